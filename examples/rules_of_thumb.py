"""Rules of thumb and their range
==============================

For designers of particle dampers: how far rules of thumb hold, by loss maps and decays of beds of balls.

Beds of 16 balls a layer are shaken without gravity at up to 2.5 times L/pi, where L is the length that they can move;
restitution, friction and the number of layers vary. Single balls from 0.15 L/pi on show what a bed cannot reach.

:doc:`/guide/rules_of_thumb` explains it.
"""

# sphinx_gallery_tags = ["space", "map", "damping curve"]

import math

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

FREE, BALL, HERTZ, G = 0.010, 0.005, 10.0, 9.80665  # m, m, Hz, m/s^2
BEST = FREE / math.pi  # amplitude of the shaker [m]
RATIOS = np.array([0.5, 0.8, 1.0, 1.3, 2.0, 2.5])  # of the amplitude to the best one
LONE = np.concatenate([[0.15, 0.2, 0.25, 0.3, 0.4], RATIOS])  # of single balls, which are best at small amplitudes
CALM = {
    "3 layers, restitution 0.8, friction 0.2": {},
    "restitution 0.5": {"restitution": 0.5},
    "friction 0.6": {"friction": 0.6},
    "6 layers, restitution 0.95": {"layers": 6, "restitution": 0.95},
}
LIVELY = {
    "friction 0": {"friction": 0.0},
    "restitution 0.95": {"restitution": 0.95},
    "1 layer": {"layers": 1},
}


def bed(layers=3, restitution=0.8, friction=0.2, **options):
    """Return a damper with this number of layers, in a box that is higher by the free length."""
    height = FREE + (1 + 0.9 * (layers - 1)) * BALL
    usual = {"gravity": (0, 0, 0), "packing": rb.Lattice(seed=1), "softening": 20, "direction": "z"}
    return rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter=BALL, count=16 * layers),
        **{"cavity": rb.Box(size=("20.2 mm", "20.2 mm", height))} | usual | options,
        contact=rb.Tsuji(restitution=restitution),
        friction=friction,
    )


def one_ball(restitution, speed=0.1):
    """Return a ball with an initial speed [m/s] in the same free length between hard walls."""
    sphere, contact = rb.Sphere(diameter=BALL, material="steel"), rb.Tsuji(restitution=0.5)
    damper = rb.ImpactDamper(ball=sphere, gap=FREE / 2, velocity=speed, contact=contact)
    return damper, rb.Newton(restitution=restitution)


def losses(damper, amplitudes=BEST * RATIOS, hertz=HERTZ, cycles=(10, 10), unit="m", **options):
    """Return the loss in a cycle on a shaker, in units of m V^2."""
    motion = rb.Harmonic(amplitude=(BEST, unit), frequency=hertz, direction=getattr(damper, "direction", None))
    case = rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration="1 s", **options)
    study = rb.loss_map(case, list(amplitudes), [hertz], cycles=cycles, samples=1 + 64 * cycles[1])
    assert "warnings" not in study or not study.warnings.any()
    return study.reduced_loss.values[:, 0]


def losses_of_a_ball(speed, ratio=0.3):
    """Return the loss of a ball of restitution 0.6 that starts at rest or with a speed [m/s], in units of m V^2."""
    damper, method = one_ball(0.6, speed)
    return losses(damper, [BEST * ratio], cycles=(400, 20), method=method)


def decays(share, ratios=(1.2, 2.5)):
    """Return added damping ratios over the mass ratio, in free decays of a structure with a bed of a share of its mass."""
    damper = bed()
    mass = float(damper.contents.mass.sum()) / share
    case = rb.Case(structure=rb.SDOF(mass=mass, frequency=HERTZ, damping_ratio=0), damper=damper, duration="3 s")
    return rb.damping_curve(case, [BEST * ratio for ratio in ratios], packings=3).damping_ratio.values / share


def decays_of_a_ball(share=0.005, ratios=(0.32, 0.4, 0.6)):
    """Return added damping ratios over the mass ratio, in free decays with one ball of restitution 0.6."""
    damper, method = one_ball(0.6)
    structure = rb.SDOF(mass=damper.balls[0].weight / share, frequency=HERTZ, damping_ratio=1e-4)
    case = rb.Case(
        structure=structure, damper=damper.model_copy(update={"velocity": (0.0,)}), method=method, duration="30 s"
    )
    curve = rb.damping_curve(case, [BEST * ratio for ratio in ratios], packings=4)
    return (curve.damping_ratio.values - 1e-4) / share


