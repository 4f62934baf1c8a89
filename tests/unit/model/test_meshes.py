"""Surfaces of triangles and bodies in cases: files, units, checks and messages.

No cavity had a file or bodies, so that no test could see what a surface with a hole or a wrong unit does.
"""

import math

import numpy as np
import pytest
from support import triangle_meshes

import rattlebox as rb
from rattlebox.model.plausibility import plausibility_notes
from rattlebox.prepare.settle import ENLARGEMENT, push_apart, start_positions

BOX = triangle_meshes.box((30, 20, 25), 2)

EDGES = ("30 mm", "20 mm", "25 mm")


def box(vertices=BOX[0], faces=BOX[1], **options):
    """Return a box of triangles in mm."""
    return rb.Mesh(vertices=vertices, faces=faces, **{"unit": "mm", **options})


def damper(cavity=None, **options):
    """Return a damper of ten balls of 3 mm."""
    usual = {
        "particles": rb.Particles(material="steel", diameter="3 mm", count=10),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.3,
        "packing": rb.Lattice(seed=1),
    }
    return rb.ParticleDamper(cavity=cavity or rb.Box(size=EDGES), **{**usual, **options})


def test_measures_of_surface_are_those_of_its_shape():
    """Volume, area, bounding box and distances of a box of triangles are those of the box."""
    exact, cavity = rb.Box(size=("30 mm", "20 mm", "25 mm")), box()
    assert cavity.volume == pytest.approx(exact.volume, rel=1e-12)
    assert cavity.surface_over_volume == pytest.approx(exact.surface_over_volume, rel=1e-12)
    assert np.allclose(cavity.lengths, exact.lengths, rtol=1e-12)
    assert cavity.extent(np.array([0.6, 0.8, 0.0])) == pytest.approx(exact.extent(np.array([0.6, 0.8, 0.0])), rel=1e-12)
    points = np.random.default_rng(1).uniform(-0.02, 0.02, (2000, 3))
    inside = exact.depth(points) > 0
    assert np.array_equal(cavity.depth(points) > 0, inside)
    assert np.allclose(cavity.depth(points)[inside], exact.depth(points)[inside], atol=1e-15)
    assert 2 * 0.01 * 0.99 < cavity.widest <= 0.02 * (1 + 1e-9)
    assert "30 x 20 x 25 mm" in cavity.words()


@pytest.mark.parametrize("ending", [".stl", ".obj", ".ply", ".off", ".step"])
def test_surface_is_read_from_file(tmp_path, ending):
    """Files of each format give the box that was written, with the unit that is stated."""
    trimesh = pytest.importorskip("trimesh")
    file = tmp_path / f"box{ending}"
    unit = {"unit": "mm"}
    if ending == ".step":
        pytest.importorskip("cascadio")
        file.write_text(triangle_meshes.step_box((30, 20, 25)))
        unit = {}
    else:
        trimesh.Trimesh(BOX[0] + (7, 8, 9), BOX[1], process=False).export(file)
    cavity = rb.Mesh(file=str(file), **unit)
    assert cavity.volume == pytest.approx(15e-6, rel=1e-6)
    centre = (0.015, 0.01, 0.0125) if ending == ".step" else (0.007, 0.008, 0.009)
    assert np.allclose(cavity.centre, centre, atol=1e-8)
    case = rb.Case(structure=rb.Fixed(), damper=damper(cavity), duration="1 ms")
    case.to_file(tmp_path / "case.toml")
    assert rb.Case.from_file(tmp_path / "case.toml").dampers[0].cavity.volume == cavity.volume


def open_box():
    """Return a box that lacks a triangle."""
    return {"faces": BOX[1][1:]}


def turned_triangle():
    """Return a box with one triangle inside out."""
    faces = BOX[1].copy()
    faces[3] = faces[3][::-1]
    return {"faces": faces}


def two_boxes(shift):
    """Return two boxes, the second smaller and displaced."""
    vertices = np.concatenate([BOX[0], 0.4 * BOX[0] + shift])
    return {"vertices": vertices, "faces": np.concatenate([BOX[1], BOX[1] + len(BOX[0])])}


