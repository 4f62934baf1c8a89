"""Runs of particle dampers: momentum, weight, energy ledger, directions, statuses and files."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.model.overlaps import check_packing
from rattlebox.prepare.particles import pack_particles, prepare
from rattlebox.results import Run

CUBE = rb.Box(size=("24 mm",) * 3)


def balls(count: int = 60) -> rb.Particles:
    """Return steel balls of 4 mm."""
    return rb.Particles(material="steel", diameter="4 mm", count=count)


def damper(**options: Any) -> rb.ParticleDamper:
    """Return a damper of sixty steel balls in a cube, with soft contacts."""
    usual: dict[str, Any] = {
        "particles": balls(),
        "cavity": CUBE,
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.3,
        "softening": 1000,
    }
    return rb.ParticleDamper(**{**usual, **options})


def simulate(*dampers: rb.ParticleDamper, **options: Any) -> Run:
    """Run dampers on a structure of 0.1 kg with an initial velocity."""
    usual: dict[str, Any] = {
        "structure": rb.SDOF(mass=0.1, stiffness=1e4, damping=0.5, velocity=0.5),
        "duration": 0.05,
        "output": rb.Output(rate="10 kHz"),
    }
    run = rb.simulate(rb.Case(**{**usual, "dampers": dampers or (damper(),), **options}))
    assert isinstance(run, Run)
    return run


def shaker(**motion: Any) -> rb.Shaker:
    """Return a shaker at 40 Hz."""
    return rb.Shaker(motion=rb.Harmonic(**{"amplitude": "3 mm", "frequency": "40 Hz", **motion}))


def test_total_momentum_of_a_free_structure_and_its_particles_is_constant() -> None:
    """Without spring, dashpot, gravity and load the total momentum is constant to round-off."""
    run = simulate(damper(gravity=(0, 0, 0)), structure=rb.SDOF(mass=0.1, stiffness=0, velocity=0.5))
    total = 0.1 * run.arrays.velocity[:, 0] + run.arrays.momentum[:, 0, 0]
    assert np.abs(total - 0.05).max() < 1e-12 * 0.05
    assert run.counts["first_touches_wall"] > 10


def test_the_ledger_closes_better_with_shorter_steps() -> None:
    """The losses by channel and by partner add up to the supplied energy, the more exactly the shorter the step."""
    residuals = []
    for fraction in (0.05, 0.0125):
        run = simulate(damper(rolling=0.02), method=rb.Dem(fraction=fraction))
        residuals.append(run.energy_residual)
        assert run.ok
        assert sum(run.ledger.shares.values()) == pytest.approx(1, abs=2 * run.energy_residual)
        assert all(run.ledger.shares[channel] > 0 for channel in ("viscous", "normal", "sliding", "rolling"))
        in_contacts = sum(run.ledger.shares[channel] for channel in ("normal", "plastic", "sliding", "rolling"))
        assert run.ledger.partner_share.sum() == pytest.approx(in_contacts)
        assert run.ledger.damper_share.sum() == pytest.approx(in_contacts)
    assert residuals[1] < 0.25 * residuals[0] < 0.01


def test_a_settled_bed_weighs_on_the_floor() -> None:
    """A settled bed has lasting contacts and almost no kinetic energy, and the floor carries its weight."""
    still = damper(packing=rb.Settled(seed=2), cavity=rb.Cylinder(diameter="20 mm", length="30 mm"))
    run = simulate(still, structure=rb.Fixed(), duration=0.1)
    weight = run.arrays.particle_mass[0] * 9.81
    late = run.arrays.time > 0.08
    assert run.arrays.cavity_force[late, 0, 2].mean() == pytest.approx(-weight, rel=2e-3)
    assert run.arrays.kinetic_energy[-1, 0] < 1e-4 * run.arrays.particle_mass[0] * 9.81 * 2e-3
    assert 3 < run.ledger.coordination[-1, 0] < 7
    assert run.arrays.particles.position[:, 2].min() == pytest.approx(-0.013, abs=1e-5)


@pytest.mark.parametrize(
    ("shape", "friction"),
    [(rb.Cylinder(diameter="20 mm", length="30 mm"), 0.3), (rb.SphericalCavity(diameter="24 mm"), 0.3), (CUBE, 0)],
    ids=["can", "sphere", "cube of six balls"],
)
def test_a_settled_bed_is_at_rest_from_the_first_step(shape: Any, friction: float) -> None:
    """A settled bed does not drop at the start of a run, even if a row of balls is as long as the cavity."""
    still = damper(packing=rb.Settled(seed=2), cavity=shape, friction=friction, softening=1)
    run = simulate(still, structure=rb.Fixed(), duration=5e-3)
    height = run.motion["centre_of_mass"].sel(axis="z").values.ravel()
    assert 0 < np.ptp(height) < 1e-6
    speed = np.sqrt(2 * run.arrays.kinetic_energy.max() / run.arrays.particle_mass[0])
    assert speed < 2e-3


def test_rough_particles_settle() -> None:
    """Particles with a friction of 3 settle to the same bed as with a friction of 1."""
    from rattlebox.prepare.settle import settle

    many = {"particles": balls(200), "cavity": rb.Box(size=("30 mm",) * 3), "packing": rb.Settled(seed=1)}
    assert np.array_equal(settle(damper(**many, friction=3)), settle(damper(**many, friction=1)))


def test_many_rough_particles_come_to_rest() -> None:
    """Hundreds of particles with a coefficient of friction of 1 come to rest: the steps of the fall generate no energy."""
    from rattlebox.prepare.settle import settle

    many = {"particles": balls(600), "cavity": rb.Box(size=("37 mm",) * 3), "packing": rb.Settled(seed=1)}
    assert settle(damper(**many, friction=1))[:, 2].max() < 0.013


def test_a_large_ball_among_many_small_ones_settles() -> None:
    """A ball among balls of a sixteenth of its size settles, and the bed is at rest from the first step."""
    kinds = [
        rb.Particles(name=size, material="steel", diameter=size, count=n) for size, n in (("1 mm", 600), ("16 mm", 1))
    ]
    cavity = rb.Box(size=("18 mm", "18 mm", "30 mm"))
    bed = damper(particles=kinds, cavity=cavity, packing=rb.Settled(seed=1), softening=1)
    run = simulate(bed, structure=rb.Fixed(), duration=1e-3)
    assert np.ptp(run.motion["centre_of_mass"].sel(axis="z").values) < 1e-6


def test_settling_is_reproducible() -> None:
    """A seed fixes the bed, another seed gives another one, and no two particles overlap."""
    from rattlebox.prepare.settle import settle

    beds = [settle(damper(packing=rb.Settled(seed=seed))) for seed in (1, 1, 2)]
    assert np.array_equal(beds[0], beds[1])
    assert not np.allclose(beds[0], beds[2])
    check_packing(CUBE, beds[0], np.full(60, 2e-3))
    assert beds[0][:, 2].max() < 0.0


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(
    "cavity",
    [
        rb.SphericalCavity(diameter="24 mm"),
        rb.SphericalCavity(diameter="14.3 mm"),
        rb.Cylinder(radius="12 mm", length="9 mm", axis="x"),
    ],
)
def test_one_ball_settles_in_a_round_cavity(cavity: Any, friction: float) -> None:
    """A ball in a round cavity comes to rest at the lowest point, with and without friction."""
    from rattlebox.prepare.settle import settle

    (place,) = settle(damper(particles=balls(1), packing=rb.Settled(seed=1), cavity=cavity, friction=friction))
    assert place[2] == pytest.approx(2e-3 - cavity.radius, abs=2e-6)
    assert abs(place[1]) < 3e-4


def test_bits_do_not_depend_on_threads() -> None:
    """Runs with one thread and with two threads have the same bits."""
    one, two = (simulate(method=rb.Dem(threads=threads), duration=0.02) for threads in (1, 2))
    assert np.array_equal(one.arrays.particles.position, two.arrays.particles.position)
    assert np.array_equal(one.arrays.sliding_loss, two.arrays.sliding_loss)
    assert one.counts["first_touches_particle"] == two.counts["first_touches_particle"]


def test_a_point_in_3_d_moves_as_the_same_point_on_a_line() -> None:
    """A mode along z with three components and a 1-D structure with a damper along z have the same motion."""
    load = {"amplitude": "200 N", "duration": "1 ms"}
    line = simulate(damper(direction="z"), structure=rb.SDOF(mass=0.1, stiffness=1e4), load=rb.HalfSine(**load))
    modal = rb.Modal(
        frequencies=[math.sqrt(1e5) / (2 * math.pi)],
        damping_ratios=[0],
        shapes={"tip": [[0, 0, math.sqrt(10)]]},
        participation=[[0, 0, math.sqrt(0.1)]],
    )
    space = simulate(damper(), structure=modal, load=rb.HalfSine(**load, direction="z"))
    assert space.arrays.points == ("tip x", "tip y", "tip z")
    before = line.arrays.time < 0.01  # later, rounding errors have grown
    np.testing.assert_allclose(
        space.arrays.displacement[before, 2], line.arrays.displacement[before, 0], rtol=1e-6, atol=1e-9
    )
    assert not space.arrays.displacement[:, :2].any()


def test_a_base_across_the_structure_moves_particles_only() -> None:
    """A base motion normal to a structure's direction does not excite it, but shakes the particles in its cavity."""
    run = simulate(
        damper(gravity=(0, 0, 0), friction=0),
        structure=rb.SDOF(mass=1e6, stiffness=1e4),
        base=rb.Harmonic(amplitude="100 m/s^2", frequency="50 Hz", direction="y"),
    )
    assert np.abs(run.arrays.velocity).max() < 1e-4
    assert np.abs(run.arrays.centre_of_mass[:, 0, 1]).max() > 1e-3
    assert run.arrays.base_acceleration[:, 1] == pytest.approx(100 * np.sin(100 * np.pi * run.arrays.time), abs=1e-9)


