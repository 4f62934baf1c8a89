"""The motion of the base that a signal of acceleration means."""

import numpy as np
import pytest

import rattlebox as rb


@pytest.mark.parametrize(
    ("times", "values"),
    [([-1.0, 1.0], [0.0, 2.0]), ([-1.0, 0.0, 1.0], [3.0, 1.0, -2.0]), ([-2.0, -0.3, 0.4, 1.0], [1.0, -4.0, 2.0, 0.5])],
)
def test_records_that_begin_before_the_run(times: list[float], values: list[float]) -> None:
    """A base starts at rest at 0, also if its record begins earlier, and then moves by its acceleration integrated twice."""
    fine = np.linspace(0.0, 1.0, 200_001)
    displacement, velocity, acceleration = rb.Record(times=times, values=values, unit="m/s^2").motion(fine)
    np.testing.assert_allclose(acceleration, np.interp(fine, times, values), atol=1e-12)
    step = np.diff(fine)
    np.testing.assert_allclose(velocity[1:], np.cumsum(step * (acceleration[1:] + acceleration[:-1]) / 2), atol=1e-9)
    np.testing.assert_allclose(displacement[1:], np.cumsum(step * (velocity[1:] + velocity[:-1]) / 2), atol=1e-9)
    assert displacement[0] == velocity[0] == 0


@pytest.mark.parametrize(
    "signal",
    [
        rb.HalfSine(amplitude=3.0, duration=0.2, start=0.1),
        rb.Harmonic(amplitude=3.0, frequency=2.0, phase=0.4, start=0.1, stop=0.7),
        rb.Record(times=[0.0, 0.2, 0.7, 1.0], values=[1.0, -4.0, 2.0, 0.5], unit="m/s^2"),
    ],
    ids=["half sine", "harmonic", "record"],
)
def test_signals_that_begin_in_the_run(signal: rb.HalfSine | rb.Harmonic | rb.Record) -> None:
    """From rest, velocity and displacement are the acceleration integrated once and twice, also after its end."""
    fine = np.linspace(0.0, 1.0, 200_001)
    displacement, velocity, acceleration = signal.motion(fine)
    step = np.diff(fine)
    np.testing.assert_allclose(velocity[1:], np.cumsum(step * (acceleration[1:] + acceleration[:-1]) / 2), atol=3e-5)
    np.testing.assert_allclose(displacement[1:], np.cumsum(step * (velocity[1:] + velocity[:-1]) / 2), atol=1e-9)
    assert displacement[0] == velocity[0] == 0
    assert abs(acceleration).max() == pytest.approx(4.0 if isinstance(signal, rb.Record) else 3.0, rel=1e-6)


def test_a_direction_without_particle_dampers() -> None:
    """The line of motion is the direction of the base; without particle dampers several directions are refused."""
    structure = rb.SDOF(mass="3 kg", frequency="20 Hz", damping_ratio=0.02)
    pulses = [rb.HalfSine(amplitude="1 g", duration="11 ms", direction=axis) for axis in (None, "z", "x")]
    free, along = (rb.simulate(rb.Case(structure=structure, base=pulse, duration="0.2 s")) for pulse in pulses[:2])
    np.testing.assert_array_equal(along.arrays.displacement, free.arrays.displacement)
    np.testing.assert_array_equal(along.arrays.interface_force, free.arrays.interface_force)
    assert np.abs(along.arrays.displacement).max() > 1e-4
    with pytest.raises(rb.CaseError, match=r"base\[1\].direction.*\n.*along one line\n.*the same direction for all"):
        rb.Case(structure=structure, base=pulses[1:], duration="0.2 s")
