"""Cases of the 3-D engine, built through the public interface only."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.prepare.particles import pack_particles, prepare

HERTZ_TIME = 3.2180655
"""Time of an elastic Hertz contact over (m*/A)^(2/5) V^(-1/5)."""


def run(case: Any, *, closes: bool = True) -> Any:
    """Run a case that must finish; with long steps the energy residual may exceed the limit of the engine."""
    result = rb.simulate(case)
    if not result.ok and (closes or result.status != "energy_error"):
        raise AssertionError(f"{result.status}: {result.message}")
    return result


def dem_of(case: Any, threads: int = 1) -> Any:
    """Return the simulation object of the core for a case, and the number of its last step."""
    prepared = prepare(case)
    packed, step = pack_particles(prepared), prepared.step
    dem = _core.Dem(packed)
    dem.threads = threads
    return dem, step.count


def ends_alike(case: Any) -> bool:
    """Return whether step 3000 has the same bits with one to three threads, and after a restart from step 1500."""
    ends = []
    for threads in (1, 2, 3):
        dem, _ = dem_of(case, threads)
        dem.run(1500, None)
        saved = dem.save()
        dem.run(3000, None)
        ends.append(np.array(dem.state().cavities[0].position))
    again, _ = dem_of(case, 2)
    again.restore(saved)
    again.run(3000, None)
    ends.append(np.array(again.state().cavities[0].position))
    return all(np.array_equal(each, ends[0]) for each in ends)


@dataclass(frozen=True)
class Ball:
    """One particle: size, material and initial motion."""

    radius: float
    position: Sequence[float] = (0.0, 0.0, 0.0)
    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    spin: Sequence[float] = (0.0, 0.0, 0.0)
    material: Any = "steel"

    @property
    def stuff(self) -> Any:
        """Material of the ball."""
        return rb.materials()[self.material] if isinstance(self.material, str) else self.material

    @property
    def mass(self) -> float:
        """Mass of the ball [kg]."""
        return self.stuff.density * 4 / 3 * math.pi * self.radius**3


def damper(balls: Sequence[Ball], *, one_kind: bool = False, **options: Any) -> Any:
    """Return a damper with these balls: one species each, or all as one species of the material of the first."""
    packing: dict[str, Any] = {
        "positions": [list(ball.position) for ball in balls],
        "velocities": [list(ball.velocity) for ball in balls],
        "spins": [list(ball.spin) for ball in balls],
    }
    if one_kind:
        particles: Any = rb.Particles(material=balls[0].material)
        packing["radii"] = [ball.radius for ball in balls]
    else:
        particles = [
            rb.Particles(name=f"ball {k + 1}", material=ball.material, radius=ball.radius, count=1)
            for k, ball in enumerate(balls)
        ]
    usual: dict[str, Any] = {"particles": particles, "packing": rb.Positions(**packing), "gravity": (0, 0, 0)}
    return rb.ParticleDamper(**{**usual, **options})


def case(balls: Sequence[Ball], *, dt: float, steps: int, samples: int = 1, **options: Any) -> Any:
    """Return balls in a fixed cavity, simulated for a number of steps."""
    structure = options.pop("structure", rb.Fixed())
    own = {key: options.pop(key) for key in ("load", "base") if key in options}
    # Rounding must not make the engine take one step more between two samples.
    return rb.Case(
        structure=structure,
        damper=damper(balls, **options),
        duration=steps * dt,
        output=rb.Output(times=np.linspace(0, steps * dt, samples + 1)),
        method=rb.Dem(dt=dt * (1 + 1e-9)),
        **own,
    )


def reduced(first: float, second: float) -> float:
    """Return half the harmonic mean."""
    return 1 / (1 / first + 1 / second)


def stiffness(first: Ball, second: Ball | None = None, wall: Any = None) -> float:
    """Return the Hertz stiffness A of two balls, or of one and a wall of a material or "rigid" (None: its own material)."""

    def compliance(material: Any) -> float:
        return (1 - material.poisson**2) / material.young

    if second is not None:
        radius, other = reduced(first.radius, second.radius), compliance(second.stuff)
    else:
        radius = first.radius
        other = 0.0 if wall == "rigid" else compliance(first.stuff if wall is None else wall)
    return 4 / 3 * math.sqrt(radius) / (compliance(first.stuff) + other)


def contact_time(first: Ball, second: Ball | None, speed: float, wall: Any = None) -> float:
    """Return the duration of an elastic Hertz contact [s]."""
    mass = first.mass if second is None else reduced(first.mass, second.mass)
    return HERTZ_TIME * (mass / stiffness(first, second, wall)) ** 0.4 * speed**-0.2


def head_on(
    first: Ball, second: Ball | None, speed: float, *, dt: float, phase: float, lasts: float, **options: Any
) -> Any:
    """Return a ball that meets another one, or a wall if there is none, along x; five steps and a `phase` after the start.

    A single ball has the whole speed, each of two balls half of it. The run lasts for `lasts` after first touch.
    """
    gap = (5 + phase) * dt * speed
    share = 1.0 if second is None else 0.5
    half = 3 * max(first.radius, second.radius if second else 0.0)
    place = (half if second is None else 0.0) - first.radius - gap
    balls = [replace(first, position=(place, 0, 0), velocity=(share * speed, 0, 0))]
    if second is not None:
        balls.append(replace(second, position=(second.radius, 0, 0), velocity=(-share * speed, 0, 0)))
    return case(balls, dt=dt, steps=math.ceil(lasts / dt) + 7, **{"cavity": rb.Box(size=(2 * half,) * 3), **options})


def rebound(result: Any) -> float:
    """Return the relative velocity along x at the end, of two balls or of one [m/s]."""
    v = result.arrays.particles.velocity[:, 0]
    return float(-v[0] if v.size == 1 else v[1] - v[0])


def particles_start(case: Any) -> Any:
    """Return positions, velocities and spins of the particles of the first damper at the start."""
    return case.dampers[0].start
