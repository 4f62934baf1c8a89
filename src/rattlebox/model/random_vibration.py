"""Random vibration with a given power spectral density."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, WithJsonSchema, model_validator

from rattlebox._util.exceptions import ResourceError
from rattlebox._util.frozen import complete

from .density_files import read_density
from .elementwise import Vector
from .errors import Hint, at, nearest, one_of
from .file_signals import FileSignal
from .files import absolute
from .records import Column, as_columns
from .signals import UNIT_NAMES, UNITS, Points, Signal, Unit
from .units import (
    MOST_MEMORY,
    STANDARD_GRAVITY,
    PositiveFrequency,
    PositiveTime,
    Whole,
    factor_of,
    parse,
    parse_density,
)

if TYPE_CHECKING:
    from typing import Self

POINTS_PER_PERIOD = 16
"""Fewest points in a period of the highest frequency of random vibration."""

_BYTES = 60  # memory of a point during the transform

LEVELS: dict[str, tuple[tuple[float, float], ...]] = {
    "gevs_qualification": ((20.0, 0.026), (50.0, 0.16), (800.0, 0.16), (2000.0, 0.026)),
    "gevs_acceptance": ((20.0, 0.013), (50.0, 0.08), (800.0, 0.08), (2000.0, 0.013)),
    "truck_vertical": ((10.0, 0.015), (40.0, 0.015), (500.0, 0.00015)),
    "truck_transverse": (
        *((10.0, 0.00013), (20.0, 0.00065), (30.0, 0.00065), (78.0, 0.00002), (79.0, 0.00019)),
        *((120.0, 0.00019), (500.0, 0.00001)),
    ),
    "truck_longitudinal": (
        *((10.0, 0.0065), (20.0, 0.0065), (120.0, 0.0002), (121.0, 0.003), (200.0, 0.003)),
        *((240.0, 0.0015), (340.0, 0.00003), (500.0, 0.00015)),
    ),
    "minimum_integrity": ((20.0, 0.04), (1000.0, 0.04), (2000.0, 0.01)),
}
"""Named densities: frequency [Hz] and density [g^2/Hz]."""

Density = Annotated[
    str | tuple[tuple[float, float], ...],
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": list(LEVELS)},
                {
                    "type": "array",
                    "items": {
                        "type": "array",
                        "items": {"anyOf": [{"type": "number"}, {"type": "string"}]},
                        "minItems": 2,
                        "maxItems": 2,
                    },
                },
            ],
            "examples": [[["20 Hz", "0.01 g^2/Hz"], ["2 kHz", "0.01 g^2/Hz"]]],
        }
    ),
]


class Random(FileSignal):
    """Gaussian random vibration with a given power spectral density.

    The signal consists of straight lines between points. Its expected density up to the highest frequency of `psd` is exact,
    and less than 0.1 % of the power is above that frequency.

    Parameters
    ----------
    psd
        Break points (frequency [Hz], one-sided density), numbers or text with units: ("20 Hz", "0.04 g^2/Hz"). The density
        is linear in log-log scales between points, and zero outside. Or a name: "gevs_qualification" (14.1 g RMS, 20 to
        2000 Hz, 0.16 g^2/Hz from 50 to 800 Hz) or "gevs_acceptance" (10.0 g RMS, half of that density), for components of
        up to 22.7 kg. After MIL-STD-810: "truck_vertical" (1.04 g RMS, 10 to 500 Hz), "truck_transverse" (0.20 g) and
        "truck_longitudinal" (0.74 g), cargo on highways, and "minimum_integrity" (7.7 g, 20 to 2000 Hz, 0.04 g^2/Hz up to
        1 kHz). The break points of these four were not compared with the printed standard, only their RMS values with those
        stated for them, and editions differ: check `corners` with your copy before a test.
    file
        File with the density, instead of `psd`: a table of frequencies and densities (text, spreadsheet, NPY, NPZ, MAT), or
        a power spectral density (type 9) of a universal file. The unit is that above the column or of the label, such
        as "g^2/Hz" or "(m/s^2)^2/Hz"; a file that states none needs `unit`. The density is read as one-sided, unless the
        file says "two-sided"; a line at 0 Hz is left out.
    columns
        Columns of frequency and density of a table, by number from 1 or by name, as of `rb.Record`; or number or name of
        the function of a universal file. Needed if there are more.
    duration
        Length [s], at least that of the run; the last point is at the duration or the first after it.
    rate
        Points per second [Hz]. There are at least 16 points in a period of the highest frequency: a lower rate is raised to
        that, which is the default.
    seed
        Random seed of the amplitudes. The signal depends on seed and duration, not on the rate. Simultaneous signals in
        several directions need different seeds.
    unit
        Unit of the signal, whose square per Hz is the unit of densities without one: "N", "m/s^2", "m", or another of these
        dimensions, such as "g", "gal", "kN" or "mm".

    Notes
    -----
    The signal is a sum of harmonics at the multiples of 1 / duration, whose sine and cosine amplitudes are independent
    Gaussian numbers of variance S(f) / duration (compare Shinozuka and Deodatis 1991). The mean square of one realisation of
    bandwidth B has a relative standard deviation of about 1 / sqrt(B duration), like that of measured vibration.
    Linear interpolation at the rate R multiplies the amplitude at f by sinc^2(f / R) = (sin(pi f / R) / (pi f / R))^2; the
    amplitudes are divided by this factor. It also adds images at k R +- f with sinc^2(k +- f / R) of the amplitude: at 16
    points per period, less than 4e-5 of the power.

    References
    ----------
    M. Shinozuka, G. Deodatis (1991): Simulation of stochastic processes by spectral representation. Applied Mechanics
    Reviews 44, 191-204, doi:10.1115/1.3119501.

    NASA Goddard Space Flight Center (2013): General Environmental Verification Standard for GSFC Flight Programs and
    Projects, GSFC-STD-7000A, Table 2.4-3, generalized random vibration test levels of components of 22.7 kg or less.

    MIL-STD-810F (2000), Method 514.5, Vibration, Annex C: where to look up the highway truck exposures and the general
    minimum integrity exposure.

    Examples
    --------
    >>> import rattlebox as rb
    >>> shaking = rb.Random([("20 Hz", "0.01 g^2/Hz"), ("2 kHz", "0.01 g^2/Hz")], "0.5 s", direction="x")
    >>> round(shaking.rms / 9.80665, 2)
    4.45
    """

    positional: ClassVar[tuple[str, ...]] = ("psd", "duration", "rate")
    file_fields: ClassVar[tuple[str, ...]] = ("psd",)
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("psd", "file"),)
    spectra: ClassVar[tuple[str, ...]] = ("psd", "third_octaves")
    is_density: ClassVar[bool] = True
    kind: Literal["random"] = "random"
    psd: Density
    duration: PositiveTime
    rate: PositiveFrequency | None = None
    seed: Annotated[Whole, Field(ge=0)] = 0
    file: str | None = None
    columns: tuple[Column, Column] | tuple[Column] | str | None = None
    _unit_is_assumed: bool = PrivateAttr(default=False)

    @model_validator(mode="wrap")
    @classmethod
    def _from_file(cls, values: object, handler: Any) -> Random:
        if not isinstance(values, dict) or values.get("file") is None:
            if isinstance(values, dict) and values.get("columns") is not None:
                raise Hint("columns need a file", 'file = "psd.csv"', ["columns"])
            kept: Random = handler(values)
            return kept
        one_of('file = "psd.csv"', psd=values.get("psd"), file=values["file"])
        given = values.get("unit")
        with at("file"):
            path = absolute(values["file"])
        with at("columns"):
            columns = values.get("columns")
            if columns == "rows":
                raise Hint("a density has no rows of samples", "columns = [1, 2]")
            columns = as_columns(columns)
        with at("file"):
            corners, unit, notes = read_density(path, columns, given if isinstance(given, str) else None)
        fields = {"psd": tuple(map(tuple, corners.tolist())), "unit": unit, "file": path, "columns": columns}
        random: Random = handler({**values, **fields})
        complete(random, _unit_as_given=given, _notes=notes)
        return random

    @model_validator(mode="before")
    @classmethod
    def _in_si(cls, values: object) -> Any:
        if not isinstance(values, dict) or values.get("psd") is None:
            return values
        if isinstance(values["psd"], str):
            if values["psd"] not in LEVELS:
                raise Hint("there is no density of this name", nearest(values["psd"], LEVELS), ["psd"])
            if values.get("unit") not in (None, "m/s^2"):
                raise Hint(f"{values['psd']} is an acceleration", "leave unit out", ["unit"])
            return {**values, "unit": "m/s^2"}
        corners, unit = _densities(values["psd"], values.get("unit"))
        return {**values, "psd": tuple(map(tuple, corners.tolist())), "unit": unit}

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], duration: float | str, **options: Any) -> Random:
        """Read a random vibration from a file with its power spectral density.

        Parameters
        ----------
        path
            The file; see `file`.
        duration
            Length [s].
        **options
            Other fields: columns, unit, rate, seed, point, direction.

        Returns
        -------
        Random
            The random vibration.

        Raises
        ------
        DataError
            If the file cannot be read, or does not state what its numbers are.
        CaseError
            If other fields are not valid.
        """
        return cls(file=os.fspath(path), duration=duration, **options)

    def notes(self) -> Iterator[str]:
        """Yield notes on assumptions about the file, with the RMS value that follows from them."""
        yield from self._notes
        if self.file is not None:
            in_g = f" = {self.rms / STANDARD_GRAVITY:.4g} g" if self.unit == "m/s^2" else ""
            first, last = self.corners[0, 0], self.corners[-1, 0]
            name = " ".join(Path(self.file).name.split())
            yield f"{name} is read as {self.rms:.4g} {self.unit}{in_g} RMS from {first:.6g} to {last:.6g} Hz"

    @property
    def is_lasting(self) -> bool:
        """Whether it continues to the end of every run: always, since it is at least as long."""
        return True

    @model_validator(mode="after")
    def _in_the_band(self) -> Self:
        rate, count = self._sampling
        if _BYTES * count > MOST_MEMORY:  # before any array is made
            raise ResourceError(
                f"{count:.3g} points at {rate:g} Hz would take {1e-9 * _BYTES * count:.3g} GB",
                f'duration = "{0.9 * MOST_MEMORY / (_BYTES * rate):.2g} s", or a lower highest frequency in psd',
                ["duration"],
            )
        if not self._harmonics.size:
            raise Hint(
                f"a signal of {self.duration:g} s has no frequency in the band: its frequencies are multiples of"
                f" {1 / self.duration:.4g} Hz",
                "a longer duration",
                ["duration"],
            )
        return self

    def placed(self, allowed: Sequence[Unit], place: str) -> Signal:
        """Return the signal with the unit of the field in which it is used; see `Signal.placed`."""
        placed = super().placed(allowed, place)
        if self.unit is None:
            complete(placed, _unit_is_assumed=True)
        return placed

    @property
    def unit_is_assumed(self) -> bool:
        """Whether the densities have no unit, and that of the field in which they are used is assumed."""
        return self._unit_is_assumed

    @property
    def corners(self) -> NDArray[np.float64]:
        """Break points of the density, (n, 2): frequency [Hz] and density [unit^2/Hz]."""
        if isinstance(self.psd, str):
            return np.array(LEVELS[self.psd]) * (1.0, STANDARD_GRAVITY**2)
        return np.array(self.psd)

    @property
    def levels(self) -> NDArray[np.float64]:
        """The corners."""
        return self.corners

    def with_levels(self, levels: NDArray[np.float64]) -> Random:
        """Return random vibration with another density, (n, 2), in SI units."""
        own = {"duration": self.duration, "rate": self.rate, "seed": self.seed, "direction": self.direction}
        given = {name: value for name, value in own.items() if value is not None}
        return Random(psd=[tuple(row) for row in levels.tolist()], unit=self.unit, **given)

    @property
    def rms(self) -> float:
        """Root of the expected mean square, which is the integral of the density over the frequency."""
        (f, g), (f2, g2) = self.corners[:-1].T, self.corners[1:].T
        slope = np.log(g2 / g) / np.log(f2 / f) + 1
        flat = np.abs(slope) < 1e-12  # density as 1 / f
        area = np.where(flat, g * f * np.log(f2 / f), (g2 * f2 - g * f) / np.where(flat, 1.0, slope))
        return float(math.sqrt(area.sum()))

    @property
    def times(self) -> Vector:
        """Times of the points, (n,) [s]."""
        return self._points.times

    @property
    def values(self) -> Vector:
        """Values at the points, (n,), in `unit`."""
        return self._points.values

    def words(self) -> str:
        """Return a phrase."""
        return f"random {self._quantity}"

    def polyline(self) -> tuple[Vector, Vector]:
        """Return times [s] and values of the points."""
        return self._points.times, self._points.values

    @property
    def _sampling(self) -> tuple[float, int]:
        """Rate [Hz] and number of intervals."""
        rate = max(self.rate or 0.0, POINTS_PER_PERIOD * float(self.corners[-1, 0]))
        return rate, math.ceil(self.duration * rate * (1 - 1e-12))  # 0.07 s of 100 Hz may be a little more than 7

    @property
    def _harmonics(self) -> NDArray[np.intp]:
        """Indices of the harmonics in the band."""
        rate, count = self._sampling
        frequency = np.fft.rfftfreq(count, 1 / rate)
        return np.flatnonzero((frequency >= self.corners[0, 0]) & (frequency <= self.corners[-1, 0]))

    @cached_property
    def _points(self) -> Points:
        rate, count = self._sampling
        frequency = np.fft.rfftfreq(count, 1 / rate)
        inside = self._harmonics
        logs = np.log(self.corners)
        density = np.exp(np.interp(np.log(frequency[inside]), logs[:, 0], logs[:, 1]))
        noise = np.random.default_rng(self.seed).standard_normal((inside.size, 2)) @ (1, 1j)
        spectrum = np.zeros(frequency.size, complex)
        spectrum[inside] = np.sqrt(density * rate * count / 4) * noise / np.sinc(frequency[inside] / rate) ** 2
        values = np.fft.irfft(spectrum, count)
        return Points(np.arange(count + 1) / rate, np.append(values, values[0]))


def _densities(psd: Any, unit: str | None) -> tuple[NDArray[np.float64], Any]:
    """Return the points of a density in SI, (n, 2), and the SI unit of the signal."""
    factor, found = 1.0, None
    if unit is not None:
        with at("unit"):
            known = factor_of(unit, UNITS) if isinstance(unit, str) else None
            if known is None:
                raise Hint(f"{unit!r} is not a unit of force, acceleration or displacement", 'unit = "g"')
            factor, found = known
    corners = []
    with at("psd"):
        needed = "a PSD needs positive (frequency, density) pairs with rising frequencies"
        advice = '[(10, 1e-3), (200, 1e-3)] or [(10, "0.04 g^2/Hz"), (200, "0.04 g^2/Hz")]'
        if isinstance(psd, (str, Mapping)) or np.ndim(np.asarray(psd, dtype=object)) != 2 or np.shape(psd)[1] != 2:
            raise Hint(needed, advice)
        for index, (frequency, density) in enumerate(psd):
            with at(index):
                with at(0):
                    hertz = parse(frequency, ("Hz",))[0]
                with at(1):
                    number, own = parse_density(density, UNITS)
                    if own is not None and found not in (None, own):
                        raise Hint(
                            f"the density of {UNIT_NAMES[own]}, but others are of {UNIT_NAMES[str(found)]}", "one unit"
                        )
            found = own or found
            corners.append((hertz, number if own else number * factor**2))
        points = np.array(corners).reshape(-1, 2)
        if not points.size or np.any(points <= 0) or np.any(np.diff(points[:, 0]) <= 0):
            raise Hint(needed, advice)
    return points, found
