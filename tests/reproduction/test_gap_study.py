"""Figure R3: with and without the damper."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from reproduction import gap_study
from reproduction.models import CONSTANT_E, RIGID, STEEL
from reproduction.system import DAMPING, GAP, MASS


@pytest.fixture(scope="module")
def data():
    """Return the data for a few gaps and starts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gap_study, "GAPS", np.array([GAP, 1.6e-3, gap_study.BEST, 2.6e-3]))
        patch.setattr(gap_study, "RESTITUTIONS", np.array([0.6, 0.9, 0.99]))
        patch.setattr(gap_study, "MEMBERS", 6)
        yield gap_study.data()


def test_bare_and_attached_structures_settle_as_they_must(data):
    """Settling times without the ball and with an attached one are those of exp(-C t/2M), to half a period."""
    weight = gap_study._attached().structure.mass / MASS
    for name, ratio in (("settled_bare", 1.0), ("settled_attached", weight)):
        # The pulse gives P/M, and M + m swings with P/sqrt(K (M + m)).
        expected = (np.log(20) - 0.5 * np.log(ratio)) * 2 * MASS * ratio / DAMPING
        assert float(data[name]) == pytest.approx(expected, abs=0.055)
    assert float(data.settled_attached - data.settled_bare) > 0.2


def test_paper_gap_is_useless(data):
    """With the paper's gap no model shortens the settling, and the RMS changes by at most one per cent."""
    paper = data.sel(gap=GAP)
    assert float(paper.settled.min()) > float(data.settled_bare)
    assert float(np.abs(paper.rms_change.sel(quantile=0.5)).max()) < 0.012


def test_only_the_rigid_wall_profits_from_the_gap(data):
    """Just below the peak the rigid wall settles in 2.8 s with 40 % of the work; the others never settle earlier."""
    best = data.sel(gap=gap_study.BEST, quantile=0.5)
    assert float(best.loss.sel(model=RIGID)) == pytest.approx(0.40, abs=0.02)
    assert float(best.settled.sel(model=RIGID)) == pytest.approx(2.85, abs=0.2)
    touched = data.settled.where(data.loss.sel(quantile=0.5) > 0).sel(model=[CONSTANT_E, STEEL])
    assert float(touched.min()) > float(data.settled_bare)


def test_never_touched_beyond_the_peak(data):
    """A gap larger than the peak changes nothing."""
    wide = data.sel(gap=2.6e-3)
    assert float(wide.loss.max()) == 0
    np.testing.assert_allclose(wide.settled, data.settled_bare)
    assert float(np.abs(wide.held).max()) < 1e-3


def test_balance_decides(data):
    """Impacts that dissipate more than the dashpot misses lower the RMS, and only those."""
    touched = data.sel(gap=[GAP, 1.6e-3, gap_study.BEST], quantile=0.5)
    faster = touched.taken > touched.held
    assert faster.sel(model=RIGID).values.tolist() == [False, True, True]
    assert not faster.sel(model=[CONSTANT_E, STEEL]).any()
    touched, faster = (each.sel(model=[CONSTANT_E, STEEL, RIGID]) for each in (touched, faster))
    assert float(touched.rms_change.where(faster).max()) < -0.1
    assert float(touched.rms_change.where(~faster).min()) > -0.02


def test_lossy_contacts_help(data):
    """A restitution of 0.6 settles several times faster than that of steel, with any gap."""
    settled = data.settled_of_e.sel(quantile=0.5)
    assert (settled.sel(restitution=0.6) < 0.6 * settled.sel(restitution=0.99)).all()
    assert float(settled.sel(restitution=0.99).min()) > float(data.settled_bare)


def test_lessons_contain_the_computed_numbers(data):
    """The lessons state the settling times and the best gap of the data."""
    text = " ".join(gap_study.FIGURE.lessons(data))
    assert f"instead of {float(data.settled_bare):.2f} s" in text and "A gap of 2.3 mm" in text
    assert len(gap_study.FIGURE.lessons(data)) == 6


def test_animation_moves_as_the_runs(data):
    """The animation is well-formed, moves each structure as its run, and shortens the bar as the energy falls."""
    drawn = ElementTree.fromstring(gap_study.animation(data))
    moves = [node for node in drawn.iter("animateTransform") if node.get("type") == "translate"]
    assert len(moves) == 5 and drawn.get("role") == "img"
    values = np.array([float(v) for v in moves[0].get("values").split(";")])
    np.testing.assert_allclose(values, 18e3 * data.film_structure[0], atol=0.051)
    bars = list(drawn.iter("animate"))
    assert all(float(bar.get("values").split(";")[-1]) < 30 for bar in bars)
    assert not re.search("nan|inf", ElementTree.tostring(drawn, "unicode"))
