"""Damping ratio of the free decay in a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .arrays import RunArrays

_BAND = 4.0
"""Energy at the start over energy at the end of the part of the decay that is evaluated: twice the amplitude."""


class Decay(NamedTuple):
    """Damping ratio of a free decay about an amplitude [m] of a point, and the number of its mode, counted from 1."""

    damping_ratio: float
    amplitude: float
    point: str
    mode: int


def free_decay(arrays: RunArrays, amplitude: float | None = None, point: str | None = None) -> Decay | None:
    """Return the damping ratio of the free decay in a run.

    `amplitude`: amplitude of the point [m]; default half of the largest one of the decay, or the middle of a shorter decay.

    Notes
    -----
    The decay begins at the largest energy of the mode after loads and base have come to rest. The mode is the one with the
    largest energy E there, without the offset of its last quarter. While E falls from E_1 to E_2 in the time t,
    zeta = ln(E_1 / E_2) / (2 omega t), exact for a linear oscillator of small damping. E_1 / E_2 = 4 about the amplitude.

    References
    ----------
    R. W. Clough, J. Penzien (1993), Dynamics of Structures, 2nd ed., McGraw-Hill, ISBN 0-07-011394-7.
    """
    time, omega = arrays.time, 2 * math.pi * arrays.mode_frequency
    # A decay is free from the moment on at which no load and no motion of the base acts any more.
    acting = np.zeros(time.size, bool)
    for values in (arrays.load, arrays.base_acceleration.reshape(time.size, -1)):
        if values.size:
            acting |= (np.abs(values) > 1e-3 * np.abs(values).max()).any(axis=1)
    start = int(np.flatnonzero(acting)[-1]) + 1 if acting.any() else 0
    if start > 0.9 * time.size or time.size - start < 8 or not (omega > 0).any():
        return None
    time, q, p = time[start:], arrays.modal_displacement[start:], arrays.modal_velocity[start:]
    # The mean of the last quarter is the static offset, such as that of gravity, about which the mode swings.
    late = time >= time[-1] - 0.25 * (time[-1] - time[0])
    energy = np.where(omega > 0, 0.5 * (p**2 + (omega * (q - q[late].mean(axis=0))) ** 2), 0.0)
    # The mode with the most energy decides; one that never moved, or diverged, has no decay.
    top = energy.max(axis=0)
    if not (np.isfinite(top).all() and top.max() > 0):
        return None
    mode = int(np.argmax(top))
    # Files of runs have no mode shapes: they follow from displacements, which are linear in the modal ones.
    shapes = np.linalg.lstsq(arrays.modal_displacement, arrays.displacement, rcond=None)[0][mode]
    number = arrays.points.index(point) if point is not None else int(np.argmax(np.abs(shapes)))
    scale = abs(float(shapes[number]))
    if scale == 0:
        return None
    first = int(np.argmax(energy[:, mode]))
    # Impacts feed energy back now and then; the least energy so far only falls, so that each level is passed once.
    time, decay = time[first:], np.minimum.accumulate(energy[first:, mode])
    # Without an amplitude, the middle of the decay; a short decay is evaluated over as much as it falls.
    if amplitude is None:
        fall = min(2 * _BAND, decay[0] / decay[-1]) if decay[-1] > 0 else 2 * _BAND
        low, span = decay[0] / fall, min(_BAND, fall)
    else:
        low, span = 0.5 * (omega[mode] * amplitude / scale) ** 2 / math.sqrt(_BAND), _BAND
    if not (span > 1.2 and decay[0] >= low * span * (1 - 1e-9) and decay[-1] <= low):
        return None
    duration = _time_of(time, decay, low) - _time_of(time, decay, low * span)
    # Within less than a period the energy of a mode is not defined by its samples.
    if duration * omega[mode] < 2 * math.pi:
        return None
    middle = math.sqrt(2 * low * math.sqrt(span)) / omega[mode] * scale
    ratio = math.log(span) / (2 * omega[mode] * duration)
    return Decay(float(ratio), float(middle), arrays.points[number], mode + 1)


def _time_of(time: NDArray[np.float64], decay: NDArray[np.float64], level: float) -> float:
    """Return the time at which a falling energy reaches a level, between samples in the logarithm."""
    k = int(np.argmax(decay <= level))
    if k == 0 or decay[k] <= 0:
        return float(time[k])
    part = math.log(decay[k - 1] / level) / math.log(decay[k - 1] / decay[k])
    return float(time[k - 1] + part * (time[k] - time[k - 1]))
