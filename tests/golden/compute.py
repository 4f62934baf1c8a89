"""Computes the quantities of cases: `python tests/golden/compute.py FILE.npz [CASE ...]`, with RATTLEBOX_SIMD set."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from golden import cases, quantities
else:
    from . import cases, quantities

import rattlebox as rb

THREADS, RESTART = " [two threads]", " [restart]"
"""Suffixes of case names for other ways of running a case, which must give the same bits."""


def with_variants(names: Sequence[str]) -> list[str]:
    """Return the names of cases, followed by those of the other ways in which they are run."""
    threads = [name + THREADS for name in names if name in cases.TWO_THREADS]
    return [*names, *threads, *(name + RESTART for name in names if name in cases.CHECKPOINTED)]


def case_of(name: str) -> str:
    """Return the name of the case whose results a run must have."""
    return name.removesuffix(THREADS).removesuffix(RESTART)


def impacts_compared(name: str) -> int:
    """Return the number of impacts up to which the values of a case are compared: later the motion is chaotic."""
    return cases.FEWER_IMPACTS.get(name, 10)


def compute(level: str, names: Sequence[str]) -> dict[str, quantities.Quantities]:
    """Run cases with one instruction set in a separate process, and return their quantities by name."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "quantities.npz"
        environment = {**os.environ, "RATTLEBOX_SIMD": level}
        command = [sys.executable, str(Path(__file__)), str(path), *names]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"the cases failed with {level}:\n{done.stderr[-3000:]}")
        results: dict[str, quantities.Quantities] = {name: {} for name in names}
        with np.load(path) as file:
            for key in file.files:
                name, quantity = key.split("/")
                results[name][quantity] = file[key]
    return results


def run(name: str) -> Any:
    """Run a case by its name."""
    of = case_of(name)
    if name.endswith(THREADS):
        return rb.simulate(cases.TWO_THREADS[of]())
    if name.endswith(RESTART):
        return _restarted(cases.CHECKPOINTED[of]())
    return rb.simulate(cases.CASES[of]())


def _restarted(case: rb.Case) -> Any:
    """Run the first half of a case, and the rest from a checkpoint."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.checkpoint"
        first = rb.simulate(case, checkpoint=path, progress=lambda done, total: done < total // 2)
        if not quantities.was_stopped(first):
            raise RuntimeError(f"the run was to be stopped half way, but its status is {first.status}")
        return rb.simulate(case, checkpoint=path)


def main() -> None:
    """Write the quantities of the named cases to a file."""
    path, *names = sys.argv[1:]
    found = {
        f"{name}/{quantity}": array for name in names for quantity, array in quantities.quantities(run(name)).items()
    }
    np.savez(path, **found)  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
