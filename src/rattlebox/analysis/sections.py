"""Portraits and sections of a run's motion, and impacts a cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .signals import FloatArray, finite, labelled, positive

if TYPE_CHECKING:
    import xarray

    from rattlebox.results import Run


def phase_portrait(run: Run, of: str | None = None) -> xarray.Dataset:
    """Position and velocity of a ball in its cavity, or of a point of the structure.

    Parameters
    ----------
    run
        Run of T output times.
    of
        Name of a ball or of a point; the first ball when left out, or the first point without balls.

    Returns
    -------
    xarray.Dataset
        `position` [m] and `velocity` [m/s] over `time` [s]. Those of a ball are relative to the cavity, the position
        counted from the ball's place in the packed, centred row; those of a point are relative to the base.

    Raises
    ------
    ValueError
        When no ball or point has that name.
    """
    name, x, v = _motion(run, of)
    return _portrait(run, name, run.arrays.time, x, v)


def poincare_section(run: Run, period: float, *, phase: float = 0.0, of: str | None = None) -> xarray.Dataset:
    """Strobe the motion once a period.

    A motion that repeats every n periods shows n points. Between output times the motion is a cubic through positions
    and velocities; so let output times fall on the strobes, or lie dense, where an impact may be near.

    Parameters
    ----------
    run
        Run of at least 2 output times.
    period
        Time between strobes [s].
    phase
        Phase of the strobes [rad]: they fall on (n + phase/(2 pi)) period, for every whole n within the run.
    of
        Name of a ball or of a point, as for `phase_portrait`.

    Returns
    -------
    xarray.Dataset
        `position` [m] and `velocity` [m/s] over `time` [s], the times of the strobes; transients included, so that
        one drops them with `.sel(time=slice(start, None))`.

    Raises
    ------
    ValueError
        When no ball or point has that name, the period is not above zero, or no strobe falls into the run.
    """
    from scipy.interpolate import CubicHermiteSpline

    name, x, v = _motion(run, of)
    t = finite("time", run.arrays.time, 2)
    period = positive("period", period, "s")
    offset = float(finite("phase", [phase])[0]) / (2 * np.pi)
    slack = 1e-9  # of a period: a strobe on the first or last time counts in spite of its rounding
    first = np.ceil(t[0] / period - offset - slack)
    last = np.floor(t[-1] / period - offset + slack)
    if last < first:
        raise ValueError(f"no strobe of period {period:g} s falls into the run, {t[0]:g} s to {t[-1]:g} s")
    strobes = np.clip((np.arange(first, last + 1) + offset) * period, t[0], t[-1])
    path = CubicHermiteSpline(t, x, v)
    return _portrait(run, name, strobes, path(strobes), path(strobes, 1))


def impacts_per_cycle(impact_times: ArrayLike, period: float, *, start: float, end: float) -> xarray.DataArray:
    """Count the impacts in each whole cycle.

    Parameters
    ----------
    impact_times : (I,) array_like
        Times of impacts [s], in any order; those outside the cycles are left out.
    period
        Length of a cycle [s].
    start, end
        The first cycle begins at `start`, the last whole one ends by `end` [s].

    Returns
    -------
    xarray.DataArray
        Counts over `cycle`, the times at which the cycles begin [s]. An impact on the border of two cycles, to 1e-9 of
        a period, belongs to the one that begins.

    Raises
    ------
    ValueError
        When no whole cycle fits between start and end, or a number is not finite.
    """
    times = finite("impact_times", impact_times, 0)
    period = positive("period", period, "s")
    begin, stop = finite("start and end", [start, end])
    slack = 1e-9
    cycles = int(np.floor((stop - begin) / period + slack))
    if cycles < 1:
        raise ValueError(f"no whole cycle of {period:g} s fits between start = {start:g} s and end = {end:g} s")
    cycle = np.floor((times - begin) / period + slack)
    counts = np.bincount(cycle[(cycle >= 0) & (cycle < cycles)].astype(int), minlength=cycles)
    starts = begin + period * np.arange(cycles)
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

    place = "in its cavity" if name in run.arrays.balls else "of the structure"
    return xarray.Dataset(
        {
            "position": labelled("position", position, "m", f"position {place}", time=time),
            "velocity": labelled("velocity", velocity, "m/s", f"velocity {place}", time=time),
        },
        attrs={"of": name},
    )
