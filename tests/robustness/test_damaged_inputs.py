"""Damaged files of other programs, for every reader: an error that names the file, never a traceback, and exit code 2.

The readers are all functions `read_...` of the modules below; a reader that no file reaches fails a test.
"""

from __future__ import annotations

import importlib
import io
import math
import pkgutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

import h5py
import nptdms
import numpy as np
import pytest
import scipy.io
from ansys.mapdl.reader import examples
from support.set_58 import set58

import rattlebox as rb
import rattlebox.analysis.measured
import rattlebox.exchange.read
import rattlebox.model.files
import rattlebox.model.modal_files
import rattlebox.model.recorded
import rattlebox.model.records
from rattlebox.analysis import read_frequency_response
from rattlebox.cli.commands import run_command
from rattlebox.model.plausibility import plausibility_notes

UFF = Path(__file__).parents[1] / "data/uff"
MODULES: list[ModuleType] = [
    *(
        importlib.import_module(f"rattlebox.exchange.read.{each.name}")
        for each in pkgutil.iter_modules(rattlebox.exchange.read.__path__)
    ),
    rattlebox.model.files,
    rattlebox.model.modal_files,
    rattlebox.model.recorded,
    rattlebox.model.records,
    rattlebox.analysis.measured,
]
READERS = {
    f"{module.__name__}.{name}": value
    for module in MODULES
    for name, value in vars(module).items()
    if isinstance(value, FunctionType) and name.startswith("read_") and value.__module__ == module.__name__
}

SDOF = '[structure]\nkind = "sdof"\nmass = "1 kg"\nfrequency = "5 Hz"\n'
MODAL = '[structure]\nkind = "modal"\ndamping_ratio = 0.01\n'
MATRICES = '[structure]\nkind = "matrices"\npoints = { tip = 0 }\n'
BEADS = (
    SDOF
    + '[damper]\nparticles = { name = "beads", material = "glass", diameter = "3 mm", count = 2 }\n'
    + 'contact = { kind = "tsuji", restitution = 0.8 }\n'
    + 'cavity = { kind = "sphere", diameter = "20 mm" }\n[damper.packing]\nkind = "positions"\nfile = "FILE"\n'
)
TIMES = 0.01 * np.arange(40)
VALUES = 0.3 * np.sin(7 * TIMES)


def saved(write: Callable[..., None], *arguments: Any, **options: Any) -> bytes:
    """Return the bytes that a function writes to a stream."""
    stream = io.BytesIO()
    write(stream, *arguments, **options)
    return stream.getvalue()


def table(head: str, *columns: Any) -> bytes:
    """Return a CSV file."""
    rows = "".join(",".join(f"{x:.10g}" for x in row) + "\n" for row in zip(*columns, strict=True))
    return f"{head}\n{rows}".encode()


class Sample(NamedTuple):
    """A valid file, the case that reads it ("" for a function), and its properties."""

    name: str
    content: bytes
    case: str = ""
    other: dict[str, bytes] = {}  # noqa: RUF012
    swapped: tuple[bytes, bytes] | None = None  # mark of the byte order, and that of the other order
    counted: bool = True  # whether a cut at the end of a line can be noticed


IN_SURFACE = """
[structure]
kind = "fixed"
[damper]
kind = "particle"
cavity = { kind = "mesh", file = "FILE", unit = "m" }
particles = { material = "steel", diameter = "4 mm", count = 3 }
contact = { kind = "tsuji", restitution = 0.5 }
"""


def stl(size: tuple[float, float, float]) -> bytes:
    """Return the surface of a box as a binary STL file."""
    import trimesh

    return bytes(trimesh.creation.box(size).export(file_type="stl"))


def obj() -> bytes:
    """Return the surface of a box as an OBJ file with two groups."""
    import trimesh

    box = trimesh.creation.box((0.02, 0.02, 0.02))
    rows = [f"f {a} {b} {c}\n" for a, b, c in (box.faces + 1).tolist()]
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in box.vertices.tolist())
    return f"{corners}g floor\n{''.join(rows[:6])}g side\n{''.join(rows[6:])}".encode()


