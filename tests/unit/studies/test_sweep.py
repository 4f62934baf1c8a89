"""Sweeps: measures of many variants equal those of single runs."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox import analysis
from rattlebox.core import _core
from rattlebox.model.paths import replaced
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.run.runner import run_work
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.measures import MEASURES, OF_RUN
from rattlebox.studies.work.variants import Variants
from rattlebox.studies.work.work import Work

PLASTIC_RIGID = rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid"), ending="zero_overlap")
AXES = {"damper.gap": ["0.3 mm", "0.8 mm"], "load.amplitude": ["1 kN", "5 kN", "8 kN"]}


@pytest.fixture(scope="module")
def swept() -> Any:
    """Return a sweep of six variants with every measure that needs no cycle and the samples of single runs."""
    names = [name for name, measure in MEASURES.items() if not measure.cyclic and not measure.of_run]
    return rb.sweep(rb.reference_case(PLASTIC_RIGID, duration=2.0), AXES, names, samples=2001)


def run_of(gap: str, amplitude: str) -> Any:
    """Return the single run of a variant."""
    case = rb.reference_case(PLASTIC_RIGID, duration=2.0, output=rb.Output(rate=1000.0))
    return rb.simulate(replaced(case, {"damper.gap": gap, "load.amplitude": amplitude}))


def expected(run: Any) -> dict[str, float]:
    """Return the measures of a run, from its data."""
    a, log = run.arrays, run.arrays.impacts
    z, v = a.displacement[:, 0], a.velocity[:, 0]
    shares = run.ledger.shares
    return {
        "impacts": len(log),
        "peak_contact_force": log.peak_force.max(initial=0),
        "peak_overlap": log.peak_overlap.max(initial=0),
        "largest_approach_speed": log.approach_speed.max(initial=0),
        "mean_approach_speed": log.approach_speed.mean() if len(log) else np.nan,
        "longest_contact": log.duration.max(initial=0),
        "work": run.ledger.work[-1],
        "viscous_loss": a.viscous_loss[-1],
        "impact_loss": run.ledger.channels["normal"][-1] + run.ledger.channels["plastic"][-1],
        "viscous_share": shares["viscous"],
        "impact_share": shares["normal"] + shares["plastic"],
        "motion_share": shares["motion"],
        "peak": np.abs(z).max(),
        "rms": np.sqrt(np.trapezoid(z**2, a.time) / a.time[-1]),
        "peak_velocity": np.abs(v).max(),
        "rms_velocity": np.sqrt(np.trapezoid(v**2, a.time) / a.time[-1]),
        "settling_time": analysis.settling_time(a.time, z),
    }


def test_measures_are_those_of_single_runs(swept: Any) -> None:
    """Each measure of each variant equals that of its run."""
    assert not swept.status.any()
    for i, gap in enumerate(AXES["damper.gap"]):
        for j, amplitude in enumerate(AXES["load.amplitude"]):
            variant = swept.isel({"damper.gap": i, "load.amplitude": j})
            for name, value in expected(run_of(gap, amplitude)).items():
                assert float(variant[name]) == pytest.approx(value, rel=1e-12, abs=1e-14, nan_ok=True), name
            assert float(variant.energy_residual) < 1e-12


def test_settling_is_that_of_the_analysis_however_short_the_window() -> None:
    """If a window ends while the motion crosses the band, neither the core nor the analysis reports settling."""
    case = rb.Case(structure=rb.SDOF(mass=1, stiffness=400, damping=1, velocity="1 m/s"), duration=20.0)
    ends = np.linspace(0.5, 8, 60)
    result = rb.sweep(case, {"duration": ends}, "settling_time", samples=301).settling_time.values
    for end, settled in zip(ends, result, strict=True):
        run = rb.simulate(case.replaced({"duration": end, "output": rb.Output(rate=300 / end)}))
        alone = analysis.settling_time(run.arrays.time, run.arrays.displacement[:, 0])
        assert settled == pytest.approx(alone, rel=1e-9, nan_ok=True)
    assert 10 < np.isnan(result).sum() < 50


def test_all_measures_of_the_core_are_listed() -> None:
    """The table of measures is that of the core, in its order, with the requirements of each measure, and those of a run."""
    assert [*(row.name for row in _core.measures()), *OF_RUN] == list(MEASURES)
    assert set(OF_RUN) == {name for name, measure in MEASURES.items() if measure.of_run}
    assert {name for name, measure in MEASURES.items() if measure.of_impacts} == {
        "impacts",
        "impacts_per_cycle",
        "peak_contact_force",
        "peak_overlap",
        "largest_approach_speed",
        "mean_approach_speed",
        "longest_contact",
    }
    assert all(measure.samples for measure in MEASURES.values() if measure.of_base_force or measure.of_first_harmonic)


def shaken(duration: float = 1.0) -> rb.Case:
    """Return a ball with hard impacts in a cavity that is shaken at 10 Hz."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency=10.0)),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="5 mm", material="steel"), gap="1.5 mm", contact=rb.Tsuji(restitution=0.5)
        ),
        duration=duration,
        method=rb.Newton(restitution=0.5),
    )


