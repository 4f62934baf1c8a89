"""Particle dampers: what is described is what is filled in; what does not fit is refused with a reason."""

from __future__ import annotations

import math
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg

import rattlebox as rb
from rattlebox.model.packing import check_packing
from rattlebox.model.units import registry

STEEL = rb.materials()["steel"]
CAVITIES = {
    "box": rb.Box(size=("40 mm", "30 mm", "60 mm")),
    "upright can": rb.Cylinder(diameter="40 mm", length="50 mm"),
    "lying can": rb.Cylinder(radius="20 mm", length="50 mm", axis="x"),
    "can askew": rb.Cylinder(radius="20 mm", length="50 mm", axis=(1, 2, -1)),
    "sphere": rb.SphericalCavity(radius="25 mm"),
}
SIZES = {
    "normal": rb.NormalSizes(mean="4 mm", deviation="0.5 mm", smallest="3 mm", largest="5 mm"),
    "log-normal": rb.LogNormal(median="4 mm", geometric_standard_deviation=1.2, smallest="3 mm", largest="6 mm"),
    "sieve": rb.Sieve(sizes=["2 mm", "3 mm", "5 mm"], passing=[0, 0.3, 1]),
}


def balls(count: int = 100, **options: Any) -> rb.Particles:
    """Return steel balls of 4 mm."""
    return rb.Particles(**{"material": "steel", "diameter": "4 mm", "count": count, **options})


def damper(**options: Any) -> rb.ParticleDamper:
    """Return a damper of a hundred steel balls in a cube."""
    usual = {
        "particles": balls(),
        "cavity": rb.Box(size=("40 mm",) * 3),
        "contact": rb.Tsuji(restitution=0.9),
        "friction": 0.3,
    }
    return rb.ParticleDamper(**{**usual, **options})


def case(*dampers: rb.ParticleDamper, **options: Any) -> rb.Case:
    """Return a case with one degree of freedom."""
    usual: dict[str, Any] = {"structure": rb.SDOF(mass=20, stiffness=8e4), "duration": 1.0}
    return rb.Case(**{**usual, "dampers": dampers or (damper(),), **options})


@pytest.mark.parametrize("name", CAVITIES)
@pytest.mark.parametrize("count", [1, 7, 300])
def test_lattices_with_noise_fit(name: str, count: int) -> None:
    """Particles on a lattice with all the noise that is allowed are inside and do not overlap, whatever the cavity."""
    radii = np.linspace(1e-3, 2e-3, count)
    positions = rb.Lattice(noise=1.0, seed=3).place(CAVITIES[name], radii)
    check_packing(CAVITIES[name], positions, radii)
    assert np.array_equal(positions, rb.Lattice(noise=1.0, seed=3).place(CAVITIES[name], radii))
    assert not np.array_equal(positions, rb.Lattice(noise=1.0, seed=4).place(CAVITIES[name], radii))


@pytest.mark.parametrize("name", CAVITIES)
def test_lattices_use_the_whole_cavity(name: str) -> None:
    """Many particles are spread evenly, at least to within half a cell of the walls: so says their mean square distance."""
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
    """Where two rows side by side would stick out of a round cavity, there is one."""
    radii = np.full(count, 2e-3)
    check_packing(cavity, rb.Lattice().place(cavity, radii), radii)


@pytest.mark.parametrize(
    "cavity",
    [rb.Box(size=(24, 24, 24)), rb.SphericalCavity(radius=24), rb.Box(size=(24, 24, 5e-3)), rb.Box(size=(0.25,) * 3)],
)
def test_few_particles_take_little_memory_in_a_wide_cavity(cavity: Any) -> None:
    """A lattice is as large as its particles are many, not as the cavity is wide, also where it is wide and flat."""
    radii = np.full(20, 5e-4)
    tracemalloc.start()
    positions = rb.Lattice().place(cavity, radii)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2e8
    check_packing(cavity, positions, radii)


def test_a_lattice_reaches_close_packing() -> None:
    """Where a cubic lattice is full, a face-centred one takes over: 60 % of a large box is no problem."""
    radii = np.full(round(0.6 / (4 / 3 * math.pi * 0.02**3)), 0.02)
    cavity = rb.Box(size=(1, 1, 1))
    check_packing(cavity, rb.Lattice().place(cavity, radii), radii)


