"""Which times are recorded when nobody has chosen any."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.engines.simulate import _with_contacts

EXAMPLES = Path(__file__).parents[3] / "examples"


def example(name: str, **changes: Any) -> rb.Case:
    """Return an example with other fields."""
    return rb.Case.from_file(EXAMPLES / name).model_copy(update=changes)


@pytest.mark.parametrize("method", [rb.EventDriven(), rb.Newton()], ids=lambda m: m.kind)
def test_flights_are_drawn_from_wall_to_wall(method: Any) -> None:
    """The default output holds begin and end of every contact, at the wall, with the velocities of the log."""
    a = rb.simulate(example("steel_ball_jackson_green.toml", method=method)).arrays
    log, half = a.impacts, a.clearance[0] / 2
    side = np.where(log.contact == 0, -1.0, 1.0)
    begin = np.searchsorted(a.time, log.time)
    assert np.array_equal(a.time[begin], log.time)
    assert side * a.relative_position[begin, 0] == pytest.approx(half, rel=1e-9)
    assert side * a.relative_velocity[begin, 0] == pytest.approx(log.approach_speed, rel=1e-6, abs=1e-9)
    opened = np.nextafter(log.time + log.duration, np.inf)
    end = np.searchsorted(a.time, opened)
    assert -side * a.relative_velocity[end, 0] == pytest.approx(log.separation_speed, rel=1e-6, abs=1e-9)
    inside = side * a.relative_position[begin + 1, 0] - half
    if method.kind == "event_driven":
        assert np.all((inside > 0) & (inside <= log.peak_overlap * (1 + 1e-9)))


def test_default_output_does_not_change_the_run() -> None:
    """The run that is repeated for the default output is the same to the last bit, and says the time of both."""
    case = example("steel_ball.toml")
    chosen = case.model_copy(update={"output": rb.Output(times=[1.0])})
    default, few = rb.simulate(case).arrays, rb.simulate(chosen).arrays
    assert default.impacts == few.impacts
    assert default.displacement[-1] == few.displacement[-1]
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


def test_run_of_very_many_events_is_not_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond the limit of events only the times known before the run are recorded."""
    case = example("steel_ball.toml", duration=0.5)
    monkeypatch.setattr("rattlebox.engines.simulate._MOST_EVENTS", 10)
    assert np.array_equal(rb.simulate(case).arrays.time, case.sample_times())


def test_a_contact_that_begins_a_rounding_before_the_start_keeps_times_in_order() -> None:
    """Samples at contacts stay between the first and the last time of the run, whatever the clock of a contact tells."""
    touch, duration = np.array([-1.5e-54, 0.4]), np.array([1e-5, 1e-5])
    raw = {"impacts": {"time": touch, "duration": duration}, "stopped_at": 1.0}
    times = _with_contacts(np.array([0.0, 0.5, 1.0]), raw)
    assert times[0] == 0 and times[-1] == 1
    assert np.all(np.diff(times) > 0) and np.isin(0.4, times)
