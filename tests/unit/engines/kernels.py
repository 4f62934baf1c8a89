"""The kernels of impact dampers on the processor: their source, compiled with the containers and the memory of a GPU.

`python kernels.py LIBRARY` runs all cases of gpu_cases.py by them and by the core, and tells in JSON what came of it.
"""

from __future__ import annotations

import ctypes
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.engines.batch import kept, run_block
from rattlebox.engines.gpu import sources
from rattlebox.engines.gpu_impact import Members
from rattlebox.studies.axes import Design
from rattlebox.studies.measures import MEASURES
from rattlebox.studies.task import SweepTask

COMPILER = shutil.which(os.environ.get("CC", "cc")) or shutil.which("gcc") or shutil.which("clang")
FLAGS = "-x c++ -std=c++20 -O1 -ffp-contract=off -fno-math-errno -fno-exceptions -fno-threadsafe-statics -nostdinc++"
NEAR = 16384
"""Bytes of local memory for the vectors of a thread, as in core/gpu/impact.cpp."""


def built(folder: Path) -> Path:
    """Compile the kernels' source into a library of its own."""
    core, library = sources(), folder / "impact.so"
    given = f"{FLAGS} -shared -fPIC -Wall -Wextra -Werror -DRATTLEBOX_GPU".split()
    rooms = ["-I", str(core), "-I", str(core / "gpu" / "std")]
    source = str(core / "gpu" / "impact.cpp")
    subprocess.run([str(COMPILER), *given, *rooms, source, "-o", str(library), "-lm"], check=True)
    return library


def emulated(library: ctypes.CDLL, members: Members) -> tuple[dict[str, NDArray[Any]], int, int]:
    """Run members as one thread of a card would; also the most local and further memory that one of them took."""
    status, numbers = np.full(members.count, 4, np.int8), np.full(members.numbers, np.nan)
    room = np.zeros(members.memory + 64, np.uint8)
    most = (ctypes.c_size_t * 2)()
    library.impact(
        ctypes.c_char_p(members.image),
        status.ctypes.data_as(ctypes.c_void_p),
        numbers.ctypes.data_as(ctypes.c_void_p),
        ctypes.c_size_t(members.count),
        ctypes.c_void_p(room.ctypes.data + -room.ctypes.data % 64),
        ctypes.c_size_t(members.memory),
        most,
    )
    return members.named(status, numbers), most[0], most[1]


def compared(library: ctypes.CDLL) -> Iterator[dict[str, Any]]:
    """Run each case both ways: memory reckoned and taken, and how far each result is off; None where one is not there."""
    from gpu_cases import CASES  # beside this file

    for group, named in CASES.items():
        for name, (case, axes, look) in named.items():
            measures = [measure for measure, about in MEASURES.items() if "cycles" in look or not about.cyclic]
            task = SweepTask(case, Design.of(case, axes), measures=measures, samples=101, **look)
            for part, looked, _ in task._prepared:
                size = int(np.prod(part.shape))
                wanted = run_block(part.packed, part.shape, 0, size, looked)
                members = Members(part.packed, part.shape, 0, size, **kept(looked, part.shape))
                found, near, far = emulated(library, members)
                assert wanted is not None and set(wanted) == set(found)
                off = {key: _off(found[key].astype(float), wanted[key].astype(float)) for key in wanted}
                yield {
                    "case": [group, name],
                    "status": wanted["status"].tolist(),
                    "impacts": wanted["impacts"].tolist(),
                    "near": near,
                    "far": far,
                    "reckoned": members.memory,
                    "off": off,
                }


def _off(found: NDArray[np.float64], wanted: NDArray[np.float64]) -> float | None:
    if not np.array_equal(np.isnan(found), np.isnan(wanted)):
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.nanmax(np.abs(found - wanted) / np.maximum(np.abs(wanted), 1e-300), initial=0.0))


if __name__ == "__main__":
    json.dump(list(compared(ctypes.CDLL(sys.argv[1]))), sys.stdout)
