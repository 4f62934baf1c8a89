"""Variants of cases with particle dampers under a harmonic load, reduced to their steady motion, alone or in sequence."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.batch_means import half_widths
from rattlebox._util.exceptions import RattleboxError
from rattlebox.engines.dem import continue_dem
from rattlebox.engines.end_state import EndState
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.prepare.particles import settle_all
from rattlebox.studies.work.along_last import AlongLast
from rattlebox.studies.work.case_work import Extra
from rattlebox.studies.work.measures import INTERVAL
from rattlebox.studies.work.orbits import Motion, classify
from rattlebox.studies.work.particle_work import ParticleWork
from rattlebox.studies.work.work import Cancelled, Values, proceed_unless

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results import Run

FloatArray = NDArray[np.float64]

QUANTITIES: dict[str, tuple[str, str, str]] = {
    "amplitude": ("float64", "m", "amplitude of the first harmonic"),
    "amplitude" + INTERVAL: ("float64", "m", "half of the 95 % interval, amplitude of the first harmonic"),
    "phase": ("float64", "rad", "phase to the load"),
    "phase" + INTERVAL: ("float64", "rad", "half of the 95 % interval, phase to the load"),
    "spread": ("float64", "1", "spread of strobes over the range of motion"),
    "period": ("int64", "1", "cycles after which the motion repeats"),
    "motion": ("int64", "1", "kind of motion: " + ", ".join(f"{kind:d} {kind.name.lower()}" for kind in Motion)),
    "multiplier": ("float64", "1", "estimated factor per cycle of the distance to the periodic motion"),
}
"""Number type, unit and meaning of the quantities of a steady motion."""


_APART = 10
"""Difference of states that count as different, over the tolerance."""


def steady_motion(
    displacement: FloatArray, others: FloatArray, phase: float, samples: int, tolerance: float
) -> dict[str, NDArray[Any]]:
    """Return the quantities of steady motions.

    Parameters
    ----------
    displacement : (..., T) float
        Displacement in whole cycles, both ends included [m].
    others : (..., T, B) float
        Further displacements that must repeat in a periodic motion [m].
    phase
        Phase of the load [rad].
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


@dataclass
class ParticleResponse(ParticleWork):
    """Steady motions under a harmonic load; see `ParticleWork`.

    Attributes
    ----------
    phase
        Phase of the load [rad].
    """

    phase: float = 0.0
    tolerance: float = 1e-3

    @cached_property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, Any]]]:
        """Further dimensions, number type and attributes of each output."""
        own: dict[str, tuple[Extra, str, dict[str, Any]]] = {
            name: ((), kind, {"units": unit, "long_name": text}) for name, (kind, unit, text) in QUANTITIES.items()
        }
        return {**super().outputs, **own}

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        return {**super().describe(), "phase": self.phase, "tolerance": self.tolerance}

    def row(self, case: Case, run: Run, index: int) -> dict[str, Any]:
        """Return the outputs of one variant by name."""
        row = super().row(case, run, index)
        if run.ok and self.cycles is not None:
            displacement = self.window(run, case).displacement
            samples = (displacement.size - 1) // self.cycles[1]
            nothing = np.zeros((displacement.size, 0))
            row |= steady_motion(displacement, nothing, self.phase, samples, self.tolerance)
        return row


@dataclass
class ParticleContinuation(AlongLast, ParticleResponse):
    """Steady motions, each of which starts from the end of the one before: particles, contacts and structure.

    The load continues without a break, since each variant lasts whole cycles. A variant that does not finish leaves the
    state unchanged.
    """

    @property
    def has_states(self) -> bool:
        """Whether the state at the end of a variant is not among the outputs: its size differs."""
        return True

    def validate(self) -> None:
        """Raise if the arguments do not fit the case, or its loads do not continue."""
        super().validate()
        for signal in (*self.case.loads, *self.case.base):
            if not isinstance(signal, Harmonic) or signal.start > 0 or signal.stop is not None:
                raise Hint(
                    "a load or motion does not continue from one frequency to the next",
                    'one harmonic without start and stop, or direction = "fresh"',
                )

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        return {"study": "continuation", **super().describe()}

    def run(
        self, start: int, stop: int, *, threads: int = 1, cancelled: Cancelled = None, before: Values | None = None
    ) -> Values | None:
        """Run a range of variants of one chain; see `ChainedWork.run`. The state is that at the end of the last one."""
        proceed = proceed_unless(cancelled)
        end = None if before is None else EndState.from_arrays(before)
        rows = {}
        for index in self.order(start, stop):
            try:
                case = self.variant(index)
                if end is None and not settle_all(case, proceed):
                    return None
                run, after = continue_dem(case, end, threads=threads, progress=proceed)
            except RattleboxError:  # the variant gets the status "refused"; see `refusal_reason`
                continue
            if run.status == "interrupted":
                return None
            rows[index] = self.row(case, run, index)
            end = after if run.ok else end
        states = {} if end is None else end.arrays()
        count = stop - start
        return {
            **self.columns(rows, start, stop),
            **{name: np.repeat(array, count, axis=0) for name, array in states.items()},
        }
