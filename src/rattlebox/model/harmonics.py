"""Harmonics and sine sweeps."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, WithJsonSchema, model_validator

from rattlebox._util.narrow import present
from rattlebox._util.quantities import amount

from .elementwise import Vector, power
from .errors import Hint
from .recorded import Record
from .signals import Amplitude, Points, Polyline, Signal, Unit
from .units import Angle, NotNegativeTime, PositiveFrequency, PositiveTime

if TYPE_CHECKING:
    from typing import Self


class Harmonic(Signal):
    r"""Harmonic signal.

    Parameters
    ----------
    amplitude
        Peak value, with its unit.
    frequency
        Frequency [Hz]; text in "rad/s" is an angular frequency.
    phase
        Phase [rad], or text in "deg".
    start, stop
        Start and end [s]; default unlimited from 0.

    Notes
    -----
    .. math:: x = A \sin(2 \pi f t + \varphi)

    for start <= t < stop, else 0. The phase :math:`\varphi` is that at t = 0, not at the start.

    Examples
    --------
    The unit of the amplitude decides what moves:

    >>> import rattlebox as rb
    >>> [rb.Harmonic(amplitude=amplitude, frequency="50 Hz").unit for amplitude in ("5 N", "2 g", "1 mm")]
    ['N', 'm/s^2', 'm']
    """

    kind: Literal["harmonic"] = "harmonic"
    amplitude: Amplitude
    frequency: PositiveFrequency
    phase: Angle = 0.0
    start: NotNegativeTime = 0.0
    stop: PositiveTime | None = None

    @model_validator(mode="after")
    def _in_order(self) -> Harmonic:
        if self.stop is not None and self.stop <= self.start:
            raise Hint(f"must be later than start, {self.start:g} s", "a later time, or no stop", ["stop"])
        return self

    @property
    def is_lasting(self) -> bool:
        """Whether it never stops."""
        return self.stop is None

    def evaluate(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the values at the given times [s]."""
        t = np.asarray(time, dtype=float)
        inside = (t >= self.start) & (t < (math.inf if self.stop is None else self.stop))
        return np.where(inside, self.amplitude * np.sin(2 * math.pi * self.frequency * t + self.phase), 0.0)

    def unplaced(self, allowed: Sequence[Unit]) -> str:
        """Return advice for a harmonic in another unit; for a displacement, the amplitude of its acceleration."""
        if self.unit == "m" and "m/s^2" in allowed:
            return f'amplitude = "{self.acceleration().amplitude:.8g} m/s^2", the acceleration of this displacement'
        return super().unplaced(allowed)

    def coefficients(self) -> dict[str, Any]:
        """Return the coefficients for the core."""
        return {
            "kind": "harmonic",
            "amplitude": +self.amplitude,  # a float without the unit of the input
            "frequency": 2 * math.pi * self.frequency,
            "phase": self.phase,
            "start": self.start,
            "stop": math.inf if self.stop is None else self.stop,
        }

    def motion(self, time: Vector) -> Vector:
        """Return displacement, velocity and acceleration, (3, T): u = -A sin(w t + phi) / w^2, less its start value."""
        omega = 2 * math.pi * self.frequency
        angle = omega * time + self.phase
        acceleration = self.evaluate(time)
        velocity = -self.amplitude / omega * np.cos(angle)
        displacement = -self.amplitude / omega**2 * np.sin(angle)
        if self.start == 0 and self.stop is None:
            return np.array([displacement, velocity, acceleration])
        stop = math.inf if self.stop is None else self.stop
        first = omega * self.start + self.phase
        v0, u0 = -self.amplitude / omega * math.cos(first), -self.amplitude / omega**2 * math.sin(first)
        inside = np.clip(time, self.start, stop)
        angle = omega * inside + self.phase
        v = -self.amplitude / omega * np.cos(angle) - v0
        u = -self.amplitude / omega**2 * np.sin(angle) - u0 - v0 * (inside - self.start)
        return np.array([u + v * np.maximum(time - stop, 0.0), v, acceleration])

    @property
    def shortest_time(self) -> tuple[float, str]:
        """Period [s]."""
        return 1 / self.frequency, "period of a harmonic"

    @property
    def is_resolved(self) -> bool:
        """True: by default a period has 20 steps."""
        return True

    def mean_harmonic(self, duration: float) -> tuple[float, float]:
        """Return frequency [Hz] and amplitude."""
        return self.frequency, abs(self.amplitude)

    def words(self) -> str:
        """Return a phrase with amplitude and frequency."""
        size = amount(abs(self.amplitude), self.unit or "")
        return f"a harmonic {self._quantity} of {size} at {amount(self.frequency, 'Hz')}"

    def acceleration(self) -> Harmonic:
        """Return the acceleration of a harmonic displacement, -(2 pi frequency)^2 times it."""
        factor = -power(2 * math.pi * self.frequency, 2)
        return self.model_copy(update={"amplitude": self.amplitude * factor, "unit": "m/s^2"})


