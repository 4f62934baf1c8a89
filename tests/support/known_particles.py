"""Results of the 3-D engine for which an exact value is known, for the tests and the verification table."""

import math
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np
from scipy.optimize import brentq

import rattlebox as rb
from rattlebox import alpha_of_restitution
from rattlebox.analysis import shaken_cavity

from . import dem_cases
from .dem_cases import Ball
from .exact import dashpot, oblique, printed, restitution_laws, shaken
from .known_impacts import Comparison

FINE = 2000
"""Time steps per contact."""


def stuff(young: float, poisson: float, density: float) -> Any:
    """Return a material."""
    return rb.Material(name="as printed", young=young, poisson=poisson, density=density)


IMPACTS: dict[str, tuple[Ball, bool, float]] = {
    "two glass spheres": (Ball(0.01, material=stuff(48e9, 0.20, 2800)), False, 20.0),
    "two limestone spheres": (Ball(0.01, material=stuff(20e9, 0.25, 2500)), False, 20.0),
    "aluminium on a rigid plane": (Ball(0.1, material=stuff(70e9, 0.30, 2699)), True, 0.2),
    "magnesium on a rigid plane": (Ball(0.1, material=stuff(40e9, 0.35, 1800)), True, 0.2),
}
"""Tests 1 and 2 of Chung and Ooi: the ball, whether it hits a plane, and the approach speed."""


