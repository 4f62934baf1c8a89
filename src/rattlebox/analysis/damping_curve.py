"""Damping ratio over amplitude from one free decay."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rattlebox.results.free_decay import free_decay

from .decay import analytic_signal, oscillation
from .signals import FloatArray, finite, labelled, positive, units_of

if TYPE_CHECKING:
    import xarray

    from rattlebox.results.run import Run


class SmoothDecay(NamedTuple):
    """Amplitude and phase of a free decay, averaged over one cycle, without the first and last three cycles."""

    time: FloatArray  # Times [s], (T,)
    log_amplitude: FloatArray  # Logarithm of the envelope, (T,)
    phase: FloatArray  # Phase of the oscillation [rad], (T,)


def smooth_decay(time: ArrayLike, values: ArrayLike) -> SmoothDecay:
    """Return amplitude and phase of a free decay about its rest position.

    The rest position, which a weight may shift, is removed as the mean over one cycle around each sample. The mean over a
    cycle also removes the ripple that impacts leave in the envelope. It does not change a linear decay.
    """
    t, x, cycle = oscillation(time, values)
    step = (t[-1] - t[0]) / (t.size - 1)
    inner, mean = mean_over_period(t, x, cycle * step)
    inner, signal, _ = analytic_signal(inner, x[np.isin(t, inner)] - mean)
    # Subtracting the mean over T has changed a local exp(s t) by the factor 1 - sinh(s T / 2) / (s T / 2), which is not one
    # where T is not the local period.
    signal = np.where(np.abs(signal) > 0, signal, np.finfo(float).tiny)
    rate = np.gradient(np.log(np.abs(signal)) + 1j * np.unwrap(np.angle(signal)), step)
    half = 0.5 * cycle * step * mean_over_period(inner, rate, cycle * step)[1]
    means = [mean_over_period(inner, x, cycle * step) for x in (np.log(np.abs(signal)), np.unwrap(np.angle(signal)))]
    return SmoothDecay(means[0][0], means[0][1] - np.log(np.abs(1 - np.sinh(half) / half)), means[1][1])


def damping_over_amplitude(time: ArrayLike, values: ArrayLike, amplitudes: ArrayLike) -> xarray.Dataset:
    r"""Compute the damping ratio and frequency of a free decay at given amplitudes.

    The damping at an amplitude is the mean over the part of the decay in which the envelope falls through a band around it,
    whose edges are halfway to the nearer neighbour on a logarithmic scale. The rest position, which a weight may shift, is
    removed, and the envelope is smoothed, by means over one cycle around each sample.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s], at least 5 per cycle; the last step may be shorter, and its sample is then not used.
    values : (N,) array_like
        Free decay of one mode; the unit of a DataArray is used.
    amplitudes : (A,) array_like
        At least two ascending amplitudes above zero, in the unit of the values.

    Returns
    -------
    xarray.Dataset
        `damping_ratio`, `frequency` [Hz], and the times `start` and `end` of each band [s], over `amplitude`. They are NaN
        if the decay does not fall through the whole band or passes it in less than half a cycle, and if it enters the band
        in the first three cycles or leaves it in the last three: the envelope is not known there, and in the first cycles
        the decay sets particles at rest in motion.

    Raises
    ------
    ValueError
        If times are not evenly spaced, a sample is not finite, the record is too short or too coarse, or the amplitudes do
        not rise.

    Notes
    -----
    With the envelope :math:`A` and the phase :math:`\varphi` of the analytic signal,

    .. math:: \zeta = \frac{\delta}{\sqrt{1 + \delta^2}}, \qquad \delta = \frac{\ln(A_1 / A_2)}{\varphi_2 - \varphi_1}

    which is exact for a linear decay.

    References
    ----------
    M. Feldman (1994), Non-linear system vibration analysis using Hilbert transform: I. Free vibration analysis method
    'FREEVIB', Mechanical Systems and Signal Processing 8, 119-127, doi:10.1006/mssp.1994.1011.

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
    decay = smooth_decay(time, values)
    # The smallest envelope so far, since particles may return energy to the structure for a while.
    logarithm = np.minimum.accumulate(decay.log_amplitude)
    lower, upper = (np.log(edges) for edges in band_edges(levels))
    ratio, frequency, starts, ends = np.full((4, levels.size), np.nan)
    for k in range(levels.size):
        # A band that the decay does not cross as a whole would have the ratio of a part of it.
        if not logarithm[-1] < lower[k] < upper[k] <= logarithm[0]:
            continue
        (t_high, phase_high), (t_low, phase_low) = (_crossing(decay, logarithm, e) for e in (upper[k], lower[k]))
        turn = phase_low - phase_high
        # Less than half a cycle cannot be told from a change of the rest position.
        if turn < math.pi:
            continue
        # The decrement counts phase instead of time, and so is exact while the frequency changes.
        delta = (upper[k] - lower[k]) / turn
        ratio[k] = delta / math.sqrt(1 + delta**2)
        frequency[k] = turn / (2 * math.pi * (t_low - t_high))
        starts[k], ends[k] = t_high, t_low
    axis = ("amplitude", levels, {"units": units_of(values), "long_name": "amplitude"})
    return xarray.Dataset(
        {
            "damping_ratio": labelled("damping_ratio", ratio, "1", "damping ratio", amplitude=axis),
            "frequency": labelled("frequency", frequency, "Hz", "frequency of the decay", amplitude=axis),
            "start": labelled("start", starts, "s", "time at which the band is entered", amplitude=axis),
            "end": labelled("end", ends, "s", "time at which the band is left", amplitude=axis),
        }
    )


