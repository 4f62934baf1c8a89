"""Base class of the parts of a case."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import cache
from inspect import Parameter, Signature
from reprlib import Repr
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self, get_args

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    GetJsonSchemaHandler,
    ValidationError,
    WithJsonSchema,
    model_serializer,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from rattlebox._util.text import has_controls

from .also_accepts import AlsoAccepts
from .as_written import TEXTS, remember
from .errors import Hint, nearest, translate
from .kinds import in_order, register
from .signatures import PlainText, type_text

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass as _ModelType
else:
    _ModelType = type(BaseModel)


class _ReadableSignature:
    """The signature of a part, in place of the one with all validators that pydantic assigns, which is ignored."""

    def __get__(self, cls: type[Part], _: type) -> Signature:
        return _signature(cls)

    def __set__(self, cls: type[Part], value: object) -> None:
        pass


class _PartMeta(_ModelType):
    """Metaclass of parts: plain types in the signature, and CaseError in place of pydantic's error in direct calls."""

    __signature__ = _ReadableSignature()

    def __dir__(cls) -> list[str]:  # noqa: N805
        """Return what users need: neither pydantic's names nor those by which parts describe themselves to the package."""
        return [name for name in super().__dir__() if not name.startswith("__") and name not in _internal_names()]

    def __call__(cls, *args: Any, **values: Any) -> Any:  # noqa: N805
        if args:
            names: tuple[str, ...] = getattr(cls, "positional", ())
            if len(args) > len(names) or set(names[: len(args)]) & set(values):
                fields = tuple(getattr(cls, "model_fields", ()))
                first = next((name for name in fields if name != "kind"), "name")
                raise Hint(
                    f"{cls.__name__} takes its fields by name: {', '.join(fields)}", f"{cls.__name__}({first}=...)"
                )
            values = dict(zip(names, args, strict=False)) | values
        try:
            return super().__call__(**values)
        except ValidationError as error:
            raise translate(error, cls.__name__, vocabulary(), values) from None


def _signature(part: type[Part]) -> Signature:
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
            default = () if isinstance(default, np.ndarray) else default
        elif name in alternatives and name not in part.positional:  # a required argument may follow a positional one
            annotation, metadata, default = Annotated[annotation, *metadata] | None, (), None
        if name in singular:
            # Show both names: the plural takes several, and is optional if the singular is given.
            metadata = tuple(each for each in metadata if not isinstance(each, AlsoAccepts))
            default = () if default is Parameter.empty else default
            one = PlainText(f"{type_text(get_args(annotation)[0])} | None")
            named.append(Parameter(singular[name], Parameter.KEYWORD_ONLY, default=None, annotation=one))
        kind = Parameter.POSITIONAL_OR_KEYWORD if name in part.positional else Parameter.KEYWORD_ONLY
        shown = Parameter(
            field.alias or name, kind, default=default, annotation=PlainText(type_text(annotation, metadata))
        )
        (positional if name in part.positional else named).append(shown)
    return Signature([*sorted(positional, key=lambda each: part.positional.index(each.name)), *named])


@cache
def _internal_names() -> frozenset[str]:
    return frozenset({*type.__dir__(BaseModel), *vars(Part), "kinds", "model_post_init"})


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


