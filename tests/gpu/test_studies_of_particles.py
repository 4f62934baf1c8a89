"""Studies of particles in space on a graphics card."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.unit.engines.gpu_cases import bed

import rattlebox as rb
from rattlebox.engines import dem, dem_gpu
from rattlebox.results import GranularRun
from rattlebox.studies import granular
from rattlebox.studies.axes import Design
from rattlebox.studies.runner import Stopped
from rattlebox.studies.store import progress_of

from .conftest import Watched

DOCS = Path(__file__).parents[2] / "docs/gpu.md"
SPEEDS = {"structure.velocity": [0.1, 0.3, 0.5, 0.7]}
SHARES = ["impact_share", "viscous_share", "peak", "closure"]


def turned(run: rb.Run) -> float:
    """Return the energy of all spins at the end."""
    assert isinstance(run, GranularRun)
    return float(run.arrays.rotation_energy[-1].sum())


def test_variants_run_side_by_side(watched: Watched) -> None:
    """Measures and functions of a run are those of each variant alone on the card, and the processor's but for rounding."""
    found = rb.sweep(bed(), SPEEDS, [*SHARES, turned], on="gpu", progress=False)
    assert set(watched.blocks) == {4} and "sm_" in found.gpu
    for k, speed in enumerate(SPEEDS["structure.velocity"]):
        structure = bed().structure.model_copy(update={"velocity": speed})
        alone = rb.simulate(bed().model_copy(update={"structure": structure}), on="gpu")
        one = found.isel({"structure.velocity": k})
        assert float(one.turned) == turned(alone) > 0
        assert float(one.closure) == alone.closure
        assert float(one.viscous_share) == alone.ledger.shares["viscous"]
        assert float(one.peak) == np.abs(alone.arrays.displacement).max()
    here = rb.sweep(bed(), SPEEDS, [*SHARES, turned], progress=False)
    for name in ("status", "impact_share", "viscous_share", "peak", "turned"):
        np.testing.assert_allclose(found[name], here[name], rtol=1e-5)


def test_batches_fit_the_memory(watched: Watched) -> None:
    """As many variants run at once as fit, to the same bits; where one does not, the study is refused with the number."""
    whole = rb.sweep(bed(), SPEEDS, SHARES, on="gpu", progress=False)
    each = dem_gpu._room(dem_gpu.CardDem(dem.pack_dem(bed())[0]))
    watched.free, watched.blocks = int(2.5 * each / 0.9), []
    assert rb.sweep(bed(), SPEEDS, SHARES, on="gpu", progress=False).equals(whole)
    assert set(watched.blocks) == {2}
    watched.free, watched.blocks = each // 2, []
    with pytest.raises(rb.CaseError, match=r"40 particles need .* GiB on the card, .* GiB are free"):
        rb.sweep(bed(), SPEEDS, SHARES, on="gpu", progress=False)
    assert not watched.blocks


def test_portions_fit_this_machine(watched: Watched, monkeypatch: pytest.MonkeyPatch) -> None:
    """No more particles are brought to the card at once than fit the machine; large variants are blocks of their own."""
    whole = rb.sweep(bed(), SPEEDS, SHARES, on="gpu", progress=False)
    watched.blocks.clear()
    monkeypatch.setattr(granular, "_PARTICLES", 130)
    told: list[int] = []
    found = rb.sweep(bed(), SPEEDS, SHARES, on="gpu", progress=lambda done, _: told.append(done))
    assert found.equals(whole) and watched.blocks[0] == 3 and watched.blocks[-1] == 1
    assert told == sorted(told) and told[-1] == 4
    monkeypatch.setattr(dem_gpu, "SMALL", 30)
    task = granular.GranularTask(bed(), Design.of(bed(), SPEEDS), []).on_card()
    assert task.side_by_side(4) == 1


