"""Values of a parameter that are followed one after the other."""

import signal
import threading
import time

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.continuation import follow
from rattlebox.studies.kinds.sweep import sweep

QUIET = {"progress": False}


def shaken(frequency="10 Hz", *, contact=None, method=None, motion=(), **damper):
    """Return a ball that a shaker throws to and fro."""
    return rb.Case(
        structure=rb.Shaker(motion=[rb.Harmonic(amplitude="1 mm", frequency=frequency), *motion]),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap="1 mm",
            velocity=0.1,
            contact=contact or rb.Tsuji(restitution=0.6),
            **damper,
        ),
        duration="1 s",
        method=method or rb.EventDriven(),
    )


def beam():
    """Return two dampers, one with two balls, on a structure with two modes."""
    ball = rb.Sphere(radius="10 mm", material="steel")
    tsuji = rb.Tsuji(restitution=0.6)
    return rb.Case(
        structure=rb.Modal(
            frequencies=[9.0, 23.0], damping_ratios=[0.01, 0.01], shapes={"tip": [2, 1], "end": [1, -2]}
        ),
        dampers=[
            rb.ImpactDamper(balls=[ball, ball], gap="1 mm", start=[-0.5, 0.5], contact=tsuji, point="tip"),
            rb.ImpactDamper(ball=ball, gap="0.5 mm", contact=tsuji, point="end"),
        ],
        load=[
            rb.Harmonic(amplitude="60 N", frequency="10 Hz", phase="30 deg", point="tip"),
            rb.Harmonic(amplitude="10 N", frequency="20 Hz", point="end"),
        ],
        duration="1 s",
    )


def assert_goes_on(case, path, value, cycles=(3, 2)):
    """Check that a value followed three times ends as one long run of it."""
    skip, look = cycles
    options = {"samples": 9, "motion": True, "last": 4, **QUIET}
    whole = (2 * (skip + look) + skip, look)
    long = follow(case, path, [value], measure=["impacts"], cycles=whole, **options).isel({path: 0, "direction": 0})
    parts = follow(case, path, [value] * 3, measure=["impacts"], cycles=cycles, **options).isel(
        {path: 2, "direction": 0}
    )
    for name in ("ball_place", "ball_speed", "displacement", "velocity", "impacts", "last_approach_speed"):
        np.testing.assert_allclose(parts[name], long[name], rtol=1e-8, atol=1e-9)
    earlier = long.last_time - parts.last_time
    np.testing.assert_allclose(earlier, 0.1 * 2 * (skip + look), rtol=1e-9)


def test_first_value_is_a_sweep():
    """What has nothing to follow is what a sweep gives, with the same bits."""
    options = {"cycles": (3, 2), "samples": 9, "motion": True, "last": 4, **QUIET}
    first = follow(shaken(), "damper.gap", [0.5e-3, 0.6e-3], measure=["impacts", "peak_contact_force"], **options)
    alone = sweep(shaken(), {"damper.gap": [0.5e-3]}, ["impacts", "peak_contact_force"], **options)
    assert set(first) == set(alone)
    for name in alone:
        np.testing.assert_array_equal(first[name][0, 0], alone[name][0])


@pytest.mark.parametrize("method", [rb.Newton(), rb.EventDriven()])
def test_value_that_is_repeated_goes_on(method):
    """A value that follows itself goes on as one long run does."""
    assert_goes_on(shaken(method=method), "structure.motion.amplitude", 1.2e-3)


def test_modes_and_rows_go_on():
    """Two modes, two dampers, a row of balls and a load with a phase and its double frequency go on."""
    assert_goes_on(beam(), "loads[0].amplitude", 60.0, (0, 1))


def test_closed_contact_at_the_end_of_a_cycle():
    """A contact that is closed for a quarter of the cycle does not break the motion, whenever the cycle ends."""
    soft = rb.Linear(stiffness=500.0, restitution=0.6)
    closed = 0
    for phase in np.linspace(0, 2 * np.pi, 7)[:-1]:
        motion = rb.Harmonic(amplitude="1 mm", frequency="10 Hz", phase=phase)
        case = shaken(contact=soft).model_copy(update={"structure": rb.Shaker(motion=motion)})
        assert_goes_on(case, "damper.gap", 0.5e-3)
        end = sweep(case, {"damper.gap": [0.5e-3]}, [], cycles=(3, 2), motion=True, **QUIET).ball_place[0, -1, 0]
        closed += abs(float(end)) > 0.5e-3
    assert closed >= 2


