"""Report about a comparison of runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, cast

from rattlebox._util.phrases import joined
from rattlebox._util.quantities import amount
from rattlebox.plots.compare import plot_comparison
from rattlebox.report.kinds.run import attached_points, result_sentences
from rattlebox.report.limits import readable_case, run_limits
from rattlebox.report.parts import Kind, Limit, Picture, Table
from rattlebox.results.case_words import loads_words

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results.run import Run
    from rattlebox.results.summary import Comparison

_MAX_COLUMNS = 4
"""Most runs in a figure of a comparison."""


def _runs(comparison: Comparison) -> dict[str, Run]:
    return cast("dict[str, Run]", comparison.runs)


def _cases(comparison: Comparison) -> Mapping[str, Case]:
    return {name: run.case for name, run in _runs(comparison).items()}


def _question(comparison: Comparison) -> str:
    reference = readable_case(next(iter(_runs(comparison).values())))
    names = joined([f"“{name}”" for name in comparison.runs])
    if reference is None:
        return f"How do the variants {names} compare?"
    loads = loads_words(reference)
    under = f" under {loads}" if loads else " in free vibration"
    return f"How do the variants {names} of {reference.structure.words()} compare{under}?"


def _answer(comparison: Comparison) -> Iterator[str]:
    runs, names = _runs(comparison), list(comparison.runs)
    for name, run in _runs(comparison).items():
        if not run.ok:
            yield f"{name} has the status {run.status}: {run.message}"
    for name in names[1:]:
        values = comparison.values[name]
        found = []
        for kind, words in (("rms", "RMS displacement"), ("peak", "peak displacement")):
            changes = {key: value for key, value in values.items() if key.startswith(f"{kind}_reduction[")}
            if changes:
                key = max(changes, key=lambda each: _before(comparison, each))
                share = float(changes[key])
                point = key.partition("[")[2][:-1]
                verb = "reduced" if share >= 0 else "increased"
                found.append(f"the {words} of {point} is {verb} by {amount(abs(share), '%', 3)}")
        if found:
            yield f"With {name}, {joined(found)} against {names[0]}."
    for name in names:
        own = attached_points(runs[name])
        yield f"{name}: {' '.join(result_sentences(comparison.values[name], own))}"


def _before(comparison: Comparison, key: str) -> float:
    """Return the value of the reference run to which a reduction belongs."""
    reference = next(iter(comparison.values.values()))
    return float(reference.get(key.replace("reduction", "displacement", 1), 0.0))


def _pictures(comparison: Comparison) -> Iterator[Picture]:
    runs = list(_runs(comparison).items())
    for first in range(0, len(runs), _MAX_COLUMNS):
        some = dict(runs[first : first + _MAX_COLUMNS])
        yield Picture(
            f"Motion and energy of {joined(list(some))}, one column for each.",
            partial(plot_comparison, some, size="page"),
        )


def _tables(comparison: Comparison) -> Iterator[Table]:
    yield Table("Summary", ("", *comparison.runs), comparison.lines(), numbers=True)


def _warnings(comparison: Comparison) -> Iterator[str]:
    for name, run in _runs(comparison).items():
        yield from (f"{name}: {note}" for note in run.notes)


def _limits(comparison: Comparison) -> Iterator[Limit]:
    for name, run in _runs(comparison).items():
        for limit in run_limits(run):
            yield limit._replace(name=f"{name}: {limit.name}")


def _about(comparison: Comparison) -> Iterator[str]:
    for name, run in _runs(comparison).items():
        origin = run.provenance
        yield f"{name}: Rattlebox {origin.version}, {origin.platform}, {amount(run.wall_time, 's', 3)}."


KIND = Kind(
    name="Comparison",
    cases=_cases,
    question=_question,
    answer=_answer,
    call=lambda comparison: None,
    pictures=_pictures,
    tables=_tables,
    warnings=_warnings,
    limits=_limits,
    about=_about,
)
