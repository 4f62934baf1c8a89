"""Report about a calibration of contact parameters."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import MISSING, amount, span
from rattlebox.plots.calibration import plot_calibration
from rattlebox.plots.labels import capitalised
from rattlebox.report import study_words as words
from rattlebox.report.limits import limit
from rattlebox.report.parts import Call, Kind, Limit, Picture, Table

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox.model.case import Case

_INTERVALS = (("lower", "upper"), ("smallest", "largest"))
"""Ends of the 95 % interval of a parameter, and of the range that was searched."""


def _by_simulation(result: xr.Dataset) -> bool:
    return "simulated" in result


def _cases(result: xr.Dataset) -> Mapping[str, Case]:
    return words.cases_of(result) if _by_simulation(result) else {}


def _names(result: xr.Dataset) -> list[str]:
    return [str(path).removeprefix("damper.").replace(".", " ").replace("_", " ") for path in result.parameter.values]


def _question(result: xr.Dataset) -> str:
    if not _by_simulation(result):
        return f"Which restitution do {counted(result.sizes['impact'], 'measured impact')} show?"
    measures = joined([name.replace("_", " ") for name in dict.fromkeys(result.measure.values.tolist())])
    data = counted(result.sizes["datum"], "measured value")
    return f"Which {joined(_names(result))} of {words.damper_words(result)} follow from {data} of {measures}?"


def _answer(result: xr.Dataset) -> Iterator[str]:
    for k, parameter in enumerate(_names(result)):
        unit = str(result.unit.values[k])
        value, lower, upper = (float(result[name][k]) for name in ("value", "lower", "upper"))
        yield f"The {parameter} is {amount(value, unit, 3)} (95 % interval {span(lower, upper, unit, 3)})."
    if not _by_simulation(result):
        slow, fast = float(result.approach_speed.min()), float(result.approach_speed.max())
        ends = amount(slow, "m/s", 3) + (f" to {amount(fast, 'm/s', 3)}" if fast > 1.001 * slow else "")
        yield f"It holds for approach speeds of {ends}."
        return
    freedom = int(result.attrs["degrees_of_freedom"])
    if freedom > 0:
        yield (
            f"At these values chi² is {float(result.attrs['chi2']):.3g} with {counted(freedom, 'degree')} of freedom; a "
            f"larger one has a probability of {amount(float(result.attrs['p_value']), '%', 2)}."
        )
    for line in _list(result.attrs.get("undetermined")):
        yield capitalised(line.removeprefix("warning: ").partition("; try:")[0]) + "."


def _list(value: Any) -> list[str]:
    """Return an attribute as a list of texts; a file holds a list of one as text."""
    texts = [] if value is None else [value] if isinstance(value, str) else value
    return [str(text) for text in texts if str(text)]


def _pictures(result: xr.Dataset) -> Iterator[Picture]:
    if not _by_simulation(result):
        caption = "Restitution of each impact over its approach speed, with the mean and its 95 % interval."
    else:
        caption = (
            "Simulated values at the result over the measured ones, with bars of two standard deviations; and "
            + (
                "the region of the parameters that agree with the data: the line is the threshold of the 95 % intervals."
                if result.sizes["parameter"] == 2
                else "chi² over each parameter, the least over all others; the line is the threshold of the 95 % interval."
            )
        )
    yield Picture(caption, partial(plot_calibration, result, size="page"))


def _tables(result: xr.Dataset) -> Iterator[Table]:
    if not _by_simulation(result):
        return
    rows: list[tuple[str, ...]] = []
    for k in range(result.sizes["parameter"]):
        one = result.isel(parameter=k)
        unit = str(one.unit.item())
        is_bounded = bool(one.is_lower_bounded & one.is_upper_bounded)
        intervals = [span(float(one[low]), float(one[high]), unit, 3) for low, high in _INTERVALS]
        value = amount(float(one.value), unit, 3)
        rows.append((str(one.parameter.item()), value, *intervals, "yes" if is_bounded else "no"))
    header: tuple[str, ...] = ("parameter", "value", "95 % interval", "range", "bounded by the data")
    yield Table("Parameters", header, rows, numbers=True)
    rows = []
    for k in range(result.sizes["datum"]):
        one = result.isel(datum=k)
        measure, frequency = str(one.measure.item()), float(one.frequency)
        unit = "J" if measure == "loss_per_cycle" else "1"
        at = amount(float(one.amplitude), str(one.amplitude_unit.item()))
        values = [amount(float(one[name]), unit, 3) for name in ("measured", "error", "check", "check_deviation")]
        hertz = amount(frequency, "Hz") if np.isfinite(frequency) else MISSING
        rows.append((measure.replace("_", " "), at, hertz, *values))
    header = ("measure", "amplitude", "frequency", "measured", "uncertainty", "simulated", "scatter of packings")
    note = "Simulated: mean of further packings at the result, which did not enter the fit."
    yield Table("Data", header, rows, note, numbers=True)


def _limits(result: xr.Dataset) -> Iterator[Limit]:
    if not _by_simulation(result):
        yield limit("impacts", "statistical error", counted(result.sizes["impact"], "impact"))
        exponent = float(result.exponent)
        if np.isfinite(exponent):
            yield limit("impacts", "speed", f"as v^{exponent:.2g} ± {float(result.exponent_interval):.2g}")
        return
    yield limit("calibrate", "samples", f"{result.attrs['samples']} samples, {result.attrs['checks']} checks")
    apart = np.abs(result.check - result.fitted) / np.hypot(result.error, result.scatter)
    yield limit("calibrate", "response surface", f"{float(apart.max()):.2g} standard deviations, largest")
    yield limit("calibrate", "model", "assumed to be right")
    yield from (shared for shared in words.study_limits(result) if shared.name != "statistical error")


def _call(result: xr.Dataset) -> Call:
    data = _list(result.attrs.get("data"))
    source = data[0] if len(data) == 1 else f"[{', '.join(data)}]"
    if not _by_simulation(result):
        return Call("calibrate", first=source)
    ranges = zip(result.parameter.values.tolist(), result.smallest.values, result.largest.values, strict=True)
    arguments: dict[str, Any] = {"parameters": {path: (float(low), float(high)) for path, low, high in ranges}}
    if known := json.loads(str(result.attrs["known"])):
        arguments["known"] = {path: tuple(pair) for path, pair in known.items()}
    if logs := _list(result.attrs.get("log")):
        arguments["log"] = logs
    arguments |= {name: int(result.attrs[name]) for name in ("runs", "checks", "seed")}
    return Call("calibrate", arguments, first=source)


KIND: Kind[xr.Dataset] = Kind(
    name="Calibration",
    cases=_cases,
    question=_question,
    answer=_answer,
    call=_call,
    pictures=_pictures,
    tables=_tables,
    warnings=lambda result: _list(result.attrs.get("warnings")),
    limits=_limits,
    about=words.study_about,
)
