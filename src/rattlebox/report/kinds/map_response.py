"""Report about the response of a structure from the loss map of a damper."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import MISSING, amount
from rattlebox.model.case import Case
from rattlebox.plots.labels import unit_of
from rattlebox.plots.map_response import plot_response_from_map
from rattlebox.report.limits import limit
from rattlebox.report.parts import Kind, Limit, Picture, Table

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_NAME = "response_from_map"
_MAX_ROWS = 16


def _cases(response: xr.Dataset) -> Mapping[str, Case]:
    text = str(response.attrs.get("map_case", ""))
    return {"damper of the map": Case.from_toml(text)} if text else {}


def _question(response: xr.Dataset) -> str:
    places = [str(name) for name in response["at"].values]
    numbers = joined([str(number) for number in response.number.values.tolist()])
    where = f"at {joined(places)}" if len(places) < 4 else f"at one of {len(places)} places"
    return f"Which peak amplitude and damping ratios does the structure have with {numbers} dampers {where}?"


def _answer(response: xr.Dataset) -> Iterator[str]:
    for mode in response["mode"].values.tolist():
        ratios = response.damping_ratio.sel(mode=mode)
        if not np.isfinite(ratios.values).any():
            continue
        least = ratios.min("map_amplitude")
        best, words = _place(response, least, np.nanargmax)
        # The interval is that of the amplitude at which the damping ratio is least.
        weakest = ratios.isel(best).argmin("map_amplitude")
        half = response.damping_ratio_interval.sel(mode=mode).isel(best)[weakest]
        unit = unit_of(response.map_amplitude)
        ends = " to ".join(amount(float(end), unit) for end in response.map_amplitude.values[[0, -1]])
        yield (
            f"Mode {mode}: the least damping ratio over amplitudes of the damper from {ends} is largest, "
            f"{_with_half(float(least.isel(best)), float(half), '%', 3)}, {words}."
        )
    peaks = response.peak.isel(level=-1)
    if np.isfinite(peaks.values).any():
        best, words = _place(response, peaks, np.nanargmin)
        half = response.peak_interval.isel(level=-1).isel(best)
        level = amount(float(response["level"][-1]), unit_of(response["level"]))
        yield (
            f"At {level} the peak amplitude of {response.attrs['point']} is smallest, "
            f"{_with_half(float(peaks.isel(best)), float(half), 'm')}, {words}."
        )


def _place(
    response: xr.Dataset, values: xr.DataArray, pick: Callable[[Array], np.intp]
) -> tuple[dict[Hashable, int], str]:
    """Return the indices of the picked arrangement of dampers, and a phrase about it."""
    indices = np.unravel_index(int(pick(values.values)), values.shape)
    best = {dim: int(index) for dim, index in zip(values.dims, indices, strict=True)}
    one = response.isel(best)
    return best, f"with {counted(int(one.number), 'damper')} at {one['at'].item()}"


def _with_half(value: float, half: float, unit: str, digits: int = 4) -> str:
    """Return a value with half of its 95 % interval, unless this is unknown or negligible."""
    text = amount(value, unit, digits)
    return f"{text} ± {amount(half, unit, 2)} (95 % interval of the map)" if half > 1e-4 * value else text


def _pictures(response: xr.Dataset) -> Iterator[Picture]:
    at, number = response["at"].values[0], int(response.number.values[-1])
    yield Picture(
        f"Amplitude over frequency, and damping ratio of each mode over the amplitude of the damper, with "
        f"{counted(number, 'damper')} at {at}. Crosses mark motions with less than 95 % in the first harmonic.",
        partial(plot_response_from_map, response, at=str(at), number=number, size="page"),
    )


def _tables(response: xr.Dataset) -> Iterator[Table]:
    rows, ratios = [], response.damping_ratio
    modes = [mode for mode in response["mode"].values.tolist() if np.isfinite(ratios.sel(mode=mode)).any()]
    for at in response["at"].values:
        for number in response.number.values:
            one = response.sel(at=at, number=number).isel(level=-1)
            shares = [_range(one.damping_ratio.sel(mode=mode).values) for mode in modes]
            rows.append((str(at), str(number), _known(one.peak), _known(one.peak_interval, 2), *shares))
    of_modes = (f"damping ratio, mode {mode}" for mode in modes)
    header = ("points", "number", "peak at the highest level", "± (95 %)", *of_modes)
    note = f"{len(rows) - _MAX_ROWS} more are in the dataset." if len(rows) > _MAX_ROWS else ""
    yield Table("Dampers", header, rows[:_MAX_ROWS], note, numbers=True)


def _known(length: xr.DataArray, digits: int = 4) -> str:
    return amount(float(length), "m", digits) if np.isfinite(length) else MISSING


def _range(values: Array) -> str:
    known = values[np.isfinite(values)]
    return f"{amount(float(known.min()), '%', 3)} to {amount(float(known.max()), '%', 3)}" if known.size else MISSING


def _warnings(response: xr.Dataset) -> Iterator[str]:
    yield from filter(None, str(response.attrs.get("warnings", "")).splitlines())


def _limits(response: xr.Dataset) -> Iterator[Limit]:
    share = response.first_harmonic_share.values
    known = share[np.isfinite(share)]
    least = f"{amount(float(known.min()), '%', 3)}, least share" if known.size else "unknown"
    yield limit(_NAME, "first harmonic", least, "95 %")
    yield limit(_NAME, "mass of the dampers", amount(float(response.mass_ratio.max()), "%", 3), "15 %")
    yield limit(_NAME, "interpolation of the map", _worst(response.peak_interpolation_error))
    if "softening" in response.attrs:
        softening = str(response.attrs["softening"])
        yield limit(_NAME, "softening of the map", _worst(response.peak_softening_error), softening=softening)


def _worst(errors: xr.DataArray) -> str:
    """Return the largest of some relative errors."""
    return amount(float(errors.max()), "%", 2) if np.isfinite(errors).any() else "unknown"


KIND: Kind[xr.Dataset] = Kind(
    name="Response from a loss map",
    cases=_cases,
    question=_question,
    answer=_answer,
    call=lambda response: None,  # a response needs the dataset of its map, which the page does not hold
    pictures=_pictures,
    tables=_tables,
    warnings=_warnings,
    limits=_limits,
)
