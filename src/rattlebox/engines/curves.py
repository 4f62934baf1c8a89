"""Restitution against approach speed, from the core's own formulas."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.engines.core import core
from rattlebox.model.pairs import Pair
from rattlebox.model.restitutions import Restitution

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def restitution_curve(law: Restitution, pair: Pair, speeds: ArrayLike) -> NDArray[np.float64]:
    """Return the restitution that a law gives at each approach speed.

    Parameters
    ----------
    law
        A restitution law.
    pair
        The bodies (see contact_pairs).
    speeds
        Approach speeds [m/s], any shape.

    Returns
    -------
    float, shape of speeds
        NaN where a speed lies beyond the law.
    """
    name, values = law.coefficients(pair)
    packed: dict[str, Any] = {"law": name}
    packed |= {k: v if isinstance(v, (int, float)) else np.array(v, dtype=float) for k, v in values.items()}
    given = np.asarray(speeds, dtype=float)
    e = core().restitution(packed, np.ascontiguousarray(given.ravel()))
    return np.asarray(e).reshape(given.shape)
