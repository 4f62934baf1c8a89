"""Fixtures that run the command in an empty folder."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from rattlebox.cli.main import main

RunCli = Callable[..., tuple[int | str | None, str, str]]


@pytest.fixture
def run_cli(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> RunCli:
    """Return a function that runs the command in an empty folder and returns exit code, standard output and errors."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> tuple[int | str | None, str, str]:
        monkeypatch.setattr(sys, "argv", ["rattlebox", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main()
        return stop.value.code or 0, *capsys.readouterr()

    return run
