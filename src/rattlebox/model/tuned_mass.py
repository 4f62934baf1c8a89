"""Tuned masses: a mass on a spring and a dashpot at a point of the structure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from .base import Part
from .elementwise import Vector, power
from .errors import Hint, at
from .modes import ModalModel
from .space import Direction, unit_vector
from .structures import Ratio
from .units import Length, PositiveFrequency, PositiveMass, Quantity, Velocity, in_si

if TYPE_CHECKING:
    from .structures import StructurePart

_NO_COUPLING = 1e-12
"""Damping between modes, relative to the largest damping, up to which it counts as rounding error."""


class TunedMass(Part):
    r"""Tuned mass damper: a mass on a spring and a dashpot at a point of the structure.

    It moves along the line of the point, or along `direction` at a point in 3-D; its inertia perpendicular to that direction
    is neglected. The run records its motion as that of a point with its name.

    Parameters
    ----------
    mass
        Mass [kg].
    frequency
        Natural frequency of the mass on its spring, with the structure fixed [Hz].
    damping_ratio
        Damping ratio, relative to that frequency.
    point
        Point of the structure; needed if there are several.
    direction
        Direction of the motion, if the point moves in 3-D.
    displacement, velocity
        Initial displacement and velocity relative to the base [m], [m/s]; default an undeformed spring and a mass at rest.
    name
        Name of its point in the results; default "tuned mass".

    Notes
    -----
    .. math:: m \ddot y + 2 \zeta \omega m (\dot y - \dot z) + \omega^2 m (y - z) = -m a

    with the displacements :math:`y` of the mass and :math:`z` of the point relative to the base, which accelerates with
    :math:`a`, and the angular frequency :math:`\omega` of the mass on its spring. Spring and dashpot act on the point with
    the opposite force. `den_hartog` and `warburton` have the equations and sources of optimal dampers.

    Examples
    --------
    >>> import rattlebox as rb
    >>> structure = rb.SDOF(mass="20 kg", stiffness="80 kN/m")
    >>> tuned = rb.TunedMass.den_hartog(structure, mass="1 kg")
    >>> round(tuned.frequency, 4), round(tuned.damping_ratio, 4)
    (9.5865, 0.1336)
    """

    field_names: ClassVar[tuple[str, ...]] = ("tuned_mass", "tuned_masses")
    kind: Literal["tuned_mass"] = "tuned_mass"
    mass: PositiveMass
    frequency: PositiveFrequency
    damping_ratio: Ratio = 0.0
    point: str | None = None
    direction: Direction | None = None
    displacement: Length | None = None
    velocity: Velocity = 0.0
    name: Annotated[str | None, Field(min_length=1)] = None

    def label(self, index: int, count: int) -> str:
        """Return the name of the point of the tuned mass."""
        return self.name or ("tuned mass" if count == 1 else f"tuned mass {index + 1}")

    @classmethod
    def among(cls, value: object) -> tuple[tuple[TunedMass, ...], list[Any]]:
        """Return the tuned masses in a list or alone, and what else is there; None is nothing."""
        several = [each for each in (value if isinstance(value, (list, tuple)) else [value]) if each is not None]
        tuned = tuple(each for each in several if isinstance(each, cls))
        return tuned, [each for each in several if not isinstance(each, cls)]

    @classmethod
    def den_hartog(cls, structure: StructurePart, mass: Quantity, *, mode: int = 1, **options: Any) -> TunedMass:
        """Return the tuned mass that minimises the largest response to a harmonic force on the structure.

        Parameters
        ----------
        structure
            The structure.
        mass
            Mass of the damper [kg].
        mode
            Number of the mode to be damped, counted from 1.
        **options
            Other arguments of the class: point, direction, name.

        Returns
        -------
        TunedMass
            The tuned mass.

        Raises
        ------
        CaseError
            If the point or mode does not exist, or the mode does not move the point.

        Notes
        -----
        f / f_s = 1 / (1 + mu) and zeta = sqrt(3 mu / (8 (1 + mu))), relative to the frequency f of the damper, with mu
        the ratio of its mass to the modal mass 1 / shape^2 at the point. Optimal for an undamped structure with one mode,
        whose largest displacement is then sqrt(1 + 2 / mu) times the static one.

        References
        ----------
        J. P. Den Hartog (1956), Mechanical Vibrations, 4th ed., McGraw-Hill, section 3.3; reprint ISBN 978-0-486-64785-2.
        """
        ratio, frequency = cls._of_mode(structure, mass, mode, options)
        damping = math.sqrt(3 * ratio / (8 * (1 + ratio)))
        return cls(mass=mass, frequency=frequency / (1 + ratio), damping_ratio=damping, **options)

    @classmethod
    def warburton(cls, structure: StructurePart, mass: Quantity, *, mode: int = 1, **options: Any) -> TunedMass:
        """Return the tuned mass that minimises the largest displacement under a harmonic acceleration of the base.

        Parameters
        ----------
        structure, mass, mode, **options
            As in `den_hartog`.

        Returns
        -------
        TunedMass
            The tuned mass.

        Raises
        ------
        CaseError
            If the point or mode does not exist, or the mode does not move the point.

        Notes
        -----
        f / f_s = sqrt(1 - mu / 2) / (1 + mu) and zeta = sqrt(3 mu / (8 (1 + mu) (1 - mu / 2))), for an undamped structure
        with one mode and mu < 2.

        References
        ----------
        G. B. Warburton (1982), Earthquake Eng. Struct. Dyn. 10, 381-401, doi:10.1002/eqe.4290100304.
        """
        ratio, frequency = cls._of_mode(structure, mass, mode, options)
        if ratio >= 2:
            raise Hint(
                f"mass is {ratio:.3g} times the modal mass at the point, but the optimum holds below twice",
                "a smaller mass",
                ["mass"],
            )
        tuning = math.sqrt(1 - ratio / 2) / (1 + ratio)
        damping = math.sqrt(3 * ratio / (8 * (1 + ratio) * (1 - ratio / 2)))
        return cls(mass=mass, frequency=frequency * tuning, damping_ratio=damping, **options)

    def with_content(self, mass: Any) -> TunedMass:
        """Return the tuned mass as a lighter box on the same spring and dashpot, for balls or particles of a mass in it.

        Together the box and its content, if this does not move in the box, are the tuned mass again. A damper with
        `point="tuned mass"` is in the box: a particle tuned mass damper.

        Parameters
        ----------
        mass
            Mass of the content [kg], below that of the tuned mass; `damper.mass` of an impact damper or
            `damper.contents.mass.sum()` of a particle damper.

        Returns
        -------
        TunedMass
            The empty box, whose frequency and damping ratio are those without content.

        Raises
        ------
        CaseError
            If the content is not lighter than the tuned mass.

        Examples
        --------
        >>> import rattlebox as rb
        >>> full = rb.TunedMass(mass="10 kg", frequency="2 Hz", damping_ratio=0.05)
        >>> box = full.with_content("7.5 kg")
        >>> box.mass, box.frequency, box.damping_ratio
        (2.5, 4.0, 0.1)
        """
        content = float(in_si(mass, "kg"))
        if not 0 <= content < self.mass:
            raise Hint(
                f"the content has a mass of {content:g} kg, but box and content together have {self.mass:g} kg",
                f"from 0 to less than {self.mass:g} kg; often 0.5 to 0.9 of it",
                ["mass"],
            )
        lighter = math.sqrt(self.mass / (self.mass - content))
        update = {"frequency": self.frequency * lighter, "damping_ratio": self.damping_ratio * lighter}
        return self.model_copy(update={"mass": self.mass - content, **update})

    @classmethod
    def _of_mode(
        cls, structure: StructurePart, mass: Quantity, mode: int, options: dict[str, Any]
    ) -> tuple[float, float]:
        """Return mass over modal mass, and the natural frequency [Hz]."""
        trial = cls(mass=mass, frequency=1.0, **options)
        modes = structure.modes()
        index = modes.elastic(mode)
        shape = float(modes.shape(trial.point, trial.direction)[index])
        if shape == 0:
            raise Hint(f"mode {mode} does not move the point", "another point or direction", ["point"])
        return trial.mass * shape**2, math.sqrt(modes.stiffness[index]) / (2 * math.pi)


def with_tuned_masses(modes: ModalModel, tuned: Sequence[TunedMass]) -> ModalModel:
    """Return the modes of a structure with tuned masses.

    The equations of the modes of the structure and of the tuned masses (see `TunedMass`), scaled to unit masses, are
    x'' + D x' + K x = f. The eigenvectors of K are the new, undamped modes; the transformed damping matrix is not diagonal
    (`Modal` names the source).
    """
    if not tuned:
        return modes
    if not modes.stiffness.shape[0]:
        raise Hint("a tuned mass needs a structure that moves", "SDOF, Modal or Matrices", ["tuned_masses", 0])
    coordinates = _Coordinates.of(modes, tuned)
    names, springs = _springs(modes, tuned, coordinates)
    values, damping, vectors = _eigenmodes(*_matrices(modes, tuned, springs, coordinates))

    def into_modes(first: object, more: Sequence[object], spatial: bool = False) -> Vector:
        """Return a vector in the coordinates as one in the new modes."""
        vector = coordinates.joined(first, more, 2 if spatial else 1)
        return np.asarray(np.einsum("cm...,cd...->md..." if spatial else "cm...,c...->m...", vectors, vector))

    # Points, participation, displacements and velocities go into the new modes by the same rotation.
    roots, count = coordinates.roots, len(tuned)
    shapes = {
        name: into_modes(shape, [np.zeros(3) if name in modes.spatial else 0.0] * count, name in modes.spatial)
        for name, shape in modes.shapes.items()
    }
    for index, name in enumerate(names):
        own = [1 / root if k == index else 0.0 for k, root in enumerate(roots)]
        shapes[name] = into_modes(np.zeros(modes.stiffness.shape[0]), own)
    places = [
        root * (_initial_displacement(modes, part) if part.displacement is None else part.displacement)
        for part, root in zip(tuned, roots, strict=True)
    ]
    speeds = [root * part.velocity for part, root in zip(tuned, roots, strict=True)]
    inertia = [  # m^1/2, or m^1/2 d of a mass that moves along d
        root if part.direction is None else np.multiply.outer(unit_vector(part.direction), root)
        for part, root in zip(tuned, roots, strict=True)
    ]
    total_mass, participation = modes.total_mass, modes.participation
    if total_mass is not None:
        for one in inertia:
            total_mass = total_mass + (np.einsum("a...,b...->ab...", one, one) if modes.spatial else one * one)
    if participation is not None:
        participation = into_modes(participation, inertia, bool(modes.spatial))
    # The dampers couple the modes unless the damping happens to be proportional; rounding is no coupling.
    main = np.stack([damping[k, k] for k in range(len(damping))])
    coupling = damping - _diagonal(main)
    is_coupled = bool(np.any(np.abs(coupling) > _NO_COUPLING * np.abs(main).max(initial=0.0)))
    return ModalModel(
        decay=np.maximum(main, 0.0) / 2,
        stiffness=values,
        shapes=shapes,
        participation=participation,
        q0=into_modes(modes.q0, places),
        p0=into_modes(modes.p0, speeds),
        spatial=modes.spatial,
        coupling=coupling if is_coupled else None,
        attached=modes.attached | frozenset(names),
        total_mass=total_mass,
    )


@dataclass(frozen=True)
class _Coordinates:
    """Coordinates in which the mass matrix is the identity.

    They are those of the modes of the structure, and the displacement of each tuned mass times the root of its mass.
    Numbers may be arrays over a grid, whose axes follow those of vectors and matrices.
    """

    roots: list[Any]
    grid_axes: int

    @classmethod
    def of(cls, modes: ModalModel, tuned: Sequence[TunedMass]) -> _Coordinates:
        numbers = [
            number for part in tuned for number in (part.mass, part.frequency, part.damping_ratio, part.velocity)
        ]
        numbers += [part.displacement for part in tuned if part.displacement is not None]
        vectors = (modes.decay, modes.stiffness, modes.q0, modes.p0)
        axes = max(*(np.ndim(number) for number in numbers), *(vector.ndim - 1 for vector in vectors))
        return cls([power(part.mass, 0.5) for part in tuned], axes)

    def lifted(self, value: object, components: int) -> Vector:
        """Return an array of components with all axes of the grid."""
        array = np.asarray(value, dtype=float)
        return array.reshape((*array.shape, *(1,) * (components + self.grid_axes - array.ndim)))

    def joined(self, first: object, more: Sequence[object], components: int = 1) -> Vector:
        """Return a vector over the structure's modes and the tuned masses."""
        parts = [*self.lifted(first, components), *(self.lifted(one, components - 1) for one in more)]
        return np.stack(np.broadcast_arrays(*parts))