class Part(BaseModel, metaclass=_PartMeta):
    """Immutable part of a case. Invalid values raise CaseError."""

    field_names: ClassVar[tuple[str, ...]] = ()  # fields of a case file that hold a part of this class
    aliases: ClassVar[dict[str, str]] = {}  # other names of fields, such as the singular for one item
    positional: ClassVar[tuple[str, ...]] = ()  # fields that are also positional arguments
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = ()  # pairs of fields of which only one is allowed
    file_fields: ClassVar[tuple[str, ...]] = ()  # fields that are read from a file
    elementwise: ClassVar[bool] = True  # whether arrays of variants may replace its numbers
    examples_in: ClassVar[dict[str, dict[str, str]]] = {}  # TOML examples of fields, by the field that holds the part
    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        arbitrary_types_allowed=True,
        allow_inf_nan=False,
        ser_json_inf_nan="constants",
        defer_build=True,  # validators are compiled when a class is first used
    )

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        register(cls)

    def short_label(self) -> str:
        """Return a phrase for the labels of studies, or nothing where the fields that were given make the label."""
        return ""

    @model_validator(mode="wrap")
    @classmethod
    def _with_texts(cls, values: object, handler: Any) -> Self:
        """Keep the texts of quantities for `Case.to_file`."""
        made: Self = handler(values)
        if isinstance(values, dict):
            remember(made, values)
            made._check_names()
        return made

    def _check_names(self) -> None:
        """Raise if a name has control characters, which would reach figures and terminals."""
        for field in type(self).model_fields:
            value = getattr(self, field)
            names = value if isinstance(value, Mapping) else [value] if field in _NAMES else ()
            for name in names:
                if isinstance(name, str) and has_controls(name):
                    raise Hint(f"{name!r} contains a control character", "printable characters only", [field])

    def model_copy(self, *, update: Mapping[str, object] | None = None, deep: bool = False) -> Self:
        """Return a copy with other values, which are not validated; cached properties are computed anew.

        Raises
        ------
        CaseError
            If a field does not exist.
        """
        for name in (update or {}).keys() - type(self).model_fields.keys():
            raise Hint(f"{type(self).__name__} has no field {name!r}", nearest(name, type(self).model_fields))
        copy = super().model_copy(update=update, deep=deep)
        for name in copy.__dict__.keys() - type(self).model_fields.keys() - {TEXTS}:
            del copy.__dict__[name]
        return copy

    def __setattr__(self, name: str, value: object) -> None:
        raise Hint(
            f"{name}: a {type(self).__name__} cannot be changed",
            'another one, or a new case with other values, case.replaced({"duration": "2 s", "damper.friction": 0.5})',
        )

    def __repr_args__(self) -> Iterator[tuple[str, Any]]:
        """Return the fields that are not at their defaults, shortened."""
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                yield name, _Shown(_SHORT.repr(tuple(value[: _SHORT.maxtuple + 1].tolist())))
            elif field.is_required() or value != field.get_default(call_default_factory=True):
                yield name, _Shown(_SHORT.repr(value))

    def __str__(self) -> str:
        return repr(self)

    def __dir__(self) -> list[str]:
        return sorted({*dir(type(self)), *type(self).model_fields})

    def fields_from_file(self) -> tuple[str, ...]:
        """Return the fields whose values were read from a file."""
        return type(self).file_fields if getattr(self, "file", None) is not None else ()

    def as_given(self) -> dict[str, Any]:
        """Return the fields by name, without those that were read from a file, from which an equal part is made."""
        from_file = self.fields_from_file()
        return {name: getattr(self, name) for name in type(self).model_fields if name not in from_file}

    @classmethod
    def excluded_by(cls, name: str, value: object) -> list[str]:
        """Return the fields that a value of a field excludes."""
        return [other for pair in cls.alternatives if name in pair for other in pair if other != name]

    def excludes(self, name: str, value: object) -> list[str]:
        """Return the fields of this part that a new value of a field excludes."""
        return self.excluded_by(name, value)

    def absent_item(self, field: str, name: str) -> str:
        """Return advice on a name that a table of this part lacks, by default the nearest one."""
        return nearest(name, getattr(self, field))

    @classmethod
    def expand_aliases(cls, values: dict[str, Any]) -> dict[str, Any]:
        """Return values with the names of fields in place of aliases.

        Raises
        ------
        Hint
            If a field is given under both names.
        """
        for other, name in cls.aliases.items():
            if other in values and name in values:
                if values[other] is not None:
                    raise Hint(f"give {other} or {name}, not both", f"all of them in {name}")
                values = {field: value for field, value in values.items() if field != other}
        return {cls.aliases.get(name, name): value for name, value in values.items()}

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        schema = handler(core)
        content = handler.resolve_ref_schema(schema)
        for other, name in cls.aliases.items():
            content["properties"][other] = content["properties"][name]
            if name in content.get("required", []):
                content["required"].remove(name)
        return schema


def full_text(value: object) -> str:
    """Return a text that two values share only if they are equal; the representation of a part is shortened."""
    if isinstance(value, Part):
        return f"{type(value).__name__} {value.model_dump_json()}"
    if isinstance(value, (list, tuple)):
        return f"{type(value).__name__}[{', '.join(map(full_text, value))}]"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key!r}: {full_text(each)}' for key, each in value.items())}}}"
    return repr(value)


def vocabulary() -> dict[str, dict[str, dict[str, str]]]:
    """Return the fields of parts, each with an example or "", by field or class of the part and by its kind."""
    known: dict[str, dict[str, dict[str, str]]] = {}
    stack: list[type[Part]] = [Part]
    while stack:
        part = stack.pop()
        if part is FilePart:  # its classes follow below their other base class, in the order of kinds
            continue
        stack.extend(reversed(in_order(part, part.__subclasses__())))
        kind = part.model_fields.get("kind")
        if kind is not None and kind.is_required():
            continue  # a base class of several kinds
        for holder in (*part.field_names, part.__name__):
            tag = "" if kind is None else str(kind.default)
            fields = known.setdefault(holder, {}).setdefault(tag, {})
            fields |= dict.fromkeys(part.aliases, "") | examples(part) | part.examples_in.get(holder, {})
    return known


def examples(part: type[Any]) -> dict[str, str]:
    """Return the names of fields, each with an example in TOML, or ""."""
    fields: dict[str, FieldInfo] = getattr(part, "model_fields", None) or part.__pydantic_fields__
    return {field.alias or name: _example(field) for name, field in fields.items()}


def _example(field: FieldInfo) -> str:
    schemas = [item.json_schema or {} for item in field.metadata if isinstance(item, WithJsonSchema)]
    values = [*(field.examples or []), *(example for schema in schemas for example in schema.get("examples", []))]
    return _toml_value(values[0]) if values else ""


def _toml_value(value: object) -> str:
    if isinstance(value, Mapping):
        rows = (
            f"{name if name.isidentifier() else json.dumps(name)} = {_toml_value(row)}" for name, row in value.items()
        )
        return "{ " + ", ".join(rows) + " }"
    return json.dumps(value)


class FilePart(Part):
    """Part with fields that may be read from a file; a case file then names the file in their place."""

    @model_serializer(mode="wrap")
    def _without_file_fields(self, handler: Any) -> Any:
        data = handler(self)
        for name in self.fields_from_file():
            data.pop(name, None)
        return data
