"""Figure A6: steady motions by continuation."""

import numpy as np
import pytest
from tests.reproduction.test_drawn import unknown_marks

from reproduction import branches
from reproduction.files import grouped, record_cases
from reproduction.harmonic import paper_two_impacts
from reproduction.judge import verdict

FEW = np.array([14.0, 16.6])


@pytest.fixture(scope="module")
def data():
    """Return the data with motions sought at a few of the frequencies."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(branches, "FREQUENCIES", FEW)
        patch.setattr(branches, "SEEDS", 1)
        with record_cases() as runs:
            found = branches.FIGURE.data()
        yield found.assign_attrs(runs=runs)


def test_branch_of_two_impacts_is_the_closed_form(data):
    """Speeds, and the range in which the motion is stable, are those of the exact motion with two impacts a cycle."""
    # Past the grazing point the branch continues with more impacts.
    symmetric = data.isel(point=((data.branch == 0) & (data.contacts == 2)).values)
    assert symmetric.point.size > 100
    for point in range(10, symmetric.point.size - 10, 20):
        one = symmetric.isel(point=point)
        exact = min(
            paper_two_impacts(branches.AMPLITUDE, float(one["at"])),
            key=lambda motion, speed=float(one.slowest): abs(motion.approach_speed - speed),
        )
        assert float(one.slowest) == pytest.approx(exact.approach_speed, rel=1e-8)
        if abs(exact.multiplier - 1) > 1e-6:  # not the located point itself
            assert bool(one.stable) == (exact.multiplier < 1)


def test_symmetry_is_lost_at_13_6_hertz(data):
    """The pitchfork and the two torus bifurcations are where the exact multiplier crosses one."""
    special = data.isel(point=((data.branch == 0) & (data.contacts == 2)).values & (data.special.values != ""))
    for kind in ("pitchfork", "torus"):
        assert kind in special.special.values
        for frequency in special.located.values[special.special.values == kind]:
            below, above = (
                paper_two_impacts(branches.AMPLITUDE, frequency + step)[0].multiplier for step in (-1e-4, 1e-4)
            )
            assert (below - 1) * (above - 1) < 0


def test_runs_are_variants_of_the_case(data):
    """The runs of the figure differ from its case in numbers only; the files of its runs were written in slow tests only."""
    grouped(branches.FIGURE.cases(), data.attrs["runs"])


def test_drawn_and_judged(data):
    """The figure draws numbers of its dataset only, and the claim depends on the data."""
    figure = branches.FIGURE
    drawn = figure.draw(data)
    assert len(drawn.axes) == 2 and not unknown_marks(drawn, data)
    assert "followed by continuation" in figure.caption(data)
    changing = data.assign(contacts=data.contacts.where(data["at"] > 15, 3))
    assert verdict(figure.claims(changing)[0]) == "reproduced"
    one = data.isel(point=(data.contacts == 2).values)
    assert verdict(figure.claims(one)[0]) == "not reproducible"
