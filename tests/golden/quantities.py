"""Physical quantities of a run under names that do not change with the public interface.

The stored results use the names that are defined here, so that a renamed attribute changes only this module.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import choose as core

Quantities = dict[str, NDArray[Any]]

_IMPACTS = {
    "impact_time": "time",
    "impact_damper": "damper",
    "impact_place": "contact",
    "impact_approach_speed": "approach_speed",
    "impact_separation_speed": "separation_speed",
    "impact_restitution": "restitution",
    "impact_duration": "duration",
    "impact_peak_overlap": "peak_overlap",
    "impact_peak_force": "peak_force",
    "impact_energy_lost": "energy_lost",
}
_SHARED = {
    "time": "time",
    "structure_position": "displacement",
    "structure_velocity": "velocity",
    "cavity_force": "cavity_force",
    "load": "load",
    "base_velocity": "base_velocity",
    "mode_energy": "mode_energy",
    "contact_energy": "contact_energy",
    "gravity_energy": "gravity_energy",
    "load_work": "load_work",
    "base_work": "base_work",
    "viscous_loss": "viscous_loss",
    "normal_loss": "normal_loss",
    "plastic_loss": "plastic_loss",
}
_BALLS = {
    "ball_position": "ball_position",
    "ball_velocity": "ball_velocity",
    "ball_energy": "ball_energy",
}
_PARTICLES = {
    "cavity_moment": "cavity_moment",
    "centre_of_mass": "centre_of_mass",
    "momentum": "momentum",
    "contacts": "contacts",
    "kinetic_energy": "kinetic_energy",
    "rotation_energy": "rotation_energy",
    "sliding_loss": "sliding_loss",
    "rolling_loss": "rolling_loss",
}
_FINAL = {
    "final_position": "position",
    "final_velocity": "velocity",
    "final_spin": "spin",
    "radius": "radius",
}
LOSSES = ("viscous_loss", "normal_loss", "plastic_loss", "sliding_loss", "rolling_loss")
"""Quantities that hold energy lost since the start; the last ones of particles only."""

KINDS = (
    (
        *("mode_energy", "contact_energy", "gravity_energy", "ball_energy", "kinetic_energy", "rotation_energy"),
        *("load_work", "base_work", "impact_energy_lost", *LOSSES),
    ),
    ("cavity_force", "load", "impact_peak_force"),
)
"""Quantities whose rounding errors share a scale: energies [J] and forces [N]. Each of the others has a separate scale."""
_EVERY = 5
"""Interval of the particles whose final state is among the values; the bits cover all particles."""


def quantities(run: Any) -> Quantities:
    """Return the physical quantities of a run.

    Parameters
    ----------
    run
        Run of either engine.

    Returns
    -------
    dict of str to ndarray
        Impacts one by one, samples with the time as their first axis, and for particles the final state; SI units.
    """
    arrays = run.arrays
    found = {name: np.asarray(getattr(arrays, of)) for name, of in _SHARED.items()}
    if "particles" in run.groups:
        found |= {name: np.asarray(getattr(arrays, of)) for name, of in _PARTICLES.items()}
        found |= {name: np.asarray(getattr(arrays.particles, of)) for name, of in _FINAL.items()}
        found["time_step"] = np.array(run.diagnostics["step"])
        found["largest_overlap"] = np.array(run.diagnostics["largest_overlap"])
        found["largest_approach_speed"] = np.array(run.diagnostics["largest_approach_speed"])
    else:
        found |= {name: np.asarray(getattr(arrays, of)) for name, of in _BALLS.items()}
        found |= {name: np.asarray(getattr(arrays.impacts, of)) for name, of in _IMPACTS.items()}
    return found | {"status": np.array(run.status)}


def was_stopped(run: Any) -> bool:
    """Return whether the progress function of a run stopped it."""
    return bool(run.status == "interrupted")


def predictable(found: Mapping[str, NDArray[Any]], impacts: int) -> Quantities:
    """Return the part of the quantities that does not depend on rounding.

    That is the part up to a number of impacts, without the durations of contacts that begin at rest, whose start is
    ill-conditioned. Of the particles one in five is included, to store less.
    """
    kept = dict(found)
    if "impact_duration" in kept:
        kept["impact_duration"] = np.where(found["impact_approach_speed"] == 0, np.nan, found["impact_duration"])
    for name in ("final_position", "final_velocity", "final_spin", "radius"):
        if name in kept:
            kept[name] = kept[name][::_EVERY]
    if found.get("impact_time", np.zeros(0)).size < impacts:
        return kept
    before = found["time"] < found["impact_time"][impacts - 1]
    for name, array in found.items():
        if name.startswith("impact_"):
            kept[name] = kept[name][:impacts]
        elif name != "status":
            kept[name] = array[before]
    return kept


def measures(found: Mapping[str, NDArray[Any]]) -> dict[str, float]:
    """Return measures of a chaotic run: final losses [J], and the number of impacts or contacts."""
    values = {name: float(np.sum(found[name][-1])) for name in LOSSES if name in found}
    if "impact_time" in found:
        values["impacts"] = float(found["impact_time"].size)
    else:
        values["contacts"] = float(np.mean(np.sum(found["contacts"], axis=(1, 2))))
    return values


def levels() -> tuple[str, ...]:
    """Return the instruction sets that are built and that this machine can run, best first."""
    return core.supported()


def core_file(level: str) -> str:
    """Return the path of the compiled core of an instruction set."""
    from importlib.util import find_spec

    spec = find_spec(f"rattlebox.core._core_{level}")
    return "" if spec is None or spec.origin is None else spec.origin
