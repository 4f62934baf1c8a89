"""Derivatives through soft contacts that are solved as a whole, and through those that last."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.support.smooth_differences import difference
from tests.verification.test_transition import STEEL, random_case

import rattlebox as rb
from rattlebox.engines.transition import Flow, Transition


def whole(end: Transition) -> Any:
    """Return the derivatives in state and parameters side by side."""
    return np.hstack([end.matrix, end.by_parameter])


def errors(found: Transition, right: Transition, sizes: Any) -> float:
    """Return the largest error of derivatives, as part of the largest term of their component of the state."""
    terms = np.abs(whole(right)) * sizes
    return float(np.max(np.abs(whole(found) - whole(right)) * sizes / terms.max(axis=1, keepdims=True)))


def check_whole(seeds: range, law: str) -> None:
    """Compare derivatives of random runs with those of runs that integrate every contact, and the state with a plain run."""
    collocated = wanted = 0
    for seed in seeds:
        rng = np.random.default_rng([seed, *law.encode(), 7])
        case, paths = random_case(rng, law)
        duration = float(rng.uniform(0.02, 0.06))  # few contacts: each enlarges the errors of the states
        quick = Flow.of(case.replaced({"method": rb.EventDriven(tolerance=1e-13)}), paths)
        steps = Flow.of(case.replaced({"method": rb.EventDriven(tolerance=2e-14, collocation=False)}), paths)
        start = quick.start().state
        end, right = quick.over(start, 0.0, duration), steps.over(start, 0.0, duration)
        plain = quick.over(start, 0.0, duration, derivatives=False)
        if not (end.ok and right.ok):
            continue
        assert end.raw.counts.collocated <= plain.raw.counts.collocated
        if end.raw.counts.collocated == plain.raw.counts.collocated:
            np.testing.assert_array_equal(end.state, plain.state)
            assert end.raw.counts.contact_steps == plain.raw.counts.contact_steps
        collocated += end.raw.counts.collocated
        wanted += plain.raw.counts.collocated
        sizes = np.r_[np.where(np.arange(start.size) % 2, 0.1, 1e-3), np.abs(quick.values)]
        # The motions differ within the tolerance of the quick one, and so do their derivatives. A sharper comparison
        # is that with runs in 113-bit arithmetic.
        apart = float(np.max(np.abs(end.state - right.state) / np.abs(right.state)))
        assert errors(end, right, sizes) < 4e-9 + 1e3 * apart
    assert 3 * collocated >= len(seeds)
    assert collocated >= 0.95 * wanted


LAWS = ("tsuji", "alpha", "jackson-green")


@pytest.mark.parametrize("law", LAWS)
def test_contacts_solved_as_a_whole(law: str) -> None:
    """Contacts solved as a whole have the derivatives of integrated ones, and a state with the bits of a plain run.

    Comparisons with differences use a tolerance at which no contact is solved as a whole, so that they saw neither.
    """
    check_whole(range(12), law)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_many_contacts_solved_as_a_whole(law: str) -> None:
    """The same in 900 runs."""
    check_whole(range(100, 400), law)


@pytest.mark.parametrize("lost", [1e-2, 3e-3, 1e-3, 1e-4, 1e-6])
def test_nearly_elastic_contacts_are_solved_as_a_whole(lost: float) -> None:
    """Contacts with little damping, whose restitution changes with the speed, are solved as a whole for any damping.

    Below a damping ratio of 0.004 they were integrated, at several times the cost; the test of random runs let half of the
    contacts be integrated.
    """
    case = rb.Case(
        structure=rb.SDOF(mass=0.8, frequency=9.0, damping_ratio=0.02, velocity=0.23),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(**STEEL),
            gap="1.2 mm",
            contact=rb.Tsuji(restitution=rb.Tabulated(speeds=[1e-3, 3.0], values=[1 - lost, 1 - 3 * lost])),
            velocity=0.12,
        ),
        load=rb.Harmonic(amplitude=7.0, frequency=8.0, phase=0.4),
        duration=1.0,
    )
    paths = ["dampers[0].gap", "load.amplitude", "structure.mass"]
    quick = Flow.of(case.replaced({"method": rb.EventDriven(tolerance=1e-13)}), paths)
    steps = Flow.of(case.replaced({"method": rb.EventDriven(tolerance=2e-14, collocation=False)}), paths)
    start = quick.start().state
    end, right = quick.over(start, 0.0, 0.09), steps.over(start, 0.0, 0.09)
    assert end.ok and right.ok
    assert end.raw.counts.collocated == len(end.contacts) > 3
    assert right.raw.counts.collocated == 0
    sizes = np.r_[np.where(np.arange(start.size) % 2, 0.1, 1e-3), np.abs(quick.values)]
    apart = float(np.max(np.abs(end.state - right.state) / np.abs(right.state)))
    assert errors(end, right, sizes) < 4e-9 + 1e3 * apart


def resting(gravity: float = 9.81) -> rb.Case:
    """Return a ball that is dropped in a shaken box with soft walls, bounces, and stays on its floor."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=3e-4, frequency=9.0, phase=0.3)),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(**STEEL), gap="2 mm", contact=rb.Tsuji(restitution=0.4), gravity=gravity, velocity=0.1
        ),
        duration="1 s",
        method=rb.EventDriven(),
    )


