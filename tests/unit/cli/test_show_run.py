"""The command show of runs; and what all commands print of names with square brackets."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

import rattlebox as rb

Answer = Callable[..., tuple[int | str | None, str, str]]

ODD = "[red]a[1] :smile:"
"""A name that rich would take for a colour and a picture."""

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
def files(answer: Answer) -> None:
    """Case files and a study file in the current folder."""
    Path("case.toml").write_text(DAMPER, encoding="utf-8")
    Path("particles.toml").write_text(PARTICLES, encoding="utf-8")
    Path("fast.toml").write_text(FAST, encoding="utf-8")
    axes = '"damper.gap" = ["1 mm", "2 mm", "3 mm"]'
    Path("study.toml").write_text(
        f'measure = "impacts"\n[case]\nfile = "case.toml"\n[axes]\n{axes}\n', encoding="utf-8"
    )


def test_a_run_is_shown_from_its_folder_and_its_file(answer: Answer) -> None:
    """Show tells where a run comes from, its numbers and notes as run did, and the files that belong to it."""
    code, told, _ = answer("run", "case.toml", "-o", "out", "--csv", "--no-figures")
    assert code == 0
    summary = told[: told.index("written to")]
    assert "simulated time" in summary and "warning: " in summary
    Path("out/notes.txt").touch()
    for path in ("out", "out/run.nc"):
        code, shown, said = answer("show", path)
        assert (code, said) == (0, "")
        head, rest = shown.split("\n", 1)
        assert re.fullmatch(rf"{path}: run of \d{{4}}-\d\d-\d\d \d\d:\d\d UTC, Rattlebox .*Python .*", head)
        assert rest == f"{summary}  files: run.nc, motion.csv, energy.csv, impacts.csv\n"
    Path("out/run.nc").rename("out/first.nc")
    assert answer("show", "out/first.nc")[1].split("\n", 1)[1] == summary


def test_a_run_that_is_not_over_is_shown(answer: Answer) -> None:
    """Of a folder with a checkpoint alone, show says that the run is not over and how it goes on."""
    Path("out").mkdir()
    case = rb.Case.from_file("particles.toml").model_copy(update={"duration": 100.0})
    assert rb.simulate(case, checkpoint="out/run.checkpoint", progress=lambda *_: False).status == "interrupted"
    told = "out: a run that is not over\n  files: run.checkpoint\n  The command that began it goes on.\n"
    assert answer("show", "out") == (0, told, "")
    told = "error: there is no file out/run.nc: the run is not over\n  try: the command that began it, which goes on\n"
    assert answer("plot", "out") == (2, "", told)


def test_what_a_folder_lacks_is_told(answer: Answer) -> None:
    """Of snapshots alone, of a run in the place of a finished one, and of films of impacts, it is told."""
    case = rb.Case.from_file("particles.toml")
    Path("out").mkdir()
    rb.simulate(case.replaced({"output": rb.Output(snapshots=3)}), snapshots="out/run.vtkhdf")
    draws = "rattlebox plot out/run.vtkhdf"
    told = f"out: files of a run, without its run.nc\n  files: run.vtkhdf\n  {draws} draws it.\n"
    assert answer("show", "out") == (0, told, "")
    assert answer("plot", "out") == (2, "", f"error: there is no file out/run.nc\n  try: {draws}\n")
    rb.simulate(case).save("out/run.nc")
    rb.simulate(case.replaced({"duration": 100.0}), checkpoint="out/run.checkpoint", progress=lambda *_: False)
    shown = answer("show", "out")[1]
    assert shown.endswith("  run.checkpoint: a run that takes its place is not over; its command continues it.\n")
    assert answer("run", "case.toml", "-o", "hit", "--no-figures")[0] == 0
    said = "error: there is no file hit/run.vtkhdf, and this run has no particles in space to show\n"
    assert answer("plot", "hit", "-o", "a.gif") == (2, "", said)


def test_what_is_no_run_is_told(answer: Answer) -> None:
    """Files that are not there or something else, and folders of neither runs nor studies, end with exit code 2."""
    Path("notes.nc").write_text("notes")
    Path("empty").mkdir()
    for path, said in (
        ("nowhere.nc", "nowhere.nc is not there\n  try: the folder that 'rattlebox run -o' or"),
        ("notes.nc", "notes.nc is not an intact netCDF-4 file"),
        ("empty", "empty is not a study"),
        (
            "case.toml",
            "case.toml is a case file or a study file, not a result\n  try: the folder that 'rattlebox run -o' or",
        ),
    ):
        code, told, errors = answer("show", path)
        assert (code, told) == (2, "")
        assert errors.startswith(f"error: {said}")


def test_names_are_printed_as_they_are(answer: Answer) -> None:
    """Square brackets and colons in the names of folders are what they are in all that the commands print."""
    assert answer("run", "case.toml", "-o", ODD, "--no-figures")[1].endswith(f"written to {ODD}: run.nc\n")
    assert answer("show", ODD)[1].startswith(f"{ODD}: run of ")
    assert answer("plot", ODD, "-o", f"{ODD}.png") == (0, f"written: {ODD}.png\n", "")
    assert answer("sweep", "study.toml", "-o", f"{ODD}.zarr")[1].endswith(f"written to {ODD}.zarr\n")
    assert answer("show", f"{ODD}.zarr")[1].startswith(f"{ODD}.zarr: 3 variants")
    assert answer("plot", f"{ODD}.zarr", "-o", f"{ODD}.png") == (0, f"written: {ODD}.png\n", "")
    errors = answer("run", "fast.toml", "-o", f"{ODD}/fast", "--no-figures")[2]
    assert "in run.checkpoint." in errors
    assert f"\n{ODD}/fast/run.checkpoint is kept" in errors
    assert answer("demo", "-o", f"{ODD}/demo")[1].endswith(
        f"written to {ODD}/demo: demo.png, and a netCDF and a case file of each model\n"
    )


def test_no_path_is_broken_at_the_edge_of_a_terminal(answer: Answer, monkeypatch: pytest.MonkeyPatch) -> None:
    """However narrow the terminal is, a line with a path stays one line, which can be copied."""
    monkeypatch.setenv("COLUMNS", "40")
    out = "a folder with a name/that is longer than/the terminal is wide"
    lines = answer("run", "case.toml", "-o", out, "--no-figures")[1].splitlines()
    assert lines[-1] == f"written to {out}: run.nc"
    lines = answer("show", out)[1].splitlines()
    assert lines[0].startswith(f"{out}: run of ") and lines[-1] == "  files: run.nc"
    assert answer("demo", "-o", out)[1].splitlines()[-1].startswith(f"written to {out}: demo.png, and a netCDF")
