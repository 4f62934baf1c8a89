"""The page of the browser application, simulated without a browser."""

import asyncio
import time
from contextlib import asynccontextmanager

import pytest
from nicegui.testing import user_simulation

import rattlebox as rb
from rattlebox.app.jobs import Worker
from rattlebox.app.page import Page

pytestmark = pytest.mark.filterwarnings("ignore")  # of the libraries of the server


@asynccontextmanager
async def opened(folder):
    """Open the page and yield it with the simulated user and the bodies that it publishes."""
    pages, bodies = [], {}

    def root():
        pages.append(Page(folder, bodies))

    async with user_simulation(root=root) as user:
        await user.open("/")
        try:
            yield pages[0], user, bodies
        finally:
            pages[0].close()
            Worker.stop_spare()


async def until(condition, longest=60.0):
    """Wait for a condition."""
    end = time.monotonic() + longest
    while not condition():
        assert time.monotonic() < end, "it took too long"
        await asyncio.sleep(0.05)


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
    """A wrong value is shown at its input, in the words of the library, and goes away."""

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
                page._templates.set_value("box")
                running = asyncio.ensure_future(page.run())
            await until(lambda: (tmp_path / "run-001.checkpoint").exists())
            worker = page._worker
            with user.client:
                page._cancel()
            await running
            assert not worker._process.is_alive()
            assert not list(tmp_path.glob("run-001*"))

    asyncio.run(visit())


def test_closed_page_stops_its_run(tmp_path):
    """Closing the page ends its processes; the checkpoint of the run remains."""

    async def visit():
        async with opened(tmp_path) as (page, user, bodies):
            with user.client:
                page._templates.set_value("box")
                running = asyncio.ensure_future(page.run())
            await until(lambda: (tmp_path / "run-001.checkpoint").exists())
            worker = page._worker
            page.close()
            await running
            assert not worker._process.is_alive()
            assert not bodies

    asyncio.run(visit())
    assert (tmp_path / "run-001.checkpoint").exists()


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
                page.kept_tab.refresh()
                assert "cannot be read" in page.kept_tab._failure.text

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
