"""No writer replaces a file of others: every command with a default name, every Python function that chooses a name.

No test saw that `plot`, `fmu` and `pack` replaced files of others: the protection was tested for one command at a time, and
the test of the default names of `plot` even demanded that "somebody's" file was replaced. Here all writers are in one list.
"""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from support.command import rattlebox

import rattlebox as rb
from rattlebox._util.atomic_io import FileTaken, atomic_write
from rattlebox._util.own_files import may_replace, seal, sealed_kind
from rattlebox.cli import run as command_run

CASE = """
duration = "40 ms"
structure = { kind = "sdof", mass = "7 kg", stiffness = "30 kN/m", velocity = "0.2 m/s" }
[damper]
ball = { radius = "11 mm", material = "steel" }
gap = "0.3 mm"
contact = { kind = "tsuji", restitution = 0.7 }
"""
BEADS = """
duration = "30 ms"
structure = { kind = "sdof", mass = "0.2 kg", stiffness = "10 kN/m", velocity = "0.4 m/s" }
output = { rate = "2 kHz", snapshots = 3 }
[damper]
particles = { material = "glass", diameter = "3 mm", count = 9 }
cavity = { kind = "sphere", diameter = "16 mm" }
contact = { kind = "tsuji", restitution = 0.8 }
softening = 100
"""
STUDY = 'case = "case.toml"\nmeasures = ["rms"]\n[axes]\n"damper.gap" = ["0.2 mm", "0.3 mm", "0.5 mm"]\n'


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run, its folder of results and a study."""
    folder = tmp_path_factory.mktemp("results")
    case = rb.Case.from_toml(CASE)
    rb.simulate(case).save(folder / "run.nc")
    rb.sweep(case, {"damper.gap": ["0.2 mm", "0.5 mm"]}, "rms", store=folder / "study.zarr", progress=False)
    return folder


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Start in a folder with case files."""
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(CASE)
    Path("beads.toml").write_text(BEADS)


def command(*words: object) -> Callable[[Path], str]:
    """Return a writer that runs a command and returns its errors; {} stands for the folder with results."""

    def write(results: Path) -> str:
        done = rattlebox(*(str(word).format(results) for word in words))
        assert done.returncode in (0, 2)
        assert bool(done.stderr) == bool(done.returncode), done.stderr
        return done.stderr

    return write


def function(call: Callable[[Path], object]) -> Callable[[Path], str]:
    """Return a writer that calls a function and returns its error."""

    def write(results: Path) -> str:
        try:
            call(results)
        except rb.RattleboxError as error:
            return str(error)
        return ""

    return write


def beads() -> rb.Case:
    """Return a case of particles."""
    return rb.Case.from_file("beads.toml")


RUN = command("run", "case.toml", "-o", "out", "--csv", "--mat")
WRITERS = {
    "run.nc": (RUN, "out/run.nc"),
    "run.mat": (RUN, "out/run.mat"),
    "run.csv": (RUN, "out/energy.csv"),
    "run.png": (RUN, "out/motion.png"),
    "run of particles": (command("run", "beads.toml", "-o", "out"), "out/run.vtkhdf"),
    "demo.png": (command("demo", "-o", "out"), "out/demo.png"),
    "demo.toml": (command("demo", "-o", "out"), "out/with_the_ball.toml"),
    "plot run": (command("plot", "{}/run.nc"), "run.png"),
    "plot particles": (command("plot", "{}/run.nc", "--kind", "case"), "run.png"),
    "plot study": (command("plot", "{}/study.zarr"), "study.png"),
    "fmu": (command("fmu", "case.toml", "--alone"), "case.fmu"),
    "pack": (command("pack", "case.toml"), "case.bin"),
    "report": (command("report", "{}/run.nc"), "run.html"),
    "named report": (command("report", "{}/run.nc", "-o", "page.html"), "page.html"),
    "run.to_csv": (function(lambda results: rb.load(results / "run.nc").to_csv("tables")), "tables/impacts.csv"),
    "run.report": (function(lambda results: rb.load(results / "run.nc").report("a.html")), "a.html"),
    "run.save, replace=False": (
        function(lambda results: rb.load(results / "run.nc").save("a.nc", replace=False)),
        "a.nc",
    ),
    "snapshots": (function(lambda _: rb.simulate(beads(), snapshots="a.vtkhdf", progress=False)), "a.vtkhdf"),
}
"""Writers that choose a name themselves, or are documented to replace only their own files, with one of their files."""

