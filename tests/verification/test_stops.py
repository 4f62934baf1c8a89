"""Stops and pounding: closed forms, conservation laws, symmetries, ties, and every contact law of balls."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from support import impact_cases
from support.exact import impact_oscillator, printed

import rattlebox as rb

LAWS: dict[str, Any] = {
    "tsuji": rb.Tsuji(restitution=0.7),
    "tsuji to zero overlap": rb.Tsuji(restitution=0.7, ending="zero_overlap"),
    "tsuji alpha": rb.Tsuji(alpha=0.3),
    "elastic": rb.Tsuji(restitution=1.0),
    "linear": rb.Linear(stiffness="2 MN/m", restitution=0.5),
    "linear damping": rb.Linear(stiffness="2 MN/m", damping="150 N s/m"),
    "linear time": rb.Linear(contact_time="0.4 ms", restitution=0.8, ending="zero_overlap"),
    "thornton": rb.Thornton(),
    "power": rb.PowerLaw(exponent=1.2, stiffness=4e7, damping_exponent=0.1, restitution=0.6, impact_speed="1 m/s"),
    "tabulated": rb.TabulatedNormal(
        overlap=["0 um", "40 um", "90 um", "400 um"],
        force=["0 N", "80 N", "250 N", "2 kN"],
        unloading={"overlap": ["150 um", "250 um", "400 um"], "force": ["0 N", "600 N", "2 kN"]},
    ),
    "jackson green": rb.Tsuji(restitution=rb.JacksonGreen(extrapolate=True)),
    "table": rb.Tsuji(restitution=rb.Tabulated(speeds=["1 mm/s", "1 m/s"], values=[0.9, 0.4])),
    "johnson": rb.Tsuji(restitution=rb.Johnson()),
}
SIZE: dict[str, Any] = {"radius": "15 mm", "material": "steel"}


@pytest.mark.parametrize("key", printed.IMPACT_OSCILLATOR)
def test_impact_oscillator_has_the_speed_of_the_closed_form(key: tuple[float, float, float, float]) -> None:
    """An oscillator that meets a hard stop once in each cycle has the impact speed of the closed form, for 20 cycles.

    The engine could only be asked with a ball of 1e15 kg in the place of the stop.
    """
    shown = printed.IMPACT_OSCILLATOR[key]
    orbit = min(impact_oscillator.orbits(*key), key=lambda o: abs(o.speed - shown))
    run = rb.simulate(impact_cases.impact_oscillator(orbit, 20.0))
    assert run.ok, run.message
    assert len(run.arrays.impacts) == 20
    assert run.arrays.impacts.approach_speed == pytest.approx(orbit.speed, rel=1e-9)
    assert orbit.speed == pytest.approx(shown, rel=1e-7)
    assert np.abs(np.diff(run.arrays.impacts.time) - 2 * math.pi / orbit.omega).max() < 1e-9


def oscillators(*, gap: Any = "1 mm", contact: Any = None, **options: Any) -> Any:
    """Return two undamped oscillators of 3 kg at 4 Hz and 1 kg at 7 Hz that move towards each other."""
    mass, rate = np.array([3.0, 1.0]), 2 * np.pi * np.array([4.0, 7.0])
    values: dict[str, Any] = {
        "structure": rb.Matrices(
            M=np.diag(mass), K=np.diag(mass * rate**2), points={"left": 0, "right": 1}, velocity=[0.3, -0.5]
        ),
        "stop": rb.Stop(point="left", other="right", gap=gap, contact=contact or rb.Tsuji(restitution=0.6), **SIZE),
        "duration": 4.0,
    }
    return rb.Case(**values | options)


def test_pounding_oscillators_follow_the_closed_form() -> None:
    """Two oscillators that pound: times and speeds of all impacts are those of sines between impacts of two free masses."""
    from scipy.optimize import brentq

    run = rb.simulate(oscillators(method=rb.Newton()))
    assert run.ok, run.message
    log = run.arrays.impacts
    mass, rate, e, gap = np.array([3.0, 1.0]), 2 * np.pi * np.array([4.0, 7.0]), 0.6, 1e-3
    x, v, t = np.zeros(2), np.array([0.3, -0.5]), 0.0

    def at(s: float) -> tuple[Any, Any]:
        turn = rate * s
        return x * np.cos(turn) + v / rate * np.sin(turn), v * np.cos(turn) - x * rate * np.sin(turn)

    def distance(s: float) -> float:
        place = at(s)[0]
        return float(gap - place[0] + place[1])

    for number in range(len(log)):
        times = np.linspace(1e-9, 4.0 - t, 80001)
        closed = next(k for k, s in enumerate(times) if distance(s) < 0)
        s = brentq(distance, times[closed - 1], times[closed], xtol=1e-15) if closed else times[0]
        t += s
        x, v = at(s)
        assert log.time[number] == pytest.approx(t, abs=1e-10)
        approach = v[0] - v[1]
        assert log.approach_speed[number] == pytest.approx(approach, rel=1e-8)
        impulse = (1 + e) * approach / (1 / mass).sum()
        v = v + np.array([-1, 1]) * impulse / mass
        assert log.energy_lost[number] == pytest.approx(0.5 * (1 - e**2) * approach**2 / (1 / mass).sum(), rel=1e-7)
    assert len(log) > 8


@pytest.mark.parametrize("name", LAWS)
def test_pounding_conserves_momentum_and_closes_the_energy(name: str) -> None:
    """Two free bodies that meet with each contact law keep their momentum and their energy, and separate as two balls do."""
    mass = np.array([0.7, 0.2])
    case = rb.Case(
        structure=rb.Matrices(M=np.diag(mass), K=np.zeros((2, 2)), points={"a": 0, "b": 1}, velocity=[0.8, -0.1]),
        stop=rb.Stop(point="a", other="b", gap="0.2 mm", contact=LAWS[name], **SIZE),
        duration="20 ms",
        output=rb.Output(rate=1000.0),
    )
    run = rb.simulate(case)
    assert run.ok, run.message
    assert run.energy_residual < 1e-10
    momentum = run.arrays.velocity @ mass
    assert np.ptp(momentum) < 1e-13
    (impact,) = run.arrays.impacts.energy_lost
    reduced = 1 / (1 / mass).sum()
    separation = run.arrays.velocity[-1, 1] - run.arrays.velocity[-1, 0]
    lost = 0.5 * reduced * (0.9**2 - separation**2)
    assert impact == pytest.approx(lost, rel=1e-9, abs=1e-12)
    assert run.ledger.contact_loss[-1] == pytest.approx(lost, rel=1e-9, abs=1e-12)
    # The impulse is the change of momentum of each body, and the force its derivative.
    assert run.arrays.stop_impulse[-1, 0] == pytest.approx(mass[0] * (run.arrays.velocity[-1, 0] - 0.8), rel=1e-9)
    # The same law between the wall of a free cavity and its ball.
    ball = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=0.2, stiffness=0.0, velocity=-0.1),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius="15 mm", material="steel", mass=0.7),
                gap="0.2 mm",
                velocity=0.8,
                contact=LAWS[name],
            ),
            duration="20 ms",
        )
    ).arrays.impacts
    log = run.arrays.impacts
    for quantity in ("separation_speed", "duration", "peak_force", "peak_overlap", "energy_lost"):
        mine, theirs = getattr(log, quantity)[0], getattr(ball, quantity)[0]
        assert mine == pytest.approx(theirs, rel=1e-8, abs=1e-14), quantity


@pytest.mark.parametrize("name", LAWS)
def test_energy_closes_on_a_beam_with_stops_and_a_damper(name: str) -> None:
    """A shaken beam with stops, one of them for its tuned mass, and a ball: the energy closes with each law."""
    case = rb.Case(
        structure=rb.Beam(
            length="0.4 m", width="30 mm", height="4 mm", material="steel", mode_count=4, damping_ratio=0.005,
            points={"tip": "0.4 m", "middle": "0.2 m"},
        ),
        tuned_mass=rb.TunedMass(mass="20 g", frequency="18 Hz", damping_ratio=0.05, point="tip"),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(diameter="10 mm", material="steel"), gap="0.3 mm", point="middle",
            contact=rb.Tsuji(restitution=0.8),
        ),
        stops=[
            rb.Stop(point="tip", gap="0.7 mm", side="both", contact=LAWS[name], **SIZE),
            rb.Stop(point="tuned mass", other="tip", gap="1 mm", contact=LAWS[name], **SIZE),
        ],
        base=rb.Harmonic(amplitude="8 m/s^2", frequency="19 Hz"),
        duration="0.6 s",
    )  # fmt: skip
    run = rb.simulate(case)
    assert run.ok, run.message
    assert run.energy_residual < 1e-9
    log = run.arrays.impacts
    assert {int(d) for d in log.damper} == {0, 1, 2, 3}
    assert run.arrays.dampers == ("damper", "stop leading", "stop trailing", "stop2")
    lost = log.energy_lost[log.complete].sum()
    assert lost == pytest.approx(run.ledger.contact_loss[-1], rel=1e-2)
    # No gap is smaller than the largest overlap of its stop.
    for k, stop in enumerate(run.arrays.stops):
        here = log.damper == run.arrays.dampers.index(stop)
        assert run.arrays.stop_gap[:, k].min() >= -log.peak_overlap[here].max() * (1 + 1e-9)


def test_oscillator_on_a_spring_stop_has_the_period_of_two_half_sines() -> None:
    """An oscillator that touches a linear elastic stop at rest has half a period without it and half with both springs."""
    mass, own, stop = 2.0, 5e3, 9e4
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=mass, stiffness=own, velocity=0.4),
            stop=rb.Stop(gap=0, contact=rb.Linear(stiffness=stop, restitution=1.0)),
            duration=20.0,
            output=rb.Output(rate=100.0),
        )
    )
    assert run.ok, run.message
    period = math.pi * (math.sqrt(mass / own) + math.sqrt(mass / (own + stop)))
    log = run.arrays.impacts
    assert log.time == pytest.approx(np.arange(len(log)) * period, abs=1e-9)
    assert log.duration[:-1] == pytest.approx(math.pi * math.sqrt(mass / (own + stop)), rel=1e-9)
    assert len(log) > 200


@pytest.mark.parametrize("e", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
def test_grazing_speed_follows_the_square_root(depth: float, e: float) -> None:
    """A free oscillation whose amplitude exceeds the gap by a part d meets the stop with sqrt(d (2 - d)) of its speed."""
    amplitude, rate = 2e-3, 2 * math.pi * 11.0
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=1.0, frequency=11.0, displacement=-amplitude),
            stop=rb.Stop(gap=amplitude * (1 - depth), contact=rb.Tsuji(restitution=0.5)),
            method=rb.Newton(restitution=e),
            duration=0.08,
        )
    )
    assert run.ok, run.message
    log = run.arrays.impacts
    speed = amplitude * rate * math.sqrt(depth * (2 - depth))
    # The gap is known to its rounding, of which the speed is the root.
    rounding = amplitude * rate * 1e-16 / math.sqrt(depth)
    assert log.approach_speed[0] == pytest.approx(speed, rel=1e-9, abs=4 * rounding)


@pytest.mark.parametrize("depth", [0.0, -1e-15, -1e-9])
def test_motion_that_just_does_not_reach_the_stop_is_free(depth: float) -> None:
    """An amplitude equal to the gap, or smaller by the last bits, changes nothing."""
    case = rb.Case(
        structure=rb.SDOF(mass=1.0, frequency=11.0, displacement="-2 mm"),
        stop=rb.Stop(gap=2e-3 * (1 - depth), contact=rb.Linear(stiffness="1 MN/m", restitution=0.5)),
        duration=1.0,
        output=rb.Output(rate=500.0),
    )
    free = rb.simulate(case.replaced({"stops": []}))
    for method in (rb.Newton(), rb.EventDriven()):
        run = rb.simulate(case.replaced({"method": method}))
        assert run.ok, run.message
        moved = np.interp(free.arrays.time, run.arrays.time, run.arrays.displacement[:, 0])
        # The gap is known to its rounding, and an impact at the root of that speed may be found.
        jumps = 2 * run.arrays.impacts.approach_speed.sum() / (2 * math.pi * 11.0)
        assert np.abs(moved - free.arrays.displacement[:, 0]).max() <= 1e-9 * 2e-3 + jumps
        assert run.arrays.impacts.approach_speed.max(initial=0.0) < 2e-7 * 2e-3 * 2 * math.pi * 11.0
        assert run.ledger.contact_loss[-1] <= 1e-12 * run.ledger.supplied[-1]


def driven(stops: Sequence[Any], sign: float = 1.0, **options: Any) -> Any:
    """Return the run of a structure of two masses with these stops, under a load of either sign."""
    return rb.simulate(
        rb.Case(
            structure=rb.Matrices(
                M=[[1.3, 0], [0, 0.8]], K=[[9e4, -4e4], [-4e4, 6e4]], points={"a": 0, "b": 1}, damping_ratio=0.01
            ),
            stops=list(stops),
            load=rb.Harmonic(amplitude=sign * 60.0, frequency=31.0, point="a"),
            **{"duration": 0.5, "output": rb.Output(rate=2000.0)} | options,
        )
    )


@pytest.mark.parametrize("method", [rb.Newton(), rb.EventDriven(), rb.TwoStep(dt_flight=2e-5, dt_contact=2e-6)])
def test_mirrored_reordered_and_exchanged_stops_give_equal_results(method: Any) -> None:
    """A mirrored case moves the other way to the last bit; another order, or the points exchanged, change nothing."""
    soft = rb.Linear(stiffness="3 MN/m", restitution=0.6)
    stops = [
        rb.Stop(point="a", gap="0.4 mm", contact=soft),
        rb.Stop(point="b", gap="0.9 mm", side="trailing", contact=soft),
        rb.Stop(point="a", other="b", gap="0.5 mm", contact=soft),
    ]
    flipped = {"leading": "trailing", "trailing": "leading"}
    mirrored = [stop.model_copy(update={"side": flipped[stop.side]}) for stop in stops]
    exchanged = [*stops[:2], rb.Stop(point="b", other="a", gap="0.5 mm", side="trailing", contact=soft)]
    run, mirror, swapped = (
        driven(stops, method=method),
        driven(mirrored, -1.0, method=method),
        driven(exchanged, method=method),
    )
    assert run.ok, run.message
    assert len(run.arrays.impacts) > 20
    assert np.array_equal(run.arrays.displacement, -mirror.arrays.displacement)
    assert np.array_equal(run.arrays.displacement, swapped.arrays.displacement)
    assert np.array_equal(run.arrays.cavity_force, -mirror.arrays.cavity_force)
    assert np.array_equal(run.arrays.stop_gap, swapped.arrays.stop_gap)
    turned = driven(stops[::-1], method=method)
    short = run.arrays.time < 0.1
    same = np.interp(run.arrays.time, turned.arrays.time, turned.arrays.displacement[:, 0])
    assert np.abs(same - run.arrays.displacement[:, 0])[short].max() < 1e-9


@pytest.mark.parametrize("method", [rb.Newton(restitution=0.4), rb.EventDriven()])
def test_point_pressed_against_its_stop_stays_there(method: Any) -> None:
    """A point that a load presses against a stop of gap zero comes to rest; the stop carries the load for ten minutes."""
    push = rb.Record(times=[0.0, 600.0], values=[25.0, 25.0], unit="N")
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=1.5, frequency=6.0, damping_ratio=0.02),
            stop=rb.Stop(gap=0, contact=rb.Linear(stiffness="1 MN/m", restitution=0.4)),
            load=push,
            duration=600.0,
            method=method,
            output=rb.Output(rate=0.5),
        )
    )
    assert run.ok, run.message
    late = run.arrays.time > 10
    own = 1.5 * (2 * math.pi * 6.0) ** 2
    depth = 0.0 if isinstance(method, rb.Newton) else 25.0 / (1e6 + own)
    assert run.arrays.displacement[late, 0] == pytest.approx(depth, rel=1e-9, abs=1e-18)
    assert run.arrays.cavity_force[late, 0] == pytest.approx(-(25.0 - own * depth), rel=1e-9)
    assert run.arrays.stop_impulse[-1, 0] == pytest.approx(-(25.0 - own * depth) * 600, rel=1e-3)
    mean = -np.diff(run.arrays.stop_impulse[late, 0]) / np.diff(run.arrays.time[late])
    assert mean == pytest.approx(25.0 - own * depth, rel=1e-9)
    # The base carries the force of the stop and of the spring.
    assert run.arrays.interface_force[late] == pytest.approx(25.0, rel=1e-9)


def test_point_on_a_hard_stop_lifts_off_when_the_load_turns() -> None:
    """A point at rest on a hard stop leaves it when the load changes its sign, and follows the equation."""
    rate = 2 * math.pi * 2.0
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=1.0, stiffness=0.0),
            stop=rb.Stop(gap=0, contact=rb.Tsuji(restitution=0.0 + 1e-6)),
            load=rb.Harmonic(amplitude=1.0, frequency=2.0),
            method=rb.Newton(restitution=0.0),
            duration=0.5,
            output=rb.Output(rate=1000.0),
        )
    )
    assert run.ok, run.message
    t, x = run.arrays.time, run.arrays.displacement[:, 0]
    held = t <= 0.25
    assert not x[held].any()
    s = t[~held] - 0.25
    assert x[~held] == pytest.approx(-(s / rate - np.sin(rate * s) / rate**2), abs=1e-15)
    assert run.arrays.cavity_force[held, 0] == pytest.approx(-np.sin(rate * t[held]), abs=1e-12)
    assert run.arrays.stop_impulse[-1, 0] == pytest.approx(-2 / rate, rel=1e-12)


def test_two_equal_hard_stops_share_the_impulse() -> None:
    """Two equal stops at one point close at one time: the motion is that with one, and each takes half of the impulse.

    The impulses of such stops follow from a singular matrix, which no row of balls has.
    """
    one = rb.Stop(point="a", gap="0.4 mm", contact=rb.Tsuji(restitution=0.5))
    many = driven([one, one.model_copy(update={"name": "second"})], method=rb.Newton())
    single = driven([one], method=rb.Newton())
    assert many.ok, many.message
    assert many.arrays.displacement[-1] == pytest.approx(single.arrays.displacement[-1], rel=1e-6, abs=1e-9)
    impulse = many.arrays.stop_impulse[-1]
    assert impulse[0] == impulse[1] == pytest.approx(single.arrays.stop_impulse[-1, 0] / 2, rel=1e-9)
    assert many.ledger.contact_loss[-1] == pytest.approx(single.ledger.contact_loss[-1], rel=1e-9)


@pytest.mark.parametrize("contact", [rb.Tsuji(restitution=0.6), rb.Linear(contact_time="1 ms", restitution=0.6)])
def test_two_hard_stops_let_go_of_a_point_when_the_load_turns(contact: Any) -> None:
    """A point that chatters to rest on two equal stops is let go of in each cycle of the load.

    One of them was released and pressed again without end, because what was left of its gap was rounding.
    """
    stop = rb.Stop(gap=0, contact=contact)
    case = rb.Case(
        structure=rb.SDOF(mass=2.4, frequency=35.0, displacement="-0.07 mm", velocity="-12 mm/s"),
        stops=[stop, stop],
        load=rb.Harmonic(amplitude=43.0, frequency=24.0),
        base=rb.Harmonic(amplitude=3.0, frequency=2.0),
        duration=1.0,
        method=rb.Newton(max_events=20_000),
    )
    run, single = rb.simulate(case), rb.simulate(case.replaced({"stops": [stop]}))
    assert run.ok, run.message
    assert run.counts["sticks"] >= 2
    early = single.arrays.time < 0.2
    same = np.interp(single.arrays.time, run.arrays.time, run.arrays.displacement[:, 0])
    assert np.abs(same - single.arrays.displacement[:, 0])[early].max() < 1e-9


def test_equal_stops_of_different_restitution_rebound_with_the_larger() -> None:
    """Of two hard stops that a point meets at one time, the one with the larger restitution acts."""
    stops = [rb.Stop(gap="1 mm", contact=rb.Tsuji(restitution=e), name=f"e {e}") for e in (0.3, 0.8)]
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=1.0, stiffness=0.0, velocity=0.5),
            stops=stops,
            duration="10 ms",
            method=rb.Newton(),
        )
    )
    assert run.ok, run.message
    assert run.arrays.velocity[-1, 0] == pytest.approx(-0.4, rel=1e-12)
    assert run.energy_residual < 1e-12


def test_row_of_masses_against_a_wall_is_resolved_together() -> None:
    """Three masses that lie against each other and a wall stop together: hard, without rebound, all at one instant."""
    points = {"a": 0, "b": 1, "c": 2}
    stops = [rb.Stop(point=p, other=q, gap=0, contact=rb.Tsuji(restitution=0.5)) for p, q in (("a", "b"), ("b", "c"))]
    stops.append(rb.Stop(point="c", gap="1 mm", contact=rb.Tsuji(restitution=0.5)))
    run = rb.simulate(
        rb.Case(
            structure=rb.Matrices(
                M=np.diag([1.0, 2.0, 0.5]), K=np.zeros((3, 3)), points=points, velocity=[0.2, 0.2, 0.2]
            ),
            stops=stops,
            duration="20 ms",
            method=rb.Newton(restitution=0.0),
        )
    )
    assert run.ok, run.message
    assert np.abs(run.arrays.velocity[-1]).max() < 1e-15
    assert run.ledger.contact_loss[-1] == pytest.approx(0.5 * 3.5 * 0.04, rel=1e-12)
    assert run.arrays.stop_impulse[-1] == pytest.approx([-0.2, -0.6, -0.7], rel=1e-12)


def test_hertz_stop_agrees_with_scipy() -> None:
    """A driven oscillator with an elastic Hertz stop moves as SciPy computes it, with collocation and without."""
    from scipy.integrate import solve_ivp

    soft = rb.Material(density="1100 kg/m^3", young="40 MPa", poisson=0.45)
    case = rb.Case(
        structure=rb.SDOF(mass=1.2, frequency=9.0, damping_ratio=0.02),
        stop=rb.Stop(gap="1 mm", contact=rb.Tsuji(restitution=1.0), radius="8 mm", material=soft),
        load=rb.Harmonic(amplitude=12.0, frequency=8.0),
        duration=0.6,
        output=rb.Output(rate=400.0),
    )  # fmt: skip
    stiffness = case.stops[0].contact.coefficients(case.stops[0].pair(case.modes))[1]["stiffness"]
    rate = 2 * math.pi * 9.0

    def slope(t: float, y: Any) -> list[float]:
        force = 12 * math.sin(2 * math.pi * 8 * t) - stiffness * max(y[0] - 1e-3, 0.0) ** 1.5
        return [y[1], force / 1.2 - rate**2 * y[0] - 2 * 0.02 * rate * y[1]]

    even = np.linspace(0, 0.6, 241)
    exact = solve_ivp(slope, (0, 0.6), [0.0, 0.0], "DOP853", even, rtol=1e-11, atol=1e-14, max_step=2e-5).y[0]
    for method in (rb.EventDriven(), rb.EventDriven(collocation=False)):
        run = rb.simulate(case.replaced({"method": method}))
        assert run.ok, run.message
        assert len(run.arrays.impacts) > 3
        mine = np.interp(even, run.arrays.time, run.arrays.displacement[:, 0])
        assert np.abs(mine - exact).max() < 1e-8
