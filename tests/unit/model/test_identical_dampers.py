"""Identical impact dampers at a point: their starts, their motion, studies of their number, and refused arguments."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rattlebox as rb


def ball(**changes: Any) -> rb.ImpactDamper:
    """Return a steel ball of 33 g."""
    contact = rb.Tsuji(restitution=0.5)
    usual: dict[str, Any] = {"ball": rb.Sphere(diameter="20 mm", material="steel"), "gap": "1 mm", "contact": contact}
    return rb.ImpactDamper(**(usual | changes))


def case(*dampers: rb.ImpactDamper, **changes: Any) -> rb.Case:
    """Return dampers on an oscillator that is displaced at the start."""
    structure = rb.SDOF(mass="3 kg", frequency="32 Hz", damping_ratio=0.005, displacement="0.3 mm")
    load = rb.Harmonic(amplitude="10 N", frequency="31 Hz")
    return rb.Case(structure=structure, dampers=dampers, load=load, duration="1 s", **changes)


def test_identical_dampers_are_a_list_of_them() -> None:
    """They move like dampers with the same starts one by one, which are spread between the walls of the displaced cavity."""
    group = case(ball(number=5, start=0.4))
    alone = group.impact_dampers
    starts = np.array([each.positions0[0] for each in alone]) / 1e-3
    assert starts[0] == pytest.approx(0.4)
    assert np.abs(starts).max() <= 1
    assert np.diff(np.sort(starts)).min() > 0.25
    run, other = rb.simulate(group), rb.simulate(case(*alone))
    assert run.arrays.dampers == ("damper", "damper2", "damper3", "damper4", "damper5")
    assert np.array_equal(run.arrays.displacement, other.arrays.displacement)
    named = case(ball(number=2, name="pod"), ball(name="other"))
    assert rb.simulate(named).arrays.dampers == ("pod", "pod2", "other")
    assert rb.Case.from_toml(group.to_toml()) == group


def test_studies_vary_the_number() -> None:
    """A sweep over number, gap and start has the values of single runs; the mass of a design grows with the number."""
    axes = {"damper.number": [1, 3], "damper.gap": ["0.5 mm", "1 mm"], "damper.start": [0.4, -0.2]}
    found = rb.sweep(case(ball()), axes, "rms", skip="0.5 s", progress=False).rms
    for number in (1, 3):
        for gap in (0.5e-3, 1e-3):
            own = case(ball(number=number, gap=gap, start=0.4))
            one = rb.sweep(own, {"damper.gap": [gap]}, "rms", skip="0.5 s", progress=False).rms
            same = found.sel({"damper.number": number, "damper.gap": gap})
            assert same[0].item() == pytest.approx(one.item(), rel=1e-9)
    designs = rb.design(case(ball()), {"damper.number": [1, 2]}, ["added_mass", "rms"], progress=False)
    mass = ball().masses[0]
    assert designs.added_mass.values == pytest.approx([mass, 2 * mass])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"number": 2, "start": [0.1]}, "a list of starts holds for one damper"),
        ({"number": 2, "gap": 0}, "would move in step"),
        ({"number": 0}, "at least 1"),
        ({"number": 2, "point": "tip"}, "no point 'tip'"),
    ],
)
def test_bad_groups_are_refused(changes: dict[str, Any], message: str) -> None:
    """Dampers that would move in step, or that have no place, are refused."""
    with pytest.raises(rb.CaseError, match=message):
        case(ball(**changes))
