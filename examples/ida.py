"""Incremental dynamic analysis of a building with a ball on its roof
==================================================================

For structural engineers: the largest drift of five storeys over the spectral acceleration of twelve records.

A tuned mass lowers the median by the same 29 % at every intensity. A ball of the same mass does nothing until the roof moves
further than its gap, and then lowers the median by a tenth. The building is linear: curves without impacts are straight.

:doc:`/how-to/record_sets` explains it.
"""

# sphinx_gallery_tags = ["building", "study"]

import matplotlib.pyplot as plt
import numpy as np
from scipy.signal import lfilter

import rattlebox as rb
from rattlebox.analysis import over_records

HEIGHT, STEP, LENGTH = 3.2, 0.01, 24.0  # of a storey [m], of a record [s]
TOWER = rb.ShearBuilding(masses=["90 t"] * 5, stiffnesses=["68.5 MN/m"] * 5, damping_ratio="2 %")
LEVELS = np.round(np.linspace(0.04, 0.6, 15), 4)  # spectral accelerations [g]
BALL = rb.ImpactDamper(
    ball=rb.Sphere(diameter="1.55 m", mass="15 t", material="steel"),
    gap="60 mm",
    contact=rb.Linear(contact_time="20 ms", restitution=0.4),
    point="storey 5",
)


def shaking(seed: int) -> rb.Record:
    """Return a record of filtered noise that rises, stays and decays, as of an earthquake."""
    random = np.random.default_rng(seed)
    ground, rise, stay = 2 * np.pi * random.uniform(1.2, 3.5), random.uniform(1, 4), random.uniform(3, 8)
    time = np.arange(0, LENGTH + STEP / 2, STEP)
    envelope = np.clip(time / rise, 0, 1) ** 2 * np.exp(-0.35 * np.clip(time - rise - stay, 0, None))
    # Soil as an oscillator with a damping ratio of 0.6, whose absolute acceleration is the record.
    decay = np.exp((-0.6 + 0.8j) * ground * STEP)
    soil = lfilter([1.0], [1.0, -2 * decay.real, abs(decay) ** 2], envelope * random.standard_normal(time.size))
    values = soil - np.convolve(soil, np.ones(100) / 100, mode="same")  # without what is slower than 1 s
    return rb.Record(dt=STEP, values=values, unit="m/s^2", name=f"record {seed}")


def curves(case: rb.Case, quakes: rb.RecordSet):
    """Return the largest drifts over records and spectral accelerations, as a part of the height of a storey [%]."""
    study = rb.sweep(case, {"base": quakes, "base.scale": LEVELS.tolist()}, ["largest_drift"], progress=False)
    return 100 / HEIGHT * study.largest_drift


def draw(panel, drifts, bare, title: str) -> None:
    """Draw the curves of all records, their median and 84th percentile, and the median of the bare building."""
    levels = over_records(drifts)
    colour = rb.plots.SERIES_COLOURS[0]
    for record in drifts:
        panel.plot(record, LEVELS, color=colour, lw=0.6, alpha=0.35)
    panel.plot(levels.lognormal_84, LEVELS, color=colour, lw=2, ls="--", label="84 %")
    panel.plot(levels.lognormal_median, LEVELS, color=colour, lw=2, label="median")
    panel.plot(bare.lognormal_median, LEVELS, color="0.3", lw=1, ls=":", label="median without")
    panel.set(xlabel="Largest drift (% of the storey)", title=title, xlim=(0, None), ylim=(0, LEVELS[-1]))


@rb.plots.figure_style("page")
def main():
    """Compute the curves, check the numbers and draw the figure."""
    quakes = rb.RecordSet({f"record {seed}": shaking(seed) for seed in range(1, 13)})
    period = 2 * np.pi / float(TOWER.modes().stiffness[0]) ** 0.5
    quakes = quakes.scaled_to("1 g", period=period)  # so that a scale is a spectral acceleration in g
    common = {"structure": TOWER, "base": quakes["record 1"], "duration": LENGTH}
    tuned = rb.TunedMass.warburton(TOWER, mass="15 t", point="storey 5")
    drifts = {
        "Without": curves(rb.Case(**common), quakes),
        "Ball of 15 t": curves(rb.Case(**common, damper=BALL), quakes),
        "Tuned mass of 15 t": curves(rb.Case(**common, tuned_mass=tuned), quakes),
    }
    levels = {name: over_records(each) for name, each in drifts.items()}
    bare = levels["Without"]
    figure, panels = plt.subplots(1, 2, figsize=(7, 3.2), sharex=True, sharey=True, layout="constrained")
    for panel, name in zip(panels, list(drifts)[1:], strict=True):
        draw(panel, drifts[name], bare, name)
    panels[0].set_ylabel(f"Spectral acceleration at {period:.2f} s (g)")
    panels[1].legend(loc="lower right")
    figure.savefig("ida.png", dpi=200)
    for name, each in levels.items():
        ratios = (each.lognormal_median / bare.lognormal_median).values[[0, 6, -1]]
        print(
            f"{name}: median drift {ratios[0]:.2f}, {ratios[1]:.2f} and {ratios[2]:.2f} of that without at "
            f"{LEVELS[0]:g}, {LEVELS[6]:g} and {LEVELS[-1]:g} g; dispersion {float(each.dispersion[-1]):.2f}"
        )
    slopes = drifts["Without"] / LEVELS
    assert np.allclose(slopes, slopes[:, :1], rtol=1e-9)  # linear
    third = (levels["Tuned mass of 15 t"].lognormal_median / bare.lognormal_median).values
    tenth = (levels["Ball of 15 t"].lognormal_median / bare.lognormal_median).values
    assert np.allclose(third, 0.70, atol=0.02) and tenth[0] == 1 and np.allclose(tenth[-5:], 0.89, atol=0.03)
    assert bare.dispersion[0] < 0.15


if __name__ == "__main__":
    main()
