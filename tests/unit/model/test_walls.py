"""Faces of cavities: what is accepted and refused, and how it is written."""

from typing import Any

import numpy as np
import pytest

import rattlebox as rb

BOX = rb.Box(size=(0.02,) * 3)
SLICE = rb.Box(size=(0.02,) * 3, periodic="x")
CAN = rb.Cylinder(diameter=0.02, length=0.03)


def damper(**options: Any) -> rb.ParticleDamper:
    """Return a damper with friction and rolling resistance."""
    usual: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="4 mm", count=20),
        "cavity": BOX,
        "contact": rb.Tsuji(restitution=0.8),
        "friction": 0.3,
        "rolling": 0.1,
    }
    return rb.ParticleDamper(**{**usual, **options})


def at_wall(made: rb.ParticleDamper, face: str) -> Any:
    """Return the entry of the first species and a face."""
    return made.contact_table.at_wall(0, made.cavity.walls().names.index(face))


def test_a_face_has_the_laws_of_the_other_walls_where_it_states_none() -> None:
    """Each law of a face is its own one, or that of the walls, or that of the particles, in this order."""
    made = damper(
        wall="glass",
        wall_friction=0.2,
        pairs=[rb.PairLaws(between=("steel", "wall"), contact=rb.Tsuji(restitution=0.6))],
        walls={"-z": rb.Wall(friction=0.5), "+z": rb.Wall(restitution=0.4, material="rigid"), "+x": "steel"},
    )
    floor, roof, side, other = (at_wall(made, face) for face in ("-z", "+z", "+x", "-y"))
    assert [each.friction.coefficient for each in (floor, roof, side, other)] == [0.5, 0.2, 0.2, 0.2]
    assert [each.rolling.coefficient for each in (floor, roof, side, other)] == [0.1] * 4
    restitutions = [each.contact.restitution.constant_value for each in (floor, roof, side, other)]
    assert restitutions == [0.6, 0.4, 0.6, 0.6]
    names = [getattr(each.pair.above.material, "name", None) for each in (floor, roof, side, other)]
    assert names == ["glass", None, "steel", "glass"]


def test_a_frictionless_face_has_no_rolling_resistance() -> None:
    """One word, or a coefficient of zero, removes friction and rolling resistance from a face."""
    for word in ("frictionless", rb.Wall(friction=0), {"friction": 0}):
        entry = at_wall(damper(walls={"+y": word}), "+y")
        assert entry.friction.coefficient == 0 and (entry.rolling is None or entry.rolling.coefficient == 0)


def test_equal_faces_share_their_laws() -> None:
    """Faces with the same properties are one kind of wall, so that a box has as many laws as it needs."""
    same = dict.fromkeys(("-x", "+x", "-y", "+y"), "frictionless")
    table = damper(walls=same).contact_table
    assert len(table.entries) == 3 and len(np.unique(table.wall_kind)) == 2
    assert len(damper(walls=same | {"-z": "frictionless", "+z": "frictionless"}).contact_table.entries) == 2


