"""Particles in space on a card: the rows that `python benchmarks/gpu.py` adds for them.

The shaken box of particles.py. Rates count steps of particles in launches, with cases brought to the card and back.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from particles import shaken

from rattlebox.engines.card import Card
from rattlebox.engines.core import core
from rattlebox.engines.dem import pack_dem
from rattlebox.engines.dem_gpu import CardDem, run_together

CLOSE = 1e-10
BANDWIDTH = {"H200": 4.8e12, "H100": 3.35e12, "A100": 2.0e12, "B200": 8.0e12}
Row = tuple[str, str, str, str]


def prepared(count: int, steps: int) -> dict[str, Any]:
    """Pack a box that is sampled twice."""
    packed, _, _ = pack_dem(shaken(count))
    return {**packed, "steps": steps, "every": steps}


def bytes_of_a_step(candidates: float, contacts: float, owners: float, touching: float) -> float:
    """Bytes that a particle-step of the grid kernel moves, as counted in docs/gpu.md."""
    return 180 + 28 * candidates + 352 * contacts + 136 * owners + 192 * touching


def first_impacts() -> Row:
    """Places of 1000 particles after the first hundred impacts."""
    packed = prepared(1000, 20_000)
    here, there = core().Dem(packed), CardDem(packed)
    for until in range(0, packed["steps"], 20):
        here.run(until)
        if here.counters()["first_touches"].sum() >= 100:
            break
    there.run(until)
    a, b = (dem.state()["cavities"][0]["position"] for dem in (here, there))
    off = float(np.max(np.abs(a - b)) / np.max(np.abs(a)))
    return (
        "particles: first impacts, largest difference",
        "",
        f"{off:.1e}",
        "ok" if off < CLOSE else f"not below {CLOSE}",
    )


def on_one_core(packed: dict[str, Any], steps: int) -> float:
    """Particle-steps a second of the processor's engine."""
    dem = core().Dem(packed)
    dem.run(min(steps, packed["steps"]))
    return len(packed["cavities"][0]["radius"]) * dem.step / dem.counters()["seconds"]


def batch(count: int, cases: int, steps: int) -> Row:
    """Many small boxes side by side."""
    card, packed = Card(), prepared(count, steps)
    dems = [CardDem(packed, card) for _ in range(cases)]
    run_together(dems, 50, card)  # compiles, and finds room
    begin = time.perf_counter()
    run_together(dems, steps, card)
    rate = count * cases * (steps - 50) / (time.perf_counter() - begin)
    one = on_one_core(packed, 2_000_000 // count)
    return f"particle-steps/s, {cases} x {count}", f"{one:.3g}", f"{rate:.3g}", "goal: 2e9"


def large(count: int, before: int, steps: int) -> Row:
    """One large box, and the share of the memory's bandwidth that it uses by the count of bytes."""
    card, packed = Card(), prepared(count, 10 * (before + steps))
    dem = CardDem(packed, card)
    dem.run(before)  # until the particles lie on each other
    begin = time.perf_counter()
    dem.run(before + steps)
    rate = count * steps / (time.perf_counter() - begin)
    found = dem.contacts(0)
    pairs = found["second"] < count
    touching = np.unique(np.concatenate([found["first"], found["second"][pairs]])).size / count
    owners = np.unique(found["first"]).size / count
    each = bytes_of_a_step(3.0, found["first"].size / count, owners, touching)
    most = next((speed for name, speed in BANDWIDTH.items() if name in card.name), float("nan"))
    share = f"{rate * each / most:.0%} of {most / 1e12:.1f} TB/s (goal: 50 %)"
    told = f"{each:.0f} B each, 3 candidates assumed: {share}"
    return f"particle-steps/s, one of {count:,}", "", f"{rate:.3g}", told


def same_bits(steps: int) -> Row:
    """The same bits twice."""
    packed = prepared(1500, steps)
    ends = []
    for _ in range(2):
        dem = CardDem(packed)
        dem.run(steps)
        ends.append(dem.state()["cavities"][0]["position"])
    same = np.array_equal(*ends)
    return "particles: the same bits twice", "", "yes" if same else "no", "ok" if same else "not deterministic"


def little() -> None:
    """What compute-sanitizer looks at."""
    dem = CardDem(prepared(60, 400))
    dem.run(400)


def jobs(short: bool) -> dict[str, Callable[[], Row]]:
    """Return what to measure, by name."""
    return {
        "particles: first impacts": first_impacts,
        "particles: the same bits": lambda: same_bits(60 if short else 4000),
        "particles: 100": lambda: batch(100, *((4, 150) if short else (2048, 20_000))),
        "particles: 1000": lambda: batch(1000, *((2, 100) if short else (512, 5_000))),
        "particles: a million": lambda: large(*((2_500, 10, 10) if short else (1_000_000, 4000, 1000))),
    }
