"""How fast neighbouring motions part."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .signals import labelled, positive, sampled

if TYPE_CHECKING:
    import xarray


def lyapunov_exponent(time: ArrayLike, separations: ArrayLike, *, saturation: float) -> xarray.Dataset:
    """Finite-time Lyapunov exponent from the growth of small separations.

    The exponent is the slope of the straight line that fits the mean logarithmic growth best, from the first sample
    to the last before the geometric mean of the separations reaches `saturation`. Positive means chaos, for as long
    as it was watched.

    Parameters
    ----------
    time : (N,) array_like
        Increasing times [s].
    separations : (N,) or (P, N) array_like
        Distances of P pairs of neighbouring motions, in one unit, all above zero. Let the pairs start at different
        places: pairs along one motion share its luck, and their spread says little.
    saturation
        Separation at which growth is no longer exponential, in the same unit: some hundredth of the reach of the motion.

    Returns
    -------
    xarray.Dataset
        `growth`, the mean over pairs of ln(separation/first separation), and `fit`, the line where it was fitted and
        NaN beyond, over `time` [s]; `exponent` [1/s]; `standard_error` [1/s], from the spread between pairs, or for a
        single pair from the scatter about the line, as if its samples were independent.

    Raises
    ------
    ValueError
        When a separation is not finite and above zero, or fewer than 3 samples come before saturation.
    """
    import xarray

    rows = np.atleast_2d(np.asarray(separations, dtype=np.float64))
    if rows.ndim != 2 or not rows.shape[0]:
        raise ValueError(f"separations has shape {np.shape(separations)}, but (N,) or (P, N) is needed")
    t, *pairs = sampled(time, 3, **{f"separations[{k}]": row for k, row in enumerate(rows)})
    if np.min(pairs) <= 0:
        raise ValueError(
            f"separations go down to {np.min(pairs):g}, but all must be above zero; start farther apart, or cut the record "
            "where the motions have become equal"
        )
    saturation = positive("saturation", saturation, "")
    logs = np.log(pairs)
    reached = np.flatnonzero(logs.mean(axis=0) >= np.log(saturation))
    size = int(reached[0]) if reached.size else t.size
    if size < 3:
        raise ValueError(
            f"only {size} samples come before the separation reaches {saturation:g}, but at least 3 are needed; start "
            "closer or sample more densely"
        )
    growth = logs - logs[:, :1]
    (slopes, offsets), covariance = np.polyfit(t[:size] - t[0], growth[:, :size].T, 1, cov=True)
    exponent = float(slopes.mean())
    error = slopes.std(ddof=1) / slopes.size**0.5 if slopes.size > 1 else covariance[0, 0, 0] ** 0.5
    fit = np.where(np.arange(t.size) < size, offsets.mean() + exponent * (t - t[0]), np.nan)
    return xarray.Dataset(
        {
            "growth": labelled("growth", growth.mean(axis=0), "1", "mean logarithmic growth of the separation", time=t),
            "fit": labelled("fit", fit, "1", "fitted line", time=t),
            "exponent": labelled("exponent", exponent, "1/s", "finite-time Lyapunov exponent"),
            "standard_error": labelled("standard_error", float(error), "1/s", "standard error of the exponent"),
        }
    )
