"""Binary bodies of a run for the page: curves, impacts, frames and the summary."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import rattlebox as rb

from .binary import encode

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
Arrays = dict[str, Array]
Chart = dict[str, Any]
"""Chart or series for the browser."""

MOST_SAMPLES = 6000
"""Samples of a curve; of longer runs every n-th sample is drawn, as the page states."""
MOST_FRAMES = 3000
"""Frames of an animation of balls on a line."""
MOST_LISTED = 200
"""Impacts in the list."""
FLASH = 0.004
"""Duration of the flash of a contact over that of the run."""
MOST_BYTES = 200_000_000
"""Largest size of the frames of particles [B]; of longer runs every n-th frame is sent."""


def view_of_run(run: rb.Run, bare: rb.Run | None = None) -> bytes:
    """Return the curves, the animation and the summary of a run, and the motion of the bare structure if it is given.

    The body has the format of `rattlebox.app.binary`; lengths are in mm, energies in `energy_unit`.
    """
    motion, energy = run.motion, run.energy
    time = motion.time.values
    rows = _rows(time.size)
    arrays: Arrays = {"time": time[rows]}
    # A shaker has no point of its own that moves: its base is shown.
    points = (
        [str(point) for point in motion.point.values] if "displacement" in motion and run.case.modes.decay.size else []
    )
    for k, point in enumerate(points):
        arrays[f"displacement {point}"] = 1e3 * motion.displacement.values[rows, k]
    if not points:
        arrays["displacement base"] = 1e3 * _base(run)[rows]
        points = ["base"]
    # One unit for all energies, so that curves can be compared.
    energies = {name: _total(energy[name])[rows] for name in _ENERGIES if name in energy}
    unit, scale = prefixed("J", energies.values())
    arrays |= {name: scale * values for name, values in energies.items()}
    if bare is not None:
        chosen = _rows(bare.motion.time.size)
        arrays["bare time"] = bare.motion.time.values[chosen]
        arrays["bare displacement"] = 1e3 * bare.motion.displacement.values[chosen, 0]
    about: dict[str, Any] = {
        "points": points,
        "summary": str(run.summary()),
        "status": run.status,
        "warnings": [note for note in run.notes if note.startswith("warning: ")],
        "notes": [note for note in run.notes if not note.startswith("warning: ")],
        "shown": f"every {rows.step} of {time.size} samples" if rows.step > 1 else "",
        "end": float(time[-1]),
        "energy_unit": unit,
    }
    if "impacts" in run.groups:
        arrays |= _balls(run, rows)
        log = run.impacts
        first = {
            "time": log.time,
            "speed": log.approach_speed,
            "force": log.peak_force,
            "loss": scale * log.energy_lost,
        }
        columns = {name: values.values[:MOST_LISTED].astype(float) for name, values in first.items()}
        about["impacts"] = [
            {"number": k + 1, **{name: f"{values[k]:.5g}" for name, values in columns.items()}}
            for k in range(min(MOST_LISTED, log.sizes["impact"]))
        ]
        about["impact_count"] = int(log.sizes["impact"])
        about["gaps"] = (1e3 * motion.clearance.values / 2).tolist() if "clearance" in motion else []
        about["damper_of_ball"] = motion.ball_damper.values.tolist() if "ball_damper" in motion else []
    about["charts"] = _charts(arrays, points, run, unit)
    return encode(arrays, **about)


def comparison(runs: Mapping[str, rb.Run]) -> bytes:
    """Return charts of several runs: motion of the first point, or of the base, and losses in the dampers."""
    arrays: Arrays = {}
    losses = {
        name: sum((_total(run.energy[each]) for each in _LOSSES if each in run.energy), np.zeros(run.motion.time.size))
        for name, run in runs.items()
    }
    unit, scale = prefixed("J", losses.values())
    charts: list[Chart] = [
        {"title": "Motion of the first point", "x": "Time (s)", "y": "Displacement (mm)", "series": []},
        {"title": "Energy lost in the dampers", "x": "Time (s)", "y": f"Energy ({unit})", "series": []},
    ]
    for number, (name, run) in enumerate(runs.items()):
        motion, rows = run.motion, _rows(run.motion.time.size)
        moves = "displacement" in motion and run.case.modes.decay.size
        x = motion.displacement.values[:, 0] if moves else _base(run)
        arrays[f"time {name}"] = motion.time.values[rows]
        arrays[f"motion {name}"] = 1e3 * x[rows]
        arrays[f"loss {name}"] = scale * losses[name][rows]
        for chart, kind in zip(charts, ("motion", "loss"), strict=True):
            line = {"name": name, "x": f"time {name}", "y": f"{kind} {name}", "colour": number, "dash": number > 5}
            chart["series"].append(line)
    return encode(arrays, charts=charts)


def _charts(arrays: Arrays, points: Sequence[str], run: rb.Run, unit: str) -> list[Chart]:
    """Return the charts of a run: title, labels of the axes, and series with their arrays and the number of their colour."""

    def series(number: int, name: str, y: str, x: str = "time", **more: object) -> Chart:
        return {"name": name, "x": x, "y": y, "colour": number, **more}

    def chart(title: str, x: str, y: str, lines: list[Chart], **more: object) -> Chart:
        return {"title": title, "x": x, "y": y, "series": lines, **more}

    motion = [series(k, point, f"displacement {point}") for k, point in enumerate(points)]
    if "bare displacement" in arrays:
        motion[:1] = [series(0, f"{points[0]}, with damper", f"displacement {points[0]}")]
        motion.append(series(4, f"{points[0]}, without", "bare displacement", "bare time", dash=True))
    present = [(name, label) for name, label in _ENERGIES.items() if name in arrays and np.any(arrays[name])]
    ledger = [series(k, label, name, dash=name.endswith("loss")) for k, (name, label) in enumerate(present)]
    charts = [
        chart("Motion", "Time (s)", "Displacement (mm)", motion),
        chart("Energy", "Time (s)", f"Energy ({unit})", ledger),
    ]
    if "place" in arrays:
        balls = enumerate(run.motion.ball.values)
        lines = [series(i, str(ball), "speed", "place", row=i, portrait=True) for i, ball in balls]
        position_label = "Position from the centre of the cavity (mm)"
        charts.append(chart("Phase portrait in the cavity", position_label, "Velocity (m/s)", lines, portrait=True))
        hits = [series(0, "impacts", "impact speed", "impact time", dots=True)]
        limits = [float(run.arrays.time[0]), float(run.arrays.time[-1])]
        charts.append(chart("Impacts", "Time (s)", "Approach speed (m/s)", hits, range=limits))
    return charts


_ENERGIES = {
    "work": "work of load and base",
    "mode_energy": "structure",
    "ball_energy": "balls",
    "kinetic_energy": "particles",
    "rotation_energy": "rotation",
    "gravity_energy": "gravity",
    "viscous_loss": "lost in the structure",
    "normal_loss": "lost in normal damping",
    "plastic_loss": "lost in plastic flow",
    "sliding_loss": "lost in sliding",
    "rolling_loss": "lost in rolling",
}
"""Labels of the energies and losses."""
_LOSSES = ("normal_loss", "plastic_loss", "sliding_loss", "rolling_loss")
"""Losses in dampers."""


def prefixed(unit: str, values: Iterable[ArrayLike]) -> tuple[str, float]:
    """Return the unit with a prefix, and the factor to it, for numbers in an SI unit; the largest is then at least 2."""
    finite = [np.abs(each[np.isfinite(each)]) for each in map(np.asarray, values)]
    largest = max((float(each.max(initial=0.0)) for each in finite), default=0.0)
    if unit in ("m", "m/s", "N", "J", "W", "s") and largest > 0:
        for prefix, scale in (("M", 1e-6), ("k", 1e-3), ("", 1.0), ("m", 1e3), ("µ", 1e6)):
            if largest * scale >= 2 and (prefix in "mµ" or unit in "NJW"):
                return prefix + unit, scale
    return unit, 1.0


def _rows(count: int) -> slice:
    return slice(0, None, max(1, -(-count // MOST_SAMPLES)))


def _base(run: rb.Run) -> Array:
    """Return the displacement of the base in the direction of the first damper, or along the line of a 1-D run."""
    dampers = run.case.particle_dampers
    return np.asarray(run.along(dampers[0].direction if dampers else None).base_displacement.values)


def _total(values: xr.DataArray) -> Array:
    """Return an energy summed over all modes, dampers and partners."""
    others = tuple(axis for axis, dim in enumerate(values.dims) if dim != "time")
    return np.asarray(values.values.sum(axis=others), float)


def _balls(run: rb.Run, rows: slice) -> Arrays:
    """Return positions in the cavity, the phase portrait, the impacts and the frames of a 1-D run."""
    motion, log = run.motion, run.impacts
    time = motion.time.values
    frames = np.linspace(time[0], time[-1], min(MOST_FRAMES, max(2, time.size)))
    arrays: Arrays = {"frame time": frames}
    if run.case.modes.decay.size:
        names = [str(point) for point in motion.point.values]
        point = run.case.impact_dampers[0].point if run.case.impact_dampers else None
        moved = motion.displacement.values[:, names.index(point) if point in names else 0]
    else:
        moved = _base(run)
    arrays["frame displacement"] = 1e3 * np.interp(frames, time, moved)
    if motion.sizes.get("ball"):
        position = 1e3 * (motion.relative_position - motion.ball_centre).values
        arrays["place"] = position[rows].T
        arrays["speed"] = motion.relative_velocity.values[rows].T
        arrays["frame place"] = np.array([np.interp(frames, time, column) for column in position.T])
        at = log.time.values
        arrays["impact time"], arrays["impact speed"] = at, log.approach_speed.values
        arrays["impact force"] = log.peak_force.values
        arrays["impact contact"], arrays["impact damper"] = log.contact.values, log.damper.values
        # The time since the last impact, by which a contact flashes.
        after = frames - at[np.searchsorted(at, frames, side="right") - 1] if at.size else np.full(frames.size, np.inf)
        flash = FLASH * (time[-1] - time[0])
        arrays["frame flash"] = np.where((after >= 0) & (after < flash), 1 - after / flash, 0.0)
    return arrays


def view_of_snapshots(path: Path, first: int = 0) -> bytes:
    """Return the particles of the snapshots of a run from a number on, also while it runs.

    Returns body with `position` (frames, particles, 3) and `shift` of the cavities (frames, cavities, 3) [m], `speed` [m/s]
    and `spin` [rad/s] (frames, particles), `radius` [m], `species` and `cavity`, and `time` [s]. Long runs have every n-th
    snapshot from 0 on.
    """
    try:
        snapshots = rb.Snapshots(path)
        frames = range(len(snapshots))
        if len(snapshots):
            # Float32 of position, speed and spin of each particle.
            size = 20 * snapshots[0].radius.size
            frames = frames[:: max(1, -(-len(snapshots.planned) * size // MOST_BYTES))]
        new = [snapshots[number] for number in frames if number >= first]
    except rb.DataError:  # the bed still settles, or the file is being created or removed
        return encode({}, next=first, planned=0)
    cavities = _cavities(rb.Case.from_toml(snapshots.case_toml)) if new else []
    reach = max((2 * abs(cavity["place"][1]) + cavity["size"] for cavity in cavities), default=1.0)
    about = {"next": len(snapshots), "planned": len(snapshots.planned), "cavities": cavities, "reach": reach}
    return encode(_particles(new), **about)


def _cavities(case: rb.Case) -> list[dict[str, Any]]:
    """Return edges [m], size [m] and place in the picture [m] of each cavity: side by side along y, cells together."""
    groups = [(damper.interior, group) for damper, group in case.cell_groups]
    sizes = [float(cavity.lengths.max()) for cavity, _ in groups]
    widths = np.array(
        [size + float(np.ptp(group, axis=0).max()) for size, (_, group) in zip(sizes, groups, strict=True)]
    )
    ends = np.cumsum(1.3 * widths)
    middles = ends - 0.65 * widths - ends[-1] / 2
    return [
        {"size": size, "place": (place + np.array([0.0, middle, 0.0])).tolist(), **_edges(cavity.surface())}
        for size, middle, (cavity, group) in zip(sizes, middles, groups, strict=True)
        for place in group - 0.5 * (group.min(axis=0) + group.max(axis=0))
    ]


def _edges(surface: Any) -> dict[str, list[float]]:
    """Return the ends of the sharp edges and of the others of a surface, six numbers an edge [m]."""
    kinds: dict[str, list[float]] = {"sharp": [], "smooth": []}
    for edge in surface.edges:
        kinds["sharp" if surface.is_sharp(edge) else "smooth"] += surface.points[list(edge)].ravel().tolist()
    return kinds


def _particles(frames: Sequence[Any]) -> dict[str, Any]:
    if not frames:
        return {}
    return {
        "time": [frame.time for frame in frames],
        "position": [frame.position for frame in frames],
        "shift": [frame.displacement for frame in frames],
        "speed": [np.linalg.norm(frame.velocity - _carried(frame), axis=1) for frame in frames],
        "spin": [np.linalg.norm(frame.spin, axis=1) for frame in frames],
        "radius": frames[0].radius,
        "species": frames[0].species,
        "cavity": frames[0].cavity,
    }


def _carried(frame: Any) -> Any:
    """Return the mean velocity of the particles of each cavity, for each particle (n, 3) [m/s]."""
    count = np.bincount(frame.cavity)
    mean = np.array([np.bincount(frame.cavity, frame.velocity[:, axis]) / count for axis in range(3)]).T
    return mean[frame.cavity]
