"""Times the dem engine on a shaken box and on a bed at rest: `python benchmarks/particles.py [NAME ...]`.

scaling   particle-steps a second with 100 to 100,000 particles, one core and two, and the memory they take
rest      the same for beds that have settled, where contacts persist
peers     one start, step and physics in this and other programs: `peers FOLDER [rest] [N ...]`, with FOLDER of their
          decks (make_initial.py, settle.py, in.lammps, in.lammps_legacy, in.liggghts); what is not installed is left out

A cube of 3 mm spheres (E = 100 MPa, e = 0.75, mu = 0.3, fill 0.36), shaken along z with 10 g at 50 Hz; steps of 14.549 us.
Programs take turns; the median of three turns is told, and the ratio to it.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import rattlebox as rb
from rattlebox.engines.core import core
from rattlebox.engines.dem import pack_dem

DT, PERIOD, TURNS = 1.4549e-5, 0.02, 3
DIAMETER, DENSITY, FILL = 3e-3, 7850.0, 0.36
MATERIAL = rb.Material(name="soft steel", density=DENSITY, young=1e8, poisson=0.3)
WINDOWS = {100: (5, 50), 1000: (5, 10), 10_000: (5, 5), 100_000: (1, 1)}
"""Periods before the clock starts, and while it runs."""


AMPLITUDES = {"shaken": 98.1, "rest": 0.0}
"""Of the acceleration [m/s^2]."""


def shaken(count: int, amplitude: float = AMPLITUDES["shaken"]) -> rb.Case:
    """Return the box, on a shaker that starts from rest."""
    edge = (count * np.pi * DIAMETER**3 / 6 / FILL) ** (1 / 3)
    motion = rb.Harmonic(amplitude=f"{amplitude} m/s^2", frequency=1 / PERIOD, phase=np.pi / 2, direction="z")
    return rb.Case(
        structure=rb.Shaker(motion=motion),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material=MATERIAL, diameter=DIAMETER, count=count),
            cavity=rb.Box(size=(edge, edge, edge)),
            contact=rb.Tsuji(restitution=0.75),
            friction=rb.Mindlin(0.3),
            direction="z",
            packing=rb.Lattice(noise=0.45),
        ),
        duration=1000.0,
        method=rb.Dem(dt=DT),
        output=rb.Output(rate=50),
    )


def steps_of(periods: float) -> int:
    """Return the steps in some periods."""
    return round(periods * PERIOD / DT)


def timed(packed: dict[str, Any], warm: int, steps: int, threads: int) -> dict[str, float]:
    """Return particle-steps a second and bytes a particle of a run of some steps after others."""
    dem = core().Dem(packed)
    dem.threads = threads
    dem.run(warm)
    before = dem.counters()["seconds"]
    dem.run(warm + steps)
    count = len(packed["cavities"][0]["radius"])
    after = dem.counters()
    return {"rate": count * steps / (after["seconds"] - before), "bytes": after["memory_bytes"] / count}


def apart(job: str, *arguments: str, cores: int) -> dict[str, float]:
    """Run one measurement in a process of its own, on its own cores."""
    command = [sys.executable, __file__, job, *arguments]
    if shutil.which("taskset"):
        command = ["taskset", "-c", "0" if cores == 1 else "0,1", *command]
    result: dict[str, float] = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return result


def one(kind: str, count: str, cores: str, start: str = "") -> None:
    """Print the JSON line of one measurement; what `apart` runs."""
    n = int(count)
    warm, window = WINDOWS[n]
    packed, _, _ = pack_dem(shaken(n, amplitude=AMPLITUDES[kind]))
    if start:  # a bed in motion, whose contacts are pressed in
        columns = np.loadtxt(start, delimiter=",", ndmin=2)
        for name, part in zip(("position", "velocity", "spin"), np.split(columns, 3, axis=1), strict=True):
            packed["cavities"][0][name] = np.ascontiguousarray(part)
    elif kind == "rest":  # a lattice that falls
        print(json.dumps(timed(packed, steps_of(25), max(1, 2_000_000 // n), int(cores))))
        return
    print(json.dumps(timed(packed, steps_of(warm), steps_of(window), int(cores))))


def scaling(kind: str = "shaken") -> Iterator[tuple[str, str]]:
    """Rate and memory over the number of particles."""
    for count in WINDOWS:
        turns = [tuple(apart("one", kind, str(count), str(n), cores=n) for n in (1, 2)) for _ in range(TURNS)]
        single = statistics.median(a["rate"] for a, _ in turns)
        ratio = statistics.median(b["rate"] / a["rate"] for a, b in turns)
        yield f"{count:,} particles, {kind}, one core", f"{single / 1e6:.1f} million particle-steps/s"
        yield "two cores against one", f"{ratio:.2f}"
        yield "memory a particle", f"{turns[0][0]['bytes']:.0f} B"


def rest() -> Iterator[tuple[str, str]]:
    """The same of settled beds."""
    return scaling("rest")


# ---- other programs

_DECKS = {
    "LAMMPS granular": ("lmp", "in.lammps"),
    "LAMMPS gran/hertz/history": ("lmp", "in.lammps_legacy"),
    "LIGGGHTS": ("liggghts", "in.liggghts"),
}


def peers(folder: str, *counts: str) -> Iterator[tuple[str, str]]:
    """Rates of all programs, from one start."""
    kind = "rest" if "rest" in counts else "shaken"
    for count in [int(c) for c in counts if c != kind] or WINDOWS:
        with tempfile.TemporaryDirectory() as place:
            where = Path(place)
            start = _start(Path(folder), where, count, kind)
            for cores in (1, 2):
                yield from _compared(where, start, count, cores, kind)


def _start(folder: Path, where: Path, count: int, kind: str) -> Path:
    """A bed that LAMMPS has shaken, or let fall and rest, for 25 periods, for all programs."""
    for deck in folder.iterdir():
        if deck.is_file():
            shutil.copy(deck, where)
    for name in ("in.lammps", "in.lammps_legacy", "in.liggghts"):
        deck = where / name
        deck.write_text(deck.read_text().replace("A equal 98.1/", f"A equal {AMPLITUDES[kind]}/"))
    quiet: Any = {"cwd": where, "check": True, "stdout": subprocess.DEVNULL}
    subprocess.run([sys.executable, "make_initial.py", str(count), "."], **quiet)
    subprocess.run([sys.executable, "settle.py", str(count), "2" if count >= 10_000 else "1"], **quiet)
    text = (where / f"w2_{count}.data").read_text()
    atoms, velocities = (
        np.array([line.split() for line in part.splitlines() if line.strip()], dtype=float)
        for part in text.split("Atoms")[1].split("Velocities")
    )
    edge = (count * np.pi * DIAMETER**3 / 6 / FILL) ** (1 / 3)
    columns = np.hstack([atoms[:, 4:7] - edge / 2, velocities[:, 1:7]])
    path = where / "start.csv"
    np.savetxt(path, columns, delimiter=",")
    return path


def _compared(where: Path, start: Path, count: int, cores: int, kind: str) -> Iterator[tuple[str, str]]:
    programs: dict[str, Callable[[], float]] = {
        "Rattlebox": lambda: apart("one", kind, str(count), str(cores), str(start), cores=cores)["rate"]
    }
    for name, (program, deck) in _DECKS.items():
        if shutil.which(program):
            programs[name] = lambda program=program, deck=deck: _peer(where, program, deck, count, cores)
    rates: dict[str, list[float]] = {name: [] for name in programs}
    for _ in range(TURNS):
        for name, run in programs.items():
            rates[name].append(run())
    own = rates["Rattlebox"]
    for name, each in rates.items():
        ratio = statistics.median(a / b for a, b in zip(own, each, strict=True))
        told = f"{statistics.median(each) / 1e6:.1f} million particle-steps/s"
        yield (
            f"{count:,} particles, {kind}, {cores} core(s): {name}",
            told + ("" if name == "Rattlebox" else f", 1/{ratio:.2f}"),
        )


def _peer(where: Path, program: str, deck: str, count: int, cores: int) -> float:
    warm, window = WINDOWS[count]
    variables = {"n": count, "warm": steps_of(warm), "win": steps_of(window), "nwin": 1, "skin": 0.0006, "px": cores}
    command = [program, "-in", deck, *(w for key, value in variables.items() for w in ("-var", key, str(value)))]
    if cores > 1:
        command = ["mpirun", "--bind-to", "none", "-np", str(cores), *command]
    command = ["taskset", "-c", "0" if cores == 1 else "0,1", *command]
    as_root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_NUM_THREADS": "1"}
    out = subprocess.run(command, cwd=where, check=True, capture_output=True, text=True, env={**os.environ, **as_root})
    seconds = [float(t) for t in re.findall(r"Loop time of ([\d.eE+-]+)", out.stdout)]
    return count * steps_of(window) / seconds[1]


def main(arguments: list[str]) -> None:
    """Print a table of what was asked for."""
    if arguments and arguments[0] == "one":
        one(*arguments[1:])
        return
    jobs: dict[str, Callable[..., Iterator[tuple[str, str]]]] = {"scaling": scaling, "rest": rest, "peers": peers}
    names = arguments[:1] or ["scaling", "rest"]
    print("| what | measured |\n|---|---|")
    for name in names:
        for what, value in jobs[name](*arguments[1:]):
            print(f"| {what} | {value} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
