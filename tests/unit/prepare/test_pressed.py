"""Given positions: those at the end of a run are accepted as they are, mistakes are refused with advice that helps.

No test saw that the end of a run was refused: the tests of given positions had spheres that touch or are apart, and none
took the positions of a run.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rattlebox as rb

RADIUS = 2e-3


def damper(**options: Any) -> rb.ParticleDamper:
    """Return a bed of balls in a box."""
    usual: dict[str, Any] = {"packing": rb.Settled(seed=3), "friction": 0.2, "softening": 50}
    usual["particles"] = rb.Particles(material="steel", diameter=2 * RADIUS)
    usual["cavity"] = rb.Box(size=("17 mm", "17 mm", "24 mm"))
    return rb.ParticleDamper(contact=rb.Tsuji(restitution=0.7), **usual | options)


def case(bed: rb.ParticleDamper, **options: Any) -> rb.Case:
    """Return a ringing structure with a bed."""
    structure = rb.SDOF(mass="0.5 kg", frequency="45 Hz", velocity="0.4 m/s", damping_ratio=0.01)
    return rb.Case(**{"structure": structure, "damper": bed, "duration": "12 ms"} | options)


@pytest.mark.parametrize("softening", [1, 50, 1000])
@pytest.mark.parametrize(
    "cavity", [rb.Cylinder(diameter="18 mm", length="20 mm"), rb.SphericalCavity(diameter="21 mm")]
)
def test_the_end_of_a_run_is_a_start(softening: float, cavity: Any) -> None:
    """A run continues from its end with another friction; momentum and energy continue, and a note states overlaps."""
    balls = rb.Particles(material="steel", diameter=2 * RADIUS, count=24)
    bed = damper(softening=softening, cavity=cavity, particles=balls)
    first = rb.simulate(case(bed), progress=False)
    end, last = first.particles, first.motion.isel(time=-1)
    room = bed.cavity.room(end.position.values, end.radius.values)
    start = rb.Positions(positions=end.position.values, velocities=end.velocity.values, spins=end.spin.values)
    changes = {
        "damper.packing": start,
        "damper.friction": 0.5,
        "structure.displacement": float(last.displacement.squeeze()),
        "structure.velocity": float(last.velocity.squeeze()),
    }
    rest = rb.simulate(case(bed).replaced(changes), progress=False)
    assert rest.ok
    before, after = first.arrays, rest.arrays
    np.testing.assert_allclose(after.momentum[0], before.momentum[-1], atol=1e-12)
    # The stretch of tangential springs is not in positions; their energy is that which differs.
    np.testing.assert_allclose(
        after.gravity_energy[0] + after.contact_energy[0],
        before.gravity_energy[-1] + before.contact_energy[-1],
        rtol=5e-3,
    )
    touching = room.min() < 0 or float(before.contact_energy[-1].sum()) > 0
    assert any("overlap by up to" in note for note in rest.notes) == touching


@pytest.mark.parametrize(
    ("positions", "parts"),
    [
        ([[0, 0, 0], [3.2e-3, 0, 0]], ["particles 0 and 1 overlap by 0.8 mm", "at least 4 mm apart"]),
        ([[0, 0, -0.0101], [0, 0, 0]], None),
        ([[0, 0, -0.0112], [0, 0, 0]], ["particle 0", "sticks out of the cavity by 1.2 mm", "at least 2 mm between"]),
        (
            [[2e-3, 2e-3, 2e-3], [15e-3, 15e-3, 20e-3]],
            [
                "particle 1",
                "sticks out",
                "relative to the centre of the cavity: with a shift by (-8.5, -8.5, -11) mm all are inside",
            ],
        ),
        ([[0, 0, 0], [2.0, 0, 0]], ["positions in metres"]),
    ],
)
def test_mistakes_are_refused_with_advice(positions: Any, parts: list[str] | None) -> None:
    """Deep overlaps and positions outside of the cavity are refused; following the advice helps."""
    pack = rb.Positions(positions=positions)
    bed = damper(packing=rb.Positions(positions=[[0, 0, 0]]))
    if parts is None:
        with pytest.raises(rb.CaseError, match=r"particle 0 is in a wall by 0\.1 mm") as caught:
            rb.simulate(case(damper(packing=pack, gravity=(0, 0, 0), softening=1)), progress=False)
        assert "velocities and the softening" in str(caught.value)
        return
    with pytest.raises(rb.CaseError) as caught:
        case(bed).replaced({"damper.packing": pack})
    for part in parts:
        assert part in str(caught.value)
    if "with a shift" in parts[-1]:
        shifted = np.array(positions) - [8.5e-3, 8.5e-3, 11e-3]
        case(bed).replaced({"damper.packing": rb.Positions(positions=shifted)})


def test_an_overlap_without_a_cause_is_refused_before_the_run() -> None:
    """Two balls at rest that overlap by 2 % of their radius would fly apart at metres a second, and are refused."""
    pack = rb.Positions(positions=[[0, 0, 0], [2 * RADIUS - 0.04e-3, 0, 0]])
    still = rb.Fixed() if hasattr(rb, "Fixed") else rb.Shaker(motion=rb.Harmonic(amplitude="1 um", frequency="50 Hz"))
    with pytest.raises(rb.CaseError, match=r"overlap by 0.04 mm, but an impact at .* would throw them apart"):
        rb.simulate(case(damper(packing=pack, gravity=(0, 0, 0), softening=1), structure=still), progress=False)
