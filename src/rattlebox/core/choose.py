"""Picks the compiled core that this processor runs best."""

from __future__ import annotations

import os
import platform
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from rattlebox._util.exceptions import MissingDependency, ResourceError

# What each x86-64 level needs beyond the one below, in the names of Linux.
_FLAGS = {
    "v3": {"avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"},
    "v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
}


def _processor_flags() -> set[str]:
    """Return the processor's features in Linux names; empty where they cannot be read."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return set()
    found = next((line for line in lines if line.startswith("flags")), "")
    return set(found.partition(":")[2].split())


def built() -> tuple[str, ...]:
    """Return the levels whose extension was built, best first."""
    return tuple(level for level in ("v4", "v3", "v1", "native") if find_spec(f"rattlebox.core._core_{level}"))


def supported() -> tuple[str, ...]:
    """Return the built levels that this processor can run, best first."""
    flags = _processor_flags()
    has_v3 = _FLAGS["v3"] <= flags
    can = {"native": True, "v1": True, "v3": has_v3, "v4": has_v3 and _FLAGS["v4"] <= flags}
    return tuple(level for level in built() if can[level])


@cache
def choice() -> tuple[str, str]:
    """Return the level that is used and why.

    Raises
    ------
    MissingDependency
        When there is no compiled core.
    ResourceError
        When RATTLEBOX_SIMD asks for a level that is not there or that the processor cannot run.
    """
    possible = supported()
    if not possible:
        raise MissingDependency("no compiled core was found", "python -m pip install --force-reinstall rattlebox")
    asked = os.environ.get("RATTLEBOX_SIMD", "")
    if asked:
        if asked not in possible:
            raise ResourceError(
                f"RATTLEBOX_SIMD = {asked!r}: this processor and build offer {', '.join(possible)}",
                f"RATTLEBOX_SIMD={possible[0]}, or unset it",
            )
        return asked, "RATTLEBOX_SIMD asks for it"
    best = possible[0]
    if best == "native":
        return best, f"the only build for {platform.machine()}"
    if best == built()[0]:
        return best, "the best that was built, and the processor has all its instructions"
    return best, f"the processor lacks instructions of {built()[0]}, or they could not be read"


def instructions() -> str:
    """Return the name of the instructions that decide the last bits."""
    level = choice()[0]
    return platform.machine() if level == "native" else level


@cache
def core() -> ModuleType:
    """Return the compiled core. Modules that use it import `rattlebox.core._core`, whose types mypy knows."""
    return import_module(f"rattlebox.core._core_{choice()[0]}")
