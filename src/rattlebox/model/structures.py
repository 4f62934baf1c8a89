"""Structures: single degree of freedom, modes, a fixed cavity, a shaker, and their base classes."""

from __future__ import annotations

import math
import operator
import os
from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import (
    BeforeValidator,
    Field,
    PrivateAttr,
    WithJsonSchema,
    field_validator,
    model_validator,
)

from rattlebox._util.frozen import complete
from rattlebox._util.narrow import present
from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import amount

from .also_accepts import AlsoAccepts
from .any_signal import AnySignal
from .base import FilePart, Part
from .elementwise import Vector, power, stacked
from .errors import Hint, at, one_of, several
from .files import absolute
from .modal_files import fields_of_modes
from .modes import ModalModel
from .signals import Signal, Unit, signals_in
from .units import (
    LARGEST,
    SI,
    Damping,
    Frequency,
    Length,
    Number,
    PositiveFrequency,
    PositiveMass,
    Stiffness,
    Velocity,
    in_si,
    numbers,
)

if TYPE_CHECKING:
    from typing import Self


def _numbers(value: object) -> Any:
    return _of_shape(numbers(value), 1, "a list of numbers")


def _matrix(value: object) -> Any:
    return _of_shape(numbers(value), 2, "a list of rows of numbers")


def _of_shape(array: Vector, dimensions: int, wanted: str) -> Any:
    if array.ndim != dimensions:
        raise Hint(f"{wanted} is needed", "[[1.0, 0.5], [0.5, -1.0]]" if dimensions == 2 else "[1.0, 0.5]")
    return array.tolist()


def _shape(value: object) -> Any:
    array = numbers(value)
    if array.ndim == 2 and array.shape[1] == 3:
        return array.tolist()
    return _of_shape(array, 1, "a list of numbers, one for each mode, or of three for each mode,")


def _participation(value: object) -> Any:
    return _shape(in_si(value, "kg^0.5"))


def _weights(value: object) -> Any:
    array = numbers(value)
    if array.ndim == 2 and len(array) == 3:
        return array.tolist()
    return _of_shape(array, 1, "a list of numbers, or three of them, along x, y and z,")


def _point(value: Any) -> Any:
    if isinstance(value, (list, tuple, np.ndarray)):
        return _weights(value)
    try:
        return operator.index(value)
    except TypeError:
        raise Hint(
            "the index of a degree of freedom, from 0, or a list of weights is needed", "points = { tip = 0 }"
        ) from None


Numbers = Annotated[list[float], BeforeValidator(_numbers)]
Matrix = Annotated[list[list[float]], BeforeValidator(_matrix)]
Shape = Annotated[list[float] | list[list[float]], BeforeValidator(_shape)]
Participation = Annotated[list[float] | list[list[float]], BeforeValidator(_participation)]
Weights = Annotated[list[float] | list[list[float]], BeforeValidator(_weights)]
Point = Annotated[int | list[float] | list[list[float]], BeforeValidator(_point)]
_ratio_schema = WithJsonSchema({"type": "number", "minimum": 0, "description": "damping ratio"})
Ratio = Annotated[Number, Field(ge=0, le=LARGEST), _ratio_schema]


