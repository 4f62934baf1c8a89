"""Continuation of a periodic motion along a parameter."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

from rattlebox._util.progress import Report, progress_bar
from rattlebox.model.errors import Hint
from rattlebox.model.units import whole_number
from rattlebox.studies.orbits.branch import Branch
from rattlebox.studies.orbits.branch_data import LONGEST_STEP, MOST_POINTS, corrector_of, start_value
from rattlebox.studies.orbits.corrector import Point
from rattlebox.studies.orbits.find import size_of
from rattlebox.studies.orbits.follow import Follower
from rattlebox.studies.orbits.orbit import Orbit
from rattlebox.studies.orbits.shooting import ReturnMap
from rattlebox.studies.orbits.stored_branch import BranchFile, request_of
from rattlebox.studies.orbits.symmetry import stays_mirrored


def continue_orbit(
    orbit: Orbit,
    axis: str,
    limits: Sequence[Any],
    *,
    points: int = MOST_POINTS,
    step: float = LONGEST_STEP,
    store: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> Branch:
    r"""Follow a periodic motion along a parameter, through folds and where it is unstable, and locate its bifurcations.

    Parameters
    ----------
    orbit
        Periodic motion from `rattlebox.find_orbit`.
    axis
        Path of a number of the case, such as "load.frequency", "load.amplitude", "damper.gap" or "method.restitution".
    limits
        Smallest and largest value of the parameter, numbers in SI units or text.
    points
        Largest number of points in each of both directions.
    step
        Longest step, as part of the range of the parameter and of the size of the motion. Shorter steps are taken where
        the branch turns.
    store
        netCDF file (.nc) of the branch, written after every 50 points and at the end. If it exists, the continuation resumes
        from it, or the complete branch is read.
    progress
        True for a progress bar after 2 s, False for none, or a function of the number of points and of the largest number;
        the continuation stops if it returns False.

    Returns
    -------
    Branch
        Periodic motions in their order along the branch, with the special points.

    Raises
    ------
    CaseError
        If the path is not a number that changes the motion, the motion is not between the limits, or the loads have no
        common period when it varies.

    DataError
        If `store` is another file, or cannot be written.

    See Also
    --------
    find_orbit : Find the first motion.
    frequency_response : Motion that a slow sweep of the frequency reaches, for any damper.

    Notes
    -----
    With the return map :math:`P(x, p)`, the points :math:`(x, p)` with :math:`P(x, p) = x` form curves. From each point
    a step along the tangent is followed by Newton's method in the plane normal to it (pseudo-arclength continuation), so
    that the curve may turn back in :math:`p`. Special points are zeros of test functions of the derivative :math:`M` of
    the map:

    - fold: the component of the tangent along :math:`p`;
    - flip: :math:`\det(M + 1)`; for a symmetric motion, whose map covers half a period, this is the pitchfork in which it
      loses its symmetry;
    - Neimark-Sacker: :math:`\prod_{i < j} (\mu_i \mu_j - 1)` for a complex pair;
    - grazing: the smallest gap of a near miss, or the approach speed of the slowest impact. There :math:`M` is singular
      as one over that speed, and :math:`p` is extrapolated. The branch continues with the motion with one impact more
      or less that begins there, past the grazing point or back on the same side of it (`SpecialPoint.passage`);
    - sticking: bisected where bodies begin or cease to rest on each other.

    A branch ends at the limits, at a grazing point past which no motion is found, where motions without the symmetry meet
    their mirror images in a pitchfork, or after the largest number of points.

    References
    ----------
    H. B. Keller (1977), Numerical solution of bifurcation and nonlinear eigenvalue problems, in: P. H. Rabinowitz (ed.),
    Applications of Bifurcation Theory, Academic Press, 359-384.

    M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk (2008), Piecewise-smooth Dynamical Systems, Springer,
    doi:10.1007/978-1-84628-708-4.

    Examples
    --------
    With the motion `orbit` of the example of `rattlebox.find_orbit`:

    >>> import rattlebox as rb
    >>> branch = rb.continue_orbit(orbit, "load.frequency", ("32 Hz", "38 Hz"), progress=False)
    >>> [point.kind for point in branch.specials]
    ['pitchfork', 'torus']
    """
    if not isinstance(orbit, Orbit):
        raise Hint(f"orbit = {orbit!r:.60} is not a periodic motion", "orbit = rb.find_orbit(case)")
    corrector, unit = corrector_of(orbit.case, axis, limits, step)
    forcing = corrector.returns.forcing
    corrector.returns = ReturnMap(
        forcing,
        orbit.cycles,
        (axis,),
        phase=orbit.phase,
        mirrored=orbit.is_symmetric and stays_mirrored(forcing, (axis,), [corrector.limits]),
    )
    value = start_value(orbit.case, axis, corrector, unit)
    scale = size_of(corrector.returns, orbit.state)
    starts = [None if scale is None else corrector.point(orbit.state, value, scale, side) for side in (-1.0, 1.0)]
    if starts[0] is None or starts[1] is None:
        raise Hint(f"the motion cannot be computed along {axis}", "rb.find_orbit(case) at another value")
    most, down, up = whole_number(points, "points", 1), starts[0], starts[1]
    file = BranchFile(Follower(corrector), up, axis, unit, {"points": most, "step": float(step)})
    if (complete := file.resume(store, request_of(orbit, axis, corrector.limits, most, step))) is not None:
        return complete
    try:
        with progress_bar(progress, "points") as report:
            _collect(file, down, most, report)
    finally:  # also after Ctrl-C
        file.write()
    return file.branch()


def _collect(file: BranchFile, down: Point, most: int, report: Report) -> None:
    """Follow both sides of a branch; a stop leaves a side unfinished."""
    going = True

    def proceed() -> bool:
        nonlocal going
        going = report(sum(map(len, file.sides)) + 1, 2 * most) is not False
        return going

    if file.finished == 0:
        file.collect(0, most, proceed)
        file.finished = 2 if file.follower.is_closed and going else int(going)
    if file.finished == 1:
        up, file.start, file.loop = file.start, down, [] if not file.sides[1] else file.loop
        file.collect(1, most, proceed)
        file.start, file.finished = up, 2 if going else 1