def test_two_cavities_at_one_point_share_its_motion() -> None:
    """Two dampers at a point have the same displacement, and each has its own mass and particles."""
    run = simulate(damper(), damper(name="second", particles=balls(10)))
    assert run.arrays.dampers == ("damper", "second")
    assert np.array_equal(run.arrays.cavity_displacement[:, 0], run.arrays.cavity_displacement[:, 1])
    assert run.arrays.particle_mass[0] == pytest.approx(6 * run.arrays.particle_mass[1])
    assert np.bincount(run.arrays.particles.damper).tolist() == [60, 10]


def test_a_displaced_cavity_takes_its_particles_along() -> None:
    """The particles of a structure with an initial displacement start in its cavity."""
    run = simulate(structure=rb.SDOF(mass=0.1, stiffness=1e4, displacement="5 mm"))
    assert run.arrays.cavity_displacement[0, 0, 0] == pytest.approx(5e-3)
    made = damper()
    centre = made.start.position.mean(axis=0)
    assert run.arrays.centre_of_mass[0, 0] == pytest.approx(centre, abs=1e-12)


def test_samples_are_at_the_requested_times() -> None:
    """The step divides the time between samples, so that the samples are exactly at their times."""
    run = simulate(output=rb.Output(rate="3 kHz"), duration=0.02)
    assert run.arrays.time == pytest.approx(np.arange(61) / 3000, rel=1e-12)


