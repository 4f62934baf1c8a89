"""The table of claims in the documentation."""

import re
from pathlib import Path

import pytest

from reproduction.judge import CLAIMS, documentation, place, row, verdict
from reproduction.report import FIGURES, load_figure

PAGE = Path(__file__).parents[2] / "docs/validation/paper_table.md"
QUICK = ("figure_02", "figure_05", "figure_06", "figure_09a", "interpretations")
"""Modules whose claims are checked in the fast tests."""


def marks(text):
    """Return the page without its computed numbers, which may differ in the last digit between processors."""
    return re.sub(r"-?\d+(\.\d+)?(e[-+]\d+)?", "#", text)


def test_page_has_the_verdicts_of_quick_figures(computed):
    """Statements, criteria, marks and verdicts of some figures are those of the page."""
    page = marks(PAGE.read_text(encoding="utf-8")).splitlines()
    for module in QUICK:
        figure, data = computed(module).figure, computed(module).data
        for line in marks(documentation(figure.claims(data))).splitlines():
            if line.startswith("| # |"):
                assert line in page, line


def test_interpretations_and_misprints_are_on_the_page():
    """The tables of the page are those of the report, with at least twelve misprints."""
    page = PAGE.read_text(encoding="utf-8")
    for printed, _, _ in (*CLAIMS["readings"], *CLAIMS["misprints"]):
        assert f"| {printed.replace('*', chr(92) + '*')} |" in page
    assert len(CLAIMS["misprints"]) >= 12


@pytest.mark.slow
def test_page_is_that_of_the_report(computed):
    """The whole page is what the report writes, but for the last digits of numbers."""
    claims = [claim for name in FIGURES for claim in load_figure(name).claims(computed(name).data)]
    assert marks(documentation(claims)) == marks(PAGE.read_text(encoding="utf-8"))
    assert len(claims) >= 45


@pytest.mark.slow
def test_rows_are_in_the_order_of_the_paper(computed):
    """The verdicts of the page are those of the rows, sorted by section and figure."""
    claims = [claim for name in FIGURES for claim in load_figure(name).claims(computed(name).data)]
    ordered = sorted(claims, key=lambda claim: place(claim.where))
    lines = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if re.match(r"\| \d+ \|", line)]
    assert len(lines) == len(ordered)
    for line, claim in zip(lines, ordered, strict=True):
        assert verdict(claim) == row(claim).verdict and f"| {verdict(claim)}" in line
