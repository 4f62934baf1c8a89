"""Global sensitivity analysis: Sobol indices of measures, computed by SALib."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import KW_ONLY
from dataclasses import dataclass as plain_dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox._util.exceptions import CaseError
from rattlebox._util.optional_imports import optional_import
from rattlebox.model.errors import Hint
from rattlebox.model.units import Whole
from rattlebox.results.schema import OUTCOMES
from rattlebox.studies.grid.axes import ParsedAxes, parse_axes, robust_axes
from rattlebox.studies.grid.sampling import RandomDesign, random_design
from rattlebox.studies.kinds.sweep import Sweep
from rattlebox.studies.run.store import save_result
from rattlebox.studies.run.study import (
    CONFIG,
    Axes,
    Bounds,
    Cycles,
    Fraction,
    Measures,
    Samples,
    Seconds,
    Seed,
    Study,
    split_bounds,
    study_function,
)
from rattlebox.studies.work.measures import INTERVAL
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray as xr

_MIN_SHARE = 0.5
"""Smallest share of base points that must have a value."""


@plain_dataclass(frozen=True)
class _Crossed(RandomDesign):
    """Saltelli sample: points that differ in one parameter at a time, for Sobol indices."""

    def points(self) -> NDArray[np.float64]:
        """Return the points in the unit cube, (count, parameters)."""
        width = len(self.ranges)
        sample: NDArray[np.float64] = optional_import("SALib.sample.sobol", "design").sample(
            _problem(width), self.count // (width + 2), calc_second_order=False, seed=self.seed
        )
        return sample


@dataclass(frozen=True, config=CONFIG)
class Sensitivity(Study):
    r"""Compute the shares of the variance of a measure that several parameters cause (Sobol indices).

    The parameters vary independently within their bounds. The first-order index of a parameter is the share of the variance
    that disappears when it is fixed; the total index is the share that remains when all others are fixed. They differ if
    parameters interact.

    Parameters
    ----------
    case
        Case with the values that do not vary.
    bounds
        By path: a pair (smallest, largest), or a list to choose from if the parameter is not a number; see
        `rb.random_design`.
    measure
        Names of measures (`rb.MEASURES`), or functions of a Run.
    n
        Number of base points, a power of two; the study has n (parameters + 2) points.
    levels, starts
        Load levels and start positions as for `rb.design`; a point is the mean over them. Use several start positions
        for a chaotic measure, whose scatter would otherwise count as interaction.
    log
        Paths whose values are distributed uniformly in the logarithm.
    confidence
        Level of the confidence intervals, computed by bootstrap.
    seed
        Random seed of the points and intervals.
    skip, cycles, samples, point, workers, backend, store, progress
        See `rb.sweep`.

    Returns
    -------
    xarray.Dataset
        Over `measure` and `parameter`: `first` and `total` indices with the half widths `first_confidence` and
        `total_confidence` of their intervals; over `measure`: `mean`, `variance` and `left_out`, the number of base points
        that were excluded because one of their runs has no value.

    Raises
    ------
    CaseError
        If an argument is not valid, a measure is constant, or more than half of the base points have no value.
    MissingDependency
        If SALib is not installed.

    Notes
    -----
    With the measure Y, the parameter x_i and all others x_~i, the first-order index S and the total index T are

    .. math:: S_i = \frac{V[E(Y | x_i)]}{V[Y]}, \qquad T_i = \frac{E[V(Y | x_{\sim i})]}{V[Y]}

    References
    ----------
    I. M. Sobol' (2001), Global sensitivity indices for nonlinear mathematical models and their Monte Carlo estimates,
    Mathematics and Computers in Simulation 55, 271-280, doi:10.1016/S0378-4754(00)00270-6.
    A. Saltelli et al. (2010), Variance based sensitivity analysis of model output, Computer Physics Communications 181,
    259-270, doi:10.1016/j.cpc.2009.09.018.
    J. Herman, W. Usher (2017), SALib, Journal of Open Source Software 2(9), 97, doi:10.21105/joss.00097.

    Examples
    --------
    >>> import rattlebox as rb
    >>> bounds = {"damper.gap": ("0.1 mm", "2 mm"), "load.amplitude": ("1 kN", "5 kN")}
    >>> result = rb.sensitivity(rb.reference_case(duration=1.0), bounds, "impact_share", 64)
    >>> result.total.dims
    ('measure', 'parameter')
    """

    kind: ClassVar[str] = "sensitivity"
    figure: ClassVar[str] = "rattlebox.plots.sensitivity:plot_sensitivity"
    report: ClassVar[str] = "rattlebox.report.kinds.sensitivity:KIND"

    bounds: Bounds
    measure: Measures = ("impact_share",)
    n: Annotated[Whole, Field(ge=8)] = 256
    _: KW_ONLY
    levels: Axes | None = None
    starts: Any = None
    log: Any = ()
    confidence: Fraction = 0.95
    seed: Seed = 0
    skip: Seconds = 0.0
    cycles: Cycles | None = None
    samples: Samples | None = None
    point: str | None = None

    @cached_property
    def _points(self) -> ParsedAxes:
        """Sampled points, along one dimension."""
        bounds, log = split_bounds(self.bounds, self.log)
        ranges = random_design(bounds, self.n * (len(bounds) + 2), seed=self.seed, log=log)
        crossed = _Crossed(ranges.ranges, ranges.count, ranges.method, ranges.seed, ranges.log)
        return parse_axes(self.case, crossed, source="bounds")

    @cached_property
    def _sweep(self) -> Sweep:
        """Sweep over the points, levels and starts."""
        return Sweep(
            self.case,
            [self._points, *robust_axes(self.case, self.levels, self.starts)],
            self.measure,
            skip=self.skip,
            cycles=self.cycles,
            samples=self.samples,
            point=self.point,
        )

    @property
    def work(self) -> Work:
        """Runs of all points, levels and starts."""
        return self._sweep.work

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        if self.n & (self.n - 1):
            raise Hint(f"n = {self.n} is not a power of two", f"{2 ** self.n.bit_length()}")
        self._points.grid(self.case)  # for messages that name the bounds
        self._sweep.validate()

    def compute(self) -> xr.Dataset:
        """Run the points and compute the indices; see `Study.compute`."""
        runs = self._sweep.run(**self.where)
        bounds, log = split_bounds(self.bounds, self.log)
        found = _indices(runs, list(bounds), self.n, self.confidence, self.seed)
        with suppress(TypeError):  # choices may be objects, which JSON does not know
            found.attrs |= {"bounds": json.dumps(bounds, default=float), "log": json.dumps(log)}
        return save_result(found, self.kind, self.store)


sensitivity = study_function(Sensitivity)


def _indices(runs: xr.Dataset, paths: list[str], n: int, confidence: float, seed: int) -> xr.Dataset:
    """Return the Sobol indices of all measures of a sweep."""
    import xarray as xr

    names = [str(name) for name in runs.data_vars if name not in OUTCOMES and not str(name).endswith(INTERVAL)]
    rows = [_indices_of_measure(runs, name, len(paths), n, confidence, seed) for name in names]
    found = xr.Dataset(
        {
            name: (
                ("measure", "parameter")[: 1 + np.ndim(rows[0][name])],
                [row[name] for row in rows],
                {"long_name": text},
            )
            for name, text in _LONG.items()
        },
        coords={"parameter": paths, "measure": names},
    )
    about = {"title": "Rattlebox sensitivity", "confidence": confidence, "n": n, "seed": seed}
    return found.assign_attrs(runs.attrs | about)


def _indices_of_measure(
    runs: xr.Dataset, name: str, width: int, n: int, confidence: float, seed: int
) -> dict[str, Any]:
    """Return the Sobol indices of one measure."""
    values = runs[name].where(runs["status"] == 0)
    values = values.mean([dim for dim in values.dims if dim != "sample"], skipna=False)
    by_base = values.values.reshape(n, width + 2)
    complete = np.isfinite(by_base).all(axis=1)
    left_out = int((~complete).sum())
    if left_out > _MIN_SHARE * n:
        raise CaseError(
            f"{name}: {left_out} of {n} base points have a run without a value",
            "narrower bounds or a longer duration; a sweep over a random design shows where",
        )
    output = by_base[complete].ravel()
    if np.ptp(output) == 0:
        raise CaseError(f"{name} is {output[0]:.6g} at every point and has no variance", "wider bounds")
    analyze = optional_import("SALib.analyze.sobol", "design").analyze
    # SALib interprets a seed of 0 as no seed.
    indices = analyze(_problem(width), output, calc_second_order=False, conf_level=confidence, seed=seed + 1)
    return {
        "first": indices["S1"],
        "total": indices["ST"],
        "first_confidence": indices["S1_conf"],
        "total_confidence": indices["ST_conf"],
        "mean": output.mean(),
        "variance": output.var(),
        "left_out": left_out,
    }


_LONG = {
    "first": "first-order index",
    "total": "total index",
    "first_confidence": "half width of the interval of the first-order index",
    "total_confidence": "half width of the interval of the total index",
    "mean": "mean over all points",
    "variance": "variance over all points",
    "left_out": "base points without a value",
}


def _problem(width: int) -> dict[str, Any]:
    """Return the unit cube in the form of SALib."""
    return {"num_vars": width, "names": [str(number) for number in range(width)], "bounds": [[0.0, 1.0]] * width}