def elastic_impact(ball: Ball, plane: bool, speed: float) -> tuple[float, float, float]:
    """Return peak force [N], peak overlap [m] and contact time [s] of an elastic impact."""
    other = None if plane else ball
    time = dem_cases.contact_time(ball, other, speed, "rigid")
    dt = time / FINE
    law = rb.Tsuji(restitution=1.0)
    case = dem_cases.head_on(ball, other, speed, dt=dt, phase=0.5, lasts=1.2 * time, contact=law, wall="rigid")
    dem, last = dem_cases.dem_of(case)
    forces = []
    for step in range(FINE // 2, FINE // 2 + 12):
        dem.run(step)
        forces.append(float(np.abs(dem.contacts(0).force).max()))
    assert 0 < np.argmax(forces) < 11
    dem.run(last)
    x = dem.state().cavities[0].position[:, 0]
    gap = 0.5 * case.dampers[0].cavity.size[0] - x[0] - ball.radius if plane else x[1] - x[0] - 2 * ball.radius
    left = dem.state().time - gap / speed
    return max(forces), dem.counts().largest_overlap[0] * ball.radius, left - 5.5 * dt


def elastic_impacts() -> Iterator[Comparison]:
    """Yield force, overlap and time of elastic impacts, against Hertz."""
    for name, (ball, plane, speed) in IMPACTS.items():
        other = None if plane else ball
        mass = ball.mass if plane else 0.5 * ball.mass
        stiffness = dem_cases.stiffness(ball, other, "rigid")
        overlap = (1.25 * mass * speed**2 / stiffness) ** 0.4
        exact = stiffness * overlap**1.5, overlap, dashpot.HERTZ_TIME * overlap / speed
        for what, a, b in zip(
            ("force", "overlap", "contact time"), exact, elastic_impact(ball, plane, speed), strict=True
        ):
            # Verlet: the square of the step, (pi / 2000)^2 / 2, or less.
            yield Comparison("dem", f"{name}: {what}", a, b, 2e-6)


def prescribed_restitution() -> Iterator[Comparison]:
    """Yield the restitution of impacts with a prescribed restitution."""
    ball = Ball(0.01)
    time = dem_cases.contact_time(ball, None, 1.0)
    for e in (0.1, 0.2, 0.4, 0.6, 0.8, 0.99):
        for ending in ("zero_force", "zero_overlap"):
            law = rb.Tsuji(restitution=e, ending=ending)
            case = dem_cases.head_on(ball, None, 1.0, dt=time / FINE, phase=0.3, lasts=4 * time, contact=law)
            got = dem_cases.rebound(dem_cases.run(case))
            # Orders and factors: see test_normal.
            allowed = 2.4 * FINE**-2 if ending == "zero_force" else 0.38 * FINE**-1.25
            yield Comparison("dem", f"e = {e} prescribed, {ending.replace('_', ' ')}", e, got, allowed / e)


def contact_end(case: Any, ball: Ball, ending: str, about: float) -> float:
    """Return the time at which the force of a ball on the wall at +x ends [s], to second order; not before `about`."""
    dem, last = dem_cases.dem_of(case)
    if ending == "zero_overlap":
        dem.run(last)
        now = dem.state().cavities[0]
        gap = 0.5 * case.dampers[0].cavity.size[0] - now.position[0, 0] - ball.radius
        return float(dem.state().time + gap / now.velocity[0, 0])
    forces: list[float] = []
    step = math.floor(about / case.method.dt)
    while not forces or forces[-1] > 0:
        dem.run(step)
        forces.append(float(np.abs(dem.contacts(0).force).max()))
        step += 1
    before, least = forces[-3:-1]
    return float(dem.state().time - case.method.dt * (1 - least / (before - least)))


def damped() -> Iterator[Comparison]:
    """Yield contact times of Tsuji's law, and a restitution close to zero."""
    ball = Ball(0.01)
    elastic = dem_cases.contact_time(ball, None, 1.0)
    unit = (ball.mass / dem_cases.stiffness(ball)) ** 0.4
    for ending in ("zero_force", "zero_overlap"):
        for zeta in (0.1, 0.5):
            exact = dashpot.tsuji_contact_time(zeta, ending) * unit
            law = rb.Tsuji(alpha=zeta * math.sqrt(5), ending=ending)
            case = dem_cases.head_on(ball, None, 1.0, dt=elastic / FINE, phase=0.5, lasts=1.5 * exact, contact=law)
            time = contact_end(case, ball, ending, 0.99 * exact) - 5.5 * elastic / FINE
            # Order 2; factors measured with steps of 1/500 to 1/4000: up to 7.2, and 2.6 if the end follows from the flight.
            allowed = (8.0 if ending == "zero_force" else 3.2) * FINE**-2
            yield Comparison("dem", f"zeta = {zeta}, {ending.replace('_', ' ')}: contact time", exact, time, allowed)
    law = rb.Tsuji(alpha=0.9 * math.sqrt(5), ending="zero_overlap")
    case = dem_cases.head_on(ball, None, 1.0, dt=elastic / FINE, phase=0.5, lasts=30 * elastic, contact=law)
    exact = dashpot.restitution(0.9, "zero_overlap")
    allowed = 0.38 * FINE**-1.25 / exact
    yield Comparison(
        "dem", "zeta = 0.9, zero overlap: restitution", exact, dem_cases.rebound(dem_cases.run(case)), allowed
    )


def yielding() -> Iterator[Comparison]:
    """Yield the restitution of contacts that yield."""
    ball, steel = Ball(0.01), rb.materials()["steel"]
    modulus = steel.young / (1 - steel.poisson**2) / 2
    scale = restitution_laws.thornton_speed(ball.radius, ball.mass, modulus, 1.6 * steel.yield_stress)
    for ratio in printed.THORNTON:
        speed = ratio * scale
        time = dem_cases.contact_time(ball, None, speed)
        case = dem_cases.head_on(ball, None, speed, dt=time / FINE, phase=0.3, lasts=4 * time, contact=rb.Thornton())
        exact = restitution_laws.thornton(ratio)
        yield Comparison(
            "dem",
            f"Thornton, V/V_y = {ratio}: restitution",
            exact,
            dem_cases.rebound(dem_cases.run(case)) / speed,
            1e-6,
        )


ALUMINA = Ball(0.0025, material=stuff(380e9, 0.23, 4000))
OBLIQUE_SPEED, OBLIQUE_FRICTION, OBLIQUE_E = 3.9, 0.092, 0.98


def oblique_impact(angle: float, per_contact: int, **options: Any) -> tuple[float, float, float, Any]:
    """Return tangential and normal velocity, spin, and the run, of an alumina sphere that hits the floor at an angle."""
    radius = ALUMINA.radius
    down, along = OBLIQUE_SPEED * math.cos(angle), OBLIQUE_SPEED * math.sin(angle)
    dt = dem_cases.contact_time(ALUMINA, None, down) / per_contact
    half = 20 * radius
    spin = options.pop("spin", 0.0)
    start = (0, 0, radius - half + 5.5 * dt * down)
    ball = Ball(radius, start, (along, 0, -down), (0, spin, 0), ALUMINA.material)
    usual = {"contact": rb.Tsuji(restitution=OBLIQUE_E), "friction": rb.Mindlin(OBLIQUE_FRICTION)}
    case = dem_cases.case(
        [ball], dt=dt, steps=4 * per_contact, cavity=rb.Box(size=(2 * half,) * 3), **{**usual, **options}
    )
    result = dem_cases.run(case)
    velocity, turning = result.arrays.particles.velocity[0], result.arrays.particles.spin[0]
    assert velocity[1] == turning[0] == turning[2] == 0
    return float(velocity[0]), float(velocity[2]), float(turning[1]), result


def oblique_law(
    angle: float, e: float, damping: float, steps: int = 4000, keeps: str = "eased"
) -> tuple[float, float, float]:
    """Return tangential and normal velocity and spin from an accurate integration of the law or of a variant of it."""
    down = OBLIQUE_SPEED * math.cos(angle)
    law = oblique.Impact(
        alpha=float(alpha_of_restitution(e)),
        ratio=oblique.mindlin_ratio(ALUMINA.stuff.poisson),
        friction=OBLIQUE_FRICTION,
        damping=damping,
        stiffness=dem_cases.stiffness(ALUMINA) * ALUMINA.radius**2.5 / (ALUMINA.mass * down**2),
        keeps=keeps,
    )
    along, spin, up = law.follow(math.tan(angle), steps)
    return along * down, up * down, -spin * down / ALUMINA.radius


def oblique_impacts() -> Iterator[Comparison]:
    """Yield tangential restitution and spin of test 4 of Chung and Ooi, against closed form and accurate integration."""
    for degrees in (10, 20, 30, 50, 70):
        angle = math.radians(degrees)
        before = OBLIQUE_SPEED * math.sin(angle)
        along, _, spin, _ = oblique_impact(angle, FINE)
        exact = oblique_law(angle, OBLIQUE_E, 1.0, 16000)
        yield Comparison(
            "dem", f"alumina at {degrees} degrees: tangential restitution", exact[0] / before, along / before, 1e-5
        )
        yield Comparison("dem", f"alumina at {degrees} degrees: spin", exact[2], spin, 2e-5)


def ball_that_falls(e: float, height: float, end: float, dt: float) -> Any:
    """Return the case of MFiX's test DEM01."""
    return dem_cases.case(
        [Ball(0.1, (0, 0, 0.5 - 0.5 * height), material=stuff(1e9, 0.3, 2600))],
        dt=dt,
        steps=round(end / dt),
        cavity=rb.Box(size=(1.0, 1.0, height)),
        contact=rb.Linear(stiffness=1e4, restitution=e, ending="zero_overlap"),
        gravity=(0, 0, -9.81),
    )


def first_touch(dt: float = 1e-5) -> float:
    """Return the time of the first step in contact of that test, less half a step [s]."""
    dem, last = dem_cases.dem_of(ball_that_falls(0.9, 2.0, 0.3, dt))
    for step in range(round(0.28 / dt), last):
        dem.run(step)
        if dem.contacts(0).first.size:
            return float(dem.state().time - 0.5 * dt)
    raise AssertionError("the ball does not touch")


def falling(e: float, dt: float = 1e-5) -> tuple[float, float, float]:
    """Return approach and rebound speed [m/s], and duration [s], of the first bounce of that test."""
    height, end = 2.0, 0.45
    result = dem_cases.run(ball_that_falls(e, height, end, dt))
    arrays = result.arrays
    high, speed = arrays.particles.position[0, 2] + 0.5 * height - 0.1, arrays.particles.velocity[0, 2]
    rebound = math.sqrt(speed**2 + 2 * 9.81 * high)
    approach = result.diagnostics["largest_approach_speed"]
    return approach, rebound, end - (rebound - speed) / 9.81 - approach / 9.81


def bounce(e: float) -> tuple[float, float, float]:
    """Return the same from the exact solution of spring and dashpot under gravity until the overlap is zero again."""
    mass, stiffness = 2600 * 4 / 3 * math.pi * 0.1**3, 1e4
    approach = math.sqrt(2 * 9.81 * 0.4)
    zeta = -math.log(e) / math.hypot(math.pi, math.log(e))
    omega = math.sqrt(stiffness / mass)
    swing, decay, rest = omega * math.sqrt(1 - zeta**2), zeta * omega, 9.81 / omega**2

    def overlap(t: float) -> float:
        part = math.cos(swing * t) + decay / swing * math.sin(swing * t)
        return rest + math.exp(-decay * t) * (approach / swing * math.sin(swing * t) - rest * part)

    time = float(brentq(overlap, 0.5 * math.pi / swing, 1.5 * math.pi / swing, xtol=1e-15, rtol=1e-14))
    slope = math.cos(swing * time) - decay / swing * math.sin(swing * time)
    rate = math.exp(-decay * time) * (approach * slope + rest * omega**2 / swing * math.sin(swing * time))
    return approach, -rate, time


def falling_ball() -> Iterator[Comparison]:
    """Yield first touch, speeds and contact time of MFiX's falling ball."""
    # Accurate to half a step.
    yield Comparison(
        "dem", "ball falling on a linear spring: first touch", math.sqrt(2 * 0.4 / 9.81), first_touch(), 1.8e-5
    )
    for e in (0.6, 0.9):
        for what, a, b in zip(("touches at", "leaves at", "contact time"), bounce(e), falling(e), strict=True):
            # The force of a linear dashpot jumps within a step, which lasts a ten thousandth of the contact.
            yield Comparison("dem", f"ball falling on a linear spring, e = {e}: {what}", a, b, 1e-4)


GRAVITY = 9.81
FLOOR = stuff(1e9, 0.3, 2000)


def on_floor(
    velocity: float, spin: float, friction: float, *, rolling: Any = None, slope: float = 0.0, duration: float = 1.0
) -> Any:
    """Return the run of a ball that starts on a floor, which may slope down along x (its tangent)."""
    radius, dt = 0.02, 1e-5
    angle = math.atan(slope)
    case = dem_cases.case(
        [Ball(radius, (-0.5, 0, 0), (velocity, 0, 0), (0, spin, 0), FLOOR)],
        dt=dt,
        steps=round(duration / dt),
        samples=1000,
        cavity=rb.Box(size=(2.0, 1.0, 2 * radius)),
        contact=rb.Tsuji(restitution=0.2),
        friction=friction,
        rolling=rolling,
        gravity=(GRAVITY * math.sin(angle), 0, -GRAVITY * math.cos(angle)),
    )
    return dem_cases.run(case)


def along(result: Any) -> tuple[Any, Any]:
    """Return path [m] and velocity [m/s] along x, (T,)."""
    arrays = result.arrays
    return arrays.centre_of_mass[:, 0, 0] + 0.5, arrays.momentum[:, 0, 0] / arrays.particles.mass[0]


def slip_to_roll() -> Iterator[Comparison]:
    """Yield velocity and time of a ball that slips until it rolls (MFiX's test DEM04)."""
    start, friction = 1.0, 0.2
    result = on_floor(start, 0.0, friction, duration=0.25)
    _, speed = along(result)
    rolls = float(speed[-1])
    # Where the slope, taken between a tenth and nine tenths of the way, meets the end.
    early, late = (float(np.interp(share * (start - rolls), start - speed, result.arrays.time)) for share in (0.1, 0.9))
    # The lever is shorter than the radius by the overlap, 0.03 % of it; the ball swings on the floor at first.
    yield Comparison("dem", "ball slips, then rolls: velocity", 5 / 7 * start, rolls, 3e-4)
    yield Comparison(
        "dem", "ball slips, then rolls: time", 2 * start / (7 * friction * GRAVITY), late + (late - early) / 8, 1e-3
    )


def rolls_out() -> Iterator[Comparison]:
    """Yield the distance that a ball rolls with rolling resistance, and its velocity on a slope."""
    start, resistance = 0.3, 0.05
    brake = 5 / 7 * resistance * GRAVITY
    path, _ = along(on_floor(start, start / 0.02, 0.5, rolling=rb.Rolling(resistance, damping=0.3)))
    # The ball swings on the floor at first, and the spring of the resistance gives way by some micrometres in the end.
    yield Comparison("dem", "ball rolls to a stop: path", start**2 / (2 * brake), float(path[-1]), 1e-3)
    for part in (1.2, 1.5):
        slope = part * resistance
        _, speed = along(on_floor(0.0, 0.0, 0.5, rolling=rb.Rolling(resistance, damping=0.3), slope=slope))
        angle = math.atan(slope)
        exact = 5 / 7 * GRAVITY * (math.sin(angle) - resistance * math.cos(angle))
        yield Comparison(
            "dem", f"ball rolls down a slope of {part} mu_r: acceleration", exact, 2 * (speed[-1] - speed[500]), 5e-3
        )


def shaken_ball(gamma: float, per_contact: int = 400) -> Any:
    """Return the run of a ball on a shaker of 20 Hz with a short, strongly damped contact, and the amplitude."""
    frequency, radius, half, cycles, time = 20.0, 2e-3, 0.02, 6, 1e-4
    amplitude = gamma * GRAVITY / (2 * math.pi * frequency) ** 2
    samples = 400 * cycles
    every = math.ceil(cycles / frequency / samples / (time / per_contact))
    case = dem_cases.case(
        [Ball(radius, (0, 0, radius - half))],
        dt=cycles / frequency / samples / every,
        steps=samples * every,
        samples=samples,
        cavity=rb.Box(size=(2 * half,) * 3),
        contact=rb.Linear(contact_time=time, restitution=0.1),
        gravity=(0, 0, -GRAVITY),
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=f"{amplitude!r} m", frequency=frequency, direction="z")),
    )
    return dem_cases.run(case), frequency, amplitude


