"""Detection of the first touch in random flights, many of them grazing, against an independent solution and search."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from support import impact_cases

import rattlebox as rb

Array = NDArray[np.float64]
DURATION = 1.0
GRID = 4001
CLOSE = 1e-9
"""Minimum gaps below this fraction of the clearance cannot be distinguished from touching in double precision."""


@dataclass(frozen=True)
class Flights:
    """Random flights of one kind: modes, a pulse or a steady load, a ball; shapes (N, m) and (N,)."""

    rate: Array
    ratio: Array
    shape: Array
    q: Array
    p: Array
    harmonic: bool
    force: Array
    omega: Array
    phase: Array
    clearance: Array
    ball: Array
    speed: Array
    gravity: Array

    def cavity(self, k: NDArray[np.intp], t: Array) -> Array:
        """Return the displacement of the cavity of flights k (K,) at times t (K, T), free and forced motion."""
        total = np.zeros_like(t)
        for j in range(self.rate.shape[1]):
            w, z, f = self.rate[k, j, None], self.ratio[k, j, None], self.shape[k, j, None]
            omega, load = self.omega[k, None], f * self.force[k, None]
            phase = self.phase[k, None]
            q, p = self.q[k, j, None], self.p[k, j, None]
            # i omega response to load * sin(omega t + phase)
            gain = load / (w * w - omega * omega + 2j * z * w * omega)
            q0, p0 = (gain * np.exp(1j * phase)).imag, (gain * 1j * omega * np.exp(1j * phase)).imag
            stop = np.pi / omega
            inside = np.ones_like(t, bool) if self.harmonic else t < stop
            forced = (gain * np.exp(1j * (omega * t + phase))).imag + _free(w, z, q - q0, p - p0, t)
            if not self.harmonic:
                # After a half sine the continued load is cancelled by the same load started at its end.
                late = np.maximum(t - stop, 0)
                echo = (gain * np.exp(1j * omega * late)).imag + _free(
                    w, z, -gain.imag, -(gain * 1j * omega).imag, late
                )
                forced = forced + np.where(inside, 0, echo)
            total += f * forced
        return total

    def margin(self, k: NDArray[np.intp], t: Array) -> tuple[Array, Array]:
        """Return the gaps to the trailing and leading wall of flights k at times t."""
        s = self.ball[k, None] + self.speed[k, None] * t + 0.5 * self.gravity[k, None] * t * t
        off = s - self.cavity(k, t)
        half = 0.5 * self.clearance[k, None]
        return half + off, half - off

    def case(self, k: int) -> Any:
        """Return flight k as a case; the first touch is the first impact of its log."""
        names = {"frequency": f"{float(self.omega[k])!r} rad/s", "phase": float(self.phase[k])}
        load = (
            rb.Harmonic(amplitude=float(self.force[k]), point="tip", **names)
            if self.harmonic
            else rb.HalfSine(amplitude=float(self.force[k]), duration=float(np.pi / self.omega[k]), point="tip")
        )
        gap = float(0.5 * self.clearance[k])
        return rb.Case(
            structure=rb.Modal(
                frequencies=list(self.rate[k] / (2 * np.pi)),
                damping_ratios=list(self.ratio[k]),
                shapes={"tip": list(self.shape[k])},
                displacement=list(self.q[k]),
                velocity=list(self.p[k]),
            ),
            damper=rb.ImpactDamper(
                ball=impact_cases.ball(1e-3),
                gap=gap,
                start=float(self.ball[k] - self.shape[k] @ self.q[k]) / gap,
                velocity=float(self.speed[k]),
                gravity=float(self.gravity[k]),
                point="tip",
                contact=rb.Tsuji(restitution=0.5),
            ),
            load=load,
            duration=DURATION,
            method=rb.EventDriven(max_events=1000),
            output=rb.Output(times=[0.0]),
        )


def _free(w: Array, z: Array, q: Array, p: Array, t: Array) -> Array:
    wd = w * np.sqrt(1 - z * z)
    return np.exp(-z * w * t) * (q * np.cos(wd * t) + (p + z * w * q) / wd * np.sin(wd * t))


def random_flights(modes: int, harmonic: bool, count: int, seed: int) -> Flights:
    """Return random flights; the clearance of half of them is such that they graze or nearly miss."""
    rng = np.random.default_rng(seed)
    shape = (count, modes)
    flights = Flights(
        rate=2 * np.pi * np.sort(rng.uniform(1, 30, shape), axis=1),
        ratio=10 ** rng.uniform(-4, -0.5, shape),
        shape=rng.uniform(0.2, 1, shape) * rng.choice([-1, 1], shape),
        q=1e-3 * rng.normal(size=shape),
        p=5e-2 * rng.normal(size=shape),
        harmonic=harmonic,
        force=rng.normal(size=count) * (3 if harmonic else 10),
        omega=2 * np.pi * 10 ** rng.uniform(0, 1.6, count),
        phase=rng.uniform(0, 2 * np.pi, count) if harmonic else np.zeros(count),
        clearance=10 ** rng.uniform(-2.3, -1.3, count),
        ball=np.zeros(count),
        speed=1e-2 * rng.normal(size=count),
        gravity=1e-2 * rng.normal(size=count),
    )
    start = flights.cavity(np.arange(count), np.zeros((count, 1)))[:, 0]
    flights.ball[:] = start * rng.uniform(0, 1, count)
    # Graze: the clearance is such that the first extreme of the offset just reaches or misses a wall.
    k = np.arange(0, count, 2)
    t = np.linspace(0, DURATION, GRID)[None, :]
    for part in np.array_split(k, max(1, k.size // 250)):
        off = np.abs(flights.margin(part, np.broadcast_to(t, (part.size, GRID)))[0] - flights.clearance[part, None] / 2)
        peak = (off[:, 1:-1] > off[:, :-2]) & (off[:, 1:-1] >= off[:, 2:])
        first = np.where(peak.any(axis=1), peak.argmax(axis=1) + 1, GRID // 2)
        top = off[np.arange(part.size), first]
        dip = 10 ** rng.uniform(-8, -3, part.size) * rng.choice([-1, 1], part.size)
        flights.clearance[part] = np.maximum(2 * top * (1 - dip), 4 * np.abs(flights.ball[part] - start[part]) + 1e-6)
    # The ball starts inside by a fraction of the clearance, in the frames of both the base and the cavity.
    flights.clearance[:] = np.maximum(flights.clearance, 2.2 * (np.abs(flights.ball) + np.abs(start)))
    return flights


def first_touches(flights: Flights, k: NDArray[np.intp]) -> tuple[Array, NDArray[np.intp], Array]:
    """Return the first touches, by a fine grid with refined minima and bisection.

    Returns time (infinite where there is none), side, and the margin of the decision near tangents: the
    smallest |gap| over the clearance among the minima before the touch.
    """
    t = np.linspace(0, DURATION, GRID)
    n = k.size
    time, side, margin = np.full(n, np.inf), np.full(n, -1), np.full(n, np.inf)
    margins = flights.margin(k, np.broadcast_to(t, (n, GRID)))
    for wall, gap in enumerate(margins):
        dips = (gap[:, 1:-1] <= gap[:, :-2]) & (gap[:, 1:-1] <= gap[:, 2:])
        curve = gap[:, 2:] - 2 * gap[:, 1:-1] + gap[:, :-2]
        # Minima that may be below zero by a parabola through three points are refined by golden section.
        near = dips & (gap[:, 1:-1] < 4 * np.abs(curve) + 1e-3 * flights.clearance[k, None])
        row, column = np.nonzero(near)
        low, high = t[column], t[column + 2]
        ratio = 0.5 * (np.sqrt(5) - 1)

        def value(row: NDArray[np.intp], at: Array, wall: int = wall) -> Array:
            return flights.margin(k[row], at[:, None])[wall][:, 0]

        for _ in range(45):
            a, b = high - ratio * (high - low), low + ratio * (high - low)
            left = value(row, a) < value(row, b)
            low, high = np.where(left, low, a), np.where(left, b, high)
        bottom = 0.5 * (low + high)
        depth = value(row, bottom)
        # Brackets: the first grid point or refined minimum that is beyond the wall.
        beyond = gap < 0
        grid_hit = np.where(beyond.any(axis=1), beyond.argmax(axis=1), GRID)
        high = np.where(grid_hit < GRID, t[np.minimum(grid_hit, GRID - 1)], np.inf)
        low = np.where(grid_hit < GRID, t[np.maximum(np.minimum(grid_hit, GRID - 1) - 1, 0)], 0)
        for r, c, at, g in zip(row, column, bottom, depth, strict=True):
            if at < high[r]:
                margin[r] = min(margin[r], abs(g) / flights.clearance[k[r]])
                if g < 0:
                    high[r], low[r] = at, t[c]
        hit = np.nonzero(np.isfinite(high))[0]
        low, high = low[hit], high[hit]
        for _ in range(60):
            middle = 0.5 * (low + high)
            inside = value(hit, middle) > 0
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        result = 0.5 * (low + high)
        better = result < time[hit]
        time[hit[better]], side[hit[better]] = result[better], wall
    return time, side, margin


KINDS = pytest.mark.parametrize(
    ("modes", "harmonic", "share"),
    [(1, False, 0.35), (1, True, 0.25), (3, False, 0.25), (4, True, 0.15)],
    ids=["one mode, pulse", "one mode, steady load", "three modes, pulse", "four modes, steady load"],
)


@KINDS
def test_no_first_touch_of_some_is_missed(modes: int, harmonic: bool, share: float) -> None:
    """The engine finds every first touch of a brute-force search, at its time, and no others."""
    compare(modes, harmonic, int(400 * share))


@pytest.mark.slow
@KINDS
def test_no_first_touch_of_ten_thousand_is_missed(modes: int, harmonic: bool, share: float) -> None:
    """The engine finds every first touch of ten thousand flights, and no others."""
    compare(modes, harmonic, int(10_000 * share))


def compare(modes: int, harmonic: bool, count: int) -> None:
    """Compare the first touches of random flights."""
    flights = random_flights(modes, harmonic, count, seed=100 * modes + harmonic)
    parts = np.array_split(np.arange(count), max(1, count // 250))
    result = [first_touches(flights, part) for part in parts]
    time, side, margin = (np.concatenate(v) for v in zip(*result, strict=True))
    runs = rb.simulate_many([flights.case(k) for k in range(count)], threads=2)
    clear = margin > CLOSE
    assert clear.mean() > 0.95
    ours, wall = np.full(count, np.inf), np.full(count, -1)
    for k, run in enumerate(runs):
        log = run.arrays.impacts
        if len(log):
            ours[k], wall[k] = log.time[0], log.contact[0]
    hit = np.isfinite(time)
    assert 0.2 < hit[clear].mean() < 0.98
    wrong = np.nonzero(clear & (np.isfinite(ours) != hit))[0]
    assert wrong.size == 0, f"flights {wrong[:10]}: brute force {time[wrong[:10]]}, ours {ours[wrong[:10]]}"
    both = clear & hit
    assert np.array_equal(wall[both], side[both])
    # The time of a grazing touch is known to rounding error over its slope, which is the root of the depth of the minimum.
    expected = 1e-9 + 1e-15 / np.sqrt(np.minimum(margin[both], 1.0)) * 1e3
    assert np.all(np.abs(ours[both] - time[both]) <= expected)


def test_brute_force_finds_a_known_touch() -> None:
    """The brute-force search finds the touch of a freely flying ball in a cavity at rest."""
    one = np.ones((1, 1))
    flights = Flights(
        rate=10 * one,
        ratio=0.1 * one,
        shape=one,
        q=0 * one,
        p=0 * one,
        harmonic=True,
        force=np.zeros(1),
        omega=np.ones(1),
        phase=np.zeros(1),
        clearance=np.full(1, 0.02),
        ball=np.zeros(1),
        speed=np.full(1, 0.025),
        gravity=np.zeros(1),
    )
    time, side, _ = first_touches(flights, np.array([0]))
    assert time[0] == pytest.approx(0.4, rel=1e-12)
    assert side[0] == 1
