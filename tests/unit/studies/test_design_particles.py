"""Designs of particle dampers: objectives, intervals, budget, refused arguments."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.stats import t

import rattlebox as rb
from rattlebox.cli.show import show_study
from rattlebox.cli.sweep import run_sweep
from rattlebox.studies.design import trials
from rattlebox.studies.design.search import DesignSearch
from rattlebox.studies.run.estimate import Estimate, duration

COUNT, SIZE, NUMBER, SEED = (
    "damper.particles.count",
    "damper.particles.diameter",
    "damper.number",
    "damper.packing.seed",
)


def box(**changes: Any) -> rb.ParticleDamper:
    """Return a box with a few balls."""
    usual: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="5 mm", count=8),
        "cavity": rb.Box(size=("15 mm", "15 mm", "20 mm")),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.2,
        "direction": "z",
        "softening": 1000,
    }
    return rb.ParticleDamper(**{**usual, **changes})


def struck(damper: rb.ParticleDamper | None = None, **changes: Any) -> rb.Case:
    """Return the box on a structure with an initial velocity."""
    usual: dict[str, Any] = {
        "structure": rb.SDOF(mass="0.1 kg", frequency="100 Hz", damping_ratio=0.02, velocity="0.5 m/s"),
        "damper": damper or box(),
        "duration": "0.2 s",
    }
    return rb.Case(**{**usual, **changes})


def searched(parameters: Any = None, objective: Any = "rms", case: rb.Case | None = None, **options: Any) -> xr.Dataset:
    """Return a short search."""
    usual: dict[str, Any] = {"packings": 2, "progress": False}
    return rb.design(case or struck(), parameters or {COUNT: [4, 8]}, objective, **(usual | options))


@pytest.mark.parametrize(("robust", "reduce"), [("worst", np.max), ("mean", np.mean), ("median", np.median)])
def test_objectives_are_means_over_packings(robust: Any, reduce: Any) -> None:
    """An objective is the mean over packings of its reduction over levels, with the interval of Student's t."""
    levels = {"structure.velocity": ["0.2 m/s", "0.5 m/s"]}
    result = searched(levels=levels, packings=3, robust=robust)
    for trial, count in enumerate((4, 8)):
        runs = rb.sweep(struck(), {COUNT: [count], **levels, SEED: [0, 1, 2]}, "rms", progress=False)
        each = reduce(runs.rms.values[0], axis=0)
        assert result.rms_packings[trial].values == pytest.approx(each, rel=1e-12)
        assert float(result.rms[trial]) == pytest.approx(each.mean(), rel=1e-12)
        half = t.ppf(0.975, 2) * each.std(ddof=1) / np.sqrt(3)
        assert float(result.rms_interval[trial]) == pytest.approx(half, rel=1e-9)
        assert float(result[COUNT][trial]) == count
        assert float(result.added_mass[trial]) == pytest.approx(count * 7850 * np.pi / 6 * 0.005**3)
    assert result.attrs["study"] == "design"


@pytest.mark.filterwarnings("ignore:at .*, which decides")
def test_the_least_damping_ratio_is_an_objective() -> None:
    """A damping ratio is maximised: the least one over the amplitudes of each packing."""
    options: dict[str, Any] = {"amplitudes": ["0.2 mm", "0.25 mm"]}
    result = searched({NUMBER: [1, 2]}, "damping_ratio", **options)
    for trial, number in enumerate((1, 2)):
        case = struck(box(number=number))
        curve = rb.damping_curve(case, options["amplitudes"], packings=2, progress=False)
        least = curve.damping_ratios.min("amplitude").values
        assert np.array_equal(result.damping_ratio_packings[trial].values, least)
        assert float(result.damping_ratio[trial]) == least.mean()
    assert result.damping_ratio.attrs["goal"] == "max"
    best = int(result.damping_ratio.values.argmax())
    assert int(result.front.item()) == best
    assert rb.Case.from_toml(result.case.item()).dampers[0].number == best + 1
    with_mass = searched({NUMBER: [1, 2]}, ["added_mass", "damping_ratio"], **options)
    assert with_mass.front.values.tolist() == ([0, 1] if best else [0])
    assert [with_mass[name].attrs["goal"] for name in ("added_mass", "damping_ratio")] == ["min", "max"]


