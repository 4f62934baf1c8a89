"""A process of the browser application that computes with a full disk."""

from __future__ import annotations

import errno
import os
from multiprocessing.connection import Connection
from pathlib import Path

from rattlebox.app import worker


def main(flag: Path, connection: Connection) -> None:
    """Do the tasks of a connection; as long as the file `flag` exists, files cannot be completed."""
    flush = os.fsync

    def flush_if_space(handle: int) -> None:
        if flag.exists():
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        flush(handle)

    os.fsync = flush_if_space
    worker.FIRST_LOOK = worker.MOST_WAIT = 0.1  # many checkpoints, so that the disk is full at one of them
    worker.main(connection)
