"""Initial packings of particles: on a lattice with noise, settled under gravity, or at given positions."""

from __future__ import annotations

import math
import os
from abc import abstractmethod
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from rattlebox._util.exceptions import DataError

from .any_cavity import AnyCavity
from .base import FilePart, Part
from .crowds import (
    COMPACTED,
    LOOSEST,
    RANDOM_CLOSE_PACKING,
    Crowd,
    fewer_at_random,
    holds_at_random,
    lattice_is_full,
    sites_for,
)
from .elementwise import Vector
from .errors import Hint, at, several
from .files import BINARY, absolute, check_finite, existing, read_arrays
from .kinds import AnyKind
from .overlaps import check_packing
from .records import read_table
from .units import SI, Number, Whole, in_si, numbers

PRESSED = 0.1
"""Largest overlap of given positions over the smaller radius. Contacts at the end of a run overlap; `prepare` compares with
the overlaps of the contact law."""


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
        sites, cell = sites_for(cavity, radii, settles)
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
            raise Hint(
                f"rows of {columns} numbers are needed" if columns > 1 else "a list of numbers is needed",
                f"one row of {columns} for each particle" if columns > 1 else "one number for each particle",
            )
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
