"""Initial packings of particles: on a lattice with noise, settled under gravity, or at given positions."""

from __future__ import annotations

import math
import os
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from rattlebox._util.exceptions import DataError

from .any_cavity import AnyCavity
from .base import FilePart, Part
from .cavities import Box, SphericalCavity
from .elementwise import Vector
from .errors import Hint, at, several
from .files import BINARY, absolute, check_finite, existing, read_arrays
from .kinds import AnyKind
from .records import read_table
from .space import AXES, to_global, wrapped
from .units import SI, Number, Whole, in_si, numbers

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

TOUCHING = 1e-9  # tolerance for overlaps by rounding, relative to the radius
PRESSED = 0.1
"""Largest overlap of given positions over the smaller radius. Contacts at the end of a run overlap; `prepare` compares with
the overlaps of the contact law."""
RANDOM_CLOSE_PACKING = 0.64
"""Largest share of the volume that equal spheres fill at random.

G. D. Scott, D. M. Kilgour, J. Phys. D 2 (1969) 863, doi:10.1088/0022-3727/2/6/311."""
COMPACTED = 0.62  # volume of equal spheres over that of a compacted bed, far from walls
LOOSEST = 0.571  # the same of a settled bed with a large coefficient of friction
NARROWEST = 2.02
"""Least width of a periodic box over the diameter of the largest particle. Up to 2, two particles touch through both faces
at once; the rest is for the overlaps while particles are pushed apart."""
_FAR = 100.0  # distance over the size of the cavity from which positions are probably in other units


class Packing(Part):
    """Base class of packings."""

    field_names: ClassVar[tuple[str, ...]] = ("packing",)
    kinds: ClassVar[dict[str, type[Part]]] = {}
    kind: str

    @abstractmethod
    def place(self, cavity: AnyCavity, radii: Vector, *, settles: bool = True) -> Vector:
        """Return positions for spheres.

        `cavity`: cavity around the spheres. `radii`: radii of the spheres, (n,) [m]. `settles`: whether there is gravity,
        so that the error may suggest a settled packing. Returns positions relative to the centre of the cavity [m]; NaN if
        `is_computed`, (n, 3). Raises Hint if the spheres do not fit.
        """

    @property
    def is_computed(self) -> bool:
        """Whether the positions are those of a `Bed`, which is computed before the run."""
        return False

    @property
    def is_dense(self) -> bool:
        """Whether particles are packed as densely as random ones can be: a bed as large as the cavity fills all of it."""
        return False

    @property
    def is_random(self) -> bool:
        """Whether another seed gives other initial positions."""
        return False

    @property
    def stated_count(self) -> int | None:
        """Number of particles, if the packing states their positions."""
        return None

    @property
    def stated_radii(self) -> Vector | None:
        """Radii of the particles, (n,) [m], if the packing states them."""
        return None

    def notes(self) -> Iterator[str]:
        """Yield what a user should know about assumptions, such as the unit of a file."""
        yield from ()

    @property
    def where(self) -> str:
        """Field that messages about positions name; empty if the packing itself is meant."""
        return ""

    def motion(self, count: int) -> tuple[Vector, Vector]:
        """Return velocities [m/s] and angular velocities [rad/s] to add to that of the damper, (n, 3) each; default 0."""
        return np.zeros((count, 3)), np.zeros((count, 3))

    def check(self, cavity: AnyCavity, crowd: Crowd, *, settles: bool) -> None:
        """Raise if the packing does not suit particles whose volume is less than that of the cavity."""

    def too_many(self, cavity: AnyCavity, crowd: Crowd) -> Hint:
        """Return the error for particles whose volume is at least that of the cavity."""
        times = crowd.count * crowd.volume / cavity.volume
        return Hint(
            f"{crowd.count} particles do not fit: their volume is {times:.3g} times that of the cavity; "
            f"{holds_at_random(cavity, crowd)}",
            fewer_at_random(cavity, crowd),
            ["particles"],
        )

    def repeated(self, index: int) -> Self:
        """Return the packing of one of several identical dampers: the same for index 0, others with their own seeds."""
        if index == 0 or not self.is_random:
            return self
        seed = int(np.random.SeedSequence([getattr(self, "seed", 0), index]).generate_state(1)[0])
        return self.model_copy(update={"seed": seed})

    def reseeded(self, number: int) -> Self:
        """Return the packing with the seed of a repeated run; the packing itself for the number 0, or without a seed."""
        return self.model_copy(update={"seed": getattr(self, "seed", 0) + number}) if self.is_random else self

    def bulk_density(self, friction: float) -> float:
        """Return the volume of particles over that of their bed, far from walls; by default that of a compacted bed."""
        return COMPACTED


