"""Optional libraries: imported when they are first needed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .exceptions import MissingDependency


def optional_import(module: str, extra: str, otherwise: str = "") -> Any:
    """Import a module of an optional library.

    Parameters
    ----------
    module
        Name of the module.
    extra
        Extra of rattlebox that installs the library.
    otherwise
        What can be done without the library.

    Returns
    -------
    module
        The module.

    Raises
    ------
    MissingDependency
        If the library is not installed; the message has the command that installs it.
    """
    library = module.partition(".")[0]
    try:
        import_module(library)
    except ModuleNotFoundError as error:
        if error.name != library:
            raise
        advice = f"python -m pip install 'rattlebox[{extra}]'" + (f", or {otherwise}" if otherwise else "")
        raise MissingDependency(f"this needs {library}, which is not installed", advice) from None
    return import_module(module)
