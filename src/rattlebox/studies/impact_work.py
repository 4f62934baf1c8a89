"""One study as work that can be cut into blocks and sent anywhere."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.analysis.shaken import MIN_SAMPLES
from rattlebox.core import _core
from rattlebox.engines.batch import BlockOutput, run_block
from rattlebox.engines.simulate import simulate_many
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.random_vibration import Random
from rattlebox.prepare.pack import Batch, pack_parts

from .case_digest import describe_case
from .fingerprint import fingerprint
from .measures import INTERVAL, MEASURES, interval_of, name_of
from .work import Values

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results import Run

    from .grid import Grid

Extra = tuple[tuple[str, int], ...]
UserMeasure = Callable[["Run"], float]
_one_at_a_time = Lock()  # functions of users need not be safe to call from several threads


@dataclass
class ImpactWork:
    """Variants of a case with impact dampers, run in the core without keeping trajectories.

    Attributes
    ----------
    case, grid
        Base case and the grid of its variants.
    measures
        Names of measures, and functions of a Run.
    skip
        Time from which measures are evaluated [s].
    cycles
        Numbers of cycles of the harmonic load to skip and to evaluate, in place of `skip` and the duration of the case.
    samples
        Number of samples of the evaluated window; None for as many as the measures need.
    point
        Name of the observed point of the structure; default that of the first damper.
    motion, last, state
        Whether to keep the samples of the motion, number of the last impacts to keep, whether to keep the final state.
    intervals
        Whether measures of steady motion carry their 95 % interval.
    """

    case: Case
    grid: Grid
    measures: Sequence[str | UserMeasure] = ()
    skip: float = 0.0
    cycles: tuple[int, int] | None = None
    samples: int | None = None
    point: str | None = None
    motion: bool = False
    last: int = 0
    state: bool = False
    intervals: bool = False

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_prepared"}

    @property
    def size(self) -> int:
        """Number of variants."""
        return self.grid.size

    @property
    def block(self) -> int:
        """Preferred number of variants in a block: as many as there are blocks, or one run for functions of a Run."""
        return 1 if self.own else math.isqrt(self.size)

    @property
    def named(self) -> list[str]:
        """Measures that the core computes."""
        return [measure for measure in self.measures if isinstance(measure, str)]

    @property
    def own(self) -> dict[str, UserMeasure]:
        """Measures that are functions of a Run, by name."""
        return {name_of(measure): measure for measure in self.measures if not isinstance(measure, str)}

    @property
    def steady(self) -> list[str]:
        """Measures that carry an interval: averages over a motion that is driven for good."""
        if not self.intervals or not _is_driven(self.case):
            return []
        return [name for name in self.named if MEASURES[name].average]

    @cached_property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, str]]]:
        """Further dimensions, number type and attributes of each output."""
        names = " ".join(status.name for status in _core.Status)
        flags = {"long_name": "how the run ended", "flag_meanings": names}
        found: dict[str, tuple[Extra, str, dict[str, str]]] = {"status": ((), "int8", flags)}
        for name in self.named:
            measure = MEASURES[name]
            found[name] = ((), "float64", {"units": measure.units, "long_name": measure.long_name})
        for name in self.steady:
            half = f"half of the 95 % interval, {MEASURES[name].long_name}"
            found[name + INTERVAL] = ((), "float64", {"units": MEASURES[name].units, "long_name": half})
        for name in self.own:
            found[name] = ((), "float64", {"units": "", "long_name": name.replace("_", " ")})
        balls = self._balls
        if self.motion:
            time: Extra = (("instant", self.output.samples),)
            found["displacement"] = (time, "float64", {"units": "m", "long_name": "displacement"})
            found["velocity"] = (time, "float64", {"units": "m/s", "long_name": "velocity"})
            ball: Extra = (*time, ("ball", balls))
            place = "ball position from its place in the packed, centred row"
            found["ball_place"] = (ball, "float64", {"units": "m", "long_name": place})
            found["ball_speed"] = (ball, "float64", {"units": "m/s", "long_name": "ball speed in its cavity"})
        if self.last:
            tail: Extra = (("last", self.last),)
            found["last_time"] = (tail, "float64", {"units": "s", "long_name": "time of impact"})
            found["last_approach_speed"] = (tail, "float64", {"units": "m/s", "long_name": "approach speed"})
            found["last_contact"] = (tail, "float64", {"units": "", "long_name": "number of the contact"})
        if self.state:
            states: Extra = (("component", 2 * (len(self.case.modes.decay) + balls)),)
            found["state"] = (states, "float64", {"units": "", "long_name": "modes, ball positions, ball velocities"})
        return found

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of the further dimensions."""
        found: dict[str, tuple[NDArray[Any], str, str]] = {}
        durations = np.unique(np.concatenate([np.ravel(p.packed.settings.duration) for p, *_ in self._prepared]))
        lengths = {name: length for extra, _, _ in self.outputs.values() for name, length in extra}
        if self.motion:
            found["ball"] = np.arange(1, lengths["ball"] + 1), "1", "number of the ball"
            if self.cycles is not None:
                found["instant"] = self._window(0.0, self.cycles[1]), "1", "cycles looked at"
            elif len(durations) == 1:
                found["instant"] = self._window(self.skip, durations.item()), "s", "time"
            else:
                found["instant"] = self._window(0.0, 1.0), "1", "part of the time looked at"
        if self.last:
            found["last"] = np.arange(-self.last, 0), "1", "number of the impact, from the end"
        if self.state:
            found["component"] = np.arange(1, lengths["component"] + 1), "1", "number of the component"
        return {
            name: (name, values, {"units": unit, "long_name": text}) for name, (values, unit, text) in found.items()
        }

    def _window(self, start: float, stop: float) -> NDArray[np.float64]:
        return np.linspace(start, stop, self.output.samples)

    def describe(self) -> dict[str, Any]:
        """What is computed besides the grid, in JSON's types."""
        kept = {name: getattr(self, name) for name in ("skip", "samples", "point", "motion", "last", "state")}
        return {
            **describe_case(self.case, self.grid.columns),
            "measures": [*self.named, *(f"{name} {fingerprint(own)}" for name, own in self.own.items())],
            "cycles": None if self.cycles is None else list(self.cycles),
            **kept,
        }

    def run(
        self,
        start: int,
        stop: int,
        *,
        threads: int = 1,
        cancelled: Callable[[], bool] | None = None,
    ) -> Values | None:
        """Run variants start to stop.

        Parameters
        ----------
        start, stop
            Variants, counted along the grid with its last axis fastest.
        threads
            How many work at once.
        cancelled
            Asked some fifty times a second; True stops.

        Returns
        -------
        dict of str to array, or None
            Each output, (stop - start, ...); None when it was stopped.
        """

        def go_on(*_: int) -> bool:
            return not (cancelled and cancelled())

        result = self._measured(start, stop, threads, go_on)
        if result is None or not self.own:
            return result
        columns = {name: np.full(stop - start, np.nan) for name in self.own}
        for index in range(start, stop):
            if not go_on():
                return None
            (run,) = simulate_many([self.grid.case_at(self.case, index)], threads=1)
            if run.status == "finished":
                for name, number in self.own_of(run, index).items():
                    columns[name][index - start] = number
        return {**result, **columns}

    def own_of(self, run: Run, index: int) -> dict[str, float]:
        """Return what functions of a Run give of a variant.

        Raises
        ------
        CaseError
            When one of them gives no number.
        """
        found = {}
        for name, measure in self.own.items():
            with _one_at_a_time:
                value: Any = measure(run)
            try:
                if isinstance(value, str) or np.ndim(value):
                    raise TypeError
                found[name] = float(value)
            except TypeError:
                kind = type(value).__name__
                raise Hint(f"measure {name}: of variant {index} it is {kind}, not one number", "float(...)") from None
        return found

    def _measured(self, start: int, stop: int, threads: int, go_on: Callable[[int], bool]) -> Values | None:
        """What the core finds of variants start to stop."""
        found: dict[str, NDArray[Any]] = {}
        for part, output, numbers in self._prepared:
            first, last = (start, stop) if numbers is None else np.searchsorted(numbers, (start, stop)).tolist()
            if first == last:
                continue
            values = run_block(part.packed, part.shape, first, last, output, threads=threads, progress=go_on)
            if values is not None:
                values = with_intervals(values, output)
            if values is None or numbers is None:
                return values
            for name, array in values.items():
                whole = found.setdefault(name, np.empty((stop - start, *array.shape[1:]), array.dtype))
                whole[numbers[first:last] - start] = array
        return found

    def validate(self) -> None:
        """Raise, before anything runs, if a variant does not fit.

        Raises
        ------
        CaseError
            If one does not.
        """
        _ = self._prepared

    def require_alike(self) -> None:
        """Raise, before anything runs, if the variants differ in more than numbers.

        Raises
        ------
        CaseError
            If they do, or if one does not fit.
        """
        _ = self.packed

    # ---- what the core needs

    @property
    def packed(self) -> _core.Problem:
        """All variants, packed.

        Raises
        ------
        CaseError
            When they differ in more than numbers.
        """
        part = self._prepared[0][0]
        if part.obstacle:
            raise part.obstacle
        return part.packed

    @property
    def output(self) -> BlockOutput:
        """What is kept of each, for the core; of the first ones, where variants differ in more than numbers."""
        return self._prepared[0][1]

    @cached_property
    def _prepared(self) -> list[tuple[Batch, BlockOutput, NDArray[np.intp] | None]]:
        """Parts that differ in numbers only, with the numbers of their variants."""
        parts = pack_parts(self.case, self.grid.columns, self.grid.shape)
        found = []
        for part in parts:
            balls = sum(len(damper.mass) for damper in part.packed.dampers)
            modes = len(part.packed.mode_decay)
            if (
                part.obstacle
                and (self.motion or self.state)
                and (balls, modes) != (self._balls, len(self.case.modes.decay))
            ):
                raise part.obstacle
            numbers = part.flat_indices(self.grid.shape) if len(parts) > 1 else None
            found.append((*self._seen(part), numbers))
        return found

    def _seen(self, part: Batch) -> tuple[Batch, BlockOutput]:
        """A part as it is run, and what is kept of it."""
        packed = part.packed
        settings = packed.settings
        period = _period(packed)
        if self.cycles is not None:
            if period is None:
                raise Hint("cycles need a harmonic load or motion", 'duration and skip in seconds: skip = "2 s"')
            settings = settings.replace(duration=sum(self.cycles) * period)
        for name in self.named:
            if MEASURES[name].cyclic and period is None:
                raise Hint(f"{name} needs a harmonic load or motion, whose cycle it refers to", "kind harmonic")
        start = self.skip if self.cycles is None else self.cycles[0] * period
        if np.any(np.asarray(start) >= settings.duration):
            raise Hint(
                f"skip = {np.max(start):.6g} s is not before the end of the run", "a smaller skip or a longer duration"
            )
        dense = self.motion or any(MEASURES[name].samples for name in self.named)
        usual = 2001 if self.cycles is None else 1 + int(np.ceil(64 * self.cycles[1]))
        ends = 2
        if self.steady and not dense:  # energies at the ends of cycles, or of equal parts
            seen = 64.0 if period is None else np.max((settings.duration - np.asarray(start)) / period)
            ends = 1 + int(np.clip(np.ceil(seen - 1e-9), 1, 2000))
        harmonic = [name for name in self.named if MEASURES[name].samples and MEASURES[name].cyclic]
        if harmonic:
            seen = (settings.duration - np.asarray(start)) / period
            usual = max(usual, 1 + int(np.ceil(20 * np.max(seen))))
            each = ((self.samples or usual) - 1) / float(np.max(seen))
            if each < MIN_SAMPLES * (1 - 1e-6):
                raise Hint(
                    f"{harmonic[0]} needs {MIN_SAMPLES} samples in a cycle, and there are {each:.3g}",
                    "more samples; without a number there are enough",
                )
        output = BlockOutput(
            measures=self.named,
            shape=part.points[self._point],
            start=start,
            period=np.nan if period is None else period,
            samples=self.samples or (usual if dense else ends),
            motion=self.motion,
            last=self.last,
            state=self.state,
            batched=self.steady,
        )
        return replace(part, packed=packed.replace(settings=settings)), output

    @property
    def _balls(self) -> int:
        return sum(len(damper.balls) for damper in self.case.impact_dampers)

    @property
    def _point(self) -> str:
        if self.point is None and self.case.dampers:
            return self.case.modes.point(self.case.dampers[0].point)
        return self.case.modes.point(self.point)


def with_intervals(values: Values, output: BlockOutput) -> dict[str, NDArray[Any]]:
    """Return the outputs of runs with the intervals of their measures in place of the batches."""
    found = dict(values)
    if output.batched:
        batches, lengths = found.pop("batches"), found.pop("batch_length")
        for name, part in zip(output.batched, batches, strict=True):
            found[name + INTERVAL] = interval_of(name, found[name], part, lengths)
    return found


def _is_driven(case: Case) -> bool:
    """Return whether a harmonic or random vibration acts to the end of every run."""
    signals = (*case.loads, *case.base, *case.shaker_motion)
    return any(isinstance(s, Random) or (isinstance(s, Harmonic) and s.stop is None) for s in signals)


def _period(packed: _core.Problem) -> Any:
    """Of the first harmonic load or motion [s]; None when there is none."""
    for load in packed.loads:
        if isinstance(load.signal, _core.Harmonic):
            return 2 * np.pi / np.asarray(load.signal.frequency)
    return None
