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
    """Rounding is no open ledger where nothing is supplied, in a run and in a sweep."""
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


def test_a_lost_joule_is_found_out() -> None:
    """A thousandth of the viscous loss gone astray is more than any bound allows."""
    run = rb.simulate(rb.reference_case(duration=0.5))
    astray = rb.Run(run.arrays.replaced(viscous_loss=1.001 * run.arrays.viscous_loss))
    assert run.ledger.is_balanced(1e-8)
    assert not astray.ledger.is_balanced(1e-8)


def struck(**changes: Any) -> rb.Case:
    """Return a ball that flies to a wall with steps that are longer than its contact."""
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
    """Steps longer than a contact end as energy_error, alone and as a variant, of which only the residual is a number."""
    run = rb.simulate(struck())
    assert run.energy_residual > 1e3
    assert (run.status, run.ok) == ("energy_error", False)
    assert "dt_contact" in run.message
    found = rb.sweep(
        struck(),
        {"method.dt_contact": ["1 s", "30 ns"]},
        ["impact_loss", "energy_residual"],
        samples=201,
        progress=False,
    )
    names = found.status.attrs["flag_meanings"].split()
    assert [names[number] for number in found.status.values] == ["energy_error", "finished"]
    assert np.isfinite(found.impact_loss.values).tolist() == [False, True]
    assert float(found.energy_residual[0]) > 1e3


def test_a_residual_that_overflows_is_not_finite() -> None:
    """Energies beyond all numbers have the same status in a run and in a study of it."""
    structure = rb.SDOF(mass=1, stiffness=1e20, velocity=1)
    case = struck(structure=structure, damper=[], duration=5, method=rb.TwoStep(dt_flight=1))
    run = rb.simulate(case)
    found = rb.sweep(case, {"duration": [5]}, "energy_residual", samples=6, progress=False)
    assert run.status == "not_finite"
    assert found.status.attrs["flag_meanings"].split()[int(found.status[0])] == "not_finite"


@pytest.mark.parametrize(
    "law", [None, rb.JacksonGreen(), rb.JacksonGreen(wall="rigid")], ids=["constant", "plastic", "rigid"]
)
@pytest.mark.parametrize("start", [-1.0, 0.0, 1.0])
def test_fixed_steps_of_the_reference_case_are_far_below_the_bound(law: Any, start: float) -> None:
    """The steps of the reference paper keep the energy to 2e-5 of what was put in; the bound is 0.01."""
    contact = rb.Tsuji(restitution=law, ending="zero_overlap") if law else None
    run = rb.simulate(rb.reference_case(contact, start=start, duration=0.5, method=rb.TwoStep()))
    assert run.ok
    assert run.energy_residual < 2e-5


@pytest.mark.parametrize("tolerance", [1e-12, 1e-3])
def test_no_method_finishes_beyond_the_bound(tolerance: float) -> None:
    """The bound of the event-driven method grows with its tolerance, to a hundredth of the energy put in at most."""
    run = rb.simulate(rb.reference_case(duration=0.3, method=rb.EventDriven(tolerance=tolerance)))
    off = 0.02 * float(run.ledger.supplied[-1])
    astray = rb.Run(run.arrays.replaced(viscous_loss=run.arrays.viscous_loss + off * (run.arrays.time > 0)))
    assert final_status(run.ledger, _core.worst_energy_residual, 1.2) == Status.finished
    assert final_status(astray.ledger, _core.worst_energy_residual, 1.2) == Status.energy_error


@pytest.mark.parametrize("method", [rb.EventDriven(), rb.Newton(), rb.TwoStep()], ids=lambda method: method.kind)
@pytest.mark.parametrize("gravity", [0.0, -9.81])
def test_a_ball_at_rest_is_finished(method: Any, gravity: float) -> None:
    """Rounding of a ball at rest, far above the energy put in, is no energy error: the bound has a floor."""
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
