"""The matrix of claims and interpretations, as rows for the page and as text for the documentation."""

from __future__ import annotations

import operator
import re
from collections.abc import Sequence
from math import inf, isnan
from typing import NamedTuple

from .judge import (
    AS_READ,
    CLAIMS,
    CORRECTED,
    ORDER,
    PRINTED,
    STATED,
    SWAPPED,
    SYSTEM,
    WALLS,
    Claim,
    Estimate,
    Grade,
    Range,
    fit,
    graded,
    interpreted,
    single_runs_differ,
    verdict,
    where_it_holds,
)
from .models import ALL_MODELS, SHORT, STEEL

TEXTS = dict(zip(WALLS, ("a steel wall", "a rigid wall", "a wall that is rigid in the stiffness too"), strict=True))
MARKS: dict[Grade, str] = {"holds": "✓", "partly": "≈", "fails": "✗", "undecided": "?", "": ""}


class Entry(NamedTuple):
    """One value of a cell."""

    label: str  # Order of the cases, or "printed" and "corrected"; "" if there is only one value
    grade: Grade
    text: str
    scatter: str  # Interval of the median and band of the starts; "" for exact values
    dagger: bool


class Cell(NamedTuple):
    """Cell of the matrix over one or more columns."""

    entries: tuple[Entry, ...]
    columns: int = 1


class Row(NamedTuple):
    """Claim with its cells, one for each model or one for all."""

    claim: Claim
    test: str
    criterion: str
    cells: tuple[Cell, ...]
    verdict: str
    restriction: str


def number(value: float) -> str:
    """Return a value with three significant digits; rounding errors of zero are zero."""
    return "0" if abs(value) < 1e-12 else f"{value:.3g}"


def criterion(wanted: Range) -> str:
    """Return a range as text; limits that only exclude rounding errors are zero."""
    low, high = (0.0 if abs(value) < 1e-8 else value for value in wanted)
    if number(low) == number(high):
        return f"= {number(low)}"
    if high == inf:
        return f"{'≥' if low else '>'} {number(low)}"
    return f"≤ {number(high)}" if low == -inf else f"{number(low)} to {number(high)}"


def row(claim: Claim) -> Row:
    """Return the row of a claim."""
    test = claim.quantity[0].upper() + claim.quantity[1:] if claim.quantity[0].isascii() else claim.quantity
    if claim.kind == "unchecked":
        return Row(claim, test, "", (Cell((), len(ALL_MODELS)),), verdict(claim), "")
    tests = criterion(claim.accept) + (f"; qualitatively {criterion(claim.partly)}" if claim.partly else "")
    grades = interpreted(claim) | graded(claim)
    entries = {
        at: Entry(at[0] if at in (PRINTED, CORRECTED) else at[1], grades.get(at, ""), *_texts(value, claim))
        for at, value in claim.cells.items()
    }
    if claim.scope == "system" or claim.kind == "misprint":
        at = (SYSTEM,) if claim.scope == "system" and SYSTEM in entries else (PRINTED, CORRECTED)
        cells: tuple[Cell, ...] = (Cell(tuple(entries[place] for place in at), len(ALL_MODELS)),)
    else:
        cells = tuple(Cell(tuple(e for at, e in entries.items() if at[0] == model)) for model in ALL_MODELS)
    return Row(claim, test, tests, cells, verdict(claim), where_it_holds(claim))


def _texts(value: Estimate, claim: Claim) -> tuple[str, str, bool]:
    if isnan(value.value):
        return "no loss", "", False
    scatter = "" if value.low == value.high else f"median {number(value.low)} to {number(value.high)} (95 %)"
    if value.least != value.most:
        scatter += f", starts {number(value.least)} to {number(value.most)} (80 %)"
    return number(value.value), scatter, bool(scatter) and single_runs_differ(value, claim.accept)