def inelastic_ball() -> Iterator[Comparison]:
    """Yield the apparent mass of a ball on a shaker, from the force on the cavity, and its loss from the ledger."""
    for gamma in printed.APPARENT_MASS:
        exact = shaken.inelastic_ball(gamma).apparent_mass()
        result, frequency, amplitude = shaken_ball(gamma)
        results = shaken_cavity(result, frequency=frequency, after=1 / frequency)
        mass = result.arrays.particles.mass[0]
        unit = math.pi * mass * (2 * math.pi * frequency * amplitude) ** 2
        power, ledger = (float(loss) / unit for loss in results.loss_per_cycle)
        # What is left of the speed, e = 0.1, bears e^2 = 1 % of the energy.
        name = f"inelastic ball on a shaker, Gamma {gamma}"
        yield Comparison("dem", f"{name}: m'", exact[0], float(results.effective_mass[0]) / mass, 2e-3)
        yield Comparison("dem", f"{name}: m''", exact[1], power, 1e-2)
        yield Comparison("dem", f"{name}: m'' from the ledger", exact[1], ledger, 1e-2)


FILLED = {
    "box": rb.Box(size=("30 mm", "30 mm", "60 mm")),
    "lying cylinder": rb.Cylinder(diameter="40 mm", length="40 mm", axis="x"),
    "sphere": rb.SphericalCavity(diameter="40 mm"),
}


