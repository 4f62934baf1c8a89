"""Contact detection and elastic forces against a brute-force search through all pairs and walls."""

from typing import Any

import numpy as np
import pytest
from support import brute_force, dem_cases

import rattlebox as rb
from rattlebox.prepare.settle import insert

CAVITIES = {
    "box": rb.Box(size=("40 mm", "30 mm", "60 mm")),
    "long box": rb.Box(size=("20 mm", "20 mm", "400 mm")),
    "flat box": rb.Box(size=("90 mm", "16 mm", "45 mm")),
    "upright can": rb.Cylinder(diameter="40 mm", length="50 mm"),
    "lying can": rb.Cylinder(diameter="40 mm", length="50 mm", axis="y"),
    "can askew": rb.Cylinder(diameter="40 mm", length="50 mm", axis=(1, 2, -1)),
    "sphere": rb.SphericalCavity(diameter="50 mm"),
    "periodic along x": rb.Box(size=("40 mm", "30 mm", "60 mm"), periodic="x"),
    "periodic along y and z": rb.Box(size=("90 mm", "16 mm", "45 mm"), periodic="yz"),
    "narrowest periodic": rb.Box(size=("8.29 mm", "9 mm", "300 mm"), periodic="xy"),
}
ALIKE = rb.NormalSizes(mean="4 mm", deviation="0.1 mm", smallest="3.9 mm", largest="4.1 mm")
WIDE = rb.LogNormal(median="1.5 mm", geometric_standard_deviation=2.0, smallest="0.8 mm", largest="8 mm")


SOFT = rb.Material(name="soft", density=2000, young=2e7, poisson=0.3)
HARDER = rb.Material(name="harder", density=3000, young=2e8, poisson=0.2)


def gas(
    cavity: Any,
    sizes: Any,
    count: int,
    speed: float,
    *,
    structure: Any = None,
    gravity: float = 0.0,
    one: Any = None,
    others: int = 0,
) -> Any:
    """Return soft elastic spheres with random velocities in a cavity.

    `one` of them has a velocity of its own; `others` more are of a harder material.
    """
    kinds = [rb.Particles(material=SOFT, distribution=sizes, count=count)]
    if others:
        kinds.append(rb.Particles(material=HARDER, distribution=sizes, count=others))
    options: dict[str, Any] = {
        "particles": kinds,
        "cavity": cavity,
        "contact": rb.Tsuji(restitution=1.0),
        "gravity": (0, 0, -gravity),
    }
    velocities = speed * np.random.default_rng(1).standard_normal((count + others, 3))
    if one is not None:
        velocities[7] = one
    places = rb.ParticleDamper(**options).start.position
    damper = rb.ParticleDamper(**options, packing=rb.Positions(positions=places, velocities=velocities))
    return rb.Case(structure=structure or rb.Fixed(), damper=damper, duration=0.05, output=rb.Output(rate=20e3))


def follow(case: Any, checks: int = 40) -> dict[str, int]:
    """Compare contacts, forces, and force and moment on the cavity with brute force during a run."""
    damper = case.dampers[0]
    dem, last = dem_cases.dem_of(case)
    contents, walls = damper.contents, damper.cavity.walls()
    soft = [(1 - each.material.poisson**2) / each.material.young for each in damper.particles]
    compliance = np.array(soft)[contents.species]
    inside, wall = 4 / 3 / (compliance[:, None] + compliance[None]), 4 / 3 / (compliance + soft[0])
    n = contents.radius.size
    every = max(1, round(last / case.even_samples()))
    seen: set[tuple[int, int]] = set()
    for k in range(1, checks + 1):
        until = every * round(last / every * k / checks)
        dem.run(until)
        assert dem.status == 0
        now, raw = dem.state().cavities[0], dem.records()
        moved = raw.q[-1] @ cavity_shape(case)
        result = brute_force.find_contacts(
            now.position - moved, contents.radius, walls, inside, wall, 1e-12, damper.cavity.period
        )
        listed = dem.contacts(0)
        there = {(min(i, j), max(i, j)) for i, j in zip(listed.first.tolist(), listed.second.tolist(), strict=True)}
        assert len(there) == len(listed.first)
        assert result.pairs <= there <= result.pairs | result.doubtful
        force = np.zeros((n, 3))
        np.add.at(force, listed.first, listed.force)
        between = listed.second < n
        np.subtract.at(force, listed.second[between], listed.force[between])
        # Rounding of positions is about 1e-10 of an overlap of micrometres.
        scale = np.abs(result.force).max() + 1e-30
        assert np.abs(force - result.force).max() < 1e-8 * scale
        assert np.abs(raw.force[-1, 0] - result.on_cavity).max() < 1e-8 * scale
        assert np.abs(raw.moment[-1, 0] - result.moment).max() < 1e-8 * scale * 0.05
        assert raw.contacts[-1, 0].sum() == len(there)
        seen |= there
    return {
        "pairs": sum(j < n for _, j in seen),
        "walls": sum(j >= n for _, j in seen),
        "builds": dem.counts().rebuilds,
        "scans": dem.counts().refreshes,
    }


