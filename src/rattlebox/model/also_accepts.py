"""Additional JSON Schemas of fields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema


@dataclass(frozen=True)
class AlsoAccepts:
    """Annotation with another JSON Schema that a field accepts; None is one item in place of a list."""

    schema: dict[str, Any] | None = None

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        schema = handler(core)
        return {"anyOf": [schema, self.schema or schema["items"]]}

    __hash__ = object.__hash__
