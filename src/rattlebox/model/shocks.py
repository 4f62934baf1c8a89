"""Shocks: half sine, sawtooth, trapezoid."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import model_validator

from rattlebox._util.quantities import amount

from .elementwise import Vector
from .errors import Hint, nearest
from .signals import Amplitude, Polyline, Signal
from .units import NotNegativeTime, PositiveTime

if TYPE_CHECKING:
    from typing import Self


PULSES: dict[str, tuple[float, float]] = {
    "MIL-STD-810H 516.8 flight vehicle": (20.0, 0.011),
    "MIL-STD-810H 516.8 weapon launch": (30.0, 0.011),
    "MIL-STD-810H 516.8 ground": (40.0, 0.011),
    "MIL-STD-810H 516.8 truck": (20.0, 0.011),
    "MIL-STD-810F 516.5 crash, flight vehicle": (40.0, 0.011),
    "MIL-STD-810F 516.5 crash, ground": (75.0, 0.006),
}
"""Named sawtooth pulses: peak [g] and duration [s]."""


class Shock(Signal):
    """Base class of shocks."""

    spectra: ClassVar[tuple[str, ...]] = ("shock_spectrum",)
    amplitude: Amplitude
    duration: PositiveTime
    start: NotNegativeTime = 0.0

    @property
    def shortest_time(self) -> tuple[float, str]:
        """Duration of the pulse [s]."""
        return self.duration, "pulse"

    def mean_harmonic(self, duration: float) -> tuple[float, float]:
        """Return frequency [Hz] and amplitude of a harmonic whose half cycle is as long."""
        return 0.5 / self.duration, abs(self.amplitude)

    def words(self) -> str:
        """Return a phrase with amplitude and duration."""
        size = amount(abs(self.amplitude), self.unit or "")
        return f"a {self.kind.replace('_', '-')} pulse of {size} for {amount(self.duration, 's')}"


class HalfSine(Shock):
    r"""A half-sine pulse.

    Parameters
    ----------
    amplitude
        Peak value, with its unit.
    duration, start
        Length D and start of the pulse [s].

    Notes
    -----
    .. math:: f = A \sin\frac{\pi (t - t_0)}{D}, \qquad t_0 \le t < t_0 + D

    and 0 otherwise, with the amplitude :math:`A`, the start :math:`t_0` and the duration :math:`D`. The velocity changes by
    :math:`2 A D / \pi`.

    References
    ----------
    IEC 60068-2-27 (2008), Environmental testing, test Ea: shock.

    Examples
    --------
    A pulse whose force changes the velocity of 20 kg by 0.16 m/s:

    >>> import rattlebox as rb
    >>> pulse = rb.HalfSine(amplitude="5 kN", duration="1 ms")
    >>> run = rb.simulate(rb.Case(structure=rb.SDOF(mass="20 kg", stiffness=0), load=pulse, duration="2 ms"))
    >>> print(f"{run.motion.velocity[-1].item():.3f} m/s")
    0.159 m/s
    """

    kind: Literal["half_sine"] = "half_sine"

    def evaluate(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the values at the given times [s]."""
        t = np.asarray(time, dtype=float)
        inside = (t >= self.start) & (t < self.start + self.duration)
        return np.where(inside, self.amplitude * np.sin(math.pi * (t - self.start) / self.duration), 0.0)

    def coefficients(self) -> dict[str, Any]:
        """Return the coefficients for the core."""
        return {
            "kind": "half_sine",
            "amplitude": +self.amplitude,  # a float without the unit of the input
            "frequency": math.pi / self.duration,
            "phase": 0.0,
            "start": self.start,
            "stop": self.start + self.duration,
        }

    def motion(self, time: Vector) -> Vector:
        """Return displacement, velocity and acceleration, (3, T)."""
        omega = math.pi / self.duration
        s = np.clip(time - self.start, 0, self.duration)
        v = self.amplitude / omega * (1 - np.cos(omega * s))
        u = self.amplitude / omega * (s - np.sin(omega * s) / omega)
        late = np.maximum(time - self.start - self.duration, 0.0)
        return np.array([u + v * late, v, self.evaluate(time)])


