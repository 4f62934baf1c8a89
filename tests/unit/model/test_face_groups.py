"""Groups of faces of surfaces: rules, files, names, messages, and all that reads the walls of a damper.

A surface was one wall with the name "mesh", so that no test named a part of it.
"""

import math
import re

import numpy as np
import pytest
from support import triangle_meshes

import rattlebox as rb
from rattlebox.model.plausibility import plausibility_notes
from rattlebox.prepare.settle import start_positions

SIZE = (30, 20, 25)
BOX = triangle_meshes.box(SIZE, 2)
FACES = ("-x", "+x", "-y", "+y", "-z", "+z")
GROUPS = {"floor": "-z", "lid": rb.FaceGroup("+z", within="30 deg"), "side": "rest"}


def box(arrays=BOX, **options):
    """Return a box of triangles in mm."""
    vertices, faces = arrays
    return rb.Mesh(vertices=vertices, faces=faces, **{"unit": "mm", **options})


def damper(cavity, **options):
    """Return a damper of forty balls of 3 mm."""
    usual = {
        "particles": rb.Particles(material="steel", diameter="3 mm", count=40),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.3,
        "packing": rb.Settled(seed=1),
        "softening": 300,
    }
    return rb.ParticleDamper(cavity=cavity, **{**usual, **options})


def areas(cavity):
    """Return the area of each wall [mm^2]."""
    return dict(zip(cavity.walls().labels, (1e6 * cavity.face_areas).tolist(), strict=True))


def test_groups_by_direction_have_names_and_areas():
    """Groups have the areas of their faces; all directions of a box may be written as the names of its faces."""
    assert areas(box(groups=GROUPS)) == pytest.approx({"floor": 600, "lid": 600, "side": 2500})
    assert areas(box(groups={"floor": "-z"})) == pytest.approx({"floor": 600, "mesh": 3100})
    six = areas(box(groups={face: face for face in FACES}))
    assert six == pytest.approx({"-x": 500, "+x": 500, "-y": 750, "+y": 750, "-z": 600, "+z": 600})
    assert areas(box(groups={"one": (0, 3, 0), "wide": rb.FaceGroup((1, 0, 0), within="80 deg")})) == pytest.approx(
        {"one": 750, "wide": 500, "mesh": 2450}
    )
    assert areas(box(groups={"all": "rest"})) == pytest.approx({"all": 3700})


@pytest.mark.parametrize("seed", range(12))
def test_advice_on_an_angle_is_followed(seed):
    """With the angle that the message names, the group has a triangle; no test could follow one without an angle."""
    direction = tuple(np.random.default_rng(seed).normal(size=3))
    with pytest.raises(rb.CaseError, match="no triangle") as raised:
        box(groups={"one": rb.FaceGroup(direction, within="0.01 deg")})
    angle = re.fullmatch(r'within = "(\d+ deg)"', raised.value.suggestion)[1]
    assert areas(box(groups={"one": rb.FaceGroup(direction, within=angle)}))["one"] > 0


def test_groups_by_place():
    """A range contains triangles all corners of which are in it, relative to the centre of the cavity."""
    moved = BOX[0] + (100, -50, 7), BOX[1]
    for arrays in (BOX, moved):
        cavity = box(arrays, groups={"low": rb.FaceGroup(z=("-12.5 mm", "0 mm")), "wing": rb.FaceGroup("x", z=(0, 1))})
        assert areas(cavity) == pytest.approx({"low": 600 + 1250, "wing": 250, "mesh": 3700 - 1850 - 250})


def test_distances_belong_to_the_nearest_group():
    """The nearest wall of a point is its group, and the distance that of the surface."""
    cavity, plain = box(groups=GROUPS), box()
    points = np.random.default_rng(1).uniform(-0.009, 0.009, (500, 3))
    assert np.array_equal(cavity.depth(points), plain.depth(points))
    below = np.column_stack([points[:, :2], np.full(500, -0.0124)])
    assert {cavity.walls().labels[k] for k in cavity.nearest_wall(below)} == {"floor"}


