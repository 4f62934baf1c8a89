"""Reductions of motions to numbers: period and kind of a motion, its first harmonic, harmonics of the force on particles."""

from __future__ import annotations

import json
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.batch_means import half_widths
from rattlebox._util.flags import flag_values
from rattlebox.analysis.shaken import force_harmonics
from rattlebox.studies.work.measures import INTERVAL
from rattlebox.studies.work.work import Extra, Outputs, Signals

if TYPE_CHECKING:
    import xarray

    from rattlebox.core import _core


# ---- motions by their stroboscopic states, one per cycle


Vector = NDArray[np.float64]
Whole = NDArray[np.int64]
Mask = NDArray[np.bool_]

_MAX_ATTRACTORS = 256
_ROWS = 2048
"""Motions classified at once, which bounds the memory."""
_ROUNDING = 1e-9
"""Differences of dimensionless states that are not examined for a trend."""
_GOOD, _NEARLY_EXACT = 0.02, 1e-6
"""Share of the differences that a linear map may leave: to be a description at all, and to need one multiplier only."""
_EXACTLY = 1e-3
"""Standard error of a multiplier below which the differences need not be seen to fall."""
_FALL = 0.03
"""Ratio of the last to the first differences below which a motion contracts, whatever map it follows."""


class Motion(IntEnum):
    """Kind of a motion: not finished, periodic, contracting towards a periodic one, or neither."""

    NOT_FINISHED = 0
    PERIODIC = 1
    TRANSIENT = 2
    IRREGULAR = 3


KINDS_OF_MOTION = flag_values(kind.name.lower() for kind in Motion)
"""Attributes of a variable with kinds of motions."""


class Orbits(NamedTuple):
    """Classification of motions."""

    period: Whole
    motion: Whole
    multiplier: Vector
    residual: Vector


def reduced_strobes(maps: xarray.Dataset, packed: _core.Problem, period: object) -> tuple[Vector, Vector]:
    """Return stroboscopic states with velocities as lengths, and the range of each component, in gaps.

    Lengths are divided by the gap of the damper (of the first one for the structure; without balls by the amplitude),
    velocities by gap times angular frequency. In motions without impacts, in which balls drift freely, positions and
    velocities of balls are zero.

    `maps`: strobes over a grid: `displacement`, `velocity` (..., sample), `relative_position`, `relative_velocity` (...,
    sample, ball), `impacts` and `largest_approach_speed`. `period`: length of a cycle [s], broadcastable to the grid.
    """
    shape = maps.status.shape
    gaps = [np.broadcast_to(0.5 * np.asarray(d.clearance), shape) for d in packed.dampers for _ in d.mass]
    omega = np.broadcast_to(2 * np.pi / np.asarray(period), shape)
    hit = (maps.impacts.values > 0)[..., None]
    size = gaps[0] if gaps else np.hypot(maps.displacement.values, maps.velocity.values / omega[..., None]).max(axis=-1)
    size = np.where(size > 0, size, 1.0)
    parts = [maps.displacement.values / size[..., None], maps.velocity.values / (size * omega)[..., None]]
    amplitude = np.hypot(*parts).max(axis=-1)
    ranges = [amplitude, amplitude]
    speed = maps.largest_approach_speed.values
    for ball, gap in enumerate(gaps):
        place, rate = maps.relative_position.values[..., ball], maps.relative_velocity.values[..., ball]
        parts += [np.where(hit, place / gap[..., None], 0.0), np.where(hit, rate / (gap * omega)[..., None], 0.0)]
        reach = speed / (gap * omega)
        ranges += [np.minimum(reach, 1.0), reach]
    # A component at rest, and a ball that rests on its wall, move by rounding only.
    return np.stack(parts, axis=-1), np.maximum(np.nan_to_num(np.stack(ranges, axis=-1)), 1e-6)


def classify(strobes: Vector, tolerance: float, apart: float) -> Orbits:
    """Classify motions as periodic, transient or irregular.

    `strobes`: states over the range of the motion, (..., sample, component).
    """
    shape = strobes.shape[:-2]
    flat = strobes.reshape(-1, *strobes.shape[-2:])
    parts = [_classify(flat[k : k + _ROWS], tolerance, apart) for k in range(0, len(flat), _ROWS)]
    return Orbits(*(np.concatenate(column).reshape(shape) for column in zip(*parts, strict=True)))


