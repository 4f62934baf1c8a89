"""Cases of the verification, built through the public interface only."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

import rattlebox as rb

from .exact import masri_caughey, shaken
from .exact.impact_oscillator import StopOrbit

YOUNG, POISSON, DENSITY, YIELD = 200e9, 0.3, 7850.0, 1030e6
"""Steel of the reference paper."""
RADIUS = 0.01
GAP = 1e-3
MODULUS = YOUNG / (2 * (1 - POISSON**2))
MASS = DENSITY * 4 / 3 * math.pi * RADIUS**3
STIFFNESS = 4 / 3 * MODULUS * math.sqrt(RADIUS)


def ball(mass: float | None = None, material: Any = "steel") -> Any:
    """Return the small ball, optionally with the mass that a theory prescribes."""
    return rb.Sphere(radius=RADIUS, material=material, mass=mass)


def single_impact(contact: Any, speed: float, duration: float) -> Any:
    """Return a ball thrown at a fixed wall a millimetre away."""
    return rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(ball=ball(), gap=GAP, start=0.0, velocity=speed, contact=contact),
        duration=GAP / speed + duration,
        output=rb.Output(times=[0.0]),
    )


def still_cavity(contact: Any, speed: float, duration: float, method: Any = None) -> Any:
    """Return a ball that bounces in a fixed cavity."""
    return rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(ball=ball(), gap=1e-4, velocity=speed, contact=contact),
        duration=duration,
        method=method or rb.EventDriven(),
        output=rb.Output(times=[0.0]),
    )


def impact_damper(
    orbit: masri_caughey.Orbit,
    half_cycles: float,
    *,
    method: Any = None,
    contact: Any = None,
    soft: Any = None,
    shift: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
) -> Any:
    """Return the damper of Masri and Caughey on its orbit, starting at a zero crossing of the displacement.

    The ball is of a `soft` material against rigid walls, or of steel against steel.
    `shift` disturbs the start: displacement and velocity of the structure, position and velocity of the ball.
    """
    begin = orbit.zero_crossing()
    x, v = orbit.structure(begin)
    y, w = orbit.ball(begin)
    gap = 0.5 * orbit.clearance
    law = contact or rb.Tsuji(restitution=orbit.restitution)
    return rb.Case(
        structure=rb.SDOF(
            mass=1.0,
            stiffness=1.0,
            damping_ratio=orbit.zeta,
            displacement=x + shift[0],
            velocity=v + shift[1],
        ),
        damper=rb.ImpactDamper(
            ball=ball(orbit.mass_ratio, soft or "steel"),
            wall="rigid" if soft else None,
            gap=gap,
            start=(y + shift[2] - (x + shift[0])) / gap,
            velocity=w + shift[3],
            contact=law,
        ),
        load=rb.Harmonic(
            amplitude=1.0,
            frequency=f"{orbit.omega!r} rad/s",
            phase=orbit.load_phase + orbit.omega * begin,
        ),
        duration=half_cycles * orbit.half_period,
        method=method or rb.Newton(restitution=orbit.restitution),
        output=rb.Output(times=[0.0]),
    )


def shaken_cavity(orbit: shaken.TwoImpacts, cycles: float) -> Any:
    """Return a ball in a cavity that moves as orbit.amplitude sin t, starting in the middle of a flight."""
    begin = 0.5 * math.pi
    phase = begin + orbit.phase
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=f"{orbit.amplitude!r} m", frequency="1 rad/s", phase=phase)),
        damper=rb.ImpactDamper(
            ball=ball(1.0),
            gap=1.0,
            start=-orbit.amplitude * math.sin(phase),
            velocity=-orbit.speed - orbit.amplitude * math.cos(phase),
            contact=rb.Tsuji(restitution=orbit.restitution),
        ),
        duration=2 * math.pi * cycles,
        method=rb.Newton(restitution=orbit.restitution),
        output=rb.Output(times=[0.0]),
    )


def sticky_load(ratio: float, cycles: float) -> Any:
    """Return an inelastic ball in a cavity that moves as `ratio` sin t, with a free clearance of one."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=f"{ratio!r} m", frequency="1 rad/s")),
        damper=rb.ImpactDamper(ball=ball(1.0), gap=0.5, start=-1.0, contact=rb.Tsuji(restitution=0.5)),
        duration=2 * math.pi * cycles,
        method=rb.Newton(restitution=0.0),
        output=rb.Output(times=[0.0]),
    )


