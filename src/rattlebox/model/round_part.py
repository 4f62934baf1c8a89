"""Parts with a radius, or a diameter in its place."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field, model_validator

from .base import Part
from .errors import Hint
from .units import PositiveLength, radius_of_diameter


class RoundPart(Part):
    """Base class of parts that need a radius or a diameter."""

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("radius", "diameter"),)
    kind: str
    radius: PositiveLength
    diameter: PositiveLength | None = Field(default=None, exclude=True)

    @model_validator(mode="before")
    @classmethod
    def _radius_of_diameter(cls, values: object) -> Any:
        if isinstance(values, dict) and values.get("radius") is None and values.get("diameter") is None:
            raise Hint("either radius or diameter is needed", 'diameter = "20 mm"')
        return radius_of_diameter(values)
