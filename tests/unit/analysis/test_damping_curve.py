"""Damping over amplitude of decays whose damping is known."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rattlebox.analysis import damping_over_amplitude

F0 = 12.0
W0 = 2 * math.pi * F0


@pytest.mark.parametrize("ratio", [0.001, 0.02, 0.1])
@pytest.mark.parametrize("shift", [0.0, 3.0])
def test_linear_decay(ratio, shift):
    """A linear decay about any rest position has its ratio and frequency at every amplitude that it passes."""
    time = np.arange(0, 8 / (ratio * W0), 1 / (40 * F0))
    damped = W0 * math.sqrt(1 - ratio**2)
    result = damping_over_amplitude(
        time, shift + np.exp(-ratio * W0 * time) * np.cos(damped * time), np.geomspace(0.01, 0.1, 4)
    )
    np.testing.assert_allclose(result.damping_ratio, ratio, rtol=2e-4)
    np.testing.assert_allclose(result.frequency, damped / (2 * math.pi), rtol=2e-4)


@pytest.mark.parametrize("end", [1.5, 3.0, 6.0])
def test_the_length_of_the_record_is_irrelevant(end):
    """A decay whose frequency rises as it falls has the same ratios and times in records of any length."""
    time = np.arange(0, end, 1 / (40 * F0))
    decay, chirp = np.exp(-0.02 * W0 * time), W0 * (time - 0.02 * 0.3 * (1 - np.exp(-time / 0.3)))
    result = damping_over_amplitude(time, 2.0 + decay * np.cos(chirp), [0.15, 0.2, 0.25, 0.3])
    np.testing.assert_allclose(result.damping_ratio, 0.02 * W0 / (2 * math.pi * result.frequency), rtol=1e-3)
    np.testing.assert_allclose(result.end[1], -math.log(0.2 * math.sqrt(0.2 / 0.25)) / (0.02 * W0), rtol=1e-3)


def test_a_ripple_does_not_shift_the_bands():
    """Harmonics that impacts leave in the motion change the ratio of narrow bands by less than 0.1 %."""
    time = np.arange(0, 6, 1 / (40 * F0))
    decay = np.exp(-0.002 * W0 * time)
    ripple = 1 + 0.05 * np.cos(2 * W0 * time + 0.3) + 0.02 * np.cos(4 * W0 * time)
    result = damping_over_amplitude(time, decay * ripple * np.cos(W0 * time), np.geomspace(0.5, 0.7, 8))
    np.testing.assert_allclose(result.damping_ratio, 0.002, rtol=1e-3)


def test_coulomb_friction():
    """Friction of force mu takes 4 mu / k from the amplitude in a cycle: ratio 2 mu / (pi k A)."""
    friction = 0.01  # over the stiffness

    def motion(_, y):
        return [y[1], -(W0**2) * (y[0] + friction * math.tanh(y[1] / (1e-4 * W0)))]

    time = np.arange(0, 20 / F0, 1 / (60 * F0))
    z = solve_ivp(motion, (0, time[-1]), [1.0, 0.0], "LSODA", t_eval=time, rtol=1e-9, atol=1e-12).y[0]
    amplitudes = np.array([0.4, 0.5, 0.6, 0.7])
    result = damping_over_amplitude(time, z, amplitudes)
    np.testing.assert_allclose(result.damping_ratio, 2 * friction / (math.pi * amplitudes), rtol=0.03)


def test_amplitudes_that_the_decay_does_not_pass_are_nan():
    """The curve is NaN above the start, below the end, and in the first two cycles."""
    time = np.arange(0, 3, 1 / 500)
    result = damping_over_amplitude(time, np.exp(-0.02 * W0 * time) * np.cos(W0 * time), [0.005, 0.1, 0.4, 0.9, 2.0])
    assert np.isnan(result.damping_ratio.values).tolist() == [True, False, False, True, True]


@pytest.mark.parametrize("amplitudes", [[0.1], [0.2, 0.1], [0.0, 0.1], [-1.0, 1.0]])
def test_bad_amplitudes(amplitudes):
    """Amplitudes must rise from above zero."""
    time = np.arange(0, 3, 1 / 500)
    with pytest.raises(ValueError, match="amplitudes"):
        damping_over_amplitude(time, np.cos(W0 * time), amplitudes)
