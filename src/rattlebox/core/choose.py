"""Picks the compiled core that this processor runs best."""

from __future__ import annotations

import os
import platform
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from rattlebox._util.exceptions import MissingDependency, ResourceError

# The x86-64 level that the processor must offer for a build; 0 where it need not be an x86-64.
_NEEDED = {"v4": 4, "v3": 3, "v1": 1, "native": 0}


def built() -> tuple[str, ...]:
    """Return the levels whose extension was built, best first."""
    return tuple(level for level in _NEEDED if find_spec(f"rattlebox.core._core_{level}"))


def supported() -> tuple[str, ...]:
    """Return the built levels that this processor can run, best first."""
    offered = _x86_64_level()
    return tuple(level for level in built() if _NEEDED[level] <= offered)


def _x86_64_level() -> int:
    """Return the highest of the x86-64 levels 1, 3 and 4 that processor and system offer; 0 on other processors."""
    try:
        from rattlebox.core._core_processor import x86_64_level
    except ImportError:
        return -1  # nothing was built
    return x86_64_level()


@cache
def choice() -> tuple[str, str]:
    """Return the level that is used and why."""
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
    return best, f"the processor or the operating system lacks instructions of {built()[0]}"


def instructions() -> str:
    """Return the name of the instructions that decide the last bits."""
    level = choice()[0]
    return platform.machine() if level == "native" else level


@cache
def core() -> ModuleType:
    """Return the compiled core. Modules that use it import `rattlebox.core._core`, whose types mypy knows."""
    return import_module(f"rattlebox.core._core_{choice()[0]}")
