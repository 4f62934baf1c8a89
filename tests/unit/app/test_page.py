"""The page of the browser application, simulated without a browser."""

import asyncio
import os
import re
import signal
from functools import partial

import pytest
from support import full_disk as full_disk_worker
from support.pages import opened, until

import rattlebox as rb
from rattlebox.app import jobs, maps, worker
from rattlebox.app.binary import decode
from rattlebox.app.draft import template

SHORT_BOX = (
    template("box")
    .replace('duration = "1 s"', 'duration = "60 ms"')
    .replace("count = 200", "count = 8")
    .replace("snapshots = 200", "snapshots = 5")
)

LONG_BOX = SHORT_BOX.replace('"60 ms"', '"8 s"')
"""A run of some seconds, with time for several checkpoints."""

RECORD = re.sub(r"\[load\].*?\n\n", '[load]\nkind = "record"\nfile = "load.csv"\n\n', template("row"), flags=re.DOTALL)
"""A case with a record of the load in a file."""

FAST = template("steel_ball").replace('duration = "5 s"', 'duration = "5 s"\noutput = { rate = "1 THz" }')
"""A case with terabytes of output."""

pytestmark = pytest.mark.filterwarnings("ignore")  # of the libraries of the server


def test_case_is_computed_run_and_mapped(tmp_path):
    """A changed case is drawn anew; a run and a map are kept; a point of the map changes the case."""

    async def visit():
        async with opened(tmp_path) as (page, user, bodies):
            await until(lambda: "view" in page._keys)
            first = bodies[page._keys["view"]](0)
            await page._draw_case()
            assert "<svg" in page._drawing.content
            page.draft.set_value(("damper", "gap"), "0.7 mm")
            page.use_text(page.draft.text.replace('"5 s"', '"0.3 s"'))
            await until(lambda: bodies[page._keys["view"]](0) != first)
            assert len(bodies) == 1  # the last view replaces the one before
            await page.run()
            assert rb.load(tmp_path / "run-001.nc").case == page.draft.case
            with user.client:
                (name, low, high, count, _), _ = page.map_tab._rows
                name.set_value("damper.gap")
                low.set_value("0.2 mm"), high.set_value("0.8 mm"), count.set_value(3)
                await page.map_tab.compute()
            assert rb.open_study(tmp_path / "map-001.zarr").rms.shape == (3,)
            with user.client:
                page.map_tab._watch_point(type("Click", (), {"data_index": 2, "data": [0.8, 0.1]}))
            assert page.draft.case.dampers[0].gap == pytest.approx(0.8e-3)

    asyncio.run(visit())


def test_errors_are_beside_their_field(tmp_path):
    """The message of a wrong value is shown at its input, as in the library, until the value is mended."""

    async def visit():
        async with opened(tmp_path) as (page, user, _):
            with user.client:
                page.form._inputs["damper.gap"].set_value("-1 mm")
                field = page.form._inputs["damper.gap"]
                assert "negative" in field.error
                assert not page.form._inputs["structure.mass"].error
                field.set_value("1 mm")
                assert not field.error
                page.use_text("structure = 3")
                assert "table" in page._text_error.text
            await user.should_see("The case is not valid")

    asyncio.run(visit())


@pytest.mark.parametrize("template", ["box", "building"])
def test_templates_and_kinds(tmp_path, template):
    """Choosing a template or another kind of a part rebuilds the form."""

    async def visit():
        async with opened(tmp_path) as (page, user, _):
            with user.client:
                page._templates.set_value(template)
                assert page.draft.errors == {}
                page.form._set_kind(
                    ("structure",),
                    page.draft.given["structure"],
                    {"properties": {"kind": {}}},
                    "fixed",
                )
                assert page.draft.given["structure"] == {"kind": "fixed"}
            await user.should_see("structure")

    asyncio.run(visit())


def test_particle_run_is_cancelled_and_its_files_are_removed(tmp_path):
    """Cancel ends the process, and nothing of an unfinished run is left."""

    async def visit():
        async with opened(tmp_path) as (page, user, _):
            with user.client:
                page.use_text(LONG_BOX)
                running = asyncio.ensure_future(page.run())
            await until(lambda: (tmp_path / "run-001.checkpoint").exists())
            worker = page._worker
            with user.client:
                page._cancel()
            await running
            assert not worker._process.is_alive()
            assert not list(tmp_path.glob("run-001*"))

    asyncio.run(visit())