class Lattice(Packing):
    """Particles on a lattice that fills the cavity, with random displacements in their cells.

    Parameters
    ----------
    noise
        Largest displacement, from 0 to 1; 1 is the largest one at which particles cannot touch.
    seed
        Random seed of the displacements and of the order of particles.

    Notes
    -----
    The lattice is the cubic or the face-centred one, whichever has the larger cell for the number of particles. With the
    distance a between neighbouring sites, a particle of radius R is displaced by up to noise (a/2 - R), evenly distributed
    in this sphere.

    Examples
    --------
    The balls of a box without gravity, evenly spread:

    >>> import rattlebox as rb
    >>> damper = rb.ParticleDamper(
    ...     particles=rb.Particles(material="steel", diameter="5 mm", count=48),
    ...     cavity=rb.Box(size=("30 mm", "30 mm", "20 mm")),
    ...     contact=rb.Tsuji(restitution=0.7),
    ...     friction=0.2,
    ...     gravity=(0, 0, 0),
    ...     packing=rb.Lattice(seed=1),
    ... )
    >>> run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration="1 ms"))
    >>> run.arrays.particles.position.shape
    (48, 3)
    """

    kind: Literal["lattice"] = "lattice"
    noise: Annotated[Number, Field(ge=0, le=1)] = 0.5
    seed: Annotated[Whole, Field(ge=0)] = 0

    @property
    def is_random(self) -> bool:
        """Whether there is noise."""
        return self.noise > 0

    def place(self, cavity: AnyCavity, radii: Vector, *, settles: bool = True) -> Vector:
        """Return the positions of sites, displaced at random."""
        generator = np.random.default_rng(self.seed)
        sites, cell = _sites(cavity, radii, settles)
        chosen = generator.permutation(len(sites))[: radii.size]
        direction = generator.standard_normal((radii.size, 3))
        direction /= np.linalg.norm(direction, axis=1)[:, None]
        reach = self.noise * (cell / 2 - radii) * generator.random(radii.size) ** (1 / 3)
        return np.asarray(sites[chosen] + reach[:, None] * direction)

    def too_many(self, cavity: AnyCavity, crowd: Crowd) -> Hint:
        """Return the error with the number of sites."""
        return lattice_is_full(cavity, crowd, settles=False)


class Bed(Packing):
    """Base class of packings that are computed before the run: inserted at random, then settled if there is gravity."""

    kind: str
    seed: Annotated[Whole, Field(ge=0)] = 0
    at_rest: Annotated[Number, Field(gt=0, le=0.1)] = 1e-3

    @property
    @abstractmethod
    def is_dense(self) -> bool:
        """Whether particles are inserted as densely as they can be."""

    @property
    def is_computed(self) -> bool:
        """True."""
        return True

    @property
    def is_random(self) -> bool:
        """True."""
        return True

    def place(self, cavity: AnyCavity, radii: Vector, *, settles: bool = True) -> Vector:
        """Return NaN: `rattlebox.prepare.settle` computes the positions."""
        return np.full((radii.size, 3), np.nan)

    def check(self, cavity: AnyCavity, crowd: Crowd, *, settles: bool) -> None:
        """Raise if the particles cannot be inserted at random."""
        filled = crowd.count * crowd.volume / cavity.volume
        if filled > RANDOM_CLOSE_PACKING and crowd.count > 1:
            raise Hint(
                f"{crowd.count} particles would fill {100 * filled:.3g} % of the cavity; {holds_at_random(cavity, crowd)}",
                fewer_at_random(cavity, crowd),
                ["particles"],
            )


