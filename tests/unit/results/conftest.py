"""Runs for the tests of results, made once."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

from rattlebox.results import Run


def _factory() -> Callable[..., Run]:
    spec = spec_from_file_location("example_runs", Path(__file__).parent / "example_runs.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module.make_run  # type: ignore[no-any-return]


_make_run = _factory()

KINDS = {
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
    """Function that makes a run by hand."""
    return _make_run


@pytest.fixture(scope="session", params=KINDS, ids=[kind.replace(" ", "_") for kind in KINDS])
def any_run(request: pytest.FixtureRequest) -> Run:
    """Every kind of run in turn."""
    return _make_run(**KINDS[request.param])


@pytest.fixture(scope="session")
def run() -> Run:
    """One ball in one damper after a pulse."""
    return _make_run()


@pytest.fixture(scope="session")
def two_dampers() -> Run:
    """One damper with a ball and one with a row of three."""
    return _make_run(**KINDS["two dampers"])
