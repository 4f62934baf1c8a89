"""Export of datasets as CSV files, one per group of dimensions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr


def write_tables(data: xr.Dataset, folder: Path, stem: str) -> dict[Path, xr.Dataset]:
    """Write a dataset as CSV tables."""
    tables = {}
    for dims, table in _groups(data).items():
        path = folder / f"{'_'.join([stem, *(dims or ('numbers',))])}.csv"
        frame = table.to_dataframe(dim_order=list(dims)).reset_index() if dims else table.expand_dims("row").to_pandas()
        frame = frame[[*dims, *table.data_vars]]
        frame.to_csv(path, index=False, header=[_header(data, name) for name in frame], na_rep="nan")
        tables[path] = table
    return tables


def _groups(data: xr.Dataset) -> dict[tuple[str, ...], xr.Dataset]:
    """Split a dataset by the dimensions of its variables; an unused coordinate becomes a dataset of its own."""
    data = data.reset_coords()
    dims = [tuple(map(str, variable.dims)) for variable in data.data_vars.values()]
    used = {name for group in dims for name in group}
    lone: list[tuple[str, ...]] = [(str(name),) for name in data.coords if name not in used]
    return {
        group: data[[name for name, variable in data.data_vars.items() if variable.dims == group]]
        if group in dims
        else data[list(group)]
        for group in dict.fromkeys(dims + lone)
    }


def _header(data: xr.Dataset, name: str) -> str:
    units = data[name].attrs.get("units", "")
    return f"{name} [{units}]" if units else name
