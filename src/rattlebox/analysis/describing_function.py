"""First-harmonic response of a structure with dampers that act as an apparent mass, which depends on the amplitude.

In the first harmonic, a damper whose cavity has the complex acceleration a exerts the force -(m' - i m'') a on the
structure. At each frequency the accelerations of the cavities thus satisfy a + G m(abs(a)) a = L a_0, with the level L of
the load, the accelerations a_0 of the structure alone at level 1, and its accelerations G per unit force. Meyer and
Seifried call m' and the loss per cycle, computed for the damper on a shaker, its effective fields.

References
----------
A. Gelb, W. E. Vander Velde (1968), Multiple-Input Describing Functions and Nonlinear System Design, McGraw-Hill.
N. Meyer, R. Seifried (2021), Damping prediction of particle dampers for structures under forced vibration using effective
fields, Granular Matter 23, 64, doi:10.1007/s10035-021-01128-z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .signals import FloatArray

ComplexArray = NDArray[np.complex128]

NEGLIGIBLE = 0.05
"""Amplitude of a cavity over the largest one below which it may be under the smallest amplitude of the table."""

_FINE = 8  # amplitudes in each interval of the table at which levels are computed
_EDGE = 0.1  # width of the transition outside of the table, in natural logarithms of the amplitude
_BISECTIONS = 60
_ROOT = 1e-12  # change of a solution below which it has converged
_NEWTON = 1e-6  # largest residual of a point on a branch
_NEARBY = 0.3  # largest change of a motion over that without dampers in one step of Newton's method
_LONGEST, _SHORTEST = 0.1, 1e-6  # steps along a branch, in natural logarithms of the level
_MOST_STEPS = 1500
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class MassTable:
    """Apparent mass of a damper over amplitude and frequency, with interpolation between the values.

    The mass is interpolated by monotone piecewise cubics (PCHIP) over the logarithm of the amplitude, and linearly over the
    logarithm of the frequency. There is no extrapolation.

    References
    ----------
    F. N. Fritsch, J. Butland (1984), SIAM J. Sci. Stat. Comput. 5, 300-304, doi:10.1137/0905021.
    """

    frequency: FloatArray  # Rising frequencies [Hz], (J,)
    # Rising amplitudes of the cavity, two or more: displacements [m] or accelerations [m/s^2], (K,)
    amplitude: FloatArray
    mass: ComplexArray  # Apparent mass m' - i m'' [kg]; NaN where it is unknown, (K, J)
    is_acceleration: bool

    @property
    def limits(self) -> tuple[float, float]:
        """Natural logarithms of the smallest and the largest amplitude."""
        return math.log(self.amplitude[0]), math.log(self.amplitude[-1])

    @cached_property
    def _coefficients(self) -> ComplexArray:
        """Coefficients of the cubics in each interval, (J, K - 1, 4), highest power first."""
        from scipy.interpolate import PchipInterpolator

        x = np.log(self.amplitude)
        coefficients = np.full((self.frequency.size, x.size - 1, 4), np.nan, np.complex128)
        for k, column in enumerate(self.mass.T):
            known = np.flatnonzero(np.isfinite(column))
            if known.size < 2:
                continue
            values = column[known]
            cubic = PchipInterpolator(x[known], np.stack([values.real, values.imag], axis=1)).c
            adjacent = np.flatnonzero(np.diff(known) == 1)  # no interpolation across a missing value
            coefficients[k, known[adjacent]] = (cubic[:, adjacent, 0] + 1j * cubic[:, adjacent, 1]).T
        return coefficients

    @cached_property
    def _latest(self) -> dict[bytes, MassCurves]:
        return {}

    def curves(self, frequency: FloatArray, *, store: bool = True) -> MassCurves:
        """Return the apparent mass over the amplitude at frequencies.

        `frequency`: frequencies within the table [Hz], (F,).
        """
        key = frequency.tobytes()
        curves = self._latest.get(key)
        if curves is None:
            curves = MassCurves(np.log(self.amplitude), self._at(frequency))
            if store:
                self._latest.clear()
                self._latest[key] = curves
        return curves

    def _at(self, frequency: FloatArray) -> ComplexArray:
        """Return the coefficients of the cubics at frequencies, (F, K - 1, 4)."""
        nodes = np.log(self.frequency)
        left = np.clip(np.searchsorted(nodes, np.log(frequency), side="right") - 1, 0, max(nodes.size - 2, 0))
        right = np.minimum(left + 1, nodes.size - 1)
        span = nodes[right] - nodes[left]
        part = np.clip((np.log(frequency) - nodes[left]) / np.where(span > 0, span, 1.0), 0.0, 1.0)
        coefficients = np.zeros((frequency.size, self.amplitude.size - 1, 4), np.complex128)
        for column, weight in ((left, 1 - part), (right, part)):
            w = weight[:, None, None]
            # A column without weight may be unknown, that is, NaN.
            coefficients += np.where(w > 0, w * self._coefficients[column], 0.0)
        return coefficients

    def covers(self, frequency: FloatArray) -> NDArray[np.bool_]:
        """Return whether frequencies [Hz] are within the table, same shape."""
        low, high = self.frequency[0] * (1 - _ROUNDING), self.frequency[-1] * (1 + _ROUNDING)
        return np.asarray((frequency >= low) & (frequency <= high))

    def log_acceleration(self, omega: FloatArray) -> FloatArray:
        """Return the logarithm of the acceleration of a unit amplitude at angular frequencies [rad/s], same shape."""
        return np.zeros_like(omega) if self.is_acceleration else 2 * np.log(omega)

    def thinned(self, amplitudes: bool) -> MassTable | None:
        """Return the table without every second amplitude or frequency; None if it has fewer than three of them."""
        nodes = self.amplitude if amplitudes else self.frequency
        if nodes.size < 3:
            return None
        kept = np.unique(np.append(np.arange(0, nodes.size, 2), nodes.size - 1))
        if amplitudes:
            return MassTable(self.frequency, nodes[kept], self.mass[kept], self.is_acceleration)
        return MassTable(nodes[kept], self.amplitude, self.mass[:, kept], self.is_acceleration)


@dataclass(frozen=True, eq=False)
class MassCurves:
    """Apparent mass of a damper over the amplitude at F frequencies."""

    nodes: FloatArray  # Natural logarithms of the amplitudes of the table, (K,)
    coefficients: ComplexArray  # Coefficients of the cubic in each interval, highest power first [kg], (F, K - 1, 4)

    @cached_property
    def grid(self) -> FloatArray:
        """Eight logarithms of amplitudes in each interval, and the last one, (G,)."""
        inner = self.nodes[:-1, None] + np.diff(self.nodes)[:, None] * np.arange(_FINE) / _FINE
        return np.append(inner.ravel(), self.nodes[-1])

    @cached_property
    def mass_on_grid(self) -> ComplexArray:
        """Apparent mass on the grid, (F, G) [kg]."""
        steps = np.diff(self.nodes)
        powers = (steps[:, None, None] * np.arange(_FINE)[:, None] / _FINE) ** np.arange(3, -1, -1)  # (K - 1, 8, 4)
        inner = np.einsum("fkp,kip->fki", self.coefficients, powers).reshape(len(self.coefficients), -1)
        last = self.coefficients[:, -1] @ steps[-1] ** np.arange(3, -1, -1)
        return np.concatenate([inner, last[:, None]], axis=1)

    def evaluate(self, rows: NDArray[np.intp], log_amplitude: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the apparent mass and its derivative with respect to the logarithm of the amplitude.

        `rows`: numbers of frequencies, (R,). `log_amplitude`: natural logarithms of amplitudes, (R, ...). Returns mass [kg]
        and derivative [kg]. Outside of the table the derivative decays to zero within a few per cent of the amplitude, so
        that branches of solutions can be followed there; these solutions are not used.
        """
        x = self.nodes
        inner = np.minimum(np.maximum(log_amplitude, x[0]), x[-1])
        interval = np.minimum(np.searchsorted(x[1:], inner, side="right"), x.size - 2)
        d = inner - x[interval]
        c = self.coefficients[rows.reshape(-1, *[1] * (inner.ndim - 1)), interval]
        mass = ((c[..., 0] * d + c[..., 1]) * d + c[..., 2]) * d + c[..., 3]
        slope = (3 * c[..., 0] * d + 2 * c[..., 1]) * d + c[..., 2]
        beyond = log_amplitude - inner
        if not beyond.any():
            return mass, slope
        # The damping mass must not change its sign there: the structure would vibrate without a load.
        with np.errstate(divide="ignore", invalid="ignore"):
            short = np.fmin(_EDGE, 0.5 * np.abs(mass.imag / slope.imag))
        parts = []
        for value, change, width in ((mass.real, slope.real, _EDGE), (mass.imag, slope.imag, np.maximum(short, 1e-9))):
            decay = np.exp(-np.abs(beyond) / width)
            parts.append((value + change * np.sign(beyond) * width * (1 - decay), change * decay))
        (mass_real, slope_real), (mass_imag, slope_imag) = parts
        return mass_real + 1j * mass_imag, slope_real + 1j * slope_imag


