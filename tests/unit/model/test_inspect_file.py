"""Previews of files: the numbers that they show, and the lines of TOML and Python that they offer."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
from support.set_58 import set58

import rattlebox as rb

TIMES = 0.02 * np.arange(21)
VALUES = np.round(3.5 * np.sin(7 * TIMES), 4)
MODES = 'frequencies = ["3.5 Hz", "9 Hz"]\n[shapes]\ntip = [0.4, -0.2]\nroot = [0.1, 0.3]\n'


def written(folder: Path) -> dict[str, tuple[str, ...]]:
    """Write files of several kinds; return what the preview of each must contain."""
    pairs = list(zip(TIMES.tolist(), VALUES.tolist(), strict=True))
    numbers = "".join(f"{t:.2f};{a:.4f};{2 * a:.4f}\n" for t, a in pairs)
    (folder / "comma.csv").write_text("t (s);a x (m/s^2);disp (mm)\n" + numbers.replace(".", ","), "latin-1")
    (folder / "bare.txt").write_text("".join(f"{a}\n" for _, a in pairs))
    (folder / "rows.txt").write_text(
        "NPTS= 21, DT= .02 SEC\n" + " ".join(map(str, VALUES[:11])) + "\n" + " ".join(map(str, VALUES[11:]))
    )
    (folder / "force.txt").write_text("# t (s) F (kN)\n" + "".join(f"{t} {a}\n" for t, a in pairs))
    scipy.io.savemat(folder / "two.mat", {"ch_1": np.array(pairs), "ch_2": np.array(pairs)})
    np.save(folder / "table.npy", np.array(pairs))
    np.save(folder / "samples.npy", VALUES)
    at2 = "QUAKE\nSITE\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 21, DT= .0200 SEC\n"
    (folder / "quake.at2").write_text(at2 + "".join(f"{a}\n" for _, a in pairs))
    (folder / "modes.toml").write_text(MODES)
    peak = float(np.abs(VALUES).max())
    return {
        "comma.csv": ("2 channels", "a x (m/s^2): 21 samples every 0.02 s (50 Hz)", f"{peak:.4g} m/s^2", "decimal mark"),
        "bare.txt": ("1 channel", "dt = '0.01 s', since the file states no time", "unit = 'm/s^2'"),
        "rows.txt": ("21 samples every 0.02 s", "unit = 'm/s^2'"),
        "force.txt": (f"peak {1e3 * peak:.4g} N", "[load]"),
        "two.mat": ("2 channels", "ch_1", "ch_2"),
        "table.npy": ("1 channel", "every 0.02 s"),
        "samples.npy": ("21 samples", "dt = '0.01 s'"),
        "quake.at2": (f"= {peak:.4g} g", "every 0.02 s"),
        "modes.toml": ("2 modes: 3.5, 9 Hz", "2 points: ", "damping_ratio = 0.01, since"),
    }  # fmt: skip


NAMES = [
    "comma.csv",
    "bare.txt",
    "rows.txt",
    "force.txt",
    "two.mat",
    "table.npy",
    "samples.npy",
    "quake.at2",
    "modes.toml",
]


@pytest.mark.parametrize("name", NAMES)
def test_a_preview_and_its_lines(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A preview shows channels, sampling, peak and assumptions; its lines of TOML and Python are executed and agree."""
    monkeypatch.chdir(tmp_path)
    expected = written(tmp_path)[name]
    contents = rb.inspect(name)
    for words in expected:
        assert words in str(contents)
    part = eval(contents.python, {"rb": rb})
    ((table, fields),) = tomllib.loads(contents.toml).items()
    kinds: dict[str, Any] = {"record": rb.Record, "modal": rb.Modal}
    assert kinds[fields.pop("kind")](**fields) == part
    assert table == {"m/s^2": "base", "N": "load"}.get(getattr(part, "unit", ""), "structure")


@pytest.mark.parametrize(
    "content", [b"", b"words only\n", b"\x00\x01\x02" * 40, b"t;F\n0,5;1\n0,7;1.5\n0,8;1,5\n0,9;2,5\n"]
)
def test_files_without_numbers(content: bytes, tmp_path: Path) -> None:
    """A file without a channel raises the error of its reader."""
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(rb.DataError, match=r"(?s)a\.csv.*try:"):
        rb.inspect(tmp_path / "a.csv")


