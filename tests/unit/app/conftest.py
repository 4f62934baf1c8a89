"""Processes of the page that start quickly: they are forked from one that has loaded the libraries."""

import multiprocessing
import os
import sys
from multiprocessing import forkserver

import pytest

from rattlebox.app import jobs


@pytest.fixture(scope="session")
def _forks():
    """Return a start method of processes; a new process of the usual one loads the libraries for a second."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return jobs._CONTEXT
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["support.app_libraries"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join(sys.path))  # Python 3.11 does not pass sys.path on
        forkserver.ensure_running()
    return context


@pytest.fixture(autouse=True)
def _forked_workers(monkeypatch, _forks):
    """The browser tests start workers as users do."""
    monkeypatch.setattr(jobs, "_CONTEXT", _forks)
