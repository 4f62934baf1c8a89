"""Particles in space on a card: what the processor computes, but for how it rounds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.unit.engines.gpu_cases import bed
from tests.verification.dem.varieties import VARIETIES, agree, pair

import rattlebox as rb
from rattlebox.engines import dem_gpu
from rattlebox.engines.card import Card
from rattlebox.engines.core import core
from rattlebox.engines.dem import pack_dem
from rattlebox.engines.dem_gpu import CardDem
from rattlebox.results.snapshots import Snapshots

from .conftest import Watched


@pytest.mark.parametrize("variety", VARIETIES)
def test_a_card_agrees_with_the_processor(variety: str) -> None:
    """Every law, wall, structure and load: oblique impacts of two balls and at walls."""
    packed, _, _ = pack_dem(pair(VARIETIES[variety]))
    here, there = core().Dem(packed), CardDem(packed)
    for each in (here, there):
        each.run(20_000)
    assert there.step == here.step == 20_001 and here.counters()["first_touches"].sum() >= 3
    agree(here, there, to=1e-7)


def test_studies_are_those_of_the_processor(card: Card) -> None:
    """A study of many variants, more than the card holds at once, has the processor's measures but for rounding."""
    axes = {"structure.velocity": rb.linspace("0.1 m/s", "0.7 m/s", 10 * card.multiprocessors + 1)}
    case = bed().model_copy(update={"duration": 1e-3})
    found = rb.sweep(case, axes, ["impact_share", "peak"], on="gpu", progress=False)
    some = {"structure.velocity": found["structure.velocity"].values[::10]}
    here = rb.sweep(case, some, ["impact_share", "peak"], progress=False)
    assert (found.status == 0).all()
    for name in ("impact_share", "peak"):
        np.testing.assert_allclose(found[name][::10], here[name], rtol=1e-4)


def test_variants_side_by_side_are_those_alone() -> None:
    """Blocks do not disturb each other."""
    cases = [bed(0.2 * k) for k in range(1, 10)]
    for one, each in zip(rb.simulate_many(cases, on="gpu"), cases, strict=True):
        assert np.array_equal(one.arrays.position, rb.simulate(each, on="gpu").arrays.position)


def test_kernels_do_what_the_processor_does(watched: Watched) -> None:
    """One case on the card agrees with the processor to rounding as long as chaos lets it."""
    case = bed().model_copy(update={"duration": 6e-3})
    here, there = rb.simulate(case), rb.simulate(case, on="gpu")
    assert there.ok and set(watched.blocks) == {1} and set(watched.threads) == {128}
    assert "driver with CUDA" in there.provenance.gpu and "kernels" in there.provenance.gpu and not here.provenance.gpu
    assert there.arrays.counts["first_touches_particle"] >= 20
    for name in ("displacement", "cavity_force", "kinetic_energy", "sliding_loss", "normal_loss", "position", "spin"):
        wanted, found = (getattr(run.arrays, name) for run in (here, there))
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-7 * np.max(np.abs(wanted)), err_msg=name)


def test_snapshots_are_of_their_times(tmp_path: Path) -> None:
    """Places at the times that were asked for are the processor's."""
    case = bed().model_copy(update={"output": rb.Output(rate=10_000.0, snapshots=(0.7e-3, 1.1e-3, 2.9e-3))})
    frames = []
    for on in (None, "gpu"):
        rb.simulate(case, on=on, snapshots=tmp_path / f"{on}.vtkhdf")
        frames.append(Snapshots(tmp_path / f"{on}.vtkhdf"))
    for here, there in zip(*frames, strict=True):
        np.testing.assert_allclose(there.position, here.position, rtol=0, atol=1e-9)


def test_near_memory_does_not_matter(watched: Watched) -> None:
    """As much of a case as fits lies in shared memory; how much that is changes no bit."""
    runs = []
    for watched.shared in (0, 3000, 200_000):
        runs.append(rb.simulate(bed(), on="gpu").arrays)
    assert all(np.array_equal(run.position, runs[0].position) for run in runs)
    assert all(np.array_equal(run.cavity_force, runs[0].cavity_force) for run in runs)


