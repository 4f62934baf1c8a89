"""Stores: content, refused folders, damage and full disks."""

from __future__ import annotations

import errno
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from support import logistic_study
from support.datasets import bits
from support.logistic_study import Grid, Logistic, LogisticEngine
from support.mounts import needs_mounts, with_own_mounts

import rattlebox as rb
from rattlebox._util.owned_folder import MARKER, read_marker, write_marker
from rattlebox.cli.show import show_study
from rattlebox.studies.run.runner import run_work
from rattlebox.studies.run.stored import open_study, progress_of
from rattlebox.studies.work.work import Work

SCRIPT = Path(logistic_study.__file__)


def study(store: Path | None = None, task: Logistic | None = None, **options: Any) -> xr.Dataset:
    """Run the logistic study."""
    task = task or Logistic()
    return run_work(task, store=store, block=7, progress=False, **options)


def test_store_equals_result_in_memory(tmp_path: Path) -> None:
    """A store has the bits, coordinates, dimensions and attributes of a result in memory, for any block size."""
    here = study()
    there = study(tmp_path / "maps" / "study.zarr")
    assert bits(here) == bits(there)
    xr.testing.assert_equal(here, there.load())
    assert here.sizes == {"gap": 6, "material": 10, "step": 3}
    assert here.attrs | {"created": ""} == there.attrs | {"created": ""}
    assert there.gap.attrs["units"] == "m"
    assert there.value.attrs == {"units": "J", "long_name": "value"}
    larger = run_work(Logistic(), store=tmp_path / "larger.zarr", block=23)
    assert bits(larger) == bits(here)
    chosen = run_work(Logistic(), store=tmp_path / "chosen.zarr")
    assert bits(chosen) == bits(here)


def test_a_store_is_plain_zarr(tmp_path: Path) -> None:
    """Xarray opens a store without a warning, with coordinates, texts and attributes."""
    study(tmp_path / "study.zarr")
    data = xr.open_zarr(tmp_path / "study.zarr", chunks=None)
    assert list(data.material.values) == [f"m{i}" for i in range(10)]
    assert data.attrs["version"] == rb.__version__
    assert "amplitude" in data.attrs["case"]
    xr.testing.assert_identical(data, open_study(tmp_path / "study.zarr"))


def test_missing_variants_are_nan(tmp_path: Path) -> None:
    """A study that fails keeps its finished variants and their number; the other ones are NaN."""

    def fail(done: int, total: int) -> None:
        if done >= 20:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        run_work(Logistic(), store=tmp_path / "study.zarr", block=7, progress=fail)
    how_far = progress_of(tmp_path / "study.zarr")
    assert (how_far.done, how_far.total) == (20, 60)
    data = open_study(tmp_path / "study.zarr")
    assert np.isfinite(data.value.values).sum() == 20
    assert (data.status.values == -128).sum() == 40
    assert bits(study(tmp_path / "study.zarr")) == bits(study())


def test_finished_study_computes_nothing(tmp_path: Path) -> None:
    """A finished study is returned without computing, and progress reports all variants."""
    study(tmp_path / "study.zarr")
    seen: list[int] = []
    task = Logistic(fail=True)
    again = run_work(task, store=tmp_path / "study.zarr", progress=lambda done, total: seen.append(done))
    assert bits(again) == bits(study())
    assert seen == [60]


