"""Four experiments for a lecture
==============================

For lecturers: the four experiments of the tutorial for the browser application, computed by a script.

The best gap of a row of balls, chaos, one mass as few or as many balls, and the loss over the amplitude.

:doc:`/tutorials/lecture` explains it.
"""

# sphinx_gallery_tags = ["lecture", "sweep", "comparison"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb
from rattlebox.app.draft import template

BOX = template("box").replace('duration = "1 s"', 'duration = "0.5 s"').replace(", snapshots = 200", "")
SIZES = (12, 8, 6)  # of balls of 60 g in total [mm]


def gaps():
    """Return gaps [mm] of a row of three balls, and RMS displacements [mm]."""
    axis = {"damper.gap": rb.geomspace("0.3 mm", "100 mm", 40)}
    study = rb.sweep(rb.Case.from_toml(template("row")), axis, "rms")
    return 1e3 * study["damper.gap"].values, 1e3 * study.rms.values


def starts():
    """Return starts of a ball as a part of the gap, numbers of impacts, and RMS displacements [mm]."""
    axis = {"damper.start": rb.linspace(-0.1, 0.1, 21)}
    study = rb.sweep(rb.Case.from_toml(template("steel_ball")), axis, ["impacts", "rms"])
    return study["damper.start"].values, study.impacts.values, 1e3 * study.rms.values


def sizes():
    """Return summaries of a shaken box with 60 g of balls of each size."""
    texts = [BOX.replace('"6 mm", count = 200', f'"{size} mm", mass = "60 g"') for size in SIZES]
    return [rb.simulate(rb.Case.from_toml(text), progress=False).summary().values for text in texts]


def amplitudes():
    """Return amplitudes of a shaken box [mm], and the loss over the square of the amplitude [kJ/m^2]."""
    axis = {"structure.motion.amplitude": rb.geomspace("0.5 mm", "20 mm", 8)}
    loss = rb.sweep(rb.Case.from_toml(BOX), axis, "impact_loss").impact_loss
    amplitude = loss["structure.motion.amplitude"].values
    return 1e3 * amplitude, 1e-3 * loss.values / amplitude**2


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    gap, rms = gaps()
    print(f"row: RMS {rms.min():.1f} mm at a gap of {gap[rms.argmin()]:.0f} mm, {rms[-1]:.1f} mm without contact")
    start, impacts, same = starts()
    print(f"chaos: {impacts.min():.0f} to {impacts.max():.0f} impacts, RMS within {np.ptp(same) / same.mean():.1%}")
    summaries = sizes()
    rows = [[round(each[key]) for each in summaries] for key in ("particles", "first_touches")]
    losses = [1e3 * each["supplied_energy"] * (1 - each["share_motion"]) for each in summaries]
    print("balls, contacts, loss (mJ):", *rows, [round(loss) for loss in losses])
    amplitude, quotient = amplitudes()
    print("loss over squared amplitude:", ", ".join(f"{each:.1f}" for each in quotient), "kJ/m^2")

    figure, panels = plt.subplots(2, 2, figsize=(7.5, 5), layout="constrained")
    panels[0, 0].plot(gap, rms, "o-", ms=3)
    panels[0, 0].set(xlabel="Gap (mm)", ylabel="RMS displacement (mm)", xscale="log", ylim=0)
    panels[0, 1].plot(start, impacts, "o-", ms=3)
    panels[0, 1].set(xlabel="Start (part of the gap)", ylabel="Impacts", ylim=(150, 250))
    panels[1, 0].bar([str(count) for count in rows[0]], losses, width=0.5)
    panels[1, 0].set(xlabel="Balls of 60 g in total", ylabel="Loss (mJ)")
    panels[1, 1].plot(amplitude, quotient, "o-", ms=3)
    panels[1, 1].set(xlabel="Amplitude (mm)", ylabel="Loss over its square (kJ/m²)", xscale="log", ylim=0)
    for panel in panels.flat:
        panel.margins(x=0.03)
    figure.savefig("lecture.png", dpi=140)
    assert abs(rms.min() - 1.3) < 0.05 and 4 < gap[rms.argmin()] < 8 and np.allclose(rms[gap > 14], 3.0, atol=0.01)
    assert (impacts.min(), impacts.max()) == (196, 236) and np.ptp(same) < 0.006 * same.mean()
    assert rows[0] == [27, 90, 212] and np.allclose(rows[1], [9e3, 38e3, 111e3], rtol=0.2)
    assert np.allclose(losses, [240, 250, 200], rtol=0.1)
    for share in ("share_sliding", "share_at_particle"):
        assert summaries[0][share] < summaries[-1][share]
    assert quotient.argmax() in (5, 6) and np.allclose(quotient[[0, 5, 7]], [2.1, 10, 5.6], rtol=0.12)


if __name__ == "__main__":
    main()
