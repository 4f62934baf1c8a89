"""Steppers against whole runs, balances of momentum and energy, and their own saved states."""

from __future__ import annotations

import re
import struct
from typing import Any

import numpy as np
import pytest
from support.ctrl_c import CtrlC

import rattlebox as rb

FREQUENCY, AMPLITUDE = 20.0, 2e-3
RATE = 2 * np.pi * FREQUENCY
MOTION = rb.Harmonic(amplitude=f"{AMPLITUDE} m", frequency=f"{FREQUENCY} Hz")
TSUJI = rb.Tsuji(restitution=0.6)


def ball(**changes: Any) -> rb.ImpactDamper:
    """A ball with room to fly."""
    given = {"ball": rb.Sphere(radius="10 mm", material="steel"), "gap": "2 mm", "contact": TSUJI}
    return rb.ImpactDamper(**{**given, **changes})


def box(count: int = 200, **changes: Any) -> rb.ParticleDamper:
    """A box of balls."""
    given = {
        "particles": rb.Particles(material="steel", diameter="6 mm", count=count),
        "cavity": rb.Box(size=("50 mm", "50 mm", "50 mm")),
        "contact": rb.Tsuji(restitution=0.75),
        "softening": 1e3,
    }
    return rb.ParticleDamper(**{**given, **changes})


def speed(time: float) -> float:
    """Velocity of the shaker [m/s]."""
    return AMPLITUDE * RATE * float(np.cos(RATE * time))


def run_shaken(damper: Any, duration: float, **changes: Any) -> rb.Run:
    """Run a damper on the shaker."""
    return rb.simulate(
        rb.Case(structure=rb.Shaker(motion=MOTION), damper=damper, duration=duration, **changes), progress=False
    )


# ---- impact dampers


def driven_ball(steps: int, duration: float, **options: Any) -> tuple[float, float, float]:
    """Return the velocity of the ball, the loss, and the residual of the energy over the loss, after steps."""
    damper = ball(velocity=speed(0))
    stepper = rb.Stepper(damper, velocity=speed(0), **options)
    mass, start = float(damper.masses[0]), stepper.advance(1e-9, velocity=speed(1e-9)).stored
    velocity, work, loss, stored = speed(0), 0.0, 0.0, start
    for time in 1e-9 + (duration - 1e-9) * np.arange(1, steps + 1) / steps:
        before = stepper.time
        result = stepper.advance(time, velocity=speed(time))
        velocity -= result.force * (stepper.time - before) / mass
        work, loss, stored = work + result.work, loss + result.loss, result.stored
    return velocity, loss, (stored - start - work + loss) / loss


@pytest.mark.parametrize("method", [rb.EventDriven(), rb.Newton()])
def test_driven_ball_converges_to_the_whole_run(method: Any) -> None:
    """Driven by the shaker's velocity, the tenth impact is reached with second order, and the energy balance closes."""
    times = run_shaken(ball(), 0.3, method=method).impacts["time"].values
    duration = round(float(times[9] + times[10]) / 2, 6)
    whole = run_shaken(ball(), duration, method=method)
    assert whole.impacts.sizes["impact"] == 10
    expected = float(whole.motion.ball_velocity.values[-1].item()) + speed(duration)
    loss = float(whole.impacts["energy_lost"].sum())
    errors = []
    for steps in (1000, 4000, 16000):
        velocity, lost, residual = driven_ball(steps, duration, method=method)
        assert abs(residual) < 1e-10
        errors.append((abs(velocity - expected), abs(lost / loss - 1)))
    assert max(errors[-1]) < 1e-6
    orders = np.log(np.array(errors)[:-1] / np.array(errors)[1:]) / np.log(4)
    assert (orders > 1.6).all()
    assert (orders < 2.6).all()


