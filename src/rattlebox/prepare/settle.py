"""Particles inserted at random and settled under gravity."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rattlebox._util.narrow import instance
from rattlebox.core import _core
from rattlebox.model.errors import Hint
from rattlebox.model.packing import TOUCHING, Crowd, Settled, check_packing, fewer_at_random, overlapping

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.cavities import AnyCavity, Walls
    from rattlebox.model.particle_damper import ParticleDamper

    Array = NDArray[np.float64]

ROUNDS = 5000
KISSING = 12  # equal spheres that touch one
SWELL = 2e-3  # how much larger particles are made while they are pushed apart, so that in the end none touch
GROWN = 5e-6  # the same while they fall: twice that are the gaps of the bed
SINK = 0.1  # overlap over radius at the largest speed of the fall; it is two hundredths of it under the own weight
LIGHTER = tuple(0.5**n for n in range(1, 25))  # parts of the weight, one after the other
CALM = 3  # times twenty contact times under each
RESTITUTION = 0.1
STEPS = 20  # in a contact
FALLS = 40  # times that a fall through the cavity takes; common beds rest after three to thirteen
QUIET = 5  # times twenty contact times
STOPS = 100  # after that: what nothing slows, as one ball that rolls in a round cavity, is stopped where it is fastest
ROUGH = 1.0  # friction beyond which hardly anything slides
REMEMBERED = 8  # beds


@overload
def settle(damper: ParticleDamper) -> Array: ...
@overload
def settle(damper: ParticleDamper, go_on: Callable[[], bool]) -> Array | None: ...
def settle(damper: ParticleDamper, go_on: Callable[[], bool] = lambda: True) -> Array | None:
    """Return positions of a bed at rest, (n, 3) [m] from the centre of the cavity.

    The last few beds are remembered: cases that differ in motion or contacts only start from the same one.

    Parameters
    ----------
    damper
        What to fill in; its packing is Settled.
    go_on
        Asked now and then; False stops, and nothing is returned.

    Raises
    ------
    Hint
        When particles cannot be inserted, or do not come to rest.
    """
    packing = instance(damper.packing, Settled)
    about = damper.model_dump_json(include={"particles", "cavity", "gravity", "packing"}) + f" {_friction(damper)!r}"
    if about in _beds:
        return _beds[about].copy()
    radii = damper.contents.radius
    inserted = insert(damper.cavity, radii, packing.seed)
    bed = _Bed(damper, go_on)
    try:
        settled = bed.expand(bed.fall(inserted, packing.at_rest), damper.cavity)
    except _Stopped:
        return None
    check_packing(damper.cavity, settled, radii)
    for oldest in list(_beds)[: 1 - REMEMBERED]:
        _beds.pop(oldest, None)
    _beds[about] = settled.copy()
    return settled


_beds: dict[str, Array] = {}


class _Stopped(Exception):
    pass


def insert(cavity: AnyCavity, radii: Array, seed: int) -> Array:
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
    there = np.zeros(0, int)
    octave = np.log2(radii.max() / radii).astype(int)
    for k in np.unique(octave):  # the largest first: they do not get through many small ones
        left = new = np.flatnonzero(octave == k)
        for _ in range(1000):
            places[left] = generator.uniform(-half, half, (left.size, 3)) @ cavity.frame
            outside = cavity.room(places[left], radii[left]) < 0
            left = left[outside | _overlap(places[left], radii[left], places[there], radii[there])]
            if not left.size:
                break
        there = np.sort(np.concatenate([there, new]))
        places[there] = push_apart(cavity, places[there], radii[there], SWELL)
    return places


def _overlap(places: Array, radii: Array, others: Array, other_radii: Array) -> NDArray[np.bool_]:
    """Whether spheres overlap others, larger ones, (n,)."""
    from scipy.spatial import cKDTree

    found = np.zeros(radii.size, bool)
    octave = np.log2(other_radii / other_radii.min(initial=math.inf)).astype(int)
    for k in np.unique(octave):
        large = np.flatnonzero(octave == k)
        reach = float(radii.max() + other_radii[large].max())
        near = cKDTree(places).sparse_distance_matrix(cKDTree(others[large]), reach, output_type="ndarray")
        found[near["i"][near["v"] < radii[near["i"]] + other_radii[large[near["j"]]]]] = True
    return found


def push_apart(cavity: AnyCavity, places: Array, radii: Array, swell: float) -> Array:
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
    margin = 0.3 * float(grown.min())
    looked = np.full_like(places, np.inf)
    move, stride, mixing, downhill = np.zeros_like(places), 0.3, 0.1, 0
    for _ in range(ROUNDS):  # steepest descent with inertia (FIRE) on the squares of all overlaps
        if not 2 * np.abs(places - looked).max() * math.sqrt(3) < margin:
            near = overlapping(places, grown, margin)[:2]
            looked = places.copy()
        between = places[near[0]] - places[near[1]]
        length = np.linalg.norm(between, axis=1)
        apart = length - grown[near[0]] - grown[near[1]]
        deep = apart < 0
        first, second, apart = near[0][deep], near[1][deep], apart[deep]
        depth = walls.distances(places) - grown[:, None]
        small = np.minimum(grown[first], grown[second])
        if max((-apart / small).max(initial=0.0), (-depth / grown[:, None]).max()) <= 0.5 * swell:
            return places
        between, length = between[deep], length[deep][:, None]
        push = -apart[:, None] * np.where(length > 0, between / np.maximum(length, 1e-300), [0.0, 0.0, 1.0])
        force = _off_walls(walls, places, depth)
        np.add.at(force, first, push)
        np.add.at(force, second, -push)
        around = np.bincount(first, minlength=radii.size) + np.bincount(second, minlength=radii.size)
        force /= np.maximum(around / KISSING, 1.0)[:, None]  # a large one among many small ones is stiffly held
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
        fewer_at_random(cavity, Crowd.of(radii)),
    )


def _off_walls(walls: Any, places: Array, depth: Array) -> Array:
    """Moves that take spheres out of walls."""
    move = np.zeros_like(places)
    for k, (axis, form) in enumerate(zip(walls.axis, walls.form, strict=True)):
        deep = np.minimum(depth[:, k], 0.0)[:, None]
        if form != "plane":
            outward = places - (places @ axis)[:, None] * axis
            outward /= np.maximum(np.linalg.norm(outward, axis=1), 1e-300)[:, None]
        else:
            outward = np.broadcast_to(axis, places.shape)
        move += deep * outward
    return move


class _Bed:
    """Particles, a little larger than they are, in a cavity that stands still, with soft and sticky contacts."""

    def __init__(self, damper: ParticleDamper, go_on: Callable[[], bool]) -> None:
        self._go_on = go_on
        self._contents, self._walls = damper.contents, damper.cavity.walls()
        self._gravity = np.array(damper.gravity)
        self._pull = float(np.linalg.norm(self._gravity))
        height = damper.cavity.extent(self._gravity / self._pull)
        self._fall = math.sqrt(2 * height / self._pull)
        small = float(self._contents.radius.min())
        # the largest overlap is speed times duration over pi
        self._lasts = math.pi * SINK * small / (self._pull * self._fall)
        mass = float(self._contents.mass.min()) / 2
        stiffness = mass * (math.pi / self._lasts) ** 2
        self._laws = _core.PairLaws(
            normal=_core.LinearForce(stiffness=stiffness, mass=mass, zero_overlap=0.0, fixed_contact_time=1.0),
            restitution=_core.ConstantRestitution(e=RESTITUTION, maximum=1.0),
            tangential=_core.SpringFriction(friction=_friction(damper), stiffness=0.0, ratio=2 / 7, damping=1.0),
            rolling=_core.RollingResistance(coefficient=0.0, stiffness=1.0, damping=0.0),
            radius=small / 2,
            mass=mass,
        )

    def fall(self, places: Array, at_rest: float) -> Array:
        """Let particles fall until they rest."""
        still = at_rest * float(self._contents.mass @ self._contents.radius) * self._pull
        rounds = max(1, math.ceil(FALLS * self._fall / (20 * self._lasts)))
        for stopped in (False, *STOPS * (True,)):
            quiet, before = 0, 0.0
            for now, energy in self._followed(places, 1.0, rounds):
                quiet = quiet + 1 if energy < still else 0
                if quiet == QUIET:
                    return now
                places = now
                if stopped and energy < before:
                    if before < still:
                        return now
                    break
                before = energy
        raise Hint(f"particles do not come to rest within {FALLS * self._fall:.3g} s", "a larger at_rest")

    def expand(self, places: Array, cavity: AnyCavity) -> Array:
        """Lift the weight little by little, until no particle in its true size overlaps another one."""
        radii = self._contents.radius
        told = radii - 0.5 * TOUCHING * radii.min()  # a row as long as the cavity overlaps by its rounding for ever
        for weight in LIGHTER:
            for now, _ in self._followed(places, weight, CALM):
                if cavity.room(now, told).min() >= 0 and not overlapping(now, told)[0].size:
                    return now
            places = now
        return push_apart(cavity, places, radii, SWELL)

    def _followed(self, places: Array, weight: float, rounds: int) -> Iterator[tuple[Array, float]]:
        """Places and kinetic energy every twenty contact times, under a part of the weight."""
        every, none, count = 20 * STEPS, np.zeros(0), self._contents.radius.size
        cavity = _core.Cavity(
            shape=np.zeros((0, 3)),
            walls=packed_walls(self._walls, np.zeros(self._walls.offset.size, int)),
            position=places,
            velocity=np.zeros_like(places),
            spin=np.zeros_like(places),
            radius=self._contents.radius * (1 + GROWN),
            mass=self._contents.mass,
            inertia=self._contents.inertia,
            species=np.zeros(count, np.int64),
            particle_pair=np.zeros((1, 1), np.int64),
            wall_pair=np.zeros((1, 1), np.int64),
        )
        problem = _core.DemProblem(
            dt=self._lasts / STEPS,
            steps=rounds * every,
            every=every,
            gravity=self._gravity * weight,
            mode_decay=none,
            mode_stiffness=none,
            mode_coupling=none,
            mode_displacement=none,
            mode_velocity=none,
            loads=[],
            load_directions=np.zeros((0, 3)),
            cavities=[cavity],
            pairs=[self._laws],
        )
        dem = _core.Dem(problem)
        dem.threads = max(1, min(os.cpu_count() or 1, count // 4000))
        for sample in range(1, rounds + 1):
            dem.run(sample * every, None)
            if not self._go_on():
                raise _Stopped
            if dem.status:
                raise Hint(f"particles do not settle: the run ended with status {dem.status.name}")
            yield dem.state().cavities[0].position, float(dem.records().kinetic[-1].sum())


def packed_walls(walls: Walls, material: NDArray[np.int_]) -> list[_core.Wall]:
    """Return walls as the core reads them, each with the number of its material."""
    return [
        _core.Wall(form=_core.WallForm[form], axis=axis, offset=float(offset), material=int(number))
        for form, axis, offset, number in zip(walls.form, walls.axis, walls.offset, material, strict=True)
    ]


def _friction(damper: ParticleDamper) -> float:
    """The largest coefficient of friction among the particles, up to where more makes no other bed."""
    entries = damper.contact_table.entries
    return min(max((entry.friction.coefficient for entry in entries if entry.friction is not None), default=0.0), ROUGH)
