"""What fields of a case take besides their type."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema


@dataclass(frozen=True)
class AlsoTakes:
    """Adds to the JSON Schema of a field what a validator takes besides; None stands for one instead of a list."""

    schema: dict[str, Any] | None = None

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        schema = handler(core)
        return {"anyOf": [schema, self.schema or schema["items"]]}

    __hash__ = object.__hash__
