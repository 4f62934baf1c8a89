"""Particles in space on a card: what the processor computes, but for how it rounds."""

from __future__ import annotations

import numpy as np
import pytest
from tests.unit.engines.test_gpu_dem import case
from tests.verification.dem.varieties import VARIETIES, agree, pair

import rattlebox as rb
from rattlebox.engines import dem_gpu
from rattlebox.engines.core import core
from rattlebox.engines.dem import pack_dem
from rattlebox.engines.dem_gpu import CardDem


@pytest.mark.parametrize("variety", VARIETIES)
def test_a_card_agrees_with_the_processor(variety: str) -> None:
    """Every law, wall, structure and load: oblique impacts of two balls and at walls."""
    packed, _, _ = pack_dem(pair(VARIETIES[variety]))
    here, there = core().Dem(packed), CardDem(packed)
    for each in (here, there):
        each.run(packed["steps"])
    agree(here, there, to=1e-7)


def test_a_block_and_all_blocks_give_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Teams of any size agree, on a card too; twice is the same."""
    runs = [rb.simulate(case(), on="gpu") for _ in range(2)]
    monkeypatch.setattr(dem_gpu, "SMALL", 10)
    runs.append(rb.simulate(case(), on="gpu"))
    for run in runs[1:]:
        assert np.array_equal(run.arrays.position, runs[0].arrays.position)
        assert np.array_equal(run.arrays.cavity_force, runs[0].arrays.cavity_force)


def test_studies_are_those_of_the_processor() -> None:
    """A study of many variants, more than the card holds at once, has the processor's measures but for rounding."""
    axes = {"structure.velocity": rb.linspace("0.1 m/s", "0.7 m/s", 1500)}
    found = rb.sweep(case(), axes, ["impact_share", "peak"], on="gpu", progress=False)
    some = {"structure.velocity": found["structure.velocity"].values[::100]}
    here = rb.sweep(case(), some, ["impact_share", "peak"], progress=False)
    assert (found.status == 0).all()
    for name in ("impact_share", "peak"):
        np.testing.assert_allclose(found[name][::100], here[name], rtol=1e-4)


def test_variants_side_by_side_are_those_alone() -> None:
    """Blocks do not disturb each other."""
    cases = [case(0.2 * k) for k in range(1, 40)]
    for one, each in zip(rb.simulate_many(cases, on="gpu"), cases, strict=True):
        assert np.array_equal(one.arrays.position, rb.simulate(each, on="gpu").arrays.position)