def test_overlaps_are_found_among_unlike_sizes() -> None:
    """Overlaps between large and small, small and small particles are found, at the least distance."""
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


@pytest.mark.parametrize("name", SIZES)
def test_the_mass_that_is_asked_for_is_filled_in(name: str) -> None:
    """A mass is met to within one particle, with sizes between the limits."""
    filled = damper(particles=rb.Particles(material="steel", distribution=SIZES[name], mass="60 g")).contents
    assert filled.mass.sum() == pytest.approx(0.06, abs=filled.mass.max())
    assert filled.mass == pytest.approx(4 / 3 * math.pi * filled.radius**3 * STEEL.density)
    assert filled.inertia == pytest.approx(0.4 * filled.mass * filled.radius**2)
    assert 1e-3 <= filled.radius.min() < filled.radius.max() <= 3e-3


WIDE = {
    "sieve": rb.Sieve(sizes=["0.2 mm", "1 mm", "10 mm"], passing=[0, 0.2, 1]),
    "sieve with a gap": rb.Sieve(sizes=["0.5 mm", "0.6 mm", "9.9 mm", "10 mm"], passing=[0, 0.5, 0.5, 1]),
    "log-normal": rb.LogNormal(median="1 mm", geometric_standard_deviation=2, smallest="0.01 mm", largest="50 mm"),
}


def test_a_sieve_takes_percent() -> None:
    """Shares that pass may be given in per cent, as sieve tables are."""
    assert rb.Sieve(sizes=["2 mm", "3 mm", "5 mm"], passing=["0 %", "30 %", "100 %"]) == SIZES["sieve"]


@pytest.mark.parametrize("mass", [5e-3, 50e-3, 0.4])
@pytest.mark.parametrize("name", WIDE)
def test_wide_distributions_meet_the_mass_as_closely_as_they_can(name: str, mass: float) -> None:
    """With one particle more or less the mass would be further from what is asked for, and a fill ratio is the same."""
    kind = rb.Particles(material="steel", distribution=WIDE[name], mass=mass)
    number = kind.number(1.0)
    filled = [STEEL.density * math.pi / 6 * np.sum(kind.diameters(number + more) ** 3) for more in (-1, 0, 1)]
    assert np.abs(np.array(filled) - mass).argmin() == 1
    by_volume = rb.Particles(material="steel", distribution=WIDE[name], fill_ratio=mass / STEEL.density)
    assert by_volume.number(1.0) == number


def test_sieve_shares_are_shares_of_mass() -> None:
    """Of a sieve table, the share of the mass below each mesh is what passes."""
    diameters = SIZES["sieve"].diameters((np.arange(100_000) + 0.5) / 100_000)
    assert np.sum(diameters[diameters < 3e-3] ** 3) / np.sum(diameters**3) == pytest.approx(0.3, abs=1e-3)


def test_normal_sizes_have_their_mean_and_deviation() -> None:
    """A normal distribution that is hardly cut off has its mean and deviation, a log-normal one its median and spread."""
    share = (np.arange(100_000) + 0.5) / 100_000
    normal = rb.NormalSizes(mean=1e-2, deviation=1e-3, smallest=1e-3, largest=2e-2).diameters(share)
    assert (normal.mean(), normal.std()) == (pytest.approx(1e-2), pytest.approx(1e-3, rel=1e-3))
    wide = np.log(
        rb.LogNormal(median=1e-2, geometric_standard_deviation=1.3, smallest=1e-4, largest=1.0).diameters(share)
    )
    assert (np.exp(np.median(wide)), np.exp(wide.std())) == (pytest.approx(1e-2), pytest.approx(1.3, rel=1e-3))


def test_the_width_of_a_round_cavity_knows_no_corners() -> None:
    """A sphere is as wide as its diameter in any direction, and a can in any across its axis; a box has a diagonal."""
    skew, way = np.array([1.0, 1.0, 1.0]) / np.sqrt(3), np.array([1.0, -1.0, 0.0]) / np.sqrt(2)
    sphere = rb.SphericalCavity(diameter="30 mm")
    assert [sphere.extent(d) for d in (skew, way)] == [0.03, 0.03]
    can = rb.Cylinder(diameter="30 mm", length="50 mm", axis="z")
    assert can.extent(way) == pytest.approx(0.03, rel=1e-15)
    assert can.extent(skew) == pytest.approx((0.05 + np.sqrt(2) * 0.03) / np.sqrt(3), rel=1e-15)
    assert rb.Box(size=("30 mm",) * 3).extent(skew) == pytest.approx(np.sqrt(3) * 0.03, rel=1e-15)


