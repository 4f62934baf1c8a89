"""Drifts between points of structures whose motion is known."""

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import drift

TOWER = rb.ShearBuilding(masses=["50 t", "40 t"], stiffnesses=["60 MN/m", "50 MN/m"], damping_ratio=0.5)


def test_storeys_under_a_steady_push_drift_by_force_over_stiffness():
    """Under a slow base acceleration each storey drifts by the inertia force above it over its stiffness."""
    slow = rb.Record(times=[0, 20, 40], values=[0, 1, 1], unit="m/s^2")
    run = rb.simulate(rb.Case(structure=TOWER, base=slow, duration="40 s", output=rb.Output(rate="100 Hz")))
    first, second = drift(run, "storey 1"), drift(run, "storey 2", "storey 1")
    assert float(first[-1]) == pytest.approx(-90e3 / 60e6, rel=1e-6)
    assert float(second[-1]) == pytest.approx(-40e3 / 50e6, rel=1e-6)
    np.testing.assert_allclose(first + second, run.motion.displacement.sel(point="storey 2"), atol=1e-18)
    assert second.attrs["units"] == "m" and second.time.attrs["units"] == "s"


@pytest.mark.parametrize("points", [("roof",), ("storey 2", "cellar")])
def test_an_unknown_point_is_refused_with_those_that_exist(points):
    """The message names the unknown point and the known ones."""
    run = rb.simulate(rb.Case(structure=TOWER, duration="0.1 s"))
    with pytest.raises(ValueError, match=f"'{points[-1]}'.*storey 1, storey 2"):
        drift(run, *points)
