"""Random impact cases of all kinds: status, finite numbers, energy balance, and the same bits when run again."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rattlebox as rb
from rattlebox.results.arrays import RunArrays
from rattlebox.results.schema import variables

EVENTS = 300
"""Limit of events of each run, which only cases with chatter of unlimited length reach."""


def between(low: float, high: float) -> st.SearchStrategy[float]:
    """Return a strategy for numbers between two limits, uniform in the logarithm."""
    return st.floats(math.log10(low), math.log10(high)).map(lambda exponent: float(f"{10**exponent:.4g}"))


def either_sign(numbers: st.SearchStrategy[float]) -> st.SearchStrategy[float]:
    """Return a strategy for the numbers, their opposites, and zero."""
    return st.one_of(st.just(0.0), numbers, numbers.map(lambda x: -x))


ratios = st.one_of(st.sampled_from([0.0, 1.0, 2.0]), between(1e-4, 0.5))
fractions = st.floats(-1, 1).map(lambda x: round(x, 3))


@st.composite
def structures(draw: st.DrawFn) -> Any:
    """Draw a structure of any kind, at rest or moving."""
    kind = draw(st.sampled_from(["sdof", "modal", "matrices", "fixed", "shaker"]))
    shift = either_sign(between(1e-6, 1e-2))
    speed = either_sign(between(1e-4, 1.0))
    if kind == "sdof":
        stiffness = draw(st.one_of(st.just(0.0), between(1e2, 1e6)))
        damping = {"damping": draw(between(1e-2, 1e2))} if stiffness == 0 else {"damping_ratio": draw(ratios)}
        return rb.SDOF(
            mass=draw(between(0.05, 50)), stiffness=stiffness, displacement=draw(shift), velocity=draw(speed), **damping
        )
    if kind == "modal":
        count = draw(st.integers(1, 3))
        row = st.lists(st.floats(-1, 1).map(lambda x: round(x, 2)), min_size=count, max_size=count)
        return rb.Modal(
            frequencies=draw(st.lists(st.one_of(st.just(0.0), between(1, 200)), min_size=count, max_size=count)),
            damping_ratios=draw(st.lists(ratios, min_size=count, max_size=count)),
            shapes={"tip": draw(row), "root": draw(row)},
            participation=draw(row),
        )
    if kind == "matrices":
        count = draw(st.integers(2, 3))
        springs = np.array(draw(st.lists(between(1e3, 1e5), min_size=count, max_size=count)))
        K = np.diag(springs) + np.diag([*springs[1:], 0.0]) - np.diag(springs[1:], 1) - np.diag(springs[1:], -1)
        M = np.diag(draw(st.lists(between(0.1, 10), min_size=count, max_size=count)))
        a, b = draw(ratios), draw(between(1e-7, 1e-4))
        return rb.Matrices(M=M, C=a * M + b * K, K=K, points={"tip": count - 1, "root": 0})
    if kind == "shaker":
        return rb.Shaker(
            motion=rb.Harmonic(amplitude=f"{draw(between(1e-5, 1e-2))} m", frequency=draw(between(2, 100)))
        )
    return rb.Fixed()


@st.composite
def signals(draw: st.DrawFn, size: st.SearchStrategy[float], point: str | None) -> Any:
    """Draw a pulse, a harmonic or a record."""
    kind = draw(st.sampled_from(["half_sine", "harmonic", "record"]))
    if kind == "half_sine":
        return rb.HalfSine(
            amplitude=draw(size),
            duration=draw(between(1e-4, 0.1)),
            start=draw(st.sampled_from([0.0, 0.01])),
            point=point,
        )
    if kind == "harmonic":
        stop = draw(st.sampled_from([None, 0.05]))
        return rb.Harmonic(
            amplitude=draw(size), frequency=draw(between(1, 300)), phase=draw(fractions), stop=stop, point=point
        )
    values = draw(st.lists(either_sign(size), min_size=2, max_size=6))
    return rb.Record(times=np.linspace(0, 1, len(values)), values=values, point=point)


@st.composite
def restitutions(draw: st.DrawFn, lowest: float) -> Any:
    """Draw a restitution law for any material."""
    kind = draw(st.sampled_from(["number", "number", "table", "jackson_green", "thornton", "johnson"]))
    if kind == "number":
        return draw(st.one_of(st.just(1.0), st.floats(lowest, 1).map(lambda x: round(x, 3))))
    if kind == "table":
        return rb.Tabulated(speeds=[0.01, 0.1, 1.0], values=draw(st.lists(st.floats(0.1, 1), min_size=3, max_size=3)))
    if kind == "jackson_green":
        return rb.JacksonGreen(
            yield_stress=draw(between(1e7, 2e9)),
            extrapolate=draw(st.booleans()),
            wall=draw(st.sampled_from([None, "rigid"])),
        )
    return (
        rb.ThorntonRestitution(yield_pressure=1e9)
        if kind == "thornton"
        else rb.Johnson(speed_scale=draw(between(1e-3, 1)))
    )


@st.composite
def contacts(draw: st.DrawFn) -> Any:
    """Draw a contact law."""
    kind = draw(st.sampled_from(["tsuji", "alpha", "linear", "dashpot", "thornton"]))
    ending = draw(st.sampled_from(["zero_force", "zero_overlap"]))
    if kind == "tsuji":
        return rb.Tsuji(restitution=draw(restitutions(0.05)), ending=ending)
    if kind == "alpha":
        return rb.Tsuji(alpha=draw(between(1e-3, 2)), ending=ending)
    if kind == "linear":
        return rb.Linear(stiffness=draw(between(1e4, 1e8)), restitution=draw(restitutions(0.05)), ending=ending)
    if kind == "dashpot":
        return rb.Linear(contact_time=draw(between(1e-5, 1e-3)), damping=draw(between(1e-3, 1)), ending="zero_force")
    return rb.Thornton(yield_pressure=draw(between(1e8, 3e9)))


@st.composite
def dampers(draw: st.DrawFn, count: int, point: str | None, name: str) -> Any:
    """Draw a damper with balls somewhere in a cavity that may be displaced."""
    material = st.sampled_from(["steel", "brass", "glass", "nylon", "lead"])
    gap = draw(between(1e-5, 1e-2))
    places = sorted(draw(st.lists(fractions, min_size=count, max_size=count)))
    return rb.ImpactDamper(
        name=name,
        balls=[rb.Sphere(radius=draw(between(1e-3, 2e-2)), material=draw(material)) for _ in range(count)],
        gap=gap,
        start=[f"{place * gap!r} m" for place in places],
        velocity=draw(st.lists(either_sign(between(1e-4, 2)), min_size=count, max_size=count)),
        gravity=draw(st.sampled_from([0.0, 0.0, -9.81, 3.0])),
        contact=draw(contacts()),
        ball_contact=draw(st.one_of(st.none(), contacts())),
        wall=draw(st.sampled_from([None, "rigid", "steel"])),
        point=point,
    )


@st.composite
def cases(draw: st.DrawFn) -> rb.Case:
    """Draw a case of any kind."""
    structure = draw(structures())
    modes = structure.modes()
    point = "tip" if "tip" in modes.shapes else None
    loads, base = [], []
    if modes.decay.size:
        loads = draw(st.lists(signals(between(1e-2, 5e3), point), max_size=2))
        base = draw(st.lists(signals(between(1e-1, 50), None), max_size=1))
    counts = draw(st.lists(st.integers(1, 4), min_size=1, max_size=2))
    method = draw(st.sampled_from(["event_driven", "event_driven", "steps", "newton", "two_step"]))
    if method == "newton":
        computed: Any = rb.Newton(
            restitution=draw(st.one_of(st.none(), restitutions(0.0))),
            stick=draw(st.sampled_from([0.0, 1e-6, 1e-3])),
            max_events=EVENTS,
        )
    elif method == "two_step":
        computed = rb.TwoStep(dt_flight=1e-5, dt_contact=1e-6, inner=draw(st.sampled_from(["rk4", "dopri5"])))
    else:
        computed = rb.EventDriven(
            max_events=EVENTS,
            tolerance=draw(st.sampled_from([1e-12, 1e-9])),
            collocation=method == "event_driven",
        )
    return rb.Case(
        structure=structure,
        loads=loads,
        base=base,
        dampers=[draw(dampers(count, point, f"damper {n + 1}")) for n, count in enumerate(counts)],
        duration=0.02 if method == "two_step" else draw(between(0.01, 0.5)),
        method=computed,
        output=rb.Output(rate=draw(st.sampled_from([200.0, 5000.0]))),
    )


def violations(case: rb.Case) -> list[str]:
    """Run a case twice; return all violated promises."""
    run, again = rb.simulate(case), rb.simulate(case)
    a = run.arrays
    result = (
        []
        if run.status in ("finished", "law_domain", "too_many_events", "step_too_small", "not_finite")
        # Steps of the two-step scheme may be too long for a contact, which its energy residual shows.
        or (run.status == "energy_error" and case.method.kind == "two_step")
        # A law that is used far beyond its range may fall to zero, which no dashpot can represent.
        or (run.status == "no_rebound" and "extrapolate = true" in case.to_toml())
        else [run.status]
    )
    if not run.ok and len(run.message) < 40:
        result.append(f"{run.status} without advice")
    if run != again:
        result.append("a second run differs")
    if run.status == "too_many_events" and run.counts["events"] < getattr(case.method, "max_events", 0) // 2:
        result.append("contact steps without events have spent the budget")
    if run.status != "not_finite":
        result += [f"{name} is not finite" for name in non_finite(a)]
    elif np.any(np.diff(np.isfinite(a.relative_position).all(axis=1).astype(int)) > 0):
        result.append("the motion is finite again after it was not")
    ledger = run.ledger
    energy = float(
        np.max(np.abs(ledger.motion)) + np.max(np.abs(ledger.work)) + np.max(np.abs(ledger.gravity - ledger.gravity[0]))
    )
    if isinstance(case.method, rb.TwoStep):
        return result
    tolerance = getattr(case.method, "tolerance", 1e-12)
    if run.energy_residual > 1e4 * tolerance:
        result.append(f"energy residual {run.energy_residual:.3g}")
    if np.min(np.diff(ledger.losses), initial=0) < -1e3 * tolerance * energy:
        result.append(f"losses fall by {-np.min(np.diff(ledger.losses)) / energy:.3g} of the energy")
    if (
        not case.loads
        and not case.base_acceleration()
        and np.max(np.diff(ledger.total), initial=0) > 1e3 * tolerance * energy
    ):
        result.append(f"energy rises by {np.max(np.diff(ledger.total)) / energy:.3g} without work")
    result += unlogged_contacts(case, run)
    return result


def non_finite(arrays: RunArrays) -> list[str]:
    """Return the names of variables with non-finite numbers that must be finite."""
    log = arrays.impacts
    ended = log.complete  # a contact that is closed at the end of the run has no separation yet
    values = dict(vars(arrays))
    values |= {f"impacts.{v.name}": getattr(log, v.name)[ended] for v in variables("impact", "impacts")}
    absent = {"impacts.restitution"} | ({"impacts.peak_force"} if not log.duration.any() else set())  # of hard impacts
    return [
        name
        for name, numbers in values.items()
        if isinstance(numbers, np.ndarray)
        and numbers.dtype.kind == "f"
        and name not in absent
        and not np.isfinite(numbers).all()
    ]


def unlogged_contacts(case: rb.Case, run: rb.Run) -> list[str]:
    """Return contacts that are deeper at an output time than in the impact log."""
    a, result, first = run.arrays, [], 0
    for index, damper in enumerate(case.dampers):
        own = slice(first, first + len(damper.balls))
        first = own.stop
        place = a.relative_position[:, own] - a.ball_centre[own]
        half = 0.5 * damper.clearance
        depths = np.column_stack([-half - place[:, 0], place[:, :-1] - place[:, 1:], place[:, -1] - half])
        for contact, depth in enumerate(depths.T):
            logged = a.impacts.peak_overlap[(a.impacts.damper == index) & (a.impacts.contact == contact)]
            expected = np.max(logged, initial=0)
            if np.max(depth) > 1.001 * expected + 1e-10:
                result.append(
                    f"contact {contact} of {damper.name} is {np.max(depth):.3g} m deep, logged {expected:.3g}"
                )
    return result


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(cases())
def test_random_case(case: rb.Case) -> None:
    """Any case ends with a status, without NaN, with a closed ledger, and with the same bits when run again."""
    assert violations(case) == []


@pytest.mark.parametrize(
    "file", sorted((Path(__file__).parent / "regressions").glob("*.toml")), ids=lambda file: file.stem
)
def test_case_that_failed_before(file: Path) -> None:
    """Cases that failed in an earlier version do not fail again."""
    assert violations(rb.Case.from_file(file)) == []
