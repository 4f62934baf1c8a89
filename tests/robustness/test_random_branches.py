"""Branches of periodic motions of random cases: no exception but those of Rattlebox, no NaN, multipliers that fit."""

import contextlib
import itertools
import warnings

import numpy as np
import pytest

import rattlebox as rb

ON_CIRCLE = 1e-6
"""Largest distance of the multiplier of a located point from the value that its kind has."""


def random_case(rng):
    """Return a case with dampers or stops, hard or soft contacts, and a parameter with its value."""
    size, omega = 10 ** rng.uniform(-3.5, -2.5), 2 * np.pi * rng.uniform(5, 40)
    e, is_hard = float(rng.choice([0.0, 0.3, 0.6, 0.9])), rng.random() < 0.7
    gaps = size * rng.uniform(0.3, 2.0, 2)

    def damper(name, gap):
        ball = rb.Sphere(radius=float(rng.uniform(5e-3, 15e-3)), material="steel")
        return rb.ImpactDamper(name=name, ball=ball, gap=float(gap), contact=rb.Tsuji(restitution=max(e, 0.3)))

    count = int(rng.integers(0, 3))
    parts = {"dampers": [damper(f"damper {k}", gaps[k]) for k in range(count)]}
    if count == 0:
        parts = {"stop": rb.Stop(gap=float(gaps[0]), contact=rb.Linear(stiffness=1e6, restitution=max(e, 0.3)))}
    frequency = float(omega / (2 * np.pi) * rng.uniform(0.7, 1.4))
    case = rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=omega**2, damping_ratio=float(rng.uniform(0.01, 0.08))),
        load=rb.Harmonic(amplitude=float(size * omega**2 * rng.uniform(0.05, 0.5)), frequency=frequency),
        method=rb.Newton(restitution=e) if is_hard else rb.EventDriven(),
        duration=80 / frequency,
        output=rb.Output(times=[0.0]),
        **parts,
    )
    axis = str(rng.choice(["load.frequency", "stop.gap" if count == 0 else "dampers[0].gap"]))
    return case, axis, frequency if axis == "load.frequency" else float(gaps[0])


def off_circle(kind, values):
    """Return the distance of the nearest multiplier from its value at a special point."""
    if kind in ("fold", "pitchfork"):
        return np.abs(values - 1).min()
    if kind == "flip":  # +1 over twice the period, where the branch with this period begins
        return min(np.abs(values + 1).min(), np.abs(values - 1).min())
    return np.abs(np.abs(values[np.abs(values.imag) > 0]) - 1).min() if kind == "torus" else 0.0


@pytest.mark.parametrize("seed", range(6))
def test_random_branches(seed):
    """A random motion is followed without NaN, and located points have the multipliers of their kind.

    Special points were tested on a few chosen dampers only; in random ones folds and flips were named where the sequence of
    impacts changes, and a search went to frequencies below zero.
    """
    case, axis, value = random_case(np.random.default_rng(seed))
    with warnings.catch_warnings(), contextlib.suppress(rb.RattleboxError):
        warnings.simplefilter("error", RuntimeWarning)
        branch = rb.continue_orbit(rb.find_orbit(case), axis, (0.85 * value, 1.2 * value), points=25, progress=False)
        check(branch.data)


def assert_is_complete(data):
    """Fail if a branch leaves its limits, or turns or changes its stability without a special point there."""
    low, high = data.attrs["limits"]
    value, special = data.value.values, data.special.values.astype(str)
    assert value.min() >= low * (1 - 1e-12) and value.max() <= high * (1 + 1e-12)
    ordinary = np.flatnonzero(special == "")
    stable = data.stable.values.astype(bool)
    for before, after in itertools.pairwise(ordinary):
        assert stable[before] == stable[after] or after - before > 1, f"stability changes before point {after}"
    for first, middle, last in zip(ordinary, ordinary[1:], ordinary[2:], strict=False):
        turns = (value[middle] - value[first]) * (value[last] - value[middle]) < 0
        assert not turns or last - first > 2, f"the branch turns at point {middle}"


def check(data):
    """Fail if a number is missing, or a located point has another multiplier than its kind."""
    for name in ("value", "amplitude", "multiplier_real", "multiplier_imaginary", "state"):
        assert np.isfinite(data[name].values).all(), name
    for row in np.flatnonzero(data.special.values.astype(str) != ""):
        values = data.multiplier_real.values[row] + 1j * data.multiplier_imaginary.values[row]
        assert np.isfinite(data.located.values[row])
        assert off_circle(str(data.special.values[row]), values) < ON_CIRCLE
    assert_is_complete(data)
    known = data.determinant_error.values[np.isfinite(data.determinant_error.values)]
    assert known.size == 0 or known.max() < 1e-6
