"""Backbones: frequency, damping and excitation at phase resonance over the amplitude of vibration."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.narrow import instance
from rattlebox._util.phrases import counted
from rattlebox._util.quantities import quantity
from rattlebox.analysis.signals import first_harmonic, trapezoid_weights
from rattlebox.core import _core
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.methods import Output
from rattlebox.model.structures import Modal
from rattlebox.model.units import whole_number
from rattlebox.studies.damping_curve import different_starts, merged_warnings, on_shaker, read_amplitudes, warnings_of
from rattlebox.studies.grid.sampling import Spaced
from rattlebox.studies.run.runner import evaluate_cases

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case
    from rattlebox.model.stops import Stop
    from rattlebox.results.run import Run

FloatArray = NDArray[np.float64]

_SAMPLES = 40
"""Number of samples per cycle."""
_PARTS = 8
"""Number of parts of the evaluated cycles, whose scatter shows whether the amplitude is steady."""
_AMPLITUDE_ERROR = 0.01
"""Largest difference of the amplitude from the wanted one, relative, at which a search ends."""
_PHASE_ERROR = math.radians(1)
"""Largest difference of the phase from that of resonance at which a search ends [rad]."""
_TRIALS = 12
"""Largest number of runs for one amplitude and one start."""
_APART = 0.1
"""Difference of the effective masses of two starts, over the larger one, from which they may be different motions."""
_ERRORS = 3
"""Standard errors of two starts by which different motions must lie further apart."""
_FALLEN = 0.6
"""Amplitude over the wanted one below which a motion with stops has fallen beside the resonance."""
_USUAL_RESTITUTION = 0.7
"""Restitution of a stop whose law states none, for the first run."""
_BEYOND = math.radians(20)
"""Phase beyond that of resonance from which it has."""
_SIMILAR = 0.25
"""Stiffness of stops over that at the wanted amplitude from which both scale alike."""
_RETREAT = 0.9
"""Factor of the stiffness of stops after that."""
_LEAD = math.radians(40)
"""Distance of the phase from that of resonance in runs with stops [rad]."""
_HALVINGS = 100
"""Number of bisections of a speed."""
_RANGE = 0.5
"""Largest relative change of the frequency in which a resonance is sought."""


def backbone(
    case: Case,
    amplitudes: Sequence[Any] | Spaced,
    *,
    mode: int = 1,
    starts: int = 4,
    cycles: tuple[int, int] = (100, 100),
    workers: int | None = None,
    backend: object = "threads",
    progress: bool | Callable[[int, int], object] = True,
) -> xarray.Dataset:
    r"""Compute frequency, damping and excitation at phase resonance over the amplitude: the backbone curve of a mode.

    At phase resonance the force is in phase with the velocity of the point at which it acts. Laboratories measure backbones
    with a phase-locked loop; here frequency and force are sought by runs of the whole structure with its dampers.

    Parameters
    ----------
    case
        Structure, dampers and one harmonic load, whose point and direction are used; its amplitude and frequency are not.
    amplitudes
        Two or more rising displacement amplitudes of the point of the load: numbers [m], text with a unit, or
        `rb.geomspace`. Accelerations, such as "2 g", are divided by (2 pi f)^2 with the frequency f of the mode.
    mode
        Number of the mode of the structure, counted from 1, near whose frequency the resonance is sought.
    starts
        Number of random initial states (packings of particles, positions of balls), each with a search of its own. Their
        scatter determines the intervals.
    cycles
        Numbers of cycles of each run to skip and to evaluate. Each run starts on the expected motion, so that only changes
        of the motion have to decay.
    workers, backend
        See `rb.sweep`.
    progress
        True for a progress bar after 2 s, False for none, or a function of the number of finished runs and of all in one
        round of the search; the study stops if it returns False.

    Returns
    -------
    xarray.Dataset
        Over `amplitude` [m]: `frequency` [Hz], `damping_ratio`, `force` [N], the amplitude of the load, `work` [J] of the
        load in a cycle, each the mean of the starts, with `..._lower` and `..._upper` limit of its 95 % interval (NaN with
        fewer than two starts); `motions`, the number of different motions that the starts found. Over `start`, too:
        `frequencies`, `damping_ratios` and `found`, whether the search has ended with less than 1 % of error of the
        amplitude and 1 degree of the phase; values that were not found are NaN. Attributes: point, frequency and damping
        ratio of the mode, the text of the case and `warnings`.

    Raises
    ------
    CaseError
        If the case has not exactly one load, a harmonic force; if it has a base motion or a damper in a tuned mass;
        if it has no such mode, the load does not excite it, the initial state has no random part, the amplitudes do not
        rise, or a run fails.

    See Also
    --------
    damping_curve : Damping ratio over amplitude from free decays or prescribed motion of the mode.
    frequency_response : Steady motion over the frequency of the load.

    Notes
    -----
    With the complex amplitudes X of the displacement and F of the force at the frequency f, omega = 2 pi f, the dynamic
    stiffness F / X of the structure with dampers is that of the structure alone, D, less omega^2 m, where the effective mass
    m of the dampers depends on the amplitude and little on the frequency. Each run gives m, and the next one has

    .. math:: \operatorname{Re} [D(f) - \omega^2 m] = 0, \qquad F = X \operatorname{Im} [D(f) - \omega^2 m].

    For a linear structure this is exact. Stops are springs rather than masses: with them omega^2 m is one number k that
    depends on the amplitude only, the first one from the duration of an impact, and the runs are made 40 degrees before
    resonance with the force for the wanted amplitude, because a bent resonance is next to a fold. Hard stops leave no
    amplitude above their gap, and a search there ends without a result. The first m comes from a run in which the cavities
    move harmonically, as in the mode.
    The damping ratio is that of a linear mode with the same loss, with its shape phi at the point of the load and the mass
    of structure and dampers there, so that a bed that rests has the damping ratio of a structure with its mass,

    .. math:: \zeta = \frac{F}{2 \omega^2 X (\phi^{-2} + \operatorname{Re} m)} .

    With stops the mass is that of the structure alone.

    Starts whose effective masses differ by more than 10 % and three standard errors of both have found different motions.
    Where several coexist, no start has the mean of all: a warning lists them, and the limits include the 95 % interval of
    each, with their common scatter. Where one was found, the interval is that of this motion: one that is found from the
    share s of the initial states is missed by all of n starts with the probability (1 - s)^n.

    The interval covers the scatter of the starts (Student's t) and, in quadrature, the drift of the response from the first
    to the second half of the cycles that the starts have in common, which is the rest of a transient. The limits of 1 % and
    1 degree do not widen it: the last correction of f and F removes their first order. Near a fold, where two steady motions
    meet, and where the motion is chaotic with large modulations, searches may not end; they are counted in the warnings.

    References
    ----------
    M. Scheel, S. Peter, R. I. Leine, M. Krack (2018), A phase resonance approach for modal testing of structures with
    nonlinear dissipation, Journal of Sound and Vibration 435, 56-73, doi:10.1016/j.jsv.2018.07.010.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.SDOF(mass="3 kg", frequency="50 Hz", damping_ratio=0.01),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="12 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.5)
    ...     ),
    ...     load=rb.Harmonic(amplitude="1 N", frequency="50 Hz"),
    ...     duration="1 s",
    ... )
    >>> curve = rb.backbone(case, ["0.2 mm", "0.5 mm", "1 mm"], progress=False)
    >>> bool((curve.damping_ratio > 0.01).any())
    True
    """
    target = _Target.of(case, mode)
    levels = read_amplitudes(amplitudes, target.omega)
    count = whole_number(starts, "starts", 1)
    window = whole_number(cycles[0], "cycles[0]", 1), whole_number(cycles[1], "cycles[1]", _PARTS)
    evaluate = partial(evaluate_cases, backend=backend, workers=workers, progress=progress)
    plain = [each.model_copy(update={"loads": case.loads}) for each in different_starts(case, count, "starts")]
    searches = [_Search(each, number, level) for number, each in enumerate(plain) for level in levels]
    messages: list[str] = []
    _guess(searches, target, window, evaluate)
    for search in searches:
        search.aim(target)
    for _ in range(_TRIALS):
        left = [search for search in searches if not search.is_over]
        if not left:
            break
        rows = evaluate(
            [search.case_of(target, window) for search in left], partial(_response, target=target, window=window)
        )
        for search, row in zip(left, rows, strict=True):
            if row.failure:
                raise Hint(
                    f"the run of start {search.start + 1} failed: {row.failure}", "rb.simulate(case), to see where"
                )
            messages += row.warnings
            search.learn(row, target)
    return _dataset(searches * (count // len(plain)), levels, count, target, case, messages)


@dataclass(frozen=True)
class _Target:
    """The mode whose resonance is sought, and the structure as the load sees it."""

    case: Case
    load: Harmonic
    number: int
    omega: float
    ratio: float
    shape: float
    force: FloatArray  # on each mode of the structure with tuned masses, per newton

    @classmethod
    def of(cls, case: Case, mode: int) -> _Target:
        """Return the mode and the load of a case; raise if they do not fit."""
        load = case.harmonics.get("loads[0]")
        if load is None or len(case.loads) != 1 or case.base_acceleration():
            kinds = ", ".join(each.kind for each in (*case.loads, *case.base)) or "none"
            raise Hint(
                f"the case has loads and base motions: {kinds}; a backbone needs one harmonic force and no base motion",
                'load = rb.Harmonic(amplitude="1 N", frequency="50 Hz"), and base = ()',
            )
        for damper in case.dampers:
            if damper.point in case.modes.attached:
                # A search assumes that the effective mass depends little on the frequency.
                raise Hint(
                    f"a damper is in {damper.point!r}, near whose resonance its effective mass depends on the frequency",
                    "rb.frequency_response, or rb.damping_curve with way = 'decay'",
                )
        modes = case.structure.modes()
        index = modes.elastic(mode)
        shape = float(modes.shape(load.point, load.direction)[index])
        if shape == 0:
            raise Hint(f"the load does not excite mode {mode}", "another point or direction of the load")
        omega = math.sqrt(modes.stiffness[index])
        force = np.asarray(case.modes.shape(load.point, load.direction))
        return cls(case, load, index, omega, float(modes.decay[index]) / omega, shape, force)

    @property
    def phase(self) -> float:
        """Phase of the load at the start: with stops a run starts in the middle between them, not at a deflection."""
        return math.pi / 2 if self.case.stops else 0.0

    def motion(self, omega: float) -> NDArray[np.complex128]:
        """Return the complex amplitudes of the modes for a force of 1 N, without dampers."""
        return self.case.modes.harmonic_response(np.array([omega]), self.force[:, None])[0, :, 0]

    def stiffness(self, omega: float, mass: complex) -> complex:
        """Return the dynamic stiffness at the point of the load, with the effective mass of the dampers there [N/m]."""
        return complex(1 / (self.force @ self.motion(omega))) - self.weight(omega) * mass

    def before_resonance(self, omega: float, mass: complex) -> float:
        """Return the angular frequency below a resonance at which the displacement leads by `_LEAD` [rad/s]."""
        grid = omega * np.linspace(1.0, 1 - _RANGE, 4001)
        phase = np.array([np.angle(self.stiffness(each, mass)) for each in grid])
        return float(grid[np.argmax(phase < math.pi / 2 - _LEAD)])

    def weight(self, omega: float) -> float:
        """Return the dynamic stiffness per effective mass; with stops, which are springs rather than masses, 1."""
        return 1.0 if self.case.stops else omega**2

    def modal_mass(self, mass: complex) -> float:
        """Return the mass of the mode at the point of the load, with that of the dampers [kg]."""
        return self.shape**-2 + (0.0 if self.case.stops else mass.real)

    def resonance(self, near: float, mass: complex) -> float:
        """Return the angular frequency nearest to `near` at which the stiffness is imaginary; NaN if there is none."""
        from scipy.optimize import brentq

        grid = near * (1 + np.linspace(-_RANGE, _RANGE, 401))
        real = np.array([self.stiffness(omega, mass).real for omega in grid])
        # A resonance is where the real part falls; it rises at antiresonances.
        falls = np.flatnonzero((real[:-1] > 0) & (real[1:] <= 0))
        if not falls.size:
            return math.nan
        k = falls[np.argmin(np.abs(grid[falls] - near))]
        return float(brentq(lambda omega: self.stiffness(omega, mass).real, grid[k], grid[k + 1], xtol=1e-12 * near))


class _Row(NamedTuple):
    """Result of a run: the reason if it failed, warnings, and the response per force [m/N].

    `error` is twice the standard error of the mean response, `drift` its change from the first to the second half of the
    cycles, both over the response.
    """

    failure: str
    warnings: tuple[str, ...]
    receptance: complex
    error: float = math.nan
    drift: complex = complex(math.nan)


@dataclass
class _Search:
    """Search of the resonance at one amplitude from one start."""

    case: Case
    start: int
    amplitude: float
    mass: complex = 0j
    omega: float = math.nan
    force: float = math.nan
    drift: complex = complex(math.nan)
    error: float = math.nan  # standard error of the effective mass [kg]
    masses: list[tuple[float, complex]] = field(default_factory=list)  # amplitudes and effective masses of the runs
    is_found: bool = False
    is_over: bool = False
    # Frequency and force of the next run: those of the resonance, except with stops
    run_omega: float = math.nan
    run_force: float = math.nan

    def is_near(self, other: _Search) -> bool:
        """Return whether another search may have found the same motion."""
        apart = _APART * max(abs(self.mass), abs(other.mass)) + _ERRORS * (self.error + other.error)
        return abs(self.mass - other.mass) <= apart

    def mass_at_amplitude(self) -> complex:
        """Return the effective mass at the wanted amplitude X from those of the runs so far.

        The force of the dampers, m X, is interpolated between the last run and one on the other side of X: that of a ball
        depends little on X, so that m falls as 1 / X, and a force for the present m would overshoot more and more.
        """
        last, mass = self.masses[-1]
        beyond = [each for each in self.masses if (each[0] > self.amplitude) != (last > self.amplitude)]
        if not beyond:
            return mass
        other, mass_there = min(beyond, key=lambda each: abs(each[0] - self.amplitude))
        share = (self.amplitude - last) / (other - last)
        return (last * mass + share * (other * mass_there - last * mass)) / self.amplitude

    def with_stops(self, mass: complex, reached: float, phase: float, target: _Target) -> complex:
        """Return the effective mass at the wanted amplitude from that at the amplitude that was reached.

        `phase`: phase of the dynamic stiffness beyond that of resonance [rad].
        """
        there, here = (_added_stiffness(self, amplitude, target) for amplitude in (self.amplitude, reached))
        if there and reached < _FALLEN * self.amplitude and phase > _BEYOND:
            # Stops bend the resonance: a frequency that is a little too high ends in the small motion beside it.
            return _RETREAT * self.mass
        if here.real > _SIMILAR * there.real > 0:  # force and loss of the stops rise alike
            return mass * there.real / here.real
        return mass - (there - here)

    def aim(self, target: _Target) -> None:
        """Choose frequency and force for the present effective mass."""
        near = target.omega if math.isnan(self.omega) else self.omega
        self.omega = target.resonance(near, self.mass)
        stiffness = target.stiffness(self.omega, self.mass) if math.isfinite(self.omega) else complex(math.nan)
        self.force = self.amplitude * stiffness.imag
        self.is_over = not self.force > 0
        self.run_omega, self.run_force = self.omega, self.force
        if target.case.stops and not self.is_over:
            # Stops bend the resonance, which is then next to a fold: run below it, where the motion is safe.
            self.run_omega = target.before_resonance(self.omega, self.mass)
            self.run_force = self.amplitude * abs(target.stiffness(self.run_omega, self.mass))

    def case_of(self, target: _Target, window: tuple[int, int]) -> Case:
        """Return the case that starts on the expected motion."""
        frequency = self.run_omega / (2 * math.pi)
        modes = self.case.structure.modes()
        of_load = np.asarray(modes.shape(target.load.point, target.load.direction))
        motion = modes.harmonic_response(np.array([self.run_omega]), of_load[:, None])[0, :, 0]
        # Velocity in phase with the force.
        motion = motion * (-1j * np.exp(1j * target.phase) * self.amplitude / (of_load @ motion))
        displacement = 0 * motion.imag if self.case.stops else motion.imag
        structure = Modal.of(modes, displacement=displacement, velocity=(1j * self.run_omega * motion).imag)
        load = target.load.model_copy(
            update={
                "amplitude": self.run_force,
                "frequency": frequency,
                "phase": target.phase,
                "start": 0.0,
                "stop": None,
            }
        )
        return self.case.model_copy(
            update={
                "structure": structure,
                "loads": (load,),
                "duration": sum(window) / frequency,
                "output": Output(rate=_SAMPLES * frequency),
            }
        )

    def learn(self, row: _Row, target: _Target) -> None:
        """Correct the effective mass by a run, and choose the next frequency and force."""
        stiffness = 1 / row.receptance
        mass = (target.stiffness(self.run_omega, 0j) - stiffness) / target.weight(self.run_omega)
        reached = abs(row.receptance) * self.run_force
        self.masses.append((reached, mass))
        if self.case.stops:
            self.mass = self.with_stops(mass, reached, float(np.angle(stiffness)) - math.pi / 2, target)
        else:
            self.mass = self.mass_at_amplitude()
        phase = abs(math.remainder(np.angle(stiffness) - math.pi / 2, 2 * math.pi))
        amplitude = abs(reached / self.amplitude - 1)
        self.drift = row.drift
        self.error = 0.5 * row.error * abs(stiffness) / target.weight(self.run_omega)
        is_in_phase = phase < max(_PHASE_ERROR, row.error) or bool(self.case.stops)
        self.is_found = amplitude < max(_AMPLITUDE_ERROR, row.error) and is_in_phase
        self.aim(target)
        self.is_over = self.is_over or self.is_found


def _response(run: Run, target: _Target, window: tuple[int, int]) -> _Row:
    """Return the displacement per force at the point of the load, from the last cycles of a run."""
    if not run.ok:
        return _Row(run.message, (), complex(math.nan))
    load = instance(run.case.loads[0], Harmonic)
    time, frequency, kept = run.arrays.time, load.frequency, window[1]
    motion = run.arrays.modal_displacement @ target.force
    # The load is A sin(w t + p) and the fit has Re(x exp(i w t)), so that the load is -i A exp(i p) there.
    per_force = [
        1j
        * np.exp(-1j * target.phase)
        * first_harmonic(time[inside], motion[inside], trapezoid_weights(time[inside], start), frequency)
        / load.amplitude
        for start, inside in _parts(time, frequency, kept)
    ]
    receptance = complex(np.mean(per_force))
    relative = np.array(per_force) / receptance - 1
    drift = complex(relative[_PARTS // 2 :].mean() - relative[: _PARTS // 2].mean())
    return _Row("", warnings_of(run), receptance, 2 * math.sqrt(np.mean(np.abs(relative) ** 2) / (_PARTS - 1)), drift)


def _parts(time: FloatArray, frequency: float, kept: int) -> list[tuple[float, NDArray[np.bool_]]]:
    """Return start and samples of the parts of the evaluated cycles, each of whole cycles."""
    length = kept // _PARTS / frequency
    starts = time[-1] - length * np.arange(_PARTS, 0, -1)
    margin = 1e-9 / frequency
    return [(start, (time > start - length) & (time < start + length + margin)) for start in starts]


def _guess(
    searches: list[_Search], target: _Target, window: tuple[int, int], evaluate: Callable[..., list[Any]]
) -> None:
    """Set the effective mass of each search from runs in which the cavities move as in the mode alone."""
    frequency = target.omega / (2 * math.pi)
    variants, owners = [], []
    for search in searches:
        modes = search.case.structure.modes()
        for damper in search.case.dampers:
            shape = np.atleast_1d(modes.shapes[modes.point(damper.point)][target.number]) / target.shape
            if size := float(np.linalg.norm(shape)):
                variants.append(on_shaker(search.case, damper, frequency, shape * search.amplitude, sum(window)))
                owners.append((search, size))
    masses = evaluate(variants, partial(_effective_mass, frequency=frequency, kept=window[1])) if variants else []
    for (search, size), mass in zip(owners, masses, strict=True):
        search.mass += size**2 * mass * (target.omega**2 / target.weight(target.omega))
    for search in searches:
        if added := _added_stiffness(search, search.amplitude, target):
            search.mass -= added
            search.omega = math.sqrt(target.omega**2 + added.real * target.shape**2)


def _added_stiffness(search: _Search, amplitude: float, target: _Target) -> complex:
    """Return the stiffness that the stops add at the point of the load in a harmonic motion of the mode [N/m]."""
    return sum((_stop_stiffness(search, stop, target, amplitude) for stop in search.case.each_stop), 0j)


def _stop_stiffness(search: _Search, stop: Stop, target: _Target, amplitude: float) -> complex:
    """Return the stiffness that a stop adds at the point of the load in a harmonic motion of the mode [N/m].

    The contact is taken as a spring with the duration that an impact with the same overlap has, and with its loss.
    """
    modes = search.case.structure.modes()
    share = float(stop.shape(modes)[target.number]) / target.shape
    size = abs(share) * amplitude
    pair = stop.pair(modes)
    if size <= stop.gap or search.case.method.hard_restitution(stop.contact, pair) is not None:
        return 0j
    law = _core.normal_law(*stop.contact.coefficients(pair))
    low, high = 1e-9 * target.omega * size, 1e6 * target.omega * size
    for _ in range(_HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if law.largest_overlap(middle) < size - stop.gap else (low, middle)
    spring = law.effective_mass * (math.pi / law.contact_time(low)) ** 2
    part = stop.gap / size
    restitution = getattr(getattr(stop.contact, "restitution", None), "constant_value", None) or _USUAL_RESTITUTION
    lost = 0.5 * law.effective_mass * target.omega**2 * (size**2 - stop.gap**2) * (1 - restitution**2)
    elastic = spring * (math.acos(part) - part * math.sqrt(1 - part**2)) / math.pi
    return share**2 * complex(elastic, lost / (math.pi * size**2))


def _motions(searches: Sequence[_Search]) -> list[int]:
    """Return the number of the motion that each search found, counted from 0; -1 if it found none."""
    labels = [-1] * len(searches)
    found = [k for k, search in enumerate(searches) if search.is_found]
    for first in found:
        if labels[first] >= 0:
            continue
        labels[first] = max(labels) + 1
        reached = [first]
        # Motions that scatter form a chain of neighbours.
        while reached:
            one = searches[reached.pop()]
            for k in found:
                if labels[k] < 0 and one.is_near(searches[k]):
                    labels[k] = labels[first]
                    reached.append(k)
    return labels


def _limits_of_motions(values: FloatArray, motions: NDArray[np.int64]) -> tuple[float, float]:
    """Return the smallest and the largest limit of the 95 % intervals of the motions, which have a common scatter."""
    from scipy import stats

    groups = [values[motions == motion] for motion in range(motions.max() + 1)]
    freedom = sum(group.size - 1 for group in groups)
    squares = sum(float(np.sum((group - group.mean()) ** 2)) for group in groups)
    half = stats.t.ppf(0.975, freedom) * math.sqrt(squares / freedom) if freedom else 0.0
    ends = [
        (group.mean() - half / math.sqrt(group.size), group.mean() + half / math.sqrt(group.size)) for group in groups
    ]
    return min(low for low, _ in ends), max(high for _, high in ends)


def _several_motions(level: xarray.Dataset, motions: NDArray[np.int64]) -> str:
    """Return the warning about the different motions of the starts at an amplitude."""
    some = []
    for motion in range(motions.max() + 1):
        inside = motions == motion
        hertz, ratio = (float(level[name].values[inside].mean()) for name in ("frequencies", "damping_ratios"))
        some.append(
            f"{quantity(hertz, 'Hz')} with {100 * ratio:.3g} % ({counted(int(np.count_nonzero(inside)), 'start')})"
        )
    return (
        f"warning: at {quantity(float(level.amplitude), 'm')} the starts found {len(some)} motions: {', '.join(some)}; "
        "their mean is none of them; try: frequencies and damping_ratios of each start, and more starts"
    )


def _effective_mass(run: Run, frequency: float, kept: int) -> complex:
    """Return the momentum of the content of a cavity over its velocity, both of the first harmonic [kg]; 0 if it failed."""
    if not run.ok:
        return 0j
    arrays = run.arrays
    start = arrays.time[-1] - kept / frequency
    weights = trapezoid_weights(arrays.time, start)
    if arrays.engine == "dem":
        base = arrays.base_velocity
        momentum = arrays.momentum[:, 0] + arrays.particle_mass[0] * base
    else:
        base = arrays.base_velocity[:, None]
        masses = run.case.impact_dampers[0].masses
        momentum = ((arrays.ball_velocity + base) @ masses)[:, None]
    v = first_harmonic(arrays.time, base, weights, frequency)
    p = first_harmonic(arrays.time, momentum, weights, frequency)
    return complex(np.vdot(v, p) / np.vdot(v, v))


_QUANTITIES = {
    "damping_ratio": ("1", "damping ratio"),
    "frequency": ("Hz", "frequency of phase resonance"),
    "force": ("N", "amplitude of the load"),
    "work": ("J", "work of the load in a cycle"),
}


def _mean_and_limits(
    values: FloatArray, error: FloatArray, motions: NDArray[np.int64]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the mean over the starts at each amplitude, and the limits of its 95 % interval.

    `values`: those of each start, (starts, A); NaN where none was found. `error`: relative error by the transient, (A,).
    `motions`: number of the motion of each start, (starts, A).
    """
    from scipy import stats

    part, count = np.ma.masked_invalid(values), np.isfinite(values).sum(axis=0)
    mean = part.mean(axis=0).filled(np.nan)
    half = np.full(mean.size, np.nan)
    several = count > 1
    scatter = part.std(axis=0, ddof=1).filled(np.nan)[several] / np.sqrt(count[several])
    half[several] = np.hypot(stats.t.ppf(0.975, count[several] - 1) * scatter, (mean * error)[several])
    lower, upper = mean - half, mean + half
    # The interval of the mean of many starts in several motions is narrower than the distance of these.
    for level in np.flatnonzero(motions.max(axis=0) > 0):
        ends = _limits_of_motions(values[:, level], motions[:, level])
        lower[level], upper[level] = min(lower[level], ends[0]), max(upper[level], ends[1])
    return mean, lower, upper