def _classify(strobes: Vector, tolerance: float, apart: float) -> Orbits:
    """Classify motions, (n, sample, component)."""
    rows, count = strobes.shape[:2]
    longest = max(count // 2, 1)
    finite: Mask = np.asarray(np.isfinite(strobes).all(axis=(1, 2)))
    strobes = np.where(finite[:, None, None], strobes, 0.0)
    largest = np.empty((longest + 1, rows))
    period = np.zeros(rows, np.int64)
    motion = np.where(finite, Motion.IRREGULAR, Motion.NOT_FINISHED).astype(np.int64)
    multiplier = np.full(rows, np.nan)
    open_ = finite.copy()
    # The shortest period wins: a motion of period n also repeats after 2 n, and a longer candidate is never tried for it.
    for n in range(1, longest + 1):
        steps = strobes[:, n:] - strobes[:, :-n]
        largest[n] = np.abs(steps).max(axis=(1, 2))
        if not open_.any():
            continue
        verdict = _settled(steps[open_], strobes[open_], n, tolerance)
        settled, contracting, factor = (np.zeros(rows, kind) for kind in (bool, bool, float))
        settled[open_], contracting[open_], factor[open_] = verdict
        period[settled] = n
        motion[settled] = Motion.PERIODIC
        motion[contracting] = Motion.TRANSIENT
        multiplier[contracting] = factor[contracting]
        open_ &= ~(settled | contracting)
    # Motions that no linear map describes, such as those with rare grazing impacts, may still come together.
    falling, factor = _falls(strobes)
    late = open_ & falling
    motion[late], multiplier[late] = Motion.TRANSIENT, factor[late]
    # States closer than `apart` are one: the period is the smallest divisor after which the motion is that close.
    for n in np.unique(period[period > 0]):
        for divisor in range(1, n):
            if n % divisor == 0:
                period[(period == n) & (largest[divisor] <= apart)] = divisor
    residual = np.where(period > 0, largest[np.maximum(period, 1), np.arange(rows)], largest[1:].min(axis=0))
    return Orbits(period, motion, multiplier, np.where(finite, residual, np.nan))


def _settled(steps: Vector, strobes: Vector, n: int, tolerance: float) -> tuple[Mask, Mask, Vector]:
    """Return which motions have the period n, which contract towards one, and the multiplier per cycle of the latter.

    `strobes`: the states, (k, sample, component).
    """
    size = np.abs(steps).max(axis=2)
    # Close is not enough: a slow contraction has small differences far from its limit. The map tells how far.
    close = size.max(axis=1) <= tolerance
    exact = size.max(axis=1) <= _ROUNDING
    samples = steps.shape[1]
    if samples < n + 2:
        # Too few returns to see whether the differences fall: they must be far below the tolerance.
        return exact | (size.max(axis=1) <= 0.01 * tolerance), np.zeros(len(steps), bool), np.full(len(steps), np.nan)
    good, factor, error, gain = _linear_map(steps, n)
    parts = np.array([part.max(axis=1) for part in np.array_split(size, 3 if samples >= 6 else 2, axis=1)])
    falls = (np.diff(parts, axis=0) < 0).all(axis=0)
    contracting = good & (falls | (error < _EXACTLY)) & (factor < 1 - 3 * error)
    # Chaotic and quasi-periodic motion may come closer to itself for once: longer periods must be seen several times.
    clear = contracting & (n == 1 or samples >= 4 * n + 2) & ((n == 1) | (parts[-1] < 0.5 * parts[0]))
    # The distance to the limit follows from the last differences, which are (map - 1) times the distance.
    end = size[:, -max(n, samples // 4) :].max(axis=1)
    near = end <= tolerance * gain
    # Differences that no linear map describes are noise, if the states stay together over the whole window.
    whole = strobes[:, strobes.shape[1] % n :]
    spread = np.ptp(whole.reshape(len(whole), -1, n, whole.shape[2]), axis=1).max(axis=(1, 2))
    settled = exact | (contracting & close & near) | (~good & close & (spread <= tolerance))
    with np.errstate(divide="ignore", invalid="ignore"):
        return settled, clear & ~settled, factor ** (1 / n)


def _linear_map(steps: Vector, n: int) -> tuple[Mask, Vector, Vector, Vector]:
    """Fit differences of states by a linear map of n cycles with one or two multipliers, by least squares."""
    now, before = steps[:, n:], steps[:, :-n]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        # One multiplier: differences that shrink along one direction, as of most contractions.
        power = (now * now).sum(axis=(1, 2))
        slope = (now * before).sum(axis=(1, 2)) / (before * before).sum(axis=(1, 2))
        left = 1 - slope * (now * before).sum(axis=(1, 2)) / power
        factor, gain, freedom = np.abs(slope), np.abs(slope - 1), now.shape[1] - 1
        freedoms = np.full(len(steps), float(max(freedom, 1)))
        if steps.shape[1] >= 2 * n + 4:
            new, mid, old = steps[:, 2 * n :], steps[:, n:-n], steps[:, : -2 * n]
            a11, a12, a22 = ((p * q).sum(axis=(1, 2)) for p, q in ((mid, mid), (mid, old), (old, old)))
            b1, b2, total = ((new * q).sum(axis=(1, 2)) for q in (mid, old, new))
            det = a11 * a22 - a12 * a12
            p, q = (b1 * a22 - b2 * a12) / det, (b2 * a11 - b1 * a12) / det
            rest = 1 - (p * b1 + q * b2) / total
            # Two multipliers, as of a spiral, only where one is not enough: the second would be arbitrary.
            two = (left > _NEARLY_EXACT) & (det > 1e-12 * a11 * a22) & np.isfinite(rest)
            root = np.sqrt((p * p + 4 * q).astype(complex))
            roots = np.stack([(p + root) / 2, (p - root) / 2])
            factor = np.where(two, np.abs(roots).max(axis=0), factor)
            gain = np.where(two, np.abs(roots - 1).min(axis=0), gain)
            left = np.where(two, rest, left)
            freedoms = np.where(two, float(max(new.shape[1] - 2, 1)), freedoms)
        error = np.sqrt(np.maximum(left, 1e-12) / freedoms)
    good = np.isfinite(factor) & (left < _GOOD)
    return good, np.where(good, factor, np.inf), error, np.where(good, gain, 0.0)


def _falls(strobes: Vector) -> tuple[Mask, Vector]:
    """Return which motions come together for any number of cycles, and the factor per cycle."""
    count = strobes.shape[1]
    falling, factor = np.zeros(len(strobes), bool), np.full(len(strobes), np.nan)
    for n in range(1, count // 8 + 1):
        size = np.abs(strobes[:, n:] - strobes[:, :-n]).max(axis=2)
        third = size.shape[1] // 3
        first, last = size[:, :third].max(axis=1), size[:, -third:].max(axis=1)
        new = ~falling & (last < _FALL * first)
        falling |= new
        factor[new] = (np.maximum(last[new], 1e-300) / first[new]) ** (1 / (size.shape[1] - third))
    return falling, factor


def labels(over: tuple[Any, ...], orbits: Orbits) -> dict[str, Any]:
    """Return the variables `period`, `motion` and `multiplier` of a study."""
    attrs: dict[str, dict[str, Any]] = {
        "period": {"long_name": "cycles after which the motion repeats"},
        "motion": {"long_name": "kind of motion", **KINDS_OF_MOTION},
        "multiplier": {"long_name": "estimated factor per cycle of the distance to the periodic motion"},
    }
    return {name: (over, getattr(orbits, name), {"units": "1", **more}) for name, more in attrs.items()}


def without_speed(runs: xarray.Dataset, measures: Any) -> xarray.Dataset:
    """Return runs without the largest approach speed, which `reduced_strobes` needs, unless it was requested."""
    name = "largest_approach_speed"
    if name in list(measures):
        return runs
    found = runs.drop_vars(name)
    if "measures" in found.attrs:
        found.attrs["measures"] = json.dumps([each for each in json.loads(found.attrs["measures"]) if each != name])
    return found


def unsettled(orbits: Orbits, cycles: tuple[int, int], tolerance: float) -> dict[str, str]:
    """Return the attribute `unsettled`, a sentence about motions that are not periodic; empty if all are."""
    total = np.count_nonzero(orbits.motion != Motion.NOT_FINISHED)
    transient, irregular = orbits.motion == Motion.TRANSIENT, orbits.motion == Motion.IRREGULAR
    parts = []
    if transient.any():
        rate = np.clip(orbits.multiplier[transient], 1e-3, 1 - 1e-6)
        # The distance to the limit is above the difference that one cycle makes.
        distance = np.maximum(orbits.residual[transient] / (1 - rate), tolerance)
        more = int(np.ceil(np.max(np.log(distance / (0.1 * tolerance)) / -np.log(rate))))
        parts.append(
            f"{np.count_nonzero(transient)} of {total} motions still come closer to a periodic motion, by a factor of up to "
            f"{rate.max():.4g} in each cycle; try: cycles = ({cycles[0] + more}, {cycles[1]})"
        )
    if irregular.any():
        parts.append(
            f"{np.count_nonzero(irregular)} of {total} motions do not repeat: they are chaotic, quasi-periodic, have a "
            f"period of more than {max(cycles[1] // 2, 1)} cycles, or are long transients, whose averages change with the "
            "cycles; "
            f"try: cycles = ({10 * max(cycles[0], 1)}, {cycles[1]}) and compare"
        )
    return {"unsettled": ". ".join(parts)} if parts else {}


def attractors(strobes: Vector, ranges: Vector, period: Whole, residual: Vector, apart: float) -> tuple[Whole, Whole]:
    """Group periodic motions by attractor, independent of their phase.

    `strobes`: states, (n, sample, component). `ranges`: ranges of motion of the components, (n, component). `period` and
    `residual`: results of `classify`, (n,). Returns number of the attractor of each motion, (n,): 1 for the one with the
    most members, 0 for motions without a period and beyond 256 attractors; and for each attractor the member with the
    smallest residual.
    """
    label = np.zeros(len(strobes), dtype=np.int64)
    best: list[int] = []
    # Motions in the order of their accuracy: the most exact one of an attractor represents it, so that the result does not
    # depend on the order of the starts.
    left = np.flatnonzero(period > 0)
    left = left[np.argsort(residual[left], kind="stable")]
    while left.size and len(best) < _MAX_ATTRACTORS:
        first = left[0]
        best.append(int(first))
        n = int(period[first])
        orbit = strobes[first, -n:]
        # Strobes may begin at any point of the orbit: compare all n shifts.
        alike = left[period[left] == n]
        away = strobes[alike, -n:] / ranges[first]
        orbit = orbit / ranges[first]
        distance = np.min([np.abs(away - np.roll(orbit, k, axis=0)).max(axis=(-2, -1)) for k in range(n)], axis=0)
        members = alike[distance <= apart]
        label[members] = len(best)
        left = left[label[left] == 0]
    order = np.argsort(-np.bincount(label, minlength=len(best) + 1)[1:], kind="stable")
    rank = np.zeros(len(best) + 1, dtype=np.int64)
    rank[order + 1] = np.arange(1, len(best) + 1)
    return rank[label], np.array(best, dtype=np.int64)[order]


# ---- reductions of runs


FloatArray = NDArray[np.float64]

# ---- harmonics of the force

HIGHEST = 8
"""Largest number of a harmonic."""


@dataclass(frozen=True)
class ForceHarmonics:
    """Harmonics of the force on the content of a shaken cavity, and how its first harmonic varies from cycle to cycle."""

    # Whether contacts may be softened: then also the softening of each run, and its estimated effect on the loss
    softening: bool

    @property
    def outputs(self) -> Outputs:
        """Further dimensions, number type and attributes of each output."""
        along: Extra = (("harmonic", HIGHEST - 1),)
        rows: list[tuple[str, Extra, str, str]] = [
            ("force_harmonics", along, "N", "amplitude of a harmonic of the force on the particles"),
            ("force_variation", (), "N", "variation of the first harmonic of the force from cycle to cycle"),
        ]
        if self.softening:
            rows += [
                ("softening", (), "1", "largest softening of a damper"),
                ("softening_change", (), "1", "estimated change of the loss in a cycle by softening, over m V^2"),
            ]
        return {name: (extra, "float64", {"units": unit, "long_name": text}) for name, extra, unit, text in rows}

    def coords(self) -> dict[str, Any]:
        """Return the numbers of the harmonics."""
        numbers = np.arange(2, HIGHEST + 1)
        return {"harmonic": ("harmonic", numbers, {"units": "1", "long_name": "number of the harmonic"})}

    def describe(self) -> dict[str, Any]:
        """Return a description in JSON types: it follows from the kind of study."""
        return {}

    def reduce(self, signals: Signals) -> dict[str, Any]:
        """Return the outputs of some runs, runs first."""
        harmonics, variation = force_harmonics(signals.time, signals.momentum(), signals.frequency, HIGHEST)
        found = {"force_harmonics": signals.rate * harmonics, "force_variation": np.ravel(signals.rate) * variation}
        if self.softening:
            found |= {name: np.array([signals.diagnostics[name]]) for name in ("softening", "softening_change")}
            if signals.diagnostics["weightless"] and found["softening"] > 1:
                found["softening_change"] = np.array([np.nan])  # the estimate is for beds under their weight
        return found


# ---- steady motion


QUANTITIES: dict[str, tuple[str, str, str]] = {
    "amplitude": ("float64", "m", "amplitude of the first harmonic"),
    "amplitude" + INTERVAL: ("float64", "m", "half of the 95 % interval, amplitude of the first harmonic"),
    "phase": ("float64", "rad", "phase to the load"),
    "phase" + INTERVAL: ("float64", "rad", "half of the 95 % interval, phase to the load"),
    "spread": ("float64", "1", "spread of strobes over the range of motion"),
    "period": ("int64", "1", "cycles after which the motion repeats"),
    "motion": ("int64", "1", "kind of motion"),
    "multiplier": ("float64", "1", "estimated factor per cycle of the distance to the periodic motion"),
}
"""Number type, unit and meaning of the quantities of a steady motion."""


def attributes_of(quantity: str, units: str) -> dict[str, Any]:
    """Return the attributes of a quantity of a steady motion."""
    kinds = KINDS_OF_MOTION if quantity == "motion" else {}
    return {"units": units, "long_name": QUANTITIES[quantity][2], **kinds}


_APART = 10
"""Difference of states that count as different, over the tolerance."""


def steady_motion(
    displacement: FloatArray, others: FloatArray, phase: float, samples: int, tolerance: float
) -> dict[str, NDArray[Any]]:
    """Return the quantities of steady motions.

    `displacement`: displacement in whole cycles, both ends included [m], (..., T). `others`: further displacements that
    must repeat in a periodic motion [m], (..., T, B). `phase`: phase of the load [rad].
    """
    cycles = (displacement.shape[-1] - 1) // samples
    turns = np.exp(-2j * np.pi * np.arange(samples) / samples)
    parts = displacement[..., :-1].reshape(*displacement.shape[:-1], cycles, samples)
    each = 2j / samples * (parts @ turns) * np.exp(-1j * phase)
    mean = each.mean(axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):  # of runs that failed, and structures at rest
        relative = each / mean[..., None]
        along, across = (
            half_widths(part.reshape(-1, cycles))[0].reshape(mean.shape) for part in (relative.real, relative.imag)
        )
        positions = np.concatenate([displacement[..., None], others], axis=-1)
        strobes = positions[..., ::samples, :] / np.ptp(positions, axis=-2).max(axis=-1)[..., None, None]
        orbits = classify(strobes, tolerance, _APART * tolerance)
        spread = np.abs(np.diff(strobes, axis=-2)).max(axis=(-2, -1))
    values = (
        np.abs(mean),
        np.abs(mean) * along,
        np.angle(mean),
        across,
        spread,
        orbits.period,
        orbits.motion,
        orbits.multiplier,
    )
    return dict(zip(QUANTITIES, values, strict=True))


@dataclass(frozen=True)
class SteadyMotion:
    """First harmonic, period and kind of the motion of the observed point under a harmonic load."""

    phase: float  # Phase of the load [rad]
    tolerance: float
    cycles: int

    @property
    def outputs(self) -> Outputs:
        """Further dimensions, number type and attributes of each output."""
        return {name: ((), kind, attributes_of(name, unit)) for name, (kind, unit, _) in QUANTITIES.items()}

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of further dimensions: none."""
        return {}

    def describe(self) -> dict[str, Any]:
        """Return a description in JSON types."""
        return {"phase": self.phase, "tolerance": self.tolerance}

    def reduce(self, signals: Signals) -> dict[str, Any]:
        """Return the outputs of some runs, runs first."""
        count, size = signals.displacement.shape
        nothing = np.zeros((count, size, 0))
        return steady_motion(signals.displacement, nothing, self.phase, (size - 1) // self.cycles, self.tolerance)
