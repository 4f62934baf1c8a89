"""Stops: one-sided contacts with a gap between a point of the structure and the ground, or between two points."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from rattlebox._util.quantities import amount

from .base import Part
from .contacts import AnyContact
from .elementwise import Vector, inverse, total
from .errors import Hint, several
from .materials import AnyMaterial, AnyWall
from .pairs import Body, Pair
from .space import Direction
from .units import Length, PositiveLength

if TYPE_CHECKING:
    from .modes import ModalModel


def refuse_stops(stops: tuple[Stop, ...], what: str, advice: str) -> None:
    """Raise if there are stops, for a computation that does not know them."""
    if stops:
        raise Hint(f"{what}, but the case has {several(len(stops), 'stop')}", advice, ["stops"])


_STILL = 1e-12
"""Relative motion of two points over their motions, up to which it counts as rounding error."""


class Stop(Part):
    r"""Stop: a contact with a gap between a point of the structure and the ground, or between two points (pounding).

    Other names are bumper, snubber, end stop and motion limiter. The ground moves with the base. A point may have several
    stops; a case may have stops and impact dampers.

    Parameters
    ----------
    gap
        Distance at rest, when all displacements are zero [m]; 0 for a point that lies against its stop.
    contact
        Contact law.
    point
        Point of the structure, which may be that of a tuned mass; needed if there are several.
    other
        Point that it meets; default the ground.
    side
        Where the ground or the other point is: "leading" (in positive direction), "trailing", or "both" for a stop on each
        side with the same gap.
    direction
        Direction of the contact, if the points move in 3-D.
    radius
        Radius of the surface of the stop [m], for a law that follows from sizes and materials, such as `Tsuji`.
    material
        Material of the stop, a name in the library or a Material, for such a law.
    wall
        Material of the flat surface that it meets, or "rigid"; default that of the stop.
    name
        Name in results and messages; default "stop", "stop2", ... With `side="both"` "leading" and "trailing" are added.

    Notes
    -----
    With the displacements :math:`z` of the point and :math:`z_o` of the other point, zero for the ground, the gap and the
    force on the point are

    .. math:: g = g_0 \mp (z - z_o), \qquad F = \mp N(-g, -\dot g) \le 0 \text{ or } \ge 0

    for a stop on the leading (upper sign) or the trailing side, with the force :math:`N` of the contact law; :math:`-F` acts
    on the other point. The effective mass of the contact is

    .. math:: m^* = \frac{1}{\sum_k (\phi_k - \phi_{o,k})^2}

    with the mass-normalised mode shapes :math:`\phi`. The restitution of a contact law is that of a free impact of this
    mass.

    References
    ----------
    S. W. Shaw, P. J. Holmes, J. Sound Vib. 90 (1983) 129, doi:10.1016/0022-460X(83)90407-8 (impact oscillator).

    S. A. Anagnostopoulos, Earthquake Eng. Struct. Dyn. 16 (1988) 443, doi:10.1002/eqe.4290160311 (pounding of buildings).

    Examples
    --------
    >>> import rattlebox as rb
    >>> structure = rb.SDOF(mass="2 kg", frequency="5 Hz", damping_ratio=0.01, velocity="0.2 m/s")
    >>> stop = rb.Stop(gap="3 mm", contact=rb.Linear(stiffness="1 MN/m", restitution=0.6))
    >>> run = rb.simulate(rb.Case(structure=structure, stop=stop, duration="0.5 s"))
    >>> print(f"{1e3 * run.arrays.impacts.time[0]:.1f} ms")
    15.7 ms
    """

    field_names: ClassVar[tuple[str, ...]] = ("stop", "stops")
    kind: Literal["stop"] = "stop"
    name: str = ""
    point: str | None = None
    other: str | None = None
    side: Literal["leading", "trailing", "both"] = "leading"
    direction: Direction | None = None
    gap: Length
    contact: AnyContact
    radius: PositiveLength | None = None
    material: AnyMaterial | None = None
    wall: AnyWall | None = None

    @model_validator(mode="after")
    def _no_preload(self) -> Stop:
        if self.gap < 0:
            raise Hint(
                f"{1e3 * self.gap:.4g} mm is negative: a stop that presses at rest is not computed; a gap must be >= 0",
                "gap = 0, and a load that presses the point against the stop",
                ["gap"],
            )
        return self

    @property
    def sign(self) -> float:
        """1 for a stop on the leading side, -1 on the trailing side."""
        return -1.0 if self.side == "trailing" else 1.0

    def label(self, index: int) -> str:
        """Return the name of the stop; by default it has the number of the stop in the case."""
        return self.name or ("stop" if index == 0 else f"stop{index + 1}")

    def each(self, index: int) -> tuple[Stop, ...]:
        """Return the stops on single sides that this one stands for, with their names."""
        name = self.label(index)
        if self.side != "both":
            return (self.model_copy(update={"name": name}),)
        return tuple(
            self.model_copy(update={"name": f"{name} {side}", "side": side}) for side in ("leading", "trailing")
        )

    def shape(self, modes: ModalModel) -> Vector:
        """Return the mode shapes of the point relative to the other point, (m,) [kg^-1/2]."""
        own = modes.shape(self.point, self.direction)
        return own if self.other is None else own - modes.shape(modes.point(self.other, "other"), self.direction)

    def pair(self, modes: ModalModel) -> Pair:
        """Return the pair of bodies: the point, with the effective mass of the relative motion, and the stop."""
        wall = self.material if self.wall is None else self.wall
        radius = math.inf if self.radius is None else self.radius
        return Pair(
            Body(None if isinstance(wall, str) else wall, mass=inverse(total(self.shape(modes) ** 2))),
            Body(self.material, radius),
        )

    @property
    def is_sized(self) -> bool:
        """Whether the laws of spheres can be computed from radius and material."""
        return self.radius is not None and self.material is not None

    def check(self, modes: ModalModel) -> None:
        """Raise if the point does not move relative to the stop, or starts inside it."""
        shape = self.shape(modes)
        own = modes.shape(self.point, self.direction)
        if not np.abs(shape).max(initial=0.0) > _STILL * np.abs(own).max(initial=0.0):
            where = "the ground" if self.other is None else f"the point {self.other!r}"
            raise Hint(f"the point {modes.point(self.point)!r} does not move relative to {where}", "another point")
        start = float(shape @ modes.q0)
        for stop in self.each(0):
            depth = stop.sign * start - self.gap
            if depth > 1e-14 * (self.gap + float(np.abs(shape * modes.q0).sum())):
                raise Hint(
                    f"the point would start {1e3 * depth:.4g} mm inside the stop",
                    f'gap = "{1e3 * (self.gap + depth):.6g} mm" or more, or a smaller displacement at the start',
                    ["gap"],
                )

    def words(self) -> str:
        """Return a phrase about the stop."""
        sides = "a stop on each side" if self.side == "both" else "a stop"
        return f"{sides} at {amount(self.gap, 'm')}"

    def facts(self, modes: Any) -> list[tuple[str, str]]:
        """Return numbers that follow from the fields and the structure, with their names."""
        return [("effective mass of the contact", amount(float(self.pair(modes).mass), "kg"))]
