"""First-harmonic response of a structure with dampers that act as an apparent mass, which depends on the amplitude.

In the first harmonic, a damper whose cavity has the complex acceleration a exerts the force -(m' - i m'') a on the
structure. At each frequency the accelerations of the cavities thus satisfy a + G m(abs(a)) a = L a_0, with the level L of
the load, the accelerations a_0 of the structure alone at level 1, and its accelerations G per unit force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .signals import FloatArray

ComplexArray = NDArray[np.complex128]

NEGLIGIBLE = 0.05
"""Amplitude of a cavity over the largest one below which it may be under the smallest amplitude of the table."""

_FINE = 8  # amplitudes in each interval of the table at which levels are computed
_EDGE = 0.1  # width of the transition outside of the table, in natural logarithms of the amplitude
_BISECTIONS = 40
_LONGEST, _SHORTEST = 0.1, 1e-6  # steps along a branch, in natural logarithms of the level
_MOST_STEPS = 1500
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class MassTable:
    """Apparent mass of a damper over amplitude and frequency, with interpolation between the values.

    Along the amplitude the interpolation is piecewise cubic and monotone (PCHIP) in its logarithm, along the frequency
    linear in its logarithm. There is no extrapolation.

    Attributes
    ----------
    frequency : (J,) float
        Rising frequencies [Hz].
    amplitude : (K,) float
        Rising amplitudes of the cavity, two or more: displacements [m] or accelerations [m/s^2].
    mass : (K, J) complex
        Apparent mass m' - i m'' [kg]; NaN where it is unknown.
    is_acceleration
        Whether amplitudes are accelerations.
    """

    frequency: FloatArray
    amplitude: FloatArray
    mass: ComplexArray
    is_acceleration: bool

    @property
    def limits(self) -> tuple[float, float]:
        """Natural logarithms of the smallest and the largest amplitude."""
        return math.log(self.amplitude[0]), math.log(self.amplitude[-1])

    @cached_property
    def _coefficients(self) -> ComplexArray:
        """Coefficients of the cubics in each interval, (4, K - 1, J), highest power first."""
        from scipy.interpolate import PchipInterpolator

        x = np.log(self.amplitude)
        found = np.full((4, x.size - 1, self.frequency.size), np.nan, np.complex128)
        for k, column in enumerate(self.mass.T):
            known = np.flatnonzero(np.isfinite(column))
            if known.size < 2:
                continue
            values = column[known]
            cubic = PchipInterpolator(x[known], np.stack([values.real, values.imag], axis=1)).c
            whole = np.flatnonzero(np.diff(known) == 1)  # intervals between neighbours in the table
            found[:, known[whole], k] = cubic[:, whole, 0] + 1j * cubic[:, whole, 1]
        return found

    def covers(self, frequency: FloatArray) -> NDArray[np.bool_]:
        """Return whether frequencies [Hz] are within the table, same shape."""
        low, high = self.frequency[0] * (1 - _ROUNDING), self.frequency[-1] * (1 + _ROUNDING)
        return np.asarray((frequency >= low) & (frequency <= high))

    def log_acceleration(self, omega: FloatArray) -> FloatArray:
        """Return the logarithm of the acceleration of a unit amplitude at angular frequencies [rad/s], same shape."""
        return np.zeros_like(omega) if self.is_acceleration else 2 * np.log(omega)

    def evaluate(self, frequency: FloatArray, log_amplitude: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the apparent mass and its derivative with respect to the logarithm of the amplitude.

        Parameters
        ----------
        frequency : (F,) float
            Frequencies within the table [Hz].
        log_amplitude : (F, ...) float
            Natural logarithms of amplitudes.

        Returns
        -------
        tuple of (F, ...) complex
            Mass [kg] and derivative [kg]. Outside of the table the derivative decays to zero within a few per cent of the
            amplitude, so that branches of solutions can be followed there; these solutions are not used.
        """
        x, nodes = np.log(self.amplitude), np.log(self.frequency)
        inner = np.clip(log_amplitude, x[0], x[-1])
        interval = np.clip(np.searchsorted(x, inner, side="right") - 1, 0, x.size - 2)
        d = inner - x[interval]
        left = np.clip(np.searchsorted(nodes, np.log(frequency), side="right") - 1, 0, max(nodes.size - 2, 0))
        right = np.minimum(left + 1, nodes.size - 1)
        span = nodes[right] - nodes[left]
        part = np.clip((np.log(frequency) - nodes[left]) / np.where(span > 0, span, 1.0), 0.0, 1.0)
        shape = (-1, *[1] * (inner.ndim - 1))
        mass, slope = np.zeros(inner.shape, np.complex128), np.zeros(inner.shape, np.complex128)
        for column, weight in ((left, 1 - part), (right, part)):
            c = self._coefficients[:, interval, column.reshape(shape)]
            w = weight.reshape(shape)
            mass += np.where(w > 0, w * (((c[0] * d + c[1]) * d + c[2]) * d + c[3]), 0.0)
            slope += np.where(w > 0, w * ((3 * c[0] * d + 2 * c[1]) * d + c[2]), 0.0)
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

    def thinned(self, amplitudes: bool) -> MassTable | None:
        """Return the table without every second amplitude or frequency; None if fewer than three are left to omit from."""
        nodes = self.amplitude if amplitudes else self.frequency
        if nodes.size < 3:
            return None
        kept = np.unique(np.append(np.arange(0, nodes.size, 2), nodes.size - 1))
        if amplitudes:
            return MassTable(self.frequency, nodes[kept], self.mass[kept], self.is_acceleration)
        return MassTable(nodes[kept], self.amplitude, self.mass[:, kept], self.is_acceleration)