@pytest.mark.parametrize(
    ("duration", "times", "samples"),
    [
        (0.02, np.linspace(0, 0.02, 7), 7),
        (0.01, [0.0025, 0.005, 0.0075, 0.01], 5),
        (0.01, [0.0025, 0.005, 0.0075], 5),
        (0.02, [0.005, 0.01, 0.015], 5),
        (0.01, [0.005, 0.01, 0.015], 3),
        (0.021, np.cumsum(np.full(7, 0.003)), 8),
        (0.01, [0.01], 2),
        (0.01, [], 2),
    ],
)
def test_times_even_with_both_ends_are_recorded(duration: float, times: Sequence[float], samples: int) -> None:
    """Output times that are evenly spaced together with 0 and the end are accepted with or without these two."""
    run = simulate(output=rb.Output(times=times), duration=duration)
    assert run.arrays.time == pytest.approx(np.linspace(0, duration, samples), rel=1e-12)


def test_force_on_the_cavity_is_what_changes_momentum() -> None:
    """Between samples, the impulse of the cavity on the particles equals the change of their momentum."""
    run = simulate(damper(gravity=(0, 0, 0)), output=rb.Output(rate="1 MHz"), duration=0.005)
    assert run.diagnostics["step"] == pytest.approx(1e-6)  # every step is a sample
    force = run.arrays.cavity_force
    impulse = -0.5 * (force[1:] + force[:-1]) * np.diff(run.arrays.time)[:, None, None]
    change = np.diff(run.arrays.momentum, axis=0)
    assert np.abs(impulse).max() > 0
    np.testing.assert_allclose(impulse, change, rtol=0, atol=1e-12 * np.abs(run.arrays.momentum).max())


