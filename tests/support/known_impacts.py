"""Results of runs for which an exact value is known, for the tests and the verification table of the documentation."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

import rattlebox as rb

from . import impact_cases
from .exact import dashpot, impact_oscillator, masri_caughey, printed, restitution_laws, shaken

ENDINGS = ("zero_overlap", "zero_force")


@dataclass(frozen=True)
class Comparison:
    """One comparison: exact value, simulated value and the relative tolerance of the method."""

    item: str
    case: str
    exact: float
    ours: float
    allowed: float

    @property
    def difference(self) -> float:
        """Difference relative to the exact value."""
        return abs(self.ours - self.exact) / abs(self.exact)

    @property
    def within_tolerance(self) -> bool:
        """Whether the difference is within the tolerance."""
        return self.difference <= self.allowed


def simulate(case: Any) -> Any:
    """Run a case that must finish."""
    run = rb.simulate(case)
    if not run.ok:
        raise AssertionError(f"{run.status}: {run.message}")
    return run


def first_impact(case: Any) -> tuple[float, float, float, float]:
    """Return restitution, duration, peak overlap and peak force of the first impact."""
    log = simulate(case).arrays.impacts
    return (
        float(log.separation_speed[0] / log.approach_speed[0]),
        float(log.duration[0]),
        float(log.peak_overlap[0]),
        float(log.peak_force[0]),
    )


def tsuji() -> Iterator[Comparison]:
    """Yield restitution, contact time and overlap of Tsuji's law against a fixed wall."""
    speed = 0.7
    scale = (impact_cases.MASS / impact_cases.STIFFNESS) ** 0.4 * speed**-0.2
    for zeta in (0.0, 0.1, 0.3, 0.5, 0.9):
        for ending in ENDINGS:
            contact = rb.Tsuji(alpha=math.sqrt(5) * zeta, ending=ending)
            time = dashpot.tsuji_contact_time(zeta, ending) * scale
            e, duration, peak, _ = first_impact(impact_cases.single_impact(contact, speed, 1.5 * time))
            name = f"Tsuji, damping ratio {zeta}, ends at {ending.replace('_', ' ')}"
            yield Comparison("1", f"{name}: restitution", dashpot.restitution(zeta, ending), e, 1e-10)
            yield Comparison("1", f"{name}: contact time", time, duration, 1e-10)
            overlap = dashpot.tsuji_peak_overlap(zeta) * (impact_cases.MASS * speed**2 / impact_cases.STIFFNESS) ** 0.4
            yield Comparison("1", f"{name}: largest overlap", overlap, peak, 1e-10)


def linear() -> Iterator[Comparison]:
    """Yield restitution and contact time of the linear spring-dashpot against a fixed wall."""
    speed, stiffness = 0.7, 1e7
    rate = math.sqrt(stiffness / impact_cases.MASS)
    for zeta in (0.0, 0.1, 0.5, 0.9):
        for ending in ENDINGS:
            contact = rb.Linear(stiffness=stiffness, damping=2 * zeta * impact_cases.MASS * rate, ending=ending)
            time = dashpot.linear_contact_time(zeta, ending) / rate
            e, duration, _, force = first_impact(impact_cases.single_impact(contact, speed, 1.5 * time))
            name = f"linear, damping ratio {zeta}, ends at {ending.replace('_', ' ')}"
            yield Comparison("1", f"{name}: restitution", dashpot.restitution(zeta, ending), e, 1e-10)
            yield Comparison("1", f"{name}: contact time", time, duration, 1e-10)
            top = dashpot.linear_peak_force(zeta) * speed * rate * impact_cases.MASS
            yield Comparison("1", f"{name}: largest force", top, force, 1e-10)


def prescribed_restitution() -> Iterator[Comparison]:
    """Yield the restitution of contacts with a prescribed restitution."""
    for e in (0.05, 0.3, 0.8, 0.99117, 1.0):
        for ending in ENDINGS:
            for contact in (
                rb.Tsuji(restitution=e, ending=ending),
                rb.Linear(stiffness=1e7, restitution=e, ending=ending),
            ):
                got = first_impact(impact_cases.single_impact(contact, 0.3, 1e-3))[0]
                yield Comparison(
                    "1",
                    f"{type(contact).__name__}, e = {e} prescribed, {ending.replace('_', ' ')}",
                    e,
                    got,
                    1e-10,
                )


