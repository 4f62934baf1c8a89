"""Exit codes of the command."""

import signal

STOPPED = 128 + signal.SIGINT
"""Exit code of a command that Ctrl-C stopped."""
