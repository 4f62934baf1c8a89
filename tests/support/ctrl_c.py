"""Ctrl-C that reaches the process of a test while it computes."""

import os
import signal
import threading
import time
from typing import Self


class CtrlC:
    """SIGINT for this process after a delay [s], sent by another thread; a context ends with the timer cancelled."""

    def __init__(self, delay: float) -> None:
        self._sent = float("nan")
        self._timer = threading.Timer(delay, self._send)

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()

    def start(self) -> None:
        """Begin the delay, once."""
        if self._timer.ident is None:
            self._timer.start()

    def elapsed(self) -> float:
        """Return the time since the signal [s]."""
        return time.perf_counter() - self._sent

    def _send(self) -> None:
        self._sent = time.perf_counter()
        os.kill(os.getpid(), signal.SIGINT)
