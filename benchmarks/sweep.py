"""Times what a study of the seed's case costs. `python benchmarks/sweep.py` prints one JSON line a measurement.

packing: a million variants packed by broadcasting, on a grid and in a random design; best of three, and the memory it
took at most.
"""

from __future__ import annotations

import json
import resource
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from rattlebox.engines.pack import pack_batch
from rattlebox.model.case import Case
from rattlebox.paper.seed import CONSTANT, PLASTIC, seed_case

MILLION = 1_000_000


def grid() -> tuple[Case, dict[str, Any], tuple[int, ...]]:
    """Return a thousand gaps by a thousand amplitudes."""
    gap, amplitude = np.linspace(1e-4, 2e-3, 1000), np.linspace(1e3, 5e3, 1000)
    columns = {"damper.gap": gap.reshape(-1, 1), "load.amplitude": amplitude.reshape(1, -1)}
    return seed_case(CONSTANT), columns, (1000, 1000)


def random() -> tuple[Case, dict[str, Any], tuple[int, ...]]:
    """Return five parameters drawn at random, all of which enter the elasto-plastic law or the structure."""
    draw = np.random.default_rng(0).uniform
    columns = {
        "structure.mass": draw(10, 30, MILLION),
        "damper.ball.radius": draw(0.02, 0.04, MILLION),
        "damper.gap": draw(1e-4, 2e-3, MILLION),
        "damper.contact.restitution.yield_stress": draw(5e8, 2e9, MILLION),
        "load.amplitude": draw(1e3, 5e3, MILLION),
    }
    return seed_case(PLASTIC), columns, (MILLION,)


def packing(design: Callable[[], tuple[Case, Mapping[str, Any], tuple[int, ...]]]) -> dict[str, Any]:
    """Pack a million variants."""
    case, columns, shape = design()
    before = _peak()
    seconds = []
    for _ in range(3):
        start = time.perf_counter()
        pack_batch(case, columns, shape)
        seconds.append(time.perf_counter() - start)
    memory = (_peak() - before) / 2**20
    return {"name": f"packing, {design.__name__}", "seconds": min(seconds), "MiB": memory, "variants": MILLION}


def _peak() -> int:
    """The most memory this process has had so far [bytes]."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def main() -> None:
    """Measure and print."""
    for design in (grid, random):
        print(json.dumps(packing(design)))


if __name__ == "__main__":
    main()