def along_a_floor(accelerations=(0.1, 0.2, 0.5, 1.0)):
    """Return the loss of a bed with friction 0.2 that rests on a floor and is shaken along it, at accelerations in g."""
    box = {"cavity": rb.Box(size=("30.2 mm", "20.2 mm", "24 mm")), "packing": rb.Settled(seed=1), "direction": "x"}
    damper = bed(**box, gravity=(0, 0, -G), softening="auto")
    return losses(damper, [G * each for each in accelerations], 60.0, cycles=(60, 20), unit="m/s^2")


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    beds = {}
    for name, options in (CALM | LIVELY).items():
        damper = bed(**options)
        slow = losses(damper, BEST * RATIOS[:1], cycles=(30, 30))  # the gas takes longer to become steady
        beds[name] = np.concatenate([slow, losses(damper, BEST * RATIOS[1:])])
    balls = {}
    for restitution in (0.0, 0.6, 0.8):
        damper, method = one_ball(restitution)
        balls[f"one ball, restitution {restitution:g}"] = losses(damper, BEST * LONE, cycles=(400, 20), method=method)
    print(f"{'amplitude over L/pi':40}", *(f"{ratio:4.2f}" for ratio in RATIOS))
    for name, values in beds.items():
        print(f"{name:40}", *(f"{value:4.2f}" for value in values))
    print(f"{'of single balls':40}", *(f"{ratio:4.2f}" for ratio in LONE))
    for name, values in balls.items():
        print(f"{name:40}", *(f"{value:4.1f}" for value in values))
    calm, lively = (np.array([beds[name] for name in names]) for names in (CALM, LIVELY))
    ratios = RATIOS.tolist()
    at = {ratio: calm[:, k] for k, ratio in enumerate(ratios)}
    loose = {ratio: lively[:, k] for k, ratio in enumerate(ratios)}
    for rows, ranges in ((at, ((0.7, 3.1), (3.2, 4.1), (1.8, 2.2))), (loose, ((2.6, 3.2), (2.3, 2.9), (1.1, 1.4)))):
        found = [(rows[ratio].min(), rows[ratio].max()) for ratio in (0.8, 1.0, 2.5)]
        assert np.allclose(found, ranges, rtol=0.1, atol=0.1)
    assert at[0.8].min() < 0.25 * at[1.0].max()  # collects or not
    assert all(np.ptp(at[ratio]) < 0.25 * at[ratio].mean() for ratio in (1.3, 2.0, 2.5))
    assert (np.maximum(loose[0.5], loose[0.8]) > loose[1.0]).all()
    assert np.allclose([loose[1.0][list(LIVELY).index("1 layer")], at[1.0][0]], [2.3, 3.4], atol=0.25)
    assert max(values.max() for values in beds.values()) < 4.2  # of all beds at all amplitudes
    ball = {name.rpartition(" ")[2]: dict(zip(LONE.tolist(), values, strict=True)) for name, values in balls.items()}
    assert abs(ball["0"][1.0] - 4) < 0.01 and 1.1 < ball["0.8"][1.0] < 1.3
    assert np.allclose([ball["0.6"][0.3], ball["0.6"][0.4], ball["0.8"][0.2]], [13, 8.6, 13.5], rtol=0.1)
    assert max(ball["0.6"][0.25], ball["0.8"][0.15]) < 1  # where the motion has broken down
    lost = [losses_of_a_ball(speed)[0] for speed in (0.0, 0.1)]
    print(
        "one ball, restitution 0.6, at 0.3 L/pi:",
        "; ".join(f"{each:.1f} m V^2" for each in lost),
        "from rest and with a speed",
    )
    assert lost[0] < 1 and lost[1] > 12
    lone = decays_of_a_ball()
    print(
        "one ball of 0.5 % of the mass adds",
        ", ".join(f"{each:.1f}" for each in lone),
        "times the mass ratio in a decay",
    )
    assert np.allclose(lone, [1.8, 1.3, 0.75], rtol=0.12)

    added = {share: decays(share) for share in (0.05, 0.2)}
    for share, (near, above) in added.items():
        print(f"mass ratio {share:.0%}: adds a damping ratio of {near:.2f} of it at 1.2 L/pi, {above:.2f} at 2.5 L/pi")
    assert np.allclose(added[0.05], [0.48, 0.27], rtol=0.12)  # 3.1 / (2 pi) = 0.49 and 1.9 / (2 pi) = 0.30 from the map
    assert np.allclose(added[0.2], [0.41, 0.22], rtol=0.12)
    floor = along_a_floor()
    print("along a floor at 0.1, 0.2, 0.5 and 1 g:", ", ".join(f"{value:.2f}" for value in floor), "m V^2")
    assert floor[:2].max() < 0.05 and np.allclose(floor[2:], [0.16, 1.25], rtol=0.3)

    figure, axes = plt.subplots(figsize=(6.5, 3.5), layout="constrained")
    styles = [(CALM, "-"), (LIVELY, "--"), (balls, "k:")]
    for names, style in styles:
        for name, alpha, mark in zip(names, (1, 0.75, 0.5, 0.3), "o^sD", strict=False):
            colour = {} if "k" in style else {"color": rb.plots.SERIES_COLOURS[style == "--"]}
            axes.plot(
                LONE if name in balls else RATIOS,
                (beds | balls)[name],
                mark + style,
                alpha=alpha,
                label=name,
                ms=4,
                **colour,
            )
    axes.set(xlabel="Amplitude ($L$/π)", ylabel="Loss a cycle ($m V^2$)", ylim=(0, 15))
    axes.margins(x=0.03)
    figure.legend(loc="outside right center")
    figure.savefig("rules_of_thumb.png", dpi=200)


if __name__ == "__main__":
    main()
