"""Figure of the loss factor, effective mass and loss of a damper on a shaker, over amplitude and frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from rattlebox._util.quantities import STANDARD_GRAVITY

from .gaps import add_gap_legend
from .labels import LabelledValues, unit_of, value_of
from .lines import draw_lines
from .maps import draw_map
from .style import StyledFigure, axis_in_g, figure_style, letters, shorten
from .types import Size

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_AMPLITUDE, _FREQUENCY = _AXES = ("structure.motion.amplitude", "structure.motion.frequency")
_NAMES = {_AMPLITUDE: "Amplitude", _FREQUENCY: "Frequency"}
_PANELS = (
    ("loss_factor", "Loss factor $m''/|m'|$"),
    ("mass_ratio", "Effective mass $m'/m$"),
    ("reduced_loss", "Loss per cycle $/\\,mV^2$"),
)


def plot_loss_map(study: xr.Dataset, *, size: Size = "page") -> Figure:
    """Draw loss factor, effective mass over the mass of the particles, and loss per cycle over m V^2.

    The colours of the loss factor end at its 95th percentile, since it is unbounded where the effective mass is zero.

    Parameters
    ----------
    study
        Dataset from `rb.loss_map`.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with three panels over frequency and amplitude: in one row, or in one column at the size "column". A study
        at one frequency is drawn as lines over the amplitude, one at one amplitude as lines over the frequency; points
        whose motion is not steady are hollow there.

    Raises
    ------
    ValueError
        If the size is unknown.
    """
    ratio = (study["effective_mass"] / study["particle_mass"]).drop_attrs(deep=False)
    data = study.assign(mass_ratio=ratio)
    single = [axis for axis in _AXES if study.sizes[axis] == 1]
    with figure_style(size):
        figure = StyledFigure(size, 1.9 if size == "column" else 0.33)
        if single:
            _draw_lines(figure, data, single[-1], size)
        else:
            _draw_maps(figure, data, size)
    return figure


def _draw_maps(figure: Figure, study: xr.Dataset, size: Size) -> None:
    panels = figure.subplots(3, 1, sharex=True) if size == "column" else figure.subplots(1, 3, sharey=True)
    for panel, (name, text) in zip(panels, _PANELS, strict=True):
        # In a row the last panel has the axis in g, on the other side of that of the first.
        in_g = size == "column" or panel is panels[-1]
        draw_map(figure, panel, study, name, _FREQUENCY, _AMPLITUDE, text=text, in_g=in_g)
        panel.label_outer()
        panel.set_xlabel("Frequency (Hz)" if panel.get_xlabel() else "")
        panel.set_ylabel(panel.get_ylabel().replace("Structure motion amplitude", "Amplitude"))
    add_gap_legend(figure, study, "loss_factor")


def _add_axis_in_g(panel: Axes, amplitude: xr.DataArray, frequency: float) -> None:
    """Add a second axis with the acceleration of the cavity, whose amplitude may be a length or a velocity."""
    order = {"m/s": 1, "m": 2}.get(unit_of(amplitude))  # that of accelerations has one already
    if order is not None:
        per_g = STANDARD_GRAVITY / (2 * np.pi * frequency) ** order
        axis_in_g(panel, "x", per_g / LabelledValues.of(amplitude).divisor, "Acceleration")


def _draw_lines(figure: Figure, study: xr.Dataset, fixed: str, size: Size) -> None:
    """Draw the panels as lines over one axis, if the other has one value."""
    (along,) = (axis for axis in _AXES if axis != fixed)
    line = study.isel({fixed: 0})
    panels = figure.subplots(3, 1, sharex=True) if size == "column" else figure.subplots(1, 3, sharex=True)
    marks = []
    for panel, (name, text) in zip(panels, _PANELS, strict=True):
        marks = draw_lines(figure, panel, line, name, [along])
        panel.set_xlabel(panel.get_xlabel().replace("Structure motion " + _NAMES[along].lower(), _NAMES[along]))
        panel.set_ylabel(text)
        if along == _AMPLITUDE and (size != "column" or panel is panels[0]):
            _add_axis_in_g(panel, line[along], float(study[fixed].values[0]))
        if size == "column":
            panel.label_outer()
    if marks:
        figure.legend(handles=marks, loc="outside lower left", ncols=2, handlelength=1.0)
    title = f"{_NAMES[fixed]} {value_of(study[fixed], study[fixed].values[0])}"
    figure.suptitle(shorten(title, letters(panels[0])), x=0.01, ha="left", fontsize="medium")
