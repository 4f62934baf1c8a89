"""Benchmark of studies of the reference case: `python benchmarks/sweep.py [NAME ...]` prints a table.

packing   a million variants packed by broadcasting, on a grid and in a random design
rate      impacts per second and core in an ensemble of start positions, 5 s each; two cores against one, in pairs
memory    a million trajectories of 0.05 s: resident memory beyond the result
dask      two workers of a Dask cluster against two threads, blocks of seconds
scipy     the same ensemble by SciPy (LSODA, relative tolerance 1e-9), a few members extrapolated

Numbers are the best of three, or the median ratio of three pairs, each pair measured back to back.
"""

from __future__ import annotations

import resource
import statistics
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

import rattlebox as rb
from rattlebox.model.case import Case
from rattlebox.prepare.pack import pack_batch

MILLION = 1_000_000


def grid() -> tuple[Case, dict[str, Any], tuple[int, ...]]:
    """Return a thousand gaps by a thousand amplitudes."""
    gap, amplitude = np.linspace(1e-4, 2e-3, 1000), np.linspace(1e3, 5e3, 1000)
    columns = {"damper.gap": gap.reshape(-1, 1), "load.amplitude": amplitude.reshape(1, -1)}
    return rb.reference_case(), columns, (1000, 1000)


def random() -> tuple[Case, dict[str, Any], tuple[int, ...]]:
    """Return five parameters drawn at random, all of which enter the elasto-plastic law or the structure."""
    draw = np.random.default_rng(0).uniform
    columns = {
        "structure.mass": draw(10, 30, MILLION),
        "damper.ball.radius": draw(0.02, 0.04, MILLION),
        "damper.gap": draw(1e-4, 2e-3, MILLION),
        "damper.contact.restitution.yield_stress": draw(5e8, 2e9, MILLION),
        "load.amplitude": draw(1e3, 5e3, MILLION),
    }
    return rb.reference_case(rb.Tsuji(restitution=rb.JacksonGreen(), ending="zero_overlap")), columns, (MILLION,)


def packing(design: Callable[[], tuple[Case, Mapping[str, Any], tuple[int, ...]]]) -> dict[str, Any]:
    """Pack a million variants."""
    case, columns, shape = design()
    before = _peak()
    seconds = []
    for _ in range(3):
        start = time.perf_counter()
        pack_batch(case, columns, shape)
        seconds.append(time.perf_counter() - start)
    memory = (_peak() - before) / 2**20
    return {"name": f"packing, {design.__name__}", "seconds": min(seconds), "MiB": memory, "variants": MILLION}


def _peak() -> int:
    """Return the peak memory of this process [bytes]."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def starts(count: int) -> dict[str, Any]:
    """Return start positions across the whole gap."""
    return {"damper.start": rb.linspace(-1, 1, count)}


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Return the time of a function call [s] and its result."""
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def pairs(first: Callable[[], Any], second: Callable[[], Any]) -> float:
    """Return the median ratio of the times of two jobs, each pair back to back, in alternating order."""
    ratios = []
    for turn in range(3):
        a, b = (timed(first)[0], timed(second)[0]) if turn % 2 else (timed(second)[0], timed(first)[0])[::-1]
        ratios.append(a / b)
    return statistics.median(ratios)


def rate(count: int = 20_000) -> Iterator[tuple[str, str]]:
    """Measure impacts per second on one core, and the speed-up with a second core."""
    case = rb.reference_case(duration=5.0)

    def run(threads: int) -> Any:
        return rb.sweep(case, starts(count), ["impacts", "impact_share"], workers=threads, progress=False)

    seconds, study = min((timed(lambda: run(1)) for _ in range(3)), key=lambda pair: pair[0])
    impacts = float(study.impacts.sum())
    yield (
        f"ensemble of {count:,} starts, one core",
        f"{impacts / seconds:,.0f} impacts/s, {1e6 * seconds / impacts:.2f} us each",
    )
    yield "two cores against one", f"{pairs(lambda: run(1), lambda: run(2)):.2f}"
    hard = rb.reference_case(duration=5.0, method=rb.Newton())
    work = partial(rb.sweep, hard, starts(count), ["impacts", "impact_share"], workers=1, progress=False)
    seconds, study = min((timed(work) for _ in range(3)), key=lambda pair: pair[0])
    yield "the same with hard impacts", f"{float(study.impacts.sum()) / seconds:,.0f} impacts/s"


