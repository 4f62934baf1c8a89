"""Union of all cavities."""

from __future__ import annotations

from typing import Annotated

from . import mesh_cavity  # noqa: F401  (it registers its cavity)
from .cavities import Cavity
from .kinds import AnyKind

AnyCavity = Annotated[Cavity, AnyKind()]
