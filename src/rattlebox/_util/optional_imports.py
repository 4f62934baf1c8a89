"""Optional libraries: imported when they are first needed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .exceptions import MissingDependency


def optional_import(module: str, extra: str, otherwise: str = "") -> Any:
    """Import a module of an optional library."""
    library = module.partition(".")[0]
    try:
        import_module(library)
    except ModuleNotFoundError as error:
        if error.name != library:
            raise
        advice = f"python -m pip install 'rattlebox[{extra}]'" + (f", or {otherwise}" if otherwise else "")
        raise MissingDependency(f"{library} is required and not installed", advice) from None
    return import_module(module)
