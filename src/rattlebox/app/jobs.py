"""Workers of a page: processes that compute while the page stays responsive."""

from __future__ import annotations

import asyncio
import multiprocessing
from collections.abc import Callable
from contextlib import suppress
from typing import Any, ClassVar

import rattlebox as rb

from .worker import main

_CONTEXT = multiprocessing.get_context("spawn")


class TaskFailed(Exception):
    """A task failed; the text of the error is for the user."""


class Worker:
    """A process for one task at a time. It starts at once, and again for the next task after it was stopped."""

    _spare: ClassVar[list[Worker]] = []

    def __init__(self) -> None:
        self._start()

    @classmethod
    def ready(cls) -> Worker:
        """Return the spare worker, which has loaded its libraries; a new one if there is none."""
        return cls._spare.pop() if cls._spare else cls()

    @classmethod
    def start_spare(cls) -> None:
        """Start a worker for the next page, unless there is one."""
        if not cls._spare:
            cls._spare.append(cls())

    @classmethod
    async def load_spare(cls) -> None:
        """Start the spare worker and return when it has loaded its libraries."""
        cls.start_spare()
        with suppress(TaskFailed):
            await cls._spare[0].do("start")

    @classmethod
    def stop_spare(cls) -> None:
        """End the spare worker."""
        while cls._spare:
            cls._spare.pop().stop()

    def _start(self) -> None:
        self._connection, child = _CONTEXT.Pipe()
        self._process = _CONTEXT.Process(target=main, args=(child,), daemon=True, name="rattlebox-app-worker")
        self._process.start()
        child.close()

    @property
    def pid(self) -> int | None:
        """Process id."""
        return self._process.pid

    async def do(self, *task: Any, progress: Callable[..., object] = lambda *_: None) -> Any:
        """Send a task and return its result."""
        if not self._process.is_alive():
            self._start()
        connection = self._connection
        try:
            connection.send(task)
            while True:
                kind, *content = await asyncio.to_thread(connection.recv)
                if kind == "progress":
                    progress(*content)
                elif kind == "failed":
                    raise TaskFailed(content[0])
                else:
                    return content[0]
        except (EOFError, OSError):
            ended = "the process that computed ended; it may have needed more memory than this machine has"
            raise TaskFailed(str(rb.ResourceError(ended, "a shorter or smaller case"))) from None

    def stop(self) -> None:
        """End the process and its computation."""
        self._process.kill()
        self._process.join()  # a thread may still read from the connection, which closes with its last reference


class Live:
    """Computation of the latest request; a request replaces an earlier one that has not started.

    Parameters
    ----------
    longest
        Time after which a computation is stopped [s].
    """

    def __init__(self, show: Callable[[Any], object], fail: Callable[[str], object], longest: float = 8.0) -> None:
        self._show, self._fail, self._longest = show, fail, longest
        self._worker = Worker.ready()
        self._next: tuple[Any, ...] | None = None
        self._busy = self._started = False

    async def request(self, *task: Any) -> None:
        """Compute a task unless a newer one arrives first."""
        self._next = task
        if self._busy:
            return
        self._busy = True
        try:
            # Requests that came meanwhile replaced each other; only the last is computed.
            while (task_now := self._next) is not None:
                self._next = None
                try:
                    if not self._started:  # loading the libraries is not part of the limit
                        await self._worker.do("start")
                    self._started = True
                    self._show(await asyncio.wait_for(self._worker.do(*task_now), self._longest))
                    Worker.start_spare()  # not earlier: its start takes as much processor time as the first picture
                except TimeoutError:
                    self._worker.stop()
                    self._started = False
                    slow = f"this case takes longer than {self._longest:g} s"
                    self._fail(str(rb.ResourceError(slow, "Run and save, or a shorter case")))
                except TaskFailed as error:
                    self._fail(str(error))
        finally:
            self._busy = False

    def stop(self) -> None:
        """End the process."""
        self._next = None
        self._worker.stop()
