"""Loss of particles and balls in a moving cavity, from the work of its walls over whole cycles, and whether it is steady."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.narrow import present
from rattlebox.model.space import unit_vector

from .signals import FloatArray

if TYPE_CHECKING:
    from rattlebox.results import Run

SHARE = 0.05
"""Rise or fall of the stored energy in a cycle, over the loss, above which a motion is not steady."""
FLOOR = 0.02
"""The same over m V^2, with the mass m of the particles and the velocity amplitude V of their cavity. The loss of a locked
bed is smaller, and a share of it would never be reached."""
DRIFT = 0.2
"""Change of the loss from the first to the second half of the cycles, over the loss, above which a motion is not steady."""
_TURNS = {"gravity": 0.05, "vibration": 0.01}
"""Gravity across the axis over the centrifugal acceleration, and share of the vibration across it, from which the loss of a
turning cavity depends on its angle."""
_ALWAYS = 10.0
"""Factor on these limits above which a change counts without a trend, as in a few cycles."""
_TREND = 2.576
"""Score of the Mann-Kendall test from which a series follows a trend: both sides, 1 %."""

UNSTEADY = "unsteady"
"""Name of the validity limit of a motion that is not steady; see `rattlebox.prepare.time_step.WARNINGS`."""


@dataclass(frozen=True)
class CycleLoss:
    """Energies of one cycle, averaged over the whole cycles at the end of a run [J].

    Notes
    -----
    work = dissipated + stored. In a steady motion nothing is stored over whole cycles. A bed that sinks also dissipates its
    potential energy, which the structure does not supply: then `stored` is negative, and `dissipated` is above `work`.
    """

    work: float
    dissipated: float
    stored: float
    raised: float
    drift: float
    cycles: int
    scale: float
    is_settled: bool
    is_balanced: bool
    is_constant: bool
    turns: float = math.inf  # of the cavity in these cycles, if its loss depends on its angle

    @property
    def is_steady(self) -> bool:
        """Whether the motion is steady."""
        return self.is_settled and self.is_balanced and self.is_constant and self.is_whole_turn

    @property
    def is_whole_turn(self) -> bool:
        """Whether the cycles are at least a turn, or a period of the rocking motion, to rounding."""
        return self.turns > 1 - 1e-6

    def warning(self) -> str:
        """Return the warning about a motion that is not steady; "" for a steady one."""
        if self.is_steady:
            return ""
        if not self.is_whole_turn:
            return (
                f"warning: the {self.cycles} cycles evaluated are {self.turns:.2g} turns of the cavity, whose loss depends "
                f"on its angle; try: a mean over whole turns, {math.ceil(self.cycles / self.turns)} cycles"
            )
        part = self.scale or 1.0
        work = f"{self.work / part:.2g} m V^2"
        if not self.is_settled or not self.is_balanced:
            word = "falls" if self.stored < 0 else "rises"
            what = (
                "the bed still sinks" if not self.is_settled and self.raised < 0 else "particles do not move steadily"
            )
            reason = (
                f"{what}, and their energy {word} by {abs(self.stored) / part:.2g} m V^2 in a cycle, while the structure "
                f"loses {work}"
            )
        else:
            reason = f"the loss of {work} in a cycle changes by {abs(self.drift) / part:.2g} m V^2 over the cycles"
        return (
            f"warning: the motion is not steady after {self.cycles} cycles: {reason}; with the mass m of the particles and "
            "the velocity amplitude V of the cavity; try: more cycles to skip"
        )


def cycle_loss(run: Run, frequency: float, cycles: int, dampers: Sequence[int] | None = None) -> CycleLoss:
    """Compute the loss of dampers over the last cycles of a run.

    `frequency`: frequency of the motion [Hz].

    Notes
    -----
    The work of the walls is the rise of the energy of the particles in the inertial frame plus the energy lost in contacts.
    Between samples the energy relative to that of rigid masses in the cavities is interpolated linearly, and the velocities
    of the cavities by cubic splines. A motion is not steady if the potential or the stored energy changes by more than 5 %
    of the work or 2 % of m V^2 in a cycle, or the work by more than 20 % of itself from the first to the second half; if it
    has a trend (Mann-Kendall, 1 %) or is ten times larger; or if the cycles are less than a turn of a cavity in which the
    vibration or gravity changes its direction.

    References
    ----------
    H. B. Mann (1945), Nonparametric tests against trend, Econometrica 13, 245-259, doi:10.2307/1907187.
    """
    arrays = run.arrays
    numbers = list(range(len(arrays.dampers))) if dampers is None else list(dampers)
    # Ends of cycles lie between samples. Only what is smooth is interpolated: the energy of the contents as rigid
    # masses, which changes fastest, is taken out before and added after.
    ends = arrays.time[-1] - np.arange(cycles, -1, -1) / frequency
    *energies, carried, velocity, mass = _energies(run, numbers)
    energy, raised, lost = (np.interp(ends, arrays.time, values) for values in energies)
    energy = energy + carried(ends)
    supplied = energy + lost
    work, stored = float(supplied[-1] - supplied[0]) / cycles, float(energy[-1] - energy[0]) / cycles
    # The natural unit of a loss is m V^2; small losses are compared with a part of it, since their relative change is
    # large in any motion.
    moving = velocity[arrays.time >= ends[0] - 1e-9 / frequency]
    scale = 2 * mass * float(np.var(moving, axis=0).sum())
    limit = max(SHARE * abs(work), FLOOR * scale)
    work_of_cycle = np.diff(supplied)
    # The first half against the second: a loss that still falls, as of a bed that compacts, shows there before it does
    # in single cycles.
    half = cycles // 2
    drift = float(work_of_cycle[cycles - half :].mean() - work_of_cycle[:half].mean()) if half else 0.0
    sunk = float(raised[-1] - raised[0]) / cycles
    return CycleLoss(
        work=work,
        dissipated=float(lost[-1] - lost[0]) / cycles,
        stored=stored,
        raised=sunk,
        drift=drift,
        cycles=cycles,
        scale=scale,
        is_settled=not _matters(sunk, limit, raised),
        is_balanced=not _matters(stored, limit, energy),
        is_constant=not _matters(drift, max(DRIFT * abs(work), FLOOR * scale), work_of_cycle),
        turns=_turns(run, numbers, float(ends[0])) if arrays.engine == "dem" else math.inf,
    )


def _matters(change: float, limit: float, series: FloatArray) -> bool:
    """Return whether a change exceeds its limit, and does so by a trend or by far."""
    return abs(change) > limit and (abs(change) > _ALWAYS * limit or abs(_trend_score(series)) > _TREND)


def _trend_score(x: FloatArray) -> float:
    """Return the score of the Mann-Kendall test of a series, standard normal without a trend; 0 for a few numbers."""
    n = x.size
    total = float(sum(np.sign(x[k + 1 :] - x[k]).sum() for k in range(n - 1)))
    return math.copysign(max(0.0, abs(total) - 1), total) / math.sqrt(max(1, n * (n - 1) * (2 * n + 5)) / 18)


def _turns(run: Run, dampers: list[int], start: float) -> float:
    """Return the least number of turns since a time of the cavities whose loss depends on their angle."""
    arrays, turns = run.arrays, [math.inf]
    late = arrays.time >= start
    for number in dampers:
        damper = run.case.particle_dampers[number]
        rotation = damper.rotation
        if rotation is None:
            continue
        axis, field = unit_vector(rotation.axis), np.max(np.abs(arrays.cavity_speed[late, number])) ** 2
        across = float(np.linalg.norm(np.cross(damper.gravity, axis)))
        varies = across > _TURNS["gravity"] * field * float(np.linalg.norm(rotation.radial))
        if rotation.vibration == "machine":
            velocity = (arrays.cavity_velocity[:, number] + arrays.base_velocity)[late]
            part = np.abs(np.cross(velocity, axis)).max()
            varies |= bool(part > _TURNS["vibration"] * np.abs(velocity).max())
        angle = np.interp([start, arrays.time[-1]], arrays.time, arrays.cavity_angle[:, number])
        turned = abs(float(angle[1] - angle[0])) / (2 * math.pi)
        if rotation.is_rocking:
            turned = (arrays.time[-1] - start) * present(rotation.frequency)
        if varies and turned * 360 > 1:  # less than a degree is a cavity at rest
            turns.append(turned)
    return min(turns)


def _turning_velocity(run: Run, dampers: list[int]) -> FloatArray:
    """Return the velocities of the centres of cavities by their rotation, (T, D, 3) [m/s]."""
    arrays = run.arrays
    velocity = np.zeros((arrays.time.size, len(dampers), 3))
    for index, number in enumerate(dampers):
        rotation = run.case.particle_dampers[number].rotation
        if rotation is not None:
            arm = np.broadcast_to(rotation.radial, (arrays.time.size, 3))
            across = np.cross(unit_vector(rotation.axis), rotation.to_machine(arm, arrays.cavity_angle[:, number]))
            velocity[:, index] = arrays.cavity_speed[:, number, None] * across
    return velocity


def _energies(
    run: Run, dampers: list[int]
) -> tuple[Any, Any, Any, Callable[[FloatArray], FloatArray], FloatArray, float]:
    """Return energies of the contents of dampers, velocity of the first cavity, (T, axes) [m/s], and the mass [kg].

    The energies are: stored, without that of rigid masses in the cavities, potential of gravity, and lost in contacts, (T,)
    [J] each, and a function of time for the energy of these masses.
    """
    from scipy.interpolate import CubicSpline

    arrays = run.arrays
    # Gravity counts as stored energy: a bed that sinks pays for a part of the loss, which the walls have not supplied.
    raised = arrays.gravity_energy[:, dampers].sum(axis=1)
    still = raised + arrays.contact_energy[:, dampers].sum(axis=1)
    turning = np.zeros((1, 1, 1))
    if arrays.engine == "dem":
        # The drive of a turning cavity raises its bed and lowers it again; what it supplies is not work of the vibration.
        still = still - arrays.drive_work[:, dampers].sum(axis=1)
        raised = arrays.gravity_energy[:, [k for k in dampers if not np.any(arrays.cavity_speed[:, k])]].sum(axis=1)
        turning = _turning_velocity(run, dampers)
        parts = (arrays.normal_loss, arrays.plastic_loss, arrays.sliding_loss, arrays.rolling_loss)
        lost = sum(part[:, dampers].sum(axis=(1, 2)) for part in parts)
        moving = (arrays.kinetic_energy + arrays.rotation_energy)[:, dampers].sum(axis=1)
        # One mass for each cavity in 3-D, one for each ball in 1-D: the energy that is taken out is that of bodies that
        # move with their cavity.
        masses, momenta = arrays.particle_mass[dampers], arrays.momentum[:, dampers]
        base = arrays.base_velocity
        cavities = base[:, None] + arrays.cavity_velocity[:, dampers]
    else:
        balls = np.flatnonzero(np.isin(arrays.ball_damper, dampers))
        lost = (arrays.normal_loss + arrays.plastic_loss)[:, dampers].sum(axis=1)
        moving = arrays.ball_energy[:, balls].sum(axis=1)
        masses = np.concatenate([np.asarray(damper.masses, float) for damper in run.case.impact_dampers])[balls]
        momenta = (arrays.ball_velocity[:, balls] * masses)[..., None]
        base = arrays.base_velocity[:, None]
        cavities = base[:, None] + (arrays.ball_velocity - arrays.relative_velocity)[:, balls, None]
    # In the inertial frame, whose velocity the base adds to that of the ledger.
    energy = still + moving + np.einsum("tdi,ti->t", momenta, base) + 0.5 * masses.sum() * np.sum(base**2, axis=1)
    carriers = cavities + turning
    energy = energy - 0.5 * np.sum(carriers**2, axis=2) @ masses
    smooth = CubicSpline(arrays.time, carriers) if arrays.time.size > 1 else None

    def carried(times: FloatArray) -> FloatArray:
        return np.asarray(0.0 if smooth is None else 0.5 * np.sum(smooth(times) ** 2, axis=2) @ masses)

    return energy, raised, lost, carried, cavities[:, 0], float(masses.sum())
