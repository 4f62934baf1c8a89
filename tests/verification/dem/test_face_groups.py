"""Groups of faces of a surface as walls: the motion, loads and losses are those of exact walls, whatever the order of faces.

A surface was one wall, so that no test had two laws on it, or an edge between them.
"""

import math

import numpy as np
import pytest
from support import triangle_meshes
from support.dem_cases import ends_alike

import rattlebox as rb

RADIUS, SIZE, GRAVITY = 2e-3, (0.032, 0.022, 0.026), 9.81
FACES = ("-x", "+x", "-y", "+y", "-z", "+z")
LAWS = {
    "-z": rb.Wall(friction=0.6, rolling=0.05),
    "+x": "frictionless",
    "-y": rb.Wall(material="aluminium"),
    "+z": rb.Wall(restitution=0.3),
}


def fly(cavity, positions, velocities, spins=(0, 0, 0), duration=0.05, **options):
    """Return the run of balls in a cavity at rest, with the results of its walls."""
    usual = {"contact": rb.Tsuji(restitution=0.8), "friction": 0.3, "gravity": (0, 0, 0), "softening": 100.0}
    more = {name: options.pop(name) for name in ("method", "output") if name in options}
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", radius=RADIUS),
        cavity=cavity,
        packing=rb.Positions(
            positions=np.atleast_2d(positions), velocities=np.atleast_2d(velocities), spins=np.atleast_2d(spins)
        ),
        **{**usual, **options},
    )
    case = rb.Case(structure=rb.Fixed(), damper=damper, duration=duration, **{"output": rb.Output(walls=True), **more})
    run = rb.simulate(case)
    assert run.ok, run.message
    return run


def box(parts=1, groups=None, order=None, size=SIZE):
    """Return a box of triangles with a group for each face, or others; `order` seeds a random order of triangles."""
    vertices, faces = triangle_meshes.box(size, parts)
    return surface(vertices, faces, groups or {face: face for face in FACES}, order)


def surface(vertices, faces, groups, order=None):
    """Return a surface with groups; `order` seeds a random order of its triangles and of their corners."""
    if order is not None:
        generator = np.random.default_rng(order)
        faces = np.array([np.roll(face, generator.integers(3)) for face in generator.permutation(faces)])
    return rb.Mesh(vertices=vertices, faces=faces, unit="m", groups=groups)


def state(run):
    """Return position, velocity and spin of all balls at the end."""
    particles = run.arrays.particles
    return np.stack([particles.position, particles.velocity, particles.spin])


def of_walls(run, name, labels=FACES):
    """Return an array of a run for walls in the order of these labels, (t, w, ...)."""
    return getattr(run.arrays, name)[:, [run.arrays.walls.index(label) for label in labels]]


WALL_ARRAYS = (
    "wall_force",
    "wall_moment",
    "wall_normal_force",
    "wall_impulse",
    "wall_normal_impulse",
    "wall_normal_loss",
    "wall_sliding_loss",
    "wall_rolling_loss",
    "wall_impacts",
)


@pytest.mark.parametrize("parts", [1, 9])
@pytest.mark.parametrize("seed", range(4))
def test_box_of_six_groups_is_box_of_six_walls(parts, seed):
    """A ball has the same rebounds, and each wall the same loads, in a box and in a surface with a group for each face."""
    generator = np.random.default_rng(seed)
    position = generator.uniform(-0.3, 0.3, 3) * (np.array(SIZE) - 2 * RADIUS)
    velocity, spin = 1.5 * generator.normal(size=3), 100 * generator.normal(size=3)
    runs = [
        fly(cavity, position, velocity, spin, walls=LAWS, rolling=0.01) for cavity in (rb.Box(size=SIZE), box(parts))
    ]
    assert sum(of_walls(runs[0], "wall_impacts")[-1]) >= 2
    assert np.allclose(state(runs[1]), state(runs[0]), rtol=1e-11, atol=1e-13)
    for name in WALL_ARRAYS:
        exact, of_groups = (of_walls(run, name) for run in runs)
        assert np.allclose(of_groups, exact, rtol=1e-9, atol=1e-10 * np.abs(exact).max(initial=0)), name
    assert runs[1].arrays.wall_area == pytest.approx(runs[0].arrays.wall_area[_same_order(runs)], rel=1e-12)


def _same_order(runs):
    return [runs[0].arrays.walls.index(label) for label in runs[1].arrays.walls]


