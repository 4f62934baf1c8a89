"""Settling times and reductions of signals whose answers are known."""

import numpy as np
import pytest

from rattlebox.analysis import peak_reduction, rms_reduction, settling_time

TIME = np.linspace(0, 10, 5001)


@pytest.mark.parametrize("band", [0.5, 0.05, 0.01])
def test_exponential_settles_at_the_logarithm_of_the_band(band):
    """exp(-t) enters the band at -ln(band), to the second order of the sampling step."""
    assert settling_time(TIME, np.exp(-TIME), band=band) == pytest.approx(-np.log(band), abs=TIME[1] ** 2)
    assert settling_time(TIME, -np.exp(-TIME), band=band) == pytest.approx(-np.log(band), abs=TIME[1] ** 2)


def test_time_counts_on_its_own_axis_and_may_be_uneven():
    """A record that begins later settles later, and uneven samples do as well as even ones."""
    uneven = 10 * np.linspace(0, 1, 5001) ** 2
    assert settling_time(uneven + 3.0, np.exp(-uneven)) == pytest.approx(3.0 + np.log(20), abs=1e-4)


def test_oscillation_settles_when_it_last_leaves_the_band():
    """The last crossing of the band counts, not the first, also between samples of opposite sign."""
    assert settling_time([0, 1, 2, 3, 4, 5], [1.0, 0.0, 0.8, 0.1, 0.0, 0.0], band=0.5) == pytest.approx(2 + 3 / 7)
    assert settling_time([0, 1, 2], [1.0, -0.25, 0.0], band=0.5) == pytest.approx(0.4)


def test_reference_other_than_the_peak():
    """Against the peak of the bare structure a smaller motion settles sooner, or was never out of the band."""
    assert settling_time(TIME, np.exp(-TIME), reference=4.0) == pytest.approx(np.log(5), abs=1e-5)
    assert settling_time(TIME, np.exp(-TIME), reference=40.0) == 0.0


def test_motion_that_never_settles_is_nan():
    """A signal that is outside the band at its end, or passes through it there, has no settling time."""
    for end in np.linspace(4, 10, 200):
        assert np.isnan(settling_time(TIME[end >= TIME], np.cos(TIME[end >= TIME]), band=0.5))


@pytest.mark.parametrize("decay", [0.03, 0.2, 1.0])
def test_a_record_of_any_length_gives_the_time_or_none(decay):
    """An oscillation that decays is settled when it is, and not while it may only pass through the band."""
    time = np.linspace(0, 150, 150_001)
    motion = np.exp(-decay * time) * np.cos(2 * time)
    settled = settling_time(time, motion)
    for stop in range(2000, time.size, 97):  # after a swing to either side
        result = settling_time(time[:stop], motion[:stop])
        expected = time[stop - 1] > settled + 0.6 * np.pi  # a swing and what decay adds
        assert result == pytest.approx(settled, rel=1e-12) if expected else np.isnan(result) or result == settled


def test_reductions():
    """A motion of a quarter of the size is reduced by three quarters, and a larger one negatively."""
    x = np.sin(2 * np.pi * TIME)
    assert peak_reduction(x, -0.25 * x) == pytest.approx(0.75)
    assert rms_reduction(x, 0.25 * x) == pytest.approx(0.75)
    assert rms_reduction(x, np.ones_like(x)) == pytest.approx(1 - np.sqrt(2), abs=1e-3)
    assert peak_reduction(x, 1.5 * x) == pytest.approx(-0.5)
    assert peak_reduction(x, [0.5]) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: settling_time([0, 1], [1, 0], band=0.0), r"band is 0\.0"),
        (lambda: settling_time([0, 1], [1, 0], reference=-1.0), r"reference is -1\.0"),
        (lambda: settling_time([0, 0], [1, 0]), r"time must increase, but time\[1\]"),
        (lambda: settling_time([0, 1], [1, np.nan]), r"values\[1\] is nan"),
        (lambda: peak_reduction([0.0, 0.0], [1.0]), "without is zero throughout"),
        (lambda: rms_reduction([1.0, 0.0], [1.0]), "with_damper has 1 samples, but without has 2"),
        (lambda: rms_reduction([1.0, np.inf], [1.0, 1.0]), r"without\[1\] is inf"),
    ],
)
def test_bad_input_is_named(call, message):
    """Bad input is refused with the argument and its value."""
    with pytest.raises(ValueError, match=message):
        call()
