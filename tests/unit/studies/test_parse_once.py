"""Number of times that a study parses its files and the quantities in them."""

from __future__ import annotations

import re
import sys
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from support.command import rattlebox

import rattlebox as rb
from rattlebox.model import units
from rattlebox.model.materials import materials
from rattlebox.studies.study_file import read_study

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
MOTION = 'structure = { kind = "shaker", motion = { kind = "harmonic", amplitude = "1.01 mm", frequency = "10.1 Hz" } }'
LOAD = """\
structure = { kind = "sdof", mass = "1.04 kg", stiffness = "40.1 kN/m" }
load = { kind = "harmonic", amplitude = "5.02 N", frequency = "30.1 Hz" }"""
DRIVEN = """\
duration = "1.01 s"
method = { kind = "newton" }

[damper]
gap = "1.02 mm"
velocity = "0.11 m/s"
ball = { radius = "10.1 mm", material = "oak" }
contact = { kind = "tsuji", restitution = 0.6 }

[materials.oak]
density = "702 kg/m^3"
young = "10.2 GPa"
poisson = 0.3
"""
AMPLITUDE = "structure.motion.amplitude"
KINDS = {
    "bifurcation": (MOTION, f'cycles = [4, 4]\npath = "{AMPLITUDE}"\nvalues = ["0.51 mm", "2.01 mm"]'),
    "basins": (
        MOTION,
        'cycles = [4, 4]\n[starts]\n"damper.velocity" = { from = "-0.12 m/s", to = "0.13 m/s", count = 3 }',
    ),
    "lyapunov": (MOTION, f'cycles = [4, 4]\npairs = 2\n[axes]\n"{AMPLITUDE}" = ["0.51 mm", "2.01 mm"]'),
    "loss_map": (
        MOTION,
        'cycles = [2, 4]\nfrequencies = ["11.1 Hz", "20.1 Hz"]\namplitudes = ["0.51 mm", "2.01 mm"]',
    ),
    "design": (
        MOTION,
        'cycles = [2, 4]\nobjective = { reduced_loss = "max" }\ntrials = 3\nstarts = 2\n'
        f'[levels]\n"{AMPLITUDE}" = ["1.03 mm", "2.03 mm"]\n'
        '[parameters]\n"damper.gap" = { from = "0.51 mm", to = "5.01 mm", spacing = "log" }',
    ),
    "sensitivity": (
        MOTION,
        'cycles = [2, 4]\nmeasure = "reduced_loss"\nn = 8\n[bounds]\n"damper.gap" = { from = "0.51 mm", to = "5.01 mm" }',
    ),
    "frequency_response": (
        LOAD,
        'cycles = [4, 4]\nlevels = ["2.51 N", "5.01 N"]\nfrequencies = ["29.1 Hz", "33.1 Hz"]',
    ),
}
TEXTS = {
    part
    for text in (CASE, STUDY, MOTION, LOAD, DRIVEN, *(study for _, study in KINDS.values()))
    for part in text.split('"')
}


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
    for module in list(sys.modules.values()):
        if getattr(module, "parse", None) is parse:
            monkeypatch.setattr(module, "parse", counting_parse)
    return counts


def test_a_study_file_and_its_case_are_parsed_once(parsed: Counter[str]) -> None:
    """A sweep from a file with results on disk parses both files, the case and its own material once."""
    assert rattlebox("sweep", "study.toml", "-o", "out").returncode == 0
    assert parsed.keys() >= {CASE, STUDY, "80.1 kN/m", "33.1 mm", "10.1 GPa", "21.1 kg", "2.01 mm", "10.1 ms"}
    assert set(parsed.values()) == {1}


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_of_study_parses_its_files_once(kind: str, parsed: Counter[str]) -> None:
    """A study with results on disk parses its file, its case, the quantities in both, and no other TOML, once."""
    structure, options = KINDS[kind]
    case, study = f"{structure}\n{DRIVEN}", f'kind = "{kind}"\ncase = "driven.toml"\n{options}\n'
    Path("driven.toml").write_text(case)
    Path("driven_study.toml").write_text(study)
    read_study("driven_study.toml").run(store="out", progress=False)
    rb.open_study("out")
    amplitude = re.search(r'amplitude = "(.*?)"', case)[1]  # read for its unit as well
    quantities = set(re.findall(r'"(-?\d+\.\d+ .*?)"', case + study)) - {amplitude}
    assert {text: count for text, count in parsed.items() if "\n" in text} == {case: 1, study: 1}
    assert {text: parsed[text] for text in quantities} == dict.fromkeys(quantities, 1)


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