@cache
def settled(name: str) -> tuple[Any, float]:
    """Return the force of two hundred settled spheres on their cavity [N], (3,), and their weight [N]."""
    soft = rb.Material(name="soft", density=2500, young=5e7, poisson=0.25)
    damper = rb.ParticleDamper(
        particles=rb.Particles(material=soft, diameter="4 mm", count=200),
        cavity=FILLED[name],
        contact=rb.Tsuji(restitution=0.3),
        friction=0.4,
        rolling=rb.Rolling(0.05, damping=0.3),
        packing=rb.Settled(seed=1),
    )
    arrays = dem_cases.run(
        rb.Case(structure=rb.Fixed(), damper=damper, duration=0.6, output=rb.Output(rate=100.0))
    ).arrays
    return arrays.cavity_force[-1, 0], float(arrays.particles.mass.sum() * GRAVITY)


def hydrostatic() -> Iterator[Comparison]:
    """Yield the load of a settled fill on its cavity."""
    for name in FILLED:
        force, weight = settled(name)
        # A bed comes to rest slowly: some tenths of a second after settling a ball may still roll.
        yield Comparison(
            "dem", f"two hundred spheres settled in a {name}: load over weight", 1.0, -force[2] / weight, 1e-6
        )


LAWS: dict[str, Any] = {
    "Hertz": rb.Tsuji(restitution=0.9),
    "Jackson-Green": rb.Tsuji(restitution=rb.JacksonGreen()),
    "linear": rb.Linear(stiffness=2e7, restitution=0.9),
    "yielding": rb.Thornton(),
}
FLIGHT, PLAY, TIMES = 0.02, 5e-4, 100


