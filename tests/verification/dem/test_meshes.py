"""Surfaces of triangles and bodies against exact walls and closed forms.

Cavities were boxes, cylinders and balls with exact walls only, so that no test had edges or corners that stick out, seams
between faces of one plane, or a wall of facets.
"""

import math

import numpy as np
import pytest
from support import triangle_meshes
from support.dem_cases import ends_alike

import rattlebox as rb

RADIUS, SIZE = 2e-3, (0.030, 0.020, 0.025)
FINE = rb.Dem(fraction=0.002)


def fly(cavity, position, velocity, spin=(0, 0, 0), duration=0.05, *, radius=RADIUS, **options):
    """Return the run of one ball in a cavity at rest."""
    usual = {"contact": rb.Tsuji(restitution=0.8), "friction": 0.3, "gravity": (0, 0, 0), "softening": 100.0}
    method = options.pop("method", None)
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", radius=radius),
        cavity=cavity,
        packing=rb.Positions(
            positions=np.atleast_2d(position), velocities=np.atleast_2d(velocity), spins=np.atleast_2d(spin)
        ),
        **{**usual, **options},
    )
    more = {} if method is None else {"method": method}
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration=duration, **more))
    assert run.ok, run.message
    return run


def end(run):
    """Return position, velocity and spin at the end, (3, 3)."""
    particles = run.arrays.particles
    return np.stack([particles.position[0], particles.velocity[0], particles.spin[0]])


def touches(run):
    """Return the number of contacts that began at walls."""
    return run.counts["first_touches_wall"]


def path(run):
    """Return the positions of the only ball at all samples, (t, 3)."""
    return run.arrays.centre_of_mass[:, 0]


def box_mesh(parts, size=SIZE):
    """Return a box of triangles."""
    vertices, faces = triangle_meshes.box(size, parts)
    return rb.Mesh(vertices=vertices, faces=faces, unit="m")


