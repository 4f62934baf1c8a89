"""Fill, level and packing of the damper of a panel
================================================

For engineers who ask what decides: fills, levels, packings and softening of the damper of ``panel.py``.

The clearance above the bed decides, and neither the packing nor the softening.

:doc:`/tutorials/panel` explains it.
"""

# sphinx_gallery_tags = ["space", "comparison", "check"]

import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb
from rattlebox.analysis import band_levels, power_spectral_density

PANEL = runpy.run_path(str(Path(__file__).parent / "panel.py"))
DAMPER, G = PANEL["damper"], PANEL["G"]


def levels(bands=("200",), seed=1, table="gevs_acceptance", **changed):
    """Return RMS accelerations of the middle in third octaves [g], RMS force on the base [N] and RMS displacement [m]."""
    dampers = {"damper": DAMPER.model_copy(update=changed)} if changed else {}
    run = PANEL["run"] | {"base": rb.Random(table, PANEL["LENGTH"], seed=seed)}
    along_z = rb.simulate(rb.Case(structure=PANEL["panel"], **run, **dampers), progress=False).along("z")
    velocity = along_z.velocity.sel(point="middle") + along_z.base_velocity
    absolute = velocity.differentiate("time").assign_attrs(units="m/s^2")
    density = power_spectral_density(along_z.time, absolute, resolution=2).density
    level = band_levels(density.sel(frequency=slice(20, 2000))) / G
    moved = along_z.displacement.sel(point="middle")
    return [
        *(float(level.sel(nominal=band)) for band in bands),
        float(along_z.interface_force.std()),
        float(moved.std()),
    ]


def filled(fill):
    """Return particles with another fill."""
    return DAMPER.particles[0].model_copy(update={"fill_ratio": fill})


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    bands = ("160", "200", "250", "800", "1250")
    bare, with_half = levels(bands), levels(bands, packing=DAMPER.packing)
    for name, values in (("bare", bare), ("fill 0.5", with_half)):
        words = ", ".join(f"{value:.1f} g at {band} Hz" for band, value in zip(bands, values, strict=False))
        print(f"{name}: {words}; {values[-2]:.0f} N, {1e3 * values[-1]:.2f} mm")
    lower = 1 - np.array(with_half) / bare
    print(f"lower by {lower[3]:.0%} at 800 Hz, {lower[4]:.0%} at 1250 Hz, {lower[5]:.0%} of the force")
    assert np.allclose(lower[3:6], [0.14, 0.09, 0.36], atol=0.03)
    assert abs(np.hypot.reduce(bare[:3]) - 54.8) < 0.5 and abs(bare[-1] - 0.34e-3) < 0.01e-3
    for level, hertz, moved in ((bare[3], 820.0, 13e-6), (bare[4], 1170.0, 5e-6)):
        assert abs(level * G / (2 * np.pi * hertz) ** 2 - moved) < 1e-6

    found = {
        "bare, another seed": (levels(seed=2), 49.2),
        "fill 0.2": (levels(particles=(filled(0.2),)), 50.6),
        "fill 0.4": (levels(particles=(filled(0.4),)), 46.3),
        "qualification, bare": (levels(table="gevs_qualification"), 75.7),
        "qualification, fill 0.5": (levels(table="gevs_qualification", packing=DAMPER.packing), 39.5),
        "packing 2": (levels(packing=rb.Lattice(seed=2)), 27.1),
        "packing 3": (levels(packing=rb.Lattice(seed=3)), 30.9),
        "softening 100": (levels(softening=100), 29.3),
        "softening 3": (levels(softening=3), 29.4),
        "softening 1": (levels(softening=1), 29.3),
    }
    for name, (values, known) in found.items():
        print(f"{name}: {values[0]:.1f} g at 200 Hz, {values[1]:.0f} N")
        assert abs(values[0] / known - 1) < 0.07
    figure, axes = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
    levels_at_200 = {"bare": bare[1], "fill 0.5": with_half[1]} | {
        name: values[0] for name, (values, _) in found.items()
    }
    axes.barh(list(levels_at_200), list(levels_at_200.values()), color=rb.plots.SERIES_COLOURS[0])
    axes.invert_yaxis()
    axes.set_xlabel("RMS acceleration in the band of 200 Hz ($g_0$)")
    figure.savefig("panel_variants.png", dpi=200)


if __name__ == "__main__":
    main()