@dataclass(frozen=True, eq=False)
class Solutions:
    """Steady motions of the cavities of P dampers at L levels and F frequencies, the largest of up to S motions first."""

    acceleration: ComplexArray  # Acceleration of each cavity [m/s^2]; NaN where there are fewer solutions, (L, F, S, P)
    is_unstable: NDArray[np.bool_]  # Whether the motion lies between two folds, where a disturbance grows, (L, F, S)
    is_below: NDArray[np.bool_]  # Whether there is also a motion below or above the amplitudes of the table, (L, F)
    is_above: NDArray[np.bool_]
    # Whether a motion was not found, because the table has no masses there or the search failed, (L, F)
    is_lost: NDArray[np.bool_]

    def with_rows(self, rows: NDArray[np.intp], others: Solutions) -> Solutions:
        """Return the solutions with other ones at some frequencies; these are all frequencies of the others."""
        count = max(self.is_unstable.shape[2], others.is_unstable.shape[2])
        changed, new = self._padded(count), others._padded(count)
        for field in fields(Solutions):
            getattr(changed, field.name)[:, rows] = getattr(new, field.name)
        return changed

    def _padded(self, count: int) -> Solutions:
        """Return a copy with places for a number of solutions."""
        more = (0, 0), (0, 0), (0, count - self.is_unstable.shape[2])
        return Solutions(
            np.pad(self.acceleration, (*more, (0, 0)), constant_values=np.nan),
            np.pad(self.is_unstable, more),
            *(each.copy() for each in (self.is_below, self.is_above, self.is_lost)),
        )


