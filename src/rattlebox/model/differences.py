"""Differences between two descriptions, for messages."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from itertools import chain, islice, takewhile

_MAX_LINES = 8
_NOTHING = object()


def differences(there: Mapping[str, object], here: Mapping[str, object]) -> list[str]:
    """Describe the differences between two trees in a few lines."""
    lines = [f"  {line}" for line in _differences(there, here)]
    return lines if len(lines) <= _MAX_LINES else [*lines[:_MAX_LINES], f"  and {len(lines) - _MAX_LINES} more"]


def _differences(there: object, here: object, path: str = "") -> Iterator[str]:
    """Yield the differences between two trees; of lists, the first one."""
    if isinstance(there, str) and isinstance(here, str) and "\n" in there:
        with suppress(tomllib.TOMLDecodeError):
            there, here = tomllib.loads(there), tomllib.loads(here)
    if isinstance(there, dict) and isinstance(here, dict):
        for name in sorted(there.keys() | here.keys()):
            below = f"{path}.{name}" if path else name
            yield from _differences(there.get(name, _NOTHING), here.get(name, _NOTHING), below)
    elif isinstance(there, list) and isinstance(here, list) and len(there) == len(here):
        places = (_differences(*pair, f"{path}[{i}]") for i, pair in enumerate(zip(there, here, strict=True)))
        yield from islice(chain.from_iterable(places), 1)
    elif isinstance(there, list) and isinstance(here, list) and any(isinstance(each, dict) for each in (*there, *here)):
        yield f"{path}: {len(there)} there, {len(here)} here"
    elif there is not here and _shown(there) != _shown(here):
        sides = _shown(there), _shown(here)
        common = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(*sides, strict=False)))
        yield f"{path}: {_cut(sides[0], common)} there, {_cut(sides[1], common)} here"


def _shown(value: object) -> str:
    return "nothing" if value is _NOTHING else json.dumps(value, default=str, ensure_ascii=False)


def _cut(text: str, common: int) -> str:
    """Return the part of a text around its first difference from another one, after `common` equal characters."""
    start = max(0, min(common - 12, len(text) - 37)) if len(text) > 40 else 0
    end = len(text) if len(text) <= start + 40 else start + 37
    return "..." * (start > 0) + text[start:end] + "..." * (end < len(text))
