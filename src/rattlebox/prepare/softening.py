"""Softening of contacts: effect on a bed under its own weight, value of "auto", validity warnings.

A softened bed is more compliant: the resonance of its compression under its own weight falls towards the excitation. The
loss in a cycle then changes by up to K ((f / f_s)^2 - (f / f_1)^2) m V^2, where f is the frequency of the motion, f_s the
resonance at softening s, m the mass of the particles and V the velocity amplitude of the cavity. The coefficients K were
fitted to computed runs, see docs/theory/softening.md.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rattlebox._util.quantities import quantity

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.model.contact_table import Entry
    from rattlebox.model.particle_damper import ParticleDamper

PACKED = 0.58
"""Volume fraction of particles in a settled bed."""

COLUMN = 0.75
"""Resonance of a bed over that of a column of contacts in series: the smallest of four computed beds. The ratio is up to
twice as large in deep and narrow beds, which the side walls support."""

SENSITIVITY = (25.0, 7.0)
"""K of the module's equation, below and above `THROWN`, from computed runs."""

THROWN = 2.0
"""Amplitude of the acceleration over gravity above which a bed leaves the floor in every cycle."""

RESTING = 1.2
"""Amplitude of the acceleration over gravity below which a bed stays on the floor for most of a cycle."""

MAX_CHANGE = 0.2
"""Change of the loss in a cycle over m V^2 above which a run has a warning: a tenth of the largest loss of a thrown bed."""

AUTO_CHANGE = 0.1
"""Change of the loss in a cycle over m V^2 that softening "auto" accepts."""

ENDURING = 0.25
"""Age, in periods of the excitation, beyond which a contact counts as enduring."""

MAX_ENDURING_SHARE = 0.1
"""Share of the loss in enduring contacts above which a softened run has a warning."""

ROLLING = 0.3
"""Speed of particles relative to their cavity, over the velocity amplitude of the cavity, from which they roll through it.
Those of beds that rest move at up to 0.17 of it in computed runs, single balls on a shaken floor at 0.7."""

_LEAST_PART = 0.1  # Motions with less than this part of the largest acceleration are ignored.
_LARGEST = 1e6


@dataclass(frozen=True)
class CavityMotion:
    """Motion of a cavity."""

    main: float  # Frequency of the largest acceleration [Hz]; 0 without motion
    highest: float  # Highest frequency with at least a tenth of that acceleration [Hz]
    acceleration: float
    is_prescribed: bool


def cavity_motion(case: Case, shape: NDArray[np.float64], state: NDArray[np.float64]) -> CavityMotion:
    """Estimate the motion of a cavity without particles.

    `shape`: mode shapes at the cavity, (m, 3). `state`: modal displacements and velocities of the structure without
    particles, (T, m, 2).

    Notes
    -----
    Each mode counts as a harmonic motion with the same standard deviations of displacement and velocity, s_q and s_v: its
    angular frequency is s_v / s_q, and its acceleration sqrt(2) (s_v^2 / s_q) times the mode shape. Each signal counts as
    one with the same standard deviations of velocity and acceleration.
    """
    parts = [signal.mean_harmonic(case.duration) for signal in case.base_acceleration()]
    for mode, row in zip(np.moveaxis(state, 1, 0), shape, strict=True):
        displacement, speed = (float(values.std()) for values in mode.T)
        rate = speed / displacement if displacement > 0 else 0.0
        parts.append((rate / (2 * math.pi), math.sqrt(2) * rate * speed * float(np.linalg.norm(row))))
    parts = [(f, a) for f, a in parts if f > 0 and a > 0]
    if not parts:
        return CavityMotion(0.0, 0.0, 0.0, not len(shape))
    main, largest = max(parts, key=lambda part: part[1])
    highest = max(f for f, a in parts if a >= _LEAST_PART * largest)
    return CavityMotion(main, highest, math.hypot(*(a for _, a in parts)), not len(shape))


