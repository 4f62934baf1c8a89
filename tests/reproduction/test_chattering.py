"""Figure A4: chattering."""

import numpy as np
import pytest

from reproduction import chattering
from reproduction.judge import verdict
from reproduction.models import CONSTANT_E, RIGID
from reproduction.system import GAP


@pytest.fixture(scope="module")
def data():
    """Return the data for two of the loads."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(chattering, "LOADS", np.array([100.0, chattering.LOAD]))
        yield chattering.FIGURE.data()


def test_restitution_is_jackson_and_greens(data):
    """Each impact of the elasto-plastic model has the restitution of the law at its speed, 1 below 42.3652 mm/s."""
    hits = data.sel(shown=RIGID).dropna("hit")
    assert float(data.critical_speed) == pytest.approx(0.0423652, abs=5e-8)
    ratio = hits.approach_speed / 0.0423652
    plastic = hits.sel(hit=ratio > 1.001)
    over = plastic.approach_speed / 0.0423652
    law = 1 - 0.1 * np.log(over) * ((over - 1) / 59) ** 0.156
    assert plastic.hit.size > 30
    np.testing.assert_allclose(plastic.restitution, law, atol=1e-5)
    elastic = hits.sel(hit=ratio < 0.999)
    assert elastic.hit.size > 5
    assert (elastic.restitution == 1).all()


def test_chattering_ends_in_an_elastic_lasting_contact(data):
    """The lasting contact is elastic, and lies around the instant at which the wall's acceleration is largest."""
    one = data.sel(shown=RIGID)
    lasting = one.where(one.lasting, drop=True)
    assert lasting.hit.size == 2
    assert float(lasting.approach_speed.max()) < float(data.critical_speed)
    for begin, length in zip(lasting.hit_time.values, lasting.contact_time.values, strict=True):
        turn = float(abs(one.displacement.sel(time=slice(begin, begin + length))).idxmax())
        assert turn == pytest.approx(begin + length / 2, abs=0.1 * length)


def test_constant_restitution_does_not_come_to_rest(data):
    """With constant restitution no contact lasts, at either load, nor with the elasto-plastic model at the lower one."""
    assert not data.held.sel(model=CONSTANT_E).any()
    assert data.held.sel(model=RIGID).values.tolist() == [False, True]


def test_ball_alone_is_irregular(data):
    """The load determines the structure's motion to 0.1 %; with constant restitution the ball's motion is irregular."""
    low, median, high = data.displacement_spread.transpose("quantile", ...)
    size = float(abs(data.displacement).max())
    assert float((high - low).max()) < 1e-3 * size
    assert float(abs(median - data.displacement).max()) < 1e-3 * size
    low, _, high = data.place_spread.sel(shown=CONSTANT_E).transpose("quantile", ...)
    assert float((high - low).max()) > 0.5 * GAP


def test_drawn_and_judged(data):
    """The figure can be drawn, and the verdict depends on the lasting contacts."""
    figure = chattering.FIGURE
    assert len(figure.draw(data).axes) == 8
    assert "chatter ends in contacts of up to 17 ms" in figure.caption(data)
    (claim,) = figure.claims(data)
    assert verdict(claim) == "reproduced"
    (claim,) = figure.claims(data.assign(held_starts=0 * data.held_starts))
    assert verdict(claim) == "not reproducible"
