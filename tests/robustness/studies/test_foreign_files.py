"""No command changes or removes a file that it did not write."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from support.command import rattlebox
from support.logistic_study import Logistic

import rattlebox as rb
from rattlebox._util.owned_folder import MARKER, Marker, fill, read_marker, remove, write_marker
from rattlebox.studies.run.runner import run_work
from rattlebox.studies.run.stored import open_study

CASE = """
duration = "50 ms"
structure = { kind = "sdof", mass = "20 kg", stiffness = "80 kN/m", velocity = "0.1 m/s" }
load = { kind = "harmonic", amplitude = "20 N", frequency = "10 Hz" }
damper = { ball = { radius = "33 mm", material = "steel" }, gap = "0.4 mm", contact = { kind = "tsuji", restitution = 0.8 } }
"""

NAMES = (
    "thesis.tex",
    ".DS_Store",
    "draft.partial",
    "value/notes.txt",
    "value/c/notes.txt",
    "value/c/0/mine.partial",
    "progress/plan.txt",
    "progress/map/picture.png",
    "status/zarr.json.bak",
    "photos/2026/a.jpg",
)


def add_files(folder: Path, names: tuple[str, ...] = NAMES) -> dict[Path, str]:
    """Write files of a user into a folder."""
    files = {folder / name: f"my {name}" for name in names}
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return files


@pytest.fixture
def user_files(tmp_path: Path) -> Iterator[Callable[..., dict[Path, str]]]:
    """Return a function that writes files of a user; all of them are unchanged at the end of the test."""
    all_of_them: dict[Path, str] = {}

    def put(folder: Path, names: tuple[str, ...] = NAMES) -> None:
        all_of_them.update(add_files(folder, names))

    yield put
    assert all_of_them
    for path, text in all_of_them.items():
        assert path.read_text() == text


def test_folder_of_a_user_is_refused(tmp_path: Path, user_files: Any) -> None:
    """A folder with foreign files of any name is refused."""
    for number, names in enumerate(
        [
            ("thesis/ch1.tex", "progress/plan.txt"),
            ("progress/lock",),
            ("progress/zarr.json", "zarr.json"),
            ("progress/finished/zarr.json",),
            ("map/zarr.json",),
            (MARKER,),
        ]
    ):
        folder = tmp_path / str(number)
        user_files(folder, names)
        with pytest.raises(rb.StoreError, match=r"\n  try: "):
            run_work(Logistic(), store=folder, progress=False)
        assert {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()} == {*names}


@pytest.mark.parametrize("kind", ["sweep", "command", "bifurcation", "frequency_response", "design"])
def test_every_study_refuses_a_folder_of_a_user(
    kind: str, tmp_path: Path, user_files: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All functions and the command that take a store refuse a folder with a foreign subfolder called progress."""
    folder = tmp_path / "project"
    user_files(folder, ("thesis/ch1.tex", "progress/plan.txt"))
    case = rb.Case.from_toml(CASE)
    if kind == "command":
        (tmp_path / "case.toml").write_text(CASE)
        text = 'measure = ["impacts"]\ncase = "case.toml"\n[axes]\n"damper.gap" = ["0.3 mm", "0.5 mm"]\n'
        (tmp_path / "study.toml").write_text(text)
        monkeypatch.chdir(tmp_path)
        done = rattlebox("sweep", "study.toml", "-o", "project")
        assert done.returncode == 2 and "holds other files" in done.stderr
        return
    options: dict[str, Any] = {"store": folder, "progress": False}
    calls: dict[str, Callable[[], object]] = {
        "sweep": lambda: rb.sweep(case, {"damper.gap": [3e-4, 4e-4]}, ["impacts"], **options),
        "bifurcation": lambda: rb.bifurcation(case, "damper.gap", [3e-4, 4e-4], cycles=(1, 2), **options),
        "frequency_response": lambda: rb.frequency_response(case, [8, 9], cycles=(1, 2), **options),
        "design": lambda: rb.design(case, {"damper.gap": (1e-4, 1e-3)}, trials=2, **options),
    }
    with pytest.raises(rb.StoreError, match="holds other files"):
        calls[kind]()


