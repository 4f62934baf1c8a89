"""Laws of pairs in the 3-D engine, given or mixed; softening has the effects that the run reports."""

import math
import re
from typing import Any

import numpy as np
import pytest
from support import dem_cases
from support.dem_cases import Ball
from support.exact import oblique

import rattlebox as rb

SHOT, BEAD = Ball(2e-3, material="steel"), Ball(3e-3, material="glass")
HALF = 0.05
DT = 2e-8
LAWS: dict[str, tuple[float, float, float]] = {
    "all": (0.9, 0.30, 0.04),
    "walls": (0.8, 0.25, 0.03),
    "bead and bead": (0.4, 0.60, 0.10),
    "bead and wall": (0.5, 0.10, 0.02),
    "shot and bead": (0.7, 0.15, 0.05),
}
"""Restitution, friction and rolling resistance."""


def laws(name: str) -> dict[str, Any]:
    """Return laws as fields."""
    e, friction, rolling = LAWS[name]
    return {"contact": rb.Tsuji(restitution=e), "friction": friction, "rolling": rolling}


def entry(first: str, second: str, name: str) -> Any:
    """Return the laws of one pair."""
    return rb.PairLaws(between=(first, second), **laws(name))


def meeting(first: Ball, second: Ball | None, **table: Any) -> tuple[Any, ...]:
    """Return velocities and spins after an oblique impact of two balls, or of one and a wall, with both species present."""
    aside = (0.8 * HALF,) * 3
    gap = 5.5 * DT * 2.0
    if second is None:
        places = [(-HALF + first.radius + gap, 0, 0)]
        ways, spins = [(-2.0, 1.2, 0.3)], [(200, -300, 400)]
    else:
        places = [(0, 0, 0), (first.radius + second.radius + gap, 0, 0)]
        ways, spins = [(1.0, 0.8, -0.2), (-1.0, -0.4, 0.1)], [(200, -300, 400), (-100, 250, 50)]
    met = [ball for ball in (first, second) if ball is not None]
    here = [*met, *(ball for ball in (SHOT, BEAD) if ball not in met)]
    starts = [*zip(places, ways, spins, strict=True), *[(aside, (0, 0, 0), (0, 0, 0))] * (len(here) - len(met))]
    rows = sorted(zip(here, starts, strict=True), key=lambda row: row[0] is BEAD)
    fields = ("positions", "velocities", "spins")
    packing = rb.Positions(**{field: [start[n] for _, start in rows] for n, field in enumerate(fields)})
    species = [
        rb.Particles(name=name, material=ball.material, radius=ball.radius, count=sum(one is ball for one in here))
        for name, ball in (("shot", SHOT), ("bead", BEAD))
    ]
    damper = rb.ParticleDamper(
        particles=species, cavity=rb.Box(size=(2 * HALF,) * 3), packing=packing, gravity=(0, 0, 0), **table
    )
    slowest = max(dem_cases.contact_time(ball, None, 1.0) for ball in met)
    result = dem_cases.run(
        rb.Case(
            structure=rb.Fixed(),
            damper=damper,
            duration=4 * slowest,
            output=rb.Output(times=[4 * slowest]),
            method=rb.Dem(dt=DT),
        )
    )
    assert result.counts["first_touches_wall"] == (second is None)
    assert result.counts["first_touches_particle"] == (second is not None)
    return result.arrays.particles.velocity, result.arrays.particles.spin


PAIRS = {
    "shot and shot": (SHOT, SHOT, "all"),
    "bead and bead": (BEAD, BEAD, "bead and bead"),
    "shot and bead": (SHOT, BEAD, "shot and bead"),
    "shot and wall": (SHOT, None, "walls"),
    "bead and wall": (BEAD, None, "bead and wall"),
}


@pytest.mark.parametrize("pair", PAIRS)
def test_each_pair_has_its_laws(pair: str) -> None:
    """An impact in a damper with laws for pairs is the same as with these laws for all."""
    first, second, own = PAIRS[pair]
    table = meeting(
        first,
        second,
        **laws("all"),
        **{f"wall_{field}": law for field, law in laws("walls").items()},
        pairs=[
            entry("bead", "bead", "bead and bead"),
            entry("wall", "bead", "bead and wall"),
            entry("bead", "shot", "shot and bead"),
        ],
    )
    for ours, alone in zip(table, meeting(first, second, **laws(own)), strict=True):
        np.testing.assert_allclose(ours, alone, rtol=1e-12, atol=1e-12)
    other = meeting(first, second, **laws("walls" if own == "all" else "all"))
    assert np.abs(table[0] - other[0]).max() > 0.01