class Settled(Bed):
    """Particles inserted at random and settled under gravity: a loose bed, like a poured one.

    The fall is computed before the run with soft, strongly damped contacts and the largest friction of the damper. Motion
    without damping, such as that of one ball in a round cavity, is stopped. In the end particles almost touch, without
    overlap. Far from walls particles fill 0.57 of the volume with a coefficient of friction of 1, 0.60 with 0.3, and 0.64
    without friction.

    Parameters
    ----------
    seed
        Random seed of the insertion.
    at_rest
        Kinetic energy of a bed at rest, relative to the energy of a fall by the mean radius.

    Notes
    -----
    Random positions without overlap, found as for `Compacted`, then the discrete-element method (see `Dem`) with linear
    contacts until the kinetic energy is below at_rest sum(m R) g. `bulk_density` has the equation of the density.

    References
    ----------
    P. A. Cundall, O. D. L. Strack, Geotechnique 29 (1979) 47, doi:10.1680/geot.1979.29.1.47.

    Examples
    --------
    >>> import rattlebox as rb
    >>> damper = rb.ParticleDamper(
    ...     particles=rb.Particles(material="steel", diameter="5 mm", count=100),
    ...     cavity=rb.Box(size=("30 mm", "30 mm", "25 mm")),
    ...     contact=rb.Tsuji(restitution=0.8),
    ...     friction=0.2,
    ...     packing=rb.Settled(seed=1),
    ... )
    >>> print(f"the bed fills {rb.measure_bed(damper).bed_fill:.2f} of the box")
    the bed fills 0.58 of the box
    """

    kind: Literal["settled"] = "settled"

    @property
    def is_dense(self) -> bool:
        """False: particles are poured, and the bed has a free surface."""
        return False

    def check(self, cavity: AnyCavity, crowd: Crowd, *, settles: bool) -> None:
        """Raise if nothing pulls the particles down, or if they cannot be inserted at random."""
        if not settles:
            held = crowd.on_lattice(cavity)
            some = "" if held >= crowd.count else f" with at most {held} of them"
            dense = 'packing = { kind = "compacted" }, ' if crowd.count <= crowd.at_random(cavity) else ""
            raise Hint(
                "particles do not settle without gravity",
                f'{dense}packing = {{ kind = "lattice" }}{some}, or gravity = [0, 0, -9.81]',
                ["packing"],
            )
        super().check(cavity, crowd, settles=settles)

    def bulk_density(self, friction: float) -> float:
        """Return the volume of particles over that of their bed, far from walls, with a coefficient of friction.

        Notes
        -----
        0.571 + 0.072 exp(-friction / 0.25), fitted to computed beds.
        """
        return LOOSEST + 0.072 * math.exp(-friction / 0.25)


class Compacted(Bed):
    """Particles compacted at random without friction, then settled under gravity: a dense bed, like a tapped one.

    Particles far from walls fill 0.62 of the volume, near the largest value for random packings, 0.64. They are inserted at
    random under a lid at the height of such a bed, and pushed apart until none overlap; then the lid is removed, and the bed
    settles as a `Settled` one. A bed that is as large as the cavity fills all of it, without a free surface. Without gravity
    particles fill the whole cavity evenly, whatever their number.

    Parameters
    ----------
    seed
        Random seed of the insertion.
    at_rest
        Kinetic energy of a bed at rest, relative to the energy of a fall by the mean radius.

    Notes
    -----
    Overlaps d of particles with each other and with the walls are removed by minimising sum(d^2) from random positions, with
    the FIRE method.

    References
    ----------
    C. S. O'Hern, L. E. Silbert, A. J. Liu, S. R. Nagel, Physical Review E 68 (2003) 011306, doi:10.1103/PhysRevE.68.011306.

    E. Bitzek et al., Physical Review Letters 97 (2006) 170201, doi:10.1103/PhysRevLett.97.170201 (FIRE).
    """

    kind: Literal["compacted"] = "compacted"

    @property
    def is_dense(self) -> bool:
        """True."""
        return True


