"""The shaken bed, and single collisions, that lammps_bed.py, liggghts_bed.py and yade_bed.py compute in other programs.

200 beads in a closed cube that moves up and down at 50 Hz and 10 g. Every program starts from the same random
positions, has the same time step, and is sampled at the same phases. As runs are chaotic, averages over
several random packings are compared. The collisions are deterministic and are compared one by one: two beads that meet
head-on, and one that hits a wall at an angle.

References: Y. Tsuji, T. Tanaka, T. Ishida (1992), Powder Technology 71, 239, doi:10.1016/0032-5910(92)88030-L. R. D.
Mindlin, H. Deresiewicz (1953), J. Appl. Mech. 20, 327, doi:10.1115/1.4010702.
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import rattlebox as rb

COUNT, DIAMETER, DENSITY, MODULUS, POISSON, RESTITUTION, FRICTION = 200, 3e-3, 7850.0, 1e8, 0.3, 0.75, 0.3
FREQUENCY, ACCELERATION, GRAVITY = 50.0, 98.1, 9.81
EDGE = (COUNT * np.pi / 6 * DIAMETER**3 / 0.36) ** (1 / 3)
AMPLITUDE = ACCELERATION / (2 * np.pi * FREQUENCY) ** 2
WARM, MEASURED, PHASES, STEPS = 20, 40, 20, 276  # periods, periods, samples in a period, steps between samples
STEP = 1 / FREQUENCY / PHASES / STEPS  # 5 % of the Rayleigh time, and 50 steps in a contact at 1 m/s
MASS = COUNT * DENSITY * np.pi / 6 * DIAMETER**3
EQUAL_DASHPOTS = math.sqrt((2 - POISSON) / (2 - 2 * POISSON))
"""`damping` of `Mindlin` at which the tangential dashpot has the coefficient of the normal one, in N s/m."""

COLLISION_STEP, COLLISION_STEPS, AHEAD = STEP / 5, 1200, 20e-6  # s, steps, s before first touch
SPEEDS = (0.1, 1.0)  # m/s, of two beads towards each other
SLOW = 0.01  # m/s, of a bead that hits a wall: so slowly that levers do not depend on the overlap
ANGLES = (5.0, 11.0, 20.0, 40.0, 70.0)  # degrees from the normal


class Beads(NamedTuple):
    """Initial positions [m], relative to a corner of the cube, and velocities [m/s], (n, 3) each."""

    positions: Any
    velocities: Any


class Task(NamedTuple):
    """Beads in the cube, and numbers for the input script of a program.

    `phase` is the number of steps between two samples, `warm` the number before the first one, `steps` the number from there
    to the end; `amplitude` [m] and `gravity` [m/s^2] are zero for a collision; `mu` is the coefficient of friction,
    `modulus` that of Young [Pa].
    """

    beads: Beads
    step: float
    warm: int
    steps: int
    phase: int
    amplitude: float
    gravity: float
    mu: float = FRICTION
    modulus: float = MODULUS

    def numbers(self) -> dict[str, float | int]:
        """Return everything that an input script needs except the beads."""
        bed = {"poisson": POISSON, "e": RESTITUTION, "edge": EDGE}
        return {**bed, **self._asdict(), "density": DENSITY, "radius": DIAMETER / 2, "frequency": FREQUENCY}


class Samples(NamedTuple):
    """Samples of a run, one row per time: time [s], kinetic and rotation energy [J], height and vertical velocity [m, m/s]
    of the centre of mass, contacts between beads.
    """

    time: Any
    kinetic: Any
    rotation: Any
    height: Any
    velocity: Any
    contacts: Any


class Law(NamedTuple):
    """Contact of a program in terms of Rattlebox: arguments of `Tsuji`, and `damping` of `Mindlin`."""

    alpha: float
    ending: str
    damping: float


def random_beads(seed: int) -> Beads:
    """Return beads at rest, at random sites of a cubic lattice and shifted at random."""
    rng = np.random.default_rng(seed)
    per_side = int(np.ceil(COUNT ** (1 / 3)))
    cell = EDGE / per_side
    sites = rng.permutation(per_side**3)[:COUNT]
    grid = np.stack(np.unravel_index(sites, (per_side,) * 3), axis=1) + 0.5
    positions = grid * cell + rng.uniform(-1, 1, (COUNT, 3)) * (cell - DIAMETER) / 2 * 0.9
    return Beads(positions, np.zeros((COUNT, 3)))


def bed(seed: int, friction: float = FRICTION, coarseness: float = 1.0, stiffness: float = 1.0) -> Task:
    """Return the shaken bed of a random packing, with a longer step and a larger modulus by some factors."""
    steps = round(STEPS / coarseness)
    warm, measured = WARM * PHASES * steps, MEASURED * PHASES * steps
    modulus = stiffness * MODULUS
    return Task(random_beads(seed), STEP * STEPS / steps, warm, measured, steps, AMPLITUDE, GRAVITY, friction, modulus)


def head_on(speed: float) -> Task:
    """Return two beads that approach each other along z with a speed [m/s]."""
    middle = np.full(3, EDGE / 2)
    away = np.array([0, 0, (DIAMETER + AHEAD * speed) / 2])
    return _collision(
        Beads(np.array([middle - away, middle + away]), np.array([[0, 0, speed / 2], [0, 0, -speed / 2]]))
    )


def oblique(angle: float) -> Task:
    """Return a bead that hits the floor at an angle from the normal [degrees]."""
    along, down = SLOW * math.sin(math.radians(angle)), SLOW * math.cos(math.radians(angle))
    above = np.array([[EDGE / 2, EDGE / 2, DIAMETER / 2 + AHEAD * down]])
    return _collision(Beads(above, np.array([[along, 0, -down]])))


def _collision(beads: Beads) -> Task:
    """Return a collision, which lasts shorter than the run."""
    return Task(beads, COLLISION_STEP, 0, COLLISION_STEPS, COLLISION_STEPS, 0.0, 0.0)


def case(task: Task, law: Law) -> rb.Case:
    """Return the case of Rattlebox for beads with a contact law."""
    bead = rb.Material(name="bead", density=DENSITY, young=task.modulus, poisson=POISSON)
    places = task.beads.positions - EDGE / 2
    damper = rb.ParticleDamper(
        particles=rb.Particles(material=bead, diameter=DIAMETER, count=len(places)),
        cavity=rb.Box(size=(EDGE, EDGE, EDGE)),
        contact=rb.Tsuji(alpha=law.alpha, ending=law.ending),
        friction=rb.Mindlin(task.mu, damping=law.damping),
        direction="z",
        gravity=(0, 0, -task.gravity),
        packing=rb.Positions(positions=places.tolist(), velocities=task.beads.velocities.tolist()),
    )
    motion = rb.Harmonic(amplitude=AMPLITUDE, frequency=FREQUENCY, unit="m")
    return rb.Case(
        structure=rb.Shaker(motion=motion) if task.amplitude else rb.Fixed(),
        damper=damper,
        duration=(task.warm + task.steps) * task.step,
        method=rb.Dem(dt=task.step * (1 + 1e-9)),
        output=rb.Output(rate=1 / (task.phase * task.step)),
    )


def rattlebox(task: Task, law: Law) -> dict[str, Any]:
    """Return the averages of the shaken bed in Rattlebox; a run that fails prints its status, as with too long a step."""
    run = rb.simulate(case(task, law), progress=False)
    if not run.ok:
        print(f"Rattlebox: {run.status}")
    late = run.motion.time.values >= (task.warm - 0.5) * task.step
    motion, energy = run.motion.isel(time=late), run.energy.isel(time=late)
    relative = motion.momentum.values[:, 0, 2] / MASS
    velocity = relative + motion.base_velocity.values[:, 2]
    kinetic = energy.kinetic_energy.values.sum(axis=1)
    kinetic = kinetic + MASS * 0.5 * (velocity**2 - relative**2)  # in the frame of the ground
    height = motion.centre_of_mass.values[:, 0, 2] + EDGE / 2 + AMPLITUDE * np.sin(_angle(motion.time.values))
    rotation, contacts = energy.rotation_energy.values.sum(axis=1), motion.contacts.values[:, 0, 0]
    return averages(Samples(motion.time.values, kinetic, rotation, height, velocity, contacts))


def _angle(time: Any, lag: float = 0.0) -> Any:
    """Return the phase of the cube, which moves as its sine [rad]; `lag` in periods."""
    return 2 * np.pi * (FREQUENCY * time - lag)


def averages(samples: Samples, *, lag: float = 0.0) -> dict[str, Any]:
    """Return averages over whole periods, and the kinetic energy by phase [mJ].

    The height is that above the floor. The power that the walls give to the bed is that of its mass times its acceleration
    over the velocity of the cube, which after integration by parts is -M <v a> with the acceleration a of the cube.
    `lag` is the part of a period by which the cube is behind A sin(2 pi f t).
    """
    last = MEASURED * PHASES
    time, kinetic, rotation, height, velocity, contacts = (np.asarray(values)[:last] for values in samples)
    angle = _angle(time, lag)
    acceleration = -ACCELERATION * np.sin(angle)
    phase = np.round(angle / (2 * np.pi) * PHASES).astype(int) % PHASES
    return {
        "kinetic energy (mJ)": 1e3 * kinetic.mean(),
        "rotation (mJ)": 1e3 * rotation.mean(),
        "centre of mass (mm)": 1e3 * (height - AMPLITUDE * np.sin(angle)).mean(),
        "dissipated power (mW)": -1e3 * MASS * np.mean(velocity * acceleration),
        "contacts": contacts.mean(),
        "by phase": 1e3 * np.bincount(phase, kinetic, PHASES) / np.bincount(phase, minlength=PHASES),
    }


def exact_collision(task: Task, law: Law) -> tuple[Any, Any]:
    """Return velocities [m/s] and spins [rad/s] after a collision in Rattlebox, (n, 3) each."""
    particles = rb.simulate(case(task, law), progress=False).arrays.particles
    return particles.velocity, particles.spin


def collision_table(theirs: Callable[[Task], tuple[Any, Any]], law: Law) -> list[tuple[str, float, float]]:
    """Return rows of a quantity, its value in a program and in Rattlebox; spins times radius over tangential velocity."""
    rows = []
    for speed in SPEEDS:
        values = [run[0] for run in (theirs(head_on(speed)), exact_collision(head_on(speed), law))]
        rows.append((f"restitution at {speed:g} m/s", *((v[1, 2] - v[0, 2]) / speed for v in values)))
    for angle in ANGLES:
        results = theirs(oblique(angle)), exact_collision(oblique(angle), law)
        along = SLOW * math.sin(math.radians(angle))
        rows.append((f"tangential restitution at {angle:g} degrees", *(v[0, 0] / along for v, _ in results)))
        rows.append((f"spin at {angle:g} degrees", *(abs(w[0, 1]) * DIAMETER / 2 / along for _, w in results)))
    return rows


def comparison(theirs: list[dict[str, Any]], ours: list[dict[str, Any]]) -> list[tuple[str, Any, Any, float]]:
    """Return rows of a quantity, mean and standard error in two programs, and the difference over its standard error."""
    rows = []
    for name in theirs[0]:
        if name == "by phase":
            continue
        pair = [np.array([run[name] for run in runs]) for runs in (theirs, ours)]
        means = [values.mean() for values in pair]
        errors = [values.std(ddof=1) / np.sqrt(values.size) for values in pair]
        error = float(np.hypot(*errors))
        difference = float(means[1] - means[0]) / error if error else 0.0
        rows.append((name, (means[0], errors[0]), (means[1], errors[1]), difference))
    return rows


def run_files(command: list[str], files: Mapping[str, str], results: tuple[str, ...]) -> list[str]:
    """Return the texts of files that a program writes when it runs in a folder with other files.

    Raises
    ------
    RuntimeError
        If the program fails, with the end of its output.
    """
    with tempfile.TemporaryDirectory() as place:
        for name, text in files.items():
            (Path(place) / name).write_text(text)
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        done = subprocess.run(command, cwd=place, capture_output=True, text=True, env=environment)
        if done.returncode or not all((Path(place) / name).exists() for name in results):
            raise RuntimeError(done.stdout[-2000:] + done.stderr[-1000:])
        return [(Path(place) / name).read_text() for name in results]


def lammps_data(task: Task) -> str:
    """Return the beads as a data file of LAMMPS and LIGGGHTS."""
    bounds = "".join(f"{-0.1 * EDGE} {1.3 * EDGE} {axis}lo {axis}hi\n" for axis in "xyz")
    rows = list(zip(task.beads.positions, task.beads.velocities, strict=True))
    atoms = "".join(f"{i} 1 {DIAMETER} {DENSITY} {x} {y} {z}\n" for i, ((x, y, z), _) in enumerate(rows, 1))
    speeds = "".join(f"{i} {u} {v} {w} 0 0 0\n" for i, (_, (u, v, w)) in enumerate(rows, 1))
    return f"bed\n\n{len(rows)} atoms\n1 atom types\n\n{bounds}\nAtoms\n\n{atoms}\nVelocities\n\n{speeds}"


def last_frame(dump: str, count: int) -> tuple[Any, Any]:
    """Return velocities and spins by id from the last frame of a dump of LAMMPS or LIGGGHTS: id, velocity, spin."""
    rows = np.array([line.split() for line in dump.splitlines()[-count:]], dtype=float)
    rows = rows[rows[:, 0].argsort()]
    return rows[:, 1:4], rows[:, 4:7]


def main(
    name: str,
    default: str,
    law: Law,
    samples: Callable[[str, Task], dict[str, Any]],
    collision: Callable[[str, Task], tuple[Any, Any]],
) -> None:
    """Run a program and Rattlebox, and print the comparison of beds and of collisions."""
    parser = argparse.ArgumentParser(description=f"Compare a shaken bed in {name} with Rattlebox.")
    parser.add_argument("--program", default=default, help=f"path of {name} (default: {default})")
    parser.add_argument(
        "--packings", type=int, default=6, help="random packings of the bed; 0 computes collisions only"
    )
    parser.add_argument("--friction", type=float, default=FRICTION, help="coefficient of friction of the bed")
    parser.add_argument("--step", type=float, default=1.0, help="factor by which the step of the bed is longer")
    parser.add_argument("--stiffness", type=float, default=1.0, help="factor by which the modulus of the bed is larger")
    options = parser.parse_args()
    print(f"{'':36}{name:>12}{'Rattlebox':>12}")
    for title, theirs, ours in collision_table(lambda task: collision(options.program, task), law):
        print(f"{title:36}{theirs:>12.5g}{ours:>12.5g}")
    if not options.packings:
        return
    variant = options.friction, options.step, options.stiffness
    tasks = [bed(seed, *variant) for seed in range(1, options.packings + 1)]
    runs = [samples(options.program, task) for task in tasks], [rattlebox(task, law) for task in tasks]
    print(f"{'':24}{name:>22}{'Rattlebox':>22}{'difference / standard error':>30}")
    for title, *pairs, difference in comparison(*runs):
        cells = "".join(f"{mean:>12.5g} +- {2 * error:<6.2g}" for mean, error in pairs)
        print(f"{title:24}{cells}{difference:>16.1f}")
    print(f"averages over {len(tasks)} random packings with twice their standard error; kinetic energy by phase (mJ):")
    print(np.round([np.mean([run["by phase"] for run in one], axis=0) for one in runs], 3))
