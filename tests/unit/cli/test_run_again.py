"""`rattlebox run` into a folder that holds results already."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox._util.owned_folder import MARKER
from rattlebox.engines.checkpoint import Checkpoint

Answer = Callable[..., tuple[int | str | None, str, str]]

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
def files(answer: Answer) -> None:
    """Case files in the current folder."""
    for name, text in (
        ("case", CASE),
        ("wider", CASE.replace("0.4 mm", "0.5 mm")),
        ("beads", BEADS),
        ("rougher", BEADS.replace("friction = 0.2", "friction = 0.3")),
    ):
        Path(f"{name}.toml").write_text(text, encoding="utf-8")


def begin() -> None:
    """Leave the checkpoint of a run of beads that was stopped in the default folder."""
    Path("out").mkdir(exist_ok=True)
    beads = rb.Case.from_file("beads.toml")
    assert rb.simulate(beads, checkpoint="out/run.checkpoint", progress=lambda *_: False).status == "interrupted"


def names() -> set[str]:
    """Names of all files in the default folder, without the list of them."""
    return {path.name for path in Path("out").iterdir()} - {MARKER}


def test_results_of_another_case_are_refused(answer: Answer) -> None:
    """Where a folder holds results of another case, the fields that differ are told with what to try; nothing changes."""
    assert answer("run", "case.toml", "--no-figures")[0] == 0
    before = Path("out/run.nc").read_bytes()
    assert answer("run", "wider.toml", "--mat") == (
        2,
        "",
        "error: out/run.nc holds another run\n"
        '  case.dampers[0].gap: "0.0004 m" there, "0.0005 m" here\n'
        "  try: another -o folder, or --replace\n",
    )
    assert names() == {"run.nc"} and Path("out/run.nc").read_bytes() == before
    assert answer("run", "wider.toml", "--no-figures", "-o", "wider")[0] == 0


def test_the_same_case_is_run_again(answer: Answer) -> None:
    """The same case, however its file is written, and on any number of threads, takes the place of its earlier results."""
    assert answer("run", "case.toml", "--no-figures")[0] == 0
    Path("same.toml").write_text(CASE.replace("0.4 mm", "400 um"), encoding="utf-8")
    first = rb.load("out/run.nc")
    assert answer("run", "same.toml", "--no-figures")[0] == 0
    assert rb.load("out/run.nc") == first
    for text in (BEADS, BEADS + '[method]\nkind = "dem"\nthreads = 2\n'):
        Path("beads.toml").write_text(text.replace("0.5 s", "5 ms"), encoding="utf-8")
        assert answer("run", "beads.toml", "--no-figures", "-o", "beads")[0] == 0


def test_earlier_results_are_replaced(answer: Answer) -> None:
    """--replace removes all that the command wrote for another case, and nothing else, before it runs."""
    assert answer("run", "case.toml", "--csv", "--mat")[0] == 0
    written = names()
    assert len(written) == 8
    for name in ("notes.txt", "other.nc", "motion.svg", "energy.csv.bak"):
        Path("out", name).write_text("mine")
    Path("out/impacts").mkdir()
    assert answer("run", "wider.toml", "--no-figures", "--replace")[0] == 0
    assert names() == {"run.nc", "notes.txt", "other.nc", "motion.svg", "energy.csv.bak", "impacts"}
    assert rb.load("out/run.nc") == rb.simulate(rb.Case.from_file("wider.toml"))


def test_replace_leaves_what_is_no_run(answer: Answer) -> None:
    """In a folder without a run --replace removes nothing, and a run.nc of something else is refused with and without it."""
    Path("out").mkdir()
    Path("out/motion.csv").write_text("measured")
    assert answer("run", "case.toml", "--no-figures", "--replace")[0] == 0
    assert Path("out/motion.csv").read_text() == "measured"
    Path("out/run.nc").write_text("notes")
    for options in ([], ["--replace"]):
        assert answer("run", "case.toml", *options) == (
            2,
            "",
            "error: out/run.nc is not an intact netCDF-4 file\n  try: another -o folder, or remove this file\n",
        )
    assert Path("out/run.nc").read_text() == "notes"


def test_checkpoints_of_another_case_are_refused_and_replaced(answer: Answer) -> None:
    """A checkpoint of another case is refused as results are, with another folder to try; --replace begins anew."""
    begin()
    differs = (
        "error: out/run.checkpoint holds another run\n  case.dampers[0].friction.coefficient: 0.2 there, 0.3 here\n"
    )
    advice = "  try: another -o folder, --replace, another file, or remove this one\n"
    assert answer("run", "rougher.toml") == (2, "", differs + advice)
    errors = answer("run", "rougher.toml", "-o", "new", "--checkpoint", "out/run.checkpoint")[2]
    assert errors == differs + advice.replace("--replace, ", "")
    assert answer("run", "rougher.toml", "--no-figures", "--replace")[0] == 0
    assert names() == {"run.nc"}
    at_once = rb.simulate(rb.Case.from_file("rougher.toml"))
    assert np.array_equal(rb.load("out/run.nc").arrays.displacement, at_once.arrays.displacement)


def test_a_run_tells_how_far_it_is_where_there_is_no_terminal(answer: Answer, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once a minute a line where errors go; a run that is done before says nothing."""
    assert answer("run", "beads.toml", "--no-figures")[::2] == (0, "")
    monkeypatch.setattr("rattlebox.cli.run._MINUTE", 0.0)
    code, _, errors = answer("run", "beads.toml", "--no-figures")
    steps = rb.load("out/run.nc").counts["steps"] - 1
    line = re.compile(rf"([\d,]+) of {steps:,} steps \((\d+)%\), (\d+:\d\d:\d\d) left")
    told = [line.fullmatch(text) for text in errors.splitlines()]
    assert code == 0 and all(told)
    done = [int(found[1].replace(",", "")) for found in told if found]
    assert done and done == sorted(set(done)) and done[-1] <= steps
    assert told[0] and int(told[0][2]) == round(100 * done[0] / steps)