def best_fit(claims: Sequence[Claim]) -> str:
    """Return sentences on the interpretation that fits most claims; empty if no claim depends on it."""
    counts = fit(claims)
    total = sum(next(iter(counts.values())).values())
    if not total:
        return ""
    holds = [
        f"{counts[wall, AS_READ]['holds']} and {counts[wall, AS_READ]['partly']} ({TEXTS[wall]})" for wall in WALLS
    ]
    pairs = [{place[0]: ORDER.index(found) for place, found in interpreted(claim).items()} for claim in claims]
    better = [
        sum(STEEL in pair and first(pair[STEEL], pair[STATED]) for pair in pairs)
        for first in (operator.gt, operator.lt)
    ]
    swapped = [
        claim
        for claim in claims
        for grades in [interpreted(claim)]
        if any(
            found != grades.get((wall, SWAPPED), found) for (wall, order), found in grades.items() if order == AS_READ
        )
    ]
    return (
        f"Of {total} claims about elasto-plastic impacts, so many are met and met in part: {', '.join(holds)}. "
        f"{better[0]} claims fit a rigid wall "
        f"better than a steel one, {better[1]} the reverse; the others fit both alike. The order of cases 2 and 3 "
        f"changes the grade of {len(swapped)} claim{'s' * (len(swapped) != 1)}."
    )


def documentation(claims: Sequence[Claim]) -> str:
    """Return the matrix, the fit of each interpretation, the interpretations and the misprints as a Markdown page."""
    claims = sorted(claims, key=lambda claim: place(claim.where))
    lines = [
        "<!-- `python -m reproduction` writes this file as figures/figure_claims.md. -->",
        "### The matrix\n",
        *_header("no.", "the paper says", "test: criterion", *SHORT.values(), "verdict"),
    ]
    for k, each in enumerate(map(row, claims), 1):
        marks = [text for cell in each.cells for text in (_entries(cell), *[""] * (cell.columns - 1))]
        test = (
            each.test
            + (f": {each.criterion}" if each.criterion else "")
            + (f"; {each.claim.note}" if each.claim.note else "")
        )
        restriction = f" ({each.restriction})" if each.restriction else ""
        printed = f"; printed {each.claim.printed}" if each.claim.printed else ""
        said = f"{each.claim.statement} ({each.claim.where}{printed})"
        lines.append(_line(str(k), said, test, *marks, each.verdict + restriction))
    lines += ["\n### Claims met under each interpretation\n"]
    lines += _header("wall", "cases 2 and 3", "met", "in part", "undecided", "not met")
    lines += [_line(SHORT[wall], order, *map(str, found.values())) for (wall, order), found in fit(claims).items()]
    lines += [f"\n{best_fit(claims)}", "\n### Interpretations\n", *_header("printed", "read as", "reason")]
    lines += [_line(*each) for each in CLAIMS["readings"]]
    lines += ["\n### Misprints\n", *_header("printed", "should be", "shown by")]
    lines += [_line(*each) for each in CLAIMS["misprints"]]
    return "\n".join(lines) + "\n"


def _header(*names: str) -> list[str]:
    return [_line(*names), f"|{'---|' * len(names)}"]


def _line(*texts: str) -> str:
    return f"| {' | '.join(text.replace('*', chr(92) + '*') for text in texts)} |"


def _entries(cell: Cell) -> str:
    return "; ".join(
        " ".join(filter(None, (MARKS[entry.grade], entry.label, entry.text + "†" * entry.dagger)))
        for entry in cell.entries
    )


_SECTION_OF = {
    "figure": {1: 3.0, 2: 3.1, 3: 4.1, 4: 4.2, 5: 4.3, 6: 5.0, 7: 5.1},
    "equation": {1: 3.0, 8: 3.1, 11: 3.2, 17: 5.1},
    "table": {1: 4.25},
    "conclusion": {1: 6.0},
}
"""Section of the paper's numbered items; items between two entries belong to the section of the first."""


def place(where: str) -> tuple[float, ...]:
    """Return a key that sorts the locations of claims by section, then by figure."""
    where = where.lower()
    section = re.search(r"sections? (\d+(?:\.\d+)?)", where)
    things = re.search(r"(fig|equation|table|conclusion)(?:ure)?s?\.? \(?(\d+)([a-z]?)", where)
    if things is None:
        return (float(section[1]) if section else float("abstract" not in where) * 9.0,)
    kind, number, part = things.groups()
    starts = _SECTION_OF[{"fig": "figure"}.get(kind, kind)]
    found = starts[max(start for start in starts if start <= int(number))]
    return float(section[1]) if section else found, float(number), float(ord(part or "a"))
