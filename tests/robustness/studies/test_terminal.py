"""Output of a study to a terminal: progress bar with rate and remaining time, and the message after Ctrl-C."""

import os
import pty
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from rattlebox.studies.run.stored import progress_of

EXAMPLE = Path(__file__).parents[3] / "examples" / "steel_ball.toml"
STUDY = f"""\
measure = ["impacts"]
[case]
file = "{EXAMPLE}"
[axes]
"damper.start" = {{ from = -0.5, to = 0.5, count = 100000 }}
"""


@pytest.mark.skipif(sys.platform == "win32", reason="terminals are made otherwise")
@pytest.mark.slow
def test_bar_and_ctrl_c(tmp_path: Path) -> None:
    """A terminal shows a bar with share, rate and remaining time; Ctrl-C ends with code 130 and how to resume."""
    (tmp_path / "study.toml").write_text(STUDY)
    own_end, other_end = pty.openpty()
    shown = bytearray()

    def read() -> None:
        while True:
            try:
                shown.extend(os.read(own_end, 4096))
            except OSError:  # the other end is closed
                return

    process = subprocess.Popen(
        [sys.executable, "-m", "rattlebox.cli", "sweep", "study.toml"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=other_end,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "120"},
    )
    os.close(other_end)
    reader = threading.Thread(target=read)
    reader.start()
    until = time.monotonic() + 60
    while not re.search(rb"\d/s", shown):
        assert time.monotonic() < until and process.poll() is None, bytes(shown)
        time.sleep(0.02)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=20)
    reader.join(timeout=10)
    os.close(own_end)
    text = re.sub(r"\x1b\[[\d;?]*[A-Za-z]", "", shown.decode())
    assert process.returncode == 130
    assert out == b""
    assert re.search(r"[1-9][\d,]* of 100,000 variants .*\d% +[\d,]+/s +\d+:\d\d(:\d\d)? left", text)
    last = text.strip().splitlines()[-1]
    done = re.fullmatch(
        r"stopped; ([\d,]+) of 100,000 variants are in study.zarr, and the same command resumes from there", last
    )
    assert done, text
    assert int(done[1].replace(",", "")) == progress_of(tmp_path / "study.zarr").done > 0
