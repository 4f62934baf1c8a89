"""Amplitude spectra of signals with exact amplitudes."""

import math

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import amplitude_spectrum

TIME = np.arange(1000) / 500.0  # 2 s: bins every 0.5 Hz


def sine(amplitude, frequency, phase=0.3):
    """Return a sine over TIME."""
    return amplitude * np.sin(2 * np.pi * frequency * TIME + phase)


@pytest.mark.parametrize(
    ("window", "allowed"),
    [
        *((name, 1e-13) for name in ("boxcar", "hann", "hamming", "blackman", "nuttall", "blackmanharris", "flattop")),
        # Windows other than sums of cosines: the negative frequency leaks a little into the bin.
        ("cosine", 2e-5),
        ("bartlett", 1e-13),
        (("kaiser", 14.0), 2e-8),
        (("tukey", 0.5), 1e-4),
    ],
)
def test_sine_on_a_bin_reads_its_amplitude(window, allowed):
    """A sine of 0.3 mm whose frequency lies on a bin has an amplitude of 0.3 mm with every window."""
    spectrum = amplitude_spectrum(TIME, sine(3e-4, 40.0), window=window)
    assert float(spectrum.sel(frequency=40.0)) == pytest.approx(3e-4, rel=allowed)
    assert float(spectrum.idxmax("frequency")) == 40.0


@pytest.mark.parametrize(("window", "scalloping"), [("boxcar", 0.637), ("hann", 0.849), ("flattop", 0.999)])
def test_sines_between_bins_have_the_scalloping_loss(window, scalloping):
    """The amplitudes of two sines midway between bins are reduced by the window's gain at half a bin."""
    spectrum = amplitude_spectrum(TIME, sine(3e-4, 40.25) + sine(1e-4, 120.25, 1.0), window=window)
    for frequency, amplitude in ((40.25, 3e-4), (120.25, 1e-4)):
        near = spectrum.sel(frequency=slice(frequency - 2, frequency + 2))
        assert float(near.max()) == pytest.approx(scalloping * amplitude, rel=0.02)


def test_padding_recovers_an_amplitude_between_bins():
    """Zero padding that places a bin on the frequency gives the exact amplitude and does not shift the peak."""
    spectrum = amplitude_spectrum(TIME, sine(3e-4, 40.25), padding=2)
    assert float(spectrum.frequency[1]) == 0.25
    assert float(spectrum.sel(frequency=40.25)) == pytest.approx(3e-4, rel=1e-6)


@pytest.mark.parametrize("samples", [1000, 999])
def test_mean_and_highest_frequency_are_not_doubled(samples):
    """The values at 0 Hz and at half the sampling rate are the absolute mean and the amplitude of an alternating signal."""
    time = TIME[:samples]
    spectrum = amplitude_spectrum(time, np.full(samples, -2.0), window="boxcar")
    assert float(spectrum[0]) == pytest.approx(2.0, rel=1e-14)
    if samples % 2 == 0:
        alternating = amplitude_spectrum(time, np.resize([3.0, -3.0], samples), window="boxcar")
        assert float(alternating[-1]) == pytest.approx(3.0, rel=1e-13)
        assert float(alternating.frequency[-1]) == 250.0


def test_result_has_units_and_window():
    """A spectrum has the unit of its signal, none for a plain array, and the name of the window."""
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=1.0, stiffness=1.0, damping=0.1, velocity=1.0),
            duration=50.0,
            output=rb.Output(rate=10.0),
        )
    )
    displacement = run.motion.displacement.isel(point=0)
    spectrum = amplitude_spectrum(run.motion.time, displacement, window="blackman")
    assert spectrum.attrs == {"units": "m", "long_name": "amplitude", "window": "blackman"}
    assert spectrum.frequency.attrs == {"units": "Hz", "long_name": "frequency"}
    assert amplitude_spectrum(TIME, sine(1.0, 3.0)).attrs["units"] == ""


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"window": "hanning-ish"}, "window is 'hanning-ish'.*hann"),
        ({"window": "kaiser"}, "window is 'kaiser'.*parameter"),
        ({"padding": 0}, "padding is 0.*at least 1"),
        ({"padding": math.inf}, "padding is inf.*whole"),
        ({"padding": "2"}, "padding is 2.*whole"),
        ({"padding": 1.5}, "padding is 1\\.5.*whole"),
        ({"time": np.concatenate([TIME[:-1], [5.0]])}, "evenly spaced.*Output"),
        ({"time": TIME[::-1]}, "time must increase"),
        ({"time": TIME[:-1]}, "values has 1000 samples, but time has 999"),
        ({"time": TIME[:3], "values": TIME[:3]}, "time has 3 samples.*at least 4"),
        ({"values": np.where(TIME == 1.0, np.nan, 0.0)}, r"values\[500\] is nan"),
        ({"values": np.ones((1000, 2))}, r"shape \(1000, 2\).*one signal"),
    ],
)
def test_bad_input_is_refused(change, message):
    """Bad input is refused with the argument, its value and the allowed values."""
    given = {"time": TIME, "values": sine(1.0, 40.0)} | change
    with pytest.raises(ValueError, match=message):
        amplitude_spectrum(given.pop("time"), given.pop("values"), **given)
