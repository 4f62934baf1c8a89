"""A case whose contacts have history, and a program that runs it with a checkpoint every 20 ms."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

import rattlebox as rb
from rattlebox.results import Run


def case(**changes: Any) -> rb.Case:
    """Return a case with a settled bed with friction and rolling resistance, and a damper whose particles yield."""
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
    yielding = rb.ParticleDamper(
        name="yielding",
        particles=steel,
        cavity=rb.Cylinder(diameter="35 mm", length="30 mm"),
        contact=rb.Thornton(yield_pressure="1.2 GPa"),
        friction=0.2,
        packing=rb.Lattice(noise=0.2, seed=1),
        velocity=(0.3, 0.1, 0.0),
        softening=100,
    )
    defaults: dict[str, Any] = {
        "structure": rb.SDOF(mass="2 kg", stiffness="80 kN/m", damping="5 N s/m", velocity="50 mm/s"),
        "dampers": [settled, yielding],
        "duration": "0.05 s",
        "output": rb.Output(rate="2 kHz", snapshots=11),
    }
    return rb.Case(**{**defaults, **changes})


def bits(run: Run) -> dict[str, Any]:
    """Return all arrays and numbers of a run, without the computing time and the memory that it took."""
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