def test_unlike_cases_share_launches(watched: Watched) -> None:
    """Small cases share launches, of different length and with more neighbours than slots, each as if it were alone."""
    cases = [bed(0.5), bed(2.0, softening=2000.0), bed(1.0, packing=rb.Lattice())]
    together = rb.simulate_many(cases, on="gpu")
    assert 3 in watched.blocks
    alone = [rb.simulate(each, on="gpu") for each in cases]
    for one, other in zip(together, alone, strict=True):
        assert one.status == other.status == "finished"
        assert np.array_equal(one.arrays.position, other.arrays.position)
        assert np.array_equal(one.arrays.kinetic_energy, other.arrays.kinetic_energy)


def test_who_waits_for_room_does_not_wait_for_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """A case that needs room goes on with the others once it has waited some exchanges long, to the same bits."""
    monkeypatch.setattr(dem_gpu, "MANY_SAMPLES", 12)  # of 31 in the longer case
    monkeypatch.setattr(dem_gpu, "_PIECE", 1e-9)  # a step a launch
    monkeypatch.setattr(dem_gpu, "_PATIENCE", 0.0)
    cases = [bed(0.5), bed(0.5).model_copy(update={"duration": 1.5e-3, "output": rb.Output(rate=6000.0)})]
    rounds: list[list[int]] = []
    begun = dem_gpu._Blocks.filled

    def filled(self: dem_gpu._Blocks) -> Any:
        rounds.append([case.step for case in self.cases])
        return begun(self)

    monkeypatch.setattr(dem_gpu._Blocks, "filled", filled)
    together = rb.simulate_many(cases, on="gpu")
    assert any(len(steps) == 2 and steps[0] > 0 for steps in rounds)
    monkeypatch.undo()
    for one, each in zip(together, cases, strict=True):
        assert np.array_equal(one.arrays.position, rb.simulate(each, on="gpu").arrays.position)


def test_a_large_case_has_all_of_the_card(watched: Watched, monkeypatch: pytest.MonkeyPatch) -> None:
    """A case of many particles is not put into one block, and moves alike to the last bit; twice is the same."""
    small, again = rb.simulate(bed(), on="gpu"), rb.simulate(bed(), on="gpu")
    monkeypatch.setattr(dem_gpu, "SMALL", 10)
    monkeypatch.setattr(dem_gpu, "SAMPLES", 7)  # fetched now and then
    large = rb.simulate(bed(), on="gpu")
    assert watched.blocks[-1] == 0
    for run in (again, large):
        assert np.array_equal(small.arrays.position, run.arrays.position)
        assert np.array_equal(small.arrays.cavity_force, run.arrays.cavity_force)


def test_a_run_on_the_card_can_be_stopped_and_goes_on(tmp_path: Path) -> None:
    """Progress stops it between two launches; from the checkpoint it goes on to the same bits."""
    whole = rb.simulate(bed(), on="gpu")
    told: list[int] = []

    def twice(done: int, _: int) -> bool:
        told.append(done)
        return len(told) < 2

    part = rb.simulate(bed(), on="gpu", checkpoint=tmp_path / "kept", progress=twice)
    assert part.status == "interrupted"
    with pytest.raises(rb.CaseError, match=r'(?s)holds another run.*try: on="gpu", or another file'):
        rb.simulate(bed(), checkpoint=tmp_path / "kept")
    rest = rb.simulate(bed(), on="gpu", checkpoint=tmp_path / "kept")
    assert rest.ok
    assert np.array_equal(rest.arrays.position, whole.arrays.position)
    assert np.array_equal(rest.arrays.sliding_loss, whole.arrays.sliding_loss)


def test_too_large_a_case_is_refused_with_the_number(watched: Watched) -> None:
    """A card with too little memory is told of before anything runs."""
    watched.free = 50_000
    with pytest.raises(rb.CaseError, match=r"40 particles need \d\.\d+e-05 GiB on the card, 4\.66e-05 GiB are free"):
        rb.simulate(bed(), on="gpu")
    assert not watched.blocks
