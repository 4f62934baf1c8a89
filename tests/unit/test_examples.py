"""Every example is run and checked on a number."""

import ast
import re
import runpy
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

import rattlebox as rb
from rattlebox.app.draft import FIRST, template
from rattlebox.cli.demo import BARE, DAMPED, demo_cases
from rattlebox.studies.design.trials import count_trials

EXAMPLES = Path(__file__).parents[2] / "examples"
SCRIPTS = sorted(path for path in EXAMPLES.rglob("*.py") if path.name != "write_data.py")


def test_all_examples_are_checked_here() -> None:
    """No example escapes the checks below."""
    assert {path.stem for path in EXAMPLES.glob("*.toml")} == {
        "struck",
        "steel_ball",
        "steel_ball_jackson_green",
        "row_on_beam",
        "shaker",
        "steel_balls_in_a_box",
        "two_cavities_on_a_beam",
    }


@pytest.mark.parametrize("script", SCRIPTS, ids=[script.stem for script in SCRIPTS])
def test_scripts_are_in_the_gallery(script: Path) -> None:
    """A script begins with a title and has tags, asserts a number, and its figure is among those of the pages."""
    code = script.read_text(encoding="utf-8")
    title, line, blank, introduction = (ast.get_docstring(ast.parse(code)) or "").split("\n")[:4]
    assert line == len(title) * "=" and not blank and introduction.startswith("For ")
    tags = re.search(r"^# sphinx_gallery_tags = (\[.+\])$", code, re.MULTILINE)
    assert tags and all(isinstance(tag, str) for tag in ast.literal_eval(tags[1]))
    assert re.search(r"^ *assert ", code, re.MULTILINE)
    assert (EXAMPLES.parent / "docs" / "_static" / f"{script.stem}.png").exists()


def test_the_first_example_is_the_damper_that_damps() -> None:
    """Examples, application and demonstration begin with one case, whose ball stops the structure."""
    case = rb.Case.from_file(EXAMPLES / "struck.toml")
    assert (EXAMPLES / "struck.toml").read_text(encoding="utf-8") == template(FIRST)
    demo = demo_cases()
    assert case.replaced({"name": ""}) == demo[DAMPED].replaced({"name": ""})
    values = rb.compare({BARE: demo[BARE], DAMPED: case}).values
    assert values[DAMPED]["settling_time[mass]"] < 0.9 < 4.7 < values[BARE]["settling_time[mass]"]
    wide = rb.simulate(case.replaced({"damper.gap": 3e-3, "duration": 0.5}))
    assert not len(wide.arrays.impacts) and any("touched anything" in note for note in wide.notes)


@pytest.mark.parametrize("name", ["steel_ball", "steel_ball_jackson_green"])
def test_steel_balls(name: str) -> None:
    """The first impact has the approach speed of the exact free motion, and the ledger closes."""
    run = rb.simulate(rb.Case.from_file(EXAMPLES / f"{name}.toml"))
    assert run.ok
    assert run.energy_residual < 1e-10
    assert run.arrays.impacts.approach_speed[0] == pytest.approx(0.1566058315137885, rel=1e-12)


def test_row_on_a_beam_keeps_its_order() -> None:
    """Five balls on a beam stay in their cavity and in their order, and the ledger closes."""
    run = rb.simulate(rb.Case.from_file(EXAMPLES / "row_on_beam.toml"))
    assert run.ok
    assert run.energy_residual < 1e-8
    gaps = run.arrays.ball_position[:, 1:] - run.arrays.ball_position[:, :-1]
    radii_apart = run.arrays.ball_centre[1:] - run.arrays.ball_centre[:-1]
    assert (gaps > radii_apart - run.arrays.impacts.peak_overlap.max()).all()


def test_ball_on_a_shaker_is_thrown() -> None:
    """The ball on a vibrating table is struck again and again, and the ledger with the table's work closes."""
    run = rb.simulate(rb.Case.from_file(EXAMPLES / "shaker.toml"))
    assert run.ok
    assert len(run.arrays.impacts) > 5
    assert run.energy_residual < 1e-10


def test_many_small_balls_calm_a_structure_sooner_than_one_large_ball() -> None:
    """Balls in a box bring the structure below a fifth of its peak sooner than one ball of their mass, by sliding."""
    box = rb.simulate(rb.Case.from_file(EXAMPLES / "steel_balls_in_a_box.toml"))
    ball = rb.simulate(rb.Case.from_file(EXAMPLES / "steel_ball.toml"))
    assert box.ok
    assert box.energy_residual < 5e-3
    assert box.diagnostics["largest_overlap"] < 0.01
    assert not any("warning" in note for note in box.notes)
    masses = box.arrays.particle_mass.sum(), rb.Case.from_file(EXAMPLES / "steel_ball.toml").dampers[0].masses.sum()
    assert masses[0] == pytest.approx(masses[1], rel=2e-3)
    settled = [
        rb.analysis.settling_time(run.arrays.time, run.arrays.displacement[:, 0], band=0.2) for run in (box, ball)
    ]
    assert settled[0] < 0.7 * settled[1]
    assert box.ledger.shares["sliding"] > 0.3 > ball.ledger.shares["normal"]