def test_fill_ratio_is_of_the_cavity() -> None:
    """A fill ratio is the volume of the particles over that of the cavity."""
    contents = damper(particles=balls(count=None, fill_ratio=0.2)).contents
    assert np.sum(4 / 3 * math.pi * contents.radius**3) / 0.04**3 == pytest.approx(0.2, abs=1e-3)


@pytest.mark.parametrize("name", CAVITIES)
def test_walls_are_the_cavity(name: str) -> None:
    """Along any line from the centre the depth falls, never faster than the line is long; normals have length one."""
    cavity = CAVITIES[name]
    directions = np.random.default_rng(2).standard_normal((50, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    inside = np.linspace(0, 0.04, 4001)[:, None, None] * directions
    depth = cavity.depth(inside.reshape(-1, 3)).reshape(4001, 50)
    assert np.all(np.diff(depth, axis=0) <= 1e-12)
    assert np.all(np.abs(np.diff(depth, axis=0)) <= 1e-5 * (1 + 1e-9))
    normals = cavity.walls().axis[np.array(cavity.walls().form) == "plane"]
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(normals)))


@pytest.mark.parametrize(
    "made",
    [
        damper(),
        damper(packing=rb.Settled(seed=5), softening=10, rolling=0.01, wall="rigid", wall_friction=0.1, name="can"),
        damper(
            particles=[balls(10), rb.Particles(name="fine", material="steel", distribution=SIZES["sieve"], mass="3 g")],
            pairs=[rb.PairLaws(between=("fine", "wall"), friction=rb.LinearSpring(0.5, stiffness=1e5))],
            mixing="smaller",
            wall_friction=rb.LinearSpring(0.3, stiffness=1e5),
            cavity=CAVITIES["can askew"],
            gravity=(0, "-1 g_0", 0),
            direction=(1, 0, 1),
            velocity=("1 mm/s", 0, 0),
        ),
        damper(
            particles=rb.Particles(material="glass"),
            packing=rb.Positions(positions=[[0, 0, 0], [0, 0, 0.01]], radii=[1e-3, 2e-3], spins=np.ones((2, 3))),
            contact=rb.Linear(contact_time="0.1 ms", restitution=0.8),
            friction=rb.LinearSpring(0.2, ratio=0.3),
            cavity=rb.SphericalCavity(diameter="40 mm"),
        ),
    ],
)
def test_a_written_damper_reads_back_equal(made: rb.ParticleDamper, tmp_path: Path) -> None:
    """A case with particles equals itself after a trip through a file, and its method is dem without being told."""
    one = case(made)
    one.to_file(tmp_path / "case.toml")
    back = rb.Case.from_file(tmp_path / "case.toml")
    assert back == one
    assert back.method == rb.Dem()
    assert np.array_equal(back.particle_dampers[0].contents.radius, made.contents.radius)


