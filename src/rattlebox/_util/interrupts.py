"""Reliable handling of Ctrl-C, and deadlines."""

from __future__ import annotations

import math
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_pressed = threading.Event()


class _Deadline(threading.local):
    time = math.inf


_deadline = _Deadline()


@contextmanager
def deadline(end: float) -> Iterator[None]:
    """Set a time after which `raise_if_pressed` raises in this block and this thread.

    Parameters
    ----------
    end
        Time by `time.monotonic` [s].
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