def test_a_preview_of_modes_with_many_points(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a file with hundreds of points, the one that moves most in the first mode is in the lines, which can be used.

    No test saw that such a file was refused: all had few points.
    """
    monkeypatch.chdir(tmp_path)
    names = ",".join(f"p{k}" for k in range(30))
    rows = "".join(f"{f},{','.join(str(np.sin(f * k)) for k in range(30))}\n" for f in (0.3, 2.0))
    Path("modes.csv").write_text(f"frequency (Hz),{names}\n{rows}")
    contents = rb.inspect("modes.csv")
    most = np.abs(np.sin(0.3 * np.arange(30))).argmax()
    assert contents.lines[1] == f"1 point: point p{most}" and "one of 30 points" in str(contents)
    assert sum("kg is assumed" in note for note in contents.notes) == 1  # no test saw that the preview left this out
    part = eval(contents.python, {"rb": rb})
    ((_, fields),) = tomllib.loads(contents.toml).items()
    assert fields.pop("kind") == "modal" and rb.Modal(**fields) == part


def test_frequency_responses(tmp_path: Path) -> None:
    """Frequency responses of a universal file are listed, with the line that reads the first; they were refused."""
    pytest.importorskip("pyuff")
    path = tmp_path / "a.uff"
    values = np.array([1.0, 2.5 - 3.0j, 0.25j])
    path.write_text(set58(4, values, "g/N", name="Head", step=4.0) + set58(4, 2 * values, "g/N", name="Foot"))
    content = rb.inspect(path)
    assert content.content == "2 frequency responses" and not content.toml
    assert content.lines[0].startswith("Head: 3 lines from 0 to 8 Hz, largest magnitude 3.905 g/N")
    read = eval(content.python, {"rb": rb})
    assert read.transfer.size == 3 and content.python in str(content) and "case file" not in str(content)


@pytest.mark.parametrize(
    ("name", "content", "advice"),
    [
        ("a.toml", '[structure]\nkind = "sdof"\n', "rattlebox run"),
        ("a.toml", 'kind = "sweep"\ncase = "b.toml"\n', "rattlebox sweep"),
        ("a.nc", "\x89HDF", "rattlebox show"),
        (
            "a.csv",
            "frequency (Hz), real (g/N), imaginary (g/N)\n4, 0.1, 0\n5, 0.2, -3\n6, -0.1, -1\n",
            "read_frequency",
        ),
        ("a.txt", "f (Hz);H (mm/s^2/N);phase (deg)\n4;1;0\n5;2;-30\n6;1;-170\n", "read_frequency"),
    ],
)
def test_files_for_other_functions_are_named(name: str, content: str, advice: str, tmp_path: Path) -> None:
    """Cases, studies, results and tables of frequency responses name what reads them; they were refused as tables."""
    (tmp_path / name).write_text(content, encoding="latin-1")
    with pytest.raises(rb.DataError, match=rf"(?s)try: .*{advice}"):
        rb.inspect(tmp_path / name)


def test_a_surface(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A preview of a surface shows its size and its groups; its lines are executed and agree.

    Surfaces were read as cavities only: of an STL file the preview said that it is not text, and of an OBJ file that it is a
    table of four channels.
    """
    trimesh = pytest.importorskip("trimesh")
    monkeypatch.chdir(tmp_path)
    block = trimesh.creation.box((18, 22, 31))
    block.export("block.stl")
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in block.vertices)
    rows = ["f " + " ".join(str(corner + 1) for corner in face) + "\n" for face in block.faces]
    Path("block.obj").write_text(f"{corners}g part\n{''.join(rows[:5])}g lid\n{''.join(rows[5:])}")
    for name, groups in (("block.stl", None), ("block.obj", "file")):
        contents = rb.inspect(name)
        for words in (
            "12 triangles, 18 x 22 x 31 mm",
            "volume 12.28 cm^3",
            "18 mm",
            "unit = 'mm', since the file states none",
        ):
            assert words in str(contents)
        assert ("groups: lid, part" in str(contents)) == (groups is not None)
        fields = tomllib.loads(contents.toml)["damper"]["cavity"]
        assert fields.pop("kind") == "mesh" and fields.get("groups") == groups
        assert rb.Mesh(**fields) == eval(contents.python, {"rb": rb})
    trimesh.Trimesh(block.vertices, block.faces[1:]).export("open.stl")
    with pytest.raises(rb.DataError, match=r"(?s)open\.stl: the surface is open.*try: a closed surface"):
        rb.inspect("open.stl")