@pytest.mark.parametrize("head", ["x,y,z,radius,vz\n", ""])
def test_positions_from_a_file(head: str, tmp_path: Path) -> None:
    """Columns are found by name, or by their order; a case names the file instead of its numbers."""
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
    """Arrays of positions are read from a file whose suffix is written in capitals."""
    np.save(tmp_path / "bed.npy", np.array([[0, 0, 0, 1e-3], [0.01, 0, 0, 2e-3]]))
    (tmp_path / "bed.npy").rename(tmp_path / "BED.NPY")
    assert rb.Positions.from_file(tmp_path / "BED.NPY").radii == pytest.approx([1e-3, 2e-3])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x,y,z\n0,0,0\n0,0,abc\n", r"bed.csv, line 3: 'abc' is not a number"),
        ("x,y,z\n0,0,0\n0,0\n", r"bed.csv, line 3: 2 columns, but 3 in line 2\n  try: the whole file"),
        ("a bed, settled\nx,y,z\n0,0\n", r"bed.csv, line 3: 2 columns, but 3 in line 2"),
        ("x,y,z,radius,vz\n0,0,0,0.001\n", r"bed.csv, line 2: 4 columns, but 5 in line 1"),
        ("x,y,z,x\n0,0,0,0\n", r"bed.csv has two columns 'x'"),
        ("x,y,z\n0,nan,0\n", r"bed.csv, line 2: 0, nan, 0 is not finite"),
        ("x,y,z\n", r"bed.csv holds no numbers"),
        ("x,y,z,radius\n0,0,0,0.001\n0,0,0.001,0.001\n", r"packing.file = .*\n  particles 0 and 1 overlap by 1 mm"),
        (
            "x,y,z,radius\n0,0,0.02,0.001\n",
            r"packing.file = .*\n  particle 0 at \(0, 0, 20\) mm sticks out of the cavity",
        ),
        ("x,y,z,radius\n0,0,0,-0.001\n", r"file = .*\n  radii must be greater than zero"),
    ],
)
def test_bad_rows_of_positions_are_reported(text: str, said: str, tmp_path: Path) -> None:
    """A file of positions with a bad row is refused with the line, or the particle, and what is wrong with it."""
    (tmp_path / "bed.csv").write_text(text, encoding="utf-8")
    size = {} if "radius" in text else {"radius": "1 mm"}
    with pytest.raises(rb.DataError if said.startswith("bed.csv") else rb.CaseError, match=said):
        damper(
            particles=rb.Particles(material="steel", **size),
            packing=rb.Positions(file=tmp_path / "bed.csv"),
        )


def test_arrays_of_positions_of_different_lengths_are_reported(tmp_path: Path) -> None:
    """Arrays of x, y and z that do not go together are told with the file, the field and how long each is."""
    np.savez(tmp_path / "p.npz", x=[0, 0.006], y=[0, 0], z=[0.0])
    with pytest.raises(rb.DataError) as caught:
        rb.Positions(file=tmp_path / "p.npz")
    place, said, hint = str(caught.value).splitlines()
    assert place.startswith("Positions: file = ")
    assert said == f"  {tmp_path / 'p.npz'} has arrays of different lengths: x 2, y 2, z 1"
    assert hint.startswith("  try: a number for each particle")


def test_contacts_without_rebound_are_told() -> None:
    """Particles whose restitution is zero are told the field, the value, and what particles may have."""
    with pytest.raises(rb.CaseError) as told:
        damper(contact={"kind": "tsuji", "restitution": 0})
    place, _, hint = str(told.value).splitlines()
    assert place == "ParticleDamper: contact.restitution = 0"
    assert hint.startswith("  try: restitution = 1e-6, ")


@pytest.mark.parametrize(
    "make",
    [
        lambda: rb.Dem(fraction=0),
        lambda: rb.Settled(at_rest=0),
        lambda: rb.Rolling(coefficient=0.1, stiffness=0),
        lambda: rb.LinearSpring(coefficient=0.1, ratio=0),
    ],
)
def test_zero_is_told_alike(make: Any) -> None:
    """Numbers that must not be zero are told in the same words everywhere."""
    with pytest.raises(rb.CaseError, match=r"= 0\n  must be greater than zero$"):
        make()


def test_positions_have_units() -> None:
    """Rows of positions, radii, velocities and spins take quantities, as text and of pint, and plain numbers in SI."""
    quantity = registry().Quantity
    rows = [["1 mm", 0, "-0.2 cm"], [0.01, "0.02", 0]]
    made = rb.Positions(
        positions=rows,
        radii=["1 mm", "2 mm"],
        velocities=quantity([[1, 2, 3], [0, 0, 4]], "mm/s"),
        spins=[["60 rpm", "360 deg/s", "1 Hz"], ["1 rad/s", 0, 0]],
    )
    assert np.array(made.positions) == pytest.approx(np.array([[1e-3, 0, -2e-3], [0.01, 0.02, 0]]))
    assert made.radii == pytest.approx([1e-3, 2e-3])
    assert np.array(made.velocities) == pytest.approx(1e-3 * np.array([[1, 2, 3], [0, 0, 4]]))
    assert np.array(made.spins) == pytest.approx(np.array([[2 * math.pi] * 3, [1, 0, 0]]))
    assert rb.Positions(positions=np.array(rows, dtype=object)).positions == made.positions