def test_soft_ball_at_rest_follows_its_wall() -> None:
    """A ball that rests at the end moves with its wall: derivatives of its relative motion in start and gap vanish.

    No test ended with a contact that lasts. The permitted error of a step was below the rounding of the forces there,
    steps became shorter without end, and their rounding errors added up, after minutes.
    """
    paths = ("damper.gap", "structure.motion.amplitude", "structure.motion.phase", "damper.gravity")
    flow = Flow.of(resting(), paths)
    end = flow.over(None, 0.0, 0.4)
    plain = flow.over(None, 0.0, 0.4, derivatives=False)
    assert end.ok
    assert end.is_closed
    np.testing.assert_array_equal(end.state, plain.state)
    assert end.raw.counts.contact_steps == plain.raw.counts.contact_steps < 10_000
    np.testing.assert_allclose(end.matrix, 0, atol=1e-10)
    assert end.by_parameter[0, 0] == pytest.approx(1.0, abs=1e-11)
    assert abs(end.by_parameter[1, 0]) < 1e-10
    start = flow.start().state

    def moved(h: float) -> Any:
        values = flow.values * (1 + h * np.array([0.0, 1.0, 1.0, 0.01]))
        return flow.over(start, 0.0, 0.4, values, derivatives=False).state

    differences, rough = difference(moved, step=1e-3)
    exact = flow.over(start, 0.0, 0.4).by_parameter @ (flow.values * np.array([0.0, 1.0, 1.0, 0.01]))
    np.testing.assert_allclose(exact, differences, rtol=1e-6, atol=1e-13 + 3 * rough)


def test_load_without_amplitude_has_a_derivative() -> None:
    """The derivative in an amplitude of zero is the motion by a unit amplitude; flights left the load out."""
    case = rb.Case(
        structure=rb.SDOF(mass=1.1, frequency=5.0, damping_ratio=0.02, displacement=1e-3),
        damper=rb.ImpactDamper(ball=rb.Sphere(**STEEL), gap="50 mm", contact=rb.Tsuji(restitution=0.5)),
        load=rb.Harmonic(amplitude=0.0, frequency=3.0),
        duration="1 s",
        method=rb.Newton(),
    )
    flow = Flow.of(case, ("load.amplitude",))
    end = flow.over(None, 0.0, 0.2)
    change = flow.over(None, 0.0, 0.2, [1.0], derivatives=False).state - end.state
    np.testing.assert_allclose(end.by_parameter[:, 0], change, rtol=1e-11, atol=1e-13)
