"""Free motion of x'' + 2 zeta x' + x = 0 and its forced amplitude; zeta < 1."""

import math

import numpy as np
from numpy.typing import NDArray


def transition(zeta: float, t: float) -> NDArray[np.float64]:
    """Matrix that takes (x, x') over a time t, shape (2, 2)."""
    wd = math.sqrt(1 - zeta * zeta)
    c, s, decay = math.cos(wd * t), math.sin(wd * t), math.exp(-zeta * t)
    return decay * np.array([[c + zeta / wd * s, s / wd], [-s / wd, c - zeta / wd * s]])


def amplitude(zeta: float, omega: float, force: float = 1.0) -> float:
    """Amplitude of the steady response to a harmonic force."""
    return force / math.hypot(1 - omega * omega, 2 * zeta * omega)


def lag(zeta: float, omega: float) -> float:
    """Phase by which the steady response lags behind the force, in [0, pi]."""
    return math.atan2(2 * zeta * omega, 1 - omega * omega)


def roots(a: float, b: float, c: float) -> tuple[float, float]:
    """Real roots of a x^2 + b x + c, the larger one first."""
    root = math.sqrt(b * b - 4 * a * c)
    q = -0.5 * (b + math.copysign(root, b))
    return max(q / a, c / q), min(q / a, c / q)
