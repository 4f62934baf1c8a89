"""Symmetry of a case: whether the mirrored motion, half a period later, is one of its motions, too."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rattlebox.engines.fingerprint import fingerprint
from rattlebox.prepare.pack import pack

if TYPE_CHECKING:
    from rattlebox.core import _core
    from rattlebox.studies.orbits.forcing import Forcing

_EQUAL = 1e-12
"""Largest relative difference of two equal numbers."""


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


def _same(one: _core.Contact, other: _core.Contact) -> bool:
    """Return whether two contacts have the same law with the same numbers."""
    return fingerprint(one) == fingerprint(other)


def _opposite(one: tuple[_core.Damper, _core.Contact], other: tuple[_core.Damper, _core.Contact]) -> bool:
    """Return whether two stops stand on opposite sides with the same gap and law."""
    same_gap = abs(float(one[0].clearance) - float(other[0].clearance)) <= _EQUAL * float(one[0].clearance)
    return same_gap and np.allclose(one[0].shape, -other[0].shape, rtol=_EQUAL, atol=0) and _same(one[1], other[1])
