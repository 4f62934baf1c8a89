"""What a card computes is what the processor computes, but for how it rounds."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.engines.card import Card
from rattlebox.engines.gpu_impact import ready
from rattlebox.paper.seed import seed_case
from rattlebox.studies.measures import MEASURES

BESIDE = Path(__file__).parents[1] / "unit/engines/gpu_cases.py"


def _cases() -> dict[str, dict[str, Any]]:
    spec = importlib.util.spec_from_file_location("gpu_cases", BESIDE)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.CASES


CASES = _cases()


@pytest.mark.parametrize(("group", "name"), [(group, name) for group, named in CASES.items() for name in named])
def test_a_card_agrees_with_the_processor(group: str, name: str) -> None:
    """Every part of a case gives the same status, and measures that differ by what a few impacts make of rounding."""
    case, axes, look = CASES[group][name]
    named = [measure for measure, about in MEASURES.items() if "cycles" in look or not about.cyclic]
    kept = {key: value for key, value in look.items() if key != "state"}
    here, there = (rb.sweep(case, axes, named, samples=101, on=on, **kept) for on in (None, "gpu"))
    np.testing.assert_array_equal(there.status, here.status)
    for measure in here.data_vars:
        if measure == "closure":
            assert np.all(there[measure] < 1e-8)
        else:
            size = float(np.abs(here[measure]).max())
            np.testing.assert_allclose(there[measure], here[measure], rtol=1e-6, atol=1e-9 * size, err_msg=str(measure))


def test_the_same_bits_twice() -> None:
    """Two runs on a card give the same bits, whichever thread takes which variant."""
    axes = {"damper.start": rb.linspace(-1.0, 1.0, 3000)}
    one, other = (rb.sweep(seed_case(duration=0.5), axes, ["impacts", "impact_share"], on="gpu") for _ in range(2))
    for measure in one.data_vars:
        np.testing.assert_array_equal(one[measure], other[measure])


def test_kernels_are_compiled_once_on_a_machine(card: Card) -> None:
    """The second time they come from the cache."""
    ready()
    assert "cache" in ready()[1] and card.arch in ready()[1]
