"""The status of runs whose energies do not add up."""

import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.engines.status import final_status


@pytest.mark.parametrize("start", [-1.0, -0.999])
def test_a_ball_at_rest_on_a_shaken_table_is_finished(start: float) -> None:
    """Rounding errors without supplied energy are not an energy error, in a run and in a sweep."""
    omega = 2 * math.pi * 25
    table = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=0.9 * 9.81 / omega**2, frequency="25 Hz")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap="10 mm",
            start=start,
            gravity=-9.81,
            contact=rb.Tsuji(restitution=0.8),
        ),
        duration=8.0,
        method=rb.Newton(),
    )
    assert rb.simulate(table).status == "finished"
    swept = rb.sweep(table, {"damper.start": [start]}, ["impacts"], cycles=(180, 16), samples=17)
    assert int(swept.status[0]) == 0


def test_a_small_error_in_the_ledger_is_detected() -> None:
    """An error of a thousandth of the viscous loss exceeds the bound."""
    run = rb.simulate(rb.reference_case(duration=0.5))
    wrong = rb.Run(run.arrays.replaced(viscous_loss=1.001 * run.arrays.viscous_loss))
    assert run.ledger.is_balanced(1e-8)
    assert not wrong.ledger.is_balanced(1e-8)


def struck(**changes: Any) -> rb.Case:
    """Return a ball that hits a wall, integrated with steps longer than its contact."""
    usual: dict[str, Any] = {
        "structure": rb.Fixed(),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(diameter="10 mm", material="steel"),
            cavity_length="30 mm",
            velocity="1 m/s",
            contact=rb.Tsuji(restitution=0.9),
        ),
        "duration": "0.02 s",
        "method": rb.TwoStep(dt_flight="10 us", dt_contact="1 s"),
    }
    return rb.Case(**{**usual, **changes})


def test_fixed_steps_whose_energy_explodes_are_an_energy_error() -> None:
    """Steps longer than a contact end with energy_error in a run and in a sweep, which reports only the residual."""
    run = rb.simulate(struck())
    assert run.energy_residual > 1e3
    assert (run.status, run.ok) == ("energy_error", False)
    assert "dt_contact" in run.message
    result = rb.sweep(
        struck(),
        {"method.dt_contact": ["1 s", "30 ns"]},
        ["impact_loss", "energy_residual"],
        samples=201,
        progress=False,
    )
    names = result.status.attrs["flag_meanings"].split()
    assert [names[number] for number in result.status.values] == ["energy_error", "finished"]
    assert np.isfinite(result.impact_loss.values).tolist() == [False, True]
    assert float(result.energy_residual[0]) > 1e3


def test_a_residual_that_overflows_is_not_finite() -> None:
    """Energies that overflow give the status not_finite in a run and in a sweep."""
    structure = rb.SDOF(mass=1, stiffness=1e20, velocity=1)
    case = struck(structure=structure, damper=[], duration=5, method=rb.TwoStep(dt_flight=1))
    run = rb.simulate(case)
    result = rb.sweep(case, {"duration": [5]}, "energy_residual", samples=6, progress=False)
    assert run.status == "not_finite"
    assert result.status.attrs["flag_meanings"].split()[int(result.status[0])] == "not_finite"


@pytest.mark.parametrize(
    "law", [None, rb.JacksonGreen(), rb.JacksonGreen(wall="rigid")], ids=["constant", "plastic", "rigid"]
)
@pytest.mark.parametrize("start", [-1.0, 0.0, 1.0])
def test_fixed_steps_of_the_reference_case_are_far_below_the_bound(law: Any, start: float) -> None:
    """With the steps of the reference paper the energy residual is at most 2e-5; the bound is 0.01."""
    contact = rb.Tsuji(restitution=law, ending="zero_overlap") if law else None
    run = rb.simulate(rb.reference_case(contact, start=start, duration=0.5, method=rb.TwoStep()))
    assert run.ok
    assert run.energy_residual < 2e-5


@pytest.mark.parametrize("tolerance", [1e-12, 1e-3])
def test_no_method_finishes_beyond_the_bound(tolerance: float) -> None:
    """The bound of the event-driven method grows with its tolerance up to 1 % of the supplied energy."""
    run = rb.simulate(rb.reference_case(duration=0.3, method=rb.EventDriven(tolerance=tolerance)))
    off = 0.02 * float(run.ledger.supplied[-1])
    wrong = rb.Run(run.arrays.replaced(viscous_loss=run.arrays.viscous_loss + off * (run.arrays.time > 0)))
    assert final_status(run.ledger, _core.worst_energy_residual, 1.2) == Status.finished
    assert final_status(wrong.ledger, _core.worst_energy_residual, 1.2) == Status.energy_error


@pytest.mark.parametrize("method", [rb.EventDriven(), rb.Newton(), rb.TwoStep()], ids=lambda method: method.kind)
@pytest.mark.parametrize("gravity", [0.0, -9.81])
def test_a_ball_at_rest_is_finished(method: Any, gravity: float) -> None:
    """Rounding errors of a ball at rest, far above the supplied energy, are not an energy error: the bound has a floor."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"),
        gap="10 mm",
        start=-1.0,
        gravity=gravity,
        contact=rb.Tsuji(restitution=0.8),
    )
    case = rb.Case(structure=rb.Fixed(), damper=damper, duration=0.02, method=method)
    assert rb.simulate(case).status == "finished"
    assert int(rb.sweep(case, {"damper.gap": ["10 mm"]}, "energy_residual", samples=101, progress=False).status[0]) == 0
