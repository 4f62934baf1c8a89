"""Energy shares, damping capacity and complex power against exact values."""

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import complex_power, energy_shares, loss_factor, specific_damping_capacity


def ball_on_a_structure(**changes):
    """Return a structure with one ball, hit by a pulse."""
    parts = {
        "structure": rb.SDOF(mass=20.0, stiffness=80e3, damping=25.3),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(radius=0.03, material="steel"), gap=4e-4, contact=rb.Tsuji(restitution=0.6)
        ),
        "load": rb.HalfSine(amplitude=5e3, duration=1e-3),
        "duration": 1.0,
    }
    return rb.simulate(rb.Case(**(parts | changes)))


def test_shares_add_up_to_one_and_are_those_of_the_ledger():
    """The shares of a run add up to one; each is its loss over the energy supplied."""
    run = ball_on_a_structure()
    shares = energy_shares(run)
    assert float(shares.sum()) == pytest.approx(1.0, abs=1e-12)
    work = run.arrays.load_work[-1]
    assert float(shares.sel(channel="viscous")) == pytest.approx(run.arrays.viscous_loss[-1] / work)
    assert float(shares.sel(channel="normal")) == pytest.approx(run.arrays.normal_loss[-1, 0] / work)
    assert 0.05 < float(shares.sel(channel="normal")) < 0.95
    assert shares.attrs["units"] == "1"


def test_shares_of_a_run_without_energy_are_nan():
    """A run without supplied energy has NaN shares."""
    run = ball_on_a_structure(load=rb.HalfSine(amplitude=0.0, duration=1e-3))
    assert np.isnan(energy_shares(run)).all()


@pytest.mark.parametrize("ratio", [0.01, 0.2])
def test_capacity_of_a_viscous_oscillator(ratio):
    """Each cycle of a simulated free decay dissipates 1 - exp(-2 decrement) of its initial energy."""
    omega = np.sqrt(80e3 / 20.0)
    cycle = 2 * np.pi / (omega * np.sqrt(1 - ratio**2))
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=20.0, stiffness=80e3, damping_ratio=ratio, velocity=0.1),
            duration=5 * cycle,
            output=rb.Output(times=(cycle * np.arange(6)).tolist()),
        )
    )
    exact = 1 - np.exp(-4 * np.pi * ratio / np.sqrt(1 - ratio**2))
    stored = run.energy.total.values[:-1]
    capacity = specific_damping_capacity(np.diff(run.energy.viscous_loss), stored)
    np.testing.assert_allclose(capacity, exact, rtol=1e-9)
    np.testing.assert_allclose(loss_factor(np.diff(run.energy.viscous_loss), stored), exact / (2 * np.pi), rtol=1e-9)


def test_loss_factor_under_a_harmonic_motion():
    """A dashpot c parallel to a spring k stores k A^2/2, dissipates pi c omega A^2 and has the loss factor c omega/k."""
    c, k, omega, amplitude = 3.0, 500.0, 12.0, 0.02
    result = loss_factor(np.pi * c * omega * amplitude**2, 0.5 * k * amplitude**2)
    assert result == pytest.approx(c * omega / k)


def test_lists_of_energies_are_accepted():
    """Lists and arrays of the same numbers give the same result."""
    np.testing.assert_array_equal(specific_damping_capacity([1, 2.0], [2, 8]), [0.5, 0.25])
    np.testing.assert_array_equal(loss_factor([1.0, 2.0], 2), np.array([0.5, 1.0]) / (2 * np.pi))


@pytest.mark.parametrize(
    ("dissipated", "stored", "message"),
    [
        (1.0, 0.0, "stored energy .* 0 J"),
        (1.0, np.array([1.0, -2.0]), "stored energy .* -2 J"),
        (np.nan, 1.0, "must be finite"),
    ],
)
def test_bad_energies_are_refused(dissipated, stored, message):
    """A stored energy that is not positive and an energy that is NaN are refused."""
    with pytest.raises(ValueError, match=message):
        loss_factor(dissipated, stored)


def driven(time, frequency, mass=0.0, damping=0.0, stiffness=0.0, amplitude=0.2):
    """Return the force on a mass, dashpot and spring in harmonic motion, and the velocity."""
    phase = 2 * np.pi * frequency * time + 0.7
    omega = 2 * np.pi * frequency
    velocity = amplitude * np.cos(phase)
    force = (
        -mass * omega * amplitude * np.sin(phase) + damping * velocity + stiffness * amplitude / omega * np.sin(phase)
    )
    return force, velocity


