"""Time step of particle runs: its limits before the run, diagnostics and warnings after it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.narrow import instance
from rattlebox.core import _core
from rattlebox.model.contacts import MAX_OVERLAP
from rattlebox.model.errors import Hint
from rattlebox.model.methods import Dem
from rattlebox.model.particle_case import direction_of_base
from rattlebox.prepare.softening import MAX_CHANGE, MAX_ENDURING_SHARE, CavityMotion, Effect, softening_of_overlap

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.model.contact_table import ContactTable, Entry
    from rattlebox.model.particle_damper import ParticleDamper

BOUND = 0.2
"""Longest step over the duration of the shortest contact. The integration of a single Hertz contact is stable up to half of
its duration; a particle with many contacts oscillates up to twice as fast, and friction adds to that."""

RAYLEIGH = 0.2
"""Longest automatic step over the time of a Rayleigh wave along the smallest particle."""

MAX_AVERAGING_LOSS = 0.02
"""Largest relative loss of amplitude at the fastest mode when a record is averaged over steps."""

MIN_STEPS_PER_CONTACT = 20.0
"""Fewest steps in the shortest contact without a warning."""


WARNINGS = {
    "few_steps": f"fewer than {MIN_STEPS_PER_CONTACT:g} steps in the shortest contact",
    "deep_overlap": f"overlaps above {100 * MAX_OVERLAP:g} % of the radius",
    "soft_bed": "softening that lowers the resonance of the bed too close to the excitation",
    "enduring_contacts": f"over {100 * MAX_ENDURING_SHARE:g} % of the loss in enduring contacts, which grows with softening",
    "unsteady": "motion that is not steady, as of a bed that still sinks, or evaluated in less than a turn of the cavity; "
    "try: more cycles to skip, or to evaluate",
}
"""Validity limits that a run can exceed: name and description. Studies test whether a motion is steady, as they know its
cycles; the others follow from the diagnostics of the run."""

HERTZ_TIME = 2.9432752
"""Duration of a Hertz contact times the approach speed over the largest overlap, 4/5 pi^(1/2) Gamma(2/5) / Gamma(9/10).

