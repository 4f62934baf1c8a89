"""What the comparisons with other programs in benchmarks/ share, and their collisions (slow, if a program is installed)."""

import importlib
import math
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from support.exact import oblique

import rattlebox as rb

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def module(monkeypatch):
    """Return a function that imports a module of benchmarks/ by name."""
    monkeypatch.syspath_prepend(BENCHMARKS)
    yield importlib.import_module
    for name in ("shaken_bed", "lammps_bed", "liggghts_bed", "yade_bed"):
        sys.modules.pop(name, None)


def test_beads_start_apart_inside_the_cube(module):
    """No two beads touch each other or a wall, and packings differ."""
    bed = module("shaken_bed")
    first, second = (bed.random_beads(seed).positions for seed in (1, 2))
    apart = np.linalg.norm(first[:, None] - first, axis=2) + bed.EDGE * np.eye(bed.COUNT)
    assert apart.min() > bed.DIAMETER
    assert first.min() > bed.DIAMETER / 2 and first.max() < bed.EDGE - bed.DIAMETER / 2
    assert not np.allclose(first, second)


@pytest.mark.parametrize(
    ("name", "e"), [("lammps_bed", 0.8157416640), ("liggghts_bed", 0.75), ("yade_bed", 0.75)], ids=lambda value: value
)
def test_converted_dampings_give_the_restitution(module, name, e):
    """LIGGGHTS and YADE give the restitution that is asked for, each with its own end of the contact; LAMMPS another one."""
    law = module(name).law()
    assert float(rb.restitution_of_alpha(law.alpha, law.ending)) == pytest.approx(e, abs=1e-9)


def test_dashpots_are_equal(module):
    """A tangential dashpot with the factor has the coefficient of the normal one at any overlap: sqrt(5/6) 2 b sqrt(k m)."""
    bed = module("shaken_bed")
    stiffness = oblique.mindlin_ratio(bed.POISSON)  # tangential over that of the force over the overlap
    normal, tangential = math.sqrt(5), bed.EQUAL_DASHPOTS * 2 * math.sqrt(5 / 6) * math.sqrt(stiffness)
    assert tangential == pytest.approx(normal)


@pytest.mark.parametrize("lag", [0.0, 0.25])
def test_averages_of_a_known_motion(module, lag):
    """A bed that lags behind the cube takes M a v sin(lag) / 2; energy by phase and height are those that were put in."""
    bed = module("shaken_bed")
    time = np.arange(bed.WARM * bed.PHASES, (bed.WARM + bed.MEASURED) * bed.PHASES + 1) / bed.PHASES / bed.FREQUENCY
    angle = 2 * np.pi * (bed.FREQUENCY * time - lag)
    samples = bed.Samples(
        time=time,
        kinetic=2e-3 + 1e-3 * np.sin(angle),
        rotation=np.full(time.size, 3e-3),
        height=4e-3 + bed.AMPLITUDE * np.sin(angle),
        velocity=0.2 * np.sin(angle - 2.0),
        contacts=np.full(time.size, 7),
    )
    found = bed.averages(samples, lag=lag)
    assert found["kinetic energy (mJ)"] == pytest.approx(2)
    assert found["by phase"] == pytest.approx(2 + np.sin(2 * np.pi * np.arange(bed.PHASES) / bed.PHASES))
    assert found["centre of mass (mm)"] == pytest.approx(4)
    # -M <v a> with a = -A w^2 sin: half the product of the amplitudes and the cosine of their difference in phase
    assert found["dissipated power (mW)"] == pytest.approx(1e3 * bed.MASS * 0.2 * bed.ACCELERATION / 2 * math.cos(2.0))


def test_collisions_of_rattlebox(module):
    """The collisions that are compared have the exact restitution, and the oblique ones that of an integration."""
    bed = module("shaken_bed")
    law = module("liggghts_bed").law()
    velocity, _ = bed.exact_collision(bed.head_on(1.0), law)
    assert velocity[1, 2] - velocity[0, 2] == pytest.approx(0.75, abs=5e-4)
    velocity, spin = bed.exact_collision(bed.oblique(11.0), law)
    angle, radius = math.radians(11.0), bed.DIAMETER / 2
    down, along = bed.SLOW * math.cos(angle), bed.SLOW * math.sin(angle)
    hertz = 4 / 3 * bed.MODULUS / (2 * (1 - bed.POISSON**2)) * math.sqrt(radius)
    expected = oblique.Impact(
        alpha=law.alpha,
        ratio=oblique.mindlin_ratio(bed.POISSON),
        friction=bed.FRICTION,
        damping=law.damping,
        stiffness=hertz * radius**2.5 / (bed.MASS / bed.COUNT * down**2),
    ).follow(along / down)
    assert velocity[0, 0] / down == pytest.approx(expected[0], abs=1e-3)
    assert abs(spin[0, 1]) * radius / down == pytest.approx(abs(expected[1]), abs=2e-3)


def test_files_for_other_programs(module):
    """The data file lists every bead once, the cube is closed, and the last frame of a dump is sorted by bead."""
    bed = module("shaken_bed")
    text = bed.lammps_data(bed.bed(1))
    atoms, velocities = text.split("Atoms\n\n")[1].split("\nVelocities\n\n")
    assert len(atoms.splitlines()) == len(velocities.splitlines()) == bed.COUNT
    corners = np.array(
        [line.split()[1:] for line in module("liggghts_bed").cube().splitlines() if "vertex" in line], float
    )
    a, b, c = corners.reshape(12, 3, 3).swapaxes(0, 1)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(6 * bed.EDGE**2)
    velocity, spin = bed.last_frame("ITEM: ATOMS\n9 9 9 9 9 9 9\nITEM: ATOMS\n2 4 5 6 0 0 1\n1 1 2 3 0 0 2\n", 2)
    assert velocity.tolist() == [[1, 2, 3], [4, 5, 6]] and spin[:, 2].tolist() == [2, 1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "program"), [("lammps_bed", "lmp"), ("liggghts_bed", "liggghts"), ("yade_bed", "yade")]
)
def test_collisions_in_other_programs(module, name, program):
    """Restitution agrees to 1e-3 with Rattlebox, and friction in gross sliding to 2 %; otherwise springs differ."""
    if shutil.which(program) is None:
        pytest.skip(f"{program} is not installed")
    other, bed = module(name), module("shaken_bed")
    rows = {
        title: (a, b) for title, a, b in bed.collision_table(lambda task: other.collision(program, task), other.law())
    }
    for title, (theirs, ours) in rows.items():
        if title.startswith("restitution"):
            assert theirs == pytest.approx(ours, abs=1e-3)
        elif title.startswith("tangential"):
            assert theirs == pytest.approx(ours, abs=0.01 if "70" in title else 0.06)
