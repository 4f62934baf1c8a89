"""Union of all structures."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from .beams import Beam
from .matrices import Matrices
from .plates import Plate
from .shear_buildings import ShearBuilding
from .structures import SDOF, Fixed, Modal, Shaker

Structure = SDOF | Modal | Matrices | Beam | Plate | ShearBuilding | Fixed | Shaker
AnyStructure = Annotated[Structure, Field(discriminator="kind")]
