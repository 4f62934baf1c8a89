"""Reliable handling of Ctrl-C, and deadlines."""

from __future__ import annotations

import ctypes
import math
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TypeVar

Result = TypeVar("Result")

_pressed = threading.Event()


class _Deadline(threading.local):
    time = math.inf


_deadline = _Deadline()


@contextmanager
def deadline(end: float) -> Iterator[None]:
    """Set a time after which `raise_if_pressed` raises in this block and this thread.

    `end`: time by `time.monotonic` [s].
    """
    before = _deadline.time
    _deadline.time = min(before, end)
    try:
        yield
    finally:
        _deadline.time = before


@contextmanager
def remember_ctrl_c() -> Iterator[None]:
    """Store in this block whether Ctrl-C was pressed, for `raise_if_pressed`.

    Python discards a KeyboardInterrupt that is raised inside a callback of the garbage collector, which happens in long runs
    with many short-lived threads. Does nothing in other threads, or where another program handles Ctrl-C.
    """
    usual = signal.default_int_handler
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGINT) is not usual:
        yield
        return

    def remember(number: int, frame: FrameType | None) -> None:
        _pressed.set()
        usual(number, frame)

    _pressed.clear()
    signal.signal(signal.SIGINT, remember)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
        _pressed.clear()


def raise_if_pressed() -> None:
    """Raise KeyboardInterrupt if Ctrl-C was pressed in a block of `remember_ctrl_c`, or at a deadline."""
    if time.monotonic() >= _deadline.time:
        raise KeyboardInterrupt
    if _pressed.is_set() and threading.current_thread() is threading.main_thread():
        raise KeyboardInterrupt


class _Stopped(BaseException):
    """Raised in a call that `StoppableCalls.stop` ends."""


class StoppableCalls:
    """Calls in threads of a pool, which `stop` ends.

    A study that is stopped would otherwise wait for the evaluation of the runs in progress, since Python waits for its
    threads when it ends.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._threads: set[int] = set()
        self._stopped = False

    def is_stopped(self) -> bool:
        """Return whether the calls were stopped; loops in compiled code ask for it."""
        return self._stopped

    def call(self, function: Callable[[], Result]) -> Result | None:
        """Return the result of a function; None if the calls are stopped."""
        thread = threading.get_ident()
        try:
            with self._lock:
                if self._stopped:
                    return None
                self._threads.add(thread)
            try:
                return function()
            finally:
                with self._lock:
                    self._threads.discard(thread)
        except _Stopped:
            return None

    def stop(self) -> None:
        """Raise an exception in all calls, at their next line of Python."""
        with self._lock:
            self._stopped = True
            for thread in self._threads:
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(_Stopped))