def jackson_green() -> Iterator[Comparison]:
    """Yield restitution, and speeds of a ball in a fixed cavity after n hits, over the critical speed."""
    strain = impact_cases.YIELD / impact_cases.YOUNG
    critical = restitution_laws.jackson_green_speed(
        impact_cases.RADIUS, impact_cases.MASS, impact_cases.MODULUS, impact_cases.YIELD, impact_cases.POISSON
    )
    contact = rb.Tsuji(restitution=rb.JacksonGreen())
    for ratio in printed.JACKSON_GREEN:
        # At the limit of the law a rounded speed could exceed it.
        case = impact_cases.single_impact(contact, ratio * critical * (1 - 1e-14), 3e-4)
        exact = restitution_laws.jackson_green(ratio, strain)
        yield Comparison("2", f"Jackson-Green, V/V_c = {ratio}: restitution", exact, first_impact(case)[0], 1e-10)
    log = simulate(impact_cases.still_cavity(contact, 10 * critical, 0.2)).arrays.impacts
    for hits in printed.JACKSON_GREEN_HITS:
        exact = restitution_laws.jackson_green_after(10, hits, strain)
        # The error of the speed grows with the number of contacts.
        yield Comparison(
            "2",
            f"Jackson-Green, V/V_c after {hits} hits",
            exact,
            log.separation_speed[hits - 1] / critical,
            1e-10 * hits,
        )


def thornton() -> Iterator[Comparison]:
    """Yield restitution of the hysteretic contact."""
    pressure = 1.6 * impact_cases.YIELD
    critical = restitution_laws.thornton_speed(impact_cases.RADIUS, impact_cases.MASS, impact_cases.MODULUS, pressure)
    for ratio in printed.THORNTON:
        case = impact_cases.single_impact(rb.Thornton(yield_pressure=pressure), ratio * critical, 3e-4)
        yield Comparison(
            "3", f"Thornton, V/V_y = {ratio}", restitution_laws.thornton(ratio), first_impact(case)[0], 1e-10
        )
    ratio = 1e8
    tail = first_impact(impact_cases.single_impact(rb.Thornton(yield_pressure=pressure), ratio * critical, 3e-4))[0]
    # The next term of the expansion is of first order in V_y / V.
    yield Comparison(
        "3", "Thornton, tail: e (V/V_y)^(1/4) at 1e8", restitution_laws.THORNTON_TAIL, tail * ratio**0.25, 1e-7
    )


def stable(key: tuple[float, float, float]) -> masri_caughey.Orbit:
    """Return the orbit that is printed for (mass ratio, restitution, clearance)."""
    multiplier = printed.MASRI_CAUGHEY[key][2]
    return min(masri_caughey.orbits(*key), key=lambda orbit: abs(max(abs(orbit.multipliers())) - multiplier))


def differences(state: Callable[[NDArray[np.float64]], NDArray[np.float64]], steps: list[float]) -> Any:
    """Return the Jacobian of a map at zero by central differences of fourth order."""
    columns = []
    for k, step in enumerate(steps):
        d = np.zeros(len(steps))
        d[k] = step
        near, far = state(d) - state(-d), state(2 * d) - state(-2 * d)
        columns.append((8 * near - far) / (12 * step))
    return np.array(columns).T


def damper_multiplier(orbit: masri_caughey.Orbit) -> float:
    """Return the largest multiplier of the mirrored half-cycle map, from perturbed runs."""

    def end(shift: NDArray[np.float64]) -> NDArray[np.float64]:
        a = simulate(impact_cases.impact_damper(orbit, 1.0, shift=tuple(shift))).arrays
        return np.array([a.displacement[-1, 0], a.velocity[-1, 0], a.ball_position[-1, 0], a.ball_velocity[-1, 0]])

    size = 1e-3 * orbit.clearance
    return float(max(abs(np.linalg.eigvals(-differences(end, [size] * 4)))))


