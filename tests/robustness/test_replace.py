"""`rattlebox run --replace` keeps the earlier run until the new one is finished, and never removes foreign files."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from support.command import rattlebox

import rattlebox as rb
from rattlebox._util.owned_folder import MARKER
from rattlebox.cli import folder as folders
from rattlebox.cli.commands import app
from rattlebox.results.snapshots import Snapshots

IMPACT = """
duration = "50 ms"
structure = { kind = "sdof", mass = "20 kg", stiffness = "80 kN/m", velocity = "0.1 m/s" }
[damper]
ball = { radius = "33 mm", material = "steel" }
gap = "0.4 mm"
contact = { kind = "tsuji", restitution = 0.8 }
"""
BEADS = """
duration = "%s"
structure = { kind = "sdof", mass = "0.1 kg", stiffness = "10 kN/m", velocity = "0.5 m/s" }
output = { rate = "2 kHz", snapshots = 5 }
method = { kind = "dem", checkpoint_every = "0.02 s" }
[damper]
particles = { material = "glass", diameter = "3 mm", count = 20 }
cavity = { kind = "sphere", diameter = "20 mm" }
contact = { kind = "tsuji", restitution = 0.8 }
friction = %g
softening = 100
"""


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Write the case files to the current folder."""
    monkeypatch.chdir(tmp_path)
    for name, text in (
        ("impact", IMPACT),
        ("wider", IMPACT.replace("0.4 mm", "0.5 mm")),
        ("first", BEADS % ("0.2 s", 0.2)),
        ("second", BEADS % ("0.2 s", 0.3)),
        ("long", BEADS % ("20 s", 0.3)),
        ("longer", BEADS % ("30 s", 0.4)),
    ):
        Path(f"{name}.toml").write_text(text)


OPTIONS = ("-o", "out", "--no-figures")


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a case into the folder."""
    return rattlebox("run", *arguments, *OPTIONS)


def stop(*arguments: str, by: int, once: Callable[[], object]) -> str:
    """Start the command in another process, send a signal when a condition holds, and return its standard error."""
    command = [sys.executable, "-m", "rattlebox.cli", "run", *arguments, *OPTIONS]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    until = time.monotonic() + 60
    while not once():
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.01)
    process.send_signal(by)
    return process.communicate(timeout=60)[1]


def contents(folder: Path = Path("out")) -> dict[str, bytes]:
    """Return the content of the files in a folder, without subfolders."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def has_changed(file: Path) -> Callable[[], bool]:
    """Return a condition: a file has changed since this call."""
    before = file.read_bytes()
    return lambda: file.read_bytes() != before


def replacement_has_checkpoint() -> bool:
    """Return whether a replacement has a checkpoint."""
    return any(Path("out").glob("replacement-*/run.checkpoint"))


@pytest.mark.parametrize("by", [signal.SIGINT, signal.SIGKILL])
@pytest.mark.slow
def test_finished_run_is_kept_until_the_new_one_is_finished(by: int) -> None:
    """Results and snapshots are unchanged after a stop; the same command resumes and replaces them at the end."""
    assert run("first.toml", "--csv").returncode == 0
    before = contents()
    assert before.keys() == {MARKER, "run.nc", "run.vtkhdf", "motion.csv", "energy.csv", "particles.csv"}
    stop("long.toml", "--replace", by=by, once=replacement_has_checkpoint)
    after = contents()
    assert {name: after[name] for name in before} == before
    assert {*after} - {*before} <= {".run.checkpoint.lock"}
    assert "an unfinished run that replaces this one" in rattlebox("show", "out").stdout
    # The earlier case runs again, and its message mentions the replacement.
    done = run("first.toml")
    assert done.returncode == 0 and "started with --replace" in done.stderr
    message = stop(
        "long.toml", "--replace", by=signal.SIGINT, once=has_changed(next(Path("out").glob("*/run.checkpoint")))
    )
    assert "resuming from out/replacement-" in message
    # A third case replaces the first, and the second stays.
    assert run("second.toml", "--replace").returncode == 0
    assert replacement_has_checkpoint()
    assert contents().keys() == {MARKER, "run.nc", "run.vtkhdf"}
    assert rb.load("out/run.nc") == rb.simulate(rb.Case.from_file("second.toml"), snapshots="other.vtkhdf")
    assert Snapshots("out/run.vtkhdf").numbers == Snapshots("other.vtkhdf").numbers


