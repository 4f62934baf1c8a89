"""Restitution from measurements of single impacts: drop heights and rebounds, times of bounces."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from rattlebox._util.quantities import amount
from rattlebox.model.errors import Hint
from rattlebox.studies.calibration.fit import NORMAL
from rattlebox.studies.calibration.measurements import Contacts, Drops

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.dampers import Sphere

FloatArray = NDArray[np.float64]

GRAVITY = 9.80665
"""Standard gravity [m/s^2]."""
_AIR_DENSITY, _AIR_VISCOSITY = 1.204, 1.825e-5
"""Density [kg/m^3] and viscosity [Pa s] of air at 20 °C and 1013 hPa."""
_FALL_STEPS = 200
"""Number of steps over a fall through air; the error of the speed is below 1e-6."""
_SIGNIFICANT = 0.05
"""Level of the tests for a trend and for differences between measurements."""
_SMALL_CHANGE = 2e-3
"""Relative change of the restitution over the measured speeds below which a trend does not matter."""
_HIGH_DROP = 20.0
"""Height of a drop above which the unit is doubtful [m]."""
_MISSED = 0.1
"""Smallest difference of a logarithm from the median that may be a missed contact."""


class Impacts(NamedTuple):
    """Impacts of one measurement."""

    speed: FloatArray  # Approach speed [m/s], (N,)
    restitution: FloatArray  # Restitution, (N,)
    error: float


def impacts_of(data: Contacts) -> Impacts:
    """Return approach speed and restitution of each impact of a measurement.

    Notes
    -----
    A drop: e = sqrt(h_1/h_0). A bounce: e = T_2/T_1, with the flights T = 2 v/g before and after the contact. Neither needs
    the value of gravity. With air the speeds follow from m dv/dt = m g -+ C_D rho A v^2 / 2 and the drag coefficient C_D of
    a sphere (Schiller and Naumann).
    """
    if isinstance(data, Drops):
        if data.ball is None:
            before, after = (np.sqrt(2 * GRAVITY * height) for height in (data.height, data.rebound))
        else:
            before = speed_after_fall(data.height, data.ball)
            after = speed_after_fall(data.rebound, data.ball, rising=True)
        error = math.nan
        if data.error is not None:
            error = data.error * math.sqrt(float(np.sum(1 / data.height**2 + 1 / data.rebound**2))) / 2
        return Impacts(before, after / before, error)
    flights = [np.diff(times) for times in data.times]
    error = math.nan
    if data.error is not None:
        ends = sum(_error_of_ends(each) for each in flights)
        error = data.error * math.sqrt(ends)
    return Impacts(
        GRAVITY / 2 * np.concatenate([each[:-1] for each in flights]),
        np.concatenate([each[1:] / each[:-1] for each in flights]),
        error,
    )


def _error_of_ends(flights: FloatArray) -> float:
    """Return the variance of ln(last flight / first flight) for times with a variance of one."""
    gradient = np.zeros(flights.size + 1)
    gradient[:2] += np.array([1.0, -1.0]) / flights[0]
    gradient[-2:] += np.array([-1.0, 1.0]) / flights[-1]
    return float(gradient @ gradient)


def speed_after_fall(height: FloatArray, ball: Sphere, *, rising: bool = False) -> FloatArray:
    """Return the speed of a sphere after a fall from rest through air, or that with which it rises to a height [m/s].

    `height`: heights [m], (N,).

    Notes
    -----
    The drag coefficient at the Reynolds number Re is 24 / Re (1 + 0.15 Re^0.687), and 0.44 above Re = 1000.

    References
    ----------
    L. Schiller, A. Naumann (1933), Zeitschrift des Vereines Deutscher Ingenieure 77, 318-320.
    """
    area = math.pi * ball.half**2

    def slope(square: FloatArray) -> FloatArray:
        """Return the change of the squared speed with the height [m/s^2]."""
        reynolds = np.maximum(np.sqrt(np.maximum(square, 0)) * 2 * ball.half * _AIR_DENSITY / _AIR_VISCOSITY, 1e-9)
        drag = np.where(reynolds < 1000, 24 / reynolds * (1 + 0.15 * reynolds**0.687), 0.44)
        deceleration = drag * _AIR_DENSITY * area * square / (2 * ball.weight)
        return np.asarray(2 * (GRAVITY + deceleration if rising else GRAVITY - deceleration))

    step, square = height / _FALL_STEPS, np.zeros_like(height)
    for _ in range(_FALL_STEPS):  # Runge-Kutta of fourth order
        first = slope(square)
        second = slope(square + step / 2 * first)
        third = slope(square + step / 2 * second)
        square = square + step / 6 * (first + 2 * second + 2 * third + slope(square + step * third))
    return np.sqrt(square)


def restitution_of(data: Sequence[Contacts]) -> xarray.Dataset:
    """Return the restitution of all measurements with its 95 % interval.

    Notes
    -----
    The estimate is the geometric mean. The interval is that of Student's t over the logarithms of all n restitutions,
    ln e +- t s / sqrt(n) with their standard deviation s, or 1.96 times the error of the mean from the uncertainty of the
    readings if that is wider. Errors of times make consecutive
    ratios vary against each other, which the interval counts as scatter of the restitution; it is then too wide.

    References
    ----------
    JCGM 100:2008, Guide to the expression of uncertainty in measurement, 4.2 and G.3.
    """
    sets = [impacts_of(each) for each in data]
    speed = np.concatenate([each.speed for each in sets])
    values = np.concatenate([each.restitution for each in sets])
    logs, count = np.log(values), values.size
    errors = np.array([each.error for each in sets])
    reading = NORMAL * math.sqrt(float(np.sum(errors**2))) / count  # NaN if one is not given
    if count < 2 and math.isnan(reading):
        few = "contacts have one ratio of flights" if not isinstance(data[0], Drops) else "drop has no scatter"
        raise Hint(
            f"{'three' if few.startswith('c') else 'one'} {few}, from which an interval follows",
            "five drops or more, or error = the standard uncertainty of a reading",
            ["data"],
        )
    scatter = float(stdtrit(count - 1, 0.975)) * logs.std(ddof=1) / math.sqrt(count) if count > 1 else 0.0
    half = scatter if math.isnan(reading) else max(scatter, reading)
    mean = float(logs.mean())
    trend = Trend.of(speed, logs)
    warnings = [
        *_unit_notes(data),
        *_same_values(half),
        *_missed(logs),
        *_different_sets(sets),
        *trend.warnings(),
    ]
    return _dataset(
        sets, {"value": mean, "lower": mean - half, "upper": min(mean + half, 0.0)}, trend, speed, values, warnings
    )


class Trend(NamedTuple):
    """Power law e ~ v^q through the restitutions."""

    exponent: float
    half: float
    slowest: float  # Range of the approach speeds [m/s]
    fastest: float
    is_significant: bool

    @classmethod
    def of(cls, speed: FloatArray, logs: FloatArray) -> Trend:
        """Return the trend of the logarithms of restitutions over approach speeds."""
        x = np.log(speed)
        ends = float(speed.min()), float(speed.max())
        spread = float(np.sum((x - x.mean()) ** 2))
        if x.size < 4 or np.ptp(x) < 0.05:
            return cls(math.nan, math.nan, *ends, False)
        exponent = float((x - x.mean()) @ logs / spread)
        rest = logs - logs.mean() - exponent * (x - x.mean())
        half = float(stdtrit(x.size - 2, 1 - _SIGNIFICANT / 2)) * math.sqrt(float(rest @ rest) / (x.size - 2) / spread)
        matters = abs(exponent) * np.ptp(x) > _SMALL_CHANGE
        return cls(exponent, half, *ends, bool(matters and abs(exponent) > half))

    def warnings(self) -> Iterator[str]:
        """Yield a warning if the restitution depends on the speed."""
        if self.is_significant:
            speeds = f"{amount(self.slowest, 'm/s', 2)} to {amount(self.fastest, 'm/s', 2)}"
            yield (
                f"warning: the restitution depends on the approach speed, about as v^{self.exponent:.2g} "
                f"(± {self.half:.2g}) from {speeds}, so that one value is wrong at other speeds; try: a law over the speed, "
                "such as rb.Tabulated of `restitution` over `approach_speed`, or drops from heights near your speed"
            )


def _unit_notes(data: Sequence[Contacts]) -> Iterator[str]:
    for each in data:
        name, si = ("height", "m") if isinstance(each, Drops) else ("times", "s")
        largest = float(each.height.max()) if isinstance(each, Drops) else float(max(row[-1] for row in each.times))
        if each.unit is None:
            yield f"note: {name} has no unit, {si} is assumed: the largest is {largest:.4g} {si}"
        if isinstance(each, Drops) and largest > _HIGH_DROP:
            yield f"warning: a drop from {largest:.4g} m; check the unit of height"


def _same_values(half: float) -> Iterator[str]:
    if half < 1e-9:
        yield (
            "warning: all restitutions are equal, so that the interval has no width; try: error = the standard uncertainty "
            "of a reading"
        )


def _missed(logs: FloatArray) -> Iterator[str]:
    """Yield a warning about a restitution that differs much from the others."""
    apart = np.abs(logs - np.median(logs))
    limit = max(_MISSED, 5 * 1.4826 * float(np.median(apart)))
    if logs.size > 3 and (apart > limit).any():
        k = int(np.argmax(apart))
        yield (
            f"warning: restitution {k + 1}, {math.exp(logs[k]):.3g}, differs much from the median, "
            f"{math.exp(float(np.median(logs))):.3g}; try: look for a missed contact, a swapped number or an oblique rebound"
        )


def _different_sets(sets: Sequence[Impacts]) -> Iterator[str]:
    """Yield a warning if the means of several measurements differ by more than their scatter."""
    logs = [np.log(each.restitution) for each in sets if each.restitution.size > 1]
    if len(logs) < 2:
        return
    from scipy.stats import f_oneway

    if float(f_oneway(*logs).pvalue) < _SIGNIFICANT:
        means = ", ".join(f"{math.exp(float(each.mean())):.3g}" for each in logs)
        yield (
            f"warning: the restitutions of the measurements, {means}, differ by more than their scatter, so that the "
            "interval of the mean of all is too narrow; try: one call for each; or look for differences in speed or plate"
        )


def _dataset(
    sets: Sequence[Impacts],
    found: dict[str, float],
    trend: Trend,
    speed: FloatArray,
    values: FloatArray,
    warnings: list[str],
) -> xarray.Dataset:
    import xarray

    words = {"value": "restitution", "lower": "lower 95 % limit", "upper": "upper 95 % limit"}
    number = np.repeat(np.arange(len(sets)), [each.speed.size for each in sets])
    parts: dict[str, Any] = {
        name: ("parameter", [math.exp(found[name])], {"units": "1", "long_name": text}) for name, text in words.items()
    }
    pure = {"units": "1"}
    parts |= {
        "approach_speed": ("impact", speed, {"units": "m/s", "long_name": "approach speed"}),
        "restitution": ("impact", values, pure | {"long_name": "restitution of each impact"}),
        "data_set": ("impact", number, pure | {"long_name": "number of the measurement"}),
        "exponent": ((), trend.exponent, pure | {"long_name": "exponent of the approach speed"}),
        "exponent_interval": ((), trend.half, pure | {"long_name": "half of the 95 % interval of the exponent"}),
    }
    return xarray.Dataset(
        parts,
        {"parameter": ["restitution"], "unit": ("parameter", ["1"])},
        {"title": "Calibration of the restitution", "warnings": warnings},
    )
