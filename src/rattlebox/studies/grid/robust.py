"""Axes of load levels and start positions over which designs and sensitivities are evaluated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.model.errors import Hint
from rattlebox.model.packing import Bed, Lattice
from rattlebox.model.particle_damper import ParticleDamper
from rattlebox.model.units import whole_number

if TYPE_CHECKING:
    from rattlebox.model.case import Case


def robust_axes(case: Case, levels: Any = None, starts: int | Sequence[Any] | None = None) -> list[Any]:
    """Return the axes of load levels and start positions; an empty list for one run."""
    axes = list(levels) if isinstance(levels, (list, tuple)) else [] if levels is None else [levels]
    if starts is not None:
        if [len(damper.balls) for damper in case.impact_dampers] != [1]:
            raise Hint("starts requires a case with exactly one ball", 'levels={"dampers[0].start": [...]}')
        is_list = hasattr(starts, "__len__")
        axes.append({"damper.start": starts if is_list else np.linspace(-1, 1, whole_number(starts, "starts", 2))})
    return axes


def packing_axis(case: Case, count: int) -> dict[str, Any]:
    """Return an axis "packing" along which the random packings of all particle dampers vary together."""
    seeds: dict[str, list[int]] = {}
    for index, damper in enumerate(case.dampers):
        packing = damper.packing if isinstance(damper, ParticleDamper) else None
        if isinstance(packing, (Bed, Lattice)) and packing.is_random:
            seeds[f"dampers[{index}].packing.seed"] = list(range(packing.seed, packing.seed + count))
    if not seeds:
        raise no_random_packing()
    return {"packing": seeds}


def no_random_packing() -> Hint:
    """Return the error for repeated runs of a case whose initial state has no random part."""
    return Hint(
        "the packing has no random seed, so that all repeated runs would be equal",
        "packing = rb.Settled(seed=1), rb.Lattice with noise, or packings = 1",
        ["packing"],
    )
