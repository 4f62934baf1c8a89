"""Designs whose packings run in stages: trials that are dropped early, and those that are precise enough."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.stats import t

import rattlebox as rb
from rattlebox._util.exceptions import CaseError
from rattlebox.report.kinds.design import KIND
from rattlebox.studies import damping_curve
from rattlebox.studies.design import trials
from rattlebox.studies.design.candidate import Candidate, Evaluation, pooled
from rattlebox.studies.design.evidence import curves_of
from rattlebox.studies.design.search import DesignSearch
from rattlebox.studies.design.trials import Trials
from rattlebox.studies.kinds.design import Design
from rattlebox.studies.run import runner
from rattlebox.studies.run.estimate import Estimate
from rattlebox.studies.run.runner import Stopped

FILL, COUNT, GAP = "damper.particles.fill_ratio", "damper.particles.count", "damper.gap"
LENGTH, RESTITUTION = "damper.cavity.size[2]", "damper.contact.restitution"


def with_bed(**particles: Any) -> rb.Case:
    """Return a structure with a box of balls."""
    return rb.Case(
        structure=rb.SDOF(mass="0.06 kg", frequency="90 Hz", damping_ratio=0.02, velocity="0.6 m/s"),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", **particles),
            cavity=rb.Box(size=("16 mm", "16 mm", "22 mm")),
            contact=rb.Tsuji(restitution=0.6),
            friction=0.3,
            direction="z",
            packing=rb.Settled(seed=4),
            softening=100,
        ),
        duration="0.1 s",
    )


def with_ball() -> rb.Case:
    """Return a structure with a ball between two walls."""
    ball = rb.ImpactDamper(
        ball=rb.Sphere(diameter="30 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.5)
    )
    return rb.Case(structure=rb.SDOF(mass="5 kg", frequency="30 Hz", damping_ratio=0.004), damper=ball, duration="1 s")


def shaken(case: rb.Case, parameters: Any, objective: Any = "damping_ratio", **options: Any) -> xr.Dataset:
    """Return a search by shaking."""
    usual: dict[str, Any] = {"way": "shaking", "cycles": (5, 5), "packings": 12, "progress": False}
    return rb.design(case, parameters, objective, **usual | options)


@pytest.fixture
def cycles(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Return a list to which the number of cycles of each run, or of the part that is new, is added on a shaker."""
    counted: list[float] = []
    usual = damping_curve.steady_run

    def run(case: rb.Case, *, frequency: float, part: float = 1.0, before: Any = None, **options: Any) -> Any:
        done = 0.0 if before is None else before.records["time"][-1]
        counted.append((part * case.duration - done) * frequency)
        return usual(case, frequency=frequency, part=part, before=before, **options)

    monkeypatch.setattr(damping_curve, "steady_run", run)
    return counted


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return a list to which the number of cases of each call is added that simulates cases."""
    counted: list[int] = []
    usual = runner._Cases.run

    def run(self: Any, numbers: range, **options: Any) -> Any:
        counted.append(len(numbers))
        return usual(self, numbers, **options)

    monkeypatch.setattr(runner._Cases, "run", run)
    return counted


GAPS9 = [float(gap) / 1e4 for gap in range(2, 11)]
GAPS = ["0.2 mm", "0.4 mm", "0.6 mm", "0.8 mm", "1 mm", "1.2 mm", "1.4 mm", "2.5 mm", "3.5 mm", "5 mm"]
FILLS = [0.04, 0.08, 0.12, 0.16, 0.2, 0.24, 0.28, 0.36, 0.44]
LENGTHS = ["14 mm", "16 mm", "18 mm", "20 mm", "22 mm", "25 mm", "28 mm", "32 mm", "36 mm", "40 mm"]
RESTITUTIONS = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95]
COUNTS = [2, 3, 5, 8, 12, 16, 20, 30, 40]
PLANTED: dict[str, Any] = {
    "clearance of a ball": (with_ball(), GAP, GAPS, ["0.5 mm", "0.6 mm"], 1.4e-3),
    "fill of a bed": (with_bed(fill_ratio=0.2), FILL, FILLS, ["2 mm", "3 mm"], 0.36),
    "number of balls": (with_bed(count=4), COUNT, COUNTS, ["2 mm", "3 mm"], 30),
}


@pytest.mark.parametrize("name", PLANTED)
def test_the_answer_is_the_same_at_a_third_of_the_runs(name: str, runs: list[int]) -> None:
    """The best design is that without dropping, with the same bits, and needs about a third of the runs."""
    case, path, choices, amplitudes, best = PLANTED[name]
    full = shaken(case, {path: choices}, amplitudes=amplitudes)
    needed = sum(runs)
    runs.clear()
    short = shaken(case, {path: choices}, amplitudes=amplitudes, drop=True)
    assert 0.25 * needed < sum(runs) < 0.36 * needed
    assert short[path].values[short.front.item()] == full[path].values[full.front.item()] == best
    assert short.case.item() == full.case.item()
    check_parts(short, full, path)
    assert short.dropped.sum() >= short.feasible.sum() - 2
    assert not (short.dropped & short.may_be_best).any()


MANY_CYCLES: dict[str, Any] = {
    "clearance of a ball": (with_ball(), GAP, GAPS, ["0.5 mm", "0.6 mm"], (40, 80), 1.4e-3),
    "length of a cavity": (with_bed(count=12), LENGTH, LENGTHS, ["2 mm", "3 mm"], (20, 40), 0.016),
    "restitution of a bed": (with_bed(count=20), RESTITUTION, RESTITUTIONS, ["2 mm", "3 mm"], (20, 40), 0.95),
}


def check_few_cycles(name: str, cycles: list[float], **options: Any) -> tuple[xr.Dataset, xr.Dataset]:
    """Return a planted search with and without dropping, after checks of its answer, its evidence and its cycles."""
    case, path, choices, amplitudes, numbers, best = MANY_CYCLES[name]
    options = {"amplitudes": amplitudes, "cycles": numbers, **options}
    full = shaken(case, {path: choices}, **options)
    needed = sum(cycles)
    cycles.clear()
    short = shaken(case, {path: choices}, drop=True, **options)
    assert sum(cycles) < needed / 3
    assert short[path].values[short.front.item()] == full[path].values[full.front.item()] == best
    assert short.case.item() == full.case.item()
    few, total = max(8, sum(numbers) // 4), sum(numbers)
    after_few = (short.cycles_run == few).values
    assert set(short.cycles_run.values.tolist()) <= {few, 2 * few, total} and after_few.sum() >= 5
    check_parts(short.isel(trial=(short.cycles_run == total).values), full, path)
    assert (short.packings_run.values[after_few] == 3).all() and short.dropped.values[after_few].all()
    stage = f"dropped after 3 of 12 packings and {few} of {total} cycles: worse than trial "
    assert all(reason.startswith(stage) for reason in short.reason.values[after_few])
    assert np.isfinite(short.damping_curve.values).all()
    # The values of few cycles are within their intervals, which cover the change with more of them.
    for one in (short.isel(trial=number) for number in np.flatnonzero(after_few)):
        other = full.isel(trial=int(np.flatnonzero(full[path].values == one[path].item())[0]))
        assert abs(float(one.damping_ratio - other.damping_ratio)) < 1.5 * float(one.damping_ratio_interval)
    return full, short


def test_trials_are_dropped_after_few_cycles(cycles: list[float]) -> None:
    """The best design is that without dropping, with the same bits, for a third of the cycles; the report has the stages.

    Before, the first packings of each trial ran with all cycles.
    """
    _, short = check_few_cycles("clearance of a ball", cycles)
    answer = " ".join(KIND.answer(short))
    assert f"{int(short.dropped.sum())} trials were dropped early, as certainly not the best: " in answer
    assert "after 3 random initial states of 30 cycles" in answer
    table = next(each for each in KIND.tables(short) if "over the amplitude" in each.title)
    assert table.header[1:3] == ("random initial states", "cycles of each")
    assert table.rows[0][:3] == ("0", "12", "120") and ("3", "30") in {tuple(row[1:3]) for row in table.rows}
    assert all(("dropped" in row[0]) == (row[1] == "3") for row in table.rows)


@pytest.mark.slow
@pytest.mark.parametrize("name", MANY_CYCLES)
def test_few_cycles_need_a_third_of_the_processor_time(name: str, cycles: list[float]) -> None:
    """The best design is that without dropping, for a third of the processor time of the trials."""
    full, short = check_few_cycles(name, cycles, workers=1)
    assert short.attrs["cpu_time"] < 0.34 * full.attrs["cpu_time"]  # the clock of a busy machine scatters


def test_default_packings_are_dropped_after_few_cycles() -> None:
    """With the three packings of the default, trials can be dropped after few cycles, also of default cycles."""
    options: dict[str, Any] = {"amplitudes": ["0.5 mm", "0.6 mm"], "packings": None, "cycles": None, "drop": True}
    short = shaken(with_ball(), {GAP: GAPS[2:]}, **options)
    assert short.cycles_run.values.tolist() == [60] + (len(GAPS[2:]) - 1) * [15]
    assert set(short.packings_run.values.tolist()) == {3}
    assert short[GAP].values[short.front.item()] == 1.4e-3
    study = Design(with_ball(), {GAP: GAPS}, "damping_ratio", way="shaking", **options | {"packings": 12})
    estimate = study.estimate()
    assert estimate.least is not None and 0.05 < estimate.least / estimate.cpu_time < 0.5
    assert estimate.runs == 10 * (24 + 6) and "if trials end as early as they can" in str(estimate)


@pytest.mark.parametrize("option", [{"way": "decay", "cycles": None}, {"packings": 2}, {"cycles": (5, 10)}])
def test_runs_that_cannot_be_shorter(option: Any) -> None:
    """Decays, and runs of few cycles, are not shortened: then more than three packings are needed."""
    with pytest.raises(CaseError, match="drop decides after 3 packings, and packings = "):
        shaken(
            with_ball(),
            {GAP: GAPS},
            amplitudes=["0.5 mm", "0.6 mm"],
            drop=True,
            **{"packings": 3, "cycles": (20, 40)} | option,
        )


class Killed(BaseException):
    """Stop of a process, after which nothing is stored."""


@pytest.mark.parametrize(
    ("case", "parameters", "cycles", "counts"),
    [
        (with_ball(), {GAP: GAPS[3:]}, (4, 20), {8, 24}),
        (with_ball(), {GAP: ("0.2 mm", "1.4 mm")}, (4, 20), {8, 24}),
        (with_bed(count=4), {COUNT: COUNTS[1:6]}, (4, 28), {8, 16, 32}),
    ],
    ids=["all combinations", "between bounds", "beds"],
)
def test_a_kill_at_any_stage_changes_nothing(
    case: rb.Case, parameters: Any, cycles: Any, counts: set[int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a kill in any evaluation, whatever was finished before, the same trials are dropped at the same stages."""
    options: dict[str, Any] = {"amplitudes": ["0.5 mm", "0.6 mm"], "cycles": cycles, "packings": 8, "drop": True}
    options |= {"workers": 1} | ({} if isinstance(next(iter(parameters.values())), list) else {"trials": 6})
    usual, left = DesignSearch.evaluate, [10**9]

    def evaluate(self: DesignSearch, candidate: Candidate, count: int) -> Evaluation:
        left[0] -= 1
        if not left[0]:
            raise Killed
        return usual(self, candidate, count)

    monkeypatch.setattr(DesignSearch, "evaluate", evaluate)
    monkeypatch.setattr(
        "rattlebox.studies.kinds.design.predict", lambda search, trials: Estimate(trials, 1, 1.0, 1.0, 1)
    )
    one = shaken(case, parameters, **options)
    evaluations = 10**9 - left[0]
    assert set(one.cycles_run.values.tolist()) <= counts and len(set(one.cycles_run.values.tolist())) > 1
    assert one.dropped.any()
    for step in range(3, evaluations + 1, 7):
        store = tmp_path / str(step)
        for count in (step, max(2, evaluations - step)):
            left[0] = count
            try:
                shaken(case, parameters, store=store, **options)
            except Killed:
                continue
        left[0] = 10**9
        again = shaken(case, parameters, store=store, **options)
        xr.testing.assert_identical(one.drop_attrs(), again.drop_attrs())