def test_one_ball_may_fill_most_of_its_cavity() -> None:
    """What is too dense for many particles inserted at random is not for one alone."""
    alone = damper(
        particles=balls(1, diameter="24 mm"), cavity=rb.SphericalCavity(radius="12.5 mm"), packing=rb.Settled()
    )
    assert alone.contents.radius.size == 1


def test_softening_keeps_restitution() -> None:
    """Softer moduli lower stiffness, but dashpots and limiting pressure such that yield speed and damping ratio stay."""
    for contact in (rb.Thornton(), rb.Linear(stiffness="1 MN/m", damping="3 N s/m")):
        values = []
        for factor in (1, 100):
            made = damper(contact=contact, softening=factor, friction=0)
            entry = made.contact_table.entries[0]
            name, coefficients = made.softened(entry)
            values.append(coefficients)
        assert values[1]["stiffness"] == pytest.approx(values[0]["stiffness"] / 100)
        if name == "thornton":
            speed = [v["yield_pressure"] ** 2.5 / v["modulus"] ** 2 for v in values]
            assert speed[1] == pytest.approx(speed[0])
        else:
            ratio = [v["damping"] / math.sqrt(v["stiffness"] * v["mass"]) for v in values]
            assert ratio[1] == pytest.approx(ratio[0])


def test_mindlin_stiffness_of_equal_spheres() -> None:
    """8 G* of two bodies of one material is 4 G / (2 - nu)."""
    entry = damper().contact_table.entries[0]
    shear = STEEL.young / (2 * (1 + STEEL.poisson))
    assert damper().softened_friction(entry)[1]["shear_modulus"] == pytest.approx(4 * shear / (2 - STEEL.poisson))


def test_pair_table_goes_before_the_laws_of_all() -> None:
    """A pair has the laws that the table gives it; what the table leaves out, and all other pairs, have the common ones."""
    made = damper(
        particles=[balls(10), rb.Particles(material="glass", diameter="3 mm", count=5)],
        pairs=[
            rb.PairLaws(between=("glass", "steel"), friction=0.7),
            rb.PairLaws(between=("wall", "glass"), contact=rb.Tsuji(restitution=0.5)),
        ],
        wall_friction=0.1,
    )
    table = made.contact_table
    found = {e.names: (e.friction.coefficient, e.contact.restitution.e) for e in table.entries if e.friction}
    assert found == {
        ("steel", "steel"): (0.3, 0.9),
        ("steel", "glass"): (0.7, 0.9),
        ("glass", "glass"): (0.3, 0.9),
        ("steel", "wall"): (0.1, 0.9),
        ("glass", "wall"): (0.1, 0.5),
    }
    assert table.particle_entry.tolist() == [[0, 1], [1, 2]]
    assert table.wall_entry.tolist() == [[3], [4]]


def two_kinds(other: str, **laws: Any) -> rb.ParticleDamper:
    """Return a damper of steel and glass, in which glass and something else have laws of their own."""
    glass = rb.Particles(material="glass", radius="1 mm", count=1)
    return damper(particles=[balls(), glass], pairs=[rb.PairLaws(between=("glass", other), **laws)])


def test_walls_may_have_laws_of_another_kind() -> None:
    """Friction and endings at walls may differ from those among particles, and pairs without friction do not matter."""
    made = damper(
        wall_contact=rb.Tsuji(restitution=0.5, ending="zero_overlap"), wall_friction=rb.LinearSpring(0.2, stiffness=1e5)
    )
    assert len(made.contact_table.entries) == 2
    two_kinds("steel", friction=rb.LinearSpring(0.0, stiffness=1e5))


