"""How a run can end, each with a sentence on what happened and one on what to try with the method that ran."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rattlebox.engines.core import core

if TYPE_CHECKING:
    from rattlebox.results.ledger import Ledger

STATUSES: tuple[tuple[str, str], ...] = (
    ("finished", "The run reached its end."),
    (
        "law_domain",
        "{contact} was struck at {value:.6g} m/s, above the last speed its restitution law covers, at t = {time:.9g} s.",
    ),
    ("too_many_events", "The budget of events was spent at t = {time:.9g} s, likely by chattering."),
    ("step_too_small", "A contact could not be integrated within the tolerance at t = {time:.9g} s."),
    ("interrupted", "The run was stopped at t = {time:.9g} s; what was computed until then is kept."),
    ("not_finite", "The motion grew beyond all numbers at t = {time:.9g} s."),
    (
        "energy_error",
        "The run reached its end, but its energies do not add up: {value:.2g} of the energy put in is missing or too much. "
        "Do not use its results.",
    ),
    ("escaped", "{contact} left its cavity at {value:.6g} m/s, at t = {time:.9g} s."),
    (
        "no_rebound",
        "{contact} was struck at {value:.6g} m/s, where its restitution law gives no rebound, which no contact with a "
        "dashpot can do, at t = {time:.9g} s.",
    ),
    ("refused", "The case cannot be run as it is."),
)
_NAMES = [name for name, _ in STATUSES]
FINISHED, INTERRUPTED, NOT_FINITE, ENERGY_ERROR, REFUSED = map(
    _NAMES.index, ("finished", "interrupted", "not_finite", "energy_error", "refused")
)

_SIZES = "Check that stiffnesses, masses and speeds are of the sizes you meant."
_ADVICE: dict[str, dict[str, str]] = {
    "law_domain": {
        "": "Use a law that covers it (Thornton, a table), or allow extrapolation (extrapolate = true) knowingly."
    },
    "too_many_events": {
        "": "Raise max_events, shorten the run, or add damping to the contact.",
        "event_driven": "Raise max_events, shorten the run, add damping to the contact, or use the Newton method, which "
        "lets chattering balls stick.",
        "newton": "Raise stick, so that slow impacts end earlier, raise max_events, shorten the run, or use the EventDriven "
        "method, whose contacts take their time.",
    },
    "step_too_small": {"": "Loosen the tolerance. " + _SIZES},
    "no_rebound": {
        "": "Check the law (yield stress, table, extrapolation), use a contact that yields (Thornton), or the Newton "
        "method, whose impacts may be fully plastic.",
        "dem": "Check the law (yield stress, table, extrapolation), or use a contact that yields (Thornton).",
    },
    "not_finite": {
        "": _SIZES,
        "two_step": "Shorten the time steps dt_flight and dt_contact.",
        "dem": "Shorten dt. " + _SIZES,
    },
    "energy_error": {
        "": "Compare with another method.",
        "event_driven": "Lower the tolerance, and compare with another method.",
        "two_step": "Shorten the time steps dt_flight and dt_contact.",
        "dem": "Shorten dt, or the fraction of the shortest contact that it is.",
    },
    "refused": {"": "Run it alone, which says why."},
    "escaped": {"": "Shorten dt, or use a stiffer contact.", "softened": "Shorten dt, or soften the contacts less."},
}
"""What to try, by status and kind of method; "" for every other method, "softened" where contacts are."""


def end_of(ledger: Ledger, bound: float, mass: float) -> int:
    """Return the status of a run that reached its end.

    Parameters
    ----------
    ledger
        Energies of the run.
    bound
        Largest energy residual of a finished run, over the energy put in.
    mass
        Mass of all balls or particles [kg]. A residual below their energy at a nanometre a second is rounding.
    """
    if not np.isfinite(ledger.residual).all():
        return NOT_FINITE
    return FINISHED if ledger.closes(bound, mass * core().speed_at_rest ** 2) else ENERGY_ERROR


def describe(
    status: int, time: float, contact: str, value: float, method: str, *, softened: bool = False
) -> tuple[str, str]:
    """Return the name of a core status, and what happened with what to try.

    Parameters
    ----------
    status
        Number of the core's status (core/util/status.hpp).
    time
        Where the run stopped [s].
    contact
        Name of the contact concerned, if any.
    value
        Approach speed there [m/s], or the closure of a ledger.
    method
        Kind of the method that ran, as in case files.
    softened
        Whether the contacts concerned are softer than their bodies are.
    """
    name, happened = STATUSES[status]
    advice = _ADVICE.get(name, {})
    own = advice.get("softened" if softened and "softened" in advice else method, advice.get("", ""))
    sentences = happened.format(time=time, contact=contact, value=value), own
    return name, " ".join(sentences).strip()
