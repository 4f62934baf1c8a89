"""Figure 11: the response with and without the damper."""

import numpy as np
import pytest
import xarray as xr

from reproduction import figure_11
from reproduction.reference import DAMPING, MASS, STIFFNESS


@pytest.fixture
def data(computed) -> xr.Dataset:
    """Responses, settling times and reductions."""
    return computed("figure_11").data


def test_bare_structure_decays_as_it_must(data: xr.Dataset) -> None:
    """The bare structure decays from 0.0503 mm at the rate C/(2M), which determines its settling times."""
    decay = DAMPING / (2 * MASS)
    quarter = np.pi / 2 * np.sqrt(MASS / STIFFNESS)
    assert float(data.peak) == pytest.approx(0.0503e-3 * np.exp(-decay * quarter), rel=2e-3)
    half_period = 2 * quarter
    ring_down = -np.log(data.level) / decay
    assert float(np.abs(data.settled_without - ring_down).max()) < 1.2 * half_period


def test_first_peak_comes_before_the_first_contact(data: xr.Dataset) -> None:
    """The leading wall first moves away from the ball and meets it half a period later: the peak is not reduced."""
    np.testing.assert_allclose(data.peak_reduction, 0.0, atol=1e-12)
    assert float(data.contact.min()) == pytest.approx(np.pi / 63.2456, rel=0.02)


def test_settling_times_are_those_of_the_single_run(data: xr.Dataset) -> None:
    """After the time given for a level no drawn sample is above it, and just before one is."""
    at = data.sel(model="elasto-plastic").sel(level=0.2, method="nearest")
    limit = float(at.level * data.peak)
    size = np.abs(at.displacement)
    assert float(size.sel(time=slice(float(at.settled), None)).max()) <= limit
    assert float(size.sel(time=slice(float(at.settled) - 0.06, float(at.settled))).max()) > limit


def test_ball_gives_back_what_it_takes(data: xr.Dataset) -> None:
    """The RMS falls at first, while elasto-plastic impacts at this amplitude dissipate nothing at all."""
    assert float(data.impact_share.sel(model="elasto-plastic")) == 0
    assert float(data.rms_reduction.sel(until=1.0).min()) > 0.1
    assert float(data.rms_reduction.sel(until=10.0).max()) < 0.1
    assert bool((data.settled_median.sel(level=0.05) > data.settled_without.sel(level=0.05)).all())


def test_starts_move_alike_and_then_part(data: xr.Dataset) -> None:
    """The displacement of starts within a micrometre is that of the single run for a second, and then anything."""
    low, median, high = data.displacement_spread.transpose("quantile", "model", "time")
    together, apart = data.time < 1.0, data.time > 2.0
    assert float(abs(median - data.displacement).where(together).max()) < 0.02 * float(data.peak)
    assert float((high - low).where(together).max()) < 0.04 * float(data.peak)
    assert float((high - low).where(apart).max("time").min()) > 0.1 * float(data.peak)


def test_verdict_follows_the_data(data: xr.Dataset) -> None:
    """Earlier attenuation holds qualitatively, fully when all settle sooner, and not at all without a reduced RMS."""
    assert [claim.verdict for claim in figure_11.claims(data)] == ["reproduced qualitatively"]
    sooner = data.assign(settled_high=0.1 * data.settled_high)
    assert figure_11.claims(sooner)[0].verdict == "reproduced"
    worse = data.assign(rms_reduction=-data.rms_reduction)
    assert figure_11.claims(worse)[0].verdict == "not reproducible"


def test_draws_what_the_data_hold(data: xr.Dataset) -> None:
    """The panels hold responses and settling times, and every number has a unit."""
    upper, right, lower = figure_11.draw(data).axes
    for axes, model in ((upper, "constant"), (lower, "elasto-plastic")):
        np.testing.assert_allclose(axes.lines[1].get_ydata(), 1e6 * data.displacement.sel(model=model), rtol=1e-12)
    np.testing.assert_array_equal(right.lines[0].get_xdata(), data.settled_median.sel(model="constant"))
    assert all({"units", "long_name"} <= set(variable.attrs) for variable in data.variables.values())
    assert f"{float(data.settled_without.sel(level=0.05)):.1f} s without damper" in figure_11.caption(data)
    assert len(figure_11.cases()) == 3
