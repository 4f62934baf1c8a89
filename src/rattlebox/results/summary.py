"""Summary of the main results of a run, and comparison of several runs."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TextIO

import numpy as np

from rattlebox._util.batch_means import half_widths, shortest_window
from rattlebox._util.exceptions import CaseError, RattleboxError
from rattlebox._util.html import bullets, paragraph, table
from rattlebox._util.quantities import ACCELERATION, MISSING, STANDARD_GRAVITY, digits, quantity
from rattlebox.core import _core

from .damper_force import has_hard_impacts, mean_damper_force
from .extremes import accelerations, largest_acceleration, own_points, peak_drifts
from .free_decay import free_decay
from .schema import PARTNERS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from rich.console import Group

    from .arrays import FloatArray, RunArrays
    from .record import Record

Value = float | int | str

_MAX_POINTS = 4
"""Points of a structure with all their lines."""
_MAX_PEAKS = 20
"""Points of a structure with a line of their peak."""
SETTLED = 0.05
"""Displacement of a motion that has settled, over the peak of the first run of a comparison."""
_NAMED = {"share_in": "dampers", "peak_load": "loads", "peak_damper_force": "dampers"}
"""Values that are listed by name, and what has these names."""
_ROUNDING = 1e-9
"""Motion over the largest motion of any point, below which a point counts as at rest."""
_CHANNEL_LABELS = {
    "viscous": "lost in the structure",
    "normal": "lost in normal damping",
    "plastic": "lost in plastic flow",
    "sliding": "lost in sliding",
    "rolling": "lost in rolling",
    "motion": "left in the motion",
}
_OPTIONAL = ("plastic", "rolling")
"""Channels with a line only if they are not zero."""
_PARTNER_LABELS = {"particle": "lost between particles", "wall": "lost at walls"}


@dataclass(frozen=True, slots=True)
class _Row:
    """One line of the table: key of the value, label and unit.

    The unit is "%" for a share, "order" for an order of magnitude, "" for a count or a text. `at` is the key of the
    amplitude [m] at which a value holds.
    """

    key: str
    label: str
    unit: str = ""
    at: str = ""

    @property
    def in_g(self) -> _Row:
        """Line with accelerations in g alone, for tables of several columns."""
        return replace(self, unit="g") if self.unit == ACCELERATION else self

    def text(self, values: Mapping[str, Value]) -> str:
        value = values.get(self.key)
        scale = STANDARD_GRAVITY if self.unit == "g" else 1.0
        if isinstance(value, float):
            value /= scale
        if value is None:
            return MISSING
        if isinstance(value, str):
            return value
        if isinstance(value, int):
            return f"{value:,}".replace(",", " ")
        if self.at:
            return f"{quantity(value, self.unit)} at {quantity(float(values[self.at]), 'm')}"
        if self.key.startswith("steady_"):
            return self._with_error(value, float(values[error_of(self.key)]) / scale)
        if self.key == "end_time" and (start := float(values["start_time"])):  # of a run that continues another one
            return f"{quantity(start, self.unit)} to {quantity(value, self.unit)}"
        if self.key.startswith("settling_time") and math.isnan(value):
            return "not reached"
        if self.unit == "order":
            return f"{value:.1e}" if value else "0"
        if self.unit == "million":
            return MISSING if math.isnan(value) else f"{digits(1e-6 * value, 3)} million"
        return MISSING if self.unit == "1" and math.isinf(value) else quantity(value, self.unit)

    def _with_error(self, value: float, error: float) -> str:
        if math.isnan(error):
            return quantity(value, self.unit)  # a note says it once for all lines
        share = 100 * error / value if value else 0.0
        return f"{quantity(value, self.unit)} +- {digits(share, 2)} %"


_FIRST = (
    _Row("status", "status"),
    _Row("end_time", "simulated time", "s"),
    _Row("impacts", "impacts"),
    _Row("particles", "particles"),
    _Row("particle_mass", "mass of the particles", "kg"),
    _Row("fill_ratio", "volume of the particles over the cavity", "%"),
    _Row("bed_fill", "volume of the bed over the cavity", "%"),
    _Row("first_touches", "first touches"),
    _Row("contacts", "mean number of contacts", "1"),
    _Row("step", "time step", "s"),
    _Row("steps_per_contact", "steps in the shortest contact", "1"),
    _Row("supplied_energy", "energy supplied", "J"),
)
_CONTACTS = (
    _Row("energy_residual", "energy residual", "order"),
    _Row("largest_overlap", "largest overlap over radius", "%"),
    _Row("peak_contact_force", "peak contact force", "N"),
    _Row("largest_approach_speed", "largest approach speed", "m/s"),
)
_OF_POINT = (
    _Row("rms_displacement", "RMS displacement", "m"),
    _Row("settling_time", f"settles to {100 * SETTLED:g} % of the peak", "s"),
    _Row("steady_rms_displacement", "RMS displacement, second half", "m"),
    _Row("peak_acceleration", "peak acceleration", "m/s^2"),
    _Row("rms_acceleration", "RMS acceleration", "m/s^2"),
    _Row("steady_rms_acceleration", "RMS acceleration, second half", "m/s^2"),
    _Row("rms_relative_acceleration", "RMS acceleration relative to the base", "m/s^2"),
    _Row("peak_reduction", "reduction of the peak displacement", "%"),
    _Row("rms_reduction", "reduction of the RMS displacement", "%"),
)
"""Lines of a point; its name is added to their keys."""
_DECAY = _Row("equivalent_damping_ratio", "equivalent damping ratio", "%", at="damping_amplitude")
_LAST = (
    _Row("peak_interface_force", "peak force on the base", "N"),
    _Row("rms_interface_force", "RMS force on the base", "N"),
    _Row("steady_rms_interface_force", "RMS force on the base, second half", "N"),
    _Row("steady_loss_power", "mean power lost, second half", "W"),
    _Row("computing_time", "computing time", "s"),
    _Row("particle_steps_per_second", "particle steps per second", "million"),
)


def _main_results(run: Record) -> dict[str, Value]:
    """Return the values of the summary, in SI units."""
    arrays = run.arrays
    values: dict[str, Value] = {
        "status": run.status,
        "start_time": float(arrays.time[0]),
        "end_time": float(arrays.time[-1]),
    }
    if "impacts" in run.groups:
        values |= _impact_results(run)
    if "particles" in run.groups:
        values |= _particle_results(run)
    values["supplied_energy"] = float(run.ledger.supplied[-1])
    values |= {f"share_{channel}": share for channel, share in run.ledger.shares.items()}
    if len(arrays.dampers) > 1:
        shares = zip(arrays.dampers, run.ledger.damper_share, strict=True)
        values |= {f"share_in[{damper}]": float(share) for damper, share in shares}
    values["energy_residual"] = run.energy_residual
    if arrays.mode_frequency.size:
        relative, absolute = accelerations(run)
        for k, point in enumerate(arrays.points):
            x = arrays.displacement[:, k]
            values[f"peak_displacement[{point}]"] = _largest(np.abs(x))
            values[f"rms_displacement[{point}]"] = _rms(arrays.time, x)
            if absolute is not None:
                values |= _peak_and_rms(f"acceleration[{point}]", arrays.time, absolute[:, :, k])
            if relative is not None and relative is not absolute:
                values |= _peak_and_rms(f"relative_acceleration[{point}]", arrays.time, relative[:, :, k])
        values |= _extremes(run)
        values |= _modal_motion(arrays)
        if is_driven(arrays):
            values |= _steady_results(run, absolute)
        elif (decay := free_decay(arrays)) is not None:
            values["equivalent_damping_ratio"] = decay.damping_ratio
            values["damping_amplitude"] = decay.amplitude
    values |= _forces(run)
    values["computing_time"] = run.wall_time
    return values


def _impact_results(run: Record) -> dict[str, Value]:
    """Return the results of a run with an impact log."""
    log = run.arrays.impacts
    # Hard impacts have no force, and a contact that the end of the run interrupts may lack values.
    return {
        "impacts": len(log),
        "peak_contact_force": _largest(log.peak_force[np.isfinite(log.peak_force)]),
        "largest_approach_speed": _largest(log.approach_speed[np.isfinite(log.approach_speed)]),
    }


def _particle_results(run: Record) -> dict[str, Value]:
    """Return the results of a particle run."""
    arrays = run.arrays
    moved = len(arrays.particles) * run.counts.get("steps", 0)
    names = ("step", "steps_per_contact", "largest_overlap", "largest_approach_speed")
    shares = zip(PARTNERS, run.ledger.partner_share, strict=True)
    return {
        "particles": len(arrays.particles),
        "particle_mass": float(arrays.particle_mass.sum()),
        **{name: run.diagnostics[name] for name in ("fill_ratio", "bed_fill") if name in run.diagnostics},
        "first_touches": sum(run.counts.get(f"first_touches_{partner}", 0) for partner in PARTNERS),
        "contacts": float(arrays.contacts.sum(axis=(1, 2)).mean()),
        **{name: run.diagnostics.get(name, float("nan")) for name in names},
        **{f"share_at_{partner}": float(share) for partner, share in shares},
        "particle_steps_per_second": moved / run.wall_time if run.wall_time else float("nan"),
    }


def _notes(run: Record) -> tuple[str, ...]:
    """Return what a run states about itself."""
    message = (run.message,) if run.message and not run.ok else ()
    return message + run.notes


def _notes_about(all_values: Sequence[Mapping[str, Value]]) -> Iterator[str]:
    """Yield what the lines of a table leave out."""
    errors = [
        value for values in all_values for key, value in values.items() if key.partition("[")[0].endswith("_error")
    ]
    if any(isinstance(error, float) and math.isnan(error) for error in errors):
        yield "note: values of the second half without +- have no 95 % interval, because the run is too short for one"
    for what, name in _NAMED.items():
        count = len(_keys(what, all_values))
        if count > _MAX_POINTS:
            yield f"note: the table has the {_MAX_POINTS} of {count} {name} with the largest values; `values` has all"


def _largest(x: FloatArray) -> float:
    return float(np.max(x)) if x.size else float("nan")


def _rms(time: FloatArray, x: FloatArray) -> float:
    """Return the root mean square over time of a motion with uneven sample times."""
    if time.size < 2:
        return float(np.abs(x[0]))
    with np.errstate(over="ignore"):  # the solution may have diverged
        return float(np.sqrt(np.trapezoid(x**2, time) / (time[-1] - time[0])))


def _peak_and_rms(of: str, time: FloatArray, values: FloatArray) -> dict[str, Value]:
    """Return peak and root mean square of means over each output step, (T - 1,), or of values at its ends, (2, T - 1)."""
    with np.errstate(over="ignore"):
        squares = np.sum(_squares(values) * np.diff(time))
        rms = math.sqrt(squares / (time[-1] - time[0])) if values.size else math.nan
    return {f"peak_{of}": _largest(np.abs(values)), f"rms_{of}": rms}


def _squares(values: FloatArray) -> FloatArray:
    """Return the mean square in each output step of means over it, (T - 1,), or of values at its ends, (2, T - 1)."""
    return np.asarray(values**2 if values.ndim == 1 else (values**2).mean(axis=0))


def _extremes(run: Record) -> dict[str, Value]:
    """Return the drift of each storey of a building and the largest one, and the largest acceleration of several points."""
    drifts = peak_drifts(run.arrays)
    values: dict[str, Value] = {f"peak_drift[{storey}]": drift for storey, drift in drifts.items()}
    if drifts:
        values["largest_drift"] = max(drifts.values())
    with suppress(RattleboxError):  # of the case of a run from a file, which may name files that are gone
        if run.source and len(own_points(run.case)) > 1 and run.arrays.time.size > 1:
            values["largest_acceleration"] = largest_acceleration(run)
    return values


def _modal_motion(arrays: RunArrays) -> dict[str, Value]:
    """Return peak and RMS of the coordinate of each mode, if there are several."""
    values: dict[str, Value] = {}
    count = arrays.mode_frequency.size
    for k in range(count if count > 1 else 0):
        motion = arrays.modal_displacement[:, k]
        values[f"peak_modal_displacement[mode {k + 1}]"] = _largest(np.abs(motion))
        values[f"rms_modal_displacement[mode {k + 1}]"] = _rms(arrays.time, motion)
    return values


def _forces(run: Record) -> dict[str, Value]:
    """Return peak and RMS of loads, of the acceleration of the base, and of the forces of dampers and on the base."""
    arrays = run.arrays
    time = arrays.time
    values: dict[str, Value] = {}
    for name, load in zip(arrays.loads, arrays.load.T, strict=True):
        values |= {f"peak_load[{name}]": _largest(np.abs(load)), f"rms_load[{name}]": _rms(time, load)}
    base = np.linalg.norm(arrays.base_acceleration.reshape(time.size, -1), axis=1)
    if base.any():
        values |= {"peak_base_acceleration": _largest(base), "rms_base_acceleration": _rms(time, base)}
    with suppress(RattleboxError):  # of the case of a run from a file, which may name files that are gone
        mean = mean_damper_force(arrays, run.case) if run.source else np.zeros((0, 0))
        for index, name in enumerate(arrays.dampers if mean.size else ()):
            force = mean[:, index].reshape(time.size - 1, -1)
            if has_hard_impacts(arrays):
                force = np.full_like(force, np.nan)
            values |= _peak_and_rms(f"damper_force[{name}]", time, np.linalg.norm(force, axis=1))
    force = np.linalg.norm(arrays.interface_force.reshape(time.size, -1), axis=1)
    if np.isfinite(force).all() and force.any():
        values |= {"peak_interface_force": _largest(force), "rms_interface_force": _rms(time, force)}
    return values


def is_driven(arrays: RunArrays) -> bool:
    """Return whether a load or the base motion acts in the last tenth of a run."""
    late = arrays.time >= arrays.time[0] + 0.9 * (arrays.time[-1] - arrays.time[0])
    for values in (arrays.load, arrays.base_acceleration.reshape(arrays.time.size, -1)):
        if values.size and np.abs(values[late]).max() > 1e-3 * np.abs(values).max():
            return True
    return False


def _reductions(reference: Mapping[str, Value], values: Mapping[str, Value]) -> dict[str, Value]:
    """Return the relative reductions of the displacements against a reference run."""
    reductions: dict[str, Value] = {}
    for kind in ("peak", "rms"):
        for key, value in values.items():
            before = reference.get(key)
            if key.startswith(f"{kind}_displacement[") and isinstance(before, float) and before > 0:
                reductions[key.replace("displacement", "reduction", 1)] = 1 - float(value) / before
    return reductions


def _settling_times(reference: Mapping[str, Value], arrays: RunArrays) -> dict[str, Value]:
    """Return the times after which displacements are within the band around zero that the peaks of a reference set."""
    times: dict[str, Value] = {}
    for k, point in enumerate(arrays.points):
        peak = reference.get(f"peak_displacement[{point}]")
        if isinstance(peak, float) and peak > 0 and math.isfinite(peak):
            times[f"settling_time[{point}]"] = _core.settled_after(
                arrays.time - arrays.time[0], arrays.displacement[:, k], SETTLED * peak
            )
    return times


def _steady_results(run: Record, accelerations: FloatArray | None) -> dict[str, Value]:
    """Return results over the second half of a driven run, each with half the width of its 95 % interval.

    The series are means of squares, and of the power lost, over equal intervals of about the length of a mean output step.
    """
    arrays = run.arrays
    time = arrays.time
    # Batch means need equal steps, and the output times of a run with contacts are not equal.
    count = min(max(int(np.count_nonzero(2 * time >= time[0] + time[-1])), 2), 20_000)
    even = np.linspace(0.5 * (time[0] + time[-1]), time[-1], count)

    def late(cumulative: FloatArray) -> FloatArray:
        return np.asarray(np.diff(np.interp(even, time, cumulative)) / (even[1] - even[0]))

    def late_means(steps: FloatArray) -> FloatArray:
        # Interpolated samples would be too small between the crests.
        return late(np.concatenate([[0.0], np.cumsum(steps * np.diff(time))]))

    values: dict[str, Value] = {}
    least = _fewest_samples(run, even)
    for k, point in enumerate(arrays.points):
        x = arrays.displacement[:, k]
        values |= _root_with_interval(f"steady_rms_displacement[{point}]", late_means(_squares(_ends(x))), least)
        if accelerations is not None:
            squares = late_means(_squares(accelerations[:, :, k]))
            values |= _root_with_interval(f"steady_rms_acceleration[{point}]", squares, least)
    force = arrays.interface_force.reshape(time.size, -1)
    if np.isfinite(force).all() and force.any():
        squares = late_means(_squares(_ends(np.linalg.norm(force, axis=1))))
        values |= _root_with_interval("steady_rms_interface_force", squares, least)
    values |= _with_interval("steady_loss_power", late(run.ledger.losses), least)
    return values


def _ends(x: FloatArray) -> FloatArray:
    """Return samples (T,) as values at both ends of each output step, (2, T - 1)."""
    return np.stack([x[:-1], x[1:]])


def _fewest_samples(run: Record, times: FloatArray) -> float:
    """Return the fewest samples for an interval of a motion in which no damper acts, from its least damped mode; else 0."""
    arrays = run.arrays
    acts = np.any(arrays.impacts.time >= times[0]) if "impacts" in run.groups else arrays.contacts.any()
    if acts or not run.source:
        return 0.0
    with suppress(RattleboxError):  # of the case of a run from a file, which may name files that are gone
        return shortest_window(run.case.modes.decay) / float(times[1] - times[0])
    return 0.0


def _with_interval(key: str, series: FloatArray, least: float) -> dict[str, Value]:
    """Return the mean of a steady series, and half the width of its 95 % interval."""
    return {key: float(np.mean(series)), error_of(key): float(half_widths(series[None], least)[0][0])}


def _root_with_interval(key: str, squares: FloatArray, least: float) -> dict[str, Value]:
    """Return the root of the mean of steady squares, and half the width of its 95 % interval."""
    mean, half = float(np.mean(squares)), float(half_widths(squares[None], least)[0][0])
    lower, middle, upper = (math.sqrt(max(square, 0.0)) for square in (mean - half, mean, mean + half))
    return {key: middle, error_of(key): 0.5 * (upper - lower)}


def error_of(key: str) -> str:
    """Return the key of half the width of the interval of a value: rms_x[point] -> rms_x_error[point]."""
    name, bracket, point = key.partition("[")
    return f"{name}_error{bracket}{point}"


def _rows(all_values: Sequence[Mapping[str, Value]], detailed: Collection[str]) -> list[_Row]:
    """Return the lines for which any of the runs has a value, and all of them for the points in `detailed`."""

    def named(what: str, label: str, unit: str) -> Iterator[_Row]:
        for key, name in _largest_of(what, all_values):
            yield _Row(key, f"{label}{name}", unit)

    rows = list(_FIRST)
    for channel, label in _CHANNEL_LABELS.items():
        key = f"share_{channel}"
        if channel not in _OPTIONAL or any(values.get(key, 0.0) != 0.0 for values in all_values):
            rows.append(_Row(key, label, "%"))
    rows += [_Row(f"share_at_{partner}", label, "%") for partner, label in _PARTNER_LABELS.items()]
    rows += [*named("share_in", "lost in ", "%"), *_CONTACTS]
    several = len(_keys("peak_displacement", all_values)) > 1
    for key, point in _largest_of("peak_displacement", all_values, _MAX_PEAKS):
        where = f", {point}" if several else ""
        rows.append(_Row(key, f"peak displacement{where}", "m"))
        if point in detailed:
            rows += [replace(row, key=f"{row.key}[{point}]", label=row.label + where) for row in _OF_POINT]
    if len(_keys("peak_drift", all_values)) <= _MAX_POINTS:
        rows += named("peak_drift", "peak drift, ", "m")
    rows.append(_Row("largest_drift", "largest drift of all storeys", "m"))
    rows.append(_Row("largest_acceleration", "largest acceleration of all points", "m/s^2"))
    rows += [_DECAY, *named("peak_load", "peak load, ", "N")]
    rows.append(_Row("peak_base_acceleration", "peak acceleration of the base", "m/s^2"))
    rows += named("peak_damper_force", "peak force of ", "N")
    rows += [*named("rms_damper_force", "RMS force of ", "N"), *_LAST]
    return [row for row in rows if any(row.key in values for values in all_values)]


def _keys(what: str, all_values: Sequence[Mapping[str, Value]]) -> list[str]:
    """Return the keys "what[name]" of all runs."""
    return list(dict.fromkeys(key for values in all_values for key in values if key.startswith(f"{what}[")))


def _largest_of(
    what: str, all_values: Sequence[Mapping[str, Value]], count: int = _MAX_POINTS
) -> list[tuple[str, str]]:
    """Return key and name of the largest values with keys "what[name]"."""
    # A comparison lists the same points for all its runs: those with the largest value in any of them.
    keys = _keys(what, all_values)
    highest = [max(float(values.get(key, 0.0)) for values in all_values) for key in keys]
    return [(keys[k], _name_in(keys[k])) for k in largest_points(highest, count)]


def _name_in(key: str) -> str:
    """Return the name of a key "what[name]"."""
    return key.partition("[")[2][:-1]


def largest_points(peaks: ArrayLike, count: int) -> list[int]:
    """Return the points of a structure with the largest motion, without those at rest.

    `peaks`: largest displacement of each point, (P,) [m].
    """
    highest = np.asarray(peaks, dtype=float)
    moves = ~(highest <= _ROUNDING * highest.max(initial=0.0, where=np.isfinite(highest)))
    order = np.argsort(-highest, kind="stable")
    return sorted(order[moves[order] | ~moves.any()][:count].tolist())


class _Report:
    """A table of texts with a title, one label and one or more columns, and notes below."""

    def __init__(self, title: str, columns: tuple[str, ...], notes: tuple[str, ...]) -> None:
        self._title = title
        self._columns = columns
        self._notes = notes

    def _cells(self) -> list[tuple[str, ...]]:
        raise NotImplementedError

    def lines(self) -> list[tuple[str, ...]]:
        """Return the texts of the table, one tuple for each line: its label, and a text for each column."""
        return self._cells()

    def __str__(self) -> str:
        cells = self._cells()
        if any(self._columns):
            cells.insert(0, ("", *self._columns))
        widths = [max(len(row[k]) for row in cells) for k in range(len(cells[0]))]
        lines = [self._title] if self._title else []
        for row in cells:
            padded = [text.rjust(width) for text, width in zip(row, widths, strict=True)]
            padded[0] = row[0].ljust(widths[0])
            lines.append("  ".join(padded).rstrip())
        return "\n".join((*lines, *self._notes))

    __repr__ = __str__

    def _repr_html_(self) -> str:
        title = paragraph(self._title) if self._title else ""
        return title + table(("", *self._columns), self._cells(), numbers=True) + bullets(self._notes)

    def __rich__(self) -> Group:
        from rich import box
        from rich.console import Group
        from rich.padding import Padding
        from rich.table import Table
        from rich.text import Text

        table = Table(
            title=Text(self._title, "table.title") if self._title else None,
            box=box.SIMPLE_HEAD,
            show_header=any(self._columns),
            title_justify="left",
        )
        table.add_column("")
        for column in self._columns:
            table.add_column(Text(column), justify="right", no_wrap=True)
        for row in self._cells():
            table.add_row(*map(Text, row))
        notes = (Padding(Text(note, "italic dim"), (0, 2)) for note in self._notes)
        return Group(table, *notes)

    def show(self, file: TextIO | None = None) -> None:
        """Print a table in a terminal, plain text otherwise."""
        from rich.console import Console

        console = Console(file=file)
        if console.is_terminal:
            console.print(self)
        else:
            print(str(self), file=file)


class Summary(_Report):
    """The main results of one run.

    `print(summary)` prints plain text, `rich.print(summary)` a table, `summary.show()` a table in a terminal. Peak and RMS
    displacement are evaluated at the output times, relative to the base. The text lists the four points with the largest
    motion; `values` has all.

    Attributes
    ----------
    values : dict
        Numbers in SI units: `status`, `start_time` (zero, or that of a run which continues another one; all other values
        are of the time from there on), `end_time`, `impacts`, `supplied_energy`, `share_viscous`,
        `share_normal`, `share_plastic`, `share_motion` (of the energy supplied, adding to one), `energy_residual`,
        `peak_contact_force`, `largest_approach_speed`, `peak_displacement[point]`, `rms_displacement[point]`,
        `peak_acceleration[point]` and `rms_acceleration[point]` (absolute; contacts and pulses act with their mean over each
        output step; NaN with hard impacts, in which they are infinite), the same for `relative_acceleration[point]` if the
        base moves, `damper_force[damper]` (mean over each output step; NaN with hard impacts),
        `interface_force`, `base_acceleration`, `load[load]` and, with several modes, `modal_displacement[mode 1]`;
        `peak_drift[storey 2]` of shear buildings and their `largest_drift`; `largest_acceleration` of several points without
        tuned masses; `computing_time`. For runs
        that are driven to their end `steady_rms_displacement[point]` over the second half, and
        `steady_rms_displacement_error[point]`, half of its 95 % interval, see `rattlebox.analysis.mean_interval` (NaN: the
        run is too short). For
        runs that end in a free decay `equivalent_damping_ratio` of the mode with the largest energy, and
        `damping_amplitude`, at which it holds: see `rattlebox.analysis.equivalent_damping`.
        For 3-D runs instead of the impacts: `particles`, `particle_mass`,
        `first_touches`, `contacts`, `step`, `steps_per_contact`, `share_sliding`, `share_rolling`, shares by partner as
        `share_at_particle` and `share_at_wall`, `largest_overlap` (of the smaller radius), `particle_steps_per_second`.
    """

    def __init__(self, run: Record) -> None:
        self.values = _main_results(run)
        super().__init__("", ("",), (*_notes_about((self.values,)), *_notes(run)))

    def _cells(self) -> list[tuple[str, ...]]:
        detailed = dict(_largest_of("peak_displacement", (self.values,))).values()
        return [(row.label, row.text(self.values)) for row in _rows((self.values,), detailed)]


class Comparison(_Report):
    """Summaries of several runs in one table, one column per run.

    Of structures with more than four points the table has all lines for one point, and the peak displacement of the others.

    Attributes
    ----------
    values : dict
        For each name the `values` of that run's summary; for all but the first also `peak_reduction[point]` and
        `rms_reduction[point]`, one minus the ratio to the first. If no load or base motion acts at the end of any run,
        `settling_time[point]`, the time from the start of the run after which the displacement is at most 5 % of the peak of
        the first run; NaN if that is not reached.
    point : str
        Point that is compared, "" if the runs have no point in common.
    of : str
        Quantity that is compared: "displacement", "acceleration", "drift" or "force".
    """

    def __init__(
        self, runs: Mapping[str, Record], title: str = "", *, point: str | None = None, of: str = "displacement"
    ) -> None:
        if not runs:
            raise ValueError("there is no run to compare")
        self.runs = dict(runs)
        self.values = {name: _main_results(run) for name, run in runs.items()}
        reference, *others = self.values.values()
        for values in others:
            values |= _reductions(reference, values)
        if not any(is_driven(run.arrays) for run in runs.values()):
            for name, run in runs.items():
                self.values[name] |= _settling_times(reference, run.arrays)
        self.points = common_points(self.runs)
        self.point = checked_point(point, self.points)
        self.of = _checked_quantity(of, self.values)
        every = tuple(self.values.values())
        one_of_many = bool(self.point) and len(_keys("peak_displacement", every)) > _MAX_POINTS
        choice = (f"note: lines of one point are those of {self.point}; point= of rb.compare chooses another",)
        super().__init__(title, tuple(runs), (*(choice if one_of_many else ()), *_notes_about(every), *self.notes()))

    def notes(self) -> list[str]:
        """Return the notes of the runs, each once, after the names of its runs."""
        names: dict[str, list[str]] = {}
        for name, run in self.runs.items():
            for note in _notes(run):
                names.setdefault(note, []).append(name)
        every = len(self.runs)
        return [
            f"{', '.join(some) if len(some) < every or every < 3 else 'all'}: {note}" for note, some in names.items()
        ]

    def measures(self) -> list[tuple[str, str, str]]:
        """Return key, label and unit of the values that are compared: one quantity, at one point."""
        rows = [(key.format(point=self.point), label, unit) for key, label, unit in COMPARED[self.of]]
        every = tuple(self.values.values())
        # Over the second half, if this has an interval in all runs.
        for k, (key, label, unit) in enumerate(rows):
            late = f"steady_{key}"
            if all(math.isfinite(float(values.get(error_of(late), math.nan))) for values in every):
                rows[k] = late, f"{label} in the second half of the run", unit
        return [row for row in rows if all(row[0] in values for values in every)]

    def drawn(self) -> str | None:
        """Return the variable, or the largest drift of the first run, that a figure of the comparison shows."""
        if self.of != "drift":
            return {"acceleration": "absolute_acceleration", "force": "interface_force"}.get(self.of)
        ((_, storey),) = _largest_of("peak_drift", (next(iter(self.values.values())),), 1)
        number = int(storey.removeprefix("storey "))
        return f"{storey} - {f'storey {number - 1}' if number > 1 else 'base'}"

    def _cells(self) -> list[tuple[str, ...]]:
        every = tuple(self.values.values())
        several = len(_keys("peak_displacement", every)) > _MAX_POINTS
        detailed = [self.point] if several else [_name_in(key) for key in _keys("peak_displacement", every)]
        return [(row.label, *(row.in_g.text(values) for values in every)) for row in _rows(every, detailed)]


COMPARED = {
    "displacement": (
        ("peak_displacement[{point}]", "peak displacement", "m"),
        ("rms_displacement[{point}]", "RMS displacement", "m"),
    ),
    "acceleration": (
        ("peak_acceleration[{point}]", "peak acceleration", "m/s^2"),
        ("rms_acceleration[{point}]", "RMS acceleration", "m/s^2"),
    ),
    "drift": (("largest_drift", "largest drift of all storeys", "m"),),
    "force": (
        ("peak_interface_force", "peak force on the base", "N"),
        ("rms_interface_force", "RMS force on the base", "N"),
    ),
}
"""Quantities that sentences of a comparison can be about: key, label and unit of their values."""


def common_points(runs: Mapping[str, Record]) -> list[str]:
    """Return the points that all runs have, without tuned masses, that with the largest peak in the first run first."""
    first, *others = runs.values()
    own = list(first.arrays.points)
    with suppress(RattleboxError):  # of the case of a run from a file, which may name files that are gone
        own = own_points(first.case) if first.source else own
    peaks = dict(zip(first.arrays.points, np.abs(first.arrays.displacement).max(axis=0, initial=0.0), strict=True))
    common = [point for point in own if all(point in run.arrays.points for run in others)]
    return sorted(common, key=lambda point: -peaks[point])


def checked_point(point: str | None, points: list[str]) -> str:
    """Return the point to compare: by default the first one, "" if there is none."""
    if point is not None and point not in points:
        raise CaseError(
            f"point = {point!r} is not a point of all runs", ", ".join(points) or "runs with a common point"
        )
    return point or next(iter(points), "")


def _checked_quantity(of: str, values: Mapping[str, Mapping[str, Value]]) -> str:
    """Return the quantity to compare, which all runs must have unless it is the default."""
    if of not in COMPARED:
        raise CaseError(f"of = {of!r} is not a quantity of comparisons", ", ".join(COMPARED))
    key = COMPARED[of][0][0].partition("[")[0]
    missing = [name for name, some in values.items() if not any(each.partition("[")[0] == key for each in some)]
    if missing and of != "displacement":
        raise CaseError(f"of = {of!r}: {', '.join(missing)} has no {COMPARED[of][0][1]}", "displacement")
    return of


def compare(runs: Mapping[str, Record], title: str = "") -> Comparison:
    """Compare the summaries of several runs in one table."""
    return Comparison(runs, title)