def test_unlike_variants_have_kernels_of_their_own(watched: Watched, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bits of a variant depend on itself alone: cases of other laws or sizes run beside their like, large ones alone."""
    monkeypatch.setattr(dem_gpu, "SMALL", 50)
    axes = {"damper.friction": [0.0, 0.3], "damper.particles.count": [40, 60, 41]}
    found = rb.sweep(bed(friction=0.3), axes, ["peak", turned], on="gpu", progress=False)
    assert set(watched.blocks) == {2, 0}
    assert (found.status == 0).all() and (found.turned > 0).values.tolist() == [[False] * 3, [True] * 3]
    for k, count in ((1, 60), (2, 41)):
        other = {"damper.friction": [0.3], "damper.particles.count": [count]}
        one = rb.sweep(bed(friction=0.3), other, ["peak", turned], on="gpu", progress=False).squeeze()
        there = found.isel({"damper.friction": 1, "damper.particles.count": k})
        assert float(one.turned) == float(there.turned) and float(one.peak) == float(there.peak)


class _Full:
    """A case with no room for more neighbours."""

    def make_room(self) -> None:
        """Say so."""
        raise ValueError("a particle has more than 32 neighbours of its size or larger")


def test_corners_that_cannot_be_run_do_not_stop_the_others(watched: Watched, monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps that are too long, motion beyond all numbers and full slots have a status, the first two the processor's."""
    given = bed().model_copy(update={"method": rb.Dem(dt="10 us")})
    softening = {"damper.softening": [1e5, 1.0, 2e4]}
    found, here = (rb.sweep(given, softening, "peak", on=on, progress=False) for on in ("gpu", None))
    names = found.status.attrs["flag_meanings"].split()
    assert [names[k] for k in found.status.values] == ["finished", "refused", "finished"]
    assert np.array_equal(found.status, here.status)
    assert np.isfinite(found.peak).values.tolist() == [True, False, True]

    given = bed(softening=1e5).model_copy(update={"method": rb.Dem(dt="10 us")})
    fast = {"structure.velocity": [0.5, 1e3, 0.7]}
    found, here = (rb.sweep(given, fast, "peak", on=on, progress=False) for on in ("gpu", None))
    assert [names[k] for k in found.status.values] == ["finished", "escaped", "finished"]
    assert np.array_equal(found.status, here.status)

    usual = dem_gpu.CardDem.make_room

    def full(self: dem_gpu.CardDem) -> None:
        own = self._dem
        if self.particles == 41:
            self._dem = _Full()
        usual(self)
        self._dem = own

    monkeypatch.setattr(dem_gpu.CardDem, "make_room", full)
    counts = {"damper.particles.count": [40, 41, 42]}
    found = rb.sweep(bed(), counts, "peak", on="gpu", progress=False)
    assert [names[k] for k in found.status.values] == ["finished", "refused", "finished"]
    with pytest.raises(rb.CaseError, match=r"(?s)on a card, a particle has more.*try: the processor"):
        rb.simulate(bed(particles=rb.Particles(material="steel", radius="2 mm", count=41)), on="gpu")


def test_a_stop_loses_no_finished_block(watched: Watched, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C is heard between launches; the same call goes on to the same bits, on a card only."""
    monkeypatch.setattr(granular, "_SIDE_BY_SIDE", 2)
    store, told = tmp_path / "study.zarr", []

    def stopping(done: int, total: int) -> None:
        told.append((done, total))
        if progress_of(store).done == 2:
            raise KeyboardInterrupt

    with pytest.raises(Stopped, match="2 of 4 variants are in"):
        rb.sweep(bed(), SPEEDS, SHARES, on="gpu", store=store, progress=stopping)
    assert told[0] == (0, 4)
    watched.blocks.clear()
    with pytest.raises(rb.CaseError, match="another study"):
        rb.sweep(bed(), SPEEDS, SHARES, store=store, progress=False)
    found = rb.sweep(bed(), SPEEDS, SHARES, on="gpu", store=store, progress=False)
    assert set(watched.blocks) == {2}
    launches = len(watched.blocks)
    assert rb.sweep(bed(), SPEEDS, SHARES, on="gpu", store=store, progress=False).equals(found)
    assert len(watched.blocks) == launches
    assert rb.sweep(bed(), SPEEDS, SHARES, on="gpu", progress=False).equals(found.load())


def test_a_block_tells_how_far_it_is_and_stops(watched: Watched) -> None:
    """Between launches a block is asked whether to stop, with how many of its variants are done, parts included."""
    task = granular.GranularTask(bed(), Design.of(bed(), SPEEDS), ["peak"]).on_card()
    parts: list[float] = []
    assert task.run(0, 4, cancelled=lambda done: parts.append(done)) is not None
    assert parts == sorted(parts) and parts[-1] == 4.0 and any(0 < part < 4 for part in parts)
    assert task.run(0, 4, cancelled=lambda done: done > 0) is None
    settled = bed(packing=rb.Settled(seed=5))
    assert (
        granular.GranularTask(settled, Design.of(settled, SPEEDS), []).on_card().run(0, 4, cancelled=lambda _: True)
        is None
    )


def test_ready_maps_take_particles_on_a_card(watched: Watched) -> None:
    """A loss map and a sensitivity run there as a sweep does, and the page about cards says so."""
    assert "| study: sweep, loss_map, sensitivity; functions of a Run as measures | yes | yes |" in DOCS.read_text(
        "utf-8"
    )
    motion = rb.Harmonic(amplitude="1 m/s^2", frequency="500 Hz", direction="z")
    shaken = bed().model_copy(update={"structure": rb.Shaker(motion=motion)})
    amplitudes, frequencies = ["50 m/s^2", "90 m/s^2"], ["400 Hz", "600 Hz"]
    here, there = (
        rb.loss_map(shaken, amplitudes, frequencies, cycles=(1, 2), on=on, progress=False) for on in (None, "gpu")
    )
    assert set(watched.blocks) == {4}
    np.testing.assert_allclose(there.loss_per_cycle, here.loss_per_cycle, rtol=1e-4)
    bounds = {"damper.contact.restitution": (0.4, 0.9), "structure.velocity": (0.2, 0.6)}
    found = rb.sensitivity(bed(), bounds, "peak", 8, on="gpu", progress=False)
    assert np.isfinite(found.total).all() and max(watched.blocks) == 32