def test_damping_ratios_of_balls_are_objectives() -> None:
    """The damping ratio is an objective of impact dampers, too, with random start positions as packings."""
    case = struck(duration="2 s").model_copy(
        update={
            "dampers": (
                rb.ImpactDamper(
                    ball=rb.Sphere(diameter="8 mm", material="steel"), gap="0.4 mm", contact=rb.Tsuji(restitution=0.6)
                ),
            ),
            "method": rb.EventDriven(),
        }
    )
    options: dict[str, Any] = {"amplitudes": rb.geomspace("0.2 mm", "0.25 mm", 2), "robust": "mean"}
    result = searched({"damper.gap": ["0.1 mm", "0.4 mm"]}, "damping_ratio", case, **options, packings=3)
    best = rb.damping_curve(
        case.replaced({"damper.gap": "0.1 mm"}), ["0.2 mm", "0.25 mm"], packings=3, progress=False
    ).damping_ratios
    assert result.damping_ratio_packings[0].values == pytest.approx(best.mean("amplitude").values, rel=1e-12)


def test_directions_of_motion_and_gravity_are_levels() -> None:
    """A design is evaluated for several directions of the motion and of gravity."""
    down = [[0, 0, -9.81], [-9.81, 0, 0]]
    levels = {"damper.direction": ["x", "z"], "damper.gravity": down}
    result = searched({NUMBER: [2]}, "rms", levels=levels)
    runs = rb.sweep(struck(box(number=2)), {**levels, SEED: [0, 1]}, "rms", progress=False)
    assert len(set(runs.rms.values.ravel().tolist())) == 8
    assert float(result.rms.item()) == pytest.approx(float(runs.rms.max(list(levels)).mean()), rel=1e-12)


def test_all_combinations_of_choices_are_tried() -> None:
    """Lists of choices are tried in all combinations, once each, and a store continues after a stop."""
    parameters = {COUNT: [4, 8], SIZE: ["4 mm", "5 mm"], "damper.particles.material": ["steel", "brass"]}
    result = searched(parameters, packings=1)
    tried = {(int(a), float(b), str(c)) for a, b, c in zip(*(result[path].values for path in parameters), strict=True)}
    assert result.sizes["trial"] == len(tried) == 8
    assert searched(parameters, packings=1, trials=50).sizes["trial"] == 8


