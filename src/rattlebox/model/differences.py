"""What two descriptions of something on disk do not share, for messages."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from itertools import chain, islice, takewhile
from typing import Any

_TOLD = 8  # on one screen
_NOTHING = object()


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> list[str]:
    """Tell where two trees differ, as far as one screen holds it.

    Parameters
    ----------
    there, here
        Of JSON's types; texts may be TOML. "There" is what is on disk.

    Returns
    -------
    list of str
        A line for each difference; of a list, the first place only, and of tables that are not as many, their numbers.
    """
    lines = [f"  {line}" for line in _differences(there, here)]
    return lines if len(lines) <= _TOLD else [*lines[:_TOLD], f"  and {len(lines) - _TOLD} more"]


def _differences(there: Any, here: Any, path: str = "") -> Iterator[str]:
    """Where two trees differ; of a list, the first place."""
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
        parted = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(*sides, strict=False)))
        yield f"{path}: {_cut(sides[0], parted)} there, {_cut(sides[1], parted)} here"


def _shown(value: Any) -> str:
    return "nothing" if value is _NOTHING else json.dumps(value, default=str, ensure_ascii=False)


def _cut(text: str, parted: int) -> str:
    """As much as fits a line, with the place where it parts from another text."""
    begin = max(0, min(parted - 12, len(text) - 37)) if len(text) > 40 else 0
    end = len(text) if len(text) <= begin + 40 else begin + 37
    return "..." * (begin > 0) + text[begin:end] + "..." * (end < len(text))
