"""Tests of a graphics card: `make gpu-test`. They are skipped, and say why, where there is none."""

from __future__ import annotations

import pytest

from rattlebox.engines.card import Card
from rattlebox.model.errors import CaseError


@pytest.fixture(scope="session", autouse=True)
def card() -> Card:
    """The card of this machine."""
    try:
        return Card()
    except CaseError as error:
        pytest.skip(f"no graphics card to test on: {' '.join(str(error).split())}")