EVER_NEW = {"run.save, replace=False"}


def text(path: Path) -> None:
    """Write a text."""
    path.write_text("mine")


def empty(path: Path) -> None:
    """Create an empty file."""
    path.touch()


def picture(path: Path) -> None:
    """Write a file of the right kind that another program wrote."""
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(40) + b"IEND\xaeB`\x82")


def folder_there(path: Path) -> None:
    """Create a folder."""
    path.mkdir()


def dangling(path: Path) -> None:
    """Create a link to a file that does not exist."""
    path.symlink_to("nowhere")


def link(path: Path) -> None:
    """Create a link to a file in another place."""
    Path("elsewhere.txt").write_text("mine")
    path.symlink_to(Path("elsewhere.txt").resolve())


def pipe(path: Path) -> None:
    """Create a pipe."""
    os.mkfifo(path)


def state(path: Path) -> tuple[object, ...]:
    """Return what a writer could change of a file."""
    found = path.lstat()
    content = path.read_bytes() if path.is_file() else sorted(path.iterdir()) if path.is_dir() else None
    return found.st_ino, found.st_mode, os.readlink(path) if path.is_symlink() else "", content


@pytest.mark.parametrize(
    "foreign", [text, empty, picture, folder_there, dangling, link, pipe], ids=lambda f: f.__name__
)
@pytest.mark.parametrize("name", WRITERS)
def test_files_of_others_stay(name: str, foreign: Callable[[Path], None], results: Path) -> None:
    """A file, link, folder or pipe of others with the name of an output is refused with its name and advice, and stays."""
    write, target = WRITERS[name]
    path = Path(target)
    path.parent.mkdir(exist_ok=True)
    foreign(path)
    before = state(path)
    message = write(results)
    assert target in message and "\n  try: " in message
    assert state(path) == before


@pytest.mark.parametrize("name", [name for name in WRITERS if name not in EVER_NEW])
def test_own_files_are_replaced_until_they_change(name: str, results: Path) -> None:
    """The same writer again replaces its file; after any change of the file it does not."""
    write, target = WRITERS[name]
    path = Path(target)
    assert write(results) == ""
    assert may_replace(path)
    assert write(results) == ""
    if path.suffix in (".nc", ".vtkhdf", ".bin"):  # recognised by their format; damage is found when they are read
        return
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    assert target in write(results)
    assert path.read_bytes() == content