def bed_resonance(damper: ParticleDamper, softening: float | None = None) -> float:
    """Return the lowest resonance of the bed of a damper, compressed under its own weight.

    Returns resonance [Hz]; 0 without gravity.

    Notes
    -----
    In a column of depth h under gravity, with contacts of stiffness k in series, waves have the speed c = (k / (d
    rho))^(1/2) at the floor. Contacts with a force A x^n have k = n F/x at the force F = pi d^2 p / (phi Z) for the pressure
    p there (phi: volume fraction 0.58, Z: contacts of a particle, 4.6), and a wave takes 2n/(n + 1) h / c, which is 6/5 h /
    c with Hertz contacts. The resonance is a quarter wave, 1 / (4 times this time), multiplied by `COLUMN`, which is fitted
    to computed beds (docs/theory/softening.md).
    """
    gravity = damper.field
    size = float(np.linalg.norm(gravity))
    if not size:
        return 0.0
    floor = _floor(damper, gravity / size, size)
    factor = damper.softening_factor if softening is None else softening
    exponent = floor.entry.contact.force_exponent
    stiffness = exponent * floor.force / floor.entry.contact.static_overlap(floor.entry.pair, factor, floor.force)
    travel = 2 * exponent / (exponent + 1)  # time of a wave over h / c
    return float(COLUMN * math.sqrt(stiffness / (floor.diameter * floor.density)) / (4 * travel * floor.depth))


def softening_of_overlap(damper: ParticleDamper, field: float, overlap: float) -> float:
    """Return the softening at which contacts at the floor of a bed at rest in a field have an overlap [m/s^2], [m]."""
    if not field or damper.up is None:
        return math.inf
    floor = _floor(damper, -damper.up, field)
    hard = float(floor.entry.contact.static_overlap(floor.entry.pair, 1.0, floor.force))
    return float((overlap / hard) ** floor.entry.contact.force_exponent)


class _Floor(NamedTuple):
    """Contacts at the floor of a bed: their laws and force, diameter and depth [m], and density of the bed [kg/m^3]."""

    entry: Entry
    force: float
    diameter: float
    depth: float
    density: float


def _floor(damper: ParticleDamper, along: NDArray[np.float64], size: float) -> _Floor:
    """Return the contacts at the floor of a bed in a field of a size along a unit vector."""
    contents, table = damper.contents, damper.contact_table
    species = int(np.bincount(contents.species, contents.mass).argmax())
    if contents.radius.size == 1:  # It rests on the floor.
        lowest = 0.5 * damper.interior.extent(along) * along[None]
        entry = table.at_wall(species, int(damper.interior.nearest_wall(lowest)[0]))
    else:
        entry = table.entries[table.particle_entry[species, species]]
    diameter = 2 * float(contents.radius[contents.species == species].mean())
    volume = 4 / 3 * math.pi * float((contents.radius**3).sum())
    area = damper.interior.volume / damper.interior.extent(along)
    depth = max(diameter, volume / (PACKED * area))
    density = PACKED * float(contents.mass.sum()) / volume
    neighbours = 4.6
    force = math.pi * diameter**2 * density * size * depth / (PACKED * neighbours)
    return _Floor(entry, force, diameter, depth, density)


def loss_change(damper: ParticleDamper, motion: CavityMotion, level: float, softening: float) -> float:
    """Estimate the largest change of the loss in a cycle by softening, over m V^2.

    Notes
    -----
    K ((f / f_s)^2 - (f / f_1)^2), with the frequency f of the motion and the resonance f_s at softening s. K is 25 up to an
    acceleration of 2 g and 7 above it, fitted to computed runs (docs/theory/softening.md).
    """
    soft, hard = bed_resonance(damper, softening), bed_resonance(damper, 1.0)
    if not soft:
        return 0.0
    return _sensitivity(level) * motion.highest**2 * (soft**-2 - hard**-2)


def _sensitivity(level: float) -> float:
    return SENSITIVITY[level >= THROWN]


@dataclass(frozen=True)
class Choice:
    """The value of softening "auto"."""

    softening: float
    note: str


