"""Fixtures with example runs, for the tests of results and of figures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from rattlebox.results import Run

from . import example_runs

KINDS: dict[str, dict[str, Any]] = {
    "one ball": {},
    "two dampers": {"rows": (1, 3), "restitution": 0.8, "duration": 0.3},
    "no ball": {"rows": ()},
    "no impact": {"pulse": 100.0},
    "fixed cavity": {"fixed": True, "ball_speed": 0.2},
    "interrupted": {"duration": 0.2, "status": "interrupted", "message": "Stopped by hand at 0.2 s; µ kept."},
    "one time": {"times": 1, "duration": 1e-3},
}


@pytest.fixture(scope="session")
def make_run() -> Callable[..., Run]:
    """Return the function that computes an example run."""
    return example_runs.make_run


@pytest.fixture(scope="session", params=KINDS, ids=[kind.replace(" ", "_") for kind in KINDS])
def any_run(request: pytest.FixtureRequest) -> Run:
    """Return each kind of run in turn."""
    return example_runs.make_run(**KINDS[request.param])


@pytest.fixture(scope="session")
def run() -> Run:
    """Return a run with one ball in one damper, after a pulse."""
    return example_runs.make_run()


@pytest.fixture(scope="session")
def two_dampers() -> Run:
    """Return a run with one damper with a ball and one with a row of three."""
    return example_runs.make_run(**KINDS["two dampers"])
