"""The kernels of impact dampers on the processor: their source, compiled with the containers and the memory of a GPU."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.engines.gpu import sources
from rattlebox.engines.gpu_impact import Members

COMPILER = shutil.which(os.environ.get("CC", "cc")) or shutil.which("gcc") or shutil.which("clang")
FLAGS = "-x c++ -std=c++20 -O1 -ffp-contract=off -fno-math-errno -fno-exceptions -fno-threadsafe-statics -nostdinc++"
NEAR = 16384
"""Bytes of local memory for the vectors of a thread, as in core/gpu/impact.cpp."""


def built(folder: Path) -> ctypes.CDLL:
    """Compile the kernels' source into a library of its own."""
    core, library = sources(), folder / "impact.so"
    given = f"{FLAGS} -shared -fPIC -Wall -Wextra -Werror -DRATTLEBOX_GPU".split()
    rooms = ["-I", str(core), "-I", str(core / "gpu" / "std")]
    source = str(core / "gpu" / "impact.cpp")
    subprocess.run([str(COMPILER), *given, *rooms, source, "-o", str(library), "-lm"], check=True)
    return ctypes.CDLL(str(library))


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
