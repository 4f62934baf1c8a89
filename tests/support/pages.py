"""The page of the browser application, simulated without a browser."""

import asyncio
import time
from contextlib import asynccontextmanager

from nicegui.testing import user_simulation

from rattlebox.app.jobs import Worker
from rattlebox.app.page import Page


@asynccontextmanager
async def opened(folder):
    """Open the page and yield it with the simulated user and the bodies that it publishes."""
    pages, bodies = [], {}

    def root():
        pages.append(Page(folder, bodies))

    failure = None
    async with user_simulation(root=root) as user:
        await user.open("/")
        try:
            yield pages[0], user, bodies
        except Exception as error:  # the simulation ends only without an exception
            failure = error
        pages[0].close()
        Worker.stop_spare()
        await asyncio.sleep(0.05)  # a task that is cancelled as it sends the last changes would end only after 2 s
    if failure is not None:
        raise failure


async def until(condition, longest=60.0):
    """Wait for a condition."""
    end = time.monotonic() + longest
    while not condition():
        assert time.monotonic() < end, "it took too long"
        await asyncio.sleep(0.05)
