"""Loss factor, effective mass and loss of a damper on a shaker, over amplitude and frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from .maps import draw_map, explain_gaps
from .style import PaperFigure, Size, paper

if TYPE_CHECKING:
    import xarray as xr


def plot_loss_map(study: xr.Dataset, *, size: Size = "page") -> Figure:
    """Draw loss factor, effective mass over the mass of the particles, and loss a cycle over m V^2.

    The colours of the loss factor end at its 95th percentile: where the effective mass passes through zero it has no bound.

    Parameters
    ----------
    study
        From `rb.loss_map`.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        With three panels over frequency and amplitude: side by side, or in a column below each other.

    Raises
    ------
    ValueError
        When the size is unknown.
    """
    amplitude, frequency = "structure.motion.amplitude", "structure.motion.frequency"
    ratio = (study["effective_mass"] / study["particle_mass"]).drop_attrs(deep=False)
    shown = study.assign(mass_ratio=ratio)
    panels = (
        ("loss_factor", "Loss factor $m''/|m'|$"),
        ("mass_ratio", "Effective mass $m'/m$"),
        ("reduced_loss", "Loss a cycle $/\\,mV^2$"),
    )
    with paper(size):
        figure = PaperFigure(size, 1.9 if size == "column" else 0.33)
        axes = figure.subplots(3, 1, sharex=True) if size == "column" else figure.subplots(1, 3, sharey=True)
        for panel, (name, text) in zip(axes, panels, strict=True):
            draw_map(figure, panel, shown, name, frequency, amplitude, text=text)
            panel.label_outer()
            panel.set_xlabel("Frequency (Hz)" if panel.get_xlabel() else "")
            panel.set_ylabel(panel.get_ylabel().replace("Structure motion amplitude", "Amplitude"))
        explain_gaps(figure, study, "loss_factor")
    return figure
