"""File systems that exist only for one test: full or read-only."""

from __future__ import annotations

import shutil
import subprocess

import pytest


def with_own_mounts(script: str) -> subprocess.CompletedProcess[str]:
    """Run a shell script in a namespace in which it may mount file systems."""
    command = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-ec", script]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


MOUNTS = shutil.which("unshare") is not None and with_own_mounts("mount -t tmpfs none /mnt").returncode == 0
needs_mounts = pytest.mark.skipif(not MOUNTS, reason="this machine does not let users mount file systems")