def impact_damper() -> Iterator[Comparison]:
    """Yield ball speed and multiplier of the orbits of Masri and Caughey."""
    for key in printed.MASRI_CAUGHEY:
        orbit = stable(key)
        name = "Masri-Caughey, mass ratio {}, e {}, clearance {}".format(*key)
        exact = max(abs(orbit.multipliers()))
        # Differences of fourth order with steps of a thousandth have truncation and rounding errors of about 1e-11,
        # times the condition number of the eigenvalue.
        yield Comparison("4", f"{name}: multiplier", exact, damper_multiplier(orbit), 1e-7)
        if exact < 1:
            a = simulate(impact_cases.impact_damper(orbit, 40.0)).arrays
            yield Comparison("4", f"{name}: approach speed", orbit.approach, a.impacts.approach_speed[-1], 1e-10)
            yield Comparison("4", f"{name}: ball velocity w", orbit.speed, a.ball_velocity[-1, 0], 1e-10)
            yield Comparison("4", f"{name}: max|x|/50", orbit.largest() / 50, largest_displacement(orbit) / 50, 1e-9)


def largest_displacement(orbit: masri_caughey.Orbit) -> float:
    """Return the largest displacement of the structure in half a cycle, from samples and a parabola through the peak."""
    span = orbit.half_period
    case = impact_cases.impact_damper(orbit, 1.0)
    case = case.model_copy(update={"output": rb.Output(times=np.linspace(0, span, 4001))})
    x = np.abs(simulate(case).arrays.displacement[:, 0])
    k = int(x.argmax())
    left, mid, right = x[k - 1 : k + 2]
    return float(mid + (right - left) ** 2 / (8 * (2 * mid - left - right)))


SOFT_KEY = (0.1, 0.25, 20)
SOFT_TIMES = (1 / 80, 1 / 160, 1 / 320, 1 / 640)


def linear_damper(orbit: masri_caughey.Orbit, time: float) -> Any:
    """Return the damper with linear springs of a contact time."""
    law = rb.Linear(contact_time=time, restitution=orbit.restitution, ending="zero_force")
    return impact_cases.impact_damper(orbit, SOFT_HALF_CYCLES, method=rb.EventDriven(), contact=law)


def hertz_damper(orbit: masri_caughey.Orbit, time: float) -> Any:
    """Return the damper with Hertz-Tsuji contacts that, undamped, would last a time at the exact approach speed."""
    mass = orbit.mass_ratio / (1 + orbit.mass_ratio)
    stiffness = mass * (3.2180655 / time) ** 2.5 / math.sqrt(orbit.approach)
    young = 0.75 * stiffness / math.sqrt(impact_cases.RADIUS)
    soft = rb.Material(density=1.0, young=young, poisson=0.0)
    law = rb.Tsuji(restitution=orbit.restitution)
    return impact_cases.impact_damper(orbit, SOFT_HALF_CYCLES, method=rb.EventDriven(), contact=law, soft=soft)


SOFT_HALF_CYCLES = 160.0
SOFT_DAMPERS = {"linear": linear_damper, "Hertz-Tsuji": hertz_damper}


def soft_errors(law: str) -> tuple[list[float], list[float]]:
    """Return contact times over the period, and relative errors of the approach speed of soft dampers."""
    orbit = stable(SOFT_KEY)
    error = []
    for fraction in SOFT_TIMES:
        log = simulate(SOFT_DAMPERS[law](orbit, fraction * 2 * orbit.half_period)).arrays.impacts
        speeds = log.approach_speed[log.complete][-2:]
        error.append(float(speeds.mean() / orbit.approach - 1))
    return list(SOFT_TIMES), error


def soft_order(law: str) -> float:
    """Return the order at which soft impacts approach hard ones as the contact time goes to zero."""
    times, error = soft_errors(law)
    return math.log(error[-2] / error[-1]) / math.log(times[-2] / times[-1])


