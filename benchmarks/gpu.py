"""Measures a graphics card against one core: `python benchmarks/gpu.py` prints one table.

--short     the same table from little work, to see that all is there: its rates mean nothing
--small     only a little work, for compute-sanitizer, which this script starts by itself where it is installed

Nothing here takes long: what has not begun after eight minutes is left out, and the table says so.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import gpu_particles
import numpy as np

import rattlebox as rb
from rattlebox.engines.batch import Look, run_block
from rattlebox.engines.gpu_impact import ready
from rattlebox.engines.pack import pack_batch
from rattlebox.model.errors import CaseError
from rattlebox.paper.seed import seed_case

ENOUGH = 480.0
CLOSE = 1e-10
Row = tuple[str, str, str, str]


def starts(count: int, duration: float) -> tuple[Any, tuple[int, ...]]:
    """Pack an ensemble of start positions of the seed's case."""
    case, columns = seed_case(duration=duration), {"damper.start": np.linspace(-0.9, 0.9, count)}
    return pack_batch(case, columns, (count,)), (count,)


def run(count: int, duration: float, look: Look, *, gpu: bool) -> tuple[dict[str, Any], float]:
    """Run an ensemble on the card or on one core; also how long it took."""
    packed, shape = starts(count, duration)
    begin = time.perf_counter()
    found = run_block(packed, shape, 0, count, look, gpu=gpu)
    assert found is not None
    return dict(found), time.perf_counter() - begin


def first_impacts() -> Row:
    """The first impacts of 4096 trajectories: times and speeds."""
    look = Look(measures=["impacts"], last=8)
    (here, _), (there, _) = (run(4096, 0.05, look, gpu=gpu) for gpu in (False, True))
    assert np.array_equal(here["status"], there["status"]) and np.array_equal(here["impacts"], there["impacts"])
    off = max(float(np.nanmax(np.abs(there[name] / here[name] - 1))) for name in ("last_time", "last_approach_speed"))
    return "first impacts, largest relative difference", "", f"{off:.1e}", "ok" if off < CLOSE else f"not below {CLOSE}"


def statistics(count: int) -> Row:
    """Mean impacts and loss of an ensemble over 5 s, in standard errors of the difference."""
    names = ["impacts", "impact_share", "largest_approach_speed"]
    (here, _), (there, _) = (run(count, 5.0, Look(measures=names), gpu=gpu) for gpu in (False, True))
    apart = []
    for name in names:
        a, b = here[name], there[name]
        spread = np.hypot(np.nanstd(a), np.nanstd(b)) / np.sqrt(a.size)
        apart.append(abs(np.nanmean(a) - np.nanmean(b)) / spread)
    worst = max(apart)
    return "means of an ensemble, standard errors apart", "", f"{worst:.2f}", "ok" if worst < 4 else "too far"


def rate(most: int) -> Row:
    """Impacts a second, the best of three, against one core."""
    look = Look(measures=["impacts"])
    few, slow = run(min(most, 2000), 5.0, look, gpu=False)
    one = np.nansum(few["impacts"]) / slow
    run(min(most, 1000), 0.1, look, gpu=True)
    best = 0.0
    for count in (most // 3, most, most):
        found, took = run(count, 5.0, look, gpu=True)
        best = max(best, float(np.nansum(found["impacts"])) / took)
    return "impacts a second", f"{one:.3g}", f"{best:.3g}", f"{best / one:.0f} times one core (goal: 300)"


def same_bits(count: int) -> Row:
    """The same bits twice."""
    look = Look(measures=["impacts", "impact_share"])
    (one, _), (other, _) = (run(count, 2.0, look, gpu=True) for _ in range(2))
    same = all(np.array_equal(one[name], other[name], equal_nan=True) for name in one)
    return "the same bits twice", "", "yes" if same else "no", "ok" if same else "not deterministic"


def sanitized(tool: str) -> Row:
    """What compute-sanitizer finds in a little work."""
    program = shutil.which("compute-sanitizer")
    name = f"compute-sanitizer, {tool}"
    if program is None:
        return name, "", "not installed", ""
    command = [program, "--tool", tool, "--error-exitcode", "9", sys.executable, __file__, "--small"]
    try:
        ended = subprocess.run(command, capture_output=True, text=True, timeout=90)
    except subprocess.TimeoutExpired:
        return name, "", "not done in 90 s", ""
    lines = [line for line in (ended.stdout + ended.stderr).splitlines() if "SUMMARY" in line]
    summary = lines[-1].strip("= ") if lines else f"exit code {ended.returncode}"
    return name, "", summary, "error" if ended.returncode else "ok"


def jobs(short: bool) -> dict[str, Callable[[], Row]]:
    """Return what to measure, by name."""
    return {
        "first impacts": first_impacts,
        "statistics": lambda: statistics(60 if short else 4096),
        "the same bits": lambda: same_bits(150 if short else 20_000),
        "rate": lambda: rate(90 if short else 300_000),
        **gpu_particles.jobs(short),
        "memory check": lambda: sanitized("memcheck"),
        "race check": lambda: sanitized("racecheck"),
    }


def main() -> int:
    """Run all jobs and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--small", action="store_true")
    given = parser.parse_args()
    begin = time.perf_counter()
    try:
        _, told = ready()  # which compiles the kernels, where they are not in the cache
    except CaseError as error:
        print(f"nothing was measured: {error}")
        return 2
    if given.small:
        run(256, 0.1, Look(measures=["impacts", "peak"], samples=11), gpu=True)
        gpu_particles.little()
        return 0
    rows: list[Row] = [("", "one core", "card", ""), ("card", "", told, "")]
    for name, job in jobs(given.short).items():
        if time.perf_counter() - begin > ENOUGH:
            rows.append((name, "", "left out: no time", ""))
            continue
        try:
            rows.append(job())
        except Exception as error:
            rows.append((name, "", f"{type(error).__name__}: {error}", "failed"))
    widths = [max(len(row[i]) for row in rows) for i in range(4)]
    print(f"Rattlebox {rb.__version__}, {time.perf_counter() - begin:.0f} s in all")
    for row in rows:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    return 0


if __name__ == "__main__":
    sys.exit(main())
