"""What tests of the paper share."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import pytest
import xarray as xr

from rattlebox.model.case import Case
from rattlebox.paper.report import reproduction
from rattlebox.paper.runs import noting


@cache
def _computed(module: str) -> tuple[xr.Dataset, list[Case]]:
    with noting() as runs:
        data = reproduction(module).data()
    return data, runs


@pytest.fixture(scope="session")
def computed() -> Callable[[str], tuple[xr.Dataset, list[Case]]]:
    """Return the dataset of the figure in a module, and the cases that were run for it, computed once."""
    return _computed