def test_samples_for_the_first_harmonic() -> None:
    """Each cycle has twenty samples by default for any window; fewer than eight are refused."""
    case, axes = shaken(duration=100.0), {"structure.motion[0].frequency": [10.0, 20.0]}
    for options, least in (({"skip": 10.0}, 36_001), ({"cycles": (10, 90)}, 64 * 90 + 1)):
        usual = rb.sweep(case, axes, ["effective_mass", "loss_factor"], **options)
        explicit = rb.sweep(case, axes, ["effective_mass", "loss_factor"], samples=least, **options)
        assert np.isfinite(usual.loss_factor).all()
        assert (usual.effective_mass == explicit.effective_mass).all() and (
            usual.loss_factor == explicit.loss_factor
        ).all()
        with pytest.raises(rb.CaseError, match=r"\d samples per cycle are too few for effective_mass"):
            rb.sweep(case, axes, ["impacts", "effective_mass"], samples=500, **options)


def test_cyclic_measures_refer_to_the_window() -> None:
    """With cycles the run lasts as many as are skipped and evaluated, for any frequency."""
    case = shaken()
    axes = {"structure.motion[0].frequency": [5.0, 10.0, 20.0]}
    result = rb.sweep(case, axes, ["impacts_per_cycle", "loss_per_cycle", "reduced_loss"], cycles=(40, 10))
    # Hard impacts have no time scale: all frequencies have the same motion.
    assert np.ptp(result.impacts_per_cycle.values) == 0
    assert result.impacts_per_cycle[0] > 0
    assert result.reduced_loss.values == pytest.approx(float(result.reduced_loss[0]), rel=1e-9)
    assert result.loss_per_cycle.values == pytest.approx(
        float(result.loss_per_cycle[0]) * np.array([1, 4, 16]), rel=1e-9
    )


def test_skip_omits_the_beginning() -> None:
    """Impacts and losses before `skip` are not counted."""
    case = rb.reference_case(duration=2.0, output=rb.Output(times=[0.5, 2.0]))
    run = rb.simulate(case)
    result = rb.sweep(case, {"damper.gap": [case.dampers[0].gap]}, ["impacts", "impact_loss"], skip="0.5 s")
    assert float(result.impacts[0]) == (run.arrays.impacts.time >= 0.5).sum()
    assert float(result.impact_loss[0]) == pytest.approx(np.diff(run.ledger.channels["normal"])[-1], rel=1e-10)


def test_motion_and_last_impacts_on_request() -> None:
    """Samples of the motion and the last impacts are those of the run; fewer impacts are padded at the front."""
    case = rb.reference_case(duration=0.2, output=rb.Output(times=np.linspace(0, 0.2, 41).tolist()))
    run = rb.simulate(case)
    result = rb.sweep(case, {"damper.start": [0.0]}, ["impacts"], motion=True, samples=41, last=1000).isel(
        {"damper.start": 0}
    )
    assert result.displacement.values == pytest.approx(run.arrays.displacement[:, 0], abs=1e-15)
    assert result.relative_position.values == pytest.approx(run.arrays.relative_position, abs=1e-15)
    speeds = result.last_approach_speed.values
    assert np.array_equal(speeds[np.isfinite(speeds)], run.arrays.impacts.approach_speed)
    assert np.isnan(speeds[0])


def test_own_measures_are_functions_of_a_run() -> None:
    """A function of a Run is computed for each variant from the run of the other measures."""

    def third_speed(run: rb.Run) -> float:
        return float(run.arrays.impacts.approach_speed[2])

    case = rb.reference_case(duration=0.3)
    result = rb.sweep(case, {"damper.start": rb.linspace(-0.5, 0.5, 5)}, [third_speed], last=1000)
    logged = [row[np.isfinite(row)][2] for row in result.last_approach_speed.values]
    assert result.third_speed.values.tolist() == logged


