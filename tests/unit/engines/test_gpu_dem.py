"""Particles in space on a graphics card, on the processor: the kernels' source and all that leads to them."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.verification.dem.varieties import VARIETIES, agree, pair

import rattlebox as rb
from rattlebox.engines import dem, dem_gpu
from rattlebox.engines.core import core

from .card_of_paper import COMPILER, CardOfPaper, built

DOCS = Path(__file__).parents[3] / "docs/gpu.md"

pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C++ compiler")


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """The kernels of Hertz contacts with friction."""
    return built(tmp_path_factory.mktemp("kernels"), RATTLEBOX_NORMAL=0, RATTLEBOX_RUBS=1)


@pytest.fixture
def card(library: ctypes.CDLL, monkeypatch: pytest.MonkeyPatch) -> CardOfPaper:
    """A card that every run finds."""
    made = CardOfPaper(library)
    monkeypatch.setattr(dem, "Card", lambda: made)
    return made


@pytest.fixture(scope="module")
def any_law(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """The kernels of any contacts."""
    return built(tmp_path_factory.mktemp("any"))


@pytest.mark.parametrize("variety", VARIETIES)
def test_kernels_know_every_law_wall_structure_and_load(any_law: ctypes.CDLL, variety: str) -> None:
    """Oblique impacts of two balls and at walls agree with the processor's engine, and the page about cards names them."""
    packed, _, _ = dem.pack_dem(pair(VARIETIES[variety]))
    here, there = core().Dem(packed), dem_gpu.CardDem(packed, CardOfPaper(any_law))  # type: ignore[arg-type]
    for each in (here, there):
        each.run(packed["steps"])
    agree(here, there, to=1e-7)
    assert variety in DOCS.read_text(encoding="utf-8")


def case(speed: float = 1.0, **options: Any) -> Any:
    """Return 40 balls in a box on a structure that is hit."""
    usual: dict[str, Any] = {
        "particles": rb.Particles(material="steel", radius="2 mm", count=40),
        "cavity": rb.Box(size=("22 mm",) * 3),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": rb.Mindlin(0.3),
        "softening": 1000.0,
        "velocity": (0.3, 0.1, -speed),
        "packing": rb.Lattice(noise=1.0, seed=2),
    }
    return rb.Case(
        structure=rb.SDOF(mass=0.5, stiffness=2e4, damping_ratio=0.02, velocity=0.5),
        damper=rb.ParticleDamper(**{**usual, **options}),
        duration="6 ms",
        output=rb.Output(rate=5000.0),
    )


def test_kernels_do_what_the_processor_does(card: CardOfPaper) -> None:
    """One case on the card agrees with the processor to rounding as long as chaos lets it."""
    here, there = rb.simulate(case()), rb.simulate(case(), on="gpu")
    assert there.ok and set(card.launched) == {"block"}
    assert card.macros == {"RATTLEBOX_THREADS": 128, "RATTLEBOX_BLOCKS": 4, "RATTLEBOX_NORMAL": 0, "RATTLEBOX_RUBS": 1}
    assert there.arrays.counts["first_touches_particle"] >= 20
    for name in ("displacement", "cavity_force", "kinetic_energy", "sliding_loss", "normal_loss", "position", "spin"):
        wanted, found = (getattr(run.arrays, name) for run in (here, there))
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-7 * np.max(np.abs(wanted)), err_msg=name)


def test_near_memory_does_not_matter(card: CardOfPaper) -> None:
    """As much of a case as fits lies in shared memory; how much that is changes no bit."""
    runs = []
    for card.shared in (0, 3000, 200_000):
        runs.append(rb.simulate(case(), on="gpu").arrays)
    assert all(np.array_equal(run.position, runs[0].position) for run in runs)
    assert all(np.array_equal(run.cavity_force, runs[0].cavity_force) for run in runs)


def test_variants_run_side_by_side(card: CardOfPaper) -> None:
    """Small cases share launches, of different length and with more neighbours than slots, each as if it were alone."""
    cases = [case(0.5), case(2.0, softening=2000.0), case(1.0, packing=rb.Lattice())]
    together = rb.simulate_many(cases, on="gpu")
    launches = len(card.launched)
    alone = [rb.simulate(each, on="gpu") for each in cases]
    assert launches < len(card.launched) - launches
    for one, other in zip(together, alone, strict=True):
        assert one.status == other.status == "finished"
        assert np.array_equal(one.arrays.position, other.arrays.position)
        assert np.array_equal(one.arrays.kinetic_energy, other.arrays.kinetic_energy)