def test_store_with_foreign_files_resumes(tmp_path: Path, user_files: Any) -> None:
    """Foreign files in a store stay there while the study resumes, is repaired and loses blocks."""
    store = tmp_path / "study.zarr"

    def stop(done: int, total: int) -> None:
        if done >= 20:
            raise ZeroDivisionError

    with suppress(ZeroDivisionError):
        run_work(Logistic(), store=store, block=5, progress=stop)
    user_files(store)
    left = store / "value" / "c" / "1" / f"0.{'a' * 32}.partial"
    left.write_text("half a chunk")
    first = run_work(Logistic(), store=store, progress=False).load()
    assert not left.exists()
    (store / "gap" / "zarr.json").unlink()
    (store / "value" / "c" / "0" / "0").unlink()
    assert run_work(Logistic(), store=store, progress=False).load().equals(first)


def test_incomplete_store_with_foreign_files(tmp_path: Path, user_files: Any) -> None:
    """Of an incomplete store only the files in its list are removed."""
    store = tmp_path / "study.zarr"
    run_work(Logistic(), store=tmp_path / "other.zarr", progress=False)
    made = read_marker(tmp_path / "other.zarr")
    assert made
    store.mkdir()
    write_marker(store, replace(made, complete=False, files=dict.fromkeys((*made.files, "gone/zarr.json"), "")))
    for name in ("zarr.json", "gone/zarr.json", "value/zarr.json"):
        (store / name).parent.mkdir(exist_ok=True)
        (store / name).write_text("{")
    user_files(store, ("thesis.tex", "gone/notes.txt", "photos/a.jpg"))
    run_work(Logistic(), store=store, progress=False)
    assert not (store / "gone" / "zarr.json").exists()


@pytest.mark.parametrize("name", ["zarr.json", "value/c/0/0", "gap/zarr.json"])
def test_foreign_files_are_not_overwritten(name: str, tmp_path: Path, user_files: Any) -> None:
    """A foreign file with a name that the study needs is reported, and nothing is written."""
    store = tmp_path / "study.zarr"
    store.mkdir()
    write_marker(store, Marker("Rattlebox study", rb.__version__))
    user_files(store, (name,))
    with pytest.raises(rb.StoreError, match="was not written by Rattlebox\n  try: move it"):
        run_work(Logistic(), store=store, progress=False)


def test_diagram_with_foreign_files(tmp_path: Path, user_files: Any) -> None:
    """A diagram is written again next to foreign files in its folder; a foreign map folder does not matter to a sweep."""
    store, case = tmp_path / "study.zarr", rb.Case.from_toml(CASE)

    def made() -> Any:
        return rb.bifurcation(case, "damper.gap", [3e-4, 4e-4], cycles=(1, 2), store=store, progress=False)

    first = made()
    user_files(store / "map", ("notes.txt", "c/notes.txt"))
    (store / "map" / "zarr.json").write_text("{")
    with pytest.raises(
        rb.StoreError, match=r"is damaged: zarr\.json is missing or has changed\n  try: its command again"
    ):
        open_study(store)
    made()
    assert open_study(store).load().equals(first)

    other = tmp_path / "other.zarr"
    rb.sweep(case, {"damper.gap": [3e-4, 4e-4]}, ["impacts"], store=other, progress=False)
    user_files(other, ("map/zarr.json",))
    assert open_study(other).impacts.size == 2


def test_marker_cannot_remove_files_elsewhere(tmp_path: Path, user_files: Any) -> None:
    """A forged marker removes nothing outside of its folder, neither by dots in a path nor by links."""
    folder = tmp_path / "given"
    folder.mkdir()
    user_files(tmp_path / "home", ("thesis.tex",))
    write_marker(folder, Marker("Rattlebox study", "1", files={"../home/thesis.tex": ""}))
    with pytest.raises(ValueError, match="has changed"):
        fill(folder, Marker("Rattlebox study", "1"), {"a": b"b"})
    (folder / "link").symlink_to(tmp_path / "home")
    remove(folder, ["link/thesis.tex"])


def test_store_that_is_removed_during_a_study(tmp_path: Path) -> None:
    """A study whose folder is removed stops with a message and does not create an incomplete store."""
    store = tmp_path / "study.zarr"

    def clear(done: int, total: int) -> None:
        if store.exists() and done >= 20:
            store.rename(tmp_path / "elsewhere")

    with pytest.raises(rb.StoreError, match=rf"{store} was removed while the study ran"):
        run_work(Logistic(), store=store, block=5, progress=clear)
    assert not store.exists()
