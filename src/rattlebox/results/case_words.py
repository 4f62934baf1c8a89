"""Phrases that describe the parts of a case: "an oscillator of 20 kg at 10.07 Hz", "a steel ball of 1.2 kg"."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rattlebox.model.beams import Beam
from rattlebox.model.dampers import ImpactDamper
from rattlebox.model.harmonics import Harmonic, SineSweep
from rattlebox.model.plates import Plate
from rattlebox.model.random_vibration import Random
from rattlebox.model.recorded import Record
from rattlebox.model.shear_buildings import ShearBuilding
from rattlebox.model.shocks import HalfSine, Shock
from rattlebox.model.signals import Sampled
from rattlebox.model.structures import SDOF, Fixed, Shaker

from .quantities import amount, in_unit

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.model.particle_damper import ParticleDamper
    from rattlebox.model.signals import Signal

_CAVITIES = {"box": "a box", "cylinder": "a cylinder", "sphere": "a sphere"}
_FORCES = {"N": "force", "m/s^2": "acceleration", "m": "displacement"}


def joined(items: Sequence[str]) -> str:
    """Return phrases in one list: "a, b and c".

    Parameters
    ----------
    items
        Phrases.
    """
    return " and ".join([", ".join(items[:-1]), items[-1]] if len(items) > 1 else items)


def counted(number: int, noun: str, plural: str = "") -> str:
    """Return a number with a noun: "1 mode", "5 modes", "12 000 particles".

    Parameters
    ----------
    number
        Count.
    noun
        Noun in the singular.
    plural
        Its plural; default with an s.
    """
    return f"{number:,} ".replace(",", "\N{NO-BREAK SPACE}") + (noun if number == 1 else plural or f"{noun}s")


def natural_frequencies(case: Case) -> tuple[float, ...]:
    """Return the natural frequencies of the structure, without rigid-body modes [Hz].

    Parameters
    ----------
    case
        The case.
    """
    stiffness = np.asarray(case.structure.modes().stiffness)
    return tuple((np.sqrt(stiffness[stiffness > 0]) / (2 * math.pi)).tolist())


def structure_words(case: Case) -> str:
    """Return a phrase about the structure.

    Parameters
    ----------
    case
        The case.
    """
    structure, frequencies = case.structure, natural_frequencies(case)
    if isinstance(structure, Shaker):
        return f"a shaker with {joined([signal_words(signal) for signal in structure.motion])}"
    if isinstance(structure, Fixed):
        return "a fixed cavity"
    if isinstance(structure, SDOF):
        mass = amount(structure.mass, "kg")
        return f"an oscillator of {mass} at {amount(frequencies[0], 'Hz')}" if frequencies else f"a free mass of {mass}"
    first = f", first mode at {amount(frequencies[0], 'Hz')}" if frequencies else ""
    if isinstance(structure, Beam):
        material = f"{_material(structure.material)} " if structure.material else ""
        return f"a {structure.ends} {material}beam of {amount(structure.length, 'm')}{first}"
    if isinstance(structure, Plate):
        material = f"{_material(structure.material)} " if structure.material else ""
        return f"a simply supported {material}plate of {sizes_words((structure.length, structure.width))}{first}"
    if isinstance(structure, ShearBuilding):
        return f"a building of {counted(len(structure.masses), 'storey')}{first}"
    return f"a structure of {counted(len(structure.modes().stiffness), 'mode')}{first}"


def damper_words(damper: ImpactDamper | ParticleDamper) -> str:
    """Return a phrase about a damper: its balls or particles, and their cavity.

    Parameters
    ----------
    damper
        The damper.
    """
    if isinstance(damper, ImpactDamper):
        mass, count = float(np.sum(damper.masses)), len(damper.balls)
        materials = list(dict.fromkeys(_material(ball.material) for ball in damper.balls))
        one = f"{_article(materials[0])} ball of {amount(mass, 'kg')}"
        several = f"a row of {count} {joined(materials)} balls of {amount(mass, 'kg')} in all"
        return f"{one if count == 1 else several} with {amount(damper.clearance, 'm')} of clearance"
    contents = damper.contents
    materials = list(dict.fromkeys(_material(each.material) for each in damper.particles))
    count, mass = len(contents.radius), float(contents.mass.sum())
    size = f"{amount(2 * float(contents.radius.min()), 'm')}"
    if not np.isclose(contents.radius.min(), contents.radius.max()):
        size += f" to {amount(2 * float(contents.radius.max()), 'm')}"
    balls = counted(count, f"{joined(materials)} ball")
    return f"{balls} of {size} ({amount(mass, 'kg')}) in {cavity_words(damper)}"


def cavity_words(damper: ParticleDamper) -> str:
    """Return a phrase about the cavity of a particle damper with its sizes.

    Parameters
    ----------
    damper
        The damper.
    """
    cavity = damper.cavity
    name = _CAVITIES[cavity.kind]
    if cavity.kind == "box":
        return f"{name} of {sizes_words(cavity.lengths.tolist())}"
    diameter = f"{amount(float(cavity.lengths[0]), 'm')} in diameter"
    length = f", {amount(float(cavity.lengths[2]), 'm')} long" if cavity.kind == "cylinder" else ""
    return f"{name}, {diameter}{length}"


def each_damper(case: Case) -> tuple[ImpactDamper | ParticleDamper, ...]:
    """Return all dampers of a case, each of several identical ones on its own.

    Parameters
    ----------
    case
        The case.
    """
    return (*case.impact_dampers, *case.particle_dampers)


def dampers_words(case: Case) -> str:
    """Return a phrase about all dampers and tuned masses of a case; empty if there are none.

    Parameters
    ----------
    case
        The case.
    """
    phrases = [damper_words(damper) for damper in each_damper(case)]
    phrases += [
        f"a tuned mass of {amount(part.mass, 'kg')} at {amount(part.frequency, 'Hz')}" for part in case.tuned_masses
    ]
    counts = {phrase: phrases.count(phrase) for phrase in phrases}
    return joined([phrase if count == 1 else f"{count} times {phrase}" for phrase, count in counts.items()])


def signal_words(signal: Signal) -> str:
    """Return a phrase about a load or a motion.

    Parameters
    ----------
    signal
        The signal.
    """
    unit = signal.unit or ""
    what = _FORCES.get(unit, "signal")
    if isinstance(signal, Harmonic):
        return f"a harmonic {what} of {amount(abs(signal.amplitude), unit)} at {amount(signal.frequency, 'Hz')}"
    if isinstance(signal, SineSweep):
        ends = f"{amount(signal.first_frequency, 'Hz')} to {amount(signal.last_frequency, 'Hz')}"
        return f"a sine sweep of {what} from {ends}"
    if isinstance(signal, Shock):
        shape = "half-sine" if isinstance(signal, HalfSine) else signal.kind.replace("_", "-")
        return f"a {shape} pulse of {amount(abs(signal.amplitude), unit)} for {amount(signal.duration, 's')}"
    if isinstance(signal, Random):
        return f"random {what}"
    if isinstance(signal, Record):
        return f"a record of {what}"
    return f"a sampled {what}" if isinstance(signal, Sampled) else f"a {signal.kind.replace('_', ' ')} {what}"


def loads_words(case: Case) -> str:
    """Return a phrase about the loads and the motion of the base; empty if there are none.

    Parameters
    ----------
    case
        The case.
    """
    loads = [signal_words(signal) for signal in case.loads]
    base = [f"{signal_words(signal)} of the base" for signal in case.base]
    return joined([*loads, *base])


def sizes_words(lengths: Sequence[float]) -> str:
    """Return lengths in the unit of the smallest one: "100 x 70 x 60 mm".

    Parameters
    ----------
    lengths
        Edges [m].
    """
    divisor, unit = in_unit(min(lengths), "m")
    return f"{' x '.join(amount(length / divisor) for length in lengths)} {unit}"


def _material(material: object) -> str:
    return str(getattr(material, "name", "")).replace("_", " ")


def _article(noun: str) -> str:
    return f"{'an' if noun[:1] in tuple('aeiou') else 'a'} {noun}".rstrip()
