"""Libraries that not everybody needs."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from rattlebox.model.errors import CaseError


def extra(module: str, extra: str) -> Any:
    """Import a module of an optional library.

    Parameters
    ----------
    module
        Its name.
    extra
        Which extra of rattlebox installs it.

    Raises
    ------
    CaseError
        When it is not installed, with the command that installs it.
    """
    library = module.partition(".")[0]
    try:
        import_module(library)
    except ModuleNotFoundError as error:
        if error.name != library:
            raise
        raise CaseError(
            f"this needs {library}, which is not installed\n  try: pip install 'rattlebox[{extra}]'"
        ) from None
    return import_module(module)
