"""Normal contact laws; their formulas are in core/contact/normal, one file each."""

from __future__ import annotations

import math
from abc import abstractmethod
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from rattlebox._util.narrow import present

from .base import Part
from .elementwise import mapped, power, powers, sqrt
from .errors import Hint, at, one_of
from .kinds import AnyKind
from .pairs import Pair
from .power_dashpot import SMALLEST, dimensionless_damping, rebound
from .restitutions import (
    AnyRestitution,
    Coefficients,
    Constant,
    Restitution,
    Tabulated,
    ThorntonRestitution,
    yield_pressure,
)
from .units import (
    LARGEST,
    Damping,
    Force,
    Length,
    Modulus,
    Number,
    PositiveStiffness,
    PositiveTime,
    PositiveVelocity,
)

Ending = Literal["zero_force", "zero_overlap"]

_SMALL_OVERLAP = 1e-6
"""Overlap at which forces of power laws are limited [m]."""

MAX_OVERLAP = 0.01
"""Largest overlap over the smaller radius at which contact laws of spheres hold."""
MAX_LINEAR_OVERLAP = 0.1
"""The same of a linear contact, which is a model of a contact and not a law of spheres."""
EXTRAPOLATED = 1000.0
"""Largest overlap in the restitution table of a measured contact, over the last measured one."""


class FixedDamping(NamedTuple):
    """A dashpot with the same restitution at every speed.

    See Also
    --------
    rattlebox.restitution_of_alpha : Restitution of a damping ratio, with equation and source.
    """

    ratio: Any
    ending: Ending


class Contact(Part):
    """Base class of normal contact laws."""

    field_names: ClassVar[tuple[str, ...]] = ("contact", "ball_contact")
    kinds: ClassVar[dict[str, type[Part]]] = {}
    kind: str
    overlap_limit: ClassVar[float] = MAX_OVERLAP
    """Largest overlap over the smaller radius at which the law holds."""
    depends_on_speed: ClassVar[bool] = True
    """Whether the duration of a contact depends on the approach speed."""

    @property
    @abstractmethod
    def force_exponent(self) -> float:
        """Exponent of the force in the overlap; 1 for a measured curve, which counts as linear with its secant."""

    @property
    def measured_overlap(self) -> float | None:
        """Last overlap of a measured force curve [m], beyond which it is extrapolated; None if none is measured."""
        return None

    @property
    def impact_restitution(self) -> Restitution | None:
        """The restitution law from which the dashpot of each impact is computed; None if the law needs none."""
        return None

    @property
    def last_tabulated_speed(self) -> float | None:
        """Last speed of a table of restitution [m/s]; None if the contact has no table."""
        law = self.impact_restitution
        return None if law is None else law.last_speed

    def static_overlap(self, pair: Pair, softening: float, force: float) -> float:
        """Return the overlap at rest under a force [N], with moduli divided by `softening` [m]."""
        _, values = self.softened(pair, softening)
        return float((force / values["stiffness"]) ** (1 / self.force_exponent))

    @abstractmethod
    def coefficients(self, pair: Pair) -> Coefficients:
        """Return the name of the law in the core and its coefficients for a pair of bodies, in SI units."""

    def softened(self, pair: Pair, softening: float) -> Coefficients:
        """Return `coefficients` with moduli divided by a factor; dashpots are scaled so that the restitution is the same.

        Notes
        -----
        With a modulus E / s the coefficient of a linear dashpot is c / s^(1/2), since its damping ratio c / (2 (k m*)^(1/2))
        is the same. A limiting pressure is p_y / s^(4/5), since the speed at which yield begins is proportional to
        p_y^(5/2) / E^2 (see `ThorntonRestitution`).
        """
        name, values = self.coefficients(pair)
        scale = {"stiffness": 1.0, "modulus": 1.0, "damping": 0.5, "yield_pressure": 0.8}
        return name, {key: value / softening ** scale.get(key, 0.0) for key, value in values.items()}

    @abstractmethod
    def equivalent_restitution(self, pair: Pair) -> Restitution | FixedDamping:
        """Return the restitution law of hard impacts with the same loss, or the dashpot from which it follows."""


