"""Initial packings: lattices, given positions, walls, overlaps."""

from __future__ import annotations

import math
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.particle_dampers import CAVITIES, balls, case, damper

import rattlebox as rb
from rattlebox.model.overlaps import check_packing
from rattlebox.model.units import registry
from rattlebox.prepare.settle import start_positions


@pytest.mark.parametrize("name", CAVITIES)
@pytest.mark.parametrize("count", [1, 7, 300])
def test_lattices_with_noise_do_not_overlap(name: str, count: int) -> None:
    """Particles on a lattice with the largest noise are inside any cavity and do not overlap."""
    radii = np.linspace(1e-3, 2e-3, count)
    positions = rb.Lattice(noise=1.0, seed=3).place(CAVITIES[name], radii)
    check_packing(CAVITIES[name], positions, radii)
    assert np.array_equal(positions, rb.Lattice(noise=1.0, seed=3).place(CAVITIES[name], radii))
    assert not np.array_equal(positions, rb.Lattice(noise=1.0, seed=4).place(CAVITIES[name], radii))


@pytest.mark.parametrize("name", CAVITIES)
def test_lattices_use_the_whole_cavity(name: str) -> None:
    """The mean square distance of many particles is that of an even spread up to half a cell from the walls."""
    cavity = CAVITIES[name]
    positions = rb.Lattice().place(cavity, np.full(4000, 2e-4))
    anywhere = np.random.default_rng(0).uniform(-0.04, 0.04, (400_000, 3))
    depth = cavity.depth(anywhere)
    assert cavity.volume == pytest.approx(0.08**3 * np.mean(depth > 0), rel=0.02)
    reached = anywhere[depth > 0.5 * (cavity.volume / 4000) ** (1 / 3)]
    assert 0.97 * np.mean(reached**2) < np.mean(positions**2) < 1.03 * np.mean(anywhere[depth > 0] ** 2)


@pytest.mark.parametrize(
    ("cavity", "count"),
    [
        (rb.SphericalCavity(diameter="8.8 mm"), 1),
        (rb.Cylinder(diameter="8.8 mm", length="4.2 mm"), 1),
        (rb.Cylinder(diameter="8.8 mm", length="8.8 mm"), 2),
        (rb.Cylinder(diameter="8.8 mm", length="40 mm", axis="x"), 9),
    ],
)
def test_particles_lie_along_the_middle_of_a_narrow_round_cavity(cavity: Any, count: int) -> None:
    """A lattice in a round cavity too narrow for two rows has one row."""
    radii = np.full(count, 2e-3)
    check_packing(cavity, rb.Lattice().place(cavity, radii), radii)


@pytest.mark.parametrize(
    "cavity",
    [rb.Box(size=(24, 24, 24)), rb.SphericalCavity(radius=24), rb.Box(size=(24, 24, 5e-3)), rb.Box(size=(0.25,) * 3)],
)
def test_few_particles_take_little_memory_in_a_wide_cavity(cavity: Any) -> None:
    """The memory of a lattice scales with the number of particles, not with the cavity, even in a flat one."""
    radii = np.full(20, 5e-4)
    tracemalloc.start()
    positions = rb.Lattice().place(cavity, radii)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2e8
    check_packing(cavity, positions, radii)


def test_a_lattice_reaches_close_packing() -> None:
    """A face-centred lattice is used if a cubic one is too loose: it fills 60 % of a large box."""
    radii = np.full(round(0.6 / (4 / 3 * math.pi * 0.02**3)), 0.02)
    cavity = rb.Box(size=(1, 1, 1))
    check_packing(cavity, rb.Lattice().place(cavity, radii), radii)


def test_overlaps_among_different_sizes() -> None:
    """Overlaps are detected between particles of any sizes, down to 1e-6 of their distance."""
    cavity, generator = rb.Box(size=(1, 1, 1)), np.random.default_rng(1)
    for first, second in [(0.1, 0.001), (0.001, 0.001), (0.1, 0.1)]:
        radii = np.array([first, second, 0.002])
        direction = generator.standard_normal(3)
        direction /= np.linalg.norm(direction)
        for apart, good in [(1 + 1e-6, True), (1 - 1e-6, False)]:
            positions = np.array([np.zeros(3), (first + second) * apart * direction, np.full(3, 0.4)])
            if good:
                check_packing(cavity, positions, radii)
            else:
                with pytest.raises(rb.CaseError, match="particles 0 and 1 overlap"):
                    check_packing(cavity, positions, radii)


