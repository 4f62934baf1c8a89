"""Design studies: objectives, fronts, restart after a stop, refused arguments, figures."""

from __future__ import annotations

import multiprocessing
import os
import re
import runpy
import signal
import sys
import time
import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray as xr
from support.command import rattlebox
from support.struck import struck

import rattlebox as rb
from rattlebox._util.quantities import quantity
from rattlebox.report.kinds.design import KIND
from rattlebox.studies.design.trials import count_trials
from rattlebox.studies.run.runner import Stopped
from rattlebox.studies.study_file import study_from_toml

EXAMPLE = Path(__file__).parents[3] / "examples" / "design.py"
GAP, RADIUS = "damper.gap", "damper.ball.radius"
BOUNDS: dict[str, Any] = {GAP: ("0.1 mm", "2 mm"), RADIUS: ("10 mm", "40 mm")}


def without_times(result: xr.Dataset) -> xr.Dataset:
    """Return a result without the times that its runs took."""
    result = result.copy()
    for name in ("predicted_cpu_time", "predicted_wall_time", "wall_time", "cpu_time"):
        result.attrs.pop(name, None)
    return result


def searched(**changes: Any) -> xr.Dataset:
    """Return a short search."""
    options: dict[str, Any] = {
        "objective": {"added_mass": "min", "impact_share": "max"},
        "levels": {"load.amplitude": ["2 kN", "5 kN"]},
        "starts": 3,
        "max_added_mass": "1 kg",
        "log": [GAP],
        "trials": 24,
        "seed": 5,
        "progress": False,
    }
    return rb.design(struck(), BOUNDS, **(options | changes))


def test_objective_is_the_worst_of_all_runs() -> None:
    """The objective of a trial is the worst value of a sweep over levels and starts of its case."""
    result = rb.design(
        struck(),
        {GAP: ("0.1 mm", "2 mm")},
        {"impact_share": "max"},
        levels={"load.amplitude": ["2 kN", "5 kN"]},
        starts=[-1, 0.5],
        trials=2,
        progress=False,
    )
    assert result[GAP].units == "m"
    for trial in range(2):
        gap = float(result[GAP][trial])
        axes = {"load.amplitude": ["2 kN", "5 kN"], "damper.start": [-1, 0.5], GAP: [gap]}
        members = rb.sweep(struck(), axes, "impact_share", progress=False)
        assert float(result.impact_share[trial]) == float(members.impact_share.min())


@pytest.mark.parametrize(("robust", "of"), [("mean", np.mean), ("median", np.median), ("worst", np.max)])
def test_robust(robust: Any, of: Any) -> None:
    """The objective is the mean, median or worst value of the runs of a trial."""
    result = rb.design(struck(), {GAP: ("0.4 mm", "1 mm")}, "rms", starts=3, robust=robust, trials=1, progress=False)
    gap = float(result[GAP][0])
    members = rb.sweep(struck(), {"damper.start": [-1.0, 0.0, 1.0], GAP: [gap]}, "rms", progress=False)
    assert float(result.rms[0]) == of(members.rms.values.ravel())


def test_front_is_not_dominated() -> None:
    """No feasible trial dominates a trial on the front."""
    result = searched()
    allowed = result.isel(trial=result.feasible.values)
    best = result.isel(trial=result.front.values)
    both = np.array([allowed.added_mass, -allowed.impact_share]).T
    for values in np.array([best.added_mass, -best.impact_share]).T:
        assert not ((both <= values).all(axis=1) & (both < values).any(axis=1)).any()
    assert set(result.front.values) <= set(allowed.trial.values)
    assert (np.diff(best.added_mass) > 0).all()
    assert best.sizes["trial"] == result.sizes["front"] >= 2


def test_best_case_is_the_trial() -> None:
    """The case file of a trial on the front has its parameters, its mass and its objective."""
    result = searched(objective="impact_share", trials=8)
    case = rb.Case.from_toml(result.case.item())
    best = result.isel(trial=int(result.front.item()))
    assert float(best.impact_share) == np.nanmin(result.impact_share)
    assert case.dampers[0].gap == float(best[GAP])
    assert case.dampers[0].balls[0].weight == float(best.added_mass)


