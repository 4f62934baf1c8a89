"""Particles in two cavities on a structure: a case whose contacts remember much, and a command that runs it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

import rattlebox as rb
from rattlebox.results import Run


def case(**changes: Any) -> rb.Case:
    """Return two dampers: one settled with friction, rolling and restitutions, one that dents."""
    steel = rb.Particles(material="steel", diameter="6 mm", count=40)
    settled = rb.ParticleDamper(
        name="settled",
        particles=steel,
        cavity=rb.Box(size=("30 mm", "30 mm", "40 mm")),
        contact=rb.Tsuji(restitution=rb.JacksonGreen(extrapolate=True)),
        friction=0.3,
        rolling=0.01,
        packing=rb.Settled(seed=3),
        softening=100,
    )
    denting = rb.ParticleDamper(
        name="denting",
        particles=steel,
        cavity=rb.Cylinder(diameter="35 mm", length="30 mm"),
        contact=rb.Thornton(yield_pressure="1.2 GPa"),
        friction=0.2,
        packing=rb.Lattice(noise=0.2, seed=1),
        velocity=(0.3, 0.1, 0.0),
        softening=100,
    )
    usual: dict[str, Any] = {
        "structure": rb.SDOF(mass="2 kg", stiffness="80 kN/m", damping="5 N s/m", velocity="50 mm/s"),
        "dampers": [settled, denting],
        "duration": "0.05 s",
        "output": rb.Output(rate="2 kHz", snapshots=11),
    }
    return rb.Case(**{**usual, **changes})


def bits(run: Run) -> dict[str, Any]:
    """Every array and number of a run, to the last bit, but the computing time and the memory that the run took."""
    counts = {name: count for name, count in run.counts.items() if name != "memory_bytes"}
    values = vars(run.arrays) | {f"particles.{name}": column for name, column in vars(run.arrays.particles).items()}
    del values["particles"]
    arrays = {name: value.tobytes() if isinstance(value, np.ndarray) else value for name, value in values.items()}
    texts = {"status": run.status, "message": run.message, "notes": run.notes, "diagnostics": dict(run.diagnostics)}
    return arrays | texts | {"counts": counts}


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    long = case(duration=sys.argv[2], method=rb.Dem(checkpoint="20 ms"))
    rb.simulate(long, checkpoint=folder / "run.checkpoint", snapshots=folder / "run.vtkhdf")
