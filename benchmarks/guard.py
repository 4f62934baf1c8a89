"""Compares the speed of this source tree with that of an earlier commit, in pairs: `make bench-guard [SINCE=COMMIT]`.

SINCE is a commit or a tag; without it, it is the last tag, and as long as there is none, the commit that began the current
version. Both trees are compiled with the same options for this processor into build/guard, and each measurement runs in
a process of its own, the two packages in turns. The median ratio of the pairs is printed: the CPU time of the earlier
package over that of this one, so that 1.1 means that this one is 10 % faster. The range that holds half of the pairs shows
how steady the machine is. All jobs run on one thread.

The exit code is 1 if this tree is slower by more than 5 % in any job: the upper end of the range is below 0.95.

impact      ensemble of 2000 starts of the reference case, 5 s each, in a sweep
dem N       N spheres in a box that is shaken along z with 10 g, fill 0.36, from a lattice
"""

from __future__ import annotations

import argparse
import inspect
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[1]
BUILDS = HERE / "build" / "guard"
SLOWER = 0.95
"""Ratio below which a job is slower."""

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
STEPS = {100: 500_000, 1000: 60_000, 10_000: 5000, 100_000: 350}
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


def seconds_of(job: str, package: Path) -> float:
    """Return the CPU time that a job takes [s], in a process with the package in a folder.

    Raises
    ------
    SystemExit
        When the job fails, or another package than that of the folder is imported.
    """
    # Without `site`, no editable installation comes before the folder.
    libraries = [path for path in sys.path if path.endswith("site-packages")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(package), *libraries])}
    command = [sys.executable, "-S", str(Path(__file__).resolve()), "--measure", job]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{job} failed with the package of {package}:\n{done.stderr[-2000:]}")
    seconds, file = done.stdout.split(maxsplit=1)
    if package not in Path(file.strip()).parents:
        raise SystemExit(f"{file.strip()} was imported instead of the package in {package}")
    return float(seconds)


def git(*arguments: str) -> str:
    """Return what a git command prints; nothing where it fails."""
    return subprocess.run(["git", *arguments], cwd=HERE, capture_output=True, text=True, check=False).stdout.strip()


def reference() -> tuple[str, str]:
    """Return the commit to compare with by default, and why."""
    if tag := git("describe", "--tags", "--abbrev=0"):
        return tag, "the last tag"
    version = re.search(r'^version = ".*"$', (HERE / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)
    begun = git("log", "-1", "--format=%h", "-S", version[0] if version else "", "--", "pyproject.toml")
    return begun, "the commit that began this version, since there is no tag"


def installed(tree: Path, folder: Path) -> Path:
    """Compile a source tree for this processor; return the folder with its package."""
    options = ["--no-deps", "--no-build-isolation", "--quiet", "--disable-pip-version-check", "--upgrade"]
    from rattlebox.core.choose import choice  # not in the processes that measure: the other package may lack it

    level = choice()[0]
    settings = [f"-Cbuild-dir={folder / 'cmake'}", f"-Ccmake.define.RATTLEBOX_LEVELS={level}"]
    command = [sys.executable, "-m", "pip", "install", *options, *settings, "--target", folder / "package", tree]
    subprocess.run(command, check=True)
    return folder / "package"


def installed_commit(commit: str) -> Path:
    """Compile a commit for this processor, once; return the folder with its package.

    Raises
    ------
    SystemExit
        When there is no such commit.
    """
    number = git("rev-parse", "--verify", f"{commit}^{{commit}}")
    if not number:
        raise SystemExit(f"{commit!r} is no commit or tag of this repository\n  try: git log --oneline")
    folder = BUILDS / number
    if not (folder / "package").exists():
        tree = folder / "tree"
        tree.mkdir(parents=True, exist_ok=True)
        archive = subprocess.run(["git", "archive", number], cwd=HERE, capture_output=True, check=True)
        subprocess.run(["tar", "-x"], cwd=tree, input=archive.stdout, check=True)
        installed(tree, folder)
    return folder / "package"


def compare(job: str, ours: Path, theirs: Path, pairs: int) -> tuple[str, bool]:
    """Return in words how a job of one package compares with that of another, and whether it is slower by 5 %.

    Parameters
    ----------
    job
        Name.
    ours, theirs
        Folders with the packages.
    pairs
        Number of pairs; the first package changes from pair to pair.
    """
    ratios, seconds = [], []
    for turn in range(pairs):
        times = {}
        for package in (ours, theirs) if turn % 2 else (theirs, ours):
            times[package] = seconds_of(job, package)
        ratios.append(times[theirs] / times[ours])
        seconds.append(times[ours])
    low, middle, high = statistics.quantiles(ratios, n=4) if pairs > 1 else ratios * 3
    spread = f"half of {pairs} pairs: {low:.3f} to {high:.3f}"
    return f"{job:12} {middle:.3f} ({spread}), {statistics.median(seconds):.2f} s a run", high < SLOWER


def main() -> None:
    """Print the median ratio of each job; exit with 1 if one is slower."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--since", metavar="COMMIT", help="commit or tag to compare with")
    parser.add_argument("--pairs", type=int, default=10)
    parser.add_argument("--job", action="append", choices=JOBS, help="only these jobs")
    parser.add_argument("--measure", choices=JOBS, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        measure(options.measure)
        return
    commit, why = (options.since, "as asked") if options.since else reference()
    theirs, ours = installed_commit(commit), installed(HERE, BUILDS / "this")
    print(f"time of {commit} ({why}) over that of this tree")
    slower = []
    for job in options.job or JOBS:
        words, is_slower = compare(job, ours, theirs, options.pairs)
        print(words, flush=True)
        slower += [job] * is_slower
    if slower:
        raise SystemExit(f"slower by more than 5 %: {', '.join(slower)}")


if __name__ == "__main__":
    main()
