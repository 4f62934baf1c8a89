"""Walls that differ, sums for each wall, and periodic boxes, against exact values and against uniform walls."""

from typing import Any

import numpy as np
import pytest
from support import dem_cases, triangle_meshes
from support.dem_cases import Ball

import rattlebox as rb

SIDE = 0.02
BOX = rb.Box(size=(SIDE,) * 3)
CAN = rb.Cylinder(diameter=SIDE, length=SIDE)
FACES = {
    **{name: (BOX, direction) for name, direction in zip(("-x", "-y", "-z"), -np.eye(3), strict=True)},
    **{name: (BOX, direction) for name, direction in zip(("+x", "+y", "+z"), np.eye(3), strict=True)},
    "side": (CAN, np.array([0.6, -0.8, 0.0])),
    "first end": (CAN, np.array([0.0, 0.0, -1.0])),
    "last end": (CAN, np.array([0.0, 0.0, 1.0])),
}
LAWS = {"contact": rb.Tsuji(restitution=0.9), "friction": 0.3}


def thrown(direction: Any, cavity: Any, slip: float = 0.0, **options: Any) -> Any:
    """Return a ball that hits one face of a cavity, as a run."""
    across = np.cross(direction, np.roll(direction, 1))
    ball = Ball(radius=2e-3, velocity=0.5 * direction + slip * across)
    case = dem_cases.case([ball], dt=2e-7, steps=100_000, samples=100, cavity=cavity, **{**LAWS, **options})
    return dem_cases.run(case)


@pytest.mark.parametrize("face", FACES)
def test_each_face_has_its_own_laws(face: str) -> None:
    """A ball that hits a face rebounds bit by bit as in a cavity with such walls only, and with its restitution."""
    cavity, direction = FACES[face]
    own = {"contact": rb.Tsuji(restitution=0.4), "friction": 0.1, "rolling": 0.02}
    one = thrown(direction, cavity, slip=0.2, walls={face: rb.Wall(material="glass", **own)})
    all_alike = thrown(direction, cavity, slip=0.2, wall="glass", **own)
    for name in ("velocity", "spin", "position"):
        assert np.array_equal(getattr(one.arrays.particles, name), getattr(all_alike.arrays.particles, name))
    rebound = thrown(direction, cavity, walls={face: rb.Wall(restitution=0.4)}).arrays.particles.velocity[0]
    assert -rebound @ direction == pytest.approx(0.5 * 0.4, rel=1e-3)
    others = {name: rb.Wall(restitution=0.4) for name, (its, _) in FACES.items() if name != face and its is cavity}
    untouched = thrown(direction, cavity, walls=others).arrays.particles.velocity[0]
    assert -untouched @ direction == pytest.approx(0.5 * 0.9, rel=1e-3)


def test_contacts_without_friction_lose_nothing_by_it_beside_others() -> None:
    """A face without friction neither pushes nor loses energy along it, although other faces have friction.

    Contacts without friction among contacts with friction had a spring without force that lost energy at each slip. Tests
    of friction used one coefficient for all contacts of a list, and this loss was below the limit of the ledger.
    """
    own = {"-z": "frictionless", "+x": rb.Wall(friction=0.8, rolling=0.1)}
    run = thrown(np.array([0.0, 0.0, -1.0]), BOX, slip=0.3, rolling=0.05, walls=own)
    assert run.counts["first_touches_wall"] == 1
    assert not run.arrays.sliding_loss.any() and not run.arrays.rolling_loss.any()
    assert not run.arrays.particles.spin.any()
    before, after = run.arrays.momentum[0, 0], run.arrays.momentum[-1, 0]
    assert np.array_equal(after[:2], before[:2]) and before[:2].any()


def shaken(seed: int = 1, **options: Any) -> Any:
    """Return a case of balls of two sizes in a shaken box, with different walls that are recorded."""
    usual: dict[str, Any] = {
        "particles": [
            rb.Particles(material="steel", diameter="4 mm", count=40),
            rb.Particles(material="glass", diameter="2.5 mm", count=60),
        ],
        "cavity": BOX,
        "contact": rb.Tsuji(restitution=0.8),
        "friction": 0.3,
        "rolling": 0.05,
        "walls": {
            "-z": rb.Wall(material="aluminium", friction=0.1),
            "+y": "frictionless",
            "+z": rb.Wall(restitution=0.5),
        },
        "packing": rb.Settled(seed=seed),
        "softening": 10,
    }
    structure = options.pop("structure", rb.Fixed())
    base = options.pop("base", rb.Harmonic(amplitude="60 m/s^2", frequency=40, direction="z"))
    output = options.pop("output", rb.Output(rate="2 kHz", walls=True))
    more = {name: options.pop(name) for name in ("method",) if name in options}
    dampers = options.pop("dampers", None) or rb.ParticleDamper(**{**usual, **options})
    return rb.Case(structure=structure, dampers=dampers, duration=0.05, base=base, output=output, **more)