def test_own_loop_converges_to_the_whole_run() -> None:
    """A mass on a spring in a loop of its own, with the ball as a stepper, approaches the coupled run."""
    structure = rb.SDOF(mass="1 kg", frequency="10 Hz", displacement="5 mm")
    damper = ball(gap="3 mm")
    case = rb.Case(structure=structure, damper=ball(gap="3 mm"), duration="0.25 s")
    whole = rb.simulate(case, progress=False)
    assert whole.impacts.sizes["impact"] >= 4
    stiffness, errors = (2 * np.pi * 10) ** 2, []
    for steps in (4000, 16000, 64000):
        stepper = rb.Stepper(damper, structure_mass="1 kg")
        x, v, force, h = 5e-3, 0.0, 0.0, 0.25 / steps
        for k in range(1, steps + 1):
            v += 0.5 * h * (force - stiffness * x)
            x += h * v
            force = stepper.advance(k * h, velocity=v).force
            v += 0.5 * h * (force - stiffness * x)
        errors.append(abs(x - float(whole.motion.displacement.values[-1].item())))
    assert errors[-1] < 2e-6
    assert errors[0] > 3 * errors[-1]


def test_a_contact_continues_in_the_next_step() -> None:
    """With steps much shorter than the contact the impulse adds up to that of the impact."""
    damper = ball(velocity="0.5 m/s")
    mass = float(damper.masses[0])
    stepper, impulse, pushed = rb.Stepper(damper), 0.0, 0
    for k in range(1, 5001):
        force = stepper.advance(k * 1e-6, acceleration=0.0).force
        impulse, pushed = impulse + force * 1e-6, pushed + (abs(force) > 1e-6)
    assert 20 < pushed < 100
    assert impulse == pytest.approx(mass * 0.5 * 1.6, rel=1e-6)


def test_a_row_with_gravity_rests_on_the_wall() -> None:
    """At rest on the lower wall, the mean force of a row of balls is its weight."""
    damper = ball(ball=[rb.Sphere(radius="10 mm", material="steel")] * 3, gravity="9.81 m/s^2")
    stepper = rb.Stepper(damper)
    for k in range(1, 40):
        result = stepper.advance(0.05 * k, acceleration=0.0)
    assert result.force == pytest.approx(9.81 * float(np.sum(damper.masses)), rel=1e-6)


def deviation(ratio: float, step: float, exchanges: int = 1, relaxation: float = 1.0) -> float:
    """Return the largest deviation of the force in steps 150 to 200, for a ball that lies on a structure with less mass.

    The structure is free and carries the ball; a push of 1 % of the weight accelerates both.
    """
    damper = ball(gravity="9.81 m/s^2", start="2 mm")
    mass = float(damper.masses[0])
    stepper = rb.Stepper(damper, structure_mass=mass / ratio)
    for _ in range(60):
        weight = stepper.advance(stepper.time + 0.02, acceleration=0.0).force
    velocity, force, deviations = 0.0, weight, []
    for _ in range(200):
        before, to = stepper.save(), stepper.time + step
        for exchange in range(exchanges):
            if exchange > 0:
                stepper.restore(before)
            new = velocity + step * ratio / mass * (force - 0.99 * weight)
            force += relaxation * (stepper.advance(to, velocity=new).force - force)
        velocity = new
        deviations.append(abs(force / weight - 1))
        if deviations[-1] > 100:
            break
    return max(deviations[150:], default=np.inf)


def test_heavy_balls_need_short_steps_or_several_exchanges() -> None:
    """One exchange is unstable if ball and step are large; repeated with relaxation it gives the force of the motion."""
    unstable = 0.3  # the ball has lost contact, or worse
    for ratio in (0.1, 0.3):
        for step in (2e-5, 1e-4, 5e-4):
            assert deviation(ratio, step) == pytest.approx(0.01 * ratio / (1 + ratio), rel=0.15)
    assert deviation(0.8, 2e-5) < 0.02 > deviation(0.8, 5e-4)
    assert deviation(0.8, 1e-4) > unstable
    assert deviation(1.2, 2e-5) < 0.02
    for step in (1e-4, 5e-4, 2e-3):
        assert deviation(1.2, step) > unstable
    assert deviation(2.0, 5e-4, exchanges=4) > unstable
    for ratio in (1.2, 2.0, 5.0):
        for step in (5e-4, 2e-3):
            repeated = deviation(ratio, step, exchanges=4, relaxation=1 / (1 + ratio))
            assert repeated == pytest.approx(0.01 * ratio / (1 + ratio), rel=0.01)
    assert deviation(2.0, 1e-4, exchanges=4, relaxation=1 / 3) == pytest.approx(0.01 * 2 / 3, rel=0.1)


