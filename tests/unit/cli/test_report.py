"""Tests of `rattlebox report`: runs, studies, unfinished ones, several runs, bad input."""

from __future__ import annotations

from pathlib import Path

import pytest

import rattlebox as rb

from .conftest import RunCli
from .test_show_run import DAMPER, PARTICLES


@pytest.fixture(autouse=True)
def files(run_cli: RunCli) -> None:
    """Write case files and a study file to the current folder."""
    Path("case.toml").write_text(DAMPER, encoding="utf-8")
    Path("particles.toml").write_text(PARTICLES, encoding="utf-8")
    axes = '"damper.gap" = ["1 mm", "2 mm", "3 mm"]'
    Path("study.toml").write_text(
        f'measure = "impacts"\n[case]\nfile = "case.toml"\n[axes]\n{axes}\n', encoding="utf-8"
    )


def test_run_and_study(run_cli: RunCli) -> None:
    """The report of a folder is named after it, states a replacement, and has the name given with -o."""
    assert run_cli("run", "case.toml", "-o", "out", "--no-figures")[0] == 0
    assert run_cli("sweep", "study.toml")[0] == 0
    assert run_cli("report", "out")[:2] == (0, "written: out.html\n")
    assert "replaced" in run_cli("report", "out/")[1]
    assert run_cli("report", "study.zarr")[:2] == (0, "written: study.html\n")
    assert "at most" in Path("study.html").read_text()
    code, printed, errors = run_cli("report", "out/run.nc", "-o", "a.html", "--title", "Mine", "--question", "Why?")
    assert (code, printed, errors) == (0, "written: a.html\n", "")
    assert "<h1>Mine</h1>" in Path("a.html").read_text() and "Why?" in Path("a.html").read_text()


def test_several_runs_are_compared(run_cli: RunCli) -> None:
    """The report of two folders compares their runs; the same folder twice is an error."""
    for out in ("one", "two"):
        assert run_cli("run", "case.toml", "-o", out, "--no-figures")[0] == 0
    assert run_cli("report", "one", "two")[:2] == (0, "written: one.html\n")
    assert "How do the variants “one” and “two”" in Path("one.html").read_text()
    code, _, errors = run_cli("report", "one", "one")
    assert code == 2 and errors.startswith("error: one is given twice\n  try: ")


def test_unfinished_run(run_cli: RunCli) -> None:
    """The report of a folder with a checkpoint only states how far the run came."""
    Path("out").mkdir()
    case = rb.Case.from_file("particles.toml").model_copy(update={"duration": 100.0})
    assert rb.simulate(case, checkpoint="out/run.checkpoint", progress=lambda *_: False).status == "interrupted"
    assert run_cli("report", "out")[0] == 0
    text = Path("out.html").read_text()
    assert "The run is not finished: it has reached" in text and "of 100 s" in text and "glass ball" in text


def test_unfinished_study(run_cli: RunCli) -> None:
    """The report of a study that was stopped is about its finished variants, and states their number."""
    from rattlebox.studies.run.stored import progress_of
    from rattlebox.studies.study_file import read_study

    study = read_study("study.toml")
    assert run_cli("sweep", "study.toml", "-o", "part")[0] == 0
    gaps = len(progress_of("part").blocks)
    chunk = next(Path("part/impacts").rglob("c/*"))
    chunk.unlink()  # a missing block counts as not computed
    assert run_cli("report", "part")[0] == 0
    text = Path("part.html").read_text()
    assert (
        "The study is not finished" in text
        and f"of {study.grid.size if hasattr(study, 'grid') else 3} variants" in text
    )
    assert gaps >= 1


@pytest.mark.parametrize(
    ("argument", "words"),
    [
        ("missing", "missing does not exist"),
        ("case.toml", "case.toml is a case file or a study file, not a result"),
        ("empty", "empty is not a study"),
        ("damaged.nc", "damaged.nc"),
        ("notes.vtkhdf", "notes.vtkhdf is not a run"),
    ],
)
def test_bad_results(argument: str, words: str, run_cli: RunCli) -> None:
    """A path without results, or with damaged ones, is an error with advice, and nothing is written."""
    Path("empty").mkdir()
    Path("damaged.nc").write_bytes(b"\x89HDF\r\n\x1a\n damaged")
    Path("notes.vtkhdf").write_text("mine")
    code, printed, errors = run_cli("report", argument)
    assert (code, printed) == (2, "")
    assert errors.startswith("error: ") and words in errors and "try: " in errors and "Traceback" not in errors
    assert list(Path().glob("*.html")) == []


def test_files_of_others_stay(run_cli: RunCli) -> None:
    """A file that exists and is not a report is not overwritten."""
    assert run_cli("run", "case.toml", "-o", "out", "--no-figures")[0] == 0
    Path("out.html").write_text("mine")
    code, printed, errors = run_cli("report", "out")
    assert (code, printed) == (2, "") and "out.html was not written by Rattlebox" in errors
    assert Path("out.html").read_text() == "mine"
