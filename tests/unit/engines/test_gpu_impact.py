"""What the page about cards tells of impact dampers is what tests/gpu compares."""

from __future__ import annotations

import typing
from pathlib import Path
from typing import Any

import pytest

from rattlebox.model import contacts, methods, restitutions, signals, structures

from . import gpu_cases as cases

UNIONS = {
    "contact": contacts.AnyContact,
    "restitution": restitutions.AnyRestitution,
    "structure": structures.AnyStructure,
    "load": signals.AnySignal,
    "method": methods.AnyMethod,
}


@pytest.mark.parametrize("group", UNIONS)
def test_every_part_of_a_case_is_compared(group: str) -> None:
    """What the model offers is among the cases, or is listed as missing."""
    offered = {part.__name__ for part in _classes(UNIONS[group])}
    assert offered and offered <= {*cases.CASES[group], *cases.BELOW.get(group, ())}


def _classes(union: Any) -> list[type]:
    if isinstance(union, type):
        return [union]
    inner = typing.get_args(union)
    return [part for one in inner for part in _classes(one)] if inner else []


def test_the_page_tells_what_a_card_can_do() -> None:
    """The parity table of the page is the one that the cases make."""
    page = (Path(__file__).parents[3] / "docs" / "gpu.md").read_text(encoding="utf-8")
    wanted = "\n".join(cases.table())
    assert wanted in page, wanted
