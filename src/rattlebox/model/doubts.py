"""What a case may be, but is rarely meant to be: units left out, dampers that outweigh the structure, huge friction."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from .dampers import ImpactDamper

if TYPE_CHECKING:
    from .case import Case
    from .granular import ParticleDamper

_WIDE = 1.0  # m
_ROUGH = 3.0  # coefficient of friction


def doubts(case: Case) -> tuple[str, ...]:
    """Return warnings about numbers that a unit may be missing from."""
    return tuple(
        f"warning: {told}"
        for index, damper in enumerate(case.dampers)
        for told in _of(case, damper, " ".join(damper.label(index).split()))
    )


def _of(case: Case, damper: ImpactDamper | ParticleDamper, name: str) -> Iterator[str]:
    if isinstance(damper, ImpactDamper):
        things = "ball"
        diameters = [2 * ball.half for ball in damper.balls]
        mass = float(sum(damper.masses))
        if damper.clearance > 2 * _WIDE:
            yield f"the gap of {name} is {damper.clearance / 2:.4g} m; a number without a unit is in metres"
    else:
        things = "particle"
        diameters = [2 * float(damper.contents.radius.max())]
        mass = float(damper.contents.mass.sum())
        frictions = [entry.friction.coefficient for entry in damper.contact_table.entries if entry.friction]
        if max(frictions, default=0.0) > _ROUGH:
            yield f"the friction in {name} is {max(frictions):g}; per cent need their sign: 40 % is 0.4"
    if max(diameters) > _WIDE:
        yield f"a {things} of {name} is {max(diameters):.4g} m wide; a number without a unit is in metres"
    ease = float(np.max(np.sum(np.square(case.modes.shapes[case.modes.point(damper.point)]), axis=0), initial=0.0))
    if mass * ease > 1:
        yield (
            f"the {things}s of {name} weigh {mass:.4g} kg, {mass * ease:.3g} times as much as the structure at their point"
        )
