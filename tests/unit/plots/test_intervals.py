"""Bands and bars of intervals show only what a quantity can be."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import rattlebox as rb


def ball(gap: str = "3 mm") -> rb.Case:
    """Return a ball that rattles irregularly."""
    return rb.Case(
        structure=rb.SDOF(mass="1 kg", frequency="20 Hz", damping_ratio=0.02),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(diameter="20 mm", material="steel"), gap=gap, contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude="2 N", frequency="20 Hz"),
        duration="4 s",
    )


def wide(study: xr.Dataset, name: str) -> xr.Dataset:
    """Return a study whose interval of a measure is wider than its values."""
    return study.assign({f"{name}_interval": (study[name].dims, 3 * np.abs(study[name].values) + 1.0)})


def lowest(figure: Figure) -> list[float]:
    """Return the smallest ordinate of the bands and bars of each panel."""

    def ends(axes: Axes) -> list[float]:
        paths = [path for band in axes.collections for path in band.get_paths()]
        return [float(path.vertices[:, 1].min()) for path in paths if len(path.vertices)]

    return [min(ends(axes)) for axes in figure.axes if ends(axes)]


@pytest.mark.parametrize(("measure", "least"), [("impacts_per_cycle", True), ("rms", True), ("work", False)])
def test_bands_of_sweeps_end_at_zero(measure: str, least: bool) -> None:
    """Counts and sizes have no band below zero, the work of a load has: bands were drawn for symmetrical intervals only."""
    study = rb.sweep(ball(), {"load.frequency": ["19 Hz", "20 Hz", "21 Hz"]}, [measure], progress=False)
    (low,) = lowest(rb.plot_map(wide(study, measure), measure))
    assert (low == 0) if least else (low < 0)


def test_bands_of_frequency_responses_end_at_zero() -> None:
    """The band of the impacts in a cycle of irregular motion does not reach below zero."""
    response = rb.frequency_response(ball(), rb.linspace("19 Hz", "21 Hz", 3), progress=False)
    assert lowest(rb.plot_frequency_response(wide(response, "impacts_per_cycle"), "impacts_per_cycle")) == [0.0]


def test_bars_of_designs_end_at_zero() -> None:
    """The bars of the trials of a design end at zero."""
    study = rb.design(ball(), {"damper.gap": ["1 mm", "3 mm"]}, "rms", progress=False)
    assert min(lowest(rb.plot_design(wide(study, "rms")))) == 0