def flat_triangle():
    """Return a box in which an edge is divided on one side only, with a triangle without area beside it."""
    vertices, faces = triangle_meshes.box((30, 20, 25), 1)
    merged, number = np.unique(vertices, axis=0, return_inverse=True)
    faces = number.reshape(-1)[faces]
    a, b, c = faces[0]
    middle = len(merged)
    return {
        "vertices": np.concatenate([merged, [(merged[a] + merged[b]) / 2]]),
        "faces": np.concatenate([faces[1:], [[a, middle, c], [middle, b, c], [a, b, middle]]]),
    }


REFUSED = {
    "open": (open_box, "open: 3 edges"),
    "inside out": (turned_triangle, "normals of the surface are not consistent"),
    "crossing": (lambda: two_boxes((12, 0, 0)), "crosses itself"),
    "two cavities": (lambda: two_boxes((40, 0, 0)), "2 shells"),
    "flat": (flat_triangle, "no area"),
    "no unit": (lambda: {"unit": None}, "the unit of the coordinates is needed"),
    "no length": (lambda: {"unit": "kg"}, "'kg' is not a unit of length"),
    "no triangles": (lambda: {"faces": np.zeros((0, 3))}, "no triangles"),
    "a corner that is missing": (lambda: {"faces": [[0, 1, 9999]]}, "corner 9999"),
    "a table of two columns": (lambda: {"vertices": [[0, 1], [1, 2]]}, "rows of 3 finite numbers"),
    "an angle": (lambda: {"smooth_angle": 3.0}, "0 to 90 degrees"),
}


@pytest.mark.parametrize("fault", list(REFUSED))
def test_faulty_surface_is_refused(fault):
    """A surface through which particles would leave, or without an inside, is refused with a place and advice."""
    values, text = REFUSED[fault]
    with pytest.raises(rb.CaseError, match="(?s)" + text + ".*try: "):
        box(**values())


def test_inverted_surface_is_turned_around_with_a_warning():
    """A surface whose normals all point inward is the same cavity, and a run says so."""
    cavity = box(faces=BOX[1][:, ::-1])
    assert cavity.volume == pytest.approx(15e-6)
    assert cavity.depth(np.zeros((1, 3)))[0] == pytest.approx(0.01)
    case = rb.Case(structure=rb.Fixed(), damper=damper(cavity), duration="1 ms")
    assert any(note.startswith("warning") and "point inward" in note for note in plausibility_notes(case))


def test_inner_shell_is_a_body():
    """A shell inside the largest one bounds a body, whichever way its normals point."""
    for turn in (1, -1):
        values = two_boxes((0, 0, 0))
        values["faces"][len(BOX[1]) :] = values["faces"][len(BOX[1]) :, ::turn]
        cavity = box(**values)
        assert cavity.volume == pytest.approx(15e-6 * (1 - 0.4**3))
        assert cavity.depth(np.zeros((1, 3)))[0] == pytest.approx(-0.004)
        assert "1 body inside" in cavity.words()


@pytest.mark.parametrize(
    ("body", "volume"),
    [
        (rb.RodBody(diameter="8 mm"), math.pi / 4 * 8**2 * 25),
        (rb.RodBody(diameter="8 mm", axis="x", length="10 mm"), math.pi / 4 * 8**2 * 10),
        (rb.PlateBody(size=("2 mm", "10 mm", "10 mm"), angle="30 deg"), 200.0),
        (rb.PlateBody(size=("2 mm", "80 mm", "10 mm")), 2 * 20 * 10),
        (rb.BallBody(diameter="6 mm", position=("15 mm", 0, 0)), math.pi / 6 * 6**3 / 2),
        (rb.BodyRing(body=rb.RodBody(diameter="2 mm"), count=5, radius="6 mm"), 5 * math.pi * 25),
        (rb.BodyRow(body=rb.BallBody(diameter="2 mm"), count=3, step=("5 mm", 0, 0)), 3 * math.pi / 6 * 8),
        (rb.BodyCross(thickness="1 mm"), (30 + 20 - 1) * 25),
    ],
)
def test_volume_is_that_without_bodies(body, volume):
    """The volume of a cavity lacks that of the bodies, as far as they are inside and not in each other."""
    assert 1e9 * damper(bodies=[body]).interior.volume == pytest.approx(15e3 - volume, rel=2e-5)


