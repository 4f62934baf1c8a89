"""Follows a run with particles to its end, and stops now and then to keep its state or to look at the particles."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from rattlebox.engines.checkpoint import Checkpoint, Kept, joined
from rattlebox.engines.status import INTERRUPTED
from rattlebox.results.snapshots import SnapshotFile

Records = dict[str, NDArray[Any]]

USUAL = 600.0
"""Time between checkpoints [s]."""


@dataclass
class Journey:
    """A run on its way.

    Parameters
    ----------
    dem
        The core.
    packed
        What the core was given.
    checkpoint, interval
        Where the state is kept, if anywhere, and how often [s].
    snapshots, shots
        Where snapshots are kept, if anywhere, and at which steps.
    """

    dem: Any
    packed: Mapping[str, Any]
    checkpoint: Checkpoint | None = None
    interval: float = USUAL
    snapshots: SnapshotFile | None = None
    shots: Sequence[int] = ()

    def __post_init__(self) -> None:
        self._pieces: list[Records] = []
        self._earlier = 0.0
        self._began = time.perf_counter()

    def resume(self, kept: Kept) -> None:
        """Go on from a checkpoint."""
        self.dem.restore(kept.state)
        self._pieces = [dict(kept.records)]
        self._earlier = kept.seconds

    @property
    def seconds(self) -> float:
        """Computing time so far [s], that before a restart included."""
        return self._earlier + time.perf_counter() - self._began

    def records(self) -> Records:
        """Samples so far."""
        self._pieces = [joined([*self._pieces, self.dem.records()])]
        return self._pieces[0]

    def go(self, progress: Callable[[int, int], object] | None = None) -> int:
        """Run to the end; Ctrl-C ends the run with a status.

        Parameters
        ----------
        progress
            Called now and then with the number of steps done and of all; False stops the run, as Ctrl-C does.

        Returns
        -------
        int
            Status.
        """
        last = int(self.packed["steps"])
        try:
            if self.dem.step == 0:
                self._keep()
            finished = self._through([k for k in self.shots if k >= self.dem.step], last, progress)
        except KeyboardInterrupt:
            finished = False
        if not self.dem.status:  # what went wrong would go wrong again: the state before is the one to look at
            self._keep()
        return int(self.dem.status) if finished or self.dem.status else INTERRUPTED

    def _through(self, shots: Sequence[int], last: int, progress: Callable[[int, int], object] | None) -> bool:
        """Run to each snapshot and to the end."""
        for shot in [*shots, None]:
            if shot != 0 and not self._run(last if shot is None else shot - 1, last, progress):
                return False
            if shot is not None and self.snapshots is not None and not self.dem.status:
                self.snapshots.take(self.shots.index(shot), self.dem.state())
        return True

    def _run(self, until: int, last: int, progress: Callable[[int, int], object] | None) -> bool:
        """Run until a step is done, with checkpoints on the way."""
        while True:
            due, stopped = time.monotonic() + self.interval, False

            def go_on(done: int, due: float = due) -> bool:
                nonlocal stopped
                stopped = progress is not None and progress(done, last) is False
                return not stopped and (self.checkpoint is None or time.monotonic() < due)

            if self.dem.run(until, go_on):
                return not stopped
            if stopped:
                return False
            self._keep()

    def _keep(self) -> None:
        if self.checkpoint is not None:
            self.checkpoint.write(self.dem, self.packed, self.records(), self.seconds)
