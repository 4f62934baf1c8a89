"""Friction and rolling resistance; the formulas themselves are in core/contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from .also_takes import AlsoTakes
from .base import Part
from .errors import one_of
from .materials import Material
from .pairs import Pair
from .units import LARGEST, SI, Number, PositiveStiffness, bare_number

NotNegative = Annotated[Number, Field(ge=0, le=LARGEST)]


def _shear_compliance(material: Material | None) -> float:
    """(2 - nu) / G [1/Pa], 0 for a rigid body."""
    if material is None:
        return 0.0
    return (2 - material.poisson) * 2 * (1 + material.poisson) / material.young


class Friction(Part):
    """What all friction laws share."""

    held_as: ClassVar[tuple[str, ...]] = ("friction", "wall_friction")
    kind: str
    coefficient: NotNegative = Field(examples=[0.3])
    damping: NotNegative = 1.0

    def coefficients(self, pair: Pair) -> tuple[str, dict[str, float]]:
        """Return the core's name of the law and its coefficients for a pair of bodies."""
        raise NotImplementedError


class Mindlin(Friction):
    """Coulomb friction with Mindlin's stiffness, 8 G* sqrt(R* overlap), and the history of the contact.

    Parameters
    ----------
    coefficient
        Of friction.
    damping
        Damping ratio of the tangential dashpot over that of the normal one.
    """

    unnamed: ClassVar[tuple[str, ...]] = ("coefficient",)
    kind: Literal["mindlin"] = "mindlin"

    if TYPE_CHECKING:  # the first field may be given without its name

        def __init__(self, coefficient: Any = ..., **values: Any) -> None: ...

    def coefficients(self, pair: Pair) -> tuple[str, dict[str, float]]:
        """Return 8 G* [Pa] besides coefficient and damping."""
        compliance = _shear_compliance(pair.below.material) + _shear_compliance(pair.above.material)
        return "mindlin", {"friction": self.coefficient, "shear_modulus": 8 / compliance, "damping": self.damping}


class LinearSpring(Friction):
    """Coulomb friction with a linear tangential spring.

    Parameters
    ----------
    coefficient
        Of friction.
    stiffness, ratio
        Of the tangential spring [N/m]; or its ratio to the stiffness of the linear contact of the pair that touches.
    damping
        Damping ratio of the tangential dashpot over that of the normal one.
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("stiffness", "ratio"),)
    unnamed: ClassVar[tuple[str, ...]] = ("coefficient",)
    kind: Literal["spring"] = "spring"
    stiffness: PositiveStiffness | None = None
    ratio: Annotated[Number, Field(gt=0, le=10)] | None = None

    if TYPE_CHECKING:

        def __init__(self, coefficient: Any = ..., **values: Any) -> None: ...

    @model_validator(mode="after")
    def _one_stiffness(self) -> LinearSpring:
        one_of("ratio = 0.286", stiffness=self.stiffness, ratio=self.ratio)
        return self

    def coefficients(self, pair: Pair) -> tuple[str, dict[str, float]]:
        """Return stiffness and ratio besides coefficient and damping."""
        return "spring", {
            "friction": self.coefficient,
            "stiffness": self.stiffness or 0.0,
            "ratio": self.ratio or 0.0,
            "damping": self.damping,
        }


class Rolling(Part):
    """Rolling resistance: an elastic, perfectly plastic spring with a dashpot.

    Parameters
    ----------
    coefficient
        Limit of the moment over normal force times R*.
    stiffness
        Of the spring, as a multiple of the tangential stiffness times R*^2.
    damping
        Damping ratio of the dashpot.
    """

    held_as: ClassVar[tuple[str, ...]] = ("rolling", "wall_rolling")
    unnamed: ClassVar[tuple[str, ...]] = ("coefficient",)
    coefficient: NotNegative = Field(examples=[0.02])
    stiffness: Annotated[Number, Field(gt=0, le=LARGEST)] = 1.0
    damping: NotNegative = 0.0

    if TYPE_CHECKING:

        def __init__(self, coefficient: Any = ..., **values: Any) -> None: ...

    def coefficients(self) -> dict[str, float]:
        """Return what the core reads."""
        return {"coefficient": self.coefficient, "stiffness": self.stiffness, "damping": self.damping}


def _mindlin(value: Any) -> Any:
    advice = '0.3, or { kind = "mindlin", coefficient = 0.3 }'
    return bare_number(value, lambda c: {"kind": "mindlin", "coefficient": c}, _NEED, advice)


def _rolling(value: Any) -> Any:
    return bare_number(value, lambda c: {"coefficient": c}, _NEED, "0.3, or { coefficient = 0.3 }")


_NEED = "a number is needed, or a table"
_number = AlsoTakes({"type": "number", "minimum": 0})
FrictionKind = Mindlin | LinearSpring
AnyFriction = Annotated[
    Annotated[FrictionKind, Field(discriminator="kind")], SI("1"), BeforeValidator(_mindlin), _number
]
AnyRolling = Annotated[Rolling, SI("1"), BeforeValidator(_rolling), _number]
