"""How a run can end, each with a sentence that says what to try."""

from __future__ import annotations

STATUSES: tuple[tuple[str, str], ...] = (
    ("finished", "The run reached its end."),
    (
        "law_domain",
        "{contact} was struck at {value:.6g} m/s, above the last speed its restitution law covers, at t = {time:.9g} s. "
        "Use a law that covers it (Thornton, a table), or allow extrapolation (extrapolate = true) knowingly.",
    ),
    (
        "too_many_events",
        "The budget of events was spent at t = {time:.9g} s, likely by chattering. Raise max_events, shorten the run, "
        "add damping to the contact, or use the Newton method, which lets chattering balls stick.",
    ),
    (
        "step_too_small",
        "A contact could not be integrated within the tolerance at t = {time:.9g} s. Loosen the tolerance, or check that "
        "stiffnesses and masses are of the sizes you meant.",
    ),
    ("interrupted", "The run was stopped at t = {time:.9g} s; what was computed until then is kept."),
    (
        "not_finite",
        "The motion grew beyond all numbers at t = {time:.9g} s. Shorten the time steps of the TwoStep method.",
    ),
    (
        "ledger_open",
        "The run reached its end, but its energy ledger closes only to {value:.2g} of the energy put in: do not trust it. "
        "Lower the tolerance, and compare with another method.",
    ),
)
LEDGER_OPEN = [name for name, _ in STATUSES].index("ledger_open")


def describe(status: int, time: float, contact: str, value: float) -> tuple[str, str]:
    """Return the name and the sentence of a core status.

    Parameters
    ----------
    status
        Number of the core's status (core/base/status.hpp).
    time
        Where the run stopped [s].
    contact
        Name of the contact concerned, if any.
    value
        Approach speed there [m/s].
    """
    name, sentence = STATUSES[status]
    return name, sentence.format(time=time, contact=contact, value=value)