AT = rb.Positions(positions=[[0, 0, 0], [0, 0, 0.003]])
REFUSED = {
    r"pairs\[0\].between = \['wall'\]\n  two names are needed\n  try: \[\"steel\", \"wall\"\]": lambda: damper(
        pairs=[{"between": ["wall"], "friction": 0.1}]
    ),
    r"between = 'steel'\n  two names are needed\n  try: \[\"steel\", \"wall\"\]": lambda: rb.PairLaws(
        between="steel", friction=0.1
    ),
    r"friction\n  .*wall_friction": lambda: damper(friction={"wall": 0.1}),
    "particles": lambda: damper(particles=[]),
    "count = 0": lambda: balls(count=0),
    "their volume is 1.05 times that of the cavity\n  try: at most 9": lambda: damper(
        particles=balls(2000), packing=rb.Settled(), gravity=(0, 0, -9.81)
    ),
    "a lattice of spheres of 4 mm holds 1099.*\n  try: 1099 of them": lambda: damper(particles=balls(1100)),
    "2000 particles do not fit: a lattice of spheres of 4 mm holds 1099": lambda: damper(particles=balls(2000)),
    "a particle of 44 mm is larger than the cavity": lambda: damper(particles=balls(1, diameter="44 mm")),
    "inserted at random they fill 60 %": lambda: damper(
        particles=balls(count=None, fill_ratio=0.7), packing=rb.Settled()
    ),
    "particles 0 and 1 overlap by 1 mm": lambda: damper(particles=balls(2), packing=AT),
    "sticks out of the cavity by .*\n  try: positions in metres, or with units": lambda: damper(
        particles=balls(2), packing=rb.Positions(positions=[(0, 0, 0), (0, 0, -7)])
    ),
    "particle 1 at .* mm sticks out of the cavity by 1 mm": lambda: damper(
        particles=balls(2), packing=rb.Positions(positions=[[0, 0, 0], [0, 0.019, 0]])
    ),
    r"Damper: packing\n  3 particles, but 2 positions\n  try: a row for each particle, or count = 2": lambda: damper(
        particles=balls(3), packing=AT
    ),
    "packing\n  1 particle, but 2 positions": lambda: damper(particles=balls(1), packing=AT),
    "  1 row of spins, but 2 positions": lambda: rb.Positions(positions=np.zeros((2, 3)), spins=np.zeros((1, 3))),
    r"positions\[0\]\[2\] = '2 s'\n  a length \(m\) is needed, not a time": lambda: rb.Positions(
        positions=[[0, 0, "2 s"]]
    ),
    "a particle of 50 mm is as large as the cavity": lambda: damper(
        particles=balls(1, diameter="50 mm"), cavity=CAVITIES["sphere"]
    ),
    "holds 1 in this cavity\n  try: 1 of them": lambda: damper(
        particles=balls(2, diameter="30 mm"), cavity=CAVITIES["sphere"]
    ),
    "their volume is 1.88 times that of the cavity\n  try: at most 1 of them": lambda: damper(
        particles=balls(2, diameter="49 mm"), cavity=CAVITIES["sphere"], packing=rb.Settled(), gravity=(0, 0, -9.81)
    ),
    "rolling = 0.1\n  rolling resistance needs friction.*\n  try: friction = 0.3": lambda: damper(
        friction=0, rolling=0.1
    ),
    "rolling = 0.1\n.* between steel and wall\n  try: wall_friction = 0.3": lambda: damper(
        wall_friction=0, rolling=0.1
    ),
    "wall_rolling = 0.1\n.* between steel and wall\n  try: friction = 0.3": lambda: damper(
        friction=0, wall_rolling=0.1
    ),
    r"pairs\[0\].rolling\n.* between glass and wall\n  try: pairs\[0\].friction = 0.3": lambda: two_kinds(
        "wall", friction=0, rolling=0.2
    ),
    r"Damper: particles\[1\]\n  a particle of 44 mm is larger than the cavity": lambda: damper(
        particles=[balls(), rb.Particles(material="glass", diameter="44 mm", count=1)]
    ),
    r"Damper: particles\n.* do not fit.*\n  try: packing = { kind = \"settled\" }, which suits many sizes": lambda: (
        damper(particles=[balls(700), rb.Particles(material="glass", diameter="6 mm", count=10)])
    ),
    "Mindlin's stiffness .* is linear": lambda: damper(contact=rb.Linear(stiffness=1e6, restitution=0.9)),
    "thornton and tsuji .* one kind of law is needed": lambda: two_kinds(
        "wall", contact=rb.Thornton(yield_pressure="1 GPa")
    ),
    "zero_overlap and zero_force .* one ending is needed": lambda: two_kinds(
        "steel", contact=rb.Tsuji(restitution=0.9, ending="zero_overlap")
    ),
    "spring and mindlin .* one kind of friction is needed": lambda: two_kinds(
        "steel", friction=rb.LinearSpring(0.2, stiffness=1e5)
    ),
    "spring and mindlin .* one kind of friction .* at walls": lambda: two_kinds(
        "wall", friction=rb.LinearSpring(0.2, stiffness=1e5)
    ),
    "without gravity": lambda: damper(packing=rb.Settled(), gravity=(0, 0, 0)),
    "there are no particles 'wood' here": lambda: damper(pairs=[rb.PairLaws(between=("wood", "wall"))]),
    "this is less than one particle": lambda: damper(particles=balls(count=None, mass="1 mg")),
    r"particles.mass = .*\n  this is 7.64e\+11 particles; 1e\+08 at most": lambda: damper(
        particles=rb.Particles(material="glass", diameter="1 um", mass="1 g")
    ),
    r"particles.fill_ratio = 0.3\n  this is 3.67e\+22 particles; 1e\+08 at most": lambda: damper(
        particles=rb.Particles(material="glass", diameter="1 nm", fill_ratio=0.3)
    ),
    "this is .* particles; .* at most": lambda: damper(
        particles=rb.Particles(
            material="glass", distribution=rb.Sieve(sizes=["1 nm", "2 nm"], passing=[0, 1]), mass="1 g"
        )
    ),
    "count, mass or fill_ratio is needed": lambda: damper(particles=balls(count=None)),
    "radius, diameter or distribution is needed": lambda: damper(particles=balls(diameter=None)),
    "cannot be in one case": lambda: case(
        damper(), rb.ImpactDamper(ball=rb.Sphere(radius=0.01, material="steel"), gap=1e-3, contact=rb.Thornton())
    ),
    "event_driven computes impact dampers": lambda: case(method=rb.EventDriven()),
    "dem computes particle dampers, and the case has none": lambda: rb.Case(
        structure=rb.Fixed(), duration=1, method=rb.Dem()
    ),
    "in another damper of this case": lambda: case(damper(), damper(name="b", gravity=(0, 0, 0))),
    "output times must be evenly spaced": lambda: case(output=rb.Output(times=[0.1, 0.15, 0.3])),
    "dampers move in several directions": lambda: case(
        damper(),
        damper(name="b", direction="y"),
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency=10)),
    ),
    "the point 'tip' moves in 3-D": lambda: case(
        structure=rb.Modal(frequencies=[10], damping_ratios=[0], shapes={"tip": [[0, 0, 1]]}),
        load=rb.HalfSine(amplitude="1 N", duration="1 ms"),
    ),
    "moves along one line only": lambda: case(load=rb.HalfSine(amplitude="1 N", duration="1 ms", direction="y")),
    "must be greater than zero": lambda: rb.Dem(dt=0.0),
    r"less than one particle of 8.878e\+05 kg and 6000 mm in diameter": lambda: damper(
        particles=balls(count=None, diameter=6, fill_ratio=0.3)
    ),
    "larger than the cavity, .*\n  try: .*; a number without a unit is in metres": lambda: damper(
        particles=balls(diameter=6)
    ),
}


