"""Symmetry of a case: whether the mirrored motion, half a period later, is one of its motions, too."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rattlebox.engines.fingerprint import fingerprint
from rattlebox.model.paths import replaced
from rattlebox.prepare.pack import pack

if TYPE_CHECKING:
    from rattlebox.core import _core
    from rattlebox.studies.orbits.forcing import Forcing

_EQUAL = 1e-12
"""Largest relative difference of two equal numbers."""
_TRIED = (0.3819660112501051, 0.7236067977499789)
"""Parts of the range of a parameter at which a case must have its mirror image, which no special value has."""


def is_mirrored(forcing: Forcing) -> bool:
    """Return whether all signs of a case may change together with half a period of its loads.

    The structure is linear. What can break the symmetry is gravity, rows of different balls or walls, stops without a
    partner on the other side, and loads with even harmonics.
    """
    if not all(count % 2 for count in forcing.cycles.values()):
        return False
    problem = pack(forcing.case)
    first, stops = 0, []
    for damper in problem.dampers:
        balls = int(np.size(damper.mass))
        contacts = problem.contacts[first : first + balls + 1]
        first += balls + 1
        if balls == 0:
            stops.append((damper, contacts[0]))
            continue
        if float(damper.gravity) != 0 or not np.allclose(damper.mass, damper.mass[::-1], rtol=_EQUAL, atol=0):
            return False
        if any(not _same(one, other) for one, other in zip(contacts, contacts[::-1], strict=True)):
            return False
    return all(any(_opposite(one, other) for other in stops) for one in stops)


def stays_mirrored(forcing: Forcing, axes: Sequence[str], limits: Iterable[Sequence[float]]) -> bool:
    """Return whether a case keeps its mirror image while parameters vary between their limits.

    Gravity, the gap of one of two stops, and the amplitude of a load with even harmonics break it at all values but one.
    """
    case = forcing.case
    return all(
        is_mirrored(type(forcing).of(replaced(case, {axis: low + share * (high - low)}), axes))
        for axis, (low, high) in zip(axes, limits, strict=True)
        for share in _TRIED
    )


def _same(one: _core.Contact, other: _core.Contact) -> bool:
    """Return whether two contacts have the same law with the same numbers."""
    return fingerprint(one) == fingerprint(other)


def _opposite(one: tuple[_core.Damper, _core.Contact], other: tuple[_core.Damper, _core.Contact]) -> bool:
    """Return whether two stops stand on opposite sides with the same gap and law."""
    same_gap = abs(float(one[0].clearance) - float(other[0].clearance)) <= _EQUAL * float(one[0].clearance)
    # A mode shape next to a node is a difference of larger numbers.
    rounding = _EQUAL * float(np.abs(one[0].shape).max(initial=0.0))
    opposite = np.allclose(one[0].shape, -np.asarray(other[0].shape), rtol=_EQUAL, atol=rounding)
    return same_gap and opposite and _same(one[1], other[1])