def _table(columns: int, unit: str, what: str) -> Any:
    def read(value: object) -> Any:
        if value is None:
            return None
        array = numbers(in_si(value, unit))
        array = np.atleast_2d(array) if columns > 1 else array
        if array.ndim != (2 if columns > 1 else 1) or (columns > 1 and array.shape[1] != columns):
            raise Hint(f"rows of {columns} numbers are needed" if columns > 1 else "a list of numbers is needed")
        return tuple(map(tuple, array.tolist())) if columns > 1 else tuple(array.tolist())

    schema = {"type": "array", "description": f"{what}, in {unit} or with units"}
    return SI(unit), BeforeValidator(read), WithJsonSchema(schema)


Row = tuple[float, float, float]


class Positions(FilePart, Packing):
    """Particles at given positions, species after species.

    Parameters
    ----------
    positions
        Centres, relative to the centre of the cavity, (n, 3) [m]. Contacts may overlap as deeply as the contact law makes
        them, as those at the end of a run do; their elastic energy is part of that of the start. Tangential springs start
        without stretch.
    radii
        Radii, (n,) [m], if the species have no size.
    velocities, spins
        Initial velocities [m/s] and angular velocities [rad/s], (n, 3); default 0.
    file
        CSV, NPY, NPZ or MAT file in place of the arrays, with columns x, y, z and optionally radius, vx, vy, vz, wx, wy, wz;
        without names, in this order.
    """

    file_fields: ClassVar[tuple[str, ...]] = ("positions", "radii", "velocities", "spins")
    kind: Literal["positions"] = "positions"
    positions: Annotated[tuple[Row, ...], *_table(3, "m", "centres")] = Field(examples=[[["0 mm", "0 mm", "5 mm"]]])
    radii: Annotated[tuple[float, ...] | None, *_table(1, "m", "radii")] = None
    velocities: Annotated[tuple[Row, ...] | None, *_table(3, "m/s", "velocities")] = None
    spins: Annotated[tuple[Row, ...] | None, *_table(3, "rad/s", "spins")] = None
    file: str | None = None

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, values: object) -> Any:
        if not isinstance(values, dict) or values.get("file") is None:
            return values
        twice = sorted(set(cls.file_fields) & set(values))
        if twice:
            raise Hint(f"{twice[0]} and file exclude each other", "one of them", [twice[0]])
        with at("file"):
            path = absolute(values["file"])
            return {**values, **_read_positions(path), "file": path}

    @model_validator(mode="after")
    def _as_many(self) -> Positions:
        if not self.positions:
            raise Hint("no positions are given", "one row x, y, z for each particle", [self.where])
        for name in ("radii", "velocities", "spins"):
            rows = getattr(self, name)
            if rows is not None and len(rows) != len(self.positions):
                positions = several(len(self.positions), "position")
                raise Hint(f"{several(len(rows), 'row')} of {name}, but {positions}", "as many of both", [name])
        if self.radii is not None and not min(self.radii) > 0:
            raise Hint("radii must be greater than zero", '"2 mm"', ["file" if self.file else "radii"])
        return self

    @property
    def where(self) -> str:
        """Field with the positions."""
        return "file" if self.file else "positions"

    @property
    def stated_count(self) -> int:
        """Number of positions."""
        return len(self.positions)

    @property
    def stated_radii(self) -> Vector | None:
        """The radii, if they are given."""
        return None if self.radii is None else np.array(self.radii)

    def place(self, cavity: AnyCavity, radii: Vector, *, settles: bool = True) -> Vector:
        """Return the positions; raise if spheres overlap by more than contacts do, or extend beyond the cavity."""
        positions = np.array(self.positions)
        with at("packing", self.where):
            check_packing(cavity, positions, radii, PRESSED)
        return positions

    def notes(self) -> Iterator[str]:
        """Yield the unit that is assumed for a file."""
        if self.file is not None:
            farthest = float(np.abs(self.positions).max())
            yield f"{Path(self.file).name} states no unit; m is assumed, with coordinates up to {farthest:.4g} m"

    def motion(self, count: int) -> tuple[Vector, Vector]:
        """Return the velocities and spins; 0 where they are not given."""
        velocity, spin = super().motion(count)
        return (
            velocity if self.velocities is None else np.array(self.velocities),
            spin if self.spins is None else np.array(self.spins),
        )

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Positions:
        """Read positions from a CSV, NPY, NPZ or MAT file.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        Positions
            The packing.

        Raises
        ------
        DataError
            If the file cannot be read; the message names the line or the columns.
        CaseError
            If its columns are no packing.
        """
        fields: dict[str, Any] = {"file": os.fspath(path)}
        return cls(**fields)


