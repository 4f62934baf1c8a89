"""Properties that particles, contacts and cavities do not have are refused with what exists in their place."""

from typing import Any

import pytest

import rattlebox as rb
from rattlebox.model.synonyms import ABSENT

DRY, ROUND, STILL = "contacts are dry", "all particles are round spheres", "the damper turns, not a part of it"


def damper(**changes: Any) -> rb.ParticleDamper:
    """Return a box of glass beads."""
    usual: dict[str, Any] = {
        "particles": {"material": "glass", "diameter": "3 mm", "count": 6},
        "cavity": {"kind": "box", "size": ["18 mm", "18 mm", "18 mm"]},
        "contact": {"kind": "tsuji", "restitution": 0.7},
    }
    return rb.ParticleDamper(**{name: {**usual.get(name, {}), **each} for name, each in {**usual, **changes}.items()})


@pytest.mark.parametrize("name", ABSENT)
def test_each_name_is_refused_in_words(name: str) -> None:
    """A damper and its parts refuse the name of what does not exist with the reason; they had listed their fields only."""
    for part, classes in (("particles", "Particles"), ("cavity", "Box"), ("contact", "Tsuji")):
        if name in getattr(rb, classes).model_fields:  # a box may be periodic
            continue
        with pytest.raises(rb.CaseError) as caught:
            damper(**{part: {name: 1.0}})
        assert f"{part}.{name} = 1.0\n  there is no such property: {ABSENT[name][0]}\n  try: " in str(caught.value)
        with pytest.raises(rb.CaseError, match="there is no such property"):
            getattr(rb, classes)(**{name: 1.0})


@pytest.mark.parametrize(
    ("cause", "reason"),
    [
        (lambda: damper(contact={"kind": "JKR"}), DRY),
        (lambda: damper(particles={"Aspect-Ratio": 1.4}), ROUND),
        (lambda: rb.Sphere(radius="3 mm", material="steel", shape="cube"), ROUND),
        (lambda: rb.Cylinder(radius="9 mm", length="30 mm", rotation="3 rpm"), STILL),
        (lambda: rb.ImpactDamper(gap="1 mm", wall_adhesion=1), DRY),
    ],
)
def test_spellings(cause: Any, reason: str) -> None:
    """Kinds, other spellings and names of walls are recognised."""
    with pytest.raises(rb.CaseError, match=reason):
        cause()


def test_other_parts_keep_their_advice() -> None:
    """A shape of a beam is not advised for a particle; the message advises a field with a similar name."""
    with pytest.raises(rb.CaseError, match="did you mean 'shapes'"):
        rb.Modal(frequencies=["10 Hz"], shape=[1.0])
    with pytest.raises(rb.CaseError, match="known: bending_stiffness"):
        rb.Beam(length="1 m", rotation="3 Hz")
    with pytest.raises(rb.CaseError, match="did you mean 'rolling'"):
        damper(roling={"coefficient": 0.1})


def test_the_substitutes_are_accepted() -> None:
    """What the advice names exists: a rolling resistance, and a base that moves in two directions."""
    along = [rb.Harmonic(amplitude="1 m/s^2", frequency="9 Hz", direction=axis) for axis in ("x", "z")]
    box = rb.ParticleDamper(
        particles=rb.Particles(material="glass", diameter="3 mm", count=6),
        cavity=rb.Box(size=("18 mm", "18 mm", "18 mm")),
        contact=rb.Tsuji(restitution=0.7),
        friction=0.3,
        rolling=0.1,
    )
    assert rb.Case(structure=rb.Shaker(motion=along), damper=box, duration="0.1 s").particle_dampers[0].rolling
