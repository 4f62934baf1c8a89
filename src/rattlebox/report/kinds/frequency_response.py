"""Report about a frequency response."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.quantities import MISSING, amount
from rattlebox.plots.response import plot_frequency_response
from rattlebox.report import study_words as words
from rattlebox.report.kinds.sweep import KIND as SWEEP
from rattlebox.report.kinds.sweep import measures_argument, options_of, system_words
from rattlebox.report.parts import Call, Kind, Picture, Table
from rattlebox.studies.work.orbits import Motion

if TYPE_CHECKING:
    import xarray as xr


def _question(response: xr.Dataset) -> str:
    low, high = (words.axis_value(response.frequency, end) for end in response.frequency.values[[0, -1]])
    return f"Which steady motion does {system_words(response)} have from {low} to {high}, at {_levels(response)}?"


def _levels(response: xr.Dataset) -> str:
    levels = [words.axis_value(response.level, level) for level in response.level.values]
    return f"a level of {levels[0]}" if len(levels) == 1 else f"levels of {', '.join(levels)}"


def _peaks(response: xr.Dataset) -> Iterator[tuple[str, str, float, float, float]]:
    """Yield level, direction, and frequency [Hz], amplitude [m] and bare amplitude [m] of the largest amplitude."""
    for level in response.level.values:
        for direction in response.direction.values:
            line = response.amplitude.sel(level=level, direction=direction).values
            bare = float(response.bare_amplitude.sel(level=level).max())
            if not np.isfinite(line).any():
                yield words.axis_value(response.level, level), str(direction), np.nan, np.nan, bare
                continue
            k = int(np.nanargmax(line))
            yield (
                words.axis_value(response.level, level),
                str(direction),
                float(response.frequency[k]),
                float(line[k]),
                bare,
            )


def _answer(response: xr.Dataset) -> Iterator[str]:
    if unfinished := words.progress_sentence(response):
        yield unfinished
    for level in response.level.values:
        lines = response.amplitude.sel(level=level)
        if not np.isfinite(lines.values).any():
            continue
        flat = lines.values.ravel()
        k = np.unravel_index(int(np.nanargmax(flat)), lines.shape)
        peak, bare = float(lines.values[k]), float(response.bare_amplitude.sel(level=level).max())
        at = response.frequency.values[k[lines.dims.index("frequency")]]
        times = f", {peak / bare:.2g} times the {amount(bare, 'm')} without damper" if bare > 0 else ""
        yield (
            f"At a level of {words.axis_value(response.level, level)} the largest amplitude is {amount(peak, 'm')} at "
            f"{amount(float(at), 'Hz')}{times}."
        )
    if {"up", "down"} <= set(map(str, response.direction.values)):
        yield from _agreement(response.amplitude)
    irregular = float((response.period == 0).mean())
    if irregular > 0:
        where = amount(irregular, "%", 2)
        transient = float((response.motion == Motion.TRANSIENT).mean()) if "motion" in response else 0.0
        still = f", at {amount(transient, '%', 2)} because it is still transient" if transient else ""
        yield f"At {where} of the points the motion is not periodic{still}; amplitudes there are first harmonics."


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


def _pictures(response: xr.Dataset) -> Iterator[Picture]:
    yield Picture(
        "Amplitude of the first harmonic and impacts per cycle over frequency. Solid lines: upward; dashed: downward; "
        "shaded: two coexisting motions; crosses: motion that is not periodic; grey: structure without dampers.",
        partial(plot_frequency_response, response, size="page"),
    )


def _tables(response: xr.Dataset) -> Iterator[Table]:
    rows = [
        (
            level,
            direction,
            amount(frequency, "Hz"),
            amount(peak, "m"),
            amount(bare, "m"),
            f"{peak / bare:.3g}" if bare > 0 and np.isfinite(peak) else MISSING,
        )
        for level, direction, frequency, peak, bare in _peaks(response)
    ]
    header = ("level", "sweep", "frequency of the peak", "largest amplitude", "without dampers", "ratio")
    yield Table("Peaks of the response", header, rows, numbers=True)


def _call(response: xr.Dataset) -> Call:
    directions = [str(each) for each in response.direction.values]
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


KIND = Kind(
    name="Frequency response",
    cases=words.cases_of,
    question=_question,
    answer=_answer,
    call=_call,
    pictures=_pictures,
    tables=_tables,
    warnings=SWEEP.warnings,
    limits=SWEEP.limits,
    about=SWEEP.about,
)