def test_the_extent_of_round_cavities() -> None:
    """Extents of a sphere, a cylinder and a box along and across their axes are exact."""
    skew, way = np.array([1.0, 1.0, 1.0]) / np.sqrt(3), np.array([1.0, -1.0, 0.0]) / np.sqrt(2)
    sphere = rb.SphericalCavity(diameter="30 mm")
    assert [sphere.extent(d) for d in (skew, way)] == [0.03, 0.03]
    can = rb.Cylinder(diameter="30 mm", length="50 mm", axis="z")
    assert can.extent(way) == pytest.approx(0.03, rel=1e-15)
    assert can.extent(skew) == pytest.approx((0.05 + np.sqrt(2) * 0.03) / np.sqrt(3), rel=1e-15)
    assert rb.Box(size=("30 mm",) * 3).extent(skew) == pytest.approx(np.sqrt(3) * 0.03, rel=1e-15)


@pytest.mark.parametrize("name", CAVITIES)
def test_walls_agree_with_the_depth(name: str) -> None:
    """Along any line from the centre the depth decreases with a slope of at most one; normals have unit length."""
    cavity = CAVITIES[name]
    directions = np.random.default_rng(2).standard_normal((50, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    inside = np.linspace(0, 0.04, 4001)[:, None, None] * directions
    depth = cavity.depth(inside.reshape(-1, 3)).reshape(4001, 50)
    assert np.all(np.diff(depth, axis=0) <= 1e-12)
    assert np.all(np.abs(np.diff(depth, axis=0)) <= 1e-5 * (1 + 1e-9))
    normals = cavity.walls().axis[np.array(cavity.walls().form) == "plane"]
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(normals)))


@pytest.mark.parametrize("head", ["x,y,z,radius,vz\n", ""])
def test_positions_from_a_file(head: str, tmp_path: Path) -> None:
    """Columns are read by name or by order; the TOML of the case has the file, not its numbers."""
    file = tmp_path / "bed.csv"
    extra = "" if head else ",0,0"
    file.write_text(head + f"0,0,0,0.001{extra},2\n0.01,0,0,0.002{extra},3\n", encoding="utf-8")
    made = damper(particles=rb.Particles(material="steel"), packing=rb.Positions.from_file(file))
    assert made.contents.radius == pytest.approx([1e-3, 2e-3])
    assert made.start.position == pytest.approx(np.array([[0, 0, 0], [0.01, 0, 0]]))
    assert made.start.velocity == pytest.approx(np.array([[0, 0, 2.0], [0, 0, 3.0]]))
    assert 'file = "' in case(made).to_toml()
    assert "positions = " not in case(made).to_toml()
    np.save(tmp_path / "bed.npy", np.array([[0, 0, 0, 1e-3], [0.01, 0, 0, 2e-3]]))
    again = rb.Positions.from_file(tmp_path / "bed.npy")
    assert again.radii == made.packing.radii


def test_positions_from_a_file_with_a_suffix_in_capitals(tmp_path: Path) -> None:
    """The suffix of a file of positions may be in capitals."""
    np.save(tmp_path / "bed.npy", np.array([[0, 0, 0, 1e-3], [0.01, 0, 0, 2e-3]]))
    (tmp_path / "bed.npy").rename(tmp_path / "BED.NPY")
    assert rb.Positions.from_file(tmp_path / "BED.NPY").radii == pytest.approx([1e-3, 2e-3])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x,y,z\n0,0,0\n0,0,abc\n", r"bed.csv, line 3: 'abc' is not a number"),
        ("x,y,z\n0,0,0\n0,0\n", r"bed.csv, line 3: 2 columns, but 3 in line 2\n  try: the whole file"),
        ("a bed, settled\nx,y,z\n0,0\n", r"bed.csv, line 3: 2 columns, but 3 in line 2"),
        ("x,y,z,radius,vz\n0,0,0,0.001\n", r"bed.csv, line 2: 4 columns, but 5 in line 1"),
        ("x,y,z,x\n0,0,0,0\n", r"bed.csv has two columns 'x'"),
        ("x,y,z\n0,nan,0\n", r"bed.csv, line 2: 0, nan, 0 is not finite"),
        ("x,y,z\n", r"bed.csv .*no numbers"),
        ("x,y,z,radius\n0,0,0,0.001\n0,0,0.001,0.001\n", r"packing.file = .*\n  particles 0 and 1 overlap by 1 mm"),
        (
            "x,y,z,radius\n0,0,0.02,0.001\n",
            r"packing.file = .*\n  particle 0 at \(0, 0, 20\) mm sticks out of the cavity",
        ),
        ("x,y,z,radius\n0,0,0,-0.001\n", r"file = .*\n  radii must be greater than zero"),
    ],
)
def test_bad_rows_of_positions_are_reported(text: str, message: str, tmp_path: Path) -> None:
    """A file of positions with a bad row is refused with the line or the particle, and the reason."""
    (tmp_path / "bed.csv").write_text(text, encoding="utf-8")
    size = {} if "radius" in text else {"radius": "1 mm"}
    with pytest.raises(rb.DataError if message.startswith("bed.csv") else rb.CaseError, match=message):
        damper(
            particles=rb.Particles(material="steel", **size),
            packing=rb.Positions(file=tmp_path / "bed.csv"),
        )