def test_honeycomb_has_walls_between_cells():
    """Seven cells have thirty walls, and the middle of each cell is half a cell from them."""
    comb = rb.Honeycomb(cell="10 mm", thickness="1 mm", rings=1)
    cavity = damper(rb.Cylinder(diameter="60 mm", length="10 mm"), bodies=[comb]).interior
    assert len(cavity.solids) == 30
    middles = np.column_stack([comb.centres(), np.zeros(7)])
    assert np.allclose(cavity.depth(middles), 4.5e-3, atol=1e-12)
    assert cavity.walls().labels[-1] == "honeycomb"


@pytest.mark.parametrize(
    ("bodies", "text"),
    [
        ([rb.BallBody(diameter="4 mm", position=("50 mm", 0, 0))], "outside of the cavity"),
        ([rb.BallBody(diameter="60 mm")], "fill the whole cavity"),
        ([rb.RodBody(diameter="18 mm"), rb.PlateBody(size=("1 mm", "40 mm", "40 mm"))], "larger than the cavity"),
    ],
)
def test_bodies_that_leave_no_space_are_refused(bodies, text):
    """Bodies outside of the cavity, or that leave no room for a particle, are refused."""
    particles = rb.Particles(material="steel", diameter="9 mm", count=1)
    with pytest.raises(rb.CaseError, match="(?s)" + text):
        damper(bodies=bodies, particles=particles)


def test_necks_narrower_than_particles_are_noted():
    """A run notes into how many parts bodies divide the space, and only for particles that cannot pass."""
    shelf = rb.PlateBody(size=("2 mm", "16 mm", "30 mm"))
    for diameter, divided in (("3 mm", True), ("1.2 mm", False)):
        notes = list(damper(bodies=[shelf]).interior.notes(float(diameter.split()[0]) / 2e3))
        assert any("2 parts" in note for note in notes) == divided


@pytest.mark.parametrize("share", [20, 50, 125])
@pytest.mark.parametrize(("neck", "parts"), [(0.95, 2), (2.2, 1), (0.0, 2)])
def test_necks_of_any_width_are_checked(share, neck, parts):
    """Particles down to 1/128 of a cavity pass a slit that is wider than they are, and no thin wall.

    Only particles larger than 1/32 of the cavity were checked, and others passed every wall without a word.
    """
    wide, diameter = 0.06, 0.06 / share
    side = (wide - neck * diameter) / 2
    shape = rb.Box(size=(wide, wide / 3, wide))
    walls = [
        rb.PlateBody(size=(diameter / 20, wide, side), position=(0, 0, sign * (wide - side) / 2)) for sign in (-1, 1)
    ]
    interior = damper(shape, bodies=walls).interior
    notes = list(interior.notes(diameter / 2))
    assert any("2 parts" in note for note in notes) == (parts == 2)
    assert not any("not checked" in note for note in notes)


def test_necks_that_are_too_narrow_for_the_check_are_stated():
    """Particles of less than 1/128 of a cavity with bodies have a warning with the width that is not checked."""
    notes = list(damper(bodies=[rb.PlateBody(size=("1 um", "20 mm", "25 mm"))]).interior.notes(2e-5))
    assert any(note.startswith("warning: necks and walls thinner than 0.47 mm") and "try: " in note for note in notes)


@pytest.mark.parametrize("packing", [rb.Lattice(seed=1), rb.Settled(seed=1), rb.Compacted(seed=1)])
def test_packings_avoid_walls_and_bodies(packing):
    """Packings place all particles inside of a surface and outside of bodies."""
    for one in (
        damper(box(), packing=packing, particles=rb.Particles(material="steel", diameter="3 mm", count=60)),
        damper(
            rb.Cylinder(diameter="30 mm", length="20 mm"),
            bodies=[rb.RodBody(diameter="10 mm")],
            packing=packing,
            particles=rb.Particles(material="steel", diameter="3 mm", count=60),
        ),
    ):
        positions = start_positions(one)
        assert one.interior.room(positions, one.contents.radius).min() > -1e-9 * 1.5e-3