@dataclass(frozen=True, eq=False)
class Solutions:
    """Steady motions of the cavities of P dampers at L levels and F frequencies, the largest of up to S motions first.

    Attributes
    ----------
    acceleration : (L, F, S, P) complex
        Acceleration of each cavity [m/s^2]; NaN where there are fewer solutions.
    is_unstable : (L, F, S) bool
        Whether the motion lies between two folds, where a disturbance grows.
    is_below, is_above : (L, F) bool
        Whether there is also a motion below or above the amplitudes of the table.
    is_lost : (L, F) bool
        Whether a motion was not found, because the table has no masses there or the search failed.
    """

    acceleration: ComplexArray
    is_unstable: NDArray[np.bool_]
    is_below: NDArray[np.bool_]
    is_above: NDArray[np.bool_]
    is_lost: NDArray[np.bool_]


def solve(
    table: MassTable, frequency: FloatArray, gain: ComplexArray, drive: ComplexArray, levels: FloatArray
) -> Solutions:
    """Return all steady motions in the first harmonic within the table.

    Parameters
    ----------
    table
        Apparent mass of one damper.
    frequency : (F,) float
        Frequencies [Hz]; outside of the table there are no solutions.
    gain : (F, P, P) complex
        Accelerations of the cavities per unit force on each of them, without dampers [1/kg].
    drive : (F, P) complex
        Accelerations of the cavities at level 1 without dampers.
    levels : (L,) float
        Levels of the load or base motion, above zero.

    Returns
    -------
    Solutions
        The motions.

    Notes
    -----
    For one cavity, the level follows from the amplitude in closed form, L = abs(a) abs(1 + G m) / abs(a_0), so that the
    amplitudes at a given level are the roots of a function of one variable, which is searched in steps of an eighth of the
    spacing of the table. For several cavities, the branch of solutions is followed by steps of its arc length, around all
    folds (Keller 1977), from a level at which all move less than the smallest amplitude of the table until one moves more
    than the largest. Solutions that are not connected to this branch are missed.

    References
    ----------
    A. Gelb and W. E. Vander Velde (1968): Multiple-Input Describing Functions and Nonlinear System Design, McGraw-Hill.

    H. B. Keller (1977): Numerical solution of bifurcation and nonlinear eigenvalue problems. In: P. H. Rabinowitz (ed.),
    Applications of Bifurcation Theory, Academic Press, 359-384.
    """
    inside = np.flatnonzero(table.covers(frequency) & np.any(drive != 0, axis=1))
    one = drive.shape[1] == 1
    parts = (_one if one else _several)(table, frequency[inside], gain[inside], drive[inside], levels)
    shape, dampers = (levels.size, frequency.size), drive.shape[1]
    count = max([1, *(len(rows) for cell in parts.rows for rows in cell)])
    acceleration = np.full((*shape, count, dampers), np.nan, np.complex128)
    unstable = np.zeros((*shape, count), bool)
    below, above, lost = (np.zeros(shape, bool) for _ in range(3))
    below[:, inside], above[:, inside], lost[:, inside] = parts.below, parts.above, parts.lost
    for level, cells in enumerate(parts.rows):
        for place, rows in zip(inside, cells, strict=True):
            rows.sort(key=lambda row: -float(np.abs(row[0]).max()))
            for number, (motion, is_unstable) in enumerate(rows):
                acceleration[level, place, number] = motion
                unstable[level, place, number] = is_unstable
    return Solutions(acceleration, unstable, below, above, lost)