def bed(cavity, seed=1, count=60, **options):
    """Return the run of a shaken bed."""
    usual = {"walls": LAWS, "softening": 1000.0, "packing": rb.Settled(seed=seed), "friction": 0.3, "rolling": 0.01}
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=count),
        cavity=cavity,
        contact=rb.Tsuji(restitution=0.7),
        **{**usual, **options},
    )
    base = rb.Harmonic(amplitude="40 m/s^2", frequency="50 Hz", direction="x")
    case = rb.Case(
        structure=rb.Fixed(), damper=damper, base=base, duration=0.1, output=rb.Output(walls=True, rate="1 kHz")
    )
    run = rb.simulate(case)
    assert run.ok, run.message
    return run


@pytest.mark.parametrize("shape", ["box", "can"])
def test_sums_over_groups_are_totals(shape):
    """Forces, moments about the point and losses of the groups add up to those of the cavity, to 1e-12."""
    cavity = box(3)
    walls = LAWS
    if shape == "can":
        vertices, faces = triangle_meshes.cylinder(0.014, 0.03, 24, 2)
        cavity = surface(vertices, faces, {"floor": "-z", "lid": "z", "side": "rest"})
        walls = {"floor": rb.Wall(friction=0.6), "side": "aluminium"}
    a = bed(cavity, walls=walls).arrays
    for total, name in (("cavity_force", "wall_force"), ("cavity_moment", "wall_moment")):
        whole = getattr(a, total)[:, 0]
        assert np.allclose(getattr(a, name).sum(axis=1), whole, rtol=1e-12, atol=1e-12 * np.abs(whole).max())
    for name in ("normal_loss", "sliding_loss", "rolling_loss", "plastic_loss"):
        at_walls = getattr(a, name)[..., -1].reshape(len(a.time))
        assert np.allclose(getattr(a, f"wall_{name}").sum(axis=1), at_walls - at_walls[0], rtol=1e-12, atol=1e-18)


def pocket(order=None):
    """Return a pocket with a step, whose top, side and floor are groups."""
    filled = np.ones((6, 4, 5), bool)
    filled[4:, :, :2] = False
    groups = {
        "top": rb.FaceGroup("-z", x=("5 mm", "15 mm")),
        "side": rb.FaceGroup("x", x=("0 mm", "10 mm")),
        "floor": rb.FaceGroup("-z", x=("-15 mm", "5 mm")),
    }
    return surface(*triangle_meshes.blocks(filled, 0.005), groups, order)


STEP_LAWS = {"top": rb.Wall(friction=0.1), "side": rb.Wall(friction=0.6), "floor": rb.Wall(friction=0.5, rolling=0.02)}


@pytest.mark.parametrize("seed", range(5))
def test_order_of_triangles_does_not_matter(seed):
    """A ball that hits the edge between two groups has the same motion and loads for any order of triangles and corners."""
    generator = np.random.default_rng(seed)
    start = np.array([generator.uniform(-0.004, 0.004), generator.uniform(-0.006, 0.006), 0.004])
    # Some hit the edge itself, some near it.
    aim = np.array([0.005, generator.uniform(-0.008, 0.008), -0.0025]) + (seed % 2) * generator.normal(0, 5e-4, 3)
    towards = (aim - start) / np.linalg.norm(aim - start)
    runs = [fly(pocket(order), start, towards, duration=0.02, walls=STEP_LAWS) for order in (None, 1, 2)]
    assert sum(runs[0].arrays.wall_impacts[-1]) >= 1
    for run in runs[1:]:
        assert run.arrays.walls == runs[0].arrays.walls
        assert np.allclose(state(run), state(runs[0]), rtol=1e-9, atol=1e-11)
        for name in WALL_ARRAYS:
            one, other = (getattr(each.arrays, name)[-1] for each in (runs[0], run))
            assert np.allclose(other, one, rtol=1e-8, atol=1e-9 * np.abs(one).max(initial=0)), name


@pytest.mark.parametrize(("share", "wall"), [(0.3, "top"), (-0.3, "side"), (0.0, "top")])
def test_edge_belongs_to_the_face_in_the_direction_of_the_contact(share, wall):
    """A contact on an edge that sticks out counts for the face with the nearest normal; at equal angles for the first."""
    # The normals out of the space are -z on the top of the step and x on its side.
    towards = np.array([math.sin(math.pi / 4 - share), 0.0, -math.cos(math.pi / 4 - share)])
    start = np.array([0.005, 0.001, -0.0025]) - (RADIUS + 4e-4) * towards
    for order in (None, 3, 4):
        run = fly(pocket(order), start, towards, duration=0.001, friction=0.0, walls={})
        impacts = dict(zip(run.arrays.walls, run.arrays.wall_impacts[-1], strict=True))
        assert impacts[wall] == 1
        assert sum(impacts.values()) == 1
        assert np.allclose(state(run)[1, 0], -0.8 * towards, atol=2e-2)


