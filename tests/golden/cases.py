"""Cases with golden results, built through the public interface only.

Each function returns a new case. Names are file names of the stored results.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import rattlebox as rb

SHORT, LONG = 200, 3000
"""Steps of the two runs of each particle case: values are compared after the short one, bits after both."""

# ---- impact: the system of the reference paper

CENTRED, TRAILING, LEADING = 0.0, -1.0, 1.0
PAPER = {"case 1": CENTRED, "case 2": TRAILING, "case 3": LEADING}
"""Start positions of the three cases of the reference paper."""
CONSTANT_ALPHA = rb.Tsuji(alpha=0.006313, ending="zero_overlap")
STEEL_WALL = rb.Tsuji(restitution=rb.JacksonGreen(), ending="zero_overlap")
RIGID_WALL = rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid"), ending="zero_overlap")


def sampled(dense: float, duration: float) -> rb.Output:
    """Return output times that are dense up to a time [s] that covers some impacts, and sparse later."""
    return rb.Output(times=np.concatenate([np.linspace(0, min(dense, duration), 41), np.linspace(0, duration, 11)]))


ENDS = rb.Output(times=[0.0])
"""Output at the start and the end only."""
DEFAULT = rb.Output()
"""Default output."""


def reference(
    contact: Any = CONSTANT_ALPHA,
    *,
    start: float = CENTRED,
    amplitude: float = 5000.0,
    duration: float = 5.0,
    output: Any = None,
    **options: Any,
) -> rb.Case:
    """Return the steel ball of the reference paper on its oscillator, under a half sine of one millisecond."""
    load = options.pop("load", rb.HalfSine(amplitude=amplitude, duration=1e-3))
    return rb.Case(
        structure=options.pop("structure", rb.SDOF(mass=20.0, stiffness=80e3, damping=25.3)),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius=33.17e-3, material="steel"),
            gap=0.4e-3,
            start=start,
            contact=contact,
        ),
        load=load,
        duration=duration,
        output=output or sampled(0.2, duration),
        **options,
    )


LAWS: dict[str, Any] = {
    "tsuji zero force": rb.Tsuji(restitution=0.9),
    "tsuji zero overlap": rb.Tsuji(restitution=0.9, ending="zero_overlap"),
    "tsuji alpha zero force": rb.Tsuji(alpha=0.3),
    "tsuji above critical": rb.Tsuji(alpha=2.5),
    "tsuji jackson green": rb.Tsuji(restitution=rb.JacksonGreen(extrapolate=True)),
    "tsuji johnson": rb.Tsuji(restitution=rb.Johnson()),
    "tsuji thornton restitution": rb.Tsuji(restitution=rb.ThorntonRestitution(maximum=0.95)),
    "tsuji table": rb.Tsuji(restitution=rb.Tabulated(speeds=[0.01, 0.05, 0.2], values=[0.98, 0.9, 0.7])),
    "linear zero force": rb.Linear(stiffness="50 MN/m", restitution=0.8),
    "linear zero overlap": rb.Linear(stiffness="50 MN/m", restitution=0.8, ending="zero_overlap"),
    "linear damping": rb.Linear(contact_time="0.4 ms", damping=800.0),
    "linear table": rb.Linear(
        contact_time="0.4 ms", restitution=rb.Tabulated(speeds=[0.01, 0.05, 0.2], values=[0.98, 0.9, 0.7])
    ),
    "thornton": rb.Thornton(yield_pressure="300 MPa"),
    "thornton of the material": rb.Thornton(),
}
"""Contact laws of the impact engine."""


def five_balls(contact: Any = None, output: Any = None, duration: float = 0.5, **options: Any) -> rb.Case:
    """Return a row of five different balls at the tip of a structure with three modes, under a pulse and a harmonic load."""
    materials = ["steel", "brass", "glass", "steel", "aluminium"]
    radii = [6e-3, 5e-3, 4e-3, 5e-3, 7e-3]
    start = options.pop("start", [-0.5, -0.2, 0.0, 0.3, 0.6])
    method = options.pop("method", rb.EventDriven())
    return rb.Case(
        structure=rb.Modal(
            frequencies=[8.0, 23.0, 51.0],
            damping_ratios=[0.004, 0.006, 0.01],
            shapes={"tip": [0.5, -0.35, 0.2]},
        ),
        damper=rb.ImpactDamper(
            balls=[rb.Sphere(radius=r, material=m) for r, m in zip(radii, materials, strict=True)],
            gap=0.6e-3,
            start=start,
            contact=contact or rb.Tsuji(restitution=0.9),
            **options,
        ),
        load=[
            rb.HalfSine(amplitude=600.0, duration=2e-3, point="tip"),
            rb.Harmonic(amplitude=20.0, frequency=9.0, point="tip"),
        ],
        duration=duration,
        output=output or sampled(8e-3, duration),
        method=method,
    )


HARMONIC = rb.Harmonic(amplitude=60.0, frequency=9.8)
RECORD = rb.Record(times=[0, 0.01, 0.02, 0.05, 0.09, 0.4, 5.0], values=[0, 400, -250, 300, -80, 10, 0])


def base_motion(duration: float = 1.0) -> rb.Case:
    """Return the reference system on a shaken base, without a load."""
    return reference(
        load=[], base=rb.Harmonic(amplitude="3 m/s^2", frequency=9.8), duration=duration, contact=LAWS["thornton"]
    )


def vibrating_table(method: Any = None) -> rb.Case:
    """Return a ball that bounces on the floor of a cavity on a vertical shaker."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="0.159 mm", frequency=50.0)),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius=5e-3, material="glass"),
            gap=0.05,
            start=-0.99,
            gravity=-9.81,
            contact=rb.Tsuji(restitution=0.6),
        ),
        duration=1.0,
        output=sampled(0.2, 1.0),
        method=method or rb.EventDriven(),
    )


