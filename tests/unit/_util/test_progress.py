"""Progress bars: late, only where somebody sees them, and one meaning of `progress` in all functions."""

import inspect
import io
import re
import sys
import threading
import time
import types

import pytest

import rattlebox as rb
from rattlebox._util.progress import progress_bar
from rattlebox.model.paths import replaced


class Terminal(io.StringIO):
    """A standard error that is a terminal."""

    def isatty(self) -> bool:
        """Return True."""
        return True


def make_terminal(monkeypatch):
    """Replace the standard error by a terminal; in the test, since pytest replaces what fixtures set."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "120")
    for name in ("NO_COLOR", "TTY_COMPATIBLE", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "stderr", Terminal())
    return sys.stderr


def drawn(terminal, wanted=""):
    """Return what a terminal received, without its control sequences, once the wanted words are in it or after 20 s."""
    until = time.monotonic() + 20
    while True:
        text = re.sub(r"\x1b\[[\d;?]*[A-Za-z]", "", terminal.getvalue())
        if re.search(wanted, text) or time.monotonic() > until:
            return text
        time.sleep(0.02)


def test_a_bar_appears_after_the_delay(monkeypatch):
    """Nothing is drawn by a call that is done in time; a longer call draws, even if it reports nothing more."""
    terminal = make_terminal(monkeypatch)
    with progress_bar(True, "runs", delay=30.0) as report:
        assert report(1, 3) is None
    assert terminal.getvalue() == ""
    with progress_bar(True, "runs", delay=0.05) as report:
        report(1, 3)
        assert "33%" in drawn(terminal, "1 of 3 runs .* 33%")
    before = len(terminal.getvalue())
    report(2, 3)
    time.sleep(0.3)
    assert len(terminal.getvalue()) == before, "a bar that is closed draws no more"


def test_a_bar_without_any_report(monkeypatch):
    """During preparation, such as the settling of particles, a bar is shown with its name."""
    terminal = make_terminal(monkeypatch)
    with progress_bar(True, "steps", delay=0.0):
        assert "preparing" in drawn(terminal, "preparing")
    assert " of " not in drawn(terminal)


def test_no_bar_where_nobody_sees_it(monkeypatch, capfd):
    """No bar is drawn if the standard error is a file, in another thread, inside another bar, and with False."""
    with progress_bar(True, "runs", delay=0.0) as report:
        report(1, 2)
        time.sleep(0.2)
    assert capfd.readouterr().err == ""


def test_no_bar_in_other_threads_inside_bars_and_if_switched_off(monkeypatch):
    """A study that is run in a thread, or inside another call with a bar, draws none."""
    terminal = make_terminal(monkeypatch)

    def quiet(progress=True):
        with progress_bar(progress, "inner", delay=0.0) as report:
            report(1, 2)
            time.sleep(0.2)

    thread = threading.Thread(target=quiet)
    thread.start()
    thread.join()
    quiet(False)
    assert terminal.getvalue() == ""
    with progress_bar(True, "outer", delay=0.0) as report:
        report(1, 2)
        assert "outer" in drawn(terminal, "outer")
        quiet()
    assert "inner" not in drawn(terminal)
    with progress_bar(True, "next", delay=0.0) as report:
        report(1, 2)
        assert "next" in drawn(terminal, "next")


def test_without_rich_nothing_is_drawn(monkeypatch):
    """Without rich, runs finish without a progress bar and without an error."""
    terminal = make_terminal(monkeypatch)
    monkeypatch.setitem(sys.modules, "rich.progress", None)
    with progress_bar(True, "runs", delay=0.0) as report:
        time.sleep(0.2)
        report(1, 2)
    assert terminal.getvalue() == ""


def test_a_notebook_shows_its_own_bar(monkeypatch):
    """In a notebook the bar of IPython is displayed, updated, and cleared."""
    seen = []

    class ProgressBar:
        total = progress = 0

        def __init__(self, total):
            seen.append("made")

        def display(self):
            seen.append("shown")

        def __setattr__(self, name, value):
            seen.append((name, value))

    display = types.ModuleType("IPython.display")
    display.ProgressBar, display.clear_output = ProgressBar, lambda: seen.append("cleared")
    ipython = types.ModuleType("IPython")
    ipython.get_ipython = lambda: types.SimpleNamespace(kernel=object())
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    with progress_bar(True, "runs", delay=0.0) as report:
        time.sleep(0.3)
        report(3, 4)
    assert seen[:2] == ["made", "shown"] and seen[-1] == "cleared"
    assert ("total", 4) in seen and ("progress", 3) in seen


def test_a_function_takes_the_numbers(monkeypatch):
    """A function is called with the numbers instead of drawing; its result is returned."""
    terminal = make_terminal(monkeypatch)
    calls = []
    with progress_bar(lambda done, total: calls.append((done, total)) or False, "runs", delay=0.0) as report:
        assert report(1, 2) is False
        time.sleep(0.1)
    assert calls == [(1, 2)] and terminal.getvalue() == ""


def with_progress():
    """Return all public functions that take `progress`."""
    functions = {name: getattr(rb, name) for name in rb.__all__ if inspect.isfunction(getattr(rb, name))}
    return {name: each for name, each in functions.items() if "progress" in inspect.signature(each).parameters}


def test_progress_means_the_same_in_all_functions():
    """All long calls take `progress`, with one type and one default."""
    result = with_progress()
    studies = {"sweep", "bifurcation", "basins", "frequency_response", "lyapunov", "loss_map", "design", "sensitivity"}
    studies |= {"stability_lobes"}
    others = {"simulate", "simulate_many", "compare", "damping_curve", "calibrate", "film_particles"}
    others |= {"check_softening", "check_step", "backbone", "continue_orbit", "continue_point", "notch_with_dampers"}
    assert set(result) == studies | others
    parameters = [inspect.signature(each).parameters["progress"] for each in result.values()]
    assert {(p.annotation, p.default, p.kind) for p in parameters} == {
        ("bool | Callable[[int, int], object]", True, inspect.Parameter.KEYWORD_ONLY)
    }


def test_simulate_many_counts_runs_and_stops():
    """A function is called with the number of finished runs, all in the end; False interrupts the runs."""
    case = rb.reference_case(duration=0.5)
    calls = []
    runs = rb.simulate_many([case] * 3, progress=lambda *numbers: calls.append(numbers))
    assert calls[-1] == (3, 3) and [done for done, _ in calls] == sorted(done for done, _ in calls)
    assert all(run.ok for run in runs)
    shaken = rb.Harmonic(amplitude="500 N", frequency="11 Hz")
    long = replaced(rb.reference_case(duration=1000.0), {"load": shaken})
    began = time.monotonic()
    assert [run.status for run in rb.simulate_many([long] * 2, progress=lambda *_: False)] == ["interrupted"] * 2
    assert rb.simulate(long, progress=lambda *_: False).status == "interrupted"
    assert time.monotonic() - began < 10


def test_a_study_is_stopped_by_its_function():
    """A function that returns False stops a study as Ctrl-C does."""
    with pytest.raises(KeyboardInterrupt, match="stopped after"):
        rb.sweep(rb.reference_case(duration=0.1), {"damper.gap": ["1 mm", "2 mm"]}, progress=lambda *_: False)
    result = rb.compare({"a": rb.reference_case(duration=0.1)}, progress=lambda *_: None)
    assert result.runs["a"].ok
