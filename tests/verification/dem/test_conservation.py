"""Conservation of momentum and angular momentum to rounding for all laws; action and reaction at the cavity."""

from typing import Any

import numpy as np
import pytest
from support import dem_cases

import rattlebox as rb

SOFT = rb.Material(name="soft", density=2500, young=5e7, poisson=0.25, yield_stress=5e6)
SIZES = rb.LogNormal(median="2.5 mm", geometric_standard_deviation=1.5, smallest="1 mm", largest="5 mm")
LAWS: dict[str, dict[str, Any]] = {
    "smooth": {"contact": rb.Tsuji(restitution=0.8)},
    "rough": {"contact": rb.Tsuji(restitution=0.8), "friction": 0.5},
    "rolling": {"contact": rb.Tsuji(restitution=0.8), "friction": 0.5, "rolling": rb.Rolling(0.1, damping=0.3)},
    "linear": {
        "contact": rb.Linear(contact_time="0.2 ms", restitution=0.8, ending="zero_overlap"),
        "friction": rb.LinearSpring(0.5, ratio=0.3),
        "rolling": 0.1,
    },
    "yielding": {"contact": rb.Thornton(), "friction": 0.5, "rolling": 0.1},
}


def cloud(
    law: str, *, inwards: float = 0.0, random: float = 0.0, size: float = 0.04, count: int = 120, **options: Any
) -> Any:
    """Return a case of spinning spheres of many sizes that fly at random and towards the centre."""
    rng = np.random.default_rng(3)
    structure, duration = options.pop("structure", rb.Fixed()), options.pop("duration", 0.02)
    method, rate = options.pop("method", rb.Dem()), options.pop("rate", 5000.0)
    usual: dict[str, Any] = {
        "particles": rb.Particles(material=SOFT, distribution=SIZES, count=count),
        "cavity": rb.Box(size=(size,) * 3),
        "gravity": (0, 0, 0),
        **LAWS[law],
        **options,
    }
    places = rb.ParticleDamper(**{**usual, "cavity": rb.Box(size=(0.04,) * 3)}).start.position
    start = rb.Positions(
        positions=places,
        velocities=random * rng.standard_normal((count, 3)) - inwards * places / 0.02,
        spins=300 * rng.standard_normal((count, 3)),
    )
    damper = rb.ParticleDamper(**usual, packing=start)
    return rb.Case(structure=structure, damper=damper, duration=duration, output=rb.Output(rate=rate), method=method)


def momenta(now: Any, contents: Any) -> tuple[Any, Any]:
    """Return momentum and angular momentum about the origin of all particles, each (n, 3)."""
    momentum = contents.mass[:, None] * now.velocity
    turning = contents.inertia[:, None] * now.spin
    return momentum, np.cross(now.position, momentum) + turning