def test_triangles_across_a_limit_are_noted():
    """A range that ends between corners leaves out the triangles there, with a warning."""
    cavity = box(groups={"low": rb.FaceGroup(z=("-12.5 mm", "1 mm"))})
    notes = plausibility_notes(rb.Case(structure=rb.Fixed(), damper=damper(cavity), duration="1 ms"))
    assert any(note.startswith("warning") and "16 triangles reach across" in note and "'low'" in note for note in notes)
    exact = box(groups={"low": rb.FaceGroup(z=("-12.5 mm", "0 mm"))})
    notes = plausibility_notes(rb.Case(structure=rb.Fixed(), damper=damper(exact), duration="1 ms"))
    assert not any("across" in note for note in notes)


REFUSED = {
    "an empty group": ({"groups": {"floor": (1, 1, 1)}}, r"no triangle .* 'floor'; the nearest direction"),
    "an empty range": ({"groups": {"a": rb.FaceGroup(z=("1 m", "2 m"))}}, "no triangle .* 'a'"),
    "a range between corners": ({"groups": {"a": rb.FaceGroup("x", z=("-5 mm", "5 mm"))}}, "8 triangles reach across"),
    "a triangle in two groups": (
        {"groups": {"a": "-z", "b": rb.FaceGroup(z=("-13 mm", "0 mm"))}},
        r"8 triangles would be in the groups 'a' and 'b', the first near \(.*-12.5\) mm from the centre",
    ),
    "two rests": ({"groups": {"a": "rest", "b": "rest"}}, "a and b are both the rest"),
    "nothing left": (
        {"groups": {**{face: face for face in FACES}, "other": "rest"}},
        "no triangle is left for .*'other'",
    ),
    "no direction": ({"groups": {"a": "down"}}, "a direction, a table, or the word rest"),
    "no direction of a table": ({"groups": {"a": {"facing": "w"}}}, "a direction is x, y, z"),
    "a zero direction": ({"groups": {"a": (0, 0, 0)}}, "must not be zero"),
    "two components": ({"groups": {"a": (0, 1)}}, "three numbers"),
    "no conditions": ({"groups": {"a": {}}}, "has conditions, or is the rest"),
    "rest and a direction": ({"groups": {"a": {"facing": "x", "rest": True}}}, "has conditions, or is the rest"),
    "no angle": ({"groups": {"a": {"facing": "x", "within": 0}}}, "above 0 and up to 90"),
    "a wide angle": ({"groups": {"a": {"facing": "x", "within": "100 deg"}}}, "above 0 and up to 90"),
    "a unit of the angle": ({"groups": {"a": {"facing": "x", "within": "10 mm"}}}, "mm"),
    "a turned range": ({"groups": {"a": {"z": ["5 mm", "-5 mm"]}}}, "above the highest"),
    "one limit": ({"groups": {"a": {"z": ["5 mm"]}}}, r"groups.a.z(?s:.*)lowest and the highest"),
    "a number as limits": ({"groups": {"a": {"z": 3}}}, "lowest and the highest"),
    "a number": ({"groups": {"a": 3}}, "a direction, a table, or the word rest"),
    "a list": ({"groups": ["-z"]}, "groups are a table"),
    "another word": ({"groups": "auto"}, "groups are a table"),
    "another field": ({"groups": {"a": {"faces": "x"}}}, "faces"),
    "an empty name": ({"groups": {"": "-z"}}, "no name of a group"),
    "a path as a name": ({"groups": {"lid.top": "-z"}}, "no name of a group"),
    "a control character": ({"groups": {"a\nb": "-z"}}, "control character"),
    "the name of the rest": ({"groups": {"mesh": "-z"}}, "name of the triangles that are in no group"),
    "no file": ({"groups": "file"}, "no file with groups"),
    "names for fewer triangles": ({"face_groups": ["a", "b"]}, "2 names, but 48 triangles"),
    "names and rules": ({"groups": {"a": "-z"}, "face_groups": ["a"] * 48}, "exclude each other"),
    "numbers as names": ({"face_groups": list(range(48))}, "face_groups"),
    "many groups": ({"face_groups": [f"g{k}" for k in range(48)] * 5, "parts": 5}, "too many"),
}