def test_loss_and_mass_of_a_shaken_cavity_in_two_ways() -> None:
    """Force times velocity and the ledger give the same loss; momentum and recorded forces give the same mass."""
    run = simulate(damper(gravity=(0, 0, 0)), structure=shaker(), duration=0.25, output=rb.Output(rate="16 kHz"))
    result = rb.analysis.shaken_cavity(run, frequency=40, after=0.1)
    taken, supplied = result.active_power.values
    labelled = rb.analysis.shaken_cavity(run, frequency=result.active_power.sum() * 0 + 40, after=0.1)
    assert labelled.equals(result)
    assert result.attrs["cycles"] == 6
    assert taken == pytest.approx(supplied, rel=0.01)
    assert supplied == pytest.approx(float(result.dissipated_power + result.stored_power), rel=1e-9)
    assert result.effective_mass[0] == pytest.approx(float(result.effective_mass[1]), rel=0.01)
    assert float(result.reduced_loss[1]) == pytest.approx(
        supplied / 40 / (run.arrays.particle_mass[0] * (0.003 * 80 * math.pi) ** 2), rel=1e-6
    )
    times = run.arrays.time
    window = times >= 0.1 - 1e-9
    turn = np.exp(-80j * math.pi * times[window])
    moved, pushed = (
        2 / 0.15 * np.trapezoid(values[window] * turn, times[window])
        for values in (run.arrays.base_velocity[:, 0], -run.arrays.cavity_force[:, 0, 0])
    )
    power = complex(np.conj(pushed) * moved / 2)
    assert power.real == pytest.approx(taken, rel=0.01)
    assert -2 * power.imag / (80 * math.pi * abs(moved) ** 2) == pytest.approx(
        float(result.effective_mass[0]), rel=0.01
    )
    with pytest.raises(ValueError, match="damper is one of damper"):
        rb.analysis.shaken_cavity(run, frequency=40, damper="none")
    with pytest.raises(ValueError, match="no whole cycle"):
        rb.analysis.shaken_cavity(run, frequency=40, after=0.24)
    with pytest.raises(ValueError, match=r"at 50 Hz is .* % of its mean square speed"):
        rb.analysis.shaken_cavity(run, frequency=50)
    with pytest.raises(TypeError, match="frequency is '40 Hz', but a number is needed, in Hz"):
        rb.analysis.shaken_cavity(run, frequency="40 Hz")
    coarse = simulate(damper(gravity=(0, 0, 0)), structure=shaker(), duration=0.25, output=rb.Output(rate=200))
    with pytest.raises(ValueError, match=r"5 samples in a cycle of 40 Hz, and needs 8\n  try: rb.Output\(rate=800\)"):
        rb.analysis.shaken_cavity(coarse, frequency=40)


