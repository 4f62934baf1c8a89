"""Calibration of contact parameters: values with intervals from measurements, by simulations over the parameters."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.flags import flag_masks
from rattlebox._util.progress import announce
from rattlebox._util.quantities import amount
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, at, several
from rattlebox.model.stops import refuse_stops
from rattlebox.model.units import parse, whole_number
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.studies.calibration.fit import Fit, Space
from rattlebox.studies.calibration.measurements import Contacts, Losses, read_data, source_of
from rattlebox.studies.calibration.response_surface import least_points
from rattlebox.studies.calibration.restitution import restitution_of
from rattlebox.studies.calibration.work import CalibrationEngine, Point, Simulation, simulation_of
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.grid.sampling import random_design
from rattlebox.studies.run.backends import workers_of
from rattlebox.studies.run.estimate import duration
from rattlebox.studies.run.runner import run_work
from rattlebox.studies.run.store import exclusive_writer, save_result
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case
    from rattlebox.studies.calibration.fit import Space


FloatArray = NDArray[np.float64]

_ROUNDS = 2
"""Rounds of simulations, each in the region that the one before leaves."""
_MOST_MISSING = 0.5
"""Share of runs without a value above which there is no calibration."""
_MORE_RUNS = 20
"""Runs beyond the number of values of a measurement, for the covariance of their scatter."""
_SHOWN_FROM = 2.0
"""Predicted wall time from which it is printed without a given budget [s]."""
_PROFILE, _MAP = 101, 61
"""Numbers of grid points of the profiles and of the map of two parameters in the result."""


@dataclass(eq=False)
class Calibration:
    """A calibration by simulations."""

    case: Case
    space: Space
    simulations: list[Simulation]
    runs: int
    checks: int
    seed: int
    where: dict[str, Any]
    store: Path | None
    progress: Any
    warnings: list[str] = field(default_factory=list)

    @cached_property
    def measured(self) -> FloatArray:
        """All measured values, (M,)."""
        return np.concatenate([each.measured for each in self.simulations])

    @cached_property
    def error(self) -> FloatArray:
        """Their standard uncertainties, (M,)."""
        return np.concatenate([np.asarray(each.data.error) for each in self.simulations])

    @cached_property
    def sets(self) -> NDArray[np.int64]:
        """Number of the measurement of each value, (M,)."""
        return np.repeat(np.arange(len(self.simulations)), [each.measured.size for each in self.simulations])

    @cached_property
    def points(self) -> list[Point]:
        """Place of each value."""
        return [point for each in self.simulations for point in each.points()]

    @property
    def least_runs(self) -> int:
        """Smallest number of samples with values for the surfaces and the covariance of their scatter."""
        return max(least_points(self.space.size), int(np.bincount(self.sets).max()) + _MORE_RUNS)

    def validate(self) -> None:
        """Raise if the data or the runs do not suffice, or the case cannot be simulated."""
        least = max(2, self.space.size)
        if self.measured.size < least:
            raise Hint(
                f"{several(self.measured.size, 'measured value')} cannot determine {several(self.space.size, 'parameter')} "
                f"with an interval: at least {least} are needed",
                "losses at several amplitudes, or fewer parameters",
                ["data"],
            )
        if self.runs < self.least_runs:
            raise Hint(
                f"runs = {self.runs} are too few for these data and parameters", f"runs = {self.least_runs} or more"
            )
        case = self._work(self.space.corners, 0).variant(0)
        for each in self.simulations:
            each.check(case)

    def _work(self, corners: tuple[FloatArray, FloatArray], number: int) -> CalibrationEngine:
        """Return the simulations of a round."""
        logs = [path for path, is_log in zip(self.space.paths, self.space.is_log, strict=True) if is_log]
        design = random_design(self.space.ranges(*corners), self.runs, seed=self.seed + number, log=logs)
        grid = read_axes(self.case, design, source="parameters")
        return CalibrationEngine(self.case, grid, self.simulations, number * self.runs)

    def check_budget(self, budget: float | None) -> None:
        """Predict the time of all runs, and print it.

        `budget`: longest wall time [s].
        """
        if budget is None and self.progress is not True:
            return
        each, share = self._work(self.space.corners, 0).predict()
        samples = _ROUNDS * self.runs + self.checks
        cpu_time = each * samples / self.runs
        workers = workers_of(self.where["backend"], self.where["workers"])
        wall_time = cpu_time / share / max(1, min(workers, self.runs))
        line = (
            f"at most {samples} samples: about {duration(cpu_time)} of processor time, {duration(wall_time)} with "
            f"{several(workers, 'worker')}"
        )
        if budget is not None and wall_time > budget:
            raise Hint(
                f"budget = {duration(budget)} is less than predicted for {line}",
                f'budget = "{duration(1.2 * wall_time)}", fewer runs, fewer data, or more softening',
            )
        if budget is not None or wall_time > _SHOWN_FROM:
            announce(self.progress, f"calibrate: {line}")

    def result(self) -> xarray.Dataset:
        """Run all rounds and return the dataset of the result."""
        if self.store is not None:
            with exclusive_writer(self.store):  # marks the folder as that of a study
                pass
        corners = self.space.corners
        points, values = np.zeros((0, self.space.size)), np.zeros((0, self.measured.size))
        flags = np.zeros(0, np.int64)
        for number in range(_ROUNDS):
            work = self._work(corners, number)
            store = None if self.store is None else self.store / f"round_{number + 1}"
            found = run_work(Work(work), **self.where, store=store, progress=self.progress).load()
            columns = np.stack([found[path].values for path in self.space.paths], axis=-1)
            points = np.concatenate([points, self.space.points(columns)])
            values = np.concatenate([values, found.simulated.values])
            flags = np.concatenate([flags, found.warnings.values.astype(np.int64)])
            used = np.isfinite(values).all(axis=1)
            used &= ((points >= corners[0] - 1e-9) & (points <= corners[1] + 1e-9)).all(axis=1)
            self._check_missing(work, found.simulated.values, int(used.sum()))
            fit = Fit.of(self.space, corners, points[used], values[used], self.measured, self.error, self.sets)
            corners = fit.narrowed()
        self.warnings += fit.cut()
        checks = self._further_runs(fit.best)
        undetermined = list(fit.undetermined())
        warnings = [
            *undetermined,
            *fit.disagreement(),
            *self.warnings,
            *self._misfit(fit, checks),
            *self._unit_notes(),
            *_exceeded(flags),
        ]
        return self._dataset(fit, checks, points, values, flags).assign_attrs(
            undetermined=undetermined, warnings=warnings
        )

    def _check_missing(self, work: CalibrationEngine, values: FloatArray, used: int) -> None:
        """Raise if too many samples of a round have no value or too few are left, and warn if some have none."""
        missing = ~np.isfinite(values)
        bad = np.flatnonzero(missing.any(axis=1))
        if not bad.size:
            return
        line = (
            f"{bad.size} of {len(values)} samples have no simulated value, most often of "
            f"{self.points[int(np.argmax(missing.sum(axis=0)))]}"
        )
        reason = work.reason(int(bad[0])).replace("\n", "\n  ")
        if bad.size > _MOST_MISSING * len(values) or used < self.least_runs:
            raise Hint(
                f"{line}" + (f"; the first one: {reason}" if reason else ""),
                "a longer duration of the case, so that decays pass all amplitudes; or other amplitudes or ranges",
            )
        self.warnings.append(f"warning: {line}, and are left out" + (f": {reason}" if reason else ""))

    def _further_runs(self, best: FloatArray) -> FloatArray:
        """Return simulated values of further packings at the result, (C, M); NaN if fewer than two have values."""
        values = {path: [value] * self.checks for path, value in zip(self.space.paths, best.tolist(), strict=True)}
        grid = read_axes(self.case, {"sample": values}, source="parameters")
        work = CalibrationEngine(self.case, grid, self.simulations, _ROUNDS * self.runs)
        store = None if self.store is None else self.store / "checks"
        found: FloatArray = run_work(Work(work), **self.where, store=store, progress=self.progress).simulated.values
        complete = found[np.isfinite(found).all(axis=1)]
        if len(complete) < len(found):
            self.warnings.append(
                f"warning: {len(found) - len(complete)} of {len(found)} further packings have no value"
            )
        return complete if len(complete) > 1 else np.full((2, self.measured.size), np.nan)

    def _misfit(self, fit: Fit, checks: FloatArray) -> Iterator[str]:
        """Yield a warning if the surfaces differ from further packings at the result."""
        mean, own = checks.mean(axis=0), checks.std(axis=0, ddof=1) / math.sqrt(len(checks))
        total = np.sqrt(np.diag(fit.agreement.covariance))
        apart = np.abs(mean - fit.fitted)
        doubtful = np.flatnonzero((apart > 3 * own) & (apart > 0.5 * total))
        if doubtful.size:
            k = int(doubtful[np.argmax(apart[doubtful] / total[doubtful])])
            share = amount(float(apart[k] / abs(mean[k])), "%", 2)
            yield (
                f"warning: at the result the response surface differs by {share} from {len(checks)} further packings for "
                f"{self.points[k]}; try: narrower ranges around the result, or more runs"
            )

    def _unit_notes(self) -> Iterator[str]:
        for each in self.simulations:
            if each.data.unit is None:
                yield f"note: amplitude has no unit, m is assumed: the largest is {each.data.amplitude.max():.4g} m"

    # ---- result

    def _dataset(
        self, fit: Fit, checks: FloatArray, points: FloatArray, values: FloatArray, flags: NDArray[np.int64]
    ) -> xarray.Dataset:
        import xarray

        space = self.space
        data = {**self._fitted(fit, checks), **self._samples(values, flags), **self._profiles(fit)}
        return xarray.Dataset(data, self._coordinates(points)).assign_attrs(
            title="Calibration of contact parameters",
            case=self.case.to_toml(),
            chi2=fit.chi2,
            degrees_of_freedom=fit.freedom,
            p_value=fit.probability,
            samples=len(values),
            runs=self.runs,
            checks=self.checks,
            seed=self.seed,
            known=json.dumps(space.known),
            log=[path for path, is_log in zip(space.paths, space.is_log, strict=True) if is_log],
        )

    def _fitted(self, fit: Fit, checks: FloatArray) -> dict[str, Any]:
        """Return the parameters with their limits, and the data with their fitted values."""
        space, ends = self.space, fit.intervals
        return {
            "value": _variable("parameter", fit.best, "value"),
            "lower": _variable("parameter", ends[:, 0], "lower 95 % limit"),
            "upper": _variable("parameter", ends[:, 1], "upper 95 % limit"),
            "is_lower_bounded": _variable("parameter", fit.bounded[:, 0], "whether the data bound it below"),
            "is_upper_bounded": _variable("parameter", fit.bounded[:, 1], "whether the data bound it above"),
            "smallest": _variable("parameter", space.low, "smallest value of the range"),
            "largest": _variable("parameter", space.high, "largest value of the range"),
            "correlation": _variable(("parameter", "other"), fit.region.correlation, "correlation of two parameters"),
            "measured": _variable("datum", self.measured, "measured value"),
            "error": _variable("datum", self.error, "standard uncertainty of the measured value"),
            "fitted": _variable("datum", fit.fitted, "value of the response surface at the result"),
            "scatter": _variable("datum", fit.scatter, "standard deviation of a simulated value"),
            "check": _variable("datum", checks.mean(axis=0), "mean of further packings at the result"),
            "check_deviation": _variable("datum", checks.std(axis=0, ddof=1), "standard deviation of these packings"),
        }

    def _samples(self, values: FloatArray, flags: NDArray[np.int64]) -> dict[str, Any]:
        """Return the simulated values and the exceeded limits of all samples."""
        return {
            "simulated": _variable(("sample", "datum"), values, "simulated value"),
            "exceeded": _variable("sample", flags, "exceeded validity limits", **flag_masks(WARNINGS)),
        }

    def _coordinates(self, points: FloatArray) -> dict[str, Any]:
        """Return the names of the parameters, the data, and the values of the samples."""
        space = self.space
        coordinates: dict[str, Any] = {
            "parameter": space.paths,
            "other": space.paths,
            "unit": ("parameter", space.units),
            "measure": ("datum", [point.measure for point in self.points]),
            "amplitude": _variable("datum", [point.amplitude for point in self.points], "amplitude"),
            "amplitude_unit": ("datum", [point.unit for point in self.points]),
            "frequency": _variable("datum", [point.frequency for point in self.points], "frequency", units="Hz"),
            "data_set": _variable("datum", self.sets, "number of the measurement"),
        }
        for path, unit, column in zip(space.paths, space.units, space.values(points).T, strict=True):
            words = path.replace(".", " ").replace("_", " ")
            coordinates[path] = _variable("sample", column, words, units=unit)
        return coordinates

    def _profiles(self, fit: Fit) -> dict[str, Any]:
        """Return the profiles of all parameters, and the map of the first two."""
        region = fit.region
        lines = [np.linspace(axis[0], axis[-1], _PROFILE) for axis in region.axes]
        above = {"units": "1", "long_name": "chi^2 above its minimum"}
        found: dict[str, Any] = {
            "profile_value": (
                ("parameter", "place"),
                [fit.along(axis, line) for axis, line in enumerate(lines)],
                {"long_name": "value of the parameter"},
            ),
            "profile": (
                ("parameter", "place"),
                [np.interp(line, region.axes[axis], region.profile(axis)) for axis, line in enumerate(lines)],
                above,
            ),
            "threshold": ((), fit.threshold, above | {"long_name": "chi^2 above its minimum at the 95 % limits"}),
        }
        if self.space.size > 1:
            chi2 = region.chi2.reshape(*region.chi2.shape[:2], -1).min(axis=2) - region.chi2.min()
            steps = [np.linspace(0, axis.size - 1, _MAP).round().astype(int) for axis in region.axes[:2]]
            found["region"] = ("first", "second"), chi2[np.ix_(*steps)], above
            for axis, name in enumerate(("first", "second")):
                about = {"units": self.space.units[axis], "long_name": self.space.paths[axis]}
                found[f"{name}_value"] = name, fit.along(axis, region.axes[axis][steps[axis]]), about
        return found


def _variable(dims: str | tuple[str, ...], values: object, long_name: str, **attributes: str) -> Any:
    """Return a variable of a dataset."""
    return dims, values, {"long_name": long_name, **attributes}


def _exceeded(flags: NDArray[np.int64]) -> Iterator[str]:
    """Yield warnings about validity limits that runs exceeded."""
    for bit, (name, text) in enumerate(WARNINGS.items()):
        if count := int(np.count_nonzero(flags & 2**bit)):
            yield f"warning: {count} of {flags.size} samples exceed a limit, {name}: {text}"


# ---- call


KIND = "calibrate"
"""Kind of the result in its attribute `study`."""


def calibrate(
    data: Contacts | Losses | Sequence[Contacts] | Sequence[Losses],
    case: Case | None = None,
    parameters: Mapping[str, tuple[Any, Any]] | None = None,
    *,
    known: Mapping[str, tuple[float, float]] | None = None,
    runs: int = 64,
    checks: int = 8,
    log: Sequence[str] = (),
    seed: int = 0,
    budget: object = None,
    workers: int | None = None,
    backend: object = "threads",
    store: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> xarray.Dataset:
    r"""Calibrate contact parameters from measurements: values with 95 % intervals.

    `Drops` and `BounceTimes` give the restitution in closed form and need no case. `RingDown` and `ShakerLoss` are compared
    with simulations of a case over one to three of its parameters.

    Parameters
    ----------
    data
        One measurement, or several of single impacts, or several of losses.
    case
        Case with the damper of the measurement. Loads are ignored. For a ring-down with its structure, including the damping
        without particles; its duration is the length of a simulated decay. For losses on a shaker the structure is ignored.
    parameters
        Pairs (smallest, largest) by path: {"damper.contact.restitution": (0.5, 0.95), "damper.friction": (0.0, 0.6)}.
    known
        Parameters that are known from elsewhere: value and half of the width of its 95 % interval, by path, as
        {"damper.contact.restitution": (0.80, 0.02)}.
    runs
        Number of samples of the parameters in each of up to two rounds. Each has a random packing, or start, of its own.
    checks
        Number of further packings that are simulated at the result.
    log
        Paths whose range is sampled uniformly in the logarithm.
    seed
        Random seed of the samples.
    budget
        Longest predicted wall time, such as "10 min"; if more is predicted, nothing runs.
    workers, backend
        See `rb.sweep`.
    store
        Folder for the runs. The same call resumes after a stop.
    progress
        True for a progress bar after 2 s, False for none, or a function of the number of finished samples and of all; the
        calibration stops if it returns False. With True, the predicted time is printed if it is above 2 s or a budget is
        given.

    Returns
    -------
    xarray.Dataset
        Over `parameter`: `value`, `lower` and `upper` limit of the 95 % interval, in the SI `unit`; `attrs["warnings"]`
        lists what limits their use. From single impacts also, over `impact`: `approach_speed` [m/s], `restitution` and the
        number `data_set` of its measurement; `exponent` of a power law over the speed, with half of its interval.
        From losses also `is_lower_bounded` and `is_upper_bounded`, whether the data bound a parameter within its range;
        `correlation` over `parameter` and `other`; over `datum`: `measured` with its standard uncertainty `error`, `fitted`
        by the response surface, `check` and `check_deviation` of the further packings, and `scatter` of one packing; over
        `sample`: `simulated`, and the parameters; over `parameter` and `place`: `profile`, chi^2 above its minimum; and
        `region`, the same over the first two parameters. Attributes: `chi2`, `degrees_of_freedom` and `p_value` of the fit;
        `undetermined`, which parameters the data do not determine or separate.

    Raises
    ------
    CaseError
        If an argument is not valid, there are fewer than two data or fewer data than parameters, more than half of the
        runs have no value, or the predicted time exceeds the budget.
    StoreError
        If the store holds another study.
    Stopped
        After Ctrl-C.

    Notes
    -----
    Restitution from heights is sqrt(h_1/h_0), and from flights T_2/T_1; the interval is that of Student's t.

    For losses, a polynomial of first to third degree in the parameters (the degree with the smallest leave-one-out error) is
    fitted to the simulated values of each datum, and

    .. math:: \chi^2 = (y - f)^T (D + S)^{-1} (y - f)

    with the measured values y, the polynomials f, the variances D of the measurement, and the covariance S of the
    leave-one-out errors, which contain the scatter of random packings: the measured damper is one of them. The interval of a
    parameter holds the values at which the smallest chi^2 over all other parameters is above its minimum by less than the
    95 % quantile of F(1, n). S is scaled so that its inverse is unbiased (Hartlap et al.). The uncertainties of the data are
    assumed to be independent of each other.

    The model of the case is assumed to be right in all else: size and number of particles, cavity, damping of the structure.
    Their errors are in the result. Effective values of friction and restitution at the speeds of the measurement follow.

    References
    ----------
    G. E. P. Box, K. B. Wilson (1951), On the experimental attainment of optimum conditions, Journal of the Royal Statistical
    Society B 13, 1-45, doi:10.1111/j.2517-6161.1951.tb00067.x (response surface).
    D. M. Allen (1974), The relationship between variable selection and data augmentation and a method for prediction,
    Technometrics 16, 125-127, doi:10.1080/00401706.1974.10489157 (leave-one-out errors).
    J. Hartlap, P. Simon, P. Schneider (2007), Why your model parameter confidences might be too optimistic, Astronomy &
    Astrophysics 464, 399-404, doi:10.1051/0004-6361:20066170 (inverse of an estimated covariance).
    D. J. Venzon, S. H. Moolgavkar (1988), A method for computing profile-likelihood-based confidence intervals, Journal of
    the Royal Statistical Society C 37, 87-94, doi:10.2307/2347496.

    Examples
    --------
    >>> import rattlebox as rb
    >>> drops = rb.Drops(height="300 mm", rebound=["192 mm", "189 mm", "194 mm", "188 mm", "191 mm"])
    >>> result = rb.calibrate(drops)
    >>> f"{result.value.item():.3f} ({result.lower.item():.3f} to {result.upper.item():.3f})"
    '0.797 (0.791 to 0.804)'
    """
    contacts, losses = read_data(data)
    if contacts:
        for name, value in {"case": case, "parameters": parameters, "known": known, "store": store}.items():
            if value is not None:
                raise Hint("drops and bounces give the restitution without simulations", f"no {name}", [name])
        return restitution_of(contacts).assign_attrs(study=KIND, data=[source_of(each) for each in contacts])
    if not isinstance(case, Case) or not case.dampers:
        raise Hint(
            "losses are compared with simulations, which need a case with a damper",
            "rb.calibrate(data, case, parameters)",
            ["case"],
        )
    refuse_stops(case.stops, "losses are those of a damper on a shaker", "the case without stops")
    calibration = Calibration(
        case=case,
        space=Space.of(case, parameters, log, known),
        simulations=[simulation_of(each, case) for each in losses],
        runs=whole_number(runs, "runs", 1),
        checks=whole_number(checks, "checks", 2),
        seed=whole_number(seed, "seed", 0),
        where={"backend": backend, "workers": workers},
        store=None if store is None else Path(store),
        progress=progress,
    )
    calibration.validate()
    calibration.check_budget(None if budget is None else _seconds(budget))
    result = calibration.result().assign_attrs(data=[source_of(each) for each in losses])
    return save_result(result, KIND, store)


def _seconds(budget: object) -> float:
    """Return the budget [s]."""
    with at("budget"):
        seconds, _ = parse(budget, ("s",))
        if not seconds > 0:
            raise Hint(f"{seconds:g} s is not greater than zero", '"10 min"')
    return seconds
