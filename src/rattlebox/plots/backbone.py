"""Figure of backbones: frequency and damping ratio at phase resonance over the amplitude."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from .damping_curve import draw_with_interval
from .style import ABOVE, FAINT, StyledFigure, figure_style, label, pen, scaled
from .types import Size

if TYPE_CHECKING:
    import xarray


def plot_backbone(curves: xarray.Dataset | Mapping[str, xarray.Dataset], *, size: Size = "column") -> Figure:
    """Draw frequency and damping ratio at phase resonance over the amplitude, with their 95 % intervals.

    Parameters
    ----------
    curves
        Dataset from `rattlebox.backbone`, or several datasets by name.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with two panels, the frequency above the damping ratio; faint lines are the structure alone.

    Raises
    ------
    ValueError
        If the size is unknown.
    """
    import xarray  # importing it takes longer than drawing a figure of a run

    named = {"": curves} if isinstance(curves, xarray.Dataset) else dict(curves)
    with figure_style(size):
        figure = StyledFigure(size, 0.95)
        panels = figure.subplots(2, 1, sharex=True)
        amplitudes = xarray.concat([curve.amplitude.reset_coords(drop=True) for curve in named.values()], "amplitude")
        divisor, unit = scaled(amplitudes.assign_attrs(units="m"), "m")
        quantities = (("frequency", 1, "mode_frequency"), ("damping_ratio", 100, "mode_damping_ratio"))
        for axes, (quantity, factor, alone) in zip(panels, quantities, strict=True):
            for number, (name, curve) in enumerate(named.items()):
                limits = factor * curve[f"{quantity}_lower"], factor * curve[f"{quantity}_upper"]
                draw_with_interval(axes, curve.amplitude / divisor, factor * curve[quantity], limits, name, number)
            for number, curve in enumerate(named.values()):
                alone_text = None if number else "structure alone"
                axes.axhline(factor * curve.attrs[alone], color=FAINT, lw=pen(0.8), zorder=0, label=alone_text)
        above, below = panels
        below.set_xscale("log")
        below.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        below.xaxis.set_major_formatter("{x:g}")
        below.xaxis.set_minor_formatter(NullFormatter())
        below.set_ylim(bottom=0)
        label(above, "y", "Frequency", "Hz")
        label(below, "x", "Amplitude", unit)
        label(below, "y", "Damping ratio", "%")
        above.legend(**ABOVE, ncols=3)
    return figure
