"""Restitution as a function of approach speed and of damping, computed by the core."""

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

    See Also
    --------
    JacksonGreen, ThorntonRestitution, Johnson, Constant, Tabulated : Laws, with equations and sources.

    Examples
    --------
    >>> import rattlebox as rb
    >>> ball = rb.Body(rb.materials()["steel"], radius=0.01, mass=0.03)
    >>> pair = rb.Pair(ball, rb.Body(rb.materials()["steel"]))
    >>> [round(float(e), 3) for e in rb.restitution_curve(rb.JacksonGreen(), pair, [0.05, 1.0])]
    [1.0, 0.881]
    """
    array = np.asarray(speeds, dtype=float)
    return pack_restitution(law, pair).at(array.ravel()).reshape(array.shape)


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
    r"""Return the restitution for a damping coefficient of Tsuji's law.

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
    With :math:`\zeta = \alpha / \sqrt 5`, a contact that ends at zero overlap has

    .. math:: e = \exp\left(-\frac{\pi \zeta}{\sqrt{1 - \zeta^2}}\right)

    One that ends at zero force has :math:`e = \exp(-2 b \cot b)`, where :math:`\zeta = \cos b`, and
    :math:`e = \exp(-2 h \coth h)`, where :math:`\zeta = \cosh h`, above :math:`\zeta = 1`. Both follow from the exact
    solution of Tsuji's equation, a linear oscillator in :math:`d^{5/4}` at every speed, with the overlap :math:`d`, and are
    therefore those of a linear contact with the damping ratio :math:`\zeta`.

    References
    ----------
    Y. Tsuji, T. Tanaka, T. Ishida, Powder Technology 71 (1992) 239, doi:10.1016/0032-5910(92)88030-L.

    T. Schwager, T. Poeschel, Granular Matter 9 (2007) 465, doi:10.1007/s10035-007-0065-z (both ends, linear contact).

    Examples
    --------
    >>> import rattlebox as rb
    >>> round(float(rb.restitution_of_alpha(0.006313, "zero_overlap")), 6)
    0.99117
    """
    array = np.asarray(alpha, dtype=float)
    ratios = array.ravel() / math.sqrt(5)
    return _core.restitution_of_damping(ratios, ending == "zero_overlap").reshape(array.shape)


def alpha_of_restitution(e: ArrayLike, ending: Ending = "zero_force") -> NDArray[np.float64]:
    r"""Return the damping coefficient of Tsuji's law for a restitution, the exact inverse of `restitution_of_alpha`.

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

    Notes
    -----
    For a contact that ends at zero overlap,

    .. math:: \alpha = -\frac{\sqrt 5 \ln e}{\sqrt{\pi^2 + \ln^2 e}}

    For one that ends at zero force, the equation of `restitution_of_alpha` is solved by Newton's method.

    References
    ----------
    Y. Tsuji, T. Tanaka, T. Ishida, Powder Technology 71 (1992) 239, doi:10.1016/0032-5910(92)88030-L.

    T. Schwager, T. Poeschel, Granular Matter 9 (2007) 465, doi:10.1007/s10035-007-0065-z (both ends, linear contact).

    Examples
    --------
    >>> import rattlebox as rb
    >>> round(float(rb.alpha_of_restitution(0.99117, "zero_overlap")), 6)
    0.006313
    """
    array = np.asarray(e, dtype=float)
    ratios = _core.damping_of_restitution(array.ravel(), ending == "zero_overlap")
    return math.sqrt(5) * ratios.reshape(array.shape)
