"""Registries of the kinds of parts: each class registers itself at the base class that declares `kinds`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeVar

from pydantic import BaseModel, GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticUndefined, core_schema

from rattlebox._util.plugins import load_plugins, owner_of, taken

_compiled = False  # whether a validator lists kinds already

Class = TypeVar("Class", bound=type[Any])


def register(cls: type[BaseModel]) -> None:
    """Add a class with a fixed `kind` to the registry of its base class; raise if it lacks a method or its kind is taken."""
    base: Any = next((base for base in cls.__mro__[1:] if "kinds" in vars(base)), None)
    field = cls.model_fields.get("kind")
    if base is None or field is None or field.default is PydanticUndefined:
        return
    missing = sorted(getattr(cls, "__abstractmethods__", ()))
    if missing:
        raise TypeError(f"{owner_of(cls)} must define {', '.join(missing)}, as each {base.__name__} does")
    known = base.kinds.setdefault(field.default, cls)
    if owner_of(known) != owner_of(cls):
        raise taken(f"kind of {base.__name__}", field.default, owner_of(known), owner_of(cls))
    base.kinds[field.default] = cls
    if _compiled:
        _compile_again(cls)


def in_order(base: type[Any], classes: Iterable[Class]) -> list[Class]:
    """Return classes in an order that does not depend on which module was imported first.

    Those of the module of the base class come first, as they stand there: the first one is the usual choice.
    """
    here = base.__module__
    return sorted(classes, key=lambda cls: ("", "") if cls.__module__ == here else (cls.__module__, cls.__qualname__))


class AnyKind:
    """Annotation of a base class: a field accepts every registered kind, chosen by `kind`."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        global _compiled
        load_plugins()
        _compiled = True
        kinds = {cls: kind for kind, cls in source.kinds.items()}
        choices = {kinds[cls]: handler.generate_schema(cls) for cls in in_order(source, kinds)}
        return core_schema.tagged_union_schema(choices, discriminator="kind")


def _compile_again(added: type[BaseModel]) -> None:
    """Build the validators of all parts anew, for a class that was defined after the first case."""
    parts = [next(base for base in reversed(added.__mro__) if issubclass(base, BaseModel) and base is not BaseModel)]
    for part in parts:  # grows while it is walked
        parts.extend(part.__subclasses__())
    # A validator contains those of its fields, so that all must go before the first is built.
    for part in parts:
        for name in ("__pydantic_core_schema__", "__pydantic_validator__", "__pydantic_serializer__"):
            if name in vars(part):
                delattr(part, name)
    for part in parts:
        part.model_rebuild(force=True)