def _springs(
    modes: ModalModel, tuned: Sequence[TunedMass], coordinates: _Coordinates
) -> tuple[list[str], list[Vector]]:
    """Return the names of the masses, and the stretch of each spring per coordinate."""
    names: list[str] = []
    springs = []
    for index, part in enumerate(tuned):
        with at("tuned_masses", index):
            try:
                shape = modes.shape(part.point, part.direction)
            except Hint as hint:
                raise Hint(hint.complaint, hint.suggestion, hint.place or ["point"]) from None
            name = part.label(index, len(tuned))
            if name in modes.shapes or name in names:
                raise Hint(f"the point {name!r} already exists", 'name = "another name"', ["name"])
        names.append(name)
        # A spring stretches by the shape at its point minus the displacement of its mass.
        own = [-1 / root if k == index else 0.0 for k, root in enumerate(coordinates.roots)]
        springs.append(coordinates.joined(shape, own))
    return names, springs


def _matrices(
    modes: ModalModel, tuned: Sequence[TunedMass], springs: Sequence[Vector], coordinates: _Coordinates
) -> tuple[Vector, Vector]:
    """Return the stiffness and damping matrices."""
    nothing = (0.0,) * len(tuned)
    stiffness = _diagonal(coordinates.joined(modes.stiffness, nothing))
    damping = _diagonal(coordinates.joined(2 * modes.decay, nothing))
    if modes.coupling is not None:
        count = modes.stiffness.shape[0]
        damping[:count, :count] += coordinates.lifted(modes.coupling, 2)
    # Each spring and each damper adds a matrix of rank one to those of the structure.
    for part, spring in zip(tuned, springs, strict=True):
        rate = 2 * math.pi * part.frequency
        outer = spring[:, None] * spring[None, :]
        stiffness = stiffness + part.mass * rate * rate * outer
        damping = damping + 2 * part.damping_ratio * part.mass * rate * outer
    return stiffness, damping


