"""Branches of periodic motions over a parameter: points, special points, files and figures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.html import code_block
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, several
from rattlebox.studies.orbits.branch_data import KINDS, STUDY
from rattlebox.studies.orbits.branch_words import sentences, special_kinds
from rattlebox.studies.orbits.find import simplest, size_of
from rattlebox.studies.orbits.forcing import Forcing
from rattlebox.studies.orbits.orbit import Orbit, orbit_of
from rattlebox.studies.orbits.shooting import ReturnMap, solve
from rattlebox.studies.orbits.switching import switched
from rattlebox.studies.run.result_file import write_file
from rattlebox.studies.run.stored import open_study

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class SpecialPoint:
    """A special point of a branch.

    Attributes
    ----------
    kind : str
        "fold", "flip", "pitchfork", "torus" (Neimark-Sacker), "branch point", "grazing", "impact lost" or "sticking".
    parameter : str
        Path of the parameter of the branch.
    value : float
        Value of the parameter.
    index : int
        Index of the point in the branch.
    orbit : Orbit
        Periodic motion at the point.
    passage : str
        How the branch continues at a grazing point, such as "continues with 3 impacts" or "nonsmooth fold, turns back with 3
        impacts"; "" at other points.
    """

    kind: str
    parameter: str
    value: float
    index: int
    orbit: Orbit
    passage: str = ""

    def __str__(self) -> str:
        return f"{KINDS[self.kind]} at {self.parameter} = {self.value:.9g}{self.passage and f'; {self.passage}'}"


@dataclass(frozen=True, eq=False)
class Branch:
    """A branch of periodic motions along a parameter, from `rattlebox.continue_orbit`.

    Attributes
    ----------
    data : xarray.Dataset
        Points in their order along the branch: `value` of the parameter; `amplitude` of each point of the structure [m];
        `multiplier_real` and `multiplier_imaginary`; `stable`; `impacts` in a period; `slowest_impact` [m/s];
        `nearest_miss` [m]; `symmetric`; `sticks`; `special`, the name of a special point or ""; `located`, the value of
        the parameter there; `passage`, how the branch continues at a grazing point; `state` and `phase`, from which the
        motion can be computed again; `determinant_error`.

    Examples
    --------
    The branch of the example of `rattlebox.continue_orbit`:

    >>> point = branch.specials[0]
    >>> print(point, "with", len(point.orbit.impacts), "impacts")
    pitchfork (loss of symmetry) at load.frequency = 32.0805341 with 2 impacts
    """

    data: xarray.Dataset

    @property
    def parameter(self) -> str:
        """Path of the parameter."""
        return str(self.data.attrs["parameter"])

    @property
    def case(self) -> Case:
        """Case at the start of the continuation."""
        return Case.from_toml(str(self.data.attrs["case"]))

    @property
    def is_closed(self) -> bool:
        """Whether the branch is a closed curve, an isola."""
        return bool(self.data.attrs["closed"])

    @property
    def specials(self) -> tuple[SpecialPoint, ...]:
        """Special points in their order along the branch."""
        found = np.flatnonzero(special_kinds(self.data) != "")
        return tuple(
            SpecialPoint(
                str(self.data.special[k].item()),
                self.parameter,
                float(self.data.located[k]),
                int(k),
                self.orbit(int(k)),
                str(self.data.passage[k].item()),
            )
            for k in found
        )

    def __len__(self) -> int:
        return int(self.data.sizes["point"])

    def orbit(self, index: int) -> Orbit:
        """Compute the periodic motion of a point.

        Parameters
        ----------
        index
            Index of the point, from 0.

        Returns
        -------
        Orbit
            Periodic motion.

        Raises
        ------
        CaseError
            If there is no such point, or the motion cannot be computed.
        """
        if not -len(self) <= index < len(self):
            raise Hint(f"there is no point {index}; the branch has {several(len(self), 'point')}", "branch.orbit(0)")
        row = self.data.isel(point=index)
        forcing = Forcing.of(self.case.replaced({self.parameter: float(row.value)}), (self.parameter,))
        returns = ReturnMap(
            forcing, int(self.data.attrs["cycles"]), phase=float(row.phase), mirrored=bool(row.symmetric.item())
        )
        state = np.ascontiguousarray(row.state.values, dtype=float)
        scale = size_of(returns, state)
        found = None if scale is None else solve(returns, state[None], scale)
        if found is None or scale is None:  # at a singular point the stored state is the best there is
            shot = returns.shoot(state[None])
            found = (state[None], shot) if shot.is_complete else None
            scale = np.ones_like(state) if scale is None else scale
        if found is not None and scale is not None and str(row.special.item()) in ("flip", "pitchfork"):
            # A branch that begins or ends there has a map over twice the period, whose derivative is singular.
            returns, states, shot, scale = simplest(returns, *found, scale)
            found = states, shot
        orbit = None if found is None else orbit_of(returns, found[1], found[0][0], scale)
        if orbit is None:
            raise Hint(f"the motion of point {index} cannot be computed", "a neighbouring point")
        return orbit

    def switch(self, point: SpecialPoint, limits: Sequence[Any] | None = None, **options: Any) -> Branch:
        """Follow the branch that begins at a flip or a pitchfork.

        Parameters
        ----------
        point
            Special point of this branch, of kind "flip" or "pitchfork".
        limits
            Smallest and largest value of the parameter; default those of this branch.
        **options
            Other options of `rattlebox.continue_orbit`.

        Returns
        -------
        Branch
            Motions of twice the period after a flip, motions without the symmetry after a pitchfork.

        Raises
        ------
        CaseError
            If no branch begins at a point of this kind, or the branch is not found.
        """
        if not isinstance(point, SpecialPoint) or point.kind not in ("flip", "pitchfork"):
            kind = getattr(point, "kind", point)
            raise Hint(
                f"no branch begins at a point of kind {kind!r:.40}; it must be a flip or a pitchfork",
                'the points of branch.specials whose kind is "flip" or "pitchfork"',
            )
        value = float(self.data.value[point.index])
        limits = tuple(self.data.attrs["limits"]) if limits is None else limits
        return Branch(switched(point.orbit, point.kind, self.parameter, value, limits, **options))

    def plot(self, **options: Any) -> Figure:
        """Draw the amplitude over the parameter: stable motions solid, unstable ones dashed, special points marked.

        Parameters
        ----------
        **options
            Those of `rattlebox.plot_branches`.

        Returns
        -------
        Figure
            Figure with one panel.
        """
        # studies must not import the figures statically, which are above them
        figure: Figure = import_module("rattlebox.plots.branches").plot_branches(self, **options)
        return figure

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the branch to a netCDF file.

        Parameters
        ----------
        path
            File to write (.nc); the new file replaces an existing one when it is complete.

        Returns
        -------
        Path
            The file; `Branch.load` reads an equal branch.

        Raises
        ------
        DataError
            If the file cannot be written.
        ResourceError
            If no space is left on the disk.
        """
        return write_file(self.data, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Branch:
        """Read a branch that `save` wrote, or the result of a study of the kind "continue_orbit".

        Parameters
        ----------
        path
            netCDF file, or the folder of the study.

        Returns
        -------
        Branch
            The branch.

        Raises
        ------
        DataError
            If the file cannot be read or is not a branch.
        StoreError
            If the folder is not a study.
        """
        data = open_study(path).load()
        if data.attrs.get("study") != STUDY:
            raise DataError(f"{path} is not a branch of periodic motions", "a file that Branch.save wrote")
        return cls(data)

    def __str__(self) -> str:
        return "\n".join(sentences(self.data))

    def _repr_html_(self) -> str:
        return code_block(str(self))
