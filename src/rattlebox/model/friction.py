"""Friction and rolling resistance; their formulas are in core/contact."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from .also_accepts import AlsoAccepts
from .base import Part
from .errors import one_of
from .kinds import AnyKind
from .materials import Material
from .pairs import Pair
from .units import LARGEST, SI, Number, PositiveStiffness, bare_number

NotNegative = Annotated[Number, Field(ge=0, le=LARGEST)]


def _shear_compliance(material: Material | None) -> float:
    """Return (2 - nu) / G [1/Pa]; 0 for a rigid body."""
    if material is None:
        return 0.0
    return (2 - material.poisson) * 2 * (1 + material.poisson) / material.young


class Friction(Part):
    """Base class of friction laws."""

    field_names: ClassVar[tuple[str, ...]] = ("friction", "wall_friction")
    kinds: ClassVar[dict[str, type[Part]]] = {}
    kind: str
    coefficient: NotNegative = Field(examples=[0.3])
    damping: NotNegative = 1.0

    def unsuited(self, *, linear: bool) -> tuple[str, str] | None:
        """Return what it needs and advice if it does not suit a contact law, which is linear or not; None if it does."""
        return None

    @abstractmethod
    def coefficients(self, pair: Pair) -> tuple[str, dict[str, float]]:
        """Return the name of the law in the core and its coefficients for a pair of bodies, in SI units."""


class Mindlin(Friction):
    r"""Coulomb friction with Mindlin's tangential stiffness and the tangential displacement as history.

    Parameters
    ----------
    coefficient
        Coefficient of friction.
    damping
        Damping ratio of the tangential dashpot over that of the normal one.

    Notes
    -----
    The tangential force is that of a spring and a dashpot and at most :math:`\mu N`. The stiffness is

    .. math:: k_t = 8 G^* \sqrt{R^* d}, \qquad \frac{1}{G^*} = \frac{2 - \nu_1}{G_1} + \frac{2 - \nu_2}{G_2}

    with the overlap :math:`d`. The history is the force of the spring, :math:`dF = k_t\, ds`, with the tangential
    displacement :math:`s`; if :math:`k_t` decreases during unloading, the spring force decreases in proportion, so that
    the spring never gains energy.

    References
    ----------
    R. D. Mindlin, J. Appl. Mech. 16 (1949) 259, doi:10.1115/1.4009973 (stiffness).

    R. D. Mindlin, H. Deresiewicz, J. Appl. Mech. 20 (1953) 327, doi:10.1115/1.4010702 (history).
    """

    positional: ClassVar[tuple[str, ...]] = ("coefficient",)
    kind: Literal["mindlin"] = "mindlin"

    if TYPE_CHECKING:  # The first field is also a positional argument.

        def __init__(self, coefficient: object = ..., **values: Any) -> None: ...

    def unsuited(self, *, linear: bool) -> tuple[str, str] | None:
        """Return the need of a Hertz contact, whose stiffness grows with the overlap."""
        if not linear or not self.coefficient:
            return None
        spring = f'friction = {{ kind = "spring", coefficient = {self.coefficient:g}, ratio = 0.286 }}'
        return "Mindlin's stiffness needs a Hertz contact", spring

    def coefficients(self, pair: Pair) -> tuple[str, dict[str, float]]:
        """Return 8 G* [Pa], the coefficient of friction and the damping."""
        compliance = _shear_compliance(pair.below.material) + _shear_compliance(pair.above.material)
        return "mindlin", {"friction": self.coefficient, "shear_modulus": 8 / compliance, "damping": self.damping}


class LinearSpring(Friction):
    """Coulomb friction with a linear tangential spring.

    Parameters
    ----------
    coefficient
        Coefficient of friction.
    stiffness
        Stiffness of the tangential spring [N/m].
    ratio
        Ratio of the tangential stiffness to that of the linear contact, in place of `stiffness`.
    damping
        Damping ratio of the tangential dashpot over that of the normal one.

    Notes
    -----
    The tangential force is k_t s + c_t s', with the tangential displacement s since the contact began or slipped, and at
    most mu N. k_t is the stiffness, or the ratio times the stiffness k of the linear contact.

    References
    ----------
    P. A. Cundall, O. D. L. Strack, Geotechnique 29 (1979) 47, doi:10.1680/geot.1979.29.1.47.
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("stiffness", "ratio"),)
    positional: ClassVar[tuple[str, ...]] = ("coefficient",)
    kind: Literal["spring"] = "spring"
    stiffness: PositiveStiffness | None = None
    ratio: Annotated[Number, Field(gt=0, le=10)] | None = None

    if TYPE_CHECKING:

        def __init__(self, coefficient: object = ..., **values: Any) -> None: ...

    @model_validator(mode="after")
    def _one_stiffness(self) -> LinearSpring:
        one_of("ratio = 0.286", stiffness=self.stiffness, ratio=self.ratio)
        return self

    def unsuited(self, *, linear: bool) -> tuple[str, str] | None:
        """Return the need of a linear contact, to whose stiffness the ratio refers."""
        if linear or not self.ratio:
            return None
        return "a ratio of stiffnesses needs a linear contact", "friction = 0.3, for Mindlin's stiffness, or stiffness"

    def coefficients(self, pair: Pair) -> tuple[str, dict[str, float]]:
        """Return stiffness, ratio, the coefficient of friction and the damping."""
        return "spring", {
            "friction": self.coefficient,
            "stiffness": self.stiffness or 0.0,
            "ratio": self.ratio or 0.0,
            "damping": self.damping,
        }