@pytest.mark.parametrize("groups", [{}, {"floor": "-z", "lid": "+z", "side": "rest"}])
def test_spheres_pushed_through_a_surface_return(groups):
    """A centre beyond faces, edges and corners of triangles moves back; beds were so loose that none was pushed through."""
    radii = np.full(3, 1.5e-3)
    beyond = np.array([[0.0, 10.9e-3, 1e-3], [15.4e-3, 10.3e-3, 2e-3], [15.2e-3, 10.5e-3, 12.8e-3]])
    interior = damper(box(groups=groups)).interior
    inside = push_apart(interior, beyond, radii, ENLARGEMENT)
    assert interior.room(inside, radii).min() >= 0
    assert np.linalg.norm(inside - beyond, axis=1).max() < 5e-3  # through the nearest face


def test_wall_of_body_has_its_own_results():
    """A body is a wall with its own name, material and force."""
    case = rb.Case(
        structure=rb.Fixed(),
        damper=damper(
            bodies=[rb.PlateBody(size=("30 mm", "20 mm", "5 mm"), position=(0, 0, "-10 mm"), name="block")],
            packing=rb.Positions(positions=[[x, 0, -6e-3] for x in (-9e-3, 0, 9e-3)]),
            particles=rb.Particles(material="steel", diameter="3 mm"),
        ),
        duration="30 ms",
        output=rb.Output(walls=True),
    )
    run = rb.simulate(case)
    assert run.ok
    wall = list(run.arrays.walls).index("block")
    weight = 9.81 * run.arrays.particles.mass.sum()
    assert run.arrays.wall_force[-1, wall, 2] == pytest.approx(-weight, rel=0.05)


def test_bed_of_a_file_that_has_changed_is_settled_again(tmp_path):
    """A file that is written again with another surface gives another bed, although its name is the same."""
    import trimesh

    beds = []
    for height in (0.010, 0.025):
        path = tmp_path / "cavity.stl"
        trimesh.creation.box((0.03, 0.02, height)).export(path)
        beds.append(start_positions(damper(rb.Mesh(file=path, unit="m"), packing=rb.Settled(seed=1))))
    lowest = [bed[:, 2].min() for bed in beds]
    assert lowest == pytest.approx([-0.005 + 0.0015, -0.0125 + 0.0015], abs=1e-5)


def test_cut_file_is_named(tmp_path):
    """A binary STL file that is too short or too long for its number of triangles is refused with both lengths.

    Cut files were tried at random, and any refusal was accepted: it said that the file contains no triangles.
    """
    trimesh = pytest.importorskip("trimesh")
    path = tmp_path / "cavity.stl"
    trimesh.creation.box((0.03, 0.02, 0.01)).export(path)
    content = path.read_bytes()
    for damaged in (content[:-50], content[:301], content + b"end"):
        path.write_bytes(damaged)
        with pytest.raises(
            rb.DataError, match=rf"states 12 triangles, for which it needs 684 bytes, and has {len(damaged)}"
        ):
            rb.Mesh(file=path, unit="m")


def test_plate_in_front_of_a_surface_is_a_face():
    """A plate in front of a part of a surface has results and laws of its own."""
    floor = rb.PlateBody(name="floor", size=("34 mm", "24 mm", "4 mm"), position=(0, 0, "-13.5 mm"))
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="20 m/s^2", frequency="30 Hz", direction="x")),
        damper=damper(
            box(), bodies=[floor], walls={"floor": "frictionless"}, packing=rb.Settled(seed=1), softening=300
        ),
        duration="80 ms",
        output=rb.Output(walls=True),
    )
    run = rb.simulate(case)
    names = list(run.arrays.walls)
    assert names == ["mesh", "floor"]
    sliding, normal = run.arrays.wall_sliding_loss[-1], run.arrays.wall_normal_impulse[-1]
    assert normal[1] > 3 * normal[0] > 0
    assert sliding[1] == 0 < sliding[0]
    # The area was a share of that of the whole plate, most of which is in the wall.
    assert run.arrays.wall_area[1] == pytest.approx(30e-3 * 20e-3, rel=1e-3)
    pressure = rb.analysis.wall_pressures(run)["floor"] * 30e-3 * 20e-3
    assert pressure == pytest.approx(9.81 * run.arrays.particles.mass.sum(), rel=0.1)


