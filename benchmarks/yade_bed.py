"""The bed of shaken_bed.py in YADE.

`python benchmarks/yade_bed.py` runs both programs from several random packings each and prints a table. YADE is installed
by `apt-get install yade`.

`Ip2_FrictMat_FrictMat_MindlinPhys(en=)` of 2023 converts a restitution by the exact relation of a contact that ends at zero
force. YADE gives a `wall` or `box` the radius of the bead that touches it, so that contacts with walls have the
stiffness of two beads, 1/sqrt(2) of that of a plane. Here the walls are therefore spheres of 100 000 radii. The
tangential spring keeps its force when the contact opens; in Rattlebox the force falls with the stiffness. The tangential
dashpot has the coefficient of the normal one, and none while the contact slides; until then Coulomb's limit does
not include it.

References: V. Smilauer et al. (2021), Yade documentation, 3rd edition, doi:10.5281/zenodo.5705394.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import shaken_bed
from shaken_bed import DIAMETER, EDGE, EQUAL_DASHPOTS, RESTITUTION, Law, Samples, Task

import rattlebox as rb

SCRIPT = """
import json, math, sys
import numpy as np
task = json.load(open("task.json"))
material = O.materials.append(FrictMat(young=task["modulus"], poisson=task["poisson"], density=task["density"],
    frictionAngle=math.atan(task["mu"])))
beads = []
for place, velocity in zip(task["places"], task["velocities"]):
    beads.append(O.bodies.append(sphere(place, task["radius"], material=material)))
    O.bodies[beads[-1]].state.vel = velocity
walls = [O.bodies.append(sphere(centre, task["wall_radius"], material=material, fixed=True)) for centre in task["walls"]]
for wall in walls:
    O.bodies[wall].mask = 3
for bead in beads:
    O.bodies[bead].mask = 1
restitution = MatchMaker(algo="val", val=task["e"])
rows = []
def sample():
    states = [O.bodies[bead].state for bead in beads]
    kinetic = sum(0.5 * s.mass * s.vel.squaredNorm() for s in states)
    rotation = sum(0.5 * s.inertia[0] * s.angVel.squaredNorm() for s in states)
    height, velocity = (sum(values) / len(states) for values in ([s.pos[2] for s in states], [s.vel[2] for s in states]))
    contacts = sum(i.isReal and max(i.id1, i.id2) < len(beads) for i in O.interactions)
    rows.append([O.time, kinetic, rotation, height, velocity, contacts])
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], avoidSelfInteractionMask=2, verletDist=-0.1),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_MindlinPhys(en=restitution, es=restitution)],
        [Law2_ScGeom_MindlinPhys_Mindlin()]),
]
if task["amplitude"]:  # the engine moves walls as a cosine
    O.engines += [HarmonicMotionEngine(A=(0, 0, task["amplitude"]), f=(0, 0, task["frequency"]), fi=(0, 0, -math.pi / 2),
        ids=walls)]
O.engines += [NewtonIntegrator(damping=0, gravity=(0, 0, -task["gravity"]))]
O.dt = task["step"]
if task["warm"]:  # 0 would run without end
    O.run(task["warm"], True)
for _ in range(task["steps"] // task["phase"]):
    sample()
    O.run(task["phase"], True)
np.savetxt("out.txt", rows)
np.savetxt("last.txt", [[*O.bodies[bead].state.vel, *O.bodies[bead].state.angVel] for bead in beads])
sys.exit(0)
"""
WALL_RADIUS = 1e5 * DIAMETER / 2


def law() -> Law:
    """Return the contact of YADE in terms of Rattlebox."""
    return Law(float(rb.alpha_of_restitution(RESTITUTION, "zero_force")), "zero_force", EQUAL_DASHPOTS)


def _run(program: str, task: Task) -> list[Any]:
    middle, away = np.full(3, EDGE / 2), np.eye(3) * (EDGE / 2 + WALL_RADIUS)
    beads = {"places": task.beads.positions.tolist(), "velocities": task.beads.velocities.tolist()}
    walls = {"walls": [*(middle - away).tolist(), *(middle + away).tolist()], "wall_radius": WALL_RADIUS}
    numbers = {name: value for name, value in task.numbers().items() if name != "beads"}
    files = {"task.json": json.dumps({**numbers, **beads, **walls}), "bed.py": SCRIPT}
    texts = shaken_bed.run_files([program, "-n", "-x", "-j1", "bed.py"], files, ("out.txt", "last.txt"))
    return [np.loadtxt(text.splitlines(), ndmin=2) for text in texts]


def samples(program: str, task: Task) -> dict[str, Any]:
    """Return the averages of a run; velocities are those of half a step before the time of the positions."""
    time, *values = _run(program, task)[0].T
    return shaken_bed.averages(Samples(time - task.step / 2, *values))


def collision(program: str, task: Task) -> tuple[Any, Any]:
    """Return velocities [m/s] and spins [rad/s] after a collision."""
    last = _run(program, task)[1]
    return last[:, :3], last[:, 3:]


if __name__ == "__main__":
    shaken_bed.main("YADE", "yade", law(), samples, collision)