K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), section 11.4, doi:10.1017/CBO9781139171731."""

MAX_STEPS = 2**63 - 1
"""Most steps of a run: the core counts them in 64-bit integers."""

INSTANTS, GOLDEN = 4096, (math.sqrt(5) - 1) / 2
"""Number and spacing of the times, besides those of the samples, at which speeds are evaluated. The interval between samples
may be a period of the motion; multiples of the golden ratio are in step with no periodic motion."""


@dataclass(frozen=True)
class Limit:
    """A duration that the step must resolve: of a contact, a wave, or a period."""

    duration: float  # Duration [s]
    step: float  # Longest automatic step [s]
    bound: float  # Longest step that is accepted [s]; infinite for any
    what: str
    is_contact: bool = False


@dataclass(frozen=True)
class Step:
    """Time step of a run."""

    dt: float  # Time step [s]
    every: int
    count: int
    limit: Limit
    shortest: Limit
    speeds: tuple[float, ...]  # Largest expected approach speed in each damper [m/s]
    motions: tuple[CavityMotion, ...] = ()


def evaluation_times(case: Case) -> Any:
    """Return the times at which speeds are evaluated, (T,) [s]: those of the samples and `INSTANTS` others."""
    others = case.duration * (np.arange(INSTANTS) * GOLDEN % 1.0)
    return np.union1d(case.sample_times(), others)


def expected_speeds(case: Case, cavity_velocities: list[Any]) -> tuple[float, ...]:
    """Estimate the largest approach speed in each damper.

    `cavity_velocities`: velocity of each cavity without particles at the `evaluation_times`, (T, 3) [m/s]. Returns largest
    expected approach speeds [m/s].

    Notes
    -----
    V = r(v) + r(v_b) + (2 g h)^(1/2) + 2 v_0: the range of the velocity v of the cavity without particles (zero included),
    the range of the velocity v_b of the base, the speed after a fall through the height h of the cavity, and twice the
    largest initial speed v_0 of a particle.
    """
    times = evaluation_times(case)
    base = np.zeros((times.size, 3))
    for signal, acceleration in zip((*case.base, *case.shaker_motion), case.base_acceleration(), strict=True):
        base += np.outer(acceleration.motion(times)[1], direction_of_base(case.particle_dampers, signal))
    speeds = []
    for damper, velocity in zip(case.particle_dampers, cavity_velocities, strict=True):
        fall = damper.fall_speed(case.duration)
        start = 2 * float(np.linalg.norm(damper.start.velocity, axis=1).max())
        rest = np.zeros((1, 3))  # particles at rest relative to the base
        speeds.append(_span(np.vstack([rest, velocity])) + _span(base) + fall + start)
    return tuple(speeds)


def _span(velocity: Any) -> float:
    return float(np.linalg.norm(np.ptp(velocity, axis=0)))


def contact_limits(
    case: Case, damper: ParticleDamper, table: ContactTable, speed: float, fraction: float
) -> Iterator[Limit]:
    """Yield a limit for each kind of pair in a damper: its shortest contact at an approach speed.

    `speed`: approach speed [m/s].

    Notes
    -----
    The automatic step is `fraction` times the duration of the contact of the smallest and largest bodies of a pair, divided
    by 2 zeta if the damping ratio zeta exceeds 1/2; the longest step is `BOUND` times the duration, divided by the larger of
    that factor and that of friction and rolling resistance.
    """
    labels = [species.label for species in damper.particles]
    wall_mass = _wall_mass(case, damper)
    numbers = np.bincount(damper.contents.species, minlength=len(labels))
    for entry in table.entries:
        if entry.names[0] == entry.names[1] and numbers[labels.index(entry.names[0])] < 2:
            continue  # A single particle has no partner of its species.
        reference = pack_normal(damper, entry)
        damped = max(1.0, 2 * _damping_ratio(entry, reference, speed))
        duration, bound, sizes = math.inf, math.inf, ""
        for pair_radius, pair_mass, text in _sizes(damper, entry, wall_mass):
            law = reference.resized(entry.pair.radius, entry.pair.mass, pair_radius, pair_mass)
            time = law.contact_time(speed)
            factor = max(damped, _tangential_factor(damper, entry, law, pair_radius, speed, time))
            bound = min(bound, BOUND * time / factor)
            if time < duration:
                duration, sizes = time, text
        at = f" at {speed:.3g} m/s" if entry.contact.depends_on_speed else ""
        friction = ", with its friction" if bound < 0.5 * BOUND * duration / damped else ""
        what = f"contact of {' and '.join(entry.names)} ({sizes}){at}, {_time(duration)}{friction}"
        yield Limit(duration, min(fraction * duration / damped, 0.5 * bound), bound, what, is_contact=True)


def pack_normal(damper: ParticleDamper, entry: Entry) -> _core.NormalForce:
    """Return the softened normal law of a pair."""
    return _core.normal_law(*damper.softened(entry))


def pack_friction(damper: ParticleDamper, entry: Entry) -> _core.TangentialForce:
    """Return the softened friction law of a pair."""
    return _core.tangential_law(*damper.softened_friction(entry))


def _tangential_factor(
    damper: ParticleDamper, entry: Entry, law: _core.NormalForce, radius: float, speed: float, duration: float
) -> float:
    """Return the factor by which friction and rolling resistance shorten the longest stable step of a contact.

    Spheres that are free to rotate oscillate on a tangential spring with the squared angular frequency 7/2 k_t/m*, compared
    with k/m* along the normal; a rolling spring adds 5/2 of its share of k_t. Steps up to 1.2 over the angular frequency did
    not generate energy in tests. Dashpots use a velocity that is extrapolated from the last two steps, which is stable up to
    1 over their rate: 7/2 c_t/m*, and 5/2 c_r/(m* R*^2).
    """
    tangential = pack_friction(damper, entry)
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
    """Return the smallest effective mass of the structure at the cavity, over all directions [kg]."""
    mobility = np.linalg.norm(case.modes.space_shape(damper.point, damper.direction), 2) ** 2
    return float(1 / mobility) if mobility else math.inf


def _sizes(damper: ParticleDamper, entry: Entry, wall_mass: float) -> Iterator[tuple[float, float, str]]:
    """Yield R*, m* and a description of the pairs of smallest and largest bodies of an entry."""
    labels = [species.label for species in damper.particles]
    extremes = []
    for name in entry.names:
        if name not in labels:
            extremes.append([(math.inf, wall_mass)])
            continue
        of_species = damper.contents.species == labels.index(name)
        radii, masses = damper.contents.radius[of_species], damper.contents.mass[of_species]
        extremes.append([(float(radii[k]), float(masses[k])) for k in {int(radii.argmin()), int(radii.argmax())}])
    for radius, mass in extremes[0]:
        for other_radius, other_mass in extremes[1]:
            diameters = [f"{2e3 * r:.4g} mm" for r in (radius, other_radius) if math.isfinite(r)]
            pair = 1 / (1 / radius + 1 / other_radius), 1 / (1 / mass + 1 / other_mass)
            yield *pair, "diameter " + " and ".join(dict.fromkeys(diameters))


def _damping_ratio(entry: Entry, law: _core.NormalForce, speed: float) -> float:
    """Return the damping ratio of a contact; 0 if its restitution depends on the speed."""
    dashpot = entry.contact.impact_restitution
    restitution = None if dashpot is None else dashpot.constant_value
    if law.needs_restitution and restitution is None:
        return 0.0
    return law.damping_ratio(1.0 if restitution is None else restitution, speed)


def limits(case: Case, tables: list[ContactTable], speeds: tuple[float, ...]) -> list[Limit]:
    """Return the limits of the time step by contacts, Rayleigh waves, modes and loads.

    `speeds`: largest expected approach speed in each damper [m/s].

    Notes
    -----
    A Rayleigh wave along half the circumference of a sphere of radius R takes pi R / ((0.1631 nu + 0.8766) (G / rho)^(1/2)),
    with the softened shear modulus G = E / (2 (1 + nu)). The automatic step is at most `RAYLEIGH` times that, and at most
    the fraction of the method times the period 2 pi / k^(1/2) of each mode, the duration of each pulse and the period of
    each harmonic.

    References
    ----------
    C. Thornton, C. W. Randall, Applications of theoretical contact mechanics to solid particle system simulation, in:
    Micromechanics of Granular Materials, Elsevier (1988) 133-142, ISBN 978-0-444-70523-5.
    """
    fraction = instance(case.method, Dem).fraction
    result: list[Limit] = []
    for damper, table, speed in zip(case.particle_dampers, tables, speeds, strict=True):
        result += contact_limits(case, damper, table, speed, fraction)
        for index, species in enumerate(damper.particles):
            # A law whose duration does not depend on the speed has a spring of its own; waves along the particle do not
            # matter then.
            if not any(entry.contact.depends_on_speed for entry in table.entries if species.label in entry.names):
                continue
            radius = float(damper.contents.radius[damper.contents.species == index].min())
            material = species.material
            # Softened contacts stand for a softer material, in which waves are slower, too.
            shear = material.young / (2 * (1 + material.poisson)) / damper.softening_factor
            wave = (0.1631 * material.poisson + 0.8766) * math.sqrt(shear / material.density)
            time = math.pi * radius / wave
            what = f"Rayleigh wave along {species.label} (diameter {2e3 * radius:.4g} mm), {_time(time)}"
            result.append(Limit(time, RAYLEIGH * time, math.inf, what))
        if damper.rotation is not None and (rate := damper.rotation.largest(case.duration).speed):
            result.append(_motion_limit(2 * math.pi / rate, fraction, "turn of the cavity"))
    for k, stiffness in enumerate(case.modes.stiffness):
        if stiffness > 0:
            result.append(_motion_limit(2 * math.pi / math.sqrt(stiffness), fraction, f"period of mode {k + 1}"))
    for signal in (*case.loads, *case.base_acceleration()):
        if signal.shortest_time is not None:
            time, what = signal.shortest_time
            result.append(_motion_limit(time, fraction, what))
    return result


def _motion_limit(duration: float, fraction: float, what: str) -> Limit:
    return Limit(duration, fraction * duration, BOUND * duration, f"{what}, {_time(duration)}")


def choose_step(case: Case, tables: list[ContactTable], speeds: tuple[float, ...]) -> Step:
    """Choose the time step of a run: that of the case or the longest automatic one, shortened so that samples fall on steps.

    `speeds`: largest expected approach speed in each damper [m/s].
    """
    method = instance(case.method, Dem)
    all_limits = limits(case, tables, speeds)
    tightest = min(all_limits, key=lambda limit: limit.step)
    samples = case.even_samples()
    if method.dt == "auto":
        longest = tightest.step
    else:
        longest = float(method.dt)
        strictest = min(all_limits, key=lambda limit: limit.bound)
        if longest > strictest.bound:
            raise Hint(
                f"dt = {_time(longest)} is too long: the bound is {_time(strictest.bound)}, for the {strictest.what}",
                f'dt = "auto", or dt = "{0.99e6 * strictest.bound:.3g} us"',
            )
    interval = case.duration / samples
    every = math.ceil(min(interval / longest * (1 - 1e-12), 2.0 * MAX_STEPS))
    if every * samples > MAX_STEPS:
        raise _too_many_steps(case, longest, is_chosen=method.dt != "auto")
    shortest = min((limit for limit in all_limits if limit.is_contact), key=lambda limit: limit.duration)
    return Step(interval / every, every, every * samples, tightest, shortest, speeds)


def _too_many_steps(case: Case, dt: float, *, is_chosen: bool) -> Hint:
    """Return the error for a step of which a run needs more than `MAX_STEPS`."""
    steps = Decimal(case.duration) / Decimal(dt)
    return Hint(
        f"{'' if is_chosen else 'the automatic '}dt = {dt:.3g} s is too short: the run would take {steps:.2e} steps, "
        f"and at most {MAX_STEPS:.2e} can be counted",
        'dt = "auto"' if is_chosen else "a larger fraction, or a shorter duration",
    )


def step_diagnostics(
    case: Case,
    tables: Sequence[ContactTable],
    step: Step,
    overlaps: Sequence[float],
    speeds: Sequence[float],
    effects: Sequence[Effect] = (),
) -> tuple[dict[str, float], list[str]]:
    """Return diagnostics and notes on the time step after the run.

    `speeds`: largest approach speed at a first touch, in each damper [m/s].
    """
    dampers = case.particle_dampers
    # The shortest contact at the speeds that have occurred, instead of those expected before the run.
    shortest = min(
        (
            limit
            for damper, table, speed in zip(dampers, tables, speeds, strict=True)
            for limit in contact_limits(case, damper, table, speed, 1.0)
        ),
        key=lambda limit: limit.duration,
    )
    # With the speeds that have occurred, instead of those expected before the run.
    steps = shortest.duration / step.dt
    diagnostics = {
        "step": step.dt,
        "longest_automatic_step": step.limit.step,
        "expected_approach_speed": max(step.speeds),
        "largest_approach_speed": max(speeds),
        "steps_per_contact": steps,
        "largest_overlap": max(overlaps),
    }
    # Softening is judged for each damper; a run has one number for all of them, the worst.
    if effects:
        diagnostics |= {
            "softening": max(effect.softening for effect in effects),
            "bed_resonance": min(effect.resonance for effect in effects),
            "softening_change": max(effect.change for effect in effects),
            "enduring_share": max(effect.share for effect in effects),
            "softened_enduring_share": max(effect.share if effect.softening > 1 else 0.0 for effect in effects),
        }
    notes = [_step_note(case, step), *_softening_notes(case)]
    # Notes follow from the same numbers and limits as the flags of a study, so that both agree.
    warned = exceeded_limits(diagnostics)
    if "few_steps" in warned:
        notes.append(
            f"warning: only {steps:.3g} steps in the shortest contact, that of {shortest.what.removeprefix('contact of ')}; "
            f"it should have at least {MIN_STEPS_PER_CONTACT:g}; try: a step of "
            f"{0.9 * shortest.duration / MIN_STEPS_PER_CONTACT:.2g} s"
        )
    notes.extend(_averaging_warnings(case, step))
    for index, effect in enumerate(effects):
        notes += effect.warnings(f" in {dampers[index].label(index)}" if len(dampers) > 1 else "")
    for index, (damper, overlap) in enumerate(zip(dampers, overlaps, strict=True)):
        if overlap > MAX_OVERLAP:
            where = f" in {damper.label(index)}" if len(dampers) > 1 else ""
            notes.append(
                f"warning: overlaps{where} reach {100 * overlap:.3g} % of the radius; they should stay below "
                f"{100 * MAX_OVERLAP:g} %; try: "
                + ("less softening or a stiffer contact" if damper.softening_factor > 1 else "a stiffer contact")
            )
    return diagnostics, notes


def _averaging_warnings(case: Case, step: Step) -> Iterator[str]:
    """Yield a warning if averaging a record over steps reduces it too much at the fastest mode."""
    fastest = math.sqrt(max(case.modes.stiffness, default=0.0)) / (2 * math.pi)
    lost = 1 - float(np.sinc(fastest * step.dt))
    if lost > MAX_AVERAGING_LOSS and any(signal.is_sampled for signal in (*case.loads, *case.base_acceleration())):
        # The factor 0.9 leaves room for the rounding in the message.
        shorter = 0.9 * math.sqrt(6 * MAX_AVERAGING_LOSS) / (math.pi * fastest)
        yield (
            f"warning: a record acts with its mean over each step, which removes {100 * lost:.2g} % of the amplitude"
            f" at {fastest:.4g} Hz, the fastest mode; up to {100 * MAX_AVERAGING_LOSS:g} % is allowed; try: a step of"
            f" {shorter:.2g} s"
        )


def exceeded_limits(diagnostics: Mapping[str, float]) -> list[str]:
    """Return the names of the validity limits that the run exceeded (see `WARNINGS`)."""
    steps = diagnostics["steps_per_contact"]
    exceeded = {
        "few_steps": math.isfinite(steps) and steps < MIN_STEPS_PER_CONTACT,
        "deep_overlap": diagnostics["largest_overlap"] > MAX_OVERLAP,
        "soft_bed": diagnostics.get("softening_change", 0.0) > MAX_CHANGE,
        "enduring_contacts": diagnostics.get("softened_enduring_share", 0.0) > MAX_ENDURING_SHARE,
    }
    return [name for name, is_exceeded in exceeded.items() if is_exceeded]


def largest_softening(case: Case, damper: ParticleDamper, speed: float) -> float:
    """Return the softening at which the overlaps in a damper reach `MAX_OVERLAP`.

    `speed`: largest expected approach speed [m/s].

    Notes
    -----
    A Hertz contact of duration t has the overlap V t / 2.943. The duration, and with it the overlap, grows with the
    softening s as s^(2/5) for Hertz contacts and s^(1/2) for linear ones; the result, (`MAX_OVERLAP` / overlap)^2, uses the
    latter, which is smaller. The overlap at the floor of a bed at rest in the strongest field of the run stays below the
    limit, too.
    """
    smallest, table = float(damper.contents.radius.min()), damper.contact_table
    longest = max((limit.duration for limit in contact_limits(case, damper, table, speed, 1.0)), default=0.0)
    overlap = speed * longest / HERTZ_TIME / smallest if math.isfinite(longest) else 0.0
    by_impacts = (MAX_OVERLAP / overlap) ** 2 if overlap else math.inf
    pressed = softening_of_overlap(damper, damper.strongest_field(case.duration), MAX_OVERLAP * smallest)
    return min(by_impacts, pressed)


def _step_note(case: Case, step: Step) -> str:
    """Return a note on the step and its limit, which may be the interval between samples."""
    method = instance(case.method, Dem)
    text = f"step {_time(step.dt)}, "
    if method.dt == "auto":
        longest = step.limit.step
        reason, otherwise = f"limited by the {step.limit.what}", f"for the {step.limit.what}"
    else:
        longest = float(method.dt)
        reason = otherwise = f"as given; an automatic one would be limited by the {step.limit.what}"
    if step.every == 1 and step.dt < (1 - 1e-9) * longest:
        return f"{text}limited by the samples; without them {_time(longest)}, {otherwise}"
    return text + reason


def _softening_notes(case: Case) -> list[str]:
    """Return notes on the effects of softening, one for all dampers with the same effects."""
    dampers_by_note: dict[str, list[str]] = {}
    for index, damper in enumerate(case.particle_dampers):
        exponents = {entry.contact.force_exponent for entry in damper.contact_table.entries}
        factors = {damper.softening_factor ** (1 / (exponent + 1)) for exponent in exponents}
        times = " and ".join(f"{factor:.3g}" for factor in sorted(factors))
        effect = f"contacts last {times} times as long, and overlap {times} times as much"
        softening = damper.softening_factor
        note = f"moduli are divided by {softening:g}: {effect}" if softening > 1 else ""
        dampers_by_note.setdefault(note, []).append(damper.label(index))
    differ = len(dampers_by_note) > 1
    return [f"{', '.join(names)}: {note}" if differ else note for note, names in dampers_by_note.items() if note]


def _time(seconds: float) -> str:
    from rattlebox._util.quantities import quantity

    return quantity(seconds, "s", 3) if math.isfinite(seconds) else "unlimited"
