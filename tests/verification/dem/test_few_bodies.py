"""Three balls in a cavity on three modes: the engine against an independent program written from the documentation only.

The cases combine curved and flat walls, spatial modes, gravity, a pulse, friction, rolling resistance, velocity-dependent
restitution, separate laws at walls, and losses by type and partner.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from support import dem_cases
from support.exact.few_bodies import Ball, Bodies, Laws, Matter, Mode, Wall, box, cylinder, sphere

import rattlebox as rb

STEEL, GLASS, ALUMINIUM = Matter(7800, 2e8, 0.3), Matter(2500, 6e7, 0.2), Matter(2700, 7e7, 0.33)
MATERIALS = {
    stuff: rb.Material(name=name, young=stuff.young, poisson=stuff.poisson, density=stuff.density)
    for name, stuff in (("soft steel", STEEL), ("soft glass", GLASS), ("soft aluminium", ALUMINIUM))
}
BALLS = (
    Ball(4e-3, STEEL, (-6e-3, 1e-3, -2e-3), (1.0, 0.2, -0.3), (50, -80, 30)),
    Ball(3e-3, GLASS, (3e-3, 0.2e-3, 0.5e-3), (-0.6, 0.4, 0.2), (-40, 20, 90)),
    Ball(5e-3, STEEL, (1.5e-3, -7.4e-3, -4e-3), (0.2, 0.9, -0.5), (10, 60, -70)),
)
MODES = (
    Mode(60, 0.01, (1.5, 0.2, 0.1), 0.05),
    Mode(90, 0.02, (-0.2, 1.2, 0.3), -0.05),
    Mode(140, 0.005, (0.1, -0.3, 1.0), 0.08),
)
GRAVITY, TOWARDS = (1.0, -2.0, -9.0), (0.36, 0.48, 0.8)
PULSE = rb.HalfSine(amplitude=40, duration=4e-3, start=3e-3, point="tip", direction=TOWARDS)
AXIS = (0.2, 0.1, 1)
TABLE = ((0.1, 0.5, 2.0), (0.95, 0.8, 0.6))


def pulse(t: float) -> float:
    """Return the load [N]."""
    return float(40 * np.sin(np.pi * (t - 3e-3) / 4e-3)) if 3e-3 < t < 7e-3 else 0.0


@dataclass(frozen=True)
class Setup:
    """One case for both programs: laws between balls and at walls, duration, and tolerance.

    `step` is that of the independent program [s]; `touches` are the first touches between balls and at walls.
    """

    cavity: Any
    walls: list[Wall]
    contact: Any
    wall_contact: Any
    laws: tuple[Laws, Laws]
    until: float
    step: float
    touches: tuple[int, int]
    within: float
    options: dict[str, Any] = field(default_factory=dict)
    wall: Matter | None = ALUMINIUM


SETUPS = {
    "a leaning cylinder, Hertz, by table": Setup(
        cavity=rb.Cylinder(radius=13e-3, length=28e-3, axis=AXIS),
        walls=cylinder(13e-3, 28e-3, AXIS),
        contact=rb.Tsuji(restitution=rb.Tabulated(speeds=TABLE[0], values=TABLE[1])),
        wall_contact=rb.Tsuji(restitution=0.7),
        laws=(Laws(TABLE, friction=0.3, rolling=0.05), Laws(0.7, friction=0.2, rolling=0.03, rolling_stiffness=2.5)),
        options={
            "friction": 0.3,
            "rolling": 0.05,
            "wall_friction": 0.2,
            "wall_rolling": rb.Rolling(coefficient=0.03, stiffness=2.5),
        },
        until=0.0215,
        step=5e-7,
        touches=(3, 6),
        within=4e-4,
    ),
    "a box, linear, pulling until they part": Setup(
        cavity=rb.Box(size=(24e-3, 26e-3, 22e-3)),
        walls=box(24e-3, 26e-3, 22e-3),
        contact=rb.Linear(stiffness=2e4, restitution=0.8, ending="zero_overlap"),
        wall_contact=rb.Linear(stiffness=4e4, restitution=0.9, ending="zero_overlap"),
        laws=(
            Laws(0.8, stiffness=2e4, pulls=True, friction=0.4, spring=8e3, damping=0.5),
            Laws(0.9, stiffness=4e4, pulls=True, friction=0.2, spring=1e4),
        ),
        options={
            "friction": rb.LinearSpring(0.4, stiffness=8e3, damping=0.5),
            "wall_friction": rb.LinearSpring(0.2, stiffness=1e4),
        },
        until=0.02,
        step=1e-6,
        touches=(3, 5),
        within=1e-4,
    ),
    "a sphere, rigid, without friction among balls": Setup(
        cavity=rb.SphericalCavity(radius=14e-3),
        walls=sphere(14e-3),
        contact=rb.Tsuji(restitution=1.0),
        wall_contact=rb.Tsuji(restitution=0.6, ending="zero_overlap"),
        laws=(Laws(1.0), Laws(0.6, pulls=True, friction=0.3)),
        options={"wall_friction": 0.3},
        wall=None,
        until=0.02,
        step=1e-6,
        touches=(3, 5),
        within=2e-4,
    ),
}


def run_engine(setup: Setup) -> Any:
    """Return the results of the engine."""
    wall = "rigid" if setup.wall is None else MATERIALS[setup.wall]
    balls = [dem_cases.Ball(b.radius, b.position, b.velocity, b.spin, MATERIALS[b.matter]) for b in BALLS]
    laws = {"contact": setup.contact, "wall_contact": setup.wall_contact} | setup.options
    damper = dem_cases.damper(balls, cavity=setup.cavity, wall=wall, point="tip", **laws)
    structure = rb.Modal(
        frequencies=[mode.frequency for mode in MODES],
        damping_ratios=[mode.damping for mode in MODES],
        shapes={"tip": [list(mode.shape) for mode in MODES]},
        velocity=[mode.velocity for mode in MODES],
    )
    return dem_cases.run(
        rb.Case(
            structure=structure,
            load=PULSE,
            damper=damper.model_copy(update={"gravity": GRAVITY}),
            duration=setup.until,
            output=rb.Output(times=[0, setup.until]),
            method=rb.Dem(dt=2.5e-8),
        )
    )


def run_independently(setup: Setup) -> Bodies:
    """Return the results of the independent program."""
    bodies = Bodies(BALLS, setup.walls, setup.wall, MODES, setup.laws, GRAVITY, pulse, TOWARDS)
    for end in (3e-3, 7e-3, setup.until):
        bodies.run(end, setup.step, 1e-4)
    return bodies


def differences(bodies: Bodies, arrays: Any) -> dict[str, float]:
    """Return the largest relative difference of each result; energies relative to the total energy."""
    x, v, w, q = (bodies.part(bodies.state, name) for name in ("x", "v", "w", "q"))
    u = q @ bodies.shape
    pairs = {
        "position": (x - u, arrays.particles.position),
        "velocity": (v, arrays.particles.velocity),
        "spin": (w, arrays.particles.spin),
        "displacement": (u, arrays.cavity_displacement[-1, 0]),
    }
    out = {name: float(np.abs(ours - theirs).max() / np.abs(ours).max()) for name, (ours, theirs) in pairs.items()}
    energies = bodies.energies()
    total = float(energies["mode_energy"].sum()) + energies["kinetic_energy"]
    for name, ours in energies.items():
        theirs = np.asarray(getattr(arrays, name)[-1]).ravel()
        out[name] = float(np.abs(theirs - ours).max() / total)
    return out


@pytest.mark.parametrize("name", SETUPS)
def test_three_balls_move_as_in_an_independent_program(name: str) -> None:
    """After eight or nine contacts, positions, velocities, spins, motion of the cavity, work, energies and losses agree."""
    setup = SETUPS[name]
    ours, theirs = run_independently(setup), run_engine(setup)
    counts = (theirs.counts["first_touches_particle"], theirs.counts["first_touches_wall"])
    assert counts == setup.touches
    assert len(ours.touches) == sum(counts)
    assert {key: value for key, value in differences(ours, theirs.arrays).items() if value > setup.within} == {}
