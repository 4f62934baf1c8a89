"""Medians and percentiles over records, counted and lognormal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray

_PERCENTILES = (16.0, 84.0)
"""Percentiles one standard deviation of a normal distribution below and above its mean, rounded as codes round them."""


def over_records(values: xarray.DataArray, dim: str = "base") -> xarray.Dataset:
    r"""Compute medians and 16th and 84th percentiles over records, counted and of a lognormal distribution.

    Parameters
    ----------
    values
        A measure of a study over records, such as `study.largest_drift`; other dimensions are kept.
    dim
        Dimension of the records.

    Returns
    -------
    xarray.Dataset
        In the unit of the values: counted `median`, `percentile_16` and `percentile_84`; of a lognormal distribution
        `lognormal_median`, `lognormal_16` and `lognormal_84`. `dispersion` is the standard deviation of the logarithm, and
        `records` the number of records with a value. If a record has none (NaN), all but `records` are NaN, because a run
        that did not finish may be the largest. With a value of 0 or less, the lognormal ones are NaN.

    Raises
    ------
    ValueError
        If there is no such dimension, or it has fewer than two records.

    Notes
    -----
    Counted percentiles are interpolated linearly between the sorted values, as `numpy.quantile` does. With the mean m and
    the standard deviation s of the logarithms (divisor n - 1),

    .. math:: \text{lognormal median} = e^m, \qquad \text{16 \% and 84 \%} = e^{m \mp s}

    Examples
    --------
    >>> import numpy as np, xarray
    >>> drifts = xarray.DataArray(np.exp([-1.0, 0.0, 1.0]), dims="base")
    >>> levels = over_records(drifts)
    >>> float(levels["median"]), round(float(np.log(levels.lognormal_84)), 3), float(levels.dispersion)
    (1.0, 1.0, 1.0)
    """
    import xarray

    if dim not in values.dims:
        raise ValueError(f"there is no dimension {dim!r}, but {', '.join(map(str, values.dims)) or 'none'}")
    if values.sizes[dim] < 2:
        raise ValueError(f"{dim} has one record; percentiles need at least two")
    along = values.get_axis_num(dim)
    numbers = np.asarray(values.values, dtype=float)
    low, median, high = np.percentile(
        numbers, (_PERCENTILES[0], 50.0, _PERCENTILES[1]), axis=along
    )  # NaN if one is NaN
    with np.errstate(invalid="ignore", divide="ignore"):
        logs = np.where(numbers > 0, np.log(numbers), np.nan)
    mean, spread = logs.mean(axis=along), logs.std(axis=along, ddof=1)
    kept = [name for name in values.dims if name != dim]
    coords = {name: each for name, each in values.coords.items() if dim not in each.dims}
    quantity, units = values.attrs.get("long_name", values.name or "value"), values.attrs.get("units", "")
    named = {
        "median": (median, units, "median of the records"),
        "percentile_16": (low, units, "16th percentile of the records"),
        "percentile_84": (high, units, "84th percentile of the records"),
        "lognormal_median": (np.exp(mean), units, "median of a lognormal distribution"),
        "lognormal_16": (np.exp(mean - spread), units, "16th percentile of a lognormal distribution"),
        "lognormal_84": (np.exp(mean + spread), units, "84th percentile of a lognormal distribution"),
        "dispersion": (spread, "1", "standard deviation of the logarithm"),
        "records": (np.isfinite(numbers).sum(axis=along), "1", "records with a value"),
    }
    data = {
        name: (kept, number, {"units": unit, "long_name": f"{words}, {quantity}"})
        for name, (number, unit, words) in named.items()
    }
    return xarray.Dataset(data, coords)