@pytest.mark.parametrize("fault", list(REFUSED))
def test_faulty_groups_are_refused(fault):
    """Groups that are empty, overlap or have no meaning are refused, with what is allowed and what to try."""
    values, text = REFUSED[fault]
    values = dict(values)
    arrays = BOX
    if (parts := values.pop("parts", None)) is not None:
        arrays = triangle_meshes.box(SIZE, parts)
        values["face_groups"] = [f"g{k}" for k in range(len(arrays[1]))]
    with pytest.raises(rb.CaseError, match="(?s)" + text):
        box(arrays, **values)


@pytest.mark.parametrize("bodies", [[], [rb.RodBody(diameter="3 mm", length="8 mm")]])
def test_unknown_group_is_refused_with_the_names(bodies):
    """A wall that does not exist is refused with the names of those that do, and advice that works."""
    with pytest.raises(rb.CaseError, match=r"(?s)no face 'flor'; its faces are floor, lid, side.*did you mean 'floor'"):
        damper(box(groups=GROUPS), walls={"flor": "frictionless"}, bodies=bodies)
    with pytest.raises(rb.CaseError, match=r'(?s)its faces are mesh.*try: .*groups = \{ "top" = "\+z" \}'):
        damper(box(), walls={"top": "frictionless"}, bodies=bodies)
    assert "top" in damper(box(groups={"top": "+z"}), walls={"top": "frictionless"}, bodies=bodies).walls