def two_dampers(method: Any = None) -> rb.Case:
    """Return two dampers, one with two balls, on a chain of two masses given by its matrices."""
    return rb.Case(
        structure=rb.Matrices(
            M=[[2.0, 0.0], [0.0, 1.0]],
            C=[[2.5, -0.5], [-0.5, 1.0]],
            K=[[3e4, -1e4], [-1e4, 1e4]],
            points={"low": 0, "top": 1},
            velocity=[0.0, 0.6],
        ),
        dampers=[
            rb.ImpactDamper(
                name="low",
                point="low",
                ball=rb.Sphere(radius=15e-3, material="steel"),
                gap=0.5e-3,
                start=0.2,
                contact=rb.Tsuji(restitution=0.7),
            ),
            rb.ImpactDamper(
                name="top",
                point="top",
                balls=[rb.Sphere(radius=8e-3, material="brass"), rb.Sphere(radius=8e-3, material="glass")],
                gap=0.3e-3,
                start=[-0.4, 0.5],
                wall="aluminium",
                contact=rb.Linear(contact_time="0.2 ms", restitution=0.8),
                ball_contact=rb.Linear(contact_time="0.1 ms", restitution=0.9),
            ),
        ],
        duration=1.0,
        output=sampled(0.1, 1.0),
        method=method or rb.EventDriven(),
    )


