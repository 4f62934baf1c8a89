"""The graphics card of this machine: what is missing to use it, its memory, its kernels."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import CaseError

from .gpu import Compiled, compile_kernels, cuda, nvrtc

_DRIVER = (13, 0), "580"  # the CUDA that machine code of this compiler needs, and NVIDIA's driver that has it
_LEAST = 7, 5  # compute capability


class Card:
    """The first graphics card, ready for the thread that made this.

    Raises
    ------
    CaseError
        When a package, the driver or a card is missing or too old, with how to get it.

    Attributes
    ----------
    name
        As its maker calls it.
    arch
        Architecture that kernels are compiled for, such as "sm_90".
    driver
        Version of CUDA that the driver has.
    compiling
        How long kernels have been compiled that were not in the cache [s].
    """

    def __init__(self) -> None:
        nvrtc()
        core, self._driver = cuda("cuda.core"), cuda("cuda.bindings.driver")
        try:
            (found,) = self._driver.cuInit(0)
        except cuda("cuda.pathfinder").DynamicLibNotFoundError:
            raise CaseError(
                "a GPU needs NVIDIA's driver, which is not installed (libcuda was not found)\n"
                f"  try: the driver {_DRIVER[1]} or newer; in a container, pass the card through (--gpus all)"
            ) from None
        if found.name in ("CUDA_ERROR_NO_DEVICE", "CUDA_ERROR_SYSTEM_NOT_READY"):
            raise CaseError(
                "NVIDIA's driver is installed, but it finds no card\n"
                "  try: nvidia-smi; a card hidden by CUDA_VISIBLE_DEVICES, or not passed through to a container"
            )
        self._check(found)
        version = self._answer(self._driver.cuDriverGetVersion())
        self.driver = version // 1000, version % 1000 // 10
        if self.driver < _DRIVER[0]:
            raise CaseError(
                f"NVIDIA's driver has CUDA {self.driver[0]}.{self.driver[1]}, {_DRIVER[0][0]}.{_DRIVER[0][1]} is needed\n"
                f"  try: the driver {_DRIVER[1]} or newer"
            )
        self._core, self._device = core, core.Device(0)
        self._device.set_current()
        self.name = str(self._device.name)
        capability = tuple(self._device.compute_capability)
        if capability < _LEAST:
            raise CaseError(
                f"{self.name} has compute capability {capability[0]}.{capability[1]}, "
                f"{_LEAST[0]}.{_LEAST[1]} or newer is needed\n  try: a card since 2018 (Turing)"
            )
        self.arch = f"sm_{capability[0]}{capability[1]}"
        self._stream, self._beside = self._device.create_stream(), self._device.create_stream()
        self._loaded: dict[Any, tuple[Compiled, Any]] = {}
        self.compiling = 0.0

    def describe(self) -> str:
        """Return its name, memory, architecture and driver."""
        _, total = self.memory()
        version = f"{self.driver[0]}.{self.driver[1]}"
        return f"{self.name}, {total / 2**30:.0f} GiB, {self.arch}, driver with CUDA {version}"

    def told(self, compiling: float) -> str:
        """Return what to tell of it, and of how long kernels were compiled [s]."""
        took = f"kernels compiled in {compiling:.1f} s" if compiling else "kernels from the cache"
        return f"{self.describe()}; {took}"

    def memory(self) -> tuple[int, int]:
        """Return the bytes of its memory that are free, and all of them, once all that was asked of it is done."""
        self._stream.sync()
        self._check(*self._driver.cuMemPoolTrimTo(self._device.memory_resource.handle, 0))  # or it keeps what was used
        free, total = self._answer(self._driver.cuMemGetInfo())
        return int(free), int(total)

    @property
    def multiprocessors(self) -> int:
        """Number of its multiprocessors."""
        return int(self._device.properties.multiprocessor_count)

    @property
    def resident(self) -> int:
        """Most threads that a multiprocessor holds: for so many local memory is set aside."""
        return int(self._device.properties.max_threads_per_multiprocessor)

    def allow_shared(self, kernel: Any, size: int) -> int:
        """Let blocks of a kernel have so many bytes of shared memory, or as many as there are; return how many."""
        most = int(self._device.properties.max_shared_memory_per_block_optin) - int(kernel.attributes.shared_size_bytes)
        size = min(size, most)
        attribute = self._driver.CUfunction_attribute.CU_FUNC_ATTRIBUTE_MAX_DYNAMIC_SHARED_SIZE_BYTES
        self._check(*self._driver.cuKernelSetAttribute(attribute, size, kernel.handle, self._device.device_id))
        return size

    def blocks_at_once(self, kernel: Any, threads: int) -> int:
        """Return how many blocks of a kernel, of so many threads, the card holds at once."""
        return int(kernel.occupancy.max_active_blocks_per_multiprocessor(threads, 0)) * self.multiprocessors

    def kernels(self, source: str, **macros: int) -> tuple[Compiled, Any]:
        """Compile the kernels of a source file, or take them from the cache, and load them.

        Parameters
        ----------
        source, **macros
            As for `rattlebox.engines.gpu.compile_kernels`.

        Returns
        -------
        tuple
            Machine code, and a function that returns the kernel of a name.
        """
        key = source, *macros.items()
        if key not in self._loaded:
            compiled = compile_kernels(source, self.arch, keep=True, **macros)
            self.compiling += compiled.seconds
            loaded = self._core.ObjectCode.from_cubin(compiled.code, name=source)
            self._loaded[key] = compiled, loaded.get_kernel
        return self._loaded[key]

    @contextmanager
    def room(self, size: int) -> Iterator[Any]:
        """Hold a block of its memory, of `size` bytes."""
        try:
            buffer = self._device.allocate(max(size, 1), stream=self._stream)
        except Exception as error:
            if "OUT_OF_MEMORY" not in str(error):
                raise
            raise CaseError(
                f"{size / 2**30:.3g} GiB are needed on the card at once, {self.memory()[0] / 2**30:.3g} GiB are free\n"
                "  try: nvidia-smi, which tells what other programs use; a card with more memory"
            ) from None
        try:
            yield buffer
        finally:
            buffer.close(self._stream)

    def fill(self, buffer: Any, byte: int) -> None:
        """Write the same byte all over a block."""
        buffer.fill(byte, stream=self._stream)

    def upload(self, buffer: Any, data: bytes | NDArray[Any]) -> None:
        """Copy bytes to the card, once all that was asked of it is done."""
        host = np.frombuffer(data, np.uint8)
        # In the kernels' stream: they would not wait for a copy in the default one, which may end after the call for it.
        self._check(
            *self._driver.cuMemcpyHtoDAsync(int(buffer.handle), host.ctypes.data, host.nbytes, self._stream.handle)
        )
        self._stream.sync()

    def download(self, buffer: Any, array: NDArray[Any], begin: int = 0) -> None:
        """Copy from the card, from a byte of a block on, into an array, once all that was asked of the card is done."""
        self._stream.sync()
        self._check(*self._driver.cuMemcpyDtoH(array.ctypes.data, int(buffer.handle) + begin, array.nbytes))

    def launch(
        self, kernel: Any, blocks: int, threads: int, *arguments: Any, shared: int = 0, at_once: bool = False
    ) -> None:
        """Start a kernel; whole numbers among its arguments are of 64 bits.

        Parameters
        ----------
        kernel, blocks, threads, *arguments
            The kernel, how many blocks of how many threads each, and what it is given.
        shared
            Bytes of shared memory of each block, beyond those that it always has.
        at_once
            Blocks wait for each other, and must all be there at once.
        """
        config = self._core.LaunchConfig(grid=blocks, block=threads, shmem_size=shared, is_cooperative=at_once)
        given = [np.uint64(value) if isinstance(value, int) else value for value in arguments]
        self._core.launch(self._stream, config, kernel, *given)

    def works(self) -> bool:
        """Tell whether something that was asked of the card is not done yet."""
        (found,) = self._driver.cuStreamQuery(self._stream.handle)
        if found == self._driver.CUresult.CUDA_ERROR_NOT_READY:
            return True
        self._check(found)
        return False

    def peek(self, buffer: Any, array: NDArray[Any]) -> None:
        """Copy from the card what a kernel at work has written so far, from the begin of a block, into an array."""
        self._check(
            *self._driver.cuMemcpyDtoHAsync(array.ctypes.data, int(buffer.handle), array.nbytes, self._beside.handle)
        )
        self._beside.sync()

    def poke(self, buffer: Any, begin: int, array: NDArray[Any]) -> None:
        """Copy an array to where a kernel at work may look, from a byte of a block on."""
        self._check(
            *self._driver.cuMemcpyHtoDAsync(
                int(buffer.handle) + begin, array.ctypes.data, array.nbytes, self._beside.handle
            )
        )
        self._beside.sync()

    def wait(self) -> None:
        """Wait until all that was asked of the card is done."""
        self._stream.sync()

    def _check(self, found: Any, *_: Any) -> None:
        if found != self._driver.CUresult.CUDA_SUCCESS:
            raise CaseError(f"the graphics card says {found.name}\n  try: nvidia-smi, whether other programs use it up")

    def _answer(self, answered: tuple[Any, ...]) -> Any:
        self._check(answered[0])
        return answered[1] if len(answered) == 2 else answered[1:]


def this_card() -> Card:
    """Return the card that this thread has made before, or make it, with the errors of Card."""
    if not hasattr(_made, "card"):
        _made.card = Card()
    card: Card = _made.card
    return card


_made = threading.local()
