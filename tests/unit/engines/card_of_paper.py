"""A graphics card that is not there: kernels of particles in space, compiled for the processor, with a team of one."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.engines.gpu import sources

COMPILER = shutil.which("c++") or shutil.which("g++") or shutil.which("clang++")
FLAGS = (
    "-std=c++20 -O1 -ffp-contract=off -fno-math-errno -nostdinc++ -shared -fPIC -Wall -Wextra -Werror -DRATTLEBOX_GPU"
)


def built(folder: Path, **macros: int) -> ctypes.CDLL:
    """Compile the kernels' source into a library."""
    core, library = sources(), folder / "dem.so"
    rooms = ["-I", str(core), "-I", str(core / "gpu" / "std")]
    named = [f"-D{name}={value}" for name, value in macros.items()]
    source = str(core / "gpu" / "dem.cpp")
    subprocess.run([str(COMPILER), *FLAGS.split(), *named, *rooms, source, "-o", str(library)], check=True)
    return ctypes.CDLL(str(library))


@dataclass
class Block:
    """Memory at an address that is a multiple of 256."""

    array: NDArray[np.uint8]

    @property
    def handle(self) -> int:
        """Where it begins."""
        return int(self.array.ctypes.data)


class CardOfPaper:
    """What rattlebox.engines.card.Card does, with this memory in bytes and so much of it shared by a block."""

    arch, compiling = "sm_90", 3.0

    def __init__(self, library: ctypes.CDLL, *, free: int = 1 << 30, shared: int = 200_000) -> None:
        self.library, self.free, self.shared = library, free, shared
        self.launched: list[str] = []
        self.side_by_side: list[int] = []
        self.macros: dict[str, int] = {}

    def told(self, compiling: float) -> str:
        """What it is."""
        return f"a card of paper, {compiling:.0f} s"

    def memory(self) -> tuple[int, int]:
        """Free, and all."""
        return self.free, 2 * self.free

    def allow_shared(self, kernel: str, size: int) -> int:
        """At most what there is."""
        return min(size, self.shared)

    def blocks_at_once(self, kernel: str, threads: int) -> int:
        """Some."""
        return 4

    def kernels(self, source: str, **macros: int) -> tuple[None, Any]:
        """Name them."""
        assert source == "dem.cpp"
        self.macros = macros
        return None, lambda name: name

    @contextmanager
    def room(self, size: int) -> Iterator[Block]:
        """Memory for a while."""
        raw = np.full(size + 256, 0xAB, np.uint8)
        begin = -raw.ctypes.data % 256
        yield Block(raw[begin : begin + size])

    def fill(self, block: Block, byte: int) -> None:
        """One byte all over."""
        block.array[:] = byte

    def upload(self, block: Block, data: NDArray[Any]) -> None:
        """To the card."""
        found = np.ascontiguousarray(data).view(np.uint8)
        block.array[: found.size] = found

    def download(self, block: Block, array: NDArray[Any], begin: int = 0) -> None:
        """From the card."""
        array.view(np.uint8)[:] = block.array[begin : begin + array.nbytes]

    def launch(
        self, kernel: str, blocks: int, threads: int, *arguments: Any, shared: int = 0, at_once: bool = False
    ) -> None:
        """Run a kernel, block by block."""
        self.launched.append(kernel)
        self.side_by_side.append(blocks if kernel == "block" else 1)
        worlds, second, until, *_, board = arguments
        if kernel == "grid":
            assert at_once and shared == 0
            self.library.grid(
                ctypes.c_void_p(worlds.handle), None, ctypes.c_size_t(until), ctypes.c_void_p(board.handle)
            )
            return
        with self.room(shared) as near:
            given = [ctypes.c_void_p(block.handle) for block in (worlds, second)]
            sizes = [ctypes.c_size_t(n) for n in (blocks, until)]
            near_at, told = ctypes.c_void_p(near.handle), ctypes.c_void_p(board.handle)
            self.library.block(*given, *sizes, near_at, ctypes.c_size_t(shared), told)
