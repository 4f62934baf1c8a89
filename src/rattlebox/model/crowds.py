"""How many spheres a cavity holds, on a lattice or at random, and the densities of beds."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from .any_cavity import AnyCavity
from .cavities import Box, SphericalCavity
from .elementwise import Vector
from .errors import Hint
from .space import to_global

RANDOM_CLOSE_PACKING = 0.64
"""Largest share of the volume that equal spheres fill at random.

G. D. Scott, D. M. Kilgour, J. Phys. D 2 (1969) 863, doi:10.1088/0022-3727/2/6/311."""
COMPACTED = 0.62  # volume of equal spheres over that of a compacted bed, far from walls
LOOSEST = 0.571  # the same of a settled bed with a large coefficient of friction
_COUNTABLE = 1_000_000  # lattices with more sites are not built to count them
_MOST_SITES = (
    4_000_000  # of a lattice in the bounding box, unless particles need more; of more, evenly spread ones are built
)


@dataclass(frozen=True)
class _Grid:
    """A cubic or face-centred lattice of sites for `count` particles, at least one cell apart.

    If two sites across a round cavity would lie outside it, `middle` replaces them by one in the middle.
    """

    count: int
    centred: bool
    middle: bool

    def axes(self, cavity: AnyCavity, cell: float) -> list[Vector]:
        """Return the coordinates of sites along the axes of the cavity [m]."""
        step = cell / np.sqrt(2) if self.centred else cell
        most = max(1000, 4 * self.count)  # limits the memory in cavities that are far wider than high
        counts, halves = [], []
        for length, inside in zip(cavity.lengths, cavity.inside, strict=True):
            count = int(np.floor((length - cell) / step * (1 + 1e-12) + 1e-9)) + 1
            if self.middle and count == 2 and inside < length:
                count = 1
            half = (length - cell) / 2 if count > 1 else 0.0
            counts.append(min(count, most))
            halves.append(half)
        # A surface of triangles in a wrong unit would have billions of sites, of which a few are needed.
        box = float(np.prod(cavity.lengths)) / cavity.volume
        spare = math.prod(counts) / max(_MOST_SITES, 8 * self.count * box)
        if spare > 1:
            counts = [max(min(count, 2), math.floor(count * spare ** (-1 / 3))) for count in counts]
        return [np.linspace(-half, half, count) for half, count in zip(halves, counts, strict=True)]

    def __call__(self, cavity: AnyCavity, cell: float) -> Vector:
        """Return the sites at which a sphere as large as the cell is inside the cavity, (n, 3) [m]."""
        axes = self.axes(cavity, cell)
        index = np.indices([axis.size for axis in axes]).reshape(3, -1)
        if self.centred:
            index = index[:, index.sum(axis=0) % 2 == 0]
        local = np.column_stack([axis[i] for axis, i in zip(axes, index, strict=True)])
        sites = to_global(local, cavity.frame)
        return sites if isinstance(cavity, Box) else sites[cavity.depth(sites) >= cell / 2 * (1 - 1e-12)]

    def at_least(self, cavity: AnyCavity, cell: float) -> int:
        """Return a lower bound of the number of sites, those in the inscribed box, without building them."""
        reach = (cavity.inside - cell) / 2
        axes = zip(self.axes(cavity, cell), reach, strict=True)
        number = math.prod(int(np.sum(np.abs(axis) <= end)) for axis, end in axes)
        return number // 2 if self.centred else number


def _coarsest(cavity: AnyCavity, count: int, least: float, middle: bool) -> Iterator[tuple[float, _Grid]]:
    """Yield the coarsest lattice of each kind with enough sites, with its cell."""
    widest = float(cavity.lengths.min()) * (1 + 1e-12)
    plenty = 1.01 * count

    def size(grid: _Grid, cell: float) -> int:
        sure = grid.at_least(cavity, cell)  # Sites far above the number needed are not built.
        return sure if sure >= plenty else len(grid(cavity, cell))

    for centred in (False, True):
        grid = _Grid(count, centred, middle)
        low, high = least, min(widest, 2 * max((cavity.volume / count) ** (1 / 3), least))
        number = size(grid, low)
        if number < count:
            continue
        while high - low > 1e-3 * low and not (count > 1000 and number < plenty):
            between = (low * high) ** 0.5
            there = size(grid, between)
            if there < count:
                high = between
            else:
                low, number = between, there
        yield low, grid


def sites_for(cavity: AnyCavity, radii: Vector, settles: bool) -> tuple[Vector, float]:
    """Return at least as many sites as spheres, and the size of the cell around each."""
    count, radius, mixed = radii.size, float(radii.max()), bool(radii.min() < radii.max())
    for middle in (False, True):
        lattices = list(_coarsest(cavity, count, 2 * radius, middle))
        if lattices:
            cell, grid = max(lattices, key=lambda pair: pair[0])
            return grid(cavity, cell), cell
    raise lattice_is_full(cavity, Crowd.of(radii), settles=mixed and settles)


@dataclass(frozen=True)
class Crowd:
    """Summary of a set of particles, which may be too many for arrays."""

    count: int
    volume: float
    largest: float  # Radius of the largest particle [m]

    @property
    def alike(self) -> bool:
        """Whether all particles have one size, up to rounding."""
        return self.volume > (1 - 1e-9) * 4 / 3 * math.pi * self.largest**3

    @classmethod
    def of(cls, radii: Vector) -> Crowd:
        """Return the summary of spheres with these radii [m]."""
        return cls(radii.size, 4 / 3 * math.pi * float(np.mean(radii**3)), float(radii.max()))

    def on_lattice(self, cavity: AnyCavity) -> int:
        """Return the number of particles that a lattice holds; a lower bound if it holds all of them."""
        grids = [_Grid(self.count, *kind) for kind in product((False, True), repeat=2)]
        sure = max(grid.at_least(cavity, 2 * self.largest) for grid in grids)
        if sure >= self.count or sure > _COUNTABLE:
            return sure
        return max(len(grid(cavity, 2 * self.largest)) for grid in grids)

    def at_random(self, cavity: AnyCavity) -> int:
        """Return the number in a full, compacted cavity, which can be inserted at random."""
        filled = random_density(cavity, 2 * self.largest) * cavity.volume
        return max(1, math.floor(filled / self.volume * (1 + 1e-9)))


def random_density(cavity: AnyCavity, diameter: float, fill: float = 1.0, up: Vector | None = None) -> float:
    """Return the largest density at which spheres between walls and a lid are readily inserted at random.

    `diameter`: diameter of the spheres [m]. `up`: unit vector against gravity, (3,); None if there is no lid.

    Notes
    -----
    0.62 (1 - 0.205 x + 0.023 x^2 - 0.0035 x^3), with x the area of walls and surface over the volume, times the diameter, at
    most 4. The coefficients are fitted to packings in boxes, cylinders and spheres of 1.3 to 15 diameters, which are
    inserted in at most four attempts.
    """
    x = _wall_diameters(cavity, diameter, fill, up)
    density = COMPACTED * (1 - 0.205 * x + 0.023 * x**2 - 0.0035 * x**3)
    one = math.pi / 6 * diameter**3 / cavity.volume
    _, width, length = np.sort(cavity.lengths)
    if width < 1.9 * diameter:  # a tube, in which particles lie in a row
        density = min(density, one * (length / diameter - 0.5))
    if isinstance(cavity, SphericalCavity) and width < 2 * diameter:  # no room for two
        density = one
    return max(density, one)


def bed_density(cavity: AnyCavity, diameter: float, bulk: float, fill: float, up: Vector | None) -> float:
    """Return the usual density of a bed of spheres.

    `diameter`: diameter of the spheres [m]. `up`: unit vector against gravity, (3,); None without gravity.

    Notes
    -----
    bulk (1 - 0.165 x + 0.02 x^2), with x the area of walls and surface over the volume of the bed, times the diameter, at
    most 4. The coefficients are fitted to beds in boxes, cylinders and spheres of 2 to 14 diameters, with an error of 3 %
    (standard deviation) if the bed is higher than two diameters.
    """
    most = random_density(cavity, diameter)
    if up is None:
        return most
    x = _wall_diameters(cavity, diameter, fill, up)
    return min(bulk * (1 - 0.165 * x + 0.02 * x**2), most / fill)


def _wall_diameters(cavity: AnyCavity, diameter: float, fill: float, up: Vector | None) -> float:
    """Return the area of walls and surface of a bed over its volume, times the diameter; at most 4."""
    surface = 0.0 if up is None else 2 * (1 / fill - 1) / cavity.extent(up)
    return min(diameter * (cavity.surface_over_volume + surface), 4.0)


def lattice_is_full(cavity: AnyCavity, crowd: Crowd, *, settles: bool) -> Hint:
    """Return the error for more particles than a lattice holds; `settles` permits a settled packing as suggestion."""
    most = crowd.on_lattice(cavity)
    settled = (
        'packing = { kind = "settled" }, which suits many sizes, '
        if settles and crowd.count <= crowd.at_random(cavity)
        else ""
    )
    return Hint(
        f"{crowd.count} particles do not fit: a lattice of spheres of {2e3 * crowd.largest:.4g} mm holds {most} "
        "in this cavity",
        f"{settled}{f'{most} of them, ' if most else ''}smaller ones, or a larger cavity",
        ["particles"],
    )


def holds_at_random(cavity: AnyCavity, crowd: Crowd) -> str:
    """Return the sentence that states how many particles a cavity holds at random."""
    most = crowd.at_random(cavity)
    size = "this size" if crowd.alike else "these sizes"
    return f"at random this cavity holds at most {most} particles of {size}, a fill ratio of {_filled(cavity, crowd, most)}"


def fewer_at_random(cavity: AnyCavity, crowd: Crowd) -> str:
    """Return suggestions for more particles than can be inserted at random."""
    lattice = 'packing = { kind = "lattice" }, or ' if crowd.on_lattice(cavity) >= crowd.count else ""
    most = crowd.at_random(cavity)
    if most >= crowd.count:  # It should have been possible: no number is known that is.
        return f"{lattice}another seed, fewer particles, or a larger cavity"
    return f"{lattice}at most {most} of them (a fill ratio of {_filled(cavity, crowd, most)}), or a larger cavity"


def _filled(cavity: AnyCavity, crowd: Crowd, count: int) -> str:
    """Return the fill ratio of a number of particles, rounded down."""
    return f"{math.floor(1e3 * count * crowd.volume / cavity.volume) / 1e3:g}"
