"""Softening and evaluation of a boring bar
========================================

For engineers who check a damping ratio: the bar of ``boring_bar.py`` with less softening, and in steady vibration.

The damping of the fullest cavity is computed with four softenings, that of all fills in decays and in steady vibration, and
three points of the latter with a harmonic force on the bar.

:doc:`/tutorials/boring_bar` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "damping curve", "check"]

import math
import runpy
from pathlib import Path

import numpy as np

import rattlebox as rb

BAR = runpy.run_path(str(Path(__file__).parent / "boring_bar.py"))
AMPLITUDES, LOW = BAR["AMPLITUDES"], ["10 um", "20 um", "40 um", "80 um"]
WAYS = {  # damping ratio with each fill at AMPLITUDES [%]
    ("decay", 0.1): [1.6, 1.4, 1.3, 1.3, 1.2],
    ("shaking", 0.1): [1.9, 1.6, 1.4, 1.3, 1.2],
    ("decay", 0.2): [2.5, 2.2, 1.8, 1.6, 1.3],
    ("shaking", 0.2): [2.9, 2.5, 2.0, 1.7, 1.5],
    ("decay", 0.4): [4.8, 4.0, 3.2, 2.7, 1.7],
    ("shaking", 0.4): [5.1, 4.3, 3.3, 2.7, 2.2],
}
SOFTENINGS = {100: [6.0, 4.7, 3.2, 1.8], 30: [4.3, 4.6, 3.2, 1.8], 10: [3.3, 4.6, 3.2, 1.7], 3: [2.7, 4.5, 3.3, 1.7]}
"""Damping ratio of the fill 0.4 at LOW [%]."""
DRIVEN = {0.1: (20e-6, 1.9), 0.2: (41e-6, 2.1), 0.4: (78e-6, 2.4)}
"""Amplitude [m] and damping ratio [%] with each fill under a harmonic force."""


def driven(fill, amplitude, hertz=175.0, cycles=(40, 40)):
    """Return the amplitude of a bar under a harmonic force that aims at an amplitude [m], and its damping ratio [%]."""
    case = BAR["bar"](fill)
    mass, omega = 3.0, 2 * math.pi * hertz
    force, count = 0.4 * mass * omega**2 * amplitude, sum(cycles)
    for _ in range(4):  # the force that keeps the bar at the amplitude
        load = rb.Harmonic(amplitude=(force, "N"), frequency=hertz)
        update = {"loads": (load,), "duration": count / hertz, "output": rb.Output(rate=64 * hertz)}
        run = rb.simulate(case.model_copy(update=update), progress=False)
        late = run.motion.time.values >= cycles[0] / hertz - 1e-9
        found = math.sqrt(2) * float(run.motion.displacement.values[late].std())
        supplied = run.ledger.supplied[late]
        force *= amplitude / found
    loss = (supplied[-1] - supplied[0]) / cycles[1]
    return found, 100 * loss / (2 * math.pi * mass * omega**2 * found**2)


def percent(result):
    """Return damping ratios and half of their 95 % intervals [%]."""
    return 100 * result.damping_ratio.values, 50 * (result.upper - result.lower).values


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    figure = rb.plots.StyledFigure("page", 0.5)
    panels = figure.subplots(1, 2, sharey=True)
    colours = dict(zip((0.1, 0.2, 0.4), rb.plots.SERIES_COLOURS, strict=False))
    marks = dict(zip(colours, "o^s", strict=True))
    for (way, fill), known in WAYS.items():
        ratios, halves = percent(BAR["curve"](fill, way=way, packings=4))
        print(
            f"{way}, fill {fill}:",
            *(f"{ratio:.2f}" for ratio in ratios),
            f"± {halves.min():.2f} to {halves.max():.2f} %",
        )
        style = marks[fill] + {"decay": "--", "shaking": "-"}[way]
        micrometres = [float(amplitude.split()[0]) for amplitude in AMPLITUDES]
        panels[0].plot(micrometres, ratios, style, color=colours[fill], label=f"{way}, fill {fill}")
        assert np.allclose(ratios, known, rtol=0.08)
    for fill, (amplitude, known) in DRIVEN.items():
        found, ratio = driven(fill, amplitude)
        print(f"harmonic force, fill {fill}: {1e6 * found:.0f} um, {ratio:.2f} %")
        panels[0].plot(1e6 * found, ratio, "x", color=colours[fill])
        assert abs(ratio / known - 1) < 0.1
    for (softening, known), mark in zip(SOFTENINGS.items(), rb.plots.SERIES_MARKERS, strict=False):
        ratios, halves = percent(BAR["curve"](0.4, softening, LOW, packings=4))
        print(
            f"softening {softening}:",
            *(f"{ratio:.2f} ± {half:.2f}" for ratio, half in zip(ratios, halves, strict=True)),
        )
        panels[1].plot([10, 20, 40, 80], ratios, f"{mark}-", label=f"softening {softening}")
        assert (abs(ratios - known) < halves + 0.1 * np.array(known)).all()
    panels[0].plot([], [], "kx", label="harmonic force")
    rb.plots.label(panels[0], "y", "Damping ratio", "%")
    for panel in panels:
        panel.set_ylim(bottom=0)
        panel.margins(x=0.03)
        rb.plots.label(panel, "x", "Amplitude", "µm")
        rb.plots.legend_above(panel)
    figure.savefig("boring_bar_checks.png")


if __name__ == "__main__":
    main()