ERRORS: dict[str, Any] = {
    r"walls\.bottom = 'frictionless'\n  a box has no face 'bottom'; its faces are -x, .*\n  try: did you mean '-z'": {
        "walls": {"bottom": "frictionless"}
    },
    r"a cylinder has no face '-x'; its faces are side, first end, last end": {"cavity": CAN, "walls": {"-x": "rigid"}},
    r"walls\.-z = 'frictionles'\n  a face is a table, a material, or one of the.*\n  try: did you mean 'frictionless'": {
        "walls": {"-z": "frictionles"}
    },
    r"walls\.-z = 0\.3\n  a face is a table.*\n  try: \{ friction = 0.3 \}": {"walls": {"-z": 0.3}},
    r"walls\.-z\.frction = 0\n  there is no such field here\n  try: did you mean 'friction'": {
        "walls": {"-z": {"frction": 0}}
    },
    r"walls\.-z\.rolling = 0\.1\n  rolling resistance needs friction, and there is none between steel and wall -z": {
        "walls": {"-z": {"friction": 0, "rolling": 0.1}}
    },
    r"linear and tsuji cannot be combined": {
        "walls": {"-z": rb.Wall(contact=rb.Linear(stiffness=1e5, restitution=0.5))}
    },
    r"walls\.-z\.restitution = 0\n  a contact with duration needs a restitution of at least 1e-6": {
        "walls": {"-z": {"restitution": 0}}
    },
    r"walls\.-z\.restitution.* = 2.0": {"walls": {"-z": {"restitution": 2.0}}},
    r"the contact law 'thornton' has no restitution that a face could replace": {
        "contact": rb.Thornton(),
        "walls": {"-z": {"restitution": 0.5}},
    },
    r"walls\.-x = 'rigid'\n  the face -x has no wall, since the box is periodic along x\n  try: no wall at -x": {
        "cavity": SLICE,
        "walls": {"-x": "rigid"},
    },
    r"the box is 7.5 mm wide along x, in which it is periodic; a particle of 4 mm needs at least 8.08 mm": {
        "cavity": rb.Box(size=(0.0075, 0.02, 0.02), periodic="x")
    },
    r"gravity has a component along z, in which the box is periodic: particles would fall forever": {
        "cavity": rb.Box(size=(0.02,) * 3, periodic="z")
    },
    r"cavity\.periodic = 'x'\n  .*only a box has parallel faces.*\n  try: cavity = \{ kind = \"box\", periodic = \"x\"": {
        "cavity": {"kind": "cylinder", "diameter": 0.02, "length": 0.03, "periodic": "x"}
    },
    r"periodic along x, y and z has no wall": {"cavity": {"kind": "box", "size": (0.02,) * 3, "periodic": "xyz"}},
    r"axes: one or two of x, y and z\n  try: \"x\" or \"xy\"": {
        "cavity": {"kind": "box", "size": (0.02,) * 3, "periodic": 1}
    },
    r"an axis is named twice": {"cavity": {"kind": "box", "size": (0.02,) * 3, "periodic": "xx"}},
    r"particle 1 at \(11, 0, 0\) mm sticks out of the cavity by 1 mm": {
        "cavity": SLICE,
        "packing": rb.Positions(positions=[(0.0, 0.0, 0.0), (0.011, 0.0, 0.0)]),
        "particles": rb.Particles(material="steel", diameter="4 mm"),
    },
    r"particles 0 and 1 overlap by 1 mm": {
        "cavity": SLICE,
        "packing": rb.Positions(positions=[(-0.0095, 0.0, 0.0), (0.0075, 0.0, 0.0)]),
        "particles": rb.Particles(material="steel", diameter="4 mm"),
    },
}


@pytest.mark.parametrize("pattern", ERRORS)
def test_invalid_faces_are_refused(pattern: str) -> None:
    """Each invalid face or periodic box is refused with its place, what is allowed, and what to try."""
    with pytest.raises(rb.CaseError, match=pattern):
        damper(**ERRORS[pattern])


def test_walls_are_recorded_of_particle_dampers_only() -> None:
    """A case without particles that asks for the walls is refused, and so is their measure in a study."""
    with pytest.raises(rb.CaseError, match=r"output\.walls.*\n  walls are recorded of a particle damper"):
        rb.reference_case(output=rb.Output(walls=True))
    with pytest.raises(rb.CaseError, match="largest_wall_wear is that of the walls around particles"):
        rb.sweep(rb.reference_case(), {"damper.gap": [1e-3]}, ["largest_wall_wear"], progress=False)


def test_advice_of_refusals_was_followed() -> None:
    """What the messages suggest is accepted."""
    damper(walls={"-z": "frictionless"})
    damper(cavity=rb.Box(size=(8.161e-3, 0.02, 0.02), periodic="x"))
    damper(cavity=rb.Box(size=(0.02,) * 3, periodic="z"), gravity=(9.81, 0, 0))


def test_a_face_without_an_entry_as_an_axis() -> None:
    """A path to a face without an entry is refused with the names of faces or the entry to add, which works.

    Studies of faces were tested with entries that had the field; without one, the advice was an empty list of names.
    """
    case = rb.Case(structure=rb.Fixed(), damper=damper(), duration="1 ms")
    path = "damper.walls.-z.friction"
    with pytest.raises(
        rb.CaseError, match=r"there is no '-z' in damper.walls\n  try: walls = { \"-z\" = {} } in the case"
    ):
        case.replaced({path: 0.1})
    with pytest.raises(rb.CaseError, match=r"no 'bottom' in damper.walls\n  try: did you mean '-z'"):
        case.replaced({"damper.walls.bottom.friction": 0.1})
    with_entry = rb.Case(structure=rb.Fixed(), damper=damper(walls={"-z": {}}), duration="1 ms")
    for name in ("momentum", "sliding_loss"):
        runs = [rb.simulate(each) for each in (case, with_entry)]
        assert np.array_equal(*(getattr(run.arrays, name) for run in runs))
    changed = with_entry.replaced({path: 0.1}).particle_dampers[0]
    assert at_wall(changed, "-z").friction.coefficient == 0.1 and at_wall(changed, "+z").friction.coefficient == 0.3


