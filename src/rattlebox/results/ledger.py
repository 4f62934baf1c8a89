"""The energy ledger: energy supplied, energy lost by channel, and the imbalance of the sum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rattlebox._util.quantities import quantity
from rattlebox.core import _core

from .arrays import FloatArray, RunArrays, raise_absent
from .schema import channels

_KINETIC = ("ball_energy", "kinetic_energy", "rotation_energy")


def _sum(values: FloatArray) -> FloatArray:
    """Return the sum over all axes except the first."""
    return np.asarray(values.sum(axis=tuple(range(1, values.ndim))))


@dataclass(frozen=True, eq=False, repr=False)
class Ledger:
    """The energy ledger of a run: sums over its energies, each (T,) in J.

    Notes
    -----
    The energy balance is E(t) - E(0) = W(t) - L(t) with the total energy E (structure, particles, elastic contacts,
    gravity), the work W of load, base and drives, and the losses L (viscous; in contacts normal, plastic, and in 3-D runs
    sliding and rolling).
    """

    arrays: RunArrays

    @cached_property
    def structure(self) -> FloatArray:
        """Energy of all modes."""
        return _sum(self.arrays.mode_energy)

    @cached_property
    def particles(self) -> FloatArray:
        """Kinetic energy of all balls or particles."""
        parts: Sequence[FloatArray] = [getattr(self.arrays, name) for name in _KINETIC if name in self.arrays]
        return _sum(np.asarray(sum(parts)))

    @cached_property
    def contact(self) -> FloatArray:
        """Elastic energy of all contacts."""
        return _sum(self.arrays.contact_energy)

    @cached_property
    def gravity(self) -> FloatArray:
        """Gravity potential of all balls or particles."""
        return _sum(self.arrays.gravity_energy)

    @cached_property
    def motion(self) -> FloatArray:
        """Energy of structure, particles and elastic contacts, without the gravity potential."""
        return self.structure + self.particles + self.contact

    @cached_property
    def total(self) -> FloatArray:
        """Total energy E(t)."""
        return self.motion + self.gravity

    @cached_property
    def work(self) -> FloatArray:
        """Work W(t) of the load, of the base motion and of the drives of turning cavities since the start."""
        return np.asarray(self.driven + self.arrays.base_work)

    @cached_property
    def driven(self) -> FloatArray:
        """Work of the load and of the drives of turning cavities since the start."""
        drives = _sum(self.arrays.drive_work) if "drive_work" in self.arrays else 0.0
        return np.asarray(self.arrays.load_work + drives)

    @cached_property
    def channels(self) -> dict[str, FloatArray]:
        """Losses since the start by channel, and the remaining energy of the motion under "motion"."""
        return {
            name: self.motion if name == "motion" else _sum(getattr(self.arrays, f"{name}_loss"))
            for name in channels(self.arrays.engine)
        }

    @cached_property
    def losses(self) -> FloatArray:
        """All energy lost since the start."""
        return np.asarray(sum(part for channel, part in self.channels.items() if channel != "motion"))

    @cached_property
    def contact_loss(self) -> FloatArray:
        """Energy lost since the start in all contacts."""
        return np.asarray(sum(self.channels[channel] for channel in self._contact_channels))

    @property
    def _contact_channels(self) -> list[str]:
        return [channel for channel in self.channels if channel not in ("viscous", "motion")]

    @cached_property
    def supplied(self) -> FloatArray:
        """Energy supplied until t, the sum of the initial energy of motion and the work of load, base and gravity."""
        return np.asarray(self.motion[0] + self.work + (self.gravity[0] - self.gravity))

    @cached_property
    def residual(self) -> FloatArray:
        """Imbalance E(t) - E(0) - W(t) + losses(t), zero in exact arithmetic."""
        with np.errstate(invalid="ignore"):  # a solution that became non-finite
            return np.asarray(self.total - self.total[0] - self.work + self.losses)

    @cached_property
    def _put_in(self) -> float:
        """Energy put in: max|W_load| + max|W_base| + E(0), with max|V(t) - V(0)| for the gravity potential [J]."""
        arrays = self.arrays
        return float(
            np.max(np.abs(self.driven))
            + np.max(np.abs(arrays.base_work))
            + self.motion[0]
            + np.max(np.abs(self.gravity - self.gravity[0]))
        )

    @cached_property
    def _largest(self) -> float:
        """Largest sum of all terms of the balance at one time, whose rounding errors the residual contains [J]."""
        arrays = self.arrays
        handled = self.motion + np.abs(self.gravity) + arrays.viscous_loss
        return float(np.max(handled + np.abs(self.driven) + np.abs(arrays.base_work)))

    @cached_property
    def energy_residual(self) -> float:
        """Largest residual over the energy put in; 0 if nothing moves.

        Nothing moves if residual and energy put in are below 1e-10 of the largest energy of the run, the potential of
        gravity for instance, so that both are its rounding errors.

        The reference is max|W_load| + max|W_base| + E(0), in which max|V(t) - V(0)| replaces the gravity potential V(0),
        whose zero is arbitrary.
        """
        # At rest all terms of the balance are rounding errors of the largest energy, and their ratio has no meaning.
        arrays, nothing = self.arrays, np.zeros(0)
        recorded = _core.RecordedRun(
            time=arrays.time,
            motion=self.motion,
            gravity=self.gravity,
            load_work=self.driven,
            base_work=arrays.base_work,
            viscous_loss=arrays.viscous_loss,
            contact_loss=self.contact_loss,
            displacement=nothing,
            velocity=nothing,
            start_acceleration=nothing,
            end_acceleration=nothing,
            base_acceleration=nothing,
            damper_force=nothing,
            base_force=nothing,
        )
        (residual,) = _core.measure(recorded, ["energy_residual"])
        return residual

    def is_balanced(self, limit: float, *, permitted: float = 0.0, floor: float = 0.0, rounding: float = 1e-10) -> bool:
        """Return whether the largest residual is within a limit or within rounding.

        Parameters
        ----------
        limit
            Largest allowed `energy_residual`, apart from the permitted error.
        permitted
            Error that the tolerance permits in all steps of a run [J]. With it the limit is at most 1 %.
        floor
            Residual that counts as rounding in addition to that of the largest energy [J].
        rounding
            Residual that counts as rounding, as part of the largest energy of the run.

        Returns
        -------
        bool
            False also if an energy is NaN.
        """
        worst = float(np.max(np.abs(self.residual)))
        # A loose tolerance permits a larger error, but never one that would make the losses doubtful.
        allowed = min(limit * self._put_in + permitted, _core.worst_energy_residual * self._put_in)
        return worst <= max(allowed, rounding * self._largest + floor)

    @cached_property
    def shares(self) -> dict[str, float]:
        """Shares of the energy supplied by the end, by channel.

        Their sum is one up to the energy residual. NaN if no energy was supplied.
        """
        supplied = float(self.supplied[-1])
        return {
            channel: float(part[-1]) / supplied if supplied > 0.0 else float("nan")
            for channel, part in self.channels.items()
        }

    @property
    def share(self) -> FloatArray:
        """Values of `shares` as an array, (channels,)."""
        return np.array(list(self.shares.values()))

    @property
    def contact_share(self) -> float:
        """Share of the supplied energy that is dissipated in all contacts by the end."""
        return sum(self.shares[channel] for channel in self._contact_channels)

    @property
    def damper_share(self) -> FloatArray:
        """Shares of the supplied energy that are dissipated in the contacts of each damper, (D,)."""
        return self._share_of(_sum(self._contact_losses))

    @property
    def partner_share(self) -> FloatArray:
        """Shares of the supplied energy that are dissipated between particles and at walls, (2,); 3-D runs only."""
        if "contacts" not in self.arrays:
            raise_absent("partner_share", self.arrays.engine)
        return self._share_of(np.asarray(self._contact_losses.sum(axis=0)))

    def _share_of(self, lost: FloatArray) -> FloatArray:
        supplied = float(self.supplied[-1])
        return np.asarray(lost / supplied if supplied > 0.0 else np.full(lost.shape, np.nan))

    @property
    def _contact_losses(self) -> FloatArray:
        """Energy dissipated in contacts by the end, by damper and, in 3-D runs, by partner."""
        parts = (getattr(self.arrays, f"{channel}_loss")[-1] for channel in self._contact_channels)
        return np.asarray(sum(parts))

    @property
    def coordination(self) -> FloatArray:
        """Mean number of contacts per particle (coordination number), (T, D); 3-D runs only."""
        arrays = self.arrays
        count = np.bincount(arrays.particles.damper, minlength=len(arrays.dampers))
        return np.asarray(arrays.contacts @ np.array([2, 1]) / np.maximum(count, 1))

    @property
    def wall_pressure(self) -> FloatArray:
        """Normal contact force on each wall over its area [Pa], (T, W); 3-D runs that record their walls only."""
        with np.errstate(invalid="ignore"):  # NaN where a body is inside of another one and has no area
            return np.asarray(self.arrays.wall_normal_force / self.arrays.wall_area)

    def __repr__(self) -> str:
        shares = ", ".join(f"{channel} {quantity(share, '%')}" for channel, share in self.shares.items())
        supplied = quantity(float(self.supplied[-1]), "J")
        return f"<Ledger {supplied} supplied: {shares}; energy residual {self.energy_residual:.1e}>"
