"""Variants of a study that have no value, with the hatches and markers by which figures show them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.patches import Patch

from rattlebox._util.flags import has_flag
from rattlebox.analysis.cycle_loss import UNSTEADY

from .style import FAINT, pen
from .types import Style

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

GREY = "#c8c8c8"
_HATCHES = ("////", "....", "xxxx", "\\\\\\\\", "++++", "oooo", "****")
_MARKERS = ("x", "+", "1", "2", "3", "4", "*")
NOT_STEADY = "not steady"
"""Text of the legend for runs whose motion is not steady."""


class Gap(NamedTuple):
    """Variants that have no value for one reason."""

    text: str
    mask: xr.DataArray
    face: str
    hatch: str
    marker: str


def gaps_of(study: xr.Dataset, name: str) -> list[Gap]:
    """Return the variants without a value of a measure, grouped by reason."""
    values = study[name]
    explained, groups = np.isfinite(values), []
    if "status" in study:
        states = study["status"]
        explained = explained | (states != 0)
        names = str(states.attrs.get("flag_meanings", "")).split()
        for status in np.unique(states.values[states.values != 0]).tolist():
            reason = names[status].replace("_", " ") if 0 <= status < len(names) else "not computed yet"
            number = status % len(_HATCHES)
            groups.append((reason, states == status, "none", "" if status < 0 else _HATCHES[number], _MARKERS[number]))
    groups.append(("no value", ~explained, GREY, "", "|"))
    return [Gap(f"{reason} ({int(mask.sum())})", mask, *style) for reason, mask, *style in groups if mask.any()]


def unsteady_runs(study: xr.Dataset) -> xr.DataArray | None:
    """Return the variants whose motion is not steady; None for a study without warnings."""
    return has_flag(study["warnings"], UNSTEADY) if "warnings" in study else None


def add_gap_legend(figure: Figure, study: xr.Dataset, name: str) -> None:
    """Add a legend of the hatches below a map, with the number of runs for each."""
    style: Style = {"edgecolor": FAINT, "linewidth": pen(0.5)}
    handles = [Patch(facecolor=gap.face, hatch=gap.hatch, label=gap.text, **style) for gap in gaps_of(study, name)]
    if handles:
        columns = len(handles) if figure.get_figwidth() > 5 else 2
        figure.legend(handles=handles, loc="outside lower left", ncols=columns, handlelength=1.4)
