"""Settings of all tests."""

import doctest
import gc
import os
import pydoc
import re
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


def _names_before(text: str) -> dict[str, object]:
    """Return the names that the example of a docstring starts with: those of "the example of `rattlebox.find_orbit`"."""
    names: dict[str, object] = {}
    for name in re.findall(r"example\s+of\s+`(rattlebox\.[\w.]+)`", text):
        names |= _names_of_example(name)
    return names


@cache
def _names_of_example(name: str) -> dict[str, object]:
    """Return the names of the example of a public function."""
    (example,) = doctest.DocTestFinder(recurse=False).find(pydoc.locate(name), name)
    scope = example.globs | _names_before(example.docstring or "")
    for line in example.examples:
        exec(line.source, scope)
    return {key: value for key, value in scope.items() if key not in example.globs}


@pytest.fixture(autouse=True)
def examples_go_on_from_others(request: pytest.FixtureRequest, doctest_namespace: dict[str, object]) -> None:
    """Give an example the names of the examples to which its docstring refers."""
    if isinstance(request.node, pytest.DoctestItem):
        doctest_namespace.update(_names_before(request.node.dtest.docstring or ""))


@pytest.fixture(autouse=True)
def figures_are_closed() -> Iterator[None]:
    """Close the figures of a test: scripts leave them open, and the twentieth open one is an error in a later test."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
