"""How fast neighbouring motions part: the largest Lyapunov exponent, over any axes of a sweep."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY
from dataclasses import dataclass as plain_dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox._util.exceptions import CaseError
from rattlebox.core import _core
from rattlebox.model.case import Case
from rattlebox.model.units import Number, Whole
from rattlebox.studies.axes import read_axes
from rattlebox.studies.case_digest import describe_case
from rattlebox.studies.grid import Grid
from rattlebox.studies.impact_work import Extra, ImpactWork
from rattlebox.studies.neighbour_pairs import Pairs
from rattlebox.studies.study import (
    CONFIG,
    Axes,
    Count,
    Cycles,
    Seconds,
    Seed,
    Study,
    study_function,
)

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, config=CONFIG)
class Lyapunov(Study):
    """Find the largest finite-time Lyapunov exponent of a case, or of each variant along some axes.

    Parameters
    ----------
    case
        The case, with the values that do not vary. Its output is not used. Records cannot be restarted from, so it has none.
    axes
        As of `rb.sweep`; none for the case alone.
    cycles
        With a harmonic load: how many cycles to skip until the motion is steady, and how many to look at.
    skip
        Without cycles: time to skip [s]; what is looked at ends with the case's duration.
    steps
        How often neighbours are brought back to their distance; default each cycle, or a hundred times.
    pairs
        Motions with a neighbour each. They start with ball velocities that differ a little, so where the motion is chaotic
        they are independent, and their spread tells the error.
    distance
        Between neighbours, over half the clearance.
    reach
        Of the differences between the starts of the pairs, over half the clearance.
    seed
        Of the directions in which neighbours lie at first, and of the differences of the starts.
    workers, backend, store, progress
        Where the study runs, and where its results are stored; see `rattlebox.studies.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over the axes: `status`; `exponent` [1/s], the mean over the pairs, and its `standard_error` [1/s]; with cycles
        `growth_per_cycle`, the exponent times the cycle, for a periodic motion the logarithm of its largest multiplier.
        Over the axes and `cycle` or `time`: `running_exponent` [1/s], over what has been looked at so far. -inf where
        neighbours become one motion within rounding, as those of a ball that comes to rest on a shaker do.

    Raises
    ------
    CaseError
        When an axis or argument does not fit the case, before anything runs.

    Notes
    -----
    Impacts make a motion only piecewise smooth. A variational equation would need the jump of each impact, of every law, and
    says nothing of grazing ones. So a second motion is run from a state at a small but finite distance, and brought back to
    it along the line between both again and again: impacts, sticking and grazing count as they are. The distance is
    compared between moments at which all contacts of both motions are open and no impact of one still awaits the other;
    where this is not so at the end of a cycle, another moment is taken. Pairs that are never brought back, as
    `rattlebox.analysis.lyapunov_exponent` reads them, see no more than the few decades between rounding and clearance;
    they are right for one pass, such as the time after a pulse of a record.

    Distances are taken in positions times the root of the mass, and velocities over the angular frequency of the cycle or
    of the fastest mode. The average over the steps gives those at both ends little weight, which makes it converge much
    faster where the motion is regular: E. Sander, J. D. Meiss, arXiv:2409.08496.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ...     ),
    ...     load=rb.Harmonic(amplitude="10 N", frequency="30 Hz"),
    ...     duration="1 s",
    ... )
    >>> rb.lyapunov(case, cycles=(50, 20), pairs=4).running_exponent.dims
    ('cycle',)
    """

    kind: ClassVar[str] = "lyapunov"

    axes: Axes | None = None
    _: KW_ONLY
    cycles: Cycles | None = None
    skip: Seconds = 0.0
    steps: Annotated[Whole, Field(ge=2)] | None = None
    pairs: Count = 8
    distance: Annotated[Number, Field(ge=1e-12, le=1e-4)] = 1e-7
    reach: Annotated[Number, Field(ge=0, le=1)] = 1e-3
    seed: Seed = 0

    @cached_property
    def work(self) -> LyapunovWork:
        """Pairs of neighbouring motions of all variants."""
        return LyapunovWork(
            self.case,
            Grid((), (), {}, {}) if self.axes is None else read_axes(self.case, self.axes),
            cycles=self.cycles,
            skip=float(self.skip),
            steps=self.steps,
            pairs=self.pairs,
            distance=self.distance,
            reach=self.reach,
            seed=self.seed,
        )

    def validate(self) -> None:
        """Raise if the fields do not fit the case or each other; see `Study.validate`."""
        self.work.validate()

    def compute(self) -> xarray.Dataset:
        """Run the pairs of all variants; see `Study.compute`."""
        return self.run_work(self.work)


lyapunov = study_function(Lyapunov)
"""Run a study of this kind: see `Lyapunov`."""


@plain_dataclass
class LyapunovWork:
    """A case, its variants, and how their neighbours are watched; attributes as of `lyapunov`."""

    case: Case
    grid: Grid
    cycles: tuple[int, int] | None = None
    skip: float = 0.0
    steps: int | None = None
    pairs: int = 8
    distance: float = 1e-7
    reach: float = 1e-3
    seed: int = 0

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "sweep"}

    def validate(self) -> None:
        """Refuse what does not fit.

        Raises
        ------
        CaseError
            With what to try.
        """
        packed = self.sweep.packed
        if self.count < 2:
            raise CaseError("to look at one cycle is one step, and at least two are needed\n  try: steps = 100")
        if np.ndim(packed.settings.duration) and self.cycles is None:
            raise CaseError("the duration differs between variants\n  try: cycles, or one duration for all")
        if any(isinstance(load.signal, _core.Record) for load in packed.loads):
            raise CaseError(
                "motions under a record cannot be started anew in its middle\n"
                "  try: rattlebox.analysis.lyapunov_exponent with pairs of runs"
            )

    # ---- as any study

    @property
    def size(self) -> int:
        """Number of variants."""
        return self.grid.size

    @property
    def block(self) -> int:
        """Preferred number of variants in a block."""
        return 1

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.steps or (int(np.ceil(self.cycles[1])) if self.cycles else 100)

    @property
    def outputs(self) -> Mapping[str, tuple[Extra, str, dict[str, str]]]:
        """Further dimensions, number type and attributes of each output."""
        along: Extra = (("cycle" if self.cycles else "time", self.count),)
        error = {"units": "1/s", "long_name": "standard error of the exponent"}
        found: dict[str, tuple[Extra, str, dict[str, str]]] = {
            "status": self.sweep.outputs["status"],
            "exponent": ((), "float64", {"units": "1/s", "long_name": "largest Lyapunov exponent"}),
            "standard_error": ((), "float64", error),
        }
        if self.cycles:
            found["growth_per_cycle"] = ((), "float64", {"units": "1", "long_name": "logarithmic growth in a cycle"})
        found["running_exponent"] = (along, "float64", {"units": "1/s", "long_name": "Lyapunov exponent so far"})
        return found

    def coords(self) -> dict[str, Any]:
        """Return the coordinate of the running exponent."""
        part = np.arange(1, self.count + 1) / self.count
        if self.cycles:
            return {"cycle": ("cycle", self.cycles[1] * part, {"units": "1", "long_name": "cycles looked at"})}
        seconds = (float(self.sweep.packed.settings.duration) - self.skip) * part
        return {"time": ("time", seconds, {"units": "s", "long_name": "time looked at"})}

    def describe(self) -> dict[str, Any]:
        """What is computed besides the grid, in JSON's types."""
        names = "skip", "steps", "pairs", "distance", "reach", "seed"
        cycles = None if self.cycles is None else list(self.cycles)
        about = {"study": "lyapunov", **describe_case(self.case, self.grid.columns), "cycles": cycles}
        return about | {name: getattr(self, name) for name in names}

    @cached_property
    def sweep(self) -> ImpactWork:
        """The variants as they are swept."""
        return ImpactWork(self.case, self.grid, skip=self.skip, cycles=self.cycles)

    def run(
        self, start: int, stop: int, *, threads: int = 1, cancelled: Callable[[], bool] | None = None
    ) -> Mapping[str, NDArray[Any]] | None:
        """Run variants start to stop; None when it was stopped."""
        pairs = Pairs(self, start, stop, threads, cancelled)
        growth = pairs.growth()
        if growth is None:
            return None
        with np.errstate(invalid="ignore"):  # of infinite growth
            rates = np.where(np.isinf(growth).any(axis=-1, keepdims=True), -np.inf, growth @ _weights(self.count).T)
            rates = rates / pairs.leg[..., None]
            mean, spread = rates[..., -1].mean(axis=1), rates[..., -1].std(axis=1, ddof=min(1, self.pairs - 1))
            found = {
                "status": pairs.status.max(axis=1).astype(np.int8),
                "exponent": mean,
                "standard_error": spread / self.pairs**0.5 if self.pairs > 1 else np.full(mean.shape, np.nan),
                "running_exponent": rates.mean(axis=1),
            }
        if self.cycles:
            found["growth_per_cycle"] = mean * pairs.period[:, 0]
        return found


def _weights(steps: int) -> NDArray[np.float64]:
    """Weights of the steps in the average over the first one, two, ... of them, (steps, steps)."""
    count, step = np.arange(1, steps + 1)[:, None], np.arange(steps)
    with np.errstate(divide="ignore", over="ignore"):
        part = (step + 0.5) / count
        weights = np.where(step < count, np.exp(-1 / (part * (1 - part))), 0.0)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))
