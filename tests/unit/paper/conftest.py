"""What tests of the paper share."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import pytest
import xarray as xr

from rattlebox.model.case import Case
from rattlebox.paper.figure import Reproduction
from rattlebox.paper.report import FIGURES, reproduction
from rattlebox.paper.runs import noting

HEAVY = {"contacts_per_cycle", "bifurcation", "chattering", "lyapunov"}
"""Modules whose data take some seconds."""


class Computed(NamedTuple):
    """A figure, its data, and the cases that were run for them."""

    module: str
    figure: Reproduction
    data: xr.Dataset
    runs: list[Case]


@cache
def _computed(module: str) -> Computed:
    figure = reproduction(module)
    with noting() as runs:
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