AnyPacking = Annotated[Packing, AnyKind()]

_COLUMNS = ("x", "y", "z", "radius", "vx", "vy", "vz", "wx", "wy", "wz")


def _read_positions(path: str) -> dict[str, Any]:
    """Return the fields of `Positions` from a file."""
    file = existing(path)
    columns = _from_arrays(file, read_arrays(file)) if file.suffix.lower() in BINARY else read_table(file, _COLUMNS)
    if not set("xyz") <= set(columns):
        if not all(name.isdecimal() for name in columns) or len(columns) not in (3, 4, 7, 10):
            there = ", ".join(columns) or "nothing"
            raise DataError(f"{file} has columns {there}; x, y and z are needed", "a first line x,y,z,radius")
        columns = dict(zip(_COLUMNS, columns.values(), strict=False))
    unknown = sorted(set(columns) - set(_COLUMNS))
    if unknown:
        raise DataError(f"{file} has a column {unknown[0]!r}", f"columns of {', '.join(_COLUMNS)}")
    if len({column.size for column in columns.values()}) > 1:
        sizes = ", ".join(f"{name} {column.size}" for name, column in columns.items())
        raise DataError(f"{file} has arrays of different lengths: {sizes}", "a number for each particle in each array")
    values: dict[str, Any] = {"positions": np.column_stack([columns[name] for name in "xyz"])}
    if "radius" in columns:
        values["radii"] = columns["radius"]
    for field, letter in (("velocities", "v"), ("spins", "w")):
        parts = [columns.get(letter + axis) for axis in "xyz"]
        if any(part is not None for part in parts):
            values[field] = np.column_stack([np.zeros_like(columns["x"]) if p is None else p for p in parts])
    return values


def _from_arrays(file: Path, arrays: dict[str, Vector]) -> dict[str, Vector]:
    if len(arrays) == 1:
        ((_, table),) = arrays.items()
        if table.ndim == 2:
            check_finite(table, str(file))
            return {str(k + 1): table[:, k] for k in range(table.shape[1])}
    for name, array in arrays.items():
        check_finite(array, f"{file}: {name}")
    return {name: array.ravel() for name, array in arrays.items()}


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


def _sites(cavity: AnyCavity, radii: Vector, settles: bool) -> tuple[Vector, float]:
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


def check_size(cavity: AnyCavity, radius: float) -> None:
    """Raise if a sphere is as large as the cavity or larger."""
    widest = cavity.widest * (1 + TOUCHING)  # A slot exactly as wide as the sphere may be narrower by rounding.
    if 2 * radius > widest or 4 / 3 * math.pi * radius**3 >= cavity.volume:
        large = "larger than" if 2 * radius > widest else "as large as"
        raise Hint(
            f"a particle of {2e3 * radius:.4g} mm is {large} the cavity, which is {1e3 * widest:.4g} mm wide",
            "smaller particles, or a larger cavity; check both and their units",
        )
    for axis, length in zip(AXES, cavity.period, strict=True):
        if 0 < length < NARROWEST * 2 * radius:
            least = 2e3 * NARROWEST * radius
            raise Hint(
                f"the box is {1e3 * length:.4g} mm wide along {axis}, in which it is periodic; a particle of "
                f"{2e3 * radius:.4g} mm needs at least {least:.4g} mm, since two of them could otherwise touch twice",
                f"a width of {1.01 * least:.4g} mm, or smaller particles; a slice of a wide bed has about ten diameters",
            )


