"""Derivatives of the state after a stretch of flights and contacts: exact cases, and differences of runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.support.smooth_differences import difference

import rattlebox as rb
from rattlebox.engines.transition import Flow

STEEL = {"radius": "8 mm", "material": "steel"}
EXACT = rb.EventDriven(tolerance=2e-14)
"""Soft contacts with the smallest tolerance: differences of runs are as rough as the errors of their steps."""


def soft_laws(rng: np.random.Generator) -> dict[str, tuple[rb.Tsuji | Any, tuple[str, ...]]]:
    """Return a contact law of each kind, and the paths of its own parameters."""
    e = float(rng.uniform(0.4, 0.9))
    return {
        "tsuji": (rb.Tsuji(restitution=e), ("contact.restitution",)),
        "alpha": (rb.Tsuji(alpha=float(rng.uniform(0.01, 0.3))), ("contact.alpha",)),
        "jackson-green": (rb.Tsuji(restitution=rb.JacksonGreen()), ()),
        "linear": (
            rb.Linear(stiffness=float(rng.uniform(1e5, 1e6)), restitution=e),
            ("contact.stiffness", "contact.restitution"),
        ),
        "power": (
            rb.PowerLaw(
                stiffness=float(rng.uniform(1e7, 1e8)),
                exponent=float(rng.uniform(1.2, 1.8)),
                damping=float(rng.uniform(50, 500)),
                damping_exponent=float(rng.uniform(0.25, 0.8)),
            ),
            ("contact.stiffness", "contact.exponent", "contact.damping"),
        ),
        "thornton": (rb.Thornton(), ()),
        "tabulated": (rb.TabulatedNormal(**measured(rng)), ()),
    }


def measured(rng: np.random.Generator) -> dict[str, Any]:
    """Return measured curves of loading and unloading: a force with a power of the overlap."""
    d = np.linspace(0, 3e-4, 7)
    part = np.linspace(0.3, 1, 5)
    top = float(rng.uniform(2e3, 8e3))
    return {
        "overlap": d.tolist(),
        "force": (top * (d / d[-1]) ** 1.5).tolist(),
        "unloading": rb.Curve(
            overlap=(part * d[-1]).tolist(), force=(top * ((part - part[0]) / (1 - part[0])) ** 1.5).tolist()
        ),
    }


def random_case(rng: np.random.Generator, law: str) -> tuple[rb.Case, tuple[str, ...]]:
    """Return a case with one to three dampers, perhaps tuned masses, and paths of parameters."""
    count, tuned = int(rng.integers(1, 4)), int(rng.integers(0, 3))
    if law == "hard":
        contact, own = rb.Tsuji(restitution=float(rng.uniform(0.3, 0.95))), ("contact.restitution",)
    elif law == "hard e(V)":
        contact, own = rb.Tsuji(restitution=rb.JacksonGreen()), ()
    else:
        contact, own = soft_laws(rng)[law]
    gaps = rng.uniform(1e-3, 4e-3, count)
    dampers = [
        rb.ImpactDamper(
            ball=rb.Sphere(**STEEL),
            gap=float(gap),
            contact=contact,
            gravity=float(rng.choice([0.0, 9.81])),
            start=float(rng.uniform(-0.5, 0.5)),
            velocity=float(rng.uniform(-0.3, 0.3)),
        )
        for gap in gaps
    ]
    base = bool(rng.integers(2))
    load = rb.Harmonic(
        amplitude=float(rng.uniform(1, 5)),
        frequency=float(rng.uniform(3, 9)),
        phase=float(rng.uniform(0.1, 3)),
    )
    case = rb.Case(
        structure=rb.SDOF(
            mass=float(rng.uniform(0.3, 2)),
            frequency=float(rng.uniform(4, 8)),
            damping_ratio=float(rng.uniform(0, 0.05)),
            displacement=float(rng.uniform(-2e-3, 2e-3)),
            velocity=float(rng.uniform(-0.1, 0.1)),
        ),
        dampers=dampers,
        tuned_masses=[
            rb.TunedMass(
                mass=float(rng.uniform(0.02, 0.1)),
                frequency=float(rng.uniform(4, 8)),
                damping_ratio=float(rng.uniform(0, 0.1)),
                name=f"tuned {k}",
            )
            for k in range(tuned)
        ],
        **({"base": load} if base else {"load": load}),
        duration="1 s",
        method=rb.Newton() if law.startswith("hard") else EXACT,
    )
    wave = "base" if base else "load"
    paths = ["structure.mass", "structure.frequency", "structure.damping_ratio"]
    paths += [f"{wave}.amplitude", f"{wave}.frequency", f"{wave}.phase"]
    paths += [f"dampers[{k}].gap" for k in range(count)] + ["dampers[0].ball.radius"]
    paths += [f"dampers[0].{path}" for path in own]
    if tuned:
        paths += ["tuned_masses[0].mass", "tuned_masses[0].frequency", "tuned_masses[0].damping_ratio"]
    return case, tuple(paths)


def compare_with_differences(seed: int, law: str) -> tuple[float, float] | None:
    """Return the error of a derivative in a random direction and that of the differences, as parts of its largest terms.

    None where a run of the differences does not exist.
    """
    rng = np.random.default_rng([seed, *law.encode()])
    case, paths = random_case(rng, law)
    flow = Flow.of(case, paths)
    start = flow.start().state
    duration = float(rng.uniform(0.05, 0.25))
    sizes = np.where(np.arange(start.size) % 2, 0.1, 1e-3) * 1e-2
    by_state = rng.uniform(-1, 1, start.size) * sizes
    by_value = rng.uniform(-1, 1, len(paths)) * flow.values * 1e-3
    end = flow.over(start, 0.0, duration)
    if not end.ok:
        return None
    contacts = [(touch.damper, touch.contact) for touch in end.contacts]
    same = True

    def moved(h: float) -> Any:
        nonlocal same
        other = flow.over(start + h * by_state, 0.0, duration, flow.values + h * by_value, derivatives=False)
        same = same and [(touch.damper, touch.contact) for touch in other.contacts] == contacts
        return other.state

    differences, rough = difference(moved, step=0.01)
    exact = end.matrix @ by_state + end.by_parameter @ by_value
    terms = np.abs(end.matrix) @ np.abs(by_state) + np.abs(end.by_parameter) @ np.abs(by_value)
    if not same and rough > 1e-9 * terms.max():  # a contact begins or ends at the end of the stretch, or one is missed
        return None
    return float(np.max(np.abs(exact - differences) / terms)), rough / float(terms.min())


FLOORS = {"power": 1e-7}
"""Errors of derivatives where they are not below 1e-9: the derivative of d^q, q < 1, is singular where a contact begins."""
SHARP = {"tabulated": 0.3, "power": 0.5}
"""Least part of runs with accurate differences, if it is not 0.6: the slope of a measured curve has a kink at each knot."""


def check_many(seeds: range, law: str) -> None:
    """Compare derivatives of random runs with differences; in a part of the runs these must be accurate to 3e-9.

    In the other runs derivatives and differences are compared to three times the error of the differences.
    """
    results = [compare_with_differences(seed, law) for seed in seeds]
    known = [result for result in results if result is not None]
    for error, rough in known:
        assert error < FLOORS.get(law, 1e-9) + 3 * rough
    sharp = [error for error, rough in known if rough < 3e-9]
    assert len(sharp) >= SHARP.get(law, 0.6) * len(seeds)


LAWS = ("hard", "hard e(V)", "tsuji", "alpha", "jackson-green", "linear", "power", "thornton", "tabulated")


@pytest.mark.parametrize("law", LAWS)
def test_random_runs(law: str) -> None:
    """Derivatives in state and parameters equal differences of short random runs with several dampers and tuned masses."""
    check_many(range(7), law)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_many_random_runs(law: str) -> None:
    """The same in 1000 runs, which take some minutes."""
    check_many(range(100, 212), law)


def two_balls(e: float) -> rb.Case:
    """Return two equal balls in one cavity at rest, of which one flies towards the other."""
    return rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(
            balls=[rb.Sphere(**STEEL), rb.Sphere(**STEEL)],
            gap="20 mm",
            contact=rb.Tsuji(restitution=e),
            start=["-18 mm", "10 mm"],
            velocity=[0.7, 0.0],
        ),
        duration="1 s",
        method=rb.Newton(),
    )


def test_equal_elastic_balls_exchange_their_motions() -> None:
    """Derivatives of two equal elastic balls are 0 and 1, exchanged, where a step through the contact loses a quarter."""
    flow = Flow.of(two_balls(1.0))
    end = flow.over(None, 0.0, 0.05)
    assert [touch.contact for touch in end.contacts] == [1]
    fly = np.array([[1.0, 0.05], [0.0, 1.0]])
    zero = np.zeros((2, 2))
    # Positions of both, then velocities of both.
    order = [0, 2, 1, 3]
    exchanged = np.block([[zero, fly], [fly, zero]])[np.ix_(order, order)]
    np.testing.assert_allclose(end.matrix, exchanged, rtol=0, atol=1e-12)
    assert end.matrix[3, 2] == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_determinant_of_hard_impacts(seed: int) -> None:
    """The determinant is e^2 for each hard impact times the decay of the modes, whatever the masses and loads."""
    rng = np.random.default_rng(seed)
    case, _ = random_case(rng, "hard")
    # Without contacts at rest, whose determinant is zero, and with few impacts: a small one is lost in rounding.
    numbers = {"gravity": 0.0, "contact.restitution": 0.85}
    case = case.replaced({f"dampers[{k}].{path}": v for k in range(len(case.dampers)) for path, v in numbers.items()})
    end = Flow.of(case).over(None, 0.0, 0.1)
    e = [touch.restitution for touch in end.contacts]
    decay = float(case.modes.decay.sum())
    assert end.status == "finished"
    assert np.linalg.det(end.matrix) == pytest.approx(np.prod(e) ** 2 * np.exp(-2 * 0.1 * decay), rel=1e-8, abs=0)


def test_flights_compose() -> None:
    """Two stretches one after the other have the product of their matrices, and end in the same state."""
    case, paths = random_case(np.random.default_rng(5), "tsuji")
    flow = Flow.of(case, paths)
    whole = flow.along(None, 0.0, [0.037, 0.11])
    second = flow.over(whole.states[0], 0.037, 0.11 - 0.037)
    np.testing.assert_allclose(second.state, whole.state, rtol=1e-9, atol=1e-12)
    n = second.state.size
    first = whole.derivatives[0]
    np.testing.assert_allclose(second.matrix @ first[:, :n], whole.matrix, rtol=1e-7, atol=1e-8)
    np.testing.assert_allclose(
        second.matrix @ first[:, n:] + second.by_parameter, whole.by_parameter, rtol=1e-6, atol=1e-8
    )


def stuck(**changes: Any) -> rb.Case:
    """Return a ball on the floor of a shaken box that comes to rest, is thrown, and comes to rest again."""
    return rb.Case(
        structure=rb.SDOF(mass=1.3, frequency=2.0, damping_ratio=0.01, displacement=0.02),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(**STEEL), gap="30 mm", contact=rb.Tsuji(restitution=0.3), gravity=9.81, start=0.97
        ),
        load=rb.Harmonic(amplitude=3.0, frequency=3.1, phase=0.4),
        duration="1 s",
        method=rb.Newton(),
    ).replaced(changes)


def test_hard_contacts_at_rest() -> None:
    """A ball at rest on a moving wall has the derivatives of a run in which both are one body; releases keep them."""
    flow = Flow.of(stuck(), ("structure.mass", "damper.gap", "load.frequency"))
    end = flow.over(None, 0.0, 0.6)
    assert end.ok
    assert end.raw.counts.sticks > 0
    # In contact both sides have one motion.
    at_rest = flow.along(None, 0.0, [0.25, 0.6])
    assert at_rest.raw.counts.sticks > 0
    start = end_state(flow)

    def moved(h: float) -> Any:
        values = flow.values * (1 + h * np.array([1e-3, 0, 1e-3]))
        return flow.over(start, 0.0, 0.6, values, derivatives=False).state

    differences, rough = difference(moved, step=0.02)
    exact = flow.over(start, 0.0, 0.6).by_parameter @ (flow.values * np.array([1e-3, 0, 1e-3]))
    np.testing.assert_allclose(exact, differences, rtol=1e-5, atol=1e-9 * np.abs(exact).max() + 10 * rough)


def end_state(flow: Flow) -> Any:
    """Return the state at the start of the case."""
    return flow.start().state


REFUSED: dict[str, tuple[Callable[[], rb.Case], str]] = {
    "two balls at one instant": (
        lambda: rb.Case(
            structure=rb.SDOF(mass=1, stiffness=100),
            dampers=[
                rb.ImpactDamper(ball=rb.Sphere(**STEEL), gap="1 mm", contact=rb.Tsuji(restitution=0.5), velocity=0.2)
                for _ in range(2)
            ],
            duration="1 s",
            method=rb.Newton(),
        ),
        "simultaneous",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_motions_without_derivatives(name: str) -> None:
    """Motions without a derivative have a status that says so."""
    make, status = REFUSED[name]
    assert Flow.of(make()).over(None, 0.0, 0.1).status == status


def test_pulses_of_straight_lines_are_refused() -> None:
    """A number of a sawtooth is refused with a reason: the message named a table, of which the case has none."""
    case, _ = random_case(np.random.default_rng(1), "tsuji")
    case = case.replaced({"load": rb.Sawtooth(amplitude="5 N", duration="10 ms"), "base": None})
    with pytest.raises(rb.CaseError, match="pulses of straight lines have no derivatives"):
        Flow.of(case, ("load.amplitude",))


def test_start_within_a_contact() -> None:
    """A start at an overlap is refused, because the contact has no history."""
    case, _ = random_case(np.random.default_rng(1), "tsuji")
    flow = Flow.of(case)
    state = flow.start().state
    modes = 2 * case.modes.decay.size
    state[modes] = 1.0
    assert flow.over(state, 0.0, 0.1).status == "starts_closed"


def test_restitution_one_is_a_limit() -> None:
    """A derivative in a restitution of exactly 1 of a soft contact does not exist."""
    case, _ = random_case(np.random.default_rng(1), "tsuji")
    case = case.replaced({f"dampers[{k}].contact": rb.Tsuji(restitution=1.0) for k in range(len(case.dampers))})
    assert Flow.of(case, ("dampers[0].contact.restitution",)).over(None, 0.0, 0.3).status == "kink"
    assert Flow.of(case, ("dampers[0].gap",)).over(None, 0.0, 0.3).status == "finished"


def test_near_misses() -> None:
    """A ball that turns before the wall has its smallest gap there, and the curvature of the gap."""
    case = rb.Case(
        structure=rb.SDOF(mass=1, frequency=1.0, displacement=0.005),
        damper=rb.ImpactDamper(ball=rb.Sphere(**STEEL), gap="11 mm", contact=rb.Tsuji(restitution=0.5)),
        duration="1 s",
        method=rb.Newton(),
    )
    end = Flow.of(case).over(None, 0.0, 1.2)
    assert not end.contacts
    miss = min(end.closest_approach, key=lambda each: each.gap)
    assert miss.gap == pytest.approx(0.001, rel=1e-9)
    assert miss.curvature == pytest.approx((2 * np.pi) ** 2 * 0.005, rel=1e-3)


@pytest.mark.parametrize("method", [rb.Newton(), EXACT], ids=["hard", "soft"])
def test_loads_that_begin_and_stop(method: Any) -> None:
    """Start and stop of a load are parameters: the force jumps there, also while a ball rests on its wall."""
    case = rb.Case(
        structure=rb.SDOF(mass=0.9, frequency=6.0, damping_ratio=0.02, displacement=1e-3, velocity=0.1),
        damper=rb.ImpactDamper(ball=rb.Sphere(**STEEL), gap="1 mm", contact=rb.Tsuji(restitution=0.7)),
        load=rb.Harmonic(amplitude=4.0, frequency=5.0, phase=0.9, start=0.03, stop=0.2),
        duration="1 s",
        method=method,
    )
    flow = Flow.of(case, ("load.start", "load.stop"))
    start, weights = flow.start().state, np.array([3e-5, -2e-4])

    def moved(h: float) -> Any:
        return flow.over(start, 0.0, 0.3, flow.values + h * weights, derivatives=False).state

    differences, rough = difference(moved, step=0.02)
    end = flow.over(start, 0.0, 0.3)
    assert method.kind != "newton" or end.raw.counts.sticks > 0
    terms = np.abs(end.by_parameter) @ np.abs(weights)
    assert np.all(np.abs(end.by_parameter @ weights - differences) < 1e-9 * terms + 3 * rough)


def test_modes_have_one_sign_over_the_steps_of_the_differences() -> None:
    """Derivatives in numbers of tuned masses exist: in one case in ten, another sign of an eigenvector was taken for a kink.

    The random runs of the other tests left out what was refused.
    """
    for seed in range(40):
        rng = np.random.default_rng(seed)
        case = rb.Case(
            structure=rb.SDOF(mass=float(rng.uniform(0.3, 2)), frequency=float(rng.uniform(4, 12)), displacement=1e-3),
            tuned_masses=[
                rb.TunedMass(mass=float(rng.uniform(0.02, 0.2)), frequency=float(rng.uniform(4, 12)), name=name)
                for name in "ab"
            ],
            damper=rb.ImpactDamper(ball=rb.Sphere(**STEEL), gap="1 mm", contact=rb.Tsuji(restitution=0.6)),
            duration="1 s",
            method=rb.Newton(),
        )
        paths = [f"tuned_masses[{k}].{name}" for k in (0, 1) for name in ("mass", "frequency")]
        assert Flow.of(case, [*paths, "structure.frequency"]).start().status == "finished"


@pytest.mark.parametrize("second", [9.21, 9.3, 10.0])
@pytest.mark.parametrize("path", ["tuned_masses[1].frequency", "tuned_masses[0].mass"])
def test_tuned_masses_of_close_frequencies(second: float, path: str) -> None:
    """Derivatives exist where modes change within a small part of a parameter: random tuned masses were never as close."""
    case = rb.Case(
        structure=rb.SDOF(mass=1.4, frequency=13.0, damping_ratio=0.02, displacement=2e-3),
        tuned_masses=[
            rb.TunedMass(mass=0.13, frequency=9.2, damping_ratio=0.02, name="a"),
            rb.TunedMass(mass=0.12, frequency=second, damping_ratio=0.1, name="b"),
        ],
        damper=rb.ImpactDamper(ball=rb.Sphere(**STEEL), gap="1 mm", contact=rb.Tsuji(restitution=0.6), velocity=0.2),
        duration="1 s",
        method=rb.Newton(),
    )

    def displacement(flow: Flow, state: Any) -> Any:
        return flow.shape("b")[0] @ state[: 2 * 3 : 2]

    def moved(h: float) -> Any:
        other = case.replaced({path: flow.values[0] * (1 + 1e-2 * h)})
        return np.array([displacement(Flow.of(other), Flow.of(other).over(None, 0.0, 0.1, derivatives=False).state)])

    flow = Flow.of(case, [path])
    end = flow.over(None, 0.0, 0.1)
    assert end.status == "finished"
    slope = displacement(flow, end.by_parameter[:, 0]) + flow.shape("b")[1][:, 0] @ end.state[: 2 * 3 : 2]
    differences, rough = difference(moved, step=0.05)
    assert 1e-2 * flow.values[0] * slope == pytest.approx(differences[0], rel=1e-9, abs=3 * rough)
    assert rough < 1e-9 * abs(differences[0])
