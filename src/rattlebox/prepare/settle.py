"""Particles inserted at random, compacted, and settled under gravity."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

import numpy as np

from rattlebox._util.narrow import instance, present
from rattlebox.core import _core
from rattlebox.model.crowds import Crowd, fewer_at_random, holds_at_random, random_density
from rattlebox.model.errors import Hint
from rattlebox.model.overlaps import TOUCHING, check_packing, overlapping, tree_of
from rattlebox.model.packing import Bed
from rattlebox.model.space import components_along, to_global, to_nearest_image

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.any_cavity import AnyCavity
    from rattlebox.model.cavities import Walls
    from rattlebox.model.particle_damper import ParticleDamper

    Array = NDArray[np.float64]

MAX_ITERATIONS = 5000
KISSING_NUMBER = 12  # equal spheres that can touch one sphere
ENLARGEMENT = 2e-3  # relative enlargement of the radii while particles are pushed apart, so that none touch in the end
FALL_ENLARGEMENT = 5e-6  # the same during the fall; the gaps of the bed are twice as large
FALL_OVERLAP = 0.1  # overlap over radius at the largest speed of the fall; under the own weight it is 50 times smaller
WEIGHT_FACTORS = tuple(0.5**n for n in range(1, 25))  # successive fractions of the weight during expansion
RELAXATION_BLOCKS = 3  # blocks of twenty contact times under each of them
RESTITUTION = 0.3  # With stronger damping, steps of this length generate energy where friction is large.
STEPS = 20  # in a contact
MAX_FALL_TIMES = 40  # longest simulation over the duration of a fall through the cavity; common beds need 3 to 13
QUIET_BLOCKS = 5  # blocks of twenty contact times in a row below the energy limit, after which a bed is at rest
MAX_STOPS = 100
"""Largest number of times that a motion without damping, such as that of a ball in a round cavity, is stopped."""
MAX_FRICTION = 1.0  # A larger coefficient of friction does not change the bed.
CACHED_BEDS = 8
ATTEMPTS = 4  # insertions with different random numbers into a cavity that is nearly full; more of a few particles
VOLUME_POINTS = 2**16  # points at which volumes in a cavity are computed


def start_positions(damper: ParticleDamper) -> Array:
    """Return the initial positions of the particles relative to the centre of the cavity, (n, 3) [m]; beds are computed."""
    return settle(damper) if damper.packing.is_computed else damper.start.position


def bed_key(damper: ParticleDamper) -> str:
    """Return a text that is equal for dampers with the same settled bed."""
    fields = damper.model_dump_json(include={"particles", "cavity", "gravity", "rotation", "packing"})
    return f"{fields} {damper.interior.digest} {_friction(damper)!r}"


@overload
def settle(damper: ParticleDamper) -> Array: ...
@overload
def settle(damper: ParticleDamper, proceed: Callable[[], bool]) -> Array | None: ...
def settle(damper: ParticleDamper, proceed: Callable[[], bool] = lambda: True) -> Array | None:
    """Compute the positions of the particles of a damper in a bed.

    The last few beds are cached: cases that differ only in motion or contacts start from the same one.

    Returns positions relative to the centre of the cavity [m]; None if `proceed` stopped it, (n, 3).
    """
    packing = instance(damper.packing, Bed)
    key = bed_key(damper)
    known = _beds.get(key)
    if known is not None:
        return known.copy()
    radii = damper.contents.radius
    try:
        places = compact(damper, proceed) if packing.is_dense else insert(damper.interior, radii, packing.seed, proceed)
        if damper.up is not None:
            bed = _SettlingBed(damper, proceed)
            places = bed.expand(bed.fall(places, packing.at_rest))
    except _Stopped:
        return None
    places = damper.interior.wrapped(places)
    check_packing(damper.interior, places, radii)
    for oldest in list(_beds)[: 1 - CACHED_BEDS]:
        _beds.pop(oldest, None)
    _beds[key] = places.copy()
    return places


_beds: dict[str, Array] = {}


class _Stopped(Exception):
    pass


def compact(damper: ParticleDamper, proceed: Callable[[], bool] = lambda: True) -> Array:
    """Compute positions of a dense random bed under a lid, which is as low as the density of the bed permits.

    Returns positions relative to the centre of the cavity [m], (n, 3).

    Notes
    -----
    Below the lid, particles have the density of `rattlebox.model.crowds.random_density`. If they cannot be inserted, the
    volume below the lid grows by 3 % until they can. `push_apart` names the method and its source.
    """
    cavity, radii, seed = damper.interior, damper.contents.radius, instance(damper.packing, Bed).seed
    fill = 1.0 if damper.up is None else _compacted_fill(cavity, radii, damper.up)
    while fill < 1:
        try:
            return insert(cavity, radii, seed, proceed, _under_lid(cavity, present(damper.up), fill))
        except Hint:  # The density of beds in narrow cavities is lower than usual.
            fill *= 1.03
    for attempt in range(ATTEMPTS + 100 // radii.size):
        try:
            return insert(cavity, radii, [seed, attempt] if attempt else seed, proceed)
        except Hint as hint:
            full = hint
    raise full


def _compacted_fill(cavity: AnyCavity, radii: Array, up: Array) -> float:
    """Return the volume of a compacted bed over that of the cavity, at most 1."""
    diameter = 2 * float(np.sum(radii**3) / np.sum(radii**2))
    solid = 4 / 3 * math.pi * float(np.sum(radii**3)) / cavity.volume
    lowest = min(1.0, 2.5 * float(radii.max()) / cavity.extent(up))  # one layer
    fill = 1.0
    for _ in range(20):
        fill = min(1.0, max(lowest, solid / random_density(cavity, diameter, fill, up)))
    return fill


def _under_lid(cavity: AnyCavity, up: Array, fill: float) -> Walls:
    """Return the walls of a cavity with a lid perpendicular to gravity, above a share of the volume."""
    walls = cavity.walls()
    level = np.quantile(components_along(cavity.spread(VOLUME_POINTS), up), fill)
    return walls.with_lid(up, float(level))


def insert(
    cavity: AnyCavity,
    radii: Array,
    seed: int | list[int],
    proceed: Callable[[], bool] = lambda: True,
    walls: Walls | None = None,
) -> Array:
    """Compute random positions of spheres that do not overlap.

    `radii`: radii of the spheres, (n,) [m]. Returns positions relative to the centre of the cavity [m], (n, 3).

    Notes
    -----
    Spheres are placed in classes of size, the largest first, each at evenly distributed places outside the walls and the
    larger spheres; `push_apart` then removes overlaps within the class.
    """
    generator = np.random.default_rng(seed)
    walls = cavity.walls() if walls is None else walls
    half = cavity.lengths / 2
    places = np.zeros((radii.size, 3))
    there = np.zeros(0, int)
    octave = np.log2(radii.max() / radii).astype(int)
    for k in np.unique(octave):  # the largest first: many small ones would leave them no place
        left = new = np.flatnonzero(octave == k)
        for _ in range(1000):
            places[left] = to_global(generator.uniform(-half, half, (left.size, 3)), cavity.frame)
            outside = walls.distances(places[left]).min(axis=1) < radii[left]
            left = left[outside | _overlap(places[left], radii[left], places[there], radii[there], cavity.period)]
            if not left.size:
                break
        there = np.sort(np.concatenate([there, new]))
        places[there] = push_apart(cavity, places[there], radii[there], ENLARGEMENT, proceed, walls)
    return places


def _overlap(places: Array, radii: Array, others: Array, other_radii: Array, period: Array) -> NDArray[np.bool_]:
    """Return whether each sphere overlaps one of the others, which are larger, (n,)."""
    overlaps = np.zeros(radii.size, bool)
    octave = np.log2(other_radii / other_radii.min(initial=math.inf)).astype(int)
    for k in np.unique(octave):
        large = np.flatnonzero(octave == k)
        reach = float(radii.max() + other_radii[large].max())
        trees = tree_of(places, period), tree_of(others[large], period)
        near = trees[0].sparse_distance_matrix(trees[1], reach, output_type="ndarray")
        overlaps[near["i"][near["v"] < radii[near["i"]] + other_radii[large[near["j"]]]]] = True
    return overlaps


@dataclass
class _Descent:
    """Steepest descent with inertia (FIRE); see `push_apart`."""

    move: Array  # (n, 3)
    stride: float = 0.3
    mixing: float = 0.1
    downhill: int = 0  # steps since the motion was last uphill

    def step(self, force: Array) -> Array:
        """Return the displacements of a step under forces, (n, 3)."""
        # Downhill the motion speeds up and turns into the force; uphill it stops at once, so that long steps are safe.
        if np.sum(force * self.move) > 0:
            length = math.sqrt(np.sum(self.move**2) / np.sum(force**2))
            self.move = (1 - self.mixing) * self.move + self.mixing * force * length
            self.downhill += 1
            if self.downhill > 5:
                self.stride, self.mixing = min(1.1 * self.stride, 0.8), 0.99 * self.mixing
        else:
            self.move, self.stride, self.mixing, self.downhill = np.zeros_like(force), 0.5 * self.stride, 0.1, 0
        self.move += self.stride * force
        return self.stride * self.move


def push_apart(
    cavity: AnyCavity,
    places: Array,
    radii: Array,
    enlargement: float,
    proceed: Callable[[], bool] = lambda: True,
    walls: Walls | None = None,
) -> Array:
    """Push overlapping spheres apart and off the walls until no overlap is left.

    `places`: positions, (n, 3) [m]. `radii`: radii of the spheres, (n,) [m]. Returns positions without overlaps [m],
    (n, 3).

    Notes
    -----
    The positions x minimise U = 1/2 sum(d^2) over all overlaps d of spheres with each other and with walls. FIRE is steepest
    descent with inertia: x' = v, v' = F = -dU/dx, where v is mixed with F in every step, v = (1 - c) v + c F sqrt(v^2/F^2),
    and set to zero if F v <= 0. Steps are 1.1 times as long after five steps with F v > 0, and halved after one without. The
    force on a sphere that has more than 12 neighbours is reduced, so that the sum of their springs is no stiffer.

    References
    ----------
    E. Bitzek, P. Koskinen, F. Gähler, M. Moseler, P. Gumbsch, Physical Review Letters 97 (2006) 170201,
    doi:10.1103/PhysRevLett.97.170201.
    """
    places, grown = places.copy(), radii * (1 + enlargement)
    # In a slot as wide as the spheres there is no room for larger ones.
    at_walls = np.minimum(grown, np.maximum(radii, 0.5 * cavity.widest))
    walls = cavity.walls() if walls is None else walls
    # Candidate pairs hold until something has moved by half of the margin; a search costs as much as many iterations.
    margin = 0.3 * float(grown.min())
    listed = np.full_like(places, np.inf)  # positions at the last search for candidate pairs
    descent = _Descent(np.zeros_like(places))
    for iteration in range(MAX_ITERATIONS):
        if iteration % 50 == 0 and not proceed():
            raise _Stopped
        if not 2 * np.abs(places - listed).max() * math.sqrt(3) < margin:
            near = overlapping(places, grown, margin, cavity.period)[:2]
            listed = places.copy()
        between = to_nearest_image(places[near[0]] - places[near[1]], cavity.period)
        length = np.linalg.norm(between, axis=1)
        apart = length - grown[near[0]] - grown[near[1]]
        deep = apart < 0
        first, second, apart = near[0][deep], near[1][deep], apart[deep]
        distance = walls.distances(places)
        depth = distance - at_walls[:, None]
        solids = _off_solids(walls, places, at_walls, depth)
        small = np.minimum(grown[first], grown[second])
        # Spheres were enlarged, so that the end may leave half of the enlargement: true sizes then have no overlap.
        deepest = max((-apart / small).max(initial=0.0), (-depth / grown[:, None]).max())
        if deepest <= 0.5 * enlargement and (distance - radii[:, None]).min() >= -0.5 * TOUCHING * radii.min():
            return cavity.wrapped(places)
        between, length = between[deep], length[deep][:, None]
        # Two centres at the same place have no direction; any one separates them.
        push = -apart[:, None] * np.where(length > 0, between / np.maximum(length, 1e-300), [0.0, 0.0, 1.0])
        force = _off_walls(walls, places, depth)
        np.add.at(force, *solids)
        np.add.at(force, first, push)
        np.add.at(force, second, -push)
        around = np.bincount(first, minlength=radii.size) + np.bincount(second, minlength=radii.size)
        # The stiffness of the springs of many small spheres on a large one adds up, and steps would be unstable.
        force /= np.maximum(around / KISSING_NUMBER, 1.0)[:, None]
        places += descent.step(force)
    # The number that would fit is computed, so that the advice can be followed.
    crowd = Crowd.of(radii)
    filled = crowd.count * crowd.volume / cavity.volume
    raise Hint(
        f"{crowd.count} particles, which would fill {100 * filled:.3g} % of the cavity, cannot be inserted at random"
        + (f"; {holds_at_random(cavity, crowd)}" if crowd.count > crowd.at_random(cavity) else ""),
        fewer_at_random(cavity, crowd),
    )


def _off_walls(walls: Walls, places: Array, depth: Array) -> Array:
    """Return displacements that move spheres out of the walls."""
    move = np.zeros_like(places)
    for k, (axis, form) in enumerate(zip(walls.axis, walls.form, strict=True)):
        deep = np.minimum(depth[:, k], 0.0)[:, None]
        if form != "plane":
            outward = places - components_along(places, axis)[:, None] * axis
            outward /= np.maximum(np.linalg.norm(outward, axis=1), 1e-300)[:, None]
        else:
            outward = np.broadcast_to(axis, places.shape)
        move += deep * outward
    return move


def _off_solids(walls: Walls, places: Array, radii: Array, depth: Array) -> tuple[NDArray[np.int64], Array]:
    """Return spheres that overlap solids, once for each contact, and displacements that move them out, (k, 3) [m]."""
    depth = depth[:, walls.offset.size :]
    near = np.flatnonzero((depth < 0).any(axis=1))
    if not near.size:
        return near, np.zeros((0, 3))
    number, normal, distance = walls.solids.contacts(places[near], radii[near])
    who, moves = [near[number]], [(distance - radii[near[number]])[:, None] * normal]
    # A sphere without a contact, because its centre is beyond a surface, moves back up the gradient of the distance.
    end = 0
    for solid in walls.solids.each:
        own = slice(end, end := end + len(solid.walls))
        nearest = depth[:, own].min(axis=1)
        beyond = np.flatnonzero(nearest < -radii) if solid.hides_centres else near[:0]
        if beyond.size:
            steps = 1e-4 * radii[beyond, None, None] * np.eye(3)
            ahead, back = (
                walls.solids.distances((places[beyond, None] + side * steps).reshape(-1, 3))[:, own].min(axis=1)
                for side in (1, -1)
            )
            slope = (ahead - back).reshape(-1, 3)
            who.append(beyond)
            moves.append((-nearest[beyond] / np.maximum(np.linalg.norm(slope, axis=1), 1e-300))[:, None] * slope)
    return np.concatenate(who), np.concatenate(moves)


class _SettlingBed:
    """Slightly enlarged particles with soft, strongly damped contacts in a cavity at rest."""

    def __init__(self, damper: ParticleDamper, proceed: Callable[[], bool]) -> None:
        self._proceed = proceed
        self._contents, self._cavity = damper.contents, damper.interior
        self._gravity = damper.field
        self._pull = float(np.linalg.norm(self._gravity))
        height = damper.interior.extent(present(damper.up))
        self._fall = math.sqrt(2 * height / self._pull)
        small = float(self._contents.radius.min())
        # The largest overlap of a linear contact is the speed times the duration over pi.
        self._contact_time = math.pi * FALL_OVERLAP * small / (self._pull * self._fall)
        mass = float(self._contents.mass.min()) / 2
        # Only the positions of the bed are used, so that contacts may be soft: as soft as overlaps in the fall allow,
        # which makes steps long.
        stiffness = mass * (math.pi / self._contact_time) ** 2
        self._laws = _core.PairLaws(
            normal=_core.LinearForce(stiffness=stiffness, mass=mass, zero_overlap=0.0, fixed_contact_time=1.0),
            restitution=_core.ConstantRestitution(e=RESTITUTION, maximum=1.0),
            tangential=_core.SpringFriction(friction=_friction(damper), stiffness=0.0, ratio=2 / 7, damping=1.0),
            rolling=_core.RollingResistance(coefficient=0.0, stiffness=1.0, damping=0.0),
            radius=small / 2,
            mass=mass,
        )

    def fall(self, places: Array, at_rest: float) -> Array:
        """Compute the positions of the particles after they have fallen and come to rest."""
        # The unit of energy is a fall of all particles by their radius.
        limit = at_rest * float(np.sum(self._contents.mass * self._contents.radius)) * self._pull
        blocks = max(1, math.ceil(MAX_FALL_TIMES * self._fall / (20 * self._contact_time)))
        # A deep bed without damping of its modes sways for long. If it has not come to rest, it is stopped where its
        # energy is largest, that is, where its potential is lowest, and falls again from there.
        for stopped in (False, *MAX_STOPS * (True,)):
            quiet, before = 0, 0.0
            for now, energy in self._simulate(places, 1.0, blocks):
                quiet = quiet + 1 if energy < limit else 0
                if quiet == QUIET_BLOCKS:
                    return now
                if stopped and energy < before:
                    if before < limit:
                        return now
                    break  # The next fall starts from the positions at the largest speed.
                places, before = now, energy
        raise Hint(f"particles do not come to rest within {MAX_FALL_TIMES * self._fall:.3g} s", "a larger at_rest")

    def expand(self, places: Array) -> Array:
        """Reduce the weight in steps until particles of the true size do not overlap; return their positions."""
        radii, cavity = self._contents.radius, self._cavity
        # The tolerance is for rows exactly as long as the cavity, which overlap by rounding under any weight.
        reduced = radii - 0.5 * TOUCHING * radii.min()
        # Under its weight a bed overlaps; with less of it in each step it swells as a whole instead of being pushed
        # apart at random.
        for weight in WEIGHT_FACTORS:
            for now, _ in self._simulate(places, weight, RELAXATION_BLOCKS):
                if cavity.room(now, reduced).min() >= 0 and not overlapping(now, reduced, period=cavity.period)[0].size:
                    return now
            places = now
        return push_apart(cavity, places, radii, ENLARGEMENT)

    def _simulate(self, places: Array, weight: float, blocks: int) -> Iterator[tuple[Array, float]]:
        """Yield positions and kinetic energy every twenty contact times, under a fraction of the weight."""
        every, none, count = 20 * STEPS, np.zeros(0), self._contents.radius.size
        walls = self._cavity.walls()
        cavity = _core.Cavity(
            shape=np.zeros((0, 3)),
            walls=pack_walls(walls, np.zeros(len(walls.names), int)),
            solids=pack_solids(walls, np.zeros(len(walls.names), int)),
            period=self._cavity.period,
            position=places,
            velocity=np.zeros_like(places),
            spin=np.zeros_like(places),
            radius=self._contents.radius * (1 + FALL_ENLARGEMENT),
            mass=self._contents.mass,
            inertia=self._contents.inertia,
            species=np.zeros(count, np.int64),
            particle_pair=np.zeros((1, 1), np.int64),
            wall_pair=np.zeros((1, 1), np.int64),
        )
        # The cavity stands still: a structure without modes.
        problem = _core.DemProblem(
            dt=self._contact_time / STEPS,
            steps=blocks * every,
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
        # Small beds are faster on one thread; results do not depend on the number.
        dem.threads = max(1, min(os.cpu_count() or 1, count // 4000))
        for sample in range(1, blocks + 1):
            dem.run(sample * every, None)
            if not self._proceed():
                raise _Stopped
            if dem.status:
                raise Hint(
                    f"particles do not settle: the run ended with status {dem.status.name}",
                    'packing = { kind = "lattice" }, or another seed',
                )
            yield dem.state().cavities[0].position, float(dem.records().kinetic[-1].sum())


def pack_walls(walls: Walls, material: NDArray[np.int_]) -> list[_core.Wall]:
    """Pack walls for the core without solids, each with the index of its material."""
    return [
        _core.Wall(form=_core.WallForm[form], axis=axis, offset=float(offset), material=int(number), label=int(label))
        for form, axis, offset, number, label in zip(
            walls.form, walls.axis, walls.offset, material, walls.label_numbers, strict=False
        )
    ]


def pack_solids(walls: Walls, material: NDArray[np.int_]) -> list[_core.Solid]:
    """Pack bodies and surfaces of triangles for the core, each with the index of its material."""
    end, packed = walls.offset.size, []
    for solid in walls.solids.each:
        begin, end = end, end + len(solid.walls)
        packed.append(solid.packed(material[begin:end].tolist(), walls.label_numbers[begin:end].tolist()))
    return packed


def _friction(damper: ParticleDamper) -> float:
    """Return the largest coefficient of friction in a damper, at most `MAX_FRICTION`."""
    return min(damper.largest_friction, MAX_FRICTION)