def memory() -> Iterator[tuple[str, str]]:
    """Measure the memory of a million trajectories."""
    case = rb.reference_case(duration=0.05)
    rb.sweep(case, starts(1000), ["impacts", "impact_share"], progress=False)
    before = _peak()
    seconds, study = timed(lambda: rb.sweep(case, starts(MILLION), ["impacts", "impact_share"], progress=False))
    beyond = (_peak() - before - study.nbytes) / 2**20
    yield (
        "a million trajectories",
        f"{seconds:.1f} s, {beyond:.0f} MiB beyond the result of {study.nbytes / 2**20:.0f} MiB",
    )


def dask(count: int = 40_000) -> Iterator[tuple[str, str]]:
    """Compare two Dask workers with two threads."""
    from distributed import Client, LocalCluster

    case = rb.reference_case(duration=5.0)
    run = partial(rb.sweep, case, starts(count), ["impacts", "impact_share"], progress=False)
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        rb.sweep(case, starts(100), ["impacts"], backend=client, progress=False)
        yield (
            "two Dask workers against two threads, time",
            f"{pairs(partial(run, backend=client), partial(run, workers=2)):.3f}",
        )


def scipy(count: int = 100_000, members: int = 3) -> Iterator[tuple[str, str]]:
    """Extrapolate SciPy's time for the ensemble from a few members, against ours on one core."""
    ours, _ = timed(
        lambda: rb.sweep(rb.reference_case(duration=5.0), starts(2000), ["impact_share"], workers=1, progress=False)
    )
    theirs, _ = timed(lambda: [peer(start) for start in np.linspace(-0.9, 0.9, members)])
    ratio = (theirs / members) / (ours / 2000)
    yield (
        f"SciPy LSODA 1e-9, {count:,} starts",
        f"{theirs / members * count / 3600:.1f} h extrapolated, {ratio:,.0f} times ours",
    )


def peer(start: float) -> float:
    """Simulate the reference case with SciPy, with an event at each contact start and end; return the loss in contacts."""
    from scipy.integrate import solve_ivp

    case = rb.reference_case()
    structure, damper, pulse = case.structure, case.dampers[0], case.loads[0].duration
    mass, stiffness, damping, gap = structure.mass, structure.stiffness, structure.damping, damper.gap
    ball = 1.2
    hertz = 4 / 3 * 200e9 / (2 * (1 - 0.3**2)) * damper.balls[0].radius ** 0.5
    dashpot = damper.contact.alpha * (mass * ball / (mass + ball) * hertz) ** 0.5

    def derivative(t: float, y: Any) -> list[float]:
        z, v, s, w, _ = y
        depth = abs(s - z) - gap
        side = 1.0 if s > z else -1.0
        rate = side * (w - v)
        normal = hertz * depth**1.5 if depth > 0 else 0.0
        drag = dashpot * depth**0.25 * rate if depth > 0 else 0.0
        push = 5000.0 * np.sin(np.pi * t / pulse) if t < pulse else 0.0
        force = side * (normal + drag)
        return [v, (push - stiffness * z - damping * v + force) / mass, w, -force / ball, drag * rate]

    def touch(t: float, y: Any) -> float:
        return float(abs(y[2] - y[0]) - gap)

    touch.terminal = True  # type: ignore[attr-defined]
    y = np.array([0.0, 0.0, start * gap, 0.0, 0.0])
    t, stops = 0.0, [pulse, 5.0]
    while t < 5.0:
        part = solve_ivp(
            derivative, (t, stops[0]), y, method="LSODA", rtol=1e-9, atol=1e-12, events=touch, max_step=1e-2
        )
        t, y = part.t[-1], part.y[:, -1]
        if t >= stops[0] and len(stops) > 1:
            stops.pop(0)
        elif part.status == 1:  # step past the event, so that it is not detected again
            part = solve_ivp(derivative, (t, t + 1e-9), y, method="LSODA", rtol=1e-9, atol=1e-12)
            t, y = part.t[-1], part.y[:, -1]
    return float(y[4])


def packings() -> Iterator[tuple[str, str]]:
    """Measure the packing of a million variants."""
    for design in (grid, random):
        result = packing(design)
        yield result["name"], f"{result['seconds']:.3f} s, {result['MiB']:.0f} MiB"


PARTS = {"packing": packings, "rate": rate, "memory": memory, "dask": dask, "scipy": scipy}


def main() -> None:
    """Print a table of the selected measurements."""
    print("| case | result |\n|---|---|")
    for name in sys.argv[1:] or PARTS:
        for title, result in PARTS[name]():
            print(f"| {title} | {result} |", flush=True)


if __name__ == "__main__":
    main()