def test_two_cavities_on_a_beam_both_take_energy() -> None:
    """Both cavities take up energy, and the beam swings less than without them."""
    case = rb.Case.from_file(EXAMPLES / "two_cavities_on_a_beam.toml")
    run = rb.simulate(case)
    assert run.ok
    assert run.energy_residual < 5e-3
    alone = rb.simulate(case.model_copy(update={"dampers": (), "method": rb.EventDriven()}))
    largest = [
        abs(each.motion.displacement.sel(point="middle")).where(each.motion.time > 0.4).max() for each in (run, alone)
    ]
    assert largest[0] < 0.8 * largest[1]
    lost = (run.arrays.normal_loss + run.arrays.sliding_loss)[-1].sum(axis=1)
    assert lost.min() > 0.05 * run.ledger.supplied[-1]
    assert run.arrays.particle_mass[1] == pytest.approx(0.04, rel=0.02)


@pytest.mark.parametrize("cycles", [(2, 4), pytest.param((10, 20), marks=pytest.mark.slow)])
def test_a_shaken_box_rides_along_or_is_thrown(cycles: tuple[int, int]) -> None:
    """Below the acceleration of gravity the balls' mass counts in full; thrown slowly they take more than m v^2 a cycle."""
    box = runpy.run_path(str(EXAMPLES / "shaken_box.py"))["BOX"]
    samples = 1 + 200 * cycles[1]
    result = rb.loss_map(box, [5.0, 150.0], [30.0], cycles=cycles, samples=samples, progress=False).isel(
        {"structure.motion.frequency": 0}
    )
    assert (result.effective_mass[0] / result.particle_mass).item() == pytest.approx(1, abs=0.02)
    assert result.loss_factor[0].item() == pytest.approx(0, abs=0.02)
    assert 1 < result.reduced_loss[1].item() < 4  # 4: every ball loses all of twice the speed
    by_force = np.pi * result.damping_mass[1] / result.particle_mass
    assert by_force.item() == pytest.approx(result.reduced_loss[1].item(), rel=0.05)


def test_a_measured_contact_gives_back_the_area_below_its_unloading_curve(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An impact as deep as the measurement has the restitution of the areas below both curves; a deeper one is noted."""
    monkeypatch.chdir(tmp_path)
    example = runpy.run_path(str(EXAMPLES / "measured_contact.py"), run_name="__main__")
    assert "0.6 m/s: overlap 133 um, restitution 0.770\n  warning" in capsys.readouterr().out
    pad = example["PAD"]
    work, back = (
        PchipInterpolator(curve.overlap, curve.force).integrate(curve.overlap[0], curve.overlap[-1])
        for curve in (pad, pad.unloading)
    )
    ball = rb.Sphere(radius="10 mm", material="steel")
    run = example["impact"](float(np.sqrt(2 * work / ball.weight)))
    (hit,) = run.arrays.impacts.separation_speed / run.arrays.impacts.approach_speed
    assert run.arrays.impacts.peak_overlap[0] == pytest.approx(100e-6, rel=1e-8)
    assert hit == pytest.approx(np.sqrt(back / work), rel=1e-8)


def test_a_table_of_modes_moves_as_the_beam_does() -> None:
    """A beam and the table of its modes give the same motion with a ball at the tip."""
    example = runpy.run_path(str(EXAMPLES / "structure_from_modes.py"))
    assert example["BAR"].frequencies[0] == pytest.approx(187.6, abs=0.05)
    beam = example["tip_after_hit"](example["BAR"])
    with TemporaryDirectory() as folder:
        file = Path(folder) / "bar.csv"
        file.write_text(example["table_of"](example["BAR"]))
        assert example["tip_after_hit"](rb.Modal.from_file(file)) == pytest.approx(beam, rel=1e-6)
    assert beam == pytest.approx(1.0218e-3, rel=1e-4)


def test_loads_of_standards_give_the_responses_of_formulas() -> None:
    """The RMS response is that of Miles within its scatter, and the sweep comes within 3 % of the steady resonance."""
    example = runpy.run_path(str(EXAMPLES / "loads_of_standards.py"))
    simulated, miles = example["rms_under_gevs"]()
    assert simulated == pytest.approx(miles, rel=0.1)  # 6 Hz of bandwidth for 20 s: 4.5 % of scatter
    assert example["gain_in_sweep"]() == pytest.approx(25, rel=0.03)


def test_own_time_loop_approaches_the_whole_run() -> None:
    """The error of Newmark's loop halves with the step, and falls with its square if steps are repeated."""
    example = runpy.run_path(str(EXAMPLES / "own_time_loop.py"))
    whole, orders = example["whole_run"](), []
    for exchanges, steps in ((1, (4000, 8000)), (4, (4000, 8000))):
        errors = [np.abs(example["newmark"](count, exchanges) - whole).max() for count in steps]
        orders.append(np.log2(errors[0] / errors[1]))
        assert errors[1] < {1: 4e-6, 4: 1e-7}[exchanges]
    assert orders == pytest.approx([1, 2], abs=0.2)


def test_ball_on_an_arm_of_mujoco_moves_as_in_a_whole_run() -> None:
    """The tip of the arm has the displacement of the whole run, with an error that falls with the step."""
    difference = runpy.run_path(str(EXAMPLES / "mujoco_arm.py"))["difference"]
    errors = [difference(step) for step in (1e-4, 5e-5)]
    assert errors[1] < 0.006
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.3)


