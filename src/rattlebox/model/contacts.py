"""Contact laws; the formulas themselves are in core/contact, one file each."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, model_validator

from .base import Part
from .elementwise import power, sqrt
from .errors import Hint, one_of
from .pairs import Pair
from .restitutions import AnyRestitution, Constant, Restitution, ThorntonRestitution, yield_pressure
from .units import LARGEST, Damping, Modulus, Number, PositiveStiffness, PositiveTime

Ending = Literal["zero_force", "zero_overlap"]


class Contact(Part):
    """What all contact laws share."""

    held_as: ClassVar[tuple[str, ...]] = ("contact", "ball_contact")
    kind: str

    def coefficients(self, pair: Pair) -> tuple[str, dict[str, Any]]:
        """Return the core's name of the law and its coefficients for a pair of bodies."""
        raise NotImplementedError

    def equivalent_restitution(self, pair: Pair) -> Restitution:
        """Return the restitution law that hard impacts of the same loss obey."""
        raise NotImplementedError


def _soft(restitution: Any) -> None:
    if isinstance(restitution, Constant) and restitution.e < 1e-6:
        raise Hint(
            "a contact with duration needs a restitution of at least 1e-6",
            "restitution = 1e-6, or for balls in a row method = Newton(), whose impacts may be fully plastic",
            ["restitution"],
        )


def _constant(e: Any) -> Constant:
    """The law of a constant restitution, or of an array of them."""
    return Constant(float(e)) if e.ndim == 0 else Constant.model_construct(e=e)


class Tsuji(Contact):
    """Hertz contact with Tsuji's dashpot.

    Parameters
    ----------
    restitution
        A law, or a number for a constant; the contact gives back exactly this.
    alpha
        Instead: the damping coefficient itself.
    ending
        "zero_force": the contact ends when its force vanishes, it never pulls; "zero_overlap": at zero overlap.
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("restitution", "alpha"),)
    kind: Literal["tsuji"] = "tsuji"
    restitution: AnyRestitution | None = None
    alpha: Annotated[Number, Field(ge=0, le=LARGEST)] | None = None
    ending: Ending = "zero_force"

    @model_validator(mode="after")
    def _one_damping(self) -> Tsuji:
        one_of("restitution = 0.9", restitution=self.restitution, alpha=self.alpha)
        if self.alpha is not None and self.ending == "zero_overlap" and self.alpha >= math.sqrt(5):
            raise Hint("above alpha = sqrt(5) an overlap never returns to zero", 'ending = "zero_force"')
        _soft(self.restitution)
        return self

    def coefficients(self, pair: Pair) -> tuple[str, dict[str, Any]]:
        """Return stiffness, mass and, if fixed, alpha."""
        values: dict[str, Any] = {
            "stiffness": pair.hertz_stiffness,
            "mass": pair.mass,
            "zero_overlap": float(self.ending == "zero_overlap"),
        }
        if self.alpha is not None:
            values["alpha"] = self.alpha
        return "hertz_tsuji", values

    def equivalent_restitution(self, pair: Pair) -> Restitution:
        """Return the law itself, or the constant that alpha amounts to."""
        if self.restitution is not None:
            return self.restitution
        assert self.alpha is not None
        return _constant(restitution_of_alpha(self.alpha, self.ending))


class Linear(Contact):
    """Linear spring and dashpot.

    Parameters
    ----------
    stiffness
        k [N/m].
    contact_time
        Instead: the duration of an undamped contact, pi sqrt(m*/k) [s].
    restitution, damping
        A law or a number; or instead the dashpot's coefficient c [N s/m].
    ending
        "zero_force": the contact never pulls; "zero_overlap": it ends at zero overlap.
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("stiffness", "contact_time"), ("restitution", "damping"))
    kind: Literal["linear"] = "linear"
    stiffness: PositiveStiffness | None = None
    contact_time: PositiveTime | None = None
    restitution: AnyRestitution | None = None
    damping: Damping | None = None
    ending: Ending = "zero_force"

    @model_validator(mode="after")
    def _determined(self) -> Linear:
        one_of('stiffness = "1 MN/m"', stiffness=self.stiffness, contact_time=self.contact_time)
        one_of("restitution = 0.9", restitution=self.restitution, damping=self.damping)
        _soft(self.restitution)
        return self

    def coefficients(self, pair: Pair) -> tuple[str, dict[str, Any]]:
        """Return stiffness, mass and, if fixed, damping."""
        if self.stiffness is not None:
            stiffness = self.stiffness
        else:
            assert self.contact_time is not None
            stiffness = pair.mass * power(math.pi / self.contact_time, 2)
        values: dict[str, Any] = {
            "stiffness": stiffness,
            "mass": pair.mass,
            "zero_overlap": float(self.ending == "zero_overlap"),
        }
        if self.damping is not None:
            values["damping"] = self.damping
            if self.ending == "zero_overlap" and np.any(self.damping >= 2 * sqrt(stiffness * pair.mass)):
                raise Hint("with this damping an overlap never returns to zero", 'ending = "zero_force"')
        return "linear", values

    def equivalent_restitution(self, pair: Pair) -> Restitution:
        """Return the law itself, or the constant that the dashpot amounts to."""
        if self.restitution is not None:
            return self.restitution
        _, values = self.coefficients(pair)
        zeta = values["damping"] / (2 * sqrt(values["stiffness"] * pair.mass))
        return _constant(restitution_of_alpha(math.sqrt(5) * zeta, self.ending))


