"""No command changes or removes a file that it did not write."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import rattlebox as rb
from rattlebox._util.owned_folder import MARKER, Marker, fill, read_marker, remove, write_marker
from rattlebox.studies.runner import run_work
from rattlebox.studies.stored import open_study

from .fake import Logistic

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


def plant(folder: Path, names: tuple[str, ...] = NAMES) -> dict[Path, str]:
    """Put files of a user into a folder."""
    files = {folder / name: f"my {name}" for name in names}
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return files


@pytest.fixture
def mine(tmp_path: Path) -> Iterator[Callable[..., dict[Path, str]]]:
    """Return a function that puts files into a folder; they are there and unchanged at the end of the test."""
    all_of_them: dict[Path, str] = {}

    def put(folder: Path, names: tuple[str, ...] = NAMES) -> None:
        all_of_them.update(plant(folder, names))

    yield put
    assert all_of_them
    for path, text in all_of_them.items():
        assert path.read_text() == text


def test_a_folder_of_a_user_is_no_store(tmp_path: Path, mine: Any) -> None:
    """A folder with other files is refused, whatever their names are."""
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
        mine(folder, names)
        with pytest.raises(rb.StoreError, match=r"\n  try: "):
            run_work(Logistic(), store=folder, progress=False)
        assert {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()} == {*names}


@pytest.mark.parametrize("kind", ["sweep", "command", "bifurcation", "frequency_response", "design"])
def test_every_study_refuses_a_folder_of_a_user(kind: str, tmp_path: Path, mine: Any) -> None:
    """The functions and the command that take a store refuse a folder that has a subfolder called progress."""
    folder = tmp_path / "project"
    mine(folder, ("thesis/ch1.tex", "progress/plan.txt"))
    case = rb.Case.from_toml(CASE)
    if kind == "command":
        (tmp_path / "case.toml").write_text(CASE)
        text = 'measure = ["impacts"]\ncase = "case.toml"\n[axes]\n"damper.gap" = ["0.3 mm", "0.5 mm"]\n'
        (tmp_path / "study.toml").write_text(text)
        command = [sys.executable, "-m", "rattlebox.cli", "sweep", "study.toml", "-o", "project"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
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


def test_a_study_goes_on_beside_files_of_a_user(tmp_path: Path, mine: Any) -> None:
    """Files that were put into a store stay there while the study goes on, is repaired, and loses blocks."""
    store = tmp_path / "study.zarr"

    def stop(done: int, total: int) -> None:
        if done >= 20:
            raise ZeroDivisionError

    with suppress(ZeroDivisionError):
        run_work(Logistic(), store=store, block=5, progress=stop)
    mine(store)
    left = store / "value" / "c" / "1" / f"0.{'a' * 32}.partial"
    left.write_text("half a chunk")
    first = run_work(Logistic(), store=store, progress=False).load()
    assert not left.exists()
    (store / "gap" / "zarr.json").unlink()
    (store / "value" / "c" / "0" / "0").unlink()
    assert run_work(Logistic(), store=store, progress=False).load().equals(first)


def test_a_half_made_store_with_files_of_a_user(tmp_path: Path, mine: Any) -> None:
    """What a killed process left is removed by its list."""
    store = tmp_path / "study.zarr"
    run_work(Logistic(), store=tmp_path / "other.zarr", progress=False)
    made = read_marker(tmp_path / "other.zarr")
    assert made
    store.mkdir()
    write_marker(store, replace(made, complete=False, files=dict.fromkeys((*made.files, "gone/zarr.json"), "")))
    for name in ("zarr.json", "gone/zarr.json", "value/zarr.json"):
        (store / name).parent.mkdir(exist_ok=True)
        (store / name).write_text("{")
    mine(store, ("thesis.tex", "gone/notes.txt", "photos/a.jpg"))
    run_work(Logistic(), store=store, progress=False)
    assert not (store / "gone" / "zarr.json").exists()


@pytest.mark.parametrize("name", ["zarr.json", "value/c/0/0", "gap/zarr.json"])
def test_files_in_the_way_are_not_written_over(name: str, tmp_path: Path, mine: Any) -> None:
    """A user's file with the name of one that a study needs is reported, and nothing is written."""
    store = tmp_path / "study.zarr"
    store.mkdir()
    write_marker(store, Marker("Rattlebox study", rb.__version__))
    mine(store, (name,))
    with pytest.raises(rb.StoreError, match="was not written by Rattlebox\n  try: move it"):
        run_work(Logistic(), store=store, progress=False)


def test_a_map_beside_files_of_a_user(tmp_path: Path, mine: Any) -> None:
    """A ready map is made anew beside files in its folder; one that is in its way is reported."""
    store, case = tmp_path / "study.zarr", rb.Case.from_toml(CASE)

    def made() -> Any:
        return rb.bifurcation(case, "damper.gap", [3e-4, 4e-4], cycles=(1, 2), store=store, progress=False)

    first = made()
    mine(store / "map", ("notes.txt", "c/notes.txt"))
    (store / "map" / "zarr.json").write_text("{")
    with pytest.raises(
        rb.StoreError, match=r"is damaged: zarr\.json is missing or has changed\n  try: its command again"
    ):
        open_study(store)
    made()
    assert open_study(store).load().equals(first)

    other = tmp_path / "other.zarr"
    rb.sweep(case, {"damper.gap": [3e-4, 4e-4]}, ["impacts"], store=other, progress=False)
    mine(other, ("map/zarr.json",))
    assert open_study(other).impacts.size == 2


def test_a_list_does_not_lead_out_of_its_folder(tmp_path: Path, mine: Any) -> None:
    """A marker made by somebody else removes nothing outside of its folder, through dots or through links."""
    folder = tmp_path / "given"
    folder.mkdir()
    mine(tmp_path / "home", ("thesis.tex",))
    write_marker(folder, Marker("Rattlebox study", "1", files={"../home/thesis.tex": ""}))
    with pytest.raises(ValueError, match="has changed"):
        fill(folder, Marker("Rattlebox study", "1"), {"a": b"b"})
    (folder / "link").symlink_to(tmp_path / "home")
    remove(folder, ["link/thesis.tex"])


def test_a_store_that_is_removed_while_it_runs(tmp_path: Path) -> None:
    """A study whose folder is removed stops with a message, and leaves no half of a store behind."""
    store = tmp_path / "study.zarr"

    def clear(done: int, total: int) -> None:
        if store.exists() and done >= 20:
            store.rename(tmp_path / "elsewhere")

    with pytest.raises(rb.StoreError, match=rf"{store} was removed while the study ran"):
        run_work(Logistic(), store=store, block=5, progress=clear)
    assert not store.exists()