def test_the_effective_mass_of_a_fixed_ball_is_its_mass() -> None:
    """The effective mass of a ball between walls without clearance is its own mass, and it dissipates nothing."""
    held = damper(
        particles=rb.Particles(material="steel", diameter="4 mm"),
        packing=rb.Positions(positions=[[0, 0, 0]]),
        cavity=rb.Box(size=("4 mm", "20 mm", "20 mm")),
        gravity=(0, 0, 0),
        contact=rb.Tsuji(restitution=1.0),
        softening=1,
    )
    run = simulate(held, structure=shaker(amplitude="0.1 mm"), duration=0.05, output=rb.Output(rate="20 kHz"))
    result = rb.analysis.shaken_cavity(run, frequency=40)
    assert result.effective_mass.values == pytest.approx(np.full(2, run.arrays.particle_mass[0]), rel=0.01)
    assert np.abs(result.loss_factor.values).max() < 0.01


def test_a_particle_that_leaves_is_reported() -> None:
    """A fast particle passes a far too soft wall: the run ends and reports the particle, the time and the step."""
    run = simulate(damper(particles=balls(1), velocity=(100, 0, 0), softening=1e6), structure=rb.Fixed(), duration=1e-3)
    assert run.status == "escaped"
    assert run.message.startswith("Particle 0, in 'damper', left its cavity at 9")
    assert "The step was" in run.message
    assert run.arrays.time[-1] < 1e-3


@pytest.mark.parametrize(("softening", "advice"), [(1e6, "softening"), (1, "stiffer contact")])
def test_what_to_try_when_a_particle_leaves(softening: float, advice: str) -> None:
    """The message proposes less softening or, without softening, a stiffer contact."""
    soft = rb.Linear(stiffness="1 kN/m" if softening > 1 else "1 N/m", restitution=0.7)
    fast = damper(particles=balls(1), contact=soft, friction=0, velocity=(100, 0, 0), softening=softening)
    run = simulate(fast, structure=rb.Fixed(), duration=1e-3)
    assert run.status == "escaped"
    assert advice in run.message


def test_a_bed_that_does_not_settle_is_named_as_in_the_file() -> None:
    """The error of a failed settling names damper.packing of a single damper and dampers[1].packing of the second."""
    tight = damper(particles=balls(220), packing=rb.Settled())
    for dampers, place in (((tight,), "damper.packing"), ((damper(name="a"), tight), "dampers[1].packing")):
        with pytest.raises(rb.CaseError) as caught:
            simulate(*dampers)
        assert str(caught.value).splitlines()[0] == place


def test_laws_are_not_used_beyond_their_domain() -> None:
    """An impact above the speed range of its restitution law ends the run with a status."""
    fast = damper(contact=rb.Tsuji(restitution=rb.JacksonGreen()), velocity=(200, 0, 0), gravity=(0, 0, 0), softening=1)
    run = simulate(fast, structure=rb.Fixed(), duration=1e-3, output=rb.Output())
    assert run.status == "law_domain"
    assert "200 m/s" in run.message
    assert not any("warning" in note for note in run.notes)


def test_an_open_ledger_is_a_status() -> None:
    """With the longest permitted step, too long for the contact, the energies do not add up and the run ends."""
    alone = damper(
        particles=rb.Particles(material="steel", diameter="3 mm"),
        packing=rb.Positions(positions=[[0, 0, 0]], velocities=[[0.1, 0, 0]]),
        cavity=rb.Box(size=("4 mm", "20 mm", "20 mm")),
        contact=rb.Tsuji(restitution=0.9),
        friction=None,
        gravity=(0, 0, 0),
        softening=1,
    )
    long, short = (
        simulate(alone, structure=rb.Fixed(), duration=0.02, output=rb.Output(), method=rb.Dem(dt=dt))
        for dt in ("2.8 us", "1 us")
    )
    assert (long.status, short.status) == ("energy_error", "finished")
    assert 0.01 < long.energy_residual < 0.1
    assert "0.04" in long.message
    assert short.energy_residual < 0.01


