"""Calls in threads that are ended.

No test saw that a stopped study continued for minutes: its runs were short, and only the engine asked whether to stop.
"""

import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from rattlebox._util.interrupts import StoppableCalls

STUDY = """
import time
import rattlebox as rb
from rattlebox.studies.run.runner import evaluate_cases
def slow(run):
    print("evaluating", flush=True)
    while True:
        time.sleep(0.001)
evaluate_cases([rb.reference_case(duration=0.01)] * 4, slow, workers=1, progress=False)
"""


def test_stop_ends_calls():
    """Calls in progress end at their next line and return None; later calls do not start; finished calls are unchanged."""
    calls, started = StoppableCalls(), threading.Semaphore(0)

    def loop():
        started.release()
        try:
            while True:
                time.sleep(0.001)
        finally:
            ended.append(True)

    ended = []
    with ThreadPoolExecutor(3) as pool:
        assert pool.submit(calls.call, partial(int, "3")).result() == 3
        futures = [pool.submit(calls.call, loop) for _ in range(3)]
        for _ in futures:
            started.acquire()
        assert not calls.is_stopped()
        calls.stop()
        assert [future.result(20) for future in futures] == [None] * 3
        assert calls.is_stopped() and len(ended) == 3
        assert pool.submit(calls.call, partial(int, "3")).result() is None
        assert pool.submit(int, "3").result() == 3


def test_ctrl_c_ends_the_evaluation_of_runs():
    """A study whose evaluation of runs never ends stops at Ctrl-C."""
    with subprocess.Popen(
        [sys.executable, "-c", STUDY], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "evaluating\n"
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    assert process.returncode and "KeyboardInterrupt" in errors
