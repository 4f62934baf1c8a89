"""Densities, bands and transfer functions of signals whose values are known."""

import math

import numpy as np
import pytest
import xarray
from scipy.signal import cont2discrete, lfilter

from rattlebox.analysis import (
    band_levels,
    miles_rms,
    power_spectral_density,
    transfer_function,
    transmissibility,
)

RATE = 2000.0
TIME = np.arange(400_000) / RATE
NOISE = np.random.default_rng(7).normal(size=TIME.size)


def oscillator(base, frequency, damping_ratio, *, rate=RATE):
    """Return the absolute acceleration of an oscillator on a base, exact for straight lines."""
    w = 2 * math.pi * frequency
    b, a, _ = cont2discrete(([2 * damping_ratio * w, w * w], [1, 2 * damping_ratio * w, w * w]), 1 / rate, "foh")
    return lfilter(np.ravel(b), a, base)


def test_the_integral_of_the_density_is_the_variance():
    """White noise of variance 1 at 2 kHz has the density 1/1000 per Hz, with an interval that holds 95 % of the time."""
    result = power_spectral_density(TIME, NOISE, resolution=5.0)
    inner = result.sel(frequency=slice(10, 990))
    assert float(result.density.integrate("frequency")) == pytest.approx(1.0, rel=0.01)
    inside = (inner.lower < 1e-3) & (inner.upper > 1e-3)
    assert 0.9 < float(inside.mean()) < 0.99
    assert result.attrs["resolution"] == 5.0


@pytest.mark.parametrize("resolution", [None, 0.5, 20.0])
def test_the_interval_is_as_wide_as_the_estimate_scatters(resolution):
    """The coefficient of variation over frequencies is that of a chi-squared variable of the stated degrees of freedom."""
    result = power_spectral_density(TIME, NOISE, resolution=resolution)
    width = result.attrs["resolution"]
    inner = result.density.sel(frequency=slice(4 * width, 1000 - 4 * width))
    expected = math.sqrt(2 / result.attrs["degrees_of_freedom"])
    assert float(inner.std() / inner.mean()) == pytest.approx(expected, rel=0.35)


def test_units_of_densities_and_levels():
    """m/s^2 becomes (m/s^2)^2/Hz and m/s^2 again in bands; a plain array has no unit."""
    signal = xarray.DataArray(NOISE[:4000], dims="time", attrs={"units": "m/s^2"})
    result = power_spectral_density(TIME[:4000], signal)
    assert result.density.attrs["units"] == "(m/s^2)^2/Hz"
    assert band_levels(result.density).attrs["units"] == "m/s^2"
    assert power_spectral_density(TIME[:4000], NOISE[:4000]).density.attrs["units"] == ""


@pytest.mark.parametrize("fraction", [1, 3, 6, 12])
def test_a_flat_density_fills_each_band_by_its_width(fraction):
    """Bands of a flat density: mean squares are density times width, edges meet, and ten bands of a third are a decade."""
    flat = xarray.DataArray(np.full(40_001, 2.5), {"frequency": np.arange(40_001) / 10.0})
    levels = band_levels(flat, fraction=fraction)
    np.testing.assert_allclose(levels**2, 2.5 * (levels.upper - levels.lower), rtol=1e-12)
    np.testing.assert_allclose(levels.upper[:-1], levels.lower[1:], rtol=1e-12)
    if fraction == 3:
        names = levels.nominal.values.tolist()
        decade = ["100", "125", "160", "200", "250", "315", "400", "500", "630", "800", "1000", "1250"]
        assert names[names.index("100") :][:12] == decade
        assert "31.5" in names
        assert float(levels.sel(nominal="1000").band) == 1000.0
        assert float(levels.sel(nominal="100").band) == pytest.approx(100.0, rel=1e-12)


