"""Variants of a shaken damper, with the harmonics of the force on its particles."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.analysis.shaken import force_harmonics
from rattlebox.model.particle_case import direction_of_base
from rattlebox.studies.work.case_work import Extra
from rattlebox.studies.work.impact_work import ImpactWork
from rattlebox.studies.work.particle_work import ParticleWork

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results import Run

HIGHEST = 8
"""Largest number of a harmonic."""

_NUMBERS = 2**23
"""Largest number of samples of the motions of a block."""

AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"
"""Axes of a loss map."""

_OUTPUTS: dict[str, tuple[Extra, str, dict[str, Any]]] = {
    "force_harmonics": (
        (("harmonic", HIGHEST - 1),),
        "float64",
        {"units": "N", "long_name": "amplitude of a harmonic of the force on the particles"},
    ),
    "force_variation": (
        (),
        "float64",
        {"units": "N", "long_name": "variation of the first harmonic of the force from cycle to cycle"},
    ),
}
_SOFTENING: dict[str, tuple[Extra, str, dict[str, Any]]] = {
    "softening": ((), "float64", {"units": "1", "long_name": "largest softening of a damper"}),
    "softening_change": (
        (),
        "float64",
        {"units": "1", "long_name": "estimated change of the loss in a cycle by softening, over m V^2"},
    ),
}
_COORDS = {
    "harmonic": (
        "harmonic",
        np.arange(2, HIGHEST + 1),
        {"units": "1", "long_name": "number of the harmonic"},
    )
}


class ImpactMapWork(ImpactWork):
    """Impact dampers on a shaker; see `ImpactWork`. The motions are reduced to the harmonics of the force."""

    @cached_property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, Any]]]:
        """Further dimensions, number type and attributes of each output."""
        samples = {"displacement", "velocity", "relative_position", "relative_velocity"}
        return {**{name: each for name, each in super().outputs.items() if name not in samples}, **_OUTPUTS}

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of the further dimensions."""
        return dict(_COORDS)

    @property
    def block(self) -> int:
        """Preferred number of variants in a block, whose motions must fit into the memory."""
        numbers = 2 * self.output.samples * (1 + sum(len(damper.balls) for damper in self.case.impact_dampers))
        return max(1, min(super().block, _NUMBERS // numbers))

    def reduced(self, values: dict[str, NDArray[Any]], start: int, stop: int) -> dict[str, NDArray[Any]]:
        """Return the outputs of variants with the harmonics of the force in place of the motions."""
        masses = np.array([ball.weight for damper in self.case.impact_dampers for ball in damper.balls])
        # The motion of the cavity has the first harmonic only and is the same in each cycle, so that the momentum relative
        # to it has the same higher harmonics and the same variation.
        momentum = values["relative_velocity"] @ masses
        cycles = self.cycles[1] if self.cycles else 1
        harmonics, variation = force_harmonics(np.linspace(0.0, cycles, momentum.shape[-1]), momentum, 1.0, HIGHEST)
        hertz = np.array([float(self.grid.values_at(index)[FREQUENCY]) for index in range(start, stop)])
        found = {name: array for name, array in values.items() if name in self.outputs}
        return {**found, "force_harmonics": hertz[:, None] * harmonics, "force_variation": hertz * variation}


class ParticleMapWork(ParticleWork):
    """Particle dampers on a shaker; see `ParticleWork`."""

    @cached_property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, Any]]]:
        """Further dimensions, number type and attributes of each output."""
        return {**super().outputs, **_OUTPUTS, **_SOFTENING}

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of the further dimensions."""
        return dict(_COORDS)

    def row(self, case: Case, run: Run, index: int) -> dict[str, Any]:
        """Return the outputs of one variant by name."""
        row = super().row(case, run, index)
        if run.ok:
            (motion,) = case.shaker_motion
            arrays = self.window(run, case).run.arrays
            momentum = arrays.momentum.sum(axis=1) @ direction_of_base(case.particle_dampers, motion)
            frequency = float(self.grid.values_at(index)[FREQUENCY])
            harmonics, variation = force_harmonics(arrays.time, momentum, frequency, HIGHEST)
            row |= {"force_harmonics": harmonics, "force_variation": variation}
            row |= {name: run.diagnostics[name] for name in _SOFTENING}
            if row["softening"] > 1 and not all(np.any(damper.gravity) for damper in case.particle_dampers):
                row["softening_change"] = np.nan  # the estimate is for beds under their weight
        return row
