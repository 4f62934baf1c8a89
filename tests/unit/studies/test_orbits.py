"""Periods, transients and attractors of motions from their strobes."""

import numpy as np
import pytest

from rattlebox.studies.work.reductions import Motion, attractors, classify, unsettled


def orbit(*points, turns=24, shift=0, blur=0.0, seed=0):
    """Return noisy strobes of an orbit through some points, from the point with index `shift`."""
    points = np.roll(np.array(points, dtype=float), -shift, axis=0)
    strobes = np.resize(points, (turns, points.shape[1]))
    return strobes + blur * np.random.default_rng(seed).uniform(-1, 1, strobes.shape)


def linear(factors, amplitude, turns, rng):
    """Return strobes that come closer to a point by linear maps with pairs of complex factors, seen through a mixture."""
    k = np.arange(turns)
    modes = np.stack([part for f in factors for part in (np.real(f**k), np.imag(f**k))], axis=1)
    strobes = modes @ rng.normal(size=(modes.shape[1], 4))
    return rng.uniform(-1, 1, 4) + amplitude * strobes / np.abs(strobes).max()


def groups(strobes, apart=1e-2):
    """Return the attractors of motions whose range is one."""
    result = classify(strobes, 1e-4, apart)
    return attractors(strobes, np.ones((len(strobes), strobes.shape[2])), result.period, result.residual, apart)


@pytest.mark.parametrize("turns", [8, 16, 32, 48])
def test_a_slow_spiral_has_no_period_of_its_turns(turns):
    """None of 800 spirals into a point, with random angles, factors and sizes, has a period above one.

    The smallest number of cycles with a difference below the tolerance was taken for the period, which is the number in
    which a small spiral turns round; tests had orbits with noise, but none that still contracted.
    """
    rng = np.random.default_rng(turns)
    turn, factor = rng.uniform(0.02, np.pi, 800), rng.uniform(0.5, 0.9999, 800)
    size = 10.0 ** rng.uniform(-9, -1, 800)
    strobes = np.stack(
        [linear([f * np.exp(1j * t)], a, turns, rng) for f, t, a in zip(factor, turn, size, strict=True)]
    )
    result = classify(strobes, 1e-4, 1e-2)
    assert set(result.period.tolist()) <= {0, 1}
    # The end of the spiral is within the tolerance, or nearly so: the distance is known within a small factor.
    end = size * factor**turns
    assert not (result.period[end > 2e-3] == 1).any()
    if turns >= 16:
        seen = (factor > 0.9) & (size > 1e-6) & (end > 1e-3) & (turn > 0.3)
        assert np.mean(result.motion[seen] == Motion.TRANSIENT) > 0.97
        known = seen & (result.motion == Motion.TRANSIENT)
        np.testing.assert_allclose(result.multiplier[known], factor[known], atol=0.01)


def test_two_spirals_at_once():
    """A point that is approached by two complex pairs of factors has no period above one."""
    rng = np.random.default_rng(3)
    strobes = []
    for _ in range(400):
        factors = rng.uniform(0.7, 0.995, 2) * np.exp(1j * rng.uniform(0.1, np.pi, 2))
        strobes.append(linear(factors, 10.0 ** rng.uniform(-5, -1), 32, rng))
    assert set(classify(np.stack(strobes), 1e-4, 1e-2).period.tolist()) <= {0, 1}


def test_a_creeping_motion_is_not_at_rest():
    """A motion that creeps by less than the tolerance in each cycle, but is far from its limit, is transient."""
    k = np.arange(48)
    strobes = np.stack([5e-2 * factor ** k[:, None] * [1.0, 0.3] for factor in (0.9995, 0.999, 0.99)])
    result = classify(strobes, 1e-4, 1e-2)
    assert result.motion.tolist() == [Motion.TRANSIENT] * 3
    assert result.multiplier == pytest.approx([0.9995, 0.999, 0.99], abs=1e-6)


@pytest.mark.parametrize("turns", [16, 32, 48])
def test_quasi_periodic_motion_has_no_period(turns):
    """Of 500 motions round a closed curve none has a period."""
    rng = np.random.default_rng(turns)
    k = np.arange(turns)
    strobes = []
    for _ in range(500):
        angle = 2 * np.pi * (rng.uniform(0.02, 0.5) * k + rng.uniform())
        bend = rng.uniform(0, 0.5)
        curve = np.stack([np.cos(angle) + bend * np.cos(2 * angle), np.sin(angle)], axis=1)
        strobes.append(10.0 ** rng.uniform(-1.9, -0.3) * curve)
    result = classify(np.stack(strobes), 1e-4, 1e-2)
    assert np.count_nonzero(result.period) <= 1  # a turn of a rational number of cycles, to 1e-5
    assert np.mean(result.motion == Motion.TRANSIENT) < 0.02


