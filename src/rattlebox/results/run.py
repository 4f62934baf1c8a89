"""One finished run: data, datasets, summary, figures and files."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rattlebox._util.exceptions import CaseError
from rattlebox._util.html import paragraph
from rattlebox.exchange.write.universal import universal_nodes

from . import datasets, export, netcdf
from .along import motion_along
from .arrays import raise_absent
from .figures import Plots
from .record import Record
from .summary import Summary

if TYPE_CHECKING:
    import xarray


class Run(Record):
    """The result of a simulation.

    A 1-D run (impact engine) has the datasets `motion`, `energy` and `impacts`, a 3-D run (dem engine) `motion`,
    `energy` and `particles`; `groups` lists them. A dataset that a run lacks raises AttributeError with the reason.

    Two runs are equal if their cases and results are bitwise equal; date, machine and computing time are ignored.
    """

    @cached_property
    def motion(self) -> xarray.Dataset:
        """Positions, velocities and forces at the output times, relative to the base; SI units.

        Forces and motion of the base have the dimension `axis`: x, y and z in a 3-D run; in a 1-D run one entry, the
        direction of the base motion, or "line". `along` gives the components in one direction.
        """
        return self._dataset("motion")

    def along(self, direction: str | Sequence[float] | None = None) -> xarray.Dataset:
        """Return the motion along one direction, with the same names and dimensions for 1-D and 3-D runs.

        Parameters
        ----------
        direction
            "x", "-z", or three numbers. Default: the line of a 1-D run, and the direction of the dampers of a 3-D run.

        Returns
        -------
        xarray.Dataset
            The dataset `motion` without the dimension `axis`. Vectors have their components along the direction, and a point
            with the lines "tip x", "tip y" and "tip z" is one point, "tip".

        Raises
        ------
        CaseError
            If the run is 1-D and its base moves in another direction, or the dampers have different directions and none is
            given.

        Examples
        --------
        >>> import rattlebox as rb
        >>> run = rb.simulate(rb.reference_case(duration="0.1 s"))
        >>> run.motion.interface_force.dims, run.along().interface_force.dims
        (('time', 'axis'), ('time',))
        """
        return motion_along(self, direction)

    @cached_property
    def energy(self) -> xarray.Dataset:
        """Energy ledger at the output times, with energies, work, losses, residual [J] and final shares."""
        return self._dataset("energy")

    @cached_property
    def impacts(self) -> xarray.Dataset:
        """The impact log of a 1-D run, one entry per impact; SI units.

        Raises
        ------
        AttributeError
            If the run is 3-D; contacts of particles are counted, not logged.
        """
        return self._dataset("impacts")

    @cached_property
    def particles(self) -> xarray.Dataset:
        """The particles of a 3-D run at its end, in their moving cavities; SI units.

        Raises
        ------
        AttributeError
            If the run is 1-D.
        """
        return self._dataset("particles")

    def _dataset(self, group: str) -> xarray.Dataset:
        if group not in self.groups:
            raise_absent(group, self.arrays.engine)
        return datasets.dataset(self, group)

    def summary(self) -> Summary:
        """Return the main numbers: energy shares, energy residual, peaks, counts of contacts, computing time.

        Returns
        -------
        Summary
            `str()` gives plain text, rich prints a table, `.show()` picks one, `.values` holds the numbers.
        """
        return Summary(self)

    def _repr_html_(self) -> str:
        try:
            case = repr(self.case)[1:-1]
        except CaseError as error:  # a file that the case names is gone
            case = str(error)
        return paragraph(repr(self)[1:-1], self.provenance.method) + paragraph("", case) + self.summary()._repr_html_()

    @property
    def plot(self) -> Plots:
        """Figures of this run: `motion`, `energy`, `phase_portrait`, `case`, and `impacts` (1-D) or `particles` (3-D)."""
        import_module("rattlebox.plots")  # registers the figures; results must not import plots statically
        return Plots(self)

    def save(self, path: str | os.PathLike[str], *, replace: bool = True) -> Path:
        """Write the run to one netCDF-4 file that MATLAB, ncdump and xarray read.

        Parameters
        ----------
        path
            File to write; the new file replaces an existing one when it is complete.
        replace
            Whether an existing file may be replaced; otherwise a DataError with the number `errno.EEXIST` is raised.

        Returns
        -------
        Path
            The file. `rattlebox.load` returns an equal run.

        Raises
        ------
        DataError
            If the file cannot be written, or its suffix belongs to another kind of file.
        ResourceError
            If no space is left on the disk.
        """
        return netcdf.save(self, Path(path), replace=replace)

    def to_mat(self, path: str | os.PathLike[str]) -> Path:
        """Write a MATLAB file with a struct for each dataset, and the structs `units` and `info`.

        Parameters
        ----------
        path
            File to write.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        DataError
            If the file cannot be written, or its suffix belongs to another kind of file.
        ResourceError
            If no space is left on the disk.
        """
        return export.to_mat(self, Path(path))

    def to_csv(self, folder: str | os.PathLike[str]) -> tuple[Path, ...]:
        """Write a CSV file for each dataset, such as motion.csv, with units in the header and all digits.

        Parameters
        ----------
        folder
            Folder to write to, created if missing. Its marker, rattlebox.json, lists the files: files with their names that
            are not in the list, or have changed since, are not overwritten.

        Returns
        -------
        tuple of Path
            The files.

        Raises
        ------
        DataError
            If a file cannot be written, or must not be overwritten.
        ResourceError
            If no space is left on the disk.
        """
        return export.to_csv(self, Path(folder))

    def to_uff(
        self,
        path: str | os.PathLike[str],
        *,
        variables: Iterable[str] | None = None,
        nodes: Mapping[str, int | str] | None = None,
    ) -> Path:
        """Write a universal file with the time histories of the motion, one set 58b each, for programs of test laboratories.

        Parameters
        ----------
        path
            File to write (.uff, .unv). A file that Rattlebox did not write, or that has changed since, is not replaced.
        variables
            Names of variables of `motion`; default displacement, velocity and accelerations of points and base, force on the
            base, and loads, those that the run has.
        nodes
            Nodes of the points: `{"tip": "21 z"}`, or `{"tip": 21}` for a point in 3-D; default 1, 2, ... in their order.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        DataError
            If the file cannot be written or must not be replaced, or the run has no such variable.
        ResourceError
            If no space is left on the disk.

        Notes
        -----
        The values are doubles and read back to the last bit. Times in equal steps are stored as start and step with the
        digits that fit into twelve characters, about eight; others as doubles.

        Examples
        --------
        >>> import rattlebox as rb
        >>> run = rb.simulate(rb.reference_case(duration=0.1))
        >>> run.to_uff("run.uff", variables=["velocity"]).name
        'run.uff'
        """
        return export.to_uff(self, Path(path), variables, universal_nodes(nodes))

    def to_sep005(self, *, variables: Iterable[str] | None = None) -> list[dict[str, Any]]:
        """Return the time histories of the motion as channels of SEP005, the form of the Python tools of SDyPy.

        Parameters
        ----------
        variables
            As for `to_uff`.

        Returns
        -------
        list of dict
            Channels with `name`, `data`, `unit_str`, `quantity`, `group`, and the sampling rate `fs` [Hz], or `time` [s] if
            the output is not in equal steps from 0 s.

        Raises
        ------
        DataError
            If the run has no such variable.

        References
        ----------
        SDyPy Enhancement Proposal 5, "A protocol for time series", https://github.com/sdypy/sdypy.

        Examples
        --------
        >>> import rattlebox as rb
        >>> run = rb.simulate(rb.reference_case(duration=0.1))
        >>> run.to_sep005(variables=["velocity"])[0]["unit_str"]
        'm/s'
        """
        return export.to_sep005(self, variables)

    def report(self, path: str | os.PathLike[str], **options: Any) -> Path:
        """Write a report about the run: one HTML page that prints on A4; see `rattlebox.write_report`.

        Parameters
        ----------
        path
            File to write, .html. An earlier report is replaced; any other file is not.
        **options
            `title` and `question`, as of `rattlebox.write_report`.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        DataError
            If the file exists and is not a report, or cannot be written.
        ResourceError
            If no space is left on the disk.
        """
        # results must not import the report statically, which is above it
        written: Path = import_module("rattlebox.report.write").write_report(self, path, **options)
        return written


def load(path: str | os.PathLike[str]) -> Run:
    """Read a run from a file that `Run.save` wrote.

    Parameters
    ----------
    path
        netCDF-4 file.

    Returns
    -------
    Run
        Run that is bitwise equal to the saved one.

    Raises
    ------
    DataError
        If the file does not exist, cannot be read, is not a run of Rattlebox, is damaged, or has another format.
    """
    return Run(**netcdf.read(path))