POINTS_PER_CYCLE = 32
"""Points of a sine sweep in each cycle."""

MAX_POINTS = 20_000_000
"""Largest number of points of a sine sweep."""

_RATE = re.compile(
    r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(oct(?:ave)?s?|dec(?:ade)?s?|Hz)\s*/\s*(s|sec|min)\s*$"
)


def _sweep_rate(value: object) -> str:
    match = _RATE.match(value) if isinstance(value, str) else None
    if match is None:
        raise Hint("a sweep rate is text with a unit: oct/min, oct/s, dec/min, Hz/s or Hz/min", '"2 oct/min"')
    if not 0 < float(match[1]) < 1e30:
        raise Hint("must be greater than zero; a downward sweep has the larger first_frequency", '"2 oct/min"')
    return match[0].strip()


SweepRate = Annotated[
    str,
    BeforeValidator(_sweep_rate),
    WithJsonSchema(
        {"type": "string", "description": "oct/min, oct/s, dec/min, Hz/s or Hz/min", "examples": ["2 oct/min"]}
    ),
]


class SineSweep(Polyline):
    r"""Sine sweep of constant amplitude, upward or downward, with a constant sweep rate.

    Parameters
    ----------
    amplitude
        Peak value at all frequencies, with its unit.
    first_frequency, last_frequency
        Frequencies at the beginning and at the end [Hz]; a downward sweep has the lower one last.
    sweep_rate
        "2 oct/min", "1 oct/s", "1 dec/min" (logarithmic), "5 Hz/s" or "100 Hz/min" (linear).
    duration
        Duration of a logarithmic sweep [s], in place of a rate.
    start
        Start [s]; before it and after its end the sweep is zero.

    Notes
    -----
    The phase of a logarithmic and of a linear sweep is

    .. math::

        f &= f_1 2^{r t}: & \varphi &= 2 \pi f_1 \frac{2^{r t} - 1}{r \ln 2} \\
        f &= f_1 + r t: & \varphi &= 2 \pi \left(f_1 t + \frac{r t^2}{2}\right)

    with a negative :math:`r` for a downward sweep. The sweep ends with the half cycle in which it reaches the last
    frequency.

    The sweep consists of straight lines between 32 points in each cycle, at equal steps of phase. Their values are divided
    by sinc^2(1/32), so that the amplitude of the fundamental is exact at all frequencies (see `Record`); the remaining
    errors are the harmonics 31 and 33, of 0.1 % each, and a peak that is 0.3 % too high.

    References
    ----------
    IEC 60068-2-6 (2007), Environmental testing, test Fc: vibration (sinusoidal).
    """

    is_sweep: ClassVar[bool] = True
    kind: Literal["sine_sweep"] = "sine_sweep"
    amplitude: Amplitude
    first_frequency: PositiveFrequency
    last_frequency: PositiveFrequency
    sweep_rate: SweepRate | None = None
    duration: PositiveTime | None = None
    start: NotNegativeTime = 0.0

    @model_validator(mode="after")
    def _validate(self) -> Self:
        if (self.sweep_rate is None) == (self.duration is None):
            raise Hint("a sweep needs either a rate or a duration", 'sweep_rate = "2 oct/min"', ["sweep_rate"])
        if self.first_frequency == self.last_frequency:
            raise Hint(
                "a sweep needs two different frequencies", 'kind = "harmonic" for one frequency', ["last_frequency"]
            )
        cycles = self._cycles()
        if cycles * POINTS_PER_CYCLE > MAX_POINTS:
            raise Hint(
                f"the sweep has {cycles:.3g} cycles; at most {MAX_POINTS // POINTS_PER_CYCLE} are allowed",
                "a faster sweep, or parts of it one after the other",
                ["sweep_rate" if self.duration is None else "duration"],
            )
        return self

    @property
    def _rate(self) -> tuple[float, bool]:
        """Signed rate [oct/s or Hz/s], and whether the sweep is linear."""
        if self.duration is not None:
            return math.log2(self.last_frequency / self.first_frequency) / self.duration, False
        match = present(_RATE.match(self.sweep_rate or ""))
        number = (
            float(match[1])
            / (60 if match[3] == "min" else 1)
            * (1 if self.last_frequency > self.first_frequency else -1)
        )
        return number * (math.log2(10) if match[2].startswith("dec") else 1), match[2] == "Hz"

    @property
    def length(self) -> float:
        """Time from the first to the last frequency [s]."""
        rate, linear = self._rate
        if linear:
            return (self.last_frequency - self.first_frequency) / rate
        return math.log2(self.last_frequency / self.first_frequency) / rate

    def _cycles(self) -> float:
        """Return the number of cycles from the first to the last frequency."""
        rate, linear = self._rate
        if linear:
            return (self.first_frequency + self.last_frequency) / 2 * self.length
        return (self.last_frequency - self.first_frequency) / (rate * math.log(2))

    @property
    def levels(self) -> NDArray[np.float64]:
        """The amplitude at the lower and the higher end, (2, 2)."""
        ends = sorted((self.first_frequency, self.last_frequency))
        return np.array([(frequency, self.amplitude) for frequency in ends])

    def with_levels(self, levels: NDArray[np.float64]) -> Record:
        """Return the record of the sweep whose amplitude follows other levels, (n, 2)."""
        times, values = self.polyline()
        amplitude = np.exp(np.interp(np.log(self.frequency_at(times)), *np.log(levels).T))
        values, sweeps = values * amplitude / self.amplitude, times >= 0
        along = {"direction": self.direction} if self.direction else {}
        return Record(times=times[sweeps], values=values[sweeps], unit=self.unit, **along)

    def frequency_at(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the frequency at the given times [Hz]; before and after the sweep, the first and the last one."""
        rate, linear = self._rate
        t = np.clip(np.asarray(time, dtype=float) - self.start, 0.0, self.length)
        if linear:
            return np.asarray(self.first_frequency + rate * t)
        return np.asarray(self.first_frequency * np.exp2(rate * t))

    @property
    def shortest_time(self) -> tuple[float, str]:
        """Period of the highest frequency [s]."""
        return 1 / max(self.first_frequency, self.last_frequency), "shortest period of a sweep"

    def words(self) -> str:
        """Return a phrase with both frequencies."""
        ends = f"{amount(self.first_frequency, 'Hz')} to {amount(self.last_frequency, 'Hz')}"
        return f"a sine sweep of {self._quantity} from {ends}"

    def polyline(self) -> tuple[Vector, Vector]:
        """Return times [s] and values of the points."""
        return self._points.times, self._points.values

    @cached_property
    def _points(self) -> Points:
        rate, linear = self._rate
        first = self.first_frequency
        halves = math.ceil(2 * self._cycles() * (1 - 1e-12))
        cycle = np.arange(halves * POINTS_PER_CYCLE // 2 + 1) / POINTS_PER_CYCLE
        if linear:  # this form of the root is accurate for small rates
            inside = first * first + 2 * rate * cycle
            times = 2 * cycle / (first + np.sqrt(np.maximum(inside, 0.0)))
        else:
            times = np.log1p(np.maximum(cycle * rate * math.log(2) / first, -1 + 1e-15)) / (rate * math.log(2))
        values = +self.amplitude * np.sin(2 * math.pi * cycle) / np.sinc(1 / POINTS_PER_CYCLE) ** 2
        values[[0, -1]] = 0.0
        lead = 1 / first
        times = self.start + times
        return Points(
            np.concatenate([[times[0] - lead], times, [times[-1] + lead]]), np.concatenate([[0.0], values, [0.0]])
        )