def test_the_periods_of_the_logistic_map():
    """Over 1000 parameters of the logistic map no period is wrong, and most parameters off the thresholds have theirs.

    The truth is the period after 200 000 cycles. Just above a doubling half of it may be found, since states within
    `apart` count as one.
    """
    parameter = np.linspace(2.9, 3.7, 1000)
    x = np.full_like(parameter, 0.4)
    for _ in range(400):
        x = parameter * x * (1 - x)
    window = []
    for _ in range(48):
        x = parameter * x * (1 - x)
        window.append(x)
    for _ in range(200_000):
        x = parameter * x * (1 - x)
    long = []
    for _ in range(48):
        x = parameter * x * (1 - x)
        long.append(x)
    long = np.array(long).T
    close = np.stack([np.abs(long[:, n:] - long[:, :-n]).max(axis=1) < 1e-9 for n in range(1, 25)])
    truth = np.where(close.any(axis=0), close.argmax(axis=0) + 1, 0)
    states = np.array(window).T[..., None] * [1.0, -0.7]
    result = classify(states, 1e-4, 1e-2)
    found = result.period > 0
    assert (truth[found] % result.period[found] == 0).all()
    assert np.count_nonzero(result.period[found] != truth[found]) <= 3
    assert np.mean(found[truth > 0]) > 0.9
    assert np.mean(result.motion[truth == 0] == Motion.IRREGULAR) > 0.97


def test_states_within_the_merging_distance_are_one():
    """A motion whose states differ by less than `apart` has the smaller period; with a smaller `apart` the true one."""
    strobes = orbit([0, 0], [5e-3, 0], [0.3, 0], [0.305, 0])[None]
    assert classify(strobes, 1e-4, 1e-3).period == 4
    assert classify(orbit([0, 0], [5e-3, 0])[None], 1e-4, 1e-2).period == 1


def test_the_end_of_a_long_transient():
    """A motion that settles within the evaluated cycles is transient, as is one that leaves an unstable orbit irregular."""
    rng = np.random.default_rng(4)
    settling = np.where(np.arange(48)[:, None] < 14, rng.uniform(-1, 1, (48, 2)), 0.25)
    leaving = 1e-9 * 1.2 ** np.arange(48)[:, None] * [1.0, 0.5]
    result = classify(np.stack([settling, leaving]), 1e-4, 1e-2)
    assert result.motion.tolist() == [Motion.TRANSIENT, Motion.IRREGULAR]
    assert result.period.tolist() == [0, 0]


def test_the_advice_is_enough():
    """The number of cycles that the note proposes makes a spiral periodic."""
    rng = np.random.default_rng(5)
    for factor, angle in ((0.92, 1.29), (0.97, 0.4), (-0.95, 0.0), (0.99, 2.0)):
        path = linear([factor * np.exp(1j * angle)], 0.2, 4000, rng)
        early = classify(path[None, 20:52], 1e-4, 1e-2)
        note = unsettled(early, (20, 32), 1e-4)["unsettled"]
        skip = int(note.split("cycles = (")[1].split(",")[0])
        assert skip > 20
        assert classify(path[None, skip : skip + 32], 1e-4, 1e-2).period == 1


def test_period_is_the_least_number_of_cycles():
    """The period of a motion is the smallest number of cycles after which it repeats."""
    strobes = np.stack(
        [
            orbit([0, 0]),
            orbit([0, 0], [1, 0]),
            orbit([0, 0], [0, 1], [1, 0]),
            np.random.default_rng(1).uniform(-1, 1, (24, 2)),
            orbit([0, 0], [1, 0], blur=1e-5),
            np.full((24, 2), np.nan),
        ]
    )
    period, motion, _, residual = classify(strobes, 1e-4, 1e-2)
    assert period.tolist() == [1, 2, 3, 0, 2, 0]
    assert motion.tolist() == [1, 1, 1, 3, 1, 0]
    assert residual[0] == 0
    assert 0 < residual[4] < 2e-5
    assert residual[3] > 1e-4


def test_longest_period_is_half_of_the_strobes():
    """A period is accepted only if the strobes cover it twice."""
    points = [[k, 0] for k in range(6)]
    assert classify(orbit(*points, turns=11), 1e-4, 1e-2).period == 0
    assert classify(orbit(*points, turns=12), 1e-4, 1e-2).period == 6


def test_motions_of_one_orbit_are_one_attractor():
    """Strobes of one orbit with any phase and noise are one attractor; attractors are sorted by their share."""
    two, other = ([0, 0], [1, 0]), ([0, 0], [0, 1])
    strobes = np.stack(
        [
            orbit(*other, blur=1e-6),
            orbit(*two, blur=1e-5, seed=1),
            orbit(*two, shift=1),
            np.random.default_rng(1).uniform(-1, 1, (24, 2)),
            orbit(*two, blur=1e-5, seed=2),
            orbit([0, 0]),
        ]
    )
    label, best = groups(strobes)
    assert label.tolist() == [3, 1, 1, 0, 1, 2]
    assert best[0] == 2


def test_the_number_of_attractors_is_limited():
    """At most 256 attractors are distinguished; other starts have no attractor."""
    strobes = np.stack([orbit([k, 0]) for k in range(300)])
    label, best = groups(strobes)
    assert len(best) == 256
    assert np.sum(label == 0) == 44
    assert sorted(label[label > 0].tolist()) == list(range(1, 257))


def test_without_periodic_motion():
    """Without periodic motion there is no attractor."""
    strobes = np.random.default_rng(1).uniform(-1, 1, (3, 24, 2))
    label, best = groups(strobes)
    assert label.tolist() == [0, 0, 0]
    assert best.size == 0
