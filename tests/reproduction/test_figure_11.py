"""Figure 11: the response with and without the damper."""

import numpy as np
import pytest
import xarray as xr

from reproduction.models import CONSTANT_E
from reproduction.system import DAMPING, MASS, STIFFNESS


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


def test_leading_wall_meets_the_ball_after_the_peak(data: xr.Dataset) -> None:
    """The leading wall first moves away from the ball and meets it half a period later: the peak is not reduced."""
    leading, trailing = (data.sel(wall=wall) for wall in data.wall.values)
    np.testing.assert_allclose(leading.peak_reduction, 0.0, atol=1e-12)
    assert leading.first_contact.values == pytest.approx(np.pi / 63.2456, rel=0.02)
    assert trailing.peak_reduction.values == pytest.approx(0.11, abs=0.01)
    assert float(trailing.first_contact.max()) < 2e-3


def test_attenuation_comes_first_and_prolongation_later(data: xr.Dataset) -> None:
    """From the trailing wall half of the peak is reached sooner than without damper, from both walls 5 % later."""
    median = data.settled.sel(quantile=0.5)
    half, end = (median.sel(level=level) - data.settled_without.sel(level=level) for level in (0.5, 0.05))
    assert float(half.sel(wall="trailing", model=CONSTANT_E)) < -0.1
    assert float(half.sel(wall="leading").min()) > 0.1
    assert float(end.min()) > 1.0


def test_starts_move_alike_at_first(data: xr.Dataset) -> None:
    """Starts within a micrometre move alike until the motion has become chaotic."""
    low, _, high = data.displacement.sel(wall="leading").transpose("quantile", ...)
    assert float((high - low).where(data.time < 0.3).max()) < 0.05 * float(data.peak)
    assert float((high - low).where(data.time > 1.5).max()) > 0.1 * float(data.peak)
