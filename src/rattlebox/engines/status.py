"""How a run can end, each with a sentence on what happened and one on what to try with the method that ran."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rattlebox.core import _core
from rattlebox.core._core import Status

if TYPE_CHECKING:
    from rattlebox.results.ledger import Ledger

MESSAGES: dict[Status, str] = {
    Status.finished: "The run reached its end.",
    Status.law_domain: (
        "{contact} was struck at {value:.6g} m/s, above the last speed its restitution law covers, at t = {time:.9g} s."
    ),
    Status.too_many_events: "The budget of events was spent at t = {time:.9g} s, likely by chattering.",
    Status.step_too_small: "A contact could not be integrated within the tolerance at t = {time:.9g} s.",
    Status.interrupted: "The run was stopped at t = {time:.9g} s; what was computed until then is kept.",
    Status.not_finite: "The motion grew beyond all numbers at t = {time:.9g} s.",
    Status.energy_error: (
        "The run reached its end, but its energies do not add up: {value:.2g} of the energy put in is missing or too much. "
        "Do not use its results."
    ),
    Status.escaped: "{contact} left its cavity at {value:.6g} m/s, at t = {time:.9g} s.",
    Status.no_rebound: (
        "{contact} was struck at {value:.6g} m/s, where its restitution law gives no rebound, which no contact with a "
        "dashpot can do, at t = {time:.9g} s."
    ),
    Status.refused: "The case cannot be run as it is.",
}

_SIZES = "Check that stiffnesses, masses and speeds are of the sizes you meant."
_ADVICE: dict[Status, dict[str, str]] = {
    Status.law_domain: {
        "": "Use a law that covers it (Thornton, a table), or allow extrapolation (extrapolate = true) knowingly."
    },
    Status.too_many_events: {
        "": "Raise max_events, shorten the run, or add damping to the contact.",
        "event_driven": "Raise max_events, shorten the run, add damping to the contact, or use the Newton method, which "
        "lets chattering balls stick.",
        "newton": "Raise stick, so that slow impacts end earlier, raise max_events, shorten the run, or use the EventDriven "
        "method, whose contacts take their time.",
    },
    Status.step_too_small: {"": "Loosen the tolerance. " + _SIZES},
    Status.no_rebound: {
        "": "Check the law (yield stress, table, extrapolation), use a contact that yields (Thornton), or the Newton "
        "method, whose impacts may be fully plastic.",
        "dem": "Check the law (yield stress, table, extrapolation), or use a contact that yields (Thornton).",
    },
    Status.not_finite: {
        "": _SIZES,
        "two_step": "Shorten the time steps dt_flight and dt_contact.",
        "dem": "Shorten dt. " + _SIZES,
    },
    Status.energy_error: {
        "": "Compare with another method.",
        "event_driven": "Lower the tolerance, and compare with another method.",
        "two_step": "Shorten the time steps dt_flight and dt_contact.",
        "dem": "Shorten dt, or the fraction of the shortest contact that it is.",
    },
    Status.refused: {"": "Run it alone, which says why."},
    Status.escaped: {
        "": "Shorten dt, or use a stiffer contact.",
        "softened": "Shorten dt, or soften the contacts less.",
    },
}
"""What to try, by status and kind of method; "" for every other method, "softened" where contacts are."""


def end_of(ledger: Ledger, bound: float, mass: float) -> Status:
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
        return Status.not_finite
    return Status.finished if ledger.closes(bound, mass * _core.speed_at_rest**2) else Status.energy_error


def describe(
    status: Status, time: float, contact: str, value: float, method: str, *, softened: bool = False
) -> tuple[str, str]:
    """Return the name of a core status, and what happened with what to try.

    Parameters
    ----------
    status
        Status of the run.
    time
        Where the run stopped [s].
    contact
        Name of the contact concerned, if any.
    value
        Approach speed there [m/s], or the energy residual of a ledger.
    method
        Kind of the method that ran, as in case files.
    softened
        Whether the contacts concerned are softer than their bodies are.
    """
    happened, advice = MESSAGES[status], _ADVICE.get(status, {})
    own = advice.get("softened" if softened and "softened" in advice else method, advice.get("", ""))
    sentences = happened.format(time=time, contact=contact, value=value), own
    return status.name, " ".join(sentences).strip()
