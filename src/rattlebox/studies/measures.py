"""Numbers that sum up a run, computed in the core (core/impact/measures.hpp) without keeping its trajectory."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any, NamedTuple

from rattlebox._util.html import Catalogue
from rattlebox.model.errors import Hint
from rattlebox.results.schema import OUTCOMES


class Measure(NamedTuple):
    """What a measure is.

    Attributes
    ----------
    units
        SI unit, "1" for pure numbers.
    long_name
        Meaning in a few words, fit for an axis label.
    samples
        It is found from samples of the motion, and is as good as they are dense.
    cyclic
        It needs a cycle: a harmonic load or motion.
    """

    units: str
    long_name: str
    samples: bool = False
    cyclic: bool = False


class Measures(Catalogue[Measure]):
    """Descriptions of measures by name."""

    plural = "measures"
    columns = ("name", "unit", "meaning", "needs")

    def row(self, name: str, entry: Measure) -> tuple[str, ...]:
        """Return name, unit, meaning and what the measure needs."""
        needs = ["samples of the motion"] * entry.samples + ["a harmonic load or motion"] * entry.cyclic
        return name, "" if entry.units == "1" else entry.units, entry.long_name, " and ".join(needs)


_MEASURES: dict[str, Measure] = {
    "impacts": Measure("1", "impacts"),
    "impacts_per_cycle": Measure("1", "impacts a cycle", cyclic=True),
    "peak_contact_force": Measure("N", "peak contact force"),
    "peak_overlap": Measure("m", "largest overlap"),
    "largest_approach_speed": Measure("m/s", "largest approach speed"),
    "mean_approach_speed": Measure("m/s", "mean approach speed"),
    "longest_contact": Measure("s", "longest contact"),
    "work": Measure("J", "work of load and base"),
    "viscous_loss": Measure("J", "loss in the structure"),
    "impact_loss": Measure("J", "loss in the damper"),
    "viscous_share": Measure("1", "share lost in the structure"),
    "impact_share": Measure("1", "share lost in the damper"),
    "motion_share": Measure("1", "share left in the motion"),
    "energy_residual": Measure("1", "energy residual over the energy put in"),
    "peak": Measure("m", "peak displacement", samples=True),
    "rms": Measure("m", "RMS displacement", samples=True),
    "peak_velocity": Measure("m/s", "peak velocity", samples=True),
    "rms_velocity": Measure("m/s", "RMS velocity", samples=True),
    "peak_acceleration": Measure("m/s^2", "peak absolute acceleration, mean over a sample step", samples=True),
    "rms_acceleration": Measure("m/s^2", "RMS absolute acceleration, mean over a sample step", samples=True),
    "settling_time": Measure("s", "settling time to 5 % of the peak", samples=True),
    "loss_per_cycle": Measure("J", "loss in the damper a cycle", cyclic=True),
    "reduced_loss": Measure("1", "loss a cycle over m V^2", samples=True, cyclic=True),
    "effective_mass": Measure("kg", "effective mass", samples=True, cyclic=True),
    "damping_mass": Measure("kg", "imaginary part of the apparent mass", samples=True, cyclic=True),
    "loss_factor": Measure("1", "loss factor", samples=True, cyclic=True),
}
MEASURES = Measures(_MEASURES)


_OF_VARIANTS = {*OUTCOMES, "state", "displacement", "velocity", "ball_place", "ball_speed"}
_OF_IMPACTS = {"last_time", "last_approach_speed", "last_contact"}
_OF_DESIGNS = {"trial", "front", "case", "missing", "feasible", "added_mass"}
TAKEN = _OF_VARIANTS | _OF_IMPACTS | _OF_DESIGNS
"""Names in studies that are no measure's."""


def name_of(measure: Any) -> str:
    """Return what a measure is called, which may be a function of a Run."""
    if isinstance(measure, partial):
        measure = measure.func
    return measure if isinstance(measure, str) else getattr(measure, "__name__", type(measure).__name__)


def check_names(measures: Iterable[Any]) -> None:
    """Refuse measures of which two have one name, and functions that are called like another part of a study.

    Raises
    ------
    Hint
        With the name.
    """
    measures = list(measures)
    for measure in measures:
        if not isinstance(measure, str) and name_of(measure) in TAKEN:
            raise Hint(
                f"a function cannot be called {name_of(measure)}: studies hold something else by that name",
                "another name",
            )
    names = [name_of(measure) for measure in measures]
    for name in names:
        if names.count(name) > 1:
            raise Hint(f"two measures are called {name}", "each once, functions with names of their own")


def with_required(required: Sequence[str], measures: Any) -> list[Any]:
    """Return the measures that a study needs, and those that are asked for besides."""
    return [*required, *(name for name in measures if name not in required)]
