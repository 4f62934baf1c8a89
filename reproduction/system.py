"""The reference paper's system, a ball in a cavity on a sprung mass hit by a short pulse: its cases and ensembles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

import rattlebox as rb
from rattlebox import Case, Run

from .files import simulate_many

Array = NDArray[np.float64]
Contact = rb.Tsuji | rb.Linear | rb.Thornton
Ending = Literal["zero_overlap", "zero_force"]

_CASE = rb.reference_case()
_STRUCTURE, _DAMPER, _PULSE = _CASE.structure, _CASE.dampers[0], _CASE.loads[0]
assert isinstance(_STRUCTURE, rb.SDOF) and isinstance(_DAMPER, rb.ImpactDamper) and isinstance(_PULSE, rb.HalfSine)
assert isinstance(_DAMPER.contact, rb.Tsuji) and _DAMPER.contact.alpha is not None
_RADIUS = _DAMPER.balls[0].radius
assert _STRUCTURE.stiffness is not None and _STRUCTURE.damping is not None
assert _DAMPER.gap is not None and _RADIUS is not None

MASS, STIFFNESS, DAMPING = _STRUCTURE.mass, _STRUCTURE.stiffness, _STRUCTURE.damping  # Structure [kg, N/m, N s/m]
RADIUS, GAP = _RADIUS, _DAMPER.gap  # Radius of the ball; d0, the clearance on each side when it is centred [m]
ALPHA = _DAMPER.contact.alpha  # Tsuji's coefficient of the constant-restitution model
PULSE = _PULSE.duration  # Duration of the half sine [s]

START = {1: 0.0, 2: -1.0, 3: 1.0}
"""Reduced start position of the paper's cases: centred, touching the trailing wall, touching the leading wall."""

CONSTANT = _DAMPER.contact  # The constant-restitution model
PLASTIC = rb.Tsuji(restitution=rb.JacksonGreen(), ending="zero_overlap")
"""The elasto-plastic impact model between a steel ball and a steel wall."""
PLASTIC_RIGID = rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid"), ending="zero_overlap")
"""The same with a wall that counts as rigid in the critical speed."""


def paper_case(
    contact: Contact = CONSTANT,
    *,
    start: float = 0.0,
    amplitude: float = 5000.0,
    duration: float = 10.0,
    times: Sequence[float] | None = None,
    rate: float | None = None,
    method: rb.EventDriven | rb.TwoStep | rb.Newton | None = None,
    wall: Literal["rigid"] | None = None,
    ball: bool = True,
    name: str = "",
) -> Case:
    """Return the paper's case."""
    case = rb.reference_case(
        contact,
        start=start,
        amplitude=amplitude,
        duration=duration,
        output=rb.Output(rate=rate) if times is None else rb.Output(times=tuple(times)),
        method=method,
    )
    changes: dict[str, Any] = {}
    if name:
        changes["name"] = name
    if wall is not None:
        changes["damper.wall"] = wall
    if not ball:
        changes["dampers"] = ()
    return case.replaced(changes) if changes else case


def ensemble(make_case: Callable[[float], Case], members: int = 64, reach: float = 1e-6) -> list[Run]:
    """Simulate a case from many nearby start positions."""
    if members < 1:
        raise ValueError(f"members is {members}, but an ensemble needs at least 1")
    # A quarter step off centre: no two starts coincide when offsets are mirrored at a wall.
    steps = (np.arange(members) + 0.25) / members
    return simulate_many([make_case(float(offset)) for offset in reach * (2 * steps - 1)])


def near(start: float, offset: float) -> float:
    """Return the reduced start position displaced by an offset, mirrored at the walls."""
    place = start + offset / GAP
    return place if abs(place) <= 1 else float(np.copysign(2.0, place)) - place


def band(values: ArrayLike, axis: int = 0) -> Array:
    """Return the 10 %, 50 % and 90 % quantiles of an ensemble, (3, ...); NaN wherever a member is NaN."""
    return np.asarray(np.quantile(np.asarray(values, dtype=float), (0.1, 0.5, 0.9), axis=axis))