@pytest.mark.parametrize(
    ("system", "mass", "named"),
    [
        (ball(), None, None),
        (ball(), "2 kg", None),
        (ball(), "0.5 kg", r"6.6 % of the effective mass .* lasts 69 µs at 1 m/s"),
        (ball(), "25 g", r"1.3 times the effective mass .* relaxation of 0.43"),
    ],
)
def test_dampers_that_are_heavy_for_their_structure_have_a_note(system: Any, mass: Any, named: str | None) -> None:
    """The note names the ratio of the masses, the duration of a contact, and above 0.3 a relaxation."""
    notes = rb.Stepper(system, structure_mass=mass).notes
    assert (len(notes) == 1 and re.search(named, notes[0])) if named else notes == ()


# ---- particle dampers


def test_shaken_box_has_the_statistics_of_the_whole_run() -> None:
    """Loss, force and moment of 200 shaken balls agree with the whole run within their scatter."""
    damper, periods = box(), 20
    motion = rb.Harmonic(amplitude="4 mm", frequency="25 Hz")
    period = 1 / 25
    whole = rb.simulate(
        rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration=periods * period), progress=False
    )
    energy = np.interp(np.arange(periods + 1) * period, whole.energy.time, whole.energy.losses)
    per_period = np.diff(energy)[5:]
    stepper = rb.Stepper(damper, motion=motion)
    top, h = 4e-3 * 2 * np.pi * 25, period / 100
    result, losses, forces, moments, work, start = None, [], [], [], 0.0, None
    for k in range(1, periods * 100 + 1):
        result = stepper.advance(k * h, velocity=(top * (np.cos(2 * np.pi * 25 * k * h) - 1), 0, 0))
        start = result.stored - result.work + result.loss if start is None else start
        work += result.work
        losses.append(result.loss)
        forces.append(result.force)
        moments.append(result.moment)
    own = np.sum(np.reshape(losses, (periods, 100)), axis=1)[5:]
    scatter = np.hypot(own.std(), per_period.std()) / np.sqrt(own.size)
    assert abs(own.mean() - per_period.mean()) < 4 * scatter + 0.02 * per_period.mean()
    weight = -9.81 * float(whole.motion.particle_mass.sum())
    assert np.mean(forces[500:], axis=0)[2] == pytest.approx(weight, rel=0.02)
    late = whole.motion.sel(time=slice(5 * period, None))
    mean = late.cavity_moment.mean("time").values.ravel()
    spread = late.cavity_moment.std("time").values.ravel() / np.sqrt(15)
    assert (np.abs(np.mean(moments[500:], axis=0) - mean) < 4 * spread).all()
    assert result is not None
    assert abs(result.stored - start - work + sum(losses)) < 0.01 * sum(losses)


def test_momentum_is_kept_in_free_flight() -> None:
    """Particles that touch nothing exert no force and no moment, however the cavity moves."""
    positions = [(0, 0, 0), (0.012, 0, 0.003)]
    damper = box(2, gravity=(0, 0, 0), packing=rb.Positions(positions=positions, velocities=[(0.1, 0, 0), (0, 0.2, 0)]))
    stepper = rb.Stepper(damper)
    start = stepper.advance(1e-5, acceleration=(0, 0, 0)).stored
    time = 1e-5
    for k, length in enumerate((1e-3, 3.3e-4, 2e-3, 1e-4, 1e-3)):
        time += length
        result = stepper.advance(time, acceleration=(30 * (-1) ** k, 5, -4))
        mass = float(np.sum(damper.contents.mass))
        assert np.abs(result.force).max() < 1e-9 * mass * 30
        assert np.abs(result.moment).max() < 1e-12
        assert result.stored == pytest.approx(start, rel=1e-9)


def test_steps_are_only_pauses_while_the_inputs_stay() -> None:
    """Without a change of the inputs, short steps have the energies of long ones."""
    one, many = rb.Stepper(box(60), motion=MOTION), rb.Stepper(box(60), motion=MOTION)
    step = 2e-4
    whole = [one.advance(10 * step * k, acceleration=(0.0, 0.0, 2.0)) for k in (1, 2)]
    parts = [many.advance(step * k, acceleration=(0.0, 0.0, 2.0)) for k in range(1, 21)]
    assert parts[-1].stored == pytest.approx(whole[-1].stored, rel=1e-6)
    assert sum(part.work for part in parts) == pytest.approx(sum(part.work for part in whole), rel=1e-6)


