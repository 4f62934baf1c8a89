"""Restitution as a function of approach speed and of damping, from the formulas of the core."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rattlebox.core import _core
from rattlebox.model.contacts import Ending
from rattlebox.model.pairs import Pair
from rattlebox.model.restitutions import Restitution

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def restitution_curve(law: Restitution, pair: Pair, speeds: ArrayLike) -> NDArray[np.float64]:
    """Return the restitution of a law at each approach speed.

    Parameters
    ----------
    law
        A restitution law.
    pair
        The two bodies (see `contact_pairs`).
    speeds
        Approach speeds [m/s], any shape.

    Returns
    -------
    float, shape of speeds
        Restitution; NaN outside the range of speeds of the law.
    """
    given = np.asarray(speeds, dtype=float)
    return pack_restitution(law, pair).at(given.ravel()).reshape(given.shape)


def pack_restitution(law: Restitution | None, pair: Pair) -> _core.Restitution:
    """Pack a restitution law for a pair of bodies; None is a restitution of 1."""
    if law is None:
        return _core.ConstantRestitution(e=1.0, maximum=1.0)
    name, values = law.coefficients(pair)
    numbers: dict[str, object] = {
        key: v if isinstance(v, (int, float)) else np.asarray(v, dtype=float) for key, v in values.items()
    }
    return _core.restitution_law(name, numbers)


def restitution_of_alpha(alpha: ArrayLike, ending: Ending = "zero_force") -> NDArray[np.float64]:
    """Return the restitution for a damping coefficient of Tsuji's law.

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
    With zeta = alpha/sqrt(5), a contact that ends at zero overlap has e = exp(-pi zeta / sqrt(1 - zeta^2)); one that ends at
    zero force has e = exp(-2 b cot b), where zeta = cos b. Both follow from the exact solution of Tsuji's equation.

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
    ratios = given.ravel() / math.sqrt(5)
    return _core.restitution_of_damping(ratios, ending == "zero_overlap").reshape(given.shape)


def alpha_of_restitution(e: ArrayLike, ending: Ending = "zero_force") -> NDArray[np.float64]:
    """Return the damping coefficient of Tsuji's law for a restitution, the exact inverse of `restitution_of_alpha`.

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

    References
    ----------
    Y. Tsuji, T. Tanaka, T. Ishida, Powder Technology 71 (1992) 239, doi:10.1016/0032-5910(92)88030-L.

    Examples
    --------
    >>> import rattlebox as rb
    >>> round(float(rb.alpha_of_restitution(0.99117, "zero_overlap")), 6)
    0.006313
    """
    given = np.asarray(e, dtype=float)
    ratios = _core.damping_of_restitution(given.ravel(), ending == "zero_overlap")
    return math.sqrt(5) * ratios.reshape(given.shape)
