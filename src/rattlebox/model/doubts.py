"""What a case may be, but is rarely meant to be: units left out, dampers that outweigh the structure, late loads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from .dampers import ImpactDamper
from .materials import Material
from .signals import HalfSine, Harmonic, Record
from .space import Direction, unit_vector

if TYPE_CHECKING:
    from .case import Case
    from .granular import ParticleDamper

_WIDE = 1.0  # m
_ROUGH = 3.0  # coefficient of friction
_FEW = 4.0  # samples in a period
_SOFT = 1e5  # Pa
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
    return tuple(
        f"warning: {told}" for told in (*_of_structure(case), *(_of_signals(case) if signals else ()), *dampers)
    )


def _of_structure(case: Case) -> Iterator[str]:
    modes = case.modes
    swings = modes.stiffness > 0
    ratio = float(np.max(modes.decay[swings] / np.sqrt(modes.stiffness[swings]), initial=0.0))
    if ratio > 1:
        told = f"{ratio:.3g}" if ratio >= 1.005 else "above 1"
        yield f"the structure's damping ratio is {told}, so that it creeps back; per cent need their sign: 2 % is 0.02"


def _of_signals(case: Case) -> Iterator[str]:
    signals = [
        (f"{field} {number}" if len(part) > 1 else field, signal)
        for field, part in (("load", case.loads), ("base", case.base), ("motion", case.shaker_motion))
        for number, signal in enumerate(part, 1)
    ]
    for name, signal in signals:
        if isinstance(signal, (HalfSine, Harmonic)) and signal.start >= case.duration:
            yield f"{name} begins at {signal.start:.4g} s, when the run of {case.duration:.4g} s is over"
    for name, signal in signals:
        if isinstance(signal, Record) and signal.times[-1] - signal.times[0] > _LONG * case.duration:
            yield (
                f"{name} is a record of {signal.times[-1] - signal.times[0]:.4g} s, of which the run takes"
                f" {case.duration:.4g} s; its times are in seconds"
            )
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
