"""Wedge, ring and honeycomb
=========================

For users who choose the shape of a cavity: loss maps of three shapes with the same particles.

A wedge, a ring around a rod and a tube with a honeycomb are shaken sideways, each with 100 steel spheres of 3 mm and one
random packing.

:doc:`/how-to/sweep` explains axes of shapes.
"""

# sphinx_gallery_tags = ["space", "map"]

import matplotlib.pyplot as plt

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
        softening=300,
    ),
    duration="1 s",
)

# %%
# Cavity and bodies vary together along one axis, over a grid of amplitudes and frequencies.

cavities, bodies = zip(*shapes.values(), strict=True)
study = rb.sweep(
    case,
    {
        ("damper.cavity", "damper.bodies"): (list(cavities), list(bodies)),
        "structure.motion.amplitude": ["5 m/s^2", "10 m/s^2", "20 m/s^2", "40 m/s^2"],
        "structure.motion.frequency": ["20 Hz", "30 Hz", "45 Hz"],
    },
    ["reduced_loss"],
    cycles=(5, 10),
    progress=False,
)
loss = study.reduced_loss
for name, shape in zip(shapes, loss.values, strict=True):
    print(f"{name:10} largest loss {shape.max():.2f} m V^2, least {shape.min():.2f} m V^2")

# %%
# One map for each shape, on one scale.

levels = [5, 10, 20, 40]
figure, maps = plt.subplots(1, 3, figsize=(9, 3), sharey=True, layout="constrained")
for axes, name, shape in zip(maps, shapes, loss.values, strict=True):
    cells = axes.pcolormesh([20, 30, 45], levels, shape, vmin=0, vmax=float(loss.max()))
    axes.set(title=name, xlabel="frequency [Hz]", xticks=[20, 30, 45], yscale="log")
    axes.set_yticks(levels, [str(level) for level in levels])
    axes.minorticks_off()
maps[0].set_ylabel("amplitude [m/s$^2$]")
figure.colorbar(cells, label="loss per cycle [m V$^2$]")
figure.savefig("cavity_shapes.png", dpi=150)

# %%
# At large amplitudes the honeycomb loses most; at the smallest one and 20 Hz the wedge does.

of_wedge, of_ring, of_honeycomb = loss.values
assert of_honeycomb.max() > 1.3 * of_ring.max() > 1.3 * 1.3 * of_wedge.max()
assert of_wedge[0, 0] > 1.2 * of_ring[0, 0] and of_wedge[0, 0] > 2 * of_honeycomb[0, 0]
