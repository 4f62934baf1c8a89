"""Report about a comparison of runs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, cast

from rattlebox._util.phrases import joined
from rattlebox._util.quantities import amount, with_interval
from rattlebox.plots.compare import plot_comparison
from rattlebox.report.kinds.run import attached_points, result_sentences
from rattlebox.report.limits import readable_case, run_limits
from rattlebox.report.parts import Call, Kind, Limit, Picture, Table
from rattlebox.results.case_words import loads_words
from rattlebox.results.summary import error_of

if TYPE_CHECKING:
    from rattlebox.results.run import Run
    from rattlebox.results.summary import Comparison

_MAX_COLUMNS = 4
"""Most runs in a figure of a comparison."""


def _runs(comparison: Comparison) -> dict[str, Run]:
    return cast("dict[str, Run]", comparison.runs)


def _question(comparison: Comparison) -> str:
    reference = readable_case(next(iter(_runs(comparison).values())))
    names = joined([f"“{name}”" for name in comparison.runs])
    if reference is None:
        return f"How do the variants {names} compare?"
    loads = loads_words(reference)
    under = f" under {loads}" if loads else " in free vibration"
    return f"How do the variants {names} of {reference.structure.words()} compare{under}?"


def _answer(comparison: Comparison) -> Iterator[str]:
    reference = next(iter(comparison.runs))
    for name, run in _runs(comparison).items():
        if not run.ok:
            yield f"{name} has the status {run.status}: {run.message}"
    measures = comparison.measures()
    at = comparison.point if measures and f"[{comparison.point}]" in measures[0][0] else ""
    if at and len(comparison.points) > 1:
        chosen = f", the one with the largest displacement with {reference}" if at == comparison.points[0] else ""
        yield f"All numbers are those of {at}, one of {len(comparison.points)} points{chosen}."
    for name, run in _runs(comparison).items():
        values = comparison.values[name]
        if measures:
            words = [_compared(comparison, name, *measure) for measure in measures]
            words[0] = words[0].replace(" is ", f" of {at} is " if at else " is ", 1)
            yield f"{name}: {', and '.join(words)}."
        else:  # for instance cavities on shakers, which have no point
            yield f"{name}: {' '.join(result_sentences(values, attached_points(run)))}"


def _compared(comparison: Comparison, name: str, key: str, label: str, unit: str) -> str:
    """Return a value of a run with its 95 % interval, and its change against the first run."""
    reference, values = next(iter(comparison.runs)), comparison.values
    value, before = float(values[name][key]), float(values[reference][key])
    half = float(values[name].get(error_of(key), math.nan))
    phrase = f"the {label} is {with_interval(value, half, unit)}"
    if name == reference or not before > 0:
        return phrase
    change = 1 - value / before
    return f"{phrase} ({amount(abs(change), '%', 3)} {'less' if change >= 0 else 'more'} than with {reference})"


def _pictures(comparison: Comparison) -> Iterator[Picture]:
    runs = list(_runs(comparison).items())
    for first in range(0, len(runs), _MAX_COLUMNS):
        some = dict(runs[first : first + _MAX_COLUMNS])
        caption = f"Motion and energy of {joined(list(some))}, one column for each."
        options = {"point": comparison.point or None, "of": comparison.drawn()}
        yield Picture(caption, partial(plot_comparison, some, **options, size="page"))


def _call(comparison: Comparison) -> Call:
    given = {"point": comparison.point} if comparison.point not in comparison.points[:1] and comparison.point else {}
    return Call("compare", given | ({"of": comparison.of} if comparison.of != "displacement" else {}))


def _about(name: str, run: Run) -> str:
    origin = run.provenance
    return f"{name}: Rattlebox {origin.version}, {origin.platform}, {amount(run.wall_time, 's', 3)}."


def _limits(comparison: Comparison) -> Iterator[Limit]:
    for name, run in _runs(comparison).items():
        yield from (limit._replace(name=f"{name}: {limit.name}") for limit in run_limits(run))


KIND: Kind[Comparison] = Kind(
    name="Comparison",
    cases=lambda comparison: {name: run.case for name, run in _runs(comparison).items()},
    question=_question,
    answer=_answer,
    call=_call,
    pictures=_pictures,
    tables=lambda comparison: [Table("Summary", ("", *comparison.runs), comparison.lines(), numbers=True)],
    warnings=lambda comparison: comparison.notes(),
    limits=_limits,
    about=lambda comparison: [_about(name, run) for name, run in _runs(comparison).items()],
)
