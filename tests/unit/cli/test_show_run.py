"""Tests of `rattlebox show` of runs, and of names with square brackets in the output of all commands."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import rattlebox as rb

from .conftest import RunCli

ODD = "[red]a[1] :smile:"
"""A name that rich would interpret as a colour and an emoji."""

DAMPER = """
duration = "20 ms"
structure = { kind = "sdof", mass = "1 kg", stiffness = "10 kN/m", velocity = "0.5 m/s" }
[damper]
ball = { radius = "5 mm", material = "steel", mass = "3 kg" }
gap = "1 mm"
contact = { kind = "tsuji", restitution = 0.8 }
"""
PARTICLES = """
duration = "5 ms"
structure = { kind = "fixed" }
output = { rate = "2 kHz" }
[damper]
particles = { material = "glass", diameter = "3 mm", count = 1 }
cavity = { kind = "sphere", diameter = "20 mm" }
contact = { kind = "tsuji", restitution = 0.8 }
softening = 1e6
"""
FAST = PARTICLES + 'velocity = ["100 m/s", 0, 0]\n'


@pytest.fixture(autouse=True)
def files(run_cli: RunCli) -> None:
    """Write case files and a study file to the current folder."""
    Path("case.toml").write_text(DAMPER, encoding="utf-8")
    Path("particles.toml").write_text(PARTICLES, encoding="utf-8")
    Path("fast.toml").write_text(FAST, encoding="utf-8")
    axes = '"damper.gap" = ["1 mm", "2 mm", "3 mm"]'
    Path("study.toml").write_text(
        f'measure = "impacts"\n[case]\nfile = "case.toml"\n[axes]\n{axes}\n', encoding="utf-8"
    )


def test_run_from_its_folder_and_its_file(run_cli: RunCli) -> None:
    """Show prints the origin of a run, the same summary as `run`, and the files of the run."""
    code, printed, _ = run_cli("run", "case.toml", "-o", "out", "--csv", "--no-figures")
    assert code == 0
    summary = printed[: printed.index("written to")]
    assert "simulated time" in summary and "warning: " in summary
    Path("out/notes.txt").touch()
    for path in ("out", "out/run.nc"):
        code, printed, errors = run_cli("show", path)
        assert (code, errors) == (0, "")
        head, rest = printed.split("\n", 1)
        assert re.fullmatch(rf"{path}: run of \d{{4}}-\d\d-\d\d \d\d:\d\d UTC, Rattlebox .*Python .*", head)
        assert rest == f"{summary}  files: run.nc, motion.csv, energy.csv, impacts.csv\n"
    Path("out/run.nc").rename("out/first.nc")
    assert run_cli("show", "out/first.nc")[1].split("\n", 1)[1] == summary


def test_unfinished_run(run_cli: RunCli) -> None:
    """For a folder with only a checkpoint, show prints that the run is unfinished and how to resume it."""
    Path("out").mkdir()
    case = rb.Case.from_file("particles.toml").model_copy(update={"duration": 100.0})
    assert rb.simulate(case, checkpoint="out/run.checkpoint", progress=lambda *_: False).status == "interrupted"
    code, printed, errors = run_cli("show", "out")
    assert (code, errors) == (0, "")
    assert printed.startswith("out: an unfinished run\n  files: run.checkpoint\n") and "resume" in printed
    code, printed, errors = run_cli("plot", "out")
    assert (code, printed) == (2, "")
    assert errors.startswith("error: out/run.nc does not exist: the run is not finished\n  try: ")


def test_missing_files_of_a_run(run_cli: RunCli) -> None:
    """Show and plot report missing files of a run and suggest what can be drawn."""
    case = rb.Case.from_file("particles.toml")
    Path("out").mkdir()
    rb.simulate(case.replaced({"output": rb.Output(snapshots=3)}), snapshots="out/run.vtkhdf")
    suggestion = "rattlebox plot out/run.vtkhdf\n"
    code, printed, errors = run_cli("show", "out")
    assert (code, errors) == (0, "")
    assert "without run.nc\n  files: run.vtkhdf\n" in printed and printed.endswith(suggestion)
    assert run_cli("plot", "out") == (2, "", f"error: out/run.nc does not exist\n  try: {suggestion}")
    rb.simulate(case).save("out/run.nc")
    rb.simulate(case.replaced({"duration": 100.0}), checkpoint="out/run.checkpoint", progress=lambda *_: False)
    assert run_cli("show", "out")[1].splitlines()[-1].startswith("  run.checkpoint: an unfinished run")
    assert run_cli("run", "case.toml", "-o", "hit", "--no-figures")[0] == 0
    code, printed, errors = run_cli("plot", "hit", "-o", "a.gif")
    assert (code, printed) == (2, "")
    assert errors.startswith("error: hit/run.vtkhdf does not exist: only runs of particle dampers")


def test_paths_without_results(run_cli: RunCli) -> None:
    """Missing files, foreign files and folders without results end with exit code 2."""
    Path("notes.nc").write_text("notes")
    Path("empty").mkdir()
    for path, message in (
        ("nowhere.nc", "nowhere.nc does not exist\n  try: the folder that 'rattlebox run -o' or"),
        ("notes.nc", "notes.nc is not "),
        ("empty", "empty is not a study"),
        (
            "case.toml",
            "case.toml is a case file or a study file, not a result\n  try: the folder that 'rattlebox run -o' or",
        ),
    ):
        code, printed, errors = run_cli("show", path)
        assert (code, printed) == (2, "")
        assert errors.startswith(f"error: {message}")


def test_names_with_markup(run_cli: RunCli) -> None:
    """Square brackets and colons in names of folders are printed unchanged by all commands."""
    assert run_cli("run", "case.toml", "-o", ODD, "--no-figures")[1].endswith(f"written to {ODD}: run.nc\n")
    assert run_cli("show", ODD)[1].startswith(f"{ODD}: run of ")
    assert run_cli("plot", ODD, "-o", f"{ODD}.png") == (0, f"written: {ODD}.png\n", "")
    assert run_cli("sweep", "study.toml", "-o", f"{ODD}.zarr")[1].endswith(f"written to {ODD}.zarr\n")
    assert run_cli("show", f"{ODD}.zarr")[1].startswith(f"{ODD}.zarr: 3 variants")
    assert run_cli("plot", f"{ODD}.zarr", "-o", f"{ODD}.png") == (0, f"written: {ODD}.png\n", "")
    errors = run_cli("run", "fast.toml", "-o", f"{ODD}/fast", "--no-figures")[2]
    assert "in run.checkpoint." in errors
    assert f"\n{ODD}/fast/run.checkpoint remains" in errors
    assert run_cli("demo", "-o", f"{ODD}/demo")[1].endswith(
        f"written to {ODD}/demo: demo.png, and a netCDF and a case file of each run\n"
    )


def test_paths_are_not_wrapped(run_cli: RunCli, monkeypatch: pytest.MonkeyPatch) -> None:
    """A line with a path is not wrapped in a narrow terminal, so that the path can be copied."""
    monkeypatch.setenv("COLUMNS", "40")
    out = "a folder with a name/that is longer than/the terminal is wide"
    lines = run_cli("run", "case.toml", "-o", out, "--no-figures")[1].splitlines()
    assert lines[-1] == f"written to {out}: run.nc"
    lines = run_cli("show", out)[1].splitlines()
    assert lines[0].startswith(f"{out}: run of ") and lines[-1] == "  files: run.nc"
    assert run_cli("demo", "-o", out)[1].splitlines()[-1].startswith(f"written to {out}: demo.png, and a netCDF")
