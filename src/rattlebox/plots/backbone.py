"""Figure of backbones: frequency and damping ratio at phase resonance over the amplitude."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from rattlebox._util.quantities import STANDARD_GRAVITY

from .damping_curve import draw_with_interval
from .style import FAINT, StyledFigure, axis_in_g, figure_style, label, pen, scaled
from .types import Size

if TYPE_CHECKING:
    import xarray


_Both = tuple[Callable[[Any], Any], Callable[[Any], Any]]


def _accelerations(curve: xarray.Dataset, divisor: float) -> _Both | None:
    """Return the functions from amplitudes in a unit to accelerations in g at phase resonance, and back, if these rise."""
    found = curve.frequency.notnull()
    amplitude = np.log(curve.amplitude.where(found, drop=True).values / divisor)
    frequency = curve.frequency.where(found, drop=True).values
    if not amplitude.size:
        amplitude, frequency = np.zeros(1), np.array([curve.attrs["mode_frequency"]])
    level = amplitude + np.log(divisor * (2 * np.pi * frequency) ** 2 / STANDARD_GRAVITY)
    if np.any(np.diff(level) <= 0):  # a frequency that falls faster than the amplitude rises
        return None

    def along(value: Any, old: Any, new: Any) -> Any:
        with np.errstate(divide="ignore", invalid="ignore"):
            at = np.log(np.asarray(value, dtype=float))
        # Beyond the ends the frequency stays as it is there.
        return np.exp(at + np.interp(at, old, new - old))

    return partial(along, old=amplitude, new=level), partial(along, old=level, new=amplitude)


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
        Figure with two panels, the frequency above the damping ratio; faint lines are the structure alone. The axis above
        has the amplitudes of one dataset as accelerations at its frequencies.

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
        if len(named) == 1 and (both := _accelerations(next(iter(named.values())), divisor)):
            axis_in_g(above, "x", both, "Acceleration")
        figure.legend(*above.get_legend_handles_labels(), loc="outside upper left", ncols=3)
    return figure
