"""Several hard stops at one place: the motion is that with one of them, forces add up, and no run ends early."""

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

PRESS = rb.Record(times=[0.0, 0.2, 1.0, 1.4, 1.6], values=[0.0, 30.0, 30.0, -12.0, 20.0], unit="N")
"""A slow load that presses a point against its stop, lets it go, and presses it again."""


def on_stops(gaps: Sequence[float], restitution: float = 0.6, **options: Any) -> Any:
    """Return the run of an oscillator with stops on its leading side."""
    case: dict[str, Any] = {
        "structure": rb.SDOF(mass=1.7, frequency=11.0, damping_ratio=0.02, velocity=0.11),
        "stops": [rb.Stop(gap=gap, contact=rb.Linear(contact_time="1 ms", restitution=restitution)) for gap in gaps],
        "load": PRESS,
        "duration": 1.6,
        "method": rb.Newton(max_events=20_000),
        "output": rb.Output(rate=1000.0),
    }
    run = rb.simulate(rb.Case(**case | options))
    assert run.ok, run.message
    return run


def compare(several: Any, one: Any, until: float = 1.6) -> None:
    """Fail unless both runs have one motion, and the stops of the first one together have the force of the other."""
    times = one.arrays.time[one.arrays.time <= until]

    def both(get: Any) -> tuple[Any, Any]:
        return tuple(np.interp(times, run.arrays.time, get(run.arrays)) for run in (several, one))

    moved, alone = both(lambda arrays: arrays.displacement[:, 0])
    assert np.abs(moved - alone).max() < 1e-12 * np.abs(alone).max()
    impulse, whole = both(lambda arrays: arrays.stop_impulse.sum(axis=1))
    assert np.abs(impulse - whole).max() < 1e-9 * np.abs(whole).max()
    lost, by_one = (run.ledger.contact_loss[-1] for run in (several, one))
    assert lost == pytest.approx(by_one, rel=1e-9)
    assert several.energy_residual < 1e-11


@pytest.mark.parametrize("gap", [0.0, 2e-3])
@pytest.mark.parametrize("count", [2, 3, 5])
@pytest.mark.parametrize("restitution", [1e-6, 0.6, 0.9])
def test_equal_stops_move_as_one(count: int, gap: float, restitution: float) -> None:
    """Equal stops that a point chatters to rest on, is pressed against, and leaves, act as one, and share its force equally.

    Equal stops were tested while they rebound; at rest one of them had the whole force, and was released before the others.
    """
    several, one = on_stops([gap] * count, restitution), on_stops([gap], restitution)
    assert one.counts["sticks"] > 0
    compare(several, one)
    at_rest = (one.arrays.time > 0.8) & (one.arrays.time < 0.95)
    shared = several.arrays.cavity_force[np.isin(several.arrays.time, one.arrays.time[at_rest])]
    assert len(shared) > 50
    assert np.ptp(shared, axis=1).max() < 1e-12 * np.abs(shared).max()
    assert np.ptp(several.arrays.stop_impulse[-1]) < 1e-9 * np.abs(several.arrays.stop_impulse[-1]).max()


@pytest.mark.parametrize("bits", [1, 3])
@pytest.mark.parametrize("order", [1, -1])
def test_gaps_that_differ_in_their_last_bits_are_one_stop(bits: int, order: int) -> None:
    """Stops whose gaps differ by some last bits act as one stop, in either order."""
    gap = 2e-3
    near = gap
    for _ in range(bits):
        near = float(np.nextafter(near, 1.0))
    compare(on_stops([gap, near, gap][::order]), on_stops([gap]))


def test_stiffness_of_hard_stops_changes_nothing() -> None:
    """A stop next to a much stiffer one: both are hard, and act as one."""
    laws = [rb.Linear(stiffness=stiffness, restitution=0.6) for stiffness in (3e4, 5e10)]
    several = on_stops([], stops=[rb.Stop(gap=1e-3, contact=law) for law in laws])
    compare(several, on_stops([1e-3]))


