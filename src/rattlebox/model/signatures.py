"""Signatures of the parts of a case for `help` and notebooks: plain names of types without validators."""

from __future__ import annotations

import re
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
from pydantic import WithJsonSchema

from .also_accepts import AlsoAccepts
from .units import SI

_QUANTITY = "number or text with unit"
_JSON_TYPES = {"string": "str", "number": "float"}


class PlainText(str):
    """A text that `inspect.Signature` prints without quotes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


def type_text(annotation: object, metadata: tuple[Any, ...] = ()) -> str:
    """Return the name of a type without validators.

    Examples
    --------
    >>> type_text(Annotated[float, SI("m")] | None)
    'number or text with unit | None'
    """
    return " | ".join(_members(annotation, metadata))


def _members(annotation: object, metadata: tuple[Any, ...] = ()) -> list[str]:
    """Return the members of a union, None last."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _members(arguments[0], (*arguments[1:], *metadata))
    if origin in (Union, UnionType):
        members = list(dict.fromkeys(name for each in arguments for name in _members(each)))
        members.sort(key=lambda name: name == "None")
    elif origin in (tuple, list) and (origin is list or arguments[-1] is ...):
        members = [f"Sequence[{type_text(arguments[0])}]"]
    elif origin is np.ndarray:
        members = ["ArrayLike"]
    elif origin is Literal:
        members = [f"Literal[{', '.join(map(repr, arguments))}]"]
    elif origin is not None:
        members = [f"{origin.__name__}[{', '.join(map(type_text, arguments))}]"]
    else:
        members = ["None" if annotation is NoneType else getattr(annotation, "__name__", str(annotation))]
    for each in metadata:
        if _takes_text(each):
            members = [re.sub(r"\bfloat\b(?: \| str)?", _QUANTITY, name) for name in members if name != "str"]
        elif isinstance(each, AlsoAccepts):
            members += [name for name in _other_types(each) if name not in members]
            members = members if each.schema else [*_members(arguments[0]), *members]
    return members


def _other_types(also: AlsoAccepts) -> list[str]:
    """Return the names of the types that a field accepts besides its own."""
    if not also.schema:
        return []
    return [f"Literal[{also.schema['const']!r}]" if "const" in also.schema else _JSON_TYPES[also.schema["type"]]]


def _takes_text(metadata: object) -> bool:
    """Return whether a validator reads numbers from text with a unit."""
    if isinstance(metadata, WithJsonSchema):
        return {"type": "string"} in (metadata.json_schema or {}).get("anyOf", ())
    return isinstance(metadata, SI)
