"""The bed of shaken_bed.py in LIGGGHTS.

`python benchmarks/liggghts_bed.py` runs both programs from several random packings each and prints a table. LIGGGHTS is
installed by `apt-get install liggghts`.

`model hertz` converts a restitution by the exact relation of a contact that ends at zero overlap, and its two dashpots
have the same damping ratio, as in Rattlebox. `tangential history` stores the displacement of the tangential spring, so
that its force also grows when the contact is pressed together; in Rattlebox it never grows by that. A sliding contact
has no tangential dashpot; until it slides, Coulomb's limit does not include the dashpot. The cube is a mesh of twelve
triangles.

References: C. Kloss, C. Goniva, A. Hager, S. Amberger, S. Pirker (2012), Models, algorithms and validation for opensource
DEM and CFD-DEM, Progress in Computational Fluid Dynamics 12, 140, doi:10.1504/PCFD.2012.047457.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import shaken_bed
from shaken_bed import EDGE, RESTITUTION, Law, Samples, Task

import rattlebox as rb

SCRIPT = """units si
newton off
atom_style granular
atom_modify map array
boundary f f f
communicate single vel yes
read_data bed.data
neighbor 0.0006 bin
neigh_modify delay 0 every 1 check yes
fix m1 all property/global youngsModulus peratomtype {modulus}
fix m2 all property/global poissonsRatio peratomtype {poisson}
fix m3 all property/global coefficientRestitution peratomtypepair 1 {e}
fix m4 all property/global coefficientFriction peratomtypepair 1 {mu}
pair_style gran model hertz tangential history
pair_coeff * *
fix g all gravity {gravity} vector 0.0 0.0 -1.0
fix box all mesh/surface file box.stl type 1 curvature 1e-5
fix wall all wall/gran model hertz tangential history mesh n_meshes 1 meshes box
{motion}
fix i all nve/sphere
compute ke all ke
compute rot all erotate/sphere
compute c all contact/atom
compute n all reduce sum c_c
variable ke equal c_ke
variable rot equal c_rot
variable n equal c_n
variable zc equal xcm(all,z)
variable vz equal vcm(all,z)
timestep {step}
thermo 100000
run {warm}
fix out all ave/time {phase} 1 {phase} v_ke v_rot v_zc v_vz v_n file out.txt
dump last all custom {steps} last.txt id vx vy vz omegax omegay omegaz
run {steps}
"""
MOTION = "fix move all move/mesh mesh box wiggle amplitude 0. 0. {amplitude} period {period}"


def law() -> Law:
    """Return the contact of LIGGGHTS in terms of Rattlebox.

    With S = 2 E* sqrt(R* d), its 2 sqrt(5/6) beta sqrt(S m*), beta = -ln e / sqrt(pi^2 + ln^2 e), is
    alpha sqrt(m* A) d^(1/4) with alpha = sqrt(5) beta.
    """
    return Law(float(rb.alpha_of_restitution(RESTITUTION, "zero_overlap")), "zero_overlap", 1.0)


def cube() -> str:
    """Return the cube as an STL file of twelve triangles."""
    facets = []
    for axis, side in itertools.product(range(3), (0.0, EDGE)):
        corners = np.insert([[0, 0], [0, EDGE], [EDGE, EDGE], [EDGE, 0]], axis, side, axis=1)
        for triangle in (corners[[0, 1, 2]], corners[[0, 2, 3]]):
            lines = "".join(f"  vertex {x} {y} {z}\n" for x, y, z in triangle)
            facets.append(f"facet normal 0 0 0\n outer loop\n{lines} endloop\nendfacet\n")
    return f"solid box\n{''.join(facets)}endsolid box\n"


def _run(program: str, task: Task) -> list[str]:
    numbers = {**task.numbers(), "period": 1 / shaken_bed.FREQUENCY}
    script = SCRIPT.format(motion=MOTION.format(**numbers) if task.amplitude else "", **numbers)
    files = {"bed.data": shaken_bed.lammps_data(task), "in.bed": script, "box.stl": cube()}
    return shaken_bed.run_files([program, "-in", "in.bed"], files, ("out.txt", "last.txt"))


def samples(program: str, task: Task) -> dict[str, Any]:
    """Return the averages of a run."""
    step, *values, contacts = np.loadtxt(_run(program, task)[0].splitlines()).T
    return shaken_bed.averages(Samples(step * task.step, *values, contacts / 2))


def collision(program: str, task: Task) -> tuple[Any, Any]:
    """Return velocities [m/s] and spins [rad/s] after a collision."""
    return shaken_bed.last_frame(_run(program, task)[1], len(task.beads.positions))


if __name__ == "__main__":
    shaken_bed.main("LIGGGHTS", "liggghts", law(), samples, collision)
