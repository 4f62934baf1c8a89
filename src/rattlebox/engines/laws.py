"""Restitution against approach speed and against damping, from the core's own formulas."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.engines.core import core
from rattlebox.model.contacts import Ending
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


def restitution_of_alpha(alpha: ArrayLike, ending: Ending = "zero_force") -> NDArray[np.float64]:
    """Return the restitution that Tsuji's damping coefficient gives.

    Parameters
    ----------
    alpha
        Damping coefficients, any shape; below sqrt(5) for "zero_overlap".
    ending
        End of the contact: "zero_force" or "zero_overlap".

    Returns
    -------
    float, shape of alpha
        Restitution.

    Notes
    -----
    With zeta = alpha/sqrt(5) and an end at zero overlap, e = exp(-pi zeta / sqrt(1 - zeta^2)); at zero force
    e = exp(-2 b cot b), zeta = cos b. Derived from the exact solution of Tsuji's equation.

    References
    ----------
    Y. Tsuji, T. Tanaka, T. Ishida, Powder Technology 71 (1992) 239, doi:10.1016/0032-5910(92)88030-L.

    Examples
    --------
    >>> import rattlebox as rb
    >>> round(float(rb.restitution_of_alpha(0.006313, "zero_overlap")), 6)
    0.99117
    """
    given = np.asarray(alpha, dtype=float)
    ratios = np.ascontiguousarray(given.ravel() / math.sqrt(5))
    return np.asarray(core().restitution_of_damping(ratios, ending == "zero_overlap")).reshape(given.shape)


def alpha_of_restitution(e: ArrayLike, ending: Ending = "zero_force") -> NDArray[np.float64]:
    """Return Tsuji's damping coefficient for a restitution, the exact inverse of restitution_of_alpha.

    Parameters
    ----------
    e
        Restitution, any shape, 0 < e <= 1.
    ending
        End of the contact: "zero_force" or "zero_overlap".

    Returns
    -------
    float, shape of e
        Damping coefficients.
    """
    given = np.asarray(e, dtype=float)
    ratios = core().damping_of_restitution(np.ascontiguousarray(given.ravel()), ending == "zero_overlap")
    return math.sqrt(5) * np.asarray(ratios).reshape(given.shape)
