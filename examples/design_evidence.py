"""Which clearances cannot be told apart
=====================================

For users who rank designs by a search: damping of four clearances over the amplitude, with the intervals that decide.

A search keeps the damping curve of every candidate, so that its order can be checked, and says whose intervals overlap.

:doc:`/how-to/design` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "design"]

import matplotlib.pyplot as plt

import rattlebox as rb

# %%
# A ball in a cavity damps free vibration. Two of the four clearances differ by 20 um only.

case = rb.Case(
    structure=rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m"),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(diameter="50 mm", material="steel"), gap="0.4 mm", contact=rb.Tsuji(restitution=0.6)
    ),
    duration="6 s",
)
ranked = rb.design(
    case,
    {"damper.gap": ["0.5 mm", "1 mm", "1.98 mm", "2 mm"]},
    "damping_ratio",
    amplitudes=["1 mm", "1.5 mm", "2 mm", "3 mm"],
    packings=4,
)
print(ranked.attrs["order"])

# %%
# The objective is the least damping ratio of the four amplitudes, here that at 3 mm. Bands are 95 % intervals of the mean of
# four random starts.

figure, axes = plt.subplots(figsize=(5, 3.2), layout="constrained")
amplitude, curves = 1e3 * ranked.amplitude.values, ranked.damping_curve
for trial, style in zip(ranked.trial.values, ("o-", "s-", "D-", "^--"), strict=True):
    best = bool(ranked.may_be_best[trial])
    mean, half = 100 * curves[trial].values, 100 * ranked.damping_curve_interval[trial].values
    colour = rb.plots.SERIES_COLOURS[trial] if best else "0.6"
    name = f"gap {1e3 * float(ranked['damper.gap'][trial]):g} mm"
    axes.plot(amplitude, mean, style, color=colour, ms=4, label=f"{name}: may be best" if best else name)
    axes.fill_between(amplitude, mean - half, mean + half, color=colour, alpha=0.25, lw=0)
axes.axhline(100 * float(ranked.bare[0]), color="0.8", lw=0.8, zorder=0)
axes.text(amplitude[-1], 100 * float(ranked.bare[0]), "structure alone", ha="right", va="top", color="0.4")
axes.set(xlabel="Amplitude (mm)", ylabel="Damping ratio (%)", ylim=0)
axes.legend(frameon=False)
figure.savefig("design_evidence.png", dpi=200)

# %%
# The numbers of the figure.

assert ranked.may_be_best.values.tolist() == [False, False, True, True]
assert ranked.attrs["order"].startswith("the best 2 of 4 trials cannot be told apart")
assert abs(float(ranked.damping_curve[3, 0]) - 0.023) < 0.001
