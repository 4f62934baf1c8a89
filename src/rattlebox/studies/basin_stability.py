"""The share of random starts that lead to a periodic motion, with its binomial interval."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rattlebox._util.exceptions import CaseError
from rattlebox.model.errors import Hint
from rattlebox.model.paths import get
from rattlebox.model.units import whole_number
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.grid.sampling import random_design
from rattlebox.studies.kinds.basins import basins
from rattlebox.studies.orbits.orbit import Orbit


@dataclass(frozen=True)
class BasinStability:
    """Share of random starts that lead to a periodic motion, from `rattlebox.basin_stability`.

    Attributes
    ----------
    share : float
        Share of the starts.
    lower, upper : float
        95 % confidence interval of the share.
    returned, count : int
        Number of starts that lead to the motion, and of all.
    unsettled : int
        Number of starts whose motion still contracted towards a periodic one, or did not finish. They count as not
        returned.

    Examples
    --------
    >>> from rattlebox.studies.basin_stability import BasinStability
    >>> print(BasinStability(0.5, 0.4, 0.6, 50, 100, 0))
    50 of 100 starts lead to the motion: 50 %, 95 % interval 40 to 60 %
    """

    share: float
    lower: float
    upper: float
    returned: int
    count: int
    unsettled: int

    def __str__(self) -> str:
        words = (
            f"{self.returned} of {self.count} starts lead to the motion: {100 * self.share:.3g} %, 95 % interval "
            f"{100 * self.lower:.3g} to {100 * self.upper:.3g} %"
        )
        if self.unsettled:
            words += f"; {self.unsettled} had not settled and count as not returned"
        return words


def basin_stability(
    orbit: Orbit,
    region: Mapping[str, object],
    count: int = 500,
    *,
    seed: int = 0,
    cycles: tuple[int, int] = (400, 48),
    **options: Any,
) -> BasinStability:
    r"""Estimate the probability that a random start in a region leads to a periodic motion.

    Parameters
    ----------
    orbit
        Stable periodic motion, from `find_orbit` or `continue_orbit`.
    region
        By path of an initial value, as for `basins`: smallest and largest value. Other initial values are those of the
        motion.
    count
        Number of independent, evenly distributed starts.
    seed
        Random seed.
    cycles
        Numbers of cycles to skip until motions are steady, and to evaluate.
    **options
        Further options of `basins`, such as `apart` or `workers`.

    Returns
    -------
    BasinStability
        Share of the starts that lead to the motion, with its interval.

    Raises
    ------
    CaseError
        If the motion is not stable, or a path or option is not valid.

    Notes
    -----
    With :math:`k` of :math:`n` independent starts, the interval is that of Clopper and Pearson, which contains the
    probability in at least 95 % of all repetitions:

    .. math:: B^{-1}(0.025;\, k,\, n - k + 1) \le p \le B^{-1}(0.975;\, k + 1,\, n - k)

    with the quantiles :math:`B^{-1}` of the beta distribution.

    References
    ----------
    P. J. Menck, J. Heitzig, N. Marwan, J. Kurths (2013), How basin stability complements the linear-stability paradigm,
    Nature Physics 9, 89-92, doi:10.1038/nphys2516.
    C. J. Clopper, E. S. Pearson (1934), The use of confidence or fiducial limits illustrated in the case of the binomial,
    Biometrika 26, 404-413, doi:10.1093/biomet/26.4.404.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ...     ),
    ...     method=rb.Newton(),
    ...     duration="3 s",
    ... )
    >>> region = {"damper.start": (-1, 1), "damper.velocity": ("-0.1 m/s", "0.1 m/s")}
    >>> stability = rb.basin_stability(rb.find_orbit(case), region, 64, cycles=(50, 8), progress=False)
    >>> stability.count
    64
    """
    number = whole_number(count, "count", 1)
    if not orbit.is_stable:
        raise Hint(
            f"the motion is {orbit.stability}; only stable motions have a basin", "a stable branch of the motion"
        )
    case = orbit.as_case()
    try:
        columns = read_axes(case, random_design(region, number, method="random", seed=seed), source="region").columns
    except Hint as hint:
        raise CaseError(f"region: {hint}") from None
    # The motion itself is one more start, whose attractor is the one in question.
    starts = {path: [*values.ravel().tolist(), get(case, path)] for path, values in columns.items()}
    found = basins(case, {"start": starts}, cycles=cycles, **options)
    label = found.attractor.values
    if label[-1] < 1:
        raise Hint(
            f"the motion itself does not repeat within {cycles[1]} cycles after {cycles[0]}",
            "more cycles to skip or to evaluate, or a larger tolerance",
        )
    returned, unsettled = int(np.sum(label[:-1] == label[-1])), int(np.sum(label[:-1] < 0))
    return BasinStability(returned / number, *_interval(returned, number), returned, number, unsettled)


def _interval(hits: int, count: int) -> tuple[float, float]:
    """Return the 95 % interval of a probability by Clopper and Pearson."""
    from scipy.stats import beta

    lower = float(beta.ppf(0.025, hits, count - hits + 1)) if hits else 0.0
    upper = float(beta.ppf(0.975, hits + 1, count - hits)) if hits < count else 1.0
    return lower, upper