@pytest.mark.parametrize("complaint", REFUSED)
def test_what_does_not_fit_is_refused(complaint: str) -> None:
    """Bad input is refused with its reason."""
    with pytest.raises(rb.CaseError, match=complaint):
        REFUSED[complaint]()


def test_as_many_as_a_lattice_is_said_to_hold_fit() -> None:
    """The number that is told where particles do not fit is one that fits, in cavities of any form."""
    for cavity in CAVITIES.values():
        with pytest.raises(rb.CaseError, match="do not fit") as caught:
            damper(particles=balls(2000), cavity=cavity)
        most = int(str(caught.value).rpartition("try: ")[2].split()[0])
        assert damper(particles=balls(most), cavity=cavity).start.position.shape == (most, 3)


def test_a_file_needs_no_kind_of_damper() -> None:
    """A damper with particles is a particle damper, and complaints name the field and what is near it."""
    with pytest.raises(rb.CaseError) as caught:
        rb.Case.from_toml(
            'duration = 1\nstructure = { kind = "fixed" }\n[damper]\ngrvity = [0, 0, 0]\n'
            'particles = { material = "steal", diameter = "4 mm", count = 10 }\n'
            'cavity = { kind = "boks", size = [1, 1, 1] }\ncontact = { kind = "tsuji", restitution = 0.9 }\n'
        )
    for said in (
        "damper.particles.material = 'steal'",
        "did you mean 'steel'",
        "damper.cavity.kind = 'boks'",
        "'gravity'",
    ):
        assert said in str(caught.value)


