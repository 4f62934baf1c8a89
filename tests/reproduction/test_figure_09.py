"""Figures 9a and 9b: phase portraits after a weak pulse."""

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from reproduction import figure_09a, figure_09b
from reproduction.reference import GAP, PLASTIC_RIGID, paper_case


@pytest.fixture
def ball(computed) -> xr.Dataset:
    """Portraits of the ball."""
    return computed("figure_09a").data


@pytest.fixture
def structure(computed) -> xr.Dataset:
    """Portraits of the structure."""
    return computed("figure_09b").data


def test_pulse_moves_the_structure_less_than_the_clearance(structure: xr.Dataset) -> None:
    """The weak pulse starts an oscillation of 0.0503 mm, and the centred ball is never touched."""
    after = structure.sel(case=1, model="constant").isel(time=2)
    amplitude = np.hypot(after.position, after.velocity / np.sqrt(80e3 / 20))
    assert float(amplitude) == pytest.approx(0.0503e-3, rel=3e-3)
    assert float(amplitude) < GAP
    assert int(structure.contacts.sel(case=1).max()) == 0
    assert float(structure.contacts_spread.sel(case=1).max()) == 0


def test_ball_at_rest_mirrors_the_structure(ball: xr.Dataset, structure: xr.Dataset) -> None:
    """A ball that is never touched moves in the cavity as the structure does, with the other sign."""
    np.testing.assert_array_equal(ball.position.sel(case=1), -structure.position.sel(case=1))


def test_weak_impacts_are_elastic(ball: xr.Dataset) -> None:
    """All approaches stay below both critical speeds, so that elasto-plastic impacts lose nothing."""
    np.testing.assert_allclose(ball.critical_speed, [0.1694607, 0.0423652], rtol=1e-6)
    assert float(ball.approach_speed.max()) < 0.0423652
    assert float(ball.impact_loss.sel(model="elasto-plastic").max()) == 0
    assert float(ball.impact_loss.sel(model="constant", case=[2, 3]).min()) > 0


def test_a_rigid_wall_changes_nothing(ball: xr.Dataset) -> None:
    """With every impact elastic, the interpretation of the wall in the critical speed has no effect."""
    case = paper_case(PLASTIC_RIGID, start=1.0, amplitude=100.0, duration=4.0, rate=1000.0)
    position = rb.simulate(case).arrays.relative_position[:, 0]
    np.testing.assert_array_equal(position, ball.position.sel(model="elasto-plastic", case=3))


def test_ball_stays_in_its_cavity(ball: xr.Dataset) -> None:
    """The ball goes no further than the walls and their indentation of micrometres."""
    assert float(np.abs(ball.position).max()) < GAP + 5e-6


def test_band_has_a_width_where_there_are_contacts(ball: xr.Dataset, structure: xr.Dataset) -> None:
    """Starts within a micrometre stay together where the ball is never touched, and part where it is."""
    for data in (ball, structure):
        low, median, high = data.largest_spread.transpose("quantile", ...)
        assert bool((low <= median).all() and (median <= high).all())
        width = ((high - low) / median).max("window")
        assert float(width.sel(case=1).max()) < 1e-9
        assert float(width.sel(case=[2, 3]).min()) > 0.5


def test_caption_of_single_runs_outside_the_band(ball: xr.Dataset) -> None:
    """The caption explains a run outside its band, and only such a run."""
    assert "single runs of case 2 lie outside" in figure_09a.caption(ball)
    assert "outside" not in figure_09a.caption(ball.assign(contacts=ball.contacts_spread.sel(quantile=0.5)))


def test_verdicts_follow_the_data(ball: xr.Dataset, structure: xr.Dataset) -> None:
    """Case 1 is confirmed, and denied when a contact is put into the data."""
    assert [claim.verdict for claim in figure_09a.claims(ball)] == [
        "reproduced",
        "misprint",
        "reproduced qualitatively",
    ]
    assert [claim.verdict for claim in figure_09b.claims(structure)] == ["reproduced", "reproduced"]
    touched = xr.where(ball.contacts.case == 1, 1, ball.contacts)
    assert figure_09a.claims(ball.assign(contacts=touched))[0].verdict == "not reproducible"
    assert figure_09b.claims(structure.assign(contacts=touched))[0].verdict == "not reproducible"


@pytest.mark.parametrize("module", [figure_09a, figure_09b])
def test_draws_what_the_data_hold(module: object, ball: xr.Dataset, structure: xr.Dataset) -> None:
    """Each panel holds the portrait of its model and case, and every number has a unit."""
    data = ball if module is figure_09a else structure
    figure = module.FIGURE.draw(data)
    (last,) = figure.axes[5].collections[:1]
    drawn = np.array([segment[0] for segment in last.get_segments()])
    factor = 1e3 if module is figure_09a else 1e6
    one = data.sel(model="elasto-plastic", case=3).isel(time=slice(None, -1))
    np.testing.assert_allclose(drawn, np.column_stack((factor * one.position, 1e3 * one.velocity)), rtol=1e-12)
    assert all({"units", "long_name"} <= set(variable.attrs) for variable in data.variables.values())
    assert "100 N" in module.FIGURE.caption(data)
    assert len(module.FIGURE.cases()) == 6