def record(options: str = "") -> str:
    """Return a case with the file as the motion of the base."""
    return SDOF + f'[base]\nkind = "record"\nfile = "FILE"\n{options}'


def mat73(**arrays: Any) -> bytes:
    """Return a MAT file of version 7.3, which is a HDF5 file behind 512 bytes."""
    stream = io.BytesIO()
    with h5py.File(stream, "w", userblock_size=512) as file:
        for name, array in arrays.items():
            file.create_dataset(name, data=np.atleast_2d(array)).attrs["MATLAB_class"] = np.bytes_("double")
    content = stream.getvalue()
    return b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM" + content[128:]


def tdms(**values: Any) -> bytes:
    """Return a TDMS file with one waveform."""
    stream = io.BytesIO()
    properties = {"wf_increment": 0.01, "wf_start_offset": 0.0, "unit_string": "g"}
    channels = [nptdms.ChannelObject("run", name, array, properties) for name, array in values.items()]
    with nptdms.TdmsWriter(stream) as writer:
        writer.write_segment(channels)
    return stream.getvalue()


RANDOM = SDOF + '[base]\nkind = "random"\nfile = "FILE"\nduration = "0.1 s"\n'
K, M = np.array([[3e4, -1e4], [-1e4, 1e4]]), np.diag([2.0, 1.0])
MTX = saved(scipy.io.mmwrite, K, symmetry="general"), saved(scipy.io.mmwrite, M, symmetry="general")
AT2 = (
    "PEER NGA\nQUAKE\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS=   40, DT=   .0100 SEC\n"
    + "".join("".join(f"{v:15.7E}" for v in VALUES[k : k + 5]) + "\n" for k in range(0, 40, 5))
).encode()
COLUMNS = np.column_stack([TIMES, VALUES])
PLACES = "x,y,z\n0.001,0.002,0.003\n-0.004,0.001,0.002\n"

GOOD: dict[str, Sample] = {
    "AT2": Sample("a.at2", AT2, record()),
    "one column": Sample("a.txt", table("acceleration (g)", VALUES), record('dt = "0.01 s"\n'), counted=False),
    "two columns": Sample("a.csv", table("time (s),acceleration (g)", TIMES, VALUES), record(), counted=False),
    "NPY": Sample("a.npy", saved(np.save, COLUMNS), record(), swapped=(b"'<f8'", b"'>f8'")),
    "NPZ record": Sample("a.npz", saved(np.savez, time=TIMES, value=VALUES), record()),
    "MAT record": Sample("a.mat", saved(scipy.io.savemat, {"time": TIMES, "value": VALUES}), record(),
                       swapped=(b"IM", b"MI")),
    "UFF record": Sample("a.uff", (UFF / "time_history_58b.uff").read_bytes(), record(),
                       swapped=(b"58b     1", b"58b     2")),
    "MAT 7.3 record": Sample("a.mat", mat73(time=TIMES, value=VALUES), record()),
    "TDMS": Sample("a.tdms", tdms(plate=VALUES), record()),
    "density": Sample("a.csv", table("f (Hz),S (g^2/Hz)", 20 + 50 * TIMES, 1 + VALUES), RANDOM, counted=False),
    "UFF density": Sample("a.uff", set58(9, 1 + VALUES, "g^2/Hz").encode(), RANDOM),
    "UFF text record": Sample("a.uff", (UFF / "time_history_58.uff").read_bytes(), record()),
    "modal table": Sample("a.csv", table("frequency (Hz),modal mass (kg),tip", [10, 25], [4, 1], [2, -1]),
                        MODAL + 'file = "FILE"\n', counted=False),
    "modal TOML": Sample("a.toml", b'modal_masses = [4, 1]\nfrequencies = ["10 Hz", 25]\n[shapes]\ntip = [2, -1]\n',
                       MODAL + 'file = "FILE"\n'),
    "UFF modes": Sample("a.unv", (UFF / "modes_mm_mN_2414.uff").read_bytes(),
                      MODAL + 'file = "FILE"\npoints = { a = 9581 }\n'),
    "Ansys result": Sample("a.rst", Path(examples.rstfile).read_bytes(), MODAL + 'file = "FILE"\npoints = { a = 100 }\n',
                         swapped=(b"\x64\x00\x00\x00", b"\x00\x00\x00\x64")),
    "Ansys matrices": Sample("a.full", Path(examples.fullfile).read_bytes(),
                           MODAL + 'file = "FILE"\nmode_count = 2\npoints = { a = 100 }\n',
                           swapped=(b"\x64\x00\x00\x00", b"\x00\x00\x00\x64")),
    "Matrix Market": Sample("a.mtx", MTX[0], MATRICES + 'file = { K = "FILE", M = "M.mtx" }\n', {"M.mtx": MTX[1]}),
    "NPZ matrices": Sample("a.npz", saved(np.savez, K=K, M=M), MATRICES + 'file = "FILE"\n'),
    "MAT matrices": Sample("a.mat", saved(scipy.io.savemat, {"K": K, "M": M}), MATRICES + 'file = "FILE"\n',
                         swapped=(b"IM", b"MI")),
    "positions": Sample("a.csv", PLACES.encode(), BEADS, counted=False),
    "surface": Sample("a.stl", stl((0.02, 0.02, 0.02)), IN_SURFACE),
    "groups": Sample("a.obj", obj(), IN_SURFACE.replace('unit = "m"', 'unit = "m", groups = "file"'), counted=False),
    "UFF response function": Sample("a.uff", (UFF / "frf_58.uff").read_bytes()),
    "response function": Sample(
        "a.csv", table("f (Hz),real (m/s^2/N),imag (m/s^2/N)", 1 + TIMES, VALUES, VALUES), counted=False
    ),
}  # fmt: skip
DAMAGED_ELSEWHERE = {
    "rattlebox.exchange.read.nastran_hdf5.read_nastran_hdf5",
    *(f"rattlebox.exchange.read.text_results.read_{name}" for name in ("f06", "punch", "frd", "dat")),
}
"""Readers whose own tests damage their files."""
TEXT = {name: good for name, good in GOOD.items() if good.name[-3:] in ("at2", "txt", "csv", "oml", "mtx")}