BEAM = {
    "M": np.diag([2.0, 1.0, 0.5, 1.5]).tolist(),
    "K": (1e4 * (np.diag([4.0, 3, 6, 5]) + 0.5 * np.eye(4, k=1) + 0.5 * np.eye(4, k=-1))).tolist(),
    "C": (0.1 * np.diag([2.0, 1.0, 0.5, 1.5])).tolist(),
}
TIP = [[0.0, 1, 0, 0], [0, 0, 1, 0.5], [0.2, 0, 0, 1]]


def test_points_of_matrices_move_in_space(tmp_path: Path) -> None:
    """Three rows of weights make a point that moves along x, y and z, in TOML and in files, as do the modes themselves."""
    matrices = rb.Matrices(**BEAM, points={"tip": TIP}, influence=[[1, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    values, vectors = scipy.linalg.eigh(BEAM["K"], BEAM["M"])
    frequencies = np.sqrt(values) / (2 * np.pi)
    modal = rb.Modal(
        frequencies=frequencies,
        damping_ratios=0.05 / np.sqrt(values),
        shapes={"tip": (np.array(TIP) @ vectors).T},
        participation=vectors.T @ BEAM["M"] @ np.transpose(matrices.influence),
    )
    ours, theirs = matrices.modes(), modal.modes()
    for one, other in ((ours.shapes["tip"], theirs.shapes["tip"]), (ours.participation, theirs.participation)):
        assert one == pytest.approx(other, rel=1e-9, abs=1e-12)
    sweeping = rb.Harmonic(amplitude=(30, "m/s^2"), frequency=15, direction="y")
    runs = [
        rb.simulate(case(damper(), structure=one, base=[sweeping], duration=0.01)).arrays for one in (matrices, modal)
    ]
    assert runs[0].points == ("tip x", "tip y", "tip z")
    assert runs[0].displacement == pytest.approx(runs[1].displacement, rel=1e-6, abs=1e-12)
    assert np.abs(runs[0].cavity_displacement[:, 0]).max(axis=0).min() > 0
    whole = case(structure=matrices)
    whole.to_file(tmp_path / "case.toml")
    assert rb.Case.from_file(tmp_path / "case.toml") == whole
    np.savez(tmp_path / "beam.npz", **BEAM, point_tip=TIP)
    read = rb.Matrices.from_file(tmp_path / "beam.npz")
    assert read.points == {"tip": TIP}
    with pytest.raises(rb.CaseError, match=r"structure\.influence"):
        case(structure=read, base=[sweeping])
    with pytest.raises(rb.CaseError, match="influence has three rows"):
        rb.Matrices(**BEAM, points={"tip": TIP}, influence=[1, 1, 1, 1])
    with pytest.raises(rb.CaseError, match="3 weights, but there are 4 degrees of freedom"):
        rb.Matrices(**BEAM, points={"tip": np.eye(3)})


def test_a_material_without_a_name_is_told_as_particles() -> None:
    """What limits the step of particles whose material has no name is a contact of particles."""
    stuff = rb.Material(density=2500, young=5e7, poisson=0.25)
    assert rb.Particles(material=stuff, radius="1 mm", count=1).label == "particles"
    assert rb.Particles(name="shot", material=stuff, radius="1 mm", count=1).label == "shot"


@pytest.mark.parametrize("count", [1, 2, 7])
def test_sizes_of_a_symmetric_distribution_are_symmetric(count: int) -> None:
    """Few particles of a distribution that is even about its mean lie even about it: at the middles of equal shares."""
    sizes = rb.NormalSizes(mean="4 mm", deviation="0.5 mm", smallest="2 mm", largest="6 mm")
    diameters = rb.Particles(material="steel", distribution=sizes, count=count).diameters(count)
    assert np.all(np.diff(diameters) > 0)
    assert diameters + diameters[::-1] == pytest.approx(np.full(count, 8e-3), rel=1e-12)
