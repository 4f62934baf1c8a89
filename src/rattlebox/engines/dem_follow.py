"""Follows a run with particles to its end, and stops now and then to keep its state or to look at the particles."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

from rattlebox._util.exceptions import DataError
from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.engines.checkpoint import Checkpoint, Kept, joined
from rattlebox.model.methods import Dem
from rattlebox.results.snapshots import SnapshotFile

USUAL = 600.0
"""Time between checkpoints [s]."""


class Journey:
    """A run on its way.

    Parameters
    ----------
    dem
        The core.
    packed
        What the core was given.
    checkpoint
        Where the state is kept, if anywhere.
    method
        Tells how often.
    """

    def __init__(self, dem: _core.Dem, packed: _core.DemProblem, checkpoint: Checkpoint | None, method: Dem) -> None:
        self.checkpoint = checkpoint
        self._dem, self._packed = dem, packed
        every = method.checkpoint_every
        self._steps = None if every is None else max(1, round(every / packed.dt))  # between checkpoints
        self._interval = math.inf if every else method.checkpoint or USUAL
        self._due = time.monotonic() + self._interval
        self._pieces: list[_core.Records] = []
        self._earlier = 0.0
        self._snapshots: SnapshotFile | None = None
        self._shots: list[int] = []

    def resume(self, kept: Kept) -> None:
        """Continue from a checkpoint.

        Raises
        ------
        DataError
            When its state cannot be one of this case.
        """
        try:
            self._dem.restore(kept.state)
        except ValueError as error:
            path = self.checkpoint.path if self.checkpoint else "the checkpoint"
            raise DataError(
                f"{path} is damaged: {error}; the state of the core must be one that it has written\n"
                "  try: a copy of it, or remove it and run from the start"
            ) from None
        self._pieces = [kept.records]
        self._earlier = kept.seconds

    def watch(self, snapshots: SnapshotFile, shots: Sequence[int]) -> None:
        """Take snapshots at these steps; those of a run that goes on are in the file, up to where it goes on from.

        Raises
        ------
        DataError
            When they are not, or the file is something else.
        """
        self._snapshots, self._shots = snapshots, list(shots)
        before = sum(shot + 1 < self._dem.step for shot in shots)
        if not before:
            snapshots.create()
            return
        wrong = f"{snapshots.path} does not hold the {before} snapshots before the checkpoint"
        try:
            if snapshots.taken >= before:
                return
        except DataError as error:
            wrong = str(error).partition("\n  try: ")[0]
        raise DataError(
            f"{wrong}\n  try: put the file back and leave output.snapshots as it was, or remove the checkpoint to begin anew"
        )

    @property
    def seconds(self) -> float:
        """Computing time so far [s], that before a restart included."""
        return self._earlier + self._dem.counts().seconds

    def records(self) -> _core.Records:
        """Samples so far."""
        self._pieces = [joined([*self._pieces, self._dem.records()])]
        return self._pieces[0]

    def go(self, progress: Callable[[int, int], object] | None = None) -> Status:
        """Run to the end; Ctrl-C ends the run with a status.

        Parameters
        ----------
        progress
            Called now and then with the number of steps done and of all; False stops the run, as Ctrl-C does.

        Returns
        -------
        Status
            How the run ended.
        """
        last = self._packed.steps
        try:
            if self._dem.step == 0:
                self._keep()
            finished = self._through([k for k in self._shots if k + 1 >= self._dem.step], last, progress)
        except KeyboardInterrupt:
            finished = False
        if self._dem.step == 0:  # a run shows at least how it began, however early it was stopped
            self._dem.run(0)
        self._keep()
        return self._dem.status if finished or self._dem.status else Status.interrupted

    def _through(self, shots: Sequence[int], last: int, progress: Callable[[int, int], object] | None) -> bool:
        """Run to each snapshot and to the end."""
        for shot in [*shots, None]:
            if not self._run(last if shot is None else shot, last, progress):
                return False
            if shot is not None and self._snapshots is not None and not self._dem.status:
                cavities = self._dem.state().cavities
                contacts = [self._dem.contacts(k) for k in range(len(cavities))]
                self._snapshots.take(self._shots.index(shot), cavities, contacts)
        return True

    def _run(self, until: int, last: int, progress: Callable[[int, int], object] | None) -> bool:
        """Run until a step is done, with checkpoints on the way."""
        stopped = False

        def go_on(done: int) -> bool:
            nonlocal stopped
            stopped = progress is not None and progress(done, last) is False
            return not stopped and (self.checkpoint is None or time.monotonic() < self._due)

        while True:
            goal = until if self._steps is None else min(until, self._next(self._steps))
            reached = self._dem.run(goal, go_on)
            if reached and (goal == last or self._dem.status):
                return True
            in_time = reached and go_on(self._dem.step)  # a piece may be too short for the core to ask
            if stopped:
                return False
            if goal < until or not in_time:
                self._keep()
            if reached and goal == until:
                return True

    def _next(self, steps: int) -> int:
        """Step after which the next checkpoint is due, one every so many steps."""
        return int(self._dem.step // steps + 1) * steps - 1

    def _keep(self) -> None:
        """Keep the state; but what went wrong would go wrong again: the state before is then the one to look at."""
        if self.checkpoint is not None and not self._dem.status:
            if self._snapshots is not None:
                self._snapshots.sync()  # a checkpoint needs the snapshots before it, also after a power cut
            self.checkpoint.write(self._dem, self._packed, self.records(), self.seconds)
            self._due = time.monotonic() + self._interval
