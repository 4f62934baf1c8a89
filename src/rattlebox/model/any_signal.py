"""Union of all signals."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from .harmonics import Harmonic, SineSweep
from .random_vibration import Random
from .recorded import Record
from .shocks import HalfSine, Sawtooth, Trapezoid

AnySignal = Annotated[
    HalfSine | Harmonic | Record | Sawtooth | Trapezoid | SineSweep | Random, Field(discriminator="kind")
]
