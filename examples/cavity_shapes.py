"""Wedge, ring and honeycomb
=========================

For users who choose the shape of a cavity: loss maps of three shapes with the same particles.

A wedge, a ring around a rod and a tube with a honeycomb are shaken sideways, each with 100 steel spheres of 3 mm, from six
random packings. The numbers are the mean loss per cycle over m V², and the half width of its 95 % interval.

:doc:`/how-to/sweep` explains axes of shapes.
"""

# sphinx_gallery_tags = ["space", "map"]

import matplotlib.pyplot as plt
import numpy as np
from scipy.stats import t

import rattlebox as rb

# %%
# The wedge is a surface of triangles, as it may come from a CAD program; ring and honeycomb are bodies in a cylinder.

wedge = rb.Mesh(
    vertices=[[0, 0, 0], [40, 0, 0], [0, 0, 30], [0, 20, 0], [40, 20, 0], [0, 20, 30]],
    faces=[[0, 1, 2], [3, 5, 4], [0, 4, 1], [0, 3, 4], [0, 2, 5], [0, 5, 3], [1, 4, 5], [1, 5, 2]],
    unit="mm",
)
tube = rb.Cylinder(diameter="32 mm", length="20 mm")
shapes = {
    "wedge": (wedge, []),
    "ring": (tube, [rb.RodBody(diameter="16 mm")]),
    "honeycomb": (tube, [rb.Honeycomb(cell="10 mm", thickness="0.6 mm")]),
}
case = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude="20 m/s^2", frequency="30 Hz", direction="x")),
    damper=rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="3 mm", count=100),
        cavity=tube,
        contact=rb.Tsuji(restitution=0.6),
        friction=0.3,
        direction="x",
        packing=rb.Settled(seed=1),
        softening=300,
    ),
    duration="1 s",
)

# %%
# Cavity and bodies vary together along one axis, over a grid of amplitudes and frequencies, with six packings of each.

cavities, bodies = zip(*shapes.values(), strict=True)
study = rb.sweep(
    case,
    {
        ("damper.cavity", "damper.bodies"): (list(cavities), list(bodies)),
        "structure.motion.amplitude": ["5 m/s^2", "15 m/s^2", "40 m/s^2"],
        "structure.motion.frequency": ["20 Hz", "45 Hz"],
        "damper.packing.seed": [1, 2, 3, 4, 5, 6],
    },
    ["reduced_loss"],
    cycles=(10, 10),
    progress=False,
)
losses = study.reduced_loss.values
packings = losses.shape[-1]
mean = losses.mean(axis=-1)
half = t.ppf(0.975, packings - 1) * losses.std(axis=-1, ddof=1) / np.sqrt(packings)
names = study.warnings.attrs["flag_meanings"].split()
unsteady = (study.warnings.values & study.warnings.attrs["flag_masks"][names.index("unsteady")]).any(axis=-1)
for name, middle, width in zip(shapes, mean, half, strict=True):
    most = np.unravel_index(middle.argmax(), middle.shape)
    print(f"{name:10} largest loss {middle[most]:.2f} +- {width[most]:.2f} m V^2, least {middle.min():.2f} m V^2")

# %%
# One map for each shape, on one scale. A star marks means in which a motion is not steady after ten cycles: slow sliding at
# small amplitudes goes on for long.

levels, frequencies = [5, 15, 40], [20, 45]
figure, maps = plt.subplots(1, 3, figsize=(6, 3.2), sharey=True, layout="constrained")
for number, (axes, name) in enumerate(zip(maps, shapes, strict=True)):
    axes.pcolormesh(range(3), range(4), mean[number], vmin=0, vmax=float(mean.max()), cmap="Blues")
    for (row, column), value in np.ndenumerate(mean[number]):
        colour = "white" if value > 0.6 * mean.max() else "black"
        words = f"{value:.2f}{'*' * bool(unsteady[number, row, column])}\n±{half[number, row, column]:.2f}"
        axes.text(column + 0.5, row + 0.5, words, ha="center", va="center", color=colour)
    axes.set(title=name, xlabel="frequency [Hz]")
    axes.set_xticks(np.arange(2) + 0.5, [str(frequency) for frequency in frequencies])
    axes.set_yticks(np.arange(3) + 0.5, [str(level) for level in levels])
maps[0].set_ylabel("amplitude [m/s$^2$]")
figure.suptitle("loss per cycle over m V$^2$, mean of six packings and its 95 % interval")
figure.savefig("cavity_shapes.png", dpi=200)

# %%
# At 40 m/s² and 45 Hz the honeycomb loses twice what the ring does and five times what the wedge does, and the intervals are
# apart. At 5 m/s² the wedge loses most, though motions there are hardly steady.

low, high = (mean - half)[:, 2, 1], (mean + half)[:, 2, 1]
assert low[2] > 1.4 * high[1] and low[1] > 1.4 * high[0]
