"""The step of wide teams, which GPUs run, on the processor: the same bits for any team and order, the same physics."""

from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.engines.core import core
from rattlebox.engines.dem import pack_dem

from . import cases
from .test_bits import LAWS, shaken
from .varieties import VARIETIES, agree, pair, told

TEAMS = [(1, "reverse"), (1, "shuffled"), (2, "forward"), (7, "interleaved"), (32, "shuffled")]


def wide(packed: Any, until: int, *, threads: int = 1, order: str = "forward", **room: int) -> Any:
    """Run a packed case by a wide team."""
    dem = core().DemWide(packed, **room)
    assert dem.run(until, threads, order)
    return dem


def differing(one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """Names of what is not equal, bit by bit."""
    return [key for key in one if not np.array_equal(one[key], other[key])]


@pytest.mark.parametrize("law", LAWS)
def test_any_team_gives_the_same_bits(law: str) -> None:
    """Teams of 1 to 32 members, who take particles in any order, agree in every number that a run tells."""
    packed, _, _ = pack_dem(shaken(law, duration=0.005, count=150))
    until = packed["steps"] // 3
    alone = told(wide(packed, until))
    for threads, order in TEAMS[: 3 if law != "Hertz" else None]:
        assert differing(alone, told(wide(packed, until, threads=threads, order=order))) == [], (threads, order)


def many(count: int) -> Any:
    """Return a packed box of so many spheres that fly into each other."""
    case = rb.Case(
        structure=rb.SDOF(mass=50.0, stiffness=2e6, damping_ratio=0.02, velocity=1.0),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", radius="2 mm", count=count),
            cavity=rb.Box(size=(0.0045 * count ** (1 / 3),) * 3),
            contact=rb.Tsuji(restitution=0.7),
            friction=rb.Mindlin(0.3),
            softening=1000.0,
            packing=rb.Lattice(noise=1.0, seed=2),
        ),
        duration="10 ms",
        output=rb.Output(rate=20_000.0),
    )
    packed, _, _ = pack_dem(case)
    packed["cavities"][0]["velocity"] = np.random.default_rng(1).normal(size=(count, 3))
    return packed


def renamed(packed: Any, names: Any) -> Any:
    """Return a case whose particles of the first cavity have other numbers: the k-th was names[k]."""
    first, *rest = packed["cavities"]
    each = ("position", "velocity", "spin", "radius", "mass", "inertia", "kind")
    return {
        **packed,
        "cavities": [{**first, **{name: np.ascontiguousarray(first[name][names]) for name in each}}, *rest],
    }


def test_totals_of_many_are_the_same_bits() -> None:
    """Where trees are so many that all of a team sum them up, any team still agrees in every bit."""
    packed = many(34_000)
    alone = told(wide(packed, 200))
    assert alone["first_touches"].sum() > 1000 and len(alone["time"]) > 3
    for threads, order in [(3, "shuffled"), (2, "interleaved")]:
        assert differing(alone, told(wide(packed, 200, threads=threads, order=order))) == [], (threads, order)


def test_memory_follows_space() -> None:
    """Particles that are near in space are so in memory, whatever their numbers are, and are told by their numbers."""
    packed = many(3000)
    names = np.random.default_rng(3).permutation(3000)
    dem = wide(renamed(packed, names), 400)
    assert dem.counters()["rebuilds"] > 3
    contacts, place = dem.contacts(0), dem.state()["cavities"][0]["position"]
    owners = contacts["first"]  # as they lie in memory
    assert len(owners) > 300
    steps = np.diff(place[owners], axis=0)
    assert np.median(np.abs(steps[:, 2])) < 0.002 < np.median(np.abs(steps[:, 0])) < 0.03
    pairs = contacts["second"] < 3000
    apart = place[contacts["second"][pairs]] - place[owners[pairs]]
    assert np.linalg.norm(apart, axis=1).max() < 0.0041


