"""Ready maps from study files: run, shown and drawn by the commands."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from rattlebox.cli.main import main
from rattlebox.studies.runner import Stopped
from rattlebox.studies.study_file import read_study

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

Answer = Callable[..., tuple[int | str | None, str, str]]


@pytest.fixture
def answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Answer:
    """Run the command beside the case files; return its exit code, what it prints, and what it says."""
    monkeypatch.chdir(tmp_path)
    for name, text in CASES.items():
        Path(name).write_text(text)

    def run(*arguments: object) -> tuple[int | str | None, str, str]:
        monkeypatch.setattr(sys, "argv", ["rattlebox", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main()
        return stop.value.code or 0, *capsys.readouterr()

    return run


def study(kind: str) -> str:
    """A study file of a kind."""
    case, text, _ = STUDIES[kind]
    return f'kind = "{kind}"\ncase = "{case}"\n{text}\n'


@pytest.mark.parametrize("kind", STUDIES)
def test_a_map_from_a_file(kind: str, answer: Answer) -> None:
    """A study file of a ready map gives what the function returns, to the last bit; it is shown, drawn, and gone on with."""
    Path("study.toml").write_text(study(kind))
    code, told, said = answer("sweep", "study.toml", "-o", "study.zarr", "--workers", 2)
    assert (code, said) == (0, "")
    assert told.endswith("written to study.zarr\n")
    found = rb.open_study("study.zarr").load()
    exact = STUDIES[kind][2](rb.Case.from_file(STUDIES[kind][0]))
    assert list(found) == list(exact)
    for name, values in exact.variables.items():
        np.testing.assert_array_equal(found[name].values.astype(values.dtype), values.values)
        assert found[name].attrs == values.attrs
    assert found.attrs["study"] == kind
    code, told, said = answer("show", "study.zarr")
    assert (code, said) == (0, "")
    assert told.startswith(f"study.zarr: {kind.replace('_', ' ')}, ")
    assert "goes on" not in told
    assert answer("plot", "study.zarr", "-o", "a.png") == (0, "written: a.png\n", "")
    assert answer("plot", "study.zarr", "-o", "b.svg", "--kind", kind, "--size", "page")[0] == 0
    assert Path("a.png").stat().st_size > 5000
    assert answer("sweep", "study.toml", "-o", "study.zarr")[0] == 0
    assert rb.open_study("study.zarr").load().identical(found)


def test_measures_of_a_map_as_any_study(answer: Answer) -> None:
    """Measures of a ready map are drawn over its axes, quantities are chosen, and others refused."""
    Path("study.toml").write_text(study("loss_map"))
    answer("sweep", "study.toml")
    assert answer("plot", "study.zarr", "--kind", "lines", "--of", "loss_per_cycle")[0] == 0
    for options, words in (
        (["--kind", "basins"], "which holds a loss map"),
        (["--kind", "basin"], "did you mean 'basins'"),
        (["--of", "loss_factor"], "shows all that there is"),
    ):
        code, _, said = answer("plot", "study.zarr", "-o", "none.png", *options)
        assert code == 2 and words in said
    assert not Path("none.png").exists()


def test_quantities_of_a_diagram(answer: Answer) -> None:
    """What a diagram shows can be chosen."""
    Path("study.toml").write_text(study("bifurcation"))
    answer("sweep", "study.toml")
    assert answer("plot", "study.zarr", "--of", "impact_phase")[0] == 0
    code, _, said = answer("plot", "study.zarr", "--of", "impact_phas")
    assert code == 2 and "did you mean 'impact_phase'" in said


def test_a_design_without_a_best_trial_is_shown(answer: Answer) -> None:
    """Where every trial is too heavy there is no best one to list, and nothing is told of its case."""
    Path("study.toml").write_text(
        study("design").replace('kind = "design"', 'kind = "design"\nmax_added_mass = "1 mg"')
    )
    assert answer("sweep", "study.toml")[0] == 0
    code, out, _ = answer("show", "study.zarr")
    assert code == 0 and "best trial" not in out and "case file" not in out
    assert answer("plot", "study.zarr")[0] == 0


@pytest.mark.parametrize(("kind", "after", "told"), [("bifurcation", 1, "3 of 18 variants"), ("design", 2, "2 trials")])
def test_maps_that_are_stopped(kind: str, after: int, told: str, answer: Answer) -> None:
    """A map that was stopped tells how far it is, cannot be drawn as one yet, and the command finishes it."""
    Path("study.toml").write_text(study(kind))

    def stop(done: int, total: int) -> None:
        if done >= after:
            raise KeyboardInterrupt

    with pytest.raises(Stopped):
        read_study("study.toml").run(store="study.zarr", progress=stop)
    code, out, _ = answer("show", "study.zarr")
    assert code == 0 and told in out and "The command that began it goes on." in out
    code, _, said = answer("plot", "study.zarr", "--kind", kind)
    assert code == 2, said
    assert answer("sweep", "study.toml")[0] == 0
    finished = answer("show", "study.zarr")[1]
    assert "goes on" not in finished
    assert ("best trial" in finished) == (kind == "design")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (study("bifurcation").replace("bifurcation", "bifurcations"), "did you mean 'bifurcation'"),
        (study("bifurcation").replace("show", "shown"), "did you mean 'show'"),
        (study("bifurcation") + '[axes]\n"damper.gap" = ["1 mm"]', "there is no such field"),
        (study("bifurcation").split("path")[0], "path"),
        (study("bifurcation").replace("[40, 16]", "[40.5, 16]"), "two whole numbers"),
        (study("bifurcation").replace('"0.5 mm"', '"0.5 kg"'), "not a mass"),
        (study("frequency_response").replace("frequencies", "frequency"), "did you mean 'frequencies'"),
        (study("frequency_response").replace('"29 Hz"', '"29 m"'), "not a length"),
        (study("basins").replace("[40, 8]", "[40, 8]\napart = 2"), "apart = 2"),
        (study("loss_map").replace("shaken", "rig"), "requires a case on a shaker"),
        (study("design").replace('"max"', '"most"'), "objective"),
        (study("design").replace('"damper.gap"', '"damper.gpa"'), "did you mean 'gap'"),
        (study("sensitivity").replace("n = 8", "n = 12"), "a power of two"),
        (study("sensitivity").replace("reduced_loss", "reduced_los"), "did you mean 'reduced_loss'"),
    ],
)
def test_mistakes_are_told(content: str, said: str, answer: Answer) -> None:
    """What does not fit ends with exit code 2, what is allowed, no traceback and nothing written."""
    Path("study.toml").write_text(content)
    before = sorted(Path().iterdir())
    code, _, message = answer("sweep", "study.toml")
    assert code == 2
    assert said in message
    assert len(message.splitlines()) < 24
    assert sorted(Path().iterdir()) == before
