"""Pairs of bodies of an impact damper in a case."""

from __future__ import annotations

from .case import Case
from .errors import Hint, several
from .pairs import Pair


def contact_pairs(case: Case, index: int = 0) -> list[Pair]:
    """Return the pairs of bodies of an impact damper, from the trailing to the leading wall.

    Parameters
    ----------
    case
        The case.
    index
        Index of the impact damper, from 0.

    Returns
    -------
    list of Pair
        The pairs: trailing wall and ball 1, ball 1 and ball 2, ..., last ball and leading wall. Walls have the effective
        mass of the structure at the point of the damper, 1 / sum(phi^2) over the mass-normalised mode shapes phi.

    Raises
    ------
    CaseError
        If the case has no impact damper with this index.

    Examples
    --------
    >>> import rattlebox as rb
    >>> trailing, leading = rb.contact_pairs(rb.reference_case())
    >>> trailing.radius  # doctest: +NUMBER
    0.03317
    """
    count = len(case.impact_dampers)
    if case.particle_dampers:
        raise Hint(
            "the case has particle dampers, but contact_pairs returns the pairs of impact dampers",
            "[entry.pair for entry in case.particle_dampers[0].contact_table.entries]",
        )
    if not -count <= index < count:
        raise Hint(
            f"index = {index}, but the case has {several(count, 'impact damper')}",
            "a case with an ImpactDamper" if not count else "index = 0" if count == 1 else f"0 to {count - 1}",
        )
    damper = case.impact_dampers[index]
    return damper.pairs(case.modes.effective_mass(damper.point))