def cavity_shape(case: Any) -> Any:
    """Return the displacement of the cavity for each mode, (m, 3)."""
    damper = case.dampers[0]
    return case.modes.space_shape(damper.point, damper.direction)


@pytest.mark.parametrize("name", CAVITIES)
def test_nothing_is_missed_in_any_cavity(name: str) -> None:
    """Contacts of spheres in a cavity are exactly the overlapping pairs, with the elastic force of the overlap."""
    seen = follow(gas(CAVITIES[name], ALIKE, 150, 1.0), checks=100)
    few = "periodic" in name  # fewer walls, which may be far apart
    assert seen["pairs"] > 150 and seen["walls"] > (5 if few else 50) and seen["builds"] > 3


@pytest.mark.parametrize("name", ["box", "can askew", "periodic along x"])
def test_nothing_is_missed_among_many_sizes(name: str) -> None:
    """No pair is missed if the largest sphere is ten times the smallest."""
    seen = follow(gas(CAVITIES[name], WIDE, 110, 1.0), checks=200)
    assert seen["pairs"] > 40 and seen["walls"] > 40


def of_sizes(cavity: Any, sizes: dict[str, int], speed: float) -> Any:
    """Return soft elastic spheres of given diameters and numbers with random velocities in a cavity."""
    kinds = [rb.Particles(name=size, material=SOFT, diameter=size, count=count) for size, count in sizes.items()]
    radii = np.repeat([kind.radius for kind in kinds], list(sizes.values()))
    start = rb.Positions(
        positions=insert(cavity, radii, seed=2),
        velocities=speed * np.random.default_rng(1).standard_normal((radii.size, 3)),
    )
    damper = rb.ParticleDamper(particles=kinds, cavity=cavity, contact=rb.Tsuji(restitution=1.0), packing=start)
    return rb.Case(structure=rb.Fixed(), damper=damper, duration=0.01, output=rb.Output(rate=20e3))


TWO_SIZES = {"1.5 mm": 1500, "14 mm": 4}
FIVE_SIZES = {"1.2 mm": 800, "1.9 mm": 600, "3 mm": 60, "7 mm": 8, "13 mm": 2}


@pytest.mark.parametrize(
    ("cavity", "sizes"),
    [
        pytest.param("flat box", TWO_SIZES, id="flat box-two"),
        pytest.param("sphere", FIVE_SIZES, id="sphere-five"),
        pytest.param("periodic along x", FIVE_SIZES, id="periodic-five"),
        pytest.param("flat box", FIVE_SIZES, id="flat box-five", marks=pytest.mark.slow),
        pytest.param("sphere", TWO_SIZES, id="sphere-two", marks=pytest.mark.slow),
        pytest.param("box", TWO_SIZES, id="box-two", marks=pytest.mark.slow),
        pytest.param("box", FIVE_SIZES, id="box-five", marks=pytest.mark.slow),
    ],
)
def test_nothing_is_missed_among_a_few_large_and_many_small(cavity: str, sizes: dict[str, int]) -> None:
    """No pair is missed with fine cells for the small spheres and coarse levels for the large ones."""
    seen = follow(of_sizes(CAVITIES[cavity], sizes, 2.0), checks=10)
    assert seen["pairs"] > 300 and seen["walls"] > 200 and seen["builds"] > 3


