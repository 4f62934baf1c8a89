"""Compares the speed of this source tree with that of another one, in pairs: `python benchmarks/guard.py OTHER`.

OTHER is a source tree with compiled cores, such as a worktree of the commit before. Each
measurement runs in a process of its own, the two trees in turns. The median ratio of the pairs is printed: the CPU time of
the other tree over that of this one, so that 1.1 means that this one is 10 % faster. The range that holds half of the
pairs shows how steady the machine is. All jobs run on one thread.

impact      ensemble of 2000 starts of the reference case, 5 s each, in a sweep
dem N       N spheres in a box that is shaken along z with 10 g, fill 0.36, from a lattice
"""

from __future__ import annotations

import argparse
import inspect
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[1]

IMPACT = """
duration = "5 s"
structure = { kind = "sdof", mass = "20 kg", stiffness = "80 kN/m", damping = "25.3 N s/m" }
load = { kind = "half_sine", amplitude = "5 kN", duration = "1 ms" }

[damper]
ball = { radius = "33.17 mm", material = "steel" }
gap = "0.4 mm"
contact = { kind = "tsuji", alpha = 0.006313, ending = "zero_overlap" }
"""
STARTS = 2000

DEM = """
duration = {duration}
output = {{ times = [0.0] }}
method = {{ kind = "dem", dt = {dt}, threads = 1 }}

[structure]
kind = "shaker"
motion = {{ kind = "harmonic", amplitude = "98.1 m/s^2", frequency = "50 Hz", direction = "z" }}

[damper]
cavity = {{ kind = "box", size = [{edge}, {edge}, {edge}] }}
contact = {{ kind = "tsuji", restitution = 0.75 }}
friction = 0.3
direction = "z"
velocity = [0.5, 0.3, -1.0]
packing = {{ kind = "lattice", noise = 0.9 }}

[damper.particles]
material = {{ name = "soft steel", density = 7850, young = 1e8, poisson = 0.3 }}
diameter = 3e-3
count = {count}
"""
DT, FILL, DIAMETER = 1.4549e-5, 0.36, 3e-3
STEPS = {1000: 60_000, 10_000: 5000, 100_000: 350}
"""Steps by number of particles."""


def impact() -> Callable[[], Any]:
    """Return a job: the impact ensemble."""
    import numpy as np

    import rattlebox as rb

    case = _case(IMPACT)
    starts = {"damper.start": np.linspace(-0.99, 0.99, STARTS)}
    # Before 0.2.0 the number of threads was called so.
    count = "workers" if "workers" in inspect.signature(rb.sweep).parameters else "threads"
    return lambda: rb.sweep(case, starts, ["impact_share"], progress=False, **{count: 1})


def dem(count: int) -> Callable[[], Any]:
    """Return a job: particles in a shaken box.

    Parameters
    ----------
    count
        Number of particles.
    """
    import rattlebox as rb

    edge = (count * 3.141592653589793 / 6 * DIAMETER**3 / FILL) ** (1 / 3)
    case = _case(DEM.format(duration=STEPS[count] * DT, dt=DT * (1 + 1e-9), count=count, edge=edge))
    return lambda: rb.simulate(case)


def _case(text: str) -> Any:
    import rattlebox as rb

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.toml"
        path.write_text(text, encoding="utf-8")
        return rb.Case.from_file(path)


JOBS: dict[str, Callable[[], Callable[[], Any]]] = {
    "impact": impact,
    **{f"dem {count}": (lambda count=count: dem(count)) for count in STEPS},
}


def measure(job: str) -> None:
    """Print the CPU time that a job takes [s], and the file of the package that ran it."""
    work = JOBS[job]()
    start = time.process_time()
    work()
    seconds = time.process_time() - start
    import rattlebox

    print(seconds, rattlebox.__file__)


def seconds_of(job: str, tree: Path) -> float:
    """Return the CPU time that a job takes [s], in a process with the package of a source tree.

    Raises
    ------
    SystemExit
        When the job fails, or another package than the tree's is imported.
    """
    environment = {**os.environ, "PYTHONPATH": str(tree / "src")}
    command = [sys.executable, str(Path(__file__).resolve()), "--measure", job]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{job} failed with the package of {tree}:\n{done.stderr[-2000:]}")
    seconds, file = done.stdout.split(maxsplit=1)
    if (tree / "src") not in Path(file.strip()).parents:
        raise SystemExit(
            f"{file.strip()} was imported instead of the package of {tree}: an editable installation comes first\n"
            "  try: a Python environment with the dependencies alone"
        )
    return float(seconds)


def compare(job: str, other: Path, pairs: int) -> str:
    """Return in words how a job of this tree compares with the other tree's.

    Parameters
    ----------
    job
        Name.
    other
        Source tree.
    pairs
        Number of pairs; the first tree changes from pair to pair.
    """
    ratios, ours = [], []
    for turn in range(pairs):
        times = {}
        for tree in (HERE, other) if turn % 2 else (other, HERE):
            times[tree] = seconds_of(job, tree)
        ratios.append(times[other] / times[HERE])
        ours.append(times[HERE])
    low, middle, high = statistics.quantiles(ratios, n=4) if pairs > 1 else ratios * 3
    return (
        f"{job:12} {middle:.3f} (half of {pairs} pairs: {low:.3f} to {high:.3f}), {statistics.median(ours):.2f} s a run"
    )


def main() -> None:
    """Print the median ratio of each job."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path, nargs="?", metavar="OTHER")
    parser.add_argument("--pairs", type=int, default=10)
    parser.add_argument("--job", action="append", choices=JOBS, help="only these jobs")
    parser.add_argument("--measure", choices=JOBS, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        measure(options.measure)
        return
    if options.other is None:
        parser.error("a source tree to compare with is needed")
    other = options.other.resolve()
    if other == HERE or not (other / "src/rattlebox").is_dir():
        parser.error(f"{other} is not another source tree with the package in src/rattlebox")
    print(f"time of {other} over that of {HERE}")
    for job in options.job or JOBS:
        print(compare(job, other, options.pairs), flush=True)


if __name__ == "__main__":
    main()