def choose_softening(damper: ParticleDamper, motion: CavityMotion, largest: float) -> Choice:
    """Choose the largest softening that changes the loss by at most `AUTO_CHANGE`.

    Notes
    -----
    The resonance of a bed of contacts F = A x^n falls as s^(-1/(2n)), so that `loss_change` equals a change c for
    s = (1 + c (f_1 / f)^2 / K)^n. The value is rounded down to two digits.
    """
    gravity = float(np.linalg.norm(damper.field))
    # Each early return is a case in which the estimate below does not hold; the reason becomes a note of the run.
    level = motion.acceleration / gravity if gravity and motion.is_prescribed else 0.0
    if not gravity:
        return _unsoftened("without gravity the effect of softening cannot be estimated")
    if not motion.highest:
        return _unsoftened("the case has no frequency to compare with the resonance of the bed")
    if motion.is_prescribed and level < RESTING:
        return _unsoftened(
            f"at {level:.2g} times gravity the bed stays on the floor for most of a cycle, and its loss grows with "
            "softening; it also depends on the friction law, and without friction on the dashpot"
        )
    exponent = damper.contact.force_exponent
    # Softening lowers the resonance of the bed towards the frequency of the motion; that, and not the stiffness itself,
    # changes the loss.
    room = AUTO_CHANGE / _sensitivity(level) * (bed_resonance(damper, 1.0) / motion.highest) ** 2
    by_loss = (1 + room) ** exponent
    value = _rounded(max(1.0, min(by_loss, largest, _LARGEST)))
    if value == 1:
        return _unsoftened(
            "a larger one would " + ("change the loss" if by_loss < largest else "make overlaps too large")
        )
    change = loss_change(damper, motion, level, value)
    faster = value ** (1 / (exponent + 1))
    limit = "the loss" if by_loss <= largest else "overlaps"
    return Choice(
        value,
        f"softening {value:g}, limited by {limit}: the loss in a cycle may change by {change:.2g} m V^2, "
        "with the mass m of the particles and the velocity amplitude V of the cavity; "
        f"softening 1 would cost {faster:.2g} times as much",
    )


def _unsoftened(reason: str) -> Choice:
    return Choice(1.0, f"softening 1: {reason}")


def _rounded(value: float) -> float:
    """Round a value down to two digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return round(math.floor(value / unit * (1 + 1e-12)) * unit, 12)


@dataclass(frozen=True)
class Effect:
    """Effect of softening on a damper in a run."""

    softening: float
    resonance: float  # Resonance of the bed under its own weight [Hz]
    change: float
    share: float
    frequency: float  # Highest frequency of the motion [Hz]

    def warnings(self, where: str) -> list[str]:
        """Return the warnings; `where` names the damper in them."""
        notes = []
        if self.softening > 1 and self.change > MAX_CHANGE:
            notes.append(
                f"warning: softening {self.softening:g}{where} lowers the resonance of the bed under its weight to about "
                f"{quantity(self.resonance, 'Hz', 2)}, {self.resonance / self.frequency:.2g} times the frequency of the "
                f"motion: the loss in a cycle may change by {min(self.change, 3):.2g} m V^2, with the mass m of the "
                f"particles and the velocity amplitude V of the cavity; below {MAX_CHANGE:g} m V^2 is acceptable; "
                'try: softening = "auto", or compare with rb.check_softening'
            )
        if self.softening > 1 and self.share > MAX_ENDURING_SHARE:
            notes.append(
                f"warning: {100 * self.share:.2g} % of the loss{where} is in contacts that last longer than a quarter of a "
                f"period; above {100 * MAX_ENDURING_SHARE:g} % the loss grows with softening ({self.softening:g} here); "
                "try: softening = 1; even then it depends on the friction law, and without friction on the dashpot"
            )
        return notes


def effects(
    case: Case,
    motions: Sequence[CavityMotion],
    velocity: NDArray[np.float64],
    lost: NDArray[np.float64],
    enduring: NDArray[np.float64],
    rolled: NDArray[np.float64],
    relative_speed: NDArray[np.float64],
) -> list[Effect]:
    """Compute the effect of softening on each damper of a run.

    `velocity`: velocity of the cavities in the run, with that of the base [m/s], (T, D, 3). `lost` and `enduring`: loss in
    all contacts, and in enduring ones [J], (D,). `rolled`: loss by rolling resistance [J], (D,). `relative_speed`: root
    mean square speed of the particles relative to their cavity, times the square root of two [m/s], (D,).

    Notes
    -----
    The loss of a bed at rest grows with softening because its contacts deform more. The contact of a ball that rolls through
    the cavity endures, too, but its rolling loss is the resistance times the path, whatever the softening: it is taken off.
    """
    result = []
    for index, (damper, motion) in enumerate(zip(case.particle_dampers, motions, strict=True)):
        gravity = float(np.linalg.norm(damper.field))
        speed = math.sqrt(2 * float(np.var(velocity[:, index], axis=0).sum()))
        level = speed * 2 * math.pi * motion.main / gravity if gravity else 0.0
        softening = damper.softening_factor
        resting = float(enduring[index])
        if relative_speed[index] > ROLLING * speed:
            resting = max(0.0, resting - float(rolled[index]))
        share = resting / float(lost[index]) if lost[index] > 0 else 0.0
        change = loss_change(damper, motion, level, softening)
        result.append(Effect(softening, bed_resonance(damper), change, share, motion.highest))
    return result