def equivalent_damping(run: Run, amplitude: float | None = None, *, point: str | None = None) -> float:
    r"""Return the damping ratio of the free decay in a run, at one amplitude.

    Studies take it as a measure: `functools.partial(analysis.equivalent_damping, amplitude=0.5e-3)`. One run of chaotic
    motion is one random sample; vary the start or the packing to estimate its scatter, as `rattlebox.damping_curve` does.

    Parameters
    ----------
    run
        Run in which loads and base come to rest.
    amplitude
        Displacement amplitude of the point [m]; default half of the largest amplitude of the decay, or the middle of a
        shorter decay.
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
    The energy of the mode with the largest energy falls from :math:`E_1` to :math:`E_2 = E_1 / 4` about the amplitude in
    the time :math:`t`:

    .. math:: \zeta = \frac{\ln(E_1 / E_2)}{2 \omega t}

    The energy falls in two steps a cycle, so that the relative error of a smooth decay is up to :math:`2 \zeta / \ln 4`:
    1.4 % for a ratio of 0.01, 6 % for 0.04.

    References
    ----------
    E. E. Ungar, E. M. Kerwin (1962), J. Acoust. Soc. Am. 34, 954-957, doi:10.1121/1.1918227.

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


def band_edges(levels: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the lower and upper edges of bands around amplitudes, (A,): halfway to the nearer neighbour, on a log scale."""
    distance = np.diff(np.log(levels))
    half = np.exp(0.5 * np.minimum(np.append(distance, np.inf), np.insert(distance, 0, np.inf)))
    return levels / half, levels * half


def mean_over_period(t: FloatArray, x: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
    """Return the times at least half a period from both ends, (M,), and the mean over one period around each."""
    from scipy.interpolate import CubicSpline

    whole = CubicSpline(t, x).antiderivative()
    inner = t[(t >= t[0] + period / 2) & (t <= t[-1] - period / 2)]
    return inner, np.asarray((whole(inner + period / 2) - whole(inner - period / 2)) / period)


def _crossing(decay: SmoothDecay, falling: FloatArray, level: float) -> tuple[float, float]:
    """Return time and phase at which a falling logarithm of the envelope first reaches a level."""
    k = int(np.argmax(falling <= level))
    if k == 0:
        return float(decay.time[0]), float(decay.phase[0])
    part = (falling[k - 1] - level) / (falling[k - 1] - falling[k])
    time, phase = (float(x[k - 1] + part * (x[k] - x[k - 1])) for x in (decay.time, decay.phase))
    return time, phase
