"""Output files of all kinds: complete or as they were, after a kill at any moment and on a full disk."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox._util.atomic_io import atomic_write
from rattlebox.model.files import read_arrays

from .mounts import needs_mounts, with_own_mounts

CASE = """
duration = "%s"
structure = { kind = "sdof", mass = "20 kg", stiffness = "80 kN/m", velocity = "0.1 m/s" }
[damper]
ball = { radius = "33 mm", material = "steel" }
gap = "0.4 mm"
contact = { kind = "tsuji", restitution = 0.8 }
"""

WRITER = """
import sys
from pathlib import Path
import rattlebox as rb
folder = Path(sys.argv[1])
pairs = []
for name in ("first", "second"):
    run = rb.load(folder / f"{name}.nc")
    pairs.append((run, run.plot.motion(), rb.Case.from_toml(run.case_toml)))
(folder / "ready").write_text("")
while True:
    for run, figure, case in pairs:
        run.to_csv(folder / "out")
        figure.savefig(folder / "out" / "motion.png")
        figure.savefig(folder / "out" / "motion.svg")
        run.save(folder / "out" / "run.nc")
        run.to_mat(folder / "out" / "run.mat")
        case.to_file(folder / "out" / "case.toml")
"""


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two runs."""
    folder = tmp_path_factory.mktemp("runs")
    for name, duration in (("first", "0.2 s"), ("second", "0.3 s")):
        run = rb.simulate(rb.Case.from_toml(CASE % duration))
        run.save(folder / f"{name}.nc")
        run.to_csv(folder / name)
    return folder


def check_whole(folder: Path, runs: Path) -> int:
    """Check that each file is one that was written, from first to last byte; return how many there are."""
    files = [path for path in folder.iterdir() if not path.name.startswith(".")]
    for path in files:
        if path.suffix == ".csv":
            assert path.read_bytes() in [(runs / name / path.name).read_bytes() for name in ("first", "second")]
        elif path.suffix == ".nc":
            assert rb.load(path) in [rb.load(runs / f"{name}.nc") for name in ("first", "second")]
        elif path.suffix == ".mat":
            assert "motion.displacement" in read_arrays(path)
        elif path.suffix == ".png":
            assert path.read_bytes().endswith(b"IEND\xaeB`\x82")
        elif path.suffix == ".svg":
            assert path.read_text().endswith("</svg>\n")
        else:
            assert rb.Case.from_file(path).duration in (0.2, 0.3)
    return len(files)


def test_killed_while_files_are_written(runs: Path, tmp_path: Path) -> None:
    """After kill -9 at a random moment every file is whole, CSV, PNG, SVG, netCDF, MAT and TOML."""
    chance, seen, left = random.Random(1), 0, 0
    for name in ("first", "second"):
        os.link(runs / f"{name}.nc", tmp_path / f"{name}.nc")
    (tmp_path / "out").mkdir()
    for _ in range(6):
        (tmp_path / "ready").unlink(missing_ok=True)
        process = subprocess.Popen([sys.executable, "-c", WRITER, str(tmp_path)])
        until = time.monotonic() + 60
        while not (tmp_path / "ready").exists():
            assert process.poll() is None and time.monotonic() < until
            time.sleep(0.01)
        time.sleep(chance.uniform(0.1, 1.0))
        process.send_signal(signal.SIGKILL)
        process.wait()
        seen += check_whole(tmp_path / "out", runs)
        left += sum(path.name.startswith(".") for path in (tmp_path / "out").iterdir())
    assert seen > 20 and left > 0  # some kills fell into a write


@needs_mounts
@pytest.mark.parametrize("size", [64, 150, 260, 400])
def test_a_full_disk_leaves_no_half_file(size: int, tmp_path: Path) -> None:
    """However much room there is, a run on a full disk names a file and an advice, and each file there is whole."""
    (tmp_path / "case.toml").write_text(CASE % "0.2 s")
    run = rb.simulate(rb.Case.from_file(tmp_path / "case.toml"))
    run.save(tmp_path / "first.nc")
    run.save(tmp_path / "second.nc")
    for name in ("first", "second"):
        run.to_csv(tmp_path / name)
    disk, copy = tmp_path / "disk", tmp_path / "copy"
    disk.mkdir()
    command = f"{sys.executable} -m rattlebox.cli run {tmp_path}/case.toml -o {disk}/out --csv --mat"
    mount = f"mount -t tmpfs -o size={size}k none {disk}"
    script = f"{mount}; {command} || echo ended $?; cp -r {disk}/out {copy}"
    done = with_own_mounts(script)
    assert "ended 2" in done.stdout, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    errors = done.stderr.splitlines()
    assert errors[-2].startswith(f"error: {disk}/out/") and errors[-2].endswith("no space is left on the disk")
    assert errors[-1].startswith("  try: ")
    (copy / "rattlebox.json").unlink(missing_ok=True)
    assert not any(path.name.startswith(".") for path in copy.iterdir())
    check_whole(copy, tmp_path)


def test_a_file_is_on_the_disk_before_an_earlier_one_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The content is flushed before the name changes, and the folder after it."""
    happened: list[str] = []
    flush, rename = os.fsync, Path.replace
    monkeypatch.setattr(
        os,
        "fsync",
        lambda handle: (happened.append(os.path.basename(os.readlink(f"/proc/self/fd/{handle}"))), flush(handle))[1],
    )
    monkeypatch.setattr(Path, "replace", lambda self, target: (happened.append("rename"), rename(self, target))[1])
    with atomic_write(tmp_path / "a.csv") as name:
        name.write_text("1, 2")
    assert happened == [name.name, "rename", tmp_path.name]


def test_links_and_devices(tmp_path: Path) -> None:
    """A link stays one and its file is replaced; a device is written to; an earlier file stays where writing fails."""
    target, link = tmp_path / "target.toml", tmp_path / "link.toml"
    target.write_text("earlier")
    link.symlink_to(target)
    case = rb.Case.from_toml(CASE % "1 s")
    case.to_file(link)
    assert link.is_symlink() and rb.Case.from_file(target) == case
    case.to_file("/dev/null")
    with pytest.raises(ZeroDivisionError), atomic_write(target):
        raise ZeroDivisionError
    assert rb.Case.from_file(target) == case
    assert {path.name for path in tmp_path.iterdir()} == {"target.toml", "link.toml"}
