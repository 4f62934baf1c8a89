"""Angles, fields and frames of turning cavities."""

import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

ARM = ("60 mm", "0 mm", "10 mm")
MOTIONS: list[dict[str, Any]] = [
    {"speed": "700 rpm", "angle": "30 deg"},
    {"times": ["0 s", "2 s", "3 s"], "speeds": ["0 rpm", "900 rpm", "600 rpm"]},
    {"times": [-1.0, 0.5, 2.0], "speeds": [10.0, -5.0, 3.0], "angle": 0.2},
    {"times": [0.1, 0.4, 1.0], "angles": [0.0, 0.3, -0.2]},
    {"amplitude": "5 deg", "frequency": "3 Hz"},
]


@pytest.mark.parametrize("motion", MOTIONS)
def test_derivatives_of_the_angle(motion: dict[str, Any]) -> None:
    """Angular velocity and acceleration are the derivatives of the angle, also before the first and after the last time."""
    rotation = rb.Rotation(arm=ARM, **motion)
    times, h = np.linspace(-2.0, 5.0, 701) + 1e-3, 1e-5
    angle, speed, acceleration = rotation.at(times)
    assert np.allclose((rotation.at(times + h).angle - rotation.at(times - h).angle) / (2 * h), speed, atol=1e-4)
    change = (rotation.at(times + h).speed - rotation.at(times - h).speed) / (2 * h)
    assert np.allclose(change, acceleration, atol=1e-3)
    if "angles" not in motion:
        assert float(rotation.at(0.0).angle) == pytest.approx(rotation.angle, abs=1e-12)
    most = rotation.largest(3.0)
    inside = (times > 0) & (times < 3)
    assert np.abs(speed[inside]).max() <= most.speed * (1 + 1e-12)
    assert np.abs(speed[inside]).max() > 0.98 * most.speed
    assert np.abs(angle[inside]).max() <= most.angle * (1 + 1e-12)


@pytest.mark.parametrize("text", ["90 rpm", "90 1/min", "90 rev/min", "90 r/min", "1.5 rev/s", "1.5 Hz", "540 deg/s"])
def test_units_of_speeds(text: str) -> None:
    """Spellings of one angular velocity are equal; that of data sheets, rev/min, was refused with 1/min as advice."""
    assert rb.Rotation(arm=ARM, speed=text).speed == pytest.approx(3 * math.pi, rel=1e-15)


def test_stated_values() -> None:
    """The angle passes through stated angles, and the angular velocity through stated speeds."""
    first = rb.Rotation(arm=ARM, times=[0, 0.4, 1.0], angles=["0 deg", "20 deg", "90 deg"])
    assert np.allclose(np.rad2deg(first.at([0, 0.4, 1.0]).angle), [0, 20, 90])
    second = rb.Rotation(arm=ARM, times=[0, 2], speeds=["0 rpm", "1200 rpm"])
    assert np.allclose(second.at([-1, 1, 2, 7]).speed * 30 / math.pi, [0, 600, 1200, 1200])
    assert float(second.at(2.0).angle) == pytest.approx(40 * math.pi)


def test_field_at_the_start() -> None:
    """The field is gravity along the axes of the cavity and the centrifugal acceleration of its centre."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=10),
        cavity=rb.Box(size=("20 mm",) * 3),
        contact=rb.Tsuji(restitution=0.7),
        rotation=rb.Rotation(arm=ARM, axis="y", speed=20.0, angle="90 deg"),
    )
    # A turn by 90 degrees about y takes x to -z: gravity is along x of the cavity.
    assert np.allclose(damper.field, np.array([9.81 + 400 * 0.06, 0.0, 400 * 0.01]))
    assert np.allclose(damper.up, -damper.field / np.linalg.norm(damper.field))


def test_round_trip_to_the_machine() -> None:
    """A vector returns from the machine, for one angle and for one angle each."""
    rotation = rb.Rotation(arm=ARM, axis=(1, 2, -1), speed=1.0)
    vectors = np.random.default_rng(1).normal(size=(5, 3))
    for angle in (0.7, np.linspace(0, 3, 5)):
        there = rotation.to_machine(vectors, angle)
        assert np.allclose(rotation.to_cavity(there, angle), vectors)
        assert np.allclose(np.linalg.norm(there, axis=1), np.linalg.norm(vectors, axis=1))
    assert np.allclose(rb.Rotation(arm=ARM, speed=1.0).to_machine(np.eye(3)[:1], math.pi / 2), [[0, 1, 0]])


def test_case_file_keeps_units(tmp_path: Any) -> None:
    """A case with a rotation is the same after it is written and read, with the units of the user."""
    case = rb.Case(
        structure=rb.Fixed(),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="4 mm", count=10),
            cavity=rb.Box(size=("20 mm",) * 3),
            contact=rb.Tsuji(restitution=0.7),
            rotation=rb.Rotation(arm=ARM, axis="y", times=["0 s", "1 s"], speeds=["0 rpm", "700 rpm"]),
        ),
        duration="1 s",
    )
    path = tmp_path / "case.toml"
    case.to_file(path)
    assert "700 rpm" in path.read_text()
    assert '"60 mm"' in path.read_text()
    assert rb.Case.from_file(path) == case
    faster = case.replaced({"damper.rotation": {"speed": "300 rpm", "arm": ARM}})
    assert faster.particle_dampers[0].rotation.speed == pytest.approx(10 * math.pi)
    assert case.replaced({"damper.rotation.angle": "10 deg"}).particle_dampers[0].rotation.angle == pytest.approx(
        math.radians(10)
    )


def test_periodic_directions_are_along_the_axis() -> None:
    """A box that is periodic across the axis is refused, since its images would be in another field."""
    values: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="4 mm", count=10),
        "contact": rb.Tsuji(restitution=0.7),
        "rotation": rb.Rotation(arm=ARM, axis="y", speed=20.0),
    }
    rb.ParticleDamper(cavity=rb.Box(size=("20 mm",) * 3, periodic="y"), **values)
    with pytest.raises(rb.CaseError, match="across the axis"):
        rb.ParticleDamper(cavity=rb.Box(size=("20 mm",) * 3, periodic="xy"), **values)


def test_steppers_refuse_rotations() -> None:
    """A stepper and an FMU of a turning damper are refused by the name of the field."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=10),
        cavity=rb.Box(size=("20 mm",) * 3),
        contact=rb.Tsuji(restitution=0.7),
        rotation=rb.Rotation(arm=ARM, speed=20.0),
    )
    with pytest.raises(rb.CaseError, match=r"rotation\n.*stepper"):
        rb.Stepper(damper)
    with pytest.raises(rb.CaseError, match="rotation"):  # of a damper in 1-D, by name
        rb.ImpactDamper(
            ball=rb.Sphere(diameter="20 mm", material="steel"),
            gap="1 mm",
            contact=rb.Tsuji(restitution=0.7),
            rotation=damper.rotation,
        )
