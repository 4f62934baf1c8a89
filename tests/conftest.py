"""What every test may rely on."""

import signal


def pytest_configure() -> None:
    """Let Ctrl-C reach tests and the programs they start: shells start background jobs with it ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
