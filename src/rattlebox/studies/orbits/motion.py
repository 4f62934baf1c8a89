"""One period of a motion in detail: amplitudes, contacts, and the smallest gaps without a contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.prepare.pack import pack

if TYPE_CHECKING:
    from rattlebox.model.case import Case

Vector = NDArray[np.float64]

SAMPLES = 512
"""Number of samples of a period, between which positions are cubic polynomials with an error of about 1e-11."""
MOST_EVENTS = 5_000
"""Largest number of flights and contacts in a stretch; a search may pass through states that no motion has."""
_TOUCHING = 1e-9
"""Gap over the largest gap of the contact, below which the end of an interval belongs to a contact."""


class NearMiss(NamedTuple):
    """Smallest gap between two bodies that do not touch then: a minimum of the gap over time."""

    contact: int
    time: float  # [s]
    gap: float  # [m]


@dataclass(frozen=True)
class GapLines:
    """The gaps of all contacts as linear functions of the state, in the order of the contacts of the core.

    A gap is `by_state` (contacts, n) times the state plus `offset` (contacts,), and its rate `rate_by_state` times the
    state.
    """

    by_state: Vector
    rate_by_state: Vector
    offset: Vector

    @classmethod
    def of(cls, dampers: Sequence[_core.Damper], modes: int) -> GapLines:
        """Return the lines of some dampers on a structure with some modes."""
        balls = sum(int(np.size(damper.mass)) for damper in dampers)
        unit = np.eye(2 * (modes + balls))
        rows, offsets, first = list[Vector](), list[float](), 2 * modes
        for damper in dampers:
            half = 0.5 * float(damper.clearance)
            own = slice(first, first := first + int(np.size(damper.mass)))
            centre = np.asarray(damper.shape) @ unit[0 : 2 * modes : 2]
            if own.start == own.stop:  # a stop
                rows.append(-centre[None])
                offsets.append(half)
            else:
                rows.append(np.diff(np.vstack([centre, unit[own], centre]), axis=0))
                offsets += [half, *np.zeros(own.stop - own.start - 1), half]
        by_state = np.vstack([np.zeros((0, len(unit))), *rows])
        rates = np.zeros_like(by_state)
        rates[:, 1 : 2 * modes : 2] = by_state[:, 0 : 2 * modes : 2]
        rates[:, 2 * modes + balls :] = by_state[:, 2 * modes : 2 * modes + balls]
        return cls(by_state, rates, np.array(offsets))


@dataclass(frozen=True)
class Motion:
    """Samples of a motion, with both sides of each hard impact, and its impacts."""

    time: Vector  # (T,) [s]
    state: Vector  # (T, n), as the core orders it
    impacts: _core.Impacts
    dampers: tuple[_core.Damper, ...]
    modes: int
    sticks: bool  # whether bodies stick together for a time

    def impact_contacts(self) -> NDArray[np.int64]:
        """Return the number of the contact of each impact, counted over all dampers."""
        first = np.cumsum([0, *(int(np.size(damper.mass)) + 1 for damper in self.dampers)])
        return np.asarray(first[np.asarray(self.impacts.damper)] + self.impacts.contact)

    def extremes(self, shape: Vector) -> tuple[float, float]:
        """Return the smallest and the largest displacement of a point with mode shapes (m,) [m]."""
        x, v = self.state[:, 0 : 2 * self.modes : 2] @ shape, self.state[:, 1 : 2 * self.modes : 2] @ shape
        values = np.concatenate([x, _turning_points(self.time, x, v)[1]])
        return float(values.min()), float(values.max())

    def gaps(self) -> tuple[Vector, Vector]:
        """Return the gaps of all contacts and their rates, (T, contacts), in the order of the contacts of the core."""
        lines = GapLines.of(self.dampers, self.modes)
        return self.state @ lines.by_state.T + lines.offset, self.state @ lines.rate_by_state.T

    def near_misses(self) -> list[NearMiss]:
        """Return the minima of all gaps over time at which there is no contact."""
        gap, rate = self.gaps()
        found = []
        size = np.abs(gap).max(axis=0)
        for contact in range(gap.shape[1]):
            times, values = _turning_points(self.time, gap[:, contact], rate[:, contact], rising=True)
            found += [
                NearMiss(contact, float(t), float(g))
                for t, g in zip(times, values, strict=True)
                if g > _TOUCHING * size[contact]
            ]
        return sorted(found, key=lambda miss: miss.gap)


def started(case: Case, state: Vector, duration: float, times: Vector, *, contacts: int = 0) -> _core.Problem:
    """Return the packed case that starts from a state of the core and ends after some time [s]."""
    problem = start_at(pack(case), state, duration, times)
    return problem.replace(settings=problem.settings.replace(contact_samples=contacts))


def start_at(problem: _core.Problem, state: Vector, duration: float, times: Vector) -> _core.Problem:
    """Return a problem that starts from a state and ends after some time [s], with samples at some times."""
    m = 2 * int(problem.mode_decay.size)
    n = sum(int(np.size(damper.mass)) for damper in problem.dampers)
    dampers, first = [], m
    for damper in problem.dampers:
        own = slice(first, first := first + int(np.size(damper.mass)))
        place, speed = (np.ascontiguousarray(part) for part in (state[own], state[own.start + n : own.stop + n]))
        dampers.append(damper.replace(position=place, velocity=speed))
    return problem.replace(
        mode_displacement=np.ascontiguousarray(state[0:m:2]),
        mode_velocity=np.ascontiguousarray(state[1:m:2]),
        dampers=dampers,
        sample_times=times,
        settings=problem.settings.replace(duration=duration),
    )


def strobes(case: Case, state: Vector, period: float, count: int) -> Vector | None:
    """Return the state at whole periods of a motion, (count + 1, n); None if it cannot be computed."""
    times: Vector = period * np.arange(count + 1, dtype=float)
    problem = started(case, state, float(times[-1]), np.asarray(times, dtype=float))
    most = min(problem.settings.max_events, MOST_EVENTS * count)
    (raw,) = _core.simulate([problem.replace(settings=problem.settings.replace(max_events=most))], 1)
    return raw.state[:, : state.size] if raw.status == Status.finished else None


def motion_of(case: Case, state: Vector, duration: float) -> Motion | None:
    """Return a motion with its samples; None if it cannot be computed."""
    problem = started(case, state, duration, np.linspace(0, duration, SAMPLES + 1), contacts=MOST_EVENTS)
    most = min(problem.settings.max_events, MOST_EVENTS)
    problem = problem.replace(settings=problem.settings.replace(max_events=most))
    (raw,) = _core.simulate([problem], 1)
    if raw.status != Status.finished:
        return None
    size = 2 * (int(problem.mode_decay.size) + sum(int(np.size(damper.mass)) for damper in problem.dampers))
    dampers, modes = tuple(problem.dampers), int(problem.mode_decay.size)
    return Motion(raw.time, raw.state[:, :size], raw.impacts, dampers, modes, raw.counts.sticks > 0)


def _turning_points(time: Vector, x: Vector, v: Vector, *, rising: bool = False) -> tuple[Vector, Vector]:
    """Return times and values of the extremes inside the intervals; only minima if `rising`.

    Between two samples x is the cubic polynomial with the values and slopes at both.
    """
    h = np.diff(time)
    inside = (h > 0) & ((v[:-1] < 0) & (v[1:] > 0) if rising else v[:-1] * v[1:] < 0)
    k = np.flatnonzero(inside)
    h, a, b = h[k], v[k], v[k + 1]
    slope = (x[k + 1] - x[k]) / h
    # v(s) = a + 2 c s + 3 d s^2 on 0 <= s <= 1, in units of the interval
    c, d = 3 * slope - 2 * a - b, a + b - 2 * slope
    # The root between both samples, without cancellation if d is small.
    root = np.sqrt(np.maximum(c * c - 3 * a * d, 0.0))
    sign = np.where(b > a, 1.0, -1.0)
    steep = c + sign * root
    # Velocities that are constant to rounding have no root of their own.
    s = np.clip(-a / np.where(steep == 0, 1.0, steep), 0.0, 1.0)
    return time[k] + s * h, x[k] + h * (a * s + c * s**2 + d * s**3)
