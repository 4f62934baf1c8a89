"""Figure A3: bifurcations of the speed at impact."""

import numpy as np
import pytest

from rattlebox import Newton, simulate
from reproduction import bifurcation
from reproduction.harmonic import State, harmonic_case
from reproduction.models import CONSTANT_E
from reproduction.system import GAP


@pytest.fixture(scope="module")
def data():
    """Return the data for a few of the parameters."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bifurcation, "FREQUENCIES", np.array([14.5, 18.5, 19.0, 22.0]))
        patch.setattr(bifurcation, "AMPLITUDES", np.array([15.0, 45.0, 60.0]))
        yield bifurcation.FIGURE.data()


def test_hard_impacts_have_the_exact_speed(data):
    """The simulation with hard impacts converges to the exact motion if it is stable."""
    case = harmonic_case(
        amplitude=bifurcation.AMPLITUDE,
        frequency=22.0,
        state=State(ball_position=GAP),
        duration=150.0,
        times=(0.0,),
        method=Newton(),
    )
    speeds = simulate(case).arrays.impacts.approach_speed[-20:]
    np.testing.assert_allclose(speeds, float(data.stable_over_frequency.sel(frequency=22.0)), rtol=1e-9)


def test_contacts_with_duration_stay_close_to_the_exact_speed(data):
    """If the exact motion is stable, runs with contacts of 0.5 ms settle within 3 % of its speed."""
    speeds = data.speed_over_frequency.sel(model=CONSTANT_E, frequency=22.0)
    np.testing.assert_allclose(speeds, float(data.stable_over_frequency.sel(frequency=22.0)), rtol=0.03)


def test_irregular_where_the_exact_motion_is_unstable(data):
    """Speeds scatter if there is no stable motion with two impacts."""
    lost = data.sel(frequency=[18.5, 19.0], model=CONSTANT_E)
    assert np.isnan(lost.stable_over_frequency).all()
    assert np.isfinite(lost.unstable_over_frequency).all()
    assert not bifurcation.is_settled(lost, "frequency").any()


def test_elastic_limit_is_that_of_the_pair(data):
    """The elastic limit of ball and structure with a rigid wall is 42.3652 mm/s."""
    assert float(data.critical_speed) == pytest.approx(0.0423652, abs=5e-8)


def test_figure_and_caption(data):
    """The figure has a row for each model; the caption counts its frequencies."""
    figure = bifurcation.FIGURE
    assert len(figure.draw(data).axes) == 4
    assert "of 7 loads" in figure.caption(data)
