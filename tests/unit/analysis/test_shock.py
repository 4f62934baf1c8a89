"""Shock response spectra against closed forms."""

import math

import numpy as np
import pytest
import xarray
from scipy.integrate import solve_ivp

from rattlebox.analysis import shock_response_spectrum


def half_sine(duration, rate, total):
    """Return times and a half sine of amplitude 1."""
    time = np.arange(round(total * rate) + 1) / rate
    return time, np.where(time < duration, np.sin(math.pi * time / duration), 0.0)


def exact_half_sine(ratio):
    """Return the undamped maximax over the amplitude; ratio is frequency times duration of the pulse."""
    k = 2 * ratio
    residual = 2 * abs(math.cos(math.pi * ratio) / (1 / k - k)) if abs(k - 1) > 1e-9 else math.pi / 2
    primary = 0.0
    if k > 1:
        # During the pulse: (sin(x) - sin(k x) / k) / (1 - 1 / k^2), largest where cos(x) = cos(k x).
        turns = np.concatenate([2 * math.pi * np.arange(1, 40) / (k + s) for s in (1, -1)])
        turns = turns[(turns > 0) & (turns <= math.pi)]
        primary = max(((np.sin(turns) - np.sin(k * turns) / k) / (1 - 1 / k**2)).max(), 0.0) if turns.size else 0.0
    return max(primary, residual)


@pytest.mark.parametrize("ratio", [0.1, 0.3, 0.5, 0.8, 1.0, 1.5, 2.5, 4.0])
def test_half_sine(ratio):
    """The undamped spectrum of a half sine is that of its closed form, during and after the pulse."""
    duration = 0.011
    time, pulse = half_sine(duration, 50_000.0, 0.02)
    result = shock_response_spectrum(time, pulse, [ratio / duration], damping_ratio=0.0)
    assert float(result.maximax[0]) == pytest.approx(exact_half_sine(ratio), rel=1e-3)


def test_default_frequencies():
    """By default twelve frequencies an octave reach from one period in the record to a tenth of the sampling rate."""
    result = shock_response_spectrum(*half_sine(0.011, 2000.0, 0.5)).frequency.values
    assert result[0] == pytest.approx(2.0)
    np.testing.assert_allclose(result[1:] / result[:-1], 2 ** (1 / 12))
    assert result[-1] <= 200.0 < result[-1] * 2 ** (1 / 12)


def test_limits():
    """A stiff oscillator has the acceleration of the base; a soft one swings freely after the velocity step of the pulse."""
    time, pulse = half_sine(0.011, 50_000.0, 0.05)
    result = shock_response_spectrum(time, pulse, [0.02, 4000.0], damping_ratio=0.05)
    assert float(result.positive[1]) == pytest.approx(1.0, rel=2e-3)
    # The soft one is thrown with the velocity step 2 T / pi and swings to v / w, less by its damping.
    speed, w = 2 * 0.011 / math.pi, 2 * math.pi * 0.02
    swing = speed / w * math.exp(-0.05 / math.sqrt(1 - 0.05**2) * math.acos(0.05))
    assert float(result.relative_displacement[0]) == pytest.approx(swing, rel=2e-3)


def test_a_random_record_against_an_integrator():
    """Damped peaks of a coarse random record are those of DOP853 over its straight lines."""
    rng = np.random.default_rng(3)
    time = np.arange(200) / 1000.0
    record = rng.normal(size=time.size)
    frequencies = np.array([7.0, 60.0, 310.0])
    result = shock_response_spectrum(time, record, frequencies, damping_ratio=0.03)
    for k, f in enumerate(frequencies):
        w, z = 2 * math.pi * f, 0.03
        end = time[-1] + 1.0 / f

        def motion(t, y, w=w, z=z):
            return [y[1], -np.interp(t, time, record, right=0.0) - 2 * z * w * y[1] - w * w * y[0]]

        fine = np.linspace(0, end, 40_000)
        y = solve_ivp(motion, (0, end), [0, 0], "DOP853", t_eval=fine, rtol=1e-9, atol=1e-14, max_step=5e-4).y
        absolute = -(2 * z * w * y[1] + w * w * y[0])
        assert float(result.maximax[k]) == pytest.approx(np.abs(absolute).max(), rel=1e-3)
        assert float(result.relative_displacement[k]) == pytest.approx(np.abs(y[0]).max(), rel=1e-3)


def test_direction():
    """A reversed record exchanges positive and negative."""
    time, pulse = half_sine(0.011, 20_000.0, 0.03)
    one, other = (shock_response_spectrum(time, s * pulse) for s in (1, -1))
    np.testing.assert_allclose(one.positive, other.negative)
    np.testing.assert_allclose(one.maximax, other.maximax)
    assert float(one.frequency[0]) == pytest.approx(1 / 0.03) and float(one.frequency[-1]) <= 2000.0


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"frequencies": [600.0]}, "Hz"),
        ({"frequencies": [-1.0]}, "frequencies"),
        ({"frequencies": [100.0], "damping_ratio": 1.0}, "damping_ratio"),
    ],
)
def test_bad_input(options, word):
    """The message names the argument that does not fit."""
    time = np.arange(100) / 1000.0
    with pytest.raises(ValueError, match=word):
        shock_response_spectrum(time, np.sin(time), **options)


def test_pseudo_velocity() -> None:
    """It is the displacement of the base times w for low oscillators, the peak acceleration over w for high ones."""
    time = np.arange(20_001) * 1e-5
    pulse = np.where(time < 0.01, 300 * np.sin(np.pi * time / 0.01), 0.0)
    labelled = xarray.DataArray(pulse, {"time": time}, attrs={"units": "m/s^2"})
    spectrum = shock_response_spectrum(time, labelled, [0.5, 80.0, 4000.0], damping_ratio=0.0)
    change = 300 * 2 * 0.01 / np.pi  # of the velocity
    assert float(spectrum.pseudo_velocity[0]) == pytest.approx(change, rel=2e-3)
    assert float(spectrum.pseudo_velocity[2]) == pytest.approx(300 / (2 * np.pi * 4000), rel=0.02)
    assert spectrum.pseudo_velocity.values == pytest.approx(
        2 * np.pi * spectrum.frequency.values * spectrum.relative_displacement.values, rel=1e-12
    )
    assert spectrum.pseudo_velocity.attrs["units"] == "m/s"
    in_g = shock_response_spectrum(time, labelled.assign_attrs(units="g"), [80.0])
    assert in_g.pseudo_velocity.attrs["units"] == "g s"
