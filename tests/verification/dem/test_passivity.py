"""No impact generates energy: random impacts at all angles, with all laws, up to the longest permitted step."""

from typing import Any

import numpy as np
import pytest
from support import dem_cases

import rattlebox as rb
from rattlebox.prepare.time_step import expected_speeds, limits

GLASS = rb.Material(name="glassy", density=2500, young=5e9, poisson=0.25, yield_stress=5e7)
FASTEST, SMALLEST, LARGEST = 2.0, 1e-3, 6e-3
FLIGHT = 2e-5  # before the impacts, at least [s]
CONTACTS: dict[str, Any] = {
    "elastic": rb.Tsuji(restitution=1.0),
    "Hertz": rb.Tsuji(restitution=0.7),
    "pulling": rb.Tsuji(restitution=0.7, ending="zero_overlap"),
    "yielding": rb.Thornton(),
    "linear": rb.Linear(contact_time="40 us", restitution=0.7),
}
FRICTIONS: dict[str, dict[str, Any]] = {
    "none": {},
    "little": {"friction": 0.1},
    "Mindlin": {"friction": 0.5},
    "without dashpot": {"friction": rb.Mindlin(1.0, damping=0.0)},
    "spring": {"friction": rb.LinearSpring(0.5, stiffness=2e5)},
    "rolling": {"friction": 0.5, "rolling": 0.3},
    "rolling with dashpot": {"friction": 1.0, "rolling": rb.Rolling(0.5, stiffness=3.0, damping=0.5)},
    "large friction": {"friction": 100.0},
    "strong dashpot": {"friction": rb.Mindlin(50.0, damping=20.0)},
    "stiff spring": {"friction": rb.LinearSpring(2.0, stiffness=1e9)},
    "stiff rolling": {"friction": 10.0, "rolling": rb.Rolling(5.0, stiffness=100.0)},
    "strong rolling": {"friction": 10.0, "rolling": rb.Rolling(5.0, stiffness=3.0, damping=5.0)},
}
FITS = [
    (contact, friction)
    for contact in CONTACTS
    for friction in FRICTIONS
    if contact != "linear" or friction in ("none", "spring", "stiff spring")
]


def bound(case: Any) -> float:
    """Return the longest step that the engine permits [s]."""
    damper = case.dampers[0]
    tables, speeds = [damper.contact_table], expected_speeds(case, [np.zeros((0, 3))])
    return min(limit.bound for limit in limits(case, tables, speeds))


