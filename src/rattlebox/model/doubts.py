"""What a case may be, but is rarely meant to be: units left out, dampers that outweigh the structure, late loads."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .dampers import ImpactDamper
from .elementwise import Vector
from .harmonics import Harmonic, SineSweep
from .materials import Material
from .recorded import Record
from .shocks import Shock
from .signals import Sampled, Signal
from .space import Direction, unit_vector

if TYPE_CHECKING:
    from .case import Case
    from .particle_damper import ParticleDamper

_GRAVITY = 9.80665  # m/s^2
_WIDE = 1.0  # m
_ROUGH = 3.0  # coefficient of friction
_FEW = 4.0  # samples in a period
_OVERDAMPED = 0.5  # damping ratio; half a per cent without its sign
_SOFT = 1e5  # Pa
_SAMPLED = 64  # points, below which a record is taken for a polyline that is meant as such
_BANDS = 2048
_CHANGED = 0.02  # of the response of a mode
_LONG = 100.0  # times what the run takes of a record
_ACROSS = 1e-6
_THIN = 1e-4  # of a cavity
_LIGHT, _HEAVY = 5.0, 25e3  # kg/m^3


def doubts(case: Case, *, signals: bool = True) -> tuple[str, ...]:
    """Return warnings about numbers that are likely slips, without signals those of structure and dampers only."""
    dampers = (
        told
        for index, damper in enumerate(case.dampers)
        for told in _of_damper(case, damper, " ".join(damper.label(index).split()))
    )
    warnings = (*_of_structure(case), *(_of_signals(case) if signals else ()), *dampers)
    notes = (*(f"note: {told}" for told in case.structure.notes()), *_assumed_units(case))
    return (*notes, *(f"warning: {told}" for told in warnings))


def _named_signals(case: Case) -> list[tuple[str, Signal]]:
    return [
        (f"{field} {number}" if len(part) > 1 else field, signal)
        for field, part in (("load", case.loads), ("base", case.base), ("motion", case.shaker_motion))
        for number, signal in enumerate(part, 1)
    ]


def _assumed_units(case: Case) -> Iterator[str]:
    """State the units that were assumed for files without units, and the peaks that follow."""
    for name, signal in _named_signals(case):
        if isinstance(signal, Record) and signal.unit_is_assumed:
            peak = abs(signal.scale) * float(np.max(np.abs(signal.values)))
            in_g = f" = {peak / _GRAVITY:.4g} g" if signal.unit == "m/s^2" else ""
            file = " ".join(Path(signal.file or "").name.split())
            yield (
                f"note: {file}, of {name}, states no unit; {signal.unit} is assumed, with a peak of {peak:.4g} {signal.unit}"
                f"{in_g}; unit and scale set another"
            )


def _of_structure(case: Case) -> Iterator[str]:
    modes = case.structure.modes()  # a tuned mass may be damped as it likes
    swings = modes.stiffness > 0
    ratio = float(np.max(modes.decay[swings] / np.sqrt(modes.stiffness[swings]), initial=0.0))
    if ratio >= _OVERDAMPED * (1 - 1e-9):
        yield (
            f"the structure's damping ratio is {ratio:.3g}; structures that vibrate have less than {_OVERDAMPED:g}; "
            "per cent need their sign: 2 % is 0.02"
        )
    yield from case.structure.warnings()


def _of_signals(case: Case) -> Iterator[str]:
    signals = _named_signals(case)
    for name, signal in signals:
        if isinstance(signal, (Shock, Harmonic, SineSweep)) and signal.start >= case.duration:
            yield f"{name} begins at {signal.start:.4g} s, when the run of {case.duration:.4g} s is over"
    for name, signal in signals:
        if isinstance(signal, Record) and signal.times[-1] - signal.times[0] > _LONG * case.duration:
            yield (
                f"{name} is a record of {signal.times[-1] - signal.times[0]:.4g} s, of which the run takes"
                f" {case.duration:.4g} s; its times are in seconds"
            )
    for name, signal in signals:
        if isinstance(signal, SineSweep) and signal.start < case.duration < (signal.start + signal.length) * (1 - 1e-6):
            yield (
                f"{name} is a sweep of {signal.length:.4g} s from {signal.first_frequency:.4g} Hz to"
                f" {signal.last_frequency:.4g} Hz, which the run ends at {float(signal.frequency_at(case.duration)):.4g} Hz"
            )
    yield from _of_interpolation(case)
    yield from _of_directions(case)
    if case.output.rate is None:
        return
    stiffness = case.modes.stiffness[case.modes.stiffness > 0]
    periods = [(f"{name}, at {s.frequency:.4g} Hz,", s.frequency) for name, s in signals if isinstance(s, Harmonic)]
    if stiffness.size:
        lowest = float(np.sqrt(stiffness.min())) / (2 * np.pi)
        periods.append((f"the structure's lowest mode, at {lowest:.4g} Hz,", lowest))
    what, frequency = max(periods, key=lambda period: period[1], default=("", 0.0))
    if case.output.rate < _FEW * frequency:
        yield (
            f"output.rate is {case.output.rate:.4g} Hz, {case.output.rate / frequency:.3g} samples in a period of {what}"
            " so that figures and spectra of the motion are not true; the run itself is"
        )


def _of_interpolation(case: Case) -> Iterator[str]:
    """State where straight lines between the samples of a record change the response of a mode."""
    modes = case.modes
    swings = np.flatnonzero(modes.stiffness > 0)
    for name, signal in _named_signals(case):
        spectrum = _spectrum(signal) if isinstance(signal, Sampled) and swings.size else None
        if spectrum is None:
            continue
        if name.startswith("load"):
            excited = np.abs(modes.shape(signal.point, signal.direction))
        else:
            participation = np.ones(modes.decay.size) if modes.participation is None else modes.participation
            excited = np.linalg.norm(participation.reshape(modes.decay.size, -1), axis=1)
        rate, frequency, power = spectrum
        changes = [
            (change_by_interpolation(rate, frequency, power, own, float(modes.decay[k]) / (2 * np.pi)), own, k)
            for k in swings
            if excited[k] > _ACROSS * excited.max() and (own := float(np.sqrt(modes.stiffness[k])) / (2 * np.pi))
        ]
        change, own, k = max(changes, key=lambda each: abs(each[0]), default=(0.0, 0.0, 0))
        if abs(change) > _CHANGED:
            yield (
                f"{name} is a record of {rate:.4g} points a second, and the straight lines between them change the response"
                f" of mode {k + 1}, at {own:.4g} Hz, by {100 * change:+.2g} %; up to {100 * _CHANGED:g} % is allowed;"
                f" try: the record resampled to {16 * min(own, 0.5 * rate):.6g} Hz (scipy.signal.resample_poly)"
            )


def _spectrum(record: Sampled) -> tuple[float, Vector, Vector] | None:
    """Return the sampling rate of a record [Hz], bands [Hz] and their power; None of one that is not evenly sampled."""
    times, values = record.polyline()
    step = (times[-1] - times[0]) / (times.size - 1)
    if times.size < _SAMPLED or np.max(np.abs(np.diff(times) - step)) > 1e-3 * step:
        return None
    # Without its end points on one level a record would have a step, which no harmonic of it means.
    values = values - np.linspace(values[0], values[-1], values.size)
    power = np.abs(np.fft.rfft(values[:-1]))[1:] ** 2
    if not power.any():
        return None
    begins = np.unique(np.linspace(0, power.size, _BANDS, endpoint=False).astype(int))
    ends = np.append(begins[1:], power.size)
    return 1 / step, 0.5 * (begins + ends + 1) / (step * (times.size - 1)), np.add.reduceat(power, begins)


def change_by_interpolation(rate: float, frequency: Vector, power: Vector, own: float, decay: float) -> float:
    """Compute how much straight lines between samples change the RMS response of a mode.

    Parameters
    ----------
    rate
        Sampling rate R [Hz].
    frequency, power : (n,) float
        Frequencies of the sampled signal [Hz], up to R / 2, and its power there.
    own, decay
        Natural frequency f_0 and decay rate over 2 pi of the mode [Hz].

    Returns
    -------
    float
        RMS response to the straight lines over that to the band-limited signal, minus one.

    Notes
    -----
    Linear interpolation multiplies the power at f by sinc^4(f / R), and adds images at k R +- f, of sinc^4(k +- f / R) of
    the power. The mode responds with |H|^2 = 1 / ((f_0^2 - f^2)^2 + (2 d f)^2).
    """
    width = max(decay, 0.005 * own, float(frequency[0]))

    def response(at: Vector) -> Vector:
        return np.asarray(1 / ((own**2 - at**2) ** 2 + (2 * width * at) ** 2))

    images = range(-2 - int(min(own / rate, 50.0)), 3 + int(min(own / rate, 50.0)))
    lines = sum(
        float(power @ (np.sinc(k + frequency / rate) ** 4 * response(np.abs(k * rate + frequency)))) for k in images
    )
    return float(np.sqrt(lines / (power @ response(frequency)))) - 1


def _of_directions(case: Case) -> Iterator[str]:
    """Tell of a base that moves across the only direction in which the structure does."""
    particles = [damper for damper in case.particle_dampers if case.modes.point(damper.point) not in case.modes.spatial]
    for number, signal in enumerate(case.base, 1):
        if signal.direction is None or not particles:
            continue
        along = [abs(unit_vector(damper.direction) @ unit_vector(signal.direction)) for damper in particles]
        if max(along) < _ACROSS:
            name = f"base {number}" if len(case.base) > 1 else "base"
            yield (
                f"{name} moves along {_named(signal.direction)}, across the structure, which moves along"
                f" {_named(particles[0].direction)}, the direction of {particles[0].label(0)}"
            )


def _named(direction: Direction) -> str:
    return direction if isinstance(direction, str) else "({:g}, {:g}, {:g})".format(*direction)


def _of_damper(case: Case, damper: ImpactDamper | ParticleDamper, name: str) -> Iterator[str]:
    materials: list[Material | str | None]
    if isinstance(damper, ImpactDamper):
        things = "ball"
        materials = [*(ball.material for ball in damper.balls), damper.wall]
        diameters = [2 * ball.half for ball in damper.balls]
        mass = float(sum(damper.masses))
        if damper.clearance > 2 * _WIDE:
            yield f"the gap of {name} is {damper.clearance / 2:.4g} m; a number without a unit is in metres"
    else:
        things = "particle"
        materials = [*(species.material for species in damper.particles), damper.wall]
        diameters = [2 * float(damper.contents.radius.max())]
        mass = float(damper.contents.mass.sum())
        filled = float(np.sum(4 / 3 * np.pi * damper.contents.radius**3)) / damper.cavity.volume
        if 0 < filled < _THIN:
            yield f"the particles of {name} fill {filled:.2g} of the cavity; a number without a unit is in metres"
        frictions = [entry.friction.coefficient for entry in damper.contact_table.entries if entry.friction]
        if max(frictions, default=0.0) > _ROUGH:
            yield f"the friction in {name} is {max(frictions):g}; per cent need their sign: 40 % is 0.4"
    for material in dict.fromkeys(m for m in materials if isinstance(m, Material)):
        what = " ".join(material.name.split()) or "a material"
        if material.young < _SOFT:
            yield f"the modulus of {what} in {name} is {material.young:g} Pa; a number without a unit is in pascals"
        if not _LIGHT <= material.density <= _HEAVY:
            yield f"the density of {what} in {name} is {material.density:g} kg/m^3, which hardly a solid has"
    if max(diameters) > _WIDE:
        yield f"a {things} of {name} is {max(diameters):.4g} m wide; a number without a unit is in metres"
    ease = float(np.max(np.sum(np.square(case.modes.shapes[case.modes.point(damper.point)]), axis=0), initial=0.0))
    if mass * ease > 1:
        yield (
            f"the {things}s of {name} weigh {mass:.4g} kg, {mass * ease:.3g} times as much as the structure at their point"
        )