def test_mixed_pairs_have_the_mean_of_the_laws() -> None:
    """With a mixing rule the law of two species is the mean of the laws of each species."""
    mixed = meeting(SHOT, BEAD, **laws("all"), mixing="geometric", pairs=[entry("bead", "bead", "bead and bead")])
    e, friction, rolling = (math.sqrt(a * b) for a, b in zip(LAWS["all"], LAWS["bead and bead"], strict=True))
    alone = meeting(SHOT, BEAD, contact=rb.Tsuji(restitution=e), friction=friction, rolling=rolling)
    for ours, theirs in zip(mixed, alone, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("radii", [(2e-3, 2e-3), (2e-3, 6e-3), (6e-3, 6e-3), (2e-3, None), (6e-3, None)])
def test_a_ratio_of_stiffnesses_holds_for_every_pair(radii: tuple[float, float | None]) -> None:
    """With linear contacts of equal duration the tangential rebound of sticking pairs follows the ratio of stiffnesses."""
    first, second = radii
    ratio, lasts, speed, aside, half = 0.3, 1e-4, 0.05, 0.01, 0.1
    dt = lasts / 1000
    e, gap = oblique.sticking(ratio), 5.5 * dt * speed
    balls = [Ball(first, (half - first - gap, 0, 0), (speed, aside, 0))]
    if second is not None:
        balls = [
            Ball(first, (-first - gap / 2, 0, 0), (speed / 2, aside / 2, 0)),
            Ball(second, (second + gap / 2, 0, 0), (-speed / 2, -aside / 2, 0)),
        ]
    others = [Ball(2e-3, (0, half / 2, half / 2)), Ball(6e-3, (0, -half / 2, -half / 2))]  # so that the mean is neither
    result = dem_cases.run(
        dem_cases.case(
            [*balls, *others],
            dt=dt,
            steps=1020,
            cavity=rb.Box(size=(2 * half,) * 3),
            contact=rb.Linear(contact_time=lasts, restitution=1.0),
            friction=rb.LinearSpring(1e6, ratio=ratio),
            one_kind=True,
        )
    )
    arrays = result.arrays
    touches = [result.counts[f"first_touches_{partner}"] for partner in ("particle", "wall")]
    assert touches == [int(second is not None), int(second is None)]
    velocity, spin = arrays.particles.velocity, arrays.particles.spin[:, 2]
    sliding = velocity[0, 1] + spin[0] * first
    if second is not None:
        sliding += spin[1] * second - velocity[1, 1]
    assert sliding == pytest.approx(aside * (1 - 3.5 * (1 - e)), abs=0.01 * aside)


SOFTENED: dict[str, Any] = {
    "Hertz": rb.Tsuji(restitution=0.9),
    "Jackson-Green": rb.Tsuji(restitution=rb.JacksonGreen()),
    "Johnson": rb.Tsuji(restitution=rb.Johnson()),
    "yielding": rb.Thornton(),
    "linear": rb.Linear(stiffness=2e7, restitution=0.9),
}


@pytest.mark.parametrize("law", SOFTENED)
def test_softening_has_the_reported_effects(law: str) -> None:
    """Softened a hundredfold, a contact has the reported duration and overlap, and the same restitution."""
    ball, speed = Ball(3e-3), 0.5
    results = []
    for softening in (1.0, 100.0):
        time = dem_cases.contact_time(ball, None, speed) * softening**0.4
        case = dem_cases.head_on(
            ball,
            None,
            speed,
            dt=time / 800,
            phase=0.5,
            lasts=6 * time,
            contact=SOFTENED[law],
            softening=softening,
        )
        result = dem_cases.run(case)
        dem, last = dem_cases.dem_of(case)
        touching = 0
        for step in range(last + 1):
            dem.run(step)
            touching += dem.contacts(0).first.size > 0
        overlap = result.diagnostics["largest_overlap"]
        results.append((touching * case.method.dt, overlap, dem_cases.rebound(result)))
    (time, overlap, rebound), (longer, larger, after) = results
    match = re.search(r"last ([\d.]+) times as long, and overlap ([\d.]+) times as much", result.notes[1])
    assert match is not None
    assert longer / time == pytest.approx(float(match[1]), rel=0.01)
    assert larger / overlap == pytest.approx(float(match[2]), rel=0.002)
    assert after == pytest.approx(rebound, rel=1e-4)
