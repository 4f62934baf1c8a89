"""Periods and multipliers of bifurcation diagrams and basins against orbits whose stability is known."""

import math

import numpy as np
import pytest
from support import impact_cases
from support.exact import masri_caughey, shaken

import rattlebox as rb
from rattlebox.studies.work.reductions import Motion


def spiral(frequency: str) -> rb.Case:
    """Return a damper whose motion with two impacts a cycle is a slow spiral up to its Neimark-Sacker point, 36.82 Hz."""
    return rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude=5.0, frequency=frequency),
        duration="1 s",
        method=rb.Newton(),
    )


@pytest.mark.parametrize("cycles", [(60, 16), (60, 32), (150, 32), (300, 48)])
def test_a_spiral_up_to_its_bifurcation_has_period_one(cycles: tuple[int, int]) -> None:
    """From 33.1 to 36.82 Hz no motion with two impacts a cycle has a period above one, nor has the torus above.

    Differences of states were compared with the gap alone, and tests skipped until nothing contracted.
    """
    maps = rb.bifurcation(
        spiral("33 Hz"), "load.frequency", rb.linspace("33.1 Hz", "36.95 Hz", 78), cycles=cycles, progress=False
    )
    two = np.abs(maps.impacts_per_cycle.values - 2) < 1e-9
    assert two.sum() > 70
    assert set(maps.period.values[two].tolist()) <= {0, 1}
    below = two & (maps["load.frequency"].values < 36.8)
    irregular = below & (maps.motion.values == Motion.IRREGULAR)
    assert irregular.sum() <= 1  # the way down loses this motion at 35.6 Hz
    above = two & (maps["load.frequency"].values > 36.83)
    assert (maps.period.values[above] == 0).all()
    factors = maps.multiplier.values[maps.motion.values == Motion.TRANSIENT]
    assert ((factors > 0.5) & (factors < 1)).all()


def test_one_spiral_is_one_orbit_of_the_basins() -> None:
    """Starts that still spiral in are transient with the multiplier 0.92; after the proposed cycles they are one orbit."""
    starts = {"damper.start": rb.linspace(-1, 1, 24), "damper.velocity": rb.linspace("-0.3 m/s", "0.3 m/s", 24)}
    early = rb.basins(spiral("36 Hz"), starts, cycles=(100, 16), progress=False)
    transient = early.attractor.values == -2
    assert transient.any() and early.sizes["orbit"] == 0
    assert float(np.median(early.multiplier.values[transient])) == pytest.approx(0.92, abs=0.005)
    late = rb.basins(spiral("36 Hz"), starts, cycles=(300, 16), progress=False)
    assert late.orbit_period.values.tolist() == [1]
    assert (late.attractor.values[transient & (np.abs(early.multiplier.values - 0.92) < 0.01)] == 1).all()


@pytest.mark.parametrize("restitution", [0.5, 0.65, 0.8])
@pytest.mark.parametrize("cycles", [(30, 16), (120, 32), (300, 48)])
def test_the_bouncing_ball_doubles_its_period_where_it_must(restitution: float, cycles: tuple[int, int]) -> None:
    """Over 240 amplitudes of the table, period one is found only below the doubling, and two only above.

    The orbit of period two lasts to about 1.1 times the amplitude of the doubling, further up to four and chaos follow.
    """
    start, double = shaken.table_bounds(restitution, 1)
    case = impact_cases.table(shaken.table_orbit(restitution, 1.02 * start, 1), 1)
    amplitude = np.linspace(1.02 * start, 1.08 * double, 240)
    path = "structure.motion.amplitude"
    maps = rb.bifurcation(case, path, amplitude, cycles=cycles, direction="up", progress=False).isel(direction=0)
    once = np.isclose(maps.impacts_per_cycle.values, 1)
    assert once.mean() > 0.9
    period, below = maps.period.values, amplitude < double
    assert set(period[once & below].tolist()) <= {0, 1}
    assert set(period[once & (amplitude > 1.001 * double)].tolist()) <= {0, 2, 4}
    assert (maps.motion.values[once & below & (period == 0)] == Motion.TRANSIENT).all()
    assert np.mean(period[once & (amplitude < 0.97 * double)] == 1) > (0.9 if cycles[0] > 100 else 0.5)


@pytest.mark.parametrize(
    "key", [(0.05, 0.25, 30.0), (0.05, 0.5, 40.0), (0.1, 0.25, 20.0), (0.1, 0.5, 20.0), (0.1, 0.75, 20.0)]
)
def test_multipliers_of_masri_and_caughey(key: tuple[float, float, float]) -> None:
    """Disturbed dampers are transient with the largest multiplier of the exact orbit, and at last periodic."""
    (orbit,) = [o for o in masri_caughey.orbits(*key) if np.abs(o.multipliers()).max() < 1]
    exact = np.abs(orbit.multipliers()).max() ** 2  # of the two mirrored halves of a cycle
    case = impact_cases.impact_damper(orbit, 2)
    rest = case.structure.displacement
    starts = {"structure.displacement": rest + np.linspace(-0.5, 0.5, 6)}
    early = rb.basins(case, starts, cycles=(10, 24), progress=False)
    assert (early.motion == Motion.TRANSIENT).all()
    np.testing.assert_allclose(early.multiplier, exact, atol=0.006)
    skip = 30 + math.ceil(math.log(1e-7) / math.log(exact))
    late = rb.basins(case, starts, cycles=(skip, 24), progress=False)
    assert late.attractor.values.tolist() == [1] * 6
    assert late.orbit_period.values.tolist() == [1]
    assert late.orbit_impacts_per_cycle.values == pytest.approx([2])