@pytest.mark.parametrize(("mass", "stiffness"), [(1.2, 0.0), (0.0, 900.0), (1.2, 900.0)])
def test_complex_power_of_mass_dashpot_and_spring(mass, stiffness):
    """Force and velocity of a mass, a dashpot and a spring give their power, effective mass and loss factor."""
    frequency, damping, amplitude = 8.0, 5.0, 0.2
    omega = 2 * np.pi * frequency
    time = np.arange(0, 2.0, 1e-3)
    force, velocity = driven(time, frequency, mass, damping, stiffness, amplitude)
    # A constant force and higher harmonics do not contribute to the power at this frequency.
    force = force + 9.81 + 3.0 * np.cos(3 * omega * time) + 2.0 * np.sin(2 * omega * time)
    effective = mass - stiffness / omega**2
    # The signal covers 15 whole cycles and a fraction, which is not evaluated.
    power = complex_power(time, force, velocity, frequency=frequency)
    assert power.attrs == {"frequency": frequency, "cycles": 15}
    assert float(power.active_power) == pytest.approx(damping * amplitude**2 / 2, rel=1e-9)
    assert float(power.reactive_power) == pytest.approx(-omega * effective * amplitude**2 / 2, rel=1e-9)
    assert float(power.effective_mass) == pytest.approx(effective, rel=1e-9)
    assert float(power.loss_factor) == pytest.approx(damping / abs(omega * effective), rel=1e-9)
    assert power.effective_mass.attrs == {"units": "kg", "long_name": "effective mass"}


def test_complex_power_of_a_simulated_damper():
    """The active power of a damper in periodic motion times the period is the energy lost in impacts per cycle."""
    frequency, amplitude = 10.0, 1e-3
    cycles, samples = 40, 4000
    # Soft, so that each contact lasts many samples.
    rubber = rb.Material(density=7850.0, young=1e8, poisson=0.45)
    run = rb.simulate(
        rb.Case(
            structure=rb.Shaker(motion=rb.Harmonic(amplitude=f"{amplitude} m", frequency=f"{frequency} Hz")),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius=0.01, material=rubber), gap=1e-3, contact=rb.Tsuji(restitution=0.5)
            ),
            duration=cycles / frequency,
            output=rb.Output(times=np.linspace(0, cycles / frequency, cycles * samples + 1).tolist()),
        )
    )
    motion, late = run.along(), slice(30 / frequency, None)
    lost = np.diff(run.arrays.normal_loss[:, 0][[30 * samples, -1]])[0] / 10
    power = complex_power(
        motion.time.sel(time=late),
        -motion.cavity_force.sel(time=late).isel(damper=0),
        motion.base_velocity.sel(time=late),
        frequency=frequency,
    )
    # The force begins as overlap^(1/4), which 80 samples a contact integrate to a thousandth.
    assert float(power.active_power) / frequency == pytest.approx(lost, rel=1e-3)
    assert float(power.effective_mass) > 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"frequency": 0.0}, r"frequency is 0\.0 Hz"),
        ({"frequency": 0.4}, r"covers 0\.8 cycles of 0\.4 Hz"),
        ({"velocity": np.zeros(2001)}, "velocity .* 8 Hz"),
        ({"force": np.zeros(5)}, "force has 5 samples, but time has 2001"),
    ],
)
def test_bad_power_is_refused(change, message):
    """An invalid frequency and signals of different lengths are refused."""
    time = np.linspace(0, 2.0, 2001)
    force, velocity = driven(time, 8.0, mass=1.0)
    given = {"force": force, "velocity": velocity, "frequency": 8.0} | change
    with pytest.raises(ValueError, match=message):
        complex_power(time, given["force"], given["velocity"], frequency=given["frequency"])


def test_complex_power_without_the_frequency():
    """`complex_power` raises if the velocity has no component at the frequency."""
    time = np.linspace(0.0, 1.0, 2001)
    with pytest.raises(ValueError, match=r"velocity .* 10 Hz"):
        complex_power(time, np.cos(40 * np.pi * time), np.sin(40 * np.pi * time), frequency=10.0)
