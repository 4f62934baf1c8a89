"""Limits of the methods, with their values in a result; docs/theory/approximations.md lists all approximations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.exceptions import RattleboxError
from rattlebox._util.quantities import amount, digits
from rattlebox.model.contacts import MAX_OVERLAP
from rattlebox.prepare.softening import MAX_CHANGE, MAX_ENDURING_SHARE
from rattlebox.prepare.time_step import MIN_STEPS_PER_CONTACT

from .parts import Limit

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results.run import Run

ENERGY_BOUNDS = {
    "event_driven": "1e-8 and the tolerance of all steps",
    "newton": "1e-8",
    "two_step": "1 %",
    "dem": "1 %",
}
"""Bound of the energy residual by the kind of the method."""


def readable_case(run: Run) -> Case | None:
    """Return the case of a run; None if a file that it names can no longer be read."""
    try:
        return run.case
    except RattleboxError:
        return None


def run_limits(run: Run) -> Iterator[Limit]:
    """Yield the limits of a run."""
    case = readable_case(run)
    residual = run.energy_residual
    yield Limit(
        "energy balance",
        f"{residual:.1e}" if residual else "0",
        "" if case is None else ENERGY_BOUNDS[case.method.kind],
        "Energy supplied minus energy stored and lost, over the energy supplied. A run beyond the bound has the status "
        "energy_error, and its results must not be used.",
    )
    if "particles" in run.groups:
        yield from _particle_limits(run)
    if case is None:
        return
    yield from mode_limits(case)
    if "impacts" in run.groups:
        yield from _impact_limits(run, case)
    if case.dampers:
        yield Limit(
            "one run of a chaotic motion",
            "1 run",
            "",
            "Motion with impacts depends on the smallest change of the start. The intervals of this report are those of "
            "time averages in this run; other starts or packings scatter more: repeat with other seeds, or use "
            "rb.damping_curve or replicas in a sweep.",
        )


def mode_limits(case: Case) -> Iterator[Limit]:
    """Yield the limit of the modes of the structure."""
    frequencies = case.structure.natural_frequencies
    if frequencies and case.structure.kind not in ("sdof", "shear_building"):
        yield Limit(
            "modes of the structure",
            f"{len(case.structure.modes().stiffness)}, up to {amount(frequencies[-1], 'Hz')}",
            "",
            "Motion above the highest mode is not computed. Impacts excite high modes: compare with more modes.",
        )


def _impact_limits(run: Run, case: Case) -> Iterator[Limit]:
    overlaps = run.arrays.impacts.peak_overlap
    overlaps = overlaps[np.isfinite(overlaps)]
    radii = [ball.half for damper in case.impact_dampers for ball in damper.balls]
    if overlaps.size and radii and overlaps.max() > 0:
        laws = [law for damper in case.impact_dampers for law in (damper.contact, damper.ball_contact) if law]
        allowed = min(law.overlap_limit for law in laws)
        yield Limit(
            "overlap in contacts",
            f"{amount(float(overlaps.max()) / min(radii), '%', 3)} of the radius",
            f"{100 * allowed:g} %",
            "Contact laws hold for contacts that are small against the spheres.",
        )


def _particle_limits(run: Run) -> Iterator[Limit]:
    known = {name: value for name, value in run.diagnostics.items() if math.isfinite(value)}
    if "steps_per_contact" in known:
        yield Limit(
            "time step",
            f"{digits(known['steps_per_contact'], 3)} steps in the shortest contact",
            f"{MIN_STEPS_PER_CONTACT:g} or more",
            "Errors fall with the square of the step: rb.check_step compares with half of it.",
        )
    if "largest_overlap" in known:
        yield Limit(
            "overlap in contacts",
            f"{amount(known['largest_overlap'], '%', 3)} of the radius",
            f"{100 * MAX_OVERLAP:g} %",
            "Contact laws of spheres hold for small contacts; less softening makes them smaller.",
        )
    if known.get("softening", 1.0) > 1:
        change = known.get("softening_change")
        yield Limit(
            "softening of contacts",
            f"{known['softening']:.4g}"
            + ("" if change is None else f", change of the loss up to {digits(change, 2)} m V²"),
            f"{MAX_CHANGE:g} m V²",
            "Moduli of contacts are divided by this factor to allow longer steps, which changes the loss of beds that rest "
            "under their weight: rb.check_softening compares.",
        )
        if "softened_enduring_share" in known:
            yield Limit(
                "enduring contacts",
                f"{amount(known['softened_enduring_share'], '%', 2)} of the loss",
                f"{100 * MAX_ENDURING_SHARE:g} %",
                "Loss in contacts that last longer than a quarter of a period grows with softening.",
            )
