"""Tests of `rattlebox sweep` and `rattlebox show` of studies."""

from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.run.stored import open_study

from .conftest import RunCli

EXAMPLE = Path(__file__).parents[3] / "examples" / "steel_ball.toml"
STUDY = f"""\
measure = ["impacts", "impact_share"]

[case]
file = "{EXAMPLE}"

[axes]
"damper.gap" = {{ from = "0.2 mm", to = "1 mm", count = 3 }}
"damper.ball.material" = ["steel", "brass"]
"""


@pytest.fixture
def study(run_cli: RunCli) -> Path:
    """Write a study file to the current folder, which is otherwise empty, and return its path."""
    Path("study.toml").write_text(STUDY)
    return Path("study.toml")


def test_sweep_and_show(study: Path, run_cli: RunCli) -> None:
    """The store is named after the study file and equals single runs; without a terminal no bar is drawn."""
    done = run_cli("sweep", study, "--workers", "2")
    assert done == (0, "6 variants: 6 finished\nwritten to study.zarr\n", "")
    data = open_study("study.zarr")
    assert list(data.data_vars) == ["status", "impacts", "impact_share"]
    case = rb.Case.from_file(EXAMPLE)
    damper = case.dampers[0].model_copy(update={"gap": float(data["damper.gap"][1])})
    run = rb.simulate(case.model_copy(update={"dampers": (damper,)}))
    assert data.impacts.values[1, 0] == len(run.arrays.impacts)
    code, shown, error = run_cli("show", "study.zarr")
    assert (code, error) == (0, "")
    assert shown.startswith("study.zarr: 6 variants, complete\n")
    words = shown.split()
    for word in ("damper.gap", "0.2000", "mm", "damper.ball.material", "brass", f"{np.max(data.impacts.values):.0f}"):
        assert word in words
    assert shown.endswith("6 variants: 6 finished\n")


def test_repeated_and_changed_study(study: Path, run_cli: RunCli) -> None:
    """A repeated study prints its result at once; a study with other axes does not change the store."""
    first = run_cli("sweep", study, "-o", "maps/a.zarr")
    assert first == (0, "6 variants: 6 finished\nwritten to maps/a.zarr\n", "")
    before = Path("maps/a.zarr/impacts/c/0/0").stat().st_mtime_ns
    assert run_cli("sweep", study, "-o", "maps/a.zarr") == first
    study.write_text(STUDY.replace("0.2 mm", "0.3 mm"))
    code, printed, errors = run_cli("sweep", study, "-o", "maps/a.zarr")
    assert (code, printed) == (2, "")
    assert errors.startswith("error: maps/a.zarr ") and "damper.gap.values[0]: 0.0002 there, 0.0003 here\n" in errors
    assert Path("maps/a.zarr/impacts/c/0/0").stat().st_mtime_ns == before


def test_unfinished_runs_are_counted(study: Path, run_cli: RunCli) -> None:
    """Runs that cannot finish do not stop a study; both commands count the runs of each status."""
    few = rb.Case.from_file(EXAMPLE).model_copy(update={"method": rb.EventDriven(max_events=20)})
    few.to_file("few.toml")
    study.write_text(STUDY.replace(str(EXAMPLE), "few.toml"))
    assert run_cli("sweep", study)[:2] == (0, "6 variants: 6 too_many_events\nwritten to study.zarr\n")
    assert run_cli("show", "study.zarr")[1].endswith("6 variants: 6 too_many_events\n")


def test_refused_runs_and_warnings_are_counted(study: Path, run_cli: RunCli) -> None:
    """Both commands count refused runs and validity warnings, and print why one run was refused."""
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
    warning = "warning: 1 of 2 results with overlaps above 1 % of the radius\n"
    code, printed, _ = run_cli("sweep", study)
    assert code == 0 and printed.startswith("2 variants: 1 finished, 1 refused\n")
    assert "damper.softening = 1\n  method.dt\n    dt = 40.0 µs" in printed
    assert printed.endswith("written to study.zarr\n") and f"\n{warning}" in printed
    shown = run_cli("show", "study.zarr")[1]
    assert "  2 variants: 1 finished, 1 refused\n" in shown and f"\n  {warning.strip()}\n" in shown


def test_plausibility_warnings_of_a_study(study: Path, run_cli: RunCli) -> None:
    """A gap of metres in the case of a study results in a warning on standard error."""
    case = rb.Case.from_file(EXAMPLE).replaced({"damper.gap": 2.0})
    case.to_file("wide.toml")
    study.write_text(STUDY.replace(str(EXAMPLE), "wide.toml").replace('"1 mm"', '"3 m"'))
    code, _, errors = run_cli("sweep", study)
    assert code == 0
    assert errors.startswith("study.toml: warning: ") and "gap" in errors and "2 m" in errors


def test_missing_values_are_counted(study: Path, run_cli: RunCli) -> None:
    """Show counts the variants with a value of each measure and prints the range of an unordered axis."""
    measured = STUDY.replace('"impacts"', '"mean_approach_speed"').replace(
        "{ from =", '["1 mm", "20 mm", "0.2 mm"] # {'
    )
    study.write_text(measured)
    run_cli("sweep", study)
    count = int(np.isfinite(open_study("study.zarr").mean_approach_speed.values).sum())
    rows = [line.split() for line in run_cli("show", "study.zarr")[1].splitlines()]
    (axis,) = (words for words in rows if words[:1] == ["damper.gap"])
    assert axis[-4:] == ["0.2000", "mm", "20.00", "mm"]
    (share,) = (words for words in rows if words[:1] == ["impact_share"])
    (speed,) = (words for words in rows if words[:1] == ["mean_approach_speed"])
    assert (share[-1], speed[-1]) == ("6", f"{count}")
    assert 0 < count < 6


def test_study_without_finished_variants(study: Path, run_cli: RunCli) -> None:
    """Show prints no age of the last variant if there is none."""

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rb.sweep(rb.Case.from_file(EXAMPLE), {"damper.gap": [1e-3, 2e-3]}, store="begun.zarr", progress=stop)
    assert run_cli("show", "begun.zarr")[1].startswith("begun.zarr: 0 of 2 variants\n")


@pytest.mark.parametrize(
    ("line", "message"),
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
def test_study_that_does_not_match_its_case(study: Path, run_cli: RunCli, line: str, message: str) -> None:
    """The error of a study file that can be read but not run begins with the name of the file."""
    content = STUDY.partition("[axes]")[0] if "kind" in line else STUDY
    study.write_text(content.replace('measure = ["impacts", "impact_share"]', line))
    code, _, errors = run_cli("sweep", study)
    assert (code, errors.startswith(f"error: study.toml: {message}")) == (2, True), errors


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("sweep", "nowhere.toml"), "there is no file nowhere.toml"),
        (("sweep", "study.toml", "--workers", "0"), "--workers"),
        (("sweep", "study.toml", "--workers", "2", "--dask", "tcp://127.0.0.1:1"), "--dask runs on the workers"),
        (("sweep", "study.toml", "--dask", "there"), "no Dask scheduler responds at there"),
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
        (("show", "nowhere.zarr"), "nowhere.zarr does not exist"),
    ],
)
def test_mistakes(study: Path, run_cli: RunCli, arguments: tuple[str, ...], message: str) -> None:
    """A mistake ends with exit code 2 and a message of one screen; nothing is written."""
    code, _, errors = run_cli(*arguments)
    assert code == 2
    assert message in " ".join(errors.replace("│", " ").split())
    assert "Traceback" not in errors
    assert len(errors.splitlines()) < 24
    assert [path.name for path in Path().iterdir()] == ["study.toml"]
