"""Limits of the methods, with their values in a result; `limits.toml` has their meanings."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.exceptions import RattleboxError
from rattlebox._util.quantities import amount, digits
from rattlebox.engines.run_notes import Overlap, worst_overlap
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


@cache
def _meanings() -> dict[str, dict[str, str]]:
    """Return the meaning of each limit by kind of result."""
    return tomllib.loads((files("rattlebox.report") / "limits.toml").read_text(encoding="utf-8"))


def limit(kind: str, name: str, here: str, allowed: str = "", **words: str) -> Limit:
    """Return a limit of a kind of result; `words` fill in the braces of its meaning."""
    return Limit(name, here, allowed, _meanings()[kind][name].format(**words))


def readable_case(run: Run) -> Case | None:
    """Return the case of a run; None if a file that it names can no longer be read."""
    try:
        return run.case
    except RattleboxError:
        return None


def run_limits(run: Run) -> Iterator[Limit]:
    """Yield the limits of a run."""
    case, residual = readable_case(run), run.energy_residual
    bound = "" if case is None else ENERGY_BOUNDS[case.method.kind]
    yield limit("run", "energy balance", f"{residual:.1e}" if residual else "0", bound)
    if "particles" in run.groups:
        yield from _particle_limits(run)
    if case is None:
        return
    yield from mode_limits(case)
    if "impacts" in run.groups:
        yield from _impact_limits(run, case)
    if case.dampers or case.stops:
        yield limit("run", "one run of a chaotic motion", "1 run")


def mode_limits(case: Case) -> Iterator[Limit]:
    """Yield the limit of the modes of the structure."""
    frequencies = case.structure.natural_frequencies
    if frequencies and case.structure.kind not in ("sdof", "shear_building"):
        highest = amount(frequencies[-1], "Hz")
        yield limit("run", "modes of the structure", f"{len(case.structure.modes().stiffness)}, up to {highest}")


def _impact_limits(run: Run, case: Case) -> Iterator[Limit]:
    """Yield the limit of the contact whose overlap is nearest to it."""
    impacts = run.arrays.impacts
    known = np.isfinite(impacts.peak_overlap) & (impacts.peak_overlap > 0)
    worst = []
    for index, damper in enumerate(case.impact_dampers):
        mine = known & (impacts.damper == index)
        if mine.any():
            worst.append(worst_overlap(damper, impacts.contact[mine], impacts.peak_overlap[mine]))
    for index, stop in enumerate(case.each_stop, len(case.impact_dampers)):
        mine = known & (impacts.damper == index)
        if mine.any() and stop.radius is not None:
            worst.append(Overlap(float(impacts.peak_overlap[mine].max()) / stop.radius, stop.contact.overlap_limit))
    if worst:
        ratio, allowed = max(worst, key=lambda overlap: overlap.ratio / overlap.limit)
        yield limit("run", "overlap in contacts", f"{amount(ratio, '%', 3)} of the radius", f"{100 * allowed:g} %")


def _particle_limits(run: Run) -> Iterator[Limit]:
    finite = {name: value for name, value in run.diagnostics.items() if math.isfinite(value)}
    if "steps_per_contact" in finite:
        steps = f"{digits(finite['steps_per_contact'], 3)} steps in the shortest contact"
        yield limit("particles", "time step", steps, f"{MIN_STEPS_PER_CONTACT:g} or more")
    if "largest_overlap" in finite:
        overlap = f"{amount(finite['largest_overlap'], '%', 3)} of the radius"
        yield limit("particles", "overlap in contacts", overlap, f"{100 * MAX_OVERLAP:g} %")
    if finite.get("softening", 1.0) > 1:
        change = finite.get("softening_change", 0.0)
        # The estimate is for beds under their weight; without gravity its 0 is no finding.
        effect = f", change of the loss up to {digits(change, 2)} m V²" if change > 0 else ", effect not estimated"
        yield limit("particles", "softening of contacts", f"{finite['softening']:.4g}{effect}", f"{MAX_CHANGE:g} m V²")
        if "softened_enduring_share" in finite:
            share = f"{amount(finite['softened_enduring_share'], '%', 2)} of the loss"
            yield limit("particles", "enduring contacts", share, f"{100 * MAX_ENDURING_SHARE:g} %")
