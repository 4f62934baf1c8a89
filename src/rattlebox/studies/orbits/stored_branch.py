"""File of a branch in progress, from which the continuation resumes."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox.studies.orbits.branch import Branch
from rattlebox.studies.orbits.branch_data import data_of
from rattlebox.studies.orbits.corrector import Point
from rattlebox.studies.orbits.follow import Follower, Restart
from rattlebox.studies.orbits.orbit import Orbit
from rattlebox.studies.run.result_file import write_file

_EVERY = 50
"""Number of points after which the file is written."""


def request_of(orbit: Orbit, axis: str, limits: tuple[float, float], points: int, step: float) -> str:
    """Return a digest of what determines a branch."""
    numbers = [*limits, points, step, orbit.cycles, orbit.phase, *(float(f"{value:.6e}") for value in orbit.state)]
    return hashlib.sha256(json.dumps([orbit.case.to_toml(), axis, numbers]).encode()).hexdigest()


@dataclass
class BranchFile:
    """Sides of a branch: points after and before the start, written to a file if there is one."""

    follower: Follower
    start: Point
    axis: str
    unit: str
    options: dict[str, float]
    path: Path | None = None
    request: str = ""
    sides: tuple[list[Point], list[Point]] = field(default_factory=lambda: ([], []))
    finished: int = 0  # number of finished sides
    loop: list[float] = field(default_factory=list)  # number of points of the side and state of the loop after them
    restart: Restart | None = None
    written: int = 0

    def resume(self, path: str | os.PathLike[str] | None, request: str) -> Branch | None:
        """Use a file; return its branch if it is complete, and restore the points of one in progress."""
        if path is None:
            return None
        self.path, self.request = Path(path), request
        if not self.path.exists():
            return None
        branch = Branch.load(self.path)
        if branch.data.attrs.get("request") != request:
            raise DataError(
                f"{self.path} is the branch of another motion, parameter or range", "another file, or remove it"
            )
        self.finished = int(branch.data.attrs["finished_sides"])
        if self.finished == 2:
            return branch
        self.follower.reasons[:] = json.loads(branch.data.attrs["reasons"])
        begin, loop = int(branch.data.attrs["start"]), json.loads(branch.data.attrs["loop"])
        self._restore(branch, range(begin + 1, len(branch)), 0)
        self._restore(branch, range(begin - 1, -1, -1), 1)
        row = self.sides[self.finished]
        if loop and len(row) >= loop[0]:
            # Points after the last restart are the beginning of a step that was not finished.
            del row[int(loop[0]) :]
            if row:
                length, count, tiny, has_before = loop[1:]
                before = [self.start, *(each for each in row[:-1] if not each.special)][-1] if has_before else None
                self.restart = Restart(row[-1], before, length, int(count), int(tiny))
        else:
            row.clear()
        return None

    def _restore(self, branch: Branch, rows: Iterable[int], side: int) -> None:
        """Restore the points of a side from their states."""
        corrector, last = self.follower.corrector, self.start
        for k in rows:
            row = branch.data.isel(point=k)
            returns = corrector.returns.with_(phase=float(row.phase))
            state, value = np.ascontiguousarray(row.state.values, dtype=float), float(row.value)
            before = branch.data.isel(point=k - 1 if side == 0 else k + 1)
            change = (state - before.state.values) / last.scale
            guide, scale = np.append(change, (value - float(before.value)) / corrector.width), last.scale
            if float(before.phase) != float(row.phase):  # states of different phases have no difference
                moved = corrector.resection(last)
                guide, scale = moved.tangent, moved.scale
            shot = returns.shoot(state[None], [value])
            point = corrector.finish(returns, state, value, shot, scale, guide) if shot.is_complete else None
            if point is None:
                return
            last = replace(
                point,
                special=str(row.special.item()),
                located=float(row.located),
                passage=str(row.passage.item()),
            )
            self.sides[side].append(last)

    def collect(self, side: int, most: int, proceed: Callable[[], bool]) -> None:
        """Follow a side to its end."""
        row, follower = self.sides[side], self.follower

        def goes_on() -> bool:
            # All points that the loop has made are in the row now, so that it can restart after them.
            self.loop = [len(row), *follower.loop]
            if len(row) >= self.written + _EVERY:
                self.write()
                self.written = len(row)
            return proceed()

        restart, self.restart, self.written = self.restart, None, len(row)
        # The other side of a closed curve may have ended anywhere on it, because of its number of points.
        other_end = next(iter(self.sides[0][-1:]), None) if side == 1 else None
        for point in follower.follow(self.start, most, goes_on, restart, other_end):
            row.append(point)

    def branch(self) -> Branch:
        """Return the branch so far."""
        after, before = self.sides
        row = [*before[::-1], self.start, *after]
        data = data_of(row, self.start.orbit.case, self.axis, self.unit, self.follower)
        about: dict[str, object] = {**self.options, "start": len(before)}
        if self.path is not None:
            # The reason of a side in progress is that it was stopped.
            reasons = json.dumps(self.follower.reasons[: self.finished])
            about |= {"request": self.request, "finished_sides": self.finished, "reasons": reasons}
            about["loop"] = json.dumps(self.loop)
        return Branch(data.assign_attrs(about))

    def write(self) -> None:
        """Write the points so far."""
        if self.path is not None:
            write_file(self.branch().data, self.path, replace=True)
