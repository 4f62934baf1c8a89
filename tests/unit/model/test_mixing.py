"""Mixing rules: laws between unlike species from the laws within each species."""

from __future__ import annotations

from typing import Any

import pytest

import rattlebox as rb


def damper(**options: Any) -> rb.ParticleDamper:
    """Return a damper of hard and soft balls; soft pairs have their own laws."""
    usual: dict[str, Any] = {
        "particles": [
            rb.Particles(name="hard", material="steel", diameter="4 mm", count=3),
            rb.Particles(name="soft", material="lead", diameter="4 mm", count=3),
        ],
        "cavity": rb.Box(size=("40 mm",) * 3),
        "contact": rb.Tsuji(restitution=0.9),
        "friction": 0.1,
        "rolling": 0.02,
        "pairs": [
            rb.PairLaws(between=("soft", "soft"), contact=rb.Tsuji(restitution=0.4), friction=0.4, rolling=0),
        ],
    }
    return rb.ParticleDamper(**{**usual, **options})


def entry(of: rb.ParticleDamper, *names: str) -> Any:
    """Return the entry of a contact table for two species, or one species and the wall."""
    (result,) = (entry for entry in of.contact_table.entries if entry.names == names)
    return result


@pytest.mark.parametrize(
    ("rule", "e", "mu", "rolls"),
    [
        ("arithmetic", 0.65, 0.25, 0.01),
        ("geometric", 0.6, 0.2, 0.0),
        ("harmonic", 0.72 / 1.3, 0.16, 0.0),
        ("smaller", 0.4, 0.1, 0.0),
        ("larger", 0.9, 0.4, 0.02),
    ],
)
def test_coefficients_of_unlike_species(rule: Any, e: float, mu: float, rolls: float) -> None:
    """Each rule computes the mean of its name for all coefficients; like pairs and walls keep their laws."""
    made = damper(mixing=rule)
    between = entry(made, "hard", "soft")
    result = (between.contact.restitution.e, between.friction.coefficient, between.rolling.coefficient)
    assert result == pytest.approx((e, mu, rolls), rel=1e-15)
    for species, among in (("hard", 0.9), ("soft", 0.4)):
        assert entry(made, species, species).contact.restitution.e == among
        assert entry(made, species, "wall").contact.restitution.e == 0.9


def test_laws_of_a_pair_override_the_mean() -> None:
    """The laws of a pair override the mixing rule; its other laws are mixed or, without a rule, the common ones."""
    pair = rb.PairLaws(between=("soft", "hard"), friction=0.7)
    assert entry(damper(), "hard", "soft").contact.restitution.e == 0.9
    made = damper(mixing="geometric", pairs=[*damper().pairs, pair])
    assert entry(made, "hard", "soft").friction.coefficient == 0.7
    assert entry(made, "hard", "soft").contact.restitution.e == pytest.approx(0.6)


def test_no_friction_is_a_coefficient_of_zero() -> None:
    """The mean of a law and no friction is that law with half of its coefficient."""
    own = [rb.PairLaws(between=("soft", "soft"), friction=rb.Mindlin(0.4, damping=0.5))]
    made = damper(friction=None, rolling=None, pairs=own, mixing="arithmetic")
    assert entry(made, "hard", "soft").friction == rb.Mindlin(0.2, damping=0.5)
    assert entry(made, "hard", "hard").friction is None


def test_laws_that_differ_in_more_than_numbers_are_refused() -> None:
    """A table and a constant have no mean: the message names both species and the table of pairs to add."""
    table = rb.Tsuji(restitution=rb.Tabulated(speeds=[0.1, 1.0], values=[0.9, 0.5]))
    pairs = [rb.PairLaws(between=("soft", "soft"), contact=table)]
    with pytest.raises(rb.CaseError) as caught:
        damper(mixing="geometric", pairs=pairs)
    message = str(caught.value)
    assert "mixing" in message and "of contact of hard and of soft differ in more than numbers" in message
    assert 'pairs = [{ between = ["hard", "soft"], contact = ... }]' in message