def test_bits_do_not_depend_on_threads_and_blocks() -> None:
    """A variant has the same bits with one thread or two, alone or among others."""
    case = rb.reference_case(duration=1.0)
    axes = {"damper.start": rb.linspace(-0.9, 0.9, 23)}
    one = rb.sweep(case, axes, ["impact_share", "settling_time"], workers=1)
    two = rb.sweep(case, axes, ["impact_share", "settling_time"], workers=2)
    alone = rb.sweep(case, {"damper.start": [float(one["damper.start"][7])]}, ["impact_share", "settling_time"])
    assert one.equals(two)
    assert float(alone.impact_share[0]) == float(one.impact_share[7])


def test_a_variant_that_fails_has_a_status() -> None:
    """A variant beyond the range of a law has a status and no numbers; the others are computed."""
    law = rb.Tsuji(restitution=rb.JacksonGreen(yield_stress="20 MPa"))
    result = rb.sweep(
        rb.reference_case(law, duration=0.2), {"load.amplitude": ["10 N", "5 kN"]}, ["impacts", "impact_share"]
    )
    names = result.status.attrs["flag_meanings"].split()
    assert names[int(result.status[0])] == "finished"
    assert names[int(result.status[1])] == "law_domain"
    assert np.isnan(result.impacts.values).tolist() == [False, True]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"measure": ["impact_shares"]}, "impact_share"),
        ({"measure": [3]}, "function"),
        ({"measure": ["loss_factor"]}, "harmonic"),
        ({"measure": []}, "no measure is given\n  try: impacts"),
        ({"measure": ["impacts", "peak", "impacts"]}, "two measures have the name impacts"),
        ({"measure": [lambda run: 1, lambda run: 2]}, "two measures have the name <lambda>"),
        ({"skip": "9 s"}, "skip = 9 s"),
        ({"cycles": (10, 5)}, "harmonic"),
        ({"skip": "9 kg"}, "s"),
        ({"point": "tip"}, "mass"),
        ({"backend": "gpu"}, "is not a backend"),
    ],
)
def test_bad_arguments_are_refused(options: dict[str, Any], message: str) -> None:
    """Unknown measures, windows outside the run and cycles without a load are refused with advice."""
    with pytest.raises(rb.CaseError, match=message):
        rb.sweep(rb.reference_case(duration=1.0), {"damper.gap": ["1 mm"]}, **options)


@pytest.mark.parametrize("value", ["2", None, np.ones(3), 1j], ids=str)
def test_a_function_that_returns_no_number_is_refused(value: Any) -> None:
    """If a function of a Run does not return one number, the error has its name, the variant and the returned type."""

    def loudness(run: Any) -> Any:
        return value if run.ledger.work[-1] > 1e-3 else 0.0

    message = f"measure loudness: the function returned {type(value).__name__} for variant 1"
    with pytest.raises(rb.CaseError, match=message):
        rb.sweep(rb.reference_case(duration=0.1), {"load.amplitude": [0.1, 5e3]}, loudness)


