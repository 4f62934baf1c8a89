"""Steps at which snapshots of particles are taken, and the layout of their file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rattlebox.core import _core
from rattlebox.engines.fingerprint import fingerprint
from rattlebox.model.errors import Hint
from rattlebox.results.snapshots import SnapshotFile

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case

SPACING = 1.25
"""Distance between the centres of neighbouring cavities over half the sum of their lengths along x."""

_ALONG = np.array([1.0, 0.0, 0.0])


def plan_snapshots(case: Case, packed: _core.DemProblem, path: Path) -> tuple[SnapshotFile, list[int]]:
    """Plan the snapshots of a run."""
    dt, last = packed.dt, packed.steps
    count = case.output.snapshots
    if isinstance(count, int) and count > last + 1:
        field = ("output", "snapshots")
        raise Hint(f"{count} is more than the {last} steps of the run", f"snapshots = {min(last + 1, 1001)}", field)
    times = case.output.snapshot_times(case.duration)
    steps = np.unique(np.clip(np.rint(times / dt).astype(np.int64), 0, last))
    contents = [damper.contents for damper in case.particle_dampers]
    fixed = {
        "radius": np.concatenate([each.radius for each in contents]),
        "mass": np.concatenate([each.mass for each in contents]),
        "cavity": np.repeat(np.arange(len(contents)), [each.radius.size for each in contents]),
        "species": np.concatenate([each.species for each in contents]),
    }
    sampled = np.asarray(steps * dt, dtype=float)
    walls = [damper.interior.surface() for damper in case.particle_dampers]
    periods = np.array([damper.interior.period for damper in case.particle_dampers])
    file = SnapshotFile(
        path, sampled, _drawing_positions(case), fixed, walls, case.to_toml(), fingerprint(packed), periods
    )
    return file, steps.tolist()


def _drawing_positions(case: Case) -> NDArray[np.float64]:
    """Return centres at which the cavities are drawn, (D, 3) [m]: cells at their offsets, others side by side along x."""
    groups = [(group, damper.interior.extent(_ALONG) / 2) for damper, group in case.cell_groups]
    # From the point of each group to its ends.
    left = np.array([half - group[:, 0].min() for group, half in groups])
    right = np.array([half + group[:, 0].max() for group, half in groups])
    along = np.concatenate([[0.0], np.cumsum(SPACING * (right[:-1] + left[1:]))])
    return np.concatenate([group + x * _ALONG for (group, _), x in zip(groups, along, strict=True)])
