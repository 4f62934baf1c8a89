"""What all parts of a case share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import BaseModel, ConfigDict, ValidationError

from .errors import translate

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass as _ModelType
else:
    _ModelType = type(BaseModel)


class _Explaining(_ModelType):
    """Makes wrong values raise CaseError at construction, and leaves validation inside a larger part to pydantic."""

    def __call__(cls, *args: Any, **values: Any) -> Any:  # noqa: N805
        try:
            return super().__call__(*args, **values)
        except ValidationError as error:
            raise translate(error, cls.__name__, known_fields()) from None


class Part(BaseModel, metaclass=_Explaining):
    """A frozen part of a case. Wrong values raise CaseError, whoever gives them."""

    held_as: ClassVar[tuple[str, ...]] = ()
    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        arbitrary_types_allowed=True,
        allow_inf_nan=False,
        ser_json_inf_nan="constants",
    )


def known_fields() -> dict[str, set[str]]:
    """Return the field names of every part, by the tag of its kind and by the fields that hold it."""
    fields: dict[str, set[str]] = {}
    stack: list[type[BaseModel]] = [Part]
    while stack:
        part = stack.pop()
        stack.extend(part.__subclasses__())
        names = set(part.model_fields)
        kind = part.model_fields.get("kind")
        if kind is not None:
            fields.setdefault(str(kind.default), set()).update(names)
        for holder in getattr(part, "held_as", ()):
            fields.setdefault(holder, set()).update(names)
        fields.setdefault(part.__name__, set()).update(names)
    return fields
