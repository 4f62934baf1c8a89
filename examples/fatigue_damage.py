"""Fatigue damage and pseudo-velocity spectra with and without a ball
==================================================================

For test engineers: what a part on a shaken box suffers, by rainflow counting with the package rainflow.

The ball calms the box at its resonance, where the damage of a part falls to 0.2 %; its blows excite parts of high
frequencies, whose damage rises. The spectrum of the largest pseudo-velocity shows the same on another scale.

:doc:`/how-to/analysis` explains the spectra.
"""

# sphinx_gallery_tags = ["space", "analysis"]

import matplotlib.pyplot as plt
import numpy as np
import rainflow
from scipy.signal import cont2discrete, lfilter
from scipy.special import gamma

import rattlebox as rb
from rattlebox.analysis import shock_response_spectrum

RATE, LENGTH, ZETA, SLOPE = 8000, 20.0, 0.05, 6.0  # [Hz], [s], damping ratio of the parts, exponent of the S-N curve
FREQUENCIES = np.geomspace(15, 800, 40)
BOX = rb.SDOF(mass="2 kg", frequency="60 Hz", damping_ratio=0.01)
BALL = rb.ImpactDamper(ball=rb.Sphere(radius="16 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.5))


def pseudo_velocity(acceleration, frequency):
    """Return the relative displacement of a part on an accelerated base, times its angular frequency [m/s]."""
    w = 2 * np.pi * frequency
    above, below, _ = cont2discrete(([-1.0], [1.0, 2 * ZETA * w, w * w]), 1 / RATE, method="foh")
    return w * lfilter(np.ravel(above), below, acceleration)


def damage(acceleration, frequency):
    """Return the damage of a part by Miner's rule: the sum over all cycles of pseudo-velocity amplitudes to the exponent."""
    cycles = rainflow.extract_cycles(pseudo_velocity(acceleration, frequency))
    return sum(count * (0.5 * size) ** SLOPE for size, _, count, *_ in cycles)


def under(base, **damper):
    """Return the absolute acceleration of the box, and its times."""
    case = rb.Case(structure=BOX, base=base, duration=LENGTH, output=rb.Output(rate=RATE), **damper)
    motion = rb.simulate(case).motion
    return motion.time, motion.absolute_acceleration.sel(point="mass")


def against_closed_forms():
    """Return the damage over that of closed forms: of a harmonic motion, and of white noise."""
    time = np.arange(0, 100, 1 / RATE)
    harmonic = 3.0 * np.sin(2 * np.pi * 40 * time)
    own, driving = 2 * np.pi * 50, 2 * np.pi * 40
    amplitude = own * 3.0 / abs(own**2 - driving**2 + 2j * ZETA * own * driving)
    of_harmonic = damage(harmonic, 50.0) / (40 * 100 * amplitude**SLOPE)
    # Narrow-band response: Rayleigh amplitudes with the RMS value of Miles' equation; a mean over parts, since one scatters.
    noise = rb.Random([(5, 1.0), (1000, 1.0)], "100 s", unit="m/s^2", seed=2)
    values = np.interp(time, noise.times, noise.values)
    ratios = []
    for frequency in np.geomspace(40, 400, 16):
        rms = np.sqrt(np.pi / 2 * frequency / (2 * ZETA)) / (2 * np.pi * frequency)  # of the pseudo-velocity
        expected = frequency * 100 * (np.sqrt(2) * rms) ** SLOPE * gamma(1 + SLOPE / 2)
        ratios.append(damage(values, frequency) / expected)
    of_noise = np.mean(ratios)
    return of_harmonic, of_noise


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    harmonic, noise = against_closed_forms()
    shaking = rb.Random([("20 Hz", "0.01 g^2/Hz"), ("500 Hz", "0.01 g^2/Hz")], LENGTH, seed=1)
    figure, panels = plt.subplots(1, 2, figsize=(7, 3.2), layout="constrained")
    damages = []
    for label, damper, colour in (
        ("without", {}, "0.4"),
        ("with a ball", {"damper": BALL}, rb.plots.SERIES_COLOURS[0]),
    ):
        time, acceleration = under(shaking, **damper)
        damages.append(np.array([damage(acceleration.values, f) for f in FREQUENCIES]))
        spectrum = shock_response_spectrum(time, acceleration, FREQUENCIES, damping_ratio=ZETA)
        panels[0].loglog(FREQUENCIES, spectrum.pseudo_velocity, color=colour, label=label)
        panels[1].loglog(FREQUENCIES, damages[-1] / damages[0].max(), color=colour, label=label)
    panels[0].set(xlabel="Natural frequency of a part (Hz)", ylabel="Largest pseudo-velocity (m/s)")
    panels[1].set(xlabel="Natural frequency of a part (Hz)", ylabel="Fatigue damage (relative)")
    for panel in panels:
        panel.set_xticks([20, 50, 100, 200, 500], ["20", "50", "100", "200", "500"])
        panel.tick_params(axis="x", which="minor", labelbottom=False)
    panels[1].legend(loc="lower left")
    figure.savefig("fatigue_damage.png", dpi=200)
    ratio = damages[1] / damages[0]
    at = np.argmax(damages[0])
    print(f"harmonic {harmonic:.3f}, noise {noise:.2f} of the closed forms")
    print(f"damage with the ball: {ratio[at]:.3f} at {FREQUENCIES[at]:.0f} Hz, {ratio[-1]:.1f} at 800 Hz")
    assert abs(harmonic - 1) < 0.01 and abs(noise - 1) < 0.15
    assert ratio[at] < 0.01 and ratio[-1] > 10


if __name__ == "__main__":
    main()
