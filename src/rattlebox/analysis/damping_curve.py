"""Damping ratio over amplitude from one free decay."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from rattlebox.results.free_decay import free_decay

from .decay import analytic_signal, oscillation
from .signals import FloatArray, finite, labelled, positive, units_of

if TYPE_CHECKING:
    import xarray

    from rattlebox.results.run import Run

SKIPPED = 2.0
"""Cycles at the start that are ignored: particles at rest must first be set in motion."""


def damping_over_amplitude(time: ArrayLike, values: ArrayLike, amplitudes: ArrayLike) -> xarray.Dataset:
    """Compute the damping ratio and frequency of a free decay at given amplitudes.

    The damping at an amplitude is the mean over the part of the decay in which the envelope falls through a band around it,
    whose edges are the geometric means with the neighbouring amplitudes. The rest position, which a weight may shift, is
    removed as the mean over one cycle around each sample.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s], at least 5 per cycle.
    values : (N,) array_like
        Free decay of one mode; the unit of a DataArray is used.
    amplitudes : (A,) array_like
        At least two ascending amplitudes above zero, in the unit of the values.

    Returns
    -------
    xarray.Dataset
        `damping_ratio`, `frequency` [Hz], the times `begin` and `end` of each band [s], and the integral `squares` of the
        squared envelope over the phase, over `amplitude`; NaN if the decay does not fall through the whole band,
        passes it in less than half a cycle, or enters it in the first two cycles.

    Raises
    ------
    ValueError
        If times are not evenly spaced, a sample is not finite, the record is too short or too coarse, or the amplitudes do
        not rise.

    Notes
    -----
    With the envelope A and the phase of the analytic signal, delta = ln(A_1 / A_2) / (phase_2 - phase_1) and
    zeta = delta / sqrt(1 + delta^2), exact for a linear decay.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(40_000) / 1000
    >>> decay = np.exp(-0.02 * 2 * np.pi * 10 * time) * np.cos(2 * np.pi * 10 * time)
    >>> curve = damping_over_amplitude(time, decay, [0.05, 0.1, 0.2])
    >>> curve.damping_ratio.values.round(4)
    array([0.02, 0.02, 0.02])
    """
    import xarray

    levels = finite("amplitudes", amplitudes, 2)
    if levels[0] <= 0 or np.any(np.diff(levels) <= 0):
        raise ValueError(
            f"amplitudes are {levels.tolist()}, but must be ascending and above zero; try: sorted amplitudes"
        )
    t, x, cycle = oscillation(time, values)
    step = (t[-1] - t[0]) / (t.size - 1)
    inner, mean = mean_over_period(t, x, cycle * step)
    inner, signal, _ = analytic_signal(inner, x[np.isin(t, inner)] - mean)
    # The smallest envelope so far, since particles may return energy to the structure for a while.
    envelope = np.minimum.accumulate(np.abs(signal))
    phase = np.unwrap(np.angle(signal))
    edges = band_edges(levels)
    ratio, frequency, begins, ends, squares = np.full((5, levels.size), np.nan)
    begin = t[0] + SKIPPED * cycle * step
    for k in range(levels.size):
        if not envelope[-1] < edges[k] < edges[k + 1] <= envelope[0]:
            continue
        (t_high, phase_high), (t_low, phase_low) = (
            _crossing(inner, envelope, phase, e) for e in (edges[k + 1], edges[k])
        )
        turn = phase_low - phase_high
        if t_high < begin or turn < math.pi:
            continue
        delta = math.log(edges[k + 1] / edges[k]) / turn
        ratio[k] = delta / math.sqrt(1 + delta**2)
        frequency[k] = turn / (2 * math.pi * (t_low - t_high))
        begins[k], ends[k] = t_high, t_low
        inside = (inner > t_high) & (inner < t_low)
        squares[k] = np.trapezoid(
            np.concatenate([[edges[k + 1]], np.abs(signal[inside]), [edges[k]]]) ** 2,
            np.concatenate([[phase_high], phase[inside], [phase_low]]),
        )
    unit = f"({units_of(values)})^2" if units_of(values) else ""
    axis = ("amplitude", levels, {"units": units_of(values), "long_name": "amplitude"})
    return xarray.Dataset(
        {
            "damping_ratio": labelled("damping_ratio", ratio, "1", "damping ratio", amplitude=axis),
            "frequency": labelled("frequency", frequency, "Hz", "frequency of the decay", amplitude=axis),
            "begin": labelled("begin", begins, "s", "time at which the band is entered", amplitude=axis),
            "end": labelled("end", ends, "s", "time at which the band is left", amplitude=axis),
            "squares": labelled(
                "squares", squares, unit, "integral of the squared envelope over the phase", amplitude=axis
            ),
        }
    )


def equivalent_damping(run: Run, amplitude: float | None = None, *, point: str | None = None) -> float:
    """Return the damping ratio of the free decay in a run, at one amplitude.

    As a measure of studies: `functools.partial(analysis.equivalent_damping, amplitude=0.5e-3)`. One run of chaotic motion is
    one random sample; vary the start or the packing to estimate its scatter, as `rattlebox.damping_curve` does.

    Parameters
    ----------
    run
        Run in which loads and base come to rest.
    amplitude
        Displacement amplitude of the point [m]; default half of the largest one of the decay, or the middle of a shorter
        decay.
    point
        Point of the amplitude; default the one with the largest motion in the mode.

    Returns
    -------
    float
        Damping ratio; NaN if there is no free decay, or it does not pass the amplitude, or passes it in less than a cycle.

    Raises
    ------
    ValueError
        If there is no such point, or the amplitude is not above zero.

    Notes
    -----
    The energy E of the mode with the largest energy falls from E_1 to E_2 = E_1 / 4 about the amplitude in the time t:
    zeta = ln(E_1 / E_2) / (2 omega t). The energy falls in two steps a cycle, so that the relative error of a smooth decay
    is up to 2 zeta / ln 4: 1.4 % for a ratio of 0.01, 6 % for 0.04.

    Examples
    --------
    >>> import rattlebox as rb
    >>> structure = rb.SDOF(mass="3 kg", frequency="50 Hz", damping_ratio=0.02, velocity="0.3 m/s")
    >>> run = rb.simulate(rb.Case(structure=structure, duration="1 s"))
    >>> round(rb.analysis.equivalent_damping(run, 0.3e-3), 3)
    0.02
    """
    if point is not None and point not in run.arrays.points:
        raise ValueError(f"point is {point!r}, but the run has {', '.join(run.arrays.points) or 'none'}")
    level = None if amplitude is None else positive("amplitude", amplitude, "m")
    decay = free_decay(run.arrays, level, point)
    return math.nan if decay is None else decay.damping_ratio


def band_edges(levels: FloatArray) -> FloatArray:
    """Return the edges of bands around amplitudes, (A + 1,): geometric means, extrapolated at both ends."""
    logs = np.log(levels)
    middle = 0.5 * (logs[1:] + logs[:-1])
    return np.asarray(np.exp(np.concatenate([[2 * logs[0] - middle[0]], middle, [2 * logs[-1] - middle[-1]]])))


def mean_over_period(t: FloatArray, x: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
    """Return the times at least half a period from both ends, (M,), and the mean over one period around each."""
    from scipy.interpolate import CubicSpline

    whole = CubicSpline(t, x).antiderivative()
    inner = t[(t >= t[0] + period / 2) & (t <= t[-1] - period / 2)]
    return inner, np.asarray((whole(inner + period / 2) - whole(inner - period / 2)) / period)


def _crossing(t: FloatArray, envelope: FloatArray, phase: FloatArray, level: float) -> tuple[float, float]:
    """Return time and phase at which a falling envelope first reaches a level."""
    k = int(np.argmax(envelope <= level))
    if k == 0:
        return float(t[0]), float(phase[0])
    part = math.log(envelope[k - 1] / level) / math.log(envelope[k - 1] / envelope[k])
    return float(t[k - 1] + part * (t[k] - t[k - 1])), float(phase[k - 1] + part * (phase[k] - phase[k - 1]))
