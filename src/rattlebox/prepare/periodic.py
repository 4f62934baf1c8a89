"""Notes on periodic cavities: motion along a periodic direction, and widths that affect the result."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rattlebox.model.particle_case import direction_of_base
from rattlebox.model.space import AXES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.model.particle_damper import ParticleDamper

NARROW = 5.0
"""Width of a periodic box over the largest diameter below which a run has a warning."""


def periodic_notes(case: Case, damper: ParticleDamper, shape: NDArray[np.float64], name: str) -> Iterator[str]:
    """Yield warnings about a periodic cavity.

    `shape`: displacement of the cavity for each mode, (m, 3).
    """
    period = damper.interior.period
    if not period.any():
        return
    signals = (*case.base, *case.shaker_motion)
    bases = np.array([direction_of_base(case.particle_dampers, signal) for signal in signals]).reshape(-1, 3)
    moves = np.abs(np.vstack([shape, bases])).max(axis=0, initial=0.0)
    along = [
        axis for axis, length, moved in zip(AXES, period, moves, strict=True) if length and moved > 1e-9 * moves.max()
    ]
    if along:
        words = " and ".join(along)
        yield (
            f"warning: the cavity of {name} moves along {words}, in which it is periodic: no wall pushes the particles "
            f"along {words}, only friction at the other walls does, as in the middle of a bed that is much longer than the "
            f"motion; try: walls along {words}, if the real cavity ends there"
        )
    diameter = 2 * float(damper.contents.radius.max())
    for axis, length in zip(AXES, period, strict=True):
        if 0 < length < NARROW * diameter:
            yield (
                f"warning: the periodic width of {name} along {axis} is {length / diameter:.3g} diameters of the largest "
                f"particle: below {NARROW:g}, a particle and its images order the bed; try: a wider slice, and compare"
            )