@dataclass
class _Found:
    """Solutions by level and frequency, and whether there are others outside of the table, (L, F) each."""

    rows: list[list[list[tuple[ComplexArray, bool]]]]
    below: NDArray[np.bool_]
    above: NDArray[np.bool_]
    lost: NDArray[np.bool_]

    @classmethod
    def none(cls, levels: int, frequencies: int) -> _Found:
        rows: list[Any] = [[[] for _ in range(frequencies)] for _ in range(levels)]
        return cls(rows, *(np.zeros((levels, frequencies), bool) for _ in range(3)))


# ---- one cavity


def _one(
    table: MassTable, frequency: FloatArray, gain: ComplexArray, drive: ComplexArray, levels: FloatArray
) -> _Found:
    """Return the solutions for one cavity from the level as a function of the amplitude."""
    found = _Found.none(levels.size, frequency.size)
    x = np.log(table.amplitude)
    grid = np.append((x[:-1, None] + np.diff(x)[:, None] * np.arange(_FINE) / _FINE).ravel(), x[-1])
    omega = 2 * np.pi * frequency
    offset = table.log_acceleration(omega) - np.log(np.abs(drive[:, 0]))

    def log_level(rows: NDArray[np.intp], log_amplitude: FloatArray) -> FloatArray:
        mass, _ = table.evaluate(frequency[rows], log_amplitude)
        more = (-1, *[1] * (log_amplitude.ndim - 1))
        factor = np.abs(1 + gain[rows, 0, 0].reshape(more) * mass)
        with np.errstate(divide="ignore"):
            return np.asarray(log_amplitude + offset[rows].reshape(more) + np.log(factor))

    everything = np.arange(frequency.size)
    curve = log_level(everything, np.broadcast_to(grid, (frequency.size, grid.size)))
    known = np.isfinite(curve)
    for number, level in enumerate(np.log(levels)):
        above = curve >= level
        # A level below that of the smallest amplitude belongs to a smaller one, and the other way round.
        found.below[number] = above[:, 0] & known[:, 0]
        found.above[number] = ~above[:, -1] & known[:, -1]
        for row in np.flatnonzero(~known.all(axis=1)):  # the level may be reached where runs of the map failed
            sides, numbers = above[row, known[row]], np.flatnonzero(known[row])
            hidden = (sides[1:] != sides[:-1]) & (np.diff(numbers) > 1)
            found.lost[number, row] = hidden.any() or not (known[row, 0] and known[row, -1])
        rows, cells = np.nonzero((above[:, 1:] != above[:, :-1]) & known[:, 1:] & known[:, :-1])
        low, high = grid[cells], grid[cells + 1]
        rises = above[rows, cells + 1]
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            beyond = (log_level(rows, middle) >= level) == rises
            low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
        root = 0.5 * (low + high)
        mass, _ = table.evaluate(frequency[rows], root)
        motion = levels[number] * drive[rows, 0] / (1 + gain[rows, 0, 0] * mass)
        for row, value, rising in zip(rows, motion, rises, strict=True):
            found.rows[number][row].append((np.array([value]), not rising))
    return found


# ---- several cavities


