"""The energy ledger: what was supplied, where it went, and how well the sum closes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .arrays import FloatArray, RunArrays
from .quantities import quantity
from .schema import CHANNELS


@dataclass(frozen=True, eq=False, repr=False)
class Ledger:
    """Sums over the energies of a run; every array is (T,) in J.

    The balance is  E(t) - E(0) = W(t) - losses(t)  with the total energy E (structure, particles, elastic
    contacts, gravity), the work W of load and base, and the losses (viscous, impact, plastic).
    """

    arrays: RunArrays

    @cached_property
    def structure(self) -> FloatArray:
        """Energy of all modes."""
        return np.asarray(self.arrays.mode_energy.sum(axis=1))

    @cached_property
    def particles(self) -> FloatArray:
        """Kinetic energy of all balls."""
        return np.asarray(self.arrays.ball_energy.sum(axis=1))

    @cached_property
    def contact(self) -> FloatArray:
        """Elastic energy of all contacts."""
        return np.asarray(self.arrays.contact_energy.sum(axis=1))

    @cached_property
    def gravity(self) -> FloatArray:
        """Gravity potential of all balls."""
        return np.asarray(self.arrays.gravity_energy.sum(axis=1))

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
        return self.arrays.load_work + self.arrays.base_work

    @cached_property
    def impact_loss(self) -> FloatArray:
        """Loss by damping in all contacts."""
        return np.asarray(self.arrays.normal_loss.sum(axis=1))

    @cached_property
    def plastic_loss(self) -> FloatArray:
        """Loss by plastic flow in all contacts."""
        return np.asarray(self.arrays.plastic_loss.sum(axis=1))

    @cached_property
    def channels(self) -> dict[str, FloatArray]:
        """Where the energy supplied is: what was lost since the start, by channel, and what is left in the motion."""
        parts = (self.arrays.viscous_loss, self.impact_loss, self.plastic_loss, self.motion)
        return dict(zip(CHANNELS, parts, strict=True))

    @cached_property
    def losses(self) -> FloatArray:
        """All energy lost since the start."""
        return np.asarray(sum(part for channel, part in self.channels.items() if channel != "motion"))

    @cached_property
    def supplied(self) -> FloatArray:
        """Energy available so far: at the start, by load and base, and released by gravity."""
        return np.asarray(self.motion[0] + self.work + (self.gravity[0] - self.gravity))

    @cached_property
    def residual(self) -> FloatArray:
        """E(t) - E(0) - W(t) + losses(t): zero in exact arithmetic."""
        with np.errstate(invalid="ignore"):  # of a motion that grew beyond all numbers
            return np.asarray(self.total - self.total[0] - self.work + self.losses)

    @cached_property
    def closure(self) -> float:
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
        """Return whether the energy balance holds, up to rounding, which is all there is of a ball at rest.

        Parameters
        ----------
        bound
            Largest closure.
        floor
            Residual [J] that is rounding, added to 1e-10 of the largest energy of the run.
        """
        arrays = self.arrays
        handled = self.motion + np.abs(self.gravity) + arrays.viscous_loss
        handled = handled + np.abs(arrays.load_work) + np.abs(arrays.base_work)
        return self.closure <= bound or float(np.max(np.abs(self.residual))) <= 1e-10 * float(np.max(handled)) + floor

    @cached_property
    def shares(self) -> dict[str, float]:
        """Shares of the energy supplied by the end, by channel.

        They add up to one, to the ledger's closure. NaN when nothing was supplied.
        """
        supplied = float(self.supplied[-1])
        return {
            channel: float(part[-1]) / supplied if supplied > 0.0 else float("nan")
            for channel, part in self.channels.items()
        }

    @property
    def damper_share(self) -> FloatArray:
        """Shares of the energy supplied that are lost in the contacts of each damper, (D,)."""
        supplied = float(self.supplied[-1])
        lost = self._lost_in_dampers
        return np.asarray(lost / supplied if supplied > 0.0 else np.full(lost.shape, np.nan))

    @property
    def _lost_in_dampers(self) -> FloatArray:
        return np.asarray(self.arrays.normal_loss[-1] + self.arrays.plastic_loss[-1])

    @property
    def share(self) -> FloatArray:
        """The same as an array, (channels,)."""
        return np.array(list(self.shares.values()))

    def __repr__(self) -> str:
        shares = ", ".join(f"{channel} {quantity(share, '%')}" for channel, share in self.shares.items())
        return f"<Ledger {quantity(float(self.supplied[-1]), 'J')} supplied: {shares}; closes to {self.closure:.1e}>"
