"""Kernels of the core, compiled for a graphics card when they are first needed: neither card nor driver take part."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from time import perf_counter
from typing import Any

from rattlebox.model.errors import CaseError

_ROOMS = ("base", "contact", "structure", "impact", "dem", "gpu")
_CHECK = 32  # bytes of a checksum behind the machine code in the cache
# Else all functions are copied to where they are used: of trajectories twice the code and five times the wait.
_INLINED = {"dem.cpp": "0"}
INSTALL = "python -m pip install 'rattlebox[gpu]'"


@dataclass(frozen=True)
class Resources:
    """What one thread of a kernel takes.

    Attributes
    ----------
    registers
        Number of 32-bit registers.
    stack
        Bytes of local memory, those of the functions that it calls included.
    shared
        Bytes of shared memory of its block.
    """

    registers: int
    stack: int
    shared: int


@dataclass(frozen=True)
class Compiled:
    """Machine code of the kernels of one source.

    Attributes
    ----------
    arch
        Architecture that it is for, such as "sm_90".
    code
        The cubin.
    seconds
        How long the compiler took; 0 where the code was in the cache.
    resources
        By kernel; empty where the code was in the cache.
    spills
        Bytes that all functions together store to and load from local memory for want of registers.
    """

    arch: str
    code: bytes
    seconds: float
    resources: Mapping[str, Resources]
    spills: int


def sources() -> Path:
    """Return the folder of the core's sources: in the package, or beside it in an editable installation."""
    package = Path(__file__).parents[1]
    folders = package / "core", package.parents[1] / "core"
    return next(folder for folder in folders if (folder / "gpu").is_dir())


def cuda(module: str) -> Any:
    """Import a module of the CUDA packages.

    Parameters
    ----------
    module
        Its name, such as "cuda.core".

    Raises
    ------
    CaseError
        When it is not installed, with the command that installs it.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "cuda":
            raise
        raise CaseError(f"a GPU needs the package cuda-core, which is not installed\n  try: {INSTALL}") from None


def nvrtc() -> tuple[int, int]:
    """Return the version of the compiler.

    Raises
    ------
    CaseError
        When it is not installed, with the command that installs it.
    """
    bindings, finder = cuda("cuda.bindings.nvrtc"), cuda("cuda.pathfinder")
    try:
        _, major, minor = bindings.nvrtcVersion()
    except finder.DynamicLibNotFoundError:
        raise CaseError(
            f"a GPU needs the package nvidia-cuda-nvrtc, which is not installed\n  try: {INSTALL}"
        ) from None
    return major, minor


def compile_kernels(source: str, arch: str, *, keep: bool = True, **macros: int) -> Compiled:
    """Compile the kernels of a source file, or take them from the user's cache folder.

    Parameters
    ----------
    source
        Name of a file in core/gpu, such as "impact.cpp", or any other with its path.
    arch
        Architecture, such as "sm_90" (Hopper).
    keep
        Use the cache.
    **macros
        Definitions for the preprocessor.

    Returns
    -------
    Compiled
        Machine code; the same bytes whether from the cache or not.

    Raises
    ------
    CaseError
        When a package is missing.
    """
    nvrtc()
    core, utils = cuda("cuda.core"), cuda("cuda.core.utils")
    folder = sources()
    code = (folder / "gpu" / source).read_text(encoding="utf-8")
    options = core.ProgramOptions(
        name=Path(source).stem,
        arch=arch,
        std="c++20",
        include_path=[str(folder), str(folder / "gpu" / "std")],
        no_source_include=True,
        device_as_default_execution_space=True,
        ofast_compile=_INLINED.get(source, "min"),
        define_macro=["RATTLEBOX_GPU", *((name, str(value)) for name, value in macros.items())],
        ptxas_options=["-v"],
    )
    key = utils.make_program_cache_key(
        code=code, code_type="c++", options=options, target_type="cubin", extra_digest=_digest(folder)
    )
    with utils.FileStreamProgramCache() as kept:
        found = kept.get(key) if keep else None
        if found and sha256(found[:-_CHECK]).digest() == found[-_CHECK:]:
            return Compiled(arch, found[:-_CHECK], 0.0, {}, 0)
        log, begin = io.StringIO(), perf_counter()
        cubin = bytes(core.Program(code, code_type="c++", options=options).compile("cubin", logs=log).code)
        if keep:
            kept[key] = cubin + sha256(cubin).digest()
    spills = sum(map(int, re.findall(r"(\d+) bytes spill", log.getvalue())))
    return Compiled(arch, cubin, perf_counter() - begin, _resources(log.getvalue()), spills)


@cache
def _digest(folder: Path) -> bytes:
    """Tells sources from others."""
    files = [file for room in _ROOMS for file in sorted((folder / room).rglob("*")) if file.is_file()]
    parts = [part for file in files for part in (str(file.relative_to(folder)).encode(), file.read_bytes())]
    return sha256(b"\0".join(sha256(part).digest() for part in parts)).digest()


def _resources(log: str) -> dict[str, Resources]:
    """What the assembler says of each kernel."""
    found = {}
    for part in log.split("Compiling entry function ")[1:]:
        name = part.split("'")[1]

        def number(pattern: str, part: str = part) -> int:
            match = re.search(rf"(\d+) {pattern}", part)
            return int(match[1]) if match else 0

        stack = max(number("bytes cumulative stack size"), number("bytes stack frame"))
        found[name] = Resources(number("registers"), stack, number("bytes smem"))
    return found