@pytest.mark.parametrize("law", LAWS)
def test_particles_alone_keep_both_momenta(law: str) -> None:
    """Spheres that collide far from walls conserve momentum and angular momentum to rounding, with friction and rolling."""
    case = cloud(law, inwards=2.0, random=0.3, size=0.4)
    contents = case.dampers[0].contents
    dem, last = dem_cases.dem_of(case)
    dem.run(0)
    (before, turning), shares = momenta(dem_cases.particles_start(case), contents), []
    for k in range(1, 9):
        dem.run(last * k // 8)
        after, turned = momenta(dem.state().cavities[0], contents)
        scale = np.abs(before).sum(), np.abs(turning).sum()
        assert np.abs(after.sum(axis=0) - before.sum(axis=0)).max() < 1e-13 * scale[0]
        assert np.abs(turned.sum(axis=0) - turning.sum(axis=0)).max() < 1e-13 * scale[1]
        shares.append(np.abs(after - before).sum() / scale[0])
    touches = dem.counts().first_touches[0]
    assert touches[0] > 200 and touches[1] == 0
    assert shares[-1] > 0.1


MASS = 0.3
ROOT = MASS**-0.5
FREE = rb.Modal(
    frequencies=[0, 0, 0],
    damping_ratios=[0, 0, 0],
    shapes={"cavity": [[ROOT, 0, 0], [0, 0.6 * ROOT, 0.8 * ROOT], [0, -0.8 * ROOT, 0.6 * ROOT]]},
    velocity=[0.1, -0.2, 0.1],
)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("cavity", [rb.Box(size=(0.04,) * 3), rb.SphericalCavity(radius=0.04)], ids=["box", "sphere"])
def test_a_free_cavity_and_its_particles_keep_their_momentum(law: str, cavity: Any) -> None:
    """A free cavity and its particles conserve their momentum in all three directions to rounding."""
    case = cloud(law, random=1.0, cavity=cavity, structure=FREE)
    result = dem_cases.run(case)
    arrays = result.arrays
    total = arrays.momentum[:, 0] + MASS * arrays.cavity_velocity[:, 0]
    scale = np.abs(arrays.particles.mass[:, None] * arrays.particles.velocity).sum() + MASS
    assert np.abs(total - total[0]).max() < 1e-13 * scale
    assert np.ptp(arrays.momentum[:, 0], axis=0).max() > 1e-3 * scale
    assert result.counts["first_touches_wall"] > 50


def test_cavities_at_several_points_keep_the_momentum_of_each_mode() -> None:
    """Different cavities at three points of a free structure conserve, with their particles, the momentum of each mode."""
    shapes = {
        "a": [[2.0, 0.3, 0.5], [0.2, 1.4, 1.0]],
        "b": [[0.3, 2.0, 0.1], [1.0, 0.0, -0.5]],
        "c": [[0.0, 0.2, 2.0], [1.0, 0.3, 0.0]],
    }
    free = rb.Modal(frequencies=[0, 0], damping_ratios=[0, 0], shapes=shapes, velocity=[0.2, 0.3])
    cavities = (
        rb.Box(size=(0.04,) * 3),
        rb.Cylinder(radius=0.03, length=0.04, axis="y"),
        rb.SphericalCavity(radius=0.036),
    )
    dampers = [
        cloud(law, random=1.0, cavity=cavity, gravity=(0, 0, -9.81))
        .dampers[0]
        .model_copy(update={"point": point, "name": point})
        for law, cavity, point in zip(("rough", "rolling", "yielding"), cavities, shapes, strict=True)
    ]
    arrays = dem_cases.run(
        rb.Case(structure=free, dampers=dampers, duration=0.02, output=rb.Output(rate=2000.0), method=rb.Dem())
    ).arrays
    points = np.array([shapes[name] for name in arrays.dampers])  # (dampers, modes, axes)
    moved = arrays.cavity_velocity.reshape(arrays.time.size, -1)
    modes = np.linalg.lstsq(points.transpose(0, 2, 1).reshape(-1, 2), moved.T, rcond=None)[0].T
    weight = arrays.particle_mass[:, None] * np.array([0, 0, -9.81])
    pulled = np.einsum("dmi,di->m", points, weight) * arrays.time[:, None]
    total = modes + np.einsum("dmi,tdi->tm", points, arrays.momentum) - pulled
    assert np.abs(total - total[0]).max() < 1e-13 * (np.abs(modes).max() + np.abs(pulled).max())
    assert np.ptp(modes, axis=0).min() > 1e-3
    assert arrays.contacts.sum(axis=(0, 2)).min() > 20  # at the samples


@pytest.mark.parametrize("law", LAWS)
def test_force_on_the_cavity_is_the_change_of_momentum(law: str) -> None:
    """In each step the mean force on a cavity is the loss rate of the momentum of its particles plus their weight."""
    dt = 4e-6
    case = cloud(
        law,
        random=1.0,
        gravity=(1.0, 2.0, -9.81),
        structure=FREE,
        duration=600 * dt,
        rate=1 / dt,
        method=rb.Dem(dt=dt * (1 + 1e-9)),
    )
    result = dem_cases.run(case)
    arrays = result.arrays
    assert arrays.time.size == result.counts["steps"] > 500
    mean = 0.5 * (arrays.cavity_force[1:, 0] + arrays.cavity_force[:-1, 0])
    weight = arrays.particles.mass.sum() * np.array([1.0, 2.0, -9.81])
    rate = np.diff(arrays.momentum[:, 0], axis=0) / np.diff(arrays.time)[:, None]
    assert np.abs(mean).max() > 1
    assert mean == pytest.approx(
        weight - rate, abs=1e-9 * np.abs(mean).max() + 1e-13 * np.abs(arrays.momentum).max() / dt
    )


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    "cavity", [rb.Box(size=(0.04,) * 3), rb.Cylinder(radius=0.027, length=0.041)], ids=["box", "can"]
)
def test_moment_on_the_cavity_is_the_change_of_angular_momentum(law: str, cavity: Any) -> None:
    """In each step the mean moment on a cavity is that of the weight less the rate of the particles' angular momentum."""
    gravity, dt, steps = np.array([1.0, 2.0, -9.81]), 4e-6, 600
    case = cloud(
        law,
        random=1.0,
        inwards=-1.0,
        cavity=cavity,
        gravity=tuple(gravity),
        duration=steps * dt,
        rate=1 / dt,
        method=rb.Dem(dt=dt * (1 + 1e-9)),
    )
    contents = case.dampers[0].contents
    dem, _ = dem_cases.dem_of(case)
    moments, turning, weighing = [], [], []
    for k in range(steps):
        dem.run(k)
        now = dem.state().cavities[0]
        moments.append(dem.records().moment[-1, 0])
        turning.append(momenta(now, contents)[1].sum(axis=0))
        weighing.append(np.cross(contents.mass @ now.position, gravity))
    half = [0.5 * (np.array(each)[1:] + np.array(each)[:-1]) for each in (moments, weighing)]
    rate = np.diff(turning, axis=0) / dt
    assert dem.counts().first_touches[0][1] > 10
    assert np.abs(half[0]).max() > 1e-3
    assert half[0] == pytest.approx(
        half[1] - rate, abs=1e-8 * np.abs(half[0]).max() + 1e-13 * np.abs(turning).max() / dt
    )
