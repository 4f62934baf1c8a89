"""Scheduler and workers of Dask as programs on the loopback, which tests can kill."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .waiting import wait_for


@contextmanager
def program(*arguments: str, **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """Start a program of Dask and kill it after use."""
    command = [sys.executable, "-m", f"distributed.cli.{arguments[0]}", *arguments[1:]]
    command += ["--host", "127.0.0.1", "--no-dashboard", "--dashboard-address", "127.0.0.1:0"]
    environment["DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT"] = "3s"  # time until a killed program counts as lost
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, stdout=quiet, stderr=quiet, env=os.environ | environment) as process:
        try:
            yield process
        finally:
            process.kill()


@contextmanager
def worker(scheduler: Path, **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """Start a worker without a process that would restart it."""
    options = ["--scheduler-file", str(scheduler), "--nthreads", "1", "--no-nanny", "--death-timeout", "20"]
    with program("dask_worker", *options, **environment) as process:
        yield process


@contextmanager
def running_scheduler(folder: Path, **environment: str) -> Iterator[tuple[Path, subprocess.Popen[bytes]]]:
    """Start a scheduler; yield the file with its address, and its process."""
    file = folder / "scheduler.json"
    with program("dask_scheduler", "--port", "0", "--scheduler-file", str(file), **environment) as process:
        wait_for(file.exists)
        yield file, process
