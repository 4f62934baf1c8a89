"""Tests of the command `python -m reproduction`."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from reproduction.__main__ import main
from reproduction.report import write_report

ENVIRONMENT = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
"""Environment in which the package can be imported from any folder."""
COMMAND = [sys.executable, "-m", "reproduction"]


def test_report_on_chosen_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A report on selected figures creates its folder; without a terminal there is no progress bar."""
    report = tmp_path / "new" / "report"
    arguments = ["-o", str(report), "--only", "2", "--only", "5", "--workers", "1"]
    monkeypatch.setattr(sys, "argv", ["reproduction", *arguments])
    assert main() == 0
    printed, errors = capsys.readouterr()
    assert printed.splitlines() == [
        f"written to {report}: index.html, and each figure as SVG, PNG and CSV with its case files"
    ]
    assert errors == ""
    drawn = {path.name for path in (report / "figures").glob("*.svg")}
    assert drawn == {"figure_02.svg", "figure_05.svg"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--only", "99"), "--only 99: unknown figure; the figures are 1, 8, 2, "),
        (("--workers", "0"), "workers"),
        (("-o", "full"), "contains other files; choose a new folder"),
        (("-o", "full/notes.txt"), "is a file; a report needs a folder"),
        (("-o", "full/notes.txt/report"), "notes.txt"),
    ],
)
def test_bad_input(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str],
    message: str,
) -> None:
    """Bad input ends with exit code 2 and a message of one screen before anything is computed."""
    monkeypatch.chdir(tmp_path)
    Path("full").mkdir()
    Path("full/notes.txt").write_text("mine")
    monkeypatch.setattr(sys, "argv", ["reproduction", *arguments])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    error = capsys.readouterr().err
    assert message in " ".join(error.replace("│", " ").split())
    assert "Traceback" not in error
    assert len(error.splitlines()) < 24
    assert [path.name for path in tmp_path.rglob("*")] == ["full", "notes.txt"]


def test_ctrl_c_stops_at_once(tmp_path: Path) -> None:
    """Ctrl-C ends command and workers with one word; the unfinished report can be replaced."""
    process = subprocess.Popen(
        [*COMMAND, "-o", str(tmp_path), "--only", "2", "--only", "A5", "--workers", "2"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=ENVIRONMENT,
        start_new_session=True,
    )
    until = time.monotonic() + 60
    while not any(tmp_path.glob("figures/*.svg")) and time.monotonic() < until:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert (out, err) == ("", "stopped\n")
    assert "not finished" in (tmp_path / "index.html").read_text()
    write_report(tmp_path, only=["2"])
    assert "not finished" not in (tmp_path / "index.html").read_text()