@pytest.mark.parametrize("backend", ["threads", pytest.param("processes", marks=pytest.mark.slow)])
def test_runs_of_beds_continue_after_each_part(
    backend: str, cycles: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each cycle of a bed runs once, and complete trials have the bits of a search without dropping.

    Before, runs that were not dropped began anew after each part. They still do if the memory for paused runs is full, and
    nothing else changes then.
    """
    options: dict[str, Any] = {"amplitudes": ["2 mm", "3 mm"], "cycles": (4, 28), "packings": 4, "workers": 2}
    case, counts = with_bed(count=4), {COUNT: [3, 5, 12, 20]}
    sizes = []
    usual = Trials._extend

    def extend(self: Trials, begun: Any) -> None:
        usual(self, begun)
        sizes.append(sum(each.candidate.memory for each in self._begun.values()))

    monkeypatch.setattr(Trials, "_extend", extend)
    full = shaken(case, counts, **options)
    cycles.clear()
    short = shaken(case, counts, drop=True, backend=backend, **options)
    assert len(set(short.cycles_run.values.tolist())) > 1 and short.dropped.any()
    complete = short.isel(trial=(short.cycles_run == 32).values)
    check_parts(complete, full, COUNT)
    assert max(sizes) > 100_000
    if backend == "processes":
        return
    assert sum(cycles) == pytest.approx(2 * int((short.cycles_run * short.packings_run).sum()))
    once = sum(cycles)
    for most in (max(sizes) // 2, 0):
        cycles.clear(), sizes.clear()
        monkeypatch.setattr(trials, "MOST_PAUSED", most)
        again = shaken(case, counts, drop=True, **options)
        xr.testing.assert_identical(short.drop_attrs(), again.drop_attrs())
        assert max(sizes) <= most and sum(cycles) > once


def transients(generator: np.random.Generator, designs: int) -> Any:
    """Return random transients over the number of cycles, one for each design: factors that end at one, (designs,)."""
    size, time = generator.uniform(-0.6, 0.8, designs), np.exp(generator.uniform(np.log(1.0), np.log(30.0), designs))
    is_slow = generator.random(designs) < 0.3

    def factor(cycles: float) -> Any:
        return 1 + np.where(is_slow, 0.4 * size * np.log(60 / cycles) / np.log(4), size * np.exp(-cycles / time))

    return factor


@pytest.mark.parametrize(
    ("scatter", "count"),
    [
        (0.02, 15),
        pytest.param(0.02, 100, marks=pytest.mark.slow),
        pytest.param(0.1, 100, marks=pytest.mark.slow),
    ],
)
def test_transients_do_not_decide(scatter: float, count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """In planted searches whose values relax or creep by up to 80 % after few cycles, the best design is found.

    Without the terms for the transient, five of the 100 with little scatter had another answer.
    """
    generator = np.random.default_rng(11)

    def evaluate(self: DesignSearch, candidate: Candidate, count: int) -> Evaluation:
        assert candidate.case is not None and self.curve is not None
        candidate.ran = count
        number = GAPS9.index(candidate.case.dampers[0].gap)
        skip, kept = self.curve.cycles or (20, 40)
        halves = [
            np.mean([factor(n + 0.5)[number] for n in range(*part)])
            for part in ((skip, skip + kept // 2), (skip + kept // 2, skip + kept))
        ]
        some = (planted[number] * np.mean(halves) * (1 + noise[number, :count] * math.sqrt(60 / (skip + kept))))[None]
        drift = np.array([planted[number] * (halves[1] - halves[0])])
        half = t.ppf(0.975, count - 1) * some.std(axis=1, ddof=1) / np.sqrt(count)
        return Evaluation(some.mean(axis=1), half, some, drift=drift)

    monkeypatch.setattr(DesignSearch, "evaluate", evaluate)
    monkeypatch.setattr(
        "rattlebox.studies.kinds.design.predict", lambda search, trials: Estimate(trials, 1, 1.0, 1.0, 1)
    )
    few, wrong = [], 0
    for _ in range(count):
        planted, noise, factor = (
            generator.uniform(1, 4, 9),
            scatter * generator.normal(size=(9, 12)),
            transients(generator, 9),
        )
        options: dict[str, Any] = {"amplitudes": ["0.5 mm", "0.6 mm"], "cycles": (20, 40)}
        found = shaken(with_ball(), {GAP: GAPS9}, drop=True, **options)
        best = max(
            range(9),
            key=lambda k: planted[k] * np.mean([factor(n + 0.5)[k] for n in range(20, 60)]) * (1 + noise[k].mean()),
        )
        wrong += found[GAP].values[found.front.item()] != GAPS9[best]
        few.append((found.cycles_run.values == 15).mean())
    assert wrong == 0
    assert np.mean(few) > 0.3


def check_parts(short: xr.Dataset, full: xr.Dataset, path: str, name: str = "damping_ratio", rel: float = 0.0) -> None:
    """Check that trials have the values of their first packings without dropping, and complete ones all values.

    `rel`: relative tolerance of dropped ones.
    """
    for trial, count in enumerate(short.packings_run.values):
        one = short.isel(trial=trial)
        other = full.isel(trial=int(np.flatnonzero(full[path].values == one[path].item())[0]))
        assert bool(one.feasible) == bool(other.feasible)
        if not one.feasible:
            continue
        parts = [f"{name}_packings"] + ["damping_curve_packings"] * ("damping_curve" in short)
        for part in parts:
            mine, all_of_them = one[part].values[..., :count], other[part].values[..., :count]
            assert np.allclose(mine, all_of_them, rtol=rel * float(one.dropped), atol=0)
            assert np.isnan(one[part].values[..., count:]).all()
        assert float(one[name]) == pytest.approx(float(one[f"{name}_packings"].mean("packing")), rel=1e-12)
        assert bool(one.dropped) == (count < full.sizes["packing"]) == ("dropped after" in str(one.reason.values))
        if not one.dropped:
            for same in [name, f"{name}_interval"] + ["damping_curve", "damping_curve_interval"] * (len(parts) - 1):
                assert np.array_equal(one[same].values, other[same].values, equal_nan=True)


def test_measures_of_a_sweep_are_dropped() -> None:
    """A measure of a strike has the values of the same packings, although those of a trial run in several sweeps."""
    options: dict[str, Any] = {
        "levels": {"structure.velocity": ["0.4 m/s", "0.6 m/s"]},
        "packings": 8,
        "progress": False,
    }
    case, counts = with_bed(count=4), {COUNT: [4, 8, 12, 16]}
    full = rb.design(case, counts, "rms", **options)
    short = rb.design(case, counts, "rms", drop=True, **options)
    assert short.dropped.any() and not short.dropped.all()
    check_parts(short, full, COUNT, "rms")
    assert short.case.item() == full.case.item()


def test_decays_are_dropped() -> None:
    """Decays of complete trials are those without dropping: the initial amplitude is that for all packings.

    It may be smaller for those of a dropped trial, which changes its values little.
    """
    options: dict[str, Any] = {"way": "decay", "cycles": None, "amplitudes": ["0.1 mm", "0.2 mm"], "packings": 6}
    case, gaps = with_ball().replaced({"duration": "4 s"}), {GAP: ["0.2 mm", "0.5 mm", "1.4 mm", "4 mm"]}
    full, short = shaken(case, gaps, **options), shaken(case, gaps, drop=True, **options)
    assert short.dropped.any()
    check_parts(short, full, GAP, rel=1e-6)


def test_the_front_of_several_objectives_is_the_same() -> None:
    """A trial is dropped only if a complete one is certainly better in all objectives: the front is the same."""
    case, counts = with_bed(count=4), {COUNT: [3, 8, 12, 20, 30], "damper.number": [1, 2]}
    options: dict[str, Any] = {"amplitudes": ["2 mm", "3 mm"], "packings": 6}
    goals = ["added_mass", "damping_ratio"]
    full, short = shaken(case, counts, goals, **options), shaken(case, counts, goals, drop=True, **options)
    assert list(short.case.values) == list(full.case.values) and short.sizes["front"] > 2
    assert short.dropped.any()


def test_the_front_is_the_same_after_few_cycles() -> None:
    """With the mass as a second objective and two levels, trials are dropped after few cycles, and the front is the same."""
    choices = {GAP: ["0.4 mm", "1.4 mm", "4 mm"], "damper.ball.diameter": ["20 mm", "30 mm"]}
    options: dict[str, Any] = {"amplitudes": ["0.5 mm", "0.6 mm"], "cycles": (8, 24), "packings": 5}
    options["levels"] = {"damper.contact.restitution": [0.4, 0.6]}
    goals = ["added_mass", "damping_ratio"]
    full = shaken(with_ball(), choices, goals, **options)
    short = shaken(with_ball(), choices, goals, drop=True, **options)
    assert list(short.case.values) == list(full.case.values)
    few = short.cycles_run.values == 8
    assert few.any() and short.dropped.values[few].all()
    assert short.damping_curve.dims == ("trial", "level", "amplitude") and np.isfinite(short.damping_curve).all()
    assert [name.count("dropped") for name in curves_of(short, [0, int(np.flatnonzero(few)[0])])] == [0, 0, 1, 1]


def stopped_after(count: int) -> Any:
    """Return a progress function that stops a study after a number of trials."""
    return lambda done, total: done < count


@pytest.mark.parametrize("gaps", [GAPS[2:], ("0.2 mm", "4 mm")], ids=["all combinations", "between bounds"])
def test_results_do_not_depend_on_workers_and_stops(gaps: Any, tmp_path: Path) -> None:
    """A search with one worker, with two, and after a stop gives the same trials: decisions depend on earlier trials."""
    options: dict[str, Any] = {"amplitudes": ["0.5 mm", "0.6 mm"], "cycles": (10, 10), "packings": 8, "drop": True}
    options |= {} if isinstance(gaps, list) else {"trials": 12}
    one = shaken(with_ball(), {GAP: gaps}, workers=1, **options)
    store = tmp_path / "design"
    for count in (1, 5):
        with pytest.raises(Stopped):
            shaken(with_ball(), {GAP: gaps}, store=store, **options | {"progress": stopped_after(count)})
    again = shaken(with_ball(), {GAP: gaps}, store=store, workers=2, **options)
    assert 0 < one.dropped.sum() < one.sizes["trial"]
    xr.testing.assert_identical(one.drop_attrs(), again.drop_attrs())
    assert any("were dropped early" in line for line in KIND.answer(one))
    assert KIND.call(one).arguments["drop"] is True


def test_trials_end_when_they_are_precise() -> None:
    """Packings are added until the interval is as narrow as asked; before, each trial had all of them."""
    options: dict[str, Any] = {"amplitudes": ["2 mm", "3 mm"], "packings": 8}
    case, counts = with_bed(count=4), {COUNT: [4, 12, 30]}
    full, short = shaken(case, counts, **options), shaken(case, counts, precision=0.05, **options)
    width = short.damping_ratio_interval / short.damping_ratio
    assert not short.dropped.any()
    for trial, count in enumerate(short.packings_run.values):
        assert count in (3, 5, 8) and (count == 8 or float(width[trial]) <= 0.05)
        mine, all_of_them = (each.damping_ratio_packings.values[trial] for each in (short, full))
        assert np.array_equal(mine[:count], all_of_them[:count])
        for fewer in (number for number in (3, 5) if number < count):
            part = all_of_them[:fewer]
            assert {3: 4.302653, 5: 2.776445}[fewer] * part.std(ddof=1) / fewer**0.5 > 0.05 * part.mean()
    assert 3 in short.packings_run and short.packings_run.max() > 3
    assert KIND.call(short).arguments["precision"] == 0.05


@pytest.mark.parametrize("motions", [False, True], ids=["normal", "two motions"])
def test_the_answer_of_planted_searches_is_that_without_dropping(
    motions: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In 100 searches of nine designs, up to one standard deviation apart, the answer is that without dropping."""
    generator = np.random.default_rng(3)

    def evaluate(self: DesignSearch, candidate: Candidate, count: int) -> Evaluation:
        assert candidate.case is not None
        candidate.ran = count
        some = planted[GAPS9.index(candidate.case.dampers[0].gap)][None, :count]
        half = t.ppf(0.975, count - 1) * some.std(axis=1, ddof=1) / np.sqrt(count)
        return Evaluation(some.mean(axis=1), half, some)

    monkeypatch.setattr(DesignSearch, "evaluate", evaluate)
    monkeypatch.setattr(
        "rattlebox.studies.kinds.design.predict", lambda search, trials: Estimate(trials, 1, 1.0, 1.0, 1)
    )
    ran = []
    for repetition in range(100):
        scatter = generator.normal(size=(9, 12))
        if motions:
            scatter = np.where(generator.random((9, 12)) < 0.6, 1.0, -1.5)
        planted = scatter + (0.5, 1.0)[repetition % 2] * generator.permutation(9)[:, None]
        found = shaken(with_ball(), {GAP: GAPS9}, amplitudes=["0.5 mm", "0.6 mm"], drop=True, robust="mean")
        assert found[GAP].values[found.front.item()] == GAPS9[int(planted.mean(axis=1).argmax())]
        ran.append(found.packings_run.values.mean() / 12)
    assert 0.4 < np.mean(ran) < 0.65  # designs half a standard deviation apart cannot be told apart early


def test_packings_that_agree_by_chance_do_not_decide() -> None:
    """A trial with three equal packings has the scatter of the others: alone, its interval would have no width."""
    equal = Evaluation(np.ones(1), np.zeros(1), np.array([[1.0, 1.0, 1.0, np.nan]]))
    other = Evaluation(np.ones(1), np.full(1, 1.6), np.array([[0.0, 2.0, 0.0, 2.0]]))
    scatter = pooled([equal, other])
    assert scatter == pytest.approx(2.570582 * np.sqrt((0 + 4 / 3) / 2))
    assert equal.widened(scatter).intervals == pytest.approx(scatter / np.sqrt(3))
    assert other.widened(scatter).intervals == 1.6


@pytest.mark.parametrize("option", [{"drop": True}, {"precision": 0.1}])
def test_too_few_packings_are_refused(option: Any) -> None:
    """With three packings there is nothing to leave out: the option is refused and does not pass silently."""
    with pytest.raises(CaseError, match="decides after 3 packings"):
        shaken(with_bed(count=4), {COUNT: [4, 8]}, amplitudes=["1 mm", "2 mm"], packings=3, **option)


@pytest.mark.parametrize("least", [20.0, 90.0])
def test_a_budget_suffices_for_the_least_time(
    least: float, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A budget below the time of all packings and cycles is refused only if trials that end early need more, too."""
    estimate = Estimate(3, 1, 100.0, 100.0, 1, least=least)
    monkeypatch.setattr("rattlebox.studies.kinds.design.predict", lambda search, trials: estimate)
    options: dict[str, Any] = {"amplitudes": ["0.5 mm", "0.6 mm"], "packings": 4, "drop": True, "progress": True}
    if least > 60:
        with pytest.raises(CaseError, match=r"budget = 60 s is less than predicted for .* if trials end as early"):
            shaken(with_ball(), {GAP: GAPS[:3]}, budget="60 s", **options)
        return
    assert shaken(with_ball(), {GAP: GAPS[:3]}, budget="60 s", **options).sizes["trial"] == 3
    assert "20 s of processor time if trials end as early as they can; perhaps not all" in capsys.readouterr().err