TABLE_GAP = 50.0


def table(orbit: shaken.TableOrbit, bounces: float, shift: Sequence[float] = (0.0, 0.0)) -> Any:
    """Return a ball bouncing on a shaken table, g = omega = 1, starting at the top of a flight.

    `shift` disturbs the ball's position and velocity relative to the table.
    """
    half = math.pi * orbit.cycles
    phase = orbit.phase + half
    height = orbit.gamma * math.sin(orbit.phase) + 0.5 * orbit.launch**2 - orbit.gamma * math.sin(phase)
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=f"{orbit.gamma!r} m", frequency="1 rad/s", phase=phase)),
        damper=rb.ImpactDamper(
            ball=ball(1.0),
            gap=TABLE_GAP,
            start=(height + shift[0]) / TABLE_GAP - 1,
            velocity=-orbit.gamma * math.cos(phase) + shift[1],
            contact=rb.Tsuji(restitution=orbit.restitution),
            gravity=-1.0,
        ),
        duration=2 * half * bounces,
        method=rb.Newton(restitution=orbit.restitution),
        output=rb.Output(times=[0.0]),
    )


def dropped(height: float, restitution: float, gravity: float, duration: float) -> Any:
    """Return a ball dropped on a fixed floor."""
    return rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(
            ball=ball(1.0),
            gap=1.0,
            start=height - 1.0,
            gravity=-gravity,
            contact=rb.Tsuji(restitution=restitution),
        ),
        duration=duration,
        method=rb.Newton(restitution=restitution),
        output=rb.Output(times=[0.0]),
    )


