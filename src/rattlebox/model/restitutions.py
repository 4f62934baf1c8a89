"""Restitution laws e(V); the formulas themselves are in core/contact/restitution, one file each."""

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
            "restitution lies between 0 (no rebound) and 1 (no loss): above 1 an impact would create energy", "0.8"
        )
    return number


Fraction = Annotated[float, BeforeValidator(_restitution), _fraction]


class Restitution(Part):
    """What all restitution laws share.

    Parameters
    ----------
    maximum
        Cap on e.
    """

    field_names: ClassVar[tuple[str, ...]] = ("restitution",)
    kind: str
    maximum: Fraction = 1.0

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return the core's name of the law and its coefficients for a pair of bodies."""
        raise NotImplementedError


class Constant(Restitution):
    """The same restitution at every speed.

    Parameters
    ----------
    e
        Rebound speed over approach speed.
    """

    positional: ClassVar[tuple[str, ...]] = ("e",)
    kind: Literal["constant"] = "constant"
    e: Fraction = Field(examples=[0.8])

    if TYPE_CHECKING:  # the first field may be given without its name

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
    """Elasto-plastic restitution after Jackson and Green, from yield stress and elastic constants.

    Parameters
    ----------
    wall
        Elasticity of the wall in the critical speed: a material, "rigid", or None for the damper's wall.
    yield_stress
        Instead of the materials' [Pa]; that of the one with the lower Poisson's ratio, or the softer one.
    extrapolate
        Use the law above 1000 critical speeds; counted in the run.
    """

    kind: Literal["jackson_green"] = "jackson_green"
    wall: AnyWall | None = None
    yield_stress: Modulus | None = None
    extrapolate: bool = False

    def critical_speed(self, pair: Pair) -> float:
        """Return V_c [m/s], the speed at which yield begins."""
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
    """Return the limiting contact pressure p_y [Pa]: as given, or 1.6 yield stress of the body that yields first."""
    if given is not None:
        return given
    material = present(pair.first_to_yield(need).material)
    return 1.6 * present(material.yield_stress)


class ThorntonRestitution(Restitution):
    """Restitution of an elastic, perfectly plastic contact in closed form.

    Parameters
    ----------
    yield_pressure
        Limiting contact pressure [Pa]; default 1.6 yield stress.
    """

    kind: Literal["thornton"] = "thornton"
    yield_pressure: Modulus | None = None

    def yield_speed(self, pair: Pair) -> float:
        """Return V_y [m/s]."""
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
        V_0 [m/s]; default from the yield stress Y of the body that yields first,
        V_0 = 3.8^4 (Y/E*)^2 sqrt(2 Y R*^3/m*) (K. L. Johnson, Contact Mechanics 1985, eq. 11.47).
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
    """Let a bare number stand for Constant."""
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