def check_packing(cavity: AnyCavity, positions: Vector, radii: Vector, allowed: float = TOUCHING) -> None:
    """Raise if spheres overlap or extend beyond the cavity.

    `positions`: centres, (n, 3) [m]. `radii`: radii, (n,) [m].
    """
    room = cavity.room(positions, radii)
    # The centre of a particle is inside of periodic faces, too; the image of its other half is on the other side.
    period = cavity.period
    beyond = np.where(period > 0, np.abs(positions) - 0.5 * period * (1 + TOUCHING), -np.inf).max(axis=1)
    room = np.where(beyond > 0, np.minimum(room, -beyond), room)
    worst = int((room / radii).argmin())
    if room[worst] < -allowed * radii[worst]:
        place = ", ".join(f"{1e3 * x:.4g}" for x in positions[worst])
        far = float(np.abs(positions).max()) > _FAR * cavity.volume ** (1 / 3)
        raise Hint(
            f"particle {worst} at ({place}) mm sticks out of the cavity by {-1e3 * room[worst]:.4g} mm",
            "positions in metres, or with units" if far else _where_inside(cavity, positions, radii, worst),
        )
    first, second, apart = overlapping(positions, radii, period=period)
    if apart.size:
        smaller = np.minimum(radii[first], radii[second])
        k = int((apart / smaller).argmin())
        if apart[k] < -allowed * smaller[k]:
            one, other = sorted((int(first[k]), int(second[k])))
            raise Hint(
                f"particles {one} and {other} overlap by {-1e3 * apart[k]:.4g} mm",
                f"positions at least {1e3 * (radii[first[k]] + radii[second[k]]):.4g} mm apart, the sum of their radii",
            )


def _where_inside(cavity: AnyCavity, positions: Vector, radii: Vector, worst: int) -> str:
    """Return advice for a particle outside of a cavity: the shift that brings all inside, or the room for its centre."""
    middle = 0.5 * (positions.max(axis=0) + positions.min(axis=0))
    from_corner = bool((positions >= 0).all() and positions.any())
    if from_corner and cavity.room(positions - middle, radii).min() >= -TOUCHING * radii.min():
        shift = ", ".join(f"{1e3 * x:.4g}" for x in -middle)
        return f"positions relative to the centre of the cavity: with a shift by ({shift}) mm all are inside"
    return f"a distance of at least {1e3 * radii[worst]:.4g} mm between its centre and the walls, or a larger cavity"


def overlapping(
    positions: Vector, radii: Vector, within: float = 0.0, period: Vector | None = None
) -> tuple[NDArray[np.intp], NDArray[np.intp], Vector]:
    """Return the pairs of spheres that overlap.

    `positions`: centres, (n, 3) [m]. `radii`: radii, (n,) [m]. `within`: largest distance between the surfaces of a pair
    [m]. `period`: distances of the images of a particle along x, y and z, 0 for none, (3,) [m]. Returns indices of the
    pairs, (p,); and distance between the surfaces [m], negative for an overlap, (p,).
    """
    octave = np.log2(radii / radii.min()).astype(int)  # small spheres have a smaller search radius
    classes = [np.flatnonzero(octave == k) for k in np.unique(octave)]
    trees = [tree_of(positions[members], period) for members in classes]
    pairs = []
    for k, (members, tree) in enumerate(zip(classes, trees, strict=True)):
        for others, other in zip(classes[k:], trees[k:], strict=True):
            reach = float(radii[members].max() + radii[others].max()) + within
            near = tree.sparse_distance_matrix(other, reach, output_type="ndarray")
            i, j = members[near["i"]], others[near["j"]]
            apart = near["v"] - radii[i] - radii[j]
            mask = (apart < within) & ((i < j) if other is tree else True)
            pairs.append((i[mask], j[mask], apart[mask]))
    first, second, apart = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
    return first, second, apart


def tree_of(positions: Vector, period: Vector | None = None) -> cKDTree:
    """Return a search tree of points, and of their images if there is a period, (3,) [m]."""
    from scipy.spatial import cKDTree

    if period is None or not np.any(period):
        return cKDTree(positions)
    # SciPy expects coordinates from 0 to the period; an axis with the period 0 is not periodic.
    return cKDTree(wrapped(positions, period) + 0.5 * period, boxsize=period)
