"""Damaged and crafted files raise an error with advice, never a traceback, a crash or other numbers."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_array

import rattlebox as rb
from rattlebox.cli.commands import run_command
from rattlebox.model.files import read_arrays
from rattlebox.results.snapshots import Snapshots

BEADS = """
duration = "20 ms"
structure = { kind = "sdof", mass = "0.1 kg", stiffness = "10 kN/m", velocity = "0.5 m/s" }
output = { rate = "2 kHz", snapshots = 5 }
[damper]
particles = { name = "beads", material = "glass", diameter = "3 mm", count = 20 }
cavity = { kind = "sphere", diameter = "20 mm" }
contact = { kind = "tsuji", restitution = 0.8 }
softening = 100
"""


IMPACT = """
duration = "50 ms"
structure = { kind = "sdof", mass = "20 kg", stiffness = "80 kN/m", velocity = "0.1 m/s" }
[damper]
ball = { radius = "33 mm", material = "steel" }
gap = "0.4 mm"
contact = { kind = "tsuji", restitution = 0.8 }
"""


def exit_code(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int | str | None:
    """Run the exit_code in this process and return its exit code."""
    monkeypatch.setattr(sys, "argv", ["rattlebox", *arguments])
    with pytest.raises(SystemExit) as stop:
        run_command()
    return stop.value.code or 0


@pytest.fixture(scope="module")
def intact(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with one file of each kind."""
    folder = tmp_path_factory.mktemp("intact")
    case = rb.Case.from_toml(BEADS)
    case.to_file(folder / "case.toml")
    stopped = rb.simulate(
        case, checkpoint=folder / "a.checkpoint", snapshots=folder / "a.vtkhdf", progress=lambda done, total: False
    )
    assert stopped.status == "interrupted"
    run = rb.simulate(case, snapshots=folder / "run.vtkhdf")
    run.save(folder / "run.nc")
    run.to_mat(folder / "run.mat")
    return folder


def read_file(path: Path, folder: Path) -> Any:
    """Read a file as a user does; return its numbers."""
    if path.suffix == ".nc":
        run = rb.load(path)
        return run.arrays.displacement.tobytes(), run.arrays.particles.position.tobytes(), run.notes
    if path.suffix == ".vtkhdf":
        return [(frame.time, frame.position.tobytes(), frame.velocity.tobytes()) for frame in Snapshots(path)]
    if path.suffix == ".mat":
        return {name: array.tobytes() for name, array in read_arrays(path).items()}
    if path.suffix == ".toml":
        return rb.Case.from_file(path)
    (folder / "a.vtkhdf").write_bytes((path.parent.parent / "a.vtkhdf").read_bytes())
    run = rb.simulate(rb.Case.from_toml(BEADS), checkpoint=path, snapshots=folder / "a.vtkhdf")
    return run.arrays.displacement.tobytes(), run.arrays.particles.position.tobytes()


@pytest.mark.parametrize("name", ["run.nc", "run.vtkhdf", "run.mat", "case.toml", "a.checkpoint"])
def test_truncated_files(name: str, intact: Path, tmp_path: Path) -> None:
    """A truncated file of any kind is refused, or has the content of the intact one."""
    folder = tmp_path / "cut"
    folder.mkdir()
    (tmp_path / "a.vtkhdf").write_bytes((intact / "a.vtkhdf").read_bytes())
    content, path = (intact / name).read_bytes(), folder / name
    path.write_bytes(content)
    exact = read_file(path, tmp_path)
    refused = 0
    for length in np.linspace(0, len(content) - 1, 25 if name != "a.checkpoint" else 12).astype(int):
        path.write_bytes(content[:length])
        try:
            result = read_file(path, tmp_path)
        except (ValueError, OSError):  # CaseError is a ValueError
            refused += 1
        else:
            assert name == "case.toml" or result == exact
    assert refused > (5 if name == "case.toml" else 10)