@pytest.mark.parametrize("name", WRITERS)
def test_file_that_appears_during_the_computation_stays(
    name: str, results: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file that another program creates after the check of the names, before the output is complete, is not lost."""
    write, target = WRITERS[name]
    path = Path(target)
    usual = tempfile.mkstemp

    def create_another_file(suffix: str, prefix: str, place: Path) -> tuple[int, str]:
        if prefix == f".{path.name}." and not os.path.lexists(path):
            path.write_text("mine")
        return usual(suffix, prefix, place)

    with monkeypatch.context() as patched:
        patched.setattr(tempfile, "mkstemp", create_another_file)
        message = write(results)
    assert path.read_text() == "mine"
    assert target in message or path.name in message
    assert not list(path.parent.glob(".*partial*"))
    path.unlink()
    assert write(results) == ""


def test_results_are_written_beside_files_that_appear(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run of hours is not lost because its names were taken meanwhile, not even by results of another run."""
    other = rb.simulate(rb.Case.from_toml(CASE.replace("0.3 mm", "0.9 mm")))
    other.save("other.nc")
    simulate = command_run._simulate

    def put_files(*arguments: Any) -> rb.Run:
        run = simulate(*arguments)
        shutil.copy("other.nc", "out/run.nc")
        for name in ("motion.csv", "energy.png", "run.checkpoint"):
            Path("out", name).write_text("mine")
        return run

    monkeypatch.setattr(command_run, "_simulate", put_files)
    done = rattlebox("run", "case.toml", "-o", "out", "--csv")
    assert done.returncode == 2
    assert "run-2.nc" in done.stderr and "motion-2.csv" in done.stderr and "energy-2.png" in done.stderr
    assert rb.load("out/run.nc") == other
    assert rb.load("out/run-2.nc") == rb.simulate(rb.Case.from_file("case.toml"))
    assert Path("out/motion-2.csv").read_text().startswith("time [s],")
    for name in ("motion.csv", "energy.png", "run.checkpoint"):
        assert Path("out", name).read_text() == "mine"
        assert not may_replace(Path("out", name))


def test_replacement_spares_files_that_appear(monkeypatch: pytest.MonkeyPatch) -> None:
    """`--replace` neither removes nor replaces a file that was put in place of a result during the run."""
    assert rattlebox("run", "case.toml", "-o", "out", "--csv").returncode == 0
    Path("case.toml").write_text(CASE.replace("0.3 mm", "0.6 mm"))
    simulate = command_run._simulate

    def put_files(*arguments: Any) -> rb.Run:
        run = simulate(*arguments)
        Path("out/run.nc").write_text("mine")
        Path("out/motion.csv").write_text("mine")
        return run

    monkeypatch.setattr(command_run, "_simulate", put_files)
    done = rattlebox("run", "case.toml", "-o", "out", "--replace", "--no-figures")
    assert done.returncode == 2 and "out/run.nc" in done.stderr
    assert Path("out/run.nc").read_text() == Path("out/motion.csv").read_text() == "mine"
    (new,) = Path("out").glob("replacement-*/run.nc")
    assert rb.load(new).case == rb.Case.from_file("case.toml")


def test_files_that_the_user_names_are_replaced(results: Path) -> None:
    """A file after -o is replaced, as documented."""
    for words in (
        ("plot", results / "run.nc", "-o", "a.svg"),
        ("plot", results / "study.zarr", "-o", "a.pdf"),
        ("fmu", "case.toml", "-o", "a.fmu"),
        ("pack", "case.toml", "-o", "a.bin"),
        ("schema", "-o", "a.json"),
    ):
        Path(words[-1]).write_text("earlier")
        assert rattlebox(*words).returncode == 0
        assert Path(words[-1]).read_bytes() != b"earlier"


@pytest.mark.parametrize("suffix", [".png", ".html", ".fmu"])
def test_sealed_files_are_valid(suffix: str, results: Path) -> None:
    """The seal is in a place that the format has for comments, and any changed byte before it is noticed."""
    import zipfile

    from PIL import Image

    path = Path(f"a{suffix}")
    if suffix == ".png":
        rb.load(results / "run.nc").plot.motion().savefig(path)
        with Image.open(path) as picture:
            picture.load()
            assert picture.text["Comment"].startswith("Rattlebox figure")
    elif suffix == ".fmu":
        rb.to_fmu(rb.Case.from_file("case.toml"), path, alone=True)
        with zipfile.ZipFile(path) as archive:
            assert archive.testzip() is None
    else:
        path.write_bytes(seal(b"<html></html>", suffix))
    kind = {".png": "figure", ".html": "report", ".fmu": "FMU"}[suffix]
    assert sealed_kind(path) == kind
    content = path.read_bytes()
    for place in range(0, content.rindex(b"Rattlebox"), max(1, len(content) // 50)):
        path.write_bytes(content[:place] + bytes([content[place] ^ 4]) + content[place + 1 :])
        assert sealed_kind(path) != kind
    path.write_bytes(content + b"more" * 100)
    assert sealed_kind(path) != kind


def test_one_of_many_writers_gets_a_name() -> None:
    """Of threads that write a new file with one name at the same time, one succeeds; the others get an error of its own."""

    def write(number: int) -> int | None:
        try:
            with atomic_write("name.txt", replace=False) as temporary:
                temporary.write_text(str(number))
        except FileTaken as error:
            return None if error.errno == errno.EEXIST else -1
        return number

    for _ in range(20):
        with ThreadPoolExecutor(8) as pool:
            winners = [number for number in pool.map(write, range(8)) if number is not None]
        assert [int(Path("name.txt").read_text())] == winners
        Path("name.txt").unlink()
    assert not list(Path().glob(".*"))


def test_file_system_without_links(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a file system has no links, the name is reserved by an empty file; a file that is there stays."""

    def refuse(*_: object) -> None:
        raise OSError(errno.EPERM, "no links")

    monkeypatch.setattr(os, "link", refuse)
    test_one_of_many_writers_gets_a_name()
