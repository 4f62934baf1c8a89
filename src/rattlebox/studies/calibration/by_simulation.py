"""Calibration by simulations over the parameters: rounds of runs, fit, checks, result."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.progress import announce
from rattlebox._util.quantities import amount
from rattlebox.model.errors import Hint, several
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.studies.calibration.fit import Fit
from rattlebox.studies.calibration.response_surface import least_points
from rattlebox.studies.calibration.work import CalibrationWork, Point, Simulation
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.grid.sampling import random_design
from rattlebox.studies.run.budget import duration, workers_of
from rattlebox.studies.run.runner import run_work
from rattlebox.studies.run.store import exclusive_writer

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case
    from rattlebox.studies.calibration.space import Space

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

    def _work(self, corners: tuple[FloatArray, FloatArray], number: int) -> CalibrationWork:
        """Return the simulations of a round."""
        logs = [path for path, is_log in zip(self.space.paths, self.space.is_log, strict=True) if is_log]
        design = random_design(self.space.ranges(*corners), self.runs, seed=self.seed + number, log=logs)
        grid = read_axes(self.case, design, source="parameters")
        return CalibrationWork(self.case, grid, self.simulations, number * self.runs)

    def check_budget(self, budget: float | None) -> None:
        """Predict the time of all runs, and print it.

        Parameters
        ----------
        budget
            Longest wall time [s].
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
            found = run_work(work, **self.where, store=store, progress=self.progress).load()
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

    def _check_missing(self, work: CalibrationWork, values: FloatArray, used: int) -> None:
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
        work = CalibrationWork(self.case, grid, self.simulations, _ROUNDS * self.runs)
        store = None if self.store is None else self.store / "checks"
        found: FloatArray = run_work(work, **self.where, store=store, progress=self.progress).simulated.values
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
        ends = fit.intervals

        def of(dims: Any, numbers: Any, long_name: str) -> tuple[Any, Any, dict[str, str]]:
            return dims, numbers, {"long_name": long_name}

        data: dict[str, Any] = {
            "value": of("parameter", fit.best, "value"),
            "lower": of("parameter", ends[:, 0], "lower 95 % limit"),
            "upper": of("parameter", ends[:, 1], "upper 95 % limit"),
            "is_lower_bounded": of("parameter", fit.bounded[:, 0], "whether the data bound it below"),
            "is_upper_bounded": of("parameter", fit.bounded[:, 1], "whether the data bound it above"),
            "smallest": of("parameter", space.low, "smallest value of the range"),
            "largest": of("parameter", space.high, "largest value of the range"),
            "correlation": of(("parameter", "other"), fit.region.correlation, "correlation of two parameters"),
            "measured": of("datum", self.measured, "measured value"),
            "error": of("datum", self.error, "standard uncertainty of the measured value"),
            "fitted": of("datum", fit.fitted, "value of the response surface at the result"),
            "scatter": of("datum", fit.scatter, "standard deviation of a simulated value"),
            "check": of("datum", checks.mean(axis=0), "mean of further packings at the result"),
            "check_deviation": of("datum", checks.std(axis=0, ddof=1), "standard deviation of these packings"),
            "simulated": of(("sample", "datum"), values, "simulated value"),
            "exceeded": (
                "sample",
                flags,
                {"long_name": "exceeded validity limits", "flag_meanings": " ".join(WARNINGS)},
            ),
            **self._profiles(fit),
        }
        coords: dict[str, Any] = {
            "parameter": space.paths,
            "other": space.paths,
            "unit": ("parameter", space.units),
            "measure": ("datum", [point.measure for point in self.points]),
            "amplitude": of("datum", [point.amplitude for point in self.points], "amplitude"),
            "amplitude_unit": ("datum", [point.unit for point in self.points]),
            "frequency": (
                "datum",
                [point.frequency for point in self.points],
                {"units": "Hz", "long_name": "frequency"},
            ),
            "data_set": of("datum", self.sets, "number of the measurement"),
        }
        for path, unit, column in zip(space.paths, space.units, space.values(points).T, strict=True):
            coords[path] = ("sample", column, {"units": unit, "long_name": path.replace(".", " ").replace("_", " ")})
        return xarray.Dataset(data, coords).assign_attrs(
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


def _exceeded(flags: NDArray[np.int64]) -> Iterator[str]:
    """Yield warnings about validity limits that runs exceeded."""
    for bit, (name, text) in enumerate(WARNINGS.items()):
        if count := int(np.count_nonzero(flags & 2**bit)):
            yield f"warning: {count} of {flags.size} samples exceed a limit, {name}: {text}"