def test_a_case_file_with_faces_is_read_back_equal() -> None:
    """Faces, with a material of the file, and periodic directions are written to a case file and read back equal."""
    text = """
    duration = "0.1 s"
    structure = { kind = "fixed" }
    [materials.liner]
    density = 1200
    young = "2 GPa"
    poisson = 0.4
    [damper]
    kind = "particle"
    particles = { material = "steel", diameter = "4 mm", count = 20 }
    cavity = { kind = "box", size = ["20 mm", "30 mm", "20 mm"], periodic = "x" }
    contact = { kind = "tsuji", restitution = 0.8 }
    friction = 0.3
    walls = { "-z" = { material = "liner", friction = 0.5 }, "+z" = "frictionless", "+y" = "rigid" }
    [output]
    walls = true
    """
    case = rb.Case.from_toml(text)
    floor: Any = case.particle_dampers[0].walls["-z"]
    assert floor.material.young == 2e9
    assert rb.Case.from_toml(case.to_toml()) == case
    changed = case.replaced({"damper.walls.-z.friction": 0.1, "damper.cavity.periodic": ""})
    floor = changed.particle_dampers[0].walls["-z"]
    assert floor.friction.coefficient == 0.1
    assert "-x" in changed.particle_dampers[0].cavity.walls().names


def test_areas_of_faces_add_up_to_the_surface() -> None:
    """Areas of faces are those of the shapes, and periodic faces have none."""
    assert dict(zip(BOX.walls().labels, BOX.face_areas, strict=True)) == pytest.approx(
        dict.fromkeys(BOX.walls().labels, 4e-4)
    )
    assert SLICE.walls().labels == ("-y", "-z", "+y", "+z") and SLICE.face_areas == pytest.approx([4e-4] * 4)
    assert CAN.face_areas == pytest.approx([np.pi * 0.02 * 0.03, np.pi * 1e-4, np.pi * 1e-4])
    for cavity in (BOX, SLICE, rb.SphericalCavity(radius=0.01)):
        assert cavity.face_areas.sum() / cavity.volume == pytest.approx(cavity.surface_over_volume)


def test_positions_are_wrapped_into_the_box() -> None:
    """Wrapped positions are from minus to plus half of the edge, also for ties and rounding at a face."""
    x = np.array([0.0, 0.01, -0.01, 0.03, -1e-19, 0.0099999999999999999, 12.345])
    wrapped = SLICE.wrapped(np.column_stack([x, x, x]))
    assert np.array_equal(wrapped[:, 1], x) and (wrapped[:, 0] >= -0.01).all() and (wrapped[:, 0] < 0.01).all()
    turns = (x - wrapped[:, 0]) / 0.02
    assert np.allclose(turns, np.rint(turns), rtol=0, atol=1e-9)


@pytest.mark.parametrize("packing", [rb.Lattice(noise=0.5), rb.Settled(seed=3), rb.Compacted(seed=3)], ids=str)
def test_packings_of_periodic_boxes_touch_across_the_faces_without_overlap(packing: Any) -> None:
    """Packings fill a periodic box up to its faces: some particles cross them, and none overlaps the image of another."""
    made = damper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=80),
        cavity=rb.Box(size=(0.02,) * 3, periodic="xy"),
        packing=packing,
    )
    centres = rb.simulate(
        rb.Case(structure=rb.Fixed(), dampers=made.model_copy(update={"softening": 100.0}), duration=1e-6)
    ).arrays.particles.position
    images = np.array([(i, j, 0) for i in (-1, 0, 1) for j in (-1, 0, 1)]) * 0.02
    apart = np.linalg.norm(centres[:, None, None] - centres[None, :, None] + images, axis=-1)
    apart[np.arange(80), np.arange(80), 4] = np.inf
    assert apart.min() > 4e-3 * (1 - 1e-6)
    if not isinstance(packing, rb.Lattice):
        assert (np.abs(centres[:, :2]).max(axis=1) > 0.008).sum() > 5
