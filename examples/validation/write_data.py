"""For those who want to compare another program: the computed cases of the validation page as netCDF files.

`python write_data.py FOLDER` runs the scripts next to it and writes their numbers, with units and case files.
"""

import sys
from pathlib import Path

import bouncing_bed
import collect_and_collide
import microgravity_decay
import numpy as np
import xarray as xr

import rattlebox as rb


def decays():
    """Return the free decays in weightlessness over friction and random packing."""
    frictions, seeds = (0.0, 0.1, 0.3), (1, 2, 3)
    runs = [[rb.simulate(microgravity_decay.case(friction, seed)) for seed in seeds] for friction in frictions]
    time = runs[0][0].motion.time.values[::5]
    x = np.array([[run.motion.displacement.sel(point="mass").values[::5] for run in row] for row in runs])
    return xr.Dataset(
        {"displacement": (("friction", "packing", "time"), x.astype("f4"), {"units": "m"})},
        {"friction": list(frictions), "packing": list(seeds), "time": ("time", time, {"units": "s"})},
        {"title": "Free decay of a box of 37 beads in weightlessness", "case": runs[0][0].case.to_toml()},
    )


def losses():
    """Return the loss of a shaken box in weightlessness over amplitude, restitution and friction."""
    ratio = np.array([0.25, 0.5, 0.75, 0.9, 1.0, 1.15, 1.4, 2.0])
    pairs = [(0.75, 0.1), (0.75, 0.3), (0.5, 0.1), (0.9, 0.1)]
    best = collect_and_collide.clearance() / np.pi
    loss = [collect_and_collide.losses(best * ratio, *pair) for pair in pairs]
    return xr.Dataset(
        {"loss": (("beads", "ratio"), np.array(loss), {"units": "1", "long_name": "loss per cycle over m A^2 w^2"})},
        {
            "ratio": ("ratio", ratio, {"units": "1", "long_name": "amplitude over free clearance / pi"}),
            "restitution": ("beads", [pair[0] for pair in pairs]),
            "friction": ("beads", [pair[1] for pair in pairs]),
        },
        {"title": "Loss of a shaken box of 120 beads in weightlessness"},
    )


def masses():
    """Return apparent mass and loss of an open vertical box over the acceleration, from random packings."""
    levels, seeds = np.geomspace(1.5, 40.0, 12), (1, 2, 3, 4)
    stored, lost = np.swapaxes([bouncing_bed.masses(levels, seed=seed) for seed in seeds], 0, 1)
    over = ("packing", "acceleration")
    return xr.Dataset(
        {
            "effective_mass": (over, stored, {"units": "1", "long_name": "over the mass of the beads"}),
            "damping_mass": (over, lost, {"units": "1", "long_name": "over the mass of the beads"}),
        },
        {"packing": list(seeds), "acceleration": ("acceleration", levels, {"units": "9.81 m/s^2"})},
        {"title": "Apparent mass of an open vertical box of 120 beads at 60 Hz"},
    )


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for name, compute in (("decays", decays), ("losses", losses), ("masses", masses)):
        data = compute().assign_attrs(source=f"Rattlebox {rb.__version__}", licence="CC0-1.0")
        data.to_netcdf(folder / f"{name}.nc")
