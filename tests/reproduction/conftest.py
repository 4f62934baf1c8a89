"""Fixtures of the tests of the reproduction."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import pytest
import xarray as xr

from rattlebox import Case
from reproduction.figure import Reproduction
from reproduction.files import record_cases
from reproduction.report import FIGURES, load_figure

HEAVY = {
    "branches",
    "contacts_per_cycle",
    "bifurcation",
    "chattering",
    "lyapunov",
    "evidence",
    "gap_study",
    "figure_07de",
}
"""Modules whose data take several seconds."""


class Computed(NamedTuple):
    """Figure with its data and the cases that were simulated for it."""

    module: str
    figure: Reproduction
    data: xr.Dataset
    runs: list[Case]


@cache
def _computed(module: str) -> Computed:
    figure = load_figure(module)
    with record_cases() as runs:
        data = figure.data()
    return Computed(module, figure, data, runs)


@pytest.fixture(scope="session")
def computed() -> Callable[[str], Computed]:
    """Return a function that computes the figure of a module once."""
    return _computed


@pytest.fixture(
    scope="session", params=[pytest.param(name, marks=pytest.mark.slow if name in HEAVY else ()) for name in FIGURES]
)
def every(request: pytest.FixtureRequest) -> Computed:
    """Return each figure in turn."""
    return _computed(request.param)
