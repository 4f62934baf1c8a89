"""Scripts of the single-ball case for other programs: availability and run times.

Each script prints one JSON line with cpu_s and impacts, and writes impacts (t0) and samples (time, position) to the JSON
file that is its last argument.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

LIMIT = 600  # s for one script


@dataclass(frozen=True)
class Peer:
    """One setting of one script, 5 s unless stated otherwise."""

    name: str
    script: str
    arguments: tuple[str, ...]
    module: str = ""
    environment: dict[str, str] = field(default_factory=dict)


_CASE = ("5", "centre", "const")
PEERS = (
    Peer("SciPy LSODA 1e-9", "w1_scipy.py", ("LSODA", "1e-9", "1e-12", *_CASE), "scipy"),
    Peer("SciPy LSODA 1e-12", "w1_scipy.py", ("LSODA", "1e-12", "1e-15", *_CASE), "scipy"),
    Peer("SciPy DOP853 1e-12", "w1_scipy.py", ("DOP853", "1e-12", "1e-15", *_CASE), "scipy"),
    Peer(
        "SciPy DOP853 1e-12, flight steps of 0.1 ms",
        "w1_scipy.py",
        ("DOP853", "1e-12", "1e-15", *_CASE),
        "scipy",
        {"W1_MAXSTEP": "1e-4"},
    ),
    Peer("Python loop, velocity Verlet, 1 us", "w1_scipy.py", ("fixed-vv", "1e-6", "0", *_CASE), "numpy"),
    Peer("Siconos Moreau-Jean (hard impacts), 10 us", "w1_siconos.py", ("1e-5", "5"), "siconos.kernel"),
    Peer("Octave lsode 1e-9", "w1_octave_ode45.m", ("lsode", "1e-9", "1e-4", "5")),
    Peer("Octave ode45 with events 1e-9", "w1_octave_ode45.m", ("events", "1e-9", "2e-5", "5")),
)


def measure(folder: Path) -> Iterator[tuple[str, dict[str, Any] | str]]:
    """Run the scripts; yield each name with its results, or with the reason why it did not run."""
    for peer in PEERS:
        program = _program(folder / peer.script, peer.module)
        yield peer.name, program if isinstance(program, str) else _run(program, peer.arguments, peer.environment)


def single_steps(folder: Path, contact_time: float, first_touch: float) -> dict[str, Any] | str:
    """Return the time that the multi-time-step program of the reference study takes for 5 s, from its time per step.

    Parameters
    ----------
    folder
        Folder with w1_octave_seed.m, which calls ode45 once every 5 microseconds of flight and 30 nanoseconds of contact.
    contact_time
        Sum of the durations of all contacts in 5 s [s].
    first_touch
        Time of the first contact [s]; the program runs until shortly after it.
    """
    program = _program(folder / "w1_octave_seed.m", "")
    if isinstance(program, str):
        return program
    result = _run(program, (repr(first_touch + 1.5e-5),), {})
    if isinstance(result, str):
        return result
    flight, contact = result["ms_per_call_free"] / 1e3, result["ms_per_call_contact"] / 1e3
    calls = (5 - contact_time) / 5e-6, contact_time / 3e-8
    result["cpu_s"] = calls[0] * flight + calls[1] * contact
    return result


def _program(script: Path, module: str) -> list[str] | str:
    """Return the command that runs a script, or the reason why it cannot run."""
    if not script.exists():
        return f"no {script.name} in the folder"
    if script.suffix == ".m":
        octave = shutil.which("octave-cli")
        return "octave-cli is not installed" if octave is None else [octave, "--no-gui", "-qf", str(script)]
    for python in (sys.executable, shutil.which("python3", path="/usr/bin:/usr/local/bin")):
        if (
            python
            and subprocess.run([python, "-c", f"import {module}"], capture_output=True, check=False).returncode == 0
        ):
            return [python, str(script)]
    return f"no Python installation has the module {module}"


def _run(program: list[str], arguments: tuple[str, ...], environment: dict[str, str]) -> dict[str, Any] | str:
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "out.json"
        command = [*program, *arguments, str(out)]
        alone = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        try:
            done = subprocess.run(
                command,
                capture_output=True,
                text=True,
                timeout=LIMIT,
                check=False,
                env={**os.environ, **alone, **environment},
            )
        except subprocess.TimeoutExpired:
            return f"took more than {LIMIT} s"
        if done.returncode != 0:
            return f"failed: {(done.stderr.strip().splitlines() or ['no message'])[-1]}"
        line = json.loads(done.stdout.strip().splitlines()[-1])
        written = json.loads(out.read_text(encoding="utf-8"))
        line["times"] = [impact["t0"] for impact in written["impacts"]]
        line["z_at_1"] = next((s[1] for s in written["samples"] if abs(s[0] - 1) < 1e-9), None)
        return dict(line)