@pytest.mark.parametrize("by", [signal.SIGINT, pytest.param(signal.SIGKILL, marks=pytest.mark.slow)])
def test_checkpoint_is_kept_until_the_new_run_is_finished(by: int) -> None:
    """An interrupted run resumes after another run has begun to replace it and was interrupted."""
    stop("longer.toml", by=signal.SIGINT, once=Path("out/run.checkpoint").is_file)
    before = contents()
    assert "--replace" in run("long.toml").stderr
    stop("long.toml", "--replace", by=by, once=replacement_has_checkpoint)
    assert {name: text for name, text in contents().items() if "lock" not in name} == before
    assert "resuming from out/run.checkpoint" in stop(
        "longer.toml", by=signal.SIGINT, once=has_changed(Path("out/run.checkpoint"))
    )
    assert run("impact.toml", "--replace").returncode == 0
    assert contents().keys() == {MARKER, "run.nc"}


@pytest.mark.parametrize("after", range(6))
def test_interrupted_exchange(after: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of two runs are exchanged in steps; the next command completes an interrupted exchange."""
    assert run("impact.toml", "--csv").returncode == 0
    steps = 0

    def stopping(step: Callable[..., object]) -> Callable[..., object]:
        def taken(*arguments: object) -> object:
            nonlocal steps
            steps += 1
            if steps > after:
                raise SystemExit(9)
            return step(*arguments)

        return taken

    with monkeypatch.context() as patched:
        for name in ("remove", "sync", "write_marker", "_discard", "_install"):
            patched.setattr(folders, name, stopping(getattr(folders, name)))
        with pytest.raises(SystemExit):
            app(["run", "wider.toml", "-o", "out", "--no-figures", "--mat", "--replace"], standalone_mode=False)
    assert run("wider.toml", "--replace").returncode == 0
    assert rb.load("out/run.nc") == rb.simulate(rb.Case.from_file("wider.toml"))
    assert contents().keys() <= {MARKER, "run.nc", "run.mat"}
    assert not any(Path("out").glob("replacement-*"))


@pytest.mark.parametrize(
    "name", ["motion.csv", "motion.png", "run.mat", "run.vtkhdf", "run.checkpoint", "run.nc", "energy.csv"]
)
def test_foreign_files_are_not_replaced(name: str) -> None:
    """A foreign file with the name of a result is refused before anything is computed."""
    Path("out").mkdir()
    mine = Path("out", name)
    mine.write_text("mine")
    case = "first.toml" if name in ("run.vtkhdf", "run.checkpoint") else "impact.toml"
    for options in ([], ["--replace"]):
        done = rattlebox("run", case, "-o", "out", "--csv", "--mat", *options)
        assert done.returncode == 2 and str(mine) in done.stderr and "\n  try: " in done.stderr
        assert mine.read_text() == "mine"


def test_edited_result_is_not_replaced() -> None:
    """A table that the user has changed is neither overwritten nor removed."""
    assert run("impact.toml", "--csv").returncode == 0
    edited = Path("out/motion.csv")
    edited.write_text(edited.read_text() + "my note\n")
    assert run("impact.toml").returncode == 0
    assert edited.read_text().endswith("my note\n")
    assert run("impact.toml", "--csv").returncode == 2
    assert run("wider.toml", "--replace").returncode == 0
    assert edited.read_text().endswith("my note\n")
    assert contents().keys() == {MARKER, "run.nc", "motion.csv"}


def test_demo_replaces_only_its_own_files() -> None:
    """The demo may use its folder again; a foreign file in it is refused before anything is computed."""
    for _ in range(2):
        assert rattlebox("demo", "-o", "out").returncode == 0
    Path("out/demo.png").write_text("mine")
    done = rattlebox("demo", "-o", "out")
    assert done.returncode == 2 and "out/demo.png was not written by Rattlebox" in done.stderr
    assert Path("out/demo.png").read_text() == "mine"


def test_foreign_files_in_a_replacement_stay() -> None:
    """Foreign files in the folder of a replacement stay there at the end."""
    assert run("first.toml").returncode == 0
    stop("long.toml", "--replace", by=signal.SIGKILL, once=replacement_has_checkpoint)
    Path("long.toml").write_text(BEADS % ("0.2 s", 0.3))
    (folder,) = Path("out").glob("replacement-*")
    (folder / "notes.txt").write_text("mine")
    assert run("second.toml", "--replace").returncode == 0
    assert (folder / "notes.txt").read_text() == "mine" and (folder / "run.checkpoint").is_file()