class StructurePart(Part):
    """Base class of structures."""

    field_names: ClassVar[tuple[str, ...]] = ("structure",)
    responds: ClassVar[bool] = True
    """Whether forces of the dampers move the structure."""
    is_truncated: ClassVar[bool] = True
    """Whether the structure may have more modes than are computed."""
    kinds: ClassVar[dict[str, type[Part]]] = {}
    kind: str

    @abstractmethod
    def modes(self) -> ModalModel:
        """Return the modes."""

    def started(self, displacement: Vector, velocity: Vector) -> StructurePart:
        """Return the structure with these initial modal displacements and velocities, (m,) [kg^1/2 m], [kg^1/2 m/s]."""
        return Modal.of(self.modes(), displacement=displacement, velocity=velocity) if displacement.size else self

    def words(self) -> str:
        """Return a phrase about the structure with its first natural frequency."""
        return self._with_first_mode(f"a structure of {counted(len(self.modes().stiffness), 'mode')}")

    @property
    def natural_frequencies(self) -> tuple[float, ...]:
        """Natural frequencies, without rigid-body modes [Hz]."""
        stiffness = np.asarray(self.modes().stiffness)
        return tuple((np.sqrt(stiffness[stiffness > 0]) / (2 * math.pi)).tolist())

    def _with_first_mode(self, words: str) -> str:
        """Return a phrase with the first natural frequency, if there is one."""
        frequencies = self.natural_frequencies
        return f"{words}, first mode at {amount(frequencies[0], 'Hz')}" if frequencies else words

    def notes(self) -> Iterator[str]:
        """Return notes on assumptions, such as the units of files."""
        return iter(())

    def base_notes(self) -> Iterator[str]:
        """Return notes on the response to a motion of the base."""
        return iter(())

    def warnings(self) -> Iterator[str]:
        """Return warnings about exceeded limits of the theory."""
        return iter(())


class SDOF(StructurePart):
    r"""Single degree of freedom with the point "mass".

    Parameters
    ----------
    mass
        M [kg].
    stiffness, frequency
        K [N/m], 0 for a free body; or the undamped natural frequency :math:`\sqrt{K/M} / (2\pi)` [Hz].
    damping, damping_ratio
        C [N s/m] or :math:`C / (2 \sqrt{K M})`, which may exceed 1; default undamped.
    displacement, velocity
        Initial displacement and velocity relative to the base [m], [m/s].

    Notes
    -----
    .. math:: M \ddot z + C \dot z + K z = F - M a

    with the displacement :math:`z` relative to the base, which accelerates with :math:`a`.

    Examples
    --------
    >>> import rattlebox as rb
    >>> rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping_ratio=0.01).modes().decay.round(4)
    array([0.6325])
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (
        ("stiffness", "frequency"),
        ("damping", "damping_ratio"),
    )
    is_truncated: ClassVar[bool] = False
    kind: Literal["sdof"] = "sdof"
    mass: PositiveMass
    stiffness: Stiffness | None = None
    frequency: PositiveFrequency | None = None
    damping: Damping | None = None
    damping_ratio: Ratio | None = None
    displacement: Length = 0.0
    velocity: Velocity = 0.0

    @model_validator(mode="after")
    def _one_of_each(self) -> Self:
        one_of('stiffness = "80 kN/m"', stiffness=self.stiffness, frequency=self.frequency)
        if self.damping is not None and self.damping_ratio is not None:
            raise Hint("damping and damping_ratio exclude each other", "give one of them")
        if self.damping_ratio and self.stiffness == 0:
            raise Hint("a damping ratio has no meaning without stiffness", 'damping = "5 N s/m"')
        return self

    def started(self, displacement: Vector, velocity: Vector) -> SDOF:
        """Return the oscillator with this initial displacement and velocity; see `StructurePart.started`."""
        root = math.sqrt(self.mass)
        return self.model_copy(
            update={"displacement": float(displacement[0]) / root, "velocity": float(velocity[0]) / root}
        )

    def words(self) -> str:
        """Return a phrase with mass and natural frequency."""
        mass, frequencies = amount(self.mass, "kg"), self.natural_frequencies
        return f"an oscillator of {mass} at {amount(frequencies[0], 'Hz')}" if frequencies else f"a free mass of {mass}"

    def modes(self) -> ModalModel:
        """Return the only mode, with the decay rate C / (2 M), the stiffness K / M and the shape M^(-1/2)."""
        by_frequency = self.stiffness is None
        stiffness = (
            power(2 * math.pi * present(self.frequency), 2) if by_frequency else present(self.stiffness) / self.mass
        )
        if self.damping_ratio is not None:
            decay = self.damping_ratio * power(stiffness, 0.5)
        else:
            decay = (0.0 if self.damping is None else self.damping) / (2 * self.mass)
        root = power(self.mass, 0.5)
        return ModalModel(
            decay=stacked([decay]),
            stiffness=stacked([stiffness]),
            shapes={"mass": stacked([1 / root])},
            participation=stacked([root]),
            q0=stacked([self.displacement * root]),
            p0=stacked([self.velocity * root]),
            total_mass=self.mass,
        )


class DampedModes(StructurePart):
    r"""Damping of structures whose modes are computed.

    Parameters
    ----------
    damping_ratio
        Damping ratio of all modes, or a list with one for each mode; default undamped. Rigid-body modes have no damping.
    rayleigh
        Coefficients alpha [1/s] and beta [s] of Rayleigh damping.

    Notes
    -----
    Rayleigh damping is :math:`C = \alpha M + \beta K`; the damping ratio at the angular frequency :math:`\omega` is

    .. math:: \zeta = \frac{\alpha}{2 \omega} + \frac{\beta \omega}{2}

    References
    ----------
    A. K. Chopra (2017): Dynamics of Structures, 5th edition, Pearson, section 11.4, ISBN 978-0-13-455512-6.
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("damping_ratio", "rayleigh"),)
    damping_ratio: Ratio | list[Ratio] | None = None
    rayleigh: tuple[Ratio, Ratio] | None = Field(default=None, examples=[[0.1, 1e-4]])

    @model_validator(mode="after")
    def _one_kind_of_damping(self) -> Self:
        given = [name for name in ("C", "damping_ratio", "rayleigh") if getattr(self, name, None) is not None]
        if len(given) > 1:
            raise Hint(f"{' and '.join(given)} exclude each other: each states the damping", "one of them", [given[-1]])
        return self

    def decay_rates(self, stiffness: Vector) -> Vector:
        """Return the decay rate of each mode [1/s]: damping ratio times natural angular frequency.

        `stiffness`: squared natural angular frequencies [1/s^2], (m,). Raises Hint if the number of damping ratios differs
        from the number of modes.
        """
        if self.rayleigh is not None:
            return np.asarray((self.rayleigh[0] + self.rayleigh[1] * stiffness) / 2)
        if isinstance(self.damping_ratio, list) and len(self.damping_ratio) != stiffness.size:
            raise Hint(
                f"{several(len(self.damping_ratio), 'number')}, but {several(stiffness.size, 'mode')}",
                "one number for all modes, or one for each",
                ["damping_ratio"],
            )
        return np.asarray(np.array(self.damping_ratio or 0.0) * np.sqrt(stiffness))


