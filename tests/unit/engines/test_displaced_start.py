"""Places of balls and particles at the start are places in the cavity, wherever the structure is.

No test saw that starts were measured from the rest position: the tests of displaced structures computed the start from the
rest position themselves, as the engine did, and none compared it with the documented meaning.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rattlebox as rb

GAP = 0.8e-3


def case(displacement: float, start: Any, **options: Any) -> rb.Case:
    """Return a ball in a cavity on an oscillator that is displaced at the start."""
    return rb.Case(
        structure=rb.SDOF(mass="2 kg", frequency="27 Hz", damping_ratio=0.02, displacement=displacement),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="9 mm", material="brass"),
            gap=GAP,
            contact=rb.Tsuji(restitution=0.7),
            start=start,
            **options,
        ),
        load=rb.Harmonic(amplitude="6 N", frequency="24 Hz"),
        duration="0.2 s",
    )


@pytest.mark.parametrize("displacement", [0.0, 0.3e-3, -2.7e-3])
@pytest.mark.parametrize(
    ("start", "place"), [(-1, -GAP), (1, GAP), (0, 0.0), (0.25, 0.25 * GAP), ("0.5 mm", 0.5e-3), ("-0.8 mm", -GAP)]
)
def test_a_start_is_a_place_in_the_cavity(displacement: float, start: Any, place: float) -> None:
    """-1 touches the trailing and +1 the leading wall of a displaced cavity, and lengths count from its centre."""
    first = rb.simulate(case(displacement, start)).motion.isel(time=0)
    assert float(first.relative_position[0]) == pytest.approx(place, abs=1e-15)
    assert float(first.ball_position[0]) == pytest.approx(displacement + place, abs=1e-15)


@pytest.mark.parametrize("start", [1.01, -1.5, "0.9 mm"])
def test_a_start_in_a_wall_is_refused_wherever_the_structure_is(start: Any) -> None:
    """The advice of the message is a start that is accepted."""
    for displacement in (0.0, 2e-3):
        with pytest.raises(rb.CaseError, match=r"inside a wall of the cavity[^\0]*up to 0.8 mm from the centre"):
            case(displacement, start)
    case(2e-3, "0.8 mm")


def test_a_run_continues_from_its_relative_position() -> None:
    """A run that starts from the end of another one, with its relative position, has the same impacts."""
    whole = rb.simulate(case(0.0, 0.4).replaced({"duration": 0.45}))
    first = rb.simulate(case(0.0, 0.4).replaced({"duration": 0.21}))
    end = first.motion.isel(time=-1)
    time = float(end.time)
    rest = rb.simulate(
        case(float(end.displacement[0]), f"{float(end.relative_position[0])!r} m").replaced(
            {
                "structure.velocity": float(end.velocity[0]),
                "damper.velocity": float(end.ball_velocity[0]),
                "load.phase": 2 * np.pi * 24 * time,
                "duration": 0.45 - time,
            }
        )
    )
    later = whole.impacts.time.values[whole.impacts.time.values > time]
    assert later.size > 5
    np.testing.assert_allclose(rest.impacts.time.values + time, later, rtol=0, atol=1e-9)


def test_identical_dampers_and_studies_follow_the_displacement() -> None:
    """Identical dampers spread between the walls of a displaced cavity; a study over both has the values of single runs."""
    group = rb.simulate(case(1.9e-3, -1, number=4)).motion.isel(time=0).relative_position.values
    assert group[0] == pytest.approx(-GAP) and np.abs(group).max() <= GAP * (1 + 1e-12)
    axes = {"structure.displacement": [0.0, 1.5e-3], "damper.start": [-1, 0.5]}
    found = rb.sweep(case(0.0, 0), axes, ["peak", "impacts"], progress=False)
    for displacement in (0.0, 1.5e-3):
        for start in (-1, 0.5):
            one = rb.simulate(case(displacement, start))
            same = found.sel({"structure.displacement": displacement, "damper.start": start})
            assert int(same.impacts) == one.impacts.sizes["impact"]


def test_particles_start_at_places_in_the_cavity_too() -> None:
    """`Positions` are relative to the centre of the displaced cavity, as those at the end of a run are."""
    places = [[0, 0, 0], [4e-3, 1e-3, -2e-3]]
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass="2 kg", frequency="27 Hz", displacement="3 mm"),
            damper=rb.ParticleDamper(
                particles=rb.Particles(material="steel", diameter="3 mm"),
                cavity=rb.Box(size=("14 mm", "14 mm", "14 mm")),
                contact=rb.Tsuji(restitution=0.7),
                packing=rb.Positions(positions=places),
                gravity=(0, 0, 0),
            ),
            duration="1e-6 s",
        ),
        progress=False,
    )
    np.testing.assert_allclose(run.particles.position, places, atol=1e-9)
    np.testing.assert_allclose(run.motion.centre_of_mass[0, 0], np.mean(places, axis=0), atol=1e-12)