def inelastic_ball(gamma: float, cycles: float, times: Sequence[float] = (0.0,)) -> Any:
    """Return an inelastic ball that starts at rest on a table gamma sin t, g = 1."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=f"{gamma!r} m", frequency="1 rad/s")),
        damper=rb.ImpactDamper(
            ball=ball(1.0), gap=TABLE_GAP, start=-1.0, gravity=-1.0, contact=rb.Tsuji(restitution=0.5)
        ),
        duration=2 * math.pi * cycles,
        method=rb.Newton(restitution=0.0),
        output=rb.Output(times=list(times)),
    )


def impact_oscillator(orbit: StopOrbit, cycles: float) -> Any:
    """Return an oscillator with a hard stop, half a cycle after an impact of a periodic motion."""
    begin = math.pi / orbit.omega
    x, v = orbit.state(begin)
    return rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1.0, damping_ratio=orbit.zeta, displacement=x, velocity=v),
        stop=rb.Stop(gap=orbit.stop, contact=rb.Tsuji(restitution=orbit.restitution)),
        load=rb.Harmonic(
            amplitude=1.0,
            frequency=f"{orbit.omega!r} rad/s",
            phase=orbit.load_phase + orbit.omega * begin + 0.5 * math.pi,
        ),
        duration=cycles * 2 * math.pi / orbit.omega,
        method=rb.Newton(),
        output=rb.Output(times=[0.0]),
    )


def reference_case(
    *,
    start: float = 0.0,
    force: float = 5000.0,
    contact: Any = None,
    duration: float = 5.0,
    wall: str | None = None,
    method: Any = None,
    times: Sequence[float] | None = None,
    mass: float | None = None,
) -> Any:
    """Return the steel ball of the reference paper on its oscillator, under a half sine of one millisecond."""
    return rb.Case(
        structure=rb.SDOF(mass=20.0, stiffness=80e3, damping=25.3),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius=0.03317, material="steel", mass=mass),
            gap=0.4e-3,
            wall=wall,
            start=start,
            contact=contact or rb.Tsuji(alpha=0.006313, ending="zero_overlap"),
        ),
        load=rb.HalfSine(amplitude=force, duration=1e-3),
        duration=duration,
        method=method or rb.EventDriven(),
        output=rb.Output(times=list(times)) if times is not None else rb.Output(),
    )


def five_balls(duration: float = 2.0) -> Any:
    """Return a row of five unequal balls at the tip of a structure with three modes, struck and shaken."""
    materials = ["steel", "brass", "glass", "steel", "aluminium"]
    radii = [6e-3, 5e-3, 4e-3, 5e-3, 7e-3]
    return rb.Case(
        structure=rb.Modal(
            frequencies=[8.0, 23.0, 51.0],
            damping_ratios=[0.004, 0.006, 0.01],
            shapes={"tip": [0.5, -0.35, 0.2]},
        ),
        damper=rb.ImpactDamper(
            balls=[rb.Sphere(radius=r, material=m) for r, m in zip(radii, materials, strict=True)],
            gap=0.6e-3,
            start=[-0.5, -0.2, 0.0, 0.3, 0.6],
            contact=rb.Tsuji(restitution=0.9),
        ),
        load=[
            rb.HalfSine(amplitude=600.0, duration=2e-3, point="tip"),
            rb.Harmonic(amplitude=20.0, frequency=9.0, point="tip"),
        ],
        duration=duration,
    )


def hard_row(rng: np.random.Generator, balls: int) -> Any:
    """Return a row of hard balls in a shaken structure, with or without gravity."""
    e = rng.uniform(0.2, 0.95)
    return rb.Case(
        structure=rb.SDOF(
            mass=1.0,
            stiffness=(2 * math.pi * rng.uniform(3, 20)) ** 2,
            damping_ratio=rng.uniform(0, 0.05),
            velocity=rng.uniform(-1, 1),
        ),
        damper=rb.ImpactDamper(
            balls=[rb.Sphere(radius=r, material="steel") for r in rng.uniform(2e-3, 6e-3, balls)],
            gap=rng.uniform(2e-4, 3e-3),
            contact=rb.Tsuji(restitution=e),
            gravity=rng.choice([0.0, 9.81]),
        ),
        load=rb.Harmonic(amplitude=rng.uniform(1, 20), frequency=rng.uniform(3, 20)),
        duration=1.0,
        method=rb.Newton(),
        output=rb.Output(rate=5000.0),
    )


def hard_dampers(rng: np.random.Generator) -> Any:
    """Return two or three dampers of one or two hard balls on a shaken structure."""
    e = rng.choice([0.0, 0.2, 0.5, 0.9])
    dampers = []
    for k in range(rng.integers(2, 4)):
        balls = rng.integers(1, 3)
        dampers.append(
            rb.ImpactDamper(
                name=f"damper {k + 1}",
                balls=[rb.Sphere(radius=r, material="steel") for r in rng.uniform(4e-3, 9e-3, balls)],
                gap=rng.uniform(3e-4, 3e-3),
                start=sorted(rng.uniform(-0.9, 0.9, balls)),
                contact=rb.Tsuji(restitution=0.8),
                gravity=rng.choice([0.0, -9.81]),
            )
        )
    return rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=4e3, damping_ratio=0.01),
        dampers=dampers,
        load=rb.Harmonic(amplitude=rng.uniform(2, 30), frequency=rng.uniform(4, 15)),
        duration=1.0,
        method=rb.Newton(restitution=e, max_events=100_000),
    )


def pile(balls: int, e: float) -> Any:
    """Return hard balls that fall on each other on the floor of a fixed cavity."""
    return rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(
            balls=[ball()] * balls,
            gap=5e-3,
            start=np.linspace(-0.9, 0.9, balls).tolist(),
            gravity=-9.81,
            contact=rb.Tsuji(restitution=0.5),
        ),
        duration=2.0,
        method=rb.Newton(restitution=e, max_events=50_000),
    )
