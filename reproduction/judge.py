"""The rule that judges every claim of the paper from computed numbers, and the matrix of claims and interpretations."""

from __future__ import annotations

import operator
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from math import inf, isnan
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .models import ALL_MODELS, CONSTANT_E, RIGID, SHORT, STEEL

CLAIMS: Mapping[str, Any] = tomllib.loads(Path(__file__).with_name("claims.toml").read_text(encoding="utf-8"))
"""Claims by the key of the figure that tests them, the rule, and the tables of the readings of the text."""

Verdict = Literal[
    "reproduced",
    "under one interpretation only",
    "qualitatively",
    "not reproducible",
    "misprint",
    "cannot be checked",
    "follows from the equations",
]
Grade = Literal["holds", "partly", "fails", "undecided", ""]
"""Of a claim under one interpretation; "undecided" is up to chaotic scatter, "" means that the claim has no number there."""

AS_READ, SWAPPED = "as read", "swapped"
"""Order of the cases: 2 at the trailing and 3 at the leading wall, or the reverse."""
STATED = RIGID
"""Interpretation that the paper states: contact with a rigid body (section 3.2), and equation (6) for the stiffness."""
WALLS = tuple(model for model in ALL_MODELS if model != CONSTANT_E)
HEDGED = 0.1  # Relative tolerance of a number that the paper prints with "about", "nearly" or "~"

RESAMPLES = 400  # Number of bootstrap samples behind an interval

Range = tuple[float, float]
Place = tuple[str, str]  # Model, and order of the cases or ""


class Estimate(NamedTuple):
    """Median of an ensemble of starts within a micrometre, or an exact value."""

    value: float
    low: float  # Lower end of the 95 % interval of the median
    high: float
    least: float  # Lower end of the band that contains the middle 80 % of the starts
    most: float


def exact(value: Any) -> Estimate:
    """Return a number without scatter."""
    return Estimate(*[float(value)] * 5)


def estimate(function: Callable[..., NDArray[np.float64]], *samples: Any) -> Estimate:
    """Estimate a function of medians with its 95 % interval from bootstrap samples."""
    random = np.random.default_rng(1)
    arrays = [np.asarray(sample, dtype=float) for sample in samples]
    drawn = [np.median(random.choice(array, (RESAMPLES, array.size)), axis=1) for array in arrays]
    medians = [float(np.median(array)) for array in arrays]
    with np.errstate(invalid="ignore", divide="ignore"):
        low, high = np.quantile(function(*drawn), (0.025, 0.975))
        # The members of the first ensemble, each against the medians of the others, are what single runs give.
        least, most = np.quantile(function(arrays[0], *medians[1:]), (0.1, 0.9))
        return Estimate(float(function(*medians)), float(low), float(high), float(least), float(most))


@dataclass(frozen=True)
class Claim:
    """Statement of the paper, the quantity that tests it, and its value under each interpretation."""

    statement: str
    where: str
    quantity: str
    cells: Mapping[Place, Estimate] = field(default_factory=dict)
    accept: Range = (-inf, inf)
    partly: Range | None = None
    printed: str = ""
    scope: Literal["system", "constant", "elasto-plastic", "both"] = "elasto-plastic"
    kind: Literal["test", "construction", "misprint", "unchecked"] = "test"
    note: str = ""
    see: str = ""


PRINTED, CORRECTED = ("printed", ""), ("corrected", "")  # Places of the two values of a misprint
SYSTEM = (CONSTANT_E, "")  # Place of the value of a claim about the system


def cells_of(values: Any) -> dict[Place, Estimate]:
    """Return the cells of a claim: one value of the system, a printed and a corrected one, or values by place or model."""
    if isinstance(values, tuple) and not isinstance(values, Estimate):
        values = dict(zip((PRINTED, CORRECTED), values, strict=True))
    if not isinstance(values, Mapping):
        values = {SYSTEM: values}
    return {
        at if isinstance(at, tuple) else (str(at), ""): value if isinstance(value, Estimate) else exact(value)
        for at, value in values.items()
    }


def claim_of(row: Mapping[str, Any], quantity: str, note: str, cells: Mapping[Place, Estimate]) -> Claim:
    """Return a claim of the table with its values; quantity and note contain numbers."""
    partly = tuple(row["partly"]) if "partly" in row else None
    plain = {key: row[key] for key in ("statement", "where", "printed", "scope", "kind", "see") if key in row}
    accept = tuple(row.get("accept", (-inf, inf)))
    return Claim(**plain, quantity=quantity, note=note, cells=cells, accept=accept, partly=partly)


def grade(value: Estimate, accept: Range, partly: Range | None = None) -> Grade:
    """Return whether a value is in the range in which a claim holds."""
    if isnan(value.value):
        return ""
    for wanted, result in ((accept, "holds"), (partly, "partly")):
        if wanted is None:
            continue
        if wanted[0] <= value.low and value.high <= wanted[1]:
            return result  # type: ignore[return-value]
        if value.low <= wanted[1] and wanted[0] <= value.high:
            return "undecided"
    return "fails"


