"""Report about a frequency response."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rattlebox._util.quantities import MISSING, amount
from rattlebox.plots.response import plot_frequency_response
from rattlebox.report import study_words as words
from rattlebox.report.arguments import measures_argument, options_of
from rattlebox.report.parts import Call, Table
from rattlebox.studies.work.reductions import Motion

if TYPE_CHECKING:
    import xarray as xr


def _question(response: xr.Dataset) -> str:
    low, high = (words.axis_value(response.frequency, end) for end in response.frequency.values[[0, -1]])
    return f"Which steady motion does {words.system_words(response)} have from {low} to {high}, at {_levels(response)}?"


def _levels(response: xr.Dataset) -> str:
    levels = [words.axis_value(response.level, level) for level in response.level.values]
    return f"a level of {levels[0]}" if len(levels) == 1 else f"levels of {', '.join(levels)}"


class _Peak(NamedTuple):
    """Largest amplitude [m] of a sweep, its frequency [Hz], and the largest amplitude without dampers [m]."""

    level: str
    direction: str
    frequency: float
    amplitude: float
    bare: float


def _peaks(response: xr.Dataset, level: float) -> Iterator[_Peak]:
    """Yield the peak of each direction at a level."""
    at_level = response.sel(level=level)
    name, bare = words.axis_value(response.level, level), float(at_level.bare_amplitude.max())
    for direction in response.direction.values:
        line = at_level.amplitude.sel(direction=direction).values
        known = np.isfinite(line).any()
        k = int(np.nanargmax(line)) if known else 0
        frequency, amplitude = (float(response.frequency[k]), float(line[k])) if known else (np.nan, np.nan)
        yield _Peak(name, str(direction), frequency, amplitude, bare)


def _answer(response: xr.Dataset) -> Iterator[str]:
    for level in response.level.values:
        known = [peak for peak in _peaks(response, level) if np.isfinite(peak.amplitude)]
        if known:
            peak = max(known, key=lambda peak: peak.amplitude)
            times = ""
            if peak.bare > 0:
                times = f", {peak.amplitude / peak.bare:.2g} times the {amount(peak.bare, 'm')} without damper"
            yield (
                f"At a level of {peak.level} the largest amplitude is {amount(peak.amplitude, 'm')} at "
                f"{amount(peak.frequency, 'Hz')}{times}."
            )
    if {"up", "down"} <= set(map(str, response.direction.values)):
        yield from _agreement(response.amplitude)
    irregular = float((response.period == 0).mean())
    if irregular > 0:
        share = amount(irregular, "%", 2)
        transient = float((response.motion == Motion.TRANSIENT).mean()) if "motion" in response else 0.0
        still = f", at {amount(transient, '%', 2)} because it is still transient" if transient else ""
        yield f"At {share} of the points the motion is not periodic{still}; amplitudes there are first harmonics."


def _agreement(amplitude: xr.DataArray) -> Iterator[str]:
    """Yield a sentence about the difference of upward and downward sweep, where both have an amplitude."""
    low, high = amplitude.min("direction", skipna=False), amplitude.max("direction", skipna=False)
    compared = int(high.count())
    if not compared:
        return
    where = "" if compared == high.size else f", where both are computed ({compared} of {high.size} points)"
    share = int((high - low > 0.02 * high).sum()) / compared
    if share == 0:
        yield f"The upward and the downward sweep agree within 2 %{where or ' at all frequencies'}."
    else:
        yield (
            f"The upward and the downward sweep differ by more than 2 % at {amount(share, '%', 2)} of the points{where}: "
            "two steady motions coexist there, or the motion is irregular."
        )


def _tables(response: xr.Dataset) -> Iterator[Table]:
    rows = []
    peaks = (peak for level in response.level.values for peak in _peaks(response, level))
    for level, direction, frequency, peak, bare in peaks:
        ratio = f"{peak / bare:.3g}" if bare > 0 and np.isfinite(peak) else MISSING
        rows.append((level, direction, amount(frequency, "Hz"), amount(peak, "m"), amount(bare, "m"), ratio))
    header = ("level", "sweep", "frequency of the peak", "largest amplitude", "without dampers", "ratio")
    yield Table("Peaks of the response", header, rows, numbers=True)


def _call(response: xr.Dataset) -> Call:
    directions = response.direction.values.tolist()
    measures, remarks = measures_argument(response, ("peak", "rms", "impacts_per_cycle"))
    return Call(
        "frequency_response",
        {
            "frequencies": response.frequency.values.tolist(),
            "levels": [f"{float(level)!r} {response.level.attrs['units']}" for level in response.level.values],
            "direction": "both" if len(directions) > 1 else directions[0],
            **({"measure": measures} if measures else {}),
            **options_of(response, "cycles", "samples", "point", "tolerance"),
        },
        "" if remarks else "frequency_response",
        remarks,
    )


KIND = words.study_kind(
    "Frequency response",
    _question,
    _answer,
    _call,
    words.picture(
        plot_frequency_response,
        "Amplitude of the first harmonic and impacts per cycle over frequency. Solid lines: upward; dashed: downward; "
        "shaded: two coexisting motions; crosses: motion that is not periodic; grey: structure without dampers.",
    ),
    tables=_tables,
)
