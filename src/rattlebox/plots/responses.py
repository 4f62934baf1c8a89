"""Figure of responses over time: accelerations, drifts, modal coordinates, forces of dampers and on the base, loads."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise, permutations
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from rattlebox._util.exceptions import CaseError

from ..model.units import STANDARD_GRAVITY
from ..results import Run, RunArrays
from ..results.figures import run_figure
from ..results.schema import AXES
from .panels import draw_largest, time_panels, time_window
from .style import axis_in_g, figure_style, label, scaled, time_axis
from .types import Size, Vector

QUANTITIES = {
    "displacement": ("Displacement", "m"),
    "velocity": ("Velocity", "m/s"),
    "acceleration": ("Acceleration relative to base", "m/s^2"),
    "absolute_acceleration": ("Absolute acceleration", "m/s^2"),
    "modal_displacement": ("Displacement of modes", "kg^0.5 m"),
    "modal_velocity": ("Velocity of modes", "kg^0.5 m/s"),
    "cavity_force": ("Force of damper", "N"),
    "interface_force": ("Force on base", "N"),
    "base_displacement": ("Displacement of base", "m"),
    "base_velocity": ("Velocity of base", "m/s"),
    "base_acceleration": ("Acceleration of base", "m/s^2"),
    "load": ("Load", "N"),
}
"""Labels and units of the variables that can be drawn."""


class Panel(NamedTuple):
    """Lines of one panel: values (T, N) [SI] and their names, label and unit of the axis."""

    values: Vector
    names: list[str]
    text: str
    unit: str


@run_figure("responses")
def plot_responses(
    run: Run,
    *,
    of: str | Iterable[str] | None = None,
    size: Size = "column",
    between: tuple[float, float] | None = None,
) -> Figure:
    """Draw responses over time, one panel for each.

    Parameters
    ----------
    run
        Run to draw.
    of
        Variables of the motion, such as "absolute_acceleration", "modal_displacement", "cavity_force" and
        "interface_force", and drifts such as "storey 2 - storey 1" and "storey 1 - base". Default: absolute acceleration,
        drifts of storeys, forces of dampers and on the base, loads and acceleration of the base, unless they are zero.
    size
        Width of the figure: "column", "page" or "slide".
    between
        First and last time to draw [s]; default the whole run.

    Returns
    -------
    Figure
        Figure with one panel for each variable and one for all drifts; of many lines those with the largest values.

    Raises
    ------
    ValueError
        If the run has no such variable or points, no output time lies within `between`, or the size is unknown.
    """
    arrays = run.arrays
    window = time_window(arrays, between)
    chosen = _default(arrays) if of is None else [of] if isinstance(of, str) else list(of)
    drifts = [name for name in chosen if " - " in name]
    variables = [name for name in chosen if name not in drifts]
    panels = [response(run, name) for name in variables]
    if drifts:
        panels.insert(min(1, len(panels)), _drifts(arrays, drifts))
    if not panels:
        raise CaseError("of is empty", ", ".join(QUANTITIES))
    with figure_style(size):
        figure, axes = time_panels(size, len(panels))
        time = scaled(arrays.time[window], "s")
        for axis, panel in zip(axes, panels, strict=True):
            values = panel.values[window]
            scale = scaled(values, panel.unit)
            draw_largest(axis, arrays.time[window] / time.divisor, values / scale.divisor, panel.names)
            label(axis, "y", panel.text, scale.unit)
            if panel.unit == "m/s^2":
                axis_in_g(axis, "y", STANDARD_GRAVITY)
        time_axis(axes[-1], arrays.time[window], time)
        figure.align_ylabels(axes)
    return figure


def _default(arrays: RunArrays) -> list[str]:
    """Return the responses that are not zero."""
    storeys = [f"storey {k}" for k in range(1, len(arrays.points) + 1) if f"storey {k}" in arrays.points]
    chosen = ["absolute_acceleration"] if arrays.points else []
    chosen += [f"{upper} - {lower}" for lower, upper in pairwise(["base", *storeys])]
    for name in ("cavity_force", "interface_force", "load", "base_acceleration"):
        values = getattr(arrays, name)
        if values.size and np.isfinite(values).all() and values.any():
            chosen.append(name)
    return chosen or ["base_acceleration"]


def response(run: Run, name: str, point: str | None = None) -> Panel:
    """Return the lines of a variable or a drift; of the variables of points that of one point, if it is given."""
    panel = _drifts(run.arrays, [name]) if " - " in name else _variable(run.arrays, name)
    if name.startswith("modal"):
        return _at_largest_points(panel, run.case.modes.lines())
    if len(panel.names) == 1 and " - " in name:
        return panel._replace(text=f"Drift of {name}")
    if point not in panel.names or point is None:
        return panel
    where = panel.names.index(point)
    return panel._replace(values=panel.values[:, where : where + 1], names=[point], text=f"{panel.text} of {point}")


def _variable(arrays: RunArrays, name: str) -> Panel:
    """Return the lines of a variable: one for each point, mode, load or damper, with axis in a 3-D run."""
    if name not in QUANTITIES:
        raise CaseError(f"of = {name!r} is not a response", f"{', '.join(QUANTITIES)}, or 'upper point - lower point'")
    values = np.asarray(getattr(arrays, name), dtype=float)
    first: list[str] = [""]
    if name in ("displacement", "velocity", "acceleration", "absolute_acceleration"):
        first = list(arrays.points)
    elif name.startswith("modal"):
        first = [f"mode {k + 1}" for k in range(arrays.mode_frequency.size)]
    elif name == "cavity_force":
        first = list(arrays.dampers)
    elif name == "load":
        first = list(arrays.loads)
    values = values.reshape(arrays.time.size, len(first), -1) if first else np.zeros((arrays.time.size, 0, 1))
    if not values.size:
        raise CaseError(f"of = {name!r}: this run has no {QUANTITIES[name][0].lower()}", f"{', '.join(QUANTITIES)}")
    if values.shape[2] == len(AXES):
        several = len(first) > 1
        names = [f"{one} {axis}" if several else f"along {axis}" for one in first for axis in AXES]
    else:
        names = first
    return Panel(values.reshape(arrays.time.size, -1), names, *QUANTITIES[name])


def _at_largest_points(panel: Panel, lines: Mapping[str, Vector]) -> Panel:
    """Return the motion of modes at the point that each moves most, in metres: a modal coordinate is in kg^0.5 m."""
    shapes, points = np.array(list(lines.values())), list(lines)
    largest = np.abs(shapes).argmax(axis=0)
    scale = shapes[largest, np.arange(shapes.shape[1])]
    names = [f"{name} at {points[place]}" for name, place in zip(panel.names, largest, strict=True)]
    return Panel(panel.values * scale, names, panel.text, panel.unit.removeprefix("kg^0.5 "))


def _drifts(arrays: RunArrays, names: list[str]) -> Panel:
    """Return the displacements of points relative to others or to the base."""
    motion = dict(zip(arrays.points, arrays.displacement.T, strict=True)) | {"base": np.zeros(arrays.time.size)}
    columns = []
    for name in names:
        pair = next((pair for pair in permutations(motion, 2) if name == " - ".join(pair)), None)
        if pair is None:
            raise CaseError(
                f"of = {name!r} is not a drift between two points of the run",
                f"two of {', '.join(motion)}, as in '{next(iter(motion))} - base'",
            )
        columns.append(motion[pair[0]] - motion[pair[1]])
    return Panel(np.stack(columns, axis=1), names, "Drift", "m")
