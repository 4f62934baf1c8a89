"""Velocity and displacement of the base from its acceleration, exact for every signal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.model.harmonics import Harmonic
from rattlebox.model.shocks import HalfSine
from rattlebox.model.signals import Signal

if TYPE_CHECKING:
    from numpy.typing import NDArray


def base_motion(signal: Signal, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integrate the acceleration of the base twice, without discretisation error.

    Parameters
    ----------
    signal
        Acceleration [m/s^2].
    time : (T,) float
        Times [s].

    Returns
    -------
    (3, T) float
        Displacement [m], velocity [m/s], acceleration [m/s^2]. An unlimited harmonic that starts at 0 has zero mean
        displacement and velocity; every other signal starts from rest.

    Notes
    -----
    v(t) is the integral of a from 0 to t, u(t) that of v. A sin(w t + phi) has u = -A sin(w t + phi) / w^2 and v = -A cos(w
    t + phi) / w, less their values at the start, if it has one; a half sine likewise. A record is linear between its
    samples, a + s t, so that over an interval v = v_0 + a t + s t^2 / 2 and u = u_0 + v_0 t + a t^2 / 2 + s t^3 / 6. There
    is no correction of the baseline: the mean of a record is part of its motion.
    """
    if isinstance(signal, Harmonic):
        omega = 2 * math.pi * signal.frequency
        angle = omega * time + signal.phase
        acceleration = signal.evaluate(time)
        velocity = -signal.amplitude / omega * np.cos(angle)
        displacement = -signal.amplitude / omega**2 * np.sin(angle)
        if signal.start == 0 and signal.stop is None:
            return np.array([displacement, velocity, acceleration])
        stop = math.inf if signal.stop is None else signal.stop
        first = omega * signal.start + signal.phase
        v0, u0 = -signal.amplitude / omega * math.cos(first), -signal.amplitude / omega**2 * math.sin(first)
        inside = np.clip(time, signal.start, stop)
        angle = omega * inside + signal.phase
        v = -signal.amplitude / omega * np.cos(angle) - v0
        u = -signal.amplitude / omega**2 * np.sin(angle) - u0 - v0 * (inside - signal.start)
        return np.array([u + v * np.maximum(time - stop, 0.0), v, acceleration])
    if isinstance(signal, HalfSine):
        omega = math.pi / signal.duration
        s = np.clip(time - signal.start, 0, signal.duration)
        v = signal.amplitude / omega * (1 - np.cos(omega * s))
        u = signal.amplitude / omega * (s - np.sin(omega * s) / omega)
        late = np.maximum(time - signal.start - signal.duration, 0.0)
        return np.array([u + v * late, v, signal.evaluate(time)])
    values = signal.coefficients()
    t, a = values["times"], values["values"]
    h = np.diff(t)
    v_knots = np.concatenate([[0.0], np.cumsum(h * (a[1:] + a[:-1]) / 2)])
    u_knots = np.concatenate([[0.0], np.cumsum(h * v_knots[:-1] + h**2 * (2 * a[:-1] + a[1:]) / 6)])

    def integrate(at: Any) -> tuple[Any, Any]:
        k = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
        s = at - t[k]
        slope = (a[k + 1] - a[k]) / h[k]
        v = v_knots[k] + s * (a[k] + s * slope / 2)
        return v, u_knots[k] + s * (v_knots[k] + s * (a[k] / 2 + s * slope / 6))

    v, u = integrate(time)
    if t[0] < 0:  # The base is at rest at time 0, whatever the record contains before it.
        v0, u0 = integrate(0.0)
        v, u = v - v0, u - u0 - v0 * time
    return np.array([u, v, signal.evaluate(time)])
