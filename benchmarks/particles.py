"""Benchmark of the dem engine with a shaken box and a settled bed: `python benchmarks/particles.py [NAME ...]`.

scaling   particle-steps per second with 100 to 100,000 particles on one core and two, and memory per particle
rest      the same for settled beds, in which contacts persist
cores     one core and two alternately over short windows of one bed, `cores [rest] [N ...]`, by the latency of a barrier
          between the threads, since hosts of virtual machines move the cores (needs a C++ compiler)
peers     the same start, time step and physics in this and other programs: `peers FOLDER [rest] [N ...]`, with the FOLDER of
          their input scripts (particle_peers.py); programs that are not installed are skipped. `--program NAME=PATH` adds
          another LAMMPS. LAMMPS creates the beds first; `--beds FOLDER` stores them (shaken_1000.csv, rest_1000.csv) and
          reuses stored ones
sizes     10,000 particles in the box with a third of the fill in particles that are two, five and ten times as large
wide      time per particle and step in a bed, and in wide beds of the same depth and state, which separates the influence of
          memory from that of density: `wide BED`, with one of the stored files

The box is a cube of 3 mm spheres (E = 100 MPa, e = 0.75, mu = 0.3, fill 0.36), shaken along z with 10 g at 50 Hz; the time
step is 14.549 us. Programs alternate; the table contains the median of `--turns` (three) and the ratio to it. A program
that takes longer than 100 s for a turn has no second turn. `--cores 1` skips two cores. Contacts, between particles and at
walls, are means over the measured time.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from particle_peers import PROGRAMS, Program, another_lammps, prepare_folder

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.prepare.particles import pack_particles, prepare
from rattlebox.prepare.settle import insert

DT, PERIOD, LONG = 1.4549e-5, 0.02, 100.0
DIAMETER, DENSITY, FILL = 3e-3, 7850.0, 0.36
MATERIAL = rb.Material(name="soft steel", density=DENSITY, young=1e8, poisson=0.3)
WINDOWS = {100: (5, 50), 1000: (5, 10), 10_000: (5, 5), 100_000: (1, 1)}
"""Periods before the measurement, and during it."""
WIDE = {"shaken": ((0.2, 0.3), (1, 1)), "rest": ((0.2, 0.5),)}
"""The same for wide beds: dense at the floor, and dilute in flight."""
WINDOW = 0.1
"""Length of a window on one core, for `cores` [s]."""
LATENCIES = (0.0, 0.06, 0.2, 10.0)
"""Limits of barrier latency [us]: threads of one core, cores that share a cache, other cores."""
SAMPLES = 101
"""Number of samples of the contacts, at all phases of the shaking."""
AMPLITUDES = {"shaken": 98.1, "rest": 0.0}
"""Amplitude of the acceleration [m/s^2]."""


def edge_of(count: float) -> float:
    """Return the edge of the box [m]."""
    return float((count * np.pi * DIAMETER**3 / 6 / FILL) ** (1 / 3))


def shaken(count: int, amplitude: float = AMPLITUDES["shaken"], across: int = 1, larger: float = 1) -> rb.Case:
    """Return the box, `across` times as wide as high, on a shaker that starts from rest.

    With `larger`, a third of the fill is in particles that are larger by this factor.
    """
    edge = edge_of(count / across**2)
    particles = [rb.Particles(material=MATERIAL, diameter=DIAMETER, count=count)]
    if larger > 1:
        few = max(1, round(count / 2 / larger**3))
        particles.append(rb.Particles(name="large", material=MATERIAL, diameter=larger * DIAMETER, count=few))
        edge = edge_of(count + few * larger**3)
    motion = rb.Harmonic(amplitude=f"{amplitude} m/s^2", frequency=1 / PERIOD, phase=np.pi / 2, direction="z")
    return rb.Case(
        structure=rb.Shaker(motion=motion),
        damper=rb.ParticleDamper(
            particles=particles,
            cavity=rb.Box(size=(across * edge, across * edge, edge)),
            contact=rb.Tsuji(restitution=0.75),
            friction=rb.Mindlin(0.3),
            direction="z",
            packing=rb.Lattice(noise=0.45) if larger == 1 else at_random(edge, particles),
        ),
        duration=1000.0,
        method=rb.Dem(dt=DT),
        output=rb.Output(rate=50),
    )


def at_random(edge: float, particles: list[rb.Particles]) -> rb.Positions:
    """Return random positions in the box."""
    radii = np.concatenate([np.full(each.count, each.radius) for each in particles])
    return rb.Positions(positions=insert(rb.Box(size=(edge,) * 3), radii, seed=1))


def window_of(count: int) -> tuple[float, float]:
    """Return the periods before and during the measurement for the largest tabulated number that is not above `count`."""
    return WINDOWS[max((n for n in WINDOWS if n <= count), default=min(WINDOWS))]


def steps_of(periods: float) -> int:
    """Return the number of steps in a number of periods."""
    return round(periods * PERIOD / DT)


def timed(packed: _core.DemProblem, warm: int, steps: int, threads: int) -> dict[str, float]:
    """Return particle-steps per second after warm-up, and bytes, contacts and candidate pairs per particle."""
    dem = _core.Dem(packed)
    dem.threads = threads
    dem.run(warm)
    state, before = dem.save(), dem.counts().seconds
    dem.run(warm + steps)
    after = dem.counts()
    dem.restore(state)  # repeat the run without the clock to sample the contacts
    samples = []
    for sample in range(1, SAMPLES + 1):
        dem.run(warm + sample * steps // SAMPLES)
        samples.append((len(dem.contacts(0).first), dem.counts().candidates))
    count = len(packed.cavities[0].radius)
    contacts, candidates = np.mean(samples, axis=0) / count
    rate = count * steps / (after.seconds - before)
    return {"rate": rate, "bytes": after.memory_bytes / count, "contacts": contacts, "candidates": candidates}


def run_process(job: str, *arguments: str, cores: int) -> dict[str, float]:
    """Run one measurement in a subprocess on its own cores."""
    command = [sys.executable, __file__, job, *arguments]
    if shutil.which("taskset"):
        command = ["taskset", "-c", "0" if cores == 1 else "0,1", *command]
    result: dict[str, float] = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return result


def set_state(packed: _core.DemProblem, columns: np.ndarray) -> _core.DemProblem:
    """Replace positions, velocities and spins; a bed in motion has contacts with overlap."""
    position, velocity, spin = np.split(columns, 3, axis=1)
    (cavity,) = packed.cavities
    return packed.replace(cavities=[cavity.replace(position=position, velocity=velocity, spin=spin)])


def one(kind: str, count: str, cores: str, start: str = "") -> None:
    """Print the JSON line of one measurement, for `run_process`."""
    n = int(count)
    warm, window = window_of(n)
    packed = pack_particles(prepare(shaken(n, amplitude=AMPLITUDES[kind])))
    if start:
        packed = set_state(packed, np.loadtxt(start, delimiter=",", ndmin=2))
    elif kind == "rest":  # a lattice that falls
        print(json.dumps(timed(packed, steps_of(25), max(1, 2_000_000 // n), int(cores))))
        return
    print(json.dumps(timed(packed, steps_of(warm), steps_of(window), int(cores))))


def one_mixed(larger: str) -> None:
    """Print the JSON line of a mixture of sizes, for `run_process`."""
    packed = pack_particles(prepare(shaken(10_000, larger=float(larger))))
    print(json.dumps(timed(packed, steps_of(1), steps_of(4), threads=1)))


def one_wide(kind: str, bed: str, across: str, window: str) -> None:
    """Print the JSON line of a wide bed made of a bed and its mirror images, for `run_process`."""
    columns, n = np.loadtxt(bed, delimiter=",", ndmin=2), int(across)
    edge = edge_of(len(columns))
    parts = []
    for i, j in np.ndindex(n, n):
        part = columns.copy()
        part[:, [0, 3, 7, 8]] *= (-1) ** i
        part[:, [1, 4, 6, 8]] *= (-1) ** j
        part[:, :2] += (np.array([i, j]) - (n - 1) / 2) * edge
        parts.append(part)
    packed = pack_particles(prepare(shaken(len(columns) * n**2, AMPLITUDES[kind], n)))
    packed = set_state(packed, np.concatenate(parts))
    warm, steps = (steps_of(periods) for periods in WIDE[kind][int(window)])
    print(json.dumps(timed(packed, warm, steps, threads=1)))


def sizes(turns: int) -> Iterator[tuple[str, str]]:
    """Yield the rate for each size of the larger particles."""
    results = [{n: run_process("one_mixed", str(n), cores=1) for n in (1, 2, 5, 10)} for _ in range(turns)]
    for n in results[0]:
        rates = [turn[n]["rate"] / 1e6 for turn in results]
        contacts = results[0][n]["contacts"]
        text = f"{statistics.median(rates):.1f} million particle-steps/s, {contacts:.2f} contacts per particle"
        yield f"10,000 particles and some {n} times as large" if n > 1 else "10,000 particles, one core", text


def scaling(kind: str = "shaken", turns: int = 3) -> Iterator[tuple[str, str]]:
    """Yield rate and memory for each number of particles."""
    for count in WINDOWS:
        results = [tuple(run_process("one", kind, str(count), str(n), cores=n) for n in (1, 2)) for _ in range(turns)]
        single = statistics.median(a["rate"] for a, _ in results)
        ratio = statistics.median(b["rate"] / a["rate"] for a, b in results)
        yield f"{count:,} particles, {kind}, one core", f"{single / 1e6:.1f} million particle-steps/s"
        yield "two cores against one", f"{ratio:.2f}"
        yield "memory per particle", f"{results[0][0]['bytes']:.0f} B"
        yield "contacts per particle", f"{results[0][0]['contacts']:.2f}"


def barrier_latency(folder: Path) -> Callable[[], float]:
    """Return a function that measures the latency of a barrier between two threads [us]."""
    core_folder = Path(__file__).parents[1] / "core"
    command = [
        os.environ.get("CXX", "c++"),
        "-O2",
        "-std=c++20",
        "-pthread",
        f"-I{core_folder}",
        "-o",
        folder / "barrier",
    ]
    subprocess.run([*command, Path(__file__).with_name("barrier.cpp")], check=True)
    program = subprocess.Popen([folder / "barrier"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def measure() -> float:
        assert program.stdin and program.stdout
        program.stdin.write("\n")
        program.stdin.flush()
        return float(program.stdout.readline())

    return measure


def cores(kind: str, counts: list[int], seconds: float) -> Iterator[tuple[str, str]]:
    """Yield the speed-up of two cores, by barrier latency."""
    with tempfile.TemporaryDirectory() as folder:
        latency = barrier_latency(Path(folder))
        for count in counts or [1000, 10_000, 100_000]:
            yield from _alternate(kind, count, seconds, latency)


def _alternate(kind: str, count: int, seconds: float, latency: Callable[[], float]) -> Iterator[tuple[str, str]]:
    packed = pack_particles(prepare(shaken(count, amplitude=AMPLITUDES[kind])))
    pair = _core.Dem(packed), _core.Dem(packed)
    step = steps_of(25 if kind == "rest" else window_of(count)[0])
    for threads, dem in enumerate(pair, 1):
        dem.threads = threads
        dem.run(step)

    def measure(dem: Any) -> float:
        before = dem.counts().seconds
        dem.run(step)
        return float(dem.counts().seconds - before)

    step += 100
    steps = max(1, round(100 * WINDOW / measure(pair[0])))
    measure(pair[1])
    results: list[tuple[float, float, float, float]] = []  # latency before and after, time on one core and on two
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        step += steps
        first = latency()
        times = [measure(dem) for dem in (pair if len(results) % 2 else pair[::-1])]
        single, double = times if len(results) % 2 else times[::-1]
        results.append((first, latency(), single, double))
    for low, high in pairwise(LATENCIES):
        some = [(a, b) for early, late, a, b in results if low <= min(early, late) and max(early, late) < high]
        if len(some) < 4:
            continue
        least, middle, most = statistics.quantiles([a / b for a, b in some], n=4)
        rate = count * steps / statistics.median(b for _, b in some) / 1e6
        text = f"two cores against one {middle:.2f} (half of {len(some)} windows: {least:.2f} to {most:.2f}), "
        yield (
            f"{count:,} particles, {kind}, barrier latency {low:g} to {high:g} us",
            text + f"{rate:.1f} million particle-steps/s",
        )


def wide(bed: str, turns: int) -> Iterator[tuple[str, str]]:
    """Yield the time per particle and step of a bed, and of wide beds made of it."""
    kind, count = Path(bed).stem.split("_")
    results: dict[tuple[int, int], list[dict[str, float]]] = {
        (w, a): [] for w in range(len(WIDE[kind])) for a in (1, 3, 10)
    }
    for _ in range(turns):
        for (window, across), each in results.items():
            each.append(run_process("one_wide", kind, bed, str(across), str(window), cores=1))
    for (window, across), each in results.items():
        cost = statistics.median(1e9 / a["rate"] for a in each)
        ratio = statistics.median(b["rate"] / a["rate"] for a, b in zip(each, results[window, 1], strict=True))
        text = f"{cost:.1f} ns per particle and step, x {ratio:.2f}, "
        text += f"{each[0]['contacts']:.2f} contacts, {each[0]['candidates']:.2f} candidates"
        yield f"{int(count) * across**2:,} particles, {kind}, as deep as {int(count):,}", text


def peers(
    folder: Path,
    kind: str,
    counts: list[int],
    programs: tuple[Program, ...],
    beds: Path | None,
    cores: list[int],
    turns: int,
) -> Iterator[tuple[str, str]]:
    """Yield the rates of all programs from the same start."""
    for program in programs:
        if not program.here:
            yield program.name, "not installed"
    for count in counts or WINDOWS:
        with tempfile.TemporaryDirectory() as place:
            where = Path(place)
            bed = (beds or where) / f"{kind}_{count}.csv"
            prepare_folder(folder, where, count, AMPLITUDES[kind], bed, edge_of(count))
            for number in cores:
                here = [program for program in programs if program.here]
                yield from _compare(where, bed, count, number, kind, here, turns)


def _compare(
    where: Path, bed: Path, count: int, cores: int, kind: str, programs: list[Program], turns: int
) -> Iterator[tuple[str, str]]:
    warm, steps = (steps_of(periods) for periods in window_of(count))
    own: list[dict[str, float]] = []
    seconds: dict[str, list[float]] = {program.name: [] for program in programs}
    done: set[str] = set()
    for _ in range(turns):
        own.append(run_process("one", kind, str(count), str(cores), str(bed), cores=cores))
        for program in programs:
            if program.name not in done:
                begun = time.monotonic()
                try:
                    seconds[program.name].append(program.seconds(where, count, cores, warm, steps))
                except RuntimeError as error:
                    print(error, file=sys.stderr)
                    done.add(program.name)
                if time.monotonic() - begun > LONG:
                    done.add(program.name)
    title = f"{count:,} particles, {kind}, {cores} core(s): "
    rates = [a["rate"] / 1e6 for a in own]
    text = f"{statistics.median(rates):.1f} million particle-steps/s"
    yield title + "Rattlebox", f"{text}, {own[0]['contacts']:.2f} contacts per particle"
    for name, each in seconds.items():
        if not each:
            yield title + name, "failed"
            continue
        theirs = [count * steps / 1e6 / taken for taken in each]
        ratio = statistics.median(a / b for a, b in zip(rates, theirs, strict=False))
        yield title + name, f"{statistics.median(theirs):.1f} million particle-steps/s, 1/{ratio:.2f}"


ONE = {"one": one, "one_mixed": one_mixed, "one_wide": one_wide}
"""Jobs that run in a subprocess."""


def main() -> None:
    """Print a table of the requested measurements."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("job", nargs="?", choices=["scaling", "rest", "cores", "peers", "sizes", "wide", *ONE])
    parser.add_argument("arguments", nargs="*")
    parser.add_argument("--beds", type=Path)
    parser.add_argument("--program", type=another_lammps, action="append", default=[])
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=100.0, help="duration for each bed of `cores` [s]")
    parser.add_argument("--cores", type=int, nargs="+", choices=[1, 2], default=[1, 2])
    arguments = parser.parse_intermixed_args()
    if arguments.job in ONE:
        ONE[arguments.job](*arguments.arguments)
        return
    rows: list[Iterator[tuple[str, str]]]
    if arguments.job in ("peers", "wide") and not arguments.arguments:
        parser.error(f"{arguments.job} needs a {'folder of decks' if arguments.job == 'peers' else 'file of a bed'}")
    if arguments.job == "peers":
        folder, *rest = arguments.arguments
        kind = "rest" if "rest" in rest else "shaken"
        counts = [int(word) for word in rest if word != kind]
        if arguments.beds:
            arguments.beds.mkdir(parents=True, exist_ok=True)
        rows = [
            peers(
                Path(folder),
                kind,
                counts,
                (*PROGRAMS, *arguments.program),
                arguments.beds,
                arguments.cores,
                arguments.turns,
            )
        ]
    elif arguments.job == "cores":
        kind = "rest" if "rest" in arguments.arguments else "shaken"
        rows = [cores(kind, [int(word) for word in arguments.arguments if word != kind], arguments.seconds)]
    elif arguments.job == "sizes":
        rows = [sizes(arguments.turns)]
    elif arguments.job == "wide":
        rows = [wide(arguments.arguments[0], arguments.turns)]
    else:
        rows = [
            scaling(kind, arguments.turns)
            for job, kind in {"scaling": "shaken", "rest": "rest"}.items()
            if arguments.job in (job, None)
        ]
    print("| case | result |\n|---|---|")
    for table in rows:
        for title, value in table:
            print(f"| {title} | {value} |", flush=True)


if __name__ == "__main__":
    main()
