"""Digests of the code of other packages that a case uses: results of two versions of it must not be mixed."""

from __future__ import annotations

import inspect
from hashlib import sha256
from pathlib import Path

from rattlebox._util.plugins import owner_of
from rattlebox.core.external_law import law_digests

from .base import Part
from .case import Case
from .contacts import Contact
from .paths import all_paths, get

_LENGTH = 12  # characters of a digest


def foreign_code(case: Case) -> dict[str, str]:
    """Return a digest for each class of a part that is not Rattlebox's, and for the laws in C++ that contacts may name."""
    parts = [get(case, path) for path in all_paths(case)]
    kinds = {type(part) for value in parts for part in (value if isinstance(value, tuple) else (value,))}
    foreign = [kind for kind in kinds if issubclass(kind, Part) and kind.__module__.partition(".")[0] != "rattlebox"]
    digests = {owner_of(kind): _digest(kind) for kind in foreign}
    # Which of the loaded laws a class names is known only for a pair of bodies.
    return digests | (law_digests() if any(issubclass(kind, Contact) for kind in foreign) else {})


def _digest(kind: type) -> str:
    """Return a digest of the module of a class; of the class alone if it has no file, as in a notebook."""
    try:
        text = Path(inspect.getfile(kind)).read_bytes()
    except (OSError, TypeError):
        try:
            text = inspect.getsource(kind).encode()
        except (OSError, TypeError):
            text = b""
    return sha256(text).hexdigest()[:_LENGTH]
