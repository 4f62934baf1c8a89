"""`rattlebox run` with particles in space."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox.cli.main import main

from .conftest import Answer

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
def run(tmp_path: Path, answer: Answer) -> Run:
    """Run a case file with options; return the exit code, the output and the errors."""

    def run(*options: str, case: str = CASE) -> tuple[int | str | None, str, str]:
        (tmp_path / "case.toml").write_text(case, encoding="utf-8")
        return answer("run", tmp_path / "case.toml", "-o", tmp_path / "out", *options)

    return run


def test_a_case_with_particles_runs_from_its_file(tmp_path: Path, run: Run) -> None:
    """The terminal shows particles, contacts, energy, its residual, the step with its limit, and the speed; files exist."""
    code, printed, error = run("--csv")
    assert code == 0, error
    told = " ".join(printed.split())
    for said in (
        "particles",
        "mean number of contacts",
        "lost in sliding",
        "lost at walls",
        "energy residual",
        "time step",
    ):
        assert said in told
    for said in ("particle steps per second", "limited by the contact of glass and glass", "moduli are divided by 100"):
        assert said in told
    names = {path.name for path in (tmp_path / "out").iterdir()} - {"rattlebox.json"}
    assert {"run.nc", "motion.csv", "energy.csv", "particles.csv", "motion.png", "energy.png"} <= names
    assert rb.load(tmp_path / "out" / "run.nc").ok


def test_bad_input_is_told_without_a_traceback(tmp_path: Path, run: Run) -> None:
    """Too many particles, none, and too long or short a step, are told on one screen with file, field, and exit code 2."""
    particles = 'particles = { material = "glass", diameter = "3 mm", fill_ratio = 0.3 }\n'
    for old, new, field, said in (
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
        assert said in error
        assert "Traceback" not in error


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    ("where", "kept"),
    [
        ("rattlebox.prepare.particles.settle", "nothing is kept yet"),
        ("rattlebox.results.Run.save", "the same command goes on from out/run.checkpoint"),
        ("rattlebox.results.Run.to_csv", "the same command goes on from out/run.checkpoint"),
    ],
)
def test_a_stop_is_told_wherever_it_comes(
    number: int,
    where: str,
    kept: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Ctrl-C and SIGTERM while particles settle, or while results are written, are told in one line with what is kept."""
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(CASE.replace("0.3 }", '0.3 }\npacking = { kind = "settled" }'), encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["rattlebox", "run", "case.toml", "-o", "out", "--csv"])
    monkeypatch.setattr(where, lambda *_: os.kill(os.getpid(), number))
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 128 + number
    assert capfd.readouterr().err == f"stopped; {kept}\n"


def test_a_run_that_fails_says_so_beside_its_results(tmp_path: Path, run: Run) -> None:
    """A particle that leaves ends the command with code 1, and errors tell it, and what is kept; results are written."""
    fast = CASE.replace("fill_ratio = 0.3", "count = 1").replace(
        "softening = 100",
        'softening = 1e6\nvelocity = ["100 m/s", 0, 0]\n[method]\nkind = "dem"\ncheckpoint_every = "20 us"',
    )
    code, _, error = run(case=fast)
    assert code == 1
    assert error.startswith("escaped: Particle 0, in 'damper', left its cavity at")
    checkpoint = tmp_path / "out" / "run.checkpoint"
    assert f"{checkpoint} is kept; a case that you have changed needs another -o folder, or --replace\n" in error
    assert checkpoint.is_file() and rb.load(tmp_path / "out" / "run.nc").status == "escaped"


def test_only_snapshots_that_are_asked_for_are_written(tmp_path: Path, run: Run) -> None:
    """With an empty list of snapshots no file of them is written or told."""
    code, printed, error = run("--no-figures", case=CASE.replace('rate = "5 kHz"', 'rate = "5 kHz", snapshots = []'))
    assert code == 0, error
    assert printed.endswith("run.nc\n")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"rattlebox.json", "run.nc"}


def test_files_that_collide_are_refused(tmp_path: Path, run: Run) -> None:
    """A checkpoint that is a folder, or a file that results are written to, is refused before anything is computed."""
    case = CASE.replace('rate = "5 kHz"', 'rate = "5 kHz", snapshots = 3')
    out = tmp_path / "out"
    for checkpoint, said in (
        (
            tmp_path,
            f"error: {tmp_path} is a folder; a checkpoint must be a file\n  try: {tmp_path}/run.checkpoint\n",
        ),
        (
            out / "run.vtkhdf",
            f"error: --checkpoint {out}/run.vtkhdf: results are written there\n  try: {out}/run.checkpoint\n",
        ),
        (out / ".." / "out" / "run.nc", "results are written there"),
    ):
        code, _, error = run("--checkpoint", str(checkpoint), case=case)
        assert code == 2
        assert said in error
        assert "going on" not in error
        assert not out.exists() or not any(out.iterdir())
