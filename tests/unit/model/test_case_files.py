"""Case files: round trips, examples, tables written twice, JSON Schema."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb

EXAMPLES = sorted((Path(__file__).parents[3] / "examples").glob("*.toml"))
BALL = rb.Sphere(radius="5 mm", material="steel")
MINE = rb.Material(name="mine", density=1234.5, young=1e9, poisson=0.1, yield_stress=2e7, source="measured")
CASES = {
    "free body on a moving base": rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=0.0, velocity=0.1),
        base=rb.HalfSine(amplitude="10 g_0", duration="10 ms"),
        duration=1.0,
        output=rb.Output(times=[0.1, 0.3]),
    ),
    "two loads": rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=3.0, damping_ratio=1.5),
        load=[
            rb.SineSweep(amplitude="1 N", first_frequency=1.0, last_frequency=5.0, duration=1.0),
            rb.Harmonic(amplitude=1 / 3, frequency="2 rad/s", stop=0.5),
        ],
        duration=1.0,
        output=rb.Output(rate="1 kHz"),
    ),
    "two balls in a fixed cavity": rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(
            balls=[rb.Sphere(diameter="1 mm", material=MINE), rb.Sphere(radius="1 mm", material="glass", mass=0.1)],
            cavity_length="4 mm",
            start=[-0.5, 0.2],
            velocity=[0.1, -0.2],
            wall="rigid",
            gravity=-9.81,
            contact=rb.Linear(contact_time="1 ms", restitution=rb.Tabulated(speeds=[0.1, 1.0], values=[0.9, 0.5])),
            ball_contact=rb.Thornton(yield_pressure="1 GPa"),
        ),
        duration=1.0,
    ),
    "shaker": rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="30 Hz", phase="90 deg")),
        damper=rb.ImpactDamper(ball=BALL, gap="1 mm", start="0.2 mm", contact=rb.Tsuji(restitution=rb.Johnson())),
        duration=1.0,
        method=rb.Newton(restitution=0.0),
    ),
    "modes": rb.Case(
        structure=rb.Modal(frequencies=["0 Hz", "1 kHz"], damping_ratios=[0.0, 0.1], shapes={"a": [1, 2], "b": [0, 1]}),
        duration=0.1,
        method=rb.TwoStep(inner="dopri5"),
    ),
    "matrices": rb.Case(
        structure=rb.Matrices(
            M=np.diag([1.0, 2.0]), C=np.zeros((2, 2)), K=[[2, -1], [-1, 2]], points={"end": 1, "mean": [0.5, 0.5]}
        ),
        duration=1.0,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_written_case_reads_back_equal(name: str, tmp_path: Path) -> None:
    """A case that is written and read again is equal to the last bit."""
    file = tmp_path / "case.toml"
    CASES[name].to_file(file)
    back = rb.Case.from_file(file)
    assert back.to_toml() == CASES[name].to_toml()
    assert back == CASES[name]


@pytest.mark.parametrize("left", CASES)
@pytest.mark.parametrize("right", CASES)
def test_cases_are_equal_to_themselves_only(left: str, right: str) -> None:
    """Cases compare by their fields, whether or not their modes have been computed."""
    assert (CASES[left] == CASES[right]) is (left == right)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_read_and_read_back(path: Path) -> None:
    """Each example file reads as a case that is equal after a round trip."""
    case = rb.Case.from_file(path)
    assert case.name
    assert rb.Case.from_toml(case.to_toml()).to_toml() == case.to_toml()


def test_two_start_positions_may_be_lengths() -> None:
    """Start positions may be lengths, or a fraction and a length."""
    for start in (["-0.5 mm", "0.2 mm"], [-0.5, "0.2 mm"]):
        damper = rb.ImpactDamper(balls=[BALL, BALL], gap="1 mm", start=start, contact=rb.Tsuji(restitution=0.9))
        np.testing.assert_allclose(damper.positions0, [-5e-4, 2e-4], rtol=1e-14)


def test_numbers_of_numpy_are_written_as_numbers() -> None:
    """NumPy scalars are written as plain numbers and read back equal."""
    ball = rb.Sphere(radius=np.float64(5e-3), material="steel")
    damper = rb.ImpactDamper(ball=ball, gap=np.float64(4e-4), start="0.1 mm", contact=rb.Tsuji(alpha=np.float64(0.1)))
    case = rb.Case(structure=rb.Fixed(), damper=damper, duration=np.int64(2))
    moved = damper.model_copy(update={"gap": np.float64(5e-4), "gravity": np.float32(0.1)})
    for each in (case, case.model_copy(update={"dampers": (moved,), "duration": np.float64(3)})):
        text = each.to_toml()
        assert "np." not in text
        assert rb.Case.from_toml(text) == each


def test_materials_of_a_case_file() -> None:
    """A material defined in the case file can be named for balls and walls."""
    case = rb.Case.from_toml(
        'duration = "1 s"\nstructure = { kind = "fixed" }\n'
        '[damper]\ngap = "1 mm"\nwall = "mine"\nball = { radius = "1 mm", material = "mine" }\n'
        'contact = { kind = "tsuji", restitution = 0.9 }\n'
        '[materials.mine]\ndensity = "2 g/cm^3"\nyoung = "3 GPa"\npoisson = 0.4\n'
    )
    assert case.dampers[0].balls[0].material.density == 2000.0
    assert isinstance(case.dampers[0].wall, rb.Material)
    assert case.dampers[0].wall.young == 3e9


def test_one_and_several_may_be_written_alike() -> None:
    """A single load and a list of one load describe the same case."""
    load = rb.HalfSine(amplitude="1 N", duration="1 ms")
    structure = rb.SDOF(mass=1.0, stiffness=1.0)
    one = rb.Case(structure=structure, load=load, duration=1.0)
    assert one == rb.Case(structure=structure, loads=[load], duration=1.0)


HEAD = 'duration = "1 s"\nstructure = { kind = "sdof", mass = "1 kg", stiffness = "1 kN/m" }\n'
CAVITY = 'gap = "1 mm"\ncontact = { kind = "tsuji", restitution = 0.9 }\n'
PULSE = 'kind = "half_sine"\nduration = "1 ms"\n'


@pytest.mark.parametrize(
    ("above", "table", "content", "several"),
    [
        ("", "damper", CAVITY + 'ball = { radius = "5 mm", material = "steel" }\n', "dampers"),
        ("", "load", PULSE + 'amplitude = "1 N"\n', "loads"),
        ("", "base", PULSE + 'amplitude = "1 m/s^2"\n', "base"),
        (f"[damper]\n{CAVITY}", "damper.ball", 'radius = "5 mm"\nmaterial = "steel"\n', "damper.balls"),
    ],
)
def test_a_table_that_is_written_twice(above: str, table: str, content: str, several: str) -> None:
    """A table written twice is refused with its line and the syntax of an array of tables, which is accepted."""
    first = f"{HEAD}{above}[{table}]\n{content}"
    with pytest.raises(rb.CaseError, match=f"line {len(first.splitlines()) + 1}") as caught:
        rb.Case.from_toml(f"{first}[{table}]\n{content}")
    assert f"  [{table}]\n  try: " in str(caught.value) and f"[[{several}]]" in str(caught.value)
    case = rb.Case.from_toml(HEAD + above + 2 * f"[[{several}]]\n{content}")
    assert 2 in (len(case.loads), len(case.base), len(case.dampers), *(len(each.balls) for each in case.dampers))


def test_a_material_that_is_written_twice() -> None:
    """Two tables of one material are refused with the advice to rename one."""
    table = "[materials.base]\ndensity = 7800\n"
    with pytest.raises(rb.CaseError, match="try: another name"):
        rb.Case.from_toml(HEAD + 2 * table)


def test_other_tables_that_are_written_twice() -> None:
    """A repeated table that has no array form is refused with the advice to join both."""
    for name in ("structure", '"it\'s"'):
        with pytest.raises(rb.CaseError, match="twice") as caught:
            rb.Case.from_toml(f"[{name}]\na = 1\n[{name}]\n")
        assert str(caught.value).endswith("try: one table with all of these fields")


def test_schema_names_every_field_and_its_units() -> None:
    """The JSON Schema is valid JSON, lists the kinds and has the unit of a quantity."""
    schema = json.loads(json.dumps(rb.Case.json_schema()))
    mass = schema["$defs"]["SDOF"]["properties"]["mass"]
    assert {option["type"] for option in mass["anyOf"]} == {"number", "string"}
    assert "kg" in mass["description"]
    assert {"damper", "load", "base", "structure", "materials"} <= set(schema["properties"])
    assert {"SDOF", "Modal", "Matrices", "Fixed", "Shaker"} <= set(schema["$defs"])


def test_schema_has_every_accepted_form() -> None:
    """The JSON Schema accepts one part for a list, a number as restitution and the name of a material."""
    schema = rb.Case.json_schema()
    damper = schema["$defs"]["ImpactDamper"]
    assert {"ball", "balls", "gap", "cavity_length"} <= set(damper["properties"])
    assert {"ball", "balls"}.isdisjoint(damper["required"])
    assert {"$ref": "#/$defs/Sphere"} in damper["properties"]["ball"]["anyOf"][1]["oneOf"]
    assert {"kind", "mass"} <= set(schema["$defs"]["Striker"]["required"])  # without a kind, a table is a sphere
    assert {"$ref": "#/$defs/ImpactDamper"} in schema["properties"]["damper"]["anyOf"][1]["oneOf"]
    assert schema["required"] == ["structure", "duration"]
    restitution = json.dumps(schema["$defs"]["Tsuji"]["properties"]["restitution"])
    assert '"type": "number"' in restitution
    assert '"type": "string"' in json.dumps(schema["$defs"]["Sphere"]["properties"]["material"])
