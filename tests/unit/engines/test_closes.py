"""When a run says that its ledger does not close."""

import math
from dataclasses import replace

import pytest

import rattlebox as rb
from rattlebox.paper.seed import seed_case


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
    run = rb.simulate(seed_case(duration=0.5))
    astray = rb.Run(replace(run.arrays, viscous_loss=1.001 * run.arrays.viscous_loss))
    assert run.ledger.closes(1e-8)
    assert not astray.ledger.closes(1e-8)
