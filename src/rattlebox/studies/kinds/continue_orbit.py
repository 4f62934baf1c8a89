"""Branches of periodic motions as studies: search of a motion of a case, and its continuation along a parameter."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox._util.exceptions import DataError
from rattlebox._util.interrupts import raise_if_pressed
from rattlebox._util.progress import progress_bar
from rattlebox.engines.continued import read_start
from rattlebox.model.errors import Hint
from rattlebox.model.units import Number
from rattlebox.results.run import Run
from rattlebox.studies.grid.starts import StartPoint
from rattlebox.studies.orbits.branch import Branch
from rattlebox.studies.orbits.branch_data import LONGEST_STEP, MOST_POINTS, STUDY, corrector_of, start_value
from rattlebox.studies.orbits.continuation import continue_orbit
from rattlebox.studies.orbits.find import check_state, find_orbit, state_of
from rattlebox.studies.orbits.orbit import Orbit
from rattlebox.studies.run.estimate import Estimate
from rattlebox.studies.run.result_file import read_file
from rattlebox.studies.run.runner import Stopped
from rattlebox.studies.run.store import open_whole, save_result
from rattlebox.studies.run.stored import has_map, open_study
from rattlebox.studies.run.study import CONFIG, Count, Study, study_function

if TYPE_CHECKING:
    import xarray

_PROBED = 8
"""Number of points from which the time of a branch is predicted."""
_FACTOR = 3.0
"""Factor within which it is expected: where a branch turns, its steps are shorter and its points more."""


@dataclass(frozen=True, config=CONFIG)
class ContinueOrbit(Study):
    """Find a periodic motion of a case and follow it along a parameter, as `rb.continue_orbit` does.

    Parameters
    ----------
    case
        Case with harmonic loads or base motions of one common period, and impact dampers or stops.
    axis
        Path of the parameter, as for `rb.continue_orbit`.
    limits
        Smallest and largest value of the parameter.
    near
        Where the search of the first motion begins, as for `rb.find_orbit`: a run or its file, or a state. Default: a run of
        the case.
    period
        Period of the first motion in periods of the loads.
    points
        Largest number of points in each of both directions.
    step
        Longest step, as part of the range of the parameter and of the size of the motion.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.run.study.Study`. A branch is computed point after point, on one core.

    Returns
    -------
    xarray.Dataset
        Data of the branch, see `rb.Branch`.

    Raises
    ------
    CaseError
        If an argument is not valid for the case, or no periodic motion is found.
    """

    kind: ClassVar[str] = STUDY
    figure: ClassVar[str] = "rattlebox.plots.branches:plot_branches"
    report: ClassVar[str] = "rattlebox.report.kinds.branch:KIND"
    files: ClassVar[tuple[str, ...]] = ("near",)

    axis: Annotated[str, Field(examples=["load.frequency"])]
    limits: Annotated[Any, Field(examples=[["20 Hz", "40 Hz"]])]
    _: KW_ONLY
    near: Any = None
    period: Count | None = None
    points: Count = MOST_POINTS
    step: Number = LONGEST_STEP

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        corrector, unit = corrector_of(self.case, self.axis, self._limits, self.step)
        start_value(self.case, self.axis, corrector, unit)
        start = self._start
        if isinstance(start, np.ndarray):
            check_state(corrector.returns, start)

    def compute(self) -> xarray.Dataset:
        """Find the motion and follow it; see `Study.compute`."""
        with open_whole(self.kind, self.store, self._manifest) as so_far:
            if so_far is not None and has_map(self.store):
                return open_study(self.store).load()
            if so_far is not None and so_far.exists():
                try:
                    read_file(so_far)
                except DataError:  # a damaged part of the result counts as not computed
                    so_far.unlink()
            with self._stoppable() as proceed:
                found = self._follow(self._find(), store=so_far, progress=proceed).data
        # What belongs to the resumption is not part of the result.
        for name in ("request", "finished_sides", "reasons"):
            found.attrs.pop(name, None)
        result = save_result(found, self.kind, self.store)
        if so_far is not None:
            so_far.unlink(missing_ok=True)
        return result

    def predict(self) -> Estimate:
        """Return the estimate from a few points; see `Study.estimate`."""
        begun = time.process_time()
        orbit = self._find()
        found = time.process_time()
        near = self._follow(orbit, progress=lambda done, _: done <= _PROBED)
        each = (time.process_time() - found) / max(len(near), 1)
        # At the distance of the last points; the first ones are closer, and the branch may turn back.
        last = np.abs(np.diff(near.data.value.values))[-1] / np.diff(near.data.attrs["limits"])[0]
        points = min(2 * self.points, round(1 / max(last, 1e-9)))
        total = found - begun + each * points
        return Estimate(0, points, total, total, 1, _FACTOR, "point")

    def _find(self) -> Orbit:
        """Return the motion from which the continuation starts."""
        try:
            return find_orbit(self.case, self._start, period=self.period)
        except Hint:
            raise_if_pressed()  # Ctrl-C has ended the run of the case
            raise

    def _follow(self, orbit: Orbit, **where: Any) -> Branch:
        return continue_orbit(orbit, self.axis, self._limits, points=self.points, step=self.step, **where)

    @contextmanager
    def _stoppable(self) -> Iterator[Any]:
        """Yield a function that reports points, and convert an interruption to `Stopped` with the way to resume."""
        done = 0
        try:
            with progress_bar(self.progress, "points") as report:

                def proceed(count: int, total: int) -> None:
                    nonlocal done
                    done = count
                    report.advance(count, total)

                yield proceed
        except KeyboardInterrupt:
            if self.store is None:
                raise Stopped(f"stopped after {done:,} points, which are lost; use a store to resume") from None
            where = f"the points so far are in {os.fspath(self.store)}, and the same command resumes from there"
            raise Stopped(f"stopped after {done:,} points; {where}") from None

    @cached_property
    def _limits(self) -> Any:
        """Limits as a pair, also of a table `{ from = ..., to = ... }`."""
        if not isinstance(self.limits, Mapping):
            return self.limits
        if set(self.limits) != {"from", "to"}:
            raise Hint(f"limits = {self.limits!r:.60} must be two values", '{ from = "20 Hz", to = "40 Hz" }')
        return self.limits["from"], self.limits["to"]

    @cached_property
    def _start(self) -> Any:
        """Run, state or motion near which the search begins."""
        if self.near is None or isinstance(self.near, (Run, Orbit)):
            return self.near
        return read_start(self.near)[0] if isinstance(self.near, (str, os.PathLike)) else state_of(self.near)

    @property
    def _manifest(self) -> dict[str, Any]:
        """Description that distinguishes this study from others."""
        start = self._start
        if isinstance(start, Run):
            start = StartPoint(start, None, "").describe()
        elif isinstance(start, Orbit):
            start = {"phase": start.phase, "state": start.state.tolist()}
        elif start is not None:
            start = start.tolist()
        corrector, _ = corrector_of(self.case, self.axis, self._limits, self.step)
        return {
            "case": self.case.to_toml(),
            "axis": self.axis,
            "limits": list(corrector.limits),
            "near": start,
            "period": self.period,
            "points": self.points,
            "step": self.step,
        }


study_function(ContinueOrbit)
