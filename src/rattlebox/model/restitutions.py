"""Restitution laws e(V); their formulas are in core/contact/restitution, one file each."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from rattlebox._util.narrow import present

from .also_accepts import AlsoAccepts
from .base import Part
from .elementwise import less, pick, power, sqrt
from .errors import Hint
from .kinds import AnyKind
from .materials import AnyWall
from .pairs import Pair, hardness
from .units import SI, Modulus, PositiveVelocity, bare_number, plain

Coefficients = tuple[str, dict[str, Any]]
_fraction = WithJsonSchema({"type": "number", "minimum": 0, "maximum": 1})


def _restitution(value: object) -> float:
    try:
        number = float(plain(value))
    except (TypeError, ValueError, OverflowError):
        raise Hint("a number from 0 to 1 is needed", "0.8") from None
    if not 0 <= number <= 1:
        raise Hint(
            "restitution is between 0 (no rebound) and 1 (no loss); above 1 an impact would create energy", "0.8"
        )
    return number


Fraction = Annotated[float, BeforeValidator(_restitution), _fraction]


class Restitution(Part):
    """Base class of restitution laws.

    Parameters
    ----------
    maximum
        Upper limit of the restitution.
    """

    field_names: ClassVar[tuple[str, ...]] = ("restitution",)
    kinds: ClassVar[dict[str, type[Part]]] = {}
    kind: str
    maximum: Fraction = 1.0

    @property
    def constant_value(self) -> float | None:
        """Restitution at every speed; None if it depends on the speed."""
        return None

    @property
    def last_speed(self) -> float | None:
        """Last speed of a table [m/s], above which its last value is used; None if there is none."""
        return None

    @abstractmethod
    def coefficients(self, pair: Pair) -> Coefficients:
        """Return the name of the law in the core and its coefficients for a pair of bodies, in SI units."""


class Constant(Restitution):
    r"""Constant restitution (Newton's law of restitution).

    Parameters
    ----------
    e
        Rebound speed over approach speed.

    Notes
    -----
    .. math:: V' = e V

    with the approach speed :math:`V` and the rebound speed :math:`V'`.

    References
    ----------
    B. Brogliato (2016), Nonsmooth Mechanics, 3rd ed., Springer, doi:10.1007/978-3-319-28664-8.
    """

    positional: ClassVar[tuple[str, ...]] = ("e",)
    kind: Literal["constant"] = "constant"
    e: Fraction = Field(examples=[0.8])

    if TYPE_CHECKING:  # The first field is also a positional argument.

        def __init__(self, e: object = ..., **values: Any) -> None: ...

    @property
    def constant_value(self) -> float | None:
        """Restitution at every speed."""
        return self.e

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return e."""
        return "constant", {"e": self.e, "maximum": self.maximum}


class Tabulated(Restitution):
    r"""Restitution from a table, linear in the speed between points and constant outside them.

    Parameters
    ----------
    speeds
        Strictly increasing approach speeds [m/s].
    values
        Restitution at each of them.

    Notes
    -----
    .. math:: e = e_k + (e_{k+1} - e_k) \frac{V - V_k}{V_{k+1} - V_k}, \qquad V_k \le V < V_{k+1}

    and the first value below :math:`V_1`, the last value above the last speed.
    """

    elementwise: ClassVar[bool] = False
    kind: Literal["table"] = "table"
    speeds: tuple[PositiveVelocity, ...] = Field(examples=[["0.1 m/s", "1 m/s"]])
    values: tuple[Fraction, ...] = Field(examples=[[0.9, 0.8]])

    @model_validator(mode="after")
    def _validate(self) -> Tabulated:
        if len(self.speeds) != len(self.values) or not self.speeds:
            raise Hint(f"{len(self.speeds)} speeds, but {len(self.values)} values", "as many of both, at least one")
        if any(b <= a for a, b in zip(self.speeds, self.speeds[1:], strict=False)):
            raise Hint("speeds must increase", "points in the order of the speed", ["speeds"])
        return self

    @property
    def last_speed(self) -> float | None:
        """Last speed of the table [m/s]; None for a single value."""
        return self.speeds[-1] if len(self.speeds) > 1 else None

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return the table."""
        return "table", {"speeds": self.speeds, "values": self.values, "maximum": self.maximum}


class JacksonGreen(Restitution):
    r"""Restitution of elasto-plastic impacts by Jackson, Green and Marghitu, from yield stress and elastic constants.

    Parameters
    ----------
    wall
        Wall for the critical speed: a material, or "rigid"; default the wall of the damper.
    yield_stress
        Yield stress [Pa] of the body with the lower Poisson's ratio, or of the softer one of two with the same ratio;
        default that of the materials.
    extrapolate
        Whether the law is used above 1000 critical speeds; a run counts these impacts.

    Notes
    -----
    With the approach speed over the critical speed, :math:`w = V / V_c`, the law is a fit to finite-element results:

    .. math::

        e &= 1, & w &< 1 \\
        e &= 1 - 0.1 \ln w \left(\frac{w - 1}{59}\right)^{0.156}, & 1 \le w &< 60 \\
        e &= 1 - 0.1 \ln 60 - 0.11 \ln\frac{w}{60}\, (w - 60)^{2.36 \varepsilon_y}, & 60 \le w &\le 1000

    :math:`\varepsilon_y = S_y / E` is the yield strain of the body that yields first, the one with the lower hardness
    :math:`C S_y`, :math:`C = 1.295 \exp(0.736 \nu)`; `critical_speed` has the equation of :math:`V_c`.

    References
    ----------
    R. L. Jackson, I. Green, D. B. Marghitu, Predicting the coefficient of restitution of impacting elastic-perfectly plastic
    spheres, Nonlinear Dynamics 60 (2010) 217-229, doi:10.1007/s11071-009-9591-z.

    R. L. Jackson, I. Green, J. Tribol. 127 (2005) 343, doi:10.1115/1.1866166 (critical load and hardness).
    """

    kind: Literal["jackson_green"] = "jackson_green"
    wall: AnyWall | None = None
    yield_stress: Modulus | None = None
    extrapolate: bool = False

    def critical_speed(self, pair: Pair) -> float:
        """Return the critical speed V_c at which yield begins [m/s].

        Notes
        -----
        V_c = (4 d_c P_c / (5 m*))^(1/2), with the overlap d_c = (pi C S_y / (2 E*))^2 R* and the load
        P_c = 4/3 (R*/E*)^2 (pi C S_y / 2)^3 at which yield begins; for the sources see the class.
        """
        pair = pair.against(self.wall)
        strength, _ = self._strength(pair)
        pressure = math.pi * strength / 2
        depth = power(pressure / pair.modulus, 2) * pair.radius
        load = 4 / 3 * power(pair.radius / pair.modulus, 2) * power(pressure, 3)
        speed: float = sqrt(4 * depth * load / (5 * pair.mass))
        return speed

    def _strength(self, pair: Pair) -> tuple[float, float]:
        if self.yield_stress is not None:
            sides = [body.material for body in (pair.below, pair.above) if body.material is not None]
            young, poisson = sides[0].young, sides[0].poisson
            for other in sides[1:]:
                softer = less(other.poisson, poisson, other.young, young)
                young, poisson = pick(softer, other.young, young), pick(softer, other.poisson, poisson)
            return hardness(poisson, self.yield_stress), self.yield_stress / young
        body = pair.first_to_yield("the Jackson-Green law")
        material = present(body.material)
        return body.hardness, present(material.yield_stress) / material.young

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return critical speed and yield strain."""
        _, strain = self._strength(pair.against(self.wall))
        return "jackson_green", {
            "critical_speed": self.critical_speed(pair),
            "yield_strain": strain,
            "extrapolate": float(self.extrapolate),
            "maximum": self.maximum,
        }


def yield_pressure(pair: Pair, given: float | None, need: str) -> float:
    """Return the limiting contact pressure p_y [Pa], by default 1.6 times the yield stress of the body that yields first."""
    if given is not None:
        return given
    material = present(pair.first_to_yield(need).material)
    return 1.6 * present(material.yield_stress)


class ThorntonRestitution(Restitution):
    r"""Restitution of an elastic, perfectly plastic contact in closed form.

    Parameters
    ----------
    yield_pressure
        Limiting contact pressure p_y [Pa]; default 1.6 times the yield stress of the body that yields first.

    Notes
    -----
    .. math::

        e = \sqrt{\frac{6 \sqrt 3}{5}} \sqrt{1 - \frac{r^2}{6}}
        \left(\frac{r}{r + 2 \sqrt{6/5 - r^2/5}}\right)^{1/4}, \qquad r = \frac{V_y}{V}

    and :math:`e = 1` for :math:`V \le V_y`; `yield_speed` has the equation of :math:`V_y`. The contact `Thornton` has this
    restitution.

    References
    ----------
    C. Thornton, Coefficient of restitution for collinear collisions of elastic-perfectly plastic spheres, J. Appl. Mech. 64
    (1997) 383-386, eq. 19, doi:10.1115/1.2787319.

    C. Thornton, Z. Ning, Powder Technology 99 (1998) 154, doi:10.1016/S0032-5910(98)00099-0 (the same contact, with
    adhesion).
    """

    kind: Literal["thornton"] = "thornton"
    yield_pressure: Modulus | None = None

    def yield_speed(self, pair: Pair) -> float:
        """Return the speed V_y at which yield begins [m/s].

        Notes
        -----
        V_y = (pi / (2 E*))^2 (8 pi R*^3 / (15 m*))^(1/2) p_y^(5/2); for the source see the class.
        """
        pressure = yield_pressure(pair, self.yield_pressure, "Thornton's law")
        speed: float = (
            power(math.pi / (2 * pair.modulus), 2)
            * sqrt(8 * math.pi * power(pair.radius, 3) / (15 * pair.mass))
            * power(pressure, 2.5)
        )
        return speed

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return the yield speed."""
        return "thornton", {"yield_speed": self.yield_speed(pair), "maximum": self.maximum}


class Johnson(Restitution):
    r"""Restitution of a fully plastic impact.

    Parameters
    ----------
    speed_scale
        V_0 [m/s]; default that of the yield stress.

    Notes
    -----
    .. math:: e = (V / V_0)^{-1/4}, \qquad V_0 = 3.8^4 \left(\frac{Y}{E^*}\right)^2 \sqrt{\frac{2 Y R^{*3}}{m^*}}

    at most 1, for speeds :math:`V` much larger than :math:`V_0`, with the yield stress :math:`Y` of the body that yields
    first.

    References
    ----------
    K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), eq. 11.47, doi:10.1017/CBO9781139171731.
    """

    kind: Literal["johnson"] = "johnson"
    speed_scale: PositiveVelocity | None = None

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return V_0."""
        scale = self.speed_scale
        if scale is None:
            strength = present(present(pair.first_to_yield("Johnson's law").material).yield_stress)
            root = sqrt(2 * strength * power(pair.radius, 3) / pair.mass)
            scale = 3.8**4 * power(strength / pair.modulus, 2) * root
        return "johnson", {"speed_scale": scale, "maximum": self.maximum}


def as_restitution(value: object) -> Any:
    """Return the table of a constant restitution for a bare number; return any other value unchanged."""
    return bare_number(
        value,
        lambda e: {"kind": "constant", "e": e},
        "a number from 0 to 1 is needed, or a table",
        '0.9, or { kind = "jackson_green" }',
    )


AnyRestitution = Annotated[
    Annotated[Restitution, AnyKind()],
    SI("1"),
    BeforeValidator(as_restitution),
    AlsoAccepts({"type": "number", "minimum": 0, "maximum": 1}),
]
