"""Search of a periodic motion near a run or a state."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.quantities import quantity
from rattlebox.engines.simulate import require_case, simulate
from rattlebox.model.errors import Hint, several
from rattlebox.model.methods import Output
from rattlebox.model.units import whole_number
from rattlebox.results.run import Run
from rattlebox.studies.orbits.forcing import Forcing
from rattlebox.studies.orbits.motion import Motion, motion_of, strobes
from rattlebox.studies.orbits.orbit import Orbit, orbit_of
from rattlebox.studies.orbits.shooting import ReturnMap, Shot, solve
from rattlebox.studies.orbits.symmetry import is_mirrored

if TYPE_CHECKING:
    from rattlebox.model.case import Case

Vector = NDArray[np.float64]

LONGEST = 16
"""Largest number of cycles that is tried if no period is given."""
_RETURNED = 0.02
"""Difference of two states, over the size of the motion, at which it counts as repeated."""
_SEGMENTS = (1, 4)
"""Numbers of segments per cycle that are tried."""
_SYMMETRIC = 1e-6
_SHORTER = 1e-7
"""Difference, over the size of the motion, below which it repeats after a part of the period."""
_OBSERVED = 200
"""Number of cycles in which close returns are sought."""
_TRIED = 6
"""Number of close returns from which a search begins."""
_RESTING = 1e-7
"""Gap over its largest value in the motion, below which bodies may rest on each other."""
_MARGIN = 0.02
"""Smallest time from the beginning to an impact, over the period of the loads."""


def find_orbit(case: Case, near: Run | Orbit | Any = None, *, period: int | None = None) -> Orbit:
    r"""Find a periodic motion, stable or not, and compute its Floquet multipliers.

    Parameters
    ----------
    case
        Case with harmonic loads or base motions of one common period, and impact dampers or stops.
    near
        Where the search begins: a run, whose last state is used; a periodic motion; or a state, an array with displacement
        and velocity of each mode [kg^1/2 m, kg^1/2 m/s], the square root of the mass times those of an `SDOF`, then
        positions and velocities of all balls, at the phase of the loads at t = 0. Default: a run of the case, which finds
        stable motions.
    period
        Period of the motion in periods of the loads; by default the shortest one, up to 16, after which the motion at
        `near` nearly repeats.

    Returns
    -------
    Orbit
        Periodic motion with its multipliers, its impacts, its distance to grazing, and its symmetry. If the motion repeats
        earlier than after `period`, its own period.

    Raises
    ------
    CaseError
        If the case has no load, loads that are not harmonic or without a common period, or particle dampers; or if no
        periodic motion is found.

    See Also
    --------
    continue_orbit : Follow a periodic motion along a parameter.
    lyapunov : Exponents of motions that are not periodic.

    Notes
    -----
    Newton's method solves :math:`P(x) = x` for the state :math:`x` at one phase of the loads, where :math:`P` maps it over
    the period, and over several shorter parts if that fails (multiple shooting). The Jacobian
    :math:`M = \partial P / \partial x` includes the jumps at impacts (saltation). Its eigenvalues are the
    Floquet multipliers: all are inside of the unit circle if the motion is stable; it loses
    stability at +1 in a fold or pitchfork, at -1 in a flip (period doubling), and
    with a complex pair on the circle in a Neimark-Sacker bifurcation. For hard impacts with restitution :math:`e_k`

    .. math:: \det M = e^{-2 T \sum_i \zeta_i \omega_i} \prod_k e_k^2,

    which checks each motion. A motion that repeats with the opposite sign after half a period is computed over
    half a period, so that its symmetry is exact.

    References
    ----------
    M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk (2008), Piecewise-smooth Dynamical Systems, Springer,
    doi:10.1007/978-1-84628-708-4.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ...     ),
    ...     load=rb.Harmonic(amplitude="5 N", frequency="33 Hz"),
    ...     method=rb.Newton(),
    ...     duration="3 s",
    ... )
    >>> orbit = rb.find_orbit(case)
    >>> print(orbit.stability)
    stable
    """
    require_case(case)
    forcing = Forcing.of(case)
    cycles = None if period is None else whole_number(period, "period", 1)
    returns = ReturnMap(forcing, cycles or 1)
    state = _state_near(returns, near)
    if cycles is None:
        cycles = near.cycles if isinstance(near, Orbit) else _recurrence(returns, state)
    returns = returns.with_(cycles=cycles)
    found = _search(returns, state)
    if found is None and not isinstance(near, Orbit):
        found = next(filter(None, (_search(returns, each) for each in _close_returns(returns, state))), None)
    if found is None and returns.coincides(state):
        raise Hint(
            "impacts of several contacts coincide in this motion, and each changes the approach speed of the others; the "
            "motion after them depends on their order, so that it has no derivatives and multipliers",
            "in place of equal dampers one with a ball of the mass of all, which moves in the same way; gaps that differ; "
            "or method = rb.EventDriven(), whose contacts last",
        )
    if found is None and _floats(returns, state):
        raise Hint(
            f"no ball touches anything in {several(cycles, 'cycle')}: a ball that floats has no place of its own in its "
            "cavity, and no isolated periodic motion",
            "a larger load or a smaller gap; the case without dampers has this motion of the structure",
        )
    if found is None:
        raise Hint(
            f"no periodic motion of {several(cycles, 'cycle')} was found near this state; Newton's method did not converge",
            "a longer run, so that its transient has decayed; another `period`; a run at a parameter where the motion is "
            "stable, and continue_orbit from there; rb.lyapunov, to see whether the motion is chaotic",
        )
    returns, states, shot, scale = simplest(*found)
    orbit = orbit_of(returns, shot, states[0], scale)
    if orbit is None:
        raise Hint("the periodic motion cannot be simulated over its period", "rb.simulate(case), to see where")
    return orbit


def _floats(returns: ReturnMap, state: Vector) -> bool:
    """Return whether no ball touches anything in a period from a state, and there is one."""
    case = returns.forcing.case
    motion = motion_of(returns.forcing.shifted(returns.phase), state, returns.cycles * returns.forcing.period)
    return bool(case.impact_dampers) and motion is not None and len(motion.impacts.time) == 0


def state_at_zero(orbit: Orbit) -> Vector:
    """Return the state of a periodic motion at the phase of the loads at t = 0."""
    return _state_near(ReturnMap(Forcing.of(orbit.case), orbit.cycles), orbit)


def size_of(returns: ReturnMap, state: Vector, periods: int | None = None) -> Vector | None:
    """Return the largest values of the components of a motion, (n,); None if it cannot be computed."""
    cycles = periods or returns.cycles
    motion = motion_of(returns.forcing.shifted(returns.phase), state, cycles * returns.forcing.period)
    return None if motion is None else sizes_in(motion)


def sizes_in(motion: Motion) -> Vector:
    """Return the largest values of the components of the state in a motion, (n,)."""
    modes = motion.modes
    largest = np.abs(motion.state).max(axis=0)
    # A mode that is hardly excited has the size of the others, or its rounding error would count.
    for part in (slice(0, 2 * modes, 2), slice(1, 2 * modes, 2), slice(2 * modes, None)):
        if largest[part].size:
            largest[part] = np.maximum(largest[part], 1e-3 * largest[part].max())
    floor = max((float(damper.clearance) for damper in motion.dampers), default=1.0) or 1.0
    return np.where(largest > 0, largest, floor)


def _state_near(returns: ReturnMap, near: object) -> Vector:
    """Return the state at which a search begins, at the phase of the loads at t = 0."""
    case, period = returns.forcing.case, returns.forcing.period
    if near is None:
        near = simulate(case.model_copy(update={"output": Output()}), progress=False)
    if isinstance(near, Orbit):
        start, state = near.phase * period, near.state
    elif isinstance(near, Run):
        start, state = _end_of(near, LONGEST * period)
    else:
        start, state = 0.0, state_of(near)
    check_state(returns, state)
    # The state moves on to the next beginning of a period.
    wait = math.ceil(start / period - 1e-9) * period - start
    if wait > 1e-9 * period:
        motion = motion_of(returns.forcing.shifted(start / period % 1.0), state, wait)
        if motion is None:
            raise Hint("the motion from the end of the run cannot be computed", "another run, or its earlier part")
        state = motion.state[-1]
    return state


def state_of(near: object) -> Vector:
    """Return a state that is given as numbers; raise if it is none."""
    try:
        state = np.array(near, dtype=np.float64)
    except (TypeError, ValueError):
        state = np.full(1, np.nan)
    if state.ndim != 1 or not np.isfinite(state).all():
        raise Hint(
            f"near = {near!r:.60} is not a run, a periodic motion or a state",
            'a run such as rb.simulate(case), its file "out/run.nc", or a list of numbers in SI units',
        )
    return state


def check_state(returns: ReturnMap, state: Vector) -> None:
    """Raise if a state has another number of components than those of the case."""
    if state.size != returns.size:
        raise Hint(
            f"the state has {several(state.size, 'component')}; the case needs {returns.size}: displacement and velocity of "
            f"{several(returns.modes, 'mode')}, positions and velocities of {several(sum(returns.rows), 'ball')}",
            "near=rb.simulate(case)",
        )


def _end_of(run: Run, last: float) -> tuple[float, Vector]:
    """Return time and state of the last sample of a run with all contacts open, if it is within the last part [s]."""
    arrays = run.arrays
    if arrays.engine == "dem":
        raise Hint("near is a run with particles", "a run of the same impact damper")
    if not run.ok:
        raise Hint(f"near has the status {run.status}", "a run that reached its end")
    gaps = [arrays.stop_gap.min(axis=1, initial=np.inf)]
    for number, half in enumerate(0.5 * arrays.clearance[: len(arrays.dampers) - len(arrays.stops)]):
        own = (
            arrays.relative_position[:, arrays.ball_damper == number] - arrays.ball_centre[arrays.ball_damper == number]
        )
        row = np.column_stack([np.full(len(own), -half), own, np.full(len(own), half)])
        gaps.append(np.diff(row, axis=1).min(axis=1))
    open_ = np.flatnonzero(np.min(gaps, axis=0) > 0)
    k = int(open_[-1]) if open_.size else -1
    if not open_.size or arrays.time[k] < arrays.time[-1] - last:
        # The state within a hard contact is complete, as where a ball rests on a wall; that within a soft one is not.
        k = -1
        if not run.case.method.is_exact:
            raise Hint(
                f"contacts are closed at all samples of the last {quantity(last, 's', 3)} of the run, as where a ball rests "
                "on a wall, and a motion cannot start within a contact that has a duration",
                "method = rb.Newton(), with which bodies rest on each other; or more samples of the run",
                ["method"],
            )
    modal = np.stack([arrays.modal_displacement[k], arrays.modal_velocity[k]], axis=1).ravel()
    state = np.concatenate([modal, arrays.ball_position[k] - arrays.ball_centre, arrays.ball_velocity[k]])
    return float(arrays.time[k]), state


def _recurrence(returns: ReturnMap, state: Vector) -> int:
    """Return the number of cycles after which a motion nearly repeats; raise if it does not."""
    scale = size_of(returns, state, LONGEST)
    row = strobes(returns.forcing.case, state, returns.forcing.period, LONGEST)
    if scale is None or row is None:
        raise Hint("the motion from this state cannot be computed", "rb.simulate(case), to see where it stops")
    distances = np.abs((row[1:] - state) / scale).max(axis=1)
    repeated = np.flatnonzero(distances < _RETURNED)
    if repeated.size:
        return int(repeated[0]) + 1
    raise Hint(
        f"the motion does not repeat within {LONGEST} cycles: it returns to within {100 * distances.min():.2g} % of its "
        f"size, after {several(int(np.argmin(distances)) + 1, 'cycle')}, and must return to within {100 * _RETURNED:g} %",
        "a longer run, so that its transient has decayed; or period=1, for an unstable motion near it; rb.lyapunov, to see "
        "whether it is chaotic",
    )


def _close_returns(returns: ReturnMap, state: Vector) -> list[Vector]:
    """Return the states of a longer motion, one of each cycle, that nearly repeat, the closest first.

    Chaotic motion comes near to each unstable periodic motion in it from time to time.
    """
    scale = size_of(returns, state, LONGEST)
    row = strobes(returns.forcing.case, state, returns.forcing.period, _OBSERVED + returns.cycles)
    if row is None or scale is None:
        return []
    distance = np.abs((row[returns.cycles :] - row[: -returns.cycles]) / scale).max(axis=1)
    return [row[k] for k in np.argsort(distance)[:_TRIED]]


def _search(returns: ReturnMap, state: Vector) -> tuple[ReturnMap, Vector, Shot, Vector] | None:
    """Return the fixed point near a state: map, states, motion and size; None if none is found."""
    returns, state = away_from_impacts(returns, state)
    scale = size_of(returns, state)
    if scale is None:
        return None
    for per_cycle in _SEGMENTS:
        segments = 1 if per_cycle == 1 else per_cycle * returns.cycles
        divided = returns.with_(segments=segments)
        found = solve(divided, divided.states_from(state), scale)
        if found is not None:
            # The section of the converged motion, whose impacts are elsewhere than those of the first guess.
            one, moved = away_from_impacts(returns, found[0][0])
            size = size_of(one, moved)
            again = None if size is None else solve(one, moved[None], size)
            if again is not None and size is not None:
                return one, *again, size
            return divided, *found, scale
    return None


def away_from_impacts(returns: ReturnMap, state: Vector) -> tuple[ReturnMap, Vector]:
    """Return the map that begins with all contacts open and no impact near, and the state there."""
    period = returns.forcing.period
    motion = motion_of(returns.forcing.shifted(returns.phase), state, returns.cycles * period)
    if motion is None or not motion.impacts.time.size:
        return returns, state
    begins = motion.impacts.time
    ends = begins + np.nan_to_num(motion.impacts.duration)
    length = returns.cycles * period
    near = np.minimum(begins, length - ends).min() < _MARGIN * period
    gap, _ = motion.gaps()
    # Bodies that rest on each other have a gap of the size of rounding errors.
    is_open = (gap > _RESTING * np.abs(gap).max(axis=0) * motion.sticks).all(axis=1)
    if not near and is_open[0]:
        return returns, state
    # The middle of the longest flight of all bodies.
    edges = np.concatenate([[0.0], ends, [length]]), np.concatenate([begins, [length]])
    free = edges[1] - edges[0][:-1]
    k = int(np.argmax(free))
    middle = 0.5 * (edges[0][k] + edges[1][k])
    if motion.sticks and is_open.any():  # a rest follows the last impact
        changes = np.flatnonzero(np.diff(np.concatenate([[False], is_open, [False]]).astype(int)))
        first, last = changes[::2], changes[1::2] - 1
        k = int(np.argmax(motion.time[last] - motion.time[first]))
        middle = 0.5 * (motion.time[first[k]] + motion.time[last[k]])
    there = motion_of(returns.forcing.shifted(returns.phase), state, middle)
    if there is None or there.state[-1].shape != state.shape:
        return returns, state
    return returns.with_(phase=(returns.phase + middle / period) % 1.0), there.state[-1]


def simplest(returns: ReturnMap, states: Vector, shot: Shot, scale: Vector) -> tuple[ReturnMap, Vector, Shot, Vector]:
    """Return the fixed point over its own period, and mirrored over half of it if the motion is symmetric."""
    for divisor in range(returns.cycles, 1, -1):
        if returns.cycles % divisor:
            continue
        shorter = returns.with_(cycles=returns.cycles // divisor, segments=1)
        if _is_fixed(shorter, states[0], scale, _SHORTER) and (found := solve(shorter, states[:1], scale)) is not None:
            returns, (states, shot) = shorter, found
            break
    if returns.cycles % 2 and is_mirrored(returns.forcing):
        half = returns.with_(mirrored=True, segments=1)
        if _is_fixed(half, states[0], scale, _SYMMETRIC) and (found := solve(half, states[:1], scale)) is not None:
            return half, *found, scale
    return returns, states, shot, scale


def _is_fixed(returns: ReturnMap, state: Vector, scale: Vector, tolerance: float) -> bool:
    """Return whether a state is a fixed point of a map within a tolerance."""
    shot = returns.shoot(state[None], derivatives=False)
    return shot.is_complete and bool(np.abs(shot.residual / scale).max() < tolerance)