def solve(
    table: MassTable, frequency: FloatArray, gain: ComplexArray, drive: ComplexArray, levels: FloatArray
) -> Solutions:
    """Return all steady motions in the first harmonic within the table.

    `frequency`: frequencies [Hz]; outside of the table there are no solutions, (F,). `gain`: accelerations of the cavities
    per unit force on each of them, without dampers [1/kg], (F, P, P). `drive`: accelerations of the cavities at level 1
    without dampers, (F, P). `levels`: levels of the load or base motion, above zero, (L,).

    Notes
    -----
    For one cavity, the level follows from the amplitude in closed form, L = abs(a) abs(1 + G m) / abs(a_0), so that the
    amplitudes at a given level are the roots of a function of one variable, which is searched in steps of an eighth of the
    spacing of the table. For several cavities, the branch of solutions is followed by steps of its arc length, around all
    folds (Keller 1977), from a level at which all move less than the smallest amplitude of the table until one moves more
    than the largest. Solutions that are not connected to this branch are missed.

    References
    ----------
    See the module for the describing function.
    H. B. Keller (1977), Numerical solution of bifurcation and nonlinear eigenvalue problems, in: P. H. Rabinowitz (ed.),
    Applications of Bifurcation Theory, Academic Press, 359-384.
    E. L. Allgower, K. Georg (1990), Numerical Continuation Methods, Springer, doi:10.1007/978-3-642-61257-2.
    """
    # Without a load at a cavity nothing moves, at any level; such frequencies would divide by zero.
    inside = np.flatnonzero(table.covers(frequency) & np.any(drive != 0, axis=1))
    one = drive.shape[1] == 1
    curves = table.curves(frequency)
    system = _System(table, curves, inside, frequency[inside], gain[inside], drive[inside])
    unordered = (_solve_one if one else _solve_several)(system, levels)
    return unordered.solutions(inside, frequency.size, levels.size, drive.shape[1])


