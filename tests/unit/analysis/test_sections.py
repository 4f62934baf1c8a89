"""Phase portraits, Poincare sections and impact counts of motions with exact solutions."""

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import impacts_per_cycle, phase_portrait, poincare_section
from rattlebox.plots import plot_phase_portrait
from rattlebox.results import Run, RunArrays

PERIOD = 0.1
OMEGA = 2 * np.pi / PERIOD


def run_of(time, position, velocity):
    """Return a run with the motion of one point."""
    return Run(RunArrays(time=time, points=("mass",), displacement=position[:, None], velocity=velocity[:, None]))


def subharmonic(order, share=0.3, samples=40):
    """Return a motion that repeats every `order` periods."""
    time = np.linspace(0, 20 * PERIOD, 20 * samples + 1)
    slow = OMEGA / order
    position = np.sin(OMEGA * time) + share * np.sin(slow * time + 0.5)
    velocity = OMEGA * np.cos(OMEGA * time) + share * slow * np.cos(slow * time + 0.5)
    return run_of(time, position, velocity)


@pytest.mark.parametrize(("order", "points"), [(1, 1), (2, 2), (3, 3)])
def test_motion_that_repeats_every_n_periods_shows_n_points(order, points):
    """The section of a motion of period 1, 2 or 3 has 1, 2 or 3 points."""
    section = poincare_section(subharmonic(order), PERIOD)
    assert section.sizes["time"] == 21
    places = np.round(np.stack([section.position, section.velocity / OMEGA]), 9) + 0.0
    assert np.unique(places, axis=1).shape[1] == points


def test_strobes_between_samples_lie_on_the_orbit():
    """Between samples, positions are interpolated to fourth order and velocities to third order."""
    phase = 1.0
    exact = np.sin(phase) + 0.3 * np.sin(phase + 0.5), OMEGA * (np.cos(phase) + 0.3 * np.cos(phase + 0.5))
    errors = {"position": [], "velocity": []}
    for samples in (20, 40, 80):
        section = poincare_section(subharmonic(1, samples=samples), PERIOD, phase=phase)
        assert section.sizes["time"] == 20
        np.testing.assert_allclose(section.time, (np.arange(20) + phase / (2 * np.pi)) * PERIOD)
        errors["position"].append(np.max(np.abs(section.position - exact[0])))
        errors["velocity"].append(np.max(np.abs(section.velocity - exact[1])) / OMEGA)
    bounds = 1.3 / 384 * (2 * np.pi / np.array([20, 40, 80])) ** 4
    assert np.all(errors["position"] <= bounds * 1.01)
    assert errors["velocity"][0] / errors["velocity"][2] > 4**3 / 2
    assert errors["velocity"][2] < 1e-4


def test_steady_state_of_a_simulated_oscillator_is_one_point():
    """The section of a linear structure under a harmonic load converges to the point of its frequency response."""
    mass, stiffness, damping, force, omega = 1.0, 100.0, 2.0, 3.0, 8.0
    period = 2 * np.pi / omega
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=mass, stiffness=stiffness, damping=damping),
            load=rb.Harmonic(amplitude=f"{force} N", frequency=f"{omega} rad/s"),
            duration=60 * period,
            output=rb.Output(times=np.linspace(0, 60 * period, 60 * 8 + 1).tolist()),
        )
    )
    section = poincare_section(run, period).sel(time=slice(50 * period, None))
    response = force / (stiffness - mass * omega**2 + 1j * damping * omega)
    np.testing.assert_allclose(section.position, response.imag, rtol=1e-9)
    np.testing.assert_allclose(section.velocity, (1j * omega * response).imag, rtol=1e-9)


def test_strobes_on_first_and_last_time_count():
    """Strobes at the first and the last sample are included, also if rounding puts them outside."""
    time = np.linspace(0.3, 0.3 + 7 * PERIOD, 71)
    section = poincare_section(run_of(time, np.sin(OMEGA * time), OMEGA * np.cos(OMEGA * time)), PERIOD)
    assert section.sizes["time"] == 8


def test_portrait_of_ball_and_point():
    """A portrait of a ball has its motion in the cavity, one of a point that of the structure, with units and names."""
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=20.0, stiffness=80e3),
            damper=rb.ImpactDamper(
                balls=[rb.Sphere(radius=0.01, material="steel")] * 2, gap=1e-3, contact=rb.Tsuji(restitution=0.8)
            ),
            load=rb.HalfSine(amplitude=5e3, duration=1e-3),
            duration=0.3,
        )
    )
    arrays = run.arrays
    portrait = phase_portrait(run)
    assert portrait.attrs["of"] == arrays.balls[0]
    # The position of each ball is relative to its place in the packed, centred row.
    for k, name in enumerate(arrays.balls):
        portrait = phase_portrait(run, name)
        np.testing.assert_array_equal(portrait.position, arrays.relative_position[:, k] - arrays.ball_centre[k])
        np.testing.assert_array_equal(portrait.velocity, arrays.relative_velocity[:, k])
        assert np.max(np.abs(portrait.position)) < 1.1e-3
    point = phase_portrait(run, arrays.points[0])
    np.testing.assert_array_equal(point.position, arrays.displacement[:, 0])
    np.testing.assert_array_equal(point.velocity, arrays.velocity[:, 0])
    assert point.position.attrs == {"units": "m", "long_name": "position of the structure"}
    assert portrait.velocity.attrs == {"units": "m/s", "long_name": "velocity in its cavity"}
    with pytest.raises(ValueError, match=r"no ball or point 'ball'; there are .*damper/1"):
        phase_portrait(run, "ball")


