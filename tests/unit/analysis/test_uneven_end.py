"""Every analysis of a run accepts a duration that is no multiple of the sampling interval."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox import analysis
from rattlebox.analysis.signals import evenly_sampled

ANALYSES: dict[str, Callable[[Any, Any], Any]] = {
    "amplitude_spectrum": analysis.amplitude_spectrum,
    "damping_over_amplitude": lambda t, x: analysis.damping_over_amplitude(t, x, [2e-4, 3e-4, 5e-4]),
    "damping_ratio": analysis.damping_ratio,
    "decay_envelope": analysis.decay_envelope,
    "decrement": lambda t, x: analysis.damping_ratio(t, x, method="decrement"),
    "power_spectral_density": analysis.power_spectral_density,
    "shock_response_spectrum": analysis.shock_response_spectrum,
    "transfer_function": lambda t, x: analysis.transfer_function(t, x, 2 * x),
    "transmissibility": lambda t, x: analysis.transmissibility(t, x, 2 * x),
}


def random_runs(count: int) -> list[rb.Run]:
    """Return decays with random frequencies, sampling rates and durations, of about 30 cycles."""
    rng = np.random.default_rng(51)
    runs = []
    for _ in range(count):
        frequency = 10 ** rng.uniform(0, 3)
        structure = rb.SDOF(mass=2.3, frequency=frequency, damping_ratio=0.013, velocity=6e-3 * frequency)
        rate, duration = frequency * rng.uniform(12, 60), rng.uniform(28, 34) / frequency
        runs.append(rb.simulate(rb.Case(structure=structure, duration=duration, output=rb.Output(rate=rate))))
    return runs


@pytest.mark.parametrize("name", ANALYSES)
def test_the_end_of_a_run_is_treated_apart(name: str) -> None:
    """The end, after a shorter step, is not used. All earlier tests had durations of a whole number of steps."""
    for run in random_runs(12):
        time, motion = run.motion.time, run.motion.displacement.sel(point="mass")
        steps = np.diff(time.values)
        assert steps[-1] < 0.9999 * steps[0], "the last step of this run is not shorter"
        found, even = (ANALYSES[name](time[:end], motion[:end]) for end in (None, -1))
        assert found.identical(even)


def test_a_damping_ratio_is_that_of_the_structure() -> None:
    """The damping ratio of a linear structure is exact for any frequency, sampling rate and duration."""
    for run in random_runs(20):
        found = analysis.damping_ratio(run.motion.time, run.motion.displacement.sel(point="mass")).damping_ratio
        np.testing.assert_allclose(found, 0.013, rtol=2e-3)


@pytest.mark.parametrize("share", [1e-9, 1e-5, 0.003, 0.5, 0.97, 0.99999])
def test_which_samples_remain(share: float) -> None:
    """The last of the samples goes with a shorter last step of any length, and no sample goes from even times."""
    step, values = 0.0137, np.arange(41.0)
    even = 3.1 + step * np.arange(41)
    np.testing.assert_array_equal(evenly_sampled(even, values=values)[1], values)
    uneven = np.append(even[:-1], even[-2] + share * step)
    time, rest = evenly_sampled(uneven, values=values)
    np.testing.assert_array_equal(time, even[:-1])
    np.testing.assert_array_equal(rest, values[:-1])


@pytest.mark.parametrize("place", [0, 1, 20, -2])
@pytest.mark.parametrize("share", [0.4, 1.6])
def test_other_uneven_steps_are_refused(place: int, share: float) -> None:
    """A step of another length before the last one, or a longer last one, is refused: samples are missing there."""
    steps = np.full(40, 0.01)
    steps[place] *= share
    for uneven in (steps, np.append(np.full(40, 0.01), 0.01 * max(share, 1.01))):
        time = np.concatenate([[0.0], np.cumsum(uneven)])
        with pytest.raises(ValueError, match="evenly spaced, but its steps range"):
            evenly_sampled(time, values=np.zeros(time.size))


def test_too_few_samples_without_the_end() -> None:
    """A signal whose even part is too short is refused with the number of its even samples."""
    with pytest.raises(ValueError, match="time has 3 samples, but at least 4"):
        analysis.amplitude_spectrum([0.0, 1.0, 2.0, 2.5], np.zeros(4))


@pytest.mark.parametrize("begin", [0.0, -3.0, 40.0])
@pytest.mark.parametrize("name", ANALYSES)
def test_times_of_single_precision(name: str, begin: float) -> None:
    """Times that a logger stored with seven digits are even; all earlier tests had times of double precision."""
    time = begin + 2e-3 * np.arange(1500)
    motion = 1e-3 * np.exp(-2 * (time - begin)) * np.sin(2 * np.pi * 21 * (time - begin))
    rounded = ANALYSES[name](time.astype(np.float32), motion)
    exact = ANALYSES[name](time, motion)
    values, others = (each.to_array() if hasattr(each, "to_array") else each for each in (rounded, exact))
    np.testing.assert_allclose(values, others, rtol=2e-3, atol=2e-3 * float(abs(others).max()))


def test_masked_numbers_elsewhere_are_refused() -> None:
    """Means and measured rebounds refuse masked numbers, and the real part of a response leaves them out."""
    values = np.ma.masked_greater(np.linspace(0.2, 0.7, 64), 0.69)
    with pytest.raises(ValueError, match="finite numbers"):
        analysis.mean_interval(values)
    with pytest.raises(rb.CaseError, match="finite number"):
        rb.Drops(["1 m"] * 64, values)
    frequency = np.linspace(20, 40, 401)
    response = 1 / (30**2 - frequency**2 + 0.6j * frequency)
    whole = analysis.minimum_real_part(frequency, response)
    assert whole == analysis.minimum_real_part(frequency, np.ma.masked_array(response))
    peak = abs(frequency - 30) < 1
    assert 0 > analysis.minimum_real_part(frequency, np.ma.masked_where(peak, response)) > 0.8 * whole


def test_times_too_large_for_single_precision_are_refused() -> None:
    """A day after the start, single precision has steps of 8 ms, so that a step of 20 ms has no even times."""
    time = (86_400 + 0.02 * np.arange(400)).astype(np.float32)
    with pytest.raises(ValueError, match="evenly spaced"):
        evenly_sampled(time, values=np.zeros(400))


@pytest.mark.parametrize("name", ANALYSES)
def test_masked_samples_are_refused(name: str) -> None:
    """A sample that is masked, as an invalid one of a measurement, is refused and never taken for a number."""
    time = 2e-3 * np.arange(900)
    motion = np.ma.masked_array(1e-3 * np.sin(2 * np.pi * 21 * time), mask=np.arange(900) == 450)
    with pytest.raises(ValueError, match=r"\[450\] is nan, but all samples must be finite"):
        ANALYSES[name](time, motion)
