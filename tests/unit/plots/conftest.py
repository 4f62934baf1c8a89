"""Example runs for the tests of figures, and a check of the layout of figures."""

from __future__ import annotations

from itertools import combinations

from matplotlib.figure import Figure
from support.run_fixtures import any_run, make_run, run, two_dampers

__all__ = ["any_run", "make_run", "run", "two_dampers"]


def overlapping(figure: Figure) -> list[tuple[str, str]]:
    """Return pairs of titles, labels of axes and legends of a drawn figure that cover each other."""
    parts = [(legend, "legend") for legend in figure.legends]
    for axes in figure.axes:
        texts = [axes.xaxis.label, axes.yaxis.label, axes.title, axes._left_title]
        parts += [(text, text.get_text()) for text in texts if text.get_text() and text.get_visible()]
        if legend := axes.get_legend():
            parts.append((legend, "legend"))
    boxes = [(part.get_window_extent().padded(-1.0), name) for part, name in parts]
    return [(name, other) for (a, name), (b, other) in combinations(boxes, 2) if a.overlaps(b)]


def is_within_page(figure: Figure) -> bool:
    """Return whether all artists of a figure are inside its page, and no titles, labels and legends cover each other."""
    figure.draw_without_rendering()
    assert overlapping(figure) == []
    box = figure.get_tightbbox()
    width, height = figure.get_size_inches()
    return bool(box.x0 > -0.01 and box.y0 > -0.01 and box.x1 < width + 0.01 and box.y1 < height + 0.01)