def _check_soft(restitution: object) -> None:
    if isinstance(restitution, Constant) and restitution.e < 1e-6:
        raise Hint(
            "a contact with duration needs a restitution of at least 1e-6",
            "restitution = 1e-6, or for impact dampers method = Newton(), which allows fully plastic impacts",
            ["restitution"],
        )


class Tsuji(Contact):
    r"""Hertz contact with Tsuji's dashpot.

    Parameters
    ----------
    restitution
        Restitution law, or a number for a constant restitution; the contact has exactly this restitution.
    alpha
        Damping coefficient, in place of the restitution.
    ending
        "zero_force": the contact ends when its force vanishes and never pulls; "zero_overlap": it ends at zero overlap.

    Notes
    -----
    .. math:: N = K d^{3/2} + \alpha \sqrt{m^* K}\, d^{1/4} \dot d, \qquad K = \tfrac{4}{3} E^* \sqrt{R^*}

    with the effective mass :math:`m^*` and the overlap :math:`d`. The restitution depends on :math:`\alpha` alone;
    `restitution_of_alpha` has the equation.

    References
    ----------
    H. Hertz, J. reine angew. Math. 92 (1882) 156, doi:10.1515/crll.1882.92.156.

    Y. Tsuji, T. Tanaka, T. Ishida, Powder Technology 71 (1992) 239, doi:10.1016/0032-5910(92)88030-L.

    Examples
    --------
    The ratio of the speeds of an impact is the restitution, but for the motion of the structure during the contact:

    >>> import rattlebox as rb
    >>> run = rb.simulate(rb.reference_case(contact=rb.Tsuji(restitution=0.6), duration="0.1 s"))
    >>> impacts = run.arrays.impacts
    >>> print(f"{impacts.separation_speed[0] / impacts.approach_speed[0]:.2f}")
    0.60
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
        _check_soft(self.restitution)
        return self

    @property
    def impact_restitution(self) -> Restitution | None:
        """The restitution law from which the dashpot of each impact is computed."""
        return self.restitution

    @property
    def force_exponent(self) -> float:
        """Exponent of the force in the overlap."""
        return 1.5

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return stiffness, mass and, if fixed, alpha."""
        values: dict[str, Any] = {
            "stiffness": pair.hertz_stiffness,
            "mass": pair.mass,
            "zero_overlap": float(self.ending == "zero_overlap"),
        }
        if self.alpha is not None:
            values["alpha"] = self.alpha
        return "hertz_tsuji", values

    def equivalent_restitution(self, pair: Pair) -> Restitution | FixedDamping:
        """Return the restitution law, or the damping ratio of alpha."""
        if self.restitution is not None:
            return self.restitution
        return FixedDamping(present(self.alpha) / math.sqrt(5), self.ending)


