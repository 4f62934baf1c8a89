"""Clearance, room and forces of the dampers of a building
=======================================================

For structural engineers who ask what decides: clearances, starts and forces of the dampers of ``building.py``.

The clearance of a ball or a row of balls decides about the drift; the random start of the balls has little effect.

:doc:`/tutorials/building` explains it.
"""

# sphinx_gallery_tags = ["building", "comparison"]

import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb
from rattlebox.analysis import drift

BUILDING = runpy.run_path(str(Path(__file__).parent / "building.py"))
COMMON, BALL, BALLS, SIZE = (BUILDING[name] for name in ("common", "ball", "balls", "SIZE"))
CLEARANCES = (20, 40, 80, 120, 160)  # of the ball on each side, of the row of four in total [mm]


def rms(run):
    """Return the RMS drift of the first storey [mm]."""
    return 1e3 * float(drift(run, "storey 1").std())


def with_ball(clearance):
    """Return the case of one ball with this clearance on each side [mm]."""
    return rb.Case(**COMMON, damper=BALL.model_copy(update={"gap": 1e-3 * clearance}))


def with_balls(clearance, seed=1):
    """Return the case of sixteen balls in a box that is longer than a row of four by this clearance [mm]."""
    box = rb.Box(size=(4 * SIZE + 1e-3 * clearance, 4.04 * SIZE, 1.05 * SIZE))
    packing = rb.Lattice(noise=0.5, seed=seed)
    return rb.Case(**COMMON, damper=BALLS.model_copy(update={"cavity": box, "packing": packing}))


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    runs = BUILDING["result"].runs
    drifts = {name: abs(drift(run, "storey 1")) for name, run in runs.items()}
    blow = float(runs["one ball"].impacts.peak_force.max()) / 1e6
    means = [runs[name].summary().values["peak_damper_force[damper]"] / 1e6 for name in ("one ball", "16 balls")]
    print(
        f"one ball: largest contact force {blow:.1f} MN; mean over 5 ms {means[0]:.1f} MN, of 16 balls {means[1]:.1f} MN"
    )
    moved = runs["tuned mass"].motion.displacement
    stroke = abs(moved.sel(point="tuned mass") - moved.sel(point="storey 5"))
    late = [float(each.idxmax()) for each in (drifts["tuned mass"], stroke)]
    print(f"tuned mass: largest drift at {late[0]:.1f} s, stroke {float(stroke.max()):.2f} m at {late[1]:.1f} s")
    assert np.allclose([blow, *means], [1.4, 0.8, 0.3], atol=0.05)
    assert np.allclose([*late, stroke.max()], [4.8, 6.6, 0.23], atol=0.05)
    lower = [1 - float(drifts[name].max() / drifts["bare"].max()) for name in ("one ball", "16 balls")]
    calmer = [1 - rms(runs[name]) / rms(runs["bare"]) for name in ("tuned mass", "one ball", "16 balls")]
    assert np.allclose(lower, [0.12, 0.08], atol=0.02) and np.allclose(calmer, [0.32, 0.20, 0.13], atol=0.015)

    curves = {
        "one ball, on each side": [rms(rb.simulate(with_ball(each))) for each in CLEARANCES],
        "16 balls, in all": [rms(rb.simulate(with_balls(each))) for each in CLEARANCES],
    }
    figure, axes = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
    for (name, values), mark in zip(curves.items(), "o^", strict=True):
        print(f"{name}, clearance {CLEARANCES} mm:", ", ".join(f"{value:.1f}" for value in values), "mm RMS")
        axes.plot(CLEARANCES, values, f"{mark}-", label=name)
    for name, style in (("bare", ":"), ("tuned mass", "--")):
        axes.axhline(rms(runs[name]), color="k", ls=style, label=name)
    axes.set(xlabel="Clearance (mm)", ylabel="RMS drift of the first storey (mm)", ylim=(0, 8))
    axes.margins(x=0.03)
    axes.legend(ncols=2)
    figure.savefig("building_variants.png", dpi=200)
    assert np.allclose(curves["one ball, on each side"][2:], [5.6, 5.1, 6.9], atol=0.1)
    assert np.allclose([curves["16 balls, in all"][k] for k in (0, 2, 4)], [6.7, 6.1, 6.8], atol=0.1)
    seeds = [rms(rb.simulate(with_balls(80, seed))) for seed in range(2, 8)]
    print(f"six other seeds: {min(seeds):.2f} to {max(seeds):.2f} mm")
    assert min(seeds) > 6.05 and max(seeds) < 6.2


if __name__ == "__main__":
    main()
