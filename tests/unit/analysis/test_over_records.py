"""Medians and percentiles over records."""

import numpy as np
import pytest
import xarray

from rattlebox.analysis import over_records


def drifts(values: object) -> xarray.DataArray:
    """Return a measure over records and scales."""
    array = np.asarray(values, dtype=float)
    return xarray.DataArray(
        array,
        {"base": [f"r{k}" for k in range(len(array))], "scale": [1.0, 2.0]},
        ("base", "scale"),
        attrs={"units": "m", "long_name": "largest drift"},
    )


def test_a_lognormal_sample_has_its_quantiles() -> None:
    """Equally probable quantiles of a lognormal distribution have its percentiles, counted and fitted."""
    from scipy.stats import norm

    count = 20_001
    normal = norm.ppf((np.arange(count) + 0.5) / count)
    levels = over_records(drifts(np.exp(-1.2 + 0.4 * normal)[:, None] * [1, 2]))
    assert levels.lognormal_median.values == pytest.approx(np.exp(-1.2) * np.array([1, 2]), rel=1e-9)
    assert levels.lognormal_84.values == pytest.approx(np.exp(-0.8) * np.array([1, 2]), rel=1e-3)
    assert levels.lognormal_16.values == pytest.approx(np.exp(-1.6) * np.array([1, 2]), rel=1e-3)
    assert levels.dispersion.values == pytest.approx(0.4, rel=1e-3)
    assert levels["median"].values == pytest.approx(np.exp(-1.2) * np.array([1, 2]), rel=1e-9)
    assert levels.percentile_84.values == pytest.approx(
        np.exp(-1.2 + 0.4 * norm.ppf(0.84)) * np.array([1, 2]), rel=1e-4
    )
    assert dict(levels.sizes) == {"scale": 2} and levels["median"].attrs["units"] == "m"


def test_few_records() -> None:
    """Counted percentiles are interpolated between sorted values; the lognormal ones follow from mean and deviation."""
    values = np.array([[4.0, 1], [1, 1], [2, 1], [8, 1]])
    levels = over_records(drifts(values))
    assert levels["median"].values.tolist() == [3.0, 1.0]
    assert levels.percentile_84.values[0] == pytest.approx(np.quantile([1, 2, 4, 8], 0.84))
    logs = np.log([1, 2, 4, 8])
    assert levels.lognormal_84.values[0] == pytest.approx(np.exp(logs.mean() + logs.std(ddof=1)))
    assert levels.dispersion.values[1] == 0


def test_missing_and_zero_values() -> None:
    """A record without a value leaves no percentile, since it may be the largest; a zero leaves the counted ones."""
    levels = over_records(drifts([[np.nan, 1.0], [1.0, 0.0], [2.0, 3.0]]))
    assert levels.records.values.tolist() == [2, 3]
    for name in ("median", "percentile_16", "percentile_84", "lognormal_median", "lognormal_84", "dispersion"):
        assert np.isnan(levels[name].values[0]), name
    assert levels["median"].values[1] == 1.0 and np.isnan(levels.lognormal_median.values[1])


def test_dimensions_without_records_raise() -> None:
    """A wrong dimension, or a single record, raises with what is there."""
    with pytest.raises(ValueError, match="there is no dimension 'quake', but base, scale"):
        over_records(drifts([[1, 2], [3, 4]]), "quake")
    with pytest.raises(ValueError, match="at least two"):
        over_records(drifts([[1, 2]]))