def test_variants_beside_each_other_do_not_disturb_each_other():
    """A variant among others, on several threads, has the bits that it has alone."""
    frequencies = np.linspace(10.0, 11.0, 4)
    options = {"cycles": (5, 2), "measure": ["impacts"], "samples": 3, "motion": True, "last": 3, **QUIET}
    gaps = [1e-3, 0.8e-3, 0.6e-3]
    both = follow(
        shaken(), "structure.motion.frequency", frequencies, beside={"damper.gap": gaps}, workers=3, **options
    )
    assert both.status.dims == ("direction", "damper.gap", "structure.motion.frequency")
    for number, gap in enumerate(gaps):
        alone = follow(
            shaken(), "structure.motion.frequency", frequencies, beside={"damper.gap": [gap]}, workers=1, **options
        )
        for name in alone:
            np.testing.assert_array_equal(alone[name][:, 0], both[name][:, number])


def test_shrinking_gap_keeps_the_ball_inside():
    """A ball beyond the wall of a smaller cavity is put to the wall."""
    options = {"cycles": (0, 1), "samples": 2, "motion": True, **QUIET}
    found = follow(shaken(method=rb.Newton()), "damper.gap", [1e-3, 1e-5], **options)
    assert (found.status == 0).all()
    assert float(abs(found.ball_place[0, 1]).max()) <= 1e-5 * (1 + 1e-15)


def test_value_that_does_not_finish_leaves_the_state():
    """A value beyond a law's domain carries its status, and the next one goes on from the one before."""
    case = shaken(contact=rb.Tsuji(restitution=rb.JacksonGreen(yield_stress="100 MPa")))
    options = {"cycles": (3, 1), "samples": 3, "motion": True, **QUIET}
    found = follow(case, "structure.motion.amplitude", [1e-3, 10.0, 1.1e-3], **options)
    assert found.status.values.tolist() == [[0, 1, 0]]
    assert found.ball_place[0, 1].isnull().all()
    without = follow(case, "structure.motion.amplitude", [1e-3, 1.1e-3], **options)
    np.testing.assert_array_equal(found.ball_place[0, 2], without.ball_place[0, 1])


@pytest.mark.parametrize(
    ("path", "options", "said"),
    [
        ("damper.start", {}, "damper.start is a start"),
        ("damper.gap", {"measure": ["impact"]}, "did you mean 'impacts'"),
        ("damper.gap", {"measure": [len]}, "there is no measure"),
        ("damper.gaps", {}, "did you mean 'gap'"),
    ],
)
def test_what_cannot_be_followed_is_told(path, options, said):
    """Bad arguments are told before anything runs."""
    with pytest.raises(rb.CaseError, match=said):
        follow(shaken(), path, [0.5e-3, 0.6e-3], **{"cycles": (3, 1), **options})


def test_stops_at_once():
    """Ctrl-C ends a value that would take hours within a second, and says where."""
    begun = []

    def interrupt():
        begun.append(time.perf_counter())
        signal.raise_signal(signal.SIGINT)

    threading.Timer(0.5, interrupt).start()
    with pytest.raises(KeyboardInterrupt, match="stopped after 0 of 2 variants"):
        follow(shaken(method=rb.Newton()), "damper.gap", [0.5e-3, 1e-3], cycles=(10**8, 1), **QUIET)
    assert time.perf_counter() - begun[0] < 1.0


def test_loads_that_do_not_repeat_are_refused():
    """A pulse, or a second frequency that is no multiple of the first, leaves no cycle to go on from."""
    for motion in (
        rb.HalfSine(amplitude="1 m/s^2", duration="1 ms"),
        rb.Harmonic(amplitude="1 mm", frequency="15 Hz"),
        rb.Harmonic(amplitude="1 mm", frequency="20 Hz", stop="1 s"),
    ):
        with pytest.raises(rb.CaseError, match="does not repeat"):
            follow(shaken(motion=[motion]), "damper.gap", [1e-3], cycles=(3, 1))