def test_arrays_of_positions_of_different_lengths_are_reported(tmp_path: Path) -> None:
    """Arrays of x, y and z of different lengths are refused with the file, the field and the lengths."""
    np.savez(tmp_path / "p.npz", x=[0, 0.006], y=[0, 0], z=[0.0])
    with pytest.raises(rb.DataError) as caught:
        rb.Positions(file=tmp_path / "p.npz")
    place, message, hint = str(caught.value).splitlines()
    assert place.startswith("Positions: file = ")
    assert message == f"  {tmp_path / 'p.npz'} has arrays of different lengths: x 2, y 2, z 1"
    assert hint.startswith("  try: a number for each particle")


def test_positions_have_units() -> None:
    """Positions, radii, velocities and spins accept text with units, pint quantities and plain numbers in SI."""
    quantity = registry().Quantity
    rows = [["1 mm", 0, "-0.2 cm"], [0.01, "0.02", 0]]
    made = rb.Positions(
        positions=rows,
        radii=["1 mm", "2 mm"],
        velocities=quantity([[1, 2, 3], [0, 0, 4]], "mm/s"),
        spins=[["60 rpm", "360 deg/s", "1 Hz"], ["1 rad/s", "2 rad/s", 0]],
    )
    assert np.array(made.positions) == pytest.approx(np.array([[1e-3, 0, -2e-3], [0.01, 0.02, 0]]))
    assert made.radii == pytest.approx([1e-3, 2e-3])
    assert np.array(made.velocities) == pytest.approx(1e-3 * np.array([[1, 2, 3], [0, 0, 4]]))
    assert np.array(made.spins) == pytest.approx(np.array([[2 * math.pi] * 3, [1, 2, 0]]))
    assert rb.Positions(positions=np.array(rows, dtype=object)).positions == made.positions


def test_one_ball_may_fill_most_of_its_cavity() -> None:
    """The limit on the density of random insertion does not apply to a single particle."""
    alone = damper(
        particles=balls(1, diameter="24 mm"), cavity=rb.SphericalCavity(radius="12.5 mm"), packing=rb.Settled()
    )
    assert alone.contents.radius.size == 1


def test_the_number_in_the_message_about_a_lattice_is_possible() -> None:
    """If particles do not fit, the message gives a number that fits, in any cavity."""
    for cavity in CAVITIES.values():
        with pytest.raises(rb.CaseError, match="do not fit") as caught:
            damper(particles=balls(2000), cavity=cavity)
        most = int(str(caught.value).rpartition("try: ")[2].split()[0])
        assert damper(particles=balls(most), cavity=cavity).start.position.shape == (most, 3)


@pytest.mark.parametrize("packing", [rb.Settled(seed=2), rb.Compacted(seed=2), rb.Lattice(seed=2)])
@pytest.mark.parametrize(
    ("cavity", "count"),
    [
        (rb.Box(size=("35 mm", "5 mm", "35 mm")), 15),
        (rb.Cylinder(diameter="5 mm", length="60 mm"), 9),
        (rb.Cylinder(diameter="35 mm", length="5 mm", axis="y"), 15),
        (rb.Box(size=("5 mm", "5 mm", "5.5 mm")), 1),
    ],
)
def test_particles_as_wide_as_their_slot(cavity: Any, count: int, packing: Any) -> None:
    """Balls fit into a slot of exactly their diameter; insertion enlarged them, and all slots in tests were wider."""
    balls_of_5 = rb.Particles(material="steel", diameter="5 mm", count=count)
    for gravity in ((0, 0, -9.81), (0, 0, 0)):
        if gravity[2] or not isinstance(packing, rb.Settled):
            one = damper(cavity=cavity, particles=balls_of_5, packing=packing, gravity=gravity, friction=0.3)
            places = start_positions(one)
            assert one.interior.room(places, one.contents.radius).min() > -1e-9 * 2.5e-3


def test_number_in_the_message_about_an_insertion_is_not_a_guess() -> None:
    """Where fewer particles are known to fit as little, no number is advised: each refusal advised one particle less."""
    deep = rb.PlateBody(size=("40 mm", "5 mm", "20 mm"), position=(0, "4.5 mm", 0))
    slot = [deep, deep.model_copy(update={"position": (0.0, -0.0045, 0.0)})]
    one = damper(
        cavity=rb.Box(size=("40 mm", "14 mm", "20 mm")),
        bodies=slot,
        particles=rb.Particles(material="steel", diameter="4 mm", count=3),
        packing=rb.Settled(seed=1),
    )
    with pytest.raises(rb.CaseError, match="cannot be inserted") as refusal:
        start_positions(one)
    assert "at most" not in str(refusal.value) and "try: " in str(refusal.value)
