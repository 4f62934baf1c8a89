"""The commands sweep and show, run as a user runs them."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.cli.main import main
from rattlebox.studies.stored import open_study

EXAMPLE = Path(__file__).parents[3] / "examples" / "steel_ball.toml"
STUDY = f"""\
measure = ["impacts", "impact_share"]

[case]
file = "{EXAMPLE}"

[axes]
"damper.gap" = {{ from = "0.2 mm", to = "1 mm", count = 3 }}
"damper.ball.material" = ["steel", "brass"]
"""


Answer = Callable[..., tuple[int | str | None, str, str]]


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A study file in the current folder, which is else empty."""
    monkeypatch.chdir(tmp_path)
    Path("study.toml").write_text(STUDY)
    return Path("study.toml")


@pytest.fixture
def answer(study: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Answer:
    """Run the command; return its exit code, what it prints, and what it says."""

    def run(*arguments: object) -> tuple[int | str | None, str, str]:
        monkeypatch.setattr(sys, "argv", ["rattlebox", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main()
        return stop.value.code or 0, *capsys.readouterr()

    return run


def test_sweep_writes_what_it_says_and_show_tells_it(study: Path) -> None:
    """A study file gives a store named after it, equal to single runs; away from a terminal no bar is drawn."""
    command = [sys.executable, "-m", "rattlebox.cli"]
    done = subprocess.run([*command, "sweep", study, "--workers", "2"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "6 variants: 6 finished\nwritten to study.zarr\n"
    data = open_study("study.zarr")
    assert list(data.data_vars) == ["status", "impacts", "impact_share"]
    case = rb.Case.from_file(EXAMPLE)
    damper = case.dampers[0].model_copy(update={"gap": float(data["damper.gap"][1])})
    run = rb.simulate(case.model_copy(update={"dampers": (damper,)}))
    assert data.impacts.values[1, 0] == len(run.arrays.impacts)
    told = subprocess.run([*command, "show", "study.zarr"], capture_output=True, text=True, check=False)
    assert (told.returncode, told.stderr) == (0, "")
    assert told.stdout.startswith("study.zarr: 6 variants, complete\n")
    words = told.stdout.split()
    for word in ("damper.gap", "200.0", "µm", "damper.ball.material", "brass", f"{np.max(data.impacts.values):.0f}"):
        assert word in words
    assert told.stdout.endswith("ended: 6 finished\n")


def test_the_same_command_goes_on_and_another_study_is_refused(study: Path, answer: Answer) -> None:
    """Run again, a finished study is told at once; after a change of the axes the store is left alone."""
    first = answer("sweep", study, "-o", "maps/a.zarr")
    assert first == (0, "6 variants: 6 finished\nwritten to maps/a.zarr\n", "")
    before = Path("maps/a.zarr/impacts/c/0/0").stat().st_mtime_ns
    assert answer("sweep", study, "-o", "maps/a.zarr") == first
    study.write_text(STUDY.replace("0.2 mm", "0.3 mm"))
    assert answer("sweep", study, "-o", "maps/a.zarr") == (
        2,
        "",
        "error: maps/a.zarr holds another study\n"
        "  design.columns.damper.gap.values[0]: 0.0002 there, 0.0003 here\n"
        "  try: another folder, or remove this one\n",
    )
    assert Path("maps/a.zarr/impacts/c/0/0").stat().st_mtime_ns == before


def test_runs_that_do_not_finish_are_counted(study: Path, answer: Answer) -> None:
    """A study goes on past runs that cannot be finished; both commands tell how many there are of each kind."""
    few = rb.Case.from_file(EXAMPLE).model_copy(update={"method": rb.EventDriven(max_events=20)})
    few.to_file("few.toml")
    study.write_text(STUDY.replace(str(EXAMPLE), "few.toml"))
    assert answer("sweep", study)[:2] == (0, "6 variants: 6 too_many_events\nwritten to study.zarr\n")
    assert answer("show", "study.zarr")[1].endswith("ended: 6 too_many_events\n")


def test_runs_that_are_refused_or_leave_their_bounds_are_told(study: Path, answer: Answer) -> None:
    """Both commands count refused runs and runs with warnings of particles, and print why the first was refused."""
    case = rb.Case(
        structure=rb.SDOF(mass=1, stiffness=1e4, velocity="1 m/s"),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=2),
            cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
            contact=rb.Tsuji(restitution=0.5),
        ),
        duration="20 ms",
        method=rb.Dem(dt="40 us"),
    )
    case.to_file("few.toml")
    study.write_text('case.file = "few.toml"\nmeasure = ["impact_share"]\naxes."damper.softening" = [1e6, 1.0]\n')
    warned = "warning: 1 with overlaps above 1 % of the radius\n"
    status, said, _ = answer("sweep", study)
    assert status == 0 and said.startswith("2 variants: 1 finished, 1 refused\n")
    assert "\nrefused, as with damper.softening = 1\n  method.dt\n    dt = 40.0 µs is too long" in said
    assert said.endswith("written to study.zarr\n") and f"\n{warned}" in said
    shown = answer("show", "study.zarr")[1]
    assert "  ended: 1 finished, 1 refused\n" in shown and f"\n  {warned.strip()}\n" in shown


def test_slips_in_the_case_of_a_study_are_told(study: Path, answer: Answer) -> None:
    """A case that varies with a gap of metres is told as it would be run alone, beside the results."""
    case = rb.Case.from_file(EXAMPLE).replaced({"damper.gap": 2.0})
    case.to_file("wide.toml")
    study.write_text(STUDY.replace(str(EXAMPLE), "wide.toml").replace('"1 mm"', '"3 m"'))
    status, _, beside = answer("sweep", study)
    assert status == 0
    assert beside == "study.toml: warning: the gap of damper is 2 m; a number without a unit is in metres\n"


def test_values_that_are_missing_are_counted(study: Path, answer: Answer) -> None:
    """Show tells how many variants have a value of each measure, and the range of an axis whose values are in no order."""
    measured = STUDY.replace('"impacts"', '"mean_approach_speed"').replace(
        "{ from =", '["1 mm", "20 mm", "0.2 mm"] # {'
    )
    study.write_text(measured)
    answer("sweep", study)
    struck = int(np.isfinite(open_study("study.zarr").mean_approach_speed.values).sum())
    told = [line.split() for line in answer("show", "study.zarr")[1].splitlines()]
    (axis,) = (words for words in told if words[:1] == ["damper.gap"])
    assert axis[-4:] == ["200.0", "µm", "20.00", "mm"]
    (share,) = (words for words in told if words[:1] == ["impact_share"])
    (speed,) = (words for words in told if words[:1] == ["mean_approach_speed"])
    assert (share[-1], speed[-1]) == ("6", f"{struck}")
    assert 0 < struck < 6


def test_study_of_which_nothing_is_done(study: Path, answer: Answer) -> None:
    """Show tells of no last variant where there is none."""

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rb.sweep(rb.Case.from_file(EXAMPLE), {"damper.gap": [1e-3, 2e-3]}, store="begun.zarr", progress=stop)
    assert answer("show", "begun.zarr")[1].startswith("begun.zarr: 0 of 2 variants\n")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("measure = []", "no measure is given"),
        ('measure = ["loss_per_cycle"]', "loss_per_cycle is defined per cycle"),
        ('measure = ["impacts"]\nskip = "9 s"', "skip = 9 s is not before the end of the run"),
        (
            'kind = "frequency_response"\nlevels = [1]\nfrequencies = [9]',
            "the case has 0 harmonic loads",
        ),
        ('kind = "sensitivity"\nbounds = { "damper.gap" = { from = "2 mm", to = "1 mm" } }', "bounds: damper.gap = ("),
    ],
)
def test_what_does_not_fit_the_case_is_told_with_the_file(study: Path, answer: Answer, line: str, said: str) -> None:
    """A study file that can be read but not run is named, as one that cannot be read is."""
    content = STUDY.partition("[axes]")[0] if "kind" in line else STUDY
    study.write_text(content.replace('measure = ["impacts", "impact_share"]', line))
    code, _, message = answer("sweep", study)
    assert (code, message.startswith(f"error: study.toml: {said}")) == (2, True), message


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("sweep", "nowhere.toml"), "there is no file nowhere.toml"),
        (("sweep", "study.toml", "--workers", "0"), "--workers"),
        (("sweep", "study.toml", "--workers", "2", "--dask", "tcp://127.0.0.1:1"), "cluster's workers run the study"),
        (("sweep", "study.toml", "--dask", "there"), "no Dask scheduler answers at there"),
        (("sweep", "study.toml", "-o", "study.toml"), "study.toml is a file; "),
        (("sweep", "study.toml", "-o", "."), "holds other files"),
        (
            ("run", "study.toml"),
            "study.toml: this is a study of a case, not a case try: rattlebox sweep study.toml",
        ),
        (
            ("sweep", str(EXAMPLE)),
            "is a case file, not a study file try: rattlebox run",
        ),
        (("show", "study.toml"), "study.toml is a case file or a study file, not a result"),
        (("plot", "study.toml"), "study.toml is a case file or a study file, not a result"),
        (("show", "."), "is not a study"),
        (("show", "nowhere.zarr"), "nowhere.zarr is not there"),
    ],
)
def test_mistakes_are_told(answer: Answer, arguments: tuple[str, ...], said: str) -> None:
    """What cannot be done is told on one screen, with exit code 2, no traceback and nothing written."""
    code, _, message = answer(*arguments)
    assert code == 2
    assert said in " ".join(message.replace("│", " ").split())
    assert "Traceback" not in message
    assert len(message.splitlines()) < 24
    assert [path.name for path in Path().iterdir()] == ["study.toml"]
