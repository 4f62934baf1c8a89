"""Default times of the output."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

EXAMPLES = Path(__file__).parents[3] / "examples"


def example(name: str, **changes: Any) -> rb.Case:
    """Return an example with other fields."""
    return rb.Case.from_file(EXAMPLES / name).model_copy(update=changes)


@pytest.mark.parametrize("method", [rb.EventDriven(), rb.Newton()], ids=lambda m: m.kind)
def test_flights_are_drawn_from_wall_to_wall(method: Any) -> None:
    """The default output holds start and end of every contact, at the wall, with the velocities of the log."""
    a = rb.simulate(example("steel_ball_jackson_green.toml", method=method)).arrays
    log, half = a.impacts, a.clearance[0] / 2
    side = np.where(log.contact == 0, -1.0, 1.0)
    start = np.searchsorted(a.time, log.time)
    assert np.array_equal(a.time[start], log.time)
    assert side * a.relative_position[start, 0] == pytest.approx(half, rel=1e-9)
    assert side * a.relative_velocity[start, 0] == pytest.approx(log.approach_speed, rel=1e-6, abs=1e-9)
    opened = np.nextafter(log.time + log.duration, np.inf)
    end = np.searchsorted(a.time, opened)
    assert -side * a.relative_velocity[end, 0] == pytest.approx(log.separation_speed, rel=1e-6, abs=1e-9)
    if method.kind == "event_driven":  # the sample at the deepest overlap
        inside = [np.max(side[k] * a.relative_position[start[k] : end[k], 0] - half) for k in range(log.time.size)]
        assert inside == pytest.approx(log.peak_overlap, rel=1e-6)


@pytest.mark.parametrize("contact", [rb.Tsuji(restitution=0.3), rb.Linear(stiffness="50 MN/m", restitution=0.6)])
@pytest.mark.parametrize("balls", [1, 3])
def test_contacts_of_rows_are_sampled_in_one_pass(contact: Any, balls: int) -> None:
    """Begin, deepest overlap and end of every contact are among the times, which rise, in rows and from rest, too."""
    case = rb.Case(
        structure=rb.SDOF(mass="2 kg", stiffness="80 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(
            balls=[rb.Sphere(radius="8 mm", material="steel")] * balls, gap="0.2 mm", start=-1, contact=contact
        ),
        load=rb.HalfSine(amplitude="1 kN", duration="1 ms"),
        duration="0.2 s",
    )
    run = rb.simulate(case)
    assert run.ok, run.message
    a = run.arrays
    log = a.impacts
    assert np.all(np.diff(a.time) > 0) and a.time[0] == 0 and a.time[-1] == 0.2
    assert log.time.size > 5 and log.time[0] == 0
    finished = log.complete & (log.time + log.duration < 0.2)
    for times in (log.time, (log.time + log.duration)[finished]):
        nearest = np.abs(a.time[np.searchsorted(a.time, times).clip(1, a.time.size - 1)] - times)
        before = np.abs(a.time[(np.searchsorted(a.time, times) - 1).clip(0)] - times)
        assert np.all(np.minimum(nearest, before) < 1e-14)
    few = rb.simulate(case.model_copy(update={"output": rb.Output(times=[0.1])})).arrays
    assert few.impacts == log


@pytest.mark.parametrize(
    "contact", [rb.Tsuji(restitution=0.8), rb.Tsuji(alpha=0.0), rb.Linear(stiffness="5 MN/m", damping=9.0)]
)
def test_default_samples_are_those_of_chosen_times(contact: Any) -> None:
    """Motion and ledger at each time of the default output are those of a run in which these times are chosen."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="33.17 mm", material="steel"), gap="0.1 mm", contact=contact, velocity="0.2 m/s"
    )
    case = example("steel_ball.toml", dampers=(damper,), duration=0.3)
    a = rb.simulate(case).arrays
    b = rb.simulate(case.model_copy(update={"output": rb.Output(times=a.time[1:-1])})).arrays
    assert np.array_equal(a.time, b.time) and a.impacts.time.size > 20
    for name in ("displacement", "velocity", "relative_position", "contact_energy", "viscous_loss", "normal_loss"):
        one, other = getattr(a, name), getattr(b, name)
        assert one == pytest.approx(other, rel=1e-9, abs=1e-9 * np.abs(other).max() + 1e-15), name


@pytest.mark.parametrize("inner", ["rk4", "dopri5"])
def test_contacts_of_fixed_steps_are_sampled(inner: str) -> None:
    """The two-step scheme is sampled at the steps in which contacts begin and end."""
    case = example("steel_ball.toml", method=rb.TwoStep(inner=inner), duration=0.05)
    a = rb.simulate(case).arrays
    assert a.impacts.time.size > 0
    assert np.isin(a.impacts.time, a.time).all()


def test_default_output_does_not_change_the_run() -> None:
    """Samples at contacts change no bit of the run."""
    case = example("steel_ball.toml")
    chosen = case.model_copy(update={"output": rb.Output(times=[1.0])})
    default, few = rb.simulate(case), rb.simulate(chosen)
    assert default.arrays.impacts == few.arrays.impacts
    assert default.arrays.displacement[-1] == few.arrays.displacement[-1]
    assert default.counts == few.counts


def test_short_pulse_and_fast_mode_are_resolved() -> None:
    """A pulse has twenty samples however long the run, and the fastest harmonic twenty in each period."""
    times = example("steel_ball.toml", duration=50.0).sample_times()
    assert np.count_nonzero((times > 0) & (times < 1e-3)) >= 19
    assert np.diff(times).max() <= 1 / 20 / (63.2456 / 2 / np.pi) * 1.001
    assert example("shaker.toml", duration=1e9).sample_times().size == 100_001
    assert example("steel_ball.toml", duration=5e-4).sample_times()[-1] == 5e-4


def test_chosen_times_are_kept() -> None:
    """A rate or times are recorded as they are, and nothing else."""
    case = example("steel_ball.toml", output=rb.Output(rate=100.0))
    assert rb.simulate(case).arrays.time == pytest.approx(np.arange(501) / 100, abs=1e-12)


@pytest.mark.parametrize("duration", [sum([1e-4] * 10_000), 1.0, 1.0 + 4e-12, 1e-9, 0.123456])
def test_rate_that_nearly_divides_the_duration(duration: float) -> None:
    """The times of a rate rise from 0 to the very end, also of a duration that is rounded."""
    times = rb.Output(rate="100 kHz").sample_times(duration)
    assert times[0] == 0 and times[-1] == duration
    assert np.all(np.diff(times) > 0)
    assert times[1:-1] == pytest.approx(np.arange(1, times.size - 1) / 1e5, rel=1e-15)


def test_run_of_very_many_events_is_sampled_evenly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond the limit of events only the times known before the run are recorded."""
    case = example("steel_ball.toml", duration=0.5)
    for module in ("prepare.pack", "engines.simulate"):
        monkeypatch.setattr(f"rattlebox.{module}.MAX_EVENTS", 10)
    assert np.array_equal(rb.simulate(case).arrays.time, case.sample_times())


def test_number_of_snapshots_from_numpy() -> None:
    """NumPy integers are accepted as a number of snapshots."""
    assert rb.Output(snapshots=np.int64(20)).snapshots == 20
