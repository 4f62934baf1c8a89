"""Bitwise reproducibility for any number of threads, after stop and restart, and for any output."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import dem_cases

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.prepare.settle import insert

CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 0

LAWS: dict[str, tuple[Any, Any]] = {
    "Hertz": (rb.Tsuji(restitution=rb.JacksonGreen()), rb.Mindlin(0.4)),
    "linear": (rb.Linear(contact_time="0.2 ms", restitution=0.8), rb.LinearSpring(0.4, ratio=0.3)),
    "yielding": (rb.Thornton(yield_pressure="20 MPa"), rb.Mindlin(0.4)),
}


def shaken(
    law: str, *, duration: float = 0.02, rate: float = 2000.0, threads: int | None = None, count: int = 400
) -> Any:
    """Return two cavities of soft spheres of two species with friction on a vibrating structure, at rest and moving."""
    soft = rb.Material(name="soft", density=2500, young=5e7, poisson=0.25, yield_stress=5e6)
    contact, friction = LAWS[law]
    common: dict[str, Any] = {
        "contact": contact,
        "friction": friction,
        "rolling": 0.05,
        "packing": rb.Lattice(noise=1.0, seed=4),
        "velocity": (0.5, 0.2, -1.0),
    }
    few = rb.Particles(name="few", material=soft, radius="2 mm", count=40)
    many = rb.Particles(name="many", material=soft, distribution=SIZES, count=count)
    return rb.Case(
        structure=rb.SDOF(mass=0.5, stiffness=2e4, damping_ratio=0.02, velocity=1.0),
        dampers=[
            rb.ParticleDamper(name="box", particles=[few, many], cavity=rb.Box(size=("40 mm",) * 3), **common),
            rb.ParticleDamper(
                name="can", particles=few, cavity=rb.Cylinder(diameter="30 mm", length="30 mm"), **common
            ),
        ],
        load=[
            rb.Harmonic(amplitude=50.0, frequency=40.0),
            rb.Record(times=[0, 0.002, 0.0035, 0.005, 0.009, max(0.02, duration)], values=[0, 40, -30, 60, -20, 0]),
            rb.HalfSine(amplitude=100.0, duration="4 ms", start="1 ms"),
        ],
        duration=duration,
        output=rb.Output(rate=rate),
        method=rb.Dem(threads=threads),
    )


SIZES = rb.NormalSizes(mean="3 mm", deviation="0.3 mm", smallest="2.5 mm", largest="3.5 mm")


def flat(value: Any) -> bytes:
    """Return the bits of all arrays in results of the core and lists of them."""
    if isinstance(value, _core.Node):
        names = sorted(value.fields().keys() - {"seconds", "memory_bytes"})
        return b"".join(flat(getattr(value, name)) for name in names)
    if isinstance(value, list):
        return b"".join(map(flat, value))
    return np.ascontiguousarray(value).tobytes()


def end(dem: Any) -> bytes:
    """Return the bits of all results of a simulation except its samples."""
    return flat(dem.state()) + flat(dem.counts()) + flat([dem.contacts(k) for k in range(2)])


@pytest.mark.parametrize("law", LAWS)
def test_threads_give_the_same_bits(law: str) -> None:
    """One, two, three and five threads compute the same bits: samples, state, contacts and counts."""
    bits = []
    for threads in (1, 2, 3, 5):
        dem, last = dem_cases.dem_of(shaken(law, duration=0.005), threads)
        dem.run(last)
        assert dem.status == 0
        bits.append(flat(dem.records()) + end(dem))
    assert len(bits[0]) > 1000 and len(set(bits)) == 1


@pytest.mark.parametrize("law", LAWS)
def test_restart_gives_the_same_bits(law: str) -> None:
    """A run from a saved state with another number of threads has the bits of the uninterrupted run, including history."""
    case = shaken(law, duration=0.01)
    whole, last = dem_cases.dem_of(case)
    for until in (7, 7, last // 3, last // 2):
        whole.run(until)
    assert sum(len(whole.contacts(k).first) for k in range(2)) > 10
    state, bits = whole.save(), end(whole)
    early = whole.records()
    whole.run(last)
    again, _ = dem_cases.dem_of(case, threads=2)
    again.restore(state)
    assert end(again) == bits
    again.run(last)
    assert end(again) == end(whole)
    assert flat(again.records()) == flat(whole.records())
    unbroken, _ = dem_cases.dem_of(case)
    unbroken.run(last)
    assert end(unbroken) == end(whole)
    assert len(early.time) < len(unbroken.records().time)


def test_very_different_sizes_give_the_same_bits() -> None:
    """A few large spheres among many small ones give the same bits for any number of threads and after a restart."""
    soft = rb.Material(name="soft", density=2500, young=5e7, poisson=0.25)
    counts = {"1.5 mm": 1500, "3.5 mm": 40, "12 mm": 4}
    kinds = [rb.Particles(name=size, material=soft, diameter=size, count=count) for size, count in counts.items()]
    cavity, radii = rb.Box(size=("36 mm",) * 3), np.repeat([each.radius for each in kinds], list(counts.values()))
    places = rb.Positions(positions=insert(cavity, radii, seed=1), velocities=np.tile((0.5, 0.2, -2), (radii.size, 1)))
    case = rb.Case(
        structure=rb.SDOF(mass=0.5, stiffness=2e4, velocity=1.0),
        damper=rb.ParticleDamper(
            particles=kinds, cavity=cavity, contact=rb.Tsuji(restitution=0.7), friction=0.3, packing=places
        ),
        duration=0.008,
        output=rb.Output(rate=2000.0),
    )
    bits = []
    for threads in (1, 2, 3):
        dem, last = dem_cases.dem_of(case, threads)
        dem.run(last // 2)
        again, _ = dem_cases.dem_of(case, threads)
        again.restore(dem.save())
        dem.records()  # those so far
        for each in (dem, again):
            each.run(last)
            assert each.status == 0
            bits.append(flat(each.records()) + flat(each.state()) + flat(each.contacts(0)))
    assert dem.counts().rebuilds > 3 and len(dem.contacts(0).first) > 100
    assert len(set(bits)) == 1


@pytest.mark.skipif(CORES == 0, reason="cores of a process can be chosen on Linux only")
def test_threads_on_one_core_give_the_same_bits() -> None:
    """Threads that share a single core yield it to each other, compute the same bits, and do not leave the core."""
    before = os.sched_getaffinity(0)
    bits = []
    try:
        os.sched_setaffinity(0, {min(before)})
        for threads in (1, 3):
            dem, last = dem_cases.dem_of(shaken("Hertz", duration=0.005), threads)
            dem.run(last)
            assert os.sched_getaffinity(0) == {min(before)}
            bits.append(flat(dem.records()) + end(dem))
    finally:
        os.sched_setaffinity(0, before)
    assert len(set(bits)) == 1


def large_bed(count: int, edge: float, *, mass: float, duration: float, rate: float) -> Any:
    """Return soft spheres that fall in a cube on a moving structure with 40 kN/m per kilogram."""
    soft = rb.Material(name="soft", density=2500, young=5e7, poisson=0.25)
    return rb.Case(
        structure=rb.SDOF(mass=mass, stiffness=4e4 * mass, velocity=1.0),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material=soft, radius="1.5 mm", count=count),
            cavity=rb.Box(size=(edge, edge, edge)),
            contact=rb.Tsuji(restitution=0.7),
            friction=rb.Mindlin(0.3),
            packing=rb.Lattice(noise=0.9, seed=2),
            velocity=(0.5, 0.2, -1.0),
        ),
        duration=duration,
        output=rb.Output(rate=rate),
    )


def test_large_beds_give_the_same_bits() -> None:
    """Results of beds that exceed the caches do not depend on threads or stops."""
    count = 21_000
    case = large_bed(count, 0.11, mass=5.0, duration=0.008, rate=1000.0)
    one, last = dem_cases.dem_of(case)
    one.run(last // 2)
    state = one.save()
    two, _ = dem_cases.dem_of(case, threads=2)
    two.restore(state)
    for dem in (one, two):
        dem.run(last)
        assert dem.status == 0
    whole, _ = dem_cases.dem_of(case, threads=3)
    whole.run(last)
    ends = [flat(dem.state()) + flat(dem.contacts(0)) + flat(dem.counts()) for dem in (one, two, whole)]
    assert len(set(ends)) == 1
    assert whole.counts().rebuilds > 5 and len(whole.contacts(0).first) > 500
    assert whole.counts().memory_bytes < 1000 * count


@pytest.mark.slow
def test_a_million_spheres() -> None:
    """A million spheres that fall on a floor run with a closed ledger and less than 1 kB per sphere."""
    count = 1_000_000
    run = rb.simulate(large_bed(count, 0.32, mass=50.0, duration=0.001, rate=10_000.0))
    assert run.ok and run.energy_residual < 0.01
    assert run.arrays.contacts[-1, 0].min() > 1000
    assert run.counts["memory_bytes"] < 1000 * count


def test_restart_in_another_process_gives_the_same_bits(tmp_path: Path) -> None:
    """Another process that continues from a file of the state ends with the same bits."""
    case = shaken("Hertz", duration=0.01)
    dem, last = dem_cases.dem_of(case)
    dem.run(last // 2)
    np.save(tmp_path / "state.npy", dem.save())
    dem.run(last)
    code = (
        "import sys, importlib; sys.path.insert(0, sys.argv[1]);"
        "importlib.import_module('verification.dem.test_bits').finish(*sys.argv[2:])"
    )
    folder = Path(__file__).resolve().parents[2]
    command = [sys.executable, "-c", code, str(folder), str(tmp_path / "state.npy"), str(tmp_path / "end")]
    subprocess.run(command, check=True)
    assert (tmp_path / "end").read_bytes() == end(dem)


def finish(state: str, target: str) -> None:
    """Finish the case of the test above from a saved state, and write the bits of its end."""
    dem, last = dem_cases.dem_of(shaken("Hertz", duration=0.01))
    dem.restore(np.load(state))
    dem.run(last)
    Path(target).write_bytes(end(dem))


@pytest.mark.parametrize("law", LAWS)
def test_output_does_not_change_the_run(law: str) -> None:
    """The end has the same bits whether every step is sampled or only the last one."""
    case = shaken(law, duration=0.004, rate=500.0)
    prepared = dem_cases.prepare(case)
    packed, step = dem_cases.pack_particles(prepared), prepared.step
    ends = []
    for every in (1, step.count):
        dem = _core.Dem(packed.replace(every=every))
        dem.run(step.count)
        ends.append(flat(dem.state()) + flat([dem.contacts(k) for k in range(2)]))
        assert len(dem.records().time) == step.count // every + 1
    assert ends[0] == ends[1]


def test_contacts_of_a_stopped_run_are_refused() -> None:
    """After an early stop the contact forces are refused; they are available at the requested end of the next run."""
    at_rest = rb.Case(
        structure=rb.Fixed(),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=50),
            cavity=rb.Box(size=("30 mm", "30 mm", "40 mm")),
            contact=rb.Tsuji(restitution=0.5),
            friction=rb.Mindlin(0.3),
            direction="z",
            packing=rb.Settled(seed=1),
            softening=1000,
        ),
        duration=100.0,
        method=rb.Dem(),
    )
    dem, last = dem_cases.dem_of(at_rest)
    dem.run(2000)  # however soon it is stopped then, all that lie on each other touch
    for _ in range(3):  # at times as many touch as before
        assert not dem.run(last, lambda _: False)
        with pytest.raises(RuntimeError, match="contact forces"):
            dem.contacts(0)
        dem.run(dem.step + 1)
        assert len(dem.contacts(0).first) > 50


@pytest.mark.parametrize("threads", [1, pytest.param(2, marks=pytest.mark.slow), 3])
def test_a_run_that_is_stopped_again_and_again_gives_the_same_bits(threads: int) -> None:
    """After a stop at any step all workers are at the same step, and the run continues with the same bits."""
    case = shaken("Hertz", rate=500.0, duration=0.1)  # many times as long as it takes to be heard
    whole, last = dem_cases.dem_of(case)
    whole.run(last)
    dem, _ = dem_cases.dem_of(case, threads=threads)
    steps = [dem.step]
    while not dem.run(last, lambda _: False):
        steps.append(dem.step)
    assert len(set(steps)) > 3
    assert flat(dem.records()) + end(dem) == flat(whole.records()) + end(whole)


@pytest.mark.skipif(CORES == 0, reason="cores of a process can be chosen on Linux only")
@pytest.mark.skipif(CORES == 1, reason="a team is held up on cores that it shares: two are needed")
def test_contention_leaves_one_worker() -> None:
    """If other programs use the cores, a single worker runs for a while, with the same bits."""
    before = os.sched_getaffinity(0)
    command = [sys.executable, "-c", "import time\nend = time.time() + 30\nwhile time.time() < end: pass"]
    case = shaken("Hertz", duration=0.02)
    alone, last = dem_cases.dem_of(case)
    alone.run(last)
    others: list[subprocess.Popen[bytes]] = []
    try:
        os.sched_setaffinity(0, sorted(before)[:2])
        others += [subprocess.Popen(command) for _ in range(4)]
        lone = 0
        for _ in range(20):  # whether others hold a team up is up to them
            crowded, _ = dem_cases.dem_of(case, 2)
            crowded.run(last)
            lone += crowded.serial_steps
            assert flat(crowded.records()) + end(crowded) == flat(alone.records()) + end(alone)
            if lone:
                break
        assert lone > 0
    finally:
        for other in others:
            other.kill()
            other.wait()
        os.sched_setaffinity(0, before)
