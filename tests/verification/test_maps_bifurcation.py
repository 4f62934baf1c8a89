"""Where motions begin, double and end: found by bifurcation diagrams, against exact thresholds."""

import numpy as np
import pytest

import rattlebox as rb

from . import cases
from .exact import shaken

AMPLITUDE = "structure.motion.amplitude"
STEP = 5e-4
"""Between two values; thresholds lie halfway between two."""


def around(threshold, below, above):
    """Values to both sides of a threshold."""
    return threshold + STEP * (np.arange(-below, above) + 0.5)


def lost(values, held):
    """Middle between the last value at which a motion holds and the next, in the order in which they are run."""
    held = np.asarray(held)
    last = int(np.argmin(held)) - 1
    assert held[: last + 1].all() and not held[last + 1 :].any()
    return 0.5 * (values[last] + values[last + 1])


@pytest.mark.parametrize(
    ("restitution", "cycles", "printed"),
    [(0.5, 1, (1.0471976, 1.5268237)), (0.8, 1, (0.3490659, 1.0708365)), (0.5, 2, (2.0943951, 2.3708772))],
)
def test_table_thresholds(restitution, cycles, printed):
    """The bouncing ball's orbit is followed up to where it doubles and down to where it ends, both to 1e-3."""
    begin, double = shaken.table_bounds(restitution, cycles)
    assert (begin, double) == pytest.approx(printed, abs=5e-8)

    def diagram(gamma, values, skip, direction):  # gamma is none of the values: no impact at a strobe
        case = cases.table(shaken.table_orbit(restitution, gamma, cycles), 1)
        maps = rb.bifurcation(case, AMPLITUDE, values, cycles=(skip, 48), direction=direction, progress=False)
        assert (maps.status == 0).all()
        return maps.isel(direction=0)

    up = around(double, 8, 8)
    maps = diagram(float(up[0]) - STEP, up, 4000, "up")  # near a threshold motions settle slowly
    assert lost(up, maps.period == cycles) == pytest.approx(double, abs=1e-3)
    assert (maps.period[-4:] == 2 * cycles).all()

    down = around(begin, 8, 8)
    maps = diagram(float(down[-1]) + STEP, down, 300, "down")
    bounces = (maps.period == cycles) & np.isclose(maps.impacts_per_cycle, 1 / cycles)
    assert lost(down[::-1], bounces[::-1]) == pytest.approx(begin, abs=1e-3)


@pytest.mark.parametrize(("restitution", "printed"), [(0.3, 0.3242719), (0.6, 0.1571767), (0.8, 0.0705592)])
def test_slow_manifold_threshold(restitution, printed):
    """Two impacts a cycle in a shaken cavity are followed down to the least amplitude that feeds them, to 1e-3."""
    threshold = shaken.threshold(restitution)
    assert threshold == pytest.approx(printed, abs=5e-8)
    down = around(threshold, 10, 20)
    case = cases.shaken_cavity(shaken.two_impacts(restitution, float(down[-1])), 1)
    maps = rb.bifurcation(
        case, AMPLITUDE, down, cycles=(500, 48), direction="down", show="impacts", progress=False
    ).isel(direction=0)
    two = (maps.period == 1) & np.isclose(maps.impacts_per_cycle, 2)
    assert lost(down[::-1], two[::-1]) == pytest.approx(threshold, abs=1e-3)
    for index in np.flatnonzero(two):
        orbit = shaken.two_impacts(restitution, float(down[index]))
        speeds = maps.approach_speed[index].dropna("impact")
        assert speeds.size == 96
        np.testing.assert_allclose(speeds, orbit.approach, rtol=1e-5)