IMPACT: dict[str, Callable[[], rb.Case]] = {
    **{
        f"paper {name}, {force} N": partial(reference, start=start, amplitude=force)
        for name, start in PAPER.items()
        for force in (5000, 100)
    },
    **{f"paper {name}, steel wall": partial(reference, STEEL_WALL, start=start) for name, start in PAPER.items()},
    **{f"paper {name}, rigid wall": partial(reference, RIGID_WALL, start=start) for name, start in PAPER.items()},
    "paper case 1, default output": partial(reference, output=DEFAULT),
    "paper case 1, step by step": partial(reference, method=rb.EventDriven(collocation=False), duration=2.0),
    **{f"law {name}": partial(reference, law, duration=2.0) for name, law in LAWS.items()},
    "five balls": five_balls,
    "five balls, default output": partial(five_balls, output=DEFAULT, duration=0.3),
    "five balls, thornton": partial(five_balls, rb.Thornton(yield_pressure="300 MPa"), duration=0.1),
    "five balls, linear": partial(five_balls, rb.Linear(contact_time="0.2 ms", restitution=0.8)),
    "five balls, two laws": partial(
        five_balls, ball_contact=rb.Tsuji(restitution=rb.Johnson(), ending="zero_force"), wall="rigid"
    ),
    "five balls packed": partial(five_balls, start=0.0),
    "harmonic load": partial(reference, load=HARMONIC),
    "harmonic load, thornton": partial(reference, LAWS["thornton"], load=HARMONIC, duration=1.0),
    "recorded load": partial(reference, load=RECORD),
    "recorded load, linear": partial(reference, LAWS["linear zero force"], load=RECORD),
    "base motion": base_motion,
    "vibrating table": vibrating_table,
    "two dampers": two_dampers,
    "hard paper case 1": partial(reference, method=rb.Newton()),
    "hard default output": partial(reference, method=rb.Newton(), output=DEFAULT, duration=1.0),
    "hard jackson green": partial(reference, RIGID_WALL, method=rb.Newton()),
    "hard table": partial(reference, LAWS["tsuji table"], method=rb.Newton()),
    "hard five balls": partial(five_balls, method=rb.Newton(restitution=0.6)),
    "hard vibrating table": partial(vibrating_table, rb.Newton(restitution=0.5)),
    "hard two dampers": partial(two_dampers, rb.Newton()),
    "two-step": partial(reference, method=rb.TwoStep(dt_contact=1e-6), duration=0.5),
    "two-step thornton": partial(reference, LAWS["thornton"], method=rb.TwoStep(dt_contact=1e-6), duration=0.5),
    "two-step adaptive": partial(reference, method=rb.TwoStep(inner="dopri5", dt_flight=5e-5), duration=0.07),
}

# ---- dem: soft spheres in cavities

SOFT = rb.Material(name="soft", density=2500, young=5e7, poisson=0.25, yield_stress=3e5)
HARDER = rb.Material(name="harder", density=4000, young=2e8, poisson=0.3, yield_stress=1e6)
OSCILLATOR = rb.SDOF(mass=0.5, stiffness=2e4, damping_ratio=0.02, velocity=1.0)
BOX = rb.Box(size=("22.5 mm", "19.5 mm", "19.5 mm"))
MINDLIN = rb.Mindlin(0.3)
NORMAL_SIZES = rb.NormalSizes(mean="3 mm", deviation="0.3 mm", smallest="2.5 mm", largest="3.5 mm")
SIEVED = rb.Sieve(sizes=["2.2 mm", "3 mm", "3.8 mm"], passing=[0.0, 0.4, 1.0])
STEP = 2e-6


def moving(size: tuple[int, int, int], inside: Callable[[Any], Any] | None = None, seed: int = 4) -> rb.Positions:
    """Return spheres of 3 mm with small gaps on a lattice, or on part of it, with random velocities and spins."""
    rng = np.random.default_rng(seed)
    places = (np.stack(np.meshgrid(*map(np.arange, size), indexing="ij"), -1).reshape(-1, 3) + 0.5) * 3.15e-3
    places -= np.array(size) / 2 * 3.15e-3
    places += rng.uniform(-7e-5, 7e-5, places.shape)
    places = places if inside is None else places[inside(places)]
    return rb.Positions(
        positions=places,
        velocities=rng.normal((0.3, 0.2, -0.5), 1.0, places.shape),
        spins=rng.normal(0.0, 300.0, places.shape),
    )