YIELDING = {
    "particles": rb.Particles(material="steel", diameter="3 mm", count=60),
    "contact": rb.Thornton(),
    "walls": {"-z": rb.Wall(material="aluminium"), "+x": "rigid"},
}


@pytest.mark.parametrize(
    "options", [{}, {"cavity": CAN, "walls": {"side": "frictionless"}}, YIELDING], ids=["box", "can", "yielding"]
)
def test_sums_over_walls_are_those_of_the_cavity(options: dict[str, Any]) -> None:
    """Forces, moments, losses and impacts of all walls add up to those of the cavity, to rounding, at each sample."""
    run = dem_cases.run(shaken(**options))
    arrays = run.arrays
    assert int(arrays.wall_impacts[-1].sum()) == run.counts["first_touches_wall"] > 50
    pairs = [(arrays.wall_force, arrays.cavity_force), (arrays.wall_moment, arrays.cavity_moment)]
    for channel in ("normal", "plastic", "sliding", "rolling"):
        losses = getattr(arrays, f"{channel}_loss")[:, 0, 1]
        pairs.append((getattr(arrays, f"wall_{channel}_loss")[..., None], (losses - losses[0])[:, None, None]))
    for each, total in pairs:
        assert np.abs(each.sum(axis=1) - total[:, 0]).max() <= 1e-13 * np.abs(each).sum(axis=1).max()
    assert arrays.wall_sliding_loss[-1].max() > 0


def test_impulses_on_walls_are_the_change_of_momentum() -> None:
    """The impulse on all walls is that of gravity and base less the change of momentum.

    A face without friction gets an impulse along its normal only.
    """
    run = dem_cases.run(shaken())
    arrays = run.arrays
    pull = arrays.particle_mass[0] * (np.array([0, 0, -9.81]) * arrays.time[:, None] - arrays.base_velocity)
    pull -= pull[0]
    # The base acts on particles in steps, so that its impulse is a sum, not exactly the change of its velocity.
    change = arrays.momentum[:, 0] - arrays.momentum[0, 0]
    impulse = arrays.wall_impulse.sum(axis=1)
    assert np.abs(impulse[:, :2] + change[:, :2]).max() < 1e-13 * np.abs(arrays.wall_impulse).max()
    assert np.abs(impulse - pull + change)[:, 2].max() < 1e-5 * np.abs(arrays.wall_impulse).max()
    smooth = arrays.walls.index("+y")
    assert not arrays.wall_impulse[:, smooth, [0, 2]].any()
    assert np.allclose(arrays.wall_normal_impulse[:, smooth], arrays.wall_impulse[:, smooth, 1], rtol=1e-12)


def test_recording_walls_changes_nothing_else() -> None:
    """A run that records its walls has the bits of one that does not, for any number of threads and after a restart."""
    recorded = rb.simulate(shaken(method=rb.Dem(threads=2)))
    plain = rb.simulate(shaken(output=rb.Output(rate="2 kHz")))
    for name in ("momentum", "normal_loss", "sliding_loss", "cavity_force", "cavity_moment"):
        assert np.array_equal(getattr(recorded.arrays, name), getattr(plain.arrays, name))
    assert np.array_equal(
        rb.simulate(shaken(method=rb.Dem(threads=1))).arrays.wall_sliding_loss, recorded.arrays.wall_sliding_loss
    )
    with pytest.raises(AttributeError, match="walls=True"):
        _ = plain.arrays.wall_force
    assert "wall_force" not in plain.motion and "wall" not in plain.motion.dims


