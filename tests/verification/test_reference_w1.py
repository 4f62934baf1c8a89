"""The reference case, centred, with constant alpha, against a computation in 113-bit arithmetic."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import impact_cases, known_impacts

REFERENCE: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "w1_centre.json").read_text())
HORIZON = REFERENCE["horizon_double_z_1e_9m"]
SAMPLES = np.array([row for row in REFERENCE["samples"] if row[0] <= HORIZON])


@pytest.fixture(scope="module")
def run() -> Any:
    """Return the run up to the time to which double precision is accurate."""
    return known_impacts.simulate(impact_cases.reference_case(duration=HORIZON + 0.05, times=SAMPLES[:, 0], mass=1.2))


def test_first_thirty_impacts_come_at_the_reference_times(run: Any) -> None:
    """The first thirty impact times agree to 1e-9, and so do the sides."""
    log, exact = run.arrays.impacts, REFERENCE["impacts_first30"]
    assert log.time[:30] == pytest.approx([i["t0"] for i in exact], rel=1e-9)
    assert list(2 * log.contact[:30] - 1) == [i["side"] for i in exact]
    assert log.duration[:30] == pytest.approx([i["t1"] - i["t0"] for i in exact], rel=1e-7)


def test_first_thirty_impacts_have_the_reference_speeds(run: Any) -> None:
    """Approach and separation speeds of the first thirty impacts agree to 1e-8."""
    log, exact = run.arrays.impacts, REFERENCE["impacts_first30"]
    assert log.approach_speed[:30] == pytest.approx([i["Din"] for i in exact], rel=1e-8)
    assert log.separation_speed[:30] == pytest.approx([-i["Dout"] for i in exact], rel=1e-8)


def test_structure_stays_within_a_nanometre(run: Any) -> None:
    """The structure is within 1e-9 m of the reference while double precision permits it."""
    a = run.arrays
    at = np.searchsorted(a.time, SAMPLES[:, 0])
    assert a.time[at] == pytest.approx(SAMPLES[:, 0], rel=1e-15)
    assert np.abs(a.displacement[at, 0] - SAMPLES[:, 1]).max() <= 1e-9


def test_energies_agree_with_the_reference(run: Any) -> None:
    """Work, viscous loss and impact loss agree with the reference at the sample times."""
    a = run.arrays
    at = np.searchsorted(a.time, SAMPLES[:, 0])
    work = SAMPLES[-1, 7]
    assert np.abs(a.load_work[at] - SAMPLES[:, 7]).max() <= 1e-12 * work
    assert np.abs(a.viscous_loss[at] - SAMPLES[:, 6]).max() <= 1e-8 * work
    # At a sample inside a contact the two may divide the loss differently; none of these is.
    assert np.abs(a.normal_loss[at, 0] - SAMPLES[:, 5]).max() <= 1e-8 * work


def test_grazing_contact_is_found(run: Any) -> None:
    """Contact 84 touches at less than a millimetre a second and is not missed."""
    time, side, speed, _ = REFERENCE["impact_84"]
    log = run.arrays.impacts
    assert log.time[83] == pytest.approx(time, rel=1e-9)
    assert 2 * log.contact[83] - 1 == side
    # The motion amplifies rounding: nanometres at the horizon are some 1e-7 of this slow approach.
    assert log.approach_speed[83] == pytest.approx(speed, rel=1e-5)
    exact = [row[0] for row in REFERENCE["all_impacts_t0_side_Din_Dout"]]
    assert log.time[: len(exact)] == pytest.approx(exact, rel=1e-8)
