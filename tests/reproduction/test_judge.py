"""The rule that judges the claims."""

from itertools import product
from math import inf, nan

import numpy as np
import pytest

from reproduction.judge import (
    AS_READ,
    CORRECTED,
    PRINTED,
    SWAPPED,
    SYSTEM,
    WALLS,
    Claim,
    Estimate,
    best_fit,
    cells_of,
    criterion,
    documentation,
    estimate,
    exact,
    fit,
    grade,
    row,
    single_runs_differ,
    verdict,
    where_it_holds,
)
from reproduction.models import CONSTANT_E, RIGID, STEEL, STIFF


def claim(values, **options):
    """Return a claim that a quantity is at least 1, and qualitatively at least 0.5."""
    return Claim(
        "It holds.", "section 5", "quantity", cells_of(values), **({"accept": (1, inf), "partly": (0.5, inf)} | options)
    )


def walls(steel, rigid, stiff, constant=None):
    """Return exact values by model."""
    values = {STEEL: exact(steel), RIGID: exact(rigid), STIFF: exact(stiff)}
    return values if constant is None else {CONSTANT_E: exact(constant)} | values


@pytest.mark.parametrize(
    ("low", "value", "high", "expected"),
    [
        (1.1, 1.2, 1.3, "holds"),
        (0.9, 1.2, 1.3, "undecided"),
        (0.6, 0.7, 0.8, "partly"),
        (0.4, 0.7, 0.8, "undecided"),
        (0.1, 0.2, 0.3, "fails"),
        (nan, nan, nan, ""),
    ],
)
def test_grade(low, value, high, expected):
    """A grade needs the whole interval of the median; an interval across a limit is undecided."""
    assert grade(Estimate(value, low, high, low, high), (1, inf), (0.5, inf)) == expected


@pytest.mark.parametrize(
    ("values", "expected", "restriction"),
    [
        ((0, 2, 0), "reproduced", ""),
        ((2, 0, 0), "under one interpretation only", "steel wall"),
        ((2, 0.7, 2), "under one interpretation only", "steel wall; rigid in A too"),
        ((0, 0.7, 0), "qualitatively", "rigid wall"),
        ((0.7, 0.7, 0.7), "qualitatively", ""),
        ((0, 0, 0), "not reproducible", ""),
    ],
)
def test_verdict_depends_on_the_stated_wall(values, expected, restriction):
    """A claim is reproduced if it holds with the rigid wall, also if it fails with the other walls."""
    one = claim(walls(*values))
    assert (verdict(one), where_it_holds(one)) == (expected, restriction)


def test_claims_about_both_models_need_both():
    """A claim about both models fails if it fails with constant restitution; one about the other model does not."""
    assert verdict(claim(walls(2, 2, 2, constant=0), scope="both")) == "not reproducible"
    assert verdict(claim(walls(2, 2, 2, constant=0.7), scope="both")) == "qualitatively"
    assert verdict(claim(walls(2, 2, 2, constant=0))) == "reproduced"


def test_both_orders_of_the_cases_are_needed():
    """With the order of the cases unknown, a claim is reproduced only if it holds for both."""
    cells = {(wall, order): exact(2) for wall, order in product(WALLS, (AS_READ, SWAPPED))}
    assert verdict(Claim("It holds.", "section 5", "quantity", cells, accept=(1, inf))) == "reproduced"
    cells[RIGID, SWAPPED] = exact(0)
    one = Claim("It holds.", "section 5", "quantity", cells, accept=(1, inf))
    assert verdict(one) == "under one interpretation only"
    assert "rigid wall, cases as read" in where_it_holds(one)


def test_kinds():
    """Misprints need a print that fails and a correction that holds; other kinds have their own verdict."""

    def printed(first, second):
        return Claim(
            "It holds.",
            "section 5",
            "q",
            {PRINTED: exact(first), CORRECTED: exact(second)},
            accept=(1, 2),
            kind="misprint",
        )

    assert verdict(printed(0, 1)) == "misprint"
    assert verdict(printed(1, 1)) == "reproduced"
    assert verdict(claim(walls(2, 2, 2), kind="construction")) == "follows from the equations"
    assert verdict(Claim("It holds.", "section 5", "q", kind="unchecked")) == "cannot be checked"
    assert (
        verdict(Claim("It holds.", "section 5", "q", {SYSTEM: exact(0.55)}, (0.45, 0.55), scope="system"))
        == "reproduced"
    )


def test_interval_of_a_median_shrinks_with_the_ensemble():
    """The 95 % interval contains the true median of a normal sample in most draws, and narrows as 1/sqrt(n)."""
    random = np.random.default_rng(5)
    inside = [one.low <= 0 <= one.high for one in (estimate(lambda x: x, random.normal(size=64)) for _ in range(60))]
    assert np.mean(inside) > 0.85
    small, large = (estimate(lambda x: x, random.normal(size=n)) for n in (50, 5000))
    assert (large.high - large.low) / (small.high - small.low) == pytest.approx(0.1, rel=0.6)
    assert small.least == pytest.approx(-1.28, abs=0.4)


def test_single_runs_on_both_sides_are_marked():
    """Single runs on the other side of the limit are reported although the median holds."""
    assert single_runs_differ(Estimate(1.2, 1.1, 1.3, 0.8, 1.5), (1, inf))
    assert not single_runs_differ(Estimate(1.2, 1.1, 1.3, 1.05, 1.5), (1, inf))


@pytest.mark.parametrize(
    ("wanted", "text"),
    [((1, inf), "≥ 1"), ((1e-12, inf), "> 0"), ((-inf, 0.9), "≤ 0.9"), ((-1e-9, 1e-9), "= 0"), ((45, 55), "45 to 55")],
)
def test_criterion_is_printed_as_it_is_applied(wanted, text):
    """The text of a criterion is made from its range."""
    assert criterion(wanted) == text


def test_fit_counts_each_interpretation():
    """The sentence on the best interpretation contains the counts, and so does the table for the documentation."""
    claims = [claim(walls(2, 2, 0)), claim(walls(0, 2, 2)), claim(walls(0, 0.7, 0)), claim(walls(2, 0, 0))]
    counts = fit(claims)
    assert counts[RIGID, AS_READ] == {"holds": 2, "partly": 1, "undecided": 0, "fails": 1}
    assert counts[STEEL, SWAPPED]["holds"] == 2
    assert "2 claims fit a rigid wall better than a steel one, 1 the reverse" in best_fit(claims)
    page = documentation(claims)
    assert "| rigid wall | swapped | 2 | 1 | 0 | 1 |" in page
    assert "| It holds. (section 5) | Quantity: ≥ 1; qualitatively ≥ 0.5 |" in page


def test_row_spans_the_models_for_claims_about_the_system():
    """A value of the system spans all models; others have a cell for each."""
    system = Claim("It holds.", "section 5", "q", {SYSTEM: exact(1)}, accept=(1, 1), scope="system")
    assert [cell.columns for cell in row(system).cells] == [4]
    assert [len(cell.entries) for cell in row(claim(walls(1, 1, 1))).cells] == [0, 1, 1, 1]