def test_advice_about_an_open_ledger_helps() -> None:
    """The time step that the message of an energy error names makes the same run finish.

    The advice was a smaller `fraction`, which changes nothing where `dt` is given or another limit sets the step; no test
    followed it.
    """
    alone = damper(
        particles=rb.Particles(material="steel", diameter="3.4 mm"),
        packing=rb.Positions(positions=[[0, 0, 0]], velocities=[[0.13, 0, 0]]),
        cavity=rb.Box(size=("4.4 mm", "20 mm", "20 mm")),
        contact=rb.Tsuji(restitution=0.88),
        friction=None,
        gravity=(0, 0, 0),
        softening=1,
    )
    run = simulate(alone, structure=rb.Fixed(), duration=0.02, output=rb.Output(), method=rb.Dem(dt="3 us"))
    assert run.status == "energy_error"
    advised = re.search(r'Halve the time step: dt = "(.+ s)"', run.message)
    assert advised
    again = simulate(alone, structure=rb.Fixed(), duration=0.02, output=rb.Output(), method=rb.Dem(dt=advised[1]))
    assert again.ok


@pytest.mark.parametrize("ending", ["zero_force", "zero_overlap"])
def test_laws_without_rebound_end_the_run(ending: str) -> None:
    """An impact so fast that the extrapolated law gives no rebound ends the run with a status, for each ending."""
    law = rb.Tsuji(restitution=rb.JacksonGreen(extrapolate=True), ending=ending)
    lead = rb.Particles(material="lead", diameter="4 mm", count=1)
    fast = damper(particles=lead, contact=law, velocity=(20, 0, 0), gravity=(0, 0, 0), softening=1)
    run = simulate(fast, structure=rb.Fixed(), duration=2e-3, output=rb.Output())
    assert run.status == "no_rebound"
    assert "Particle 0, in 'damper'" in run.message and " 20 m/s " in run.message
    assert np.isfinite(run.arrays.particles.position).all()
    assert not any("warning: only" in note or "overlaps reach" in note for note in run.notes)


@pytest.mark.parametrize("how", ["ctrl-c", "false"])
def test_a_stopped_run_keeps_what_it_has(how: str) -> None:
    """Ctrl-C and a progress function that returns False end the run with a status; earlier samples are returned."""

    def stop(done: int, total: int) -> bool:
        if done < 1e-4 * total:  # a busy machine may ask before the first sample
            return True
        if how == "ctrl-c":
            raise KeyboardInterrupt
        return False

    case = rb.Case(structure=rb.Fixed(), damper=damper(velocity=(1, 0, 0)), duration=60, output=rb.Output(rate="1 kHz"))
    run = rb.simulate(case, progress=stop)
    assert run.status == "interrupted"
    assert 0 < run.arrays.time[-1] < 60


def test_too_long_a_step_is_refused_before_the_run() -> None:
    """A step above the bound is refused."""
    with pytest.raises(rb.CaseError, match="is too long: the bound is"):
        simulate(method=rb.Dem(dt="1 ms"))


@pytest.mark.parametrize("dt", [1e-25, 5e-324])
def test_a_step_that_needs_too_many_steps_is_refused(dt: float) -> None:
    """A step so short that the core cannot count the steps is refused, with the field, the count and advice."""
    with pytest.raises(rb.CaseError) as caught:
        simulate(method=rb.Dem(dt=dt))
    place, message, hint = str(caught.value).splitlines()
    assert (place, hint) == ("method.dt", '  try: dt = "auto"')
    assert message.startswith(f"  dt = {dt:.3g} s is too short: the run would take ")
    assert message.endswith(f"e+{'23' if dt == 1e-25 else '322'} steps, and at most 9.22e+18 can be counted")


