"""Report about the response of a structure from the loss map of a damper."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import MISSING, amount
from rattlebox.model.case import Case
from rattlebox.plots.labels import unit_of
from rattlebox.plots.map_response import plot_response_from_map
from rattlebox.report.parts import Kind, Limit, Picture, Table

if TYPE_CHECKING:
    import xarray as xr

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
        low = ratios.min("map_amplitude")
        unit = unit_of(response.map_amplitude)
        ends = " to ".join(amount(float(end), unit) for end in response.map_amplitude.values[[0, -1]])
        best = np.unravel_index(int(np.nanargmax(low.values)), low.shape)
        at, number = (response[name].values[place] for name, place in zip(low.dims, best, strict=True))
        least = ratios.sel(at=at, number=number).argmin("map_amplitude")
        half = response.damping_ratio_interval.sel(mode=mode, at=at, number=number)[least]
        around = _half(half, low.values[best], "%")
        yield (
            f"Mode {mode}: the least damping ratio over amplitudes of the damper from {ends} is largest, "
            f"{amount(float(low.values[best]), '%', 3)}{around}, with {counted(int(number), 'damper')} at {at}."
        )
    peaks = response.peak.isel(level=-1)
    if np.isfinite(peaks.values).any():
        least = np.unravel_index(int(np.nanargmin(peaks.values)), peaks.shape)
        at, number = (response[name].values[place] for name, place in zip(peaks.dims, least, strict=True))
        around = _half(response.peak_interval.isel(level=-1).values[least], peaks.values[least], "m")
        level = amount(float(response["level"][-1]), unit_of(response["level"]))
        yield (
            f"At {level} the peak amplitude of {response.attrs['point']} is smallest, "
            f"{amount(float(peaks.values[least]), 'm')}{around}, with {counted(int(number), 'damper')} at {at}."
        )


def _half(value: Any, of: float, unit: str) -> str:
    """Return half of a 95 % interval as text; nothing if it is unknown or negligible."""
    return f" ± {amount(float(value), unit, 2)} (95 % interval of the map)" if value > 1e-4 * of else ""


def _pictures(response: xr.Dataset) -> Iterator[Picture]:
    at, number = response["at"].values[0], int(response.number.values[-1])
    yield Picture(
        f"Amplitude over frequency, and damping ratio of each mode over the amplitude of the damper, with "
        f"{counted(number, 'damper')} at {at}. Crosses mark motions with less than 95 % in the first harmonic.",
        partial(plot_response_from_map, response, at=str(at), number=number, size="page"),
    )


def _tables(response: xr.Dataset) -> Iterator[Table]:
    rows = []
    modes = [
        mode for mode in response["mode"].values.tolist() if np.isfinite(response.damping_ratio.sel(mode=mode)).any()
    ]
    for at in response["at"].values:
        for number in response.number.values:
            one = response.sel(at=at, number=number)
            ratios = [one.damping_ratio.sel(mode=mode).values for mode in modes]
            shares = [_range(values) for values in ratios]
            peak = float(one.peak.isel(level=-1))
            half = float(one.peak_interval.isel(level=-1))
            text = amount(peak, "m") if np.isfinite(peak) else MISSING
            rows.append((str(at), str(number), text, amount(half, "m", 2) if np.isfinite(half) else MISSING, *shares))
    header = (
        "points",
        "number",
        "peak at the highest level",
        "± (95 %)",
        *(f"damping ratio, mode {mode}" for mode in modes),
    )
    note = f"{len(rows) - _MAX_ROWS} more are in the dataset." if len(rows) > _MAX_ROWS else ""
    yield Table("Dampers", header, rows[:_MAX_ROWS], note, numbers=True)


def _range(values: np.ndarray) -> str:
    known = values[np.isfinite(values)]
    return f"{amount(float(known.min()), '%', 3)} to {amount(float(known.max()), '%', 3)}" if known.size else MISSING


def _warnings(response: xr.Dataset) -> Iterator[str]:
    yield from filter(None, str(response.attrs.get("warnings", "")).splitlines())


def _limits(response: xr.Dataset) -> Iterator[Limit]:
    share = response.first_harmonic_share.values
    known = share[np.isfinite(share)]
    yield Limit(
        "first harmonic",
        f"{amount(float(known.min()), '%', 3)}, least share" if known.size else "unknown",
        "95 %",
        "The dampers act as in harmonic motion of their cavity. Motions with other harmonics above 5 % are marked.",
    )
    yield Limit(
        "mass of the dampers",
        amount(float(response.mass_ratio.max()), "%", 3),
        "15 %",
        "Share of the effective mass of the structure for an impact. Impacts on a lighter structure are weaker than on the "
        "shaker of the map.",
    )
    error = response.peak_interpolation_error.values
    worst = amount(float(np.nanmax(error)), "%", 2) if np.isfinite(error).any() else "unknown"
    yield Limit(
        "interpolation of the map",
        worst,
        "",
        "Largest relative change of the peak with half of the map: compute more of it.",
    )
    if "softening" in response.attrs:
        change = response.peak_softening_error.values
        worst = amount(float(np.nanmax(change)), "%", 2) if np.isfinite(change).any() else "unknown"
        yield Limit(
            "softening of the map",
            worst,
            "",
            f"Largest relative change of the peak without the estimated effect of softening {response.attrs['softening']}. "
            "If it is unknown or large, compare with rb.check_softening.",
        )


def _call(response: xr.Dataset) -> None:
    """Return None: a response needs the dataset of its map, which the page does not hold."""


KIND = Kind(
    name="Response from a loss map",
    cases=_cases,
    question=_question,
    answer=_answer,
    call=_call,
    pictures=_pictures,
    tables=_tables,
    warnings=_warnings,
    limits=_limits,
)
