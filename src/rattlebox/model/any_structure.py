"""Union of all structures."""

from __future__ import annotations

from typing import Annotated

from . import beams, matrices, plates, shear_buildings  # noqa: F401  (they register their structures)
from .kinds import AnyKind
from .structures import StructurePart

AnyStructure = Annotated[StructurePart, AnyKind()]
