"""A structure from a table of modes
=================================

For engineers with a finite-element model or a modal test: a structure from a table of its modes.

The modes of a beam are written as a table and read again. With a ball at the tip, both structures have the same motion.

:doc:`/how-to/structures` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "inputs"]

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

BAR = rb.Beam(length="250 mm", material="steel", diameter="25 mm", tip_mass="0.3 kg", damping_ratio=0.01)


def table_of(structure: rb.Beam) -> str:
    """Return frequencies, damping and mass-normalised shapes as CSV."""
    modes = structure.modes()
    lines = ["frequency (Hz), damping (%), tip (kg^-0.5), middle (kg^-0.5)"]
    for k, frequency in enumerate(structure.frequencies):
        lines.append(f"{frequency:.17g}, 1, {modes.shapes['tip'][k]:.17g}, {modes.shapes['middle'][k]:.17g}")
    return "\n".join(lines)


def run_after_hit(structure: rb.Beam | rb.Modal) -> rb.Run:
    """Return 50 ms after a hit at the tip, with a steel ball in a gap of 0.1 mm."""
    ball = rb.ImpactDamper(
        ball=rb.Sphere(diameter="20 mm", material="steel"),
        gap="0.1 mm",
        contact=rb.Tsuji(restitution=0.8),
        point="tip",
    )
    hit = rb.HalfSine(amplitude="2 kN", duration="1 ms", point="tip")
    return rb.simulate(rb.Case(structure=structure, load=hit, damper=ball, duration="50 ms"))


def tip_after_hit(structure: rb.Beam | rb.Modal) -> float:
    """Return the RMS displacement of the tip in these 50 ms [m]."""
    return float(np.sqrt(np.mean(run_after_hit(structure).motion.displacement.sel(point="tip") ** 2)))


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "bar.csv"
        file.write_text(table_of(BAR))
        table = rb.Modal.from_file(file)
    beam, modal = tip_after_hit(BAR), tip_after_hit(table)
    figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
    for structure, style, name in ((BAR, "-", "beam"), (table, "--", "table of its modes")):
        tip = run_after_hit(structure).motion.displacement.sel(point="tip")
        axes.plot(1e3 * tip.time, 1e3 * tip, style, label=name)
    axes.set(xlabel="Time (ms)", ylabel="Displacement of the tip (mm)")
    axes.legend()
    figure.savefig("structure_from_modes.png", dpi=200)
    print(f"{BAR.frequencies[0]:.1f} Hz; tip {1e6 * beam:.2f} um and {1e6 * modal:.2f} um")
    assert abs(modal / beam - 1) < 1e-6 and abs(beam - 1.0218e-3) < 1e-7


if __name__ == "__main__":
    main()