def test_impacts_are_counted_in_their_cycle():
    """Impacts are counted in their cycle; impacts outside whole cycles are ignored."""
    start = 1.0
    times = start + PERIOD * np.array([-0.2, 0.1, 0.2, 0.9, 2.5, 3.1, 3.2, 3.3, 4.05])
    counts = impacts_per_cycle(times[::-1], PERIOD, start=start, end=start + 4.4 * PERIOD)
    np.testing.assert_array_equal(counts, [3, 0, 1, 3])
    np.testing.assert_allclose(counts.cycle, start + PERIOD * np.arange(4))
    assert counts.cycle.attrs == {"units": "s", "long_name": "cycle start"}
    assert counts.attrs == {"units": "1", "long_name": "impacts in the cycle"}


def test_impacts_on_a_border_belong_to_the_cycle_that_begins():
    """Impacts at the borders of cycles, shifted by rounding to either side, are one impact in each cycle."""
    period, start = 0.1, 0.3
    borders = start + period * np.arange(1001)
    for times in (borders, np.nextafter(borders, -np.inf), np.nextafter(borders, np.inf)):
        counts = impacts_per_cycle(times, period, start=start, end=float(times[-1]))
        np.testing.assert_array_equal(counts, np.ones(1000))


def test_no_impacts_is_zero_in_every_cycle():
    """Without impacts each cycle has a count of zero."""
    np.testing.assert_array_equal(impacts_per_cycle([], 1.0, start=0.0, end=3.0), [0, 0, 0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([], 0.0, 0.0, 1.0), "period is 0.0 s"),
        (([], 2.0, 0.0, 1.0), "no whole cycle of 2 s fits"),
        (([np.nan], 0.1, 0.0, 1.0), r"impact_times\[0\] is nan"),
        (([], 0.1, 0.0, np.inf), "is inf"),
    ],
)
def test_bad_cycles_are_refused(arguments, message):
    """An invalid period, span or time is refused with its value."""
    times, period, start, end = arguments
    with pytest.raises(ValueError, match=message):
        impacts_per_cycle(times, period, start=start, end=end)


def test_bad_strobes_are_refused():
    """A period that is not positive or is longer than the run is refused."""
    time = np.linspace(0.01, 0.05, 11)
    run = run_of(time, time, time)
    with pytest.raises(ValueError, match=r"period is -1\.0 s"):
        poincare_section(run, -1.0)
    with pytest.raises(ValueError, match=r"period 0\.1 s .* 0\.01 s to 0\.05 s"):
        poincare_section(run, 0.1)


def particle_run(**options):
    """Return a short run of a 3-D particle damper."""
    usual = {
        "structure": rb.SDOF(mass=0.1, stiffness=1e4, velocity=0.5),
        "damper": rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="4 mm", count=2),
            cavity=rb.Box(size=("20 mm",) * 3),
            contact=rb.Tsuji(restitution=0.7),
            softening=1000,
        ),
        "duration": 0.05,
        "output": rb.Output(rate="10 kHz"),
    }
    return rb.simulate(rb.Case(**{**usual, **options}))


def test_points_of_runs_with_particles():
    """The portrait of a run with particles is that of a point of the structure, by default the first."""
    run = particle_run()
    for of in (None, "mass"):
        portrait = phase_portrait(run, of)
        assert portrait.attrs["of"] == run.arrays.points[0]
        np.testing.assert_array_equal(portrait.position, run.arrays.displacement[:, 0])
        np.testing.assert_array_equal(portrait.velocity, run.arrays.velocity[:, 0])
    assert poincare_section(run, 0.01).sizes["time"] == 6
    assert plot_phase_portrait(run).axes
    with pytest.raises(ValueError, match="there is no ball or point 'damper'; there are mass"):
        phase_portrait(run, "damper")


def test_runs_without_a_point_are_refused():
    """A run in which only particles move has no phase portrait."""
    still = particle_run(structure=rb.Fixed())
    nothing = Run(RunArrays(time=np.linspace(0, 1, 5)))
    for run in (nothing,) if still.arrays.points else (nothing, still):
        with pytest.raises(ValueError, match="there is no ball in this run, and no point"):
            phase_portrait(run)


def test_a_run_without_particles_has_no_shaken_cavity():
    """A run without particles has no analysis of a shaken cavity."""
    run = subharmonic(1)
    with pytest.raises(
        AttributeError, match=r"this 1-D run .* has no 'particle_mass', which only the dem engine writes"
    ):
        rb.analysis.shaken_cavity(run, frequency=10)
