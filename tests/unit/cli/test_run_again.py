"""Tests of `rattlebox run` into a folder with earlier results."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox._util.owned_folder import MARKER
from rattlebox.engines.checkpoint import Checkpoint

from .conftest import RunCli

CASE = """
duration = "50 ms"
structure = { kind = "sdof", mass = "20 kg", stiffness = "80 kN/m", velocity = "0.1 m/s" }
[damper]
ball = { radius = "33 mm", material = "steel" }
gap = "0.4 mm"
contact = { kind = "tsuji", restitution = 0.8 }
"""
BEADS = """
duration = "0.5 s"
structure = { kind = "sdof", mass = "0.1 kg", stiffness = "10 kN/m", velocity = "0.5 m/s" }
output = { rate = "2 kHz" }
[damper]
particles = { material = "glass", diameter = "3 mm", count = 20 }
cavity = { kind = "sphere", diameter = "20 mm" }
contact = { kind = "tsuji", restitution = 0.8 }
friction = 0.2
softening = 100
"""


@pytest.fixture(autouse=True)
def files(run_cli: RunCli) -> None:
    """Write the case files to the current folder."""
    for name, text in (
        ("case", CASE),
        ("wider", CASE.replace("0.4 mm", "0.5 mm")),
        ("beads", BEADS),
        ("rougher", BEADS.replace("friction = 0.2", "friction = 0.3")),
    ):
        Path(f"{name}.toml").write_text(text, encoding="utf-8")


def write_checkpoint() -> None:
    """Write the checkpoint of an interrupted run of beads to the default folder."""
    Path("out").mkdir(exist_ok=True)
    beads = rb.Case.from_file("beads.toml")
    assert rb.simulate(beads, checkpoint="out/run.checkpoint", progress=lambda *_: False).status == "interrupted"


def names() -> set[str]:
    """Return the names of all files in the default folder, except the marker."""
    return {path.name for path in Path("out").iterdir()} - {MARKER}


def test_results_of_another_case_are_refused(run_cli: RunCli) -> None:
    """Results of another case are not overwritten; the message lists the fields that differ, and a suggestion."""
    assert run_cli("run", "case.toml", "--no-figures")[0] == 0
    before = Path("out/run.nc").read_bytes()
    code, printed, errors = run_cli("run", "wider.toml", "--mat")
    assert (code, printed) == (2, "")
    problem, difference, suggestion = errors.splitlines()
    assert problem.startswith("error: out/run.nc ") and "--replace" in suggestion
    assert difference == '  case.dampers[0].gap: "0.0004 m" there, "0.0005 m" here'
    assert names() == {"run.nc"} and Path("out/run.nc").read_bytes() == before
    assert run_cli("run", "wider.toml", "--no-figures", "-o", "wider")[0] == 0


def test_the_same_case_is_run_again(run_cli: RunCli) -> None:
    """A case that differs only in units or the number of threads replaces its earlier results."""
    assert run_cli("run", "case.toml", "--no-figures")[0] == 0
    Path("same.toml").write_text(CASE.replace("0.4 mm", "400 um"), encoding="utf-8")
    first = rb.load("out/run.nc")
    assert run_cli("run", "same.toml", "--no-figures")[0] == 0
    assert rb.load("out/run.nc") == first
    for text in (BEADS, BEADS + '[method]\nkind = "dem"\nthreads = 2\n'):
        Path("beads.toml").write_text(text.replace("0.5 s", "5 ms"), encoding="utf-8")
        assert run_cli("run", "beads.toml", "--no-figures", "-o", "beads")[0] == 0


def test_earlier_results_are_replaced(run_cli: RunCli) -> None:
    """--replace removes all files that the command wrote for another case, and nothing else."""
    assert run_cli("run", "case.toml", "--csv", "--mat")[0] == 0
    written = names()
    assert len(written) == 8
    for name in ("notes.txt", "other.nc", "motion.svg", "energy.csv.bak"):
        Path("out", name).write_text("mine")
    Path("out/impacts").mkdir()
    assert run_cli("run", "wider.toml", "--no-figures", "--replace")[0] == 0
    assert names() == {"run.nc", "notes.txt", "other.nc", "motion.svg", "energy.csv.bak", "impacts"}
    assert rb.load("out/run.nc") == rb.simulate(rb.Case.from_file("wider.toml"))


def test_replace_keeps_foreign_files(run_cli: RunCli) -> None:
    """Foreign files stay with --replace; a foreign run.nc ends with exit code 2 with and without it."""
    Path("out").mkdir()
    Path("out/motion.csv").write_text("measured")
    assert run_cli("run", "case.toml", "--no-figures", "--replace")[0] == 0
    assert Path("out/motion.csv").read_text() == "measured"
    Path("out/run.nc").write_text("notes")
    for options in ([], ["--replace"]):
        code, printed, errors = run_cli("run", "case.toml", *options)
        assert (code, printed) == (2, "")
        assert errors.startswith("error: out/run.nc ") and "\n  try: another -o folder" in errors
    assert Path("out/run.nc").read_text() == "notes"


def test_checkpoints_of_another_case_are_refused_and_replaced(run_cli: RunCli) -> None:
    """A checkpoint of another case is not overwritten; the message lists the differences; --replace starts anew."""
    write_checkpoint()
    difference = "\n  case.dampers[0].friction.coefficient: 0.2 there, 0.3 here\n  try: "
    code, printed, errors = run_cli("run", "rougher.toml")
    assert (code, printed) == (2, "")
    assert errors.startswith("error: out/run.checkpoint ") and difference in errors and "--replace" in errors
    errors = run_cli("run", "rougher.toml", "-o", "new", "--checkpoint", "out/run.checkpoint")[2]
    assert difference in errors and "--replace" not in errors
    assert run_cli("run", "rougher.toml", "--no-figures", "--replace")[0] == 0
    assert names() == {"run.nc"}
    direct = rb.simulate(rb.Case.from_file("rougher.toml"))
    assert np.array_equal(rb.load("out/run.nc").arrays.displacement, direct.arrays.displacement)


def test_progress_without_a_terminal(run_cli: RunCli, monkeypatch: pytest.MonkeyPatch) -> None:
    """Progress is printed once a minute on standard error; a shorter run prints nothing."""
    assert run_cli("run", "beads.toml", "--no-figures")[::2] == (0, "")
    monkeypatch.setattr("rattlebox.cli.run._MINUTE", 0.0)
    code, _, errors = run_cli("run", "beads.toml", "--no-figures")
    steps = rb.load("out/run.nc").counts["steps"] - 1
    line = re.compile(rf"([\d,]+) of {steps:,} steps \((\d+)%\), (\d+:\d\d:\d\d) left")
    matches = [line.fullmatch(text) for text in errors.splitlines()]
    assert code == 0 and all(matches)
    done = [int(match[1].replace(",", "")) for match in matches if match]
    assert done and done == sorted(set(done)) and done[-1] <= steps
    assert matches[0] and int(matches[0][2]) == round(100 * done[0] / steps)


def test_resumed_run_prints_its_checkpoint(run_cli: RunCli) -> None:
    """The checkpoint is printed once on standard error, also if only the results were missing."""
    write_checkpoint()
    code, _, errors = run_cli("run", "beads.toml", "--no-figures")
    assert (code, errors) == (0, "resuming from out/run.checkpoint\n")
    rb.simulate(rb.Case.from_file("beads.toml"), checkpoint="out/run.checkpoint")
    code, _, errors = run_cli("run", "beads.toml", "--no-figures")
    assert (code, errors) == (0, "resuming from out/run.checkpoint\n")
    assert run_cli("run", "beads.toml", "--no-figures")[2] == ""


def test_running_run_is_not_replaced(run_cli: RunCli) -> None:
    """While another process uses the folder, --replace removes nothing and prints the number of that process."""
    write_checkpoint()
    with Checkpoint(Path("out/run.checkpoint"), rb.Case.from_file("beads.toml")).lock():
        code, printed, errors = run_cli("run", "rougher.toml", "--replace")
    assert (code, printed) == (2, "")
    assert errors.startswith("error: out/run.checkpoint is in use by process ")
    assert names() == {"run.checkpoint"}


def test_earlier_case_with_a_missing_input_file(run_cli: RunCli) -> None:
    """Results of a case whose input file no longer exists are not overwritten; the differences are listed."""
    Path("push.csv").write_text("0,0\n0.05,1\n")
    load = '[load]\nkind = "record"\nfile = "push.csv"\nunit = "N"\n'
    Path("pushed.toml").write_text(CASE + load, encoding="utf-8")
    assert run_cli("run", "pushed.toml", "--no-figures")[0] == 0
    Path("push.csv").unlink()
    code, _, errors = run_cli("run", "case.toml")
    assert code == 2
    assert errors.startswith("error: out/run.nc ")
    assert "  case.loads: " in errors and "\n  try: " in errors


def test_unfinished_run_is_not_overwritten(run_cli: RunCli) -> None:
    """An impact run and a run with another checkpoint do not overwrite an unfinished run in their folder."""
    write_checkpoint()
    before = Path("out/run.checkpoint").read_bytes()
    for command in (("case.toml",), ("rougher.toml", "--checkpoint", "new.checkpoint")):
        code, printed, errors = run_cli("run", *command, "--no-figures")
        assert (code, printed) == (2, "")
        assert errors.startswith("error: out/run.checkpoint ") and "unfinished" in errors and "--replace" in errors
    with Checkpoint(Path("out/run.checkpoint"), rb.Case.from_file("beads.toml")).lock():
        assert "in use by process" in run_cli("run", "case.toml", "--no-figures", "--replace")[2]
    assert names() == {"run.checkpoint"} and Path("out/run.checkpoint").read_bytes() == before
    assert run_cli("run", "case.toml", "--no-figures", "--replace")[0] == 0
    assert names() == {"run.nc"}


def test_stopped_replacement_resumes(run_cli: RunCli) -> None:
    """A command with --replace resumes from the checkpoint of its case and removes the replaced files at the end."""
    assert run_cli("run", "case.toml", "--csv", "--no-figures")[0] == 0
    write_checkpoint()
    code, _, errors = run_cli("run", "beads.toml", "--no-figures", "--replace")
    assert (code, errors) == (0, "resuming from out/run.checkpoint\n")
    assert names() == {"run.nc"}
    assert rb.load("out/run.nc") == rb.simulate(rb.Case.from_file("beads.toml"))


def test_failed_preparation_replaces_nothing(run_cli: RunCli) -> None:
    """If a case cannot be prepared, --replace leaves the folder unchanged."""
    assert run_cli("run", "case.toml", "--csv", "--no-figures")[0] == 0
    write_checkpoint()
    before = {name: Path("out", name).read_bytes() for name in names()}
    Path("full.toml").write_text(BEADS.replace("count = 20", "count = 2000"), encoding="utf-8")
    code, _, errors = run_cli("run", "full.toml", "--no-figures", "--replace")
    assert code == 2 and "do not fit" in errors
    assert {name: Path("out", name).read_bytes() for name in names()} == before


def test_input_files_are_not_overwritten(run_cli: RunCli) -> None:
    """A case whose input file a result would overwrite ends with exit code 2, with and without --replace."""
    Path("out").mkdir()
    Path("out/motion.csv").write_text("0,0\n0.05,1\n")
    load = '[load]\nkind = "record"\nfile = "out/motion.csv"\nunit = "N"\n'
    Path("own.toml").write_text(CASE + load, encoding="utf-8")
    for options in ([], ["--replace"], ["--csv"]):
        code, printed, errors = run_cli("run", "own.toml", *options)
        assert (code, printed) == (2, "")
        assert errors.startswith("error: out/motion.csv ") and errors.endswith("  try: another -o folder\n")
    assert names() == {"motion.csv"}


def test_all_files_belong_to_one_run(run_cli: RunCli) -> None:
    """If an input file has changed since the first run, its tables and figures are written again."""
    Path("push.csv").write_text("0,0\n0.05,1\n")
    load = '[load]\nkind = "record"\nfile = "push.csv"\nunit = "N"\n'
    Path("pushed.toml").write_text(CASE + load, encoding="utf-8")
    assert run_cli("run", "pushed.toml", "--csv", "--mat")[0] == 0
    before = {name: Path("out", name).read_bytes() for name in names()}
    Path("push.csv").write_text("0,0\n0.05,500\n")
    assert run_cli("run", "pushed.toml", "--no-figures")[0] == 0
    changed = {name for name in names() if Path("out", name).read_bytes() != before[name]}
    assert changed >= {"run.nc", "motion.csv", "energy.csv", "run.mat", "motion.png", "energy.png"}


def test_folder_of_a_study(run_cli: RunCli) -> None:
    """A run does not write to the folder of a study."""
    rb.sweep(rb.Case.from_file("case.toml"), {"damper.gap": [1e-4, 2e-4]}, store="study.zarr", progress=False)
    code, printed, errors = run_cli("run", "case.toml", "-o", "study.zarr", "--replace")
    assert (code, printed) == (2, "")
    assert errors.startswith("error: study.zarr ") and errors.endswith("  try: another -o folder\n")
    assert not Path("study.zarr/run.nc").exists()
