"""Benchmark of the single-ball case (5 kN, 5 s), optionally in comparison with scripts of other programs.

    python benchmarks/bench.py [--peers FOLDER] [--repeat N]

FOLDER contains the scripts listed in peers.py; scripts that cannot run here are listed with the reason. Our times are
the best of N, in the core; those of the peers are CPU times of one run. Accuracy is measured against a solution in
113-bit arithmetic. The program that calls ode45 at every step is timed step by step, and its 5 s are extrapolated from
the number of steps.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
import peers

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.core.choose import choice
from rattlebox.prepare.pack import pack

REFERENCE = json.loads(
    (Path(__file__).parents[1] / "tests/verification/data/w1_centre.json").read_text(encoding="utf-8")
)


def errors(times: np.ndarray, z_at_1: float | None) -> tuple[float, float]:
    """Return the largest error of the first 30 impact times [s] and of the position at 1 s [m]."""
    exact = np.array([impact[0] for impact in REFERENCE["all_impacts_t0_side_Din_Dout"][:30]])
    found = times[:30] if len(times) >= 30 else np.full(30, np.nan)
    sample = next(s for s in REFERENCE["samples"] if abs(s[0] - 1) < 1e-9)
    return float(np.abs(found - exact).max()), float("nan") if z_at_1 is None else abs(z_at_1 - sample[1])


def single_ball(method: object) -> rb.Case:
    """Return the single-ball case with a method."""
    return rb.Case(
        structure=rb.SDOF(mass=20.0, stiffness=8e4, damping=25.3),
        dampers=(
            rb.ImpactDamper(
                balls=(rb.Sphere(radius=0.03317, material="steel", mass=1.2),),
                gap=4e-4,
                contact=rb.Tsuji(alpha=0.006313, ending="zero_overlap"),
            ),
        ),
        loads=(rb.HalfSine(amplitude=5000.0, duration=1e-3),),
        duration=5.0,
        method=method,
        output=rb.Output(times=[1.0]),
    )


def ours(name: str, method: object, repeat: int) -> dict[str, object]:
    """Measure the time of one of our methods inside the core."""
    case = single_ball(method)
    packed = pack(case)
    seconds = min(_core.simulate([packed], 1)[0].seconds for _ in range(repeat))
    run = rb.simulate(case)
    dt, dz = errors(run.arrays.impacts.time, float(run.arrays.displacement[1, 0]))
    return {"name": name, "seconds": seconds, "impacts": len(run.arrays.impacts), "dt30": dt, "dz1": dz}


def theirs(folder: Path) -> tuple[list[dict[str, object]], list[str]]:
    """Measure the peers; return rows, and the reasons why the others did not run."""
    rows, missing = [], []
    for name, found in peers.measure(folder):
        if isinstance(found, str):
            missing.append(f"{name}: {found}")
            continue
        dt, dz = errors(np.array(found["times"]), found["z_at_1"])
        rows.append({"name": name, "seconds": found["cpu_s"], "impacts": found["impacts"], "dt30": dt, "dz1": dz})
    log = rb.simulate(single_ball(rb.EventDriven())).arrays.impacts
    name = "Octave ode45 at every step, extrapolated"
    found = peers.single_steps(folder, float(log.duration.sum()), float(log.time[0]))
    if isinstance(found, str):
        missing.append(f"{name}: {found}")
    else:
        rows.append({"name": name, "seconds": found["cpu_s"], "impacts": "-", "dt30": np.nan, "dz1": np.nan})
    return rows, missing


def duration(seconds: float) -> str:
    """Return a time as text with a suitable unit."""
    scale, unit = next(((s, u) for s, u in ((3600.0, "h"), (1.0, "s")) if seconds >= s), (1e-3, "ms"))
    return f"{seconds / scale:.3g} {unit}"


def times(ratio: float) -> str:
    """Return a ratio as text with three digits and separated thousands."""
    return f"{float(f'{ratio:.3g}'):,.0f}".replace(",", " ") if ratio >= 100 else f"{ratio:.3g}"


def error_text(error: float, unit: str) -> str:
    """Return an error as text, a dash if it is not finite."""
    return f"{error:.1e} {unit}" if np.isfinite(error) else "-"


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--peers", type=Path)
    parser.add_argument("--repeat", type=int, default=200)
    options = parser.parse_args()
    start = time.perf_counter()
    rows = [
        ours("Rattlebox EventDriven", rb.EventDriven(), options.repeat),
        ours("Rattlebox EventDriven, step by step", rb.EventDriven(collocation=False), 10),
        ours("Rattlebox Newton (hard impacts)", rb.Newton(restitution=0.99117), options.repeat),
        ours("Rattlebox TwoStep rk4", rb.TwoStep(), 1),
    ]
    peer_rows, missing = theirs(options.peers) if options.peers else ([], [])
    rows += peer_rows
    base = float(rows[0]["seconds"])  # type: ignore[arg-type]
    print(f"core {choice()[0]}; {time.perf_counter() - start:.0f} s of measurement\n")
    print("| program | time | ratio | impacts | error of first 30 impacts | error of z(1 s) |")
    print("|---|---|---|---|---|---|")
    for r in rows:
        seconds = float(r["seconds"])  # type: ignore[arg-type]
        print(
            f"| {r['name']} | {duration(seconds)} | {times(seconds / base)} | {r['impacts']} "
            f"| {error_text(r['dt30'], 's')} | {error_text(r['dz1'], 'm')} |"  # type: ignore[arg-type]
        )
    for line in missing:
        print(f"\nnot run: {line}")


if __name__ == "__main__":
    main()