@pytest.mark.parametrize(
    ("bodies", "area"),
    [
        ([rb.RodBody(diameter="8 mm")], math.pi * 8 * 25),
        ([rb.BallBody(diameter="6 mm", position=("15 mm", 0, 0))], math.pi * 36 / 2),
        ([rb.PlateBody(size=("2 mm", "80 mm", "10 mm"))], 2 * (20 * 10 + 20 * 2)),
        ([rb.BodyCross(thickness="1 mm")], 2 * (29 + 19) * 25),
    ],
)
def test_area_of_a_body_is_that_inside_the_cavity(bodies, area):
    """What is in a wall, or in another body, is not an area of a body on which particles press."""
    assert 1e6 * damper(bodies=bodies).interior.face_areas[-1] == pytest.approx(area, rel=2e-3)


@pytest.mark.parametrize(
    ("cavity", "bodies", "face", "area"),
    [
        (rb.Box(size=EDGES), [rb.RodBody(diameter="8 mm")], "+z", 600 - math.pi * 16),
        (rb.Box(size=EDGES), [rb.RodBody(diameter="8 mm")] * 2, "+z", 600 - math.pi * 16),
        (rb.Box(size=EDGES), [rb.RodBody(diameter="8 mm")], "+x", 500),
        (rb.Box(size=EDGES), [rb.BallBody(diameter="12 mm", position=("15 mm", 0, 0))], "+x", 500 - math.pi * 36),
        (rb.Box(size=EDGES), [rb.PlateBody(size=("30 mm", "20 mm", "2 mm"), position=(0, 0, "-12.5 mm"))], "-z", 0),
        (
            rb.Cylinder(diameter="20 mm", length="9 mm"),
            [rb.BodyCross(thickness="1 mm")],
            "side",
            (20 * math.pi - 4) * 9,
        ),
        (
            rb.Cylinder(diameter="20 mm", length="9 mm"),
            [rb.BodyCross(thickness="1 mm")],
            "first end",
            100 * math.pi - 39,
        ),
        (box(groups={"lid": "z"}), [rb.RodBody(diameter="8 mm")], "lid", 600 - math.pi * 16),
        (box(groups={"lid": "z"}), [rb.RodBody(diameter="8 mm")], "mesh", 3100 - math.pi * 16),
    ],
)
def test_area_of_a_wall_is_that_beside_the_bodies(cavity, bodies, face, area):
    """What is under bodies that stand on a wall is not an area of the wall on which particles press.

    Areas of bodies were tested, and those of walls with bodies on them were the areas without bodies: pressures on the floor
    of a honeycomb were a sixth too small.
    """
    interior = damper(cavity, bodies=bodies).interior
    areas = dict(zip(interior.walls().labels, 1e6 * interior.face_areas, strict=True))
    assert areas[face] == pytest.approx(area, rel=1e-3, abs=0.05)


@pytest.mark.parametrize(
    ("bodies", "areas"),
    [
        ([rb.PlateBody(size=("8 mm", "6 mm", "2 mm"), position=(0, 0, f"{2 * k} mm")) for k in range(2)], [104, 104]),
        ([rb.PlateBody(size=("8 mm", "6 mm", "2 mm"))] * 2, [152, 0]),
        ([rb.PlateBody(size=("8 mm", "6 mm", "2 mm")), rb.PlateBody(size=("8 mm", "4 mm", "2 mm"))], [152, 0]),
        ([rb.BallBody(diameter="6 mm")] * 2, [math.pi * 36, 0]),
        ([rb.RodBody(diameter="4 mm", length="10 mm")] * 2, [math.pi * 48, 0]),
    ],
)
def test_area_of_bodies_that_touch(bodies, areas):
    """Faces on each other are no area, and a surface of two bodies is that of the first.

    Bodies reached into each other or were apart, so that it was not seen that faces on each other counted for both, and the
    surfaces of equal balls for none.
    """
    assert 1e6 * damper(bodies=bodies).interior.face_areas[-2:] == pytest.approx(areas, rel=2e-3, abs=0.01)
