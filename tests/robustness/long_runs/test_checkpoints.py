"""Checkpoints and snapshots: interrupted runs resume with the same bits, other files are refused."""

from __future__ import annotations

import errno
import re
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import particle_run
from support.command import rattlebox
from support.ctrl_c import CtrlC
from support.mounts import needs_mounts, with_own_mounts
from support.particle_run import bits, case

import rattlebox as rb
from rattlebox._util.owned_folder import MARKER
from rattlebox.engines.checkpoint import Checkpoint
from rattlebox.engines.dem_run import DemRun
from rattlebox.model.differences import differences
from rattlebox.results.snapshots import SnapshotFile, Snapshots

SCRIPT = Path(particle_run.__file__)
FULL = ((16, "run.vtkhdf"), (64, "run.vtkhdf"), (300, "run.checkpoint"), (500, "run.checkpoint"))
"""Sizes of file systems [kB], and the file that does not fit."""


@pytest.fixture(scope="module")
def uninterrupted() -> Mapping[str, Any]:
    """Return the bits of a run without interruption."""
    return bits(rb.simulate(case(output=rb.Output(rate="2 kHz"))))


def interrupt_at(snapshot: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Raise KeyboardInterrupt before a snapshot is written."""
    append = SnapshotFile.append

    def stopping(self: SnapshotFile, number: int, *state: Any) -> None:
        if number == snapshot:
            raise KeyboardInterrupt
        append(self, number, *state)

    monkeypatch.setattr(SnapshotFile, "append", stopping)


def test_repeatedly_interrupted_run_has_the_same_bits(
    uninterrupted: Mapping[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run that is interrupted while contacts slide, roll and yield resumes with the bits of an uninterrupted one."""
    files = {"checkpoint": tmp_path / "run.checkpoint", "snapshots": tmp_path / "run.vtkhdf"}
    for stop in (1, 4, 5, 9):
        interrupt_at(stop, monkeypatch)
        part = rb.simulate(case(), **files)
        monkeypatch.undo()
        assert part.status == "interrupted"
        assert part.arrays.contacts[-1].sum() > 10
        assert str(files["checkpoint"]) in part.message
        assert len(Snapshots(files["snapshots"])) == stop
    run = rb.simulate(case(method=rb.Dem(threads=2)), **files)
    assert run.ok
    assert bits(run) == uninterrupted


def test_snapshots_of_an_interrupted_run_are_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Snapshots before and after an interruption are those of an uninterrupted run."""
    files = {"checkpoint": tmp_path / "run.checkpoint", "snapshots": tmp_path / "run.vtkhdf"}
    interrupt_at(5, monkeypatch)
    rb.simulate(case(), **files)
    monkeypatch.undo()
    rb.simulate(case(), **files)
    rb.simulate(case(), snapshots=tmp_path / "at_once.vtkhdf")
    assert same_snapshots(files["snapshots"], tmp_path / "at_once.vtkhdf")


def same_snapshots(first: Path, second: Path) -> bool:
    """Return whether all arrays of two files of snapshots are equal bit by bit."""
    pairs = zip(Snapshots(first), Snapshots(second), strict=True)
    return all(np.array_equal(vars(a)[name], vars(b)[name]) for a, b in pairs for name in vars(a))


def test_finished_run_is_read_from_its_checkpoint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A finished run is returned from its checkpoint without preparation or simulation."""
    run = rb.simulate(case(), checkpoint=tmp_path / "run.checkpoint", snapshots=tmp_path / "run.vtkhdf")
    monkeypatch.setattr("rattlebox.prepare.particles.settle", None)
    again = rb.simulate(case(), checkpoint=tmp_path / "run.checkpoint", snapshots=tmp_path / "run.vtkhdf")
    assert bits(again) == bits(run)


def test_killed_run_resumes(tmp_path: Path) -> None:
    """A killed process leaves a checkpoint and snapshots from which the run resumes with the same bits."""
    duration = "0.5 s"
    checkpoint, snapshots = tmp_path / "run.checkpoint", tmp_path / "run.vtkhdf"
    for kill in range(2):
        process = subprocess.Popen([sys.executable, SCRIPT, tmp_path, duration])
        seen: set[int] = set()
        while len(seen) < 2 + kill and process.poll() is None:
            if checkpoint.exists():
                seen.add(checkpoint.stat().st_mtime_ns)
            time.sleep(0.005)
        assert process.poll() is None
        process.kill()
        process.wait()
        Snapshots(snapshots)
    long = case(duration=duration)
    run = rb.simulate(long, checkpoint=checkpoint, snapshots=snapshots)
    assert run.ok
    at_once = rb.simulate(long, snapshots=tmp_path / "at_once.vtkhdf")
    assert bits(run) == bits(at_once)
    assert same_snapshots(snapshots, tmp_path / "at_once.vtkhdf")
    assert {path.name for path in tmp_path.iterdir()} >= {"run.checkpoint", "run.vtkhdf"}


def test_ctrl_c_stops_within_a_fifth_of_a_second(tmp_path: Path) -> None:
    """Ctrl-C ends a run of hours within 0.2 s; state and samples are stored."""
    took = []
    hours = case(duration="1000 s", output=rb.Output(rate="100 Hz"))
    for _ in range(5):  # other programs may delay the signal
        ctrl_c = CtrlC(0.3)
        run = rb.simulate(
            hours, checkpoint=tmp_path / "run.checkpoint", progress=lambda done, total, ctrl_c=ctrl_c: ctrl_c.start()
        )
        took.append(ctrl_c.elapsed())
        assert run.status == "interrupted"
        assert str(tmp_path / "run.checkpoint") in run.message
        if took[-1] < 0.2:
            return
    pytest.fail(f"Ctrl-C took {took}")


def test_checkpoints_at_intervals_of_simulated_time(
    uninterrupted: Mapping[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With an interval of simulated time, checkpoints are written at its multiples, and the bits do not change."""
    times: list[float | None] = []
    write = Checkpoint.write

    def writing(self: Checkpoint, *state: Any) -> None:
        write(self, *state)
        times.append(self.time)

    monkeypatch.setattr(Checkpoint, "write", writing)
    run = rb.simulate(
        case(method=rb.Dem(checkpoint_every="8 ms")),
        checkpoint=tmp_path / "run.checkpoint",
        snapshots=tmp_path / "run.vtkhdf",
    )
    step = run.diagnostics["step"]
    assert times == pytest.approx([*np.arange(7) * 8e-3, 0.05], abs=1.5 * step)
    assert bits(run) == uninterrupted


def test_many_snapshots_do_not_delay_progress_and_checkpoints(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With many snapshots, progress is reported at each and can stop the run; checkpoints follow the wall clock."""
    many = case(output=rb.Output(rate="2 kHz", snapshots=500), method=rb.Dem(checkpoint="1 ms"))
    caught: list[int] = []
    kept: list[float] = []
    write = Checkpoint.write

    def writing(self: Checkpoint, *state: Any) -> None:
        write(self, *state)
        kept.append(self.time or 0.0)

    def progress(done: int, total: int) -> bool:
        caught.append(done)
        return done < total / 2

    monkeypatch.setattr(Checkpoint, "write", writing)
    run = rb.simulate(
        many, checkpoint=tmp_path / "run.checkpoint", snapshots=tmp_path / "run.vtkhdf", progress=progress
    )
    assert run.status == "interrupted"
    assert run.arrays.time[-1] == pytest.approx(0.025, abs=1e-3)
    assert len(caught) >= 250
    assert len(kept) > 3


def test_two_processes_cannot_share_a_checkpoint(tmp_path: Path) -> None:
    """While a process uses a checkpoint, another one is refused with its number; the lock ends with the process."""
    files = {"checkpoint": tmp_path / "run.checkpoint", "snapshots": tmp_path / "run.vtkhdf"}
    with subprocess.Popen([sys.executable, SCRIPT, tmp_path, "50 s"]) as process:
        while not files["checkpoint"].exists():
            assert process.poll() is None
            time.sleep(0.005)
        here = rf"run.checkpoint is in use by process {process.pid} on .*\n  try: another file"
        with pytest.raises(rb.DataError, match=here):
            rb.simulate(case(duration="50 s"), **files)
        process.kill()
    stopped = rb.simulate(case(duration="50 s"), **files, progress=lambda done, total: False)
    assert stopped.status == "interrupted"
    assert {path.name for path in tmp_path.iterdir()} == {"run.checkpoint", "run.vtkhdf"}


def test_unfinished_files_of_a_killed_process_are_removed(tmp_path: Path) -> None:
    """The next run removes the unfinished checkpoint of a killed process; other files stay."""
    file = tmp_path / "run.checkpoint"
    left, other = (
        tmp_path / ".run.checkpoint.ab3_xyz9.partial.checkpoint",
        tmp_path / ".run.2.checkpoint.ab3_xyz9.checkpoint",
    )
    for path in (left, other):
        path.write_bytes(b"half of it")
    assert rb.simulate(case(duration="1 ms"), checkpoint=file, snapshots=tmp_path / "run.vtkhdf").ok
    assert not left.exists() and other.exists()


def test_checkpoint_of_another_run_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A checkpoint of another case, version or core is refused; the message lists the differences, the file stays."""
    file = tmp_path / "run.checkpoint"
    short = case(duration="1 ms", output=rb.Output(rate="2 kHz"))
    rb.simulate(short, checkpoint=file)
    before = file.read_bytes()

    def refused(other: rb.Case) -> str:
        with pytest.raises(rb.DataError) as caught:
            rb.simulate(other, checkpoint=file)
        assert file.read_bytes() == before
        return str(caught.value)

    assert refused(short.model_copy(update={"duration": 0.002})) == (
        f"{file} holds another run\n"
        '  case.duration: "0.001 s" there, "0.002 s" here\n'
        "  try: another file, or remove this one"
    )
    assert "\n  case.dampers: 2 there, 1 here\n" in refused(short.model_copy(update={"dampers": short.dampers[:1]}))
    with monkeypatch.context() as other:
        other.setattr("rattlebox.engines.checkpoint.instructions", lambda: "v9")
        assert "try: RATTLEBOX_SIMD=" in refused(short)
        other.setattr("rattlebox.results.provenance._version", lambda: "9.9")
        assert 'version: "0.' in refused(short)
    assert rb.simulate(short.model_copy(update={"method": rb.Dem(threads=2, checkpoint=60)}), checkpoint=file).ok


def test_changed_input_file_is_another_run(tmp_path: Path) -> None:
    """A case with the same text whose input file has changed is another run."""
    places = tmp_path / "places.csv"
    places.write_text("x, y, z\n0, 0, 0\n")
    damper = {
        "particles": rb.Particles(material="steel", diameter="6 mm"),
        "cavity": rb.Box(size=("30 mm", "30 mm", "30 mm")),
        "contact": rb.Tsuji(restitution=0.5),
    }

    def again() -> None:
        here = rb.ParticleDamper(packing=rb.Positions(file=places), **damper)
        rb.simulate(rb.Case(structure=rb.Fixed(), damper=here, duration="1 ms"), checkpoint=tmp_path / "run.checkpoint")

    again()
    again()
    places.write_text("x, y, z\n0, 0, 0.001\n")
    with pytest.raises(rb.DataError, match="the case files agree but their numbers differ"):
        again()


@pytest.mark.parametrize("content", [b"", b"notes", b"PK\x03\x04 torn"])
def test_other_files_are_refused(content: bytes, tmp_path: Path) -> None:
    """A file that is no checkpoint is refused and stays unchanged."""
    file = tmp_path / "notes.txt"
    file.write_bytes(content)
    with pytest.raises(rb.DataError, match=r"is not an intact checkpoint: .* is damaged\n  try: another file"):
        rb.simulate(case(output=rb.Output(rate="2 kHz")), checkpoint=file)
    assert file.read_bytes() == content


def test_damaged_checkpoint_is_refused(tmp_path: Path) -> None:
    """A flipped bit in a checkpoint is detected, or does not change the run."""
    file = tmp_path / "run.checkpoint"
    short = case(duration="1 ms", output=rb.Output(rate="2 kHz"))
    rb.simulate(short, checkpoint=file)
    content, run = file.read_bytes(), rb.simulate(short)
    generator = np.random.default_rng(1)
    refused = 0
    for place in generator.integers(0, len(content), 50):
        torn = bytearray(content)
        torn[place] ^= 1 << generator.integers(8)
        file.write_bytes(torn)
        try:
            again = rb.simulate(short, checkpoint=file)
        except rb.DataError:
            refused += 1
        else:
            assert bits(again) == bits(run)  # of bytes without meaning
    assert refused > 40


def test_differences_of_long_values_are_shortened() -> None:
    """Of long values that differ at their ends, these ends are listed; of lists of tables, their length or the place."""
    there, here = ({"file": f"kept/by/someone/a/folder/of/many/records/{name}.csv"} for name in ("push", "pull"))
    assert differences(there, here) == [
        '  file: ...ne/a/folder/of/many/records/push.csv" there, ...ne/a/folder/of/many/records/pull.csv" here'
    ]
    assert differences({"a": [{"b": [1, 2]}]}, {"a": [{"b": [1, 3]}]}) == ["  a[0].b[1]: 2 there, 3 here"]
    assert differences({"a": [1, 2]}, {"a": [1]}) == ["  a: [1, 2] there, [1] here"]
    assert differences({"a": [{"b": 1}]}, {"a": [{"b": 1}, {"b": 2}]}) == ["  a: 1 there, 2 here"]


def test_missing_snapshots_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run does not resume without the snapshots that it had written."""
    files = {"checkpoint": tmp_path / "run.checkpoint", "snapshots": tmp_path / "run.vtkhdf"}
    interrupt_at(3, monkeypatch)
    rb.simulate(case(), **files)
    monkeypatch.undo()
    files["snapshots"].unlink()
    with pytest.raises(rb.DataError, match="does not hold the 3 snapshots before the checkpoint\n  try: put"):
        rb.simulate(case(), **files)


def test_damaged_or_foreign_snapshots_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run does not resume with a truncated or foreign file or a folder as snapshots; the message says what it is."""
    files = {"checkpoint": tmp_path / "run.checkpoint", "snapshots": tmp_path / "run.vtkhdf"}
    interrupt_at(3, monkeypatch)
    rb.simulate(case(), **files)
    monkeypatch.undo()
    uninterrupted = files["snapshots"].read_bytes()

    def refused() -> str:
        with pytest.raises(rb.DataError) as caught:
            rb.simulate(case(), **files)
        return str(caught.value)

    for content in (uninterrupted[:5000], b"notes"):
        files["snapshots"].write_bytes(content)
        message = f"{files['snapshots']} is not an intact HDF5 file\n  try: put the file"
        assert refused().startswith(message)
        assert files["snapshots"].read_bytes() == content
    files["snapshots"].unlink()
    files["snapshots"].mkdir()
    assert refused().startswith(f"{files['snapshots']} is a folder; snapshots must be a file\n  try: ")


def test_full_disk_leaves_the_last_checkpoint(
    uninterrupted: Mapping[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If the disk is full during a run, the last checkpoint is intact, and the run resumes from it."""
    files = {"checkpoint": tmp_path / "run.checkpoint", "snapshots": tmp_path / "run.vtkhdf"}
    interrupt_at(5, monkeypatch)
    rb.simulate(case(), **files)
    before = files["checkpoint"].read_bytes()
    monkeypatch.undo()

    def full(file: Any, **arrays: Any) -> None:
        file.write(b"half of it")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(
        OSError, match="no space is left on the disk\n  try: free disk space and give the same"
    ) as caught:
        rb.simulate(case(), **files)
    assert caught.value.filename == str(files["checkpoint"])
    monkeypatch.undo()
    assert files["checkpoint"].read_bytes() == before
    assert {path.name for path in tmp_path.iterdir()} == {"run.checkpoint", "run.vtkhdf"}
    assert bits(rb.simulate(case(), **files)) == uninterrupted


@needs_mounts
@pytest.mark.parametrize(
    ("mount", "name", "message"),
    [
        *(
            pytest.param(
                f"mount -t tmpfs -o size={size}k none {{0}}",
                name,
                "no space is left on the disk",
                marks=pytest.mark.slow if size in (64, 500) else (),
            )
            for size, name in FULL
        ),
        ("mount -t tmpfs -o ro none {0}", "run.checkpoint", "cannot be written: Read-only file system"),
    ],
    ids=[*(f"{size} kB" for size, _ in FULL), "read-only"],
)
def test_full_and_read_only_file_systems(mount: str, name: str, message: str, tmp_path: Path) -> None:
    """A file system that is full or read-only ends the run with that message as the last lines."""
    done = with_own_mounts(f"{mount.format(tmp_path)}; {sys.executable} {SCRIPT} {tmp_path} '20 s'")
    assert done.returncode == 1, done.stderr
    assert "Exception ignored" not in done.stderr
    happened, advice = done.stderr.splitlines()[-2:]
    assert message in happened
    assert str(tmp_path / name) in happened
    assert advice.startswith("  try: ")


@needs_mounts
def test_saving_to_a_full_disk(tmp_path: Path) -> None:
    """Saving a run to a full disk raises one error and leaves no file."""
    rb.simulate(case(output=rb.Output(rate="2 kHz"))).save(tmp_path / "run.nc")
    disk = tmp_path / "disk"
    disk.mkdir()
    code = f"import rattlebox as rb; rb.load('{tmp_path}/run.nc').save('{disk}/run.nc')"
    full = f'mount -t tmpfs -o size=8k none {disk}; {sys.executable} -c "{code}" || echo ended $?; ls -A {disk}'
    done = with_own_mounts(full)
    assert done.stdout == "ended 1\n"
    assert (
        f"{disk}/run.nc: no space is left on the disk\n  try: free disk space and save the run again\n" in done.stderr
    )
    assert "Exception ignored" not in done.stderr


def test_escaped_particle_is_reported(tmp_path: Path) -> None:
    """A particle that leaves its cavity ends the run; the message has its number, time, speed, step and the checkpoint."""
    file = tmp_path / "run.checkpoint"
    fast = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=2),
        cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
        contact=rb.Tsuji(restitution=0.5),
        packing=rb.Positions(positions=[(0, 0, 0), (0, 0.01, 0)], velocities=[(0, 0, 0), (40, 0, 0)]),
        softening=1e6,
    )
    thrown = rb.Case(structure=rb.Fixed(), damper=fast, duration="10 ms")
    run = rb.simulate(thrown, checkpoint=file)
    assert run.status == "escaped"
    where = "Particle 1, in 'damper', left its cavity at "
    assert run.message.startswith(where)
    speed = run.message.removeprefix(where).split()[0]
    assert float(speed) == pytest.approx(40, rel=0.1)
    step = run.diagnostics["step"]
    assert f"{step:.4g} s" in run.message
    assert "t = 0 s" in run.message and file.name in run.message
    time_of_escape = float(run.message.split("at t = ")[1].split()[0])
    assert 0.012 / 40 < time_of_escape < 0.0185 / 40 + 3 * step


def test_particles_are_counted_over_all_dampers() -> None:
    """The number of a particle in a message is its index in `run.particles`, whichever damper contains it."""
    steel = {
        "particles": rb.Particles(material="steel", diameter="6 mm", count=2),
        "contact": rb.Tsuji(restitution=0.5),
    }
    cavity, places = rb.Box(size=("30 mm", "30 mm", "30 mm")), [(0, 0, 0), (0, 0.01, 0)]
    calm, wild = (
        rb.ParticleDamper(
            name=name,
            cavity=cavity,
            packing=rb.Positions(positions=places, velocities=[(0, 0, 0), (speed, 0, 0)]),
            softening=1e6,
            **steel,
        )
        for name, speed in (("calm", 0), ("wild", 40))
    )
    run = rb.simulate(rb.Case(structure=rb.Fixed(), dampers=[calm, wild], duration="10 ms"))
    assert run.message.startswith("Particle 3, in 'wild', left its cavity at 38")
    gone = run.particles.sel(particle=3)
    assert abs(gone.position.values[0]) > 0.012
    assert run.particles.position.values[:3, 0].max() < 1e-3


def test_runs_without_particles_refuse_checkpoints(tmp_path: Path) -> None:
    """Runs without particles refuse checkpoints and snapshots; snapshots need a file."""
    plain = rb.Case(structure=rb.SDOF(mass=1, stiffness=1e4, velocity=1), duration="1 ms")
    with pytest.raises(rb.CaseError, match="are for particle dampers only"):
        rb.simulate(plain, checkpoint=tmp_path / "run.checkpoint")
    with pytest.raises(rb.CaseError, match="snapshots"):
        rb.Case(structure=rb.SDOF(mass=1, stiffness=1e4), duration="1 ms", output=rb.Output(snapshots=5))
    with pytest.raises(rb.CaseError, match=r'no file is given\n  try: snapshots="run\.vtkhdf"'):
        rb.simulate(case())


def test_run_interrupted_before_its_first_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C before the first step leaves one sample and a checkpoint from which the run resumes."""

    def press(*_: object) -> bool:
        raise KeyboardInterrupt

    file, short = tmp_path / "run.checkpoint", case(duration="5 ms", output=rb.Output(rate="2 kHz"))
    with monkeypatch.context() as patch:
        patch.setattr(DemRun, "_run_to_end", press)
        run = rb.simulate(short, checkpoint=file)
    assert run.status == "interrupted"
    assert run.arrays.time.tolist() == [0.0]
    assert bits(rb.simulate(short, checkpoint=file)) == bits(rb.simulate(short))


DISCARDING = """
import os, signal, sys, time, weakref
from rattlebox.cli.commands import app
from rattlebox.cli.main import main

class Key:
    armed = False
    def __hash__(self):
        if Key.armed:
            os.kill(os.getpid(), signal.SIGTERM)
        return 1

class Thing:
    pass

@app.command()
def wait():
    thing, values = Thing(), weakref.WeakValueDictionary()
    values[Key()] = thing
    Key.armed = True
    del thing
    Key.armed = False
    time.sleep(10)

sys.argv = ["rattlebox", "wait"]
main()
"""


def test_sigterm_where_python_discards_exceptions() -> None:
    """SIGTERM in the callback of a weak reference, where Python discards exceptions, stops the command."""
    done = subprocess.run([sys.executable, "-c", DISCARDING], capture_output=True, text=True, check=False)
    assert done.returncode == 128 + signal.SIGTERM, done.stderr


ASKING = """
import os, signal, sys, time
from collections.abc import Mapping
from pydantic import TypeAdapter, ValidationError
from rattlebox.cli.commands import app
from rattlebox.cli.main import main

class Kind:
    @property
    def __class__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        return Kind

@app.command()
def wait():
    try:
        TypeAdapter(dict[str, int]).validate_python(Kind())
    except ValidationError:
        pass
    time.sleep(10)

sys.argv = ["rattlebox", "wait"]
main()
"""


def test_sigterm_while_compiled_code_asks_for_a_type() -> None:
    """SIGTERM while a validator in compiled code asks for the type of an object, which discards it, stops the command.

    One in some hundred signals to a continuation was lost; the tests knew the places in Python's own modules only.
    """
    done = subprocess.run([sys.executable, "-c", ASKING], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (128 + signal.SIGTERM, "stopped\n")


EXECUTING = """
import os, signal
from rattlebox.cli import commands
from rattlebox.cli.main import main

commands.run_command = lambda: exec("os.kill(os.getpid(), signal.SIGTERM)")
main()
"""


def test_sigterm_in_the_execution_of_a_text(tmp_path: Path) -> None:
    """SIGTERM in the exec() of a text, as when dataclasses are defined, has the exit code of SIGTERM, not of Ctrl-C.

    `python -m` then ends by SIGINT whatever the exit code is; signals to commands were sent after all modules were loaded.
    """
    (tmp_path / "early.py").write_text(EXECUTING)
    command = [sys.executable, "-m", "early"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (128 + signal.SIGTERM, "stopped\n")


WITHOUT_ALARM = """
import os, signal, sys
del signal.SIGALRM, signal.setitimer, os.sched_getaffinity, os.posix_fallocate
from rattlebox.cli.main import main
sys.argv = ["rattlebox", "doctor"]
main()
"""


def test_commands_without_an_alarm() -> None:
    """Commands work where Python has no alarm signal, as on Windows; they ended with a traceback, unseen on Linux."""
    done = subprocess.run([sys.executable, "-c", WITHOUT_ALARM], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "rattlebox" in done.stdout, done.stderr


LOADING = """
import os, signal, sys, time
from contextlib import suppress
from rattlebox.cli.commands import app
from rattlebox.cli.main import main

class ExtensionFileLoader:
    def exec_module(self):
        with suppress(BaseException):
            os.kill(os.getpid(), signal.SIGTERM)

@app.command()
def wait():
    ExtensionFileLoader().exec_module()
    time.sleep(10)

sys.argv = ["rattlebox", "wait"]
main()
"""


def test_sigterm_while_a_compiled_module_loads() -> None:
    """SIGTERM while a compiled module is loaded, which may discard exceptions, stops the command afterwards."""
    done = subprocess.run([sys.executable, "-c", LOADING], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (128 + signal.SIGTERM, "stopped\n")


@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.slow), signal.SIGTERM])
def test_command_resumes(number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An interrupted command prints how to resume; repeated, it finishes and removes the checkpoint."""
    case(duration="0.7 s").to_file(tmp_path / "case.toml")
    command = [sys.executable, "-m", "rattlebox.cli", "run", "case.toml", "--no-figures"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "out/run.checkpoint").exists():
        time.sleep(0.01)
    process.send_signal(number)
    message = process.communicate()[1]
    assert process.returncode == 128 + number
    assert "out/run.checkpoint" in message
    monkeypatch.chdir(tmp_path)
    done = rattlebox("run", "case.toml", "--no-figures")
    assert done.returncode == 0, done.stderr
    assert "resuming from out/run.checkpoint" in done.stderr
    assert "written to out: run.vtkhdf, run.nc" in done.stdout
    assert {path.name for path in (tmp_path / "out").iterdir()} == {MARKER, "run.nc", "run.vtkhdf"}
    assert len(Snapshots(tmp_path / "out/run.vtkhdf")) == 11


def test_missing_folders_are_refused(tmp_path: Path) -> None:
    """A checkpoint or snapshots in a missing folder are refused before anything is computed."""
    for name in ("checkpoint", "snapshots"):
        files = {"snapshots": tmp_path / "run.vtkhdf", name: tmp_path / "nowhere" / "file"}
        with pytest.raises(
            rb.DataError, match=r"cannot be written: there is no folder .*nowhere\n  try: another folder"
        ):
            rb.simulate(case(), **files)


def test_invalid_paths_are_refused(tmp_path: Path) -> None:
    """A folder in place of a file, and one file for both, are refused before anything is computed."""
    file = tmp_path / "file"
    for files, message in (
        ({"checkpoint": tmp_path, "snapshots": file}, f"{tmp_path} is a folder; a checkpoint must be a file"),
        ({"checkpoint": file, "snapshots": tmp_path}, f"{tmp_path} is a folder; snapshots must be a file"),
        ({"checkpoint": tmp_path / "." / "file", "snapshots": file}, "both the checkpoint and the snapshots"),
    ):
        with pytest.raises(rb.DataError, match=re.escape(message)):
            rb.simulate(case(), **files)
    assert not any(tmp_path.iterdir())