def obj(names, word="g", head=""):
    """Return an OBJ file of the box in which each of its six faces has a name, by a line with this word."""
    text = head + "".join(f"v {x} {y} {z}\n" for x, y, z in BOX[0])
    for k, face in enumerate(BOX[1]):
        if k % 8 == 0 and names[k // 8] is not None:
            text += f"{word} {names[k // 8]}\n"
        text += f"f {' '.join(str(corner + 1) for corner in face)}\n"
    return text


def stl(names):
    """Return a text STL file with a solid for each of the six faces."""
    text = ""
    for k, name in enumerate(names):
        text += f"solid {name}\n"
        for face in BOX[1][8 * k : 8 * k + 8]:
            corners = "".join(f"vertex {x} {y} {z}\n" for x, y, z in BOX[0][face])
            text += f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n"
        text += f"endsolid {name}\n"
    return text


def ply(numbers, name="group"):
    """Return a PLY file with a number of each face."""
    head = f"ply\nformat ascii 1.0\nelement vertex {len(BOX[0])}\n" + "".join(f"property float {x}\n" for x in "xyz")
    head += f"element face {len(BOX[1])}\nproperty list uchar int vertex_indices\nproperty int {name}\nend_header\n"
    rows = "".join(f"{x} {y} {z}\n" for x, y, z in BOX[0])
    return head + rows + "".join(f"3 {a} {b} {c} {numbers[k // 8]}\n" for k, (a, b, c) in enumerate(BOX[1]))


SIX = ("left", "right", "front", "back", "floor", "lid")
OF_SIX = dict(zip(SIX, (500, 500, 750, 750, 600, 600), strict=True))
FILES = {
    "groups.obj": (obj(SIX), OF_SIX),
    "objects.obj": (obj(SIX, "o", "g all\n"), OF_SIX),
    "materials.obj": (obj(SIX, "usemtl", "o Box\nmtllib none.mtl\n"), OF_SIX),
    "late.obj": (obj((None, None, None, None, "floor", None)), {"floor": 1200, "mesh": 2500}),
    "paths.obj": (
        obj(("Box.001", "Box.001", "Box.001", "Box.001", "lid [1]", "lid [1]")),
        {"Box_001": 2500, "lid _1_": 1200},
    ),
    "numbers.obj": (obj(("f 10", "f 9", "f 10", "f 9", "f 9", "f 10")), {"f 9": 1850, "f 10": 1850}),
    "solids.stl": (stl(SIX), OF_SIX),
    "group.ply": (ply((1, 1, 2, 2, 3, 10)), {"group 1": 1000, "group 2": 1500, "group 3": 600, "group 10": 600}),
    "label.ply": (ply((0, 0, 0, 0, 1, 1), "label"), {"label 0": 2500, "label 1": 1200}),
}


@pytest.mark.parametrize("name", list(FILES))
def test_groups_of_a_file(tmp_path, name):
    """Groups of each format are walls, in the order of their names; a case file keeps them."""
    pytest.importorskip("trimesh")
    text, expected = FILES[name]
    (tmp_path / name).write_text(text)
    cavity = rb.Mesh(file=str(tmp_path / name), unit="mm", groups="file")
    assert areas(cavity) == pytest.approx(expected)
    assert list(areas(cavity)) == sorted(
        expected, key=lambda each: (each == "mesh", [int(w) if w.isdigit() else w for w in each.split()])
    )
    assert areas(rb.Mesh(file=str(tmp_path / name), unit="mm")) == pytest.approx({"mesh": 3700})
    wall = next(iter(expected))
    case = rb.Case(structure=rb.Fixed(), damper=damper(cavity, walls={wall: "frictionless"}), duration="1 ms")
    case.to_file(tmp_path / "case.toml")
    again = rb.Case.from_file(tmp_path / "case.toml")
    assert again == case
    assert areas(again.particle_dampers[0].cavity) == areas(cavity)
    assert "face_groups" not in (tmp_path / "case.toml").read_text()


def test_faces_of_a_step_file_are_groups(tmp_path):
    """A single body of a STEP file has a group for each face."""
    pytest.importorskip("trimesh")
    pytest.importorskip("cascadio")
    (tmp_path / "box.step").write_text(triangle_meshes.step_box(SIZE))
    cavity = rb.Mesh(file=str(tmp_path / "box.step"), groups="file")
    assert areas(cavity) == pytest.approx(
        dict(zip([f"face {k}" for k in range(1, 7)], (500, 500, 750, 750, 600, 600), strict=True))
    )


WITHOUT = {
    "plain.obj": obj((None,) * 6),
    "one.obj": obj(("all",) * 6),
    "other.ply": ply((1, 1, 2, 2, 3, 3), "red"),
}


@pytest.mark.parametrize("name", ["plain.obj", "one.obj", "other.ply", "binary.stl", "box.off"])
def test_file_without_groups_is_refused_with_advice(tmp_path, name):
    """A file with no groups, or with one, is refused; the rule that the message advises gives groups."""
    trimesh = pytest.importorskip("trimesh")
    if name in WITHOUT:
        (tmp_path / name).write_text(WITHOUT[name])
    else:
        trimesh.Trimesh(*BOX, process=False).export(tmp_path / name)
    with pytest.raises(rb.DataError, match=r'(?s)(no groups of faces|one group).*try: .*floor = "-z", side = "rest"'):
        rb.Mesh(file=str(tmp_path / name), unit="mm", groups="file")
    cavity = rb.Mesh(file=str(tmp_path / name), unit="mm", groups={"floor": "-z", "side": "rest"})
    assert areas(cavity) == pytest.approx({"floor": 600, "side": 3100})


def test_polygons_with_numbers_are_refused(tmp_path):
    """A PLY file whose faces have four corners and a number is refused, because the numbers are not those of triangles."""
    pytest.importorskip("trimesh")
    text = ply((1, 1, 2, 2, 3, 3)).splitlines()
    rows = [f"4 {4 * k} {4 * k + 1} {4 * k + 2} {4 * k + 3} {k}" for k in range(6)]
    head = [line.replace(f"face {len(BOX[1])}", "face 6") for line in text if not line.startswith("3 ")]
    (tmp_path / "box.ply").write_text("\n".join([*head, *rows]) + "\n")
    with pytest.raises(rb.DataError, match="more than three corners"):
        rb.Mesh(file=str(tmp_path / "box.ply"), unit="mm", groups="file")


def test_name_of_a_group_of_the_file_is_advised(tmp_path):
    """The message about a wall that is a group of the file says how to use these groups."""
    pytest.importorskip("trimesh")
    (tmp_path / "box.obj").write_text(obj(SIX))
    with pytest.raises(rb.CaseError, match=r'(?s)no face \'lid\'.*try: .*groups = "file"'):
        damper(rb.Mesh(file=str(tmp_path / "box.obj"), unit="mm"), walls={"lid": "frictionless"})


def test_names_of_arrays():
    """Arrays have names of triangles in place of a file; triangles without a name are the wall "mesh"."""
    names = np.repeat(["left", "", "front", "front", "floor", "floor"], 8)
    cavity = box(face_groups=names)
    assert areas(cavity) == pytest.approx({"floor": 1200, "front": 1500, "left": 500, "mesh": 500})


def test_groups_of_triangles_that_are_left_out():
    """Names stay with their triangles where a triangle without three corners is left out."""
    faces = np.concatenate([BOX[1][:8], [[0, 0, 1]], BOX[1][8:]])
    names = ["left"] * 9 + ["right"] * 8 + ["other"] * 32
    assert areas(box((BOX[0], faces), face_groups=names)) == pytest.approx({"left": 500, "other": 2700, "right": 500})


def shaken():
    """Return a case with groups, shaken."""
    walls = {"floor": rb.Wall(friction=0.5), "side": rb.Wall(material="glass", restitution=0.3)}
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="40 m/s^2", frequency="40 Hz", direction="x")),
        damper=damper(box(groups=GROUPS), walls=walls),
        duration="60 ms",
        output=rb.Output(walls=True, rate="1 kHz", snapshots=3),
    )


