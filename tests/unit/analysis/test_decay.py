"""Envelopes and damping ratios of decays whose damping is known."""

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import damping_ratio, decay_envelope

OMEGA = 2 * np.pi * 10.0
TIME = np.arange(0, 10, 1 / 2000)
METHODS = ("hilbert", "decrement")
RIPPLE = 3e-7
"""What the ripple of the Hilbert transformer, 1e-5 of the amplitude, lets through to the damping ratio."""


def free_decay(ratio, time=TIME):
    """Return the free decay of a linear oscillator from amplitude 1."""
    return np.exp(-ratio * OMEGA * time) * np.sin(OMEGA * np.sqrt(1 - ratio**2) * time + 0.4)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("ratio", [1e-4, 1e-3, 1e-2, 0.05, 0.1])
def test_linear_oscillator(method, ratio):
    """The damping ratio of a linear oscillator, slight to strong, is found at every amplitude, with the amplitude."""
    time = TIME[ratio * OMEGA * TIME < 12]
    result = damping_ratio(time, free_decay(ratio, time), method=method)
    np.testing.assert_allclose(result.damping_ratio, ratio, rtol=3e-5, atol=RIPPLE)
    np.testing.assert_allclose(result.amplitude, np.exp(-ratio * OMEGA * result.time), rtol=5e-5)
    assert float(result.amplitude[0] / result.amplitude[-1]) > (1.05 if ratio == 1e-4 else 1.7)


@pytest.mark.parametrize(("linear", "quadratic"), [(0.2, 3.0), (0.05, 2.0)])
def test_damping_that_grows_with_amplitude(linear, quadratic):
    """Hilbert and decrement agree with the exact law A' = -(a + b A) A, and with each other, at every amplitude."""
    amplitude = linear / ((linear + quadratic) * np.exp(linear * TIME) - quadratic)
    values = amplitude * np.cos(OMEGA * TIME)
    by = {method: damping_ratio(TIME, values, method=method) for method in METHODS}
    # The decrement averages over a cycle, in which the strongest decay here changes by a third.
    for method, allowed in (("hilbert", 2e-4), ("decrement", 5e-3)):
        rate = linear + quadratic * by[method].amplitude
        np.testing.assert_allclose(by[method].damping_ratio, rate / np.hypot(rate, OMEGA), rtol=allowed)
        np.testing.assert_allclose(by[method].amplitude, np.interp(by[method].time, TIME, amplitude), rtol=3e-5)
    common = by["decrement"].sel(time=slice(by["hilbert"].time[0], by["hilbert"].time[-1]))
    other = by["hilbert"].interp(time=common.time)
    np.testing.assert_allclose(common.damping_ratio, other.damping_ratio, rtol=5e-3)


@pytest.mark.parametrize("method", METHODS)
def test_dry_friction(method):
    """An amplitude that falls by the same step every cycle has a damping ratio of step/(2 pi amplitude)."""
    fall = 0.05  # per second
    result = damping_ratio(TIME, (1 - fall * TIME) * np.cos(OMEGA * TIME), method=method)
    np.testing.assert_allclose(result.damping_ratio, fall / (OMEGA * result.amplitude), rtol=1e-5, atol=RIPPLE)


def test_weak_end_does_not_feel_the_strong_start():
    """The envelope remains right where it has fallen by twelve orders of magnitude."""
    envelope = decay_envelope(TIME, free_decay(0.045))
    assert float(envelope[-1]) < 1e-11
    np.testing.assert_allclose(envelope, np.exp(-0.045 * OMEGA * envelope.time), rtol=5e-5)
    assert envelope.attrs == {"units": "", "long_name": "amplitude"}
    assert envelope.time.attrs == {"units": "s", "long_name": "time"}


def test_ends_are_trimmed():
    """The envelope omits two cycles at each end, the damping ratio three."""
    step, cycle = TIME[1], 0.1
    for result, lost in ((decay_envelope(TIME, free_decay(0.01)), 2), (damping_ratio(TIME, free_decay(0.01)), 3)):
        assert float(result.time[0]) == pytest.approx(lost * cycle, abs=2 * step)
        assert float(result.time[-1]) == pytest.approx(10.0 - lost * cycle, abs=3 * step)


@pytest.mark.parametrize("method", METHODS)
def test_noise_and_coarse_sampling(method):
    """Forty samples a cycle with noise of a thousandth still give the damping ratio to some per cent."""
    time = np.arange(0, 5, 1 / 400)
    noise = 1e-3 * np.random.default_rng(1).standard_normal(time.size)
    result = damping_ratio(time, free_decay(0.01, time) + noise, method=method)
    strong = result.damping_ratio[result.amplitude > 0.2]
    assert float(strong.mean()) == pytest.approx(0.01, rel=0.02)


@pytest.mark.parametrize("method", METHODS)
def test_simulated_oscillator(method):
    """The free decay of a simulated structure has the damping ratio of the case, in its unit."""
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=20.0, stiffness=80e3, damping_ratio=0.02, velocity=0.1),
            duration=4.0,
            output=rb.Output(rate=2000.0),
        )
    )
    result = damping_ratio(run.motion.time, run.motion.displacement.isel(point=0), method=method)
    np.testing.assert_allclose(result.damping_ratio, 0.02, rtol=3e-5)
    assert result.amplitude.attrs["units"] == "m"
    assert result.damping_ratio.attrs == {"units": "1", "long_name": "damping ratio"}


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (free_decay(0.01)[:1000], "cover 5 cycles"),
        (np.zeros(TIME.size), "do not oscillate"),
        (np.sin(2 * np.pi * 450 * TIME), "4.44 samples in a cycle"),
        (np.where(TIME == 1.0, np.inf, 0.0), "is inf"),
    ],
)
def test_bad_decay_is_refused(values, message):
    """A record that is too short, too coarse, still or broken is refused with the reason."""
    with pytest.raises(ValueError, match=message):
        decay_envelope(TIME[: values.size], values)


def test_bad_method_and_dead_signal_are_refused():
    """An unknown method and a signal that ends in zeros are refused with advice."""
    with pytest.raises(ValueError, match="'hilbert' or 'decrement'"):
        damping_ratio(TIME, free_decay(0.01), method="fit")
    with pytest.raises(ValueError, match=r"zero from 6.* s on"):
        damping_ratio(TIME, np.where(TIME < 6.0, free_decay(0.01), 0.0))
    with pytest.raises(ValueError, match="extremes"):
        damping_ratio(TIME, np.where(TIME < 0.1, free_decay(0.01), 0.0), method="decrement")


@pytest.mark.parametrize("samples", [5.2, 7.3, 10.3])
def test_decrement_of_few_samples(samples):
    """The decrement of a light damping is right to an eighth where a cycle has but five samples, and better above."""
    time = np.arange(0, 20, 0.1 / samples)
    result = damping_ratio(time, free_decay(1e-3, time), method="decrement")
    np.testing.assert_allclose(result.damping_ratio, 1e-3, atol=1e-3 / (8 if samples < 7 else 16))
    np.testing.assert_allclose(result.amplitude, np.exp(-1e-3 * OMEGA * result.time), rtol=5e-3)
