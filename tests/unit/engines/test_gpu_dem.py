"""Particles in space on a graphics card: for which laws kernels are compiled, and what is told of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from tests.verification.dem.varieties import VARIETIES

import rattlebox as rb
from rattlebox.engines import dem, dem_gpu

from .gpu_cases import bed

DOCS = Path(__file__).parents[3] / "docs/gpu.md"


def test_the_page_tells_of_every_law_wall_structure_and_load() -> None:
    """The page about cards names all that tests/gpu compares."""
    page = DOCS.read_text(encoding="utf-8")
    assert [variety for variety in VARIETIES if variety not in page] == []


def test_what_is_alike_is_compiled_in() -> None:
    """Kernels know the laws that all contacts share, and ask for those that differ."""
    plain, rolls = dem.pack_dem(bed())[0], dem.pack_dem(bed(rolling=0.1))[0]
    linear = dem.pack_dem(
        bed(contact=rb.Linear(contact_time="0.1 ms", restitution=0.7), friction=rb.LinearSpring(0.3, ratio=0.4))
    )[0]
    assert dem_gpu.laws([plain]) == {"RATTLEBOX_NORMAL": 0, "RATTLEBOX_RUBS": 1}
    assert dem_gpu.laws([plain, rolls]) == {"RATTLEBOX_NORMAL": 0}
    assert dem_gpu.laws([plain, linear]) == {"RATTLEBOX_RUBS": 1}


@pytest.mark.parametrize(
    ("run", "told"),
    [
        (lambda: rb.simulate(bed(), on="cloud"), "on = 'cloud'.*\"gpu\", or nothing"),
        (
            lambda: rb.simulate(rb.Case(structure=rb.SDOF(mass=1, stiffness=1, velocity=1), duration=1), on="gpu"),
            r"stays there.*rb\.sweep",
        ),
    ],
)
def test_other_places_are_refused(run: Any, told: str) -> None:
    """What does not run on a card, and cards that do not exist, are refused with what to try."""
    with pytest.raises(rb.CaseError, match=f"(?s){told}"):
        run()
