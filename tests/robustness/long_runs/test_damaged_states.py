"""Saved states of particle runs that were changed without a wrong checksum: refused or harmless, never a crash."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.prepare.particles import pack_particles, prepare

FLIPS = 1500


def shaken(kind: str) -> rb.Case:
    """Return a shaken case with particles of two sizes and all kinds of contact history."""
    contact: Any = {
        "hertz": rb.Tsuji(restitution=0.7),
        "yielding": rb.Thornton(yield_pressure="20 MPa"),
    }[kind]
    boxes = [
        rb.ParticleDamper(
            name=name,
            particles=[
                rb.Particles(material="steel", diameter="4 mm", count=count),
                rb.Particles(name="fine", material="steel", diameter="2 mm", count=count),
            ],
            cavity=cavity,
            contact=contact,
            friction=0.3,
            rolling=rb.Rolling(0.1),
            packing=rb.Settled(seed=1),
            softening=1000,
        )
        for name, count, cavity in (
            ("box", 80, rb.Box(size=("20 mm", "20 mm", "30 mm"))),
            ("can", 5, rb.Cylinder(diameter="16 mm", length="20 mm", axis="z")),
        )
    ]
    motion = rb.Harmonic(amplitude="1 mm", frequency="60 Hz", direction="z")
    return rb.Case(structure=rb.Shaker(motion=motion), dampers=boxes, duration="4 ms", output=rb.Output(rate="2 kHz"))


def run_flipped(kind: str, seed: int) -> tuple[int, int]:
    """Restore states with one flipped bit and run on; return the numbers of refused and of accepted states."""
    prepared = prepare(shaken(kind))
    packed, step = pack_particles(prepared), prepared.step
    first = _core.Dem(packed)
    first.run(step.count // 2)
    state = np.asarray(first.save())
    rng = np.random.default_rng(seed)
    refused = ran = 0
    for _ in range(FLIPS):
        changed = state.copy()
        changed[rng.integers(state.size)] ^= np.uint8(1 << int(rng.integers(8)))
        dem = _core.Dem(packed)
        try:
            dem.restore(changed)
        except ValueError:
            refused += 1
            continue
        dem.run(min(dem.step + 60, step.count))
        dem.state(), dem.counts(), dem.records()
        if dem.status:
            dem.stopped()
        ran += 1
    return refused, ran


@pytest.mark.parametrize("kind", ["hertz", "yielding"])
def test_flipped_bits_do_not_crash(kind: str) -> None:
    """No flipped bit of a state ends the process; indices and counts out of range are refused."""
    done = subprocess.run(
        [sys.executable, "-c", f"import test_damaged_states as t; print(*t.run_flipped({kind!r}, 1))"],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    refused, ran = map(int, done.stdout.split())
    assert refused > FLIPS / 20
    assert refused + ran == FLIPS


def test_changed_state_in_an_intact_archive_is_refused(tmp_path: Path) -> None:
    """A checkpoint with valid checksums but a changed state is refused with its name before the run."""
    case, path = shaken("hertz"), tmp_path / "run.checkpoint"
    assert rb.simulate(case, checkpoint=path).ok
    with np.load(path) as file:
        members = {name: file[name] for name in file.files}
    packed = pack_particles(prepare(case))
    members["state"] = members["state"].copy()
    members["state"][-2000:] ^= np.uint8(0x55)
    assert _core.Dem(packed).restore(np.load(path)["state"]) is None
    with path.open("wb") as content:
        np.savez(content, **members)
    with pytest.raises(rb.DataError, match=r"run\.checkpoint is (damaged|not an intact checkpoint)"):
        rb.simulate(case, checkpoint=path)
