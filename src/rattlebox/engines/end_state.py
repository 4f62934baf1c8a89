"""State at the end of a particle run, from which a run with another load continues."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core
from rattlebox.model.space import rotated

_FROM_ZERO = ("load_work", "base_work", "viscous_loss", "drive_work")
"""Samples that the core counts from the beginning of a continued run, unless the case is the same."""

WALL_SUMS = (
    "wall_impulse",
    "wall_normal_impulse",
    "wall_normal_loss",
    "wall_plastic_loss",
    "wall_sliding_loss",
    "wall_rolling_loss",
    "wall_impacts",
)
"""Samples of each wall that count from the beginning of a run."""

LOSSES = ("normal_loss", "plastic_loss", "sliding_loss", "rolling_loss")
"""Samples that the core continues to count in any continued run."""


@dataclass(frozen=True)
class EndState:
    """State at the end of a particle run: particles, contacts with their history, and structure."""

    state: NDArray[np.uint8]  # State of the core, (bytes,)
    dt: float  # Time step of the run [s]
    # Initial positions of the particles of each damper, (n, 3) [m], for packing
    positions: tuple[NDArray[np.float64], ...]
    samples: Mapping[str, NDArray[Any]]  # Last sample

    @classmethod
    def of(cls, dem: _core.Dem, packed: _core.DemProblem, records: _core.Records) -> Self:
        """Return the state of a run at its end, with the samples so far."""
        samples = {name: getattr(records, name)[-1:].copy() for name in _core.Records.fields()}
        positions = tuple(np.asarray(cavity.position) for cavity in packed.cavities)
        return cls(np.array(dem.save()), packed.dt, positions, samples)

    def sample(self, time: float, loads: int, walls: int, *, keeps_sums: bool) -> _core.Records:
        """Return the last sample as the first one, at a time [s], of a run that continues with some number of loads.

        `walls`: number of walls that the run records; their sums begin at zero if the run before did not record them.
        """
        values = {**self.samples, "time": np.array([time])}
        if not keeps_sums:
            widths = {name: values[name].shape[1] for name in _FROM_ZERO} | {"load_work": loads, "base_work": loads}
            values |= {name: np.zeros((1, width)) for name, width in widths.items()}
        for name, value in values.items():
            if name.startswith("wall_") and value.shape[1] != walls:
                values[name] = np.zeros((1, walls, *value.shape[2:]), value.dtype)
        return _core.Records(**values)

    def in_gravity(self, packed: _core.DemProblem) -> Self:
        """Return the state with the potential energies of the particles in the gravity of a problem."""
        potential = self.samples["potential"].copy()
        for index, cavity in enumerate(packed.cavities):
            place = self.samples["centre"][:, index]
            if (turning := cavity.rotation) is not None:
                place = rotated(place + turning.arm, turning.axis, self.samples["angle"][:, index])
            potential[:, index] = -float(cavity.mass.sum()) * (place @ np.asarray(packed.gravity))
        return replace(self, samples={**self.samples, "potential": potential})

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the state as arrays with a first dimension of length one, by name."""
        positions = {f"position.{k}": position[None] for k, position in enumerate(self.positions)}
        samples = {f"sample.{name}": values for name, values in self.samples.items()}
        return {"state": self.state[None], "dt": np.array([self.dt]), **positions, **samples}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> Self | None:
        """Return the state of `arrays`; None if they do not hold one."""
        if "state" not in arrays:
            return None
        count = sum(name.startswith("position.") for name in arrays)
        samples = {name.removeprefix("sample."): v for name, v in arrays.items() if name.startswith("sample.")}
        return cls(
            np.ascontiguousarray(arrays["state"][0]),
            float(arrays["dt"][0]),
            tuple(arrays[f"position.{k}"][0] for k in range(count)),
            samples,
        )


def sums_from_zero(records: _core.Records) -> _core.Records:
    """Return the samples of a continued run with work and losses that count from its first sample."""
    names = (*LOSSES, *_FROM_ZERO)
    return records.replace(**{name: getattr(records, name) - getattr(records, name)[:1] for name in names})
