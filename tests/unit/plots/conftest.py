"""Example runs for the tests of figures, and a check of the layout of figures."""

from __future__ import annotations

from matplotlib.figure import Figure
from support.run_fixtures import any_run, make_run, run, two_dampers

__all__ = ["any_run", "make_run", "run", "two_dampers"]


def is_within_page(figure: Figure) -> bool:
    """Return whether all artists of a figure are inside its page."""
    figure.draw_without_rendering()
    box = figure.get_tightbbox()
    width, height = figure.get_size_inches()
    return bool(box.x0 > -0.01 and box.y0 > -0.01 and box.x1 < width + 0.01 and box.y1 < height + 0.01)