def test_walls_continue_with_the_run() -> None:
    """Sums for each wall of a continued run are those of one run, whether or not the first part recorded them."""
    whole = shaken()
    run = dem_cases.run(whole)
    half = run.arrays.time.size // 2
    for recorded in (True, False):
        first = whole.replaced({"duration": 0.025, "output.walls": recorded})
        then = rb.simulate(whole, start=rb.simulate(first))
        for name in ("wall_impulse", "wall_sliding_loss", "wall_impacts"):
            once = getattr(run.arrays, name)
            assert np.allclose(getattr(then.arrays, name), once[half:] - once[half], rtol=1e-12, atol=1e-18)


# ---- periodic boxes

SLICE = rb.Box(size=(SIDE,) * 3, periodic="x")


def test_a_ball_that_crosses_a_face_flies_on() -> None:
    """A free ball crosses the faces of a periodic box on a straight line, and its position is wrapped."""
    for speed in (3.0, -3.0):
        case = dem_cases.case(
            [Ball(2e-3, velocity=(speed, 0.0, 0.0))], dt=1e-6, steps=50_000, samples=50, cavity=SLICE, **LAWS
        )
        run = dem_cases.run(case)
        straight = speed * run.arrays.time
        assert np.allclose(run.arrays.centre_of_mass[:, 0, 0], straight, rtol=0, atol=1e-12)
        position = run.arrays.particles.position[0]
        periods = (position[0] - straight[-1]) / SIDE  # the run ends on a face
        assert abs(periods - round(periods)) < 1e-10 and -SIDE / 2 <= position[0] < SIDE / 2
        assert not position[1:].any()
        assert run.counts["first_touches_wall"] == 0


def test_a_stepper_of_a_periodic_box_lets_balls_through() -> None:
    """A ball that crosses periodic faces exerts no force in a stepper, and loses nothing."""
    ball = Ball(2e-3, velocity=(3.0, 0.0, 0.0))
    stepper = rb.Stepper(dem_cases.damper([ball], cavity=SLICE, **LAWS))
    for k in range(1, 31):
        result = stepper.advance(k * 1e-3, acceleration=(0, 0, 0))
        assert np.abs(result.force).max() < 1e-12 and result.loss == 0
    assert result.stored == pytest.approx(0.5 * ball.mass * 9.0)


def test_balls_collide_across_a_face_as_inside() -> None:
    """Two balls that meet at a periodic face, or astride of it, collide as in the middle of the box."""
    runs = []
    for shift in (0.0, SIDE / 2, 0.3e-3 + SIDE / 2, 5 * SIDE / 2):
        places = rb.Box(size=(SIDE,) * 3, periodic="x").wrapped(
            np.array([[-4e-3 + shift, 0.4e-3, 0.0], [4e-3 + shift, -0.3e-3, 0.0]])
        )
        balls = [Ball(2e-3, places[0], (0.5, 0.0, 0.0)), Ball(1.5e-3, places[1], (-0.5, 0.1, 0.0))]
        case = dem_cases.case(balls, dt=2e-7, steps=60_000, samples=10, cavity=SLICE, **LAWS)
        runs.append(dem_cases.run(case))
        assert runs[-1].counts["first_touches_particle"] == 1
    for run in runs[1:]:
        assert np.allclose(run.arrays.particles.velocity, runs[0].arrays.particles.velocity, rtol=0, atol=1e-9)
        assert np.allclose(run.arrays.particles.spin, runs[0].arrays.particles.spin, rtol=0, atol=1e-5)
        assert np.allclose(run.arrays.normal_loss[-1], runs[0].arrays.normal_loss[-1], rtol=1e-6)


@pytest.mark.parametrize("periodic", ["x", "y", "xy"])
def test_momentum_is_conserved_along_periodic_directions(periodic: str) -> None:
    """Without friction at the other walls, the momentum along a periodic direction is conserved to rounding."""
    walls = {name: "frictionless" for name in ("-x", "+x", "-y", "+y", "-z", "+z") if name[1] not in periodic}
    case = shaken(cavity=rb.Box(size=(SIDE,) * 3, periodic=periodic), walls=walls, velocity=(0.4, 0.3, 0.0))
    run = dem_cases.run(case)
    assert run.counts["first_touches_particle"] > 1000
    momentum = run.arrays.momentum[:, 0, ["xy".index(axis) for axis in periodic]]
    scale = np.linalg.norm(run.arrays.particles.velocity, axis=1) @ run.arrays.particles.mass
    assert np.abs(momentum - momentum[0]).max() < 1e-13 * scale
    assert not run.arrays.wall_sliding_loss.any()