@pytest.mark.parametrize("parts", [1, 40])
@pytest.mark.parametrize("seed", range(6))
def test_ball_bounces_in_box_of_triangles_as_between_planes(parts, seed):
    """A spinning ball has the same motion between planes and in a box of 12 or 19 200 triangles, to rounding."""
    generator = np.random.default_rng(seed)
    position = generator.uniform(-0.35, 0.35, 3) * (np.array(SIZE) - 2 * RADIUS)
    velocity, spin = generator.normal(size=3), 100 * generator.normal(size=3)
    exact = fly(rb.Box(size=SIZE), position, velocity, spin)
    of_triangles = fly(box_mesh(parts), position, velocity, spin)
    assert touches(of_triangles) == touches(exact) >= 2
    assert np.allclose(end(of_triangles), end(exact), rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize("parts", [1, 4])
@pytest.mark.parametrize("towards", [(1, 1, 0), (1, 0, 1), (1, 1, 1)])
def test_ball_in_edge_or_corner_of_box_touches_each_face_once(parts, towards):
    """A ball that flies into an edge or a corner of the box touches two or three faces, once each, as between planes."""
    towards = np.array(towards, float)
    position = (np.array(SIZE) / 2 - RADIUS - 1e-3) * towards
    exact, of_triangles = (fly(c, position, towards, duration=0.004) for c in (rb.Box(size=SIZE), box_mesh(parts)))
    assert touches(of_triangles) == towards.sum()
    assert np.allclose(end(of_triangles), end(exact), rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize("velocity", [(0.2, 0, 0), (0.2, 0.2, 0), (0.2, 0.13, 0), (0.01, 0.2, 0)])
def test_ball_rolls_over_seams_without_bump(velocity):
    """A ball on a floor of triangles rolls along and across seams in a straight line, with the energy of one plane."""
    height = -SIZE[2] / 2 + RADIUS
    runs = [
        fly(cavity, (-0.011, -0.006, height), velocity, duration=0.06, gravity=(0, 0, -9.81))
        for cavity in (rb.Box(size=SIZE), box_mesh(1), box_mesh(12))
    ]
    for run in runs[1:]:
        assert touches(run) == 1
        assert np.allclose(end(run), end(runs[0]), rtol=1e-12, atol=1e-15)
        across = (path(run)[:, :2] - (-0.011, -0.006)) @ (np.array([-velocity[1], velocity[0]]) / math.hypot(*velocity))
        assert np.abs(across).max() < 1e-12 * RADIUS + 1e-15


def test_contact_goes_on_where_planes_take_the_place_of_triangles():
    """A ball that rolls past a body keeps its contact with the floor where triangles stand for it, and planes elsewhere.

    Such a change is in no run of a ball in an empty box, whose walls are planes everywhere.
    """
    height = -SIZE[2] / 2 + RADIUS
    beside = rb.BallBody(diameter="3 mm", position=(0, 0.0045, height))
    runs = [
        fly(
            cavity,
            (-0.011, -0.0014 + RADIUS, height),
            (0.4, 0, 0),
            duration=0.06,
            gravity=(0, 0, -9.81),
            bodies=[beside],
        )
        for cavity in (rb.Box(size=SIZE), box_mesh(1), box_mesh(12))
    ]
    assert touches(runs[0]) == 1
    assert path(runs[0])[-1, 0] > 0.005
    for run in runs[1:]:
        assert touches(run) == 1
        assert np.allclose(end(run), end(runs[0]), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("seed", range(8))
def test_ball_flies_around_step_of_surface_as_around_plate(seed):
    """A ball in a pocket with a step of triangles has the path that it has in a box with a plate in its corner.

    A box is convex, so that no test had a place where planes reach beyond their surface.
    """
    filled, width = np.ones((6, 4, 5), bool), 0.005
    filled[4:, :, :2] = False
    vertices, faces = triangle_meshes.blocks(filled, width)
    pocket = rb.Mesh(vertices=vertices, faces=faces, unit="m")
    step = rb.PlateBody(size=(0.01, 0.02, 0.01), position=(0.01, 0, -0.0075))
    generator = np.random.default_rng(seed)
    start = np.array([generator.uniform(-0.012, 0.003), generator.uniform(-0.007, 0.007), 0.004])
    aim = np.array([generator.uniform(0.002, 0.008), generator.uniform(-0.01, 0.01), -0.003])
    velocity, spin = (aim - start) / np.linalg.norm(aim - start), 100 * generator.normal(size=3)
    exact = fly(rb.Box(size=(0.03, 0.02, 0.025)), start, velocity, spin, bodies=[step])
    of_triangles = fly(pocket, start, velocity, spin)
    assert touches(of_triangles) == touches(exact) >= 2
    assert np.allclose(end(of_triangles), end(exact), rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("shape", ["cylinder", "ball"])
def test_facets_converge_to_curved_wall_with_order_two(shape):
    """With twice as many facets, the wall is a quarter as far from the exact one, and so is a mean rebound."""
    axes = 2 if shape == "cylinder" else 3
    radius, places, rebounds = 0.015, [], []
    for around in (16, 32, 64):
        if shape == "cylinder":
            vertices, faces = triangle_meshes.cylinder(radius, 0.02, around)
        else:
            vertices, faces = triangle_meshes.ball(radius, around // 4)
        cavity = rb.Mesh(vertices=vertices, faces=faces, unit="m", smooth_angle="40 deg")
        far, turned = [], []
        # Hits at eight places, evenly spread over a facet: its normal deviates as often to the left as to the right.
        for place in (np.arange(8) + 0.5) / 8 * 2 * np.pi / around:
            phase = place + math.asin(2e-3 / (radius - RADIUS))
            along = np.array([math.cos(phase), math.sin(phase), 0.0])
            across = np.array([-math.sin(phase), math.cos(phase), 0.0])
            start = np.array([0.0, 0.0, 0.37e-3]) - 2e-3 * across
            far.append(np.linalg.norm(hit(cavity, start, along)[:axes]) - (radius - RADIUS))
            _, velocity, _ = end(fly(cavity, start, along, duration=0.016, friction=0.0))
            turned.append([velocity @ along, velocity @ across])
        places.append(np.abs(np.mean(far)))
        exact = rb.Cylinder(radius=radius, length=0.02) if shape == "cylinder" else rb.SphericalCavity(radius=radius)
        true = end(fly(exact, (0, -2e-3, 0.37e-3), (1, 0, 0), duration=0.016, friction=0.0))[1]
        rebounds.append(np.linalg.norm(np.mean(turned, axis=0) - true[:2]))
    for errors in (places, rebounds) if shape == "cylinder" else (places,):
        orders = np.log2(np.array(errors[:-1]) / errors[1:])
        assert np.all((orders > 1.7) & (orders < 2.4)), (errors, orders)


def hit(cavity, position, velocity):
    """Return the position at which a ball first touches a wall, by bisection on the distance."""
    solids = cavity.walls().solids
    low, high = 0.0, 0.03
    for _ in range(60):
        middle = 0.5 * (low + high)
        apart = solids.distances((position + middle * velocity)[None])[0, 0] - RADIUS
        low, high = (middle, high) if apart > 0 else (low, middle)
    return position + low * velocity


BODIES = {
    "rod": (rb.RodBody(diameter="8 mm", length="10 mm"), (0.8, 0.6, 0.0)),
    "end of a rod": (rb.RodBody(diameter="8 mm", length="10 mm"), (0.0, 0.0, 1.0)),
    "rim of a rod": (rb.RodBody(diameter="8 mm", length="10 mm"), (0.6, 0.0, 0.8)),
    "face of a plate": (rb.PlateBody(size=("8 mm", "6 mm", "4 mm")), (0.0, 1.0, 0.0)),
    "edge of a plate": (rb.PlateBody(size=("8 mm", "6 mm", "4 mm")), (0.6, 0.8, 0.0)),
    "corner of a plate": (rb.PlateBody(size=("8 mm", "6 mm", "4 mm")), (0.48, 0.6, 0.64)),
    "ball": (rb.BallBody(diameter="8 mm"), (0.48, 0.6, 0.64)),
}
CORNERS = {
    "rod": (0.0032, 0.0024, 0.0),
    "end of a rod": (0.0, 0.0, 0.005),
    "rim of a rod": (0.004, 0.0, 0.005),
    "face of a plate": (0.0, 0.003, 0.0),
    "edge of a plate": (0.004, 0.003, 0.0),
    "corner of a plate": (0.004, 0.003, 0.002),
    "ball": (0.00192, 0.0024, 0.00256),
}


@pytest.mark.parametrize("name", list(BODIES))
def test_ball_rebounds_from_body_along_its_normal(name):
    """A ball that flies onto a face, an edge or a corner of a body reverses its normal velocity times the restitution."""
    body, normal = BODIES[name]
    normal = np.array(normal)
    across = np.cross(normal, (0.3, 0.5, -0.7))
    across /= np.linalg.norm(across)
    place = np.array(CORNERS[name]) + (RADIUS + 5e-4) * normal
    velocity = (
        -1.0 * normal
        + (0.0 if "edge" in name or "corner" in name or "rim" in name or name in ("ball", "rod") else 0.3) * across
    )
    run = fly(rb.Box(size=("60 mm",) * 3), place, velocity, bodies=[body], friction=0.0, duration=0.002, method=FINE)
    assert touches(run) == 1
    rebound = end(run)[1]
    assert rebound @ normal == pytest.approx(0.8, abs=1e-5)
    assert rebound @ across == pytest.approx(velocity @ across, abs=1e-5)


def test_ball_between_two_balls_keeps_to_their_line():
    """A ball between two fixed balls hits them in turn, at intervals that grow by the restitution each time."""
    bodies = [
        rb.BallBody(diameter="8 mm", position=("-10 mm", 0, 0)),
        rb.BallBody(diameter="8 mm", position=("10 mm", 0, 0)),
    ]
    gap = 0.02 - 0.008 - 2 * RADIUS
    run = fly(
        rb.Box(size=("60 mm",) * 3), (-0.006 + RADIUS, 0, 0), (1.0, 0, 0), bodies=bodies, duration=0.04, method=FINE
    )
    time = run.arrays.time
    speeds = np.abs(run.arrays.momentum[:, 0, 0]) / run.arrays.particles.mass[0]
    for k in range(3):
        flight = np.abs(speeds - 0.8**k) < 1e-4
        assert flight.sum() > 2
        assert time[flight][-1] - time[flight][0] == pytest.approx(gap / 0.8**k, abs=1e-4)
    assert np.abs(path(run)[:, 1:]).max() < 1e-12


@pytest.mark.parametrize("name", ["rod", "plate"])
def test_body_of_triangles_acts_as_exact_body(name):
    """A ball that flies into the corner between a floor and a block has the same path if the block is made of triangles."""
    size = (0.008, 0.006, 0.004)
    vertices, faces = triangle_meshes.box(size, 3)
    mesh = rb.MeshBody(vertices=vertices, faces=faces, unit="m", position=(0.001, 0.002, -0.01))
    exact = rb.PlateBody(size=size, position=(0.001, 0.002, -0.01))
    generator = np.random.default_rng(len(name))
    for _ in range(6):
        direction = generator.normal(size=3)
        target = np.array([0.001, 0.002, -0.01]) + generator.uniform(-0.6, 0.6, 3) * size
        direction[2] = abs(direction[2])
        start = target + 0.011 * direction / np.linalg.norm(direction)
        velocity, spin = (target - start) / np.linalg.norm(target - start), 100 * generator.normal(size=3)
        ends = [
            end(fly(rb.Box(size=(0.04, 0.04, 0.03)), start, velocity, spin, bodies=[body], duration=0.02))
            for body in (exact, mesh)
        ]
        assert np.allclose(ends[1], ends[0], rtol=1e-9, atol=1e-11)


def test_ball_rolls_across_joint_of_plates_without_bump():
    """A ball that rolls from one plate to another one beside it, in the same plane, has one contact in all."""
    plates = [rb.PlateBody(size=("20 mm", "30 mm", "3 mm"), position=(x, 0, "-8 mm")) for x in ("-10 mm", "10 mm")]
    run = fly(
        rb.Box(size=("60 mm", "40 mm", "30 mm")),
        (-0.006, 0.001, -0.0065 + RADIUS),
        (0.25, 0.05, 0),
        bodies=plates,
        gravity=(0, 0, -9.81),
        duration=0.05,
    )
    assert path(run)[-1, 0] > 0.003
    assert touches(run) == 1
    assert np.ptp(path(run)[:, 2]) < 2e-3 * RADIUS
    assert np.allclose(end(run)[1][:2], [0.25 * 5 / 7, 0.05 * 5 / 7], rtol=1e-3)


def test_thin_plate_of_triangles_hides_what_is_behind_it():
    """A ball on a thin sheet of triangles touches neither its other side nor the floor close below it."""
    vertices, faces = triangle_meshes.box((0.03, 0.03, 0.0002), 5)
    sheet = rb.MeshBody(vertices=vertices, faces=faces, unit="m", position=(0, 0, -0.0098))
    start = (0.0011, 0.0017, -0.0097 + RADIUS + 1e-4)
    run = fly(
        rb.Box(size=(0.04, 0.04, 0.02)), start, (0, 0, -1), bodies=[sheet], duration=0.002, friction=0.0, method=FINE
    )
    assert touches(run) == 1
    assert end(run)[1][2] == pytest.approx(0.8, abs=1e-5)


def loss_of_bed(cavity, seed):
    """Return the loss of a shaken bed of 60 balls from a random packing [J]."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=60),
        cavity=cavity,
        contact=rb.Tsuji(restitution=0.7),
        friction=0.3,
        softening=1000.0,
        packing=rb.Settled(seed=seed),
    )
    base = rb.Harmonic(amplitude="30 m/s^2", frequency="50 Hz", direction="x")
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, base=base, duration=0.2))
    assert run.ok, run.message
    return float(run.arrays.normal_loss[-1].sum() + run.arrays.sliding_loss[-1].sum())


def test_bed_in_box_of_triangles_has_loss_of_bed_between_planes():
    """A shaken bed has the same loss in a box of triangles as between planes."""
    losses = [loss_of_bed(cavity, 4) for cavity in (rb.Box(size=SIZE), box_mesh(1), box_mesh(6))]
    assert losses[1] == pytest.approx(losses[0], rel=0.1)
    assert losses[2] == pytest.approx(losses[0], rel=0.1)


@pytest.mark.slow
def test_mean_loss_in_box_of_triangles_is_that_between_planes():
    """The mean losses of packings between planes, in 12 and in 10 092 triangles differ by less than their 95 % intervals.

    One packing of each was compared, whose scatter of some per cent hides a difference of this size.
    """
    count = 8
    means, errors = [], []
    for cavity in (rb.Box(size=SIZE), box_mesh(1), box_mesh(29)):
        losses = [loss_of_bed(cavity, seed) for seed in range(count)]
        means.append(np.mean(losses))
        errors.append(2.36 * np.std(losses, ddof=1) / np.sqrt(count))  # Student's t for 7 degrees of freedom
    for mean, error in zip(means[1:], errors[1:], strict=True):
        assert abs(mean - means[0]) < np.hypot(error, errors[0])
    assert max(errors) < 0.15 * means[0]


@pytest.mark.parametrize("shape", ["ball", "box"])
def test_bits_in_surface_depend_neither_on_threads_nor_on_restart(shape):
    """A bed around a rod in a ball of facets or a box has the same bits on one to three threads, and after a restart."""
    vertices, faces = triangle_meshes.ball(0.015, 8) if shape == "ball" else triangle_meshes.box((0.025,) * 3, 4)
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="2 mm", count=400),
        cavity=rb.Mesh(vertices=vertices, faces=faces, unit="m"),
        bodies=[rb.RodBody(diameter="5 mm")],
        contact=rb.Tsuji(restitution=0.7),
        friction=0.3,
        softening=1000.0,
        packing=rb.Lattice(seed=1),
    )
    base = rb.Harmonic(amplitude="60 m/s^2", frequency="50 Hz", direction="x")
    case = rb.Case(structure=rb.Fixed(), damper=damper, base=base, duration=0.1)
    assert ends_alike(case)
