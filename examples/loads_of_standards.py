"""For engineers who test equipment by a standard: random vibration of GEVS and a sine sweep on a box of 100 Hz.

The RMS response to random vibration agrees with Miles' equation within the scatter of one realisation. In a slow sweep the
peak is close to 1 / (2 zeta) times the static displacement, 25 for a damping ratio of 2 %.
"""

import math

import numpy as np

import rattlebox as rb

FREQUENCY, RATIO, G = 100.0, 0.02, 9.80665
BOX = rb.SDOF(mass="2 kg", frequency=FREQUENCY, damping_ratio=RATIO)


def rms_under_gevs() -> tuple[float, float]:
    """Return the RMS displacement relative to the base, simulated and by Miles' equation [m]."""
    shaking = rb.Random("gevs_acceptance", "20 s", seed=1)
    run = rb.simulate(rb.Case(structure=BOX, base=shaking, duration="20 s", output=rb.Output(rate="2 kHz")))
    miles = math.sqrt(math.pi / 2 * FREQUENCY / (2 * RATIO) * 0.08 * G**2) / (2 * math.pi * FREQUENCY) ** 2
    return float(run.arrays.displacement.std()), miles


def gain_in_sweep() -> float:
    """Return the largest displacement in a sweep from 70 to 140 Hz over the static one."""
    sweep = rb.SineSweep(amplitude="1 g", first_frequency="70 Hz", last_frequency="140 Hz", sweep_rate="6 oct/min")
    case = rb.Case(structure=BOX, base=sweep, duration=sweep.length, output=rb.Output(rate="4 kHz"))
    peak = np.abs(rb.simulate(case).arrays.displacement).max()
    return float(peak * (2 * math.pi * FREQUENCY) ** 2 / G)


if __name__ == "__main__":
    simulated, miles = rms_under_gevs()
    gain = gain_in_sweep()
    print(f"RMS {1e6 * simulated:.0f} um, by Miles {1e6 * miles:.0f} um; gain {gain:.1f} in the sweep")
    assert abs(simulated / miles - 1) < 0.1 and abs(gain / 25 - 1) < 0.03
