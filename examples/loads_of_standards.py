"""Random vibration and sine sweep of a standard
=============================================

For engineers who test equipment by a standard: random vibration of GEVS and a sine sweep on a box of 100 Hz.

The RMS response to random vibration agrees with Miles' equation within the scatter of one realisation. In a slow sweep the
peak is close to 1 / (2 zeta) times the static displacement, 25 for a damping ratio of 2 %.

:doc:`/how-to/loads` explains it.
"""

# sphinx_gallery_tags = ["space", "inputs"]

import math

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

FREQUENCY, RATIO, G = 100.0, 0.02, 9.80665
BOX = rb.SDOF(mass="2 kg", frequency=FREQUENCY, damping_ratio=RATIO)


def under_gevs() -> rb.Run:
    """Return a run of 20 s of random vibration."""
    shaking = rb.Random("gevs_acceptance", "20 s", seed=1)
    return rb.simulate(rb.Case(structure=BOX, base=shaking, duration="20 s", output=rb.Output(rate="2 kHz")))


def rms_under_gevs() -> tuple[float, float]:
    """Return the RMS displacement relative to the base, simulated and by Miles' equation [m]."""
    run = under_gevs()
    miles = math.sqrt(math.pi / 2 * FREQUENCY / (2 * RATIO) * 0.08 * G**2) / (2 * math.pi * FREQUENCY) ** 2
    return float(run.arrays.displacement.std()), miles


def in_sweep() -> rb.Run:
    """Return a run of a sine sweep from 70 to 140 Hz."""
    sweep = rb.SineSweep(amplitude="1 g", first_frequency="70 Hz", last_frequency="140 Hz", sweep_rate="6 oct/min")
    return rb.simulate(rb.Case(structure=BOX, base=sweep, duration=sweep.length, output=rb.Output(rate="4 kHz")))


def gain_in_sweep() -> float:
    """Return the largest displacement in the sweep over the static one."""
    peak = np.abs(in_sweep().arrays.displacement).max()
    return float(peak * (2 * math.pi * FREQUENCY) ** 2 / G)


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    simulated, miles = rms_under_gevs()
    gain = gain_in_sweep()
    figure, panels = plt.subplots(1, 2, figsize=(7, 3), layout="constrained")
    random, sweep = under_gevs().motion.sel(time=slice(0, 1)), in_sweep().motion
    panels[0].plot(random.time, 1e6 * random.displacement.sel(point="mass"), lw=0.5, color=rb.plots.SERIES_COLOURS[0])
    panels[0].axhspan(-1e6 * miles, 1e6 * miles, color="0.85", zorder=0, label="± RMS by Miles' equation")
    panels[0].set(xlabel="Time (s)", ylabel="Displacement (µm)", title="Random vibration")
    panels[0].legend(loc="upper right")
    hertz = 70 * 2 ** (sweep.time / 10)  # 6 octaves a minute
    static = G / (2 * math.pi * FREQUENCY) ** 2
    panels[1].plot(hertz, sweep.displacement.sel(point="mass") / static, lw=0.2, color=rb.plots.SERIES_COLOURS[0])
    panels[1].axhline(1 / (2 * RATIO), color="0.5", ls="--")
    panels[1].set(xlabel="Frequency (Hz)", ylabel="Displacement over static", title="Sine sweep")
    figure.savefig("loads_of_standards.png", dpi=200)
    print(f"RMS {1e6 * simulated:.0f} um, by Miles {1e6 * miles:.0f} um; gain {gain:.1f} in the sweep")
    assert abs(simulated / miles - 1) < 0.1 and abs(gain / 25 - 1) < 0.03


if __name__ == "__main__":
    main()
