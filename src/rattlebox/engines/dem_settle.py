"""Particles inserted at random and settled under gravity."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.engines.core import core
from rattlebox.model.errors import Hint
from rattlebox.model.packing import Settled, check_packing, overlapping

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.cavities import Cavity
    from rattlebox.model.granular import ParticleDamper

    Array = NDArray[np.float64]

ROUNDS = 5000
SWELL = 2e-3  # how much larger particles are made while they are pushed apart, so that in the end none touch
SINK = 0.05  # overlap over radius at the largest speed of the fall
RESTITUTION = 0.1
STEPS = 30  # in a contact
FALLS = 200  # times that a fall through the cavity takes, after which a bed should rest


def settle(damper: ParticleDamper) -> Array:
    """Return positions of a bed at rest, (n, 3) [m] from the centre of the cavity.

    Parameters
    ----------
    damper
        What to fill in; its packing is Settled.

    Raises
    ------
    Hint
        When particles cannot be inserted, or do not come to rest.
    """
    packing = damper.packing
    assert isinstance(packing, Settled)
    radii = damper.contents.radius
    inserted = insert(damper.cavity, radii, packing.seed)
    fallen = _fall(damper, inserted, packing.at_rest)
    settled = push_apart(damper.cavity, fallen, radii, 1e-9)
    check_packing(damper.cavity, settled, radii)
    return settled


def insert(cavity: Cavity, radii: Array, seed: int) -> Array:
    """Return places of spheres at random that do not overlap, (n, 3) [m].

    Parameters
    ----------
    cavity
        Where.
    radii
        Of the spheres, (n,) [m].
    seed
        Of the places.

    Raises
    ------
    Hint
        When they are too many.
    """
    generator = np.random.default_rng(seed)
    half = cavity.lengths / 2
    places = np.zeros((radii.size, 3))
    left = np.arange(radii.size)
    for _ in range(1000):
        places[left] = generator.uniform(-half, half, (left.size, 3)) @ cavity.frame
        left = left[cavity.room(places[left], radii[left]) < 0]
        if not left.size:
            break
    return push_apart(cavity, places, radii, SWELL)


def push_apart(cavity: Cavity, places: Array, radii: Array, swell: float) -> Array:
    """Push spheres apart and off the walls, each pair by what it overlaps, until none does.

    Parameters
    ----------
    cavity
        Around them.
    places
        Where they are, (n, 3) [m].
    radii
        Of the spheres, (n,) [m].
    swell
        How much larger they are made for it, in parts of the radius.

    Raises
    ------
    Hint
        When there is no room.
    """
    places, grown = places.copy(), radii * (1 + swell)
    walls = cavity.walls()
    move, stride, mixing, downhill = np.zeros_like(places), 0.3, 0.1, 0
    for _ in range(ROUNDS):  # steepest descent with inertia (FIRE) on the squares of all overlaps
        first, second, apart = overlapping(places, grown)
        depth = walls.distances(places) - grown[:, None]
        small = np.minimum(grown[first], grown[second])
        if max((-apart / small).max(initial=0.0), (-depth / grown[:, None]).max()) <= 0.5 * swell:
            return places
        between = places[first] - places[second]
        length = np.linalg.norm(between, axis=1)[:, None]
        push = -apart[:, None] * np.where(length > 0, between / np.maximum(length, 1e-300), [0.0, 0.0, 1.0])
        force = _off_walls(walls, places, depth)
        np.add.at(force, first, push)
        np.add.at(force, second, -push)
        if np.sum(force * move) > 0:
            move = (1 - mixing) * move + mixing * force * np.linalg.norm(move) / np.linalg.norm(force)
            downhill += 1
            if downhill > 5:
                stride, mixing = min(1.1 * stride, 0.8), 0.99 * mixing
        else:
            move, stride, mixing, downhill = np.zeros_like(places), 0.5 * stride, 0.1, 0
        move += stride * force
        places += stride * move
    filled = float(np.sum(radii**3)) * 4 / 3 * math.pi / cavity.volume
    raise Hint(
        f"{radii.size} particles cannot be inserted at random: they would fill {100 * filled:.3g} % of the cavity",
        'packing = { kind = "lattice" }, or fewer of them',
    )


def _off_walls(walls: Any, places: Array, depth: Array) -> Array:
    """Moves that take spheres out of walls."""
    move = np.zeros_like(places)
    for k, (axis, curved) in enumerate(zip(walls.axis, walls.curved, strict=True)):
        deep = np.minimum(depth[:, k], 0.0)[:, None]
        if curved:
            outward = places - (places @ axis)[:, None] * axis
            outward /= np.maximum(np.linalg.norm(outward, axis=1), 1e-300)[:, None]
        else:
            outward = np.broadcast_to(axis, places.shape)
        move += deep * outward
    return move


def _fall(damper: ParticleDamper, places: Array, at_rest: float) -> Array:
    """Let particles fall in a cavity that stands still, with soft and sticky contacts, until they rest."""
    contents, walls = damper.contents, damper.cavity.walls()
    gravity = np.array(damper.gravity)
    pull = float(np.linalg.norm(gravity))
    height = damper.cavity.extent(gravity / pull)
    speed = math.sqrt(2 * pull * height)
    small = float(contents.radius.min())
    # a contact that lasts pi m V / ... : overlap V t_c / pi at most SINK of the smallest radius
    lasts = math.pi * SINK * small / speed
    mass = float(contents.mass.min()) / 2
    friction = _friction(damper)
    contact = {
        "normal": {"law": "linear", "stiffness": mass * (math.pi / lasts) ** 2, "mass": mass, "zero_overlap": 0.0},
        "restitution": {"law": "constant", "e": RESTITUTION, "maximum": 1.0},
        "radius": small / 2,
        "mass": mass,
        "by_time": True,
        "friction": friction,
        "shear": 0.0,
        "tangential_stiffness": 2 / 7 * mass * (math.pi / lasts) ** 2,
        "tangential_damping": 1.0,
        "rolling": 0.0,
        "rolling_stiffness": 1.0,
        "rolling_damping": 0.0,
    }
    every = 20 * STEPS
    dt = lasts / STEPS
    longest = max(1, math.ceil(FALLS * math.sqrt(2 * height / pull) / (every * dt)))
    none = np.zeros(0)
    count = contents.radius.size
    dem = core().Dem(
        {
            "dt": dt,
            "steps": longest * every,
            "every": every,
            "gravity": gravity,
            "mode_decay": none,
            "mode_stiffness": none,
            "mode_displacement": none,
            "mode_velocity": none,
            "loads": [],
            "contacts": [contact],
            "cavities": [
                {
                    "shape": np.zeros((0, 3)),
                    "wall_axis": np.ascontiguousarray(walls.axis),
                    "wall_offset": walls.offset,
                    "wall_curved": np.array(walls.curved, dtype=float),
                    "wall_kind": np.zeros(walls.offset.size, np.int64),
                    "position": places,
                    "velocity": np.zeros_like(places),
                    "spin": np.zeros_like(places),
                    "radius": contents.radius,
                    "mass": contents.mass,
                    "inertia": contents.inertia,
                    "kind": np.zeros(count, np.int64),
                    "particle_entry": np.zeros((1, 1), np.int64),
                    "wall_entry": np.zeros((1, 1), np.int64),
                }
            ],
        }
    )
    dem.threads = max(1, min(os.cpu_count() or 1, count // 4000))
    still = at_rest * float(contents.mass @ contents.radius) * pull
    quiet = 0
    for sample in range(1, longest + 1):
        dem.run(sample * every, None)
        if dem.status:
            raise Hint(f"particles do not settle: the run ended with status {dem.status}")
        energy = float(dem.records()["kinetic"][-1].sum())
        quiet = quiet + 1 if energy < still else 0
        if quiet == 5:
            return np.asarray(dem.state()["cavities"][0]["position"])
    raise Hint(
        f"particles do not come to rest within {longest * every * dt:.3g} s", "friction among them, or a larger at_rest"
    )


def _friction(damper: ParticleDamper) -> float:
    """The largest coefficient of friction among the particles."""
    entries = damper.contact_table.entries
    return max((entry.friction.coefficient for entry in entries if entry.friction is not None), default=0.0)
