"""Phase portraits, Poincare sections, and impacts per cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .signals import FloatArray, finite, labelled, positive

if TYPE_CHECKING:
    import xarray

    from rattlebox.results import Run


def phase_portrait(run: Run, of: str | None = None) -> xarray.Dataset:
    """Return position and velocity of a ball in its cavity, or of a point of the structure.

    Parameters
    ----------
    run
        Run of T output times.
    of
        Name of a ball or point; default the first ball, or the first point of a run without balls.

    Returns
    -------
    xarray.Dataset
        `position` [m] and `velocity` [m/s] over `time` [s]. Those of a ball are relative to the cavity, with the origin at
        its place in the packed and centred row; those of a point are relative to the base.

    Raises
    ------
    ValueError
        If no ball or point has this name.
    """
    name, x, v = _motion(run, of)
    return _portrait(run, name, run.arrays.time, x, v)


def poincare_section(run: Run, period: float, *, phase: float = 0.0, of: str | None = None) -> xarray.Dataset:
    """Sample the motion once per period.

    Parameters
    ----------
    run
        Run of at least 2 output times.
    period
        Time between samples [s].
    phase
        Phase of the samples [rad]: their times are (n + phase/(2 pi)) period, for every integer n within the run.
    of
        Name of a ball or point, as for `phase_portrait`.

    Returns
    -------
    xarray.Dataset
        `position` [m] and `velocity` [m/s] over `time` [s], including transients; `.sel(time=slice(start, None))` removes
        them.

    Raises
    ------
    ValueError
        If no ball or point has this name, the period is not above zero, or no sample is within the run.

    Notes
    -----
    The points are (x(t_n), v(t_n)) with t_n = (n + phase / (2 pi)) period. A motion of period n has n points. Between output
    times the motion is interpolated by cubics through positions and velocities, which do not resolve impacts: choose output
    times at the samples, or dense ones.

    References
    ----------
    J. Guckenheimer, P. Holmes (1983), Nonlinear Oscillations, Dynamical Systems, and Bifurcations of Vector Fields,
    Springer, section 1.5, doi:10.1007/978-1-4612-1140-2.
    """
    from scipy.interpolate import CubicHermiteSpline

    name, x, v = _motion(run, of)
    t = finite("time", run.arrays.time, 2)
    period = positive("period", period, "s")
    offset = float(finite("phase", [phase])[0]) / (2 * np.pi)
    slack = 1e-9  # tolerance in periods for samples at the first or last time
    first = np.ceil(t[0] / period - offset - slack)
    last = np.floor(t[-1] / period - offset + slack)
    if last < first:
        raise ValueError(f"no sample of period {period:g} s is within the run, {t[0]:g} s to {t[-1]:g} s")
    strobes = np.clip((np.arange(first, last + 1) + offset) * period, t[0], t[-1])
    path = CubicHermiteSpline(t, x, v)
    return _portrait(run, name, strobes, path(strobes), path(strobes, 1))


def impacts_per_cycle(impact_times: ArrayLike, period: float, *, start: float, end: float) -> xarray.DataArray:
    """Count the impacts in each whole cycle.

    Parameters
    ----------
    impact_times : (I,) array_like
        Times of impacts [s], in any order; those outside the cycles are ignored.
    period
        Length of a cycle [s].
    start, end
        The first cycle begins at `start`, the last whole one ends by `end` [s].

    Returns
    -------
    xarray.DataArray
        Counts over `cycle`, the times at which the cycles begin [s]. An impact at the border of two cycles, to 1e-9 of a
        period, counts in the later one.

    Raises
    ------
    ValueError
        If there is no whole cycle between start and end, or a number is not finite.

    Examples
    --------
    >>> impacts_per_cycle([0.1, 0.6, 1.2], period=1.0, start=0.0, end=2.0).values
    array([2, 1])
    """
    times = finite("impact_times", impact_times, 0)
    period = positive("period", period, "s")
    first, last = finite("start and end", [start, end])
    slack = 1e-9
    cycles = int(np.floor((last - first) / period + slack))
    if cycles < 1:
        raise ValueError(f"no whole cycle of {period:g} s fits between start = {start:g} s and end = {end:g} s")
    cycle = np.floor((times - first) / period + slack)
    counts = np.bincount(cycle[(cycle >= 0) & (cycle < cycles)].astype(int), minlength=cycles)
    starts = first + period * np.arange(cycles)
    return labelled(
        "impacts",
        counts,
        "1",
        "impacts in the cycle",
        cycle=("cycle", starts, {"units": "s", "long_name": "cycle start"}),
    )


def _motion(run: Run, of: str | None) -> tuple[str, FloatArray, FloatArray]:
    arrays = run.arrays
    names = (*arrays.balls, *arrays.points)
    if of is None and not names:
        raise ValueError("there is no ball in this run, and no point of a structure that moves")
    name = of if of is not None else names[0]
    if name in arrays.balls:
        k = arrays.balls.index(name)
        return name, arrays.relative_position[:, k] - arrays.ball_centre[k], arrays.relative_velocity[:, k]
    if name in arrays.points:
        k = arrays.points.index(name)
        return name, arrays.displacement[:, k], arrays.velocity[:, k]
    raise ValueError(f"there is no ball or point {name!r}; there are {', '.join(names) or 'none'}")


def _portrait(run: Run, name: str, time: FloatArray, position: FloatArray, velocity: FloatArray) -> xarray.Dataset:
    import xarray

    where = "in its cavity" if name in run.arrays.balls else "of the structure"
    return xarray.Dataset(
        {
            "position": labelled("position", position, "m", f"position {where}", time=time),
            "velocity": labelled("velocity", velocity, "m/s", f"velocity {where}", time=time),
        },
        attrs={"of": name},
    )
