"""Hard impacts at the same time: symmetry, the law against an enumeration, energy, and the threshold of sticking."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from support import tie_search

import rattlebox as rb

Array = NDArray[np.float64]


def body(masses: list[float], method: Any, *, mass: float, stiffness: float = 0.0, duration: float, e: float) -> Any:
    """Run dampers with equal gaps and balls of these masses at rest on one moving body."""
    dampers = [
        rb.ImpactDamper(
            name=f"d{k}",
            ball=rb.Sphere(radius=8e-3, material="steel", mass=m),
            gap=0.6e-3,
            contact=rb.Tsuji(restitution=e),
        )
        for k, m in enumerate(masses)
    ]
    structure = rb.SDOF(mass=mass, stiffness=stiffness, velocity=0.3)
    return rb.simulate(rb.Case(structure=structure, dampers=dampers, duration=duration, method=method))


@pytest.mark.parametrize("count", [2, 3, 5])
@pytest.mark.parametrize("e", [0.0, 0.4, 0.8, 1.0])
@pytest.mark.parametrize("light", [False, True], ids=["heavy structure", "light structure"])
def test_identical_dampers_are_one_of_their_mass(count: int, e: float, light: bool) -> None:
    """Identical dampers with the same start move in step and move the structure as one of their mass.

    Until one sticks, they do so bit for bit.

    The symmetric cases of the tests had one damper or soft contacts; hard impacts were resolved in the order of contacts.
    """
    mass, stiffness = (0.3, 0.0) if light else (12.0, 50e3)
    few = {"mass": mass, "stiffness": stiffness, "duration": 0.2, "e": e if e else 0.5}
    method = rb.Newton(restitution=e)
    many, one = body([0.2] * count, method, **few), body([0.2 * count], method, **few)
    assert many.ok and one.ok
    velocity = many.arrays.ball_velocity
    assert np.ptp(velocity, axis=1).max() <= (1e-13 if many.counts["sticks"] else 0)
    log, single = many.arrays.impacts, one.arrays.impacts
    n = min(len(single), 8)
    assert n > (e > 0)
    assert log.time[: n * count : count] == pytest.approx(single.time[:n], rel=1e-9)
    assert log.approach_speed[: n * count : count] == pytest.approx(single.approach_speed[:n], rel=1e-7, abs=1e-12)
    assert many.counts["simultaneous_impacts"] * count == len(log)
    assert one.counts["simultaneous_impacts"] == 0


@pytest.mark.parametrize("e", [0.0, 0.25, 0.6, 1.0])
def test_symmetric_row_stays_symmetric(e: float) -> None:
    """The middle one of three balls that the outer ones hit at the same time stays at rest; they rebound with e."""
    ball = rb.Sphere(radius=6e-3, material="glass")
    run = rb.simulate(
        rb.Case(
            structure=rb.Fixed(),
            damper=rb.ImpactDamper(
                balls=[ball] * 3,
                gap="8 mm",
                start=["-3 mm", "0 mm", "3 mm"],
                velocity=[0.5, 0.0, -0.5],
                contact=rb.Tsuji(restitution=0.5),
            ),
            duration=0.05,
            method=rb.Newton(restitution=e),
        )
    )
    velocity = run.arrays.ball_velocity
    assert np.array_equal(velocity[:, 1], np.zeros(len(velocity)))
    assert np.array_equal(velocity[:, 0], -velocity[:, 2])
    assert run.arrays.impacts.separation_speed[:2] == pytest.approx([0.5 * e] * 2, rel=1e-12, abs=0)
    assert run.energy_residual <= 1e-12


def random_instant(seed: int) -> tuple[Any, Array, Array, Array, Array]:
    """Return a case in which 2 to 5 balls meet a free body at one time, and masses, sides, e and speeds before.

    Each ball has its own mass, gap, speed, wall and restitution, so that some get no impulse.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 6))
    mass = 10 ** rng.uniform(-1.5, 1.5, count)
    side, e, approach = rng.choice([-1.0, 1.0], count), rng.uniform(0, 1, count), rng.uniform(0.02, 1, count)
    e[rng.random(count) < 0.2] = 1.0
    time, velocity = 2.0**-7, float(rng.uniform(-1, 1))
    # A ball approaches the leading wall (side 1) if it is faster than the body.
    speed = velocity + side * approach
    gap = approach * time
    dampers = [
        rb.ImpactDamper(
            name=f"d{k}",
            ball=rb.Sphere(radius=5e-3, material="steel", mass=float(mass[k])),
            gap=float(gap[k]),
            velocity=float(speed[k]),
            contact=rb.Tsuji(restitution=float(max(e[k], 0.01))),
        )
        for k in range(count)
    ]
    e = np.maximum(e, 0.01)
    case = rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=0.0, velocity=velocity),
        dampers=dampers,
        duration=time * (1 + 1e-9),
        method=rb.Newton(),
        output=rb.Output(times=[0.0]),
    )
    return case, mass, side, e, approach


