"""Texts of quantities: what the user wrote comes back from `Case.to_file`, and never with another value."""

from __future__ import annotations

import copy
import pickle
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.model.paths import all_paths, get, unit_of

ROOT = Path(__file__).parents[3]
FILES = sorted([*(ROOT / "examples").glob("*.toml"), *(ROOT / "src/rattlebox/app/templates").glob("*.toml")])
MOVED = """
duration = "1500 ms"
[structure]
kind = "sdof"
mass = "412 g"
frequency = "640 rpm"
damping = "0.2 N s/m"
displacement = "0.12 in"
[damper]
cavity_length = "26 mm"
ball = { diameter = "1.2 cm", mass = "7.1 g", material = "own" }
start = ["0.3 mm"]
contact = { kind = "linear", contact_time = "90 us", restitution = "62 %" }
[[load]]
kind = "half_sine"
amplitude = "3 lbf"
duration = "4 ms"
[[load]]
kind = "record"
dt = "250 ms"
unit = "kN"
values = [0.0, 0.1, 0.3, -0.2, 0.0, 0.05, 0.0]
[materials.own]
density = "7.9 g/cm^3"
young = "190 GPa"
poisson = 0.31
"""


def texts(node: Any) -> Iterator[tuple[str, str]]:
    """Yield the texts that begin with a digit or sign, with the nearest key above them."""
    for key, item in node.items() if isinstance(node, dict) else enumerate(node):
        for place, text in [(key, item)] if isinstance(item, str) else texts(item) if hasattr(item, "__iter__") else []:
            if text[:1] in "0123456789+-.":
                yield (key if isinstance(place, int) else place), text


