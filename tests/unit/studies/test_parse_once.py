"""Number of times that a study parses its files and the quantities of its case."""

from __future__ import annotations

import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from support.command import rattlebox

import rattlebox as rb
from rattlebox.model import units
from rattlebox.model.materials import materials

CASE = """\
duration = "0.101 s"

[structure]
kind = "sdof"
mass = "20.1 kg"
stiffness = "80.1 kN/m"
velocity = "1.1 m/s"

[damper]
gap = "0.41 mm"
ball = { radius = "33.1 mm", material = "oak" }
contact = { kind = "tsuji", restitution = 0.5 }

[materials.oak]
density = "701 kg/m^3"
young = "10.1 GPa"
poisson = 0.3
"""
STUDY = """\
case = "case.toml"
measure = "impacts"
skip = "10.1 ms"

[axes]
"damper.gap" = { from = "0.51 mm", to = "2.01 mm", count = 30 }
"structure.mass" = ["19.1 kg", "21.1 kg"]
"damper.ball.material" = ["oak", "steel"]
"""
TEXTS = {*CASE.split('"'), *STUDY.split('"')}


@pytest.fixture
def parsed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """Return how often each text of TOML and each quantity of the files in the current folder is parsed."""
    counts: Counter[str] = Counter()
    loads, parse = tomllib.loads, units.parse

    def counting_loads(content: str) -> dict[str, Any]:
        counts[content] += 1
        return loads(content)

    def counting_parse(value: Any, allowed: tuple[str, ...]) -> tuple[float, str | None]:
        if isinstance(value, str) and value in TEXTS:
            counts[value] += 1
        return parse(value, allowed)

    materials()  # The library of materials is parsed once in a process.
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "study.toml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(tomllib, "loads", counting_loads)
    monkeypatch.setattr(units, "parse", counting_parse)
    return counts


def test_a_study_file_and_its_case_are_parsed_once(parsed: Counter[str]) -> None:
    """A sweep from a file with results on disk parses both files, the case and its own material once."""
    assert rattlebox("sweep", "study.toml", "-o", "out").returncode == 0
    assert parsed.keys() >= {CASE, STUDY, "80.1 kN/m", "33.1 mm", "10.1 GPa", "21.1 kg", "2.01 mm", "10.1 ms"}
    assert set(parsed.values()) == {1}


def test_a_study_of_a_case_in_python_parses_no_file(parsed: Counter[str]) -> None:
    """A sweep of a case that is read already parses the values of its axes once, and neither the case nor any TOML."""
    case = rb.Case.from_file("case.toml")
    parsed.clear()
    rb.sweep(case, {"structure.mass": ["19.1 kg", "21.1 kg"]}, "impacts", progress=False, store="out")
    rb.open_study("out")
    assert parsed == {"19.1 kg": 1, "21.1 kg": 1}


def test_a_run_parses_its_case_once(parsed: Counter[str]) -> None:
    """A run with files and figures parses its case file, and each quantity in it, once."""
    assert rattlebox("run", "case.toml", "-o", "out").returncode == 0
    assert parsed.keys() >= {CASE, "80.1 kN/m", "10.1 GPa"}
    assert set(parsed.values()) == {1}
