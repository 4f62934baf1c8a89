"""Settings of all tests."""

import gc
import os
import signal
import sys
from collections.abc import Iterator
from functools import cache

import pytest

pytest_plugins = ("support.processor_time",)

# The workers of pytest share the cores. More threads of BLAS wait for each other: eigenvalues of a matrix of 900 rows take
# 1.4 s of processor time with two threads and 0.2 s with one. Read when NumPy loads, also in processes that tests start.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Garbage collections among the many objects of the libraries take a twentieth of the processor time of the tests.
gc.set_threshold(200_000, 50, 50)


def pytest_configure() -> None:
    """Let Ctrl-C reach tests and the programs they start: shells start background jobs with it ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def examples_write_into_an_own_folder(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run the examples of docstrings in an empty folder, since some write files."""
    if isinstance(request.node, pytest.DoctestItem):
        monkeypatch.chdir(request.getfixturevalue("tmp_path"))


@cache
def _examples_of_orbits() -> dict[str, object]:
    """Return the periodic motion of the example of `find_orbit`, and the branch of that of `continue_orbit`."""
    import doctest

    import rattlebox as rb

    (example,) = doctest.DocTestFinder(recurse=False).find(rb.find_orbit, "find_orbit")
    names: dict[str, object] = {}
    for line in example.examples[:-1]:
        exec(line.source, names)
    branch = rb.continue_orbit(names["orbit"], "load.frequency", ("32 Hz", "38 Hz"), progress=False)
    return {"orbit": names["orbit"], "branch": branch}


@pytest.fixture(autouse=True)
def examples_go_on_from_others(request: pytest.FixtureRequest, doctest_namespace: dict[str, object]) -> None:
    """Give examples about periodic motions the motion and the branch of the examples to which they refer."""
    if isinstance(request.node, pytest.DoctestItem) and ".studies.orbits." in request.node.name:
        doctest_namespace.update(_examples_of_orbits())


@pytest.fixture(autouse=True)
def figures_are_closed() -> Iterator[None]:
    """Close the figures of a test: scripts leave them open, and the twentieth open one is an error in a later test."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