def check_damping(matrix: Vector, count: int) -> None:
    """Raise if a modal damping matrix is invalid."""
    place = ["damping_matrix"]
    if matrix.shape != (count, count):
        raise Hint(
            f"the matrix has shape {matrix.shape}, but there are {several(count, 'mode')}",
            "a square matrix with a row for each mode",
            place,
        )
    if not np.allclose(matrix, matrix.T, rtol=1e-12, atol=1e-12 * np.abs(matrix).max()):
        raise Hint("the matrix is not symmetric", "D = (D + D^T) / 2, if the difference is rounding", place)
    if np.linalg.eigvalsh(matrix).min() < -1e-9 * np.abs(matrix).max():
        raise Hint(
            "the matrix is not positive semidefinite: a motion would gain energy",
            "a matrix whose eigenvalues are not negative",
            place,
        )


def _one_each(value: object) -> Any:
    if isinstance(value, (int, float, str)) and not isinstance(value, bool):
        one = f'"{value}"' if isinstance(value, str) else f"{value}"
        raise Hint("a list is needed, with one number for each mode", f"[{one}] for one mode, [{one}, {one}] for two")
    return value


class Modal(FilePart, StructurePart):
    r"""Structure defined by its modes, in the case or in a file.

    Parameters
    ----------
    frequencies
        Undamped natural frequencies [Hz]; 0 is a rigid-body mode.
    damping_ratios, damping_ratio, damping_matrix
        One ratio for each mode, one for all, or the modal damping matrix D of q'' + D q' + w^2 q = f [1/s], whose diagonal
        is 2 w times the ratios; one of them.
    shapes
        Mass-normalised mode shapes at named points, one number for each mode [kg^-1/2]; or three, along x, y and z, for a
        point in 3-D.
    participation
        Inertia of each mode per unit of base acceleration [kg^1/2], needed for base motion; three numbers for each mode if
        points move in 3-D. Text has its unit: a model in mm, t and N has "-0.07 t^0.5".
    total_mass
        Mass of the structure that follows the base if it does not vibrate [kg]; three numbers, for x, y and z, if points
        move in 3-D. With it the force on the base contains the inertia of truncated modes.
    displacement, velocity
        Initial modal displacements and velocities [kg^1/2 m], [kg^1/2 m/s]; default 0.
    file
        File with frequencies, shapes and possibly more: a table of modes (.csv, .toml), a universal file (.uff, .unv), a
        result (.rst) or the matrices (.full) of Ansys.
    points
        Points of the file by their new names: `{"tip": 21}` for node 21 in 3-D, or `{"tip": "21 z"}` for its motion along z;
        default all points, if there are few.
    mode_count
        Number of modes, the first ones of the file; the number of computed modes of a .full file, default 10.
    mode_numbers
        Numbers of the modes of the file that are used, from 1 on; default all. Of a modal test, those with real shapes.
    mass_unit
        Unit of mass of the file, "kg", "t" or "g", if the file does not state it; another one than it states is refused.
    modal_masses
        Modal mass of each mode of the file [kg], if the file does not state them; "1 kg" for mass-normalised shapes.

    Notes
    -----
    .. math:: \ddot q + D \dot q + \omega^2 q = \phi^T F - p\, a, \qquad p = \phi^T M r

    with the modal displacements :math:`q`, the angular frequencies :math:`\omega`, the shapes :math:`\phi`, the
    participation :math:`p` and the acceleration :math:`a` of the base, along which a rigid structure moves by :math:`r`. A
    point moves by :math:`\phi q`. The modes are those of the undamped structure; :math:`D` is diagonal,
    :math:`2 \zeta \omega`, unless it is given as a matrix. Modes that are left out add their inertia to the force on the
    base, :math:`(m - p^T p)\, a`, if the total mass :math:`m = r^T M r` is known.

    References
    ----------
    T. K. Caughey, M. E. J. O'Kelly, J. Appl. Mech. 32 (1965) 583, doi:10.1115/1.3627262 (modes that damping does not
    couple).

    A. K. Chopra (2017): Dynamics of Structures, 5th edition, Pearson, chapters 12 and 13, ISBN 978-0-13-455512-6.

    Examples
    --------
    Two modes that move the tip, with shapes per square root of mass:

    >>> import rattlebox as rb
    >>> bar = rb.Modal(frequencies=["30 Hz", "180 Hz"], damping_ratio="1 %", shapes={"tip": [0.4, -0.7]})
    >>> [round(frequency) for frequency in bar.natural_frequencies]
    [30, 180]
    """

    file_fields: ClassVar[tuple[str, ...]] = ("frequencies", "damping_ratios", "shapes", "participation")
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (
        ("damping_ratios", "damping_ratio"),
        ("damping_ratios", "damping_matrix"),
        ("damping_ratio", "damping_matrix"),
    )
    kind: Literal["modal"] = "modal"
    frequencies: list[Frequency] = Field(examples=[["10 Hz", "62 Hz"]])
    damping_ratios: Annotated[list[Ratio] | None, BeforeValidator(_one_each)] = Field(
        default=None, examples=[[0.01, 0.01]]
    )
    damping_ratio: Ratio | None = None
    damping_matrix: Annotated[Matrix | None, SI("1/s")] = None
    shapes: Annotated[dict[str, Shape], SI("kg^-0.5")] = Field(examples=[{"tip": [0.7, -0.7]}])
    participation: Annotated[Participation | None, SI("kg^0.5")] = None
    total_mass: PositiveMass | Annotated[list[PositiveMass], Field(min_length=3, max_length=3)] | None = None
    displacement: Annotated[Numbers | None, SI("kg^0.5 m")] = None
    velocity: Annotated[Numbers | None, SI("kg^0.5 m/s")] = None
    file: str | None = None
    points: dict[str, int | str] | None = Field(default=None, examples=[{"tip": "21 z"}])
    mode_count: Annotated[int, Field(ge=1)] | None = None
    mode_numbers: Annotated[list[Annotated[int, Field(ge=1)]], Field(min_length=1)] | None = None
    mass_unit: Literal["kg", "g", "t"] | None = None
    modal_masses: list[PositiveMass] | None = None

    @classmethod
    def of(cls, model: ModalModel, **options: Any) -> Modal:
        """Return the structure with the modes of another one.

        Parameters
        ----------
        model
            Modes, from `modes()` of a structure.
        **options
            displacement and velocity in place of those of the model.

        Returns
        -------
        Modal
            The structure.

        Raises
        ------
        CaseError
            If the options and the modes differ in length.
        """
        rigid = model.stiffness <= 0
        matrix = np.diag(2 * model.decay) + (0.0 if model.coupling is None else model.coupling)
        plain = model.coupling is None and not np.any(model.decay[rigid])
        omega = np.sqrt(model.stiffness)
        own: dict[str, Any] = {"damping_matrix": matrix.tolist()}
        if plain:
            own = {"damping_ratios": np.divide(model.decay, omega, out=np.zeros_like(omega), where=~rigid).tolist()}
        return cls(
            **{
                "frequencies": (omega / (2 * math.pi)).tolist(),
                **own,
                "shapes": {name: shape.tolist() for name, shape in model.shapes.items()},
                "participation": None if model.participation is None else model.participation.tolist(),
                "total_mass": _diagonal(model.total_mass),
                "displacement": model.q0.tolist(),
                "velocity": model.p0.tolist(),
                **{name: np.asarray(value).tolist() for name, value in options.items()},
            }
        )

    _notes: tuple[str, ...] = PrivateAttr(default=())
    _read: tuple[str, ...] = PrivateAttr(default=())

    @model_validator(mode="wrap")
    @classmethod
    def _from_file(cls, values: object, handler: Any) -> Self:
        if not isinstance(values, dict) or values.get("file") is None:
            for name in ("points", "mode_count", "mode_numbers", "mass_unit", "modal_masses"):
                if isinstance(values, dict) and values.get(name) is not None:
                    raise Hint(f"{name} are those of a file", 'file = "modes.csv"', [name])
            made: Self = handler(values)
            return made
        for name in ("frequencies", "shapes"):
            if values.get(name) is not None:
                raise Hint(f"give {name} or a file, not both", "leave one out", [name])
        with at("file"):
            path = absolute(values["file"])
        fields, notes = fields_of_modes(values, path)
        made = handler({**values, **fields, "file": path})
        complete(made, _notes=tuple(notes), _read=tuple(fields))
        return made

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], **options: Any) -> Modal:
        """Read modes from a file.

        Parameters
        ----------
        path
            A table of modes (.csv, .toml), a universal file (.uff, .unv), a result (.rst) or matrices (.full) of Ansys.
        **options
            points, mode_count, mode_numbers (or modes), damping_ratio, mass_unit, modal_masses, participation.

        Returns
        -------
        Modal
            The structure.

        Raises
        ------
        DataError
            If the file cannot be read.
        MissingDependency
            If the library that reads it is not installed; the message names the extra, `uff` or `fe`.
        """
        if "modes" in options:  # the name of a method, so that no field can have it
            options.setdefault("mode_numbers", options.pop("modes"))
        return cls(**{"file": os.fspath(path), **options})

    def notes(self) -> Iterator[str]:
        """Return notes on the assumed units of the file."""
        return iter(self._notes)

    def base_notes(self) -> Iterator[str]:
        """Yield the share of the modes in the total mass."""
        if self.total_mass is not None and self.participation is not None:
            shares = " and ".join(f"{round(100 * share, 6):.3g} %" for share in np.atleast_1d(self._effective_share()))
            yield f"the effective masses of the modes are {shares} of the total mass"

    def _effective_share(self) -> Vector:
        """Return the sum of the effective masses over the total mass; one for each axis of a model in 3-D."""
        return np.asarray(np.sum(np.square(np.array(self.participation)), axis=0) / np.array(self.total_mass))

    def fields_from_file(self) -> tuple[str, ...]:
        """Return the fields that were read from the file."""
        return self._read

    @model_validator(mode="after")
    def _same_lengths(self) -> Self:
        count = len(self.frequencies)
        if count == 0:
            raise Hint("at least one mode is needed", 'kind = "fixed" for a cavity that does not move', ["frequencies"])
        rows: dict[str, Any] = {"damping_ratios": self.damping_ratios, "participation": self.participation}
        rows |= {"displacement": self.displacement, "velocity": self.velocity}
        rows |= {f"shapes.{name}": row for name, row in self.shapes.items()}
        for name, row in rows.items():
            if row is not None and len(row) != count:
                modes = "there is 1 frequency" if count == 1 else f"there are {count} frequencies"
                raise Hint(
                    f"{several(len(row), 'number')}, but {modes}",
                    "one number for each mode",
                    name.split(".", 1),
                )
        kinds = ("damping_ratios", "damping_ratio", "damping_matrix")
        given = [name for name in kinds if getattr(self, name) is not None]
        if len(given) != 1:
            both = f"{' and '.join(given)} exclude each other" if given else "damping is needed"
            raise Hint(both, "damping_ratios = [0.01, 0.01], 0 for no damping", ["damping_ratios"])
        if self.damping_matrix is not None:
            check_damping(np.array(self.damping_matrix), count)
        if not self.shapes:
            raise Hint("at least one named point is needed", "shapes = { tip = [...] }", ["shapes"])
        if self.participation is not None and isinstance(self.participation[0], list) != bool(self._spatial()):
            raise Hint(
                "participation has three numbers for each mode if points move in 3-D, else one",
                "a list of three for each mode" if self._spatial() else "one number for each mode",
                ["participation"],
            )
        self._check_total_mass()
        return self

    def _check_total_mass(self) -> None:
        """Raise if the effective masses of the modes exceed the total mass, or directions do not match."""
        if self.total_mass is None:
            return
        if isinstance(self.total_mass, list) != bool(self._spatial()):
            raise Hint(
                "total_mass is three numbers if points move in 3-D, else one",
                "[m, m, m] with the mass m" if self._spatial() else "one mass",
                ["total_mass"],
            )
        if self.participation is not None:
            effective = np.sum(np.square(self.participation), axis=0)
            if np.any(self._effective_share() > 1 + 1e-3):
                raise Hint(
                    f"the squares of the participation, the effective masses, add up to {effective.max():.4g} kg,"
                    f" more than the total mass of {np.max(self.total_mass):.4g} kg",
                    "participation of mass-normalised modes, in kg^1/2",
                    ["total_mass"],
                )

    def _decay(self, omega: list[Any]) -> Vector:
        if self.damping_matrix is not None:
            return np.diag(np.array(self.damping_matrix)) / 2
        ratios = self.damping_ratios or [present(self.damping_ratio)] * len(omega)
        return stacked([ratio * w for ratio, w in zip(ratios, omega, strict=True)])

    def _coupling(self) -> Vector | None:
        if self.damping_matrix is None:
            return None
        matrix = np.array(self.damping_matrix)
        coupling = matrix - np.diag(np.diag(matrix))
        return coupling if coupling.any() else None

    def _spatial(self) -> frozenset[str]:
        """Return the points that move in 3-D."""
        return frozenset(name for name, row in self.shapes.items() if isinstance(row[0], list))

    def modes(self) -> ModalModel:
        """Return the modes."""
        omega = [2 * math.pi * frequency for frequency in self.frequencies]
        zero = [0.0] * len(omega)
        return ModalModel(
            decay=self._decay(omega),
            coupling=self._coupling(),
            stiffness=stacked([w * w for w in omega]),
            shapes={name: stacked(row) for name, row in self.shapes.items()},
            participation=None if self.participation is None else stacked(self.participation),
            q0=stacked(zero if self.displacement is None else self.displacement),
            p0=stacked(zero if self.velocity is None else self.velocity),
            spatial=self._spatial(),
            total_mass=self._total_mass(),
        )

    def _total_mass(self) -> Any:
        """Return the total mass [kg], as a matrix if points move in 3-D; None if it is unknown."""
        if self.total_mass is None:
            return None
        return np.diag(self.total_mass) if isinstance(self.total_mass, list) else self.total_mass