def test_parameters_outside_the_batch_can_vary(tmp_path: Path) -> None:
    """Scales of records, values in tables, numbers of events and kinds of laws can vary, in any blocks."""
    time = np.linspace(0, 0.5, 101)
    table = rb.Tabulated(speeds=[0.01, 0.1, 1.0], values=[0.9, 0.8, 0.5])
    ball = rb.Sphere(radius="10 mm", material="steel")
    case = rb.Case(
        structure=rb.SDOF(mass="2 kg", stiffness="8 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(ball=ball, gap="1 mm", contact=rb.Tsuji(restitution=table)),
        load=rb.Record(times=time, values=50 * np.sin(60 * time)),
        duration="0.5 s",
        method=rb.Newton(),
    )
    axes = {
        "damper.gap": ["0.5 mm", "1 mm"],
        "load.scale": [0.5, 2.0],
        "damper.contact.restitution.values[1]": [0.8, 0.6],
        "method.max_events": [60, 100_000],
        "damper.ball.material": ["steel", "brass"],
    }
    maps = rb.sweep(case, axes, ["impacts"], motion=True, samples=3)
    design = read_axes(case, axes)
    for number in range(design.size):
        run = rb.simulate(design.case_at(case, number).model_copy(update={"output": rb.Output(times=[0, 0.25, 0.5])}))
        index = np.unravel_index(number, design.shape)
        assert (maps.status.values[index] == 0) == run.ok
        if run.ok:
            assert maps.impacts.values[index] == len(run.arrays.impacts)
            np.testing.assert_allclose(maps.displacement.values[index], run.arrays.displacement[:, 0], rtol=1e-9)
    assert 0 < np.mean(maps.status == 0) < 1
    assert np.unique(maps.impacts.values[np.isfinite(maps.impacts.values)]).size > 6
    blocks = run_work(
        Work(ImpactEngine(Variants(case, design, ["impacts"], samples=3), motion=True)),
        store=tmp_path / "s.zarr",
        block=3,
    )
    for name in maps.data_vars:
        np.testing.assert_array_equal(maps[name], blocks[name])
    laws = rb.sweep(case, {"damper.contact": [rb.Tsuji(restitution=0.5), rb.Linear(stiffness=1e6, restitution=0.5)]})
    assert not laws.status.any()


def test_dimensions_have_coordinates() -> None:
    """The dimensions of samples, balls and last impacts have coordinates with units."""
    case = rb.reference_case(PLASTIC_RIGID, duration=2.0)
    maps = rb.sweep(case, {"damper.gap": [1e-3]}, [], skip="1 s", samples=5, motion=True, last=3)
    assert maps.instant.values.tolist() == [1.0, 1.25, 1.5, 1.75, 2.0] and maps.instant.units == "s"
    assert maps.ball.values.tolist() == [1]
    assert maps["last"].values.tolist() == [-3, -2, -1]
    assert all({"units", "long_name"} <= set(maps[dim].attrs) for dim in maps.dims)
    both = rb.sweep(case, {"duration": [1.0, 2.0]}, [], samples=3, motion=True)
    assert both.instant.values.tolist() == [0.0, 0.5, 1.0] and both.instant.units == "1"
    driven = case.replaced({"loads": [rb.Harmonic(amplitude="10 N", frequency="10 Hz")]})
    cycles = rb.sweep(driven, {"damper.gap": [1e-3]}, [], cycles=(3, 2), samples=5, motion=True)
    assert cycles.instant.values.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0] and cycles.instant.units == "1"


def test_motions_of_different_numbers_of_balls_are_refused() -> None:
    """Variants with different numbers of balls have measures, but no common array of motions."""
    case = rb.reference_case(PLASTIC_RIGID, duration=1.0)
    axes = {"dampers": [list(case.dampers), []]}
    assert rb.sweep(case, axes, ["impacts"]).impacts.values.tolist()[1] == 0
    with pytest.raises(rb.CaseError, match="differ in more than numbers"):
        rb.sweep(case, axes, ["impacts"], motion=True)


def test_a_file_that_has_changed_is_another_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A store refuses changed numbers in files: of the case, of files on an axis and of columns on an axis."""
    monkeypatch.chdir(tmp_path)

    def record(scale: float) -> rb.Case:
        Path("force.csv").write_text("".join(f"{t},{scale * t},{t}\n" for t in (0, 0.5, 1)))
        load = rb.Record(file="force.csv", columns=(1, 2), unit="N")
        return rb.Case(structure=rb.SDOF(mass=2, stiffness=800, damping=3), load=load, duration=0.9)

    axes: dict[str, dict[str, Any]] = {
        "mass": {"structure.mass": [1.0, 2.0]},
        "file": {"load.file": ["force.csv"]},
        "columns": {"load.columns": [(1, 2), (1, 3)]},
    }
    for name, varies in axes.items():
        for _ in range(2):
            rb.sweep(record(1.0), varies, "peak", store=name, progress=False)
    for name, varies in axes.items():
        with pytest.raises(rb.StoreError, match=r"another study\n  files\."):
            rb.sweep(record(100.0), varies, "peak", store=name, progress=False)


def test_a_ball_that_starts_outside_of_a_displaced_cavity_is_refused() -> None:
    """The one variant of many whose ball starts outside of its cavity is found; the displacement does not matter."""
    structure = rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping_ratio=0.01)
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="33 mm", material="steel"),
        gap="0.4 mm",
        contact=rb.Tsuji(restitution=0.6),
        start="0 m",
    )
    case = rb.Case(structure=structure, damper=damper, duration="10 ms")
    displaced = np.linspace(-9e-3, 9e-3, 181)
    starts = 0.4e-3 * np.linspace(-1, 1, 181)
    axes = {"offset": {"structure.displacement": displaced, "damper.start": [f"{x} m" for x in starts]}}
    assert not rb.sweep(case, axes, "peak", progress=False).status.any()
    starts[140] *= -3
    axes["offset"]["damper.start"] = [f"{x} m" for x in starts]
    with pytest.raises(rb.CaseError, match="inside a wall of the cavity"):
        rb.sweep(case, axes, "peak", progress=False)
