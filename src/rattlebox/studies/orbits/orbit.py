"""A periodic motion with its stability, its impacts and its distance to grazing."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.html import code_block
from rattlebox._util.quantities import amount, digits, quantity
from rattlebox.core import _core
from rattlebox.engines.simulate import run_from_core
from rattlebox.model.units import whole_number
from rattlebox.prepare.pack import pack
from rattlebox.studies.orbits.forcing import Forcing
from rattlebox.studies.orbits.motion import Motion, motion_of, started
from rattlebox.studies.orbits.stability import ON_CIRCLE, stability_words
from rattlebox.studies.orbits.starting import case_on

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rattlebox.model.case import Case
    from rattlebox.results.run import Run
    from rattlebox.studies.orbits.shooting import ReturnMap, Shot

Vector = NDArray[np.float64]


_MOST_LINES = 8
"""Number of impacts that are printed."""
_SMALL = 1e-8
"""Largest rounding error of a determinant, over its value, with which it is compared with its rule."""


class OrbitImpact(NamedTuple):
    """An impact of a periodic motion.

    Attributes
    ----------
    place : str
        Damper and wall, pair of balls, or stop.
    phase : float
        Time in the period of the motion over the period, from 0 to 1, where the loads have their phase at t = 0.
    approach_speed : float
        Approach speed [m/s].
    restitution : float
        Separation speed over approach speed.
    contact : int
        Number of the contact, counted over all dampers and stops from 0.
    """

    place: str
    phase: float
    approach_speed: float
    restitution: float
    contact: int


class Approach(NamedTuple):
    """The smallest gap of a periodic motion between bodies that turn back before they touch.

    Attributes
    ----------
    place : str
        Damper and wall, pair of balls, or stop.
    phase : float
        Time in the period of the motion over the period.
    gap : float
        Smallest gap [m].
    contact : int
        Number of the contact, counted over all dampers and stops from 0.
    """

    place: str
    phase: float
    gap: float
    contact: int


@dataclass(frozen=True, eq=False)
class Orbit:
    """A periodic motion of a case, from `rattlebox.find_orbit` or a point of `rattlebox.continue_orbit`.

    Attributes
    ----------
    case : Case
        Case with the values of the parameters.
    cycles : int
        Number of periods of the loads in a period of the motion.
    period : float
        Period of the motion [s].
    state : (n,) ndarray
        State at the beginning: displacement and velocity of each mode [kg^1/2 m, kg^1/2 m/s], then positions and velocities
        of all balls.
    phase : float
        Part of the period of the loads at which the state is taken; 0 unless a contact is near then.
    residual : float
        Difference of the state after a period, over the largest values of its components.
    multipliers : (n,) ndarray
        Floquet multipliers, the largest first, complex.
    impacts : tuple of OrbitImpact
        Impacts of one period in their order.
    nearest_miss : Approach or None
        Smallest gap of a contact at a time at which the bodies turn back; None if they touch at each approach.
    is_symmetric : bool
        Whether the motion repeats with the opposite sign after half a period.
    amplitudes : dict of str to float
        Half the peak-to-peak displacement of each point [m].
    determinant_error : float
        Difference of the product of the multipliers from that of the loss of the impacts and the damping, over its value;
        NaN if a contact is not a hard impact with a constant restitution, or next to grazing, where the rounding error of
        the product exceeds 1e-8.
    sticks : bool
        Whether bodies stick together for a part of the period.

    Examples
    --------
    The motion `orbit` of the example of `rattlebox.find_orbit` is a symmetric one:

    >>> orbit.is_stable, orbit.cycles, len(orbit.impacts)
    (True, 1, 2)
    """

    case: Case
    cycles: int
    period: float
    state: Vector
    phase: float
    residual: float
    multipliers: NDArray[np.complex128]
    impacts: tuple[OrbitImpact, ...]
    nearest_miss: Approach | None
    is_symmetric: bool
    amplitudes: Mapping[str, float]
    determinant_error: float
    sticks: bool

    @property
    def is_stable(self) -> bool:
        """Whether no multiplier is outside of the unit circle by more than rounding."""
        return bool((np.abs(self.multipliers) < 1 + ON_CIRCLE).all())

    @property
    def stability(self) -> str:
        """Kind of stability in words."""
        return stability_words(self.multipliers)

    @property
    def slowest_impact(self) -> OrbitImpact | None:
        """Impact with the smallest approach speed; None without impacts."""
        return min(self.impacts, key=lambda impact: impact.approach_speed, default=None)

    def run(self, periods: int = 1) -> Run:
        """Simulate the motion.

        Parameters
        ----------
        periods
            Number of periods of the motion.

        Returns
        -------
        Run
            Run that starts on the motion. Its time begins at the phase of the state; its case has the loads with the phases
            that they have then. An unstable motion departs from it after some periods.

        Raises
        ------
        CaseError
            If `periods` is not a positive whole number.
        """
        duration = whole_number(periods, "periods", 1) * self.period
        case = self._shifted().replaced({"duration": duration})
        packed = pack(case)
        problem = started(case, self.state, duration, packed.sample_times, contacts=packed.settings.contact_samples)
        problem = problem.replace(settings=problem.settings.replace(keep_end=True))
        (raw,) = _core.simulate([problem], 1)
        return run_from_core(case, raw, problem, f"a periodic motion of {quantity(self.period, 's', 6)}")

    def _shifted(self) -> Case:
        """Return the case whose time begins at the phase of the state."""
        return Forcing.of(self.case).shifted(self.phase)

    def as_case(self) -> Case:
        """Return the case that starts on the motion, for studies that begin there.

        Studies, such as `rattlebox.lyapunov`, `rattlebox.frequency_response` and `rattlebox.basins`, also take the motion
        itself in place of a case.

        Returns
        -------
        Case
            Case whose initial state is that of the motion, with the loads at the phase that belongs to it. Structures
            other than an oscillator, and those with tuned masses, become a `Modal` with the same points; identical dampers
            (`number`) are listed one by one.

        Raises
        ------
        CaseError
            If the case has tuned masses on a prescribed motion.
        """
        return case_on(self.case, self.phase, self.state)

    def plot(self, **options: Any) -> Figure:
        """Draw the motion over a period and its multipliers in the complex plane.

        Parameters
        ----------
        **options
            Those of `rattlebox.plots.plot_orbit`.

        Returns
        -------
        Figure
            Figure with two panels.
        """
        # studies must not import the figures statically, which are above them
        figure: Figure = import_module("rattlebox.plots.orbits").plot_orbit(self, **options)
        return figure

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _repr_html_(self) -> str:
        return code_block(str(self))

    def _lines(self) -> Iterator[str]:
        several = f"{self.cycles} cycles" if self.cycles > 1 else "1 cycle"
        symmetric = "symmetric" if self.is_symmetric else "not symmetric"
        yield f"periodic motion of {several} of the loads, {quantity(self.period, 's', 6)}, {symmetric}"
        yield f"stability      {self.stability}"
        yield f"multipliers    {', '.join(_multiplier_words(self.multipliers))}"
        for point, size in self.amplitudes.items():
            yield f"amplitude      {quantity(size, 'm', 6)} of {point}"
        for impact in self.impacts[:_MOST_LINES]:
            speed = quantity(impact.approach_speed, "m/s")
            yield f"impact         {impact.place} at {impact.phase:.4f} of the period, {speed}"
        if len(self.impacts) > _MOST_LINES or not self.impacts:
            yield f"impacts        {len(self.impacts) or 'none'}"
        if self.nearest_miss is not None:
            miss = self.nearest_miss
            yield f"nearest miss   {miss.place} at {miss.phase:.4f} of the period, {quantity(miss.gap, 'm')}"
        if self.sticks:
            yield "sticking       bodies stick together for a part of the period"
        yield f"residual       {self.residual:.1e}"
        if math.isfinite(self.determinant_error):
            yield f"determinant    agrees with the losses to {self.determinant_error:.1e}"


def _multiplier_words(multipliers: NDArray[np.complex128]) -> Iterator[str]:
    """Yield real multipliers, and each conjugate pair once with its angle."""
    for value in multipliers:
        if abs(value.imag) <= 1e-12 * abs(value):
            yield digits(float(value.real))
        elif value.imag > 0:
            yield f"{digits(abs(value))} (pair at {amount(math.degrees(np.angle(value)), '', 4)} deg)"


def orbit_of(
    returns: ReturnMap, shot: Shot, state: Vector, scale: Vector, values: Sequence[float] = ()
) -> Orbit | None:
    """Return the periodic motion of a fixed point; None if its motion cannot be computed."""
    found = orbit_and_motion(returns, shot, state, scale, values)
    return None if found is None else found[0]


def orbit_and_motion(
    returns: ReturnMap, shot: Shot, state: Vector, scale: Vector, values: Sequence[float] = ()
) -> tuple[Orbit, Motion] | None:
    """Return the periodic motion of a fixed point, and its samples; None if its motion cannot be computed."""
    case = returns.forcing.case
    # The motion at these values of the parameters, with its contacts.
    if len(returns.parameters):
        case = case.replaced(dict(zip(returns.parameters, map(float, values), strict=True)))
    period = returns.cycles * returns.forcing.period_of(returns.parameters, values)[0]
    motion = motion_of(Forcing.of(case, returns.parameters).shifted(returns.phase), state, period)
    if motion is None:
        return None
    # A mirrored map covers half of a period.
    matrix = shot.monodromy()
    multipliers = np.linalg.eigvals(matrix).astype(complex)
    if returns.mirrored:
        multipliers = multipliers**2
        matrix = matrix @ matrix
    order = np.lexsort((-multipliers.imag, -np.abs(multipliers).round(12)))
    # Times of contacts are shares of the period, from the phase of the loads at t = 0.
    names = case.contact_names
    shift = returns.phase / returns.cycles
    log = motion.impacts
    columns = motion.impact_contacts(), log.time, log.approach_speed, log.restitution
    impacts = [
        OrbitImpact(names[contact], (time / period + shift) % 1.0, speed, ratio, contact)
        for contact, time, speed, ratio in zip(*(column.tolist() for column in columns), strict=True)
    ]
    nearest = None
    for miss in motion.near_misses()[:1]:
        phase = (miss.time / period + shift) % 1.0
        nearest = Approach(names[miss.contact], phase, miss.gap, miss.contact)
    orbit = Orbit(
        case=case,
        cycles=returns.cycles,
        period=period,
        state=state,
        phase=returns.phase,
        residual=float(np.abs(shot.residual / scale).max()),
        multipliers=multipliers[order],
        impacts=tuple(sorted(impacts, key=lambda impact: impact.phase)),
        nearest_miss=nearest,
        is_symmetric=returns.mirrored,
        amplitudes=_amplitudes(case, motion),
        determinant_error=_determinant_error(case, motion, matrix, period) if not motion.sticks else math.nan,
        sticks=motion.sticks,
    )
    return orbit, motion


def _amplitudes(case: Case, motion: Motion) -> dict[str, float]:
    """Return half the peak-to-peak displacement of each point [m]."""
    sizes = {}
    for point, shape in case.modes.lines().items():
        low, high = motion.extremes(np.asarray(shape))
        sizes[point] = 0.5 * (high - low)
    return sizes


def _determinant_error(case: Case, motion: Motion, matrix: Vector, period: float) -> float:
    r"""Return the relative difference of the determinant from its rule; NaN if the rule does not apply.

    .. math:: \det M = e^{-2 T \sum_i \zeta_i \omega_i} \prod_k e_k^2
    """
    problem = pack(case)
    if problem.settings.method is not _core.Method.newton:
        return math.nan
    if not all(isinstance(contact.restitution, _core.ConstantRestitution) for contact in problem.contacts):
        return math.nan
    rule = math.exp(-2 * period * float(np.sum(problem.mode_decay))) * float(np.prod(motion.impacts.restitution**2))
    # The smallest multiplier has the rounding error of the largest one, which grows without bound next to grazing.
    sizes = np.abs(np.linalg.eigvals(matrix))
    rounding = float(np.finfo(float).eps * sizes.max() / max(sizes.min(), np.finfo(float).tiny))
    is_known = rule > ON_CIRCLE**2 and rounding < _SMALL
    return abs(float(np.linalg.det(matrix)) / rule - 1) if is_known else math.nan
