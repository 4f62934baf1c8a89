"""Times the single-ball case (5 kN, 5 s) against ourselves and, where they are given, against other programs' scripts.

    python benchmarks/bench.py [--peers FOLDER] [--repeat N]

FOLDER holds w1_scipy.py and its like, each printing one JSON line with cpu_s. Times are the best of N; accuracy is measured
against a solution in 113-bit arithmetic.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import rattlebox as rb
from rattlebox.engines.core import choice, core
from rattlebox.engines.pack import pack

REFERENCE = json.loads(
    (Path(__file__).parents[1] / "tests/verification/data/w1_centre.json").read_text(encoding="utf-8")
)


def errors(times: np.ndarray, z_at_1: float | None) -> tuple[float, float]:
    """Return the largest error of the first 30 impact times [s] and of the position at 1 s [m]."""
    exact = np.array([impact[0] for impact in REFERENCE["all_impacts_t0_side_Din_Dout"][:30]])
    found = times[:30] if len(times) >= 30 else np.full(30, np.nan)
    sample = next(s for s in REFERENCE["samples"] if abs(s[0] - 1) < 1e-9)
    return float(np.abs(found - exact).max()), float("nan") if z_at_1 is None else abs(z_at_1 - sample[1])


def ours(name: str, method: object, repeat: int) -> dict[str, object]:
    """Time one method of ours inside the core."""
    case = rb.Case(
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
    packed = pack(case)
    seconds = min(core().simulate([packed], 1)[0]["seconds"] for _ in range(repeat))
    run = rb.simulate(case)
    dt, dz = errors(run.arrays.impacts.time, float(run.arrays.displacement[1, 0]))
    return {"name": name, "seconds": seconds, "impacts": len(run.arrays.impacts), "dt30": dt, "dz1": dz}


def peer(folder: Path, name: str, arguments: list[str]) -> dict[str, object] | None:
    """Run one SciPy setting of the peers' script; None where it cannot run."""
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "out.json"
        command = [sys.executable, str(folder / "w1_scipy.py"), *arguments, "5", "centre", "const", str(out)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=500, check=False)
        if done.returncode != 0:
            return None
        line, data = json.loads(done.stdout), json.loads(out.read_text(encoding="utf-8"))
    z = next((s[1] for s in data["samples"] if abs(s[0] - 1) < 1e-9), None)
    dt, dz = errors(np.array([i["t0"] for i in data["impacts"]]), z)
    return {"name": name, "seconds": line["cpu_s"], "impacts": line["impacts"], "dt30": dt, "dz1": dz}


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
    if options.peers:
        for name, arguments in {
            "SciPy LSODA 1e-9": ["LSODA", "1e-9", "1e-12"],
            "SciPy LSODA 1e-12": ["LSODA", "1e-12", "1e-15"],
            "SciPy DOP853 1e-12": ["DOP853", "1e-12", "1e-15"],
        }.items():
            row = peer(options.peers, name, arguments)
            if row is not None:
                rows.append(row)
    base = float(rows[0]["seconds"])  # type: ignore[arg-type]
    print(f"core {choice()[0]}; {time.perf_counter() - start:.0f} s of measurement\n")
    print("| program | time | ratio | impacts | error of first 30 impacts | error of z(1 s) |")
    print("|---|---|---|---|---|---|")
    for r in rows:
        seconds = float(r["seconds"])  # type: ignore[arg-type]
        print(
            f"| {r['name']} | {1e3 * seconds:.3g} ms | {seconds / base:.3g} | {r['impacts']} "
            f"| {r['dt30']:.1e} s | {r['dz1']:.1e} m |"
        )


if __name__ == "__main__":
    main()
