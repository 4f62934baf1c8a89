"""Figures 9a and 9b: phase portraits after a weak pulse."""

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from reproduction import figure_09a
from reproduction.judge import verdict
from reproduction.models import CONSTANT_E, RIGID, STEEL
from reproduction.system import GAP, PLASTIC, paper_case


@pytest.fixture
def data(computed) -> xr.Dataset:
    """Return the data of the figure."""
    return computed("figure_09a").data


def test_pulse_moves_the_structure_less_than_the_clearance(data: xr.Dataset) -> None:
    """The weak pulse starts an oscillation of 0.0503 mm, and the centred ball is never touched."""
    after = data.sel(body="structure", case=1, shown=CONSTANT_E).isel(time=1)
    amplitude = np.hypot(after.position, after.velocity / np.sqrt(80e3 / 20))
    assert float(amplitude) == pytest.approx(0.0503e-3, rel=3e-3)
    assert float(data.reach) < float(amplitude) < GAP
    assert float(data.contacts.sel(case=1).max()) == 0


def test_ball_at_rest_mirrors_the_structure(data: xr.Dataset) -> None:
    """A ball that is never touched moves in the cavity as the structure does, with the other sign."""
    ball, structure = data.position.sel(case=1)
    np.testing.assert_array_equal(ball, -structure)


def test_the_wall_changes_nothing(data: xr.Dataset) -> None:
    """With every impact elastic, the interpretation of the wall in the critical speed has no effect."""
    case = paper_case(PLASTIC, start=1.0, amplitude=100.0, duration=4.0, rate=1000.0)
    position = rb.simulate(case).arrays.relative_position[::2, 0]
    np.testing.assert_array_equal(position, data.position.sel(body="ball in its cavity", shown=RIGID, case=3))
    assert (data.contacts.sel(model=STEEL) == data.contacts.sel(model=RIGID)).all()


def test_ball_stays_in_its_cavity(data: xr.Dataset) -> None:
    """The ball stays within the walls and their indentation of micrometres."""
    assert float(np.abs(data.position).max()) < GAP + 5e-6


def test_claims_follow_the_data(data: xr.Dataset) -> None:
    """All three claims hold, and fail when the data are changed."""
    assert [verdict(claim) for claim in figure_09a.FIGURE.claims(data)] == ["reproduced"] * 3
    other = data.assign(reach=data.reach * 10, decay=data.decay * 1.1, jump=0 * data.jump)
    assert [verdict(claim) for claim in figure_09a.FIGURE.claims(other)] == ["not reproducible"] * 3


def test_draws_what_the_data_hold(data: xr.Dataset) -> None:
    """Each panel holds the portrait of its body, model and case."""
    (last,) = figure_09a.FIGURE.draw(data).axes[5].collections[:1]
    drawn = np.array([segment[0] for segment in last.get_segments()])
    one = data.sel(body="ball in its cavity", shown=RIGID, case=3).isel(time=slice(None, -1))
    np.testing.assert_allclose(drawn, np.column_stack((1e6 * one.position, 1e3 * one.velocity)), rtol=1e-12)
