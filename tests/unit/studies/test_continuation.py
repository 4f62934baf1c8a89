"""Runs along a parameter, each from the final state of the one before."""

import signal
import threading
import time

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.kinds.sweep import sweep
from rattlebox.studies.run.runner import run_work
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.variants import Variants, order_along, with_direction
from rattlebox.studies.work.work import Work

QUIET = {"progress": False}


def continue_along(case, path, values, *, grid=None, workers=None, progress=False, **options):
    """Run a case for each value of a parameter from the final state before, for each variant of a grid."""
    axes = read_axes(case, [*([grid] if grid else []), {path: values}])
    axes, order = order_along(axes, "up")
    returned = {name: options.pop(name) for name in ("motion", "last") if name in options}
    work = Work(ImpactEngine(Variants(case, axes, intervals=True, **options), **returned, state=True), order)
    work.validate()
    return with_direction(run_work(work, workers=workers, progress=progress))


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


def assert_continues(case, path, value, cycles=(3, 2)):
    """Check that three runs of one value end as one long run."""
    skip, look = cycles
    options = {"samples": 9, "motion": True, "last": 4, **QUIET}
    whole = (2 * (skip + look) + skip, look)
    long = continue_along(case, path, [value], measures=["impacts"], cycles=whole, **options).isel(
        {path: 0, "direction": 0}
    )
    parts = continue_along(case, path, [value] * 3, measures=["impacts"], cycles=cycles, **options).isel(
        {path: 2, "direction": 0}
    )
    for name in (
        "relative_position",
        "relative_velocity",
        "displacement",
        "velocity",
        "impacts",
        "last_approach_speed",
    ):
        np.testing.assert_allclose(parts[name], long[name], rtol=1e-8, atol=1e-9)
    earlier = long.last_time - parts.last_time
    np.testing.assert_allclose(earlier, 0.1 * 2 * (skip + look), rtol=1e-9)


def test_first_value_is_a_sweep():
    """The first run of a chain has the bits of a sweep."""
    options = {"cycles": (3, 2), "samples": 9, "motion": True, "last": 4, **QUIET}
    first = continue_along(
        shaken(), "damper.gap", [0.5e-3, 0.6e-3], measures=["impacts", "peak_contact_force"], **options
    )
    alone = sweep(shaken(), {"damper.gap": [0.5e-3]}, ["impacts", "peak_contact_force"], **options)
    assert set(first) == set(alone)
    for name in alone:
        np.testing.assert_array_equal(first[name][0, 0], alone[name][0])


@pytest.mark.parametrize("method", [rb.Newton(), rb.EventDriven()])
def test_repeated_value_continues(method):
    """A repeated value continues like one long run."""
    assert_continues(shaken(method=method), "structure.motion.amplitude", 1.2e-3)


def test_modes_and_rows_continue():
    """Two modes, two dampers, a row of balls and a load with a phase and its double frequency continue."""
    assert_continues(beam(), "loads[0].amplitude", 60.0, (0, 1))


def test_closed_contact_at_the_end_of_a_cycle():
    """A contact that is closed for a quarter of the cycle does not break the motion, whenever the cycle ends."""
    soft = rb.Linear(stiffness=500.0, restitution=0.6)
    closed = 0
    for phase in np.linspace(0, 2 * np.pi, 7)[:-1]:
        motion = rb.Harmonic(amplitude="1 mm", frequency="10 Hz", phase=phase)
        case = shaken(contact=soft).model_copy(update={"structure": rb.Shaker(motion=motion)})
        assert_continues(case, "damper.gap", 0.5e-3)
        end = sweep(case, {"damper.gap": [0.5e-3]}, [], cycles=(3, 2), motion=True, **QUIET).relative_position[0, -1, 0]
        closed += abs(float(end)) > 0.5e-3
    assert closed >= 2


