"""The time step of a run with particles: what limits it, and what the run made of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.narrow import instance
from rattlebox.core import _core
from rattlebox.model.contacts import Linear
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic, SineSweep
from rattlebox.model.methods import Dem
from rattlebox.model.particle_case import direction_of_base
from rattlebox.model.restitutions import Constant
from rattlebox.model.shocks import Shock
from rattlebox.model.signals import Sampled
from rattlebox.prepare.base_motion import base_motion
from rattlebox.prepare.softening import MOST_CHANGE, MOST_ENDURING, Effect, Shaking, exponent_of_force

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.model.particle_damper import ContactTable, Entry, ParticleDamper

BOUND = 0.2
"""Longest step over the shortest contact. A lone Hertz contact is followed stably up to half of it; a particle that many
others hold swings up to twice as fast, and friction adds to it."""

RAYLEIGH = 0.2
"""Longest automatic step over the time that a Rayleigh wave takes along the smallest particle."""

MOST_AVERAGED = 0.02
"""Of the amplitude of a record at the fastest mode, that its means over steps may lack."""

FEWEST_STEPS = 20.0
"""In the shortest contact."""

MOST_OVERLAP = 0.01
"""Largest overlap over the smaller radius: beyond it contacts of spheres are no longer small against them."""

WARNINGS = {
    "few_steps": f"fewer than {FEWEST_STEPS:g} steps in the shortest contact",
    "deep_overlap": f"overlaps above {100 * MOST_OVERLAP:g} % of the radius",
    "soft_bed": "softening that lowers the resonance of the bed too close to the excitation",
    "enduring_contacts": f"more than {100 * MOST_ENDURING:g} % of the loss in enduring contacts, which grows with softening",
}
"""What a run can leave its bounds in."""

HERTZ_TIME = 2.9432752
"""Duration of a Hertz contact over its largest overlap by the approach speed."""

MOST_STEPS = 2**63 - 1
"""In a run: the core counts them in 64-bit integers."""

INSTANTS, GOLDEN = 4096, (math.sqrt(5) - 1) / 2
"""At which speeds are looked at besides the samples, which may be as far apart as a period. Multiples of the golden ratio
fall together with no other motion."""


@dataclass(frozen=True)
class Limit:
    """Something that a step must resolve.

    Attributes
    ----------
    duration
        How long it lasts [s].
    step
        Longest automatic step [s].
    bound
        Longest step that is not refused [s]; infinite if any is allowed.
    what
        What it is, in words.
    is_contact
        Whether it is a contact.
    """

    duration: float
    step: float
    bound: float
    what: str
    is_contact: bool = False


@dataclass(frozen=True)
class Step:
    """The step of a run.

    Attributes
    ----------
    dt
        [s].
    every
        Steps between samples.
    count
        Steps in all.
    limit
        What limits it most.
    shortest
        The shortest contact that is expected.
    speeds
        Largest approach speed that is expected in each damper [m/s].
    motions
        Expected motion of each cavity.
    """

    dt: float
    every: int
    count: int
    limit: Limit
    shortest: Limit
    speeds: tuple[float, ...]
    motions: tuple[Shaking, ...] = ()


def instants(case: Case) -> Any:
    """Return times at which speeds are looked at, (T,) [s]: those of the samples, and others in step with nothing."""
    others = case.duration * (np.arange(INSTANTS) * GOLDEN % 1.0)
    return np.union1d(case.sample_times(), others)


def expected_speeds(case: Case, cavity_velocities: list[Any]) -> tuple[float, ...]:
    """Return the largest approach speed to expect in each damper [m/s].

    The sum of what a free particle and its cavity may differ by: the span of the cavity's velocity without particles, with
    rest in it, that of the base's, the speed of a fall through the cavity, and twice the largest speed at the start.

    Parameters
    ----------
    case
        The case.
    cavity_velocities
        Velocity of each cavity without particles at the `instants`, (T, 3) [m/s].
    """
    times = instants(case)
    base = np.zeros((times.size, 3))
    for signal, acceleration in zip((*case.base, *case.shaker_motion), case.base_acceleration(), strict=True):
        base += np.outer(base_motion(acceleration, times)[1], direction_of_base(case, signal))
    speeds = []
    for damper, velocity in zip(case.particle_dampers, cavity_velocities, strict=True):
        gravity = np.array(damper.gravity)
        size = float(np.linalg.norm(gravity))
        fall = math.sqrt(2 * size * damper.cavity.extent(gravity / size)) if size else 0.0
        start = 2 * float(np.linalg.norm(damper.start.velocity, axis=1).max())
        rest = np.zeros((1, 3))  # particles without a speed of their own
        speeds.append(_span(np.vstack([rest, velocity])) + _span(base) + fall + start)
    return tuple(speeds)


def _span(velocity: Any) -> float:
    return float(np.linalg.norm(np.ptp(velocity, axis=0)))


def contact_limits(
    case: Case, damper: ParticleDamper, table: ContactTable, speed: float, fraction: float
) -> Iterator[Limit]:
    """Yield a limit for each kind of pair in a damper: its shortest contact at a speed.

    Parameters
    ----------
    case, damper
        The case, and one of its dampers.
    table
        Its pairs.
    speed
        Approach speed [m/s].
    fraction
        Of a contact, for a step.
    """
    labels = [species.label for species in damper.particles]
    wall_mass = _wall_mass(case, damper)
    numbers = np.bincount(damper.contents.species, minlength=len(labels))
    for entry in table.entries:
        if entry.names[0] == entry.names[1] and numbers[labels.index(entry.names[0])] < 2:
            continue  # nothing to meet
        reference = packed_normal(damper, entry)
        damped = max(1.0, 2 * _damping_ratio(entry, reference, speed))
        duration, bound, sizes = math.inf, math.inf, ""
        for pair_radius, pair_mass, told in _sizes(damper, entry, wall_mass):
            law = reference.resized(entry.pair.radius, entry.pair.mass, pair_radius, pair_mass)
            lasts = law.contact_time(speed)
            bound = min(bound, BOUND * lasts / max(damped, _sideways(damper, entry, law, pair_radius, speed, lasts)))
            if lasts < duration:
                duration, sizes = lasts, told
        at = "" if isinstance(entry.contact, Linear) else f" at {speed:.3g} m/s"
        rubs = ", with its friction" if bound < 0.5 * BOUND * duration / damped else ""
        what = f"contact of {' and '.join(entry.names)} ({sizes}){at}, {_time(duration)}{rubs}"
        yield Limit(duration, min(fraction * duration / damped, 0.5 * bound), bound, what, is_contact=True)


def packed_normal(damper: ParticleDamper, entry: Entry) -> _core.NormalForce:
    """Return the softened normal law of a pair."""
    return _core.normal_law(*damper.softened(entry))


def packed_friction(damper: ParticleDamper, entry: Entry) -> _core.TangentialForce:
    """Return the softened friction law of a pair."""
    return _core.tangential_law(*damper.softened_friction(entry))


def _sideways(
    damper: ParticleDamper, entry: Entry, law: _core.NormalForce, radius: float, speed: float, duration: float
) -> float:
    """Return by what factor friction and rolling resistance shorten the longest stable step of a contact.

    A spring in the plane of contact swings spheres that are free to turn with 7/2 k_t/m*, against k/m* along the normal; one
    against rolling adds 5/2 of its own part of k_t. Steps up to 1.2 over the frequency were seen to give no energy. Dashpots
    take a velocity predicted from the last two steps, stable up to 1 over their rate: 7/2 c_t/m*, and 5/2 c_r/(m* R*^2).
    """
    tangential = packed_friction(damper, entry)
    if not tangential.friction_coefficient or not math.isfinite(duration):
        return 1.0
    mass = law.effective_mass
    firm = tangential.stiffness_at(radius, mass, law.elastic_coefficient, law.largest_overlap(speed))
    rolling = damper.rolling_of(entry)
    rolls = rolling.stiffness if rolling.coefficient else 0.0
    swing = BOUND * duration * math.sqrt(firm / mass)
    damped = _damping_ratio(entry, law, speed)
    return max(
        1.0,
        swing * math.sqrt(7 / 2 + 5 / 2 * rolls) / 1.2,
        swing * 7 * math.sqrt(5 / 6) * damped * tangential.damping_share,
        swing * 5 * math.sqrt(1.4 * rolls) * rolling.damping,
    )


def _wall_mass(case: Case, damper: ParticleDamper) -> float:
    """Of the structure, where an impact on a wall meets the least of it [kg]."""
    mobility = np.linalg.norm(case.modes.space_shape(damper.point, damper.direction), 2) ** 2
    return float(1 / mobility) if mobility else math.inf


def _sizes(damper: ParticleDamper, entry: Entry, wall_mass: float) -> Iterator[tuple[float, float, str]]:
    """R*, m* and a description of the smallest and largest pairs of an entry."""
    labels = [species.label for species in damper.particles]
    extremes = []
    for name in entry.names:
        if name not in labels:
            extremes.append([(math.inf, wall_mass)])
            continue
        own = damper.contents.species == labels.index(name)
        radii, masses = damper.contents.radius[own], damper.contents.mass[own]
        extremes.append([(float(radii[k]), float(masses[k])) for k in {int(radii.argmin()), int(radii.argmax())}])
    for radius, mass in extremes[0]:
        for other_radius, other_mass in extremes[1]:
            told = [f"{2e3 * r:.4g} mm" for r in (radius, other_radius) if math.isfinite(r)]
            pair = 1 / (1 / radius + 1 / other_radius), 1 / (1 / mass + 1 / other_mass)
            yield *pair, "diameter " + " and ".join(dict.fromkeys(told))


def _damping_ratio(entry: Entry, law: _core.NormalForce, speed: float) -> float:
    """Return the damping ratio of a contact; 0 where its restitution depends on the speed."""
    constant = entry.contact.impact_restitution
    if law.needs_restitution and not isinstance(constant, Constant):
        return 0.0
    return law.damping_ratio(constant.e if isinstance(constant, Constant) else 1.0, speed)


def limits(case: Case, tables: list[ContactTable], speeds: tuple[float, ...]) -> list[Limit]:
    """Return all that a step must resolve.

    Parameters
    ----------
    case
        The case.
    tables
        Pairs of each damper.
    speeds
        Largest approach speed to expect in each damper [m/s].
    """
    fraction = instance(case.method, Dem).fraction
    found: list[Limit] = []
    for damper, table, speed in zip(case.particle_dampers, tables, speeds, strict=True):
        found += contact_limits(case, damper, table, speed, fraction)
        for index, species in enumerate(damper.particles):
            if all(isinstance(entry.contact, Linear) for entry in table.entries if species.label in entry.names):
                continue
            radius = float(damper.contents.radius[damper.contents.species == index].min())
            material = species.material
            shear = material.young / (2 * (1 + material.poisson)) / damper.softening_factor
            wave = (0.1631 * material.poisson + 0.8766) * math.sqrt(shear / material.density)
            time = math.pi * radius / wave
            told = f"Rayleigh wave along {species.label} (diameter {2e3 * radius:.4g} mm), {_time(time)}"
            found.append(Limit(time, RAYLEIGH * time, math.inf, told))
    for k, stiffness in enumerate(case.modes.stiffness):
        if stiffness > 0:
            found.append(_of_motion(2 * math.pi / math.sqrt(stiffness), fraction, f"period of mode {k + 1}"))
    for signal in (*case.loads, *case.base_acceleration()):
        if isinstance(signal, Shock):
            found.append(_of_motion(signal.duration, fraction, "pulse"))
        elif isinstance(signal, Harmonic):
            found.append(_of_motion(1 / signal.frequency, fraction, "period of a harmonic"))
        elif isinstance(signal, SineSweep):
            highest = max(signal.first_frequency, signal.last_frequency)
            found.append(_of_motion(1 / highest, fraction, "shortest period of a sweep"))
    return found


def _of_motion(duration: float, fraction: float, what: str) -> Limit:
    return Limit(duration, fraction * duration, BOUND * duration, f"{what}, {_time(duration)}")


def choose_step(case: Case, tables: list[ContactTable], speeds: tuple[float, ...]) -> Step:
    """Return the step: as given, or from what it must resolve; a little shorter so that samples fall on steps.

    Parameters
    ----------
    case
        The case.
    tables
        Pairs of each damper.
    speeds
        Largest approach speed to expect in each damper [m/s].

    Raises
    ------
    Hint
        When the step that is given is too long to be stable or to follow a load, or its steps are too many to be counted.
    """
    method = instance(case.method, Dem)
    found = limits(case, tables, speeds)
    tightest = min(found, key=lambda limit: limit.step)
    samples = case.even_samples()
    if method.dt == "auto":
        longest = tightest.step
    else:
        longest = float(method.dt)
        refusing = min(found, key=lambda limit: limit.bound)
        if longest > refusing.bound:
            raise Hint(
                f"dt = {_time(longest)} is too long: the bound is {_time(refusing.bound)}, for the {refusing.what}",
                f'dt = "auto", or dt = "{0.99e6 * refusing.bound:.3g} us"',
            )
    interval = case.duration / samples
    every = math.ceil(min(interval / longest * (1 - 1e-12), 2.0 * MOST_STEPS))
    if every * samples > MOST_STEPS:
        raise _uncountable(case, longest, given=method.dt != "auto")
    shortest = min((limit for limit in found if limit.is_contact), key=lambda limit: limit.duration)
    return Step(interval / every, every, every * samples, tightest, shortest, speeds)


def _uncountable(case: Case, dt: float, *, given: bool) -> Hint:
    """What is said of a step of which more are needed than the core can count."""
    steps = Decimal(case.duration) / Decimal(dt)
    return Hint(
        f"{'' if given else 'the automatic '}dt = {dt:.3g} s is too short: the run would take {steps:.2e} steps, "
        f"and at most {MOST_STEPS:.2e} can be counted",
        'dt = "auto"' if given else "a larger fraction, or a shorter duration",
    )


def outcome(
    case: Case,
    tables: Sequence[ContactTable],
    step: Step,
    overlaps: Sequence[float],
    speeds: Sequence[float],
    effects: Sequence[Effect] = (),
) -> tuple[dict[str, float], list[str]]:
    """Return diagnostics and notes on a step, after the run.

    Parameters
    ----------
    case, tables, step
        As for `choose_step`, and what it returned.
    overlaps
        Largest overlap over the smaller radius, in each damper.
    speeds
        Largest approach speed at a first touch, in each damper [m/s].
    effects
        Effect of softening on each damper.
    """
    dampers = case.particle_dampers
    shortest = min(
        (
            limit
            for damper, table, speed in zip(dampers, tables, speeds, strict=True)
            for limit in contact_limits(case, damper, table, speed, 1.0)
        ),
        key=lambda limit: limit.duration,
    )
    steps = shortest.duration / step.dt
    diagnostics = {
        "step": step.dt,
        "longest_automatic_step": step.limit.step,
        "expected_approach_speed": max(step.speeds),
        "largest_approach_speed": max(speeds),
        "steps_per_contact": steps,
        "largest_overlap": max(overlaps),
    }
    if effects:
        diagnostics |= {
            "softening": max(effect.softening for effect in effects),
            "bed_resonance": min(effect.resonance for effect in effects),
            "softening_change": max(effect.change for effect in effects),
            "enduring_share": max(effect.share for effect in effects),
            "softened_enduring_share": max(effect.share if effect.softening > 1 else 0.0 for effect in effects),
        }
    notes = [_limited(case, step), *_softened(case)]
    warned = warnings_of(diagnostics)
    if "few_steps" in warned:
        notes.append(
            f"warning: only {steps:.3g} steps in the shortest contact, that of {shortest.what.removeprefix('contact of ')}; "
            f"at least {FEWEST_STEPS:g} are good"
        )
    notes.extend(_averaged(case, step))
    for index, effect in enumerate(effects):
        notes += effect.warnings(f" in {dampers[index].label(index)}" if len(dampers) > 1 else "")
    for index, (damper, overlap) in enumerate(zip(dampers, overlaps, strict=True)):
        if overlap > MOST_OVERLAP:
            where = f" in {damper.label(index)}" if len(dampers) > 1 else ""
            notes.append(
                f"warning: overlaps{where} reach {100 * overlap:.3g} % of the radius, and should stay below "
                f"{100 * MOST_OVERLAP:g} %: "
                + ("less softening or a stiffer contact" if damper.softening_factor > 1 else "a stiffer contact")
            )
    return diagnostics, notes


def _averaged(case: Case, step: Step) -> Iterator[str]:
    """State what the fastest mode loses of records, which act with their means over steps."""
    fastest = math.sqrt(max(case.modes.stiffness, default=0.0)) / (2 * math.pi)
    lost = 1 - float(np.sinc(fastest * step.dt))
    if lost > MOST_AVERAGED and any(isinstance(signal, Sampled) for signal in (*case.loads, *case.base_acceleration())):
        shorter = 0.9 * math.sqrt(6 * MOST_AVERAGED) / (math.pi * fastest)  # also when it is rounded
        yield (
            f"warning: a record acts with its mean over each step, which takes {100 * lost:.2g} % of the amplitude"
            f" at {fastest:.4g} Hz, the fastest mode; up to {100 * MOST_AVERAGED:g} % is allowed; try: a step of"
            f" {shorter:.2g} s"
        )


def warnings_of(diagnostics: Mapping[str, float]) -> list[str]:
    """Return in what a run left its bounds, names of `WARNINGS`.

    Parameters
    ----------
    diagnostics
        From `outcome`.
    """
    steps = diagnostics["steps_per_contact"]
    found = (
        math.isfinite(steps) and steps < FEWEST_STEPS,
        diagnostics["largest_overlap"] > MOST_OVERLAP,
        diagnostics.get("softening_change", 0.0) > MOST_CHANGE,
        diagnostics.get("softened_enduring_share", 0.0) > MOST_ENDURING,
    )
    return [name for name, is_so in zip(WARNINGS, found, strict=True) if is_so]


def largest_softening(case: Case, damper: ParticleDamper, speed: float) -> float:
    """Return the softening at which the overlaps of a damper that is not softened reach `MOST_OVERLAP`.

    Parameters
    ----------
    case, damper
        The case, and one of its dampers.
    speed
        Largest approach speed to expect [m/s].
    """
    smallest, table = float(damper.contents.radius.min()), damper.contact_table
    longest = max((limit.duration for limit in contact_limits(case, damper, table, speed, 1.0)), default=0.0)
    overlap = speed * longest / HERTZ_TIME / smallest if math.isfinite(longest) else 0.0
    return (MOST_OVERLAP / overlap) ** 2 if overlap else math.inf


def _limited(case: Case, step: Step) -> str:
    """What the step is, and what limits it: steps are no longer than samples are apart."""
    method = instance(case.method, Dem)
    told = f"step {_time(step.dt)}, "
    if method.dt == "auto":
        longest, why = step.limit.step, f"the {step.limit.what}"
        limited, else_ = f"limited by {why}", f"for {why}"
    else:
        longest = float(method.dt)
        limited = else_ = f"as given; an automatic one would be limited by the {step.limit.what}"
    if step.every == 1 and step.dt < (1 - 1e-9) * longest:
        return f"{told}limited by the samples; without them {_time(longest)}, {else_}"
    return told + limited


def _softened(case: Case) -> list[str]:
    """What softening does, told once for all dampers that are alike."""
    told: dict[str, list[str]] = {}
    for index, damper in enumerate(case.particle_dampers):
        exponents = {exponent_of_force(entry.contact) for entry in damper.contact_table.entries}
        factors = {damper.softening_factor ** (1 / (exponent + 1)) for exponent in exponents}
        many = " and ".join(f"{factor:.3g}" for factor in sorted(factors))
        does = f"contacts last {many} times as long, and overlap {many} times as much"
        softening = damper.softening_factor
        what = f"moduli are divided by {softening:g}: {does}" if softening > 1 else ""
        told.setdefault(what, []).append(damper.label(index))
    whose = len(told) > 1
    return [f"{', '.join(names)}: {what}" if whose else what for what, names in told.items() if what]


def _time(seconds: float) -> str:
    from rattlebox.results.quantities import quantity

    return quantity(seconds, "s", 3) if math.isfinite(seconds) else "for ever"