def test_repeated_trials_are_not_run_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A random search among choices takes the result of an equal earlier trial."""
    counted: list[int] = []
    begin = trials.Trials._begin
    monkeypatch.setattr(trials.Trials, "_begin", lambda *a: (counted.append(1), begin(*a))[1])
    result = searched({COUNT: [4, 8], SIZE: ["4 mm", "5 mm"]}, packings=1, trials=3)
    different = {*zip(result[COUNT].values.tolist(), result[SIZE].values.tolist(), strict=True)}
    assert len(counted) == len(different) == len(set(result.rms.values.tolist())) < 3
    assert result.feasible.all()


def test_whole_numbers_between_bounds() -> None:
    """Bounds of a whole number give whole numbers."""
    result = searched({COUNT: (4, 8), NUMBER: (1, 2)}, "rms", packings=1, trials=3)
    assert result[COUNT].values.dtype.kind == "i" and result[NUMBER].values.dtype.kind == "i"
    assert ((result[COUNT] >= 4) & (result[COUNT] <= 8)).all()
    assert result.feasible.all()


def test_a_single_packing_has_the_interval_of_its_runs() -> None:
    """For one packing the interval follows from those of the runs; measures without an interval have none."""
    shaken = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=(60, "m/s^2"), frequency=50, direction="z")),
        damper=box(),
        duration="1 s",
    )
    levels = {"structure.motion.amplitude": ["50 m/s^2", "80 m/s^2", "90 m/s^2"]}
    window: dict[str, Any] = {"levels": levels, "cycles": (5, 40), "packings": 1}
    runs = rb.sweep(shaken, levels, ["loss_per_cycle", "peak"], cycles=(5, 40), progress=False)
    values, half = runs.loss_per_cycle.values, runs.loss_per_cycle_interval.values
    assert np.isfinite(half).all()
    order = np.argsort(values)
    expected = {"worst": half[order[0]], "median": half[order[1]], "mean": np.sqrt((half**2).sum()) / 3}
    for robust, width in expected.items():
        result = searched({COUNT: [8]}, {"loss_per_cycle": "max", "peak": "min"}, shaken, robust=robust, **window)
        assert float(result.loss_per_cycle_interval.item()) == pytest.approx(width, rel=1e-9)
        assert np.isnan(result.peak_interval.item()) and "loss_per_cycle_packings" not in result


def test_exceeded_limits_are_flagged() -> None:
    """Trials with runs beyond the validity limits of contacts are flagged, and the best one by name."""
    result = searched({"damper.softening": [100, 1e5]}, case=struck(duration="0.02 s"), packings=1)
    flags = result.warnings.attrs
    mask = dict(zip(flags["flag_meanings"].split(), flags["flag_masks"], strict=True))["deep_overlap"]
    assert [bool(each & mask) for each in result.warnings.values] == [False, True]
    soft = searched({"damper.softening": [1e5]}, case=struck(duration="0.02 s"), packings=1)
    assert "trial 0: overlaps above 1 % of the radius" in soft.attrs["flagged"]


def test_trials_that_are_not_feasible_have_a_reason() -> None:
    """Designs that do not fit, are too heavy or have runs without a value are not feasible, with the reason."""
    cavities = {"damper.cavity.size": [["25 mm", "25 mm", "25 mm"], ["30 mm", "30 mm", "9 mm"]]}
    case = struck(box(particles=rb.Particles(material="steel", diameter="5 mm", count=4)))
    sizes = searched({SIZE: ["5 mm", "10 mm"], **cavities}, case=case, packings=1, max_added_mass="9 g")
    high, flat = sizes.reason.values.reshape(2, 2)[1]
    assert sizes.reason.values[:2].tolist() == ["", ""] and high == "heavier than 0.009 kg"
    assert "is larger than the cavity" in flat
    assert sizes.feasible.values.tolist() == [not reason for reason in sizes.reason.values]
    with pytest.warns(UserWarning, match="1 of 1: some decays do not pass"):
        short = searched({COUNT: [4]}, "damping_ratio", amplitudes=["1 um", "1 mm"])
    assert short.reason.item() == "some decays do not pass all amplitudes within the duration"
    assert float(short.missing.item()) > 0
    coarse = struck(method=rb.Dem(dt="40 us"))
    refused = searched({"damper.softening": [1e5, 1.0]}, case=coarse, packings=1)
    assert "40.0 µs is too long" in str(refused.reason.values[1]) and refused.feasible.values.tolist() == [True, False]


# ---- budget


def test_the_budget_is_predicted_and_printed(capsys: pytest.CaptureFixture[str]) -> None:
    """The number of runs and the predicted times are printed before the start, and are about those of the runs."""
    case = struck(box(particles=rb.Particles(material="steel", diameter="3 mm", count=60)), duration="0.1 s")
    parameters = {"damper.particles.count": [20, 60]}
    result = searched(parameters, case=case, packings=3, workers=1, budget="1 h", progress=True)
    printed = capsys.readouterr().err
    assert "design: 2 trials, 6 runs: about" in printed and "of processor time" in printed
    assert 0.3 < result.attrs["predicted_cpu_time"] / result.attrs["cpu_time"] < 3
    assert result.attrs["predicted_wall_time"] >= result.attrs["predicted_cpu_time"]
    searched(parameters, case=case, packings=1, progress=False)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("options", [{"parameters": {COUNT: [4, 8]}}, {"parameters": {COUNT: (4, 8)}, "trials": 20}])
def test_a_budget_that_does_not_suffice_is_refused(options: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the predicted time exceeds the budget, nothing runs, and the error names what fits."""
    monkeypatch.setattr(DesignSearch, "evaluate", lambda *_: pytest.fail("a trial ran"))
    total = options.get("trials", 2)
    monkeypatch.setattr(
        "rattlebox.studies.kinds.design.predict",
        lambda search, trials: Estimate(trials, 2 * trials, 40.0 * trials, 20.0 * trials, 2),
    )
    with pytest.raises(rb.CaseError) as caught:
        searched(**options, budget="30 s")
    message = str(caught.value)
    assert f"budget = 30 s is less than predicted for {total} trials, {2 * total} runs" in message
    assert "try: trials = 1, budget = " in message
    with pytest.raises(rb.CaseError, match="try: budget ="):
        searched(**options, budget="10 s")


