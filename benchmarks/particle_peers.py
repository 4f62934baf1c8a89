"""Other programs on the box of particles.py: availability, common initial beds, and run times.

FOLDER contains their input scripts: make_initial.py and settle.py, in.lammps, in.lammps_legacy, in.liggghts and
w2_yade.py. LAMMPS and LIGGGHTS run on two cores as two ranks that divide the box along x, with the mpirun in the folder
of the program; YADE uses two threads. LIGGGHTS and YADE shake with another phase, which does not matter after the
periods before the measurement.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from argparse import ArgumentTypeError
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

SKIN = 0.0006  # m; fastest for LAMMPS and LIGGGHTS; the script of YADE sets its own
_COPIED = ("make_initial.py", "settle.py", "in.lammps", "in.lammps_legacy", "in.liggghts", "w2_yade.py")


@dataclass(frozen=True)
class Program:
    """Program that runs an input script, by its name or its path."""

    name: str
    binary: str
    deck: str

    @property
    def here(self) -> bool:
        """Whether the program is installed."""
        return shutil.which(self.binary) is not None

    def seconds(self, where: Path, count: int, cores: int, warm: int, steps: int) -> float:
        """Return the time of some steps after warm-up, from the bed in a folder [s]."""
        environment = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        if self.deck.endswith(".py"):
            command = [self.binary, "-n", "-x", f"-j{cores}", self.deck]
            environment |= {"W2_N": f"{count}", "W2_WARM": f"{warm}", "W2_WIN": f"{steps}", "W2_NWIN": "1"}
            pattern, windows = r"YADE N=.* wall_s ([\d.]+)", 1
        else:
            values = {"n": count, "warm": warm, "win": steps, "nwin": 1, "skin": SKIN, "px": cores}
            variables = [word for key, value in values.items() for word in ("-var", key, str(value))]
            command = [self.binary, "-in", self.deck, *variables]
            if cores > 1:
                neighbour = Path(self.binary).with_name("mpirun")
                mpirun = str(neighbour) if neighbour.exists() else "mpirun"
                command = [mpirun, "--bind-to", "none", "-np", str(cores), *command]
            environment["OMP_NUM_THREADS"] = "1"
            pattern, windows = r"Loop time of ([\d.eE+-]+)", 2
        command = ["taskset", "-c", "0" if cores == 1 else "0,1", *command]
        done = subprocess.run(command, cwd=where, capture_output=True, text=True, env=environment)
        times = re.findall(pattern, done.stdout + done.stderr)
        if len(times) != windows:
            raise RuntimeError(f"{self.name} failed in {where}: {(done.stdout + done.stderr)[-2000:]}")
        return float(times[-1])


PROGRAMS = (
    Program("LAMMPS granular", "lmp", "in.lammps"),
    Program("LAMMPS gran/hertz/history", "lmp", "in.lammps_legacy"),
    Program("LIGGGHTS", "liggghts", "in.liggghts"),
    Program("YADE", "yade", "w2_yade.py"),
)


def another_lammps(text: str) -> Program:
    """Parse NAME=PATH of a second LAMMPS, which runs the first input script."""
    name, _, path = text.partition("=")
    if not (name and path):
        raise ArgumentTypeError(f"{text!r} is not of the form NAME=PATH, such as 'LAMMPS 2025=/opt/lammps/bin/lmp'")
    return Program(name, path, "in.lammps")


def prepare_folder(folder: Path, where: Path, count: int, amplitude: float, bed: Path, edge: float) -> None:
    """Copy the input scripts and their bed to a folder; create and store the bed if it does not exist.

    Parameters
    ----------
    folder, where
        Folder of the scripts, and working folder.
    count, edge
        Number of particles, and edge of the box [m].
    amplitude
        Amplitude of the acceleration [m/s^2].
    bed
        CSV file: positions relative to the centre of the box, velocities and spins after 25 periods in LAMMPS, (count, 9).
    """
    for name in _COPIED:
        text = (folder / name).read_text()
        (where / name).write_text(re.sub(r"\b(A equal |A=)98\.1/", rf"\g<1>{amplitude}/", text))
    quiet: Any = {"cwd": where, "check": True, "stdout": subprocess.DEVNULL}
    subprocess.run([sys.executable, "make_initial.py", str(count), "."], **quiet)
    data = where / f"w2_{count}.data"
    middle = np.array([edge / 2, edge / 2, edge / 2, 0, 0, 0, 0, 0, 0])
    if not bed.exists():
        subprocess.run([sys.executable, "settle.py", str(count), "2" if count >= 10_000 else "1"], **quiet)
        atoms, velocities = (
            np.array([line.split() for line in part.splitlines() if line.strip()], dtype=float)
            for part in data.read_text().split("Atoms")[1].split("Velocities")
        )
        np.savetxt(bed, np.hstack([atoms[:, 4:7], velocities[:, 1:7]]) - middle, delimiter=",")
    columns = np.loadtxt(bed, delimiter=",", ndmin=2) + middle
    head = data.read_text().split("Atoms")[0]
    rows = [[f"{value:.9g}" for value in row] for row in columns]
    atom_lines = "".join(f"{i} 1 0.003 7850 {' '.join(row[:3])}\n" for i, row in enumerate(rows, 1))
    velocity_lines = "".join(f"{i} {' '.join(row[3:])}\n" for i, row in enumerate(rows, 1))
    data.write_text(f"{head}Atoms\n\n{atom_lines}\nVelocities\n\n{velocity_lines}")
