"""Measures of walls: mean pressure and wear, of runs and in studies."""

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import wall_pressures, wall_wear

DAMPER = rb.ParticleDamper(
    particles=rb.Particles(material="steel", diameter="4 mm", count=60),
    cavity=rb.Box(size=(0.02,) * 3),
    contact=rb.Tsuji(restitution=0.7),
    friction=0.3,
    walls={"-z": rb.Wall(friction=0.1), "+y": "frictionless"},
    packing=rb.Settled(seed=1),
    softening=100,
)
SHAKER = rb.Shaker(motion=rb.Harmonic(amplitude="40 m/s^2", frequency="40 Hz", direction="z"))


def case(**output: bool) -> rb.Case:
    """Return a bed on a shaker."""
    return rb.Case(structure=SHAKER, dampers=DAMPER, duration="0.05 s", output=rb.Output(rate="2 kHz", **output))


def test_measures_of_walls_are_means_over_time_and_area() -> None:
    """Mean pressure and wear are sums over the run, over area and time; a frictionless face has no wear."""
    run = rb.simulate(case(walls=True))
    arrays = run.arrays
    scale = arrays.wall_area * arrays.time[-1]
    pressure, wear = wall_pressures(run), wall_wear(run)
    assert list(pressure) == list(arrays.walls) and wear["+y"] == 0
    assert np.array(list(pressure.values())) * scale == pytest.approx(arrays.wall_normal_impulse[-1])
    assert np.array(list(wear.values())) * scale == pytest.approx(arrays.wall_sliding_loss[-1])


def test_studies_record_walls_by_themselves() -> None:
    """A study has the largest value of all walls, also where its case does not record them, and of the window only."""
    study = rb.sweep(
        case(), {"damper.walls.-z.friction": [0.1, 0.4]}, ["largest_wall_pressure", "largest_wall_wear"], progress=False
    )
    run = rb.simulate(case(walls=True))
    assert float(study.largest_wall_pressure[0]) == max(wall_pressures(run).values())
    assert float(study.largest_wall_wear[0]) == max(wall_wear(run).values())
    assert study.largest_wall_wear.attrs["units"] == "W/m^2"
    late = rb.sweep(case(), {"seed": [0]}, ["largest_wall_pressure"], skip="0.025 s", progress=False)
    start = int(np.searchsorted(run.arrays.time, 0.025 - 1e-9))
    impulse = run.arrays.wall_normal_impulse[-1] - run.arrays.wall_normal_impulse[start]
    assert float(late.largest_wall_pressure[0]) == pytest.approx(float((impulse / run.arrays.wall_area).max() / 0.025))


def test_a_run_that_did_not_record_its_walls_says_how() -> None:
    """Measures of walls are refused for a run without them, with the output that records them."""
    with pytest.raises(
        rb.CaseError, match=r"walls of this run were not recorded\n  try: output = rb.Output\(walls=True\)"
    ):
        wall_pressures(rb.simulate(case()))
    with pytest.raises(rb.CaseError, match="a 1-D run has no faces"):
        wall_wear(rb.simulate(rb.reference_case(duration="0.01 s")))