class _Branch:
    """Residual of the motions y = a / (L scale) of several cavities, with the logarithm of the level as parameter.

    A point is an array (F, 2 P + 1): real parts, imaginary parts, logarithm of the level.
    """

    def __init__(self, table: MassTable, frequency: FloatArray, gain: ComplexArray, drive: ComplexArray) -> None:
        self.table, self.frequency, self.gain = table, frequency, gain
        self.scale = np.abs(drive).max(axis=1)
        self.target = drive / self.scale[:, None]
        self.offset = np.log(self.scale) - table.log_acceleration(2 * np.pi * frequency)
        self.count = drive.shape[1]

    def motion(self, point: FloatArray) -> ComplexArray:
        return np.asarray(point[:, : self.count] + 1j * point[:, self.count : -1])

    def log_amplitudes(self, point: FloatArray, rows: NDArray[np.intp]) -> FloatArray:
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(np.abs(self.motion(point))) + point[:, -1:] + self.offset[rows, None])

    def residual(self, point: FloatArray, rows: NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
        """Return the residual, (F, 2 P), and its derivative, (F, 2 P, 2 P + 1)."""
        y, gain, p = self.motion(point), self.gain[rows], self.count
        mass, slope = self.table.evaluate(self.frequency[rows], self.log_amplitudes(point, rows))
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
        low = self.table.limits[0] - 10 * _EDGE
        mass, _ = self.table.evaluate(self.frequency, np.full((self.frequency.size, self.count), low))
        y = np.linalg.solve(np.eye(self.count) + self.gain * mass[:, None, :], self.target[..., None])[..., 0]
        level = low - np.log(np.abs(y).max(axis=1)) - self.offset
        return np.concatenate([y.real, y.imag, level[:, None]], axis=1)


def _several(
    table: MassTable, frequency: FloatArray, gain: ComplexArray, drive: ComplexArray, levels: FloatArray
) -> _Found:
    """Return the solutions for several cavities, which share the branch that begins at small levels."""
    found = _Found.none(levels.size, frequency.size)
    branch = _Branch(table, frequency, gain, drive)
    path, lost = _follow(branch)
    low, high = table.limits
    for number, level in enumerate(np.log(levels)):
        found.below[number] = path[0, :, -1] > level
        found.above[number] = ~lost & (path[-1, :, -1] < level)
        found.lost[number] = lost
        beyond = path[..., -1] >= level
        steps, rows = np.nonzero(beyond[1:] != beyond[:-1])
        begin, end = path[steps, rows], path[steps + 1, rows]
        part = (level - begin[:, -1]) / (end[:, -1] - begin[:, -1])
        points = _at_level(branch, begin + part[:, None] * (end - begin), rows, level)
        logs = branch.log_amplitudes(points, rows)
        smallest = np.where(logs < logs.max(axis=1, keepdims=True) + math.log(NEGLIGIBLE), np.inf, logs).min(axis=1)
        motion = branch.motion(points) * (branch.scale[rows] * levels[number])[:, None]
        for k, row in enumerate(rows):
            if smallest[k] < low:
                found.below[number, row] = True
            if logs[k].max() > high:
                found.above[number, row] = True
            if low <= smallest[k] and logs[k].max() <= high:
                found.rows[number][row].append((motion[k], bool(beyond[steps[k], row])))
    return found


def _at_level(branch: _Branch, point: FloatArray, rows: NDArray[np.intp], level: float) -> FloatArray:
    """Return the solutions near points, at a given logarithm of the level."""
    point = point.copy()
    point[:, -1] = level
    for _ in range(6):
        value, derivative = branch.residual(point, rows)
        change = np.linalg.solve(derivative[..., :-1], -value[..., None])[..., 0]
        small = np.linalg.norm(change, axis=1) < 0.3  # otherwise the interpolated point is better
        point[:, :-1] += np.where(small[:, None], change, 0.0)
    return point


def _follow(branch: _Branch) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the points along the branch of each frequency, (N, F, 2 P + 1), and whether it ends inside the table."""
    point = branch.start()
    path, tangent = [point.copy()], np.zeros_like(point)
    tangent[:, -1] = 1.0
    length = np.full(len(point), _LONGEST)
    end = branch.table.limits[1] + 10 * _EDGE
    lost, active = np.zeros(len(point), bool), np.arange(len(point))
    for _ in range(_MOST_STEPS):
        if not active.size:
            break
        here, along, h = point[active], tangent[active], length[active]
        ahead = here + h[:, None] * along
        accepted, new_tangent = _correct(branch, ahead, along, active)
        good = np.asarray(np.isfinite(accepted).all(axis=1) & np.isfinite(new_tangent).all(axis=1))
        good &= np.linalg.norm(np.where(good[:, None], accepted - ahead, 0.0), axis=1) < 0.5 * h
        good &= np.einsum("fi,fi->f", np.nan_to_num(new_tangent), along) > 0.9
        point[active[good]], tangent[active[good]] = accepted[good], new_tangent[good]
        length[active] = np.where(good, np.minimum(1.5 * h, _LONGEST), 0.5 * h)
        path.append(point.copy())
        lost[active] = length[active] < _SHORTEST
        beyond = branch.log_amplitudes(point[active], active).max(axis=1) > end
        active = active[~beyond & ~lost[active]]
    lost[active] = True
    return np.array(path), lost


def _correct(
    branch: _Branch, ahead: FloatArray, along: FloatArray, rows: NDArray[np.intp]
) -> tuple[FloatArray, FloatArray]:
    """Return the points of the branch nearest to predicted ones and the tangents there; NaN where there are none."""
    point = ahead.copy()
    constraint = along[:, None, :]
    unit = np.zeros(point.shape)
    unit[:, -1] = 1.0
    try:
        for _ in range(8):
            value, derivative = branch.residual(point, rows)
            matrix = np.concatenate([derivative, constraint], axis=1)
            distance = np.einsum("fi,fi->f", along, point - ahead)
            right = np.stack([-np.concatenate([value, distance[:, None]], axis=1), unit], axis=2)
            change, tangent = np.moveaxis(np.linalg.solve(matrix, right), 2, 0)
            if np.abs(value).max(initial=0.0) < 1e-9:
                break
            point += change
    except np.linalg.LinAlgError:
        return np.full_like(point, np.nan), along
    point[~(np.abs(value).max(axis=1) < 1e-6)] = np.nan
    return point, tangent / np.linalg.norm(tangent, axis=1, keepdims=True)


# ---- modes


def damping_of_modes(
    table: MassTable, stiffness: FloatArray, damping: FloatArray, shapes: FloatArray, number: int
) -> tuple[FloatArray, FloatArray]:
    """Return natural frequency and damping ratio of each mode with dampers, over the amplitude.

    Parameters
    ----------
    table
        Apparent mass of one damper.
    stiffness : (m,) float
        Squared natural frequencies of the structure [1/s^2].
    damping : (m, m) float
        Modal damping matrix D [1/s].
    shapes : (P, m) float
        Mass-normalised mode shapes at the cavities [kg^-1/2].
    number
        Number of dampers at each cavity.

    Returns
    -------
    tuple of (m, K) float
        Frequency [Hz] and damping ratio, where the cavity with the largest motion has the amplitudes of the table. NaN
        outside of the table.

    Notes
    -----
    With the masses M = I + sum of n m' s s^T over the cavities, the frequency is that of the undamped mode x,
    K x = omega^2 M x, and the damping ratio x^T (D + sum of n omega m'' s s^T) x / (2 omega x^T M x), the energy lost in
    a cycle over 4 pi times the largest kinetic energy. Both are iterated, since the masses depend on frequency and
    amplitudes.
    """
    count, amplitudes = stiffness.size, np.log(table.amplitude)
    frequency, ratio = np.full((2, count, amplitudes.size), np.nan)
    for mode in np.flatnonzero(stiffness > 0):
        omega = np.full(amplitudes.size, math.sqrt(stiffness[mode]))
        x = np.zeros((amplitudes.size, count))
        x[:, mode] = 1.0
        for _ in range(60):
            hertz = np.clip(omega / (2 * np.pi), table.frequency[0], table.frequency[-1])
            logs, outside = _cavity_amplitudes(x @ shapes.T, amplitudes)
            mass, _ = table.evaluate(hertz, logs)
            loaded = np.eye(count) + number * np.einsum("kp,pi,pj->kij", mass.real, shapes, shapes)
            squared, x, valid = _mode(stiffness, loaded, int(mode))
            before, omega = omega, np.sqrt(squared)
            if np.nanmax(np.abs(omega / before - 1), initial=0.0) < 1e-9:
                break
            omega = 0.3 * before + 0.7 * omega
        extra = -number * omega[:, None, None] * np.einsum("kp,pi,pj->kij", mass.imag, shapes, shapes)
        lost = np.einsum("ki,kij,kj->k", x, damping + extra, x)
        kinetic = np.einsum("ki,kij,kj->k", x, loaded, x)
        converged = np.abs(omega / before - 1) < 1e-6
        known = valid & converged & ~outside & table.covers(omega / (2 * np.pi))
        frequency[mode, known] = omega[known] / (2 * np.pi)
        ratio[mode, known] = (lost / (2 * omega * kinetic))[known]
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
    known = np.asarray(np.isfinite(mass).all(axis=(1, 2)))
    valid = known & (np.linalg.eigvalsh(np.where(known[:, None, None], mass, 0.0)).min(axis=1) > 0)
    root = np.linalg.cholesky(np.where(valid[:, None, None], mass, np.eye(stiffness.size)))
    inverse = np.linalg.inv(root)
    values, vectors = np.linalg.eigh(np.einsum("kia,a,kja->kij", inverse, stiffness, inverse))
    shape = np.einsum("kji,kj->ki", inverse, vectors[:, :, mode])
    return np.maximum(values[:, mode], 0.0), shape, valid