class Sawtooth(Shock, Polyline):
    r"""A sawtooth pulse: a linear rise to the peak at the end, or a linear fall from the peak at the beginning.

    Parameters
    ----------
    amplitude
        Peak value, with its unit.
    duration, start
        Length D and start of the pulse [s].
    peak
        "terminal", at the end, or "initial", at the beginning; the pulse has a jump there.

    Notes
    -----
    .. math:: f = A \frac{t - t_0}{D}, \qquad t_0 \le t < t_0 + D

    with a terminal peak, :math:`A (1 - (t - t_0) / D)` with an initial one; amplitude :math:`A`, start :math:`t_0`,
    duration :math:`D`. The velocity changes by :math:`A D / 2`. IEC 60068-2-27 and MIL-STD-810 use the pulse with a
    terminal peak.

    References
    ----------
    IEC 60068-2-27 (2008), Environmental testing, test Ea: shock.
    """

    kind: Literal["sawtooth"] = "sawtooth"
    peak: Literal["terminal", "initial"] = "terminal"

    @classmethod
    def profile(cls, name: str, **options: Any) -> Sawtooth:
        """Return the terminal-peak sawtooth of a standard.

        Parameters
        ----------
        name
            "MIL-STD-810H 516.8 flight vehicle" (20 g), "... weapon launch" (30 g, also captive carry), "... ground" (40 g)
            or "... truck" (20 g, mounted only in trucks and semi-trailers); all of 11 ms. Crash hazard:
            "MIL-STD-810F 516.5 crash, flight vehicle" (40 g, 11 ms) or "... crash, ground" (75 g, 6 ms), which were not
            compared with the printed standard.
        **options
            Other fields: start, direction; `amplitude="-40 g"` for the other direction.

        Returns
        -------
        Sawtooth
            The pulse.

        Raises
        ------
        CaseError
            If there is no pulse of this name.

        Notes
        -----
        These are the default parameters of functional shocks, procedure I, and of crash hazard, procedure V, for which the
        standard prefers measured data. It applies classical pulses in both directions. Editions differ: check peak and
        duration with your copy before a test.

        References
        ----------
        MIL-STD-810H (2019), Method 516.8, Shock, Table 516.8-IV with note 3. MIL-STD-810F (2000), Method 516.5, Shock: where
        to look up procedure V.

        Examples
        --------
        >>> import rattlebox as rb
        >>> pulse = rb.Sawtooth.profile("MIL-STD-810H 516.8 ground", direction="x")
        >>> round(pulse.amplitude / 9.80665), pulse.duration, pulse.peak
        (40, 0.011, 'terminal')
        """
        if name not in PULSES:
            raise Hint(f"there is no pulse {name!r}", nearest(name, PULSES))
        peak, duration = PULSES[name]
        return cls(**{"amplitude": f"{peak:g} g", "duration": duration, **options})

    def polyline(self) -> tuple[Vector, Vector]:
        """Return times [s] and values of the corners."""
        stop = self.start + self.duration
        jump = self.start if self.peak == "initial" else stop
        times = sorted([self.start - self.duration, self.start, stop, jump, stop + self.duration])
        values = [0.0, 0.0, self.amplitude, 0.0, 0.0]
        return np.array(times), np.array(values)


class Trapezoid(Shock, Polyline):
    """A trapezoidal pulse: a linear rise, a constant value, and a linear fall.

    Parameters
    ----------
    amplitude
        Constant value, with its unit.
    duration, start
        Length D and start of the pulse [s].
    rise, fall
        Length of the rise and of the fall [s]; 0 is a jump. The default of the rise is a tenth of the duration, that of the
        fall is the rise.

    Notes
    -----
    At the time t after the start the value is amplitude t / rise in the rise, then the amplitude, and amplitude (D - t) /
    fall in the fall. The velocity changes by amplitude (D - (rise + fall) / 2). The trapezoid of IEC 60068-2-27 rises and
    falls in a tenth of the duration.

    References
    ----------
    IEC 60068-2-27 (2008), Environmental testing, test Ea: shock.
    """

    kind: Literal["trapezoid"] = "trapezoid"
    rise: NotNegativeTime | None = None
    fall: NotNegativeTime | None = None

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if sum(self._ramps()) > self.duration * (1 + 1e-12):
            raise Hint(
                f"rise and fall last {sum(self._ramps()):.6g} s, longer than the pulse of {self.duration:.6g} s",
                "a longer duration, or a shorter rise",
                ["rise"],
            )
        return self

    def _ramps(self) -> tuple[float, float]:
        rise = 0.1 * self.duration if self.rise is None else self.rise
        return rise, rise if self.fall is None else self.fall

    def polyline(self) -> tuple[Vector, Vector]:
        """Return times [s] and values of the corners."""
        rise, fall = self._ramps()
        stop = self.start + self.duration
        full = self.start + rise
        times = [self.start - self.duration, self.start, full, max(stop - fall, full), stop, stop + self.duration]
        return np.array(times), np.array([0.0, 0.0, self.amplitude, self.amplitude, 0.0, 0.0])
