"""Exit codes of the command."""

import signal

STOPPED = 128 + signal.SIGINT
"""Of a command that Ctrl-C stopped."""