def test_points_that_move_in_proportion_share_by_their_shapes() -> None:
    """Stops at two points of a lever close together; at rest their forces are in proportion to the motions of the points."""
    lever = rb.Modal(frequencies=[11.0], damping_ratio=0.02, shapes={"near": [0.5], "far": [1.5]}, velocity=[0.2])
    law = rb.Linear(contact_time="1 ms", restitution=0.6)
    stops = [rb.Stop(point="near", gap=1e-3, contact=law), rb.Stop(point="far", gap=3e-3, contact=law)]
    several, one = (
        on_stops([], structure=lever, stops=some, load=PRESS.model_copy(update={"point": "far"}))
        for some in (stops, stops[1:])
    )
    times = one.arrays.time
    moved = np.interp(times, several.arrays.time, several.arrays.displacement[:, 0])
    assert np.abs(moved - one.arrays.displacement[:, 0]).max() < 1e-12 * np.abs(moved).max()
    at_rest = (several.arrays.time > 0.8) & (several.arrays.time < 0.95)
    near, far = several.arrays.cavity_force[at_rest].T
    assert near == pytest.approx(far / 3, rel=1e-12)
    alone = np.interp(several.arrays.time, times, one.arrays.cavity_force[:, 0])[at_rest]
    assert far + near / 3 == pytest.approx(alone, rel=1e-9)


@pytest.mark.parametrize("at", [-0.4, 0.0, 0.4])
def test_rigid_bar_on_three_stops_carries_a_load(at: float) -> None:
    """A bar that a load presses on three stops rests on them: forces and moments balance, and no stop pulls.

    Its three forces are not unique, because the bar has two motions only.
    """
    bar = rb.Modal(
        frequencies=[9.0, 14.0],
        damping_ratio=0.02,
        shapes={"left": [1.0, -1.0], "middle": [1.0, 0.0], "right": [1.0, 1.0], "load": [1.0, at]},
    )
    law = rb.Linear(contact_time="1 ms", restitution=0.5)
    stops = [rb.Stop(point=point, gap=0, contact=law) for point in ("middle", "left", "right", "left")]
    run = on_stops([], structure=bar, stops=stops, load=PRESS.model_copy(update={"point": "load"}))
    rests = (run.arrays.time > 0.8) & (run.arrays.time < 0.95)
    force = run.arrays.cavity_force[rests]
    assert force.max() <= 1e-12
    assert force.sum(axis=1) == pytest.approx(-30.0, rel=1e-9)
    assert force @ [0, -1, 1, -1] == pytest.approx(-30.0 * at, rel=1e-9, abs=1e-9)
    assert run.arrays.stop_gap.min() > -1e-15


def test_point_between_two_stops_without_clearance_stays() -> None:
    """A point that stops hold on both sides does not move under any load, though other points do.

    Speeds of rounding bounced between both stops without end, or a contact began at a gap of 1e-60 m.
    """
    structure = rb.Matrices(
        M=np.diag([0.9, 1.6]), K=[[5e4, -2e4], [-2e4, 4e4]], points={"held": 0, "free": 1}, damping_ratio=0.01
    )
    law = rb.Linear(contact_time="1 ms", restitution=0.8)
    stops = [rb.Stop(point="held", gap=0, side=side, contact=law) for side in ("leading", "trailing", "leading")]
    run = on_stops(
        [],
        structure=structure,
        stops=stops,
        load=rb.Harmonic(amplitude=50.0, frequency=17.0, point="free"),
        base=rb.Harmonic(amplitude=9.0, frequency=23.0),
    )
    assert np.abs(run.arrays.displacement[:, 0]).max() < 1e-16
    assert np.abs(run.arrays.displacement[:, 1]).max() > 1e-4