def test_chains_are_independent():
    """A chain among others, on several threads, has the bits that it has alone."""
    frequencies = np.linspace(10.0, 11.0, 4)
    options = {"cycles": (5, 2), "measures": ["impacts"], "samples": 3, "motion": True, "last": 3, **QUIET}
    gaps = [1e-3, 0.8e-3, 0.6e-3]
    both = continue_along(
        shaken(), "structure.motion.frequency", frequencies, grid={"damper.gap": gaps}, workers=3, **options
    )
    assert both.status.dims == ("direction", "damper.gap", "structure.motion.frequency")
    for number, gap in enumerate(gaps):
        alone = continue_along(
            shaken(), "structure.motion.frequency", frequencies, grid={"damper.gap": [gap]}, workers=1, **options
        )
        for name in alone:
            np.testing.assert_array_equal(alone[name][:, 0], both[name][:, number])


def test_shrinking_gap_keeps_the_ball_inside():
    """A ball beyond the wall of a smaller cavity is moved to the wall."""
    options = {"cycles": (0, 1), "samples": 2, "motion": True, **QUIET}
    result = continue_along(shaken(method=rb.Newton()), "damper.gap", [1e-3, 1e-5], **options)
    assert (result.status == 0).all()
    assert float(abs(result.relative_position[0, 1]).max()) <= 1e-5 * (1 + 1e-15)


def test_value_that_does_not_finish_leaves_the_state():
    """A value beyond the domain of a law has its status, and the next run starts from the state before."""
    case = shaken(contact=rb.Tsuji(restitution=rb.JacksonGreen(yield_stress="100 MPa")))
    options = {"cycles": (3, 1), "samples": 3, "motion": True, **QUIET}
    result = continue_along(case, "structure.motion.amplitude", [1e-3, 10.0, 1.1e-3], **options)
    assert result.status.values.tolist() == [[0, 1, 0]]
    assert result.relative_position[0, 1].isnull().all()
    without = continue_along(case, "structure.motion.amplitude", [1e-3, 1.1e-3], **options)
    np.testing.assert_array_equal(result.relative_position[0, 2], without.relative_position[0, 1])


@pytest.mark.parametrize(
    ("path", "options", "message"),
    [
        ("damper.start", {}, "damper.start is an initial value"),
        ("damper.gap", {"measures": ["impact"]}, "did you mean 'impacts'"),
        ("damper.gap", {"measures": [len]}, "there is no measure"),
        ("damper.gaps", {}, "did you mean 'gap'"),
    ],
)
def test_invalid_arguments(path, options, message):
    """Bad arguments raise before anything runs."""
    with pytest.raises(rb.CaseError, match=message):
        continue_along(shaken(), path, [0.5e-3, 0.6e-3], **{"cycles": (3, 1), **options})


def test_stops_at_once():
    """Ctrl-C ends a run that would take hours within a second, with a message of the progress."""
    begun = []

    def interrupt():
        begun.append(time.perf_counter())
        signal.raise_signal(signal.SIGINT)

    threading.Timer(0.5, interrupt).start()
    with pytest.raises(KeyboardInterrupt, match="stopped after 0 of 2 variants"):
        continue_along(shaken(method=rb.Newton()), "damper.gap", [0.5e-3, 1e-3], cycles=(10**8, 1), **QUIET)
    assert time.perf_counter() - begun[0] < 1.0


def test_loads_that_do_not_repeat_are_refused():
    """A pulse, or a second frequency that is no multiple of the first, has no common cycle."""
    for motion in (
        rb.HalfSine(amplitude="1 m/s^2", duration="1 ms"),
        rb.Harmonic(amplitude="1 mm", frequency="15 Hz"),
        rb.Harmonic(amplitude="1 mm", frequency="20 Hz", stop="1 s"),
    ):
        with pytest.raises(rb.CaseError, match="not periodic"):
            continue_along(shaken(motion=[motion]), "damper.gap", [1e-3], cycles=(3, 1))