class Linear(Contact):
    r"""Linear spring and dashpot.

    Parameters
    ----------
    stiffness
        k [N/m].
    contact_time
        Duration of an undamped contact, :math:`\pi \sqrt{m^*/k}` [s], in place of the stiffness.
    restitution
        Restitution law, or a number for a constant restitution.
    damping
        Coefficient c of the dashpot [N s/m], in place of the restitution.
    ending
        "zero_force": the contact never pulls; "zero_overlap": it ends at zero overlap.

    Notes
    -----
    .. math:: N = k d + c \dot d, \qquad \zeta = \frac{c}{2 \sqrt{k m^*}}

    with the overlap :math:`d`. Below :math:`\zeta = 1`, a contact that ends at zero overlap has the restitution
    :math:`e = \exp(-\pi \zeta / \sqrt{1 - \zeta^2})`; one that ends at zero force has :math:`e = \exp(-2 b \cot b)`, where
    :math:`\zeta = \cos b`.

    References
    ----------
    P. A. Cundall, O. D. L. Strack, Geotechnique 29 (1979) 47, doi:10.1680/geot.1979.29.1.47.

    T. Schwager, T. Poeschel, Granular Matter 9 (2007) 465, doi:10.1007/s10035-007-0065-z (restitution).

    Examples
    --------
    >>> import rattlebox as rb
    >>> pads = rb.Linear(contact_time="0.2 ms", restitution=0.5)
    >>> impacts = rb.simulate(rb.reference_case(contact=pads, duration="0.1 s")).arrays.impacts
    >>> print(f"{impacts.separation_speed[0] / impacts.approach_speed[0]:.2f}")
    0.50
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("stiffness", "contact_time"), ("restitution", "damping"))
    overlap_limit: ClassVar[float] = MAX_LINEAR_OVERLAP
    depends_on_speed: ClassVar[bool] = False
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
        _check_soft(self.restitution)
        return self

    @property
    def impact_restitution(self) -> Restitution | None:
        """The restitution law from which the dashpot of each impact is computed."""
        return self.restitution

    @property
    def force_exponent(self) -> float:
        """Exponent of the force in the overlap."""
        return 1.0

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return stiffness, mass and, if fixed, damping; a contact time t has the stiffness m* (pi / t)^2."""
        if self.stiffness is not None:
            stiffness = self.stiffness
        else:
            stiffness = pair.mass * power(math.pi / present(self.contact_time), 2)
        values: dict[str, Any] = {
            "stiffness": stiffness,
            "mass": pair.mass,
            "zero_overlap": float(self.ending == "zero_overlap"),
            "fixed_contact_time": float(self.contact_time is not None),
        }
        if self.damping is not None:
            values["damping"] = self.damping
            if self.ending == "zero_overlap" and np.any(self.damping >= 2 * sqrt(stiffness * pair.mass)):
                raise Hint("with this damping an overlap never returns to zero", 'ending = "zero_force"')
        return "linear", values

    def equivalent_restitution(self, pair: Pair) -> Restitution | FixedDamping:
        """Return the restitution law, or the damping ratio of the dashpot."""
        if self.restitution is not None:
            return self.restitution
        _, values = self.coefficients(pair)
        return FixedDamping(values["damping"] / (2 * sqrt(values["stiffness"] * pair.mass)), self.ending)


