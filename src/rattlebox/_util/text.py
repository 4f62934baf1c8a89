"""Control characters in texts from files, which could change the terminal or break lines."""

from __future__ import annotations

import re

_CONTROLS = "\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029"
_NOT_IN_NAMES, _NOT_PRINTED = re.compile(f"[{_CONTROLS}\t\n]"), re.compile(f"[{_CONTROLS}]")


def has_controls(name: str) -> bool:
    """Return whether a name contains line breaks or other control characters."""
    return _NOT_IN_NAMES.search(name) is not None


def printable(text: str) -> str:
    """Return a text in which control characters except line breaks and tabs are question marks."""
    return _NOT_PRINTED.sub("?", text)
