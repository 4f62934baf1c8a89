"""Figure of the stability of cutting: depth of cut over spindle speed, and its limit over the amplitude of vibration."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from rattlebox._util.exceptions import CaseError
from rattlebox._util.quantities import amount

from .labels import log_ticks
from .style import ABOVE, FAINT, INK, SERIES_STYLES, StyledFigure, figure_style, label, pen, scaled, series_colour
from .types import Size

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


def plot_stability_lobes(study: xr.Dataset, *, size: Size = "page") -> Figure:
    """Draw the stable depth of cut over the spindle speed, and the limit at all speeds over the amplitude of vibration.

    The lobes are those of the smallest and the largest amplitude, and of the one with the largest limit.
    Cuts below a line are stable. The structure alone is grey, and so are 95 % intervals of the limit. Lines end where the
    map of the dampers ends.

    Parameters
    ----------
    study
        Dataset from `rb.stability_lobes`.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel over the speed, one over the amplitude, or both: side by side, or below each other at the size
        "column".

    Raises
    ------
    CaseError
        If the study has neither speeds nor amplitudes.
    ValueError
        If the size is unknown.
    """
    panels = [
        draw for draw, is_there in ((_draw_lobes, "depth" in study), (_draw_limit, _has_amplitudes(study))) if is_there
    ]
    if not panels:
        raise CaseError("the limit of a linear tool at all speeds is one number", "speeds = ..., for the lobes")
    with figure_style(size):
        across = len(panels) == 2 and size != "column"
        figure = StyledFigure(size, 0.42 if across else 0.62 * len(panels))
        axes = figure.subplots(*((1, 2) if across else (len(panels), 1)), squeeze=False).ravel()
        for draw, each in zip(panels, axes, strict=True):
            draw(each, study)
    return figure


def _has_amplitudes(study: xr.Dataset) -> bool:
    return bool((study.amplitude > 0).any())


def _draw_lobes(axes: Axes, study: xr.Dataset) -> None:
    known = np.flatnonzero(np.isfinite(study.depth).any("speed"))
    best = known[[np.argmax(np.nan_to_num(study.limit.values[known]))]] if known.size else known
    chosen = np.unique(np.concatenate([known[:1], best, known[-1:]]))
    shown = study.depth.isel(amplitude=chosen)
    divisor, unit = scaled(shown.where(np.isfinite(shown)), "m")
    axes.plot(study.speed, study.bare_depth / divisor, color=FAINT, lw=pen(0.8), label="structure alone", zorder=0)
    if _has_amplitudes(study) or str(study.attrs.get("system", "")):
        for number, k in enumerate(chosen):
            size = float(study.amplitude[k])
            name = amount(size, "m", 2) if size else "with " + str(study.attrs["system"])
            style = SERIES_STYLES[number % len(SERIES_STYLES)]
            axes.plot(study.speed, study.depth[k] / divisor, color=series_colour(number), ls=style, label=name)
    axes.set_yscale("log")
    log_ticks(axes.yaxis)
    label(axes, "x", "Spindle speed", "rpm")
    label(axes, "y", "Stable depth of cut", unit)
    axes.legend(**ABOVE, ncols=3)


def _draw_limit(axes: Axes, study: xr.Dataset) -> None:
    amplitudes, unit_of_amplitude = scaled(study.amplitude, "m")
    divisor, unit = scaled(study.limit, "m")
    x, y, half = study.amplitude / amplitudes, study.limit / divisor, study.limit_interval / divisor
    axes.axhline(float(study.bare_limit) / divisor, color=FAINT, lw=pen(0.8), zorder=0, label="structure alone")
    if _has_amplitudes(study):
        axes.fill_between(x, y - half, y + half, color=FAINT, alpha=0.6, lw=0, zorder=0)
        axes.plot(x, y, color=INK, marker="o", ms=pen(2), label="with dampers")
        axes.set_xscale("log")
        log_ticks(axes.xaxis)
    axes.set_ylim(bottom=0)
    label(axes, "x", f"Amplitude of vibration of {study.attrs['point']}", unit_of_amplitude)
    label(axes, "y", "Stable depth at all speeds", unit)
    axes.legend(**ABOVE, ncols=2)