def test_mass_limit_is_applied() -> None:
    """Trials above the mass limit are not run and are not feasible, and the search learns to avoid them."""
    result = searched()
    heavy = result.added_mass > 1.0
    assert heavy.any()
    assert not result.feasible.values[heavy].any()
    assert np.isnan(result.impact_share.values[heavy]).all()
    assert result.feasible.values[12:].mean() > result.feasible.values[:12].mean() - 0.2


def test_trials_with_missing_values_are_not_feasible() -> None:
    """A trial with runs that never settle is not feasible and has the share of such runs."""
    with pytest.warns(UserWarning, match="no trial is feasible"):
        result = rb.design(struck(duration="0.5 s"), {GAP: ("0.1 mm", "2 mm")}, starts=2, trials=3, progress=False)
    assert not result.feasible.any()
    assert (result.missing == 1).all()
    assert result.sizes["front"] == 0


@pytest.mark.parametrize("frequency", [10.066, 51.3, 137.77])
def test_a_design_by_decay_at_any_frequency(frequency: float) -> None:
    """Each trial has a damping ratio at frequencies of machines; all tests had 10 or 50 Hz, where samples meet the end."""
    structure = rb.SDOF(mass="20 kg", frequency=frequency, damping_ratio=0.008)
    case = struck(structure=structure, load=None, duration=40.4 / frequency)
    options: dict[str, Any] = {"amplitudes": ["0.7 mm", "1.4 mm"], "packings": 2, "progress": False}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = rb.design(case, {GAP: ["0.9 mm", "1.3 mm"]}, "damping_ratio", **options)
    assert result.feasible.all()
    assert (result.damping_ratio > 0.01).all()


