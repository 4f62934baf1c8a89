"""What a card computes is what the processor computes, but for how it rounds."""

from __future__ import annotations

import os
from time import perf_counter
from typing import Any

import numpy as np
import pytest
from tests.unit.engines.gpu_cases import CASES

import rattlebox as rb
from rattlebox.engines.batch import Look, run_block
from rattlebox.engines.card import Card
from rattlebox.engines.gpu_impact import ready
from rattlebox.engines.pack import pack_batch
from rattlebox.engines.status import STATUSES
from rattlebox.paper.seed import seed_case
from rattlebox.studies.axes import Design
from rattlebox.studies.measures import MEASURES
from rattlebox.studies.task import SweepTask

from .conftest import Watched

ALIKE = "STAND_IN_ALIKE" in os.environ  # what is no card may round as the processor does


@pytest.mark.parametrize(("group", "name"), [(group, name) for group, named in CASES.items() for name in named])
def test_a_card_agrees_with_the_processor(group: str, name: str) -> None:
    """Every part of a case gives the same status, and measures that differ by what a few impacts make of rounding."""
    case, axes, look = CASES[group][name]
    named = [measure for measure, about in MEASURES.items() if "cycles" in look or not about.cyclic]
    kept = {key: value for key, value in look.items() if key != "state"}
    if not ALIKE:  # later impacts make too much of a last digit
        case = case.model_copy(update={"duration": min(case.duration, 0.1)})
        kept |= {"cycles": (0, 1)} if "cycles" in look else {}
    here, there = (rb.sweep(case, axes, named, samples=101, on=on, **kept) for on in (None, "gpu"))
    np.testing.assert_array_equal(there.status, here.status)
    names = {STATUSES[status][0] for status in here.status.values.flat}
    assert names == {"finished"} if group != "ending" else name in names
    for measure in here.data_vars:
        size = 1.0 if measure == "closure" else float(np.abs(here[measure]).max())
        close = {"rtol": 0.0} if ALIKE else {"rtol": 1e-6, "atol": 1e-9 * size}
        np.testing.assert_allclose(there[measure], here[measure], **close, err_msg=str(measure))


def test_the_same_bits_twice(card: Card) -> None:
    """Two runs on a card give the same bits, whichever thread takes which variant."""
    axes = {"damper.start": rb.linspace(-1.0, 1.0, 300 * card.multiprocessors)}
    one, other = (rb.sweep(seed_case(duration=0.5), axes, ["impacts", "impact_share"], on="gpu") for _ in range(2))
    for measure in one.data_vars:
        np.testing.assert_array_equal(one[measure], other[measure])


def test_kernels_are_compiled_once_on_a_machine(card: Card) -> None:
    """The second time they come from the cache."""
    ready()
    assert "cache" in ready()[1] and card.arch in ready()[1]


def shaken(**more: Any) -> rb.Case:
    """Return a ball that a shaker throws from wall to wall, again and again the same way."""
    usual: dict[str, Any] = {
        "structure": rb.Shaker(motion=rb.Harmonic(amplitude="3 mm", frequency="12 Hz")),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", start=0.3, contact=rb.Tsuji(restitution=0.6)
        ),
        "duration": "1 s",
    }
    return rb.Case(**usual | more)


def test_pairs_and_walks_are_those_of_the_processor() -> None:
    """Exponents of a motion that repeats, and a frequency response, each value of which goes on from the one before."""
    axes = {"structure.motion.amplitude": ["3 mm"]}
    here, there = (rb.lyapunov(shaken(), axes, cycles=(20, 10), pairs=2, on=on) for on in (None, "gpu"))
    np.testing.assert_allclose(there.exponent, here.exponent, rtol=1e-4)
    structure = rb.SDOF(mass="1 kg", stiffness="4 kN/m", damping_ratio=0.05)
    load = rb.Harmonic(amplitude="5 N", frequency="9 Hz")
    case = shaken(structure=structure, load=load, method=rb.Newton(restitution=0.3))
    options: dict[str, Any] = {"levels": ["20 N", "40 N"], "cycles": (60, 8)}
    here, there = (rb.frequency_response(case, [8.0, 9.0], on=on, **options) for on in (None, "gpu"))
    assert (here.period == 1).all()
    np.testing.assert_array_equal(there.period, here.period)
    np.testing.assert_allclose(there.amplitude, here.amplitude, rtol=1e-6)


def test_members_go_to_a_card_at_once(watched: Watched) -> None:
    """As many threads as fit the card take members one after the other, from any of them on."""
    case, axes = CASES["output"]["motion"].case, {"damper.gap": list(np.linspace(5e-4, 2e-3, 700))}
    task = SweepTask(case, Design.of(case, axes), measures=["impacts", "peak"], cycles=(0, 1), samples=11, motion=True)
    told: list[int] = []
    whole = run_block(task.packed, (700,), 0, 700, task.look, gpu=True)
    part = run_block(task.packed, (700,), 10, 700, task.look, gpu=True, progress=told.append)
    assert whole is not None and part is not None and np.all(part["impacts"] > 0) and told[-1] == 690
    for name, values in part.items():
        np.testing.assert_array_equal(values, whole[name][10:])
    assert [blocks for blocks in watched.blocks if blocks > 1]


@pytest.mark.parametrize("method", [rb.EventDriven(max_events=10**9), rb.Newton(max_events=10**9), rb.TwoStep()])
def test_a_launch_is_stopped_in_its_middle(method: Any) -> None:
    """Threads hear a stop at their next event, where a member takes minutes and all of them days; so when Ctrl-C comes."""
    case = shaken(duration="1e6 s", method=method)
    packed = pack_batch(case, {"damper.gap": np.linspace(5e-4, 2e-3, 500)}, (500,))
    told: list[int] = []

    def pressed(done: int) -> bool:
        told.append(done)
        if len(told) > 3:
            raise KeyboardInterrupt
        return True

    begin = perf_counter()
    assert run_block(packed, (500,), 0, 500, Look(), gpu=True, progress=lambda done: False) is None
    with pytest.raises(KeyboardInterrupt):
        run_block(packed, (500,), 0, 500, Look(), gpu=True, progress=pressed)
    assert told == [0, 0, 0, 0]
    assert np.all(rb.sweep(shaken(), {"damper.gap": ["1 mm"]}, ["impacts"], on="gpu").impacts > 0)
    assert perf_counter() - begin < 60


def test_memory_is_given_back(card: Card) -> None:
    """What was used is free again, so that the next study has as much room."""
    free, _ = card.memory()
    with card.room(free // 2):
        assert card.memory()[0] <= free - free // 2
    assert card.memory()[0] == free


def test_memory_that_another_program_took_is_told(card: Card) -> None:
    """More than there is at the moment is refused with both numbers."""
    free, total = card.memory()
    with pytest.raises(
        rb.CaseError, match=r"GiB are needed on the card at once, .* GiB are free[\s\S]*try: nvidia-smi"
    ):
        card.room(2 * total).__enter__()
    assert card.memory()[0] == free
