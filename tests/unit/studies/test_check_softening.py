"""`check_softening`: the change of measures by softening, and its statistical error."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rattlebox as rb


def case(amplitude: float, frequency: float, **changes: Any) -> rb.Case:
    """A few steel balls on a shaker."""
    given: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="5 mm", count=30),
        "cavity": rb.Box(size=("20 mm", "20 mm", "25 mm")),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.2,
        "direction": "z",
        "packing": rb.Settled(seed=1),
        "softening": 300,
    }
    motion = rb.Harmonic(amplitude=(amplitude, "m/s^2"), frequency=frequency, direction="z")
    return rb.Case(
        structure=rb.Shaker(motion=motion), damper=rb.ParticleDamper(**given | changes), duration=40 / frequency
    )


def test_a_change_is_found_where_the_bed_stays_on_the_floor() -> None:
    """The loss of a bed that stays on the floor grows with softening."""
    result = rb.check_softening(
        case(12, 160), ["reduced_loss", "effective_mass"], cycles=(8, 16), packings=3, progress=False
    )
    assert result.softening.values.tolist() == [300, 75, 18.75]
    assert bool(result.reduced_loss_changed[0]) and not bool(result.reduced_loss_changed[-1])
    assert float(result.reduced_loss_change[0]) > 3 * float(result.reduced_loss_change_error[0]) > 0
    assert np.allclose(result.reduced_loss_change, result.reduced_loss - result.reduced_loss[-1])
    assert result.effective_mass.attrs["units"] == result.effective_mass_change.attrs["units"] == "kg"


def test_the_measure_that_is_taken_by_default_shows_the_change() -> None:
    """The share of the energy does not show it: on a shaker it is near 1 for any loss."""
    result = rb.check_softening(case(5, 160, packing=rb.Settled(seed=5)), packings=4, progress=False)
    assert bool(result.impact_loss_changed[0]) and not bool(result.impact_loss_kept[0])


def test_what_the_runs_do_not_decide_is_neither_changed_nor_kept() -> None:
    """Two packings of a short run scatter by more than the tolerance."""
    bed = case(5, 160, packing=rb.Settled(seed=3))
    result = rb.check_softening(bed, packings=2, softenings=(75, 18.75), progress=False)
    assert not bool(result.impact_loss_changed[0]) and not bool(result.impact_loss_kept[0])


def test_none_is_found_where_the_bed_is_thrown() -> None:
    """A bed thrown at five times gravity has the same loss with little softening."""
    result = rb.check_softening(
        case(50, 60, softening=20), "reduced_loss", cycles=(8, 24), packings=4, softenings=(20, 2), progress=False
    )
    assert not result.reduced_loss_changed.any()
    assert 0 < float(result.reduced_loss_error[0]) < 0.1


def test_several_dampers_are_softened_together() -> None:
    """Dampers are softened in the ratio of their softenings, the largest to the value, none below 1."""
    one = case(30, 80, softening=100).particle_dampers[0].model_copy(update={"name": "one"})
    both = case(30, 80).model_copy(update={"dampers": (one, one.model_copy(update={"name": "two", "softening": 4.0}))})
    result = rb.check_softening(both, "impact_share", packings=2, softenings=(100, 10), cycles=(1, 2), progress=False)
    assert np.isfinite(result.impact_share).all()


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        ({"softening": 1}, {}, "the softening is 1"),
        ({}, {"softenings": (10,)}, "two softenings"),
        ({}, {"softenings": (10, 0.5)}, "two softenings"),
        ({}, {"packings": 1}, "packings"),
        ({}, {"measures": "nonsense"}, "nonsense"),
        (
            {
                "packing": rb.Positions(positions=[[0, 0, 0]]),
                "particles": rb.Particles(material="steel", diameter=0.005),
            },
            {},
            "no random seed",
        ),
    ],
)
def test_what_does_not_fit_is_refused(changes: dict[str, Any], options: dict[str, Any], message: str) -> None:
    """Arguments that do not fit are refused with advice."""
    with pytest.raises(rb.CaseError, match=message):
        rb.check_softening(case(12, 160, **changes), **{"cycles": (1, 1), "progress": False, **options})
