"""Report about the stability of cutting."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.quantities import MISSING, amount
from rattlebox.model.case import Case
from rattlebox.plots.stability_lobes import plot_stability_lobes
from rattlebox.report import study_words as words
from rattlebox.report.limits import limit
from rattlebox.report.parts import Limit, Table
from rattlebox.studies.maps.lobe_words import depth_with_interval

if TYPE_CHECKING:
    import xarray as xr

_NAME = "stability_lobes"
_MAX_ROWS = 16


def _cases(study: xr.Dataset) -> Mapping[str, Case]:
    text = str(study.attrs.get("map_case", ""))
    return {**words.cases_of(study), **({"damper of the map": Case.from_toml(text)} if text else {})}


def _question(study: xr.Dataset) -> str:
    case = words.known_case(study)
    tool = case.structure.words() if case is not None else "the tool"
    coefficient = amount(float(study.attrs["cutting_coefficient"]) / 1e6)
    factor, teeth = float(study.attrs["directional_factor"]), float(study.attrs["teeth_in_cut"])
    several = f", with {amount(teeth)} of {study.attrs['teeth']} teeth in cut" if study.attrs["teeth"] > 1 else ""
    return (
        f"Up to which depth of cut does {tool} not chatter, at a cutting coefficient of {coefficient} N/mm² and a "
        f"directional factor of {amount(factor)}{several}?"
    )


def _answer(study: xr.Dataset) -> Iterator[str]:
    yield from str(study.attrs["answer"]).splitlines()


def _tables(study: xr.Dataset) -> Iterator[Table]:
    rows = []
    kept = np.unique(np.linspace(0, study.amplitude.size - 1, min(study.amplitude.size, _MAX_ROWS)).round().astype(int))
    for k in kept:
        one = study.isel(amplitude=k)
        size = float(one.amplitude)
        rows.append(
            (
                amount(size, "m", 3) if size else "any",
                depth_with_interval(one),
                _known(one.limit_frequency, "Hz"),
                _known(one.dynamic_stiffness, "N/m"),
            )
        )
    header = ("amplitude", "stable depth at all speeds", "chatter frequency", "dynamic stiffness")
    yield Table("Limits", header, rows, numbers=True)


def _known(value: xr.DataArray, unit: str) -> str:
    return amount(float(value), unit, 3) if np.isfinite(value) else MISSING


def _warnings(study: xr.Dataset) -> Iterator[str]:
    yield from filter(None, str(study.attrs.get("warnings", "")).splitlines())


def _limits(study: xr.Dataset) -> Iterator[Limit]:
    yield limit(_NAME, "continuous cutting", "")
    share = study.first_harmonic_share.values
    known = share[np.isfinite(share)]
    if (study.amplitude.values > 0).any():
        least = f"{amount(float(known.min()), '%', 3)}, least share" if known.size else "unknown"
        yield limit(_NAME, "first harmonic", least, "95 %")
        error = study.interpolation_error.values
        worst = amount(float(np.nanmax(error)), "%", 2) if np.isfinite(error).any() else "unknown"
        yield limit(_NAME, "interpolation of the map", worst)


KIND = words.study_kind(
    "Stability of cutting",
    _question,
    _answer,
    lambda study: None,  # the page does not hold the map
    words.picture(
        plot_stability_lobes,
        "Stable depth of cut over the spindle speed, and the depth that is stable at all speeds over the amplitude of "
        "vibration. Below a line a vibration of that amplitude decays; the grey line is the structure alone.",
    ),
    cases=_cases,
    tables=_tables,
    warnings=_warnings,
    limits=_limits,
)