@pytest.mark.parametrize("spacing", [1.0, 0.4])
def test_a_rising_density_fills_each_band_by_its_integral(spacing):
    """Bands of a density that rises with frequency: mean squares are the integral, also between the frequencies given."""
    frequency = np.arange(4001) * spacing
    levels = band_levels(xarray.DataArray(3.0 * frequency, {"frequency": frequency}))
    np.testing.assert_allclose(levels**2, 1.5 * (levels.upper**2 - levels.lower**2), rtol=1e-12)


def test_bands_too_narrow_for_the_resolution_are_left_out():
    """With 10 Hz between frequencies the lowest third octave that holds four of them lies above 100 Hz."""
    levels = band_levels(power_spectral_density(TIME, NOISE, resolution=10.0).density)
    assert 100 < float(levels.band[0]) < 250
    with pytest.raises(ValueError, match="resolution"):
        band_levels(power_spectral_density(TIME[:100], NOISE[:100], resolution=500.0).density)


def test_the_transmissibility_of_an_oscillator():
    """H1 of the absolute acceleration on a noisy base is (1 + 2 i z r) / (1 - r^2 + 2 i z r); its coherence is one."""
    f0, z = 100.0, 0.05
    result = transmissibility(TIME, NOISE, oscillator(NOISE, f0, z), resolution=0.25).sel(frequency=slice(20, 140))
    r = result.frequency / f0
    exact = (1 + 2j * z * r) / (1 - r**2 + 2j * z * r)
    # The straight lines between samples take sinc^2 from the base from the base and so from the response.
    exact = exact * np.sinc(result.frequency / RATE) ** 2
    assert float(abs(result.transfer / exact - 1).max()) < 0.02
    assert float(result.coherence.min()) > 0.995


def test_noise_in_the_response_lowers_the_coherence_and_not_the_transfer_function():
    """Half of the response's power is noise: coherence 1/2, the gain stays, its scatter is the stated random error."""
    other = np.random.default_rng(8).normal(size=TIME.size)
    result = transfer_function(TIME, NOISE, 3 * (NOISE + other), resolution=5.0).sel(frequency=slice(20, 980))
    assert float(result.coherence.mean()) == pytest.approx(0.5, abs=0.03)
    assert float(result.transfer.real.mean()) == pytest.approx(3.0, rel=0.01)
    scatter = float(abs(result.transfer).std()) / 3
    assert scatter == pytest.approx(float(result.random_error.mean()), rel=0.25)


def test_miles():
    """The RMS of an oscillator on white noise is that of Miles' equation, and of the integral of its response."""
    f0, z = 50.0, 0.05
    response = oscillator(NOISE, f0, z)
    density = 2 / RATE  # variance one up to half the rate
    assert float(np.std(response)) == pytest.approx(miles_rms(f0, z, density), rel=0.03)
    f = np.linspace(0, 200 * f0, 2_000_001)
    r = f / f0
    gain = (1 + (2 * z * r) ** 2) / ((1 - r**2) ** 2 + (2 * z * r) ** 2)
    assert math.sqrt(np.trapezoid(gain, f) * density) == pytest.approx(miles_rms(f0, z, density), rel=1e-3)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: power_spectral_density(TIME[:100], NOISE[:100], resolution=1.0), "resolution"),
        (lambda: power_spectral_density(TIME[:100], NOISE[:100], resolution=-1.0), "resolution"),
        (lambda: power_spectral_density([0, 1, 3, *range(4, 20)], np.ones(19)), "evenly"),
        (lambda: transfer_function(TIME[:100], np.zeros(100), NOISE[:100]), "source"),
        (lambda: transfer_function(TIME[:100], NOISE[:100], NOISE[:100], resolution=20.0), "segment"),
        (lambda: transmissibility(TIME[:9], xarray.DataArray(NOISE[:9], attrs={"units": "m"}), NOISE[:9]), "quantity"),
        (lambda: band_levels(power_spectral_density(TIME, NOISE).density, fraction=2), "fraction"),
        (lambda: miles_rms(100.0, 0.0, 1.0), "damping_ratio"),
    ],
)
def test_bad_input(call, word):
    """The message names the argument that does not fit."""
    with pytest.raises(ValueError, match=word):
        call()
