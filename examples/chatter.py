"""Chatter of a boring bar
=======================

For machine tool engineers: depth of cut up to which a bar does not chatter, alone and with a slug in its head.

A slug of tungsten carbide, 364 g in a gap of 20 um, contains the chatter: up to a depth of 0.29 mm, more than three times
that of the bar alone, vibrations stay below 22 um. A tuned mass of the same mass is stable at 0.8 mm.

:doc:`/how-to/chatter` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "chatter", "map"]

import rattlebox as rb

# %%
# The bar at its tip, and the cut: steel, with a directional factor of 0.7.

bar = rb.SDOF(mass="2.8 kg", frequency="210 Hz", damping_ratio=0.012)
cut = {
    "cutting_coefficient": "2000 N/mm^2",
    "directional_factor": 0.7,
    "speeds": rb.linspace("1000 rpm", "5000 rpm", 300),
}

# %%
# The slug is shaken at many amplitudes and three frequencies: its loss map.

slug = rb.ImpactDamper(
    ball=rb.Sphere(diameter="36 mm", material="tungsten_carbide"),
    gap="20 um",
    velocity="20 mm/s",
    contact=rb.Tsuji(restitution=0.6),
)
shaken = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude="20 um", frequency="210 Hz")),
    damper=slug,
    duration="1 s",
    method=rb.Newton(),
)
loss_map = rb.loss_map(shaken, rb.geomspace("4 um", "0.3 mm", 44), ["180 Hz", "250 Hz", "340 Hz"], cycles=(200, 100))

# %%
# The limit at each amplitude of vibration, and in words.

lobes = rb.stability_lobes(bar, loss_map, **cut)
print(lobes.attrs["answer"])

# %%
# The same bar with a tuned mass of the mass of the slug.

tuned = rb.stability_lobes(bar, rb.TunedMass.den_hartog(bar, mass=slug.balls[0].weight), **cut)
print(tuned.attrs["answer"].splitlines()[1])

# %%
# Lobes at four amplitudes, and the limit at all speeds over the amplitude.

if __name__ == "__main__":
    rb.plot_stability_lobes(lobes).savefig("chatter.png", dpi=200)

# %%
# The numbers above.

if __name__ == "__main__":
    best = float(lobes.limit.max())
    assert 3.2 < best / lobes.bare_limit < 3.7
    assert 20e-6 < float(lobes.amplitude[lobes.limit.argmax("amplitude")]) < 23e-6
    assert 9 < tuned.limit[0] / tuned.bare_limit < 10