class Rolling(Part):
    r"""Rolling resistance: an elastic, perfectly plastic spring with a dashpot.

    Parameters
    ----------
    coefficient
        Largest moment over the product of normal force and R*.
    stiffness
        Stiffness of the spring over the product of tangential stiffness and R*^2.
    damping
        Damping ratio of the dashpot.

    Notes
    -----
    .. math:: M = k_r \theta + c_r \dot\theta, \qquad |M| \le \mu_r R^* N

    with the rolling angle :math:`\theta` (model C of the reference). :math:`k_r` is the stiffness times
    :math:`k_t R^{*2}`, with the tangential stiffness :math:`k_t` of the friction law.

    References
    ----------
    J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi, Powder Technology 206 (2011) 269, doi:10.1016/j.powtec.2010.09.030.
    """

    field_names: ClassVar[tuple[str, ...]] = ("rolling", "wall_rolling")
    positional: ClassVar[tuple[str, ...]] = ("coefficient",)
    coefficient: NotNegative = Field(examples=[0.02])
    stiffness: Annotated[Number, Field(gt=0, le=LARGEST)] = 1.0
    damping: NotNegative = 0.0

    if TYPE_CHECKING:

        def __init__(self, coefficient: object = ..., **values: Any) -> None: ...

    def coefficients(self) -> dict[str, float]:
        """Return mu_r, k_r / (k_t R*^2) and the damping ratio for the core."""
        return {"coefficient": self.coefficient, "stiffness": self.stiffness, "damping": self.damping}


def _mindlin(value: object) -> Any:
    advice = '0.3, or { kind = "mindlin", coefficient = 0.3 }'
    return bare_number(value, lambda c: {"kind": "mindlin", "coefficient": c}, _NEED, advice)


def _rolling(value: object) -> Any:
    return bare_number(value, lambda c: {"coefficient": c}, _NEED, "0.3, or { coefficient = 0.3 }")


_NEED = "a number is needed, or a table"
_number = AlsoAccepts({"type": "number", "minimum": 0})
AnyFriction = Annotated[Annotated[Friction, AnyKind()], SI("1"), BeforeValidator(_mindlin), _number]
AnyRolling = Annotated[Rolling, SI("1"), BeforeValidator(_rolling), _number]
