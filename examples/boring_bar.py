"""Fill of a boring bar
====================

For engineers who fill a tool with particles: damping ratio of a boring bar over amplitude, for three fills.

The bar has a natural frequency of 180 Hz, at which an amplitude of 40 um is an acceleration of 5 g. Its head contains
tungsten carbide balls.

:doc:`/tutorials/boring_bar` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "damping curve"]

import rattlebox as rb

AMPLITUDES = ["20 um", "28 um", "40 um", "57 um", "80 um"]


# %%
# The bar is a mass on a spring. Its head has a cylindrical cavity, filled to a share of its volume.


def bar(fill, softening=100):
    """Return the case of the bar with a fill, as a share of the cavity's volume."""
    balls = rb.ParticleDamper(
        particles=rb.Particles(material="tungsten_carbide", diameter="6 mm", fill_ratio=fill),
        cavity=rb.Cylinder(diameter="40 mm", length="60 mm", axis="x"),
        contact=rb.Tsuji(restitution=0.8),
        friction=0.2,
        direction="z",
        packing=rb.Settled(seed=1),
        softening=softening,
    )
    structure = rb.SDOF(mass="3 kg", frequency="180 Hz", damping_ratio="1 %")
    return rb.Case(structure=structure, damper=balls, duration="0.25 s")


# %%
# Each ratio is that of a free decay, averaged over three random packings of the bed.


def curve(fill, softening=100, amplitudes=AMPLITUDES, packings=3, way="decay"):
    """Return the damping ratio over amplitude with a fill."""
    return rb.damping_curve(bar(fill, softening), amplitudes, packings=packings, way=way)


# %%
# Three fills in one figure: the damping falls with the amplitude, and the fullest cavity damps most.

if __name__ == "__main__":
    curves = {f"fill {fill}": curve(fill) for fill in (0.1, 0.2, 0.4)}
    at_5g = [100 * float(result.damping_ratio.sel(amplitude=40e-6)) for result in curves.values()]
    print("damping ratio at 5 g:", ", ".join(f"{ratio:.1f} %" for ratio in at_5g))
    rb.plot_damping_curve(curves).savefig("boring_bar.png", dpi=200)

# %%
# The numbers of the tutorial.

if __name__ == "__main__":
    assert 1.1 < at_5g[0] < 1.5 < at_5g[1] < 2.1 < 2.9 < at_5g[2] < 3.6
    assert all((result.damping_ratio.diff("amplitude") < 0).all() for result in curves.values())
