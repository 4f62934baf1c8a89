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
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from gpu_cases import CASES  # beside this file
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
    most, desk = (ctypes.c_size_t * 2)(), _zeros(128)
    library.impact(
        ctypes.c_char_p(members.image),
        status.ctypes.data_as(ctypes.c_void_p),
        numbers.ctypes.data_as(ctypes.c_void_p),
        ctypes.c_size_t(members.count),
        ctypes.c_void_p(room.ctypes.data + -room.ctypes.data % 64),
        ctypes.c_size_t(members.memory),
        ctypes.c_void_p(desk.ctypes.data),
        most,
    )
    return members.named(status, numbers), most[0], most[1]


def _zeros(size: int) -> NDArray[np.uint8]:
    block = np.zeros(size + 64, np.uint8)
    begin = -block.ctypes.data % 64
    return block[begin : begin + size]


class Card:
    """A card whose memory is the processor's, and whose threads run one after the other while the host goes on."""

    multiprocessors, resident = 2, 2048
    occupancy = attributes = SimpleNamespace(
        max_active_blocks_per_multiprocessor=lambda threads, shared: 1, local_size_bytes=32_000
    )

    def __init__(self, library: ctypes.CDLL) -> None:
        self.library, self.launched, self.held = library, [], 0
        self.at_work: threading.Thread | None = None

    def kernels(self, source: str, **macros: int) -> tuple[None, Any]:
        """Return the kernel of a name: of this card, the name itself."""
        return None, lambda name: SimpleNamespace(name=name, occupancy=self.occupancy, attributes=self.attributes)

    def memory(self) -> tuple[int, int]:
        """Return the bytes that are free, and all."""
        return 2**30, 2**30

    @contextmanager
    def room(self, size: int) -> Iterator[NDArray[np.uint8]]:
        """Hold a block of memory with rubbish in it."""
        block = np.full(size + 64, 0xA5, np.uint8)
        begin = -block.ctypes.data % 64
        self.held += 1
        try:
            yield block[begin : begin + size]
        finally:
            self.wait()  # as blocks are given back in the order of the stream
            self.held -= 1

    def fill(self, buffer: NDArray[np.uint8], byte: int) -> None:
        """Write the same byte all over a block."""
        buffer[:] = byte

    def upload(self, buffer: NDArray[np.uint8], data: bytes) -> None:
        """Copy bytes to a block."""
        buffer[:] = np.frombuffer(data, np.uint8)

    def download(self, buffer: NDArray[np.uint8], array: NDArray[Any]) -> None:
        """Copy from a block into an array."""
        self.wait()
        array.view(np.uint8)[:] = buffer

    def wait(self) -> None:
        """Wait for the kernel."""
        if self.at_work:
            self.at_work.join()

    def works(self) -> bool:
        """Tell whether the kernel is at work."""
        return self.at_work is not None and self.at_work.is_alive()

    def peek(self, buffer: NDArray[np.uint8], array: NDArray[Any]) -> None:
        """Copy from the begin of a block while the kernel is at work."""
        array.view(np.uint8)[:] = buffer[: array.nbytes]

    def poke(self, buffer: NDArray[np.uint8], begin: int, array: NDArray[Any]) -> None:
        """Copy into a block while the kernel is at work."""
        buffer[begin : begin + array.nbytes] = array.view(np.uint8)

    def launch(self, kernel: Any, blocks: int, threads: int, *arguments: Any) -> None:
        """Run a kernel."""
        if kernel.name == "prepare":
            return
        image, status, numbers, members, far, each, desk = arguments
        assert far.size == blocks * threads * each and not desk.any()
        self.launched.append((members, blocks * threads))
        most = (ctypes.c_size_t * 2)()
        at = [ctypes.c_void_p(buffer.ctypes.data) for buffer in (image, status, numbers, far, desk)]
        given = *at[:3], ctypes.c_size_t(members), at[3], ctypes.c_size_t(each), at[4], most
        self.at_work = threading.Thread(target=self.library.impact, args=given)
        self.at_work.start()


def compared(library: ctypes.CDLL) -> Iterator[dict[str, Any]]:
    """Run each case both ways: memory reckoned and taken, and how far each result is off; None where one is not there."""
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
                yield {
                    "case": [group, name],
                    "status": wanted["status"].tolist(),
                    "near": near,
                    "far": far,
                    "reckoned": members.memory,
                    "off": {key: _off(found[key].astype(float), wanted[key].astype(float)) for key in wanted},
                }


def _off(found: NDArray[np.float64], wanted: NDArray[np.float64]) -> float | None:
    if not np.array_equal(np.isnan(found), np.isnan(wanted)):
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.nanmax(np.abs(found - wanted) / np.maximum(np.abs(wanted), 1e-300), initial=0.0))


if __name__ == "__main__":
    json.dump(list(compared(ctypes.CDLL(sys.argv[1]))), sys.stdout)
