"""The rule that judges every claim of the paper from computed numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from math import inf, isnan
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .models import ALL_MODELS, CONSTANT_E, RIGID, SHORT

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
SIZE = 2.0  # Factor within which the size of an effect is right qualitatively

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


def about(number: float, tolerance: float = HEDGED) -> Range:
    """Return the range of values that agree with a number printed as approximate."""
    return number * (1 - tolerance), number * (1 + tolerance)


def size_of(number: float) -> Range:
    """Return the range of values that have the size of a number."""
    return number / SIZE, number * SIZE


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


def by_wall(values: Mapping[str, Estimate]) -> dict[Place, Estimate]:
    """Return the cells of a claim that does not depend on the order of the cases."""
    return {(model, ""): value for model, value in values.items()}


PRINTED, CORRECTED = ("printed", ""), ("corrected", "")  # Places of the two values of a misprint
SYSTEM = (CONSTANT_E, "")  # Place of the value of a claim about the system


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


RULE = (
    "Each claim is tested by one computed quantity and one criterion, under each interpretation of the text: a steel "
    "wall, a "
    "wall that is rigid in the elastic limit, or a wall that is rigid in the stiffness too; where a claim names case "
    "2 or 3, "
    "with case 2 at the trailing wall (as read) and at the leading wall (swapped).",
    f"The criterion is met if the 95 % interval of the median over starts within 1 µm is inside it. A number printed with "
    f"“about”, “nearly” or “~” has a tolerance of {100 * HEDGED:.0f} %, any other number that of its last digit. "
    "If the interval contains the limit, chaotic scatter decides, which is no agreement; a dagger marks values for which "
    "more than a tenth of the single runs are on the other side.",
    "A claim is reproduced if it is met under the interpretation that the paper states, a rigid wall, for both "
    "orders of the "
    "cases, and, where it is about constant restitution too, with e = 0.99117. It holds under one interpretation only if it "
    "is met under others. It is qualitatively right if it holds for a part of the time or range, or if a printed number is "
    f"within a factor of {SIZE:g}. Otherwise it is not reproducible.",
    "Statements that equation (11) contains already follow from the equations. A misprint is a statement that "
    "contradicts the "
    "rest of the text or its own dimensions, where a corrected one does not. A claim without a number, or about curves that "
    "the text does not contain, cannot be checked.",
)
"""The rule, in words."""


def fit(claims: Sequence[Claim]) -> dict[Place, dict[Grade, int]]:
    """Count the grades of each interpretation over the claims about elasto-plastic impacts."""
    kinds = [c for c in claims if c.kind == "test" and c.scope in ("elasto-plastic", "both")]
    tested = [c for c in kinds if {wall for wall, _ in c.cells} >= set(WALLS)]
    counts: dict[Place, dict[Grade, int]] = {}
    for wall, order in product(WALLS, (AS_READ, SWAPPED)):
        results = [grades.get((wall, order), grades.get((wall, ""), "")) for grades in map(interpreted, tested)]
        counts[wall, order] = {result: results.count(result) for result in ("holds", "partly", "undecided", "fails")}
    return counts