def directions(rng: np.random.Generator, count: int) -> tuple[Any, Any]:
    """Return normals and relative velocities at all angles, a tenth of them head-on and a tenth grazing."""
    normal = rng.standard_normal((count, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    along = np.cross(normal, rng.standard_normal((count, 3)))
    along /= np.linalg.norm(along, axis=1)[:, None]
    cosine = rng.uniform(0, 1, count)
    kind = rng.random(count)
    cosine = np.where(kind < 0.1, 1 - 0.01 * cosine**2, np.where(kind > 0.9, 1e-3 * cosine, cosine))
    speed = FASTEST * rng.uniform(0.05, 1, count)
    velocity = speed[:, None] * (cosine[:, None] * normal + np.sqrt(1 - cosine**2)[:, None] * along)
    return normal, velocity


def spins(rng: np.random.Generator, radii: Any) -> Any:
    """Return spins, a third of them none."""
    turning = FASTEST * rng.uniform(0, 2, radii.size) * (rng.random(radii.size) < 0.67) / radii
    return turning[:, None] * rng.standard_normal((radii.size, 3))


def pairs(count: int, seed: int) -> tuple[Any, dict[str, Any]]:
    """Return a wide box and a number of pairs in it that are about to collide."""
    rng = np.random.default_rng(seed)
    number = int(np.ceil(count ** (1 / 3)))
    cell = 8 * LARGEST
    index = np.indices((number,) * 3).reshape(3, -1).T[:count]
    middle = (index + 0.5 - 0.5 * number) * cell
    radii = rng.uniform(SMALLEST, LARGEST, (count, 2))
    normal, velocity = directions(rng, count)
    ahead = velocity * (FLIGHT * (1 + rng.random(count)))[:, None]
    first = middle - radii[:, :1] * normal - 0.5 * ahead
    second = middle + radii[:, 1:] * normal + 0.5 * ahead
    start = {
        "positions": np.stack([first, second], axis=1).reshape(-1, 3),
        "velocities": np.stack([0.5 * velocity, -0.5 * velocity], axis=1).reshape(-1, 3),
        "spins": spins(rng, radii.ravel()),
        "radii": radii.ravel(),
    }
    return rb.Box(size=(number * cell,) * 3), start


def at_wall(count: int, seed: int) -> tuple[Any, dict[str, Any]]:
    """Return a wide sphere and balls that are about to hit it."""
    rng = np.random.default_rng(seed)
    radii = rng.uniform(SMALLEST, LARGEST, count)
    _, velocity = directions(rng, count)
    # Uniformly distributed over the sphere, with outward velocities.
    k = np.arange(count) + 0.5
    polar, turn = np.arccos(1 - 2 * k / count), np.pi * (1 + 5**0.5) * k
    normal = np.stack([np.cos(turn) * np.sin(polar), np.sin(turn) * np.sin(polar), np.cos(polar)], axis=1)
    normal_speed = np.abs((velocity * normal).sum(axis=1))
    velocity += (normal_speed - (velocity * normal).sum(axis=1))[:, None] * normal
    size = 0.5
    place = (size - radii)[:, None] * normal - velocity * (FLIGHT * (1 + rng.random(count)))[:, None]
    start = {"positions": place, "velocities": velocity, "spins": spins(rng, radii), "radii": radii}
    return rb.SphericalCavity(radius=size), start


def prepared(make: Any, **laws: Any) -> Any:
    """Return the case of three hundred impacts with the automatic step."""
    cavity, start = make(300, 11)
    damper = rb.ParticleDamper(
        particles=rb.Particles(material=GLASS),
        cavity=cavity,
        packing=rb.Positions(**start),
        gravity=(0, 0, 0),
        **laws,
    )
    return rb.Case(structure=rb.Fixed(), damper=damper, duration=1e-3, output=rb.Output(times=[1e-3]))


def gains(make: Any, share: float, **laws: Any) -> tuple[Any, Any]:
    """Return the relative energy gain of each impact, and the run; the step is a fraction of the bound."""
    plain = prepared(make, **laws)
    (damper,) = plain.dampers
    dt = share * bound(plain)
    steps = int(np.ceil(1e-3 / dt))
    case = rb.Case(
        structure=rb.Fixed(),
        damper=damper,
        duration=steps * dt,
        output=rb.Output(times=[steps * dt]),
        method=rb.Dem(dt=dt * (1 + 1e-9)),
    )
    result = dem_cases.run(case, closes=False)
    contents, arrays = damper.contents, result.arrays

    def energy(velocity: Any, spin: Any) -> Any:
        each = 0.5 * contents.mass * (velocity**2).sum(axis=1) + 0.5 * contents.inertia * (spin**2).sum(axis=1)
        return each.reshape(300, -1).sum(axis=1)

    before = energy(damper.start.velocity, damper.start.spin)
    return energy(arrays.particles.velocity, arrays.particles.spin) / before - 1, result


# Verlet keeps the energy of an elastic Hertz contact to the order 5/2, and what yields is elastic below the yield speed. A
# linear contact that ends within a step of its beginning may gain, of the little of the motion that goes into it.
LOOSE = {"elastic": 0.01, "yielding": 0.01, "linear": 1e-9}


@pytest.mark.parametrize("make", [pairs, at_wall])
@pytest.mark.parametrize(("contact", "friction"), FITS)
@pytest.mark.parametrize("shares", [(0.999, 0.4), pytest.param((0.08,), marks=pytest.mark.slow)])
def test_no_impact_generates_energy(contact: str, friction: str, make: Any, shares: tuple[float, ...]) -> None:
    """The energy of three hundred impacts, grazing to head-on, with and without spin, never increases."""
    for share in shares:
        gained, result = gains(make, share, contact=CONTACTS[contact], **FRICTIONS[friction])
        counts = result.counts
        assert counts["first_touches_particle"] + counts["first_touches_wall"] >= 280
        assert gained.max() <= LOOSE.get(contact, 0.0) * share**2.5 + 1e-13
        assert np.median(gained) < (1e-4 if friction == "none" else 0)


def test_gain_of_elastic_impacts_falls_at_the_stated_order() -> None:
    """Without loss the mean error of the energy decreases with the power 5/2 of the step."""
    coarse, fine = (np.abs(gains(pairs, share, contact=CONTACTS["elastic"])[0]).mean() for share in (0.8, 0.05))
    assert coarse > 1e-5
    assert np.log2(coarse / fine) / 4 == pytest.approx(2.5, abs=0.2)


@pytest.mark.parametrize("friction", ["none", "strong dashpot", "stiff spring", "stiff rolling", "strong rolling"])
def test_step_beyond_the_bound_is_refused(friction: str) -> None:
    """A step slightly above the bound is refused, for each of the conditions that determine it."""
    with pytest.raises(rb.CaseError, match="is too long: the bound is"):
        gains(pairs, 1.001, contact=CONTACTS["Hertz"], **FRICTIONS[friction])


def test_friction_may_need_shorter_steps_than_the_contact() -> None:
    """Stiff springs and strong dashpots lower the bound; common ones change it little."""

    def least(friction: str) -> float:
        return bound(prepared(pairs, contact=CONTACTS["Hertz"], **FRICTIONS[friction]))

    assert 0.7 * least("none") < least("Mindlin") <= least("none")
    for friction in ("strong dashpot", "stiff spring", "stiff rolling", "strong rolling"):
        assert least(friction) < 0.5 * least("none")
