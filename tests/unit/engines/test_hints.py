"""Hints that name a number or a choice: whoever follows them gets a case that runs, and is not sent in a circle."""

from __future__ import annotations

import itertools
import re
import time
import tracemalloc
from typing import Any

import pytest

import rattlebox as rb
from rattlebox.prepare.settle import compact, insert

CAVITIES = {
    "can": rb.Cylinder(diameter="40 mm", length="60 mm", axis="x"),
    "box": rb.Box(size=("60 mm", "20 mm", "30 mm")),
    "sphere": rb.SphericalCavity(diameter="45 mm"),
    "plate": rb.Cylinder(diameter="80 mm", length="9 mm", axis="z"),
}
UP = (0, 0, -9.81)
PACKINGS = {"lattice": rb.Lattice(), "settled": rb.Settled(seed=1), "compacted": rb.Compacted(seed=1)}


def attempt(wanted: dict[str, Any]) -> None:
    """Fill a cavity as is wanted; settled particles are inserted, which is where they may be too many."""
    particles = rb.Particles(material="steel", **wanted["particles"])
    damper = rb.ParticleDamper(**{**wanted, "particles": particles, "contact": rb.Tsuji(restitution=0.6)})
    if isinstance(damper.packing, rb.Settled):
        insert(damper.cavity, damper.contents.radius, damper.packing.seed)
    if isinstance(damper.packing, rb.Compacted):
        compact(damper)


def followed(wanted: dict[str, Any], message: str, way: int) -> dict[str, Any]:
    """Return what a message advises instead; where it names several ways, the one of that number."""
    tried = message.rpartition("try: ")[2]
    ways: list[dict[str, Any]] = []
    amounts = {
        name: value for name, value in wanted["particles"].items() if name not in ("count", "fill_ratio", "mass")
    }
    for kind in re.findall(r'packing = \{ kind = "(\w+)" \}', tried):
        ways.append({"packing": PACKINGS[kind]})
    if gravity := re.search(r"gravity = \[0, 0, -9.81\]", tried):
        assert gravity
        ways.append({"gravity": UP})
    if most := re.search(r"(\d+) of them", tried):
        ways.append({"particles": {**amounts, "count": int(most[1])}})
    if filled := re.search(r"a fill ratio of ([\d.]+)", tried):
        ways.append({"particles": {**amounts, "fill_ratio": float(filled[1])}})
    assert ways, f"nothing to follow in: {message}"
    return {**wanted, **ways[way % len(ways)]}


PARTICLES: dict[str, dict[str, Any]] = {
    "8 mm 0.9": {"diameter": "8 mm", "fill_ratio": 0.9},
    "8 mm 0.6": {"diameter": "8 mm", "fill_ratio": 0.6},
    "3 mm 0.7": {"diameter": "3 mm", "fill_ratio": 0.7},
    "8 mm 10000": {"diameter": "8 mm", "count": 10_000},
    "mixed 0.75": {
        "distribution": rb.NormalSizes(mean="5 mm", deviation="1 mm", smallest="3 mm", largest="8 mm"),
        "fill_ratio": 0.75,
    },
}
GRAVITIES = {"gravity": UP, "no gravity": (0, 0, 0)}
TAKE_SECONDS = {("8 mm 0.6", "compacted"), ("3 mm 0.7", "compacted"), ("3 mm 0.7", "settled")}
"""Fills that take seconds, by particles and packing."""


def fills() -> list[Any]:
    """Return all fills and ways; those whose particles take seconds to place are slow, but for one cavity."""
    result = []
    for names in itertools.product(CAVITIES, PARTICLES, PACKINGS, GRAVITIES, range(3)):
        cavity, particles, packing, gravity, way = names
        seconds = (particles, packing) in TAKE_SECONDS and (cavity, gravity) != ("sphere", "gravity")
        marks = [pytest.mark.slow] if seconds or way > 0 else []
        result.append(pytest.param(*names, id="-".join(map(str, names)), marks=marks))
    return result


