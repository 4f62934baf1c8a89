"""Links to nowhere, pipes, folders and made files in the folder of the page; texts that are made to break it.

No test saw that one link hid all results: the folders of all tests had results of Rattlebox only.
"""

import ast
import asyncio
import os
import shutil
import tomllib
from contextlib import suppress

import h5py
import pytest
from support.pages import opened

import rattlebox as rb
from rattlebox.app import draft as drafts
from rattlebox.app import results
from rattlebox.app.draft import Draft, python_script, template

pytestmark = pytest.mark.filterwarnings("ignore")  # of the libraries of the server

SUFFIXES = (".nc", ".zarr", ".checkpoint", ".vtkhdf", ".toml")
TEXTS = {
    "deep": "a = " + "[" * 5000 + "]" * 5000,
    "tables": "a = " + "{b=" * 600 + "1" + "}" * 600,
    "other": "name = [1]",
    "nothing": "=",
    "markup": 'name = "<img src=x onerror=alert(1)>"',
    "long": f'name = "{"x" * 200_000}"',
}


@pytest.fixture
def folder(tmp_path):
    """A folder with a run, between hostile entries."""
    place = tmp_path / "results"
    place.mkdir()
    rb.simulate(rb.reference_case(duration=0.05)).save(place / "run-001.nc")
    for suffix in SUFFIXES:
        (place / f"nowhere{suffix}").symlink_to("/nowhere/at/all")
        (place / f"circle{suffix}").symlink_to(f"circle{suffix}")
        os.mkfifo(place / f"pipe{suffix}")
        if suffix != ".zarr":
            (place / f"folder{suffix}").mkdir()
            (place / f"empty{suffix}").touch()
        else:
            (place / "file.zarr").touch()
            (place / "empty.zarr").mkdir()
        (place / f"new\nline{suffix}").touch()
        with open(os.fsencode(place) + b"/\xff" + suffix.encode(), "wb"):
            pass
    (place / "outside.nc").symlink_to("/etc/passwd")
    for name, text in TEXTS.items():
        shutil.copy(place / "run-001.nc", place / f"{name}.nc")
        with h5py.File(place / f"{name}.nc", "r+") as file:
            del file["case"]
            file.create_dataset("case", data=text, dtype=h5py.string_dtype())
    return place


def test_results_are_listed(folder):
    """The run is listed; of the hostile entries only regular files, none of which blocks or raises when it is used."""
    assert "run-001" in results.runs(folder)
    assert {*results.runs(folder)} == {"run-001", "empty", "outside", *TEXTS}
    assert results.maps(folder) == []
    assert results.paused_runs(folder) == ["empty"]
    assert results.case_files(folder) == []  # that of the name "empty" belongs to results
    for name in results.runs(folder):
        shown = results.name_of_case(folder / f"{name}.nc", 0.0)
        assert len(shown) <= 80
        for suffix in ("nc", "py", "toml", "csv"):
            with suppress(*drafts.FAILURES):
                assert isinstance(results.download(folder, name, suffix), bytes)
    for name in ("nowhere", "circle", "pipe", "folder", "new\nline", "../results/run-001", "outside"):
        for suffix in SUFFIXES:
            with pytest.raises(rb.DataError):
                results.inside(folder, name, suffix)


def test_page_shows_the_folder(folder):
    """The tab with saved runs lists the runs and can open them; the dialog of case files opens; a run is saved."""

    async def visit():
        async with opened(folder) as (page, user, _):
            with user.client:
                page.runs_tab.refresh()
                assert page.runs_tab._failure.text == ""
                page._open_dialog()
                page.map_tab._list_maps()
                for name in results.runs(folder):
                    await page.runs_tab._open(name)
                    if name != "run-001":
                        assert page.runs_tab._failure.text or page.draft.text
                page.runs_tab._chosen = {"run-001", "deep", "tables"}
                await page.runs_tab._compare()
                assert page.runs_tab._failure.text
                page.use_text(template("steel_ball").replace('"5 s"', '"0.1 s"'))
                await page.run()
            await user.should_see("run-001")
            assert rb.load(folder / "run-002.nc").case == page.draft.case

    asyncio.run(visit())


@pytest.mark.parametrize(
    "text",
    [
        template("steel_ball").rstrip(),
        template("steel_ball") + '# a "quoted" remark',
        template("steel_ball") + '# "',
        template("steel_ball") + '# ""',
        template("steel_ball") + '# """',
        template("steel_ball") + '# """"',
        template("steel_ball") + "# \\",
        template("steel_ball") + '# \\"',
        'name = """a "" b"""\n' + template("steel_ball"),
        template("steel_ball").replace("\n", "\r\n"),
        "not TOML: \0 \x1b \ud800",
        "",
    ],
)
def test_script_is_valid_python_with_the_case(text):
    """The script is Python for any text, and holds a text with the same tables."""
    script = python_script(text)
    script.encode("utf-8")
    call = ast.parse(script).body[1].value
    held = ast.literal_eval(call.args[0])
    try:
        tables = tomllib.loads(text)
    except ValueError:
        return
    assert tomllib.loads(held) == tables


@pytest.mark.parametrize("error", [MemoryError, RecursionError, OverflowError, ZeroDivisionError])
def test_no_error_of_a_case_leaves_the_draft(error, tmp_path, monkeypatch):
    """If a case raises any error, the page shows its message and drops the case of an earlier text."""
    draft = Draft(tmp_path)
    assert draft.case

    def fail(*_, **__):
        raise error

    monkeypatch.setattr(rb.Case, "from_dict", fail)
    draft.set_text(template("row"))
    assert draft.case is None and draft.errors[""] and draft.text == template("row")


def test_random_load_without_end(tmp_path):
    """A random load of 1e6 s, which would take terabytes, is an error at its field."""
    draft = Draft(tmp_path)
    draft.set_text(
        'duration = "1e6 s"\nstructure = { kind = "sdof", mass = 1, stiffness = 1000 }\n'
        'load = { kind = "random", psd = [[20, 1], [3000, 1]], duration = "1e6 s", unit = "N" }\n'
    )
    assert draft.case is None
    assert "would take" in draft.errors["load.duration"] and "try: duration" in draft.errors["load.duration"]


def test_case_names_a_pipe(tmp_path):
    """A case that names a pipe in the folder is refused without waiting for a writer."""
    os.mkfifo(tmp_path / "load.csv")
    draft = Draft(tmp_path)
    draft.set_text(
        'duration = "1 s"\nstructure = { kind = "sdof", mass = 1, stiffness = 1000 }\n'
        'load = { kind = "record", file = "load.csv", unit = "N" }\n'
    )
    assert draft.case is None and draft.errors


@pytest.mark.parametrize("read", [rb.load, rb.Snapshots])
def test_results_are_not_read_from_pipes(read, tmp_path):
    """A pipe with the name of a result is refused without waiting for a writer."""
    os.mkfifo(tmp_path / "run.nc")
    with pytest.raises(rb.DataError, match="pipe"):
        read(tmp_path / "run.nc")