def _eigenmodes(stiffness: Vector, damping: Vector) -> tuple[Vector, Vector, Vector]:
    """Return the squared frequencies, the damping matrix in the modes, and the modes (coordinate, mode, ...)."""
    # The eigenvectors of a symmetric matrix are orthonormal: the new modes are mass-normalised as well. A rigid-body mode
    # has an eigenvalue of rounding, whose root would be a frequency.
    values, vectors = np.linalg.eigh(_last(stiffness))
    # The sign of an eigenvector is arbitrary. Over a grid it is that of the first variant, so that shapes are smooth there.
    first = vectors[(0,) * (vectors.ndim - 2)]
    vectors = np.where(np.sum(vectors * first, axis=-2, keepdims=True) < 0, -vectors, vectors)
    largest = np.abs(values).max(axis=-1, keepdims=True)
    values = np.moveaxis(np.where(np.abs(values) < 1e-12 * largest, 0.0, values), -1, 0)
    in_modes = np.moveaxis(np.swapaxes(vectors, -1, -2) @ _last(damping) @ vectors, (-2, -1), (0, 1))
    return values, in_modes, np.moveaxis(vectors, (-2, -1), (0, 1))


def _diagonal(vector: Vector) -> Vector:
    """Return a diagonal matrix (n, n, ...) of a vector (n, ...)."""
    matrix = np.zeros((len(vector), *vector.shape))
    for k, value in enumerate(vector):
        matrix[k, k] = value
    return matrix


def _initial_displacement(modes: ModalModel, part: TunedMass) -> Any:
    """Return the initial displacement of the point of a tuned mass."""
    shape = modes.shape(part.point, part.direction)
    return sum(one * q for one, q in zip(shape, modes.q0, strict=True))


def _last(matrix: Vector) -> Vector:
    """Return a matrix (n, n, ...) as (..., n, n)."""
    return np.moveaxis(matrix, (0, 1), (-2, -1))
