"""The energy ledger: energy supplied, energy lost by channel, and the imbalance of the sum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .arrays import FloatArray, RunArrays, refuse_absent
from .quantities import quantity
from .schema import channels

_KINETIC = ("ball_energy", "kinetic_energy", "rotation_energy")


def _summed(values: FloatArray) -> FloatArray:
    """Return the sum over all axes but the first."""
    return np.asarray(values.sum(axis=tuple(range(1, values.ndim))))


@dataclass(frozen=True, eq=False, repr=False)
class Ledger:
    """Sums over the energies of a run; every array is (T,) in J.

    The balance is  E(t) - E(0) = W(t) - losses(t)  with the total energy E (structure, particles, elastic
    contacts, gravity), the work W of load and base, and the losses (viscous, and in contacts normal, plastic, and in
    3-D runs sliding and rolling).
    """

    arrays: RunArrays

    @cached_property
    def structure(self) -> FloatArray:
        """Energy of all modes."""
        return _summed(self.arrays.mode_energy)

    @cached_property
    def particles(self) -> FloatArray:
        """Kinetic energy of all balls or particles."""
        parts: Sequence[FloatArray] = [getattr(self.arrays, name) for name in _KINETIC if name in self.arrays]
        return _summed(np.asarray(sum(parts)))

    @cached_property
    def contact(self) -> FloatArray:
        """Elastic energy of all contacts."""
        return _summed(self.arrays.contact_energy)

    @cached_property
    def gravity(self) -> FloatArray:
        """Gravity potential of all balls or particles."""
        return _summed(self.arrays.gravity_energy)

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
        """Work W(t) of the load and of the base motion since the start."""
        return np.asarray(self.arrays.load_work + self.arrays.base_work)

    @cached_property
    def channels(self) -> dict[str, FloatArray]:
        """Losses since the start by channel, and the energy left in the motion."""
        return {
            name: self.motion if name == "motion" else _summed(getattr(self.arrays, f"{name}_loss"))
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
        """Energy available so far: at the start, by load and base, and released by gravity."""
        return np.asarray(self.motion[0] + self.work + (self.gravity[0] - self.gravity))

    @cached_property
    def residual(self) -> FloatArray:
        """E(t) - E(0) - W(t) + losses(t): zero in exact arithmetic."""
        with np.errstate(invalid="ignore"):  # a solution that became non-finite
            return np.asarray(self.total - self.total[0] - self.work + self.losses)

    @cached_property
    def energy_residual(self) -> float:
        """Largest residual over the energy that was put in.

        The reference is max|W_load| + max|W_base| + E(0), where the gravity potential, whose zero is
        arbitrary, enters as max|V(t) - V(0)| in place of V(0). It is 0 when nothing ever moved.
        """
        arrays = self.arrays
        reference = (
            np.max(np.abs(arrays.load_work))
            + np.max(np.abs(arrays.base_work))
            + self.motion[0]
            + np.max(np.abs(self.gravity - self.gravity[0]))
        )
        worst = np.max(np.abs(self.residual))
        if worst == 0.0:
            return 0.0
        return float(worst / reference) if reference != 0.0 else float("inf")

    def closes(self, bound: float, floor: float = 0.0) -> bool:
        """Return whether the energy balance holds, up to rounding.

        Parameters
        ----------
        bound
            Largest energy residual.
        floor
            Residual [J] that is rounding, added to 1e-10 of the largest energy of the run.
        """
        arrays = self.arrays
        handled = self.motion + np.abs(self.gravity) + arrays.viscous_loss
        handled = handled + np.abs(arrays.load_work) + np.abs(arrays.base_work)
        rounding = 1e-10 * float(np.max(handled)) + floor
        return self.energy_residual <= bound or float(np.max(np.abs(self.residual))) <= rounding

    @cached_property
    def shares(self) -> dict[str, float]:
        """Shares of the energy supplied by the end, by channel.

        They add up to one, to the energy residual. NaN when nothing was supplied.
        """
        supplied = float(self.supplied[-1])
        return {
            channel: float(part[-1]) / supplied if supplied > 0.0 else float("nan")
            for channel, part in self.channels.items()
        }

    @property
    def share(self) -> FloatArray:
        """The same as an array, (channels,)."""
        return np.array(list(self.shares.values()))

    @property
    def contact_share(self) -> float:
        """Share of the energy supplied that is lost in all contacts by the end."""
        return sum(self.shares[channel] for channel in self._contact_channels)

    @property
    def damper_share(self) -> FloatArray:
        """Shares of the energy supplied that are lost in the contacts of each damper, (D,)."""
        return self._share_of(_summed(self._lost_in_contacts))

    @property
    def partner_share(self) -> FloatArray:
        """Shares of the energy supplied that are lost among particles, and at walls, (2,); 3-D runs only."""
        if "contacts" not in self.arrays:
            refuse_absent("partner_share", self.arrays.engine)
        return self._share_of(np.asarray(self._lost_in_contacts.sum(axis=0)))

    def _share_of(self, lost: FloatArray) -> FloatArray:
        supplied = float(self.supplied[-1])
        return np.asarray(lost / supplied if supplied > 0.0 else np.full(lost.shape, np.nan))

    @property
    def _lost_in_contacts(self) -> FloatArray:
        """Energy lost in contacts by the end, by damper and, in 3-D runs, by partner."""
        parts = (getattr(self.arrays, f"{channel}_loss")[-1] for channel in self._contact_channels)
        return np.asarray(sum(parts))

    @property
    def coordination(self) -> FloatArray:
        """Mean number of contacts of a particle, (T, D); 3-D runs only."""
        arrays = self.arrays
        count = np.bincount(arrays.particles.damper, minlength=len(arrays.dampers))
        return np.asarray(arrays.contacts @ np.array([2, 1]) / np.maximum(count, 1))

    def __repr__(self) -> str:
        shares = ", ".join(f"{channel} {quantity(share, '%')}" for channel, share in self.shares.items())
        supplied = quantity(float(self.supplied[-1]), "J")
        return f"<Ledger {supplied} supplied: {shares}; energy residual {self.energy_residual:.1e}>"