def written(case: rb.Case, tmp_path: Path) -> str:
    """Return the text of a case file, from which an equal case was read."""
    case.to_file(tmp_path / "written.toml")
    back = rb.Case.from_file(tmp_path / "written.toml")
    assert back == case
    assert back.to_toml() == case.to_toml()
    return (tmp_path / "written.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_every_quantity_of_a_case_file_keeps_its_text(path: Path, tmp_path: Path) -> None:
    """A case file that is read and written has the same texts; only equal numbers were compared, so nobody saw SI units."""
    given = sorted(texts(tomllib.loads(path.read_text(encoding="utf-8"))))
    text = written(rb.Case.from_file(path), tmp_path)
    rest = list(texts(tomllib.loads(text)))
    for quantity in given:
        assert quantity in rest
        rest.remove(quantity)


def test_texts_of_all_kinds(tmp_path: Path) -> None:
    """Alternatives, percentages, angular speeds, inches, steps and units of records keep their texts."""
    text = written(rb.Case.from_toml(MOVED), tmp_path)
    content = tomllib.loads(text)
    for quantity in texts(tomllib.loads(MOVED)):
        assert quantity in list(texts(content))
    record = content["loads"][1]
    assert (record["unit"], record["values"][2], record.get("times")) == ("kN", 0.3, None)


def test_texts_of_parts_that_are_made_in_python(tmp_path: Path) -> None:
    """Texts, pairs, quantities of pint and lists given in Python are written as they were given."""
    import pint

    structure = rb.Modal(frequencies=["11 Hz", 47.0], damping_ratios=[0.01, 0.02], shapes={"tip": [2.0, 0.5]})
    damper = rb.ImpactDamper(
        balls=[rb.Sphere(radius=(4, "mm"), material="brass"), rb.Sphere(radius=0.004, material="brass")],
        gap=pint.UnitRegistry().Quantity(0.5, "mm"),
        velocity=["3 cm/s", 0.0],
        contact=rb.Tsuji(restitution=0.8),
        point="tip",
    )
    text = written(rb.Case(structure=structure, damper=damper, duration=np.float64(1)), tmp_path)
    content = tomllib.loads(text)
    assert content["structure"]["frequencies"] == ["11 Hz", 47.0]
    assert [ball["radius"] for ball in content["dampers"][0]["balls"]] == ["4 mm", "0.004 m"]
    assert content["dampers"][0]["gap"] == "0.5 mm"
    assert content["dampers"][0]["velocity"] == ["3 cm/s", 0.0]
    assert content["duration"] == "1.0 s"


def test_a_changed_value_is_not_written_with_its_old_text(tmp_path: Path) -> None:
    """Every number that is replaced, or changed in a copy, is written with its new value; all other texts stay."""
    case = rb.Case.from_toml(MOVED)
    before = sorted(texts(tomllib.loads(written(case, tmp_path))))
    changed = 0
    for path in all_paths(case):
        value = get(case, path)
        if not isinstance(value, float) or unit_of(case, path) is None:
            continue
        try:
            other = case.replaced({path: 1.015625 * value})
        except rb.RattleboxError:  # such as a diameter that no longer fits its cavity
            continue
        if other == case:
            continue
        changed += 1
        after = sorted(texts(tomllib.loads(written(other, tmp_path))))  # reads back equal, so no old text
        assert len([text for text in before if text not in after]) <= 2, path
    assert changed > 10
    load = case.loads[0]
    assert isinstance(load, rb.HalfSine)
    moved = case.model_copy(update={"loads": (load.model_copy(update={"amplitude": 2.5}), case.loads[1])})
    text = written(moved, tmp_path)
    assert "amplitude = 2.5" in text and "lbf" not in text
    assert 'duration = "4 ms"' in text


def test_alternatives_exchange_their_texts(tmp_path: Path) -> None:
    """A damping ratio in place of a damping, a gap in place of a length and a text in place of a text are written."""
    case = rb.Case.from_toml(MOVED).replaced(
        {"structure.damping_ratio": "3 %", "damper.gap": "1.5 mm", "loads[0].amplitude": "20 N"}
    )
    content = tomllib.loads(written(case, tmp_path))
    assert content["structure"]["damping_ratio"] == "3 %" and "damping" not in content["structure"]
    assert content["dampers"][0]["gap"] == "1.5 mm" and "cavity_length" not in content["dampers"][0]
    assert content["loads"][0]["amplitude"] == "20 N"
    assert content["dampers"][0]["balls"][0]["diameter"] == "1.2 cm"


def test_the_spelling_is_no_part_of_a_case() -> None:
    """Cases that differ in spelling are equal, have one canonical text and one hash, and their copies keep their texts."""
    ways: list[Any] = ["5 mm", 0.005, "0.5 cm", (5, "mm")]
    balls = [rb.Sphere(radius=way, material="steel") for way in ways]
    cases = [
        rb.Case(
            structure=rb.Fixed(),
            damper=rb.ImpactDamper(ball=ball, gap="1 mm", contact=rb.Tsuji(alpha=0.1)),
            duration=1.0,
        )
        for ball in balls
    ]
    assert all(case == cases[0] for case in cases)
    assert len({case.to_toml() for case in cases}) == 1
    assert len({case.model_dump_json() for case in cases}) == 1
    assert len(set(map(hash, balls))) == 1
    for twin in (pickle.loads(pickle.dumps(cases[0])), copy.deepcopy(cases[0])):
        assert twin == cases[0]


def test_a_file_whose_name_begins_with_a_digit(tmp_path: Path) -> None:
    """The name of a file is no quantity: it is written relative to the folder of the case file."""
    (tmp_path / "2024.csv").write_text("0,0\n1,1\n")
    (tmp_path / "cases").mkdir()
    push = rb.Record.from_file(tmp_path / "2024.csv", unit="N")
    case = rb.Case(structure=rb.SDOF(mass=1.0, stiffness="2 N/mm"), load=push, duration="1 s")
    case.to_file(tmp_path / "cases" / "case.toml")
    text = (tmp_path / "cases" / "case.toml").read_text()
    assert 'file = "../2024.csv"' in text and 'stiffness = "2 N/mm"' in text
