"""Two hundred balls in place of one, and two cavities on a beam
=============================================================

For users who begin with a case file: what the two case files with particles show, over random packings.

Two hundred balls of the mass of one ball calm a structure sooner, mostly by sliding. Two cavities with different particles
lower the second resonance of a beam.

:doc:`/how-to/particle_output` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "comparison"]

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb
from rattlebox.analysis import settling_time

FOLDER = Path(__file__).parent
BALL, BOX, BEAM = (
    rb.Case.from_file(FOLDER / f"{name}.toml")
    for name in ("steel_ball", "steel_balls_in_a_box", "two_cavities_on_a_beam")
)


def without_dampers(case):
    """Return the case of the bare structure."""
    return case.model_copy(update={"dampers": (), "method": rb.EventDriven()})


def calming(run):
    """Return the time until the displacement stays below a fifth of its peak [s], and the share of each loss."""
    time, x = run.motion.time.values, run.motion.displacement.values[:, 0]
    shares = run.ledger.shares
    return [
        float(settling_time(time, x, band=0.2)),
        *(shares.get(name, 0.0) for name in ("viscous", "normal", "sliding")),
    ]


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    alone = {"no damper": without_dampers(BALL), "one ball": BALL}
    rows = {name: calming(rb.simulate(case, progress=False)) for name, case in alone.items()}
    boxes = [rb.simulate(BOX.replaced({"damper.packing.seed": seed}), progress=False) for seed in range(1, 9)]
    packings = np.array([calming(run) for run in boxes])
    for name, (time, *shares) in rows.items():
        print(
            f"{name}: {time:.1f} s; lost in the structure, in contacts, by sliding:",
            *(f"{share:.0%}" for share in shares),
        )
    least, most = packings.min(axis=0), packings.max(axis=0)
    print(
        f"200 balls: {least[0]:.1f} to {most[0]:.1f} s;",
        *(f"{a:.0%} to {b:.0%}" for a, b in zip(least[1:], most[1:], strict=True)),
    )
    assert np.allclose(rows["no damper"][:2], [2.6, 1.0], atol=0.05)
    assert np.allclose(rows["one ball"], [2.7, 0.94, 0.05, 0.0], atol=[0.05, 0.01, 0.01, 0.01])
    assert np.allclose(packings.mean(axis=0), [1.6, 0.44, 0.11, 0.43], atol=[0.15, 0.03, 0.02, 0.03])
    assert most[0] < 1.9 and most[1] < 0.5

    runs = {"bare": without_dampers(BEAM), "two cavities": BEAM}
    runs = {name: rb.simulate(case, progress=False) for name, case in runs.items()}
    middle = {name: 1e3 * run.motion.displacement.sel(point="middle") for name, run in runs.items()}
    largest = [float(abs(x.sel(time=slice(0.4, None))).max()) for x in middle.values()]
    arrays, supplied = runs["two cavities"].arrays, runs["two cavities"].ledger.supplied[-1]
    lost = (arrays.normal_loss + arrays.sliding_loss)[-1].sum(axis=1) / supplied
    print(f"beam: {largest[0]:.2f} mm, with particles {largest[1]:.2f} mm; lost: {lost[0]:.0%} and {lost[1]:.0%}")
    assert np.allclose(largest, [1.15, 0.75], atol=0.05) and np.allclose(lost, [1 / 7, 1 / 3], rtol=0.1)
    assert np.allclose(arrays.particle_mass, [0.016, 0.040], rtol=0.02)

    figure, panels = plt.subplots(1, 2, figsize=(7.5, 3), layout="constrained")
    panels[0].bar(list(rows), [row[0] for row in rows.values()])
    panels[0].bar(["200 balls"], [packings[:, 0].mean()], yerr=np.ptp(packings[:, 0]) / 2, capsize=4)
    panels[0].set_ylabel("Time below a fifth of the peak (s)")
    for name, x in middle.items():
        panels[1].plot(x.time, x, lw=0.6, label=name)
    panels[1].set(xlabel="Time (s)", ylabel="Middle of the beam (mm)", ylim=(-1.5, 2))
    panels[1].legend(ncols=2)
    figure.savefig("two_case_files.png", dpi=200)


if __name__ == "__main__":
    main()
