"""Plugin of pytest that prints the processor time of all tests and of the ten that take most of it.

Processor time depends less on other programs than the time on the clock. It includes processes that a test starts and waits
for.
"""

from __future__ import annotations

import os
from collections.abc import Generator

import pytest

_SHOWN = 10
_used = 0.0


def processor_time() -> float:
    """Return the processor time of this process and of its finished children [s]."""
    return sum(os.times()[:4])


def pytest_sessionstart() -> None:
    """Begin to count."""
    global _used
    _used = processor_time()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Add the time since the last report to the report; the first one includes the collection."""
    global _used
    report = yield
    now = processor_time()
    report.processor_time = now - _used  # type: ignore[attr-defined]
    _used = now
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the sum and the largest times."""
    times: dict[str, float] = {}
    for reports in terminalreporter.stats.values():
        for report in reports:
            if hasattr(report, "processor_time"):
                times[report.nodeid] = times.get(report.nodeid, 0.0) + report.processor_time
    if len(times) <= 10 * _SHOWN:
        return
    terminalreporter.section(f"processor time {sum(times.values()):.0f} s, {_SHOWN} largest")
    for name in sorted(times, key=lambda name: -times[name])[:_SHOWN]:
        terminalreporter.write_line(f"{times[name]:6.2f} s  {name}")
