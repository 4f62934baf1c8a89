"""Best amplitude in weightlessness
================================

For critical readers: the best amplitude of a shaken box of beads in weightlessness.

While the bed is collected at a wall and thrown once per half-cycle, it acts as one inelastic mass: the loss per cycle
is at most 4 m A^2 w^2, at an amplitude A of the free clearance over pi, and the measured loss of Sack et al. in
parabolic flights follows this for different numbers and sizes of beads. At smaller amplitudes the bed does not reach
the other wall in phase and becomes a gas. Restitution and friction, which are not printed in the abstract, are swept.

References: A. Sack, M. Heckel, J. E. Kollmer, F. Zimber, T. Poeschel (2013), Energy dissipation in driven granular
matter in the absence of gravity, Physical Review Letters 111, 018001, doi:10.1103/PhysRevLett.111.018001.

:doc:`/validation/experiments` explains it.
"""

# sphinx_gallery_tags = ["space", "map", "validation"]

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import rattlebox as rb

DIAMETER, COUNT, FREQUENCY = 10e-3, 120, 2.0  # of the beads [m], of the shaker [Hz]
SIDE, LENGTH = 5.2 * DIAMETER, 100e-3  # of the cavity [m]


def clearance(count=COUNT, diameter=DIAMETER, density=0.6):
    """Return the length that the bed leaves free if it is packed with a volume fraction [m]."""
    return LENGTH - count * np.pi / 6 * diameter**3 / (density * SIDE**2)


def losses(
    amplitudes,
    restitution=0.75,
    friction=0.1,
    *,
    count=COUNT,
    diameter=DIAMETER,
    cycles=(6, 10),
    seed=1,
    softening=1000,
    fraction=0.025,
):
    """Return the loss per cycle over m A^2 w^2 at amplitudes [m]; the step is a fraction of the shortest contact."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter=diameter, count=count),
        cavity=rb.Box(size=(LENGTH, SIDE, SIDE)),
        contact=rb.Tsuji(restitution=restitution),
        friction=friction,
        gravity=(0, 0, 0),
        direction="x",
        packing=rb.Lattice(noise=1.0, seed=seed),
        softening=softening,
    )
    motion = rb.Harmonic(amplitude="10 mm", frequency=f"{FREQUENCY} Hz")
    method = rb.Dem(fraction=fraction)
    case = rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration="1 s", method=method)
    result = rb.loss_map(case, list(amplitudes), [f"{FREQUENCY} Hz"], cycles=cycles, progress=False)
    return result.reduced_loss.values[:, 0]


def one_mass(ratio):
    """Return the loss of one inelastic mass over m A^2 w^2, at amplitudes over the best one, at least 1."""
    tau = [brentq(lambda t, a=a: t - np.sin(t) - np.pi / a, 0.0, np.pi * (1 + 1e-12)) for a in ratio]
    return (1 - np.cos(tau)) ** 2


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    best = clearance() / np.pi
    ratio = np.array([0.5, 0.75, 1.0, 1.15, 1.4, 2.0])
    expected = one_mass(ratio[2:])
    print("one mass:", expected.round(2))
    figure, axes = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
    pairs = ((0.75, 0.1), (0.75, 0.3), (0.5, 0.1), (0.9, 0.1))
    for (restitution, friction), mark in zip(pairs, "o^sD", strict=True):
        loss = losses(best * ratio, restitution, friction)
        print(f"restitution {restitution}, friction {friction}:", loss.round(2))
        assert loss.argmax() == 2  # the best amplitude is the free clearance over pi
        assert loss[1] < 0.5 * loss[2]  # below, the bed is a gas
        assert np.allclose(loss[2:], expected, rtol=0.13 if restitution < 0.9 else 0.17)
        axes.plot(ratio, loss, f"{mark}-", ms=4, label=f"restitution {restitution}, friction {friction}")
    above = np.linspace(1, 2, 50)
    axes.plot(above, one_mass(above), "k", label="one inelastic mass")
    axes.set(xlabel="Amplitude (clearance/π)", ylabel="Loss a cycle ($m A^2 \\omega^2$)", ylim=0)
    axes.margins(x=0.03)
    axes.legend()
    for count, diameter in ((60, 10e-3), (200, 10e-3), (700, 4e-3)):
        amplitude = clearance(count, diameter) / np.pi
        low, high = losses(amplitude * np.array([0.75, 1.0]), count=count, diameter=diameter)
        print(f"{count} beads of {1e3 * diameter:g} mm: {high:.2f} at {1e3 * amplitude:.1f} mm, {low:.2f} at 3/4 of it")
        assert high > 3.4 and low < 0.5 * high
    figure.savefig("collect_and_collide.png", dpi=200)


if __name__ == "__main__":
    main()