def test_each_pair_has_its_own_stiffness() -> None:
    """Contacts of spheres of two materials, and with a wall of the first one, have the effective modulus."""
    seen = follow(gas(CAVITIES["box"], ALIKE, 80, 1.0, others=70), checks=150)
    assert seen["pairs"] > 100 and seen["walls"] > 50


def test_nothing_is_missed_by_the_fast() -> None:
    """No pair is missed if spheres cross many cells between two checks, so that lists are rebuilt often."""
    seen = follow(gas(CAVITIES["long box"], ALIKE, 60, 8.0), checks=150)
    assert seen["pairs"] > 100 and seen["builds"] > 100


def test_nothing_is_missed_where_most_rest_and_one_is_fast() -> None:
    """No pair is missed if one sphere flies through a bed at rest, whose lists would be valid for long."""
    seen = follow(gas(CAVITIES["box"], ALIKE, 150, 1e-3, one=(3.0, 6.0, 9.0)), checks=80)
    assert seen["pairs"] > 20


def test_nothing_is_missed_in_a_moving_cavity() -> None:
    """No pair is missed in a light cavity that the spheres move."""
    light = rb.SDOF(mass=0.02, stiffness=2000.0, velocity=2.0)
    seen = follow(gas(CAVITIES["box"], ALIKE, 150, 0.5, structure=light, gravity=9.81), checks=80)
    assert seen["pairs"] > 150 and seen["walls"] > 100


def test_nothing_is_missed_where_a_periodic_cavity_moves() -> None:
    """No pair is missed in a periodic cavity that moves along its periodic direction, and across it."""
    light = rb.Modal(
        frequencies=[30, 40],
        shapes={"plate": [[2.0, 0.0, 1.0], [1.0, 0.0, 2.0]]},
        velocity=[0.3, 0.2],
        damping_ratios=[0.0, 0.0],
    )
    case = gas(CAVITIES["periodic along x"], ALIKE, 150, 0.5, structure=light, gravity=9.81)
    seen = follow(case, checks=80)
    assert seen["pairs"] > 100 and seen["walls"] > 30


def test_nothing_is_missed_after_a_blow_within_one_step() -> None:
    """No pair is missed if spheres at rest are accelerated to 1 km/s in a microsecond."""
    seen = follow(
        rb.Case(
            structure=rb.Shaker(
                motion=rb.Record(times=[0, 1e-3, 1.001e-3, 1.002e-3, 2e-3], values=[0, 0, 1e9, 0, 0], unit="m/s^2")
            ),
            damper=rb.ParticleDamper(
                particles=rb.Particles(material="steel", diameter="2 mm", count=200),
                cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
                contact=rb.Tsuji(restitution=1.0),
                packing=rb.Lattice(noise=0.5, seed=1),
            ),
            duration="1.01 ms",
            output=rb.Output(rate="1 MHz"),
        ),
        checks=1010,
    )
    assert seen["walls"] > 10


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_nothing_is_missed_in_random_cases(seed: int) -> None:
    """No pair is missed with random cavity, sizes, number, speed, gravity, structure and one fast sphere."""
    rng = np.random.default_rng(seed)
    sizes = WIDE if rng.random() < 0.3 else ALIKE
    most = 110 if sizes is WIDE else 300
    gravity = float(rng.choice([0.0, 9.81, 200.0]))
    refused = ["narrowest periodic"] * (sizes is WIDE) + ["periodic along y and z"] * (gravity > 0)
    seen = follow(
        gas(
            CAVITIES[rng.choice([name for name in CAVITIES if name not in refused])],
            sizes,
            int(rng.integers(8, most)),
            float(10 ** rng.uniform(-2, 1)),
            structure=rb.SDOF(mass=rng.uniform(0.02, 1), stiffness=2000.0, velocity=rng.uniform(-2, 2)),
            gravity=gravity,
            one=10 * rng.standard_normal(3) if rng.random() < 0.5 else None,
        ),
        checks=200,
    )
    assert seen["builds"] > 0
