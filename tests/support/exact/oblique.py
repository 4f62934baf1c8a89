"""A sphere that hits a fixed plane obliquely: gross sliding and sticking in closed form, and integration of the law.

Units: mass and radius of the sphere and its normal speed before the impact are one.
"""

import math
from dataclasses import dataclass


def sliding(angle: float, restitution: float, friction: float) -> tuple[float, float]:
    """Return tangential restitution, and spin times radius over normal speed, of a sphere that slides all the time.

    `angle` from the normal [rad]; with a lever of one radius.
    """
    return 1 - friction * (1 + restitution) / math.tan(angle), 2.5 * friction * (1 + restitution)


def sticking(ratio: float) -> float:
    """Return the tangential restitution of linear springs without damping, of a ratio of stiffness, that never slide.

    The contact point swings with the square frequency 7/2 x ratio while the normal spring makes half a swing.
    """
    return 1 - 2 / 7 * (1 - math.cos(math.pi * math.sqrt(3.5 * ratio)))


def mindlin_ratio(poisson: float) -> float:
    """Tangential over normal stiffness for like bodies, dT/ds over F/d: 8 G* sqrt(R d) over (4/3) E* sqrt(R d)."""
    return 3 * (1 - poisson) / (2 - poisson)


@dataclass(frozen=True)
class Impact:
    """A Hertz contact with Tsuji's dashpot, Mindlin's stiffness and Coulomb's limit.

    `alpha` damps along the normal, and tangentially `damping` times as much; `stiffness` is A. As the contact changes, the
    tangential spring loses force with its stiffness but never gains any ("eased"), keeps its force ("force"), or keeps its
    stretch ("stretch").
    """

    alpha: float
    ratio: float
    friction: float
    damping: float
    stiffness: float
    keeps: str = "eased"

    def follow(self, slip: float, steps: int = 4000) -> tuple[float, float, float]:
        """Return tangential velocity, spin and normal velocity after an impact with this tangential velocity before.

        Heun's rule; the lever of the contact is the radius less the overlap.
        """
        a = self.stiffness
        soft = self.ratio * a
        dt = 3.4 * a**-0.4 / steps
        d, v, u, w, spring, before = 0.0, 1.0, slip, 0.0, 0.0, 0.0
        share = self.damping * 2 * math.sqrt(5 / 6) * self.alpha / math.sqrt(5)

        def push(d: float, v: float) -> float:
            return max(0.0, a * d**1.5 + self.alpha * math.sqrt(a) * d**0.25 * v) if d > 0 else 0.0

        while True:
            ahead = v - 0.5 * dt * push(d, v)
            middle = d + 0.5 * dt * v
            if middle <= 0:
                return u, w, -v
            force = push(middle, ahead)
            firm = soft * math.sqrt(middle)
            lever = 1 - middle
            slipping = u + lever * w
            change = firm / before if before else 1.0
            spring *= {"eased": min(1.0, change), "force": 1.0, "stretch": change}[self.keeps]
            spring -= firm * slipping * dt
            limit = self.friction * force
            spring = max(-limit, min(limit, spring))
            room = limit - abs(spring)
            drag = max(-room, min(room, -share * math.sqrt(firm) * slipping))
            before = firm
            d, v = d + dt * ahead, v - dt * force
            u += dt * (spring + drag)
            w += 2.5 * dt * lever * (spring + drag)
