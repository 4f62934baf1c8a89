"""Paths into a case: found, looked up, given other values."""

from __future__ import annotations

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.model import paths

ROW = rb.ImpactDamper(
    balls=[rb.Sphere(radius="5 mm", material="steel"), rb.Sphere(radius="6 mm", material="steel", mass=0.01)],
    gap="1 mm",
    velocity=[0.1, 0.2],
    contact=rb.Linear(stiffness="1 MN/m", restitution=0.8),
    name="row",
)
CASE = rb.Case(
    structure=rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m"),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"),
        gap="0.4 mm",
        contact=rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid")),
    ),
    load=rb.HalfSine(amplitude="5 kN", duration="1 ms"),
    duration="1 s",
)
BOX = rb.Case(
    structure=rb.Fixed(),
    damper=rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="5 mm", count=1),
        cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
        contact=rb.Tsuji(restitution=0.7),
    ),
    duration=1,
)
TWO = rb.Case(
    structure=rb.Modal(
        frequencies=[10.0, 63.0], damping_ratios=[0.01, 0.02], shapes={"tip": [1.0, -1.0]}, participation=[1.0, 0.5]
    ),
    dampers=[CASE.dampers[0], ROW],
    base=rb.Harmonic(amplitude="1 m/s^2", frequency="10 Hz"),
    duration=1.0,
)


@pytest.mark.parametrize(
    ("case", "path", "place", "value", "unit", "short"),
    [
        (CASE, "damper.gap", ("dampers", 0, "gap"), 4e-4, "m", "damper.gap"),
        (CASE, "dampers[0].gap", ("dampers", 0, "gap"), 4e-4, "m", "damper.gap"),
        (CASE, "dampers.gap", ("dampers", 0, "gap"), 4e-4, "m", "damper.gap"),
        (CASE, "damper.ball.radius", ("dampers", 0, "balls", 0, "radius"), 0.01, "m", "damper.ball.radius"),
        (CASE, "damper.balls[0].mass", ("dampers", 0, "balls", 0, "mass"), None, "kg", "damper.ball.mass"),
        (CASE, "damper.ball.diameter", ("dampers", 0, "balls", 0, "diameter"), 0.02, "m", "damper.ball.diameter"),
        (CASE, "damper.cavity_length", ("dampers", 0, "cavity_length"), 0.0208, "m", "damper.cavity_length"),
        (CASE, "load.amplitude", ("loads", 0, "amplitude"), 5e3, "N", "load.amplitude"),
        (CASE, "structure.damping_ratio", ("structure", "damping_ratio"), None, "1", "structure.damping_ratio"),
        (CASE, "method.tolerance", ("method", "tolerance"), 1e-12, "1", "method.tolerance"),
        (
            CASE,
            "damper.contact.restitution.wall",
            ("dampers", 0, "contact", "restitution", "wall"),
            "rigid",
            None,
            None,
        ),
        (TWO, "dampers[1].balls[1].mass", ("dampers", 1, "balls", 1, "mass"), 0.01, "kg", "dampers[1].balls[1].mass"),
        (TWO, "dampers[1].velocity[1]", ("dampers", 1, "velocity", 1), 0.2, "m/s", "dampers[1].velocity[1]"),
        (TWO, "structure.frequencies[1]", ("structure", "frequencies", 1), 63.0, "Hz", "structure.frequencies[1]"),
        (TWO, "structure.shapes.tip[0]", ("structure", "shapes", "tip", 0), 1.0, "kg^-0.5", "structure.shapes.tip[0]"),
        (TWO, "base.amplitude", ("base", 0, "amplitude"), 1.0, "m/s^2", "base.amplitude"),
        (TWO, "dampers[1].contact.restitution.e", ("dampers", 1, "contact", "restitution", "e"), 0.8, "1", None),
    ],
)
def test_a_path_is_found(
    case: rb.Case, path: str, place: paths.Place, value: object, unit: str | None, short: str | None
) -> None:
    """A path leads to one field, with its value and unit, and the field has its shortest path."""
    assert paths.place_of(case, path) == place
    assert paths.get(case, path) == (pytest.approx(value) if isinstance(value, float) else value)
    assert paths.unit_of(case, path) == unit
    assert paths.spelt(case, place) == (short or path)


def test_numbers_of_restitution_have_no_unit() -> None:
    """A restitution law may be given as a number, which has no dimension."""
    assert paths.unit_of(CASE, "damper.contact.restitution") == "1"
    assert paths.unit_of(CASE, "damper.ball.material") is None


