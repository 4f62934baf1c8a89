"""Base class of signals that may be read from a file with a unit of its own."""

from __future__ import annotations

from typing import Any

from pydantic import PrivateAttr, model_serializer

from .base import FilePart
from .signals import Sampled


class FileSignal(FilePart, Sampled):
    """Sampled signal whose content and unit may be read from a file, which a case file then names in their place."""

    _unit_as_given: str | None = PrivateAttr(default=None)
    _notes: tuple[str, ...] = PrivateAttr(default=())

    def excludes(self, name: str, value: object) -> list[str]:
        """Return the fields that a new value excludes; a file excludes numbers in the case and their unit."""
        numbers = [*self.file_fields, "unit"] if name == "file" and not self.fields_from_file() else []
        return [*super().excludes(name, value), *numbers]

    def as_given(self) -> dict[str, Any]:
        """Return the fields in the notation of the input: those of a file with the unit that the user states."""
        fields = super().as_given()
        return {**fields, "unit": self._unit_as_given} if self.fields_from_file() else fields

    @model_serializer(mode="wrap")
    def _without_file_fields(self, handler: Any) -> Any:
        data = handler(self)
        if names := self.fields_from_file():
            for name in names:
                data.pop(name, None)
            data["unit"] = self._unit_as_given
        return data