def test_case_file_report_pictures_and_files(tmp_path):
    """A case with groups is read back from its file; report, pictures, snapshots and results have its walls."""
    case = shaken()
    case.to_file(tmp_path / "case.toml")
    assert rb.Case.from_file(tmp_path / "case.toml") == case
    run = rb.simulate(case, snapshots=tmp_path / "run.vtkhdf")
    assert run.ok
    snapshots = rb.Snapshots(tmp_path / "run.vtkhdf")
    assert len(snapshots) == 3
    rb.plot_particles(snapshots)
    run.save(tmp_path / "run.nc")
    again = rb.load(tmp_path / "run.nc")
    assert list(again.arrays.walls) == ["floor", "lid", "side"]
    assert rb.analysis.wall_wear(again) == rb.analysis.wall_wear(run)
    assert rb.analysis.wall_wear(run)["floor"] > 0
    rb.plot_case(case)
    rb.write_report(run, tmp_path / "report.html")
    assert "3 groups" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_friction_of_a_group_is_an_axis():
    """A study varies the friction of one group; the loss at that wall follows."""
    study = rb.sweep(
        shaken(), {"damper.walls.floor.friction": [0.0, 0.4]}, measure=["largest_wall_wear", "largest_wall_pressure"]
    )
    wear = study["largest_wall_wear"].values
    assert np.isfinite(wear).all()
    assert wear[1] > wear[0]


@pytest.mark.parametrize("packing", [rb.Lattice(seed=1), rb.Settled(seed=1), rb.Compacted(seed=1)])
def test_packings_do_not_depend_on_groups(packing):
    """Positions in a surface with groups are those without, for the same friction."""
    beds = [start_positions(damper(box(groups=groups), packing=packing)) for groups in ({}, GROUPS)]
    assert np.allclose(beds[0], beds[1], rtol=0, atol=1e-12)


def test_bodies_and_groups_have_different_names():
    """A body with the name of a group gets a number; both have results."""
    interior = damper(box(groups=GROUPS), bodies=[rb.BallBody(diameter="5 mm", name="floor")]).interior
    assert interior.walls().labels == ("floor", "lid", "side", "floor2")
    assert 1e6 * interior.face_areas == pytest.approx([600, 600, 2500, math.pi * 25], rel=2e-3)