def prepare(folder: Path, good: Sample, content: bytes) -> Path:
    """Write a file and the case that reads it; return the path of the file."""
    for name, text in {**good.other, good.name: content}.items():
        (folder / name).write_bytes(text)
    (folder / "case.toml").write_text('duration = "0.5 ms"\n' + good.case.replace("FILE", good.name))
    return folder / good.name


def read_file(folder: Path, good: Sample, content: bytes) -> Any:
    """Read a file as a user does."""
    file = prepare(folder, good, content)
    return rb.Case.from_file(folder / "case.toml") if good.case else read_frequency_response(file)


def check_refused(
    folder: Path, good: Sample, content: bytes, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Check that an error with the name of the file is raised, by the command line with exit code 2."""
    if not good.case:
        with pytest.raises(rb.RattleboxError, match=good.name):
            read_file(folder, good, content)
        return
    prepare(folder, good, content)
    monkeypatch.setattr(sys, "argv", ["rattlebox", "run", str(folder / "case.toml"), "--out", str(folder / "out")])
    with pytest.raises(SystemExit) as stop:
        run_command()
    printed = capsys.readouterr().err
    assert stop.value.code == 2, printed
    assert "Traceback" not in printed and good.name in printed and "try:" in printed


def test_every_reader_has_a_sample(tmp_path: Path) -> None:
    """The valid files can be read, and all readers of the package are tested."""
    codes = {reader.__code__: name for name, reader in READERS.items()}
    reached: set[str] = set()
    before = sys.getprofile()

    def note(frame: Any, event: str, argument: Any) -> None:
        if event == "call" and frame.f_code in codes:
            reached.add(codes[frame.f_code])

    for good in GOOD.values():
        sys.setprofile(note)
        try:
            read_file(tmp_path, good, good.content)
        finally:
            sys.setprofile(before)
    assert reached == set(READERS) - DAMAGED_ELSEWHERE


@pytest.mark.parametrize("name", GOOD)
@pytest.mark.parametrize(
    "damage",
    [
        pytest.param(lambda content: b"", id="empty"),
        pytest.param(lambda content: b" \r\n\n", id="blank"),
        pytest.param(lambda content: bytes(len(content)), id="zeros"),
        pytest.param(lambda content: np.random.default_rng(3).bytes(max(len(content), 5000)), id="garbage"),
        pytest.param(lambda content: b"<html><body>404 not found</body></html>\n" * 200, id="web page"),
    ],
)
def test_other_content(
    tmp_path: Path,
    name: str,
    damage: Callable[[bytes], bytes],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """An empty file and files with other content are refused."""
    check_refused(tmp_path, GOOD[name], damage(GOOD[name].content), monkeypatch, capsys)


def truncated() -> Iterator[Any]:
    """Yield the shares at which each file is truncated; the reader of Ansys files starts a process for each of them."""
    for share in (0.02, 0.3, 0.6, 0.9):
        for name, good in GOOD.items():
            if good.counted:
                slow = "Ansys" in name and share != 0.6
                yield pytest.param(share, name, marks=pytest.mark.slow if slow else (), id=f"{share}-{name}")


@pytest.mark.parametrize(("share", "name"), list(truncated()))
def test_truncated_files(
    tmp_path: Path, name: str, share: float, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file that states its length or has an end mark is refused wherever it is truncated."""
    good = GOOD[name]
    check_refused(tmp_path, good, good.content[: int(share * len(good.content))], monkeypatch, capsys)


@pytest.mark.parametrize("name", [name for name, good in GOOD.items() if not good.counted and b"," in good.content])
def test_truncated_tables(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A table whose last line lacks columns is refused."""
    content = GOOD[name].content
    check_refused(tmp_path, GOOD[name], content[: content.rindex(b",")], monkeypatch, capsys)


@pytest.mark.parametrize("name", TEXT)
def test_other_encoding(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A text file in UTF-16 is refused, unless it is a table of numbers: these have the same values."""
    good = GOOD[name]
    content = good.content.decode().encode("utf-16")
    if name not in ("one column", "two columns", "density", "positions", "response function", "modal table"):
        check_refused(tmp_path, good, content, monkeypatch, capsys)
        return
    same = [read_file(tmp_path, good, text) for text in (good.content, content)]
    if good.case:
        assert same[0] == same[1]
    else:
        assert same[0].equals(same[1])


@pytest.mark.parametrize("name", TEXT)
def test_text_in_place_of_a_number(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A word in place of the last number is refused."""
    content = GOOD[name].content.rstrip(b" ]\n")
    last = max(content.rfind(mark) for mark in (b",", b" ", b"\n"))
    end = b"]\n" if name == "modal TOML" else b"\n"
    check_refused(tmp_path, GOOD[name], content[: last + 1] + b"bad" + end, monkeypatch, capsys)


@pytest.mark.parametrize("name", [name for name, good in GOOD.items() if good.swapped])
def test_contradicting_byte_order(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A binary file whose byte order mark contradicts its content is refused."""
    good = GOOD[name]
    assert good.swapped is not None and good.swapped[0] in good.content
    check_refused(tmp_path, good, good.content.replace(*good.swapped, 1), monkeypatch, capsys)


def without_unit(name: str, factor: float) -> bytes:
    """Return a record with scaled values and without its unit."""
    times, values = TIMES, factor * VALUES
    return {
        "one column": table("acceleration", values),
        "two columns": table("time,acceleration", times, values),
        "NPY": saved(np.save, np.column_stack([times, values])),
        "NPZ record": saved(np.savez, time=times, value=values),
        "MAT record": saved(scipy.io.savemat, {"time": times, "value": values}),
    }[name]


@pytest.mark.parametrize("name", ["one column", "two columns", "NPY", "NPZ record", "MAT record"])
@pytest.mark.parametrize(("factor", "implausible"), [(1.0, False), (1000.0, True), (1e-6, True)])
def test_records_without_unit(tmp_path: Path, name: str, factor: float, implausible: bool) -> None:
    """The assumed unit of a record without unit is noted with the peak; an implausible peak gives a warning."""
    notes = plausibility_notes(read_file(tmp_path, GOOD[name], without_unit(name, factor)))
    peak = f"{factor * np.abs(VALUES).max():.4g} m/s^2"
    assert any(note.startswith("note") and peak in note and "m/s^2 is assumed" in note for note in notes)
    assert any(note.startswith("warning") and peak in note for note in notes) == implausible


@pytest.mark.parametrize(
    ("name", "stated", "none"),
    [("AT2", b" IN UNITS OF G", b""), ("UFF record", b"acc (g)              g   ", b"acc                 NONE ")],
)
def test_empty_unit_fields(tmp_path: Path, name: str, stated: bytes, none: bytes) -> None:
    """Formats with a field for the unit are refused, or their unit is noted, if the field is empty."""
    assert stated in GOOD[name].content
    content = GOOD[name].content.replace(stated, none)
    if name == "AT2":
        with pytest.raises(rb.DataError, match=r'states no unit\n.*try: unit = "g"'):
            read_file(tmp_path, GOOD[name], content)
    else:
        notes = plausibility_notes(read_file(tmp_path, GOOD[name], content))
        assert any("m/s^2 is assumed, with a peak of 1 m/s^2" in note for note in notes)


@pytest.mark.parametrize(("unit", "implausible"), [("g_0", False), ("km/s^2", False), ("Mm/s^2", True)])
def test_an_implausible_peak_in_a_stated_unit(tmp_path: Path, unit: str, implausible: bool) -> None:
    """A record in a wrong unit gives a warning with its peak if no shock has that acceleration."""
    good = GOOD["two columns"]
    notes = plausibility_notes(read_file(tmp_path, good, table(f"time (s),acceleration ({unit})", TIMES, VALUES)))
    assert any(note.startswith("warning") and "peak of" in note for note in notes) == implausible


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("modal table", ("Hz is assumed, up to 25 Hz", "shares of one are assumed, up to 0.02", "kg^-0.5, at tip")),
        ("Ansys result", ("kg is assumed", "kg^-0.5, at a")),
        ("Ansys matrices", ("kg is assumed", "kg^-0.5, at a")),
        ("Matrix Market", ("kg and N/m are assumed", "M up to 2 kg", "K up to 3e+04 N/m", "frequency of 11.25 Hz")),
        ("NPZ matrices", ("kg and N/m are assumed", "M up to 2 kg", "K up to 3e+04 N/m", "frequency of 11.25 Hz")),
        ("MAT matrices", ("kg and N/m are assumed", "M up to 2 kg", "K up to 3e+04 N/m", "frequency of 11.25 Hz")),
        ("positions", ("m is assumed", "up to 0.004 m")),
    ],
)
def test_structures_and_positions_without_unit(tmp_path: Path, name: str, words: tuple[str, ...]) -> None:
    """Every unit that is assumed is noted with the largest value."""
    good = GOOD[name]
    content = good.content
    if name == "modal table":
        content = b"frequency,damping,tip\n10,0.01,2\n25,0.02,-3\n"
        good = good._replace(case=MODAL.replace("damping_ratio = 0.01\n", "") + 'file = "FILE"\n')
    notes = "\n".join(plausibility_notes(read_file(tmp_path, good, content)))
    for word in words:
        assert word in notes, notes


@pytest.mark.parametrize("factor", [1000.0, 1e-3])
def test_mis_scaled_files_show_their_scale(tmp_path: Path, factor: float) -> None:
    """Files in other units than those that are assumed are read, and their notes state values that show it."""
    matrices = GOOD["NPZ matrices"]
    notes = plausibility_notes(read_file(tmp_path, matrices, saved(np.savez, K=factor * K, M=M)))
    assert any(f"frequency of {11.254 * math.sqrt(factor):.4g} Hz" in note for note in notes), notes
    content = table("frequency (Hz),real,imag", 1 + TIMES, factor * VALUES, VALUES)
    with pytest.warns(UserWarning, match=f"largest magnitude is {np.abs(factor * VALUES + 1j * VALUES).max():.4g}"):
        read_file(tmp_path, GOOD["response function"], content)
