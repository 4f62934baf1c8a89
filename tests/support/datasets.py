"""Comparison of datasets bit by bit."""

import xarray as xr


def bits(data: xr.Dataset) -> dict[str, bytes]:
    """Return the bytes of each variable of a dataset."""
    return {str(name): values.values.tobytes() for name, values in data.data_vars.items()}
