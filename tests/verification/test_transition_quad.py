"""Derivatives of the motion against differences of runs in 113-bit arithmetic by an independent program.

The other tests compare with differences of the package's own runs: an error in both was not seen.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from tests.support.quad.closed_forms import CLOSED_FORMS
from tests.support.quad.compare import deviation
from tests.support.quad.draw import FAMILIES, STOPS
from tests.support.quad.runs import answers, compile_program, digest, question
from tests.support.quad.store import CLOSED, STOPS_DATA, Stored, read

STATE = 2e-13
"""Largest error of a state over its growth, in units of the largest gap and the largest approach speed."""
STATE_COLLOCATED = 5e-13
"""The same with collocated contacts, whose energy is compared with a part of that of all bodies, and with stops.

Each contact at a stop adds an error of 1e-13, which may grow more until the next contact than until the end.
"""
DERIVATIVES = 1e-9
"""Largest error of a derivative, as a part of the largest term of its component."""
FLOORS = {"power": 1e-7}
"""The same of power laws: the derivative of their dashpot is singular where a contact begins."""
PART = 5
"""The fast test compares every fifth run."""


@pytest.fixture(scope="module")
def runs() -> list[Stored]:
    """Return all stored runs."""
    return read()[1]


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Program in 113-bit arithmetic; without a compiler for it, its stored answers are compared by other tests."""
    path = tmp_path_factory.mktemp("quad") / "motion"
    for name in ("g++", "c++"):
        compiler = shutil.which(name)
        if compiler is not None and compile_program(compiler, path):
            return path
    pytest.skip("no compiler has 113-bit arithmetic (g++ with libquadmath); stored answers were compared")


def check(several: list[Stored]) -> None:
    """Compare runs, and report all that differ."""
    wrong = []
    for each in several:
        error = deviation(each)
        floor = FLOORS.get(each.run["family"].removesuffix(" stops"), DERIVATIVES)
        state = STATE_COLLOCATED if error.collocated or each.run.get("stops") else STATE
        if not (error.agrees and error.state < state and error.derivatives < floor):
            wrong.append((each.run["number"], each.run["family"], error))
    assert not wrong


@pytest.mark.parametrize("family", FAMILIES)
def test_random_runs(runs: list[Stored], family: str) -> None:
    """State and derivatives of 200 random runs equal those of the program: structures, tuned masses, rows, loads, laws."""
    check([each for each in runs[::PART] if each.run["family"] == family])


@pytest.mark.parametrize("family", STOPS)
def test_random_runs_with_stops(family: str) -> None:
    """Runs with stops, and runs that end within a contact, equal those of the program.

    The program had no stops, and all of its runs ended in flight: nothing independent computed derivatives of either.
    """
    check([each for each in read(STOPS_DATA)[1][::2] if each.run["family"] == family])


@pytest.mark.slow
@pytest.mark.parametrize("family", STOPS)
def test_all_random_runs_with_stops(family: str) -> None:
    """The same of all 230 runs."""
    check([each for each in read(STOPS_DATA)[1] if each.run["family"] == family])


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_all_random_runs(runs: list[Stored], family: str) -> None:
    """The same of all 1000 runs without stops."""
    check([each for each in runs if each.run["family"] == family])


def test_stored_runs_are_those_of_the_program(runs: list[Stored]) -> None:
    """The files state the digest of the present program, contain all kinds of runs, and are more exact than the limits."""
    about, _ = read()
    with_stops, stopped = read(STOPS_DATA)
    assert about["program"] == with_stops["program"] == read(CLOSED)[0]["program"] == digest()
    assert max(with_stops["errors"]) < 1e-11
    assert len(stopped) == 230
    assert {each.run["family"] for each in stopped} == set(STOPS)
    assert {stop["other"] >= 0 for each in stopped for stop in each.run["stops"]} == {False, True}
    assert sum(each.run["fraction"] < 0 for each in stopped) > 50
    assert len(runs) == 1000
    assert {each.run["family"] for each in runs} == set(FAMILIES)
    assert {each.run["structure"]["kind"] for each in runs} == {"sdof", "matrices", "fixed"}
    assert {len(each.run["dampers"]) for each in runs} == {1, 2, 3}
    assert {len(damper["balls"]) for each in runs for damper in each.run["dampers"]} == {1, 2, 3}
    assert {len(each.run["tuned"]) for each in runs} == {0, 1, 2}
    assert max(about["errors"]) < 1e-12


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_stored_answers_with_closed_forms(name: str) -> None:
    """The stored answers of the program equal the closed forms of the state and of each derivative."""
    form = CLOSED_FORMS[name]
    stored = read(CLOSED)[1][list(CLOSED_FORMS).index(name)]
    assert (stored.run, stored.paths) == (form.run, form.paths)
    compare(stored.state, stored.derivatives, name)


def compare(state: np.ndarray, derivatives: np.ndarray, name: str) -> None:
    """Compare a state and its derivatives with a closed form, which is exact to rounding."""
    exact, slopes = CLOSED_FORMS[name].state(), CLOSED_FORMS[name].derivatives()
    known = ~np.isnan(exact)
    np.testing.assert_allclose(state[known], exact[known], rtol=2e-14, atol=0)
    terms = np.abs(slopes[known]).max(axis=0)
    terms[terms == 0] = 1.0
    np.testing.assert_allclose(derivatives[known] / terms, slopes[known] / terms, rtol=0, atol=2e-12)


@pytest.mark.slow
@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_program_with_closed_forms(program: Path, name: str) -> None:
    """The program compiled on this machine computes the closed forms."""
    form = CLOSED_FORMS[name]
    (answer,) = answers(program, [question(form.run, form.paths)])
    assert not isinstance(answer, str)
    compare(answer.state, answer.derivatives, name)


@pytest.mark.slow
def test_equal_elastic_balls_exchange_derivatives(program: Path) -> None:
    """Two equal elastic balls exchange their velocities, and so the derivatives of these, to 113 bits."""
    form = CLOSED_FORMS["two equal elastic balls"]
    (answer,) = answers(program, [question(form.run, form.paths)])
    assert not isinstance(answer, str)
    np.testing.assert_allclose(answer.derivatives[2:, 2:], [[0, 1], [1, 0]], rtol=0, atol=1e-20)


@pytest.mark.slow
@pytest.mark.parametrize("number", [0, 7, 19, 45])
def test_program_repeats_stored_runs(program: Path, runs: list[Stored], number: int) -> None:
    """The program compiled on this machine computes the stored runs again, also with half of the step in time."""
    stored = runs[number]
    for options in ((), ("30", "-32")):
        (answer,) = answers(program, [question(stored.run, stored.paths)], options)
        assert not isinstance(answer, str)
        np.testing.assert_allclose(answer.state, stored.state, rtol=1e-15, atol=1e-20)
        terms = np.maximum(np.abs(stored.derivatives).max(axis=0), 1e-30)
        np.testing.assert_allclose(answer.derivatives / terms, stored.derivatives / terms, rtol=0, atol=1e-12)
