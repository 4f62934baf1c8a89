"""Waiting for other processes."""

import time
from collections.abc import Callable


def wait_for(condition: Callable[[], object], seconds: float = 60.0, pause: float = 0.005) -> None:
    """Wait until a condition holds; fail after a number of seconds."""
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until, "the condition does not hold in time"
        time.sleep(pause)
