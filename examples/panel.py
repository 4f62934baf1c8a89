"""A satellite panel in random vibration
=====================================

For engineers of spacecraft structures: a panel in random vibration, bare and with a particle damper, without gravity.

The three modes of the panel are read from a universal file, examples/data/panel.uff, which was computed and not measured.

:doc:`/tutorials/panel` explains it.
"""

# sphinx_gallery_tags = ["space", "comparison"]

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb
from rattlebox.analysis import band_levels, power_spectral_density

G, LENGTH = 9.80665, "3 s"

# %%
# The modes of the panel come from a file; what it does not state is given here.

panel = rb.Modal.from_file(
    Path(__file__).parent / "data" / "panel.uff",
    points={"middle": "1 z"},
    participation=[1.6847, 0.5616, 0.5616],  # phi^T M r [kg^1/2], from the model: a universal file has none
    total_mass="4.32 kg",
)

# %%
# A box with 71 g of steel balls stands in the middle. In orbit nothing holds the bed to a floor.

damper = rb.ParticleDamper(
    particles=rb.Particles(material="steel", diameter="5 mm", fill_ratio=0.5),
    cavity=rb.Box(size=("30 mm", "30 mm", "20 mm")),
    contact=rb.Tsuji(restitution=0.7),
    friction=0.2,
    gravity=(0, 0, 0),
    packing=rb.Lattice(seed=1),
    direction="z",
    softening=10,
)

# %%
# Both panels are shaken by the same random vibration. Levels in third octaves are what a test specification asks for.

run = {"base": rb.Random("gevs_acceptance", LENGTH, seed=1), "duration": LENGTH, "output": rb.Output(rate="10 kHz")}
levels, (figure, axes) = {}, plt.subplots(figsize=(7, 3), layout="constrained")
for name, dampers in {"bare": {}, "with particles": {"damper": damper}}.items():
    along_z = rb.simulate(rb.Case(structure=panel, **run, **dampers)).along("z")
    velocity = along_z.velocity.sel(point="middle") + along_z.base_velocity
    absolute = velocity.differentiate("time").assign_attrs(units="m/s^2")
    density = power_spectral_density(along_z.time, absolute, resolution=2).density
    level = band_levels(density.sel(frequency=slice(20, 2000))) / G
    place, colour = np.arange(level.size) + 0.4 * len(levels), rb.plots.SERIES_COLOURS[len(levels)]
    axes.bar(place, level, width=0.4, color=colour, label=name)
    levels[name] = float(level.sel(nominal="200")), float(along_z.interface_force.std())
    print(f"{name:14} {levels[name][0]:.1f} g in the band of 200 Hz, {levels[name][1]:.0f} N on the base")

# %%
# One bar for each band, side by side.

axes.set_xticks(np.arange(level.size) + 0.2, level.nominal.values, rotation=90)
axes.set(xlabel="Third-octave band (Hz)", ylabel="RMS acceleration ($g_0$)")
axes.legend(frameon=False)
figure.savefig("panel.png", dpi=200)

# %%
# The numbers of the tutorial.

assert np.allclose(list(levels.values()), [(53.5, 973), (29.3, 626)], rtol=0.12)
