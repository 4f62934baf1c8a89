"""What a card computes is what the processor computes, but for how it rounds."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.engines.card import Card
from rattlebox.engines.gpu_impact import ready
from rattlebox.paper.seed import seed_case
from rattlebox.studies.axes import Design
from rattlebox.studies.measures import MEASURES
from rattlebox.studies.task import SweepTask

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
    damper = shaken().dampers[0].model_copy(update={"contact": rb.Tsuji(restitution=0.3)})
    structure = rb.SDOF(mass="1 kg", stiffness="4 kN/m", damping_ratio=0.05)
    case = shaken(structure=structure, damper=damper, load=rb.Harmonic(amplitude="5 N", frequency="9 Hz"))
    options: dict[str, Any] = {"levels": ["20 N", "40 N"], "cycles": (60, 8)}
    here, there = (rb.frequency_response(case, [8.0, 9.0], on=on, **options) for on in (None, "gpu"))
    assert (here.period == 1).all()
    np.testing.assert_array_equal(there.period, here.period)
    np.testing.assert_allclose(there.amplitude, here.amplitude, rtol=1e-6)


def test_a_launch_is_stopped_in_its_middle() -> None:
    """Threads hear a stop long before their member ends, which would take an hour."""
    case = shaken(duration="1e6 s", method=rb.Newton(max_events=10**9))
    task = SweepTask(case, Design.of(case, {"damper.gap": rb.linspace("0.5 mm", "1 mm", 1000)}), ["impacts"]).on_card()
    begin = perf_counter()
    assert task.run(0, 1000, cancelled=lambda _: perf_counter() > begin + 2) is None
    assert np.all(rb.sweep(shaken(), {"damper.gap": ["1 mm"]}, ["impacts"], on="gpu").impacts > 0)
    assert perf_counter() - begin < 60
