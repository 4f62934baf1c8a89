"""Runs of the tests of results, and a check of the layout of figures."""

from __future__ import annotations

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from matplotlib.figure import Figure

_spec = spec_from_file_location("results_runs", Path(__file__).parents[1] / "results" / "conftest.py")
assert _spec is not None
assert _spec.loader is not None
_module = module_from_spec(_spec)
_spec.loader.exec_module(_module)

make_run, any_run, run, two_dampers = _module.make_run, _module.any_run, _module.run, _module.two_dampers


def is_within_page(figure: Figure) -> bool:
    """Return whether all artists of a figure are inside its page."""
    figure.draw_without_rendering()
    box = figure.get_tightbbox()
    width, height = figure.get_size_inches()
    return bool(box.x0 > -0.01 and box.y0 > -0.01 and box.x1 < width + 0.01 and box.y1 < height + 0.01)
