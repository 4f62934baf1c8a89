"""Starts of the variants of a study: runs, or times of runs, from which variants continue."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from threading import Lock
from typing import Any

import numpy as np

from rattlebox._util.quantities import amount
from rattlebox.engines.continued import Start, read_start
from rattlebox.engines.simulate import repeat_up_to
from rattlebox.model.errors import Hint
from rattlebox.results.run import Run

PATH = "start"
"""Name of an axis of starts."""

_RAW = ("state", "end", "whole")
"""States of engines as bytes."""

_EXAMPLE = '[run, (run, "0.5 s"), "driven/run.nc"]'


@dataclass(eq=False)
class StartPoint:
    """A run, or a time of it, from which variants continue."""

    run: Run
    wanted: float | None  # Time in the run; None for its end [s]
    source: str  # Name of the run
    _reached: Run | None = field(default=None, repr=False)
    _lock: Any = field(default_factory=Lock, repr=False)

    def __getstate__(self) -> dict[str, Any]:
        # Other processes get the state, and need not repeat the run.
        run = self.reached()
        return {"run": self.run, "wanted": self.wanted, "source": self.source, "_reached": run if self.wanted else None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(**state)  # type: ignore[misc]

    @property
    def time(self) -> float:
        """Time at which variants start [s]."""
        if self.wanted is not None:
            return self.wanted
        end = self.run.end
        return float(self.run.arrays.time[-1]) if end is None else end.time

    @property
    def begin(self) -> float:
        """Time at which variants start [s]: that of a step near `time`, once the run has been repeated."""
        run = self._reached
        return self.time if run is None or run.end is None else run.end.time

    @property
    def is_known(self) -> bool:
        """Whether the state is there without a repetition of the run."""
        return self.wanted is None or self._reached is not None

    def reached(self, proceed: Callable[..., bool] | None = None) -> Run | None:
        """Return the run that ends where variants start; it is repeated up to an earlier time. None if it was stopped."""
        if self.wanted is None:
            return self.run
        with self._lock:
            if self._reached is None:
                again = repeat_up_to(self.run.case, self.wanted, proceed or False)
                if again.status == "interrupted":
                    return None
                self._reached = again
            return self._reached

    def describe(self) -> dict[str, Any]:
        """Return a description in JSON types; equal states have equal descriptions."""
        end = self.run.end
        digest = hashlib.sha256(self.run.case_toml.encode())
        if self.wanted is None and end is not None:
            digest.update(end.numbers.encode())
            # The bytes of a state have gaps, whose content is arbitrary; its motion is what the run has led to.
            for name, values in sorted((end.arrays or {}).items()):
                if name not in _RAW:
                    digest.update(name.encode() + np.ascontiguousarray(values).tobytes())
        return {"time": self.time, "sha256": digest.hexdigest()}


@dataclass(frozen=True, eq=False)
class Starts:
    """Starts along one dimension of a grid."""

    points: tuple[StartPoint, ...]

    @property
    def labels(self) -> np.ndarray[Any, Any]:
        """Different names of the starts."""
        sources = [point.source for point in self.points]
        times = [amount(point.time, "s") for point in self.points]
        if len(set(map(id, (point.run for point in self.points)))) == 1 and len(set(times)) == len(times) > 1:
            return np.array(times)
        names = [
            f"{source}, {time}" if sources.count(source) > 1 or point.wanted is not None else source
            for source, time, point in zip(sources, times, self.points, strict=True)
        ]
        return np.array([f"{name} ({k})" if names.count(name) > 1 else name for k, name in enumerate(names, start=1)])

    @property
    def times(self) -> np.ndarray[Any, Any]:
        """Times of the starts [s]."""
        return np.array([point.time for point in self.points])


def read_starts(given: object) -> Starts:
    """Read a list of runs, files of runs, and pairs of one of these and a time."""
    if isinstance(given, (str, os.PathLike, Run, tuple)) or not isinstance(given, Sequence) or not given:
        raise Hint(f"{PATH} needs a list of runs, not {given!r:.60}", _EXAMPLE)
    known: dict[int, int] = {}
    points = []
    for index, each in enumerate(given):
        start: Any = tuple(each) if isinstance(each, list) else each
        try:
            run, time = read_start(start)
        except Hint as hint:
            raise Hint(f"{PATH}[{index}]: {hint.complaint}", hint.suggestion) from None
        number = known.setdefault(id(run), len(known) + 1)
        points.append(StartPoint(run, time, _source(start, run, number)))
    return Starts(tuple(points))


def _source(start: Start, run: Run, number: int) -> str:
    """Return the name of a run: its file, the name of its case, or a number."""
    file = start[0] if isinstance(start, tuple) else start
    return run.case.name or (f"run {number}" if isinstance(file, Run) else os.fspath(file))
