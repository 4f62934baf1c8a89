"""Divergence of neighbouring motions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .signals import labelled, positive, sampled

if TYPE_CHECKING:
    import xarray


def lyapunov_exponent(time: ArrayLike, separations: ArrayLike, *, saturation: float) -> xarray.Dataset:
    r"""Compute the finite-time Lyapunov exponent from the growth of small separations.

    Parameters
    ----------
    time : (N,) array_like
        Increasing times [s].
    separations : (N,) or (P, N) array_like
        Distances of P pairs of neighbouring motions, in one unit, all above zero. Pairs should start at different
        places: pairs along one motion are correlated, and their spread underestimates the error.
    saturation
        Separation at which growth is no longer exponential, in the same unit: about a hundredth of the range of the motion.

    Returns
    -------
    xarray.Dataset
        `growth`, the mean over pairs of ln(separation/first separation), and `fit`, the fitted line, NaN outside the fitted
        range, over `time` [s]; `exponent` [1/s]; `standard_error` [1/s], from the spread between pairs, or for a single pair
        from the scatter about the line, for independent samples.

    Raises
    ------
    ValueError
        If a separation is not finite and above zero, or there are fewer than 3 samples before saturation.

    Notes
    -----
    The exponent is the slope of the least-squares line through the mean logarithmic growth of the separations :math:`d` of
    :math:`P` pairs,

    .. math:: g(t) = \frac{1}{P} \sum \ln\frac{d(t)}{d(t_0)}

    from the first sample to the last one before the geometric mean of the separations reaches `saturation`. A positive
    exponent indicates chaos during the run.

    References
    ----------
    M. T. Rosenstein, J. J. Collins, C. J. De Luca (1993), A practical method for calculating largest Lyapunov exponents
    from small data sets, Physica D 65, 117-134, doi:10.1016/0167-2789(93)90009-P.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.linspace(0, 1, 101)
    >>> result = lyapunov_exponent(time, 1e-9 * np.exp(3 * time), saturation=1e-3)
    >>> round(float(result.exponent), 6)
    3.0
    """
    import xarray

    rows = np.atleast_2d(np.asarray(separations, dtype=np.float64))
    if rows.ndim != 2 or not rows.shape[0]:
        raise ValueError(f"separations has shape {np.shape(separations)}, but (N,) or (P, N) is needed")
    t, *pairs = sampled(time, 3, **{f"separations[{k}]": row for k, row in enumerate(rows)})
    if np.min(pairs) <= 0:
        raise ValueError(
            f"separations are as small as {np.min(pairs):g}, but must be above zero; try: a larger first separation, or end "
            "the record before the motions become equal"
        )
    saturation = positive("saturation", saturation, "")
    # The growth ends where motions are as far apart as they can be; the mean logarithm is compared, since single pairs
    # saturate at different times.
    logs = np.log(pairs)
    reached = np.flatnonzero(logs.mean(axis=0) >= np.log(saturation))
    size = int(reached[0]) if reached.size else t.size
    if size < 3:
        raise ValueError(
            f"only {size} samples precede a separation of {saturation:g}, but at least 3 are needed; try: a smaller first "
            "separation, or a higher sampling rate"
        )
    # Each pair counts from its own first distance, and has its own slope: the scatter of slopes is the error, and needs
    # no assumption about the noise along a line. One pair has only that of its line.
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
