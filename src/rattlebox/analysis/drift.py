"""Relative displacement between two points of a structure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .signals import labelled

if TYPE_CHECKING:
    import xarray

    from rattlebox.results import Run


def drift(run: Run, upper: str, lower: str | None = None) -> xarray.DataArray:
    """Compute the relative displacement between two points of the structure, such as two floors of a building.

    Parameters
    ----------
    run
        Run of T output times.
    upper
        Name of the first point.
    lower
        Name of the point whose displacement is subtracted; default the base.

    Returns
    -------
    xarray.DataArray
        Drift over `time` [s], (T,) [m].

    Raises
    ------
    ValueError
        If the structure has no point of this name.

    Notes
    -----
    x_upper(t) - x_lower(t). Displacements of a run are relative to the base.

    Examples
    --------
    The run of the example of `rattlebox.analysis.largest_drift`:

    >>> float(abs(drift(run, "storey 1")).max()) > float(abs(drift(run, "storey 2", "storey 1")).max())
    True
    """
    points = run.arrays.points
    for name in (upper,) if lower is None else (upper, lower):
        if name not in points:
            raise ValueError(f"there is no point {name!r} in this run; there are {', '.join(points) or 'none'}")
    values = run.arrays.displacement[:, points.index(upper)]
    if lower is not None:
        values = values - run.arrays.displacement[:, points.index(lower)]
    return labelled("drift", values, "m", f"drift of {upper} over {lower or 'the base'}", time=run.arrays.time)