def test_box_on_a_beam_of_exudyn_damps_as_in_a_whole_run() -> None:
    """Without balls the tip has the motion of the exact beam, with balls its RMS within half of the scatter of packings."""
    example = runpy.run_path(str(EXAMPLES / "exudyn_beam.py"))
    rms = example["rms"]
    bare = rms(example["coupled"](damped=False)), rms(example["whole_run"](damped=False))
    assert bare[0] == pytest.approx(bare[1], rel=2e-3)
    assert rms(example["coupled"]()) == pytest.approx(rms(example["whole_run"]()), rel=0.03)


def test_maps_of_one_cavity_agree_with_designs_of_the_bar() -> None:
    """The least damping ratio of a design of the bar is that of the map of one of its cavities."""
    example = runpy.run_path(str(EXAMPLES / "boring_bar_design.py"))
    case, amplitudes = example["bar"](softening=100), ["50 um", "80 um"]
    designs = example["search"](case, amplitudes, packings=1, fills=[0.4], numbers=[1, 2], progress=False)
    one = example["loss_map"](case, 0.4, amplitudes, packings=1)
    with pytest.warns(UserWarning, match="validity limit"):  # softening = 100 is for speed
        response = rb.response_from_map(case.structure, one, level="6 N", number=[1, 2])
    least = response.damping_ratio.isel({"at": 0, "mode": 0}).min("map_amplitude")
    np.testing.assert_allclose(designs.damping_ratio, least, rtol=0.05)
    assert int(example["recommended"](designs)["damper.number"]) == 2


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_the_boring_bar_is_designed_in_spite_of_a_kill(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Killed after some of 12 designs, the script resumes, passes its assertions and writes its report with both answers."""
    monkeypatch.chdir(tmp_path)
    script = str(EXAMPLES / "boring_bar_design.py")
    process = subprocess.Popen([sys.executable, script])
    while (count_trials("boring_bar_design.zarr") or 0) < 4:
        assert process.poll() is None
        time.sleep(0.1)
    process.kill()
    process.wait()
    before = count_trials("boring_bar_design.zarr")
    runpy.run_path(script)["main"]()
    printed, asked = capsys.readouterr()
    assert asked.startswith(f"design: {12 - before} trials, ")
    assert [line.partition(":")[0] for line in printed.splitlines()] == ["design", "map", "20 other packings"]
    page = (tmp_path / "boring_bar_design.html").read_text(encoding="utf-8")
    assert "Design: designs" in page and "Response from a loss map: map of a cavity, 40 % full" in page


@pytest.mark.parametrize(
    "name", ["building", *(pytest.param(name, marks=pytest.mark.slow) for name in ("boring_bar", "panel"))]
)
def test_tutorials_print_the_numbers_of_their_page(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A script of a tutorial passes its own assertions, writes its figure and prints as many lines as its page shows."""
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
    page = (EXAMPLES.parent / "docs" / "tutorials" / f"{name}.md").read_text(encoding="utf-8")
    shown = page.split("```text\n")[1].split("```")[0]
    printed = capsys.readouterr().out
    assert [line.split()[0] for line in printed.splitlines()] == [line.split()[0] for line in shown.splitlines()]
    assert (tmp_path / f"{name}.png").stat().st_size > 10_000


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "backbone",
        "boring_bar_checks",
        "building_variants",
        "calibration",
        "chatter",
        "deep_bed",
        "design_evidence",
        "fatigue_damage",
        "fills",
        "gear",
        "ida",
        "inner_structures",
        "lecture",
        "map_against_simulation",
        "panel_variants",
        "particle_tuned_mass",
        "particles_or_tuned_mass",
        "pounding",
        "regimes",
        "restitution_of_metals",
        "rules_of_thumb",
        "softening_and_step",
        "time_step",
        "two_case_files",
    ],
)
def test_numbers_of_the_guide_and_of_tutorials(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each script asserts the numbers of its page."""
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
