"""Union of all signals."""

from __future__ import annotations

from typing import Annotated

from . import harmonics, random_vibration, recorded, shocks  # noqa: F401  (they register their signals)
from .kinds import AnyKind
from .signals import Signal

AnySignal = Annotated[Signal, AnyKind()]
