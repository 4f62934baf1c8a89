"""Damping ratio of a structure with its dampers over the amplitude of vibration."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.quantities import quantity
from rattlebox.analysis.cycle_loss import UNSTEADY, cycle_loss
from rattlebox.analysis.damping_curve import band_edges, damping_over_amplitude, mean_over_period, smooth_decay
from rattlebox.model.errors import Hint, at, nearest
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.methods import Output
from rattlebox.model.plausibility import unusual_motion
from rattlebox.model.stops import refuse_stops
from rattlebox.model.structures import Modal, Shaker
from rattlebox.model.units import parse, whole_number
from rattlebox.prepare.time_step import exceeded_limits
from rattlebox.studies.grid.axes import no_random_packing
from rattlebox.studies.grid.sampling import Spaced, numbers_in
from rattlebox.studies.run.runner import evaluate_cases
from rattlebox.studies.work.particles import EXTENSIONS, SteadyRun, steady_run

if TYPE_CHECKING:
    import xarray

    from rattlebox.engines.dem import PausedRun
    from rattlebox.model.case import Case
    from rattlebox.results.run import Run

FloatArray = NDArray[np.float64]
Evaluate = Callable[..., list[Any]]
Way = Literal["decay", "energy", "shaking"]
WAYS: tuple[Way, ...] = ("decay", "energy", "shaking")

CYCLES = (20, 40)
"""Default numbers of cycles to skip and to evaluate on a shaker."""
_SAMPLES = 40
"""Number of samples per cycle."""
_ENOUGH = 20
"""Cycles of a decay that messages advise."""
OTHER_MOTION = "other_motion"
"""Name of the limit that a decay exceeds if its frequency is not that of the mode."""
_OTHER_FREQUENCY = 0.1
"""Relative change of the frequency of a decay above which a warning is issued."""
_MARGIN = 1.6
"""Initial amplitude of a decay over the highest edge of the bands, at the first trial."""
_TRIALS = 5
"""Number of initial amplitudes that are tried, until each decay has the highest edge behind its first three cycles."""
_FAST = 0.05
"""Relative change of the damping ratio within half a cycle of a decay above which a warning is issued."""
_HEAVY = 0.1
"""Mass of the dampers over that of the mode above which shaking at the frequency without them has a warning."""


@dataclass(frozen=True)
class CurveMode:
    """The mode whose damping is computed."""

    number: int
    omega: float  # Natural angular frequency [rad/s]
    ratio: float
    point: str
    shape: float
    axis: FloatArray | None  # Direction of the motion of a point with three directions, (3,)

    @property
    def frequency(self) -> float:
        """Natural frequency [Hz]."""
        return self.omega / (2 * math.pi)


def damping_curve(
    case: Case,
    amplitudes: Sequence[Any] | Spaced,
    *,
    way: Way = "decay",
    mode: int = 1,
    point: str | None = None,
    packings: int = 4,
    cycles: tuple[int, int] | None = None,
    workers: int | None = None,
    backend: object = "threads",
    progress: bool | Callable[[int, int], object] = True,
) -> xarray.Dataset:
    """Compute the damping ratio of a mode, with the dampers, over the amplitude of vibration.

    Loads and base motion of the case are ignored. Each run is repeated from several random initial states (packings of
    particles, positions of balls), whose scatter determines the 95 % interval of the mean.

    Parameters
    ----------
    case
        Structure, dampers and tuned masses; `case.duration` is the length of a decay.
    amplitudes
        Two or more rising displacement amplitudes: numbers [m], text with a unit, or `rb.geomspace`. Accelerations, such as
        "2 g", are divided by (2 pi f)^2 with the frequency f of the mode.
    way
        "decay": decay of the envelope in free vibration, which starts with the velocity of the mode. "energy": energy lost
        in the same decay over the energy of the mode. "shaking": work of each cavity on its content in a cycle of steady
        motion, where it moves harmonically with the amplitude and frequency of the mode at its point; structure and tuned
        masses in closed form.
    mode
        Number of the mode of the structure, counted from 1.
    point
        Point to which the amplitudes refer; default that of the first damper on the structure, as in `rb.sweep`.
    packings
        Number of random initial states.
    cycles
        Numbers of cycles to skip and to evaluate; "shaking" only. By default 20 and 40; a run whose motion is not steady
        then continues by 40 cycles, up to four times.
    workers, backend
        See `rb.sweep`.
    progress
        True for a progress bar after 2 s, False for none, or a function of the number of finished runs and of all; the
        study stops if it returns False.

    Returns
    -------
    xarray.Dataset
        Over `amplitude` [m]: `damping_ratio`, `lower` and `upper` limit of its 95 % interval (NaN with fewer than two
        packings that reach the amplitude, or a motion that is not steady), `quasi_steady_error` (see Notes), `bare` (of the
        structure alone), and over `packing`, too, `damping_ratios` of each. NaN where no decay passes the band of
        amplitudes, halfway to the nearer one, within the duration; with "shaking" also `steady`, whether the motion of each
        was steady, and `drift`, the rise of the damping ratio of each from the first to the second half of the cycles.
        Attributes: way, mode, point, frequency [Hz], the text of the case, `warnings`, such as that softening
        changes the loss or the bed still sinks, and `exceeded`, the names of the validity limits that runs exceeded.

    Raises
    ------
    CaseError
        If the case has no such mode or point, the mode does not move the point, the initial state has no random part,
        the amplitudes do not rise, or a run fails.

    Notes
    -----
    "decay": see `rattlebox.analysis.damping_over_amplitude`. "energy": zeta is the mean of (dW/dphi) / (2 E) over the phase
    phi in which the amplitude falls through a band, with the energy W that the structure has lost (the losses and the energy
    of the particles) and the energy E = (w q)^2 / 2 of the mode with modal amplitude q. "shaking": zeta = W / (2 pi (w q)^2)
    with the work W of the cavity on its content in a cycle: the energy lost in contacts plus the rise of the stored energy.
    A bed that still sinks also dissipates its own potential energy, which is not in W; `rb.analysis.shaken_cavity` has the
    test of steadiness. Each is the ratio of the linear oscillator with the same loss. "shaking" is at the frequency of the
    structure alone: with a damper whose effective mass is the share s of its mass, it is too large by up to 1 + s. Above
    s = 0.1 of the mass of the mode a warning is issued; `rb.backbone` finds the frequency of the structure with its dampers.

    The interval covers the scatter of random initial states alone. In twelve regimes of two beds, intervals of "shaking"
    from two or three packings held the mean of 40 to 120 packings in 86 to 97 % of draws: below 95 % where a bed is nearly
    locked and few packings slide. Where a motion is not steady there is no interval. A decay and a steady vibration also
    differ because particles move as an earlier, larger amplitude made them: one ball by about half a cycle, a thrown bed by
    as long as it flies. `quasi_steady_error`, the largest change of the ratio within half a cycle, estimates this difference
    for one ball; above 5 % of the ratio a warning is issued. Use "shaking" for steady vibration, "decay" for free vibration.
    For one ball of 1/700, 1/70 and 1/23 of the mass of the structure, "shaking" is above "decay" by 0.3, 3.3 and 9 %, and
    the estimates are 0.4, 3.6 and 10 %. Where several steady motions coexist, random positions may select others than the
    one that a decay follows. "energy" has a relative error of up to a third of zeta, since energy is lost in two steps a
    cycle.

    References
    ----------
    M. Feldman (1994), Mechanical Systems and Signal Processing 8, 119-127, doi:10.1006/mssp.1994.1011 ("decay").
    E. E. Ungar, E. M. Kerwin (1962), J. Acoust. Soc. Am. 34, 954-957, doi:10.1121/1.1918227 ("energy" and "shaking").

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.SDOF(mass="3 kg", frequency="50 Hz", damping_ratio=0.01),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="12 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.5)
    ...     ),
    ...     duration="2 s",
    ... )
    >>> result = rb.damping_curve(case, ["0.2 mm", "0.5 mm", "1 mm"])
    >>> bool((result.damping_ratio > result.bare).any())
    True
    """
    run = partial(evaluate_cases, backend=backend, workers=workers, progress=progress)
    return curve_from(run, case, amplitudes, way=way, mode=mode, point=point, packings=packings, cycles=cycles)


def curve_from(
    run: Evaluate,
    case: Case,
    amplitudes: Sequence[Any] | Spaced,
    *,
    way: Way,
    mode: int,
    point: str | None,
    packings: int,
    cycles: tuple[int, int] | None,
    part: tuple[int, int] | None = None,
) -> xarray.Dataset:
    """Return the damping curve of a case; `run` simulates cases as `evaluate_cases` does.

    `part`: numbers of cycles to skip and to evaluate after which shaken runs stop; default all.
    """
    levels, about, cases = _prepared(case, amplitudes, way, mode, point, packings)
    remarks = Remarks()
    steady = None
    if way == "shaking":
        ratios, steady, drift = _from_shaking(cases, about, levels, cycles, part, run, remarks)
        steady, drift = of_all_starts(steady, packings), of_all_starts(drift, packings)
    else:
        ratios = ratios_of_decays(cases, about, levels, way, run, remarks)
    ratios = of_all_starts(ratios, packings)
    result = _dataset(ratios, levels, about, way)
    if steady is not None:  # the scatter of motions that still change says nothing about their mean
        result = result.assign({name: result[name].where(steady.all(axis=0)) for name in ("lower", "upper")})
    remarks.warnings += _heavy_dampers(case, about) if way == "shaking" else _fast_decay(result)
    found: dict[str, Any] = {"study": "damping_curve", "case": case.to_toml()}
    found |= {"warnings": merged_warnings(remarks.warnings), "exceeded": list(dict.fromkeys(remarks.exceeded))}
    if steady is not None:
        found["cycles"] = list(cycles or CYCLES)
        about_steady = {"long_name": "whether the motion of each random start is steady"}
        result["steady"] = ("packing", "amplitude"), steady, about_steady
        about_drift = {
            "units": "1",
            "long_name": "rise of the damping ratio from the first to the second half of the cycles",
        }
        result["drift"] = ("packing", "amplitude"), drift, about_drift
    return result.assign_attrs(found)


def damping_curve_cases(
    case: Case,
    amplitudes: Sequence[Any] | Spaced,
    *,
    way: Way = "decay",
    mode: int = 1,
    point: str | None = None,
    packings: int = 4,
    cycles: tuple[int, int] | None = None,
) -> list[Case]:
    """Return the cases that `damping_curve` runs; decays that begin too low are repeated with a larger amplitude."""
    levels, about, cases = _prepared(case, amplitudes, way, mode, point, packings)
    if way == "shaking":
        return _shaken_variants(cases, about, levels, cycles or CYCLES)[0]
    amplitude = _MARGIN * float(band_edges(levels)[1][-1])
    return [_initial_velocity(each, about, amplitude) for each in cases]


def _prepared(
    case: Case, amplitudes: Sequence[Any] | Spaced, way: Way, mode: int, point: str | None, packings: int
) -> tuple[FloatArray, CurveMode, list[Case]]:
    """Return the amplitudes, the mode and the case with each random start."""
    if way not in WAYS:
        raise Hint(f"way = {way!r} is not a method of this function", nearest(str(way), WAYS))
    refuse_stops(
        case.stops,
        "a damping curve starts or shakes the structure at each amplitude",
        "a sweep over the initial velocity or the load, or the case without stops",
    )
    hung = [damper.point for damper in case.dampers if damper.point in case.modes.attached]
    if way == "shaking" and hung:
        raise Hint(
            f"way = 'shaking' moves each cavity as the mode of the structure does, and {hung[0]!r} moves otherwise",
            "way = 'decay'",
        )
    for index, damper in enumerate(case.particle_dampers if way == "shaking" else ()):
        with at("dampers", index):
            damper.check_base("way = 'decay'")
    count, about = whole_number(packings, "packings", 1), mode_of(case, mode, point)
    return read_amplitudes(amplitudes, about.omega), about, different_starts(case, count)


@dataclass
class Remarks:
    """Warnings of the runs of damping curves, and names of the validity limits that they exceeded."""

    warnings: tuple[str, ...] = ()
    exceeded: tuple[str, ...] = ()

    def add(self, row: _Row, number: int) -> None:
        """Add those of a run; raise if it failed."""
        self.warnings += row.warnings
        self.exceeded += row.exceeded
        if row.failure:
            raise Hint(f"the run of start {number + 1} failed: {row.failure}", row.advice)


def read_amplitudes(amplitudes: Sequence[Any] | Spaced, omega: float | None = None) -> FloatArray:
    """Return the amplitudes of a damping curve [m].

    `omega`: angular frequency at which accelerations are converted [rad/s]; None if only displacements are allowed.
    """

    def displacement(amplitude: object) -> float:
        number, unit = parse(amplitude, ("m", "m/s^2"))
        if unit != "m/s^2":
            return number
        if omega is None:
            raise Hint(
                f"{amplitude!r} is an acceleration, but parameters or levels change the structure: lengths (m) are needed",
                f"a / (2 pi f)^2, such as {quantity(number / (2 * math.pi * 50) ** 2, 'm', 3)!r} at 50 Hz",
                ["amplitudes"],
            )
        return number / omega**2

    advice = 'amplitudes = ["0.1 mm", "0.2 mm", "0.5 mm"]'
    is_list = isinstance(amplitudes, Spaced) or np.ndim(np.asarray(amplitudes, dtype=object))
    if isinstance(amplitudes, str) or not is_list:
        raise Hint("at least two amplitudes are required", advice)
    levels = numbers_in(amplitudes, displacement)
    if levels.size < 2 or levels[0] <= 0 or np.any(np.diff(levels) <= 0):
        raise Hint("amplitudes must be at least two, above zero and rising", advice)
    hertz = math.nan if omega is None else omega / (2 * math.pi)
    if omega is not None and (what := unusual_motion(levels[-1], hertz)):
        warnings.warn(
            f"amplitudes reach {quantity(levels[-1], 'm')} at {quantity(hertz, 'Hz')}{what}; try: amplitudes with their"
            ' unit, such as "0.5 mm" or "2 g"',
            stacklevel=2,
        )
    return levels


def mode_of(case: Case, number: int, point: str | None) -> CurveMode:
    """Return the mode of a damping curve."""
    modes = case.structure.modes()
    if not modes.stiffness.size:
        raise Hint(f"a {case.structure.kind} structure has no modes", "SDOF, Modal, Matrices or a built-in structure")
    index = modes.elastic(number)
    own = next((damper.point for damper in case.dampers if damper.point in modes.shapes), None)
    name = modes.point(point or own)
    shape = np.atleast_1d(modes.shapes[name][index])
    size = float(np.linalg.norm(shape))
    if size == 0:
        raise Hint(f"mode {number} does not move the point {name!r}", "another point")
    omega = math.sqrt(modes.stiffness[index])
    spatial = name in modes.spatial
    return CurveMode(
        number=index,
        omega=omega,
        ratio=float(modes.decay[index]) / omega,
        point=name,
        shape=size if spatial else float(shape[0]),
        axis=shape / size if spatial else None,
    )


def random_starts(case: Case, count: int, argument: str = "packings") -> list[Case]:
    """Return copies of the case without loads, with different random initial states."""
    rng = np.random.default_rng(case.seed)
    moving = case.particle_dampers or case.impact_dampers
    if count > 1 and case.dampers and not any(damper.has_random_start for damper in moving):
        raise no_random_packing(argument)
    cases = []
    for number in range(count):
        dampers = tuple(damper.restarted(number, rng) for damper in moving)
        cases.append(case.model_copy(update={"dampers": dampers, "loads": (), "base": ()}))
    return cases


def different_starts(case: Case, count: int, argument: str = "packings") -> list[Case]:
    """Return the random starts of a case that differ: without dampers all are the same."""
    return random_starts(case, count if case.dampers else 1, argument)


def of_all_starts(values: NDArray[Any], count: int) -> NDArray[Any]:
    """Return the values of all starts, (starts, ...), from those of the different ones."""
    return np.repeat(values, count // len(values), axis=0)


# ---- free decays


def ratios_of_decays(
    cases: list[Case],
    mode: CurveMode,
    levels: FloatArray,
    way: Way,
    evaluate: Evaluate,
    remarks: Remarks,
) -> FloatArray:
    """Return the damping ratio of each start at each amplitude from free decays, (starts, A); NaN where none is known.

    `levels`: amplitudes [m], (A,).
    """
    highest = float(band_edges(levels)[1][-1])
    amplitude = _MARGIN * highest
    for _ in range(_TRIALS):
        variants = [_initial_velocity(case, mode, amplitude) for case in cases]
        rows = evaluate(variants, partial(_decay, mode=mode, levels=levels, way=way))
        reached = min(row.largest for row in rows)
        if not 0 < reached < highest:
            break
        amplitude *= 1.1 * highest / reached
    for number, row in enumerate(rows):
        remarks.add(row, number)
    values = np.array([row.values for row in rows])
    missing = [quantity(level, "m") for level in levels[~np.isfinite(values).any(axis=0)]]
    if missing:
        text = f"warning: no decay of {cases[0].duration:.4g} s passes the whole band about {', '.join(missing)}"
        remarks.warnings += (f"{text}; try: a longer duration, or other amplitudes",)
    return values


class _Row(NamedTuple):
    """Result of a run: the reason if it failed, its warnings and exceeded limits, and its values."""

    failure: str
    warnings: tuple[str, ...]
    exceeded: tuple[str, ...]
    values: FloatArray  # Damping ratios, or the work in a cycle and its rise [J]
    largest: float = math.inf  # Largest amplitude of a decay [m]
    advice: str = "rb.simulate(case), to see where"  # for a run that failed
    paused: PausedRun | None = None  # from where the next part of the run continues


def _decay(run: Run, mode: CurveMode, levels: FloatArray, way: Way) -> _Row:
    """Return the damping ratio of a free decay at each amplitude."""
    row = _row(run)
    if row.failure:
        return row
    time, motion = run.motion.time.values, _modal_part(run, mode)
    try:
        bands = damping_over_amplitude(time, motion, levels)
    except ValueError as error:  # too few cycles, or samples in a cycle
        enough = f'duration = "{_ENOUGH / mode.frequency:.2g} s" or more, and the default output'
        return row._replace(failure=str(error), advice=enough)
    other = _other_motion(bands.frequency.values, mode)
    return row._replace(
        values=bands.damping_ratio.values if way == "decay" else _energy_ratios(run, time, motion, bands, mode),
        warnings=row.warnings + other,
        exceeded=(*row.exceeded, OTHER_MOTION) if other else row.exceeded,
        largest=float(np.exp(smooth_decay(time, motion).log_amplitude[0])),
    )


def _row(run: Run) -> _Row:
    exceeded = exceeded_limits(run.diagnostics) if run.diagnostics else ()
    return _Row("" if run.ok else run.message, warnings_of(run), tuple(exceeded), np.zeros(0))


def warnings_of(run: Run) -> tuple[str, ...]:
    """Return the notes of a run that are warnings."""
    return tuple(note for note in run.notes if note.startswith("warning: "))


def _initial_velocity(case: Case, mode: CurveMode, amplitude: float) -> Case:
    """Return the case with zero displacement and the velocity of the mode."""
    modes = case.structure.modes()
    velocity = np.zeros(modes.stiffness.size)
    velocity[mode.number] = amplitude * mode.omega / abs(mode.shape)
    structure = Modal.of(modes, displacement=np.zeros(velocity.size), velocity=velocity)
    output = Output(rate=_SAMPLES * mode.frequency)
    return case.model_copy(update={"structure": structure, "output": output})


def _modal_part(run: Run, mode: CurveMode) -> FloatArray:
    """Return the contribution of the mode to the motion of the point, (T,); with tuned masses the total motion."""
    if not run.case.tuned_masses:
        return np.asarray(mode.shape * run.motion.modal_displacement.values[:, mode.number])
    motion = run.motion.displacement
    if mode.axis is None:
        return np.asarray(motion.sel(point=mode.point).values)
    return np.asarray(
        sum(a * motion.sel(point=f"{mode.point} {name}").values for a, name in zip(mode.axis, "xyz", strict=True))
    )


def _other_motion(found: FloatArray, mode: CurveMode) -> tuple[str, ...]:
    """Return a warning if the frequency of the decay is not that of the mode."""
    change = np.abs(found / mode.frequency - 1)
    if not np.nanmax(change, initial=0.0) > _OTHER_FREQUENCY:
        return ()
    other = found[np.nanargmax(change)]
    return (
        f"warning: the decay has {other:.4g} Hz, the mode {mode.frequency:.4g} Hz; within {100 * _OTHER_FREQUENCY:g} % the "
        "damping ratio is that of the mode; try: a lighter damper, or way='shaking'",
    )


def _energy_ratios(
    run: Run, time: FloatArray, motion: FloatArray, bands: xarray.Dataset, mode: CurveMode
) -> FloatArray:
    """Return half of the mean of dW / E over the phase in which each band is passed."""
    decay = smooth_decay(time, motion)
    # 1 / E, limited far below the bands, where the decay ends in rounding errors.
    logarithm = np.maximum(decay.log_amplitude, math.log(bands.amplitude[0]) - 5)
    share = 2 * (mode.shape / mode.omega) ** 2 * np.exp(-2 * logarithm)
    # The structure has lost the losses and the energy of the particles, which includes their potential energy: a bed that
    # was thrown settles again, and dissipates the work of its weight, which does not come from the structure.
    arrays = run.arrays
    gained = run.ledger.particles + (arrays.contact_energy + arrays.gravity_energy).sum(axis=1)
    gained = gained - (run.ledger.driven - arrays.load_work)  # energy from the drives of turning cavities
    lost = np.interp(decay.time, *mean_over_period(time, run.ledger.losses + gained, 1 / mode.frequency))
    loss = np.concatenate([[0.0], np.cumsum(np.diff(lost) * (share[1:] + share[:-1]) / 2)])
    start, end = bands.start.values, bands.end.values
    both = [np.interp(end, decay.time, x) - np.interp(start, decay.time, x) for x in (loss, decay.phase)]
    # The mean over a cycle of a loss that falls with E is larger than the loss in its middle.
    turn = 2 * math.pi * bands.damping_ratio.values
    excess = np.divide(np.sinh(turn), turn, out=np.ones_like(turn), where=turn > 0)
    return np.asarray(both[0] / (2 * both[1]) / excess)


# ---- steady shaking


def _from_shaking(
    cases: list[Case],
    mode: CurveMode,
    levels: FloatArray,
    cycles: tuple[int, int] | None,
    part: tuple[int, int] | None,
    evaluate: Evaluate,
    remarks: Remarks,
) -> tuple[FloatArray, NDArray[np.bool_], FloatArray]:
    """Return damping ratios, (starts, A), whether the motions were steady, and the rises of the ratios over the cycles."""
    extensions = EXTENSIONS if cycles is None else 0
    variants, owners = _shaken_variants(cases, mode, levels, cycles or CYCLES)
    _, kept = part or cycles or CYCLES
    share = sum(part) / sum(cycles or CYCLES) if part else 1.0
    ratios = np.full((len(cases), levels.size), mode.ratio + _tuned(cases[0], mode))
    steady, drift = np.full(ratios.shape, True), np.zeros(ratios.shape)
    simulate = partial(steady_run, frequency=mode.frequency, kept=kept, extensions=extensions, part=share)
    rows = evaluate(variants, partial(_work_in_cycles, frequency=mode.frequency, kept=kept), simulate=simulate)
    for (number, k), row in zip(owners, rows, strict=True):
        remarks.add(row, number)
        work, rise = row.values / (2 * math.pi * (mode.omega * levels[k] / mode.shape) ** 2)
        ratios[number, k] += float(work)
        drift[number, k] += float(rise)
        steady[number, k] &= UNSTEADY not in row.exceeded
    return ratios, steady, drift


def _shaken_variants(
    cases: list[Case], mode: CurveMode, levels: FloatArray, cycles: tuple[int, int]
) -> tuple[list[Case], list[tuple[int, int]]]:
    """Return a case for each damper at each amplitude, and the numbers of its start and amplitude."""
    skip, kept = whole_number(cycles[0], "cycles[0]", 1), whole_number(cycles[1], "cycles[1]", 1)
    variants, owners = [], []
    for number, case in enumerate(cases):
        modes = case.structure.modes()
        for k, amplitude in enumerate(levels):
            for damper in case.dampers:
                moved = np.atleast_1d(modes.shapes[modes.point(damper.point)][mode.number]) * amplitude / mode.shape
                size = float(np.linalg.norm(moved))
                if size == 0:
                    continue
                variants.append(on_shaker(case, damper, mode.frequency, moved, skip + kept))
                owners.append((number, k))
    return variants, owners


def _work_in_cycles(shaken: SteadyRun, frequency: float, kept: int) -> _Row:
    """Return the work of the cavity in a cycle, averaged over the last ones, and its rise between their halves."""
    run = shaken.run
    row = _row(run)._replace(paused=shaken.paused)
    if row.failure:
        return row
    loss = cycle_loss(run, frequency, kept)
    if not loss.is_steady:
        row = row._replace(warnings=(*row.warnings, loss.warning()), exceeded=(*row.exceeded, UNSTEADY))
    return row._replace(values=np.array([loss.work, loss.drift]))


def on_shaker(case: Case, damper: Any, frequency: float, moved: FloatArray, cycles: int) -> Case:
    """Return a damper alone whose cavity moves harmonically; `moved`: displacement amplitude [m], (1,) or (3,)."""
    size = float(np.linalg.norm(moved))
    motion: dict[str, Any] = {
        "amplitude": size * (2 * math.pi * frequency) ** 2,
        "frequency": frequency,
        "unit": "m/s^2",
    }
    if moved.size == 3:
        motion["direction"] = (moved / size).tolist()
    return case.model_copy(
        update={
            "structure": Shaker(motion=Harmonic(**motion)),
            "dampers": (damper.model_copy(update={"point": None}),),
            "tuned_masses": (),
            "stops": (),
            "loads": (),
            "duration": cycles / frequency,
            "output": Output(rate=_SAMPLES * frequency),
        }
    )


def _tuned(case: Case, mode: CurveMode) -> float:
    """Return the damping ratio that tuned masses add at the frequency of the mode, whose change is neglected."""
    total = 0.0
    modes = case.structure.modes()
    for part in case.tuned_masses:
        own = 2 * math.pi * part.frequency
        stiffness = own**2 + 2j * part.damping_ratio * own * mode.omega
        apparent = part.mass * stiffness / (stiffness - mode.omega**2)
        shape = float(modes.shape(part.point, part.direction)[mode.number])
        total -= apparent.imag * shape**2 / 2
    return total


# ---- results


def merged_warnings(warnings: Iterable[str]) -> list[str]:
    """Return warnings that differ in their numbers only once, with their count; the one with the largest numbers stays."""
    groups: dict[str, list[str]] = {}
    for warning in dict.fromkeys(warnings):
        groups.setdefault(re.sub(r"[0-9.]+", "#", warning), []).append(warning)
    return [
        max(group, key=lambda text: [float(number) for number in re.findall(r"\d+(?:\.\d+)?", text)])
        + (f" (the largest of {len(group)} values)" if len(group) > 1 else "")
        for group in groups.values()
    ]


def _fast_decay(curve: xarray.Dataset) -> tuple[str, ...]:
    """Return a warning if the damping ratio changes much within half a cycle of the decay."""
    change = (curve.quasi_steady_error / curve.damping_ratio).values
    if not np.nanmax(change, initial=0.0) > _FAST:
        return ()
    k = int(np.nanargmax(change))
    level, share = quantity(float(curve.amplitude[k]), "m"), 100 * change[k]
    return (
        f"warning: at {level} the damping ratio changes by {share:.2g} % within half a cycle of the decay, and that of a "
        "steady vibration may differ as much; try: way='shaking' for steady vibration",
    )


def _heavy_dampers(case: Case, mode: CurveMode) -> tuple[str, ...]:
    """Return a warning if the dampers are heavy, since cavities are shaken at the frequency without them."""
    modes = case.structure.modes()
    dampers = [each for damper in case.dampers for each in damper.each()]
    shapes = [np.atleast_1d(modes.shapes[modes.point(damper.point)][mode.number]) for damper in dampers]
    share = sum(damper.mass * float(shape @ shape) for damper, shape in zip(dampers, shapes, strict=True))
    if not share > _HEAVY:
        return ()
    return (
        f"warning: the dampers have {100 * share:.3g} % of the mass that moves in the mode; way='shaking' takes the "
        f"frequency without them, and its damping ratio may be too large by up to this share (above {100 * _HEAVY:g} % "
        "there is a warning); try: rb.backbone",
    )


def _change_in_half_a_cycle(mean: FloatArray, levels: FloatArray) -> FloatArray:
    """Return the largest change of the damping ratio within half a cycle of a decay before and after each amplitude."""
    known = np.isfinite(mean)
    if known.sum() < 2:
        return np.full(mean.size, np.nan)
    logs, ratios = np.log(levels[known]), mean[known]
    slopes = np.diff(ratios) / np.diff(logs)

    def at(places: FloatArray) -> FloatArray:
        """Return the ratio, beyond the ends along the first and last segment."""
        inside = np.clip(places, logs[0], logs[-1])
        end = np.where(places > logs[-1], slopes[-1], slopes[0])
        return np.asarray(np.interp(inside, logs, ratios) + (places - inside) * end)

    result = np.full(mean.size, np.nan)
    result[known] = np.max([np.abs(at(logs + side * math.pi * ratios) - ratios) for side in (-1, 1)], axis=0)
    return result


def _dataset(ratios: FloatArray, levels: FloatArray, mode: CurveMode, way: Way) -> xarray.Dataset:
    import xarray
    from scipy.special import stdtrit

    known = np.isfinite(ratios).sum(axis=0)
    enough = known > 1
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(known > 0, np.nansum(ratios, axis=0) / known, np.nan)
        spread = np.sqrt(np.nansum((ratios - mean) ** 2, axis=0) / (known - 1))
        half = np.where(enough, stdtrit(np.maximum(known - 1, 1), 0.975) * spread / np.sqrt(known), np.nan)

    def over(values: object, long_name: str, *more: str) -> Any:
        return (*more, "amplitude") if more else "amplitude", values, {"units": "1", "long_name": long_name}

    return xarray.Dataset(
        {
            "damping_ratio": over(mean, "damping ratio"),
            "lower": over(mean - half, "lower 95 % limit of the damping ratio"),
            "upper": over(mean + half, "upper 95 % limit of the damping ratio"),
            "quasi_steady_error": over(
                _change_in_half_a_cycle(mean, levels), "change of the damping ratio within half a cycle of a decay"
            ),
            "bare": over(np.full(levels.size, mode.ratio), "damping ratio of the structure alone"),
            "damping_ratios": over(ratios, "damping ratio of each random start", "packing"),
        },
        {
            "amplitude": ("amplitude", levels, {"units": "m", "long_name": f"amplitude, {mode.point}"}),
            "packing": ("packing", np.arange(len(ratios)), {"units": "1", "long_name": "random start"}),
        },
        {"way": way, "mode": mode.number + 1, "point": mode.point, "frequency": mode.frequency},
    )
