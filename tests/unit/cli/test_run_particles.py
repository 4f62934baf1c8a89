"""Tests of `rattlebox run` with particle dampers."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox.cli.main import main

from .conftest import RunCli

CASE = """
name = "beads"
duration = "20 ms"
structure = { kind = "sdof", mass = "0.1 kg", stiffness = "10 kN/m", velocity = "0.5 m/s" }
output = { rate = "5 kHz" }
[damper]
particles = { material = "glass", diameter = "3 mm", fill_ratio = 0.3 }
cavity = { kind = "sphere", diameter = "20 mm" }
contact = { kind = "tsuji", restitution = 0.8 }
friction = 0.2
softening = 100
"""


Run = Callable[..., tuple[int | str | None, str, str]]


@pytest.fixture
def run(tmp_path: Path, run_cli: RunCli) -> Run:
    """Return a function that runs a case file with options and returns exit code, standard output and errors."""

    def run(*options: str, case: str = CASE) -> tuple[int | str | None, str, str]:
        (tmp_path / "case.toml").write_text(case, encoding="utf-8")
        return run_cli("run", tmp_path / "case.toml", "-o", tmp_path / "out", *options)

    return run


def test_particle_case_from_a_file(tmp_path: Path, run: Run) -> None:
    """The summary lists particles, contacts, energies, the time step with its limit, and the speed; files are written."""
    code, printed, error = run("--csv")
    assert code == 0, error
    summary = " ".join(printed.split())
    for text in (
        "particles",
        "mean number of contacts",
        "lost in sliding",
        "lost at walls",
        "energy residual",
        "time step",
    ):
        assert text in summary
    for text in ("particle steps per second", "limited by the contact of glass and glass", "moduli are divided by 100"):
        assert text in summary
    names = {path.name for path in (tmp_path / "out").iterdir()} - {"rattlebox.json"}
    assert {"run.nc", "motion.csv", "energy.csv", "particles.csv", "motion.png", "energy.png"} <= names
    assert rb.load(tmp_path / "out" / "run.nc").ok


def test_bad_input(tmp_path: Path, run: Run) -> None:
    """Too many particles, none, and a wrong time step end with exit code 2 and a message with file and field."""
    particles = 'particles = { material = "glass", diameter = "3 mm", fill_ratio = 0.3 }\n'
    for old, new, field, message in (
        ("fill_ratio = 0.3", "count = 4000", "damper.particles", "do not fit"),
        (particles, "", "damper.particles", "this field is needed"),
        (particles, "particles = []\n", "damper.particles = []", "needs particles"),
        ("softening = 100", 'softening = 100\n[method]\nkind = "dem"\ndt = "1 ms"', "method.dt", "the bound is"),
        ("softening = 100", 'softening = 100\n[method]\nkind = "dem"\ndt = 1e-25', "method.dt", "is too short"),
        (
            "fill_ratio = 0.3 }",
            'fill_ratio = 0.6 }\npacking = { kind = "settled" }',
            "damper.packing",
            "cannot be inserted at random",
        ),
    ):
        code, _, error = run(case=CASE.replace(old, new))
        assert code == 2
        assert f"case.toml: {field}\n" in error
        assert message in error
        assert "Traceback" not in error


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    ("function", "message"),
    [
        ("rattlebox.prepare.settle.settle", "no results were written"),
        ("rattlebox.results.Run.save", "repeat the command to resume from out/run.checkpoint"),
        ("rattlebox.cli.run.write_table", "repeat the command to resume from out/run.checkpoint"),
    ],
)
def test_stop_signals(
    number: int,
    function: str,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Ctrl-C and SIGTERM while particles settle or results are written end with one line on the files that remain."""
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(CASE.replace("0.3 }", '0.3 }\npacking = { kind = "settled" }'), encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["rattlebox", "run", "case.toml", "-o", "out", "--csv"])
    monkeypatch.setattr(function, lambda *_: os.kill(os.getpid(), number))
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 128 + number
    assert capfd.readouterr().err == f"stopped; {message}\n"


def test_failed_run_writes_its_results(tmp_path: Path, run: Run) -> None:
    """An escaped particle ends the command with exit code 1; results are written and the checkpoint remains."""
    fast = CASE.replace("fill_ratio = 0.3", "count = 1").replace(
        "softening = 100",
        'softening = 1e6\nvelocity = ["100 m/s", 0, 0]\n[method]\nkind = "dem"\ncheckpoint_every = "20 us"',
    )
    code, _, error = run(case=fast)
    assert code == 1
    assert error.startswith("escaped: Particle 0, in 'damper', left its cavity at")
    checkpoint = tmp_path / "out" / "run.checkpoint"
    assert f"\n{checkpoint} remains" in error and "--replace" in error
    assert checkpoint.is_file() and rb.load(tmp_path / "out" / "run.nc").status == "escaped"


def test_empty_list_of_snapshots(tmp_path: Path, run: Run) -> None:
    """An empty list of snapshots results in no snapshot file."""
    code, printed, error = run("--no-figures", case=CASE.replace('rate = "5 kHz"', 'rate = "5 kHz", snapshots = []'))
    assert code == 0, error
    assert printed.endswith("run.nc\n")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"rattlebox.json", "run.nc"}


def test_checkpoint_that_collides_with_results(tmp_path: Path, run: Run) -> None:
    """A checkpoint that is a folder or a result file ends with exit code 2 before anything is computed."""
    case = CASE.replace('rate = "5 kHz"', 'rate = "5 kHz", snapshots = 3')
    out = tmp_path / "out"
    for checkpoint, message, suggestion in (
        (tmp_path, f"error: {tmp_path} is a folder", f"{tmp_path}/run.checkpoint"),
        (out / "run.vtkhdf", f"error: --checkpoint {out}/run.vtkhdf: ", f"{out}/run.checkpoint"),
        (out / ".." / "out" / "run.nc", "error: --checkpoint ", f"{out}/run.checkpoint"),
    ):
        code, _, error = run("--checkpoint", str(checkpoint), case=case)
        assert code == 2
        assert error.startswith(message) and error.endswith(f"{suggestion}\n")
        assert "resuming" not in error
        assert not out.exists() or not any(out.iterdir())
