"""The command `rattlebox` in the process of a test, which saves the start of another process."""

import io
import subprocess
import sys
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from unittest.mock import patch

import pytest

from rattlebox.cli.main import main

RunCli = Callable[..., tuple[int | str | None, str, str]]
"""Return exit code, standard output and standard error of a command."""


def rattlebox(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Run the command and return its exit code and what it prints."""
    words = [str(argument) for argument in arguments]
    out, errors = io.StringIO(), io.StringIO()
    with (
        patch.object(sys, "argv", ["rattlebox", *words]),
        redirect_stdout(out),
        redirect_stderr(errors),
        pytest.raises(SystemExit) as end,
    ):
        main()
    code = end.value.code or 0
    return subprocess.CompletedProcess(words, code if isinstance(code, int) else 1, out.getvalue(), errors.getvalue())