def floor(parts=8, order=None):
    """Return a box whose floor has two groups that meet at x = 0."""
    groups = {
        "left": rb.FaceGroup("-z", x=("-30 mm", "0 mm")),
        "right": rb.FaceGroup("-z", x=("0 mm", "30 mm")),
    }
    return box(parts, groups, order, (0.06, 0.03, 0.02))


def slide(cavity, walls, speed, duration, **options):
    """Return the run of a ball that lies on the floor and slides from the left to the right, in equilibrium."""
    height = -0.01 + RADIUS
    return fly(
        cavity,
        (-0.01, 0.0013, height),
        (speed, 0, 0),
        duration=duration,
        walls=walls,
        gravity=(0, 0, -GRAVITY),
        **options,
    )


@pytest.mark.parametrize("order", [None, 5])
@pytest.mark.parametrize(("before", "after"), [(0.1, 0.5), (0.5, 0.1), (0.0, 0.4), (0.4, 0.0)])
def test_ball_slides_from_one_friction_to_another(before, after, order):
    """The speed follows from the coefficient of friction of each group, and the edge is neither a bump nor a new impact."""
    speed, duration = 1.2, 0.03
    run = slide(
        floor(order=order), {"left": rb.Wall(friction=before), "right": rb.Wall(friction=after)}, speed, duration
    )
    decelerations = before * GRAVITY, after * GRAVITY
    at_edge = math.sqrt(speed**2 - 2 * decelerations[0] * 0.01)
    until = 2 * 0.01 / (speed + at_edge)
    final = at_edge - decelerations[1] * (duration - until)
    position, velocity, _ = state(run)[:, 0]
    # The ball comes to rest on its contact in the first steps, for which the friction is smaller.
    assert velocity[0] == pytest.approx(final, abs=2e-4)
    assert position[1] == pytest.approx(0.0013, abs=1e-12)
    assert np.ptp(run.arrays.centre_of_mass[:, 0, 2]) < 2e-4 * RADIUS
    assert run.counts["first_touches_wall"] == 1
    assert run.arrays.wall_impacts[-1].sum() <= 1  # after the first sample
    left, right = (run.arrays.walls.index(name) for name in ("left", "right"))
    weight = run.arrays.particles.mass[0] * GRAVITY
    assert run.arrays.wall_normal_force[0, right] == run.arrays.wall_normal_force[-1, left] == 0
    assert run.arrays.wall_normal_force[-1, right] == pytest.approx(weight, rel=0.02)
    # The ball spins up, so that its slip decreases by 7/2 of the friction; the spring at the edge holds little energy.
    slips, slip = [], speed
    for deceleration, time in zip(decelerations, (until, duration - until), strict=True):
        slips.append(slip * time - 1.75 * deceleration * time**2)
        slip -= 3.5 * deceleration * time
    lost = np.array([before, after]) * weight * slips
    assert run.arrays.wall_sliding_loss[-1, [left, right]] == pytest.approx(lost, rel=5e-3, abs=2e-3 * lost.max())


def test_groups_with_equal_laws_are_one_surface():
    """A ball that rolls over the edge of two groups with the same laws has the motion that it has on one wall."""
    vertices, faces = triangle_meshes.box((0.06, 0.03, 0.02), 8)
    plain = rb.Mesh(vertices=vertices, faces=faces, unit="m")
    runs = [slide(cavity, {}, 0.4, 0.06, rolling=0.01) for cavity in (plain, floor())]
    assert state(runs[0])[0, 0, 0] > 0.003
    assert np.allclose(state(runs[1]), state(runs[0]), rtol=1e-12, atol=1e-15)
    assert [run.counts["first_touches_wall"] for run in runs] == [1, 1]


def test_ball_slides_from_one_plate_to_another_of_other_friction():
    """A contact that continues at another body is one contact; where the two had different laws, it began anew."""
    plates = [
        rb.PlateBody(name=name, size=("20 mm", "30 mm", "3 mm"), position=(x, 0, "-8.5 mm"))
        for name, x in (("left", "-10 mm"), ("right", "10 mm"))
    ]
    run = fly(
        rb.Box(size=(0.06, 0.04, 0.02)),
        (-0.008, 0.001, -0.007 + RADIUS),
        (1.0, 0, 0),
        bodies=plates,
        walls={"left": rb.Wall(friction=0.1), "right": rb.Wall(friction=0.4, material="aluminium")},
        gravity=(0, 0, -GRAVITY),
        duration=0.016,
    )
    until = (1.0 - math.sqrt(1.0 - 2 * 0.1 * GRAVITY * 0.008)) / (0.1 * GRAVITY)
    assert run.counts["first_touches_wall"] == 1
    speed = 1.0 - 0.1 * GRAVITY * until - 0.4 * GRAVITY * (0.016 - until)
    assert state(run)[1, 0, 0] == pytest.approx(speed, abs=3e-4)
    assert run.ledger.energy_residual < 1e-3


