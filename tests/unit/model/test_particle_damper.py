"""Particle dampers: contact laws, case files, refused input."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from support.particle_dampers import CAVITIES, SIZES, STEEL, balls, case, damper

import rattlebox as rb


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
def test_a_written_damper_is_read_back_equal(made: rb.ParticleDamper, tmp_path: Path) -> None:
    """A case with particles is equal after a round trip through a file, and its default method is dem."""
    one = case(made)
    one.to_file(tmp_path / "case.toml")
    back = rb.Case.from_file(tmp_path / "case.toml")
    assert back == one
    assert back.method == rb.Dem()
    assert np.array_equal(back.particle_dampers[0].contents.radius, made.contents.radius)


def test_contacts_without_rebound_are_refused() -> None:
    """A restitution of zero is refused for particles with the field, the value and a value to try."""
    with pytest.raises(rb.CaseError) as caught:
        damper(contact={"kind": "tsuji", "restitution": 0})
    place, _, hint = str(caught.value).splitlines()
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
def test_sizes_of_zero_have_the_same_message(make: Any) -> None:
    """The message for a zero where a positive number is needed is the same in all parts."""
    with pytest.raises(rb.CaseError, match=r"= 0\n  must be greater than zero\n  try: a positive number$"):
        make()


def test_softening_does_not_change_restitution() -> None:
    """Softening lowers the stiffness, but changes neither the yield speed nor the damping ratio."""
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


def test_pairs_override_the_laws_of_the_damper() -> None:
    """The laws of a pair override the common laws; all other pairs have the common laws."""
    made = damper(
        particles=[balls(10), rb.Particles(material="glass", diameter="3 mm", count=5)],
        pairs=[
            rb.PairLaws(between=("glass", "steel"), friction=0.7),
            rb.PairLaws(between=("wall", "glass"), contact=rb.Tsuji(restitution=0.5)),
        ],
        wall_friction=0.1,
    )
    table = made.contact_table
    result = {e.names: (e.friction.coefficient, e.contact.restitution.e) for e in table.entries if e.friction}
    assert result == {
        ("steel", "steel"): (0.3, 0.9),
        ("steel", "glass"): (0.7, 0.9),
        ("glass", "glass"): (0.3, 0.9),
        ("steel", "wall"): (0.1, 0.9),
        ("glass", "wall"): (0.1, 0.5),
    }
    assert table.particle_entry.tolist() == [[0, 1], [1, 2]]
    assert table.wall_entry.tolist() == [[3], [4]]


def two_kinds(other: str, **laws: Any) -> rb.ParticleDamper:
    """Return a damper of steel and glass with special laws between glass and `other`."""
    glass = rb.Particles(material="glass", radius="1 mm", count=1)
    return damper(particles=[balls(), glass], pairs=[rb.PairLaws(between=("glass", other), **laws)])


def test_laws_of_another_kind_at_walls() -> None:
    """Walls may have another kind of friction and ending than particles; pairs without friction are not checked."""
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
    "their volume is 1.05 times that of the cavity; at random this cavity holds at most 1.*\n  try: at most 1": lambda: (
        damper(particles=balls(2000), packing=rb.Settled(), gravity=(0, 0, -9.81))
    ),
    "a lattice of spheres of 4 mm holds 1099.*\n  try: 1099 of them": lambda: damper(particles=balls(1100)),
    "2000 particles do not fit: a lattice of spheres of 4 mm holds 1099": lambda: damper(particles=balls(2000)),
    "a particle of 44 mm is larger than the cavity": lambda: damper(particles=balls(1, diameter="44 mm")),
    "would fill 70 % of the cavity; at random this cavity holds at most 1.*, a fill ratio of 0.5": lambda: damper(
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
    "their volume is 1.88 times that of the cavity; .*\n  try: at most 1 of them": lambda: damper(
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
    "the damper has no species 'wood'": lambda: damper(pairs=[rb.PairLaws(between=("wood", "wall"))]),
    "this is less than one particle": lambda: damper(particles=balls(count=None, mass="1 mg")),
    r"particles.mass = .*\n  this is 7.64e\+11 particles; at most 1e\+08": lambda: damper(
        particles=rb.Particles(material="glass", diameter="1 um", mass="1 g")
    ),
    r"particles.fill_ratio = 0.3\n  this is 3.67e\+22 particles; at most 1e\+08": lambda: damper(
        particles=rb.Particles(material="glass", diameter="1 nm", fill_ratio=0.3)
    ),
    "this is .* particles; at most": lambda: damper(
        particles=rb.Particles(
            material="glass", distribution=rb.Sieve(sizes=["1 nm", "2 nm"], passing=[0, 1]), mass="1 g"
        )
    ),
    "count, mass, fill_ratio or bed_fill is needed": lambda: damper(particles=balls(count=None)),
    "radius, diameter or distribution is needed": lambda: damper(particles=balls(diameter=None)),
    "cannot be in one case": lambda: case(
        damper(), rb.ImpactDamper(ball=rb.Sphere(radius=0.01, material="steel"), gap=1e-3, contact=rb.Thornton())
    ),
    "event_driven computes impact dampers": lambda: case(method=rb.EventDriven()),
    "dem computes particle dampers, and the case has none": lambda: rb.Case(
        structure=rb.Fixed(), duration=1, method=rb.Dem()
    ),
    "gravity must be the same for all dampers": lambda: case(damper(), damper(name="b", gravity=(0, 0, 0))),
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
    "larger than the cavity, .*\n  try: .*; check both and their units": lambda: damper(particles=balls(diameter=6)),
}


@pytest.mark.parametrize("message", REFUSED)
def test_invalid_dampers_are_refused(message: str) -> None:
    """Bad input is refused with its reason."""
    with pytest.raises(rb.CaseError, match=message):
        REFUSED[message]()


def test_the_kind_of_a_damper_follows_from_its_fields() -> None:
    """A damper with particles is read as a particle damper; errors name the field and the nearest word."""
    with pytest.raises(rb.CaseError) as caught:
        rb.Case.from_toml(
            'duration = 1\nstructure = { kind = "fixed" }\n[damper]\ngrvity = [0, 0, 0]\n'
            'particles = { material = "steal", diameter = "4 mm", count = 10 }\n'
            'cavity = { kind = "boks", size = [1, 1, 1] }\ncontact = { kind = "tsuji", restitution = 0.9 }\n'
        )
    for message in (
        "damper.particles.material = 'steal'",
        "did you mean 'steel'",
        "damper.cavity.kind = 'boks'",
        "'gravity'",
    ):
        assert message in str(caught.value)


BEAM = {
    "M": np.diag([2.0, 1.0, 0.5, 1.5]).tolist(),
    "K": (1e4 * (np.diag([4.0, 3, 6, 5]) + 0.5 * np.eye(4, k=1) + 0.5 * np.eye(4, k=-1))).tolist(),
    "C": (0.1 * np.diag([2.0, 1.0, 0.5, 1.5])).tolist(),
}

TIP = [[0.0, 1, 0, 0], [0, 0, 1, 0.5], [0.2, 0, 0, 1]]


def test_points_of_matrices_in_3d(tmp_path: Path) -> None:
    """Three rows of weights define a 3-D point of matrices, in Python, TOML and files, with the motion of its modes."""
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


def test_identical_dampers_have_packings_of_their_own() -> None:
    """A number of identical dampers runs as that many listed ones with the seeds, names and points of its copies."""
    group = damper(packing=rb.Settled(seed=4), number=2, points=["mass"], name="can", softening=100)
    copies = group.each()
    assert [(each.name, each.point, each.number, each.points) for each in copies] == [
        ("can", "mass", 1, ()),
        ("can2", "mass", 1, ()),
    ]
    assert copies[0].packing == group.packing != copies[1].packing
    struck = rb.SDOF(mass="1 kg", frequency="20 Hz", velocity="0.2 m/s")
    run = rb.simulate(case(group).model_copy(update={"structure": struck, "duration": 0.01}))
    listed = rb.simulate(run.case.model_copy(update={"dampers": copies}))
    assert run.arrays.dampers == listed.arrays.dampers == ("can", "can2")
    assert np.array_equal(run.arrays.displacement, listed.arrays.displacement)
    loss = run.ledger.damper_share
    assert loss[0] != loss[1]


def test_identical_dampers_are_one_part_of_the_case() -> None:
    """Paths, case files and softening "auto" refer to all identical dampers at once."""
    three = case(damper(packing=rb.Settled(), number=3)).replaced({"damper.friction": 0.4, "damper.softening": "auto"})
    assert len(three.dampers) == 1 and len(three.particle_dampers) == 3
    assert rb.Case.from_toml(three.to_toml()) == three
    assert {each.friction for each in three.particle_dampers} == {three.dampers[0].friction}
    assert len({each.packing.seed for each in three.particle_dampers}) == 3
    assert len(three.replaced({"damper.number": 5}).particle_dampers) == 5
    with pytest.raises(rb.CaseError, match="a damper alone is needed, but the case has 3"):
        rb.Stepper(three, alone=True)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"number": 0}, "number = 0\n  must be at least 1"),
        ({"number": 2.5}, "number = 2.5\n  an integer is needed"),
        ({"number": 2, "packing": rb.Lattice(noise=0)}, "would move in step"),
        ({"points": ["mass", "mass"], "packing": rb.Lattice(noise=0)}, "would move in step"),
        ({"point": "mass", "points": ["mass"]}, "exclude each other"),
        ({"points": ["mass", "tip"]}, "points[1] = 'tip'\n  the structure has no point 'tip'"),
        ({"number": 10_000, "particles": balls(1_000_000), "cavity": rb.Box(size=("1 m",) * 3)}, "GB"),
    ],
)
def test_wrong_groups_are_refused(fields: dict[str, Any], message: str) -> None:
    """Numbers below one, several dampers that would move in step, and unknown points are refused."""
    with pytest.raises(rb.RattleboxError) as caught:
        case(damper(**fields))
    assert message in str(caught.value)


def test_a_case_without_its_dampers_runs() -> None:
    """The structure alone is computed without particles, in a run and a sweep, and its tuned masses and loads stay.

    A copy with an empty list of dampers kept the method and the snapshots of particles; only balls were compared so.
    """
    bed = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=3),
        cavity=rb.Box(size=("40 mm", "40 mm", "25 mm")),
        contact=rb.Tsuji(restitution=0.6),
        softening=100,
    )
    structure = rb.SDOF(mass="1 kg", frequency="60 Hz", damping_ratio=0.02)
    tuned = rb.TunedMass(mass="50 g", frequency="58 Hz", damping_ratio=0.1)
    load = rb.Harmonic(amplitude="1 N", frequency="50 Hz")
    rest = {"structure": structure, "tuned_mass": tuned, "load": load, "duration": "0.1 s"}
    case = rb.Case(damper=bed, output=rb.Output(snapshots=4, walls=True), **rest)
    alone = case.without_dampers()
    assert alone == rb.Case(**rest)
    assert rb.simulate(alone).ok
    assert rb.sweep(alone, {"structure.mass": ["1 kg", "2 kg"]}, "peak", progress=False).peak.size == 2
    ball = rb.ImpactDamper(
        ball=rb.Sphere(diameter="20 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    )
    hard = rb.Case(damper=ball, method=rb.Newton(), **rest)
    assert hard.without_dampers() == rb.Case(method=rb.Newton(), **rest)


@pytest.mark.parametrize("word", ["automatic", "aut", ""])
def test_a_word_that_is_no_softening(word: str) -> None:
    """A misspelt "auto" is refused with the word; the message said only that a number is needed."""
    with pytest.raises(
        rb.CaseError, match=r'softening.*\n  a factor is a number of at least 1, or "auto"\n  try: soft'
    ):
        damper(softening=word)
    assert damper(softening="20").softening == 20
