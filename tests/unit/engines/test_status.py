"""What a run that did not finish says."""

import pytest

from rattlebox.engines.status import STATUSES, describe

LACKS = {
    "event_driven": ("EventDriven", "dt_flight", "stick,"),
    "newton": ("Newton method", "dt_flight", "tolerance"),
    "two_step": ("TwoStep", "tolerance", "stick,"),
}
ONLY_EVENT_DRIVEN = {"step_too_small"}


@pytest.mark.parametrize("method", LACKS)
@pytest.mark.parametrize("status", range(len(STATUSES)))
def test_advice_fits_the_method(status: int, method: str) -> None:
    """A run that failed says what to try, and neither to use the method it used nor to set what that method lacks."""
    name, message = describe(status, 0.5, "damper (trailing wall)", 0.1, method)
    happened = STATUSES[status][1].format(time=0.5, contact="damper (trailing wall)", value=0.1)
    assert message.startswith(happened)
    assert (message == happened) == (name in ("finished", "interrupted"))
    if name not in ONLY_EVENT_DRIVEN or method == "event_driven":
        assert not any(word in message for word in LACKS[method])
