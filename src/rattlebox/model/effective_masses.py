"""Effective masses of modes: the parts of a structure's mass that follow a motion of its base."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .elementwise import Vector
from .errors import Hint, several
from .matrices import Matrices
from .space import AXES
from .structures import StructurePart
from .units import numbers

DIRECTIONS = (*AXES, *(f"r{axis}" for axis in AXES))
_ROUNDING = 1e-9  # effective mass that is printed as zero, over the largest of the same unit
_SHOWN = 20  # modes of a table


@dataclass(frozen=True, eq=False)
class EffectiveMasses:
    """Participation and effective masses of modes; its text is a table.

    Attributes
    ----------
    directions
        "base" for a structure whose points move along one line; else x, y, z, and possibly rotations rx, ry, rz.
    frequencies : (m,) float
        Natural frequencies [Hz].
    participation : (m, d) float
        Participation phi^T M r of mass-normalised modes [kg^1/2]; [kg^1/2 m] for rotations.
    total : (d,) float or None
        Mass r^T M r of the rigid structure [kg]; moment of inertia for rotations [kg m^2]; None if it is unknown.
    """

    directions: tuple[str, ...]
    frequencies: Vector
    participation: Vector
    total: Vector | None = None

    @property
    def masses(self) -> Vector:
        """Effective masses, the squares of the participation, (m, d) [kg], [kg m^2]."""
        return np.asarray(np.square(self.participation))

    @property
    def shares(self) -> Vector | None:
        """Sum of the effective masses over the total mass, (d,); None if the total is unknown."""
        if self.total is None:
            return None
        sums = self.masses.sum(axis=0)
        return np.asarray(np.divide(sums, self.total, out=np.zeros_like(sums), where=self.total > 0))

    def __str__(self) -> str:
        units = ["kg m^2" if name in DIRECTIONS[3:] else "kg" for name in self.directions]
        heads = [f"{name} [{unit}]" for name, unit in zip(self.directions, units, strict=True)]
        width = max(12, *(len(head) + 2 for head in heads))
        limits = [
            _ROUNDING * max(float(self.masses[:, k].max(initial=0.0)) for k in range(len(units)) if units[k] == unit)
            for unit in units
        ]

        def row(name: str, frequency: str, cells: Sequence[str]) -> str:
            return f"{name:>5s}{frequency:>12s}" + "".join(f"{cell:>{width}s}" for cell in cells)

        def cells(values: Vector) -> list[str]:
            return [f"{0.0 if value < limit else value:.4g}" for value, limit in zip(values, limits, strict=True)]

        lines = [row("mode", "[Hz]", heads)]
        for number, (frequency, masses) in enumerate(
            zip(self.frequencies[:_SHOWN], self.masses, strict=False), start=1
        ):
            lines.append(row(str(number), f"{frequency:.5g}", cells(masses)))
        if len(self.frequencies) > _SHOWN:
            lines.append(row("...", "", [""] * len(heads)))
        lines.append(row("sum", "", cells(self.masses.sum(axis=0))))
        if self.total is not None and (shares := self.shares) is not None:
            lines += [
                row("total", "", cells(self.total)),
                row("share", "", [f"{100 * share:.1f} %" for share in shares]),
            ]
        return "\n".join(line.rstrip() for line in lines)


def effective_masses(structure: object, positions: object = None, directions: object = None) -> EffectiveMasses:
    r"""Return the effective mass of each mode of a structure in each direction.

    Parameters
    ----------
    structure
        A structure, such as `rb.Beam` or `rb.Modal` with participation.
    positions : (n, 3) float
        Positions of the degrees of freedom of `rb.Matrices` [m], for all directions and for rotations about the origin.
    directions : (n,) str or (n, 3) float
        Directions of these degrees of freedom: "x", "y", "z", "rx", "ry", "rz", or unit vectors of displacements.

    Returns
    -------
    EffectiveMasses
        The table; `print` shows it.

    Raises
    ------
    CaseError
        If the structure states no participation, or positions and directions do not fit to it.

    Notes
    -----
    .. math:: \Gamma = \phi^T M r, \qquad m_{\mathrm{eff}} = \Gamma^2, \qquad \sum m_{\mathrm{eff}} = r^T M r

    with mass-normalised modes :math:`\phi` and the displacement :math:`r` of the rigid structure by 1 m, or 1 rad. The sum
    is over all modes; modes that are left out, and masses at supports of the file's model, make it smaller. The effective
    mass of a rotation depends on the origin.

    References
    ----------
    R. W. Clough, J. Penzien (2003): Dynamics of Structures, 3rd edition, Computers & Structures, chapters 12 and 26.

    Examples
    --------
    >>> import rattlebox as rb
    >>> bar = rb.Beam(length="200 mm", material="steel", diameter="25 mm", mode_count=3)
    >>> print(rb.effective_masses(bar))
     mode        [Hz]   base [kg]
        1      441.34      0.4725
        2      2765.8      0.1451
        3      7744.4     0.04989
      sum                  0.6675
    total                  0.7707
    share                  86.6 %
    """
    if not isinstance(structure, StructurePart):
        raise Hint(f"a structure is needed; got {type(structure).__name__}", "rb.effective_masses(case.structure)")
    if positions is not None or directions is not None:
        return _of_matrices(structure, positions, directions)
    modes = structure.modes()
    if modes.participation is None or not len(modes.stiffness):
        raise Hint(
            "the structure has no modes, or states no participation of them",
            "participation = [...] of rb.Modal, influence of rb.Matrices, or positions and directions of its degrees of"
            " freedom",
        )
    rows = np.asarray(modes.participation, dtype=float)
    total = None if modes.total_mass is None else np.asarray(modes.total_mass, dtype=float)
    return EffectiveMasses(
        AXES if rows.ndim == 2 else ("base",),
        np.sqrt(np.asarray(modes.stiffness, dtype=float)) / (2 * np.pi),
        rows.reshape(len(rows), -1),
        None if total is None else np.diag(total).copy() if total.ndim == 2 else total.reshape(1),
    )


def _of_matrices(structure: StructurePart, positions: object, directions: object) -> EffectiveMasses:
    """Return the effective masses of matrices for the six rigid motions."""
    if not isinstance(structure, Matrices) or positions is None or directions is None:
        raise Hint(
            "positions and directions are those of the degrees of freedom of rb.Matrices, both together",
            "rb.effective_masses(structure)",
        )
    from scipy.linalg import eigh

    mass, _, stiffness = structure.matrices()
    r = rigid_motions(positions, directions, len(mass))
    _, vectors = eigh(stiffness, mass)
    return EffectiveMasses(
        DIRECTIONS,
        np.sqrt(np.asarray(structure.modes().stiffness, dtype=float)) / (2 * np.pi),
        vectors.T @ mass @ r,
        np.einsum("ni,nm,mi->i", r, mass, r),
    )


def rigid_motions(positions: Any, directions: Any, count: int) -> Vector:
    """Return the displacements of degrees of freedom in the six rigid motions, (n, 6): along x, y, z and about them."""
    x = numbers(positions)
    if x.shape != (count, 3):
        raise Hint(
            f"positions have the shape {x.shape}, but there are {several(count, 'degree')} of freedom",
            "three coordinates for each",
        )
    if len(directions) != count:
        raise Hint(
            f"{several(len(directions), 'direction')}, but there are {several(count, 'degree')} of freedom",
            '"x", "y", "z", "rx", "ry", "rz", or a unit vector for each',
        )
    r = np.zeros((count, 6))
    for k, direction in enumerate(directions):
        if isinstance(direction, str):
            if direction not in DIRECTIONS:
                raise Hint(f"{direction!r} is no direction", ", ".join(map(repr, DIRECTIONS)))
            index = DIRECTIONS.index(direction)
            unit, is_rotation = np.eye(3)[index % 3], index >= 3
        else:
            unit, is_rotation = numbers(direction), False
            if unit.shape != (3,) or abs(float(np.linalg.norm(unit)) - 1) > 1e-6:
                raise Hint(f"direction {k + 1} is no unit vector", "three numbers whose squares add up to 1")
        if is_rotation:
            r[k, 3:] = unit
        else:
            r[k, :3] = unit
            r[k, 3:] = np.cross(x[k], unit)  # (e x p) d = e (p x d)
    return r
