"""When snapshots of particles are taken, and how their file is laid out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rattlebox.core import _core
from rattlebox.engines.checkpoint import fingerprint
from rattlebox.model.errors import Hint
from rattlebox.results.snapshots import SnapshotFile

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case

APART = 1.25
"""Between the centres of cavities side by side, over half the sum of their lengths along x."""


def snapshots_of(case: Case, packed: _core.DemProblem, path: Path) -> tuple[SnapshotFile, list[int]]:
    """Plan the snapshots of a run.

    Parameters
    ----------
    case
        What is run.
    packed
        What the core is given.
    path
        File to write.

    Returns
    -------
    SnapshotFile
        The file, not yet made.
    list of int
        Steps at which they are taken, each once.

    Raises
    ------
    Hint
        When there are more than steps.
    """
    dt, last = packed.dt, packed.steps
    asked = case.output.snapshots
    if isinstance(asked, int) and asked > last + 1:
        place = ("output", "snapshots")
        raise Hint(f"{asked} are asked for, but the run has {last} steps", f"snapshots = {min(last + 1, 1001)}", place)
    times = case.output.snapshot_times(case.duration)
    shots = np.unique(np.clip(np.rint(times / dt).astype(np.int64), 0, last))
    contents = [damper.contents for damper in case.particle_dampers]
    fixed = {
        "radius": np.concatenate([each.radius for each in contents]),
        "mass": np.concatenate([each.mass for each in contents]),
        "cavity": np.repeat(np.arange(len(contents)), [each.radius.size for each in contents]),
        "species": np.concatenate([each.species for each in contents]),
    }
    return SnapshotFile(
        path, np.asarray(shots * dt, dtype=float), _places(case), fixed, case.to_toml(), fingerprint(packed)
    ), shots.tolist()


def _places(case: Case) -> NDArray[np.float64]:
    """Centres of the cavities side by side along x, (D, 3) [m]."""
    lengths = np.array([damper.cavity.extent(np.array([1.0, 0.0, 0.0])) for damper in case.particle_dampers])
    along = np.concatenate([[0.0], np.cumsum(APART * (lengths[1:] + lengths[:-1]) / 2)])
    return np.stack([along, np.zeros_like(along), np.zeros_like(along)], axis=1)
