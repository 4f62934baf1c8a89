"""Advance a particle run to its end, with checkpoints and snapshots on the way."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError
from rattlebox._util.interrupts import raise_if_pressed
from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.engines.checkpoint import Checkpoint, CheckpointData, concatenate
from rattlebox.engines.end_state import EndState
from rattlebox.model.methods import Dem
from rattlebox.results.snapshots import SnapshotFile

CHECKPOINT_INTERVAL = 600.0
"""Default computing time between checkpoints [s]."""


class DemRun:
    """A particle run in progress."""

    def __init__(self, dem: _core.Dem, packed: _core.DemProblem, checkpoint: Checkpoint | None, method: Dem) -> None:
        self.checkpoint = checkpoint
        self.dem, self.packed = dem, packed
        every = method.checkpoint_every
        self._steps = None if every is None else max(1, round(every / packed.dt))  # between checkpoints
        self._interval = math.inf if every else method.checkpoint or CHECKPOINT_INTERVAL
        self._due = time.monotonic() + self._interval
        self._pieces: list[_core.Records] = []
        self._earlier_seconds = 0.0
        self._snapshots: SnapshotFile | None = None
        self._snapshot_steps: list[int] = []
        self.is_continued = False

    def resume_from(self, data: CheckpointData) -> None:
        """Restore the state of a checkpoint."""
        try:
            self.resume(data.state, data.records, data.seconds)
        except ValueError as error:
            path = self.checkpoint.path if self.checkpoint else "the checkpoint"
            raise DataError(
                f"{path} is damaged: {error}; its state must be one that the core wrote",
                "a copy of the file, or remove it and run from the start",
            ) from None

    def resume(self, state: NDArray[np.uint8], records: _core.Records, seconds: float) -> None:
        """Restore a state of this run, with the samples and the computing time [s] up to there."""
        self.dem.restore(state)
        self._pieces = [records]
        self._earlier_seconds = seconds

    def continue_from(self, end: EndState, time: float, *, is_same: bool = False) -> None:
        """Start from the end of another run, whose last sample is the first one of this run, at a time [s].

        Parameters
        ----------
        is_same
            Whether case and time step are those of that run.
        """
        self.is_continued = True
        if is_same:
            self.dem.restart(end.state)
        else:
            self.dem.continue_from(end.state, end.dt)
        packed = self.packed
        walls = sum(len({wall.label for wall in cavity.walls}) for cavity in packed.cavities if packed.each_wall)
        self._pieces = [end.sample(time, len(packed.loads), walls, keeps_sums=is_same)]

    def add_snapshots(self, snapshots: SnapshotFile, steps: Sequence[int]) -> None:
        """Take snapshots at the given steps. Those before a resumed checkpoint must already be in the file."""
        self._snapshots, self._snapshot_steps = snapshots, list(steps)
        # A file that lacks snapshots from before the checkpoint could never be completed.
        before = sum(step + 1 < self.dem.step for step in steps)
        if not before:
            snapshots.create()
            return
        wrong = f"{snapshots.path} does not hold the {before} snapshots before the checkpoint"
        try:
            if snapshots.written >= before:
                return
        except DataError as error:
            wrong = error.without_suggestion
        raise DataError(wrong, "put the file and output.snapshots back, or remove the checkpoint to start again")

    @property
    def seconds(self) -> float:
        """Computing time so far [s], including the time before a restart."""
        return self._earlier_seconds + self.dem.counts().seconds

    def records(self) -> _core.Records:
        """Samples so far."""
        self._pieces = [concatenate([*self._pieces, self.dem.records()])]
        return self._pieces[0]

    def end(self) -> EndState:
        """Return the state that the run has reached."""
        return EndState.of(self.dem, self.packed, self.records())

    def run(self, progress: Callable[[int, int], object] | None = None, last: int | None = None) -> Status:
        """Run to the end, or to the step `last`. Ctrl-C ends the run with the status `interrupted`."""
        last = self.packed.steps if last is None else last
        try:
            if self.dem.step == 0:
                self._write_checkpoint()
            finished = self._run_to_end(last, progress)
        except KeyboardInterrupt:
            finished = False
        # A run that was stopped before its first step still returns the sample at its start.
        if self.dem.step == 0:
            self.dem.run(0)
        self._write_checkpoint()
        raise_if_pressed()  # of a study, of which this run is a part
        return self.dem.status if finished or self.dem.status else Status.interrupted

    def _run_to_end(self, last: int, progress: Callable[[int, int], object] | None) -> bool:
        """Run to the end and take the remaining snapshots; return False if the run was stopped."""
        for number, step in enumerate(self._snapshot_steps):
            if step + 1 < self.dem.step:
                continue
            if not self._run_until(step, last, progress):
                return False
            if self._snapshots is not None and not self.dem.status:
                cavities = self.dem.state().cavities
                contacts = [self.dem.contacts(k) for k in range(len(cavities))]
                self._snapshots.append(number, cavities, contacts)
        return self._run_until(last, last, progress)

    def _run_until(self, until: int, last: int, progress: Callable[[int, int], object] | None) -> bool:
        """Run until a step is done, and write the checkpoints that are due; return False if the run was stopped."""
        # The core calls `proceed` every few steps; False ends its loop, for a checkpoint that is due or at the user's wish.
        stopped = False

        def proceed(done: int) -> bool:
            nonlocal stopped
            stopped = progress is not None and progress(done, last) is False
            return not stopped and (self.checkpoint is None or time.monotonic() < self._due)

        while True:
            # Checkpoints in simulated time are at fixed steps, so that a run that resumes has the same ones.
            goal = until
            if self._steps is not None:
                goal = min(goal, (self.dem.step // self._steps + 1) * self._steps - 1)
            reached = self.dem.run(goal, proceed)
            if reached and (goal == last or self.dem.status):
                return True
            in_time = reached and proceed(self.dem.step)  # the core does not call `proceed` in a short part
            if stopped:
                return False
            # A stop for a checkpoint: write it and go on. The last step of the run needs none; `run` writes it.
            if goal < until or not in_time:
                self._write_checkpoint()
            if reached and goal == until:
                return True

    def _write_checkpoint(self) -> None:
        """Write a checkpoint unless the run has failed: the last state before the failure is then more useful."""
        if self.checkpoint is not None and not self.dem.status:
            if self._snapshots is not None:
                self._snapshots.sync()  # a checkpoint needs the snapshots before it, also after a power cut
            self.checkpoint.write(self.dem, self.packed, self.records(), self.seconds)
            self._due = time.monotonic() + self._interval
