"""Plausibility checks: valid cases with a likely slip, such as a missing unit, a too heavy damper or a late load."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.quantities import amount

from .dampers import ImpactDamper
from .elementwise import Vector
from .harmonics import Harmonic, SineSweep
from .materials import Material
from .random_vibration import Random
from .recorded import Record
from .shocks import Shock
from .signals import Sampled, Signal
from .space import Direction, unit_vector
from .structures import Shaker
from .units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from .case import Case
    from .modes import ModalModel
    from .particle_damper import ParticleDamper

_LARGEST_BODY = 1.0  # m
_FARTHEST = 10.0  # m, of a cavity from its axis or point
_LARGEST_FRICTION = 3.0
_LEAST_PARTICIPATION = 1e-3
"""Participation times shape, from which a base excites a mode: the response of a rigid structure is 1."""
_LEAST_EFFECTIVE_SHARE = 0.2
"""Sum of the effective masses of the modes over the total mass, below which there is a warning."""
_FEWEST_SAMPLES = 4.0  # per period
_LARGEST_DAMPING_RATIO = 0.5  # also 0.5 % without its sign
_SMALLEST_MODULUS = 1e5  # Pa
_FEWEST_POINTS = 64  # a record with fewer points is a polyline, not a sampled signal
_BANDS = 2048
_LARGEST_CHANGE = 0.02  # of the response of a mode
_LONGEST_RECORD = 100.0  # in durations of the run
_PEAKS = {"m/s^2": (1e-5, 1e5, 100.0), "m": (1e-9, 10.0, 1.0)}
"""Least and largest plausible peak of a motion of the base, the latter also if the unit of a record is assumed."""
_LARGEST_DENSITY = 1.0
"""Largest density of usual random vibration [g^2/Hz]."""
_USUAL_RANDOM = 0.1, 50.0
"""Least and largest root mean square of usual random vibration [g]."""
_FASTEST_SHAKER = 10.0  # m/s; shakers reach 3 m/s
_ROUNDING = 1 + 1e-9  # of an amplitude that is exactly at a limit
_PERPENDICULAR = 1e-6
"""Cosine of an angle, or excitation of a mode relative to the largest one, below which it counts as zero."""
_SMALLEST_FILL_RATIO = 1e-4
_DENSITIES = 5.0, 25e3  # kg/m^3


def plausibility_notes(case: Case, *, signals: bool = True) -> tuple[str, ...]:
    """Return notes on assumed units and warnings about numbers that are likely slips."""
    dampers = (
        warning
        for index, damper in enumerate(case.dampers)
        for warning in _check_damper(case, damper, " ".join(damper.label(index).split()))
    )
    room = (
        f"{damper.label(index)}: {note.removeprefix('warning: ')}"
        for index, damper in enumerate(case.particle_dampers)
        for note in damper.interior.notes(float(damper.contents.radius.min()))
        if note.startswith("warning: ")
    )
    distant = (warning for damper, places in case.cell_groups for warning in _check_places(damper, places))
    loads = (*_check_amplitudes(case), *(_check_signals(case) if signals else ()))
    warnings = (*_check_structure(case), *loads, *dampers, *_check_packings(case), *distant, *room)
    about_structure = (*case.structure.notes(), *(case.structure.base_notes() if case.base else ()))
    notes = (*(f"note: {note}" for note in about_structure), *_note_assumptions(case))
    return (*notes, *(f"warning: {warning}" for warning in warnings))


def _named_signals(case: Case) -> list[tuple[str, Signal]]:
    return [
        (f"{field} {number}" if len(part) > 1 else field, signal)
        for field, part in (("load", case.loads), ("base", case.base), ("motion", case.shaker_motion))
        for number, signal in enumerate(part, 1)
    ]


def _note_assumptions(case: Case) -> Iterator[str]:
    """Yield the notes of signals and packings, such as units that are assumed for files, and the resulting peaks."""
    for name, signal in _named_signals(case):
        yield from (f"note: {name}: {note}" for note in signal.notes())

    for index, damper in enumerate(case.particle_dampers):
        name = " ".join(damper.label(index).split())
        room = damper.interior.notes(float(damper.contents.radius.min()))
        yield from (
            f"note: {name}: {note}" for note in (*damper.packing.notes(), *room) if not note.startswith("warning: ")
        )


def _check_amplitudes(case: Case) -> Iterator[str]:
    """Yield a warning for each motion of the base or of a shaker whose amplitude or density suggests another unit."""
    for name, signal in _named_signals(case):
        if isinstance(signal, Random) and signal.unit_is_assumed and signal.unit in _PEAKS:
            yield from _check_density(name, signal)
        amplitude = getattr(signal, "amplitude", None)
        if amplitude is None or signal.unit not in _PEAKS:
            continue
        what, most = "", _PEAKS["m/s^2"][1]
        if isinstance(signal, Harmonic) and signal.unit == "m":
            what = unusual_motion(amplitude, signal.frequency)
        elif abs(amplitude) > most * _ROUNDING:
            what = f"; usual are up to {amount(most, 'm/s^2')}; a number without a unit is in m/s^2 here"
        if what:
            example = '"15 mm" or "15 g"' if isinstance(case.structure, Shaker) else '"15 g"'
            # With its unit, a large amplitude may be meant, such as that of a gun launch.
            yield f"{name} is {signal.words()}{what}; try: check the amplitude, and give it with its unit, such as {example}"


def _check_density(name: str, signal: Random) -> Iterator[str]:
    """Yield a warning if the numbers of a density without a unit are usual ones in g^2/Hz."""
    density, (least, most) = signal.corners[:, 1], _USUAL_RANDOM
    if density.max() <= _LARGEST_DENSITY and least <= signal.rms <= most:
        squared = "(m/s^2)^2" if signal.unit == "m/s^2" else "m^2"
        number = f"{density.max():.3g}"
        yield (
            f"{name} is {signal.words()} of {amount(signal.rms, str(signal.unit), 3)} RMS, since densities without a unit "
            f"are in {squared}/Hz here; in g^2/Hz it would be {signal.rms:.3g} g RMS; try: densities with their unit, "
            f'"{number} g^2/Hz" or "{number} {squared}/Hz"'
        )


def unusual_motion(amplitude: float, frequency: float) -> str:
    """Return a phrase on a harmonic displacement [m] that is too large at a frequency [Hz]; "" if it is usual."""
    # A millimetre that is read as a metre is no large length at a low frequency, but a large speed at usual ones.
    omega, size, most = 2 * np.pi * frequency, abs(amplitude), _PEAKS["m"][1]
    if size <= most * _ROUNDING and omega * size <= _FASTEST_SHAKER * _ROUNDING:
        return ""
    return (
        f", {amount(omega * size, 'm/s')} and {omega**2 * size / STANDARD_GRAVITY:.3g} g; usual are up to"
        f" {amount(most, 'm')} and {amount(_FASTEST_SHAKER, 'm/s')}; a number without a unit is in m here"
    )


def _check_peaks(case: Case) -> Iterator[str]:
    """Yield a warning for each record of the base whose peak suggests another unit."""
    for name, signal in _named_signals(case):
        if not isinstance(signal, Record) or signal.unit not in _PEAKS:
            continue
        peak = signal.peak
        least, most, most_assumed = _PEAKS[signal.unit]
        if not least <= peak <= (most_assumed if signal.unit_is_assumed else most):
            yield (
                f"{name} is a record with a peak of {peak:.4g} {signal.unit}; usual are {least:g} to"
                f" {most_assumed:g} {signal.unit}; try: unit, that of its numbers"
            )


def _check_structure(case: Case) -> Iterator[str]:
    modes = case.structure.modes()  # without tuned masses, which may have any damping
    elastic = modes.stiffness > 0
    ratio = float(np.max(modes.decay[elastic] / np.sqrt(modes.stiffness[elastic]), initial=0.0))
    if ratio >= _LARGEST_DAMPING_RATIO * (1 - 1e-9):
        yield (
            f"the structure's damping ratio is {ratio:.3g}; structures that vibrate have less than "
            f"{_LARGEST_DAMPING_RATIO:g}; a percentage needs its sign: 2 % is 0.02"
        )
    yield from case.structure.warnings()
    yield from _check_participation(case, modes)


def _check_participation(case: Case, modes: ModalModel) -> Iterator[str]:
    """Yield warnings about a base motion with small participation and a force on the base without truncated modes."""
    if not case.base or modes.participation is None or not modes.decay.size:
        return
    participation = modes.participation.reshape(modes.decay.size, 1, -1)
    shapes = [shape.reshape(modes.decay.size, -1, 1) for shape in modes.shapes.values()]
    reach = max((float(np.abs(shape * participation).max()) for shape in shapes), default=0.0)
    if reach < _LEAST_PARTICIPATION:
        yield (
            f"the motion of the base barely excites the modes: participation times shape is at most {reach:.2g}; usual are "
            f"{_LEAST_PARTICIPATION:g} and more; try: other modes, points or direction"
        )
    effective = float(np.max(np.sum(np.square(modes.participation), axis=0)))
    total = None if modes.total_mass is None else float(np.max(modes.total_mass))
    if total is not None and effective < _LEAST_EFFECTIVE_SHARE * total:
        yield (
            f"the effective masses of the modes add up to {effective:.3g} kg, {100 * effective / total:.2g} % of the total"
            f" mass; usual are {100 * _LEAST_EFFECTIVE_SHARE:g} % and more; try: participation with its unit, such as"
            ' "-0.07 t^0.5", or further modes'
        )
    if total is None:
        yield (
            f"the force on the base lacks the inertia of truncated modes; the modes of the case have {effective:.4g} kg;"
            " try: total_mass, the mass of the structure"
        )


def _check_signals(case: Case) -> Iterator[str]:
    signals = _named_signals(case)
    for name, signal in signals:
        if isinstance(signal, (Shock, Harmonic, SineSweep)) and signal.start >= case.duration:
            yield f"{name} begins at {signal.start:.4g} s, after the end of the run at {case.duration:.4g} s"
    for name, signal in signals:
        if isinstance(signal, Record) and signal.times[-1] - signal.times[0] > _LONGEST_RECORD * case.duration:
            yield (
                f"{name} is a record of {signal.times[-1] - signal.times[0]:.4g} s, but the run simulates only"
                f" {case.duration:.4g} s; the times of a record are in seconds"
            )
    for name, signal in signals:
        if isinstance(signal, SineSweep) and signal.start < case.duration < (signal.start + signal.length) * (1 - 1e-6):
            yield (
                f"{name} is a sweep of {signal.length:.4g} s from {signal.first_frequency:.4g} Hz to"
                f" {signal.last_frequency:.4g} Hz; the run ends at {float(signal.frequency_at(case.duration)):.4g} Hz"
            )
    yield from _check_peaks(case)
    yield from _check_interpolation(case)
    yield from _check_directions(case)
    if case.output.rate is None:
        return
    stiffness = case.modes.stiffness[case.modes.stiffness > 0]
    periods = [(f"{name}, at {s.frequency:.4g} Hz,", s.frequency) for name, s in signals if isinstance(s, Harmonic)]
    if stiffness.size:
        lowest = float(np.sqrt(stiffness.min())) / (2 * np.pi)
        periods.append((f"the structure's lowest mode, at {lowest:.4g} Hz,", lowest))
    label, frequency = max(periods, key=lambda period: period[1], default=("", 0.0))
    if case.output.rate < _FEWEST_SAMPLES * frequency:
        yield (
            f"output.rate is {case.output.rate:.4g} Hz, {case.output.rate / frequency:.3g} samples in a period of {label}"
            f" which is too few for figures and spectra of the motion; at least {_FEWEST_SAMPLES:g} are needed;"
            " the run itself is not affected"
        )


def _check_interpolation(case: Case) -> Iterator[str]:
    """Yield a warning for each record whose straight lines between samples change the response of a mode."""
    modes = case.modes
    elastic = np.flatnonzero(modes.stiffness > 0)
    for name, signal in _named_signals(case):
        spectrum = _spectrum(signal) if isinstance(signal, Sampled) and elastic.size else None
        if spectrum is None:
            continue
        if name.startswith("load"):
            excited = np.abs(modes.shape(signal.point, signal.direction))
        else:
            participation = np.ones(modes.decay.size) if modes.participation is None else modes.participation
            excited = np.linalg.norm(participation.reshape(modes.decay.size, -1), axis=1)
        rate, frequency, power = spectrum
        changes = [
            (change_by_interpolation(rate, frequency, power, natural, float(modes.decay[k]) / (2 * np.pi)), natural, k)
            for k in elastic
            if excited[k] > _PERPENDICULAR * excited.max()
            and (natural := float(np.sqrt(modes.stiffness[k])) / (2 * np.pi))
        ]
        change, natural, k = max(changes, key=lambda each: abs(each[0]), default=(0.0, 0.0, 0))
        if abs(change) > _LARGEST_CHANGE:
            yield (
                f"{name} is a record of {rate:.4g} points a second, and the straight lines between them change the response"
                f" of mode {k + 1}, at {natural:.4g} Hz, by {100 * change:+.2g} %; up to {100 * _LARGEST_CHANGE:g} % is"
                f" allowed; try: the record resampled to {16 * min(natural, 0.5 * rate):.6g} Hz"
                " (scipy.signal.resample_poly)"
            )


def _spectrum(record: Sampled) -> tuple[float, Vector, Vector] | None:
    """Return the sampling rate of a record [Hz], bands [Hz] and their power; None if it is not evenly sampled."""
    times, values = record.polyline()
    step = (times[-1] - times[0]) / (times.size - 1)
    if times.size < _FEWEST_POINTS or np.max(np.abs(np.diff(times) - step)) > 1e-3 * step:
        return None
    # The Fourier series repeats the record. A step between its end and its beginning would add power at all frequencies.
    values = values - np.linspace(values[0], values[-1], values.size)
    power = np.abs(np.fft.rfft(values[:-1]))[1:] ** 2
    if not power.any():
        return None
    begins = np.unique(np.linspace(0, power.size, _BANDS, endpoint=False).astype(int))
    ends = np.append(begins[1:], power.size)
    return 1 / step, 0.5 * (begins + ends + 1) / (step * (times.size - 1)), np.add.reduceat(power, begins)


def change_by_interpolation(rate: float, frequency: Vector, power: Vector, natural: float, decay: float) -> float:
    """Compute the relative change of the RMS response of a mode by straight lines between samples.

    `rate`: sampling rate R [Hz]. `frequency` and `power`: frequencies of the sampled signal [Hz], up to R / 2, and its
    power there, (n,). `natural` and `decay`: natural frequency f_0 and decay rate over 2 pi of the mode [Hz].

    Notes
    -----
    Linear interpolation multiplies the power at f by sinc^4(f / R), and adds images at k R +- f, of sinc^4(k +- f / R) of
    the power. The mode responds with |H|^2 = 1 / ((f_0^2 - f^2)^2 + (2 d f)^2).
    """
    width = max(decay, 0.005 * natural, float(frequency[0]))

    def response(at: Vector) -> Vector:
        return np.asarray(1 / ((natural**2 - at**2) ** 2 + (2 * width * at) ** 2))

    images = range(-2 - int(min(natural / rate, 50.0)), 3 + int(min(natural / rate, 50.0)))
    lines = sum(
        float(power @ (np.sinc(k + frequency / rate) ** 4 * response(np.abs(k * rate + frequency)))) for k in images
    )
    return float(np.sqrt(lines / (power @ response(frequency)))) - 1


def _check_directions(case: Case) -> Iterator[str]:
    """Yield a warning for each base motion perpendicular to the only direction of the structure."""
    particles = [damper for damper in case.particle_dampers if case.modes.point(damper.point) not in case.modes.spatial]
    for number, signal in enumerate(case.base, 1):
        if signal.direction is None or not particles:
            continue
        along = [abs(unit_vector(damper.direction) @ unit_vector(signal.direction)) for damper in particles]
        if max(along) < _PERPENDICULAR:
            name = f"base {number}" if len(case.base) > 1 else "base"
            yield (
                f"{name} moves along {_format(signal.direction)}, but the structure moves along"
                f" {_format(particles[0].direction)}, the direction of {particles[0].label(0)}; check both directions"
            )


def _format(direction: Direction) -> str:
    return direction if isinstance(direction, str) else "({:g}, {:g}, {:g})".format(*direction)


def _check_places(damper: ParticleDamper, places: Vector) -> Iterator[str]:
    """Yield a warning about cells that are far from their point, or from the axis about which they turn."""
    turns = damper.rotation is not None
    away = float(np.linalg.norm(places + (damper.rotation.arm if damper.rotation else 0.0), axis=1).max(initial=0.0))
    if away > _FARTHEST * _ROUNDING:
        what, fields = ("axis", "arm and offsets") if turns else ("point", "offsets")
        yield f"a cavity is {away:.4g} m from its {what}, more than usual; try: check {fields}, and their unit"


def _check_packings(case: Case) -> Iterator[str]:
    """Yield a warning about each damper whose particles begin and move like those of another one."""
    first: dict[tuple[str, ...], str] = {}
    starts = [(damper.point, damper.packing.model_dump_json(warnings=False)) for damper in case.particle_dampers]
    for index, (damper, start) in enumerate(zip(case.particle_dampers, starts, strict=True)):
        if not damper.packing.is_random or starts.count(start) == 1:  # text of a large surface takes long
            continue
        name = " ".join(damper.label(index).split())
        other = first.setdefault(
            (*map(str, start), damper.model_copy(update={"name": ""}).model_dump_json(warnings=False)), name
        )
        if other != name:
            yield (
                f"the particles of {name} have the same random packing as those of {other}, at the same point, and move"
                f" exactly like them; try: another packing.seed, or number = 2 in one damper"
            )


def _check_damper(case: Case, damper: ImpactDamper | ParticleDamper, name: str) -> Iterator[str]:
    materials: list[Material | str | None]
    if isinstance(damper, ImpactDamper):
        body = "ball"
        materials = [*(ball.material for ball in damper.balls), damper.wall]
        diameters = [2 * ball.half for ball in damper.balls]
        mass = float(sum(damper.masses))
        if damper.clearance > 2 * _LARGEST_BODY:
            yield f"the gap of {name} is {damper.clearance / 2:.4g} m, more than usual; check the value and its unit"
    else:
        body = "particle"
        materials = [*(species.material for species in damper.particles), damper.wall]
        diameters = [2 * float(damper.contents.radius.max())]
        mass = float(damper.contents.mass.sum())
        fill_ratio = float(np.sum(4 / 3 * np.pi * damper.contents.radius**3)) / damper.interior.volume
        if 0 < fill_ratio < _SMALLEST_FILL_RATIO:
            yield f"the fill ratio of {name} is {fill_ratio:.2g}, less than usual; check the sizes and their units"
        frictions = [entry.friction.coefficient for entry in damper.contact_table.entries if entry.friction]
        if max(frictions, default=0.0) > _LARGEST_FRICTION:
            yield f"the coefficient of friction in {name} is {max(frictions):g}; a percentage needs its sign: 40 % is 0.4"
    for material in dict.fromkeys(m for m in materials if isinstance(m, Material)):
        label = " ".join(material.name.split()) or "a material"
        if material.young < _SMALLEST_MODULUS:
            yield f"the modulus of {label} in {name} is {material.young:g} Pa, too little for a solid; check its unit"
        if not _DENSITIES[0] <= material.density <= _DENSITIES[1]:
            yield (
                f"the density of {label} in {name}, {material.density:g} kg/m^3, is outside the range of solids"
                f" ({_DENSITIES[0]:g} to {_DENSITIES[1]:g} kg/m^3); check the unit"
            )
    if max(diameters) > _LARGEST_BODY:
        yield f"a {body} of {name} is {max(diameters):.4g} m wide, more than usual; check the value and its unit"
    mobility = case.modes.mobility(damper.point)
    if mass * mobility > 1 and damper.point not in case.modes.attached:  # a box on a spring is lighter than its content
        yield (
            f"the {body}s of {name} have a mass of {mass:.4g} kg, {mass * mobility:.3g} times the effective mass of the"
            " structure at their point; check diameter and density"
        )
