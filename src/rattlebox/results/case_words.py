"""Phrases about all dampers and loads of a case."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rattlebox._util.phrases import joined
from rattlebox._util.quantities import amount

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.model.damper_base import Damper


def each_damper(case: Case) -> tuple[Damper, ...]:
    """Return all dampers of a case, each of several identical ones on its own."""
    return (*case.impact_dampers, *case.particle_dampers)


def dampers_words(case: Case) -> str:
    """Return a phrase about all dampers, tuned masses and stops of a case; empty if there are none."""
    phrases = [damper.words() for damper in each_damper(case)]
    phrases += [
        f"a tuned mass of {amount(part.mass, 'kg')} at {amount(part.frequency, 'Hz')}" for part in case.tuned_masses
    ]
    phrases += [stop.words() for stop in case.stops]
    counts = {phrase: phrases.count(phrase) for phrase in phrases}
    return joined([phrase if count == 1 else f"{count} times {phrase}" for phrase, count in counts.items()])


def loads_words(case: Case) -> str:
    """Return a phrase about the loads and the motion of the base; empty if there are none."""
    loads = [signal.words() for signal in case.loads]
    base = [f"{signal.words()} of the base" for signal in case.base]
    return joined([*loads, *base])
