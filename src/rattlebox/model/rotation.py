"""Rotation of a cavity about an axis that is fixed in the machine."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from rattlebox._util.quantities import amount

from .base import Part
from .elementwise import Vector
from .errors import Hint
from .space import Direction, Lengths, rotated, unit_vector
from .units import SI, Angle, AngularVelocity, NotNegativeAngle, PositiveFrequency, in_si, numbers

_INSTANTS = 4097
"""Number of evenly spaced times at which the largest speed and angular acceleration of a rotation are evaluated."""


class AngleAt(NamedTuple):
    """Angle of a rotation and its derivatives with respect to time: numbers, or arrays over times."""

    angle: Any  # [rad]
    speed: Any  # [rad/s]
    acceleration: Any  # [rad/s^2]


def _list_of(unit: str, what: str, example: list[Any]) -> Any:
    def read(value: object) -> Any:
        array = numbers(in_si(value, unit))
        if array.ndim != 1:
            raise Hint(f"a list of {what} is needed", str(example))
        return tuple(array.tolist())

    schema = {"type": "array", "description": f"{what}, in {unit} or with units", "examples": [example]}
    return SI(unit), BeforeValidator(read), WithJsonSchema(schema)


class Rotation(Part):
    r"""Rotation of a cavity about an axis that is fixed in the machine: a gear, rotor, drum, blade or spindle.

    One of `speed`, `speeds`, `angles` and `amplitude` is needed; `amplitude` may be added to one of the others.

    Parameters
    ----------
    arm
        From the axis to the centre of the cavity, at angle 0 [m]; zero for a cavity on the axis.
    axis
        Direction of the axis; the rotation is positive about it by the right-hand rule.
    speed
        Constant angular velocity [rad/s], also in "rpm".
    times, speeds
        Angular velocity as straight lines between times [s], constant before the first and after the last: a run-up.
    angles
        Angle at `times` in place of `speeds` [rad], with a natural cubic spline between them and a constant angular velocity
        before the first and after the last.
    amplitude, frequency
        Amplitude [rad] and frequency [Hz] of a rocking motion, a sine of time.
    angle
        Angle at time 0 [rad], also in "deg", or the angle that is added to `angles`. At angle 0 the axes of the cavity are
        those of the machine.
    vibration
        Frame of the mode shapes of the structure at the cavity: "machine", for a structure that moves the axis (a gear on a
        shaft), or "cavity", for one that turns (a blade). The second is the vibration relative to the turning axes; Coriolis
        and centrifugal forces on the structure itself are those of its modes.

    Notes
    -----
    .. math::

        \varphi(t) = \varphi_0 + \int_0^t \Omega\,\mathrm dt + \hat\varphi \sin 2 \pi f t

    and the particles move in the field

    .. math::

        \ddot x = \frac F m + g - \Omega \times (\Omega \times (R + x)) - \dot \Omega \times (R + x) - 2 \Omega \times \dot x

    with the position :math:`x` in the turning cavity and the arm :math:`R`. They start at rest relative to the cavity, in a
    bed that has settled in the field at its centre.

    Examples
    --------
    >>> import rattlebox as rb
    >>> gear = rb.Rotation(speed="700 rpm", axis="y", arm=("60 mm", "0 mm", "0 mm"))
    >>> round(gear.centrifugal_ratio(), 1)
    32.9
    """

    field_names: ClassVar[tuple[str, ...]] = ("rotation",)
    arm: Lengths
    axis: Direction = "z"
    speed: AngularVelocity | None = None
    times: Annotated[tuple[float, ...], *_list_of("s", "times", ["0 s", "2 s"])] = ()
    speeds: Annotated[tuple[float, ...], *_list_of("rad/s", "angular velocities", ["0 rpm", "1000 rpm"])] = ()
    angles: Annotated[tuple[float, ...], *_list_of("rad", "angles", ["0 deg", "90 deg"])] = ()
    amplitude: NotNegativeAngle = 0.0
    frequency: PositiveFrequency | None = None
    angle: Angle = 0.0
    vibration: Literal["machine", "cavity"] = Field(default="machine", examples=["machine"])

    @model_validator(mode="after")
    def _check(self) -> Rotation:
        given = [name for name in ("speed", "speeds", "angles") if getattr(self, name) not in (None, ())]
        if len(given) > 1:
            raise Hint(f"{given[0]} and {given[1]} exclude each other", "one of them", [given[1]])
        if not given and not self.amplitude:
            raise Hint(
                "no angular velocity is given; a rotation needs speed, speeds, angles or amplitude", 'speed = "700 rpm"'
            )
        if bool(self.amplitude) != (self.frequency is not None):
            lacking, example = ("frequency", '"20 Hz"') if self.amplitude else ("amplitude", '"5 deg"')
            raise Hint(
                "a rocking motion needs amplitude and frequency, and only one of them is given",
                f"{lacking} = {example}",
                [lacking],
            )
        rows = self.speeds or self.angles
        if len(rows) != len(self.times):
            what = "angles" if self.angles else "speeds"
            raise Hint(
                f"times and {what} must have the same length; got {len(self.times)} and {len(rows)}",
                'times = ["0 s", "2 s"], speeds = ["0 rpm", "1000 rpm"]',
                [what if self.times else "times"],
            )
        if rows and (len(rows) < 2 or np.any(np.diff(self.times) <= 0)):
            raise Hint("times must increase, and there must be at least two", '["0 s", "2 s"]', ["times"])
        return self

    def at_cell(self, offset: tuple[float, float, float]) -> Rotation:
        """Return the rotation of a cavity at an offset from this one [m], along the axes of the cavity."""
        return self.model_copy(update={"arm": tuple((np.array(self.arm) + offset).tolist())})

    @cached_property
    def polynomials(self) -> tuple[Vector, Vector]:
        """Knots and coefficients of the angle without the rocking: a + b s + c s^2 + d s^3 after each knot, (k,), (k, 4)."""
        if not self.times:
            return np.zeros(1), np.array([[self.angle, self.speed or 0.0, 0.0, 0.0]])
        times, rows = np.array(self.times), np.zeros((len(self.times) + 1, 4))
        if self.angles:
            from scipy.interpolate import CubicSpline

            spline = CubicSpline(times, self.angles, bc_type="natural")
            rows[1:-1] = spline.c[::-1].T
            rows[-1, :2] = spline(times[-1]), spline(times[-1], 1)
        else:
            speeds = np.array(self.speeds)
            steps = np.diff(times)
            rows[1:-1, 2] = np.diff(speeds) / steps / 2
            rows[1:, 1] = speeds
            rows[2:, 0] = np.cumsum((speeds[1:] + speeds[:-1]) / 2 * steps)
        # The angular velocity is constant before the first time: one more knot before it.
        rows[0, 1] = rows[1, 1]
        rows[0, 0] = rows[1, 0] - rows[1, 1]
        knots = np.concatenate([times[:1] - 1.0, times])
        rows[:, 0] += self.angle - (0.0 if self.angles else _evaluate(knots, rows, np.zeros(1)).angle[0])
        return knots, rows

    @property
    def rocking(self) -> float:
        """Angular frequency of the rocking motion [rad/s]; 0 without one."""
        return 2 * math.pi * (self.frequency or 0.0)

    def words(self) -> str:
        """Return a phrase about the motion, without the place of the cavity."""
        about = f"about {self.axis if isinstance(self.axis, str) else ', '.join(f'{part:.3g}' for part in self.axis)}"
        if self.is_rocking:
            return f"rocks by {math.degrees(self.amplitude):.4g} deg at {amount(self.rocking / (2 * math.pi), 'Hz')} {about}"
        speed = f"{self.largest(max((0.0, *self.times))).speed * 30 / math.pi:.4g} rpm"
        return f"turns at {'up to ' if self.times else ''}{speed} {about}"

    @property
    def is_rocking(self) -> bool:
        """Whether the cavity rocks without turning."""
        return bool(self.amplitude) and not self.speed and not self.times

    def at(self, times: Any) -> AngleAt:
        """Return the angle, the angular velocity and the angular acceleration at times [s]."""
        times = np.asarray(times, dtype=float)
        smooth = _evaluate(*self.polynomials, times)
        rate, size = self.rocking, self.amplitude
        sine, cosine = np.sin(rate * times), np.cos(rate * times)
        return AngleAt(
            smooth.angle + size * sine,
            smooth.speed + size * rate * cosine,
            smooth.acceleration - size * rate**2 * sine,
        )

    def largest(self, duration: float) -> AngleAt:
        """Return the largest absolute angle, angular velocity and acceleration in a run of this duration [s]."""
        instants = np.linspace(0.0, duration, _INSTANTS)
        knots = [time + shift for time in self.times for shift in (-1e-12, 0.0) if 0 < time < duration]
        smooth = _evaluate(*self.polynomials, np.concatenate([instants, knots]))
        rate, size = self.rocking, self.amplitude
        return AngleAt(
            float(np.abs(smooth.angle).max()) + size,
            float(np.abs(smooth.speed).max()) + size * rate,
            float(np.abs(smooth.acceleration).max()) + size * rate**2,
        )

    @property
    def radial(self) -> Vector:
        """From the axis to the centre of the cavity, perpendicular to the axis, at angle 0, (3,) [m]."""
        axis, arm = unit_vector(self.axis), np.array(self.arm)
        return np.asarray(arm - axis * (axis @ arm))

    def to_cavity(self, vectors: Vector, angle: Any) -> Vector:
        """Return vectors in the machine, (..., 3), along the axes of the cavity at an angle or at one for each vector."""
        return self.to_machine(vectors, -np.asarray(angle))

    def to_machine(self, vectors: Vector, angle: Any) -> Vector:
        """Return vectors along the axes of the cavity, (..., 3), in the machine, at an angle or at one for each vector."""
        return rotated(np.asarray(vectors, dtype=float), unit_vector(self.axis), angle)

    def lever_velocity(self, displacement: Vector, speed: float) -> Vector:
        """Return the velocity of a cavity that turns about an axis displaced with it less that about the axis at rest, (3,).

        The displacement is along the axes of the cavity. With the vibration of the cavity the axis is at rest.
        """
        if self.vibration == "cavity":
            return np.zeros(3)
        return -speed * np.cross(unit_vector(self.axis), displacement)

    def field(self, gravity: Vector) -> Vector:
        """Return gravity and centrifugal acceleration at the centre of the cavity at the start, along its axes [m/s^2]."""
        start = self.at(0.0)
        return np.asarray(self.to_cavity(gravity, start.angle) + float(start.speed) ** 2 * self.radial)

    def strongest_field(self, gravity: Vector, reach: float, duration: float) -> float:
        """Return a bound on gravity, centrifugal and Euler acceleration in a run, within a reach of the centre [m/s^2]."""
        most = self.largest(duration)
        return float(
            np.linalg.norm(gravity)
            + math.hypot(most.speed**2, most.acceleration) * (np.linalg.norm(self.radial) + reach)
        )

    def centrifugal_ratio(self, gravity: float = 9.81) -> float:
        r"""Return the largest centrifugal acceleration at the centre of the cavity over gravity, at the stated speeds.

        It is zero for a cavity on the axis, such as a drum, whose particles stay at the wall above :math:`\Omega^2 R = g`
        with the radius R of their path.

        Parameters
        ----------
        gravity
            Acceleration of gravity [m/s^2].

        Returns
        -------
        float
            :math:`\Omega^2 R / g`, with the distance R of the centre from the axis.
        """
        last = max((0.0, *self.times))
        return float(self.largest(last).speed ** 2 * np.linalg.norm(self.radial)) / gravity


def _evaluate(knots: Vector, rows: Vector, times: Vector) -> AngleAt:
    """Return a piecewise polynomial and its derivatives at times."""
    piece = np.maximum(np.searchsorted(knots, times, side="right") - 1, 0)
    a, b, c, d = np.moveaxis(rows[piece], -1, 0)
    s = times - knots[piece]
    return AngleAt(a + s * (b + s * (c + s * d)), b + s * (2 * c + 3 * s * d), 2 * c + 6 * s * d)