def test_who_waits_for_room_does_not_wait_for_the_others(card: CardOfPaper, monkeypatch: pytest.MonkeyPatch) -> None:
    """A case that needs room goes on with the others once it has waited some exchanges long, to the same bits."""
    monkeypatch.setattr(dem_gpu, "MANY_SAMPLES", 12)  # of 31 in the longer case
    monkeypatch.setattr(dem_gpu, "_PIECE", 1e-9)  # a step a launch
    monkeypatch.setattr(dem_gpu, "_PATIENCE", 0.0)
    cases = [case(0.5), case(0.5).model_copy(update={"duration": 3e-3, "output": rb.Output(rate=3000.0)})]
    rounds: list[list[int]] = []
    begun = dem_gpu._Blocks.filled

    def filled(self: dem_gpu._Blocks) -> Any:
        rounds.append([case.step for case in self.cases])
        return begun(self)

    monkeypatch.setattr(dem_gpu._Blocks, "filled", filled)
    together = rb.simulate_many(cases, on="gpu")
    assert any(len(steps) == 2 and steps[0] > 0 for steps in rounds)
    monkeypatch.undo()
    monkeypatch.setattr(dem, "Card", lambda: card)
    for one, each in zip(together, cases, strict=True):
        assert np.array_equal(one.arrays.position, rb.simulate(each, on="gpu").arrays.position)


def test_a_large_case_has_all_of_the_card(card: CardOfPaper, monkeypatch: pytest.MonkeyPatch) -> None:
    """A case of many particles is not put into one block, and moves alike."""
    small = rb.simulate(case(), on="gpu")
    monkeypatch.setattr(dem_gpu, "SMALL", 10)
    monkeypatch.setattr(dem_gpu, "SAMPLES", 7)  # fetched now and then
    large = rb.simulate(case(), on="gpu")
    assert card.launched[-1] == "grid"
    assert np.array_equal(small.arrays.position, large.arrays.position)
    assert np.array_equal(small.arrays.cavity_force, large.arrays.cavity_force)


def test_a_run_on_the_card_can_be_stopped_and_goes_on(card: CardOfPaper, tmp_path: Path) -> None:
    """Progress stops it between two launches; from the checkpoint it goes on to the same bits."""
    whole = rb.simulate(case(), on="gpu")
    told: list[int] = []

    def twice(done: int, _: int) -> bool:
        told.append(done)
        return len(told) < 2

    part = rb.simulate(case(), on="gpu", checkpoint=tmp_path / "kept", progress=twice)
    assert part.status == "interrupted"
    with pytest.raises(rb.CaseError, match=r'(?s)holds another run.*try: on="gpu", or another file'):
        rb.simulate(case(), checkpoint=tmp_path / "kept")
    rest = rb.simulate(case(), on="gpu", checkpoint=tmp_path / "kept")
    assert rest.ok
    assert np.array_equal(rest.arrays.position, whole.arrays.position)
    assert np.array_equal(rest.arrays.sliding_loss, whole.arrays.sliding_loss)


def test_too_large_a_case_is_refused_with_the_number(card: CardOfPaper) -> None:
    """A card with too little memory is told of before anything runs."""
    card.free = 50_000
    with pytest.raises(rb.CaseError, match=r"40 particles need \d\.\d+e-05 GiB on the card, 4\.66e-05 GiB are free"):
        rb.simulate(case(), on="gpu")
    assert not card.launched


def test_what_is_alike_is_compiled_in() -> None:
    """Kernels know the laws that all contacts share, and ask for those that differ."""
    plain, rolls = dem.pack_dem(case())[0], dem.pack_dem(case(rolling=0.1))[0]
    linear = dem.pack_dem(
        case(contact=rb.Linear(contact_time="0.1 ms", restitution=0.7), friction=rb.LinearSpring(0.3, ratio=0.4))
    )[0]
    assert dem_gpu.laws([plain]) == {"RATTLEBOX_NORMAL": 0, "RATTLEBOX_RUBS": 1}
    assert dem_gpu.laws([plain, rolls]) == {"RATTLEBOX_NORMAL": 0}
    assert dem_gpu.laws([plain, linear]) == {"RATTLEBOX_RUBS": 1}


@pytest.mark.parametrize(
    ("run", "told"),
    [
        (lambda: rb.simulate(case(), on="cloud"), "on = 'cloud'.*\"gpu\", or nothing"),
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