def test_a_search_ends_at_its_budget(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A search that reaches its budget returns the finished trials with a note, and the same call continues."""

    def slow(run: rb.Run) -> float:
        time.sleep(0.1)
        return float(run.arrays.displacement[-1, 0])

    options: dict[str, Any] = {"packings": 1, "store": tmp_path / "design", "budget": "4 s"}
    case = struck(duration="5 ms")
    begun = time.monotonic()
    speeds = {"structure.velocity": ("0.2 m/s", "0.5 m/s")}
    first = searched(speeds, slow, case, **options, progress=True)
    assert time.monotonic() - begun < 8
    done = first.sizes["trial"]
    assert 0 < done < 100
    assert first.attrs["stopped"] == f"stopped at the budget of 4 s after {done} of 100 trials"
    printed = capsys.readouterr().err
    assert "design: 100 trials, 100 runs: about" in printed and first.attrs["stopped"] in printed
    assert rb.open_study(tmp_path / "design").attrs["stopped"] == first.attrs["stopped"]
    second = searched(speeds, slow, case, **options | {"budget": None, "trials": done + 2})
    assert "stopped" not in second.attrs and second.sizes["trial"] == done + 2
    assert np.array_equal(second.slow.values[:done], first.slow.values)


def test_the_budget_ends_a_run_in_progress(monkeypatch: pytest.MonkeyPatch) -> None:
    """If the prediction was wrong, a run is stopped at the budget; without a finished trial it is an error."""
    monkeypatch.setattr(
        "rattlebox.studies.kinds.design.predict", lambda search, trials: Estimate(trials, trials, 0.1, 0.1, 2)
    )
    for objective, more in (("rms", {}), ("damping_ratio", {"amplitudes": ["0.1 mm", "0.2 mm"]})):
        begun = time.monotonic()
        with pytest.raises(rb.CaseError, match=r"the budget of 0\.5 s ended before the first trial"):
            searched({COUNT: [8]}, objective, struck(duration="1000 s", output=rb.Output(rate=10)), budget=0.5, **more)
        assert time.monotonic() - begun < 10


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0123, "0.012 s"), (9.6, "10 s"), (100, "100 s"), (119, "2 min"), (7100, "2 h"), (1e6, "278 h")],
)
def test_durations(seconds: float, text: str) -> None:
    """Durations have a readable unit."""
    assert duration(seconds) == text


# ---- study files and errors

STUDY = """
kind = "design"
objective = { damping_ratio = "max", added_mass = "min" }
amplitudes = { from = "0.2 mm", to = "0.25 mm", count = 2, spacing = "log" }
way = "energy"
packings = 2
trials = 4
robust = "mean"
budget = "10 min"
levels = { "damper.direction" = ["x", "z"] }

[parameters]
"damper.number" = { from = 1, to = 2 }
"damper.particles.diameter" = ["4 mm", "5 mm"]

[case]
duration = "0.2 s"
structure = { kind = "sdof", mass = "0.1 kg", frequency = "100 Hz", damping_ratio = 0.02 }

[case.damper]
particles = { material = "steel", diameter = "5 mm", count = 8 }
cavity = { kind = "box", size = ["15 mm", "15 mm", "20 mm"] }
contact = { kind = "tsuji", restitution = 0.7 }
friction = 0.2
softening = 1000
"""


def test_study_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A study file has all arguments, its command prints the budget, and its result is that of the equivalent call."""
    file = tmp_path / "design.toml"
    file.write_text(STUDY)
    run_sweep(file, None, None, None)
    assert "design: 4 trials, 16 runs: about" in capsys.readouterr().err
    case = struck(box(direction="x"), structure=rb.SDOF(mass="0.1 kg", frequency="100 Hz", damping_ratio=0.02))
    called = searched(
        {NUMBER: (1, 2), SIZE: ["4 mm", "5 mm"]},
        {"damping_ratio": "max", "added_mass": "min"},
        case,
        amplitudes=["0.2 mm", "0.25 mm"],
        way="energy",
        robust="mean",
        levels={"damper.direction": ["x", "z"]},
        trials=4,
    )
    there = rb.open_study(tmp_path / "design.zarr")
    for name in (NUMBER, SIZE, "damping_ratio", "damping_ratio_interval", "added_mass"):
        assert np.array_equal(there[name].values, called[name].values, equal_nan=True)
    show_study(tmp_path / "design.zarr")
    assert " ± " in capsys.readouterr().out


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "unknown path": ({"parameters": {"damper.particles.diametre": ["4 mm"]}}, "did you mean 'diameter'"),
    "bounds": ({"parameters": {SIZE: ("5 mm", "4 mm")}}, "smaller than the second"),
    "material": ({"parameters": {"damper.particles.material": ["steel", "unobtainium"]}}, "unobtainium"),
    "cavity": ({"parameters": {"damper.cavity.size": [["4 mm"] * 3, ["3 mm"] * 3]}}, "is larger than the cavity"),
    "all too large": ({"parameters": {SIZE: ("30 mm", "40 mm")}}, "no design is valid"),
    "no damper": ({"parameters": {NUMBER: [0, 1]}}, "must be at least 1"),
    "half a damper": ({"parameters": {NUMBER: [1.5]}}, "an integer is needed"),
    "no ball": ({"parameters": {COUNT: [0, 5]}}, "must be at least one"),
    "no packing": ({"packings": 0}, "must be at least 1"),
    "no trial": ({"trials": 0}, "must be at least 1"),
    "no budget": ({"budget": 0}, "must be greater than zero"),
    "no time": ({"budget": "5 mm"}, "a time (s) is needed"),
    "impacts": ({"objective": "impacts"}, "which particle runs do not store"),
    "orbit": ({"objective": "loss_factor"}, "requires a harmonic load or motion"),
    "no amplitudes": ({"objective": "damping_ratio"}, "requires amplitudes"),
    "amplitudes": ({"amplitudes": ["1 mm", "2 mm"]}, "not an objective"),
    "one amplitude": ({"objective": "damping_ratio", "amplitudes": ["1 mm"]}, "at least two"),
    "mode": ({"objective": "damping_ratio", "amplitudes": ["1 mm", "2 mm"], "mode": 2}, "is not a mode"),
    "way": ({"objective": "damping_ratio", "amplitudes": ["1 mm", "2 mm"], "way": "decays"}, "'decay'"),
    "starts": ({"starts": 3}, "exactly one ball"),
    "seeds": ({"parameters": {SEED: [1, 2]}}, "varies twice"),
    "order": ({"case": struck(box(packing=rb.Lattice(noise=0)))}, "no random seed"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_clear_refusals(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wrong arguments are refused before anything runs, with advice."""
    monkeypatch.setattr("rattlebox.studies.kinds.design.predict", lambda *_: pytest.fail("something ran"))
    options, message = REFUSED[name]
    with pytest.raises(rb.CaseError) as caught:
        searched(**options)
    assert message in str(caught.value)


def test_rings_and_bars(tmp_path: Path) -> None:
    """Figures have the intervals of objectives, and rings around trials that exceed limits."""
    for objective in ("rms", ["added_mass", "rms"]):
        result = searched({"damper.softening": [100, 1e5]}, objective, struck(duration="0.02 s"))
        figure = rb.plot_design(result)
        figure.savefig(tmp_path / "design.png")
        axes = figure.axes[0]
        assert "limits exceeded (1)" in axes.get_legend_handles_labels()[1]
        bars = axes.containers[0].lines[2]
        assert len(bars) == 1 and len(bars[0].get_segments()) == 2
