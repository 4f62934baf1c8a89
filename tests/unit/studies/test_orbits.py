"""Periods and attractors of motions from their strobes."""

import numpy as np

from rattlebox.studies.orbits import attractors, period_of


def orbit(*points, turns=24, shift=0, blur=0.0, seed=0):
    """Return noisy strobes of an orbit through some points, from the point with index `shift`."""
    points = np.roll(np.array(points, dtype=float), -shift, axis=0)
    strobes = np.resize(points, (turns, points.shape[1]))
    return strobes + blur * np.random.default_rng(seed).uniform(-1, 1, strobes.shape)


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
    period, residual = period_of(strobes, 1e-4)
    assert period.tolist() == [1, 2, 3, 0, 2, 0]
    assert residual[0] == 0
    assert 0 < residual[4] < 2e-5
    assert residual[3] > 1e-4


def test_longest_period_is_half_of_the_strobes():
    """A period is accepted only if the strobes cover it twice."""
    points = [[k, 0] for k in range(6)]
    assert period_of(orbit(*points, turns=11), 1e-4)[0] == 0
    assert period_of(orbit(*points, turns=12), 1e-4)[0] == 6


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
    period, residual = period_of(strobes, 1e-4)
    label, best = attractors(strobes, period, residual, 1e-2)
    assert label.tolist() == [3, 1, 1, 0, 1, 2]
    assert best[0] == 2


def test_the_number_of_attractors_is_limited():
    """At most 256 attractors are distinguished; other starts have no attractor."""
    strobes = np.stack([orbit([k, 0]) for k in range(300)])
    label, best = attractors(strobes, *period_of(strobes, 1e-4), 1e-2)
    assert len(best) == 256
    assert np.sum(label == 0) == 44
    assert sorted(label[label > 0].tolist()) == list(range(1, 257))


def test_without_periodic_motion():
    """Without periodic motion there is no attractor."""
    strobes = np.random.default_rng(1).uniform(-1, 1, (3, 24, 2))
    label, best = attractors(strobes, *period_of(strobes, 1e-4), 1e-2)
    assert label.tolist() == [0, 0, 0]
    assert best.size == 0
