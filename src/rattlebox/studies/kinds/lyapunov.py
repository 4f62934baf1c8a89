"""The largest Lyapunov exponent over the axes of a sweep."""

from __future__ import annotations

from collections.abc import Mapping
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
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.grid.grid import Grid
from rattlebox.studies.kinds.neighbour_pairs import Pairs
from rattlebox.studies.run.study import (
    CONFIG,
    Axes,
    Count,
    Cycles,
    Seconds,
    Seed,
    Study,
    study_function,
)
from rattlebox.studies.work.case_digest import describe_case
from rattlebox.studies.work.case_work import Extra
from rattlebox.studies.work.impact_work import ImpactWork
from rattlebox.studies.work.work import Cancelled, Values

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, config=CONFIG)
class Lyapunov(Study):
    r"""Compute the largest finite-time Lyapunov exponent of a case, or of each variant along some axes.

    Parameters
    ----------
    case
        Case with the values that do not vary. Its output is not used. It must have no load from a record.
    axes
        Axes as for `rb.sweep`; none for the case alone.
    cycles
        Numbers of cycles of the harmonic load to skip until the motion is steady, and to evaluate.
    skip
        Without `cycles`: time from which the motion is evaluated, until the duration of the case [s].
    steps
        Number of rescalings of the distance; default one per cycle, or 100.
    pairs
        Number of motions with a neighbour. Their initial ball velocities differ slightly, so that chaotic motions are
        independent and their scatter estimates the error.
    distance
        Distance between neighbours over half the clearance.
    reach
        Largest difference between the initial states of the pairs, over half the clearance.
    seed
        Random seed of the directions of the neighbours and of the differences of the initial states.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.run.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over the axes: `status`; `exponent` [1/s], the mean over the pairs, and its `standard_error` [1/s]; with cycles
        `growth_per_cycle`, the exponent times the period; for a periodic motion this is the logarithm of its largest
        Floquet multiplier. Over the axes and `cycle` or `time`: `running_exponent` [1/s], the exponent until then. It is
        -inf if neighbours merge within rounding, such as those of a ball that comes to rest on a shaker.

    Raises
    ------
    CaseError
        If an axis or argument is not valid for the case (raised before anything runs).

    Notes
    -----
    With impacts a motion is only piecewise smooth. A variational equation would require the jump condition of each impact
    for every contact law, and is not valid for grazing impacts. The method therefore runs a second motion at a small, finite
    distance, and rescales the distance repeatedly along the line between both states, so that impacts, sticking and grazing
    are included. The distance is measured at times at which all contacts of both motions are open and both have had the
    same impacts; if this is not so at the end of a step, another time is used. Pairs without rescaling, which
    `rattlebox.analysis.lyapunov_exponent` evaluates, cover only the few decades between rounding and clearance; they suit a
    single transient, such as the time after a pulse of a record.

    The distance is the norm of positions times the square root of the mass, and of velocities times the same factor over
    the angular frequency of the cycle or of the fastest mode. With the distance d_k to which d_0 grows in step k of the
    length t, the exponent is the weighted average

    .. math::

        \lambda = \frac{\sum_k w_k \ln(d_k / d_0)}{t \sum_k w_k}, \qquad
        w_k \sim \exp\left(-\frac{1}{s (1 - s)}\right), \quad 0 < s < 1

    where s is the place of the step in the motion. This weight converges much faster for regular motion than an even one.

    References
    ----------
    G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn (1980), Lyapunov characteristic exponents for smooth dynamical
    systems and for Hamiltonian systems, Meccanica 15, 9-20 and 21-30, doi:10.1007/BF02128236 and doi:10.1007/BF02128237.
    P. C. Müller (1995), Calculation of Lyapunov exponents for dynamic systems with discontinuities, Chaos, Solitons &
    Fractals 5, 1671-1681 (jump conditions of the variational equation).
    S. Das, Y. Saiki, E. Sander, J. A. Yorke (2017), Quantitative quasiperiodicity, Nonlinearity 30, 4111-4140,
    doi:10.1088/1361-6544/aa84c2 (weight).
    E. Sander, J. D. Meiss (2024), doi:10.48550/arXiv.2409.08496.

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
        """Raise if the fields are not valid; see `Study.validate`."""
        self.work.validate()

    def compute(self) -> xarray.Dataset:
        """Run the pairs of all variants; see `Study.compute`."""
        return self.run_work(self.work)


lyapunov = study_function(Lyapunov)


@plain_dataclass
class LyapunovWork:
    """Variants of a case and their pairs of neighbouring motions; see `Lyapunov` for the attributes."""

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
        """Raise if the arguments are not valid for the case."""
        packed = self.sweep.packed
        if self.count < 2:
            raise CaseError("one evaluated cycle is one step; at least two steps are required", "steps = 100")
        if np.ndim(packed.settings.duration) and self.cycles is None:
            raise CaseError("the duration differs between variants", "cycles, or one duration for all")
        if any(isinstance(load.signal, _core.Record) for load in packed.loads):
            raise CaseError(
                "the case has a load from a record, in the middle of which a run cannot start",
                "rattlebox.analysis.lyapunov_exponent with pairs of runs",
            )

    # ---- interface of Work

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
        found["running_exponent"] = (along, "float64", {"units": "1/s", "long_name": "Lyapunov exponent until then"})
        return found

    def coords(self) -> dict[str, Any]:
        """Return the coordinate of the running exponent."""
        part = np.arange(1, self.count + 1) / self.count
        if self.cycles:
            return {"cycle": ("cycle", self.cycles[1] * part, {"units": "1", "long_name": "evaluated cycles"})}
        seconds = (float(self.sweep.packed.settings.duration) - self.skip) * part
        return {"time": ("time", seconds, {"units": "s", "long_name": "evaluated time"})}

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        names = "skip", "steps", "pairs", "distance", "reach", "seed"
        cycles = None if self.cycles is None else list(self.cycles)
        about = {"study": "lyapunov", **describe_case(self.case, self.grid.columns), "cycles": cycles}
        return about | {name: getattr(self, name) for name in names}

    @cached_property
    def sweep(self) -> ImpactWork:
        """The variants as a sweep."""
        return ImpactWork(self.case, self.grid, skip=self.skip, cycles=self.cycles)

    def run(self, start: int, stop: int, *, threads: int = 1, cancelled: Cancelled = None) -> Values | None:
        """Run a range of variants; see `Work.run`."""
        pairs = Pairs(self, start, stop, threads, cancelled)
        growth = pairs.growth()
        if growth is None:
            return None
        with np.errstate(invalid="ignore"):  # growth may be infinite
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
    """Return the weights of the steps in the averages over the first 1, 2, ... steps, (steps, steps)."""
    count, step = np.arange(1, steps + 1)[:, None], np.arange(steps)
    with np.errstate(divide="ignore", over="ignore"):
        part = (step + 0.5) / count
        weights = np.where(step < count, np.exp(-1 / (part * (1 - part))), 0.0)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))
