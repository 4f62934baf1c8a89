"""Messages for each status of a run: what happened, and what to try with the method that was used."""

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
        "{contact}: the approach speed {value:.6g} m/s at t = {time:.9g} s exceeds the range of the restitution law."
    ),
    Status.too_many_events: (
        "The limit max_events, or that of the steps of contacts, was reached at t = {time:.9g} s, probably by chattering."
    ),
    Status.step_too_small: "A contact could not be integrated within the tolerance at t = {time:.9g} s.",
    Status.interrupted: "The run was stopped at t = {time:.9g} s; the results up to this time are available.",
    Status.not_finite: "The solution became non-finite at t = {time:.9g} s.",
    Status.energy_error: (
        "At t = {time:.9g} s the energy balance has an error of {value:.2g} of the energy put in. Do not use the results."
    ),
    Status.escaped: "{contact} left its cavity at {value:.6g} m/s, at t = {time:.9g} s.",
    Status.no_rebound: (
        "{contact}: the restitution is zero at the approach speed {value:.6g} m/s at t = {time:.9g} s, which a dashpot "
        "cannot represent."
    ),
    Status.refused: "The case cannot be run as it is.",
    Status.false_contact: (
        "{contact}: a contact began at t = {time:.9g} s with a gap of {value:.3g} m, although it must be zero; this is an "
        "error of the engine. Do not use the results."
    ),
}

_SIZES = "Check the units of stiffnesses, masses and speeds."
ADVICE: dict[Status, dict[str, str]] = {
    Status.law_domain: {
        "": "Use a law that covers it (Thornton, a table), or allow extrapolation (extrapolate = true)."
    },
    Status.too_many_events: {
        "": "Raise max_events, shorten the run, or add damping to the contact.",
        "event_driven": "Raise max_events, shorten the run, add damping to the contact, give balls that touch both walls at "
        'rest a gap, such as "1 pm", or use the Newton method, which lets chattering balls stick.',
        "newton": "Raise stick so that slow impacts end earlier, raise max_events, shorten the run, or use the EventDriven "
        "method, whose contacts have a duration.",
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
        "dem": 'Halve the time step: dt = "{half_step:.3g} s" in the method.',
    },
    Status.refused: {"": "Run the variant alone to see the reason."},
    Status.false_contact: {"": "Compare with another method, and report the case."},
    Status.escaped: {"": "Shorten dt, or use a stiffer contact.", "softened": "Shorten dt, or lower the softening."},
}
"""Advice by status and kind of method; "" for all other methods, "softened" for softened contacts."""


def final_status(
    ledger: Ledger, limit: float, mass: float, *, permitted: float = 0.0, rounding: float = 1e-10, held: float = 0.0
) -> Status:
    """Return the status of a run that reached its end.

    `mass`: mass of all balls or particles [kg]. A residual below their kinetic energy at 1 nm/s counts as rounding.
    `permitted`: energy error that the tolerance permits in all steps [J], allowed in addition to the limit, up to 1 %.
    `rounding`: residual that counts as rounding, as part of the largest energy of the run.
    `held`: work of the forces of hard stops that counts as rounding, because the points that they hold do not move [J].
    """
    if not np.isfinite(ledger.residual).all():
        return Status.not_finite
    floor = mass * _core.speed_at_rest**2 + held
    balanced = ledger.is_balanced(limit, permitted=permitted, floor=floor, rounding=rounding)
    return Status.finished if balanced else Status.energy_error


def describe(
    status: Status,
    time: float,
    contact: str,
    value: float,
    method: str,
    *,
    softened: bool = False,
    step: float = np.nan,
) -> tuple[str, str]:
    """Return the name of a status, and a message with what happened and what to try.

    `time`: time at which the run stopped [s]. `value`: approach speed at that contact [m/s], or the energy residual.
    `step`: time step of a 3-D run [s].
    """
    happened, advice = MESSAGES[status], ADVICE.get(status, {})
    hint = advice.get("softened" if softened and "softened" in advice else method, advice.get("", ""))
    sentences = happened.format(time=time, contact=contact, value=value), hint.format(half_step=0.5 * step)
    return status.name, " ".join(sentences).strip()
