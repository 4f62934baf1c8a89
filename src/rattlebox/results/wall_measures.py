"""Mean pressure and wear of the walls of cavities with particles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import Hint

if TYPE_CHECKING:
    from .record import Record


def _over_area_and_time(run: Record, name: str) -> dict[str, float]:
    """Return the growth of a sum of each wall from the first to the last sample, over its area and the time."""
    arrays = run.arrays
    if not arrays.walls:
        raise Hint(
            "the walls of this run were not recorded"
            if arrays.engine == "dem"
            else "a 1-D run has no faces of a cavity; its impacts are in run.impacts",
            "output = rb.Output(walls=True)" if arrays.engine == "dem" else "a ParticleDamper",
        )
    sums: NDArray[np.float64] = getattr(arrays, name)
    with np.errstate(invalid="ignore"):  # NaN where a body is inside of another one and has no area
        rates = (sums[-1] - sums[0]) / arrays.wall_area / float(arrays.time[-1] - arrays.time[0])
    return dict(zip(arrays.walls, rates.tolist(), strict=True))


def wall_pressures(run: Record) -> dict[str, float]:
    """Compute the mean normal pressure on each wall.

    Parameters
    ----------
    run
        Run of a case with `output = rb.Output(walls=True)`.

    Returns
    -------
    dict of str to float
        Mean pressure by wall [Pa].

    Raises
    ------
    CaseError
        If the walls were not recorded.

    Notes
    -----
    The sum of the normal impulses of all contacts from the first to the last sample, over area and time. It contains every
    contact, also those between two samples.

    Examples
    --------
    >>> import rattlebox as rb
    >>> damper = rb.ParticleDamper(
    ...     particles=rb.Particles(material="steel", diameter="4 mm", count=60),
    ...     cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
    ...     contact=rb.Tsuji(restitution=0.5),
    ...     walls={name: "frictionless" for name in ("-x", "+x", "-y", "+y")},
    ...     packing=rb.Settled(seed=1),
    ...     softening=100,
    ... )
    >>> output = rb.Output(rate="1 kHz", walls=True)
    >>> run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration="0.1 s", output=output))
    >>> weight = run.arrays.particle_mass[0] * 9.81
    >>> round(float(rb.analysis.wall_pressures(run)["-z"] * 0.02**2 / weight), 2)
    1.0
    """
    return _over_area_and_time(run, "wall_normal_impulse")


def wall_wear(run: Record) -> dict[str, float]:
    """Compute the energy that friction loses at each wall, over its area and the time.

    Parameters
    ----------
    run
        Run of a case with `output = rb.Output(walls=True)`.

    Returns
    -------
    dict of str to float
        Power of friction over the area by wall [W/m^2].

    Raises
    ------
    CaseError
        If the walls were not recorded.

    Notes
    -----
    In Archard's law the depth of wear is proportional to this number: with the coefficient k and the hardness H the depth
    grows by k / (mu H) times it, where mu is the coefficient of friction.

    References
    ----------
    J. F. Archard, J. Appl. Phys. 24 (1953) 981, doi:10.1063/1.1721448.

    Examples
    --------
    >>> import rattlebox as rb
    >>> damper = rb.ParticleDamper(
    ...     particles=rb.Particles(material="steel", diameter="4 mm", count=60),
    ...     cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
    ...     contact=rb.Tsuji(restitution=0.5),
    ...     friction=0.3,
    ...     walls={"+z": "frictionless"},
    ...     packing=rb.Settled(seed=1),
    ...     softening=100,
    ... )
    >>> shaker = rb.Shaker(motion=rb.Harmonic(amplitude="40 m/s^2", frequency="40 Hz", direction="x"))
    >>> run = rb.simulate(
    ...     rb.Case(structure=shaker, damper=damper, duration="0.1 s", output=rb.Output(rate="1 kHz", walls=True))
    ... )
    >>> wear = rb.analysis.wall_wear(run)
    >>> wear["-z"] > wear["+z"] == 0
    True
    """
    return _over_area_and_time(run, "wall_sliding_loss")
