"""CSV files of datasets."""

import csv

import numpy as np
import pytest
import xarray as xr

from reproduction.files import write_tables

AWKWARD = np.array([0.1 + 0.2, 1 / 3, 5e-324, -0.0, np.nan, np.inf, 1.7976931348623157e308, 123456789.123456789])


@pytest.fixture
def data():
    """Return a dataset of scalars, vectors and a matrix, of numbers, truth values and text."""
    rng = np.random.default_rng(3)
    return xr.Dataset(
        {
            "energy": (("model", "time"), rng.normal(size=(2, 8)) * 1e-300, {"units": "J"}),
            "awkward": ("time", AWKWARD, {"units": "m"}),
            "count": ("model", np.array([3, 2**62]), {"units": ""}),
            "stable": ("model", np.array([True, False]), {"units": ""}),
            "speed": ((), 2 / 3, {"units": "m/s"}),
            "samples": ("sample", np.arange(3.0), {"units": "kg"}),
        },
        {
            "time": ("time", np.nextafter(np.arange(8.0), 1), {"units": "s"}),
            "model": ("model", ["nan", 'Jackson, "Green"'], {"units": ""}),
            "colour": ("model", ["a", "b"], {"units": ""}),
            "marks": ("marks", [1e-9, 2e-9], {"units": "Hz"}),
        },
    )


def test_tables_read_back_equal(data, tmp_path):
    """Every value of every variable and coordinate is read back bit by bit at its position."""
    seen = set()
    for path, table in write_tables(data, tmp_path, "figure_01").items():
        with path.open(newline="", encoding="utf-8") as file:
            headers, *rows = csv.reader(file)
        for header, column in zip(headers, zip(*rows, strict=True), strict=True):
            name, _, units = header.rstrip("]").partition(" [")
            seen.add(name)
            if name not in data.variables:
                assert name == "sample"
                continue
            assert units == data[name].units
            dims = max((variable.dims for variable in table.variables.values()), key=len)
            expected = data[name].broadcast_like(table).transpose(*dims).values.ravel()
            texts = np.array(column)
            result = texts == "True" if expected.dtype == bool else texts.astype(expected.dtype)
            if expected.dtype.kind == "f":
                result, expected = result.view(np.int64), expected.view(np.int64)
            np.testing.assert_array_equal(result, expected)
    assert seen == {*data.variables, "sample"}


def test_tables_are_named_by_their_dimensions(data, tmp_path):
    """The name of a file contains the dimensions of its rows."""
    names = {path.name for path in write_tables(data, tmp_path, "figure_01")}
    assert names == {f"figure_01_{tail}.csv" for tail in ("model_time", "time", "model", "numbers", "sample", "marks")}
    assert {path.name for path in tmp_path.iterdir()} == names


def test_header_carries_units(data, tmp_path):
    """The header of a column contains its unit, except for pure numbers."""
    write_tables(data, tmp_path, "x")
    assert (tmp_path / "x_model.csv").read_text().splitlines()[0] == "model,count,stable,colour"
    assert (tmp_path / "x_model_time.csv").read_text().splitlines()[0] == "model,time [s],energy [J]"
