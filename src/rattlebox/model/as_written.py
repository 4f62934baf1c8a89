"""Quantities as the user wrote them: a case file gets back "5 mm", not "0.005 m".

A part remembers the texts from which it was made. They are notes, never values: a text is written only if the part that is
made with it is equal to the last bit, so that the text of a value that has changed since is not used.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from pydantic import ValidationError

from rattlebox._util.exceptions import RattleboxError

TEXTS = "_texts"
"""Name under which a part keeps its texts, beside its cached properties: neither compared nor written."""

_BEGIN = frozenset("0123456789+-.")
MOST_ITEMS = 1000
"""Items of a list that are searched for texts: a longer table of numbers has none."""
Texts = Mapping[str, Any]
"""Texts by field; a part is any object with the methods of `base.Part`, which imports this module."""


class Given(dict[str, Any]):
    """Fields of a new part that were read from other values, with the texts of these."""

    def __init__(self, fields: Mapping[str, object], texts: Texts, read: Iterable[str] = ()) -> None:
        super().__init__(fields)
        self.texts = texts
        self.read = frozenset(read)  # fields whose values are not from the user

    @classmethod
    def read_from(cls, values: Mapping[str, object], fields: Mapping[str, object]) -> Given:
        """Return fields that were read from other values."""
        return cls(fields, _texts_of(values))

    @classmethod
    def changed(cls, earlier: object, fields: Mapping[str, object], *names: str | int) -> Given:
        """Return the fields of an earlier part or of its fields, of which some have new values."""
        if isinstance(earlier, Given):
            return cls(fields, earlier.texts, earlier.read - set(names))
        is_part = hasattr(earlier, "as_given")
        return cls(
            fields, earlier.__dict__.get(TEXTS, {}) if is_part else {}, set(fields) - set(names) if is_part else ()
        )


def remember(part: object, values: Mapping[str, object]) -> None:
    """Store the texts of quantities among the values from which a part was made."""
    texts = _texts_of(values)
    for name in [name for name, text in texts.items() if isinstance(text, dict)]:
        if not isinstance(part.__dict__.get(name), dict):  # a part, which stores its own
            del texts[name]
    if texts:
        part.__dict__[TEXTS] = texts


def _texts_of(values: Mapping[str, object]) -> dict[str, Any]:
    """Return the texts among values by name, with those from which the values were read."""
    texts = dict(values.texts) if isinstance(values, Given) else {}
    read = values.read if isinstance(values, Given) else ()
    for name, value in values.items():
        if value is None or type(value) is float or type(value) is int or name in read:
            continue
        text = _text_of(value)
        if text is not None:
            texts[name] = text
    return texts


def _text_of(value: Any) -> Any:
    """Return a quantity with a unit as text, and lists and tables with such quantities; None for other values."""
    if isinstance(value, str):
        return value if value.lstrip()[:1] in _BEGIN and value.strip() else None
    if isinstance(value, (list, tuple)):
        kinds = set(map(type, value[:MOST_ITEMS]))
        if str in kinds:
            if len(value) == 2 and isinstance(value[1], str) and _text_of(value[1]) is None:  # (0.4, "mm")
                return f"{value[0]} {value[1]}" if isinstance(value[0], (int, float)) else None
            return _plain(value) if any(isinstance(item, str) and _text_of(item) for item in value) else None
        if kinds & {list, tuple} and any(
            isinstance(item, (list, tuple)) and _text_of(item) for item in value[:MOST_ITEMS]
        ):
            return _plain(value)
        return None
    if isinstance(value, dict):  # such as mode shapes; that of a part is not used
        is_nested = any(isinstance(item, dict) for item in value.values())
        return _plain(value) if not is_nested and any(_text_of(item) for item in value.values()) else None
    magnitude = getattr(value, "magnitude", None) if hasattr(value, "units") else None  # a quantity of pint
    return f"{float(magnitude)!r} {value.units:~}" if isinstance(magnitude, (int, float)) else None


def _plain(value: object) -> Any:
    """Return nested lists of texts and numbers for a TOML file."""
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    return value.item() if isinstance(value, np.generic) else value


def with_texts(part: Any, data: dict[str, Any]) -> dict[str, Any]:
    """Return the content of a case file with the texts of a part, and of the parts in it, where they are still right."""
    written = {name: _inside(getattr(part, name, None), item) for name, item in data.items()}
    usable = {name: text for name, text in part.__dict__.get(TEXTS, {}).items() if _is_usable(part, name, text)}
    if not usable:
        return written
    fields = part.as_given()
    if not _is_equal(part, _replaced(part, fields, usable)):
        right: dict[str, Any] = {}
        for name, text in usable.items():
            if _is_equal(part, _replaced(part, fields, {**right, name: text})):
                right[name] = text
        usable = right
    return _replaced(part, written, usable)


def _inside(value: object, data: object) -> Any:
    """Return the content of a case file for a part, or for a list or a table of parts; other content unchanged."""
    if isinstance(data, dict):
        if hasattr(value, "as_given"):
            return with_texts(value, data)
        if isinstance(value, Mapping):
            return {name: _inside(value.get(name), item) for name, item in data.items()}
    if isinstance(data, list) and isinstance(value, tuple) and len(data) == len(value):
        return [_inside(*pair) for pair in zip(value, data, strict=True)]
    return data


def _is_usable(part: Any, name: str, text: Any) -> bool:
    """Return whether a text can stand for the value of a field; parts write themselves."""
    if name not in type(part).model_fields or name in (*part.fields_from_file(), "file"):  # paths depend on the folder
        return False
    value = getattr(part, name)
    return isinstance(text, str) or not (hasattr(value, "as_given") or _has_parts(value))


def _has_parts(value: object) -> bool:
    items: Iterable[Any] = value.values() if isinstance(value, Mapping) else value if isinstance(value, tuple) else ()
    return any(hasattr(item, "as_given") for item in items)


def _replaced(part: Any, fields: Mapping[str, Any], texts: Texts) -> dict[str, Any]:
    """Return fields with texts in place of values, without the alternatives that they exclude."""
    excluded = {other for name, text in texts.items() for other in part.excluded_by(name, text)}
    kept = {name: value for name, value in fields.items() if name not in excluded or name in texts}
    return {**kept, **texts}


def _is_equal(part: Any, fields: Mapping[str, Any]) -> bool:
    """Return whether an equal part is made of these fields."""
    try:
        return bool(type(part).model_validate(dict(fields)) == part)
    except (ValidationError, RattleboxError, ValueError, TypeError):
        return False