IN_BOX = moving((7, 6, 6))
IN_UPRIGHT = moving((8, 8, 6), lambda x: np.hypot(x[:, 0], x[:, 1]) < 11.4e-3)
IN_LYING = moving((6, 8, 8), lambda x: np.hypot(x[:, 1], x[:, 2]) < 11.4e-3)
IN_SPHERE = moving((9, 9, 9), lambda x: np.linalg.norm(x, axis=1) < 13.4e-3)
UPRIGHT = {"cavity": rb.Cylinder(diameter="26 mm", length="19.5 mm"), "packing": IN_UPRIGHT}
LYING = {"cavity": rb.Cylinder(diameter="26 mm", length="19.5 mm", axis="x"), "packing": IN_LYING}
ROUND = {"cavity": rb.SphericalCavity(radius="15 mm"), "packing": IN_SPHERE}


def filling(**options: Any) -> dict[str, Any]:
    """Return the arguments of a damper filled with moving soft spheres with friction."""
    usual: dict[str, Any] = {
        "particles": rb.Particles(material=SOFT, diameter="3 mm"),
        "cavity": BOX,
        "contact": rb.Tsuji(restitution=0.8),
        "friction": MINDLIN,
        "packing": IN_BOX,
    }
    return usual | options


def particles(
    steps: int,
    *,
    structure: Any = OSCILLATOR,
    load: Any = (),
    base: Any = (),
    threads: int | None = 1,
    dt: Any = STEP,
    dampers: Any = None,
    checkpoint_every: float | None = None,
    **options: Any,
) -> rb.Case:
    """Return one or several filled cavities, simulated for a number of steps."""
    duration = steps * STEP
    return rb.Case(
        structure=structure,
        dampers=[rb.ParticleDamper(**filling(**each)) for each in dampers or [options]],
        load=load,
        base=base,
        duration=duration,
        output=rb.Output(times=np.linspace(0, duration, 5)),
        # Rounding must not make the engine take one step more between two samples.
        method=rb.Dem(dt=dt if dt == "auto" else dt * (1 + 1e-9), threads=threads, checkpoint_every=checkpoint_every),
    )


TWO_SPECIES = [
    rb.Particles(name="light", material=SOFT, diameter="3 mm", count=126),
    rb.Particles(name="heavy", material=HARDER, diameter="2.7 mm", count=126),
]
FEWER = [species.model_copy(update={"count": 75}) for species in TWO_SPECIES]
PAIR_TABLE = [
    rb.PairLaws(between=("light", "heavy"), contact=rb.Tsuji(restitution=0.6), friction=0.6),
    rb.PairLaws(between=("heavy", "wall"), friction=0, contact=rb.Tsuji(restitution=0.95)),
]
SPATIAL = rb.Modal(
    frequencies=[40.0, 170.0],
    damping_ratios=[0.02, 0.05],
    shapes={"tip": [[0.0, 0.3, 1.0], [1.0, 0.0, -0.4]]},
)
SHAKEN = rb.Shaker(motion=rb.Harmonic(amplitude="30 m/s^2", frequency=70.0, direction="z"))
LINEAR = rb.Linear(contact_time="0.2 ms", restitution=0.8)
MIXED_SIZES = {"packing": rb.Lattice(noise=1.0, seed=4), "velocity": (4.0, -3.0, -5.0)}
RECORDED = rb.Record(times=[0, 2e-4, 5e-4, 2e-3, 5e-3, 1.0], values=[0, 80, -60, 120, -40, 0])

SETTLED: dict[str, Any] = {
    "particles": rb.Particles(material=SOFT, diameter="4 mm", count=30),
    "packing": rb.Settled(seed=1),
    "load": rb.Harmonic(amplitude=200.0, frequency=400.0, phase=1.0),
}

