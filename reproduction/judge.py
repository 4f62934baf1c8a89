"""The rule that judges every claim of the paper from computed numbers."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from math import inf, isnan
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .models import ALL_MODELS, CONSTANT_E, RIGID, SHORT

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