def check_instants(seeds: range) -> tuple[int, int]:
    """Compare instants with the enumeration; return the numbers of cases, and of those in which a ball has no impulse."""
    setups = [random_instant(seed) for seed in seeds]
    runs = rb.simulate_many([setup[0] for setup in setups], threads=2)
    passive = 0
    for seed, (case, mass, side, e, approach), run in zip(seeds, setups, runs, strict=True):
        assert run.ok, f"{seed}: {run.message}"
        matrix = np.diag(1 / mass) + np.outer(side, side)  # the body has a mass of 1 kg
        impulse = tie_search.resolve(matrix, -approach, e)
        after = matrix @ impulse - approach
        velocity = case.structure.velocity + side @ impulse
        found = run.arrays.ball_velocity[-1]
        expected = case.structure.velocity + side * approach - side * impulse / mass
        assert found == pytest.approx(expected, abs=1e-9), f"{seed}: {found}, {expected}"
        assert run.arrays.velocity[-1, 0] == pytest.approx(velocity, abs=1e-9)
        lost = 0.5 * impulse * (1 - e) * approach
        log = run.arrays.impacts
        assert len(log) == np.count_nonzero(impulse), f"{seed}: {len(log)} impacts, {impulse}"
        assert np.sort(log.energy_lost) == pytest.approx(np.sort(lost[impulse > 0]), abs=1e-12)
        assert lost.sum() >= 0 and run.energy_residual <= 1e-12
        assert run.counts["simultaneous_impacts"] == (np.count_nonzero(impulse) > 1)
        assert np.all(after >= e * approach - 1e-9)
        passive += bool((impulse == 0).any())
    return len(setups), passive


def test_law_of_simultaneous_impacts_is_that_of_an_enumeration() -> None:
    """Velocities, losses and the log after an instant follow the law for different e; energy never rises."""
    count, passive = check_instants(range(300))
    assert 0.1 * count < passive < 0.9 * count


@pytest.mark.slow
def test_law_of_five_thousand_instants_is_that_of_an_enumeration() -> None:
    """The same for 5000 instants."""
    check_instants(range(1000, 6000))


def drop(height: float, e: float, duration: float, structure: Any = None) -> Any:
    """Drop a ball onto the floor of a cavity and return the log of its hard impacts."""
    gap = 0.4
    run = rb.simulate(
        rb.Case(
            structure=structure or rb.Fixed(),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius=6e-3, material="steel"),
                gap=gap,
                start=-1 + height / gap,
                gravity=-9.81,
                wall="rigid",
                contact=rb.Tsuji(restitution=e),
            ),
            duration=duration,
            method=rb.Newton(),
            output=rb.Output(times=[0.0]),
        )
    )
    assert run.ok
    return run.arrays.impacts


@pytest.mark.parametrize("e", [0.3, 0.6, 0.9])
@pytest.mark.parametrize("height", [2e-6, 0.05])
def test_bounces_do_not_depend_on_the_duration(height: float, e: float) -> None:
    """Impacts of a ball that comes to rest are those of the geometric series, for any duration of the run.

    Each test of sticking had one duration: the threshold was a part of it in a cavity without modes and loads.
    """
    first = np.sqrt(2 * 9.81 * height)
    logs = [drop(height, e, duration) for duration in (3.0, 4e3, 5e6)]
    n = len(logs[0])
    assert first * e ** (n - 1) > 5e-7 * first  # bounces above a millionth of the first speed are there
    assert first * e**n < 2e-6 * first
    for log in logs:
        assert len(log) == n
        assert log.approach_speed[:-1] == pytest.approx(first * e ** np.arange(n - 1), rel=1e-5)
        assert np.array_equal(log.time, logs[0].time)


def test_bounces_in_a_free_body_do_not_depend_on_the_duration() -> None:
    """The same in a heavy body that moves freely."""
    logs = [drop(0.03, 0.5, duration, rb.SDOF(mass=1e3, stiffness=0.0)) for duration in (2.0, 1e3)]
    assert len(logs[0]) == len(logs[1]) > 10
    assert logs[0].time == pytest.approx(logs[1].time, rel=1e-12)