DEM: dict[str, dict[str, Any]] = {
    "box": {},
    "upright cylinder": UPRIGHT,
    "lying cylinder": LYING,
    "sphere": ROUND,
    "no friction": {"friction": None},
    "friction given by stiffness": {"friction": rb.LinearSpring(0.4, stiffness="20 kN/m")},
    "friction without damping": {"friction": rb.Mindlin(coefficient=0.5, damping=0.0)},
    "friction at walls": {"wall_friction": 0.05, "wall_contact": rb.Tsuji(restitution=0.5)},
    "rolling": {"rolling": 0.05},
    "rolling with damping": {"rolling": rb.Rolling(coefficient=0.1, stiffness=2.0, damping=0.3), "wall_rolling": 0.02},
    "two species": {"particles": TWO_SPECIES, "pairs": PAIR_TABLE},
    "two species, mixed": {
        "particles": TWO_SPECIES,
        "pairs": [rb.PairLaws(between=("heavy", "heavy"), contact=rb.Tsuji(restitution=0.5), friction=0.1)],
        "mixing": "geometric",
    },
    "jackson green": {"contact": rb.Tsuji(restitution=rb.JacksonGreen(extrapolate=True))},
    "johnson": {"contact": rb.Tsuji(restitution=rb.Johnson())},
    "thornton restitution": {"contact": rb.Tsuji(restitution=rb.ThorntonRestitution())},
    "table": {"contact": rb.Tsuji(restitution=rb.Tabulated(speeds=[0.1, 1.0, 5.0], values=[0.95, 0.8, 0.6]))},
    "alpha": {"contact": rb.Tsuji(alpha=0.3)},
    "zero overlap": {"contact": rb.Tsuji(restitution=0.7, ending="zero_overlap")},
    "thornton": {"contact": rb.Thornton(yield_pressure="2 MPa")},
    "linear": {"contact": LINEAR, "friction": rb.LinearSpring(0.3, ratio=0.4)},
    "linear zero overlap": {
        "contact": rb.Linear(stiffness="20 kN/m", restitution=0.7, ending="zero_overlap"),
        "friction": rb.LinearSpring(0.3, stiffness="5 kN/m"),
        "rolling": 0.05,
    },
    "normal sizes": {"particles": rb.Particles(material=SOFT, distribution=NORMAL_SIZES, count=140), **MIXED_SIZES},
    "sieved sizes": {"particles": rb.Particles(material=SOFT, distribution=SIEVED, count=100), **MIXED_SIZES},
    "several cavities": {
        "dampers": [
            {"name": "box"},
            {"name": "can", "contact": rb.Tsuji(alpha=0.4), **UPRIGHT},
            {"name": "ball", "rolling": 0.05, "direction": "y", **ROUND},
        ]
    },
    "load": {"load": [rb.Harmonic(amplitude=50.0, frequency=400.0), rb.HalfSine(amplitude=100.0, duration="0.3 ms")]},
    "recorded load": {"load": RECORDED},
    "base motion": {"base": rb.Harmonic(amplitude="300 m/s^2", frequency=400.0)},
    "shaker": {"structure": SHAKEN},
    "spatial modes": {
        "structure": SPATIAL,
        "point": "tip",
        "load": rb.HalfSine(amplitude=50.0, duration="0.3 ms", point="tip", direction="z"),
    },
    "rigid wall": {"wall": "rigid"},
    "softened": {
        "particles": rb.Particles(material=HARDER, diameter="3 mm"),
        "softening": 4.0,
        "contact": rb.Thornton(yield_pressure="20 MPa"),
    },
    "automatic step": {"dt": "auto"},
}
"""Arguments of `particles`."""

VALUES: dict[str, Callable[[], rb.Case]] = {
    **{f"impact {name}": build for name, build in IMPACT.items()},
    **{f"dem {name}": partial(particles, SHORT, **options) for name, options in DEM.items()},
}
"""Cases whose values and bits are stored."""

FEWER_IMPACTS = {"impact paper case 2, 100 N": 8, "impact vibrating table": 6, "impact two-step adaptive": 5}
"""Cases whose values are compared up to an earlier impact than the tenth, because rounding grows faster in them."""

BITS_ONLY: dict[str, Callable[[], rb.Case]] = {
    **{f"dem {name}, long": partial(particles, LONG, **options) for name, options in DEM.items()},
    "dem settled": partial(particles, SHORT, **SETTLED),
}
"""Cases of which only bits are stored, because the motion is chaotic at their end or after settling."""

CASES = VALUES | BITS_ONLY
"""All cases with golden results."""

