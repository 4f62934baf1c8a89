"""Which motion each start leads to, where several steady motions exist side by side."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from pydantic.dataclasses import dataclass

from rattlebox._util.exceptions import CaseError
from rattlebox.model.case import Case
from rattlebox.studies.axes import read_axes
from rattlebox.studies.impact_work import ImpactWork
from rattlebox.studies.measures import with_required
from rattlebox.studies.orbits import attractors, period_of, reduced_strobes
from rattlebox.studies.store import keep_map
from rattlebox.studies.study import (
    CONFIG,
    Axes,
    CyclesToCompare,
    Fraction,
    Measures,
    Study,
    study_function,
)

if TYPE_CHECKING:
    import xarray

NO_PERIOD, NOT_FINISHED = 0, -1


@dataclass(frozen=True, config=CONFIG)
class Basins(Study):
    """Find the steady motion under a harmonic load that each start leads to.

    Motions are told apart by their strobes, the state once a cycle: two are one attractor when one repeats after as many
    cycles as the other and passes through the same states. Motions without an impact are one attractor wherever the
    ball is, as long as the structure moves alike.

    Parameters
    ----------
    case
        The case, with dampers, under a harmonic load or motion.
    starts
        Axes as of `rb.sweep`: {"damper.start": rb.linspace(-1, 1, 200), "damper.velocity": rb.linspace(-1, 1, 200)}, or
        "structure.displacement", "load.phase", whatever may decide.
    cycles
        Numbers of cycles to skip until motions are steady, and to evaluate. Periods up to half of the
        latter are detected.
    measure
        Names of further measures (rb.MEASURES).
    tolerance
        A motion is held to repeat when its strobes differ by less than this part of the gap, and of gap times
        angular frequency.
    apart
        Motions whose strobes differ by less than this, in the same measure, are one attractor.
    point
        Of the structure, that is watched; default the first damper's.
    workers, backend, store, progress
        Where the study runs, and where its results are stored; see `rattlebox.studies.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over the starts: `status`; `attractor`, counted from 1 for that with the most starts, 0 where no period was found
        (chaos, a longer period, a motion not yet steady, or one beyond 256 attractors), -1 where the run did not finish;
        `period` in cycles, 0 where none was found; `impacts_per_cycle` and the measures asked for. Over `orbit`, the
        attractors: `share` of all starts, `orbit_period`, `orbit_impacts_per_cycle`; over `strobe`, NaN beyond its period,
        `orbit_displacement`, `orbit_velocity`, and over `ball` `orbit_ball_place`, `orbit_ball_speed` of the member that has
        settled best.

    Raises
    ------
    CaseError
        When an argument does not fit the case.

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

    starts: Axes
    _: KW_ONLY
    cycles: CyclesToCompare = (400, 48)
    measure: Measures = ()
    tolerance: Fraction = 1e-4
    apart: Fraction = 1e-2
    point: str | None = None

    @cached_property
    def work(self) -> ImpactWork:
        """Runs of all starts, with the state of each once a cycle."""
        return ImpactWork(
            self.case,
            read_axes(self.case, self.starts, source="basins"),
            measures=with_required(("impacts", "impacts_per_cycle"), self.measure),
            cycles=self.cycles,
            samples=self.cycles[1] + 1,
            point=self.point,
            motion=True,
        )

    def validate(self) -> None:
        """Raise if the fields do not fit the case or each other; see `Study.validate`."""
        if not self.case.dampers:
            raise CaseError("without a damper the motion is linear, and all starts lead to the same one")
        self.work.require_alike()

    def compute(self) -> xarray.Dataset:
        """Run all starts and find their attractors; see `Study.compute`."""
        work, grid = self.work, self.work.grid
        runs = self.run_work(work).load().isel(instant=slice(1, None)).rename(instant="strobe")
        strobes = reduced_strobes(runs, work.packed, work.output.period)
        period, residual = period_of(strobes, self.tolerance)
        flat = strobes.reshape(grid.size, self.cycles[1], -1)
        label, best = attractors(flat, period.ravel(), residual.ravel(), self.apart)
        label[runs.status.values.ravel() != 0] = NOT_FINISHED
        about = {
            "title": "Basins of attraction",
            "case": self.case.to_toml(),
            "cycles": list(self.cycles),
            "tolerance": self.tolerance,
        }
        found = _with_orbits(runs, label.reshape(grid.shape), period, best).assign_attrs(about, **_plane(self.case))
        return keep_map(found, self.kind, self.store)


basins = study_function(Basins)
"""Run a study of this kind: see `Basins`."""


def _plane(case: Case) -> dict[str, float]:
    """The gap [m] of a lone ball in a cavity whose motion is given: place and velocity are all its state."""
    alone = not case.modes.decay.size and len(case.impact_dampers) == 1 and len(case.impact_dampers[0].balls) == 1
    return {"gap": 0.5 * case.impact_dampers[0].clearance} if alone else {}


def _with_orbits(maps: xarray.Dataset, label: Any, period: Any, best: Any) -> xarray.Dataset:
    """Say which attractor each start has, and what each attractor is."""
    over = maps.status.dims
    strobes = ("displacement", "velocity", "ball_place", "ball_speed")
    found = (
        maps.drop_dims("strobe")
        .drop_vars("impacts")
        .assign(
            attractor=(over, label, {"units": "1", "long_name": "attractor", "flag_values": [-1, 0]}),
            period=(over, period, {"units": "1", "long_name": "cycles after which the motion repeats"}),
        )
    )
    found.attractor.attrs["flag_meanings"] = "not_finished no_period"
    lasts = period.ravel()[best]
    share = np.array([np.mean(label == number) for number in range(1, len(best) + 1)])
    own = {
        "share": (share, "share of all starts"),
        "orbit_period": (lasts, "cycles after which the orbit repeats"),
        "orbit_impacts_per_cycle": (maps.impacts_per_cycle.values.ravel()[best], "impacts a cycle"),
    }
    for name, (values, text) in own.items():
        found[name] = "orbit", values, {"units": "1", "long_name": text}
    longest = int(lasts.max(initial=1))
    within = np.arange(longest) < lasts[:, None]
    for name in strobes:
        values = maps[name].values.reshape(label.size, *maps[name].shape[label.ndim :])[best, :longest]
        kept = np.where(within.reshape(*within.shape, *(1,) * (values.ndim - 2)), values, np.nan)
        dims = ("orbit", "strobe", "ball")[: values.ndim]
        found[f"orbit_{name}"] = dims, kept, maps[name].attrs
    numbers = {"orbit": (len(best), "attractor"), "strobe": (longest, "strobe of the period")}
    return found.assign_coords(
        {name: (name, np.arange(1, n + 1), {"units": "1", "long_name": text}) for name, (n, text) in numbers.items()}
    )
