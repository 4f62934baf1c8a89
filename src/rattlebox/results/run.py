"""One finished run: data, ledger, summary, figures and files."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from .arrays import RunArrays
from .ledger import Ledger
from .provenance import Provenance

if TYPE_CHECKING:
    import os

    import xarray
    from matplotlib.figure import Figure

    from .summary import Summary


class Run:
    """What a simulation returns.

    Runs are equal when their case and their results are, to the last bit; when, where and how fast they were computed
    does not count.

    Parameters
    ----------
    arrays
        What the engine computed.
    case_toml
        The case, as the text of a case file, or what returns it: writing it costs more than many a run.
    provenance
        Where the run comes from; made on the spot when left out.
    """

    def __init__(
        self, arrays: RunArrays, case_toml: str | Callable[[], str] = "", provenance: Provenance | None = None
    ) -> None:
        self._arrays = arrays
        self._case = case_toml
        self._provenance = Provenance.now() if provenance is None else provenance

    @property
    def arrays(self) -> RunArrays:
        """The plain arrays, SI units, read-only."""
        return self._arrays

    @cached_property
    def case_toml(self) -> str:
        """The case that was run, as the text of a case file."""
        return self._case if isinstance(self._case, str) else self._case()

    @property
    def provenance(self) -> Provenance:
        """Version, method, seed, date and platform."""
        return self._provenance

    @property
    def status(self) -> str:
        """The word "finished", or the reason why the run ended early."""
        return self._arrays.status

    @property
    def message(self) -> str:
        """One sentence that explains the status and says what to try."""
        return self._arrays.message

    @property
    def ok(self) -> bool:
        """True when the run reached its end."""
        return self._arrays.status == "finished"

    @cached_property
    def ledger(self) -> Ledger:
        """Sums over all energies, in J, each (T,)."""
        return Ledger(self._arrays)

    @property
    def closure(self) -> float:
        """Largest imbalance of the energy ledger over the energy that was put in.

        max|E(t) - E(0) - W_load - W_base + losses| / (max|W_load| + max|W_base| + E(0)); a gravity
        potential V enters the denominator as max|V(t) - V(0)|, since its zero is arbitrary.
        """
        return self.ledger.closure

    @cached_property
    def motion(self) -> xarray.Dataset:
        """Positions, velocities and forces at the output times; relative to the base, SI units."""
        return self._dataset("motion")

    @cached_property
    def energy(self) -> xarray.Dataset:
        """The energy ledger at the output times: energies, work, losses, residual and final shares [J]."""
        return self._dataset("energy")

    @cached_property
    def impacts(self) -> xarray.Dataset:
        """The impact log, one entry for each contact that closed; SI units."""
        return self._dataset("impacts")

    def _dataset(self, group: Any) -> xarray.Dataset:
        from .datasets import dataset

        return dataset(self._arrays, self.ledger, group, self._provenance, self.case_toml)

    def summary(self) -> Summary:
        """Numbers that one looks at first: impacts, energy shares, closure, peaks, computing time.

        Returns
        -------
        Summary
            `str()` gives plain text, rich prints a table, `.show()` picks one, `.values` holds the numbers.
        """
        from .summary import Summary

        return Summary(self)

    @property
    def plot(self) -> Plots:
        """Figures of this run: `motion`, `energy`, `impacts`, `phase_portrait`."""
        return Plots(self)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write everything to one netCDF-4 file that MATLAB, ncdump and xarray read.

        Parameters
        ----------
        path
            File to write; an existing one is replaced once the new one is complete.

        Returns
        -------
        Path
            The file. `rattlebox.load` returns an equal run.

        Raises
        ------
        DataError
            When the file cannot be written, or its name is that of another kind of file.
        ResourceError
            When no space is left on the disk.
        """
        from .netcdf import save

        return save(self, Path(path))

    def to_mat(self, path: str | os.PathLike[str]) -> Path:
        """Write a MATLAB file with the structs `motion`, `energy`, `impacts`, `units` and `info`.

        Parameters
        ----------
        path
            File to write.

        Raises
        ------
        DataError
            When the file cannot be written, or its name is that of another kind of file.
        ResourceError
            When no space is left on the disk.
        """
        from .export import to_mat

        return to_mat(self, Path(path))

    def to_csv(self, folder: str | os.PathLike[str]) -> tuple[Path, ...]:
        """Write motion.csv, energy.csv and impacts.csv (in space particles.csv), units in the header, every digit kept.

        Parameters
        ----------
        folder
            Folder to write to, made when missing.

        Returns
        -------
        tuple of Path
            The files.

        Raises
        ------
        DataError
            When a file cannot be written.
        ResourceError
            When no space is left on the disk.
        """
        from .export import to_csv

        return to_csv(self, Path(folder))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Run):
            return NotImplemented
        return self._arrays == other._arrays and self.case_toml == other.case_toml

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        arrays = self._arrays
        return (
            f"<Run {arrays.status}: {arrays.time[0]:g} to {arrays.time[-1]:g} s, "
            f"{len(arrays.points)} points, {len(arrays.balls)} balls, {len(arrays.impacts)} impacts>"
        )


class RunPlots:
    """Figures that every run has; each method returns a matplotlib figure.

    Parameters
    ----------
    run
        Run to draw.
    """

    def __init__(self, run: Run) -> None:
        self._run = run

    if not TYPE_CHECKING:  # which knows what there is

        def __getattr__(self, name: str) -> NoReturn:
            known = [figure for figure in dir(type(self)) if not figure.startswith("_")]
            raise AttributeError(f"this run has no figure {name!r}; it has {', '.join(known)}")

    def energy(self, **options: Any) -> Figure:
        """Energies against time, and the ledger stacked up to the energy supplied.

        Parameters
        ----------
        **options
            Passed on to `rattlebox.plots.plot_energy`.
        """
        from ..plots import plot_energy

        return plot_energy(self._run, **options)


class Plots(RunPlots):
    """Figures of one run with balls."""

    def motion(self, **options: Any) -> Figure:
        """Displacement of the structure and ball positions in the cavity against time.

        Parameters
        ----------
        **options
            Passed on to `rattlebox.plots.plot_motion`.
        """
        from ..plots import plot_motion

        return plot_motion(self._run, **options)

    def impacts(self, **options: Any) -> Figure:
        """Approach speed, peak force and restitution of all impacts against time.

        Parameters
        ----------
        **options
            Passed on to `rattlebox.plots.plot_impacts`.
        """
        from ..plots import plot_impacts

        return plot_impacts(self._run, **options)

    def phase_portrait(self, of: str | None = None, **options: Any) -> Figure:
        """Velocity against position of a ball in its cavity, or of a point of the structure.

        Parameters
        ----------
        of
            Name of a ball or a point; the first ball when left out, or the first point without balls.
        **options
            Passed on to `rattlebox.plots.plot_phase_portrait`.

        Raises
        ------
        ValueError
            When no ball or point has that name.
        """
        from ..plots import plot_phase_portrait

        return plot_phase_portrait(self._run, of, **options)
