"""All Lyapunov exponents of a motion, from the derivatives of its state."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.batch_means import mean_interval, smooth_weights
from rattlebox._util.quantities import amount
from rattlebox.engines.transition import REFUSALS, Flow
from rattlebox.model.errors import Hint
from rattlebox.studies.orbits.forcing import Forcing
from rattlebox.studies.orbits.orbit import Orbit
from rattlebox.studies.run.study import whole_cycles

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case

Array = NDArray[np.float64]

_GOLDEN_RATIO = 0.6180339887498949
_ATTEMPTS = 12
"""Times, shifted by parts of a cycle, that are tried as the end of a step."""
_ALIGNMENT = 20
"""Periods in which the frame turns into the directions of the growth."""
_STATES = frozenset(REFUSALS.values())
_MOST_LEFT_OUT = 0.01


def lyapunov_spectrum(near: Case | Orbit, *, cycles: tuple[int, int] = (200, 500)) -> xarray.Dataset:
    r"""Compute all Lyapunov exponents of a motion under harmonic loads.

    Parameters
    ----------
    near
        Case with harmonic loads of a common period and impact dampers or stops, whose motion starts at its initial state;
        or a periodic motion of `find_orbit`, on which the motion starts.
    cycles
        Numbers of periods of the loads to skip until the motion is steady, and to evaluate.

    Returns
    -------
    xarray.Dataset
        Over `number`, from the largest exponent down: `exponent` [1/s] and `exponent_interval` [1/s], half of the width of
        its 95 % interval (NaN for regular motion, or if the cycles are too few); `growth_per_cycle`, the exponent times the
        period; for a periodic motion it is the logarithm of the absolute value of a Floquet multiplier, over its cycles.
        Without dimensions: `sum` [1/s] of the exponents, the rate at which volumes of states shrink; `dimension`, that of
        the attractor by Kaplan and Yorke. `attrs["left_out"]` is the share of the time in which the derivative does not
        exist, as at a grazing impact, which the means leave out; `attrs["too_short"]` how many exponents have no interval.

    Raises
    ------
    CaseError
        If the loads have no common period, the case has particle dampers, or the motion cannot be computed.

    Warns
    -----
    UserWarning
        If more than 1 % of the time is left out.

    Notes
    -----
    The derivative :math:`M_k` of the state after a cycle with respect to the state before it, with the jumps at impacts,
    acts on an orthogonal frame, which is made orthogonal again after each cycle,

    .. math:: M_k Q_{k-1} = Q_k R_k, \qquad \lambda_i = \frac{\sum_k w_k \ln |R_{k, ii}|}{T \sum_k w_k},

    with the weights :math:`w = e^{-1 / (s (1 - s))}` of the place :math:`0 < s < 1` of the cycle in the motion. Before
    the evaluated cycles, 20 more turn the frame into the directions of the growth. For hard impacts, :math:`n` in the time
    :math:`t` with restitution :math:`e`, the sum of the exponents is
    :math:`-2 \sum_i \zeta_i \omega_i + \frac{2 n}{t} \ln e` on average. With the largest :math:`j` for which
    :math:`\lambda_1 + \dots + \lambda_j \ge 0` the dimension is
    :math:`j + (\lambda_1 + \dots + \lambda_j) / |\lambda_{j+1}|`.

    References
    ----------
    G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn (1980), Lyapunov characteristic exponents for smooth dynamical
    systems and for Hamiltonian systems, Meccanica 15, 9-20 and 21-30, doi:10.1007/BF02128236 and doi:10.1007/BF02128237.
    P. C. Müller (1995), Calculation of Lyapunov exponents for dynamic systems with discontinuities, Chaos, Solitons &
    Fractals 5, 1671-1681, doi:10.1016/0960-0779(94)00170-U.
    J. L. Kaplan, J. A. Yorke (1979), Chaotic behavior of multidimensional difference equations, Lecture Notes in
    Mathematics 730, 204-227, doi:10.1007/BFb0064319.

    See Also
    --------
    lyapunov : The largest exponent over the axes of a sweep, by pairs of neighbouring motions.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ...     ),
    ...     method=rb.Newton(),
    ...     duration="1 s",
    ... )
    >>> rb.lyapunov_spectrum(case, cycles=(50, 100)).sizes["number"]
    2
    """
    case = near.as_case() if isinstance(near, Orbit) else near
    skip, count = whole_cycles(cycles)
    forcing = Forcing.of(case)
    growth, lengths, left_out = _growth(case, forcing.period, skip, count)
    weights = smooth_weights((np.cumsum(lengths) - 0.5 * lengths) / lengths.sum())
    with np.errstate(invalid="ignore"):  # -inf times a weight of 0
        means = weights @ growth / (weights @ lengths)
    exponents = np.where(np.isinf(growth).any(axis=0), -np.inf, means)
    order = np.argsort(-exponents, kind="stable")
    growth, exponents = growth[:, order], exponents[order]
    if left_out > _MOST_LEFT_OUT:
        warnings.warn(
            f"in {100 * left_out:.2g} % of the time the derivative of the motion does not exist (grazing or simultaneous "
            "impacts, or contacts that are closed), and the exponents leave it out; rb.lyapunov includes it",
            UserWarning,
            stacklevel=2,
        )
    return _dataset(exponents, growth / lengths[:, None], forcing.period, left_out, (skip, count))


def _growth(case: Case, period: float, skip: int, count: int) -> tuple[Array, Array, float]:
    """Return the logarithmic growth along each direction in each step, their lengths [s], and the share left out."""
    flow = Flow.of(case)
    state, time = None, 0.0
    if skip:
        state, time = _opened(flow, None, 0.0, skip * period, period)
    frame, rows, lengths, lost = np.eye(len(flow.names)), list[Array](), list[float](), 0.0
    first, last = (skip + _ALIGNMENT) * period, (skip + _ALIGNMENT + count) * period
    while last - time > 1e-6 * period:
        length = (math.floor(time / period + 1e-6) + 1) * period - time
        for attempt in range(_ATTEMPTS):
            end = flow.over(state, time, length + attempt * _GOLDEN_RATIO % 1 * period)
            if end.ok and not end.is_closed:
                frame, factor = np.linalg.qr(end.matrix @ frame)
                if time > first - 1e-6 * period:
                    with np.errstate(divide="ignore"):  # a direction that is lost at a contact
                        rows.append(np.log(np.abs(np.diag(factor))))
                    lengths.append(float(end.time[-1]) - time)
                state, time = end.state, float(end.time[-1])
                break
            if not end.ok and end.status not in _STATES:
                raise _stopped(end.status, time)
        else:
            before = time
            state, time = _opened(flow, state, time, length, period)
            lost += time - before if before > first - 1e-6 * period else 0.0
    if not rows:
        raise Hint(
            "the derivative of the motion does not exist in any cycle: contacts are closed, graze or coincide at all times",
            "rb.lyapunov, which compares neighbouring motions",
        )
    return np.array(rows), np.array(lengths), lost / (time - first)


def _opened(flow: Flow, state: Array | None, time: float, length: float, period: float) -> tuple[Array, float]:
    """Return the state after a length of time, or later within a cycle at a time when all contacts are open."""
    for attempt in range(_ATTEMPTS):
        end = flow.over(state, time, length + attempt * _GOLDEN_RATIO % 1 * period, derivatives=False)
        if not end.ok:
            raise _stopped(end.status, time)
        if not end.is_closed:
            return end.state, float(end.time[-1])
    raise Hint(
        f"a contact is closed at all times that were tried in the cycle from {amount(time + length, 's', 6)}",
        "rb.lyapunov, which compares neighbouring motions",
    )


def _stopped(status: str, time: float) -> Hint:
    return Hint(f"the motion from {amount(time, 's', 6)} ends as {status!r}", "rb.simulate(case), to see where and why")


def _dataset(exponents: Array, rates: Array, period: float, left_out: float, cycles: tuple[int, int]) -> xarray.Dataset:
    """Return the exponents with their intervals, their sum and the dimension."""
    import xarray

    def over(values: Any, units: str, text: str, *dims: str) -> Any:
        return dims, values, {"units": units, "long_name": text}

    half = [mean_interval(each).half_width if np.isfinite(each).all() else np.nan for each in rates.T]
    lacking = int(np.isnan(half).sum())
    too_short = {
        "too_short": f"no 95 % interval of {lacking} of {len(half)} exponents: the motion is regular, or its growth varies "
        "too slowly for the evaluated cycles; try: more cycles to evaluate"
    }
    each = "number"
    return xarray.Dataset(
        {
            "exponent": over(exponents, "1/s", "Lyapunov exponent", each),
            "exponent_interval": over(half, "1/s", "half of the width of the 95 % interval of the exponent", each),
            "growth_per_cycle": over(exponents * period, "1", "logarithmic growth in a period of the loads", each),
            "sum": over(exponents.sum(), "1/s", "sum of the exponents"),
            "dimension": over(_dimension(exponents), "1", "dimension of the attractor by Kaplan and Yorke"),
        },
        coords={"number": over(np.arange(1, exponents.size + 1), "1", "number of the exponent", each)},
        attrs={"title": "Lyapunov exponents", "left_out": left_out, "cycles": list(cycles)}
        | (too_short if lacking else {}),
    )


def _dimension(exponents: Array) -> float:
    """Return the Kaplan-Yorke dimension of an attractor with these exponents, the largest first."""
    sums = np.cumsum(exponents)
    positive = np.flatnonzero(sums >= 0)
    if not positive.size:
        return 0.0
    last = int(positive[-1])
    if last + 1 == exponents.size:
        return float(exponents.size)
    return last + 1 + float(sums[last] / -exponents[last + 1])
