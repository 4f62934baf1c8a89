"""Effect of softening and time step on validation
===============================================

For critical readers: the main numbers of the validation scripts with other contacts and steps.

Contacts of particles are softened to save time, and motion is computed in steps. The main number of each script with
particles is repeated with half its softening and with half its step, from several random packings each. The
loss of the box in weightlessness falls by 1 % with less softening; other changes are within the interval.

:doc:`/validation/experiments` explains it.
"""

# sphinx_gallery_tags = ["space", "lecture", "validation"]

import bouncing_bed
import collect_and_collide
import matplotlib.pyplot as plt
import microgravity_decay
import numpy as np

import rattlebox as rb


def decrement(seed, softening, fraction):
    """Return the decrement per cycle of the free decay [diameters]."""
    run = rb.simulate(microgravity_decay.case(0.1, seed, softening, 8.0, fraction), progress=False)
    return microgravity_decay.linear_part(microgravity_decay.peaks(run)[1])[0] / microgravity_decay.DIAMETER


def loss(seed, softening, fraction):
    """Return the loss per cycle over m A^2 w^2 at the best amplitude."""
    best = [collect_and_collide.clearance() / np.pi]
    return collect_and_collide.losses(best, seed=seed, softening=softening, fraction=fraction)[0]


def damping_mass(seed, softening, fraction):
    """Return the damping mass over the mass of the beads at 16 g."""
    return bouncing_bed.masses([16.0], seed=seed, softening=softening, fraction=fraction)[1][0]


def effective_mass(seed, softening, fraction):
    """Return the effective mass over the mass of the beads at 3 g."""
    return bouncing_bed.masses([3.0], seed=seed, softening=softening, fraction=fraction)[0][0]


# Name, function, softening of the script, number of packings
QUANTITIES = (
    ("Decrement a cycle\n(diameters)", decrement, 1000, 12),
    ("Loss a cycle\n($m A^2 \\omega^2$)", loss, 1000, 24),
    ("Damping mass at 16 g\nover the bed's mass", damping_mass, 300, 8),
    ("Effective mass at 3 g\nover the bed's mass", effective_mass, 300, 8),
)
VARIANTS = (("as on the page", 1.0, 0.025), ("half the softening", 0.5, 0.025), ("half the step", 1.0, 0.0125))


def variants(function, softening, packings):
    """Return means and twice their standard errors for the variants."""
    values = [
        [function(seed, factor * softening, fraction) for seed in range(1, packings + 1)]
        for _, factor, fraction in VARIANTS
    ]
    return np.mean(values, axis=1), 2 * np.std(values, axis=1, ddof=1) / np.sqrt(packings)


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    figure, panels = plt.subplots(1, len(QUANTITIES), figsize=(8, 2.6), layout="constrained")
    for panel, (name, function, softening, packings) in zip(panels, QUANTITIES, strict=True):
        means, errors = variants(function, softening, packings)
        print(
            name.replace("\n", " "),
            *(f"{mean:.4f} +- {error:.4f}" for mean, error in zip(means, errors, strict=True)),
            sep=", ",
        )
        significant = np.abs(means - means[0]) > np.hypot(errors, errors[0])
        assert np.abs(means / means[0] - 1)[significant].max(initial=0.0) < 0.02
        assert (np.abs(means / means[0] - 1) < 0.15).all()
        for k, (label, *_) in enumerate(VARIANTS):
            panel.errorbar(k, means[k], errors[k], fmt="os^"[k], ms=5, label=label)
        panel.set(title=name, xticks=[], xlim=(-0.7, 2.7))
    figure.legend(*panels[0].get_legend_handles_labels(), ncols=3, loc="outside lower center")
    figure.savefig("stiffer_and_finer.png", dpi=200)


if __name__ == "__main__":
    main()