def test_store_of_another_study_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A store of another case, design, version or core is refused; the message lists the differences."""
    store = tmp_path / "study.zarr"
    before = bits(study(store))
    other = Logistic(case="[damper]\ngap = 0.2\n[load]\namplitude = 5.0\nkind = 'harmonic'\n")
    with pytest.raises(rb.StoreError) as caught:
        study(store, other)
    assert str(caught.value) == (
        f"{store} holds another study\n"
        "  case.damper.gap: 0.1 there, 0.2 here\n"
        '  case.load.kind: nothing there, "harmonic" here\n'
        "  try: another folder, or remove this one"
    )
    with pytest.raises(rb.StoreError, match=r"design\.first: 3\.6 there, 3\.5 here"):
        study(store, Logistic(Grid(first=3.5)))
    with pytest.raises(rb.StoreError, match=r"design\.shape\[1\]: 10 there, 11 here\n  try"):
        study(store, Logistic(Grid(shape=(6, 11))))
    monkeypatch.setattr(rb, "__version__", "9.9")
    with pytest.raises(rb.StoreError, match=r'version: "[0-9.]+" there, "9\.9" here'):
        study(store)
    monkeypatch.undo()
    monkeypatch.setattr("rattlebox.studies.run.runner._core", lambda: "v9")
    with pytest.raises(rb.StoreError, match="try: RATTLEBOX_SIMD="):
        study(store)
    assert bits(open_study(store)) == before


def test_many_differences_fit_one_screen(tmp_path: Path) -> None:
    """The first of many differences are listed, and the others are counted."""
    store = tmp_path / "study.zarr"
    study(store)
    with pytest.raises(rb.StoreError, match="and 12 more\n"):
        study(store, Logistic(case="\n".join(f"a{i:02} = {i}" for i in range(18))))


def test_other_files_and_folders_are_refused(tmp_path: Path) -> None:
    """A file, or a folder with foreign files, is refused and stays unchanged."""
    (tmp_path / "notes.txt").write_text("foreign")
    with pytest.raises(rb.StoreError, match="is a file; "):
        study(tmp_path / "notes.txt")
    with pytest.raises(rb.StoreError, match="holds other files"):
        study(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
    for reader in (open_study, progress_of):
        with pytest.raises(rb.StoreError, match="is not a study"):
            reader(tmp_path)
        with pytest.raises(rb.StoreError, match="does not exist"):
            reader(tmp_path / "nowhere")


def test_a_later_format_is_refused(tmp_path: Path) -> None:
    """A store of a later format is neither read nor written."""
    store = tmp_path / "study.zarr"
    study(store)
    marker = read_marker(store)
    assert marker
    write_marker(store, replace(marker, about={**marker.about, "format": 3}))
    for use in (study, open_study, progress_of):
        with pytest.raises(rb.StoreError, match="later version of Rattlebox"):
            use(store)


def test_incomplete_store_is_created_again(tmp_path: Path) -> None:
    """A store that was killed during its creation is created anew, also by another study."""
    for again in (Logistic(), Logistic(Grid(shape=(4, 10)))):
        store = tmp_path / f"{again.grid.shape[0]}.zarr"
        study(store)
        marker = read_marker(store)
        assert marker
        write_marker(store, replace(marker, complete=False, files=dict.fromkeys(marker.files, "")))
        (store / "value" / "zarr.json").unlink()
        for name in ("value", "status", "orbit"):
            shutil.rmtree(store / name / "c")
        assert bits(study(store, again)) == bits(study(task=again))


def test_full_disk_leaves_the_stored_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the disk is full during a study, the stored blocks are intact, and the study resumes."""
    from zarr.storage import _local

    put, written = _local._put, 0

    def fill(path: Path, value: Any, exclusive: bool = False) -> int:
        nonlocal written
        written += 1
        if written > 10:
            raise OSError(errno.ENOSPC, "No space left on device")
        return put(path, value, exclusive)

    monkeypatch.setattr(_local, "_put", fill)
    with pytest.raises(OSError, match="no space is left") as caught:
        study(tmp_path / "study.zarr")
    assert caught.value.filename == str(tmp_path / "study.zarr")
    monkeypatch.undo()
    assert 0 < progress_of(tmp_path / "study.zarr").done < 60
    assert bits(study(tmp_path / "study.zarr")) == bits(study())


@needs_mounts
@pytest.mark.parametrize(
    ("mount", "message"),
    [
        ("mount -t tmpfs -o size=112k none {0}", "no space is left on the disk"),
        ("mount -t tmpfs -o ro none {0}", "the study cannot be written: Read-only file system"),
    ],
    ids=["full", "read-only"],
)
def test_full_and_read_only_file_systems(mount: str, message: str, tmp_path: Path) -> None:
    """A file system that is full or read-only ends the study with that message."""
    script = f"{mount.format(tmp_path)}; {sys.executable} {SCRIPT} {tmp_path}/study.zarr 0"
    done = with_own_mounts(script)
    assert f"{message}\n  try: " in done.stderr.splitlines()[-2] + "\n" + done.stderr.splitlines()[-1] + "\n"