@pytest.mark.parametrize(("cavity", "particles", "packing", "gravity", "way"), fills())
def test_hints_for_fills_lead_to_a_case_that_runs(
    cavity: str, particles: str, packing: str, gravity: str, way: int
) -> None:
    """Following any advice of the messages, at most two of them appear before the cavity is filled."""
    wanted = {
        "cavity": CAVITIES[cavity],
        "particles": PARTICLES[particles],
        "packing": PACKINGS[packing],
        "gravity": GRAVITIES[gravity],
    }
    for _ in range(3):
        try:
            attempt(wanted)
            break
        except rb.CaseError as error:
            wanted = followed(wanted, str(error), way)
    else:
        attempt(wanted)


def test_a_fill_that_a_hint_names_settles_and_runs() -> None:
    """The number of particles in the hint for 90 % of a can settles and runs."""
    wanted = {
        "cavity": CAVITIES["can"],
        "particles": {"diameter": "8 mm", "count": 253},
        "packing": rb.Settled(seed=1),
        "gravity": UP,
    }
    with pytest.raises(rb.CaseError) as refused:
        attempt(wanted)
    wanted = followed(wanted, str(refused.value), 0)
    particles = rb.Particles(material="steel", **wanted["particles"])
    damper = rb.ParticleDamper(**{**wanted, "particles": particles, "contact": rb.Tsuji(restitution=0.6)})
    run = rb.simulate(rb.Case(structure=rb.SDOF(mass=3, stiffness=1e6), duration="1 ms", damper=damper))
    assert run.ok


@pytest.mark.parametrize("packing", [rb.Settled(), rb.Lattice()], ids=lambda packing: packing.kind)
@pytest.mark.parametrize("amount", [{"count": 40_000_000}, {"mass": "1 t"}])
def test_far_too_many_are_refused_at_once(packing: Any, amount: dict[str, Any]) -> None:
    """Millions of particles in a box of 20 mm are refused before anything is made for each of them."""
    sizes = (
        {"diameter": "3 mm"},
        {"distribution": rb.NormalSizes(mean=3e-3, deviation=1e-3, smallest=1e-3, largest=5e-3)},
    )
    for size in sizes:
        tracemalloc.start()
        start = time.perf_counter()
        with pytest.raises(rb.CaseError, match="do not fit"):
            rb.ParticleDamper(
                particles=rb.Particles(material="steel", **size, **amount),
                cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
                contact=rb.Tsuji(restitution=0.6),
                packing=packing,
            )
        took = time.perf_counter() - start
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert took < 2
        assert peak < 50e6


def test_more_than_memory_holds_is_refused_before_it_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Particles for which there is room, but no memory, are refused with how many there is memory for."""
    monkeypatch.setattr("rattlebox.model.particle_damper.memory", lambda: 1e6)
    with pytest.raises(rb.ResourceError, match=r"this machine has 0\.001 GB") as refused:
        attempt(
            {"cavity": CAVITIES["can"], "particles": {"diameter": "1 mm", "count": 20_000}, "packing": rb.Lattice()}
        )
    most = int(float(re.search(r"at most (\S+) of them", str(refused.value))[1]))  # type: ignore[index]
    attempt({"cavity": CAVITIES["can"], "particles": {"diameter": "1 mm", "count": most}, "packing": rb.Lattice()})


def test_a_fill_ratio_of_a_damper_is_one_of_its_particles() -> None:
    """For amounts and sizes set on the damper, the message suggests the path of its particles, in cases and axes."""
    usual: dict[str, Any] = {"cavity": CAVITIES["can"], "contact": rb.Tsuji(restitution=0.6)}
    steel = rb.Particles(material="steel", diameter="8 mm", count=20)
    for name in ("fill_ratio", "count", "diameter"):
        with pytest.raises(rb.CaseError, match=rf"'particles\.{name}'"):
            rb.ParticleDamper(particles=steel, **usual, **{name: 0.1})
    case = rb.Case(structure=rb.Fixed(), duration="1 ms", damper=rb.ParticleDamper(particles=steel, **usual))
    with pytest.raises(rb.CaseError, match=r"'particles\.fill_ratio'"):
        rb.sweep(case, {"damper.fill_ratio": [0.1, 0.2]})