def random_case(rng: np.random.Generator) -> Any:
    """Return a structure with hard stops of equal or nearly equal gaps at one point or several, perhaps with a ball."""
    size, rate = 10 ** rng.uniform(-4, -2.5), rng.uniform(3, 40)
    gap = 0.0 if rng.random() < 0.5 else size * rng.uniform(0.1, 1.5)

    def near(value: float) -> float:
        choices = [
            value,
            value,
            float(np.nextafter(value, 1.0)) if value else 0.0,
            value * (1 + 10 ** rng.uniform(-15, -9)),
        ]
        return float(choices[rng.integers(4)])

    laws = [rb.Linear(contact_time="1 ms", restitution=float(e)) for e in rng.choice([0.01, 0.3, 0.6, 0.9], 5)]
    kind = int(rng.integers(4))
    shapes = {"left": [1.0, -1.0], "middle": [1.0, 0.0], "right": [1.0, 1.0]}
    stiffness = (2 * np.pi * rate) ** 2 * np.array([[1.5, -0.6], [-0.6, 0.9]])
    structure, points = (
        (rb.SDOF(mass=1.3, frequency=rate, damping_ratio=0.02), [None]),
        (
            rb.Modal(frequencies=[rate, 1.7 * rate], damping_ratio=0.01, shapes=shapes, participation=[1.0, 0.2]),
            [*shapes],
        ),
        (rb.Matrices(M=np.diag([1.1, 0.6]), K=stiffness, points={"a": 0, "b": 1}, damping_ratio=0.01), ["a", "b"]),
        (
            rb.Beam(
                length=0.3,
                width="30 mm",
                height="3 mm",
                material="steel",
                mode_count=3,
                damping_ratio=0.02,
                points={"tip": 0.3},
            ),
            ["tip"],
        ),
    )[kind]

    def stop(index: int) -> Any:
        point, side = points[rng.integers(len(points))], str(rng.choice(["leading", "leading", "trailing"]))
        return rb.Stop(point=point, gap=near(gap), side=side, contact=laws[index])

    stops = [stop(index) for index in range(int(rng.integers(2, 5)))]
    if kind == 2 and rng.random() < 0.5:
        stops.append(rb.Stop(point="a", other="b", gap=near(gap), contact=laws[4]))
    push = size * (2 * np.pi * rate) ** 2 * rng.uniform(0.3, 3)
    load: Any = rb.Harmonic(amplitude=push, frequency=rate * rng.uniform(0.1, 1.5), point=points[0])
    if rng.random() < 0.5:
        load = rb.Record(times=[0, 0.1, 0.2, 0.3, 0.4], values=[0, push, push, -push, push], unit="N", point=points[0])
    parts: dict[str, Any] = {"load": load} if rng.random() < 0.6 else {}
    if not parts or rng.random() < 0.4:
        parts["base"] = rb.Harmonic(amplitude=push, frequency=rate * rng.uniform(0.2, 1.5))
    if rng.random() < 0.3:
        ball = rb.Sphere(radius=8e-3, material="steel")
        parts["damper"] = rb.ImpactDamper(
            ball=ball, gap=near(max(gap, 0.3 * size)), point=points[0], contact=rb.Tsuji(restitution=0.5)
        )
    return rb.Case(
        structure=structure,
        stops=stops,
        duration=0.4,
        method=rb.Newton(max_events=100_000),
        output=rb.Output(rate=500.0),
        **parts,
    )


def count_failures(seeds: range) -> list[Any]:
    """Return the seeds whose runs do not reach their end, or overlap, with the reason."""
    failures = []
    for seed in seeds:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            run = rb.simulate(random_case(np.random.default_rng(seed)))
        overlap = -run.arrays.stop_gap.min()
        if not run.ok or overlap > 1e-12 * max(np.abs(run.arrays.displacement).max(), 1e-3):
            failures.append((seed, run.status, overlap, run.counts))
    return failures


def test_random_structures_with_equal_stops_reach_their_end() -> None:
    """Random structures with stops of equal or nearly equal gaps: each run ends, its energy closes, and nothing overlaps.

    Random stops were drawn with gaps of their own, so that two of them never closed together.
    """
    assert count_failures(range(60)) == []


@pytest.mark.slow
def test_thousand_random_structures_with_equal_stops() -> None:
    """The same of a thousand structures."""
    assert count_failures(range(60, 1060)) == []
