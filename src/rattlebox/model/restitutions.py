"""Restitution laws e(V); their formulas are in core/contact/restitution, one file each."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from rattlebox._util.narrow import present

from .also_accepts import AlsoAccepts
from .base import Part
from .elementwise import less, pick, power, sqrt
from .errors import Hint
from .materials import AnyWall
from .pairs import Pair, hardness
from .units import SI, Modulus, PositiveVelocity, bare_number, plain

Coefficients = tuple[str, dict[str, Any]]
_fraction = WithJsonSchema({"type": "number", "minimum": 0, "maximum": 1})


def _restitution(value: Any) -> float:
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
    kind: str
    maximum: Fraction = 1.0

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return the name of the law in the core and its coefficients for a pair of bodies, in SI units."""
        raise NotImplementedError


class Constant(Restitution):
    """Constant restitution.

    Parameters
    ----------
    e
        Rebound speed over approach speed.
    """

    positional: ClassVar[tuple[str, ...]] = ("e",)
    kind: Literal["constant"] = "constant"
    e: Fraction = Field(examples=[0.8])

    if TYPE_CHECKING:  # The first field is also a positional argument.

        def __init__(self, e: Any = ..., **values: Any) -> None: ...

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return e."""
        return "constant", {"e": self.e, "maximum": self.maximum}


class Tabulated(Restitution):
    """Restitution from a table, linear in the speed between points and constant outside them.

    Parameters
    ----------
    speeds
        Strictly increasing approach speeds [m/s].
    values
        Restitution at each of them.
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
            raise Hint("speeds must increase", place=["speeds"])
        return self

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return the table."""
        return "table", {"speeds": self.speeds, "values": self.values, "maximum": self.maximum}


class JacksonGreen(Restitution):
    """Restitution of elasto-plastic impacts after Jackson and Green, from yield stress and elastic constants.

    Parameters
    ----------
    wall
        Wall for the critical speed: a material, or "rigid"; default the wall of the damper.
    yield_stress
        Yield stress [Pa] of the body with the lower Poisson's ratio, or of the softer one of two with the same ratio;
        default that of the materials.
    extrapolate
        Whether the law is used above 1000 critical speeds; a run counts these impacts.

    References
    ----------
    R. L. Jackson, I. Green, D. B. Marghitu, Predicting the coefficient of restitution of impacting elastic-perfectly plastic
    spheres, Nonlinear Dynamics 60 (2010) 217.
    """

    kind: Literal["jackson_green"] = "jackson_green"
    wall: AnyWall | None = None
    yield_stress: Modulus | None = None
    extrapolate: bool = False

    def critical_speed(self, pair: Pair) -> float:
        """Return the critical speed V_c at which yield begins [m/s]."""
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
    """Restitution of an elastic, perfectly plastic contact in closed form.

    Parameters
    ----------
    yield_pressure
        Limiting contact pressure [Pa]; default 1.6 times the smaller yield stress.

    References
    ----------
    C. Thornton, Coefficient of restitution for collinear collisions of elastic-perfectly plastic spheres, J. Appl. Mech. 64
    (1997) 383-386.
    """

    kind: Literal["thornton"] = "thornton"
    yield_pressure: Modulus | None = None

    def yield_speed(self, pair: Pair) -> float:
        """Return the speed V_y at which yield begins [m/s]."""
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
    """Restitution of a fully plastic impact, (V/V_0)^(-1/4).

    Parameters
    ----------
    speed_scale
        V_0 [m/s]; default 3.8^4 (Y/E*)^2 sqrt(2 Y R*^3/m*), with the yield stress Y of the body that yields first.

    References
    ----------
    K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), eq. 11.47, doi:10.1017/CBO9781139171731.
    """

    kind: Literal["johnson"] = "johnson"
    speed_scale: PositiveVelocity | None = None

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return the speed scale."""
        scale = self.speed_scale
        if scale is None:
            strength = yield_pressure(pair, None, "Johnson's law") / 1.6
            root = sqrt(2 * strength * power(pair.radius, 3) / pair.mass)
            scale = 3.8**4 * power(strength / pair.modulus, 2) * root
        return "johnson", {"speed_scale": scale, "maximum": self.maximum}


def as_restitution(value: Any) -> Any:
    """Return the table of a constant restitution for a bare number, any other value unchanged."""
    return bare_number(
        value,
        lambda e: {"kind": "constant", "e": e},
        "a number from 0 to 1 is needed, or a table",
        '0.9, or { kind = "jackson_green" }',
    )


RestitutionKind = Constant | Tabulated | JacksonGreen | ThorntonRestitution | Johnson
AnyRestitution = Annotated[
    Annotated[RestitutionKind, Field(discriminator="kind")],
    SI("1"),
    BeforeValidator(as_restitution),
    AlsoAccepts({"type": "number", "minimum": 0, "maximum": 1}),
]
