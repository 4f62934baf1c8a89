"""The paper's system under a harmonic load, which the paper leaves for later."""

from __future__ import annotations

from collections.abc import Sequence

from rattlebox.model.case import Case
from rattlebox.model.contacts import Contact
from rattlebox.model.methods import EventDriven, Newton
from rattlebox.model.signals import Harmonic

from .seed import CONSTANT, seed_case


def harmonic_case(
    contact: Contact = CONSTANT,
    *,
    amplitude: float,
    frequency: float,
    start: float = 0.0,
    gravity: float = 0.0,
    duration: float = 10.0,
    times: Sequence[float] | None = None,
    rate: float | None = None,
    method: EventDriven | Newton | None = None,
    ball: bool = True,
    name: str = "",
) -> Case:
    """Return the paper's system, at rest until a sine pulls at the structure.

    Parameters
    ----------
    contact
        Contact law: CONSTANT, PLASTIC, PLASTIC_RIGID, or any other.
    amplitude, frequency
        Of the load [N], [Hz].
    start
        Reduced start position of the ball, -1 to 1.
    gravity
        Along the line, with sign [m/s^2].
    duration
        Of the run [s].
    times, rate
        Output times [s], or samples a second [Hz]; default 2001 samples.
    method
        Default event-driven.
    ball
        False leaves the damper out.
    name
        Of the case.
    """
    case = seed_case(
        contact, start=start, duration=duration, times=times, rate=rate, method=method, ball=ball, name=name
    )
    changes = {
        "loads": (Harmonic(amplitude=amplitude, frequency=frequency, unit="N"),),
        "dampers": tuple(damper.model_copy(update={"gravity": gravity}) for damper in case.dampers),
    }
    return case.model_copy(update=changes)
