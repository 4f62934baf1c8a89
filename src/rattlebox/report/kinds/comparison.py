"""Report about a comparison of runs."""

from __future__ import annotations

from collections.abc import Iterator
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
    from rattlebox.results.run import Run
    from rattlebox.results.summary import Comparison

_MAX_COLUMNS = 4
"""Most runs in a figure of a comparison."""
_DISPLACEMENTS = {"rms": "RMS displacement", "peak": "peak displacement"}


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
    reference, *others = comparison.runs
    for name, run in _runs(comparison).items():
        if not run.ok:
            yield f"{name} has the status {run.status}: {run.message}"
    for name in others:
        changes = [_change(comparison, name, kind, text) for kind, text in _DISPLACEMENTS.items()]
        if any(changes):
            yield f"With {name}, {joined(list(filter(None, changes)))} against {reference}."
    for name, run in _runs(comparison).items():
        yield f"{name}: {' '.join(result_sentences(comparison.values[name], attached_points(run)))}"


def _change(comparison: Comparison, name: str, kind: str, text: str) -> str:
    """Return a phrase about the point whose displacement is largest in the reference run; "" if there is none."""
    changes = {key: float(v) for key, v in comparison.values[name].items() if key.startswith(f"{kind}_reduction[")}
    if not changes:
        return ""
    key = max(changes, key=lambda key: _before(comparison, key))
    verb = "reduced" if changes[key] >= 0 else "increased"
    return f"the {text} of {key.partition('[')[2][:-1]} is {verb} by {amount(abs(changes[key]), '%', 3)}"


def _before(comparison: Comparison, key: str) -> float:
    """Return the value of the reference run to which a reduction belongs."""
    reference = next(iter(comparison.values.values()))
    return float(reference.get(key.replace("reduction", "displacement", 1), 0.0))


def _pictures(comparison: Comparison) -> Iterator[Picture]:
    runs = list(_runs(comparison).items())
    for first in range(0, len(runs), _MAX_COLUMNS):
        some = dict(runs[first : first + _MAX_COLUMNS])
        caption = f"Motion and energy of {joined(list(some))}, one column for each."
        yield Picture(caption, partial(plot_comparison, some, size="page"))


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
    call=lambda comparison: None,
    pictures=_pictures,
    tables=lambda comparison: [Table("Summary", ("", *comparison.runs), comparison.lines(), numbers=True)],
    warnings=lambda comparison: [f"{name}: {note}" for name, run in _runs(comparison).items() for note in run.notes],
    limits=_limits,
    about=lambda comparison: [_about(name, run) for name, run in _runs(comparison).items()],
)