def test_closed_page_stops_its_run_and_another_resumes_it(tmp_path):
    """Closing the page ends its processes; the next page lists the run as paused and resumes it."""

    async def visit():
        async with opened(tmp_path) as (page, user, bodies):
            with user.client:
                page.use_text(LONG_BOX)
                running = asyncio.ensure_future(page.run())
            await until(lambda: (tmp_path / "run-001.checkpoint").exists())
            assert page.runs_tab.show_paused() == []  # it is in progress
            worker = page._worker
            page.close()
            await running
            assert not worker._process.is_alive()
            assert not bodies

    async def return_later():
        async with opened(tmp_path) as (page, user, _):
            await user.should_see("Saved runs (1 paused)")
            with user.client:
                page.runs_tab.refresh()
            await user.should_see("run-001, paused")
            user.find("Resume").click()
            await until(lambda: "saved as run-001" in page._status.text)
            await user.should_see("Saved runs")
            await user.should_not_see("paused)")

    asyncio.run(visit())
    assert (tmp_path / "run-001.checkpoint").exists()
    asyncio.run(return_later())
    run = rb.load(tmp_path / "run-001.nc")
    assert (run.status, run.case) == ("finished", rb.Case.from_toml(LONG_BOX))
    assert not (tmp_path / "run-001.checkpoint").exists()


def test_removed_folder_is_reported(tmp_path):
    """A run in a folder that was removed gives a message, and the page remains usable."""
    folder = tmp_path / "gone"
    folder.mkdir()

    async def visit():
        async with opened(folder) as (page, user, _):
            folder.rmdir()
            with user.client:
                await page.run()
            await user.should_see("cannot be used")
            with user.client:
                page.runs_tab.refresh()
                assert "cannot be read" in page.runs_tab._failure.text

    asyncio.run(visit())


def full_disk(tmp_path, monkeypatch):
    """Let the processes of the page write to a disk that is full as long as the returned file exists."""
    flag = tmp_path / "disk is full"
    flag.touch()
    monkeypatch.setattr(jobs, "main", partial(full_disk_worker.main, flag))
    return flag


def test_full_disk_loses_no_result(tmp_path, monkeypatch):
    """A result that cannot be written is kept by the page, which writes it when there is space."""
    flag, folder = full_disk(tmp_path, monkeypatch), tmp_path / "folder"
    folder.mkdir()

    async def visit():
        async with opened(folder) as (page, user, _):
            with user.client:
                page.use_text(page.draft.text.replace('"5 s"', '"0.3 s"'))
                await page.run()
            await user.should_see("no space is left on the disk")
            await user.should_see("computed, but not saved")
            assert [path.name for path in folder.iterdir()] == ["run-001.toml"]  # keeps the name
            with user.client:
                page.use_text(page.draft.text.replace('"2 mm"', '"2.5 mm"'))  # does not end the process
                await page._save_again()
            await user.should_see("no space is left on the disk")
            flag.unlink()
            user.find("Save again").click()
            await until(lambda: "saved as" in page._status.text)
            await user.should_see("saved as run-001")
            assert not page._not_saved.text
            assert rb.load(folder / "run-001.nc").case.dampers[0].gap == pytest.approx(2e-3)

    asyncio.run(visit())


def test_full_disk_loses_no_checkpoint(tmp_path, monkeypatch):
    """A run of particles that stops at a full disk resumes from its last checkpoint, with the same bits."""
    flag, folder = full_disk(tmp_path, monkeypatch), tmp_path / "folder"
    folder.mkdir()
    flag.unlink()

    async def visit():
        async with opened(folder) as (page, user, _):
            with user.client:
                page.use_text(LONG_BOX)
                running = asyncio.ensure_future(page.run())
            await until(lambda: (folder / "run-001.checkpoint").exists())
            flag.touch()
            await running
            await user.should_see("no space is left on the disk")
            await user.should_see("Run and save resumes from the last checkpoint")
            flag.unlink()
            with user.client:
                await page.run()
            await user.should_see("saved as run-001")

    asyncio.run(visit())
    expected = rb.simulate(rb.Case.from_toml(LONG_BOX), snapshots=tmp_path / "x.vtkhdf", progress=False)
    assert rb.load(folder / "run-001.nc") == expected


