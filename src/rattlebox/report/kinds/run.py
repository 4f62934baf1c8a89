"""Report about one run."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import amount, with_interval
from rattlebox.analysis.signals import is_even
from rattlebox.report.limits import readable_case, run_limits
from rattlebox.report.parts import Call, Kind, Picture, Table
from rattlebox.results.case_words import dampers_words, loads_words
from rattlebox.results.summary import Value
from rattlebox.results.wall_measures import wall_pressures, wall_wear

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results.run import Run

_CAPTIONS = {
    "motion": "Displacement of the structure over time, and the motion in each cavity.",
    "energy": "Energies over time, and below them where the energy supplied is lost. The line is the energy supplied.",
    "impacts": "Impacts over time.",
    "psd": "Power spectral density of the absolute acceleration, with its RMS value.",
    "third_octaves": "RMS value of the absolute acceleration in third-octave bands, with the largest one.",
    "shock_spectrum": "Shock response spectrum: largest absolute acceleration of oscillators on the points and on the base.",
    "particles": "The particles at the end of the run, as seen from the base, or from a cavity that turns.",
}
_LOSSES = {
    "viscous": "in the structure",
    "normal": "in normal damping of contacts",
    "plastic": "in plastic flow",
    "sliding": "in sliding",
    "rolling": "in rolling",
}
_SPECTRA = ("psd", "third_octaves", "shock_spectrum")
"""Figures that a report has only for loads and base motions that they suit."""
_MIN_SAMPLES = 512
_MAX_WALLS = 24
"""Most walls in the table."""
_NEGLIGIBLE = 5e-4
"""Share of the energy that is not mentioned."""


def _question(run: Run) -> str:
    case, (start, end) = readable_case(run), run.arrays.time[[0, -1]]
    return case_question(case, start) if case else f"How does the structure move {_span(start, end)}?"


def _span(start: float, end: float) -> str:
    return f"from {amount(start, 's')} to {amount(end, 's')}" if start else f"within {amount(end, 's')}"


def case_question(case: Case, start: float = 0.0) -> str:
    """Return the question that a run of a case answers."""
    span = _span(start, case.duration)
    dampers, loads = dampers_words(case), loads_words(case)
    what = case.structure.words()
    if case.structure.kind in ("shaker", "fixed"):
        return f"How does {dampers or 'the cavity'} move in {what} {span}?"
    what += f" with {dampers}" if dampers else " without dampers"
    how = f"respond to {loads}" if loads else "vibrate freely"
    return f"How does {what} {how} {span}?"


def _answer(run: Run) -> Iterator[str]:
    if not run.ok:
        yield f"The run has the status {run.status}: {run.message}"
    yield from result_sentences(run.summary().values, attached_points(run))


def attached_points(run: Run) -> list[str]:
    """Return the names of the points of tuned masses."""
    case = readable_case(run)
    masses = () if case is None else case.tuned_masses
    return [part.label(number, len(masses)) for number, part in enumerate(masses)]


def result_sentences(values: Mapping[str, Value], leave_out: Sequence[str] = ()) -> Iterator[str]:
    """Yield sentences about the values of the summary of a run."""
    numbers = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
    prefix, hidden = "peak_displacement[", {f"peak_displacement[{name}]" for name in leave_out}
    peaks = {name: value for name, value in numbers.items() if name.startswith(prefix) and name not in hidden}
    if peaks:
        largest = max(peaks, key=lambda name: peaks[name])
        point = largest.partition("[")[2][:-1]
        steady = numbers.get(f"steady_rms_displacement[{point}]")
        half = numbers.get(f"steady_rms_displacement_error[{point}]", math.nan)
        yield f"The peak displacement of {point} is {amount(peaks[largest], 'm')}."
        if steady is not None:
            interval = "95 % interval" if math.isfinite(half) else "the run is too short for a 95 % interval"
            value = with_interval(steady, half, "m")
            yield f"In the second half of the run its RMS displacement is {value} ({interval})."
        else:
            yield f"Its RMS displacement over the run is {amount(numbers[f'rms_displacement[{point}]'], 'm')}."
    if "equivalent_damping_ratio" in numbers:
        ratio, at = numbers["equivalent_damping_ratio"], numbers["damping_amplitude"]
        yield f"The free decay has a damping ratio of {amount(ratio, '%', 3)} at an amplitude of {amount(at, 'm')}."
    supplied, left = numbers.get("supplied_energy", 0.0), numbers.get("share_motion", 0.0)
    shares = {words: numbers.get(f"share_{channel}", 0.0) for channel, words in _LOSSES.items()}
    lost = [f"{amount(share, '%', 3)} {words}" for words, share in shares.items() if share > _NEGLIGIBLE]
    if supplied > 0 and lost:
        lost[0] = lost[0].replace("% in", "% is lost in", 1)
        rest = f"; {amount(left, '%', 3)} is left in the motion" if left > _NEGLIGIBLE else ""
        yield f"Of the {amount(supplied, 'J')} supplied, {joined(lost)}{rest}."
    if "steady_loss_power" in numbers:
        half = numbers.get("steady_loss_power_error", math.nan)
        yield f"The mean power lost in the second half is {with_interval(numbers['steady_loss_power'], half, 'W')}."
    if "impacts" in numbers:
        count = int(numbers["impacts"])
        speed, force = (numbers.get(name, math.nan) for name in ("largest_approach_speed", "peak_contact_force"))
        most = f", the fastest at {amount(speed, 'm/s')}" if math.isfinite(speed) else ""
        most += f", with a peak force of {amount(force, 'N')}" if math.isfinite(force) else ""
        yield f"There {'is' if count == 1 else 'are'} {counted(count, 'impact')}{most}."


def _pictures(run: Run) -> Iterator[Picture]:
    for name, caption in _CAPTIONS.items():
        if name in dir(run.plot) and (name not in _SPECTRA or _has_spectrum(run, name)):
            # Without PyVista, which takes seconds to load, and half as wide, which takes a quarter of the time.
            options = {"renderer": "plain", "size": "column"} if name == "particles" else {"size": "page"}
            yield Picture(caption, partial(getattr(run.plot, name), **options))


def _tables(run: Run) -> Iterator[Table]:
    yield Table("Summary", (), run.summary().lines(), numbers=True)
    if not run.arrays.walls:
        return
    arrays, pressures, wear = run.arrays, wall_pressures(run), wall_wear(run)
    losses = sum(getattr(arrays, f"wall_{channel}_loss")[[0, -1]] for channel in _LOSSES if channel != "viscous")
    largest = np.linalg.norm(arrays.wall_force, axis=2).max(axis=0)
    rows = [
        (
            wall,
            amount(largest[k], "N", 3),
            amount(pressures[wall], "Pa", 3),
            amount(losses[1, k] - losses[0, k], "J", 3),
            amount(wear[wall], "W/m^2", 3),
        )
        for k, wall in enumerate(arrays.walls[:_MAX_WALLS])
    ]
    note = "The largest force is that of the samples. The power of friction over the area is proportional to the wear."
    note += f" {len(arrays.walls) - _MAX_WALLS} more walls are in run.motion." if len(arrays.walls) > _MAX_WALLS else ""
    header = ("wall", "largest force", "mean pressure", "energy lost", "power of friction")
    yield Table("Walls", header, rows, note, numbers=True)


def _has_spectrum(run: Run, name: str) -> bool:
    """Return whether a run has even times and a load or base motion whose response a figure over frequency suits."""
    case = readable_case(run)
    if case is None or not run.arrays.points or run.arrays.time.size < _MIN_SAMPLES or not is_even(run.arrays.time):
        return False
    return any(name in signal.spectra for signal in (*case.loads, *case.base))


def _about(run: Run) -> Iterator[str]:
    origin = run.provenance
    date = f" on {origin.created[:16].replace('T', ' ')} UTC" if origin.created else ""
    yield f"Computed by Rattlebox {origin.version}{date}, {origin.platform}, in {amount(run.wall_time, 's', 3)}."
    if origin.method:
        yield f"Method: {origin.method}."
    if origin.continues:
        yield f"The run continues {origin.continues}. All numbers are of the time from {amount(run.arrays.time[0], 's')} on."


def _call(run: Run) -> Call:
    if not run.provenance.continues:
        return Call("simulate")
    remark = f"first.nc is the saved run that this one continues: {run.provenance.continues}."
    return Call("simulate", {"start": "first.nc"}, remarks=(remark,))


KIND: Kind[Run] = Kind(
    name="Run",
    cases=lambda run: {"": run.case},
    question=_question,
    answer=_answer,
    call=_call,
    pictures=_pictures,
    tables=_tables,
    warnings=lambda run: run.notes,
    limits=run_limits,
    about=_about,
)
