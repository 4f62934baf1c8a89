"""Random records have the prescribed spectral density, and the same effect in both engines as their signal."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.model.plausibility import change_by_interpolation

LOW, HIGH, DENSITY = 20.0, 2000.0, 10.0
PSD = [(LOW, DENSITY), (HIGH, DENSITY)]
RATES = [None, 4000.0, 5000.0, 37123.0, 64000.0]
FREQUENCY, DAMPING = 1800.0, 0.02


def coefficients(record: rb.Record, fine: int = 8) -> tuple[np.ndarray, np.ndarray, float]:
    """Return frequencies and Fourier coefficients of the straight lines of a record, and its length."""
    times = np.array(record.times)
    span = times[-1] - times[0]
    count = fine * (times.size - 1)
    drawn = np.interp(np.arange(count) * span / count, times, record.values)
    return np.arange(count // 2 + 1) / span, np.fft.rfft(drawn) / count, span


def test_the_density_is_the_one_asked_for() -> None:
    """The mean density of each third of the band is the prescribed one."""
    frequency, coefficient, _ = coefficients(rb.Random(PSD, 40.0, 4000.0, seed=1), fine=4)
    power = 2 * np.abs(coefficient) ** 2
    for band in range(3):
        low, end = (LOW + (band + end) * (HIGH - LOW) / 3 for end in (0, 1))
        # The sum of 26 400 squares of complex Gaussian numbers: 0.6 % of scatter.
        assert power[(frequency >= low) & (frequency < end)].sum() / (end - low) == pytest.approx(DENSITY, rel=0.015)


@pytest.mark.parametrize("rate", RATES)
def test_nothing_lies_above_the_highest_frequency(rate: float | None) -> None:
    """Less than 0.5 % of the power of the straight lines lies above the highest frequency, at any rate."""
    frequency, coefficient, _ = coefficients(rb.Random([(1900.0, 1.0), (HIGH, 1.0)], 0.5, rate), fine=32)
    power = np.abs(coefficient) ** 2
    assert power[frequency > HIGH + 0.1].sum() < 0.0005 * power.sum()


def test_the_signal_does_not_depend_on_the_rate() -> None:
    """Below its highest frequency a record has the same spectrum at any rate, within a part in a thousand."""
    frequency, exact, _ = coefficients(rb.Random(PSD, 0.5, 512 * HIGH), fine=4)
    inside = np.flatnonzero((frequency >= LOW) & (frequency <= HIGH))
    for rate in (None, 4000.0, 50000.0):
        _, coefficient, _ = coefficients(rb.Random(PSD, 0.5, rate))
        np.testing.assert_allclose(coefficient[inside], exact[inside], rtol=1e-3)


def response(frequency: Any) -> Any:
    """Return displacement over base acceleration of the oscillator."""
    own, omega = 2 * np.pi * FREQUENCY, 2 * np.pi * np.asarray(frequency)
    return -1 / (own**2 - omega**2 + 2j * DAMPING * own * omega)


def test_rms_of_an_oscillator_near_the_highest_frequency() -> None:
    """The mean square response of an oscillator at 0.9 of the highest frequency is the integral of the theory."""
    grid = np.linspace(LOW, HIGH, 200_001)
    theory = np.trapezoid(DENSITY * np.abs(response(grid)) ** 2, grid)
    squares = []
    for seed in range(80):
        frequency, coefficient, _ = coefficients(rb.Random(PSD, 2.0, 4000.0, seed=seed), fine=4)
        squares.append(2 * np.sum(np.abs(coefficient * response(frequency)) ** 2))
    error = np.std(squares) / math.sqrt(len(squares))
    assert error < 0.015 * theory
    assert abs(np.mean(squares) - theory) < 3 * error


def floating(**changes: Any) -> rb.ParticleDamper:
    """Return a box with one light particle that touches nothing."""
    return rb.ParticleDamper(
        particles=rb.Particles(material=rb.Material(density=10.0, young="1 GPa", poisson=0.3), diameter="1 mm"),
        packing=rb.Positions(positions=[[0, 0, 0]]),
        cavity=rb.Box(size=("1 m", "1 m", "1 m")),
        gravity=(0, 0, 0),
        contact=rb.Linear(contact_time="2 ms", restitution=0.5),
        **changes,
    )


@pytest.mark.parametrize("rate", [4000.0, None])
@pytest.mark.parametrize(("parts", "allowed"), [({}, 1e-3), ({"damper": floating()}, 5e-3)], ids=["impact", "particle"])
def test_both_engines_move_as_the_signal_says(rate: float | None, parts: dict[str, Any], allowed: float) -> None:
    """The displacement of an oscillator is the sum of its responses to the harmonics of the signal."""
    record = rb.Random(PSD, 0.25, rate, seed=3, unit="m/s^2")
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=1.0, stiffness=(2 * math.pi * FREQUENCY) ** 2, damping_ratio=DAMPING),
            base=record,
            duration=0.25,
            output=rb.Output(rate=20_000.0),
            **parts,
        )
    )
    late = run.arrays.time > 0.06  # the start has died out to 1e-6
    frequency, coefficient, _ = coefficients(record, fine=32)
    driven = (frequency >= LOW) & (frequency <= HIGH)
    spectrum = 2 * coefficient[driven] * response(frequency[driven])
    exact = np.real(np.exp(2j * np.pi * np.outer(run.arrays.time[late], frequency[driven])) @ spectrum)
    result = run.arrays.displacement[late, 0]
    assert np.std(result) == pytest.approx(np.std(exact), rel=allowed)
    assert np.std(result - exact) < 4 * allowed * np.std(exact)
    assert not any("straight lines" in note for note in run.notes)


@pytest.mark.parametrize("rate", [4500.0, 8000.0])
def test_the_loss_stated_for_a_record_is_what_a_run_loses(rate: float) -> None:
    """The loss of a record by linear interpolation between samples agrees with the note."""
    random = np.random.default_rng(5)
    count = round(0.5 * rate)
    frequency = np.fft.rfftfreq(count, 1 / rate)
    inside = (frequency >= LOW) & (frequency <= HIGH)
    spectrum = np.where(inside, random.standard_normal((2, frequency.size)).T @ (1, 1j), 0)
    values = np.fft.irfft(spectrum, count)
    record = rb.Record(times=np.arange(count + 1) / rate, values=np.append(values, values[0]), unit="m/s^2")
    case = rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=(2 * math.pi * FREQUENCY) ** 2, damping_ratio=DAMPING),
        base=record,
        duration=0.5,
        output=rb.Output(rate=20_000.0),
    )
    run = rb.simulate(case)
    late = run.arrays.displacement[run.arrays.time > 0.06, 0]
    meant = math.sqrt(2 * np.sum(np.abs(spectrum * response(frequency)) ** 2)) / count
    decay = DAMPING * FREQUENCY
    stated = change_by_interpolation(rate, frequency[1:], np.abs(spectrum[1:]) ** 2, FREQUENCY, decay)
    assert stated < -0.1
    assert np.sqrt(np.mean(late**2)) / meant == pytest.approx(1 + stated, rel=0.05)  # 0.06 s are left out
    (note,) = run.notes
    assert "straight lines" in note
    advised = float(note.split("resampled to ")[1].split()[0])
    up, down = (advised / rate).as_integer_ratio()
    times = np.arange(count * up // down + 1) / advised
    spectrum = np.fft.rfft(values)
    dense = np.fft.irfft(spectrum, times.size - 1) * (up / down)
    resampled = rb.Record(times=times, values=np.append(dense, dense[0]), unit="m/s^2")
    assert rb.simulate(case.model_copy(update={"base": (resampled,)})).notes == ()


@pytest.mark.parametrize(("fraction", "warned"), [(0.025, False), (0.1, False), (0.2, True)])
def test_means_over_steps_take_what_is_stated(fraction: float, warned: bool) -> None:
    """A 3-D run takes sinc(f step) of a record at the frequency f of a mode, and warns where this is more than 2 %."""
    record = rb.Random([(1500.0, DENSITY), (HIGH, DENSITY)], 0.25, 512e3, seed=3, unit="m/s^2")
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=1.0, stiffness=(2 * math.pi * FREQUENCY) ** 2, damping_ratio=DAMPING),
            base=record,
            damper=floating(),
            duration=0.25,
            output=rb.Output(rate=10_000.0),
            method=rb.Dem(fraction=fraction),
        )
    )
    late = run.arrays.time > 0.06
    frequency, coefficient, _ = coefficients(record, fine=1)
    driven = (frequency >= 1500.0) & (frequency <= HIGH)
    means = np.sinc(frequency[driven] * run.diagnostics["step"])
    spectrum = 2 * means * coefficient[driven] * response(frequency[driven])
    exact = np.real(np.exp(2j * np.pi * np.outer(run.arrays.time[late], frequency[driven])) @ spectrum)
    assert np.std(run.arrays.displacement[late, 0]) == pytest.approx(np.std(exact), rel=5e-3)
    assert warned == any("mean over each step" in note for note in run.notes)
