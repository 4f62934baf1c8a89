"""A ball against a still wall: Hertz contact with Tsuji's dashpot, and the linear spring-dashpot.

With Y = d^(5/4) and d(tau) = d^(1/4) dt Tsuji's equation
m d'' + A d^(3/2) + alpha sqrt(m A) d^(1/4) d' = 0 is the linear oscillator
Y'' + 2 zeta w Y' + w^2 Y = 0 with w^2 = 5 A / (4 m), zeta = alpha / sqrt(5) and Y'(0) = (5/4) V.
"""

import math

from scipy.integrate import quad
from scipy.optimize import minimize_scalar

HERTZ_TIME = 2.9432752
"""Contact time of an undamped Hertz impact, as a multiple of (largest overlap / speed)."""


def end_phase(zeta: float, ending: str) -> float:
    """Phase w_d tau of the oscillator at the end of the contact, 0 <= zeta < 1."""
    if ending == "zero_overlap":
        return math.pi
    s = math.sqrt(1 - zeta * zeta)
    return math.atan2(2 * zeta * s, 2 * zeta * zeta - 1)


def restitution(zeta: float, ending: str) -> float:
    """Coefficient of restitution for a damping ratio of the oscillator."""
    if ending == "zero_overlap":
        return math.exp(-math.pi * zeta / math.sqrt(1 - zeta * zeta)) if zeta < 1 else 0.0
    if zeta < 1:
        return math.exp(-zeta / math.sqrt(1 - zeta * zeta) * end_phase(zeta, ending))
    if zeta == 1:
        return math.exp(-2.0)
    s = math.sqrt(zeta * zeta - 1)
    return ((zeta - s) / (zeta + s)) ** (zeta / s)


def linear_contact_time(zeta: float, ending: str) -> float:
    """Contact time of the linear spring-dashpot times sqrt(k / m), zeta < 1."""
    return end_phase(zeta, ending) / math.sqrt(1 - zeta * zeta)


def tsuji_contact_time(zeta: float, ending: str) -> float:
    """Contact time of Tsuji's contact times (A / m)^(2/5) V^(1/5), zeta < 1; by quadrature of Y^(-1/5)."""
    w = math.sqrt(1.25)
    wd = w * math.sqrt(1 - zeta * zeta)
    end = end_phase(zeta, ending) / wd
    right = -0.2 if ending == "zero_overlap" or zeta == 0 else 0.0

    def regular(tau: float) -> float:
        """Y^(-1/5) without the powers of tau and (end - tau) at which it is singular."""
        phase = wd * tau
        sine = math.sin(phase) / phase if phase else 1.0
        if right:
            rest = wd * (end - tau)
            far = math.sin(rest) / rest if rest else 1.0
            half = 0.5 * end
            shape = sine / (end - tau) if tau < half else far / tau
        else:
            shape = sine
        return float((1.25 * math.exp(-zeta * w * tau) * shape) ** -0.2)

    value, _ = quad(regular, 0, end, weight="alg", wvar=(-0.2, right), epsabs=1e-13, epsrel=1e-13, limit=200)
    return float(value)


def tsuji_peak_overlap(zeta: float) -> float:
    """Largest overlap times (A / (m V^2))^(2/5), zeta < 1."""
    w, s = math.sqrt(1.25), math.sqrt(1 - zeta * zeta)
    phase = math.atan2(s, zeta)
    top = 1.25 * math.exp(-zeta / s * phase) * math.sin(phase) / (w * s)
    return float(top**0.8)


def linear_peak_force(zeta: float) -> float:
    """Largest force of the linear spring-dashpot over V sqrt(k m), zeta < 1."""
    s = math.sqrt(1 - zeta * zeta)

    def force(phase: float) -> float:
        decay = math.exp(-zeta / s * phase)
        return decay * (math.sin(phase) / s + 2 * zeta * (math.cos(phase) - zeta / s * math.sin(phase)))

    result = minimize_scalar(lambda p: -force(p), bounds=(0.0, math.pi), method="bounded", options={"xatol": 1e-12})
    return max(force(float(result.x)), 2 * zeta)
