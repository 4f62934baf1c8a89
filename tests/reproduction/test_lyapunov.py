"""Figure A5: finite-time Lyapunov exponents."""

import numpy as np
import pytest

from rattlebox import simulate
from reproduction import lyapunov
from reproduction.judge import verdict
from reproduction.models import CONSTANT_E, RIGID
from reproduction.system import CONSTANT, PLASTIC_RIGID, paper_case


@pytest.fixture(scope="module")
def data():
    """Return the data for a few pairs of two models."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lyapunov, "MODELS", {CONSTANT_E: CONSTANT, RIGID: PLASTIC_RIGID})
        patch.setattr(lyapunov, "PAIRS", 4)
        yield lyapunov.FIGURE.data()


def test_exponent_without_the_ball(data):
    """The linear structure alone has the exponent -zeta omega = -25.3/40 per second."""
    assert float(data.steady_exponent[2]) == pytest.approx(-0.6325, rel=1e-3)
    assert float(data.expected[2]) == pytest.approx(-0.6325, rel=1e-12)


def test_exponent_of_motion_with_two_contacts_per_cycle(data):
    """The periodic motion attracts as fast as the exact one with hard impacts, to 3 %: contacts take time."""
    assert float(data.steady_exponent[1]) == pytest.approx(float(data.expected[1]), rel=0.03)
    assert not data.steady_chaotic[1]


def test_irregular_motion_is_chaotic(data):
    """Where no motion with two contacts is stable, neighbours part until they are as far as they can be."""
    assert data.steady_chaotic[0]
    assert float(data.steady_exponent[0]) > 5


def test_without_contact_nothing_grows(data):
    """After the weak pulse the centred ball touches no wall, and its neighbour stays where it is."""
    calm = data.sel(pulse=100.0, model=CONSTANT_E, case=1)
    np.testing.assert_allclose(calm.separation, lyapunov.DISTANCE, rtol=1e-6)
    assert float(calm.exponent) == pytest.approx(0, abs=1e-6)
    assert not calm.chaotic


def test_growth_is_measured_from_its_onset_to_saturation():
    """The fit recovers onset and rate of a growth at 7 per second from 1 s to a separation of 1 mm."""
    time = np.arange(1, 1501) * 4e-3
    grown = 1e-12 * np.exp(7 * np.clip(time - 1, 0, None))
    rows = np.minimum([grown, 2 * grown, 0.5 * grown], 1e-3)
    result = lyapunov._separation(time, rows)
    assert result.exponent == pytest.approx(7, rel=1e-9)
    assert result.onset == pytest.approx(1 + np.log(100) / 7, abs=5e-3)
    assert result.determination == pytest.approx(1)
    assert np.nanmax(result.fit) < lyapunov.SATURATION < result.fit[np.isfinite(result.fit)][-1] * 1.03


def test_neighbours_are_as_far_apart_as_they_start():
    """The initial distance of runs whose balls start 0.1 nm apart is 0.1 nm."""
    one, other = (simulate(paper_case(start=start, duration=1e-3, times=(0.0,))) for start in (0.0, 2.5e-7))
    assert lyapunov._distance(one, other)[0] == pytest.approx(1e-10, rel=1e-9)


def test_drawn_and_judged(data):
    """The figure can be drawn, and the verdicts depend on the data."""
    figure = lyapunov.FIGURE
    assert figure.draw(data).axes
    assert "{" not in figure.caption(data)
    assert [verdict(claim) for claim in figure.claims(data)] == ["reproduced", "reproduced", "not reproducible"]
    calm = data.assign(chaotic=data.chaotic & (data.case == 2))
    chaos, portraits, _ = figure.claims(calm)
    assert verdict(chaos) == verdict(portraits) == "not reproducible"
    assert "case 1, " in chaos.note
