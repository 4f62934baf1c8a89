"""A building in an earthquake
===========================

For structural engineers who compare dampers in an earthquake: storey drifts of a building with three dampers.

Five storeys are bare, or have a tuned mass, one ball or sixteen balls of the same mass on the top floor. The ground motion
is synthetic and has the file format of the PEER database (AT2).

:doc:`/tutorials/building` explains it.
"""

# sphinx_gallery_tags = ["building", "comparison"]

from itertools import pairwise
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb
from rattlebox.analysis import drift

MASS, TOP = 2500.0, "storey 5"  # 1 % of the building [kg]
SIZE = (6 * MASS / 16 / (np.pi * 7850)) ** (1 / 3)  # diameter of each of sixteen steel balls [m]

# %%
# The building has five equal storeys. The record of the ground is read from a file, with its unit.

tower = rb.ShearBuilding(masses=["50 t"] * 5, stiffnesses=["60 MN/m"] * 5, damping_ratio="2 %")
quake = rb.Record(file=Path(__file__).parent / "data" / "ground_motion.at2")

# %%
# Three dampers of 2.5 t each stand on the top floor: a tuned mass, one ball, and a layer of sixteen balls.

pads = rb.Linear(contact_time="5 ms", restitution=0.5)
tuned = rb.TunedMass.warburton(tower, mass=MASS, point=TOP)
ball = rb.ImpactDamper(
    ball=rb.Sphere(diameter="0.85 m", mass=MASS, material="steel"), gap="80 mm", contact=pads, point=TOP
)
balls = rb.ParticleDamper(
    particles=rb.Particles(material="steel", diameter=SIZE, count=16),
    cavity=rb.Box(size=(4 * SIZE + 0.08, 4.04 * SIZE, 1.05 * SIZE)),
    contact=pads,
    friction=rb.LinearSpring(coefficient=0.3, ratio=0.286),
    packing=rb.Lattice(noise=0.5, seed=1),
    point=TOP,
    direction="x",
)

# %%
# `rb.compare` runs the building with each of them.

dampers = {"bare": {}, "tuned mass": {"tuned_mass": tuned}, "one ball": {"damper": ball}, "16 balls": {"damper": balls}}
common = {"structure": tower, "base": quake, "duration": "23.9 s", "output": rb.Output(rate="200 Hz")}
result = rb.compare({name: rb.Case(**common, **damper) for name, damper in dampers.items()})

# %%
# A drift is the displacement of a floor relative to the one below. Peak and RMS value tell different stories.

figure, panels = plt.subplots(1, 2, figsize=(7, 3), sharey=True, layout="constrained")
floors, rms = [None, *(f"storey {k}" for k in range(1, 6))], {}
for (name, run), mark, colour in zip(result.runs.items(), "o^sD", rb.plots.SERIES_COLOURS, strict=False):
    drifts = [1e3 * drift(run, upper, lower) for lower, upper in pairwise(floors)]
    peak, rms[name] = [float(abs(d).max()) for d in drifts], [float(d.std()) for d in drifts]
    print(f"{name:10} first storey: peak {peak[0]:.1f} mm, RMS {rms[name][0]:.1f} mm")
    for panel, values in zip(panels, (peak, rms[name]), strict=True):
        panel.plot(values, range(1, 6), f"{mark}-", color=colour, label=name)
panels[0].set(xlabel="Peak drift (mm)", ylabel="Storey", yticks=range(1, 6), xlim=0)
panels[1].set(xlabel="RMS drift (mm)", xlim=0)
panels[1].legend(frameon=False)
figure.savefig("building.png", dpi=200)

# %%
# The numbers of the tutorial.

assert np.allclose([row[0] for row in rms.values()], [7.0, 4.8, 5.6, 6.1], rtol=0.05)