@pytest.mark.parametrize(
    ("case", "path", "parts"),
    [
        (CASE, "damper.gpa", ["damper.gpa: there is no 'gpa' in damper", "did you mean 'gap'?"]),
        (
            BOX,
            "damper.cavity.height",
            ["there is no 'height' in damper.cavity", "did you mean 'damper.cavity.size[2]'?"],
        ),
        (CASE, "damper.radius", ["there is no 'radius' in damper", "did you mean 'damper.ball.radius'?"]),
        (CASE, "dampr.gap", ["there is no 'dampr' in a case", "did you mean 'damper' or 'dampers'?"]),
        (CASE, "gap", ["there is no 'gap' in a case", "did you mean 'damper.gap'?"]),
        (CASE, "dampers[1].gap", ["dampers has 1 item"]),
        (CASE, "base.amplitude", ["there is no base in this case"]),
        (CASE, "structure[0].mass", ["structure is not a list"]),
        (CASE, "damper.wall.young", ["damper.wall is not set in this case"]),
        (CASE, "damper.gap.mm", ["there is no 'mm' in damper.gap"]),
        (CASE, "damper..gap", ["not a path"]),
        (CASE, "", ["not a path"]),
        (TWO, "damper.gap", ["damper.gap: the case has 2 of damper, and an index is needed", "damper[0] to damper[1]"]),
        (TWO, "structure.shapes.top[0]", ["there is no 'top' in structure.shapes", "tip"]),
    ],
)
def test_a_path_that_leads_nowhere(case: rb.Case, path: str, parts: list[str]) -> None:
    """A wrong path is refused with the reason and similar paths."""
    with pytest.raises(rb.CaseError) as caught:
        paths.place_of(case, path)
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize(
    ("path", "value", "seen"),
    [
        ("damper.gap", "2 mm", 2e-3),
        ("damper.ball.material", "brass", None),
        ("damper.ball.material.density", 8000.0, 8000.0),
        ("structure.mass", 10, 10.0),
        ("load.amplitude", "1 kN", 1e3),
        ("damper.contact", rb.Linear(stiffness=1e6, restitution=0.5), rb.Linear(stiffness=1e6, restitution=0.5)),
        ("damper.contact.restitution", 0.9, rb.Constant(0.9)),
        ("damper.velocity", 0.3, (0.3,)),
        ("damper.start", "0.1 mm", "0.0001 m"),
        ("method", rb.Newton(), rb.Newton()),
        ("load", rb.Harmonic(amplitude="1 N", frequency=5.0), None),
    ],
)
def test_a_value_is_replaced(path: str, value: object, seen: object) -> None:
    """A replaced value is read as in a case file; the given case stays as it is."""
    before = CASE.to_toml()
    changed = paths.replaced(CASE, {path: value})
    if seen is not None:
        assert paths.get(changed, path) == seen
    assert changed != CASE and CASE.to_toml() == before


@pytest.mark.parametrize(
    ("case", "path", "value", "gone"),
    [
        (CASE, "structure.damping_ratio", 0.1, "structure.damping"),
        (CASE, "damper.contact.alpha", 0.1, "damper.contact.restitution"),
        (TWO, "dampers[1].contact.contact_time", 1e-4, "dampers[1].contact.stiffness"),
        (TWO, "dampers[1].contact.damping", 5.0, "dampers[1].contact.restitution"),
        (CASE.model_copy(update={"output": rb.Output(rate=10.0)}), "output.times", [0.5], "output.rate"),
    ],
)
def test_a_value_replaces_its_alternative(case: rb.Case, path: str, value: object, gone: str) -> None:
    """A replaced field removes other fields that state the same quantity."""
    assert paths.get(paths.replaced(case, {path: value}), gone) is None


def test_cavity_and_diameter_are_set() -> None:
    """The length of the cavity and the diameter are read as in a case file, also together."""
    changed = paths.replaced(CASE, {"damper.cavity_length": "32 mm", "damper.ball.diameter": "30 mm"})
    assert paths.get(changed, "damper.gap") == pytest.approx(1e-3, rel=1e-12)
    assert changed.dampers[0].balls[0].radius == 0.015


def test_a_unit_comes_with_the_amplitude() -> None:
    """A shaker given by its displacement takes an acceleration instead."""
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")), duration=1.0, dampers=CASE.dampers
    )
    assert paths.unit_of(case, "structure.motion.amplitude") == "m"
    changed = paths.replaced(case, {"structure.motion.amplitude": "2 m/s^2"})
    assert paths.unit_of(changed, "structure.motion.amplitude") == "m/s^2"
    assert paths.get(paths.replaced(case, {"structure.motion.amplitude": 0.002}), "structure.motion.amplitude") == 0.002


@pytest.mark.parametrize(
    ("values", "parts"),
    [
        ({"damper.gap": -1.0}, ["damper.gap = -1.0", "must not be negative"]),
        ({"damper.gap": "1 kg"}, ["damper.gap", "a length (m) is needed"]),
        ({"damper.gap": 1e-3, "dampers[0].gap": 2e-3}, ["dampers[0].gap and damper.gap are the same"]),
        ({"structure.damping": 1.0, "structure.damping_ratio": 0.1}, ["exclude each other"]),
        ({"damper.start": 1.5}, ["inside a wall"]),
        ({"damper.contact": 3.0, "damper.contact.alpha": 0.1}, ["not both"]),
    ],
)
def test_a_wrong_value_is_refused(values: dict[str, object], parts: list[str]) -> None:
    """A case that does not fit is refused in the words of case files."""
    with pytest.raises(rb.CaseError) as caught:
        paths.replaced(CASE, values)
    for part in parts:
        assert part in str(caught.value)


def test_own_materials_keep_their_names() -> None:
    """A material of the case itself can be named."""
    own = rb.Material(name="mine", density=1000.0, young=1e9, poisson=0.3, yield_stress=1e7)
    case = paths.replaced(CASE, {"damper.wall": own})
    assert paths.get(paths.replaced(case, {"damper.ball.material": "mine"}), "damper.ball.material") == own


def test_a_file_stays(tmp_path: pytest.TempPathFactory) -> None:
    """A record from a file can be scaled; its numbers cannot be changed one by one."""
    file = f"{tmp_path}/push.npy"
    np.save(file, np.array([[0.0, 1.0], [1.0, 2.0]]))
    case = paths.replaced(CASE, {"load": rb.Record.from_file(file)})
    assert paths.replaced(case, {"load.scale": 3.0}).loads[0].evaluate(0.5) == pytest.approx(4.5)
    with pytest.raises(rb.CaseError, match="was read from"):
        paths.replaced(case, {"load.values[0]": 3.0})
