"""Curves of a special point in two parameters: limits of stability, of impacts and of rests in a plane."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import CaseError
from rattlebox._util.progress import progress_bar
from rattlebox._util.quantities import quantity
from rattlebox.model.errors import Hint
from rattlebox.model.units import whole_number
from rattlebox.studies.orbits.bisected_curve import ContactCurve, StickingCurve
from rattlebox.studies.orbits.branch import SpecialPoint
from rattlebox.studies.orbits.branch_data import LONGEST_STEP, corrector_of
from rattlebox.studies.orbits.codimension_two import names_along
from rattlebox.studies.orbits.curve import TESTS, Curve, Row, StabilityCurve, TorusCurve
from rattlebox.studies.orbits.grazing_curve import GrazingCurve

if TYPE_CHECKING:
    import xarray

_CURVES: dict[str, type[Curve]] = {
    **dict.fromkeys(TESTS, StabilityCurve),
    "torus": TorusCurve,
    "grazing": GrazingCurve,
    "impact lost": GrazingCurve,
    "sticking": StickingCurve,
}
"""Curves by the kind of their special points."""
_GAP = "the smallest gap of the motion without the impact is zero"
_EQUATIONS = {
    "fold": "a multiplier is +1",
    "flip": "a multiplier is -1",
    "pitchfork": "a multiplier of the mirrored map over half a period is -1",
    "torus": "two multipliers have the product 1",
    "grazing": _GAP,
    "impact lost": _GAP,
    "sticking": "the pressing force is zero where a rest would begin",
}


_SEPARATES = "bodies that are pressed together begin to separate for an instant, so that one contact becomes two"


def continue_point(
    point: SpecialPoint,
    axes: Sequence[str],
    limits: Sequence[Sequence[Any]],
    *,
    points: int = 200,
    step: float = LONGEST_STEP,
    progress: bool | Callable[[int, int], object] = True,
) -> xarray.Dataset:
    r"""Follow a special point in two parameters: a limit of stability, grazing, or the beginning of sticking in their plane.

    Parameters
    ----------
    point
        Special point of a branch: a fold, flip, pitchfork, Neimark-Sacker bifurcation, grazing, lost impact, or the
        beginning of sticking.
    axes
        Paths of two parameters.
    limits
        Smallest and largest value of each, a pair for each path.
    points
        Largest number of points in each of the two directions.
    step
        Longest step, as part of the ranges of the parameters and of the size of the motion.
    progress
        As for `rattlebox.continue_orbit`.

    Returns
    -------
    xarray.Dataset
        Over `point`: the values of both parameters, under their paths, the `amplitude` of the first point of the structure
        [m], `angle`, the angle of the critical multiplier [rad], NaN for grazing and sticking, and `special`, the name of
        the points nearest to a second condition, or "": "cusp", "fold-flip", "1:1 resonance" (two multipliers +1), "1:2
        resonance" (two multipliers -1), "1:3 resonance" and "1:4 resonance" (angles of 120 and 90 deg). Attributes:
        `equation`, the condition on the curve, and `ended`, why it ends between the limits.

    Raises
    ------
    CaseError
        If the point is of another kind, the paths or limits are not valid, or the point is not between the limits.

    Notes
    -----
    The equations :math:`P(x, p, q) = x` and one more are followed by pseudo-arclength continuation:

    - fold, flip, pitchfork, torus: :math:`\psi(M) = 0` with the test function :math:`\psi`, whose derivatives are central
      differences of the exact :math:`M`;
    - grazing: the smallest gap of the near miss, :math:`g(t_*) = 0` with :math:`\dot g(t_*) = 0`, and its exact
      derivatives. The motion without the contact is followed, which depends smoothly on all parameters up to the
      grazing. An impact is lost where this gap is zero, too: the same curve;
    - sticking: the force that presses two bodies together is zero at the instant at which they would come to rest. After
      chatter the motions next to this limit have no smooth derivatives; it is bisected across the curve to 1e-10 of the
      ranges.

    Examples
    --------
    With the branch of the example of `rattlebox.continue_orbit`:

    >>> import rattlebox as rb
    >>> axes, limits = ("load.frequency", "damper.gap"), [("31 Hz", "34 Hz"), ("0.8 mm", "1.2 mm")]
    >>> curve = rb.continue_point(branch.specials[0], axes, limits, points=10, progress=False)
    >>> curve.attrs["kind"]
    'pitchfork'
    """
    if not isinstance(point, SpecialPoint) or point.kind not in _CURVES:
        kind = getattr(point, "kind", point)
        raise Hint(
            f"a point of kind {kind!r:.40} is not followed in two parameters; it must be one of {', '.join(_CURVES)}",
            "a point of branch.specials of these kinds",
        )
    if isinstance(axes, str) or len(axes) != 2 or len(limits) != 2:
        raise Hint("axes must be two paths, and limits a pair for each", '("load.frequency", "damper.gap")')
    if axes[0] == axes[1]:
        raise Hint(f"axes: {axes[0]} is given twice", "two different paths")
    both = [corrector_of(point.orbit.case, axis, pair, step) for axis, pair in zip(axes, limits, strict=True)]
    curve = _curve(point, tuple(axes), [corrector.limits for corrector, _ in both], float(step))
    if not curve.is_inside(curve.start[1]):
        raise Hint("the point is not between the limits", "limits around it")
    most = whole_number(points, "points", 1)
    rows: tuple[list[Row], list[Row]] = [], []
    going = True
    with progress_bar(progress, "points") as report:

        def proceed() -> bool:
            nonlocal going
            going = going and report(sum(map(len, rows)) + 1, 2 * most) is not False
            return going

        for side, row in zip((-1.0, 1.0), rows, strict=True):
            row.extend(curve.follow(side, most, proceed))
    whole = [*rows[0][::-1], curve.start, *rows[1]]
    return _dataset(curve, whole, axes, [unit for _, unit in both], point.kind)


def _curve(point: SpecialPoint, axes: tuple[str, ...], limits: Sequence[tuple[float, float]], step: float) -> Curve:
    """Return the curve of a special point; raise if none can be followed."""
    try:
        return _CURVES[point.kind](point, axes, limits, step)
    except CaseError:
        if point.kind not in ("grazing", "impact lost"):
            raise
        curve = ContactCurve(point, axes, limits, step)
        if not curve.is_inside(curve.start[1]) or curve.has_sides():
            return curve
        raise


def _dataset(curve: Curve, row: Sequence[Row], axes: Sequence[str], units: Sequence[str], kind: str) -> xarray.Dataset:
    """Return the dataset of a curve."""
    import xarray

    values = np.array([value for _, value in row])
    data: dict[str, Any] = {
        axis: ("point", values[:, k], {"units": units[k], "long_name": axis}) for k, axis in enumerate(axes)
    }
    sizes = [next(iter(orbit.amplitudes.values()), np.nan) for orbit, _ in row]
    critical = [orbit.multipliers[np.argmin(np.abs(np.abs(orbit.multipliers) - 1))] for orbit, _ in row]
    angles = np.abs(np.angle(critical)) if kind in TESTS else np.full(len(row), np.nan)
    data["amplitude"] = "point", np.array(sizes), {"units": "m", "long_name": "amplitude"}
    data["angle"] = "point", angles, {"units": "rad", "long_name": "angle of the critical multiplier"}
    multipliers = np.array([orbit.multipliers for orbit, _ in row])
    data["special"] = "point", names_along(kind, multipliers, values / curve.width), {"long_name": "second condition"}
    ended = []
    # The side of the first point of the dataset is followed first.
    for (_, value), reason in zip((row[0], row[-1]), curve.reasons, strict=False):
        at = [f"{axis} = {quantity(float(v), unit, 6)}" for axis, v, unit in zip(axes, value, units, strict=True)]
        if reason:
            ended.append(f"at {', '.join(at)}, {reason}")
    about = {
        "study": "continue_point",
        "kind": kind,
        "equation": _SEPARATES if isinstance(curve, ContactCurve) else _EQUATIONS[kind],
        "case": curve.start[0].case.to_toml(),
        "axes": list(axes),
        "ended": "; ".join(ended),
    }
    return xarray.Dataset(data, attrs=about)