def _dataset(
    searches: list[_Search], levels: FloatArray, starts: int, target: _Target, case: Case, messages: list[str]
) -> xarray.Dataset:
    """Return the means over the starts, their intervals, and the values of each start."""
    import xarray

    shape = starts, levels.size
    found = np.array([search.is_found for search in searches]).reshape(shape)
    omega = np.array([search.omega for search in searches]).reshape(shape)
    force = np.where(found, np.array([search.force for search in searches]).reshape(shape), np.nan)
    masses = np.array([target.modal_mass(search.mass) for search in searches]).reshape(shape)
    # What all starts have in common is a transient: their mean drift turns and scales the dynamic stiffness by as much.
    drift = np.ma.masked_invalid(
        np.where(found, np.array([search.drift for search in searches]).reshape(shape), np.nan)
    )
    error = np.abs(drift.mean(axis=0)).filled(np.nan)
    values = {
        "frequency": np.where(found, omega / (2 * math.pi), np.nan),
        "damping_ratio": force / (2 * omega**2 * levels * masses),
        "force": force,
        "work": math.pi * force * levels,
    }
    result = xarray.Dataset(coords={"amplitude": ("amplitude", levels, {"units": "m", "long_name": "amplitude"})})
    count = found.sum(axis=0)
    motions = np.array([_motions(searches[level :: levels.size]) for level in range(levels.size)]).T
    for name, (units, long_name) in _QUANTITIES.items():
        about = {"units": units, "long_name": long_name}
        relative = error * (result.damping_ratio.values if name == "frequency" else 1)
        mean, lower, upper = _mean_and_limits(values[name], relative, motions)
        result[name] = "amplitude", mean, about
        result[f"{name}_lower"] = "amplitude", lower, {**about, "long_name": f"lower limit of the {long_name}"}
        result[f"{name}_upper"] = "amplitude", upper, {**about, "long_name": f"upper limit of the {long_name}"}
    for name, plural in (("frequency", "frequencies"), ("damping_ratio", "damping_ratios")):
        units, long_name = _QUANTITIES[name]
        result[plural] = ("start", "amplitude"), values[name], {"units": units, "long_name": f"{long_name}, each start"}
    result["found"] = ("start", "amplitude"), found, {"long_name": "whether the search has ended"}
    number = motions.max(axis=0) + 1
    result["motions"] = "amplitude", number, {"long_name": "number of different motions that the starts found"}
    for level in np.flatnonzero(number > 1):
        messages = [*messages, _several_motions(result.isel(amplitude=level), motions[:, level])]
    missing = [
        f"{quantity(level, 'm')} ({starts - n} of {starts})"
        for level, n in zip(levels, count, strict=True)
        if n < starts
    ]
    if missing:
        messages = [
            *messages,
            f"warning: no phase resonance was found at {', '.join(missing)}; try: more cycles to skip, or other amplitudes",
        ]
    return result.assign_attrs(
        study="backbone",
        case=case.to_toml(),
        mode=target.number + 1,
        point=case.modes.point(target.load.point),
        mode_frequency=target.omega / (2 * math.pi),
        mode_damping_ratio=target.ratio,
        warnings=merged_warnings(messages),
    )