class Thornton(Contact):
    """Elastic, perfectly plastic contact with hysteresis: it dissipates by yielding.

    Parameters
    ----------
    yield_pressure
        Limiting contact pressure p_y [Pa]; default 1.6 yield stress of the body that yields first.
    """

    kind: Literal["thornton"] = "thornton"
    yield_pressure: Modulus | None = None
    restitution: ClassVar[None] = None

    def coefficients(self, pair: Pair) -> tuple[str, dict[str, Any]]:
        """Return elastic constants and the limiting pressure."""
        return "thornton", {
            "stiffness": pair.hertz_stiffness,
            "mass": pair.mass,
            "radius": pair.radius,
            "modulus": pair.modulus,
            "yield_pressure": yield_pressure(pair, self.yield_pressure, "Thornton's contact"),
        }

    def equivalent_restitution(self, pair: Pair) -> Restitution:
        """Return the closed form of this contact's restitution."""
        return ThorntonRestitution.model_construct(yield_pressure=self.yield_pressure)


AnyContact = Annotated[Tsuji | Linear | Thornton, Field(discriminator="kind")]


def restitution_of_alpha(alpha: ArrayLike, ending: Ending = "zero_force") -> NDArray[np.float64]:
    """Return the restitution that Tsuji's damping coefficient gives.

    Parameters
    ----------
    alpha
        Any shape; below sqrt(5) for "zero_overlap".
    ending
        Where the contact ends.
    """
    zeta = np.asarray(alpha, dtype=float) / math.sqrt(5)
    with np.errstate(invalid="ignore", divide="ignore"):
        if ending == "zero_overlap":
            return np.asarray(np.exp(-math.pi * zeta / np.sqrt(1 - zeta**2)))
        below = np.clip(zeta, 0, 1)
        angle = np.arccos(below)
        sine = np.sqrt(np.abs(1 - zeta**2))
        bent = np.where(zeta < 1, 2 * angle * zeta / sine, 2 * np.arccosh(np.maximum(zeta, 1)) * zeta / sine)
        return np.asarray(np.exp(-np.where(sine == 0, 2.0, bent)))


def alpha_of_restitution(e: ArrayLike, ending: Ending = "zero_force") -> NDArray[np.float64]:
    """Return Tsuji's damping coefficient for a restitution, the exact inverse of restitution_of_alpha.

    Parameters
    ----------
    e
        Any shape, 0 < e <= 1.
    ending
        Where the contact ends.
    """
    target = -np.log(np.asarray(e, dtype=float))
    if ending == "zero_overlap":
        return np.asarray(math.sqrt(5) * target / np.sqrt(target**2 + math.pi**2))
    zeta = np.minimum(target / math.pi, 1.0)
    for _ in range(100):  # Newton on an increasing concave function, from the left
        square = (1 - zeta) * (1 + zeta)
        sine = np.sqrt(np.abs(square))
        with np.errstate(invalid="ignore", divide="ignore"):
            inner = np.where(
                square > 0,
                np.arccos(np.clip(zeta, 0, 1)) - zeta * sine,
                zeta * sine - np.arccosh(np.maximum(zeta, 1)),
            )
            slope = np.where(sine < 1e-3, 4 / 3, 2 * inner / sine**3)
        change = (target + np.log(restitution_of_alpha(math.sqrt(5) * zeta, ending))) / slope
        zeta = zeta + change
        if np.all(np.abs(change) <= 4e-16 * np.abs(zeta)):
            break
    return np.asarray(math.sqrt(5) * zeta)