def test_folder_is_removed_during_a_run(tmp_path, monkeypatch):
    """A run whose folder disappears ends with a message; the page works again when the folder is back."""
    full_disk(tmp_path, monkeypatch).unlink()  # there is space, and many checkpoints
    folder = tmp_path / "gone"
    folder.mkdir()

    async def visit():
        async with opened(folder) as (page, user, _):
            with user.client:
                page.use_text(LONG_BOX)
                running = asyncio.ensure_future(page.run())
            await until(lambda: (folder / "run-001.checkpoint").exists())
            folder.rename(tmp_path / "elsewhere")
            await running
            assert str(folder) in page._failure.text
            with user.client:
                page.map_tab._list_maps()
                await page.map_tab._download("csv")
                page._cancel()
                assert "cannot be read" in page.runs_tab._failure.text or page.map_tab._failure.text
            folder.mkdir()
            with user.client:
                page.use_text(template("steel_ball").replace('"5 s"', '"0.3 s"'))
                await page.run()
            await user.should_see("saved as run-001")

    asyncio.run(visit())


def test_run_that_exceeds_the_memory_is_refused(tmp_path):
    """Output that does not fit in the memory has a message at its field, a process that the system ends in the page."""

    async def visit():
        async with opened(tmp_path) as (page, user, _):
            with user.client:
                for text in (template("box").replace('"2 kHz"', '"1 THz"'), FAST):
                    page.use_text(text)
                    assert "GB" in page._text_error.text
                    assert "GB" in (page.form._inputs["output.rate"].error or "")
                    await page.run()
                assert not list(tmp_path.iterdir())
                page.use_text(LONG_BOX)
                running = asyncio.ensure_future(page.run())
            await until(lambda: (tmp_path / "run-001.checkpoint").exists())
            os.kill(page._worker._process.pid, signal.SIGKILL)
            await running
            assert "memory" in page._failure.text
            await user.should_see("Run and save resumes from the last checkpoint")

    asyncio.run(visit())


def test_stored_particle_run_is_shown_again(tmp_path):
    """A run of particles is opened from the folder with its curves and frames, without computing it again."""
    text = SHORT_BOX.replace('"60 ms"', '"10 ms"')
    worker.run(lambda *_: None, text, str(tmp_path), "run-001", False)

    async def visit():
        async with opened(tmp_path) as (page, user, bodies):
            with user.client:
                await page.runs_tab._open("run-001")
                arrays, about = decode(bodies[page._keys["particles"]](0))
            assert about["next"] == about["planned"] == arrays["position"].shape[0]
            assert page._summary.text == str(rb.load(tmp_path / "run-001.nc").summary())
            assert page._about.text == "finished at t = 0.01 s"
            with user.client:
                next(field for name, field in page.form._inputs.items() if name.endswith("softening")).set_value("30")
            assert page._about.text == "the pictures show an earlier case"

    asyncio.run(visit())


def test_map_fills_while_it_is_computed(tmp_path, monkeypatch):
    """The picture has the values of finished blocks during the study, and all of them at its end."""
    monkeypatch.setattr(maps, "POLL", 0.05)
    filled = []

    async def visit():
        async with opened(tmp_path) as (page, user, _):
            tab = page.map_tab
            with user.client:
                page.use_text(SHORT_BOX.replace('"60 ms"', '"0.2 s"'))
                (name, low, high, count, _), _ = tab._rows
                name.set_value("structure.motion.amplitude")
                low.set_value("2 mm"), high.set_value("8 mm"), count.set_value(6)
                tab._measure.set_value("impact_loss")
                computing = asyncio.ensure_future(tab.compute())
            while not computing.done():
                await asyncio.sleep(0.02)
                if "series" in tab._chart.options:
                    filled.append(sum(y is not None for _, y in tab._chart.options["series"][0]["data"]))
            await computing
            assert tab._failure.text == ""
            await user.should_see("saved as map-001")

    asyncio.run(visit())
    assert filled == sorted(filled)
    assert filled[-1] == 6
    assert any(0 < number < 6 for number in filled), filled