def _diagonal(total_mass: Any) -> Any:
    """Return a total mass as a number, or as three numbers if the directions do not couple; None otherwise."""
    if total_mass is None or np.ndim(total_mass) == 0:
        return None if total_mass is None else float(total_mass)
    own = np.diag(total_mass)
    coupled = np.abs(total_mass - np.diag(own)).max() > 1e-6 * own.max()
    return None if coupled or not (own > 0).all() else own.tolist()


def _still() -> ModalModel:
    none = np.zeros(0)
    return ModalModel(none, none, {"cavity": none}, none, none, none)


class Fixed(StructurePart):
    """A cavity that does not move. Its only point is called "cavity"."""

    responds: ClassVar[bool] = False
    kind: Literal["fixed"] = "fixed"

    def words(self) -> str:
        """Return a phrase."""
        return "a fixed cavity"

    def modes(self) -> ModalModel:
        """Return no modes at all."""
        return _still()


class Shaker(StructurePart):
    r"""A cavity that moves as prescribed. Its only point is called "cavity"; it is the base.

    Parameters
    ----------
    motion
        One signal or several: a Harmonic displacement [m], or accelerations [m/s^2].

    Notes
    -----
    The acceleration of the cavity is the sum of the signals; a displacement :math:`A \sin(\omega t + \varphi)` is the
    acceleration :math:`-A \omega^2 \sin(\omega t + \varphi)`.

    Examples
    --------
    >>> import rattlebox as rb
    >>> ball = rb.ImpactDamper(
    ...     ball=rb.Sphere(diameter="20 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ... )
    >>> shaker = rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz"))
    >>> run = rb.simulate(rb.Case(structure=shaker, damper=ball, duration="1 s"))
    >>> print(f"the cavity moves at up to {1e3 * abs(run.motion.base_velocity).max().item():.1f} mm/s")
    the cavity moves at up to 62.8 mm/s
    """

    responds: ClassVar[bool] = False
    kind: Literal["shaker"] = "shaker"
    motion: Annotated[tuple[AnySignal, ...], signals_in("m", "m/s^2"), AlsoAccepts()]

    @field_validator("motion")
    @classmethod
    def _smooth(cls, motion: tuple[Signal, ...]) -> tuple[Signal, ...]:
        placed = []
        for index, signal in enumerate(motion):
            allowed: tuple[Unit, ...] = ("m", "m/s^2") if signal.kind == "harmonic" else ("m/s^2",)
            with at(index):
                placed.append(signal.placed(allowed, f"a {signal.kind} that moves a shaker"))
        return tuple(placed)

    def words(self) -> str:
        """Return a phrase about the motion."""
        return f"a shaker with {joined([signal.words() for signal in self.motion])}"

    def modes(self) -> ModalModel:
        """Return no modes at all."""
        return _still()
