"""Report about damping curves: one dataset of `rb.damping_curve`, or several by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.phrases import joined
from rattlebox._util.quantities import MISSING, amount, digits, span
from rattlebox.model.units import STANDARD_GRAVITY
from rattlebox.plots.damping_curve import plot_damping_curve
from rattlebox.report import study_words as words
from rattlebox.report.limits import limit
from rattlebox.report.parts import Call, Kind, Limit, Picture, Table

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox.model.case import Case

    Curves = xr.Dataset | Mapping[str, xr.Dataset]

_WAYS = {
    "decay": "the decay of the envelope in free vibration",
    "energy": "the energy lost in free vibration",
    "shaking": "the energy lost per cycle in steady motion",
}


def _named(curves: Curves) -> dict[str, xr.Dataset]:
    """Return the curves by name; the name of a single one is empty."""
    import xarray as xr

    return {"": curves} if isinstance(curves, xr.Dataset) else dict(curves)


def _cases(curves: Curves) -> Mapping[str, Case]:
    return {name: words.cases_of(curve)[""] for name, curve in _named(curves).items()}


def _question(curves: Curves) -> str:
    named = _named(curves)
    first = next(iter(named.values()))
    ends = f"{amount(float(first.amplitude.min()), 'm')} to {amount(float(first.amplitude.max()), 'm')}"
    what = f"mode {first.attrs['mode']} ({amount(float(first.attrs['frequency']), 'Hz')})"
    case = words.known_case(first)
    if len(named) == 1:
        system = words.system_words(first) if case else "the structure"
    else:
        system = f"{case.structure.words() if case else 'the structure'} with {joined(list(named))}"
    return f"Which damping ratio does {what} of {system} have at amplitudes from {ends}?"


def _answer(curves: Curves) -> Iterator[str]:
    for name, curve in _named(curves).items():
        subject = f"{name}: the damping ratio" if name else "The damping ratio"
        values = curve.damping_ratio.values
        if not np.isfinite(values).any():
            yield f"{subject} is unknown: no decay passes these amplitudes."
            continue
        best = int(np.nanargmax(values))
        yield f"{subject} is largest, {_at(curve, best)}; the structure alone has {amount(float(curve.bare[best]), '%', 3)}."
        ends = [k for k in (0, len(values) - 1) if k != best and np.isfinite(values[k])]
        if ends:
            yield f"It is {joined([_at(curve, k) for k in ends])}."


def _at(curve: xr.Dataset, k: int) -> str:
    ratio, lower, upper = (float(curve[name][k]) for name in ("damping_ratio", "lower", "upper"))
    interval = "" if not np.isfinite(lower) else f" (95 % interval {span(lower, upper, '%', 3)})"
    return f"{amount(ratio, '%', 3)}{interval} at {amount(float(curve.amplitude[k]), 'm')}"


def _pictures(curves: Curves) -> Iterator[Picture]:
    yield Picture(
        "Damping ratio over the amplitude of vibration. Bands are 95 % intervals of the mean over the random starts; the "
        "grey line is the structure alone.",
        partial(plot_damping_curve, curves, size="page"),
    )


def _tables(curves: Curves) -> Iterator[Table]:
    for name, curve in _named(curves).items():
        per_g = (2 * np.pi * float(curve.attrs["frequency"])) ** 2 / STANDARD_GRAVITY
        rows = [
            (
                amount(float(curve.amplitude[k]), "m"),
                f"{digits(per_g * float(curve.amplitude[k]), 3)} g",
                amount(float(curve.damping_ratio[k]), "%", 3),
                _interval(curve, k),
                str(int(np.isfinite(curve.damping_ratios[:, k]).sum())) if "damping_ratios" in curve else MISSING,
            )
            for k in range(curve.amplitude.size)
        ]
        title = f"Damping ratio, {name}" if name else "Damping ratio"
        yield Table(
            title, ("amplitude", "acceleration", "damping ratio", "95 % interval", "random starts"), rows, numbers=True
        )


def _interval(curve: xr.Dataset, k: int) -> str:
    """Return the interval at an amplitude, or the reason why it has none."""
    if "steady" in curve and not bool(curve.steady[:, k].all()):
        return "not steady"
    return span(float(curve.lower[k]), float(curve.upper[k]), "%", 3)


def _warnings(curves: Curves) -> Iterator[str]:
    for name, curve in _named(curves).items():
        yield from (f"{name}: {line}" if name else line for line in words.study_warnings(curve))


def _limits(curves: Curves) -> Iterator[Limit]:
    first = next(iter(_named(curves).values()))
    way = str(first.attrs.get("way", ""))
    yield limit("damping_curve", "method", _WAYS.get(way, way))
    yield limit("replicas", "statistical error", f"{first.sizes.get('packing', 1)} random starts")
    yield from (shared for shared in words.study_limits(first) if shared.name != "statistical error")


def _call(curves: Curves) -> Call | None:
    named = _named(curves)
    if len(named) > 1:
        return None
    (curve,) = named.values()
    arguments = {
        "amplitudes": curve.amplitude.values.tolist(),
        "way": str(curve.attrs["way"]),
        "mode": int(curve.attrs["mode"]),
        "point": str(curve.attrs["point"]),
    }
    if "packing" in curve.sizes:
        arguments["packings"] = int(curve.sizes["packing"])
    if "cycles" in curve.attrs:
        arguments["cycles"] = [int(number) for number in curve.attrs["cycles"]]
    return Call("damping_curve", arguments)


KIND: Kind[Curves] = Kind(
    name="Damping curve",
    cases=_cases,
    question=_question,
    answer=_answer,
    call=_call,
    pictures=_pictures,
    tables=_tables,
    warnings=_warnings,
    limits=_limits,
    about=lambda curves: words.study_about(next(iter(_named(curves).values()))),
)
