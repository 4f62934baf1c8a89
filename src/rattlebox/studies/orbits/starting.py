"""Cases that start on a periodic motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.structures import Modal
from rattlebox.studies.orbits.forcing import Forcing

if TYPE_CHECKING:
    from rattlebox.model.dampers import ImpactDamper
    from rattlebox.model.structures import StructurePart


Vector = NDArray[np.float64]


def case_on(case: Case, phase: float, state: Vector) -> Case:
    """Return the case whose initial state is that of a periodic motion, at the phase of the loads that belongs to it."""
    case, modes = Forcing.of(case).shifted(phase), case.modes
    m = 2 * modes.decay.size
    q, p = state[0:m:2], state[1:m:2]
    places, speeds = np.split(state[m:], 2)
    dampers, first = [], 0
    for damper in case.impact_dampers:
        own = slice(first, first := first + len(damper.balls))
        cavity = float(modes.shape(damper.point) @ q)
        dampers.append(_started(damper, places[own] - cavity, speeds[own]))
    return case.model_copy(update={"structure": _structure(case, q, p), "tuned_masses": (), "dampers": tuple(dampers)})


def _structure(case: Case, q: Vector, p: Vector) -> StructurePart:
    """Return the structure in its initial state, with its tuned masses as points of its modes."""
    if not case.tuned_masses:
        return case.structure.started(q, p)
    if not case.structure.responds:
        raise Hint(
            "a case with tuned masses on a prescribed motion has no fields for the initial state of these",
            "orbit.run(), which simulates the motion",
            ["structure"],
        )
    return Modal.of(case.modes, displacement=q, velocity=p)


def _started(damper: ImpactDamper, places: Vector, speeds: Vector) -> ImpactDamper:
    """Return a damper whose balls are at these reduced positions in the cavity [m], with these velocities [m/s]."""
    half = 0.5 * damper.clearance
    fractions = np.clip(places / half, -1.0, 1.0) if half else 0.0 * places
    start = fractions.tolist() if len(fractions) > 1 else float(fractions[0])
    return damper.model_copy(update={"start": start, "velocity": tuple(speeds.tolist())})