def test_a_run_says_where_it_goes_on_from(answer: Answer) -> None:
    """Once, where errors go: also of a run that is over but for its results."""
    begin()
    code, _, errors = answer("run", "beads.toml", "--no-figures")
    assert (code, errors) == (0, "going on from out/run.checkpoint\n")
    rb.simulate(rb.Case.from_file("beads.toml"), checkpoint="out/run.checkpoint")
    code, _, errors = answer("run", "beads.toml", "--no-figures")
    assert (code, errors) == (0, "going on from out/run.checkpoint\n")
    assert answer("run", "beads.toml", "--no-figures")[2] == ""


def test_a_run_in_progress_is_not_replaced(answer: Answer) -> None:
    """While another process keeps its state in the folder, --replace removes nothing and says who it is."""
    begin()
    with Checkpoint(Path("out/run.checkpoint"), rb.Case.from_file("beads.toml")).lock():
        code, told, errors = answer("run", "rougher.toml", "--replace")
    assert (code, told) == (2, "")
    assert errors.startswith("error: out/run.checkpoint is in use by process ")
    assert names() == {"run.checkpoint"}


def test_an_earlier_case_whose_file_is_gone_is_told(answer: Answer) -> None:
    """Results of a case that names a file which is not there any more are refused with what differs, as others are."""
    Path("push.csv").write_text("0,0\n0.05,1\n")
    load = '[load]\nkind = "record"\nfile = "push.csv"\nunit = "N"\n'
    Path("pushed.toml").write_text(CASE + load, encoding="utf-8")
    assert answer("run", "pushed.toml", "--no-figures")[0] == 0
    Path("push.csv").unlink()
    code, _, errors = answer("run", "case.toml")
    assert code == 2
    assert errors.startswith("error: out/run.nc holds another run\n")
    assert "  case.loads: " in errors and errors.endswith("try: another -o folder, or --replace\n")


