"""Basins of attraction: the steady motion to which each initial state leads."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from pydantic.dataclasses import dataclass

from rattlebox._util.exceptions import CaseError
from rattlebox.model.case import Case
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.run.store import save_result
from rattlebox.studies.run.study import (
    CONFIG,
    Axes,
    CyclesToCompare,
    Fraction,
    Measures,
    Study,
    study_function,
)
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.measures import with_required
from rattlebox.studies.work.reductions import (
    Motion,
    Orbits,
    attractors,
    classify,
    labels,
    reduced_strobes,
    unsettled,
    without_speed,
)
from rattlebox.studies.work.variants import Variants
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray

NO_PERIOD, NOT_FINISHED, TRANSIENT = 0, -1, -2


@dataclass(frozen=True, config=CONFIG)
class Basins(Study):
    r"""Compute basins of attraction under a harmonic load: the steady motion of each initial state.

    Motions are compared by their stroboscopic states, one per cycle. Two motions belong to the same attractor if they have
    the same period and pass through the same states. Motions without impacts belong to the same attractor, wherever the
    ball is, if the structure moves alike.

    Parameters
    ----------
    case
        Case with impact dampers and a harmonic load or motion.
    starts
        Axes of initial values as for `rb.sweep`: {"damper.start": rb.linspace(-1, 1, 200), "damper.velocity":
        rb.linspace(-1, 1, 200)}, "structure.displacement" or "load.phase".
    cycles
        Numbers of cycles to skip until motions are steady, and to evaluate. Periods up to half of the
        latter are detected.
    measure
        Names of further measures (`rb.MEASURES`).
    tolerance
        Largest difference between states one period apart, and largest distance to the periodic motion, over the range of
        the motion.
    apart
        Largest difference between states that count as the same, over the range of the motion.
    point
        Observed point of the structure, "storey 2 - storey 1" for a drift, or "mode 2"; default that of the first damper.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.run.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over the initial values: `status`; `attractor`, 1 for the one with the most initial states, 0 if no period was
        detected (chaos, transient chaos, quasi-periodic motion, a longer period, or more than 256 attractors), -1 if the run
        did not finish, -2 if the motion still contracts towards a periodic one; `period` in cycles, 0 if none was detected;
        `motion`, whether it is periodic, transient or irregular; `multiplier`, the estimated factor by which a transient
        motion comes closer to its limit in each cycle; `impacts_per_cycle` and the requested measures. `attrs["unsettled"]`
        states how many cycles transient motions need. Over `orbit`,
        the attractors: `share` of all initial states, `orbit_period`, `orbit_impacts_per_cycle`; over `strobe` also
        `orbit_displacement`, `orbit_velocity`, and over `ball` `orbit_relative_position`, `orbit_relative_velocity` of the
        member with the smallest residual, NaN beyond its period.

    Raises
    ------
    CaseError
        If an argument is not valid for the case.

    Notes
    -----
    With the state s_k at the end of cycle k, over the range of the motion, the period is the smallest number n of cycles for
    which

    .. math:: \max_k |s_{k+n} - s_k| \le \text{tolerance}

    and which does not contract: the differences d_k = s_(k + n) - s_k are fitted by d_(k + 2n) = a d_(k + n) + b d_k. With
    the roots m of m^2 = a m + b, the distance to the periodic motion is at most max abs(d_k) / min abs(m - 1) over the last
    differences. While it is above `tolerance` and the largest abs(m) is below 1, the motion is transient, and its
    `multiplier` is abs(m)^(1/n). States that differ by less than `apart` count as the same, so that the period is the
    smallest divisor of n for which max abs(s_(k + n) - s_k) <= apart. Two motions of period n have the same attractor if for
    one of the shifts j = 0 ... n - 1

    .. math:: \max_k |s_k - r_{k+j}| \le \text{apart}

    The range is the amplitude of the structure at the strobes, for velocities times the angular frequency; for balls
    the largest approach speed, and the length that belongs to it, at most the gap.

    References
    ----------
    J. Guckenheimer, P. Holmes (1983), Nonlinear Oscillations, Dynamical Systems, and Bifurcations of Vector Fields,
    Springer, doi:10.1007/978-1-4612-1140-2.
    G. Datseris, A. Wagemakers (2022), Effortless estimation of basins of attraction, Chaos 32, 023104,
    doi:10.1063/5.0076568.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ...     ),
    ...     duration="1 s",
    ... )
    >>> starts = {"damper.start": rb.linspace(-1, 1, 5), "damper.velocity": rb.linspace("-0.1 m/s", "0.1 m/s", 5)}
    >>> rb.basins(case, starts, cycles=(50, 8)).attractor.dims
    ('damper.start', 'damper.velocity')
    """

    kind: ClassVar[str] = "basins"
    figure: ClassVar[str] = "rattlebox.plots.basins:plot_basins"
    report: ClassVar[str] = "rattlebox.report.kinds.steady_motions:BASINS"

    starts: Axes
    _: KW_ONLY
    cycles: CyclesToCompare = (400, 48)
    measure: Measures = ()
    tolerance: Fraction = 1e-4
    apart: Fraction = 1e-2
    point: str | None = None

    @cached_property
    def engine(self) -> ImpactEngine:
        """Runs of all initial states, with one state per cycle."""
        variants = Variants(
            self.case,
            read_axes(self.case, self.starts, source="basins"),
            measures=with_required(("impacts", "impacts_per_cycle", "largest_approach_speed"), self.measure),
            cycles=self.cycles,
            samples=self.cycles[1] + 1,
            point=self.point,
        )
        return ImpactEngine(variants, motion=True)

    @property
    def work(self) -> Work:
        """Runs of all initial states."""
        return Work(self.engine)

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        if not (self.case.dampers or self.case.stops):
            raise CaseError(
                "the case has no damper and no stop; its motion is linear, with one attractor",
                "a case with an impact damper, or a stop",
            )
        self.engine.require_alike()

    def compute(self) -> xarray.Dataset:
        """Run all initial states and determine their attractors; see `Study.compute`."""
        engine, grid = self.engine, self.engine.grid
        runs = self.run_work(self.work).load().isel(instant=slice(1, None)).rename(instant="strobe")
        strobes, ranges = reduced_strobes(runs, engine.packed, engine.output.period)
        orbits = classify(strobes / ranges[..., None, :], self.tolerance, self.apart)
        flat, scale = strobes.reshape(grid.size, self.cycles[1], -1), ranges.reshape(grid.size, -1)
        label, best = attractors(flat, scale, orbits.period.ravel(), orbits.residual.ravel(), self.apart)
        label[orbits.motion.ravel() == Motion.TRANSIENT] = TRANSIENT
        label[runs.status.values.ravel() != 0] = NOT_FINISHED
        about = {
            "title": "Basins of attraction",
            "case": self.case.to_toml(),
            "cycles": list(self.cycles),
            "tolerance": self.tolerance,
            "apart": self.apart,
        }
        about |= unsettled(orbits, self.cycles, self.tolerance)
        found = _with_orbits(without_speed(runs, self.measure), label.reshape(grid.shape), orbits, best).assign_attrs(
            about, **_plane(self.case)
        )
        return save_result(found, self.kind, self.store)


basins = study_function(Basins)


def _plane(case: Case) -> dict[str, float]:
    """Return the gap [m] of a single ball in a cavity with prescribed motion, whose state is position and velocity."""
    alone = not case.modes.decay.size and len(case.impact_dampers) == 1 and len(case.impact_dampers[0].balls) == 1
    return {"gap": 0.5 * case.impact_dampers[0].clearance} if alone else {}


def _with_orbits(maps: xarray.Dataset, label: Any, orbits: Orbits, best: Any) -> xarray.Dataset:
    """Add attractors and periods to the runs, and the orbit of each attractor."""
    over = maps.status.dims
    strobes = ("displacement", "velocity", "relative_position", "relative_velocity")
    found = (
        maps.drop_dims("strobe")
        .drop_vars("impacts")
        .assign(
            attractor=(over, label, {"units": "1", "long_name": "attractor", "flag_values": [-2, -1, 0]}),
            **labels(over, orbits),
        )
    )
    found.attractor.attrs["flag_meanings"] = "transient not_finished no_period"
    lasts = orbits.period.ravel()[best]
    share = np.array([np.mean(label == number) for number in range(1, len(best) + 1)])
    own = {
        "share": (share, "share of all starts"),
        "orbit_period": (lasts, "cycles after which the orbit repeats"),
        "orbit_impacts_per_cycle": (maps.impacts_per_cycle.values.ravel()[best], "impacts per cycle"),
    }
    for name, (values, text) in own.items():
        found[name] = "orbit", values, {"units": "1", "long_name": text}
    longest = int(lasts.max(initial=1))
    within = np.arange(longest) < lasts[:, None]
    for name in strobes:
        values = maps[name].values.reshape(label.size, *maps[name].shape[label.ndim :])[best, :longest]
        padded = np.where(within.reshape(*within.shape, *(1,) * (values.ndim - 2)), values, np.nan)
        dims = ("orbit", "strobe", "ball")[: values.ndim]
        found[f"orbit_{name}"] = dims, padded, maps[name].attrs
    numbers = {"orbit": (len(best), "attractor"), "strobe": (longest, "strobe of the period")}
    return found.assign_coords(
        {name: (name, np.arange(1, n + 1), {"units": "1", "long_name": text}) for name, (n, text) in numbers.items()}
    )