def soft_limit() -> Iterator[Comparison]:
    """Yield the approach speed of soft impacts extrapolated to no contact time."""
    orbit = stable(SOFT_KEY)
    for law in SOFT_DAMPERS:
        times, error = soft_errors(law)
        # Polynomial through the four runs; the remaining error is of fourth order in the contact time, at most 1e-5.
        limit = sum(
            e * math.prod(t / (t - own) for j, t in enumerate(times) if j != i)
            for i, (own, e) in enumerate(zip(times, error, strict=True))
        )
        yield Comparison(
            "4",
            f"{law} contact extrapolated to contact time 0: approach speed",
            orbit.approach,
            orbit.approach * (1 + limit),
            1e-5,
        )


def slow_manifold() -> Iterator[Comparison]:
    """Yield ball speeds in a shaken cavity with two impacts a cycle."""
    for e in printed.SLOW_MANIFOLD_THRESHOLD:
        for above in (1.001, 1.5):
            orbit = shaken.two_impacts(e, above * shaken.threshold(e))
            log = simulate(impact_cases.shaken_cavity(orbit, 20.0)).arrays.impacts
            yield Comparison(
                "5",
                f"shaken cavity, e {e}, {above} x threshold: approach speed",
                orbit.approach,
                log.approach_speed[-1],
                1e-9,
            )
        yield Comparison("5", f"shaken cavity, e {e}: threshold", shaken.threshold(e), shaken_threshold(e), 1e-7)


def shaken_threshold(e: float) -> float:
    """Return the least amplitude with two impacts a cycle, from runs above it: amplitude^2 is a parabola of the speed."""
    amplitudes = [above * shaken.threshold(e) for above in (1.01, 1.1, 1.3)]
    runs = [simulate(impact_cases.shaken_cavity(shaken.two_impacts(e, a), 20.0)) for a in amplitudes]
    speeds = [run.arrays.impacts.approach_speed[-1] for run in runs]
    curve, slope, start = np.polyfit(speeds, np.square(amplitudes), 2)
    return float(np.sqrt(start - slope**2 / (4 * curve)))


def collect_and_collide() -> Iterator[Comparison]:
    """Yield energy lost in a cycle by a ball that sticks to the walls."""
    for ratio in printed.COLLECT_AND_COLLIDE:
        log = simulate(impact_cases.sticky_load(ratio, 10.25)).arrays.impacts
        landed = log.energy_lost[log.energy_lost > 1e-6 * log.energy_lost.max()]
        ours = float(landed[-2:].sum() / ratio**2)
        yield Comparison(
            "6",
            f"collect and collide, A/g = {ratio}: energy a cycle",
            shaken.collect_and_collide(ratio),
            ours,
            1e-10,
        )


def table_multiplier(orbit: shaken.TableOrbit) -> Any:
    """Return the Jacobian of the map from the top of one flight to the next, from perturbed runs."""

    def end(shift: NDArray[np.float64]) -> NDArray[np.float64]:
        a = simulate(impact_cases.table(orbit, 1.0, tuple(shift))).arrays
        return np.array([a.relative_position[-1, 0], a.relative_velocity[-1, 0]])

    return differences(end, [1e-3, 1e-3])


def doubling(restitution: float, cycles: int) -> float:
    """Return the acceleration at which the bouncing motion doubles its period, from perturbed runs."""

    def flip(gamma: float) -> float:
        jacobian = table_multiplier(shaken.table_orbit(restitution, gamma, cycles))
        return float(1 + np.trace(jacobian) + np.linalg.det(jacobian))

    middle = shaken.table_bounds(restitution, cycles)[1]
    return float(brentq(flip, 0.95 * middle, 1.05 * middle, xtol=1e-9))