class Thornton(Contact):
    r"""Elastic, perfectly plastic contact with hysteresis, which dissipates by yielding.

    Parameters
    ----------
    yield_pressure
        Limiting contact pressure p_y [Pa]; default 1.6 times the yield stress of the body that yields first, the one with
        the lower hardness (see `JacksonGreen`).

    Notes
    -----
    Loading follows Hertz up to the overlap :math:`d_y` at which the pressure at the centre reaches :math:`p_y`, and is
    linear beyond it:

    .. math::

        F &= \tfrac{4}{3} E^* \sqrt{R^*}\, d^{3/2}, & d &\le d_y = R^* \left(\frac{\pi p_y}{2 E^*}\right)^2 \\
        F &= F_y + \pi R^* p_y (d - d_y), & d &> d_y

    Unloading from :math:`F_{max}` and reloading follow Hertz with a larger effective radius,

    .. math::

        F = \tfrac{4}{3} E^* \sqrt{R_p}\, (d - d_p)^{3/2}, \qquad
        R_p = \frac{4 E^*}{3 F_{max}} \left(\frac{2 F_{max} + F_y}{2 \pi p_y}\right)^{3/2}

    with the residual overlap :math:`d_p`, at which :math:`F = 0`.

    References
    ----------
    C. Thornton, Coefficient of restitution for collinear collisions of elastic-perfectly plastic spheres, J. Appl. Mech. 64
    (1997) 383-386, eqs 8 to 18, doi:10.1115/1.2787319.

    C. Thornton, Z. Ning, Powder Technology 99 (1998) 154, doi:10.1016/S0032-5910(98)00099-0 (the same contact, with
    adhesion).
    """

    kind: Literal["thornton"] = "thornton"
    yield_pressure: Modulus | None = None

    @property
    def force_exponent(self) -> float:
        """Exponent of the force in the overlap."""
        return 1.5

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return elastic constants and the limiting pressure."""
        return "thornton", {
            "stiffness": pair.hertz_stiffness,
            "mass": pair.mass,
            "radius": pair.radius,
            "modulus": pair.modulus,
            "yield_pressure": yield_pressure(pair, self.yield_pressure, "Thornton's contact"),
        }

    def equivalent_restitution(self, pair: Pair) -> Restitution:
        """Return the restitution law of this contact in closed form."""
        return ThorntonRestitution.model_construct(yield_pressure=self.yield_pressure)


class PowerLaw(Contact):
    r"""Contact law with powers of the overlap in the elastic force and in the dashpot.

    Parameters
    ----------
    stiffness
        k [N/m^n], with k d^n of at most 1e30 N at an overlap d of 1 um; default that of a Hertz contact of the materials,
        which needs n = 3/2.
    exponent
        n, from 0.5 to 10.
    damping_exponent
        p, from 0 to 10. 3/2: Hunt and Crossley, Lankarani and Nikravesh; 1/2: Kuwabara and Kono.
    damping
        c [N s/m^(p+1)], with c d^p of at most 1e30 N s/m at an overlap d of 1 um.
    restitution, impact_speed
        Restitution of an impact at this speed [m/s], in place of c. With p = (n - 1)/2 the restitution is the same at every
        speed, and no speed is needed.
    ending
        "zero_force": the contact ends when its force vanishes and never pulls; "zero_overlap": it ends at zero overlap and
        may pull before.

    Notes
    -----
    .. math:: N = k d^n + c d^p \dot d

    with the overlap :math:`d`. The coefficient :math:`c` is constant for the pair: unless :math:`p = (n - 1)/2`, the
    restitution depends on the speed :math:`V`. For a given restitution,

    .. math:: c = \frac{\gamma m^* V}{L^{p + 1}}, \qquad L = \left(\frac{m^* V^2}{k}\right)^{1/(n + 1)}

    where :math:`\gamma` is the root of :math:`e(\gamma)`, which is computed from
    :math:`x'' + \gamma x^p x' + x^n = 0` with :math:`x(0) = 0` and :math:`x'(0) = 1`.

    References
    ----------
    K. H. Hunt, F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440, doi:10.1115/1.3423596.

    G. Kuwabara, K. Kono, Jpn. J. Appl. Phys. 26 (1987) 1230, doi:10.1143/JJAP.26.1230.

    H. M. Lankarani, P. E. Nikravesh, J. Mech. Des. 112 (1990) 369, doi:10.1115/1.2912617.

    Examples
    --------
    >>> import rattlebox as rb
    >>> hunt_crossley = rb.PowerLaw(damping_exponent=1.5, restitution=0.8, impact_speed="1 m/s")
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("restitution", "damping"),)
    kind: Literal["power"] = "power"
    stiffness: Annotated[Number, Field(gt=0)] | None = None
    exponent: Annotated[Number, Field(ge=0.5, le=10)] = 1.5
    damping_exponent: Annotated[Number, Field(ge=0, le=10)] = 0.5
    damping: Annotated[Number, Field(ge=0)] | None = None
    restitution: Annotated[Number, Field(ge=SMALLEST, le=1)] | None = None
    impact_speed: PositiveVelocity | None = None
    ending: Ending = "zero_force"

    @model_validator(mode="after")
    def _determined(self) -> PowerLaw:
        one_of("restitution = 0.9", restitution=self.restitution, damping=self.damping)
        if self.stiffness is None and self.exponent != 1.5:
            raise Hint(
                "moduli determine the stiffness only of a Hertz contact, exponent = 1.5",
                "stiffness = 1e9",
                ["stiffness"],
            )
        # The unit of a coefficient depends on its exponent: a limit of the number itself would refuse ordinary contacts.
        for name, exponent, unit in (("stiffness", self.exponent, "N"), ("damping", self.damping_exponent, "N s/m")):
            value = getattr(self, name)
            if value is not None and value * _SMALL_OVERLAP**exponent > LARGEST:
                largest = LARGEST / _SMALL_OVERLAP**exponent
                raise Hint(
                    f"with the exponent {exponent:g} this is more than {LARGEST:g} {unit} at an overlap of 1 um",
                    f"{name} = {largest:.3g} or less",
                    [name],
                )
        same_at_every_speed = 2 * self.damping_exponent == self.exponent - 1
        if self.restitution is not None and self.impact_speed is None and not same_at_every_speed:
            raise Hint(
                "with these exponents the restitution depends on the speed: the speed of the impact is needed",
                'impact_speed = "1 m/s"',
                ["impact_speed"],
            )
        return self

    @property
    def _similarity(self) -> Any:
        """Exponent of the stiffness in a dashpot coefficient with the same restitution."""
        return (self.damping_exponent + 1) / (self.exponent + 1)

    @property
    def force_exponent(self) -> float:
        """Exponent of the force in the overlap."""
        return self.exponent

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return stiffness, mass, exponents and the coefficient of the dashpot."""
        stiffness = pair.hertz_stiffness if self.stiffness is None else self.stiffness
        zero_overlap = self.ending == "zero_overlap"
        if self.damping is not None:
            damping = self.damping
        else:
            speed = 1.0 if self.impact_speed is None else self.impact_speed
            gamma = mapped(dimensionless_damping, self.restitution, self.exponent, self.damping_exponent, zero_overlap)
            length = powers(pair.mass * power(speed, 2) / stiffness, 1 / (self.exponent + 1))
            damping = gamma * pair.mass * speed / powers(length, self.damping_exponent + 1)
        return "power", {
            "stiffness": stiffness,
            "mass": pair.mass,
            "exponent": self.exponent,
            "damping": damping,
            "damping_exponent": self.damping_exponent,
            "zero_overlap": float(zero_overlap),
            "hertz": float(self.stiffness is None),
            "fixed_restitution": float(self.damping is None),
        }

    def softened(self, pair: Pair, softening: float) -> Coefficients:
        """Return the coefficients with the stiffness divided by a factor and the same restitution at each speed.

        Notes
        -----
        k / s and c / s^((p + 1)/(n + 1)) leave gamma = c L^(p + 1) / (m* V), with L = (m* V^2 / k)^(1/(n + 1)), unchanged.
        """
        name, values = self.coefficients(pair)
        values["stiffness"] = values["stiffness"] / softening
        values["damping"] = values["damping"] / softening**self._similarity
        return name, values

    def equivalent_restitution(self, pair: Pair) -> Restitution:
        """Return the restitution of this contact: a constant, or a table if it depends on the speed."""
        if self.restitution is not None and 2 * self.damping_exponent == self.exponent - 1:
            return Constant.model_construct(e=self.restitution)
        _, values = self.coefficients(pair)
        if any(isinstance(value, np.ndarray) for value in values.values()):
            raise Hint(
                "the method Newton cannot vary a power law within one study; EventDriven can", "method = EventDriven()"
            )
        speeds = np.geomspace(1e-6, 1e3, 181)
        length = (pair.mass * speeds**2 / values["stiffness"]) ** (1 / (self.exponent + 1))
        gammas = values["damping"] * length ** (self.damping_exponent + 1) / (pair.mass * speeds)
        zero_overlap = self.ending == "zero_overlap"
        table = [rebound(gamma, self.exponent, self.damping_exponent, zero_overlap) for gamma in gammas]
        return Tabulated(speeds=tuple(speeds), values=tuple(min(e, 1.0) for e in table))


class Curve(Part):
    """A measured curve of force against overlap.

    Parameters
    ----------
    overlap
        Increasing overlaps [m].
    force
        Force at each of them [N].
    """

    overlap: tuple[Length, ...] = Field(examples=[["0 um", "10 um", "20 um"]])
    force: tuple[Force, ...] = Field(examples=[["0 N", "50 N", "140 N"]])

    @model_validator(mode="after")
    def _validate(self) -> Curve:
        check_curve(self.overlap, self.force)
        return self


def check_curve(overlap: tuple[float, ...], force: tuple[float, ...]) -> None:
    """Raise if overlaps and forces differ in number, if overlaps or forces decrease, or if a force is negative."""
    if len(overlap) != len(force) or len(overlap) < 2:
        raise Hint(f"{len(overlap)} overlaps, but {len(force)} forces", "as many of both, at least two", ["force"])
    if any(b <= a for a, b in pairwise(overlap)):
        raise Hint("overlaps must increase", "points in the order of the overlap", ["overlap"])
    if any(b < a for a, b in pairwise(force)) or force[0] < 0 or force[-1] <= 0:
        raise Hint(
            "forces must not be negative and must not decrease with the overlap",
            "the part of the measurement up to its largest force",
            ["force"],
        )


class TabulatedNormal(Contact):
    """Contact with a measured curve of force against overlap, and another curve for unloading.

    Parameters
    ----------
    overlap
        Increasing overlaps, the first 0 [m].
    force
        Force at each of them while loading, the first 0 [N].
    unloading
        Curve measured while unloading from one largest overlap; its first force is 0, at the residual overlap. Without it
        the contact is elastic.

    Notes
    -----
    Loading follows F = f(d). Between points, f is a monotone piecewise cubic whose slope at a point is the weighted harmonic
    mean of the slopes of the two chords (Fritsch and Butland); beyond the last point the force continues with the last
    slope. Unloading from the overlap d_max follows F = f(d_max) g(d / d_max), where g is the unloading curve over its
    largest force and overlap: it keeps its shape for other largest overlaps. The curves hold for the pair, independent of
    materials and sizes. The restitution is the square root of the work of unloading over that of loading.

    References
    ----------
    F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, doi:10.1137/0905021 (interpolation).
    """

    kind: Literal["tabulated"] = "tabulated"
    overlap: tuple[Length, ...] = Field(examples=[["0 um", "10 um", "20 um"]])
    force: tuple[Force, ...] = Field(examples=[["0 N", "50 N", "140 N"]])
    unloading: Curve | None = None

    @model_validator(mode="after")
    def _validate(self) -> TabulatedNormal:
        check_curve(self.overlap, self.force)
        if self.overlap[0] != 0 or self.force[0] != 0:
            raise Hint("a loading curve must begin at zero overlap and force", "overlap = [0, ...], force = [0, ...]")
        if self.unloading is not None:
            with at("unloading"):
                if self.unloading.force[0] != 0 or self.unloading.overlap[0] < 0:
                    raise Hint(
                        "an unloading curve must begin at the residual overlap with zero force", "force = [0, ...]"
                    )
                top = self.unloading.overlap[-1]
                there = float(self._loading(top)) if top <= self.overlap[-1] else math.nan
                if not abs(self.unloading.force[-1] - there) <= 0.01 * there:
                    raise Hint(
                        f"its last point, {self.unloading.force[-1]:.4g} N at {top:.4g} m, is not on the loading curve, "
                        f"{there:.4g} N; it must be within 1 %",
                        "the point at which the measurement turned from loading to unloading",
                    )
                if self._returned_share(top) > 1.001:
                    raise Hint(
                        "unloading returns more energy than loading absorbed",
                        "an unloading curve below the loading curve, and more points of both if they are close",
                    )
        return self

    @cached_property
    def _loading(self) -> Any:
        """Force against overlap while loading."""
        from scipy.interpolate import PchipInterpolator

        return PchipInterpolator(self.overlap, self.force)

    @cached_property
    def _unloading(self) -> Any:
        """Unloading curve, normalised by the largest force and the largest overlap."""
        from scipy.interpolate import PchipInterpolator

        if self.unloading is None:
            return None
        overlap, force = np.array(self.unloading.overlap), np.array(self.unloading.force)
        return PchipInterpolator(overlap / overlap[-1], force / force[-1])

    def _returned_share(self, deepest: object) -> Any:
        """Return the ratio of the work of unloading from these overlaps to the work of loading."""
        if self._unloading is None:
            return np.ones_like(deepest)
        area = self._unloading.integrate(self._unloading.x[0], 1.0)
        force, work = self._load(deepest)
        return force * deepest * area / work

    def _load(self, overlap: Any) -> tuple[Any, Any]:
        """Return force [N] and work [J] of loading, also beyond the last point, where the force has the last slope."""
        last = self.overlap[-1]
        inside, beyond = np.minimum(overlap, last), np.maximum(overlap - last, 0.0)
        force, slope = self._loading(inside), float(self._loading(last, 1))
        work = self._loading.antiderivative()(inside) + beyond * (force + slope * beyond / 2)
        return force + slope * beyond, work

    @property
    def measured_overlap(self) -> float | None:
        """Last overlap of the loading curve [m]."""
        return self.overlap[-1]

    def static_overlap(self, pair: Pair, softening: float, force: float) -> float:
        """Return the overlap at rest under a force by the secant of the loading curve [m]."""
        unsoftened = force * softening
        largest = next((k for k, other in enumerate(self.force) if other > unsoftened), -1)
        return unsoftened * self.overlap[largest] / self.force[largest]

    @property
    def force_exponent(self) -> float:
        """Exponent of the force in the overlap."""
        return 1.0

    def coefficients(self, pair: Pair) -> Coefficients:
        """Return the piecewise cubics of both curves."""
        values: dict[str, Any] = {"stiffness": 1.0, "mass": pair.mass, **_pieces("loading", self._loading)}
        if self._unloading is None:
            empty = ("unloading_knots", "unloading_coefficients", "unloading_integral")
            return "tabulated", values | dict.fromkeys(empty, np.zeros(0))
        return "tabulated", values | _pieces("unloading", self._unloading)

    def softened(self, pair: Pair, softening: float) -> Coefficients:
        """Return `coefficients` with forces divided by a factor."""
        name, values = self.coefficients(pair)
        return name, values | {"stiffness": 1.0 / softening}

    def equivalent_restitution(self, pair: Pair) -> Restitution:
        """Return the restitution of this contact as a table over the speed."""
        if isinstance(pair.mass, np.ndarray):
            raise Hint(
                "the method Newton cannot vary masses of measured contacts within one study; EventDriven can",
                "method = EventDriven()",
            )
        last = self.overlap[-1]
        deepest = np.concatenate([np.linspace(0, last, 181)[1:], last * np.geomspace(1, EXTRAPOLATED, 181)[1:]])
        _, work = self._load(deepest)
        returned = np.minimum(self._returned_share(deepest), 1.0)
        return Tabulated(speeds=tuple(np.sqrt(2 * work / pair.mass)), values=tuple(np.sqrt(returned)))


def _pieces(name: str, curve: Any) -> dict[str, Any]:
    """Return knots, coefficients and integrals of a piecewise cubic for the core."""
    return {
        f"{name}_knots": np.ascontiguousarray(curve.x),
        f"{name}_coefficients": np.ascontiguousarray(curve.c.T).ravel(),
        f"{name}_integral": np.ascontiguousarray(curve.antiderivative()(curve.x)),
    }


AnyContact = Annotated[Contact, AnyKind()]