def test_an_automatic_step_that_needs_too_many_steps_is_refused() -> None:
    """If the automatic step is too short to count, the message advises a larger fraction."""
    with pytest.raises(rb.CaseError, match=r"the automatic dt = .* is too short.*\n  try: a larger fraction"):
        simulate(method=rb.Dem(fraction=1e-25))


def test_cases_of_both_kinds_run_side_by_side() -> None:
    """Runs of impact dampers and particle dampers are returned in the order of the cases."""
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="5 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.9)
    )
    structure = rb.SDOF(mass=1, stiffness=1e4, velocity=0.1)
    impact = rb.Case(structure=structure, damper=ball, duration=0.01)
    space = rb.Case(structure=structure, damper=damper(), duration=0.01)
    kinds = ["particles" in run.groups for run in rb.simulate_many([space, impact, space])]
    assert kinds == [True, False, True]


def test_a_run_is_the_same_in_a_file(tmp_path: Path) -> None:
    """A saved run reads back equal; CSV and MAT files have its variables; the summary lists its losses."""
    from scipy.io import loadmat

    run = simulate(duration=0.01)
    assert rb.load(run.save(tmp_path / "run.nc")) == run
    files = run.to_csv(tmp_path)
    assert [file.name for file in files] == ["motion.csv", "energy.csv", "particles.csv"]
    assert "cavity_force damper z [N]" in files[0].read_text(encoding="utf-8").splitlines()[0]
    content = loadmat(run.to_mat(tmp_path / "run.mat"), simplify_cells=True)
    assert content["particles"]["position"].shape == (60, 3)
    assert run.motion.cavity_force.dims == ("time", "damper", "axis")
    assert run.energy.sliding_loss.sel(partner="wall").attrs["units"] == "J"
    text = str(run.summary())
    for message in ("lost in sliding", "lost at walls", "particle steps per second", "limited by the contact of steel"):
        assert message in text
    assert run.summary().values["particles"] == 60
    with pytest.raises(AttributeError, match="has no 'impacts': a 3-D run counts its contacts"):
        _ = run.impacts


def test_the_summary_of_a_run_without_contacts_is_finite() -> None:
    """The summary of a particle at rest has no infinite number of steps per contact."""
    still = damper(particles=balls(1), gravity=(0, 0, 0))
    text = str(simulate(still, structure=rb.Fixed(), duration=1e-3, output=rb.Output()).summary())
    assert "steps in the shortest contact" in text
    assert "inf" not in text


def test_figures_are_drawn() -> None:
    """The figures of a run with two cavities have a panel for each cavity."""
    run = simulate(damper(), damper(name="second", particles=balls(10)), duration=0.01)
    assert len(run.plot.motion().axes) == 4
    assert len(run.plot.energy(size="page").axes) == 2


JUST_TOUCHING: dict[str, dict[str, Any]] = {
    "Mindlin": {},
    "rolling": {"rolling": 0.05},
    "yielding": {"contact": rb.Thornton()},
    "linear": {
        "contact": rb.Linear(stiffness="200 kN/m", restitution=0.7),
        "friction": rb.LinearSpring(0.3, ratio=0.4),
    },
}


