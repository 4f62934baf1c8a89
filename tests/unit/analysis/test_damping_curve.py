"""Damping over amplitude of decays whose damping is known."""

import math

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

from rattlebox.analysis import damping_over_amplitude
from rattlebox.analysis.damping_curve import band_edges

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


def test_squares_of_a_linear_decay():
    """The integral of the squared envelope is the difference of its squares at the band's ends over 2 delta."""
    time = np.arange(0, 4, 1 / (40 * F0))
    values = np.exp(-0.02 * W0 * time) * np.cos(W0 * math.sqrt(1 - 0.02**2) * time)
    amplitudes = np.array([0.05, 0.1, 0.2])
    result = damping_over_amplitude(time, xr.DataArray(values, dims="time", attrs={"units": "m"}), amplitudes)
    assert result.squares.attrs["units"] == "(m)^2"
    edges = band_edges(amplitudes)
    np.testing.assert_allclose(result.squares, np.diff(edges**2) / (2 * 0.02 / math.sqrt(1 - 0.02**2)), rtol=2e-4)
    assert damping_over_amplitude(time, values, amplitudes).squares.attrs["units"] == ""


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
    """Above the start, below the end, and in the first two cycles nothing is given."""
    time = np.arange(0, 3, 1 / 500)
    result = damping_over_amplitude(time, np.exp(-0.02 * W0 * time) * np.cos(W0 * time), [0.005, 0.1, 0.4, 0.9, 2.0])
    assert np.isnan(result.damping_ratio.values).tolist() == [True, False, False, True, True]


@pytest.mark.parametrize("amplitudes", [[0.1], [0.2, 0.1], [0.0, 0.1], [-1.0, 1.0]])
def test_bad_amplitudes(amplitudes):
    """Amplitudes must rise from above zero."""
    time = np.arange(0, 3, 1 / 500)
    with pytest.raises(ValueError, match="amplitudes"):
        damping_over_amplitude(time, np.cos(W0 * time), amplitudes)