@pytest.mark.parametrize("name", ["a.checkpoint", "run.mat"])
def test_changed_files(name: str, intact: Path, tmp_path: Path) -> None:
    """Files with changed bits and blocks are refused or have the same content; no other error is raised."""
    folder = tmp_path / "changed"
    folder.mkdir()
    (tmp_path / "a.vtkhdf").write_bytes((intact / "a.vtkhdf").read_bytes())
    content, path = (intact / name).read_bytes(), folder / name
    path.write_bytes(content)
    exact = read_file(path, tmp_path)
    generator = np.random.default_rng(3)
    places = [*generator.integers(0, len(content), 20), *generator.integers(len(content) - 2500, len(content), 30)]
    for number, place in enumerate(places):
        changed = bytearray(content)
        if number % 3:
            changed[place] ^= 1 << generator.integers(8)
        else:
            changed[place : place + 40] = bytes(len(changed[place : place + 40]))
        path.write_bytes(changed)
        try:
            result = read_file(path, tmp_path)
        except (ValueError, OSError):
            continue
        assert name == "run.mat" or result == exact  # version 5 of MAT files has no checksums


def test_a_checkpoint_with_changed_numbers_is_refused(intact: Path, tmp_path: Path) -> None:
    """Changed arrays with a valid checksum of the archive are detected by the digest."""
    file = tmp_path / "a.checkpoint"
    with np.load(intact / "a.checkpoint") as there:
        arrays = dict(there)
    for name in ("state", "position.0", "records.q"):
        changed = {**arrays, name: arrays[name].copy()}
        changed[name].ravel()[-1] += 1
        with file.open("wb") as content:
            np.savez(content, **changed)
        with pytest.raises(rb.DataError, match=r"is not an intact checkpoint: .* is damaged\n  try: another file"):
            rb.simulate(rb.Case.from_toml(BEADS), checkpoint=file, snapshots=tmp_path / "a.vtkhdf")