@pytest.mark.parametrize("law", JUST_TOUCHING)
def test_particles_may_just_touch_at_the_start(law: str) -> None:
    """Balls that touch each other and the walls to the last digit move as balls with a small distance do."""
    rng = np.random.default_rng(1)
    kicks = rng.normal(0, 0.1, (27, 3))

    def moved(diameter: float, apart: float) -> Any:
        side = 3 * diameter
        places = diameter * (1 + apart) * np.array(list(np.ndindex(3, 3, 3))) - diameter * (1 + apart)
        made = damper(
            particles=rb.Particles(material="steel", diameter=diameter, count=27),
            cavity=rb.Box(size=(side * (1 + 10 * apart),) * 3),
            packing=rb.Positions(positions=places),
            **JUST_TOUCHING[law],
        )
        case = rb.Case(structure=rb.Fixed(), damper=made, duration=1e-3, method=rb.Dem(dt="1 us"))
        packed = pack_particles(prepare(case))
        (cavity,) = packed.cavities
        dem = _core.Dem(packed.replace(cavities=[cavity.replace(velocity=kicks)]))
        assert dem.run(300)
        return dem.state().cavities[0].velocity

    for diameter in (1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 7e-3, 11e-3):
        touching, apart = moved(diameter, 0.0), moved(diameter, 1e-9)
        assert np.abs(touching).max() > 1e-3
        assert np.allclose(touching, apart, rtol=0, atol=1e-4)


@pytest.mark.parametrize("width", [2e-6, 4e-5, 1.5e-4])
def test_no_impulse_of_a_record_is_lost_between_two_steps(width: float) -> None:
    """Records with knots closer than the step transfer their full impulse to the structure and the base."""
    tops = np.array([1.001e-4, 7.3e-4, 1.9e-3])
    times = np.concatenate([[0.0], (tops[:, None] + width * np.array([-0.5, 0, 0.5])).ravel(), [1.0]])
    signal = {"times": times, "values": [0.0, *[0, 100, 0] * 3, 0]}
    impulse = 1.5 * width * 100
    lone = damper(particles=balls(1), gravity=(0, 0, 0), softening=1e6)
    usual: dict[str, Any] = {"duration": 0.003, "method": rb.Dem(dt="1e-4 s")}
    pushed = simulate(lone, structure=rb.SDOF(mass=0.1, stiffness=0), load=rb.Record(**signal), **usual)
    assert pushed.diagnostics["step"] == pytest.approx(1e-4)
    assert pushed.arrays.velocity[-1, 0] == pytest.approx(impulse / 0.1, rel=1e-12)
    moved = simulate(lone, structure=rb.Fixed(), base=rb.Record(**signal, direction="x"), **usual)
    mass = moved.arrays.particle_mass[0]
    assert moved.arrays.momentum[-1, 0, 0] == pytest.approx(-mass * impulse, rel=1e-12)


@pytest.mark.parametrize("mass", [1.0, 1e-4, 1e-8])
def test_restitution_of_an_impact_on_a_light_structure(mass: float) -> None:
    """The step adapts to the short impacts on a light structure, so that restitution is exact for any mass."""
    one = damper(particles=balls(1), gravity=(0, 0, 0), velocity=(1.0, 0, 0), softening=100)
    free = rb.SDOF(mass=mass, stiffness=0)
    run = simulate(one, structure=free, duration=11e-3, output=rb.Output(rate="2 kHz"))
    apart = run.arrays.velocity[-1, 0] - run.arrays.momentum[-1, 0, 0] / run.arrays.particle_mass[0]
    assert run.counts["first_touches_wall"] == 1
    assert run.diagnostics["steps_per_contact"] >= 40
    assert apart == pytest.approx(0.7, abs=1e-3)


def test_floating_particles_take_up_no_energy_from_the_base() -> None:
    """Without contacts the stored power is zero, although the base ends the window at another speed."""
    alone = damper(
        particles=rb.Particles(material="steel", diameter="4 mm"),
        packing=rb.Positions(positions=[[0, 0, 0]], velocities=[[0.01, 0, 0]]),
        gravity=(0, 0, 0),
    )
    motion = [rb.Harmonic(amplitude="0.1 mm", frequency=frequency) for frequency in ("40 Hz", "67 Hz")]
    run = simulate(alone, structure=rb.Shaker(motion=motion), duration=0.1)
    assert not run.arrays.contacts.any()
    result = rb.analysis.shaken_cavity(run, frequency=40)
    mass, speed = run.arrays.particle_mass[0], result.attrs["velocity_amplitude"]
    assert abs(float(result.stored_power)) < 1e-4 * mass * speed**2 * 40