def test_a_search_without_a_feasible_trial_says_why(tmp_path: Path) -> None:
    """The warning counts the reasons; before, only the variable `reason` had them, which no test of a search looked at."""
    case = struck(load=None, duration="0.9 s")
    with pytest.warns(UserWarning, match=r"no trial is feasible.*\(2 of 2: some decays do not pass all amplitudes"):
        rb.design(case, {GAP: ["0.5 mm", "1 mm"]}, "damping_ratio", amplitudes=["0.2 mm", "2 mm"], progress=False)
    case = struck(duration="0.5 s")
    heavy = {"damper.ball.mass": ["0.1 kg", "3 kg", "4 kg"]}
    with pytest.warns(UserWarning, match=r"2 of 3: heavier than 1 kg; 1 of 3: no settling_time in some runs"):
        result = rb.design(case, heavy, max_added_mass=1.0, store=tmp_path / "out.zarr", progress=False)
    assert result.attrs["warnings"] == rb.open_study(tmp_path / "out.zarr").attrs["warnings"]
    shown = rattlebox("show", tmp_path / "out.zarr")
    assert shown.stdout.count("no trial is feasible") == 1
    rb.write_report(result, tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text(encoding="utf-8").count("no trial is feasible") == 1


MATERIALS, RESTITUTIONS = ["steel", "brass", "steel"], [0.5, 0.6, 0.7]


@pytest.mark.parametrize(
    "together",
    [
        {("damper.ball.material", "damper.contact.restitution"): (MATERIALS, RESTITUTIONS)},
        {"ball": {"damper.ball.material": MATERIALS, "damper.contact.restitution": RESTITUTIONS}},
    ],
    ids=["paths", "name"],
)
def test_parameters_that_vary_together(together: Any) -> None:
    """Trials have the rows of linked lists, as a sweep has them; only the sweep had been tried with them."""
    result = rb.design(struck(), together, "impact_share", progress=False)
    assert result["damper.ball.material"].values.tolist() == MATERIALS
    assert result["damper.contact.restitution"].values.tolist() == RESTITUTIONS
    same = rb.sweep(struck(), together, "impact_share", progress=False)
    np.testing.assert_array_equal(result.impact_share, same.impact_share)
    best = rb.Case.from_toml(result.case.item(0))
    assert best.dampers[0].contact.restitution.e == RESTITUTIONS[int(result.front[0])]
    both = rb.design(struck(), {**together, GAP: ("0.5 mm", "2 mm")}, "impact_share", trials=6, progress=False)
    rows = zip(both["damper.ball.material"].values, both["damper.contact.restitution"].values, strict=True)
    assert set(rows) <= set(zip(MATERIALS, RESTITUTIONS, strict=True))
    panels = rb.plot_design(both).axes  # one for both parameters
    assert [panel.get_xlabel() for panel in panels] == ["Trial", "Ball material", "Gap (mm)"]


def test_the_report_repeats_parameters_that_vary_together(tmp_path: Path) -> None:
    """The study file in a report starts the same trials."""
    together = {("damper.ball.material", "damper.contact.restitution"): (MATERIALS, RESTITUTIONS)}
    result = rb.design(struck(), together, "impact_share", progress=False)
    call = KIND.call(result)
    again = rb.design(struck(), call.arguments["parameters"], "impact_share", progress=False)
    np.testing.assert_array_equal(again.impact_share, result.impact_share)
    file = {"case": tomllib.loads(struck().to_toml()), "kind": "design", "objective": "impact_share"}
    study = study_from_toml(tomli_w.dumps({**file, "parameters": call.arguments["parameters"]}))
    np.testing.assert_array_equal(study.run(progress=False).impact_share, result.impact_share)


def test_show_lists_the_trials_of_an_unfinished_design(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stopped design shows its trials with units and reasons; before, it showed their number only."""
    monkeypatch.setenv("COLUMNS", "160")
    store = tmp_path / "out.zarr"
    parameters = {GAP: ("0.2 mm", "2 mm"), "damper.ball.material": ["steel", "lead"]}

    def stop(done: int, total: int) -> bool:
        return done < 5

    options: dict[str, Any] = {"max_added_mass": "1 kg", "trials": 20, "store": store}
    with pytest.raises(Stopped):
        rb.design(struck(), parameters, "impact_share", progress=stop, **options)
    with (store / "progress" / "trials.journal").open("ab") as file:
        file.write(b'{"op_code":6,"half')  # as a process leaves it that is killed
    shown = rattlebox("show", store).stdout
    finished = rb.design(struck(), parameters, "impact_share", progress=False, **options)
    assert "5 trials" in shown and "not finished" in shown
    for trial in range(5):
        (row,) = re.findall(rf"^ +{trial} +(\S+ mm) +(\S+) ", shown, re.MULTILINE)
        assert row == (quantity(float(finished[GAP][trial]), "m"), str(finished["damper.ball.material"].values[trial]))
    assert "heavier than 1 kg" in shown


def test_choices_and_misfits() -> None:
    """Numbers and names are chosen from lists; trials with incompatible parameters are not feasible."""
    parameters = {
        "damper.ball.material": ["steel", "brass"],
        "damper.ball.diameter": ["20 mm", "30 mm", "40 mm"],
        "damper.cavity_length": ["25 mm", "42 mm"],
    }
    result = rb.design(struck(), parameters, "rms", trials=20, progress=False)
    assert set(result["damper.ball.material"].values) == {"steel", "brass"}
    assert set(result["damper.ball.diameter"].values) <= {0.02, 0.03, 0.04}
    misfit = (result["damper.ball.diameter"] > result["damper.cavity_length"]).values
    assert misfit.any()
    assert (result.feasible.values == ~misfit).all()
    assert (result.missing.values[misfit] == 1).all()


def test_the_duration_may_be_searched() -> None:
    """The duration can be a parameter: the impacts of the trials are those of a sweep over their durations."""
    result = rb.design(struck(), {"duration": ("0.05 s", "0.5 s")}, "impacts", trials=3, progress=False)
    swept = rb.sweep(struck(), {"duration": result.duration.values}, "impacts", progress=False)
    assert (result.impacts.values == swept.impacts.values).all()
    assert len(set(result.impacts.values)) > 1


def test_own_measure() -> None:
    """A function of a Run can be an objective."""

    def last_place(run: Any) -> float:
        return float(abs(run.arrays.displacement[-1, 0]))

    result = rb.design(struck(), {GAP: ("0.1 mm", "2 mm")}, last_place, trials=2, progress=False)
    gap = float(result[GAP][0])
    run = rb.simulate(struck(damper=struck().dampers[0].model_copy(update={"gap": gap})))
    assert float(result.last_place[0]) == pytest.approx(last_place(run))


def test_same_seed_same_trials() -> None:
    """A seed fixes the trials for any number of threads; another seed gives other trials."""
    assert without_times(searched()).identical(without_times(searched(workers=1)))
    assert not searched(trials=3)[GAP].equals(searched(trials=3, seed=6)[GAP])


def test_a_stop_changes_nothing(tmp_path: Path) -> None:
    """After Ctrl-C, a truncated line and a call with fewer trials, the same call gives the result without a stop."""
    store = tmp_path / "design"
    journal = store / "progress" / "trials.journal"

    def interrupt(done: int, total: int) -> None:
        if done == 11:
            raise KeyboardInterrupt

    searched(trials=5, store=store)
    with pytest.raises(Stopped, match=r"11 of 24 trials, .*design.* resumes"):
        searched(store=store, progress=interrupt)
    assert count_trials(store) == 11
    with journal.open("ab") as file:
        file.write(b'{"op_code":4,"wor')
    counts: list[int] = []
    resumed = searched(store=store, progress=lambda done, total: counts.append(done))
    assert without_times(resumed).identical(without_times(searched()))
    assert counts[0] == 11 and counts[-1] == 24
    assert without_times(searched(trials=5, store=store)).identical(without_times(searched(trials=5)))


def _search_into(store: str) -> None:
    searched(store=store, trials=400)


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_kill_loses_nothing(tmp_path: Path) -> None:
    """After kill -9 in the middle of a search, the resumed search has the same trials."""
    store = tmp_path / "design"
    journal = store / "progress" / "trials.journal"
    process = multiprocessing.get_context("spawn").Process(target=_search_into, args=(str(store),))
    process.start()
    deadline = time.monotonic() + 60
    while not journal.exists() or journal.stat().st_size < 20_000:
        assert time.monotonic() < deadline and process.is_alive()
        time.sleep(0.01)
    assert process.pid is not None
    os.kill(process.pid, signal.SIGKILL)
    process.join()
    assert without_times(searched(store=store)).identical(without_times(searched()))


def test_another_study_is_refused(tmp_path: Path) -> None:
    """A store of another case, seed, parameters or kind of study is refused with the difference."""
    store = tmp_path / "design"
    searched(trials=2, store=store)
    with pytest.raises(rb.StoreError, match=r"another study\n  seed: 5 there, 1 here"):
        searched(trials=2, store=store, seed=1)
    with pytest.raises(rb.StoreError, match=r"another study\n  parameters"):
        searched(trials=2, store=store, log=[])

    def measured(run: rb.Run) -> float:
        return float(run.energy_residual)

    def changed(run: rb.Run) -> float:
        return 2.0

    changed.__name__ = measured.__name__
    searched(trials=1, objective=measured, store=tmp_path / "own")
    with pytest.raises(rb.StoreError, match=r"another study\n  functions"):
        searched(trials=1, objective=changed, store=tmp_path / "own")
    other = tmp_path / "notes.txt"
    other.write_text("buy milk\n")
    with pytest.raises(rb.StoreError, match="a study must be a folder"):
        searched(trials=2, store=other)
    assert other.read_text() == "buy milk\n"
    with pytest.raises(rb.StoreError, match="holds other files"):
        searched(trials=2, store=tmp_path)
    with pytest.raises(rb.StoreError, match="holds a design"):
        rb.sweep(struck(), {GAP: [1e-3]}, store=store)
    rb.sweep(struck(), {GAP: [1e-3]}, store=tmp_path / "sweep", progress=False)
    with pytest.raises(rb.StoreError, match="holds another study"):
        searched(trials=2, store=tmp_path / "sweep")
    assert count_trials(store) == 2 and count_trials(tmp_path / "sweep") is None


def test_open_study_returns_the_result(tmp_path: Path) -> None:
    """The study on disk equals the returned one, with the case files of the best trials."""
    result = searched(trials=6, store=tmp_path / "design")
    there = rb.open_study(tmp_path / "design").load()
    xr.testing.assert_equal(there, result)
    assert there.attrs == result.attrs
    assert list(there) == list(result)


@pytest.mark.parametrize(
    ("parameters", "options", "message"),
    [
        ({"damper.gapp": (1e-4, 1e-3)}, {}, "did you mean 'gap'"),
        ({GAP: (1e-3, 1e-4)}, {}, "smaller than the second"),
        ({GAP: ("1 mm", "1 kg")}, {}, "a length"),
        ({GAP: (1e-4, 1e-3, 1e-2)}, {}, "a pair"),
        ({GAP: 1e-3}, {}, "a list is needed"),
        ({(GAP, RADIUS): (["1 mm"], ["9 mm", "8 mm"])}, {}, "same number of values"),
        ({(GAP, RADIUS): (["1 mm"],)}, {}, "number of lists"),
        ({(GAP, RADIUS): (("1 mm", "2 mm"), ("9 mm", "8 mm"))}, {}, "bounds cannot vary together"),
        ({(GAP, RADIUS): (["1 mm"], ["9 mm"]), GAP: ["2 mm"]}, {}, "varies twice"),
        ({(GAP, "damper.start"): (["1 mm"], ["0.1 mm"])}, {}, "fractions of the gap"),
        ({3: ["1 mm"]}, {}, "3 is not a path"),
        ({"damper.start": ("0.1 mm", "0.2 mm")}, {}, "fractions of the gap"),
        ({"damper.ball.material": ("steel", "brass")}, {}, "a list to choose from"),
        ({"damper.ball.material": ["steel", "bras"]}, {}, "brass"),
        ({"damper.start": (0, 1)}, {"log": ["damper.start"]}, "greater than zero"),
        (BOUNDS, {"log": ["damper.gapp"]}, "did you mean 'damper.gap'"),
        (BOUNDS, {"objective": "settling"}, "settling_time"),
        (BOUNDS, {"objective": {"rms": "least"}}, '"min" or "max"'),
        (BOUNDS, {"objective": "added_mass"}, "smallest damper"),
        (BOUNDS, {"objective": []}, "objective is empty"),
        (BOUNDS, {"robust": "best"}, "worst"),
        (BOUNDS, {"starts": 1}, "at least 2"),
        (BOUNDS, {"trials": 0}, "at least 1"),
        (BOUNDS, {"max_added_mass": "1 m"}, "a mass"),
        (BOUNDS, {"levels": {"load.amplitud": [1.0]}}, "did you mean 'amplitude'"),
        (BOUNDS, {"cycles": (1, 1)}, "cycles require a harmonic load"),
        ({}, {}, "paths to bounds or choices"),
        ({"damper.start": (-1, 1)}, {"starts": 2}, "damper.start varies twice"),
        ({"load.amplitude": ("1 kN", "5 kN")}, {"levels": {"loads[0].amplitude": ["1 kN"]}}, "varies twice, also as"),
        ({GAP: (1e-4, 1e-3), "dampers[0].gap": (1e-4, 1e-3)}, {}, "varies twice, also as"),
        ({RADIUS: (0.01, 0.02), "damper.ball.diameter": (0.01, 0.02)}, {}, "exclude each other"),
    ],
)
def test_clear_refusals(parameters: Any, options: dict[str, Any], message: str) -> None:
    """Bad arguments are refused before the first trial, with advice."""
    with pytest.raises(rb.CaseError) as caught:
        rb.design(struck(), parameters, progress=False, **options)
    assert message in str(caught.value)


def test_without_optuna(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without Optuna the error has the command that installs it."""
    monkeypatch.setitem(sys.modules, "optuna", None)
    with pytest.raises(rb.MissingDependency, match=r"pip install 'rattlebox\[design\]'"):
        rb.design(struck(), BOUNDS)


def test_optuna_is_silent(capfd: pytest.CaptureFixture[str]) -> None:
    """Optuna prints nothing, and its log level is not changed."""
    import optuna

    before = optuna.logging.get_verbosity()
    searched(trials=2)
    assert capfd.readouterr() == ("", "")
    assert optuna.logging.get_verbosity() == before


@pytest.mark.parametrize("size", ["column", "page", "slide"])
@pytest.mark.parametrize("objective", ["impact_share", ["added_mass", "impact_share"]])
def test_plot(objective: Any, size: Any, tmp_path: Path) -> None:
    """Searches for one and for several objectives are drawn without a warning, with the best trials marked."""
    result = searched(objective=objective, trials=12)
    figure = rb.plot_design(result, size=size)
    figure.savefig(tmp_path / "design.png")
    assert len(figure.axes) == 3
    marked = figure.axes[1].get_lines()[-1]
    assert len(np.asarray(marked.get_xdata())) == result.sizes["front"]


@pytest.mark.parametrize("objective", ["impact_share", ["added_mass", "impact_share"]])
def test_plot_has_ticks_at_the_values_of_a_list(objective: Any) -> None:
    """Ticks are at the values of a list, which have equal distances on a logarithmic axis if their ratios are equal.

    Figures of bounds and of names were looked at; those of a list of numbers had ticks between its values.
    """
    few, many = [2e-4, 5e-4, 1.2e-3], (1e-5 * 10 ** np.arange(4)).tolist()
    options: dict[str, Any] = {"objective": objective, "starts": 2, "progress": False, "levels": {}}
    result = rb.design(struck(), {GAP: few, RADIUS: [0.03, 0.04]}, **options)
    axis = "xaxis" if isinstance(objective, str) else "yaxis"
    shown = getattr(rb.plot_design(result).axes[1], axis)
    np.testing.assert_allclose(shown.get_ticklocs(), [0.2, 0.5, 1.2])
    assert [text.get_text() for text in shown.get_ticklabels()] == ["0.2", "0.5", "1.2"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the extreme gaps have no value
        result = rb.design(struck(), {GAP: many, RADIUS: [0.03, 0.04]}, **options)
    assert getattr(rb.plot_design(result).axes[1], axis).get_scale() == "log"


def test_plot_shows_why_a_trial_is_not_feasible() -> None:
    """The legend distinguishes trials without a value and too heavy ones, and ticks of trials are whole numbers."""
    with pytest.warns(UserWarning, match="no trial is feasible"):
        nothing = rb.design(struck(duration="0.5 s"), {GAP: ("0.1 mm", "2 mm")}, starts=2, trials=3, progress=False)
    limited = searched(objective="impact_share")
    for result, label in ((nothing, "no value (3)"), (limited, f"too heavy ({int((~limited.feasible).sum())})")):
        axes = rb.plot_design(result).axes[0]
        assert axes.get_legend_handles_labels()[1][2:] == [label]
        assert all(tick == int(tick) for tick in axes.get_xticks())


def test_example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the example heavier balls settle sooner, the heaviest in less than half the time without damper."""
    monkeypatch.chdir(tmp_path)
    result = runpy.run_path(str(EXAMPLE))["result"]
    best = result.isel(trial=result.front.values)
    assert (np.diff(best.settling_time) < 0).all()
    bare = 3 * 2 * 20 / 25.3  # ln 20 time constants of the envelope
    assert float(best.settling_time[0]) < bare
    assert float(best.settling_time[-1]) < 0.45 * bare
    heaviest = rb.Case.from_file(tmp_path / "fastest.toml")
    assert heaviest.dampers[0].gap == pytest.approx(0.85e-3, rel=0.2)
    assert (tmp_path / "design.png").stat().st_size > 5000


def test_a_measure_that_returns_no_number_is_refused() -> None:
    """An error in a measure is raised; it is not treated as an infeasible trial."""

    def words(run: rb.Run) -> Any:
        return "many"

    with pytest.raises(rb.CaseError, match="measure words: the function returned str for variant 0"):
        rb.design(struck(), BOUNDS, words, trials=2, progress=False)