def test_a_run_that_is_not_over_is_kept_from_others(answer: Answer) -> None:
    """A run of impacts, and one that goes on from elsewhere, are refused in the folder of a run that is not over."""
    begin()
    before = Path("out/run.checkpoint").read_bytes()
    said = "error: out/run.checkpoint is of a run that is not over\n  try: another -o folder, or --replace\n"
    assert answer("run", "case.toml", "--no-figures") == (2, "", said)
    assert answer("run", "rougher.toml", "--no-figures", "--checkpoint", "new.checkpoint") == (2, "", said)
    with Checkpoint(Path("out/run.checkpoint"), rb.Case.from_file("beads.toml")).lock():
        assert "in use by process" in answer("run", "case.toml", "--no-figures", "--replace")[2]
    assert names() == {"run.checkpoint"} and Path("out/run.checkpoint").read_bytes() == before
    assert answer("run", "case.toml", "--no-figures", "--replace")[0] == 0
    assert names() == {"run.nc"}


def test_a_stopped_run_that_replaces_another_goes_on(answer: Answer) -> None:
    """The same command with --replace goes on from the checkpoint of its own case, and what it replaces goes in the end."""
    assert answer("run", "case.toml", "--csv", "--no-figures")[0] == 0
    begin()
    code, _, errors = answer("run", "beads.toml", "--no-figures", "--replace")
    assert (code, errors) == (0, "going on from out/run.checkpoint\n")
    assert names() == {"run.nc"}
    assert rb.load("out/run.nc") == rb.simulate(rb.Case.from_file("beads.toml"))


def test_a_refused_run_replaces_nothing(answer: Answer) -> None:
    """Where a case turns out not to fit once it has begun to be read, --replace leaves the folder as it was."""
    assert answer("run", "case.toml", "--csv", "--no-figures")[0] == 0
    begin()
    before = {name: Path("out", name).read_bytes() for name in names()}
    Path("full.toml").write_text(BEADS.replace("count = 20", "count = 2000"), encoding="utf-8")
    code, _, errors = answer("run", "full.toml", "--no-figures", "--replace")
    assert code == 2 and "do not fit" in errors
    assert {name: Path("out", name).read_bytes() for name in names()} == before


def test_what_a_case_reads_is_not_written_over(answer: Answer) -> None:
    """A case whose record lies where results go is refused, with and without --replace."""
    Path("out").mkdir()
    Path("out/motion.csv").write_text("0,0\n0.05,1\n")
    load = '[load]\nkind = "record"\nfile = "out/motion.csv"\nunit = "N"\n'
    Path("own.toml").write_text(CASE + load, encoding="utf-8")
    said = "error: out/motion.csv is read by the case, and results go there\n  try: another -o folder\n"
    for options in ([], ["--replace"], ["--csv"]):
        assert answer("run", "own.toml", *options) == (2, "", said)
    assert names() == {"motion.csv"}


def test_all_files_of_a_run_are_of_one_run(answer: Answer) -> None:
    """Where a record was changed between two runs of a case, tables and figures that lie there are written anew."""
    Path("push.csv").write_text("0,0\n0.05,1\n")
    load = '[load]\nkind = "record"\nfile = "push.csv"\nunit = "N"\n'
    Path("pushed.toml").write_text(CASE + load, encoding="utf-8")
    assert answer("run", "pushed.toml", "--csv", "--mat")[0] == 0
    before = {name: Path("out", name).read_bytes() for name in names()}
    Path("push.csv").write_text("0,0\n0.05,500\n")
    assert answer("run", "pushed.toml", "--no-figures")[0] == 0
    changed = {name for name in names() if Path("out", name).read_bytes() != before[name]}
    assert changed >= {"run.nc", "motion.csv", "energy.csv", "run.mat", "motion.png", "energy.png"}


def test_a_study_is_no_place_for_a_run(answer: Answer) -> None:
    """The folder of a study is refused."""
    rb.sweep(rb.Case.from_file("case.toml"), {"damper.gap": [1e-4, 2e-4]}, store="study.zarr", progress=False)
    told = answer("run", "case.toml", "-o", "study.zarr", "--replace")
    assert told == (2, "", "error: study.zarr holds a study\n  try: another -o folder\n")
    assert not Path("study.zarr/run.nc").exists()