def solve_near(
    table: MassTable,
    frequency: FloatArray,
    gain: ComplexArray,
    drive: ComplexArray,
    levels: FloatArray,
    solutions: Solutions,
) -> Solutions:
    """Return the motions for a table that differs little from that of known motions."""
    if drive.shape[1] == 1:
        return solve(table, frequency, gain, drive, levels)
    # Known motions are good starts for Newton's method, many times faster than following the branch again. Steps are
    # bounded, so that a start cannot change to another branch.
    index = np.nonzero(np.isfinite(solutions.acceleration).all(axis=-1))
    level, rows = np.log(levels[index[0]]), index[1]
    branch = _Branch(_System(table, table.curves(frequency), np.arange(frequency.size), frequency, gain, drive))
    scale = (branch.scale[rows] * np.exp(level))[:, None]
    unit = solutions.acceleration[index] / scale
    start = np.concatenate([unit.real, unit.imag, level[:, None]], axis=1)
    reach = np.maximum(_NEARBY, 0.5 * np.linalg.norm(start[:, :-1], axis=1))
    point = _at_level(branch, start, rows, level, reach)
    value, _ = branch.residual(point, rows)
    with np.errstate(invalid="ignore"):
        converged = np.asarray(np.abs(value).max(axis=1) < _NEWTON) & (np.linalg.norm(point - start, axis=1) < reach)
    acceleration = np.full(solutions.acceleration.shape, np.nan, np.complex128)
    acceleration[index] = branch.motion(point) * scale
    near = replace(solutions, acceleration=acceleration)
    if converged.all():
        return near
    # A fold may have passed over a motion, which then has no neighbour: its whole frequency is solved from the
    # beginning.
    lost = np.unique(rows[~converged])
    return near.with_rows(lost, solve(table, frequency[lost], gain[lost], drive[lost], levels))