def single_runs_differ(value: Estimate, accept: Range) -> bool:
    """Return whether more than a tenth of the starts are on the other side of the criterion than the median."""
    inside = accept[0] <= value.value <= accept[1]
    return inside != (accept[0] <= value.least <= accept[1]) or inside != (accept[0] <= value.most <= accept[1])


def graded(claim: Claim) -> dict[Place, Grade]:
    """Return the grade of each value of a claim, without values that are for comparison only."""
    return {
        at: grade(value, claim.accept, claim.partly)
        for at, value in claim.cells.items()
        if claim.scope != "elasto-plastic" or at[0] != CONSTANT_E
    }


ORDER: Sequence[Grade] = ("holds", "", "partly", "undecided", "fails")  # Grades from the best to the worst


def interpreted(claim: Claim) -> dict[Place, Grade]:
    """Return the grade of a claim under each interpretation: a wall and an order of the cases."""
    grades = graded(claim)
    orders = list(dict.fromkeys(order for _, order in grades))
    if claim.scope in ("system", "constant") or claim.kind == "misprint":
        return grades
    if claim.scope == "elasto-plastic":
        return grades
    return {
        (wall, order): max(grades[wall, order], grades[CONSTANT_E, order], key=ORDER.index)
        for wall, order in product(WALLS, orders)
        if (wall, order) in grades
    }


def verdict(claim: Claim) -> Verdict:
    """Judge a claim by the rule of the report (`RULE`)."""
    if claim.kind == "unchecked":
        return "cannot be checked"
    grades = interpreted(claim)
    if claim.kind == "misprint":
        return "misprint" if (grades[PRINTED], grades[CORRECTED]) == ("fails", "holds") else "reproduced"
    stated = [result for (model, _), result in grades.items() if model in (STATED, CONSTANT_E)]
    if stated and all(result == "holds" for result in stated):
        return "follows from the equations" if claim.kind == "construction" else "reproduced"
    if "holds" in grades.values():
        return "under one interpretation only"
    return "qualitatively" if "partly" in grades.values() else "not reproducible"


def where_it_holds(claim: Claim) -> str:
    """Return the interpretations to which a verdict is restricted, as text; empty if there is no restriction."""
    grades = interpreted(claim)
    best: Grade = "holds" if "holds" in grades.values() else "partly"
    found = [at for at, result in grades.items() if result == best]
    if claim.kind != "test" or not found or len(found) == len(grades) or verdict(claim) == "reproduced":
        return ""
    return "; ".join(f"{SHORT[model]}{f', cases {order}' if order else ''}" for model, order in found)


def fit(claims: Sequence[Claim]) -> dict[Place, dict[Grade, int]]:
    """Count the grades of each interpretation over the claims about elasto-plastic impacts."""
    kinds = [c for c in claims if c.kind == "test" and c.scope in ("elasto-plastic", "both")]
    tested = [c for c in kinds if {wall for wall, _ in c.cells} >= set(WALLS)]
    counts: dict[Place, dict[Grade, int]] = {}
    for wall, order in product(WALLS, (AS_READ, SWAPPED)):
        results = [grades.get((wall, order), grades.get((wall, ""), "")) for grades in map(interpreted, tested)]
        counts[wall, order] = {result: results.count(result) for result in ("holds", "partly", "undecided", "fails")}
    return counts


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
    rows = []
    for number, each in enumerate(map(row, sorted(claims, key=lambda claim: place(claim.where))), 1):
        claim = each.claim
        marks = [text for cell in each.cells for text in (_entries(cell), *[""] * (cell.columns - 1))]
        said = f"{claim.statement} ({claim.where}{f'; printed {claim.printed}' if claim.printed else ''})"
        test = each.test + (f": {each.criterion}" if each.criterion else "") + (f"; {claim.note}" if claim.note else "")
        restriction = f" ({each.restriction})" if each.restriction else ""
        rows.append([str(number), said, test, *marks, each.verdict + restriction])
    met = [[SHORT[wall], order, *map(str, counts.values())] for (wall, order), counts in fit(claims).items()]
    return (
        "<!-- `python -m reproduction` writes this file as figures/figure_claims.md. -->\n"
        + _table("The matrix", ["no.", "the paper says", "test: criterion", *SHORT.values(), "verdict"], rows)
        + _table(
            "Claims met under each interpretation",
            ["wall", "cases 2 and 3", "met", "in part", "undecided", "not met"],
            met,
        )
        + f"{best_fit(claims)}\n\n"
        + _table("Interpretations", ["printed", "read as", "reason"], CLAIMS["readings"])
        + _table("Misprints", ["printed", "should be", "shown by"], CLAIMS["misprints"])
    ).removesuffix("\n")


def _table(heading: str, names: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(text.replace("*", r"\*") for text in texts) + " |\n" for texts in (names, *rows)]
    return f"### {heading}\n\n{lines[0]}|{'---|' * len(names)}\n{''.join(lines[1:])}\n"


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
