"""Apparent mass of an open box
============================

For critical readers: apparent mass and loss of an open vertical box over the acceleration.

Masmoudi et al. measured on a shaker, and Ferreyra et al. simulated, that the loss falls with the inverse of the
acceleration amplitude, and that the apparent mass falls steeply, about with the inverse of its square at moderate
accelerations, before it becomes negative. Sizes, restitution and friction of theirs are not in the abstracts and are
swept.

References: M. Masmoudi, S. Job, M. S. Abbes, I. Tawfiq, M. Haddar (2016), Experimental and numerical investigations
of dissipation mechanisms in particle dampers, Granular Matter 18, 71. M. V. Ferreyra, M. Baldini, L. A. Pugnaloni, S.
Job (2021), Effect of lateral confinement on the apparent mass of particle dampers, arXiv:2007.07961.

:doc:`/validation/experiments` explains it.
"""

# sphinx_gallery_tags = ["lecture", "map", "validation"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

GRAVITY, FREQUENCY = 9.81, "60 Hz"


def masses(
    accelerations,
    restitution=0.7,
    friction=0.3,
    *,
    width="15 mm",
    count=120,
    cycles=(30, 40),
    seed=1,
    softening=300,
    fraction=0.025,
):
    """Return effective mass and damping mass over the mass of the beads, at acceleration amplitudes in units of gravity.

    The step is a fraction of the shortest contact.
    """
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="3 mm", count=count),
        cavity=rb.Box(size=(width, width, "400 mm")),  # so high that no bead reaches the lid
        contact=rb.Tsuji(restitution=restitution),
        friction=friction,
        direction="z",
        packing=rb.Settled(seed=seed),
        softening=softening,
    )
    motion = rb.Harmonic(amplitude="20 m/s^2", frequency=FREQUENCY, unit="m/s^2")
    method = rb.Dem(fraction=fraction)
    case = rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration="1 s", method=method)
    levels = [GRAVITY * float(level) for level in accelerations]
    result = rb.loss_map(case, levels, [FREQUENCY], cycles=cycles, progress=False)
    parts = (result.effective_mass.values[:, 0], result.damping_mass.values[:, 0])
    return [part / float(result.particle_mass) for part in parts]


def exponent(levels, values):
    """Return the exponent of a power law through values."""
    return float(np.polyfit(np.log(levels), np.log(values), 1)[0])


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    moderate, high = np.geomspace(1.5, 4.0, 5), np.geomspace(8.0, 40.0, 5)
    figure, panels = plt.subplots(1, 2, figsize=(7, 3), layout="constrained")
    for (restitution, friction), mark in zip(((0.7, 0.3), (0.5, 0.3), (0.7, 0.1)), "o^s", strict=True):
        stored, lost = masses([*moderate, *high], restitution, friction)
        falls, decays = exponent(moderate, np.maximum(stored[:5], 1e-3)), exponent(high, lost[5:])
        print(
            f"restitution {restitution}, friction {friction}: effective mass {stored.round(3)}, damping mass {lost.round(3)}"
        )
        print(f"exponents {falls:.2f} of the effective mass up to 4 g, {decays:.2f} of the damping mass from 8 g on")
        assert -1.2 < decays < -0.8
        assert -3.5 < falls < -1.2
        assert (stored[7:] < 0).all()
        name = f"restitution {restitution}, friction {friction}"
        for panel, values in zip(panels, (stored, lost), strict=True):
            panel.plot([*moderate, *high], values, f"{mark}-", ms=4, label=name)
    for width, count, cycles in (("3.1 mm", 5, (60, 200)), ("6.6 mm", 20, (30, 80))):  # a column, and four columns
        _, lost = masses(high, width=width, count=count, cycles=cycles)
        print(f"{count} beads in a width of {width}: exponent {exponent(high, lost):.2f} of the damping mass")
        assert -1.2 < exponent(high, lost) < -0.8
    panels[0].set(ylabel="Effective mass over that of the beads", xscale="log")
    panels[0].axhline(0, color="0.8", lw=0.8, zorder=0)
    panels[1].plot(high, 6 / high, "k:", label="inverse of the acceleration")
    panels[1].set(ylabel="Damping mass over that of the beads", xscale="log", yscale="log")
    for panel in panels:
        panel.set_xlabel("Acceleration (g)")
        panel.set_xticks([2, 5, 10, 20, 40], ["2", "5", "10", "20", "40"])
        panel.minorticks_off()
        panel.margins(x=0.03)
    panels[1].set_yticks([0.05, 0.1, 0.2, 0.5], ["0.05", "0.1", "0.2", "0.5"])
    panels[1].legend(loc="lower left")
    figure.savefig("bouncing_bed.png", dpi=200)


if __name__ == "__main__":
    main()