@pytest.mark.parametrize("name", ["n" * 300, "file/study.zarr", "/proc/study.zarr"])
def test_folders_that_cannot_be_made(name: str, tmp_path: Path) -> None:
    """A name that no file system takes ends with the reason; only full and read-only disks were tested, others "damaged"."""
    (tmp_path / "file").touch()
    with pytest.raises(rb.StoreError, match=r"the study cannot be written: .*\n  try: another folder"):
        study(tmp_path / name)


def test_error_of_the_task_is_raised(tmp_path: Path) -> None:
    """An error of the task is raised unchanged, and the store can still be used."""
    with pytest.raises(ZeroDivisionError, match="an error of the task"):
        study(tmp_path / "study.zarr", Logistic(fail=True))
    assert bits(study(tmp_path / "study.zarr")) == bits(study())


@pytest.mark.parametrize("name", ["zarr.json", "value/zarr.json", "gap/zarr.json", "gap/c/0", "material/c/0"])
@pytest.mark.parametrize("how", ["cut", "changed", "emptied", "removed"])
def test_damaged_metadata_is_reported_and_repaired(name: str, how: str, tmp_path: Path) -> None:
    """Damaged metadata or axes are reported on reading; the command that started the study repairs them."""
    store = tmp_path / "study.zarr"
    before = bits(study(store))
    damage(store / name, how)
    for use in (open_study, show_study):
        with pytest.raises(rb.StoreError, match=f"{name} is missing or has changed\n  try: the command that started"):
            use(store)
    again = run_work(Logistic(fail=True), store=store, progress=False)  # which computes nothing
    assert bits(again) == before
    xr.testing.assert_equal(again.load(), study())


@pytest.mark.parametrize("how", ["cut", "changed"])
def test_a_damaged_marker_is_reported(how: str, tmp_path: Path) -> None:
    """Without its list of files a store is neither read nor changed."""
    store = tmp_path / "study.zarr"
    study(store)
    damage(store / MARKER, how)
    before = {path: path.read_bytes() for path in store.rglob("*") if path.is_file()}
    for use in (study, open_study, show_study):
        with pytest.raises(rb.StoreError, match=r"study.zarr is damaged: .*\n  try: a copy of it"):
            use(store)
    assert {path: path.read_bytes() for path in store.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize("how", ["cut", "changed", "emptied", "removed"])
def test_damaged_block_is_computed_again(how: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A lost or changed chunk makes its block missing in all variables, until the same command computes it again."""
    store = tmp_path / "study.zarr"
    task = Logistic(Grid(shape=(6, 14)))
    before = bits(study(store, task))
    for name, block in (("value", 4), ("status", 0), ("orbit", 11)):
        damage(store / name / "c" / str(block // 2) / str(block % 2) / ("0" if name == "orbit" else ""), how)
        assert progress_of(store).done == 84 - 7
        data = open_study(store)
        missing = np.zeros((6, 14), bool)
        missing[block // 2, 7 * (block % 2) : 7 * (block % 2) + 7] = True
        assert np.array_equal(data.status.values == -128, missing)
        assert np.array_equal(np.isnan(data.value.values), missing)
        assert np.array_equal(np.isnan(data.orbit.values).all(axis=2), missing)
        show_study(store)
        assert "77 of 84 variants" in capsys.readouterr().out
        seen: list[int] = []
        run_work(task, store=store, progress=lambda done, total, seen=seen: seen.append(done))
        assert (seen[0], seen[-1]) == (77, 84)
        assert bits(open_study(store)) == before


def test_block_of_nan_is_computed_once(tmp_path: Path) -> None:
    """A block whose values are all NaN is computed once."""

    class Nothing(LogisticEngine):
        def run(self, numbers: range, **options: Any) -> Any:
            return {name: values * np.nan for name, values in super().run(numbers, **options).items()} | {
                "status": np.full(len(numbers), -128, "i1")
            }

    study(tmp_path / "study.zarr", Work(Nothing()))
    assert progress_of(tmp_path / "study.zarr").done == 60


def damage(file: Path, how: str) -> None:
    """Damage a file."""
    content = bytearray(file.read_bytes())
    if how == "removed":
        file.unlink()
        return
    if how == "changed":
        content[len(content) // 2] ^= 4
    file.write_bytes(content[: {"cut": len(content) // 2, "changed": None, "emptied": 0}[how]])