TWO_THREADS: dict[str, Callable[[], rb.Case]] = {
    f"dem {name}, long": partial(particles, LONG, **(DEM[name] | {"threads": 2}))
    for name in ("box", "several cavities", "thornton", "rolling")
}
"""The same with two threads: the bits must be those of one."""

CHECKPOINTED: dict[str, Callable[[], rb.Case]] = {
    f"dem {name}, long": partial(particles, LONG, **(DEM[name] | {"checkpoint_every": 50 * STEP}))
    for name in ("box", "thornton", "linear", "rolling with damping", "several cavities")
}
"""The same with checkpoints: the bits after a restart must be those of an unbroken run."""

# ---- ensembles of chaotic runs

BALL_RUNS, ROW_RUNS, PARTICLE_RUNS = 200, 100, 40
"""Runs of an ensemble of one ball, of a row of balls, and of particles."""


def _starts(build: Callable[..., rb.Case], around: float = 0.0, **options: Any) -> list[rb.Case]:
    """Return cases whose start positions differ by up to 1e-4 of the gap."""
    inward = -np.sign(around) if around else 1.0
    shifts = np.random.default_rng(1).uniform(0, 1e-4, BALL_RUNS)
    return [build(start=around + inward * shift, **options) for shift in shifts]


def _five_balls(contact: Any = None, method: Any = None, duration: float = 0.5) -> list[rb.Case]:
    """Return rows of five balls with slightly different start positions."""
    shifts = np.random.default_rng(1).uniform(0, 1e-4, (ROW_RUNS, 5))
    start = np.array([-0.5, -0.2, 0.0, 0.3, 0.6])
    method = method or rb.EventDriven()
    return [five_balls(contact, ENDS, duration, start=(start + shift).tolist(), method=method) for shift in shifts]


def _settled() -> list[rb.Case]:
    """Return shaken cavities in which particles have settled after random insertions."""
    return [particles(10_000, **(SETTLED | {"packing": rb.Settled(seed=seed)})) for seed in range(PARTICLE_RUNS)]


def _packings(**options: Any) -> list[rb.Case]:
    """Return shaken cavities with random packings."""
    usual = {"particles": rb.Particles(material=SOFT, diameter="3 mm", count=150)}
    return [
        particles(20_000, packing=rb.Lattice(noise=0.9, seed=seed), load=_SHAKING, **(usual | options))
        for seed in range(PARTICLE_RUNS)
    ]


_SHAKING = rb.Harmonic(amplitude=60.0, frequency=60.0)

ENSEMBLES: dict[str, Callable[[], list[rb.Case]]] = {
    **{
        f"paper {name}": partial(_starts, reference, start, output=ENDS, duration=10.0) for name, start in PAPER.items()
    },
    "paper case 1, rigid wall": partial(_starts, reference, contact=RIGID_WALL, output=ENDS, duration=10.0),
    "linear": partial(_starts, reference, contact=LAWS["linear zero force"], output=ENDS, duration=10.0),
    "thornton": partial(_starts, reference, contact=LAWS["thornton"], output=ENDS, duration=10.0),
    "harmonic load": partial(_starts, reference, load=HARMONIC, output=ENDS, duration=10.0),
    "hard": partial(_starts, reference, method=rb.Newton(), output=ENDS, duration=10.0),
    "five balls": _five_balls,
    "five balls, thornton": partial(_five_balls, rb.Thornton(yield_pressure="300 MPa"), duration=0.1),
    "hard five balls": partial(_five_balls, method=rb.Newton(restitution=0.6)),
    "box of particles": _packings,
    "rolling particles in a cylinder": partial(_packings, rolling=0.05, cavity=UPRIGHT["cavity"]),
    "thornton particles": partial(_packings, contact=rb.Thornton(yield_pressure="2 MPa")),
    "linear particles": partial(_packings, contact=LINEAR, friction=rb.LinearSpring(0.3, ratio=0.4)),
    "settled particles": _settled,
    "two species": partial(_packings, particles=FEWER, pairs=PAIR_TABLE),
}
"""Ensembles of runs with different initial states."""