def test_numbers_do_not_matter() -> None:
    """With other numbers, and so other owners of contacts, particles do the same to rounding."""
    packed, _, _ = pack_dem(shaken("Hertz", duration=0.02, count=150))
    names = np.random.default_rng(5).permutation(len(packed["cavities"][0]["radius"]))
    one, other = core().DemWide(packed), core().DemWide(renamed(packed, names))
    for until in range(0, packed["steps"], packed["steps"] // 200):
        for dem in (one, other):
            dem.run(until)
        if one.counters()["first_touches"].sum() >= 20:
            break
    assert one.counters()["rebuilds"] > 1
    np.testing.assert_array_equal(other.counters()["first_touches"], one.counters()["first_touches"])
    here, there = (dem.state()["cavities"][0] for dem in (one, other))
    for key in ("position", "velocity", "spin"):
        scale = np.max(np.abs(here[key]))
        np.testing.assert_allclose(there[key], here[key][names], rtol=0, atol=1e-10 * scale, err_msg=key)


def test_room_grows_and_changes_nothing() -> None:
    """A run that begins with too few slots and little room for samples is that which had enough from the start."""
    packed, _, _ = pack_dem(shaken("Hertz", duration=0.004))
    until = packed["steps"]
    small, large = (wide(packed, until, slots=slots, samples=samples) for slots, samples in ((1, 2), (32, 1000)))
    assert 1 < max(small.counters()["slots"]) < 32
    assert differing(told(small), told(large)) == []


def test_an_image_goes_on_elsewhere() -> None:
    """The memory of a run, moved to another address and taken back, goes on as if it had stayed."""
    packed, _, _ = pack_dem(shaken("yielding", duration=0.004, count=60))
    half = packed["steps"] // 2
    stayed, moved = wide(packed, packed["steps"]), wide(packed, half)
    image = moved.image(1 << 40)
    heir = core().DemWide(packed)
    heir.absorb(image)
    assert heir.step == half + 1
    first = moved.records()
    heir.run(packed["steps"])
    second, whole = heir.records(), stayed.records()
    assert all(np.array_equal(np.concatenate([first[key], second[key]]), whole[key]) for key in whole)
    with pytest.raises(ValueError, match="another case"):
        core().DemWide(
            pack_dem(shaken("Hertz", duration=0.004, count=60))[0] | {"contacts": []} | {"cavities": []}
        ).absorb(image)


# ---- against the engine of lists and lanes


@pytest.mark.parametrize("variety", VARIETIES)
def test_first_impacts_are_those_of_the_other_engine(variety: str) -> None:
    """Every law, wall and structure: after several oblique impacts both engines agree to rounding."""
    packed, _, _ = pack_dem(pair(VARIETIES[variety]))
    other, own = core().Dem(packed), core().DemWide(packed)
    for dem in (other, own):
        dem.run(packed["steps"])
    theirs, ours = (dem.counters()["first_touches"] for dem in (other, own))
    assert np.sum(ours) >= 5
    np.testing.assert_array_equal(ours, theirs)
    agree(other, own, to=1e-7)


def test_many_balls_agree_at_first() -> None:
    """Before chaos has its say, a bed of 230 rough balls in two cavities moves alike in both engines."""
    packed, _, _ = pack_dem(shaken("Hertz", duration=0.02, count=150))
    other, own = core().Dem(packed), core().DemWide(packed)
    for until in range(0, packed["steps"], packed["steps"] // 200):
        for dem in (other, own):
            dem.run(until)
        if other.counters()["first_touches"].sum() >= 20:
            break
    np.testing.assert_array_equal(own.counters()["first_touches"], other.counters()["first_touches"])
    agree(other, own, to=1e-10)


def test_many_balls_agree_on_the_whole() -> None:
    """Over a thousand impacts both engines lose the same energy in the same ways, and both ledgers close alike."""
    packed, _, _ = pack_dem(shaken("Hertz", count=150))
    shares = []
    for dem in (core().Dem(packed), core().DemWide(packed)):
        dem.run(packed["steps"])
        r = dem.records()
        lost = [r[f"{name}_loss"][-1].sum() for name in ("normal", "sliding", "rolling")]
        held = sum(r[name].sum(axis=1) for name in ("kinetic", "rotation", "potential", "elastic"))
        held += 0.5 * (r["p"] ** 2 + packed["mode_stiffness"] * r["q"] ** 2).sum(axis=1)
        put_in = r["load_work"][-1].sum() + r["base_work"][-1].sum()
        closure = (put_in - sum(lost) - r["viscous_loss"][-1].sum() - (held[-1] - held[0])) / held[0]
        shares.append([*(each / sum(lost) for each in lost), sum(lost) / held[0]])
        assert abs(closure) < 2e-3
        assert dem.counters()["first_touches"].sum() > 1000
    np.testing.assert_allclose(shares[1], shares[0], rtol=0.1)


# ---- what goes wrong


def test_a_particle_that_escapes_is_told() -> None:
    """A ball that is shot through a wall stops the run, with its number, the wall and its speed, for any team."""
    fast = cases.Ball(2e-3, position=(2e-3, 0, 0), velocity=(5e4, 0, 0))
    slow = cases.Ball(2e-3, position=(-4e-3, 0, 0))
    packed, _, _ = pack_dem(
        cases.case(
            [slow, fast], dt=2e-7, steps=100, cavity=rb.Box(size=("20 mm",) * 3), contact=rb.Tsuji(restitution=0.8)
        )
    )
    stops = []
    for threads, order in [(1, "forward"), *TEAMS[:3]]:
        dem = core().DemWide(packed)
        dem.run(packed["steps"], threads, order)
        assert dem.status == 7
        stops.append(dem.stopped())
    assert stops[0]["particle"] == 1
    assert stops[0]["speed"] == pytest.approx(5e4, rel=0.5)
    assert all(stop == stops[0] for stop in stops)


def test_a_speed_beyond_the_law_is_told() -> None:
    """A restitution law that ends below the speed of an impact stops the run."""
    ball = cases.Ball(2e-3, velocity=(150.0, 0, 0), material="aluminium")
    law = rb.Tsuji(restitution=rb.JacksonGreen())
    packed, _, _ = pack_dem(cases.case([ball], dt=1e-8, steps=6000, cavity=rb.Box(size=("6 mm",) * 3), contact=law))
    other, own = core().Dem(packed), core().DemWide(packed)
    for dem in (other, own):
        dem.run(packed["steps"])
    assert own.status == other.status == 1
    assert own.stopped() == pytest.approx(other.stopped())


def test_orders_have_names() -> None:
    """An order that does not exist is refused with those that do."""
    packed, _, _ = pack_dem(pair({}))
    with pytest.raises(ValueError, match="forward, reverse, interleaved or shuffled"):
        core().DemWide(packed).run(10, 1, "sideways")


def test_too_many_neighbours_are_told_with_their_number() -> None:
    """Where spheres lie within each other so that slots do not suffice, the number that would is told."""
    packed = many(60)
    packed["cavities"][0]["position"] = np.random.default_rng(1).normal(scale=2e-4, size=(60, 3))
    with pytest.raises(ValueError, match=r"a particle has 59 walls and particles .* 32 at most can be followed"):
        core().DemWide(packed).run(10)
