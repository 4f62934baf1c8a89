"""A ball of an impact damper in a box of the 3-D engine, alone against the 1-D engine, and beside a bed."""

from typing import Any

import numpy as np
import pytest

import rattlebox as rb

BALL = rb.Sphere(diameter="24 mm", material="steel")


def damper(**options: Any) -> rb.ImpactDamper:
    """Return a ball that starts off the centre."""
    values: dict[str, Any] = {"ball": BALL, "gap": "1.5 mm", "contact": rb.Tsuji(restitution=0.55), "start": 0.4}
    return rb.ImpactDamper(**values | options)


def run_of(*dampers: Any) -> Any:
    """Return the run of an oscillator that starts with a velocity."""
    structure = rb.SDOF(mass="4 kg", frequency="18 Hz", damping_ratio=0.008, velocity="0.35 m/s")
    case = rb.Case(structure=structure, dampers=list(dampers), duration="0.4 s", output=rb.Output(rate="2 kHz"))
    return rb.simulate(case, progress=False)


@pytest.mark.parametrize(
    ("direction", "gravity", "along"),
    [("x", (0, 0, -9.81), 0.0), ("-y", (0, 0, -9.81), 0.0), ("z", (0, 0, -9.81), -9.81), ("x", (0, 0, 0), 0.0)],
)
def test_a_ball_in_space_moves_as_on_its_line(direction: Any, gravity: Any, along: float) -> None:
    """The structure has the motion and the losses of the 1-D engine, but for the dashpot of a rigid wall (57 g on 4 kg)."""
    if direction == "-y":
        direction = (0, -1, 0)
    line = damper(gravity=along)
    on_line, in_space = run_of(line), run_of(line.in_space(direction, gravity=gravity))
    assert on_line.ok and in_space.ok and len(on_line.arrays.impacts) > 10
    x = on_line.motion.displacement.interp(time=in_space.motion.time).values[:, 0]
    y = in_space.motion.displacement.values[:, 0]
    # The first tenth of a second has several impacts; later small differences grow.
    assert np.abs(x - y)[:200].max() < 2e-3 * np.abs(x).max()
    assert in_space.ledger.contact_loss[-1] == pytest.approx(on_line.ledger.contact_loss[-1], rel=0.02)


def test_a_ball_and_a_bed_damp_one_structure() -> None:
    """Dampers of both kinds act in one case: each loses energy, and the energies balance."""
    bed = rb.ParticleDamper(
        cavity=rb.Box(size=["18 mm"] * 3),
        particles=rb.Particles(count=25, diameter="4 mm", material="steel"),
        contact=rb.Tsuji(restitution=0.7),
        friction=0.3,
        softening=100,
        name="bed",
    )
    run = run_of(damper(name="ball").in_space(gravity=bed.gravity), bed)
    assert run.ok and run.arrays.dampers == ("ball", "bed")
    lost = sum(getattr(run.arrays, f"{name}_loss")[-1].sum(axis=-1) for name in ("normal", "sliding"))
    assert (lost > 0).all() and lost[0] > lost[1]  # the ball is 57 g, the bed 7 g
    with pytest.raises(rb.CaseError, match="in_space"):
        run_of(damper(), bed)


@pytest.mark.parametrize(
    ("change", "direction", "words"),
    [
        ({"ball": [BALL, BALL], "start": 0.0}, "x", "only one ball"),
        ({"number": 2}, "x", "only one ball"),
        ({"ball": rb.Striker(mass="50 g"), "contact": rb.Linear(stiffness="1 MN/m", restitution=0.6)}, "x", "striker"),
        ({}, (1, 1, 0), "not along an axis"),
        ({}, "z", "gravity along the line is 0 m/s"),
    ],
)
def test_other_balls_and_lines_are_refused(change: dict[str, Any], direction: Any, words: str) -> None:
    """What a box with one ball cannot be is refused by name."""
    line = damper(**change)
    with pytest.raises(rb.CaseError, match=words):
        line.in_space(direction)