def one_ball(law: str, dt: float) -> tuple[Any, Any]:
    """Return displacement of the structure and position of the ball, (T,) each, by the 3-D engine."""
    result = dem_cases.run(
        dem_cases.case(
            [Ball(0.01, (0, 0, 0), (1.0, 0, 0))],
            dt=dt,
            steps=round(FLIGHT / dt),
            samples=TIMES,
            cavity=rb.Box(size=(0.02 + 2 * PLAY, 0.06, 0.06)),
            contact=LAWS[law],
            structure=rb.SDOF(mass=2.0, stiffness=2e5, damping=8.0),
        )
    ).arrays
    return result.displacement[:, 0], result.centre_of_mass[:, 0, 0] + result.cavity_displacement[:, 0, 0]


def one_ball_exactly(law: str) -> tuple[Any, Any, int]:
    """Return the same by the 1-D engine, and the number of impacts."""
    arrays = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=2.0, stiffness=2e5, damping=8.0),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius=0.01, material="steel"), gap=PLAY, velocity=1.0, contact=LAWS[law]
            ),
            duration=FLIGHT,
            output=rb.Output(times=np.linspace(0, FLIGHT, TIMES + 1)),
        )
    ).arrays
    return arrays.displacement[:, 0], arrays.ball_position[:, 0], len(arrays.impacts)


def in_one_direction() -> Iterator[Comparison]:
    """Yield positions of one ball and its structure after eight impacts or more, against the 1-D engine."""
    for law in LAWS:
        displacement, place, _ = one_ball_exactly(law)
        ours, flown = one_ball(law, 2.5e-8)
        # Order 2: see test_known_solutions.
        yield Comparison(
            "dem", f"{law} ball in one direction, as by the impact engine: structure", displacement[-1], ours[-1], 5e-5
        )
        yield Comparison(
            "dem", f"{law} ball in one direction, as by the impact engine: ball", place[-1], flown[-1], 1e-4
        )


ALL: tuple[Callable[[], Iterator[Comparison]], ...] = (
    elastic_impacts,
    prescribed_restitution,
    damped,
    yielding,
    oblique_impacts,
    falling_ball,
    slip_to_roll,
    rolls_out,
    inelastic_ball,
    hydrostatic,
    in_one_direction,
)
