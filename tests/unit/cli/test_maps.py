"""Tests of the commands with study files of all kinds."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from rattlebox.studies.run.runner import Stopped
from rattlebox.studies.study_file import read_study

from .conftest import RunCli

CASES = {
    "shaken.toml": """\
duration = "1 s"
[structure]
kind = "shaker"
motion = { kind = "harmonic", amplitude = "1 mm", frequency = "10 Hz" }
[damper]
gap = "1 mm"
velocity = "0.1 m/s"
ball = { radius = "10 mm", material = "steel" }
contact = { kind = "tsuji", restitution = 0.6 }
[method]
kind = "newton"
""",
    "rig.toml": """\
duration = "1 s"
[structure]
kind = "sdof"
mass = "1 kg"
stiffness = "40 kN/m"
damping_ratio = 0.01
[load]
kind = "harmonic"
amplitude = "5 N"
frequency = "30 Hz"
[damper]
gap = "1 mm"
ball = { radius = "14 mm", material = "steel" }
contact = { kind = "tsuji", restitution = 0.6 }
[method]
kind = "newton"
""",
}
CASES["forced.toml"] = CASES["rig.toml"].replace('"1 s"', '"3 s"').replace('"30 Hz"', '"33 Hz"')
AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"
QUIET: dict[str, Any] = {"progress": False}
STUDIES: dict[str, tuple[str, str, Callable[[rb.Case], xr.Dataset]]] = {
    "bifurcation": (
        "shaken.toml",
        f'cycles = [40, 16]\nshow = "impacts"\npath = "{AMPLITUDE}"\n'
        'values = { from = "0.5 mm", to = "2 mm", count = 9 }',
        lambda case: rb.bifurcation(
            case, AMPLITUDE, rb.linspace("0.5 mm", "2 mm", 9), cycles=(40, 16), show="impacts", **QUIET
        ),
    ),
    "frequency_response": (
        "rig.toml",
        'cycles = [40, 8]\nlevels = ["2.5 N", 5]\nfrequencies = { from = "29 Hz", to = "33 Hz", count = 5 }',
        lambda case: rb.frequency_response(
            case, rb.linspace("29 Hz", "33 Hz", 5), levels=["2.5 N", 5], cycles=(40, 8), **QUIET
        ),
    ),
    "basins": (
        "shaken.toml",
        "cycles = [40, 8]\n[starts]\n"
        '"damper.start" = { from = -1, to = 1, count = 5 }\n"damper.velocity" = ["-0.1 m/s", "0.1 m/s"]',
        lambda case: rb.basins(
            case,
            {"damper.start": rb.linspace(-1, 1, 5), "damper.velocity": ["-0.1 m/s", "0.1 m/s"]},
            cycles=(40, 8),
            **QUIET,
        ),
    ),
    "lyapunov": (
        "rig.toml",
        'cycles = [20, 10]\npairs = 2\n[axes]\n"load.frequency" = ["31 Hz", "33 Hz"]',
        lambda case: rb.lyapunov(case, {"load.frequency": ["31 Hz", "33 Hz"]}, cycles=(20, 10), pairs=2, **QUIET),
    ),
    "loss_map": (
        "shaken.toml",
        'cycles = [10, 10]\nfrequencies = ["10 Hz", "20 Hz"]\n'
        'amplitudes = { from = "0.5 mm", to = "5 mm", count = 4, spacing = "log" }',
        lambda case: rb.loss_map(case, rb.geomspace("0.5 mm", "5 mm", 4), ["10 Hz", "20 Hz"], cycles=(10, 10), **QUIET),
    ),
    "stability_lobes": (
        "rig.toml",
        'cutting_coefficient = "500 N/mm^2"\ndirectional_factor = 0.7\nspeeds = ["900 rpm", "1500 rpm"]\n'
        'amplitudes = ["1.2 mm", "3 mm"]\nfrequencies = ["25 Hz", "60 Hz"]\ncycles = [10, 10]',
        lambda case: rb.stability_lobes(
            case,
            None,
            "500 N/mm^2",
            0.7,
            ["900 rpm", "1500 rpm"],
            amplitudes=["1.2 mm", "3 mm"],
            frequencies=["25 Hz", "60 Hz"],
            cycles=(10, 10),
            **QUIET,
        ),
    ),
    "continue_orbit": (
        "forced.toml",
        'axis = "load.frequency"\nperiod = 1\nstep = 0.05\nlimits = { from = "31 Hz", to = "34 Hz" }',
        lambda case: (
            rb.continue_orbit(
                rb.find_orbit(case, period=1), "load.frequency", ("31 Hz", "34 Hz"), step=0.05, **QUIET
            ).data
        ),
    ),
    "design": (
        "shaken.toml",
        'cycles = [10, 10]\nobjective = { reduced_loss = "max" }\ntrials = 6\nstarts = 2\n'
        f'[levels]\n"{AMPLITUDE}" = ["1 mm", "2 mm"]\n'
        '[parameters]\n"damper.gap" = { from = "0.5 mm", to = "5 mm", spacing = "log" }\n'
        '"damper.ball.material" = ["steel", "brass"]',
        lambda case: rb.design(
            case,
            {"damper.gap": ("0.5 mm", "5 mm"), "damper.ball.material": ["steel", "brass"]},
            {"reduced_loss": "max"},
            levels={AMPLITUDE: ["1 mm", "2 mm"]},
            starts=2,
            log=["damper.gap"],
            cycles=(10, 10),
            trials=6,
            **QUIET,
        ),
    ),
    "sensitivity": (
        "shaken.toml",
        'cycles = [10, 10]\nmeasure = ["reduced_loss"]\nn = 8\n'
        f'[bounds]\n"damper.gap" = {{ from = "1 mm", to = "2 mm" }}\n{AMPLITUDE} = ["1 mm", "3 mm"]',
        lambda case: rb.sensitivity(
            case,
            {"damper.gap": ("1 mm", "2 mm"), AMPLITUDE: ("1 mm", "3 mm")},
            "reduced_loss",
            8,
            cycles=(10, 10),
            **QUIET,
        ),
    ),
}


@pytest.fixture(autouse=True)
def case_files(run_cli: RunCli) -> None:
    """Write the case files to the current folder."""
    for name, text in CASES.items():
        Path(name).write_text(text)


def study(kind: str) -> str:
    """Return the text of a study file of a kind."""
    case, text, _ = STUDIES[kind]
    return f'kind = "{kind}"\ncase = "{case}"\n{text}\n'


@pytest.mark.parametrize("kind", STUDIES)
def test_study_file_of_each_kind(kind: str, run_cli: RunCli) -> None:
    """The stored study equals the result of the function bit by bit; the commands show, draw and repeat it."""
    Path("study.toml").write_text(study(kind))
    code, printed, errors = run_cli("sweep", "study.toml", "-o", "study.zarr", "--workers", 2)
    assert (code, errors) == (0, "")
    assert printed.endswith("written to study.zarr\n")
    stored = rb.open_study("study.zarr").load()
    exact = STUDIES[kind][2](rb.Case.from_file(STUDIES[kind][0]))
    assert list(stored) == list(exact)
    for name, values in exact.variables.items():
        np.testing.assert_array_equal(stored[name].values.astype(values.dtype), values.values)
        # Values of flags are arrays of the type of their variable.
        np.testing.assert_equal(stored[name].attrs, values.attrs)
    assert stored.attrs["study"] == kind
    code, printed, errors = run_cli("show", "study.zarr")
    assert (code, errors) == (0, "")
    assert printed.startswith(f"study.zarr: {kind.replace('_', ' ')}, ")
    assert "not finished" not in printed
    assert run_cli("plot", "study.zarr", "-o", "a.png") == (0, "written: a.png\n", "")
    assert run_cli("plot", "study.zarr", "-o", "b.svg", "--kind", kind, "--size", "page")[0] == 0
    assert Path("a.png").stat().st_size > 5000
    assert run_cli("sweep", "study.toml", "-o", "study.zarr")[0] == 0
    assert rb.open_study("study.zarr").load().identical(stored)


def test_measures_of_a_loss_map(run_cli: RunCli) -> None:
    """Measures are drawn over the axes of the map; unsuitable kinds and measures end with exit code 2."""
    Path("study.toml").write_text(study("loss_map"))
    run_cli("sweep", "study.toml")
    assert run_cli("plot", "study.zarr", "--kind", "lines", "--of", "loss_per_cycle")[0] == 0
    for options, words in (
        (["--kind", "basins"], "this study is a loss map"),
        (["--kind", "basin"], "did you mean 'basins'"),
        (["--of", "loss_factor"], "has no choice of measures"),
    ):
        code, _, errors = run_cli("plot", "study.zarr", "-o", "none.png", *options)
        assert code == 2 and words in errors
    assert not Path("none.png").exists()


def test_quantities_of_a_bifurcation_diagram(run_cli: RunCli) -> None:
    """The quantity of a diagram can be chosen."""
    Path("study.toml").write_text(study("bifurcation"))
    run_cli("sweep", "study.toml")
    assert run_cli("plot", "study.zarr", "--of", "impact_phase")[0] == 0
    code, _, errors = run_cli("plot", "study.zarr", "--of", "impact_phas")
    assert code == 2 and "did you mean 'impact_phase'" in errors


def test_design_without_a_feasible_trial(run_cli: RunCli) -> None:
    """If every trial exceeds the mass limit, show lists no best trial."""
    Path("study.toml").write_text(
        study("design").replace('kind = "design"', 'kind = "design"\nmax_added_mass = "1 mg"')
    )
    assert run_cli("sweep", "study.toml")[0] == 0
    code, out, _ = run_cli("show", "study.zarr")
    assert code == 0 and "best trial" not in out and "case file" not in out
    assert run_cli("plot", "study.zarr")[0] == 0


@pytest.mark.parametrize(
    ("kind", "after", "progress"), [("bifurcation", 1, "3 of 18 variants"), ("design", 2, "2 trials")]
)
def test_stopped_study(kind: str, after: int, progress: str, run_cli: RunCli) -> None:
    """Show prints the progress of a stopped study; its own figure needs all runs; the same command finishes it."""
    Path("study.toml").write_text(study(kind))

    def stop(done: int, total: int) -> None:
        if done >= after:
            raise KeyboardInterrupt

    with pytest.raises(Stopped):
        read_study("study.toml").run(store="study.zarr", progress=stop)
    code, out, _ = run_cli("show", "study.zarr")
    assert code == 0 and progress in out and "not finished" in out
    code, _, errors = run_cli("plot", "study.zarr", "--kind", kind)
    assert code == 2, errors
    assert run_cli("sweep", "study.toml")[0] == 0
    finished = run_cli("show", "study.zarr")[1]
    assert "not finished" not in finished
    assert ("best trial" in finished) == (kind == "design")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (study("bifurcation").replace("bifurcation", "bifurcations"), "did you mean 'bifurcation'"),
        (study("bifurcation").replace("show", "shown"), "did you mean 'show'"),
        (study("bifurcation") + '[axes]\n"damper.gap" = ["1 mm"]', "there is no such field"),
        (study("bifurcation").split("path")[0], 'try: path = "load.frequency"'),
        ('kind = "sweep"', 'try: case = { file = "case.toml" }'),
        ('kind = "stability_lobes"', 'try: case = { file = "case.toml" }'),
        (study("loss_map").replace("frequencies", "# "), 'try: frequencies = ["30 Hz", "60 Hz"]'),
        (study("bifurcation").replace("[40, 16]", "[40.5, 16]"), "two whole numbers"),
        (study("bifurcation").replace('"0.5 mm"', '"0.5 kg"'), "not a mass"),
        (study("frequency_response").replace("frequencies", "frequency"), "did you mean 'frequencies'"),
        (study("frequency_response").replace('"29 Hz"', '"29 m"'), "not a length"),
        (study("basins").replace("[40, 8]", "[40, 8]\napart = 2"), "apart = 2"),
        (study("loss_map").replace("shaken", "rig"), "requires a case on a shaker"),
        (study("design").replace('"max"', '"most"'), "objective"),
        (study("design").replace('"damper.gap"', '"damper.gpa"'), "did you mean 'gap'"),
        (study("continue_orbit").replace("axis", "axes"), "did you mean 'axis'"),
        (study("continue_orbit").replace('"load.frequency"', '"load.frequenc"'), "did you mean 'frequency'"),
        (study("continue_orbit").replace('"31 Hz"', '"31 kg"'), "not a mass"),
        (study("continue_orbit").replace('"31 Hz"', '"33.5 Hz"'), "not between the limits"),
        (study("continue_orbit").replace("forced", "shaken"), "no load in this case"),
        (study("continue_orbit").replace("period = 1", "period = 0"), "period = 0"),
        (study("continue_orbit").replace('to = "34 Hz"', 'to = "34 Hz", count = 3'), "must be two values"),
        (study("continue_orbit").replace("period", 'near = ["a", "b"]\nperiod'), "is not a run"),
        (study("continue_orbit").replace("period", "near = [0.0, 1.0]\nperiod"), "the case needs 4"),
        (study("continue_orbit").replace("period", 'near = "none.nc"\nperiod'), "no file none.nc"),
        (study("sensitivity").replace("n = 8", "n = 12"), "a power of two"),
        (study("sensitivity").replace("reduced_loss", "reduced_los"), "did you mean 'reduced_loss'"),
    ],
)
def test_mistakes_in_study_files(content: str, message: str, run_cli: RunCli) -> None:
    """A mistake ends with exit code 2, the allowed values and advice; nothing is written. Missing fields had no advice."""
    Path("study.toml").write_text(content)
    before = sorted(Path().iterdir())
    code, _, errors = run_cli("sweep", "study.toml")
    assert code == 2
    assert message in errors and ("\n  try: " in errors or "must be" in errors)
    assert len(errors.splitlines()) < 24
    assert sorted(Path().iterdir()) == before


def test_mistyped_names_of_starts_figures_and_measures_have_advice(run_cli: RunCli) -> None:
    """Names of what does not exist end with exit code 2 and what there is; the lists were printed without "try:"."""
    Path("study.toml").write_text(study("bifurcation"))
    assert run_cli("sweep", "study.toml")[0] == run_cli("run", "rig.toml", "-o", "out")[0] == 0
    for words, advice in (
        (("run", "rig.toml", "--start", "out/rum.nc", "-o", "more"), "out/run.nc"),
        (("run", "rig.toml", "--start", "out", "-o", "more"), "out/run.nc"),
        (("plot", "out", "--kind", "energies"), "did you mean 'energy'?"),
        (("plot", "study.zarr", "--kind", "line"), "did you mean 'lines'?"),
        (("plot", "study.zarr", "--kind", "lines", "--of", "perio"), "did you mean 'period'?"),
        (("plot", "study.zarr", "--kind", "lines", "--at", "load.phase=1"), "known: "),
    ):
        code, _, errors = run_cli(*words)
        assert code == 2 and f"\n  try: {advice}" in errors, errors
