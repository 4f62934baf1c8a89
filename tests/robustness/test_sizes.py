"""Requests that need too much memory or time are refused before memory is asked for, with advice that holds.

No test saw them: each limit was tested where it was, and none with numbers that no machine can hold.
"""

from __future__ import annotations

import re
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest
from support.command import rattlebox

import rattlebox as rb
from rattlebox.studies.run.store import MemoryResult, Plan

RANDOM = """
duration = "%(time)s"
structure = { kind = "sdof", mass = "3 kg", stiffness = "90 kN/m" }
load = { kind = "random", psd = [[5, 1], [%(top)s, 1]], duration = "%(time)s", unit = "N" }
output = { rate = "1 Hz" }
"""


GAP = ("0.1 mm", "1 mm")
FORCE = ("1 kN", "2 kN")


def refused(call: Callable[[], object]) -> str:
    """Return the message of a call that is refused, and check that it took neither time nor memory."""
    tracemalloc.start()
    start = time.process_time()
    try:
        with pytest.raises(rb.RattleboxError) as error:
            call()
        assert tracemalloc.get_traced_memory()[1] < 1e8
    finally:
        tracemalloc.stop()
    assert time.process_time() - start < 10
    assert "\n  try: " in str(error.value)
    return str(error.value)


@pytest.mark.parametrize(
    "axes",
    [
        lambda: {"damper.gap": rb.linspace(*GAP, 120_000), "load.amplitude": rb.geomspace(*FORCE, 90_000)},
        lambda: {"damper.gap": rb.linspace(*GAP, 10**10)},
        lambda: {"damper.gap": rb.geomspace(*GAP, 3 * 10**9)},
        lambda: rb.random_design({"damper.gap": GAP}, 10**10),
        lambda: [{"damper.gap": ["1 mm"]}, rb.replicas({"damper.start": 0.1}, 10**11)],
    ],
)
def test_plans_of_too_many_variants(axes: Callable[[], object]) -> None:
    """A plan of 1e9 variants and more is refused, from one axis, a grid, a random design and replicas."""
    message = refused(lambda: rb.sweep(rb.reference_case(duration=0.01), axes(), "rms", progress=False))
    assert "1e+08 variants" in message


def test_study_file_of_too_many_variants(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A study file with such a plan ends with exit code 2."""
    monkeypatch.chdir(tmp_path)
    rb.reference_case(duration=0.01).to_file("case.toml")
    axis = '{ from = "0.1 mm", to = "1 mm", count = 20_000_000_000 }'
    Path("study.toml").write_text(f'case = "case.toml"\nmeasure = "rms"\n[axes]\n"damper.gap" = {axis}\n')
    done = rattlebox("sweep", "study.toml")
    assert done.returncode == 2 and "variants" in done.stderr and "\n  try: " in done.stderr


def test_results_in_memory_are_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    """Arrays of results that exceed the memory of the machine are refused with the advice to use a store."""
    from rattlebox.studies.run import store

    monkeypatch.setattr(store, "memory", lambda: 1e6)
    large = Plan(dims=("a",), shape=(10**6,), outputs={"x": ((), "f8", {})})
    with pytest.raises(rb.ResourceError, match=re.escape("1e+06 variants take 0.008 GB")):
        MemoryResult(large, [])  # type: ignore[arg-type]


@pytest.mark.parametrize(("duration", "top"), [("2e6 s", "2000"), ("3000 s", "40e3"), ("1 s", "1e12")])
def test_long_random_signals(duration: str, top: str) -> None:
    """A random signal that exceeds the memory is refused with a duration that is accepted."""
    text = RANDOM % {"time": duration, "top": top}
    message = refused(lambda: rb.Case.from_toml(text))
    advised = re.search(r'duration = "([^"]+) s"', message)
    assert advised and "particles" not in message
    count = 16 * float(top) * float(advised[1])
    assert 60 * count <= 16e9 < 1.3 * 60 * count


@pytest.mark.parametrize(
    "text",
    [
        ".".join(["part"] * 20_000) + " = 1",
        f"[{'.'.join(['a'] * 9_000)}]",
        "x = {" + ".".join(["'a'"] * 9_000) + " = 1}",
        "\n".join(f"unknown_{number} = 1" for number in range(8_000)),
        "[damper]\n" + "\n".join(f"unknown_{number} = 1" for number in range(8_000)),
        "a = " + "[" * 4_000 + "]" * 4_000,
        "a = " + "{b = " * 3_000 + "1" + "}" * 3_000,
    ],
    ids=["dots", "header", "inline", "unknown", "unknown in a part", "lists", "tables"],
)
def test_texts_that_took_minutes(text: str) -> None:
    """Long keys, deep nesting and thousands of unknown fields are refused in less than seconds."""
    start = time.process_time()
    with pytest.raises(rb.CaseError):
        rb.Case.from_toml(text)
    assert time.process_time() - start < 2
