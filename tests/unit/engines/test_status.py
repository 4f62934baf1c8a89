"""What a run that did not finish says."""

import pytest

import rattlebox as rb
from rattlebox.core._core import Status
from rattlebox.engines.status import MESSAGES, describe

LACKS = {
    "event_driven": ("EventDriven", "dt_flight", "stick,"),
    "newton": ("Newton method", "dt_flight", "tolerance"),
    "two_step": ("TwoStep", "tolerance", "stick,"),
}
OTHERS_NEVER = {"step_too_small": "event_driven", "no_rebound": "two_step"}
"""These do not happen with other methods, but for no_rebound with EventDriven."""


@pytest.mark.parametrize("method", LACKS)
@pytest.mark.parametrize("status", Status)
def test_advice_fits_the_method(status: Status, method: str) -> None:
    """The status of a failed run has advice that names neither the method in use nor fields that this method lacks."""
    name, message = describe(status, 0.5, "damper (trailing wall)", 0.1, method)
    happened = MESSAGES[status].format(time=0.5, contact="damper (trailing wall)", value=0.1)
    assert message.startswith(happened)
    assert (message == happened) == (name in ("finished", "interrupted"))
    if OTHERS_NEVER.get(name, method) == method:
        assert not any(word in message for word in LACKS[method])


@pytest.mark.parametrize(
    ("method", "status"),
    [(rb.EventDriven(), "no_rebound"), (rb.TwoStep(), "no_rebound"), (rb.Newton(), "finished")],
    ids=lambda value: getattr(value, "kind", value),
)
@pytest.mark.parametrize(
    "law",
    [
        rb.JacksonGreen(wall="rigid", yield_stress="5 MPa", extrapolate=True),
        rb.Tabulated(speeds=[0.01, 0.02], values=[1, 0]),
    ],
    ids=lambda law: law.kind,
)
def test_dashpot_does_not_stop_a_ball(law: rb.JacksonGreen | rb.Tabulated, method: rb.Newton, status: str) -> None:
    """A law with restitution 0 ends a run with soft contacts with a status; hard impacts accept it."""
    run = rb.simulate(
        rb.Case(
            structure=rb.Fixed(),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius="1 cm", material="steel"),
                gap="1 mm",
                velocity="0.2 m/s",
                contact=rb.Tsuji(restitution=law),
            ),
            duration="0.02 s",
            method=method,
        )
    )
    assert run.status == status
    assert ("restitution is zero" in run.message) == (status == "no_rebound")


@pytest.mark.parametrize(
    ("velocity", "where"),
    [
        ([-3.0, 0.0], "second (trailing wall)"),
        ([1.0, -3.0], "second (ball 1 - 2)"),
        ([0.0, 3.0], "second (leading wall)"),
    ],
)
def test_the_contact_is_named_in_the_damper_that_it_is_of(velocity: list[float], where: str) -> None:
    """With several dampers a law that is left names the damper, and the wall or the balls in it."""
    ball = rb.Sphere(radius="1 cm", material="steel")
    law = rb.Tsuji(restitution=rb.JacksonGreen(yield_stress="5 MPa"))
    first = rb.ImpactDamper(name="first", balls=[ball] * 3, gap="1 mm", contact=law)
    second = rb.ImpactDamper(
        name="second", balls=[ball] * 2, gap="1 mm", start=[-0.5, 0.5], velocity=velocity, contact=law
    )
    run = rb.simulate(rb.Case(structure=rb.Fixed(), dampers=[first, second], duration="0.02 s"))
    assert run.status == "law_domain"
    assert run.message.startswith(where)
