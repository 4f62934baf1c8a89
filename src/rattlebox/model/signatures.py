"""Signatures of the parts of a case for `help` and notebooks: plain names of types without validators."""

from __future__ import annotations

import re
from inspect import Parameter, Signature
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
from pydantic import WithJsonSchema

from .also_accepts import AlsoAccepts
from .units import SI

if TYPE_CHECKING:
    from .base import Part

_JSON_TYPES = {"string": "str", "number": "float"}


class _Plain(str):
    """A text that `inspect.Signature` prints without quotes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


def type_text(annotation: Any, metadata: tuple[Any, ...] = ()) -> str:
    """Return the name of a type without validators; a quantity with a unit accepts text as well.

    Examples
    --------
    >>> type_text(Annotated[float, SI("m")] | None)
    'float | str | None'
    """
    return " | ".join(_members(annotation, metadata))


def _members(annotation: Any, metadata: tuple[Any, ...] = ()) -> list[str]:
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
            members = [re.sub(r"\bfloat\b(?! \| str)", "float | str", name) for name in members]
        elif isinstance(each, AlsoAccepts):
            members += [_JSON_TYPES[each.schema["type"]]] if each.schema else []
            members = members if each.schema else [*_members(arguments[0]), *members]
    return members


def _takes_text(metadata: Any) -> bool:
    """Return whether a validator reads numbers from text with a unit."""
    if isinstance(metadata, WithJsonSchema):
        return {"type": "string"} in (metadata.json_schema or {}).get("anyOf", ())
    return isinstance(metadata, SI)


def part_signature(part: type[Part]) -> Signature:
    """Return the signature of a part of a case."""
    singular = {field: name for name, field in part.aliases.items()}
    alternatives = {name for pair in part.alternatives for name in pair}
    named: list[Parameter] = []
    positional: list[Parameter] = []
    for name, field in part.model_fields.items():
        if name == "kind":
            continue
        annotation: Any = field.annotation
        metadata: tuple[Any, ...] = tuple(field.metadata)
        default: Any = Parameter.empty
        if not field.is_required():
            default = field.get_default(call_default_factory=True)
        elif name in alternatives:
            annotation, metadata, default = Annotated[annotation, *metadata] | None, (), None
        if name in singular:
            # Show both names: the plural takes several, and is optional if the singular is given.
            metadata = tuple(each for each in metadata if not isinstance(each, AlsoAccepts))
            default = () if default is Parameter.empty else default
            one = _Plain(f"{type_text(get_args(annotation)[0])} | None")
            named.append(Parameter(singular[name], Parameter.KEYWORD_ONLY, default=None, annotation=one))
        kind = Parameter.POSITIONAL_OR_KEYWORD if name in part.positional else Parameter.KEYWORD_ONLY
        shown = Parameter(
            field.alias or name, kind, default=default, annotation=_Plain(type_text(annotation, metadata))
        )
        (positional if name in part.positional else named).append(shown)
    return Signature([*sorted(positional, key=lambda each: part.positional.index(each.name)), *named])
