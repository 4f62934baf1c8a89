"""Restitution as a function of the approach speed: Jackson-Green and Thornton."""

import math


def jackson_green(ratio: float, yield_strain: float) -> float:
    """Restitution at V / V_c = ratio, 0 <= ratio <= 1000."""
    if ratio <= 1:
        return 1.0
    if ratio <= 60:
        return 1 - 0.1 * math.log(ratio) * ((ratio - 1) / 59) ** 0.156
    exponent = 2.36 * yield_strain
    return 1 - 0.1 * math.log(60) - 0.11 * math.log(ratio / 60) * (ratio - 60) ** exponent


def jackson_green_after(ratio: float, hits: int, yield_strain: float) -> float:
    """V / V_c of a ball in a still cavity after a number of hits."""
    for _ in range(hits):
        ratio *= jackson_green(ratio, yield_strain)
    return ratio


def jackson_green_speed(radius: float, mass: float, modulus: float, yield_stress: float, poisson: float) -> float:
    """Critical speed V_c [m/s] from R*, m*, E*, S_y and the Poisson ratio of the body that yields."""
    c = 1.295 * math.exp(0.736 * poisson)
    overlap = (math.pi * c * yield_stress / (2 * modulus)) ** 2 * radius
    force = 4 / 3 * (radius / modulus) ** 2 * (math.pi * c * yield_stress / 2) ** 3
    return math.sqrt(4 * overlap * force / (5 * mass))


THORNTON_TAIL = math.sqrt(6 * math.sqrt(3) / 5) * (2 * math.sqrt(6 / 5)) ** -0.25
"""e (V / V_y)^(1/4) for V / V_y to infinity."""


def thornton(ratio: float) -> float:
    """Restitution at V / V_y = ratio."""
    if ratio <= 1:
        return 1.0
    r = 1 / ratio
    return (
        math.sqrt(6 * math.sqrt(3) / 5)
        * math.sqrt(1 - r * r / 6)
        * (r / (r + 2 * math.sqrt(6 / 5 - r * r / 5))) ** 0.25
    )


def thornton_speed(radius: float, mass: float, modulus: float, yield_pressure: float) -> float:
    """Yield speed V_y [m/s] from R*, m*, E* and the contact pressure at yield."""
    return (math.pi / (2 * modulus)) ** 2 * math.sqrt(8 * math.pi * radius**3 / (15 * mass)) * yield_pressure**2.5
