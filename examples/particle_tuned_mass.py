"""Particle tuned mass damper
==========================

For structural engineers: drifts of a building with a box of steel balls on a spring, over clearance and mistuning.

Five storeys of 80 t in an earthquake are bare, or have 12 t on the top floor: a tuned mass, a box of 2.4 t on its spring
with twelve balls of 9.6 t in it and no dashpot, or balls in a box on the floor. The stiffness of the building differs from
that of the design by up to 15 %.

:doc:`/how-to/particle_tuned_mass` explains it.
"""

# sphinx_gallery_tags = ["building", "comparison"]

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb
from rattlebox.analysis import drift

TOP, TOTAL, CONTENT, COUNT = "storey 5", 12e3, 9.6e3, 12
quake = rb.Record(file=Path(__file__).parent / "data" / "ground_motion.at2")


def tower(stiffness=1.0):
    """Return the building; its stiffness is a factor on that of the design."""
    return rb.ShearBuilding(masses=["80 t"] * 5, stiffnesses=[stiffness * 96e6] * 5, damping_ratio="2 %")


# %%
# The tuned mass of the design, and the box on its spring: box and balls together are the tuned mass. The balls replace the
# dashpot.

full = rb.TunedMass.warburton(tower(), mass=TOTAL, point=TOP)
box = full.with_content(CONTENT).model_copy(update={"damping_ratio": 0.0})


def balls(mass, clearance, point):
    """Return twelve steel balls of a mass in all, in a layer of three rows, with a clearance along each row."""
    size = (6 * mass / COUNT / (np.pi * 7850)) ** (1 / 3)
    return rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter=size, count=COUNT),
        cavity=rb.Box(size=(4 * size + clearance, 3.04 * size, 1.1 * size)),
        contact=rb.Linear(contact_time="10 ms", restitution=0.5),
        friction=rb.LinearSpring(coefficient=0.3, ratio=0.286),
        packing=rb.Lattice(noise=0.5, seed=1),
        point=point,
        direction="x",
    )


# %%
# Four variants of equal mass. `point="tuned mass"` puts the balls into the box.


def compared(stiffness, clearance):
    """Return peak and RMS drift of the first storey of each variant [mm]."""
    common = {"structure": tower(stiffness), "base": quake, "duration": "23.9 s", "output": rb.Output(rate="200 Hz")}
    variants = {
        "none": {},
        "tuned mass": {"tuned_mass": full},
        "balls on the spring": {"tuned_mass": box, "damper": balls(CONTENT, clearance, "tuned mass")},
        "balls on the floor": {"damper": balls(TOTAL, clearance, TOP)},
    }
    result = rb.compare({name: rb.Case(**common, **fields) for name, fields in variants.items()})
    drifts = {name: 1e3 * drift(run, "storey 1", None) for name, run in result.runs.items()}
    return {name: (float(abs(each).max()), float(each.std())) for name, each in drifts.items()}


stiffnesses, clearances = [0.85, 1.0, 1.15], [0.05, 0.1, 0.15, 0.2, 0.3, 0.4]
mistuned = {factor: compared(factor, 0.1) for factor in stiffnesses}
spaced = {clearance: compared(1.0, clearance) for clearance in clearances}

# %%
# The balls on the spring have the smallest peak drift at all three stiffnesses, the tuned mass the smallest RMS.

for factor, rows in mistuned.items():
    print(
        f"stiffness {factor:4}: " + ", ".join(f"{name} {peak:.1f}/{rms:.1f} mm" for name, (peak, rms) in rows.items())
    )

figure, panels = plt.subplots(2, 2, figsize=(7, 5), sharey="row", layout="constrained")
for column, (axis, data) in enumerate(((np.array(stiffnesses) * 100, mistuned), (np.array(clearances) * 1e3, spaced))):
    for number, name in enumerate(mistuned[1.0]):
        for row in (0, 1):
            values = [each[name][row] for each in data.values()]
            colour, mark = rb.plots.SERIES_COLOURS[number], "o^sD"[number]
            panels[row, column].plot(axis, values, f"{mark}-", color=colour, label=name)
panels[0, 0].set(ylabel="Peak drift (mm)", ylim=0)
panels[1, 0].set(ylabel="RMS drift (mm)", xlabel="Stiffness of the building (%)", ylim=0)
panels[1, 1].set(xlabel="Clearance of the balls (mm)")
figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=4, frameon=False)
figure.savefig("particle_tuned_mass.png", dpi=200)

# %%
# The numbers of the page.

for rows in mistuned.values():
    assert min(rows, key=lambda name: rows[name][0]) == "balls on the spring"
    assert min(rows, key=lambda name: rows[name][1]) == "tuned mass"
assert np.allclose([mistuned[factor]["balls on the spring"][0] for factor in stiffnesses], [21.5, 14.9, 14.9], atol=1.0)
assert np.allclose(mistuned[1.0]["tuned mass"], (18.0, 4.0), atol=0.1)
