"""What all parts of a case share."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from inspect import Signature
from reprlib import Repr
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, ValidationError, WithJsonSchema, model_validator
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from rattlebox._util.text import has_controls

from .errors import Hint, nearest, translate
from .signatures import part_signature

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass as _ModelType
else:
    _ModelType = type(BaseModel)


class _Explaining(_ModelType):
    """Makes wrong values raise CaseError at construction, and leaves validation inside a larger part to pydantic."""

    def __call__(cls, *args: Any, **values: Any) -> Any:  # noqa: N805
        if args:
            names: tuple[str, ...] = getattr(cls, "unnamed", ())
            if len(args) > len(names) or set(names[: len(args)]) & set(values):
                raise Hint(f"{cls.__name__} takes its fields by name: {', '.join(getattr(cls, 'model_fields', ()))}")
            values = dict(zip(names, args, strict=False)) | values
        try:
            return super().__call__(**values)
        except ValidationError as error:
            raise translate(error, cls.__name__, vocabulary(), values) from None


class _ReadableSignature:
    """The signature of a part, in place of the one with all validators that pydantic sets."""

    def __get__(self, part: Part | None, cls: type[Part]) -> Signature:
        if part is not None:  # only classes are called
            raise AttributeError("__signature__")
        return part_signature(cls)


_NAMES = frozenset({"name", "title", "point"})


class _Shown(str):
    """A text that is its own representation."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


_SHORT = Repr()
_SHORT.maxtuple = _SHORT.maxlist = _SHORT.maxdict = 6
_SHORT.maxstring = 60
_SHORT.maxother = 10_000  # parts inside parts shorten themselves


class Part(BaseModel, metaclass=_Explaining):
    """A frozen part of a case. Wrong values raise CaseError, whoever gives them."""

    held_as: ClassVar[tuple[str, ...]] = ()
    spellings: ClassVar[dict[str, str]] = {}  # other names of fields, such as that for one instead of several
    unnamed: ClassVar[tuple[str, ...]] = ()  # fields that may be given without their names
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = ()  # fields that say the same thing: one of each pair
    in_file: ClassVar[tuple[str, ...]] = ()  # fields that a file stands for
    elementwise: ClassVar[bool] = True  # whether arrays of variants may stand in place of its numbers
    examples_in: ClassVar[
        dict[str, dict[str, str]]
    ] = {}  # of fields, as a file has them, where the part is held as such
    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        arbitrary_types_allowed=True,
        allow_inf_nan=False,
        ser_json_inf_nan="constants",
    )

    @model_validator(mode="after")
    def _check_names(self) -> Self:
        """Refuse control characters in names, which results, figures and terminals show."""
        for field in type(self).model_fields:
            value = getattr(self, field)
            names = value if isinstance(value, Mapping) else [value] if field in _NAMES else ()
            for name in names:
                if isinstance(name, str) and has_controls(name):
                    raise Hint(f"{name!r} holds a control character", "printable characters only", [field])
        return self

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with other values, unchecked; what was computed from the former ones is forgotten.

        Raises
        ------
        CaseError
            When there is no such field.
        """
        for name in (update or {}).keys() - type(self).model_fields.keys():
            raise Hint(f"{type(self).__name__} has no field {name!r}", nearest(name, type(self).model_fields))
        copy = super().model_copy(update=update, deep=deep)
        for name in copy.__dict__.keys() - type(self).model_fields.keys():
            del copy.__dict__[name]
        return copy

    def __setattr__(self, name: str, value: Any) -> None:
        raise Hint(
            f"{name}: a {type(self).__name__} stays as it is",
            'another one; or a new case with other values, case.replaced({"duration": "2 s", "damper.friction": 0.5})',
        )

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Show plain types in the signature."""
        cls.__signature__ = _ReadableSignature()  # type: ignore[assignment]

    def __repr_args__(self) -> Iterator[tuple[str, Any]]:
        """Return the fields that are not at their defaults, shortened."""
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if field.is_required() or value != field.get_default(call_default_factory=True):
                yield name, _Shown(_SHORT.repr(value))

    def __str__(self) -> str:
        return repr(self)

    def fields_from_file(self) -> tuple[str, ...]:
        """Return the fields whose values were read from a file."""
        return type(self).in_file if getattr(self, "file", None) is not None else ()

    @classmethod
    def in_full(cls, values: dict[str, Any]) -> dict[str, Any]:
        """Return the values under the names of the fields.

        Raises
        ------
        Hint
            When one is given twice.
        """
        for other, name in cls.spellings.items():
            if other in values and name in values:
                raise Hint(f"give {other} or {name}, not both")
        return {cls.spellings.get(name, name): value for name, value in values.items()}

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        schema = handler(core)
        content = handler.resolve_ref_schema(schema)
        for other, name in cls.spellings.items():
            content["properties"][other] = content["properties"][name]
            if name in content.get("required", []):
                content["required"].remove(name)
        return schema


def full_text(value: Any) -> str:
    """Return a text that two values share only if they are equal; the representation of a part is shortened.

    Parameters
    ----------
    value
        A part, a list, tuple or dictionary of them, or anything else, whose representation is returned.
    """
    if isinstance(value, Part):
        return f"{type(value).__name__} {value.model_dump_json()}"
    if isinstance(value, (list, tuple)):
        return f"{type(value).__name__}[{', '.join(map(full_text, value))}]"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key!r}: {full_text(each)}' for key, each in value.items())}}}"
    return repr(value)


def vocabulary() -> dict[str, dict[str, dict[str, str]]]:
    """Return names of fields, each with an example or "", by the field that holds a part or its class, and by its kind."""
    known: dict[str, dict[str, dict[str, str]]] = {}
    stack: list[type[Part]] = [Part]
    while stack:
        part = stack.pop()
        stack.extend(reversed(part.__subclasses__()))
        kind = part.model_fields.get("kind")
        if kind is not None and kind.is_required():
            continue  # what several kinds share
        for holder in (*part.held_as, part.__name__):
            tag = "" if kind is None else str(kind.default)
            fields = known.setdefault(holder, {}).setdefault(tag, {})
            fields |= dict.fromkeys(part.spellings, "") | examples(part) | part.examples_in.get(holder, {})
    return known


def examples(part: type[Any]) -> dict[str, str]:
    """Return the names of fields as they are written, each with an example as a file would hold it, or ""."""
    fields: dict[str, FieldInfo] = getattr(part, "model_fields", None) or part.__pydantic_fields__
    return {field.alias or name: _example(field) for name, field in fields.items()}


def _example(field: FieldInfo) -> str:
    schemas = [told.json_schema or {} for told in field.metadata if isinstance(told, WithJsonSchema)]
    told = [*(field.examples or []), *(example for schema in schemas for example in schema.get("examples", []))]
    return _in_a_file(told[0]) if told else ""


def _in_a_file(value: Any) -> str:
    if isinstance(value, Mapping):
        rows = (
            f"{name if name.isidentifier() else json.dumps(name)} = {_in_a_file(row)}" for name, row in value.items()
        )
        return "{ " + ", ".join(rows) + " }"
    return json.dumps(value)