def test_contacts_beyond_the_limits_have_warnings() -> None:
    """A motion that is larger than the expected one warns of few steps and deep overlaps; the expected one does not."""
    expected = rb.Harmonic(amplitude="1 mm", frequency="20 Hz")
    stepper = rb.Stepper(box(30, softening="auto"), motion=expected)
    for speed, warned in ((0.1, False), (30.0, True)):
        for k in range(40):
            stepper.advance(stepper.time + 1e-3, velocity=(speed * (-1) ** (k // 10), 0, 0))
        warnings = [note for note in stepper.notes if note.startswith("warning")]
        assert any("steps in the shortest contact" in note for note in warnings) == warned
        assert any("overlaps reach" in note for note in warnings) == warned
    state = stepper.save()
    again = rb.Stepper(box(30, softening="auto"), motion=expected)
    again.restore(state)
    assert again.notes == stepper.notes
    hit = rb.Stepper(ball(velocity="40 m/s", contact=rb.Tsuji(restitution=0.6)))
    assert hit.notes == ()
    hit.advance(1e-3, acceleration=0.0)
    assert any("overlaps in damper reach" in note for note in hit.notes)


# ---- steps of any length


def rough_box(friction: Any, rolling: Any = None, contact: Any = None, **changes: Any) -> rb.ParticleDamper:
    """A bed that slides, rolls and bounces; its engine has steps of some microseconds."""
    given: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="9 mm", count=8),
        "cavity": rb.Box(size=("80 mm", "50 mm", "40 mm")),
        "contact": contact or rb.Tsuji(restitution=0.8),
        "friction": friction,
        "rolling": rolling,
        "packing": rb.Settled(seed=4),
        "softening": 200.0,
    }
    return rb.ParticleDamper(**{**given, **changes})


SPRING = rb.LinearSpring(0.2, ratio=0.3)
BEDS: dict[str, Any] = {
    "Mindlin": lambda: rough_box(0.15),
    "Mindlin, rolling": lambda: rough_box(0.4, rb.Rolling(0.08, damping=0.2)),
    "linear spring, rolling": lambda: rough_box(
        SPRING, 0.05, rb.Linear(stiffness="300 kN/m", restitution=0.5), softening=1.0
    ),
    "yielding": lambda: rough_box(0.25, None, rb.Thornton(yield_pressure="0.8 GPa")),
}
MICRO = 1e-6
PATTERNS: dict[str, Any] = {
    "constant": lambda random, k: 40 * MICRO,
    "constant, shorter than the engine's": lambda random, k: 2 * MICRO,
    "two in turn": lambda random, k: (8.5 if k % 2 else 6.2) * MICRO,
    "very different": lambda random, k: (5 if k % 2 else 0.08) * MICRO,
    "uniform": lambda random, k: random.uniform(1, 5.5) * MICRO,
    "log-uniform": lambda random, k: 10 ** random.uniform(-1.3, 2) * MICRO,
    "events": lambda random, k: (0.7 if k % 4 == 0 else 90) * MICRO,
}


def audited(damper: Any, length: Any, duration: float, seed: int = 2) -> tuple[float, float]:
    """Return the loss of a shaken bed, and the largest |change of stored - work + loss| over the loss."""
    stepper = rb.Stepper(damper, motion=rb.Harmonic(amplitude="1 mm", frequency="60 Hz"))
    random, steps, work, loss, worst = np.random.default_rng(seed), 0, 0.0, 0.0, 0.0
    start = stepper._core.stored
    while stepper.time < duration:
        steps += 1
        to = stepper.time + length(random, steps)
        r = stepper.advance(to, velocity=(0.25 * np.sin(380 * to), 0, 0.1 * np.sin(250 * to)))
        work, loss = work + r.work, loss + r.loss
        worst = max(worst, abs(r.stored - start - work + loss))
    assert stepper.energy_residual < 1e-3
    return loss, worst / loss


@pytest.mark.parametrize("bed", BEDS)
def test_the_loss_does_not_depend_on_the_lengths_of_the_steps(bed: str) -> None:
    """The loss of a bed with friction is that of constant steps, and balanced within 1e-3, for steps of any lengths.

    No test had seen that sliding losses grew with every change of the step: all steppers of beds had constant steps, or
    no friction.
    """
    duration = 0.012
    expected, _ = audited(BEDS[bed](), PATTERNS["constant, shorter than the engine's"], duration)
    for name, length in PATTERNS.items():
        loss, imbalance = audited(BEDS[bed](), length, duration)
        assert imbalance < 1e-3, name
        assert loss == pytest.approx(expected, rel=0.01), name


def test_a_changed_step_keeps_a_sliding_ball() -> None:
    """A ball that slides on the floor loses mu m g per length, with constant and with random steps."""
    damper = rough_box(
        0.2,
        particles=rb.Particles(material="steel", diameter="9 mm", count=1),
        packing=rb.Positions(positions=[(0, 0, -0.0155)], velocities=[(0.3, 0, 0)], spins=[(0, 0, 0)]),
    )
    losses = []
    for name in ("constant", "uniform", "log-uniform", "very different"):
        stepper = rb.Stepper(damper, motion=rb.Harmonic(amplitude="1 mm", frequency="60 Hz"))
        random, k, loss = np.random.default_rng(1), 0, 0.0
        while stepper.time < 0.02:
            k += 1
            to = min(stepper.time + PATTERNS[name](random, k), 0.02)
            loss += stepper.advance(to, acceleration=(0, 0, 0)).loss
        losses.append(loss)
    mass = float(damper.contents.mass[0])
    # Until the ball rolls, 2/7 of the kinetic energy is lost; the ball settles a little at first.
    assert losses[0] < 2 / 7 * 0.5 * mass * 0.3**2 * 1.1
    assert losses == pytest.approx([losses[0]] * 4, rel=2e-3)


def test_energies_that_do_not_balance_stop_the_stepper() -> None:
    """An imbalance above 1 % of the energy put in is the status energy_error; an earlier state can be restored.

    Nothing compared the energies of a step before, so that a wrong loss had no consequence.
    """
    stepper = rb.Stepper(box(30), motion=MOTION, method=rb.Dem(fraction=0.1))
    good = stepper.save()

    def go(speed: float) -> None:
        for k in range(20):
            stepper.advance(stepper.time + 1e-3, velocity=(speed * (-1) ** (k // 10), 0, 0))

    with pytest.raises(rb.StepError, match=r"energy_error.*work - loss by 0\.0.*lower `fraction`"):
        go(3.0)
    assert stepper.energy_residual > 0.01
    stepper.restore(good)
    go(0.2)
    assert stepper.energy_residual < 0.01


def test_another_gravity_keeps_the_balance() -> None:
    """A change of gravity between steps changes the stored energy at once, and the balance of the next steps holds."""
    for system in (ball(gravity="9.81 m/s^2"), box(40, gravity=(0, 0, -9.81))):
        stepper = rb.Stepper(system, motion=MOTION if isinstance(system, rb.ParticleDamper) else None)
        axes, largest = len(stepper.inputs), 0.0
        for k in range(60):
            if k % 20 == 10:
                stepper._core.set_gravity([3.0 * k] * axes + [0.0] * (3 - axes))
            before = stepper._core.stored
            r = stepper.advance(stepper.time + 1e-3, velocity=[0.2 * np.sin(0.3 * k)] * axes)
            largest = max(largest, abs(r.stored))
            assert abs(r.stored - before - r.work + r.loss) <= 3e-3 * largest + 1e-15
        assert stepper.energy_residual < 3e-3


@pytest.mark.parametrize(("method", "events"), [(rb.EventDriven, 2), (rb.Newton, 1)])
def test_max_events_bounds_the_contacts_of_a_step(method: Any, events: int) -> None:
    """A step with n contacts needs 2 n + 1 events, or n + 1 with hard impacts; the page said n, and no test counted."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="8 mm", material="steel"), gap="0.4 mm", contact=rb.Tsuji(restitution=0.7)
    )
    # At 0.4 m/s the walls meet the ball at 1 ms, 3.9 ms and 7.9 ms.
    for contacts, end in enumerate((0.5e-3, 2e-3, 6e-3, 9e-3)):
        enough = events * contacts + 1
        for limit in range(1, enough + 1):
            stepper = rb.Stepper(damper, structure_mass="2 kg", velocity=0.4, method=method(max_events=limit))
            if limit == enough:
                assert (stepper.advance(end, velocity=0.4).force != 0) == (contacts > 0)
            else:
                with pytest.raises(rb.StepError):
                    stepper.advance(end, velocity=0.4)


@pytest.mark.parametrize(
    ("system", "given", "status", "named"),
    [
        (
            lambda: rb.Stepper(ball(contact=rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid")))),
            {"acceleration": 1e8},
            "law_domain",
            r"damper \(trailing wall\): the approach speed \d",
        ),
        (lambda: rb.Stepper(ball(), method=rb.EventDriven(max_events=1)), {"velocity": 3.0}, "too_many_events", ""),
        (
            lambda: rb.Stepper(box(20, softening=1e6), motion=MOTION),
            {"acceleration": (3e5, 0, 0)},
            "escaped",
            r"Particle \d+, in 'damper', left its cavity at \d",
        ),
    ],
    ids=["law", "events", "escaped"],
)
def test_a_stopped_stepper_is_saved_and_restored_as_stopped(system: Any, given: Any, status: str, named: str) -> None:
    """The state after a failed step restores a stepper that stays stopped, with the same reason; earlier states continue.

    Only states of healthy steppers were saved by tests; after a failure the 1-D engine holds no sample, which was read.
    """

    def go(one: rb.Stepper) -> None:
        for k in range(1, 100):
            one.advance(0.01 * k, **given)

    stepper, twin = system(), system()
    good = stepper.save()
    with pytest.raises(rb.StepError, match=rf"{status}.*{named}") as first:
        go(stepper)
    assert "nan" not in str(first.value)
    stopped = stepper.save()
    for one in (stepper, twin):
        one.restore(stopped)
        assert one.save() == stopped
        with pytest.raises(rb.StepError) as again:
            one.advance(one.time + 0.01, **given)
        assert str(again.value) == str(first.value)
        one.restore(good)
    fresh = system()
    still = {"acceleration": 0.0 if len(stepper.inputs) == 1 else (0, 0, 0)}
    expected = fresh.advance(1e-4, **still)
    for one in (stepper, twin):
        again_result = one.advance(1e-4, **still)
        assert (again_result.work, again_result.loss, again_result.stored) == (
            expected.work,
            expected.loss,
            expected.stored,
        )


def test_a_start_in_motion_without_its_velocity_has_a_warning() -> None:
    """A jump in the first step that is followed by none is noted; with the initial velocity, and from rest, nothing is."""
    for system, motion in ((ball(), None), (box(10), MOTION)):
        along = (lambda v: v) if motion is None else (lambda v: (v, 0, 0))
        for start, given, warned in ((0.5, 0.0, True), (0.5, 0.5, False), (0.0, 0.0, False)):
            stepper = rb.Stepper(system, velocity=along(given), motion=motion)
            for k in range(1, 6):
                stepper.advance(k * 1e-3, velocity=along(start * np.cos(9e-3 * k) + 0.1 * np.sin(9e-3 * k)))
            warnings = [note for note in stepper.notes if "Stepper(..., velocity=...)" in note]
            assert bool(warnings) == warned
            if warned:
                assert "changed by 501 mm/s in the first step" in warnings[0]


@pytest.mark.parametrize("name", ["box", "ball"])
def test_ctrl_c_ends_a_long_step(name: str) -> None:
    """Ctrl-C ends a step of a day within two seconds, and the stepper is where the step began."""
    system, given = {
        "box": (lambda: rb.Stepper(box(200), motion=MOTION), {"acceleration": (0.0, 0.0, 1.0)}),
        # A ball that comes to rest would take no time.
        "ball": (
            lambda: rb.Stepper(ball(gravity="9.81 m/s^2", contact=rb.Tsuji(restitution=1.0), start=1.0)),
            {"acceleration": 0.0},
        ),
    }[name]
    stepper, twin = system(), system()
    for one in (stepper, twin):
        one.advance(1e-3, **given)
    with CtrlC(0.3) as stop, pytest.raises(KeyboardInterrupt):
        stepper.advance(86400.0, **given)
    assert stop.elapsed() < 2
    assert stepper.time == 1e-3
    ends = [one.advance(3e-3, **given) for one in (stepper, twin)]
    assert [(r.work, r.loss, r.stored) for r in ends] == [(ends[0].work, ends[0].loss, ends[0].stored)] * 2


# ---- both


def steppers() -> dict[str, rb.Stepper]:
    """One of each engine, alone and with a structure."""
    beam = rb.SDOF(mass="1 kg", frequency="15 Hz", damping_ratio=0.01)
    pulse = rb.HalfSine(amplitude="50 N", duration="10 ms")
    return {
        "ball": rb.Stepper(ball()),
        "hard ball": rb.Stepper(ball(), method=rb.Newton()),
        "box": rb.Stepper(box(50), motion=MOTION),
        "structure with ball": rb.Stepper(rb.Case(structure=beam, damper=ball(), load=pulse, duration="1 s")),
        "structure with box": rb.Stepper(rb.Case(structure=beam, damper=box(50), load=pulse, duration="0.5 s")),
    }


NAMES = ("ball", "hard ball", "box", "structure with ball", "structure with box")


def advance(stepper: rb.Stepper, steps: int, seed: Any = 3) -> list[bytes]:
    """Advance by steps of random lengths with random inputs and return every bit of the results."""
    random, seen = np.random.default_rng(seed), []
    for _ in range(steps):
        to, values = stepper.time + random.uniform(1e-4, 3e-3), random.normal(size=len(stepper.inputs))
        given = {"loads": 60 * values} if stepper.points else {"acceleration": 60 * values}
        r = stepper.advance(to, **given)
        seen.append(np.hstack([np.ravel(r.force), r.moment, r.work, r.loss, r.stored]).tobytes())
    return seen


@pytest.mark.parametrize("name", NAMES)
def test_restored_states_continue_with_the_same_bits(name: str) -> None:
    """A state that was saved in the middle of contacts continues with the same bits, in the same and in another stepper."""
    one, other = steppers()[name], steppers()[name]
    advance(one, 40, seed=1)
    state = one.save()
    expected = advance(one, 40)
    one.restore(state)
    assert one.save() == state
    assert advance(one, 40) == expected
    advance(other, 7, seed=5)
    other.restore(state)
    assert advance(other, 40) == expected


@pytest.mark.parametrize("name", NAMES)
def test_damaged_and_foreign_states_are_refused(name: str) -> None:
    """A state that is cut, changed or of another case raises an error, and the stepper continues as if nothing was."""
    stepper, twin = steppers()[name], steppers()[name]
    advance(stepper, 5), advance(twin, 5)
    state = stepper.save()
    foreign = rb.Stepper(ball(gap="1 mm")).save()
    for bad in (
        b"",
        state[:10],
        state[:-8],
        state + b"\0" * 8,
        state[:40] + bytes([state[40] ^ 1]) + state[41:],
        foreign,
    ):
        with pytest.raises(rb.CaseError):
            stepper.restore(bad)
    assert advance(stepper, 5) == advance(twin, 5)


@pytest.mark.parametrize("name", ["structure with ball", "structure with box"])
def test_the_energy_of_a_structure_is_balanced(name: str) -> None:
    """With a structure, the work of the loads is lost or stored."""
    stepper, work, loss, start = steppers()[name], 0.0, 0.0, None
    for k in range(1, 401):
        r = stepper.advance(2.5e-4 * k, loads=[40.0 * np.sin(90 * 2.5e-4 * k)])
        start = r.stored - r.work + r.loss if start is None else start
        work, loss = work + r.work, loss + r.loss
    assert loss > 0
    assert abs(r.stored - start - work + loss) < 0.01 * abs(work)


def test_a_structure_follows_its_loads_like_the_whole_run() -> None:
    """A structure with a ball under a load that is constant in steps approaches the run with the smooth load."""
    load = rb.Harmonic(amplitude="20 N", frequency="9 Hz")
    structure = rb.SDOF(mass="1 kg", frequency="10 Hz", damping_ratio=0.01)
    case = rb.Case(structure=structure, damper=ball(gap="1 mm"), load=load, duration="0.3 s")
    whole = rb.simulate(case, progress=False)
    expected, errors = float(whole.motion.displacement.values[-1].item()), []
    for steps in (1500, 6000):
        stepper, h = rb.Stepper(case), 0.3 / steps
        for k in range(steps):
            stepper.advance((k + 1) * h, loads=[20 * np.sin(2 * np.pi * 9 * (k + 0.5) * h)])
        errors.append(abs(stepper.displacement() - expected))
    assert errors[1] < errors[0] / 8
    assert errors[1] < 1e-7


def test_several_steppers_do_not_disturb_each_other() -> None:
    """Steppers that are advanced in turn have the bits of steppers that are advanced alone."""
    alone = {name: advance(stepper, 10) for name, stepper in steppers().items()}
    together: dict[str, list[bytes]] = {name: [] for name in NAMES}
    random = {name: np.random.default_rng(3) for name in NAMES}
    all_steppers = steppers()
    for _ in range(10):
        for name in NAMES:
            together[name] += advance(all_steppers[name], 1, random[name])
    assert together == alone


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"to": 0.0, "velocity": 1.0}, "to = "),
        ({"to": float("nan"), "velocity": 1.0}, "to = "),
        ({"to": 1e-3}, "velocity or acceleration"),
        ({"to": 1e-3, "velocity": 1.0, "acceleration": 1.0}, "velocity and acceleration"),
        ({"to": 1e-3, "loads": [1.0]}, "loads"),
        ({"to": 1e-3, "velocity": (1.0, 0.0)}, "velocity"),
        ({"to": 1e-3, "velocity": float("nan")}, "finite"),
    ],
)
def test_wrong_inputs_are_refused(given: Any, named: str) -> None:
    """A step with wrong inputs raises an error that names them, and changes nothing."""
    stepper, twin = rb.Stepper(ball()), rb.Stepper(ball())
    with pytest.raises(rb.CaseError, match=named):
        stepper.advance(**given)
    assert advance(stepper, 3) == advance(twin, 3)


def test_a_particle_that_leaves_stops_the_stepper() -> None:
    """A particle that is thrown through the wall stops the stepper, and an earlier state can be restored."""
    stepper = rb.Stepper(box(20, softening=1e6), motion=MOTION)
    stepper.advance(1e-3, acceleration=(0, 0, 0))
    state = stepper.save()
    with pytest.raises(rb.StepError, match="escaped"):
        stepper.advance(40e-3, acceleration=(3e5, 0, 0))
    with pytest.raises(rb.StepError):
        stepper.advance(1.0, acceleration=(0, 0, 0))
    stepper.restore(state)
    stepper.advance(2e-3, acceleration=(0, 0, 0))


# ---- the packed case


def test_packed_case_is_read_by_an_independent_reader() -> None:
    """The documented layout, read with `struct` alone, gives the gap, the mass and the law of a ball."""
    from rattlebox.prepare.component import damper_case, pack_component

    damper = ball(velocity="0.25 m/s", gravity="2 m/s^2")
    data = pack_component(damper_case(damper, None, None, None, "1 s"), alone=True).data
    assert data[:8] == b"RATTLEBX"
    version, engine, size = struct.unpack_from("<3q", data, 8)
    assert (version, engine, size) == (2, 1, len(data) - 40)
    hashed = 14695981039346656037
    for byte in data[40:]:
        hashed = (hashed ^ byte) * 1099511628211 % 2**64
    assert struct.unpack_from("<Q", data, 32)[0] == hashed
    words = iter(struct.iter_unpack("<8s", data[40:]))

    def integer() -> int:
        return int(struct.unpack("<q", next(words)[0])[0])

    def real() -> float:
        return float(struct.unpack("<d", next(words)[0])[0])

    assert [integer() for _ in range(3)] == [0, 0, 0]  # modes, coupling, initial state
    assert [integer() for _ in range(3)] == [1, 0, 1]  # one load: no modes, of the base
    assert [integer() for _ in range(4)] == [1, 0, 1, 0]  # one damper: its first ball, number of balls, first contact
    assert real() == pytest.approx(4e-3)  # both gaps
    assert real() == 2.0
    assert integer() == 0
    assert integer() == 2  # contacts: at each wall
    mass = float(damper.masses[0])
    for below, above in ((-1, 0), (0, -1)):
        assert [integer() for _ in range(3)] == [0, below, above]
        assert real() == pytest.approx(mass)
        assert integer() == 0  # Hertz with Tsuji's dashpot
        for _ in range(4):
            real()
        assert integer() == 0  # constant restitution
        assert real() == 0.6
        for _ in range(1):
            real()
    assert [integer(), real()] == [1, pytest.approx(mass)]
    assert [integer(), real()] == [1, 0.0]
    assert [integer(), real()] == [1, 0.25]
