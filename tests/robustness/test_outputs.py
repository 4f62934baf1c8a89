"""Output files are complete or unchanged, after a kill at any time and on a full disk."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.mounts import needs_mounts, with_own_mounts

import rattlebox as rb
from rattlebox._util.atomic_io import atomic_write
from rattlebox._util.owned_folder import MARKER
from rattlebox.model.files import read_arrays

CASE = """
duration = "%s"
structure = { kind = "sdof", mass = "20 kg", stiffness = "80 kN/m", velocity = "0.1 m/s" }
[damper]
ball = { radius = "33 mm", material = "steel" }
gap = "0.4 mm"
contact = { kind = "tsuji", restitution = 0.8 }
"""

# A process that has loaded two runs; for each line of input, a child writes their files until it is killed.
WRITER = """
import os
import sys
from pathlib import Path
import rattlebox as rb
folder = Path(sys.argv[1])
pairs = []
for name in ("first", "second"):
    run = rb.load(folder / f"{name}.nc")
    pairs.append((run, run.plot.motion(), rb.Case.from_toml(run.case_toml)))
for _ in sys.stdin:
    child = os.fork()
    if child:
        print(child, flush=True)
        os.waitpid(child, 0)
        continue
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
    """Return a folder with the files of two runs."""
    folder = tmp_path_factory.mktemp("runs")
    for name, duration in (("first", "0.2 s"), ("second", "0.3 s")):
        run = rb.simulate(rb.Case.from_toml(CASE % duration))
        run.save(folder / f"{name}.nc")
        run.to_csv(folder / name)
    return folder


def check_complete(folder: Path, runs: Path) -> int:
    """Check that each file is complete; return the number of files."""
    files = [path for path in folder.iterdir() if not path.name.startswith(".") and path.name != MARKER]
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


@pytest.mark.slow
def test_killed_while_files_are_written(runs: Path, tmp_path: Path) -> None:
    """After SIGKILL at a random time every CSV, PNG, SVG, netCDF, MAT and TOML file is complete."""
    generator, complete, unfinished = random.Random(1), 0, 0
    for name in ("first", "second"):
        os.link(runs / f"{name}.nc", tmp_path / f"{name}.nc")
    (tmp_path / "out").mkdir()
    command = [sys.executable, "-c", WRITER, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin and process.stdout
        for _ in range(60):  # on a slow machine few files are complete before a kill
            if complete > 20 and unfinished:
                break
            process.stdin.write("\n")
            process.stdin.flush()
            child = int(process.stdout.readline())
            time.sleep(generator.uniform(0.1, 0.7))
            os.kill(child, signal.SIGKILL)
            complete += check_complete(tmp_path / "out", runs)
            unfinished += sum(path.name.startswith(".") for path in (tmp_path / "out").iterdir())
    assert complete > 20 and unfinished > 0  # some kills interrupted a write


@needs_mounts
@pytest.mark.parametrize(
    "size", [pytest.param(64, marks=pytest.mark.slow), 150, pytest.param(260, marks=pytest.mark.slow), 400]
)
def test_full_disk_leaves_complete_files(size: int, tmp_path: Path) -> None:
    """With little space, the command reports a file with advice, and each existing file is complete."""
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
    check_complete(copy, tmp_path)


def test_content_is_flushed_before_the_replacement(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The content is flushed before the file is renamed, and the folder afterwards."""
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
    """The target of a link is replaced, a device is written to, and an earlier file stays if writing fails."""
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


@needs_mounts
def test_full_disk_under_figures(tmp_path: Path) -> None:
    """On a full disk a figure of each format ends with file and advice, and nothing is left.

    No test saw that matplotlib's writer of PDF hides the error: the figures of a run are PNG.
    """
    rb.simulate(rb.reference_case(duration=0.1)).save(tmp_path / "run.nc")
    (tmp_path / "disk").mkdir()
    disk = tmp_path / "disk"
    figures = "for form in png svg pdf; do "
    fill = f"dd if=/dev/zero of={disk}/fill bs=1k count=36 2>/dev/null; "
    command = f"{sys.executable} -m rattlebox.cli plot {tmp_path}/run.nc -o {disk}/a.$form"
    draw = f"{command} || echo ended $?; ls -A {disk}; rm -f {disk}/*; "
    done = with_own_mounts(f"mount -t tmpfs -o size=40k none {disk}; {figures}{fill}{draw}done")
    assert done.stdout.split() == ["ended", "2", "fill"] * 3, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    errors = done.stderr.splitlines()
    assert errors[::2] == [f"error: {disk}/a.{form}: no space is left on the disk" for form in ("png", "svg", "pdf")]