@dataclass(frozen=True, eq=False)
class _System:
    """Cavities at the frequencies within a table."""

    table: MassTable
    curves: MassCurves
    rows: NDArray[np.intp]  # Numbers of the frequencies in the curves, (F,)
    frequency: FloatArray
    gain: ComplexArray
    drive: ComplexArray

    def mass(self, rows: NDArray[np.intp], log_amplitude: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return mass and derivative at frequencies of the system; see `MassCurves.evaluate`."""
        return self.curves.evaluate(self.rows[rows], log_amplitude)


@dataclass
class _UnorderedSolutions:
    """Solutions in any order, and flags for solutions that were not computed."""

    level: NDArray[np.intp]  # Numbers of level and frequency, (N,)
    row: NDArray[np.intp]
    motion: ComplexArray  # Accelerations of the cavities, (N, P)
    unstable: NDArray[np.bool_]  # Whether the motion is between two folds, (N,)
    below: NDArray[np.bool_]  # See `Solutions`, (L, F)
    above: NDArray[np.bool_]
    lost: NDArray[np.bool_]

    def solutions(self, inside: NDArray[np.intp], frequencies: int, levels: int, dampers: int) -> Solutions:
        """Return the solutions over all frequencies, those of a level and frequency in the order of their amplitudes."""
        column = inside[self.row]
        order = np.lexsort((-np.abs(self.motion).max(axis=1), column, self.level))
        cell = (self.level * frequencies + column)[order]
        first = np.searchsorted(cell, cell, side="left")
        number = np.arange(cell.size) - first
        shape = levels, frequencies
        acceleration = np.full((*shape, int(number.max(initial=0)) + 1, dampers), np.nan, np.complex128)
        unstable = np.zeros(acceleration.shape[:-1], bool)
        acceleration[self.level[order], column[order], number] = self.motion[order]
        unstable[self.level[order], column[order], number] = self.unstable[order]
        flags = []
        for flag in (self.below, self.above, self.lost):
            everywhere = np.zeros(shape, bool)
            everywhere[:, inside] = flag
            flags.append(everywhere)
        return Solutions(acceleration, unstable, *flags)


# ---- one cavity


def _solve_one(system: _System, levels: FloatArray) -> _UnorderedSolutions:
    """Return the solutions for one cavity from the level as a function of the amplitude."""
    grid, gain, drive = system.curves.grid, system.gain[:, 0, 0], system.drive[:, 0]
    # The logarithm of the level as a function of that of the amplitude: levels are roots of `curve - level`, and where
    # it falls, a larger level belongs to a smaller motion.
    offset = system.table.log_acceleration(2 * np.pi * system.frequency) - np.log(np.abs(drive))
    with np.errstate(divide="ignore"):
        factor = np.log(np.abs(1 + gain[:, None] * system.curves.mass_on_grid[system.rows]))
    curve = grid + offset[:, None] + factor
    has_mass = np.isfinite(curve)
    shape = levels.size, system.frequency.size
    below, above, lost = (np.zeros(shape, bool) for _ in range(3))
    places = []
    for number, level in enumerate(np.log(levels)):
        over = curve >= level
        # A level below that of the smallest amplitude belongs to a smaller amplitude, one above that of the largest to a
        # larger amplitude.
        below[number] = over[:, 0] & has_mass[:, 0]
        above[number] = ~over[:, -1] & has_mass[:, -1]
        for row in np.flatnonzero(~has_mass.all(axis=1)):  # the level may be reached where runs of the map failed
            sides, numbers = over[row, has_mass[row]], np.flatnonzero(has_mass[row])
            hidden = (sides[1:] != sides[:-1]) & (np.diff(numbers) > 1)
            lost[number, row] = hidden.any() or not (has_mass[row, 0] and has_mass[row, -1])
        # Each change of side between neighbours of the grid is a solution; the sign of the change is its stability.
        rows, cells = np.nonzero((over[:, 1:] != over[:, :-1]) & has_mass[:, 1:] & has_mass[:, :-1])
        places.append(np.stack([np.full(rows.size, number), rows, cells, over[rows, cells + 1]]))
    level_of, rows, cells, rises = np.concatenate(places, axis=1)
    low, high, level = grid[cells], grid[cells + 1], np.log(levels)[level_of]
    left, right = curve[rows, cells] - level, curve[rows, cells + 1] - level
    # Newton's method, which bisects where it would leave the interval.
    root = low - left / (right - left) * (high - low)
    for _ in range(_BISECTIONS):
        mass, slope = system.mass(rows, root)
        with np.errstate(divide="ignore", invalid="ignore"):
            total = 1 + gain[rows] * mass
            value = root + offset[rows] + np.log(np.abs(total)) - level
            step = value / (1 + (gain[rows] * slope / total).real)
        beyond = (value >= 0) == rises.astype(bool)
        low, high = np.where(beyond, low, root), np.where(beyond, root, high)
        new = root - step
        inner = (new >= low) & (new <= high)
        new = np.where(inner, new, 0.5 * (low + high))
        change, root = np.abs(new - root).max(initial=0.0), new
        if change < _ROOT:
            break
    mass, _ = system.mass(rows, root)
    motion = levels[level_of] * drive[rows] / (1 + gain[rows] * mass)
    return _UnorderedSolutions(level_of, rows, motion[:, None], rises == 0, below, above, lost)


# ---- several cavities


class _Branch:
    """Residual of the motions y = a / (L scale) of several cavities, with the logarithm of the level as parameter.

    A point is an array (F, 2 P + 1): real parts, imaginary parts, logarithm of the level.
    """

    def __init__(self, system: _System) -> None:
        self.system, self.limits = system, system.table.limits
        self.gain, self.count = system.gain, system.drive.shape[1]
        with np.errstate(divide="ignore", invalid="ignore"):  # frequencies without drive, which have no solutions
            self.scale = np.abs(system.drive).max(axis=1)
            self.target = system.drive / self.scale[:, None]
            self.offset = np.log(self.scale) - system.table.log_acceleration(2 * np.pi * system.frequency)

    def motion(self, point: FloatArray) -> ComplexArray:
        return np.asarray(point[:, : self.count] + 1j * point[:, self.count : -1])

    def log_amplitudes(self, point: FloatArray, rows: NDArray[np.intp]) -> FloatArray:
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(np.abs(self.motion(point))) + point[:, -1:] + self.offset[rows, None])

    def residual(self, point: FloatArray, rows: NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
        """Return the residual, (F, 2 P), and its derivative, (F, 2 P, 2 P + 1)."""
        y, gain, p = self.motion(point), self.gain[rows], self.count
        mass, slope = self.system.mass(rows, self.log_amplitudes(point, rows))
        value = y + (gain @ (mass * y)[..., None])[..., 0] - self.target[rows]
        size = np.maximum(np.abs(y) ** 2, 1e-300)
        by_level = (gain @ (slope * y)[..., None])[..., 0]
        derivative = np.empty((len(y), 2 * p, 2 * p + 1))
        for columns, unit, part in ((slice(0, p), 1.0, y.real), (slice(p, 2 * p), 1j, y.imag)):
            inner = mass * unit + slope * y * part / size
            column = gain * inner[:, None, :] + unit * np.eye(p)
            derivative[:, :p, columns], derivative[:, p:, columns] = column.real, column.imag
        derivative[:, :p, -1], derivative[:, p:, -1] = by_level.real, by_level.imag
        return np.concatenate([value.real, value.imag], axis=1), derivative

    def start(self) -> FloatArray:
        """Return the motions at a level at which all are so far below the table that the masses are constant."""
        # There the system is linear, with one solution, from which all others are followed.
        low = self.limits[0] - 10 * _EDGE
        every = np.arange(len(self.gain))
        mass, _ = self.system.mass(every, np.full((every.size, self.count), low))
        y = np.linalg.solve(np.eye(self.count) + self.gain * mass[:, None, :], self.target[..., None])[..., 0]
        level = low - np.log(np.abs(y).max(axis=1)) - self.offset
        return np.concatenate([y.real, y.imag, level[:, None]], axis=1)


def _solve_several(system: _System, levels: FloatArray) -> _UnorderedSolutions:
    """Return the solutions for several cavities, which share the branch that begins at small levels."""
    branch = _Branch(system)
    path, at_end = _follow_branch(branch)
    low, high = branch.limits
    shape = levels.size, system.frequency.size
    below, above, lost = (np.zeros(shape, bool) for _ in range(3))
    parts = []
    for number, level in enumerate(np.log(levels)):
        # The branch passes a level as often as there are motions: twice more after each pair of folds.
        below[number] = path[0, :, -1] > level
        above[number] = ~at_end & (path[-1, :, -1] < level)
        lost[number] = at_end
        beyond = path[..., -1] >= level
        steps, rows = np.nonzero(beyond[1:] != beyond[:-1])
        first, last = path[steps, rows], path[steps + 1, rows]
        part = (level - first[:, -1]) / (last[:, -1] - first[:, -1])
        points = _at_level(branch, first + part[:, None] * (last - first), rows, level)
        logs = branch.log_amplitudes(points, rows)
        # A cavity at a node of the motion is below the table at any level; it has no influence and does not decide.
        smallest = np.where(logs < logs.max(axis=1, keepdims=True) + math.log(NEGLIGIBLE), np.inf, logs).min(axis=1)
        motion = branch.motion(points) * (branch.scale[rows] * levels[number])[:, None]
        small, large = smallest < low, logs.max(axis=1) > high
        below[number, rows[small]] = True
        above[number, rows[large]] = True
        inner = ~small & ~large
        parts.append((np.full(inner.sum(), number), rows[inner], motion[inner], beyond[steps, rows][inner]))
    level_of, rows, motion, unstable = (np.concatenate(each) for each in zip(*parts, strict=True))
    return _UnorderedSolutions(level_of, rows, motion, unstable, below, above, lost)


def _at_level(
    branch: _Branch,
    point: FloatArray,
    rows: NDArray[np.intp],
    level: float | FloatArray,
    reach: float | FloatArray = _NEARBY,
) -> FloatArray:
    """Return the solutions near points, at a given logarithm of the level, from steps shorter than the reach."""
    point = point.copy()
    point[:, -1] = level
    active, reach = np.arange(len(point)), np.broadcast_to(reach, len(point))
    for _ in range(6):
        value, derivative = branch.residual(point[active], rows[active])
        change = np.linalg.solve(derivative[..., :-1], -value[..., None])[..., 0]
        size = np.linalg.norm(change, axis=1)
        small = size < reach[active]  # otherwise the given point is better
        point[active[small], :-1] += change[small]
        active = active[small & (size > _ROOT)]
        if not active.size:
            break
    return point


def _follow_branch(branch: _Branch) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the points along the branch of each frequency, (N, F, 2 P + 1), and whether it ends inside the table."""
    point = branch.start()
    path, tangent = [point.copy()], np.zeros_like(point)
    tangent[:, -1] = 1.0
    length = np.full(len(point), _LONGEST)
    # All frequencies advance together, each with its own step, because the cost is that of the calls.
    end = branch.limits[1] + 10 * _EDGE
    lost, active = np.zeros(len(point), bool), np.arange(len(point))
    before = tangent.copy()
    last = np.zeros(len(point))
    for _ in range(_MOST_STEPS):
        if not active.size:
            break
        here, along, h = point[active], tangent[active], length[active]
        # Second order: the tangents of the last two points give the curvature.
        bend = (along - before[active]) / np.where(last[active] > 0, last[active], np.inf)[:, None]
        ahead = here + h[:, None] * along + 0.5 * h[:, None] ** 2 * bend
        accepted, new_tangent = _correct_prediction(branch, ahead, along, active)
        # A step is good if the corrector stayed near the prediction and the tangent has not turned by more than 25
        # degrees: otherwise it may have jumped to another branch.
        good = np.asarray(np.isfinite(accepted).all(axis=1) & np.isfinite(new_tangent).all(axis=1))
        good &= np.linalg.norm(np.where(good[:, None], accepted - ahead, 0.0), axis=1) < 0.5 * h
        good &= np.einsum("fi,fi->f", np.nan_to_num(new_tangent), along) > 0.9
        done = active[good]
        before[done], last[done] = along[good], h[good]
        point[done], tangent[done] = accepted[good], new_tangent[good]
        length[active] = np.where(good, np.minimum(1.5 * h, _LONGEST), 0.5 * h)
        path.append(point.copy())
        # Where even the shortest step fails, the table has a hole or a kink: the rest of the branch is reported as
        # lost.
        lost[active] = length[active] < _SHORTEST
        beyond = branch.log_amplitudes(point[active], active).max(axis=1) > end
        active = active[~beyond & ~lost[active]]
    lost[active] = True
    return np.array(path), lost


def _correct_prediction(
    branch: _Branch, ahead: FloatArray, along: FloatArray, rows: NDArray[np.intp]
) -> tuple[FloatArray, FloatArray]:
    """Return the points of the branch nearest to predicted ones and the tangents there; NaN where there are none."""
    point, tangents = np.full_like(ahead, np.nan), np.full_like(ahead, np.nan)
    active, here = np.arange(len(ahead)), ahead
    try:
        for _ in range(8):
            along_here = along[active]
            value, derivative = branch.residual(here, rows[active])
            # The bordered matrix stays regular at folds, where the derivative without the level is singular. One
            # factorisation gives the correction and the tangent.
            matrix = np.concatenate([derivative, along_here[:, None, :]], axis=1)
            distance = np.einsum("fi,fi->f", along_here, here - ahead[active])
            right = np.zeros((*here.shape, 2))
            right[:, :-1, 0], right[:, -1, 0], right[:, -1, 1] = -value, -distance, 1.0
            solved = np.linalg.solve(matrix, right)
            done = np.abs(value).max(axis=1) < _NEWTON
            tangent = solved[done, :, 1]
            point[active[done]] = here[done]
            tangents[active[done]] = tangent / np.linalg.norm(tangent, axis=1, keepdims=True)
            active, here = active[~done], (here + solved[..., 0])[~done]
            if not active.size:
                break
    except np.linalg.LinAlgError:
        return np.full_like(point, np.nan), along
    return point, tangents


# ---- modes


def damping_of_modes(
    table: MassTable, stiffness: FloatArray, damping: FloatArray, shapes: FloatArray, number: int
) -> tuple[FloatArray, FloatArray]:
    """Return natural frequency and damping ratio of each mode with dampers, over the amplitude.

    `stiffness`: squared natural frequencies of the structure [1/s^2], (m,). `damping`: modal damping matrix D [1/s],
    (m, m). `shapes`: mass-normalised mode shapes at the cavities [kg^-1/2], (P, m). Returns frequency [Hz] and damping
    ratio, where the cavity with the largest motion has the amplitudes of the table. NaN outside of the table.

    Notes
    -----
    With the masses M = I + sum of n m' s s^T over the cavities, the frequency is that of the undamped mode x,
    K x = omega^2 M x, and the damping ratio x^T (D + sum of n omega m'' s s^T) x / (2 omega x^T M x), the energy lost in
    a cycle over 4 pi times the largest kinetic energy. Both are iterated, since the masses depend on frequency and
    amplitudes.

    References
    ----------
    E. E. Ungar, E. M. Kerwin (1962), J. Acoust. Soc. Am. 34, 954-957, doi:10.1121/1.1918227.
    """
    count, amplitudes = stiffness.size, np.log(table.amplitude)
    frequency, ratio = np.full((2, count, amplitudes.size), np.nan)
    for mode in np.flatnonzero(stiffness > 0):
        # The mass of a damper depends on frequency and amplitude, which depend on it: a fixed point that converges
        # fast, since dampers are light.
        omega = np.full(amplitudes.size, math.sqrt(stiffness[mode]))
        x = np.zeros((amplitudes.size, count))
        x[:, mode] = 1.0
        for step in range(60):
            hertz = np.clip(omega / (2 * np.pi), table.frequency[0], table.frequency[-1])
            logs, outside = _cavity_amplitudes(x @ shapes.T, amplitudes)
            mass, _ = table.curves(hertz, store=False).evaluate(np.arange(hertz.size), logs)
            loaded = np.eye(count) + number * np.einsum("kp,pi,pj->kij", mass.real, shapes, shapes)
            squared, x, valid = _mode(stiffness, loaded, int(mode))
            before, omega = omega, np.sqrt(squared)
            if np.nanmax(np.abs(omega / before - 1), initial=0.0) < 1e-9:
                break
            if step > 8:  # slow convergence, or none
                omega = 0.3 * before + 0.7 * omega
        # Energy lost in a cycle over the largest kinetic energy; modes are coupled by damping only to second order.
        extra = -number * omega[:, None, None] * np.einsum("kp,pi,pj->kij", mass.imag, shapes, shapes)
        lost = np.einsum("ki,kij,kj->k", x, damping + extra, x)
        kinetic = np.einsum("ki,kij,kj->k", x, loaded, x)
        converged = np.abs(omega / before - 1) < 1e-6
        valid_at = valid & converged & ~outside & table.covers(omega / (2 * np.pi))
        frequency[mode, valid_at] = omega[valid_at] / (2 * np.pi)
        ratio[mode, valid_at] = (lost / (2 * omega * kinetic))[valid_at]
    return frequency, ratio


def _cavity_amplitudes(motions: FloatArray, amplitudes: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the logarithms of the amplitudes of all cavities, (K, P), the largest as given; whether one is too small."""
    size = np.abs(motions)
    most = size.max(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(most > 0, size / most, np.nan)
        logs = amplitudes[:, None] + np.log(part)
    small = np.any((logs < amplitudes[0] - _ROUNDING) & (part > NEGLIGIBLE), axis=1)
    return np.nan_to_num(logs, nan=amplitudes[0], neginf=amplitudes[0]), small | ~(most[:, 0] > 0)


def _mode(stiffness: FloatArray, mass: FloatArray, mode: int) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Return eigenvalue and eigenvector of a mode for many mass matrices, and whether these are positive definite."""
    finite = np.asarray(np.isfinite(mass).all(axis=(1, 2)))
    valid = finite & (np.linalg.eigvalsh(np.where(finite[:, None, None], mass, 0.0)).min(axis=1) > 0)
    root = np.linalg.cholesky(np.where(valid[:, None, None], mass, np.eye(stiffness.size)))
    inverse = np.linalg.inv(root)
    values, vectors = np.linalg.eigh(np.einsum("kia,a,kja->kij", inverse, stiffness, inverse))
    shape = np.einsum("kji,kj->ki", inverse, vectors[:, :, mode])
    return np.maximum(values[:, mode], 0.0), shape, valid