def vibrating_table() -> Iterator[Comparison]:
    """Yield impact speed and doubling threshold of a ball on a shaken table."""
    for (e, n), (start, end) in printed.VIBRATING_TABLE.items():
        orbit = shaken.table_orbit(e, 0.5 * (start + end), n)
        log = simulate(impact_cases.table(orbit, 30.0)).arrays.impacts
        name = f"vibrating table, e {e}, {n} cycles"
        yield Comparison("7", f"{name}: approach speed", orbit.approach, log.approach_speed[-1], 1e-10)
        # The velocity of the table at the impact does not depend on its acceleration; it peaks at the birth of the orbit.
        phase = log.time[-1] + orbit.phase + math.pi * n
        yield Comparison("7", f"{name}: start", shaken.table_bounds(e, n)[0], orbit.gamma * math.cos(phase), 1e-9)
        yield Comparison("7", f"{name}: doubling", shaken.table_bounds(e, n)[1], doubling(e, n), 1e-7)


def chatter() -> Iterator[Comparison]:
    """Yield time and path of a ball that chatters to rest."""
    height, e, gravity = 0.5, 0.8, 9.81
    log = simulate(impact_cases.dropped(height, e, gravity, 4.0)).arrays.impacts
    bounced = np.asarray(log.separation_speed > 0)
    speed = log.separation_speed[bounced]
    # Bounces below the threshold of sticking are summed as a geometric series.
    rest = float(log.time[bounced][-1] + 2 * speed[-1] / (gravity * (1 - e)))
    path = float(height + (speed**2).sum() / gravity + (speed[-1] * e) ** 2 / gravity / (1 - e * e))
    yield Comparison("7", "chatter: time to rest", shaken.chatter_time(height, e, gravity), rest, 1e-9)
    yield Comparison("7", "chatter: path", shaken.chatter_path(height, e), path, 1e-9)


def apparent_mass(gamma: float) -> tuple[float, float]:
    """Return m' and m'' of an inelastic ball on a shaker, from one cycle of the force on the cavity."""
    log = simulate(impact_cases.inelastic_ball(gamma, 6.0)).arrays.impacts
    hits = log.approach_speed > 1e-3 * log.approach_speed.max()
    land, speed = float(log.time[hits][-2]), float(log.approach_speed[hits][-2])
    off = land + (math.asin(1 / gamma) - land) % (2 * math.pi)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    times, weights = land + 0.5 * (off - land) * (nodes + 1), 0.5 * (off - land) * weights
    arrays = simulate(impact_cases.inelastic_ball(gamma, 6.0, list(times))).arrays
    force = -np.interp(times, arrays.time, arrays.cavity_force[:, 0])
    sines = (weights * force * np.sin(times)).sum() + speed * math.sin(land)
    cosines = (weights * force * np.cos(times)).sum() + speed * math.cos(land)
    return -float(sines) / (math.pi * gamma), float(cosines) / (math.pi * gamma)


def inelastic_ball() -> Iterator[Comparison]:
    """Yield the apparent mass of an inelastic ball on a shaker."""
    for gamma in printed.APPARENT_MASS:
        exact, ours = shaken.inelastic_ball(gamma).apparent_mass(), apparent_mass(gamma)
        for name, a, b in zip(("m'", "m''"), exact, ours, strict=True):
            yield Comparison("8", f"inelastic ball on a shaker, Gamma {gamma}: {name}", a, b, 1e-9)


def oscillator_with_stop() -> Iterator[Comparison]:
    """Yield the speed before impact of an oscillator with a stop."""
    for key, shown in printed.IMPACT_OSCILLATOR.items():
        orbit = min(impact_oscillator.orbits(*key), key=lambda o: abs(o.speed - shown))
        log = simulate(impact_cases.impact_oscillator(orbit, 20.0)).arrays.impacts
        name = "impact oscillator, zeta {}, omega {}, stop {}, e {}".format(*key)
        yield Comparison("9", f"{name}: speed before impact", orbit.speed, log.approach_speed[-1], 1e-9)


ALL: tuple[Callable[[], Iterator[Comparison]], ...] = (
    tsuji,
    linear,
    prescribed_restitution,
    jackson_green,
    thornton,
    impact_damper,
    soft_limit,
    slow_manifold,
    collect_and_collide,
    vibrating_table,
    chatter,
    inelastic_ball,
    oscillator_with_stop,
)