def test_a_shift_along_a_periodic_direction_changes_nothing() -> None:
    """A bed that starts shifted along the periodic direction, with balls exactly on a face, has the same losses.

    The shift changes the order of sums, so that the comparison ends before chaos amplifies rounding.
    """
    bed = shaken(cavity=SLICE, particles=rb.Particles(material="steel", diameter="4 mm", count=50), walls={})
    places = rb.simulate(bed.replaced({"duration": 1e-5})).arrays.particles.position
    losses = []
    for shift in (0.0, SIDE / 2 - places[7, 0], 0.37 * SIDE):
        at = SLICE.wrapped(places + np.array([shift, 0.0, 0.0]))
        packing = rb.Positions(positions=at)
        particles = rb.Particles(material="steel", diameter="4 mm")
        case = shaken(cavity=SLICE, particles=particles, walls={}, packing=packing).replaced({"duration": 0.004})
        losses.append(rb.simulate(case).ledger.contact_loss[-1])
    assert losses[0] > 0 and losses == pytest.approx([losses[0]] * 3, rel=1e-6)


# ---- beds at rest and shaken beds

BALL = 4e-3
PRESSED = 100.0
"""Acceleration of the base that presses a bed down and mobilises its friction at the walls [m/s^2]."""


def pressed(cavity: Any, count: int, by: float = PRESSED, duration: float = 0.1, seed: int = 1, **options: Any) -> Any:
    """Return the mean forces at the end of a run in which a bed is slowly pressed down, over the force on it, by wall."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="glass", diameter=BALL, count=count),
        cavity=cavity,
        contact=rb.Tsuji(restitution=0.3),
        packing=rb.Settled(seed=seed),
        softening=3e4,
        **options,
    )
    ramp = rb.Record(times=[0, 0.08, 1.0], values=[0, by, by], unit="m/s^2", direction="z")
    output = rb.Output(rate="400 Hz", walls=True)
    run = dem_cases.run(rb.Case(structure=rb.Fixed(), damper=damper, duration=duration, base=ramp, output=output))
    load = run.arrays.particle_mass[0] * (9.81 + by)
    assert run.arrays.kinetic_energy[-1, 0] < 1e-3 * load * BALL
    # Means over the last part of the run, of all time steps in it.
    arrays, first = run.arrays, -40 if duration > 0.2 else -5
    length = arrays.time[-1] - arrays.time[first]
    force = (arrays.wall_impulse[-1] - arrays.wall_impulse[first]) / length / load
    normal = (arrays.wall_normal_impulse[-1] - arrays.wall_normal_impulse[first]) / length / load
    return dict(zip(run.arrays.walls, zip(force, normal, strict=True), strict=True)), run


def test_a_bed_without_friction_has_hydrostatic_pressure() -> None:
    """Without friction the floor carries all of a bed, sides have no vertical force, and their pressure is that of a fluid.

    Spheres without friction carry a small difference of pressures: the sides have 0.8 to 1.1 of the vertical pressure.
    """
    width, count = 5 * BALL, 200
    walls, run = pressed(rb.Box(size=(width, width, 14 * BALL)), count, by=0.0, duration=0.3)
    assert -walls["-z"][0][2] == pytest.approx(1, abs=2e-3)
    damper = run.case.particle_dampers[0]
    height = rb.measure_bed(damper).height
    for face in ("-x", "+x", "-y", "+y"):
        force, normal = walls[face]
        assert force[2] == 0 and np.delete(force, "xy".index(face[1])).tolist() == [0, 0]
        # The mean vertical pressure over the depth is half of that on the floor.
        assert 0.8 < normal / (0.5 * height / width) < 1.1
    for axis in range(2):
        opposite = walls["-" + "xy"[axis]][0][axis] + walls["+" + "xy"[axis]][0][axis]
        assert abs(opposite) < 2e-3


def test_side_walls_carry_a_deep_bed_as_in_janssen_s_law() -> None:
    """The load on the floor of a pressed column saturates as (1 - exp(-n/N)) N/n, with one fitted number N.

    N and the measured ratio of friction to pressure at the side give K, the ratio of horizontal to vertical pressure,
    between 0.35 and 0.65. Vertical forces on all walls add up to the force on the bed.
    """
    counts, loads, friction = np.array([100, 200, 400]), [], []
    for count in counts:
        side = rb.Wall(friction=0.2, rolling=0.5)  # wall balls slide, and do not roll off the load
        cavity = rb.Cylinder(diameter=5 * BALL, length=max(8, count / 12) * BALL)
        walls, _ = pressed(cavity, int(count), friction=0.3, walls={"side": side})
        (side_force, side_normal), (floor, _) = walls["side"], walls["first end"]
        assert -(side_force + floor)[2] == pytest.approx(1, abs=5e-3)
        loads.append(-floor[2])
        friction.append(-side_force[2] / side_normal)
    assert min(friction) > 0.7 * 0.2 and max(friction) <= 0.2 * (1 + 1e-9)

    def law(saturated: Any) -> Any:
        return (1 - np.exp(-counts / saturated)) * saturated / counts

    choices = np.linspace(100, 1000, 9001)
    saturated = choices[np.argmin([np.sum((law(n) - loads) ** 2) for n in choices])]
    assert np.abs(law(saturated) - loads).max() < 0.03  # other packings of a column differ by 0.015
    filled = 0.55  # volume of the balls over that of their bed in a can of five diameters
    depth = saturated * BALL / (6 * filled * (5 / 2) ** 2)
    assert 0.35 < 5 * BALL / (4 * np.mean(friction) * depth) < 0.65


@pytest.mark.slow
def test_side_of_a_surface_carries_a_deep_bed_as_that_of_a_can() -> None:
    """In a can of triangles whose floor and side are groups, a pressed bed loads the floor as in a can of exact walls.

    Janssen's law was compared in exact cans only, in which no contact passes from the side to the floor.
    """
    length, side = 21 * BALL, rb.Wall(friction=0.2, rolling=0.5)
    vertices, faces = triangle_meshes.cylinder(2.5 * BALL, length, 64)
    groups = {"floor": "-z", "lid": "z", "side": "rest"}
    surface = rb.Mesh(vertices=vertices, faces=faces, unit="m", groups=groups)
    cans = {"floor": surface, "first end": rb.Cylinder(diameter=5 * BALL, length=length)}
    means, errors = [], []
    for floor, cavity in cans.items():
        loads = []
        for seed in range(1, 9):
            walls, _ = pressed(cavity, 250, seed=seed, friction=0.3, walls={"side": side})
            assert -(walls["side"][0] + walls[floor][0])[2] == pytest.approx(1, abs=5e-3)
            loads.append(-walls[floor][0][2])
        means.append(np.mean(loads))
        errors.append(2.36 * np.std(loads, ddof=1) / 8**0.5)  # Student, eight values
    assert 0.5 < means[1] < 0.8 and max(errors) < 0.04
    assert abs(means[0] - means[1]) < np.hypot(*errors)


@pytest.mark.slow
def test_a_periodic_slice_has_the_loss_of_a_wide_bed() -> None:
    """The loss per mass of a slice of eight diameters is that of a box five times as wide, within the 95 % intervals."""
    loss: dict[str, list[float]] = {"slice": [], "wide": []}
    for name, width, periodic, count in (("slice", 8, "xy", 160), ("wide", 40, "y", 800)):
        for seed in range(1, 5):
            damper = rb.ParticleDamper(
                particles=rb.Particles(material="steel", diameter=BALL, count=count),
                cavity=rb.Box(size=(width * BALL, 6 * BALL, 10 * BALL), periodic=periodic),
                contact=rb.Tsuji(restitution=0.7),
                friction=0.3,
                walls={} if name == "slice" else {"-x": "frictionless", "+x": "frictionless"},
                packing=rb.Settled(seed=seed),
                softening=100,
            )
            shaker = rb.Shaker(motion=rb.Harmonic(amplitude="40 m/s^2", frequency="40 Hz", direction="z"))
            case = rb.Case(structure=shaker, damper=damper, duration=1)
            study = rb.sweep(case, {"seed": [0]}, ["reduced_loss"], cycles=(4, 16), progress=False)
            loss[name].append(study.reduced_loss.values.item())
    means = {name: np.mean(values) for name, values in loss.items()}
    errors = {name: 3.18 * np.std(values, ddof=1) / 2 for name, values in loss.items()}  # Student, four values
    assert abs(means["slice"] - means["wide"]) < np.hypot(*errors.values())
    assert max(errors.values()) < 0.03 * means["wide"]