def test_runs_are_compared(tmp_path):
    """The ticked runs are in one figure, with a table of their results and of the differences of their cases."""
    for number, gap in enumerate(("0.4 mm", "0.7 mm", "1 mm")):
        text = template("steel_ball").replace('"5 s"', '"0.3 s"').replace('"0.4 mm"', f'"{gap}"')
        worker.run(lambda *_: None, text, str(tmp_path), f"run-00{number + 1}", False)
    names = ["run-001", "run-002", "run-003"]

    async def visit():
        async with opened(tmp_path) as (page, user, bodies):
            tab = page.runs_tab
            with user.client:
                tab.refresh()
                await tab._compare()
            await user.should_see("Tick two or more runs")
            for name in names:
                user.find(name).click()
            user.find("Compare the ticked runs").click()
            await until(lambda: tab._table.text)
            arrays, about = decode(bodies[page._keys["comparison"]](0))
            motion, loss = about["charts"]
            assert [line["name"] for line in motion["series"]] == names
            assert [line["name"] for line in loss["series"]] == names
            assert len({line["colour"] for line in motion["series"]}) == 3
            for name in names:
                run = rb.load(tmp_path / f"{name}.nc")
                expected = 1e3 * run.motion.displacement.values[:, 0]
                assert arrays[f"motion {name}"] == pytest.approx(expected, abs=1e-6)
            rows = [line.split() for line in tab._table.text.splitlines()]
            assert ["dampers[0].gap", "0.0004", "m", "0.0007", "m", "0.001", "m"] in rows
            assert any(row[:1] == ["impacts"] and len(row) == 4 for row in rows)

    asyncio.run(visit())


def test_opened_files(tmp_path):
    """A file that is opened replaces the case, or has a message in the page; a record is added to the folder, once."""

    async def visit():
        async with opened(tmp_path) as (page, user, _):
            good = template("row").encode()
            (tmp_path / "mine.toml").write_bytes(good)
            user.find("Open").click()
            user.find("mine.toml").click()
            assert page.draft.case.name == "row of three balls"
            with user.client:
                page._use_file("bad.toml", good.replace(b"gap =", b"gapp ="))
                assert page.draft.case is None
            await user.should_see("gapp: there is no such field here")
            with user.client:
                page._use_file("picture.toml", b"\x89PNG\xff")
            await user.should_see("picture.toml is not a text in UTF-8")
            assert "gapp" in page.draft.text  # the case is as it was
            with user.client:
                page.use_text(RECORD)
                assert "there is no file" in page.draft.errors["load.file"]
                page._use_file("load.csv", b"t,F\n0,0\n0.1,100\n3,0\n")
                assert page.draft.errors == {}
                page._use_file("load.csv", b"t,F\n0,0\n")
            await user.should_see("load.csv is in the folder already")
            assert (tmp_path / "load.csv").read_bytes().endswith(b"3,0\n")

    asyncio.run(visit())


def test_notes_are_not_warnings(tmp_path):
    """Information about a run is in another place of the page than warnings, which have the words of the library."""
    folder = tmp_path
    worker.run(lambda *_: None, SHORT_BOX.replace('"60 ms"', '"10 ms"'), str(folder), "run-001", False)
    far = template("steel_ball").replace('"5 s"', '"0.2 s"').replace('"0.4 mm"', '"100 mm"')

    async def visit():
        async with opened(folder) as (page, user, _):
            with user.client:
                await page.runs_tab._open("run-001")
                stored = rb.load(folder / "run-001.nc").notes
                assert page._notes.text == "\n".join(stored)
                assert page._notes.text.startswith("step ")
                assert page._warnings.text == ""
                page.use_text(far)
            await until(lambda: page._warnings.text)
            assert "warning: " in page._warnings.text
            assert page._warnings.text == "\n".join(rb.simulate(rb.Case.from_toml(far), progress=False).notes)
            assert page._notes.text == ""

    asyncio.run(visit())


def test_failed_task_is_reported(tmp_path):
    """An error of the library in a background run is shown with its advice."""

    async def visit():
        async with opened(tmp_path) as (page, user, _):
            with user.client:
                page.map_tab._rows[0][0].set_value("damper.gap")
                page.map_tab._rows[0][1].set_value("0.2 kg")
                await page.map_tab.compute()
            assert "kg" in page.map_tab._failure.text

    asyncio.run(visit())


def test_server_needs_a_folder_and_a_port(tmp_path):
    """A folder that cannot be created and a port in use are refused before the server starts."""
    import socket

    from rattlebox.app.server import serve

    (tmp_path / "file").touch()
    with pytest.raises(rb.DataError, match="written"):
        serve(tmp_path / "file")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(rb.ResourceError, match="port"):
            serve(tmp_path, port=taken.getsockname()[1])
