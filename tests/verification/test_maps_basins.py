"""Steady motions of basins of attraction against exact orbits."""

import math

import numpy as np
import pytest
from support import impact_cases
from support.exact import shaken

import rattlebox as rb

RESTITUTION, GAMMA = 0.8, 0.9


def state(orbit: shaken.TableOrbit, since: float) -> tuple[float, float]:
    """Return the height of the ball over the table and its rate, some time after an impact."""
    table = orbit.phase + since
    height = orbit.gamma * (math.sin(orbit.phase) - math.sin(table)) + orbit.launch * since - 0.5 * since**2
    return height, orbit.launch - since - orbit.gamma * math.cos(table)


def test_bouncing_balls_coexist() -> None:
    """Rest on the table and the orbits that bounce every cycle and every second cycle coexist, and are found to 1e-8."""
    case = impact_cases.table(shaken.table_orbit(RESTITUTION, GAMMA, 1), 1)
    phase = case.structure.motion[0].phase
    gap = impact_cases.TABLE_GAP
    starts = {
        "damper.start": np.linspace(0, 12, 7) / gap - 1,
        "damper.velocity": np.linspace(-4, 4, 7),
    }
    maps = rb.basins(case, starts, cycles=(300, 16), tolerance=1e-9, apart=1e-4, progress=False)
    for cycles in (1, 2):
        orbit = shaken.table_orbit(RESTITUTION, GAMMA, cycles)
        expected = (maps.orbit_period == cycles) & np.isclose(maps.orbit_impacts_per_cycle, 1 / cycles)
        result = maps.isel(orbit=np.flatnonzero(expected)).squeeze("orbit")  # one and no more
        strobes = [state(orbit, (phase - orbit.phase) % (2 * math.pi) + 2 * math.pi * k) for k in range(cycles)]
        heights = result.orbit_relative_position.values[:cycles, 0] + gap
        rates = result.orbit_relative_velocity.values[:cycles, 0]
        ours = sorted(zip(heights.tolist(), rates.tolist(), strict=True))
        assert ours == [pytest.approx(exact, abs=1e-8) for exact in sorted(strobes)]
    rest = maps.isel(orbit=np.flatnonzero(maps.orbit_impacts_per_cycle == 0)).squeeze("orbit")
    assert rest.orbit_period == 1
    assert rest.orbit_relative_position.values[0, 0] + gap == pytest.approx(0, abs=1e-12)
    assert rest.orbit_relative_velocity.values[0, 0] == pytest.approx(0, abs=1e-12)
    assert maps.attractor.sel({"damper.velocity": 0}).values[0] == rest.orbit  # the table alone never throws it
