"""Cutting with a delayed force, step by step: an independent check of the stability limit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import rattlebox as rb

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Vibration:
    """Amplitude of the tip over the cycles of a simulation, (n,)."""

    amplitude: FloatArray

    def growth(self, first: int) -> float:
        """Return the relative growth in a cycle from a cycle on, by least squares through the logarithm."""
        logs = np.log(self.amplitude[first:])
        return float(np.polyfit(np.arange(logs.size), logs, 1)[0])

    def mean(self, first: int) -> float:
        """Return the mean amplitude from a cycle on."""
        return float(np.exp(np.log(self.amplitude[first:]).mean()))


def cut(
    structure: Any,
    damper: Any,
    stiffness: float,
    period: float,
    omega: float,
    amplitude: float,
    cycles: int,
    **options: Any,
) -> Vibration:
    """Return the vibration of a tool that cuts with the force -stiffness (y(t) - y(t - period)).

    Parameters
    ----------
    stiffness
        Depth of cut times cutting coefficient, teeth in cut and directional factor [N/m].
    omega, amplitude
        Harmonic motion before the start [rad/s], [m].
    options
        Further fields of the case; `steps` is the number of steps in a cycle, default 200.
    """
    steps = options.pop("steps", 200)
    # A whole number of steps in the delay. The load of a step is its mean value, to second order that in its middle.
    count = max(round(period * omega * steps / (2 * math.pi)), 1)
    length = period / count
    start = {"displacement": 0.0, "velocity": amplitude * omega}
    case = rb.Case(
        structure=structure.model_copy(update=start),
        dampers=() if damper is None else (damper,),
        load=rb.Harmonic(amplitude=stiffness * amplitude, frequency=omega / (2 * math.pi)),
        duration="10 s",
        **options,
    )
    stepper = rb.Stepper(case)
    total = math.ceil(cycles * 2 * math.pi / (omega * length))
    place, speed = np.empty(total + 1), np.empty(total + 1)
    place[0], speed[0] = 0.0, amplitude * omega
    axis = getattr(damper, "direction", None)
    for n in range(total):
        middle = (n + 0.5) * length
        back = n - count
        if back < 0:  # the motion before the start
            before = amplitude * math.sin(omega * (middle - period))
        else:
            before = 0.5 * (place[back] + place[back + 1]) + 0.125 * length * (
                speed[back] - speed[back + 1]
            )  # cubic, in the middle
        now = place[n] + 0.5 * length * speed[n]
        if n:
            now += 0.125 * length * (speed[n] - speed[n - 1])
        stepper.advance((n + 1) * length, loads=[-stiffness * (now - before)])
        moved, velocity = stepper.displacement(), stepper.velocity()
        if axis is not None:
            k = "xyz".index(axis)
            moved, velocity = moved[k], velocity[k]
        place[n + 1], speed[n + 1] = moved, velocity
    per_cycle = 2 * math.pi / (omega * length)
    turn = np.exp(-1j * omega * length * np.arange(total + 1))
    ends = np.round(np.arange(0, total, per_cycle)).astype(int)
    # First harmonic of each two cycles, without their mean, which is the deflection by weight or drift.
    found = []
    for first, last in zip(ends, ends[2:], strict=False):
        part = place[first:last] - place[first:last].mean()
        found.append(2 * abs((part * turn[first:last]).mean()))
    return Vibration(np.array(found))