@pytest.mark.parametrize("kind", ['["sweep"]', "{ a = 1 }", "3", "true"])
def test_kinds_of_studies_that_are_not_text(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A list, a table or a number as kind of a study is refused like an unknown kind."""
    (tmp_path / "study.toml").write_text(f'kind = {kind}\n[case]\nfile = "case.toml"\n')
    assert exit_code(monkeypatch, "sweep", str(tmp_path / "study.toml")) == 2
    assert "is not a kind of study" in capsys.readouterr().err


@pytest.mark.parametrize("mark", ["\0", "\n", "\x1b]0;title\x07", "\x1b[31m", "\x9b31m", "\u2028", "\x7f", "\t"])
def test_names_with_control_characters(mark: str) -> None:
    """Control characters are refused in all names of a case."""
    name, ball = f"a{mark}b", {"diameter": "10 mm", "material": "steel"}
    contact = rb.Tsuji(restitution=0.8)
    sdof = {"kind": "sdof", "mass": 1, "stiffness": 1e4, "velocity": 1}
    for make in (
        lambda: rb.ImpactDamper(name=name, ball=ball, gap="1 mm", contact=contact),
        lambda: rb.ImpactDamper(point=name, ball=ball, gap="1 mm", contact=contact),
        lambda: rb.Particles(name=name, material="steel", diameter="4 mm", count=4),
        lambda: rb.Case(name=name, structure=sdof, duration=1),
        lambda: rb.Modal(frequencies=[8.0], damping_ratios=[0.01], shapes={name: [0.5]}),
        lambda: rb.Harmonic(amplitude="1 N", frequency="8 Hz", point=name),
    ):
        with pytest.raises(rb.CaseError, match="contains a control character\n  try: printable characters"):
            make()


def test_control_characters_in_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Control characters in the file of a run are not printed."""
    monkeypatch.setattr("rattlebox.model.base.has_controls", lambda text: False)
    case = rb.Case.from_toml(BEADS.replace('name = "beads"', 'name = "\\u001b]0;PWNED\\u0007\\u001b[31mred"'))
    rb.simulate(case, snapshots=tmp_path / "run.vtkhdf").save(tmp_path / "run.nc")
    monkeypatch.undo()
    exit_code(monkeypatch, "show", str(tmp_path / "run.nc"))
    shown = "".join(capsys.readouterr())
    assert "\x1b" not in shown and "\x07" not in shown


def test_random_mat_files(tmp_path: Path) -> None:
    """MAT files with random bytes are refused; a crash of the reader is an error and does not end the process."""
    code = f"""
import numpy as np
from pathlib import Path
from scipy.io import savemat
import rattlebox as rb
file = Path({str(tmp_path)!r}) / "record.mat"
record = {{"t": np.linspace(0, 1, 50), "a": np.random.default_rng(0).random(50)}}
savemat(file, record | {{"s": {{"b": [1.0, 2.0], "c": "text"}}}})
content, generator, refused = file.read_bytes(), np.random.default_rng(1), 0
for number in range(400):
    changed = bytearray(content)
    for place in generator.integers(0 if number % 4 == 0 else 128, len(content), 1 + number % 12):
        changed[place] = generator.integers(256)
    file.write_bytes(changed[: len(content) - (number % 5 == 0) * int(generator.integers(len(content)))])
    try:
        rb.Record(file=file, unit="N")
    except rb.RattleboxError:
        refused += 1
print(refused)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 100


@pytest.mark.parametrize("options", [{}, {"do_compression": True}, {"format": "4"}], ids=["5", "compressed", "4"])
def test_mat_files_of_all_kinds_are_read(options: dict[str, Any], tmp_path: Path) -> None:
    """Arrays of all types, sparse ones, texts, cells and nested structs are read."""
    content: dict[str, Any] = {
        "t": np.linspace(0, 1, 50),
        "z": np.array([1 + 2j]),
        "M": csc_array(np.diag(np.arange(5.0))),
    }
    if "format" not in options:
        content |= {f"{kind}": np.arange(3, dtype=kind) for kind in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "f4")}
        content |= {"e": np.zeros((0, 3)), "l": np.array([True]), "text": "ünï", "texts": np.array(["ab", "cd"])}
        content |= {"cell": np.array(["x", 1.0, [2, 3]], dtype=object), "s": {"b": [1.0], "deep": {"c": np.ones(2)}}}
    savemat(tmp_path / "a.mat", content, **options)
    result = read_arrays(tmp_path / "a.mat")
    assert np.array_equal(result["t"], content["t"]) and np.array_equal(result["M"], np.diag(np.arange(5.0)))
    assert "format" in options or np.array_equal(result["s.deep.c"], [1, 1])


def test_sparse_matrices_with_indices_out_of_bounds_are_refused(tmp_path: Path) -> None:
    """Sparse matrices with indices out of bounds, which would write out of bounds, are refused."""
    file = tmp_path / "a.mat"
    savemat(file, {"M": csc_array(np.diag(np.arange(1.0, 6.0)))})
    content = file.read_bytes()
    rows = np.arange(5, dtype="<i4").tobytes()
    assert content.count(rows) >= 1
    for wrong in ([0, 1, 2, 3, 5], [0, 1, -2, 3, 4], [0, 1, 2, 3, 10**8]):
        file.write_bytes(content.replace(rows, np.array(wrong, "<i4").tobytes()))
        with pytest.raises(rb.DataError, match="cannot be read as MAT: a sparse matrix has wrong"):
            read_arrays(file)


def test_commands_on_a_study_with_a_damaged_block(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Show reports a damaged block as missing, plot draws the others, and sweep computes it again."""
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(IMPACT)
    Path("study.toml").write_text(
        'measure = ["impact_share"]\ncase = "case.toml"\n[axes]\n"damper.gap" = ["0.3 mm", "0.4 mm", "0.5 mm"]\n'
    )
    assert exit_code(monkeypatch, "sweep", "study.toml") == 0
    exact = rb.open_study("study.zarr").load()
    for change in (lambda chunk: chunk.unlink(), lambda chunk: chunk.write_bytes(chunk.read_bytes()[:-7])):
        for name in ("impact_share", "status"):
            change(next(Path("study.zarr", name, "c").iterdir()))
            capsys.readouterr()
            assert exit_code(monkeypatch, "show", "study.zarr") == 0
            shown = capsys.readouterr().out
            assert "complete" not in shown and "not finished" in shown
            assert exit_code(monkeypatch, "plot", "study.zarr") in (0, 2)
            result = rb.open_study("study.zarr")
            assert not (np.isnan(result.impact_share.values) & (result.status.values == 0)).any()
            assert exit_code(monkeypatch, "sweep", "study.toml") == 0
            assert rb.open_study("study.zarr").load().equals(exact)