@pytest.mark.parametrize("contact", [rb.Tsuji(restitution=1.0), rb.Thornton(yield_pressure="1 GPa")])
@pytest.mark.parametrize(
    "walls", [{"left": "nylon"}, {"right": "nylon"}, {"right": rb.Wall(material="nylon", friction=0.0)}]
)
@pytest.mark.parametrize("ahead", [5e-5, 1e-4, 1.5e-4])
def test_impact_that_crosses_into_another_material_keeps_its_energy(contact, walls, ahead):
    """An impact that slides into another group keeps its law: no energy comes from a change of stiffness in a contact.

    With the stiffness of the new wall at the same overlap, a ball left the edge of nylon and steel three times as fast.
    """
    run = fly(
        floor(),
        (-3e-4 - ahead, 0.001, -0.01 + RADIUS + 1e-4),
        (3.0, 0, -1.0),
        duration=0.0008,
        contact=contact,
        walls=walls,
        method=rb.Dem(fraction=0.005),
        output=rb.Output(walls=True, rate="1 MHz"),
    )
    assert run.counts["first_touches_wall"] == 1
    assert (run.arrays.wall_normal_impulse[-1, :2] > 0).all()
    assert run.ledger.energy_residual < 1e-3
    upward = state(run)[1, 0, 2]
    if contact.kind == "tsuji":
        assert upward == pytest.approx(1.0, abs=1e-3)
    else:
        assert 0.3 < upward < 1.001


@pytest.mark.parametrize("shape", ["box", "pocket"])
def test_bits_with_groups_depend_neither_on_threads_nor_on_restart(shape):
    """A bed with yielding contacts on groups has the same bits on one to three threads, and after a restart."""
    cavity, walls = (floor(6), {"right": "nylon"}) if shape == "box" else (pocket(), {"top": "nylon", "side": "glass"})
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="2 mm", count=200),
        cavity=cavity,
        contact=rb.Thornton(yield_pressure="1 GPa"),
        friction=0.3,
        rolling=0.01,
        walls=walls,
        softening=100.0,
        packing=rb.Lattice(seed=1),
    )
    base = rb.Harmonic(amplitude="60 m/s^2", frequency="50 Hz", direction="x")
    case = rb.Case(structure=rb.Fixed(), damper=damper, base=base, duration=0.1, output=rb.Output(walls=True))
    assert ends_alike(case)


def can(friction, **options):
    """Return a deep bed at rest in a can of triangles, and its weight [N]."""
    vertices, faces = triangle_meshes.cylinder(0.012, 0.06, 32, 4)
    cavity = surface(vertices, faces, {"floor": "-z", "lid": "z", "side": "rest"})
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=240),
        cavity=cavity,
        contact=rb.Tsuji(restitution=0.6),
        friction=0.3,
        walls={"side": rb.Wall(friction=friction)},
        packing=rb.Settled(seed=2),
        softening=1000.0,
    )
    output = rb.Output(walls=True, rate="1 kHz")
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration=0.05, output=output))
    assert run.ok, run.message
    return run, GRAVITY * float(run.arrays.particle_mass.sum())


def test_side_of_a_can_carries_a_part_of_the_bed():
    """Without friction the floor of a can of triangles carries all; with it the side carries the rest of the weight."""
    for friction in (0.0, 0.5):
        run, weight = can(friction)
        force = -run.arrays.wall_force[-20:, :, 2].mean(axis=0) / weight
        on_floor, on_side = (force[run.arrays.walls.index(name)] for name in ("floor", "side"))
        assert on_floor + on_side == pytest.approx(1.0, abs=0.02)
        # The facets of the side are upright, so that without friction no force on it has a component along z.
        if friction == 0:
            assert on_side == pytest.approx(0.0, abs=1e-12)
        else:
            assert 0.02 < on_side < 0.5
        pressures = rb.analysis.wall_pressures(run)
        assert pressures["lid"] == 0 < pressures["side"]
        assert pressures["floor"] * run.arrays.wall_area[0] == pytest.approx(on_floor * weight, rel=0.1)
