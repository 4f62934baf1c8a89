"""Runs whose end is known in closed form: for the program, and for its stored answers."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .runs import Run

STEEL = {"density": 7800.0, "young": 2.1e11, "poisson": 0.3, "yield_stress": 9e8}
Numbers = dict[str, Any]


class ClosedForm(NamedTuple):
    """A run, the paths of its parameters, and its state at the end as an analytic function of start and parameters.

    The function takes the state at the start (positions, then velocities) and the parameters by path. Entries of its
    result that are NaN are not known.
    """

    run: Run
    paths: list[str]
    end: Callable[[list[Any], Numbers], list[Any]]

    def start(self) -> list[float]:
        """Return the state at the start."""
        structure, tuned = self.run["structure"], self.run["tuned"]
        assert not tuned
        free = structure["kind"] == "fixed"
        positions = [] if free else [structure["displacement"]]
        velocities = [] if free else [structure["velocity"]]
        for damper in self.run["dampers"]:
            centre = 0.0 if free else structure["displacement"]
            positions += [centre + ball["start"] * damper["gap"] for ball in damper["balls"]]
            velocities += [ball["velocity"] for ball in damper["balls"]]
        return positions + velocities

    def values(self) -> Numbers:
        """Return the parameters by path."""
        damper = self.run["dampers"][0]
        found: Numbers = {}
        for path in self.paths:
            part: Any = self.run
            for name in path.replace("[", ".").replace("]", "").replace("base.", "loads.0.").split("."):
                part = part[int(name)] if name.isdigit() else part["e"] if name == "e" else part[name]
            found[path] = part["e"] if isinstance(part, dict) else part
        return found | {"gap": damper["gap"]}

    def state(self) -> NDArray[np.float64]:
        """Return the state at the end."""
        return np.real(np.array(self.end(self.start(), self.values()), dtype=complex))

    def derivatives(self) -> NDArray[np.float64]:
        """Return its derivatives in the state at the start and in the parameters, by complex steps: exact to rounding."""
        start, values, tiny = self.start(), self.values(), 1e-30
        columns = []
        for i in range(len(start)):
            moved = [x + 1j * tiny * (i == k) for k, x in enumerate(start)]
            columns.append(self.end(moved, values))
        for path in self.paths:
            changed = values | {path: values[path] + 1j * tiny}
            moved = list(start)
            if path == "dampers[0].gap":  # starts are fractions of the gap
                fractions = [ball["start"] for ball in self.run["dampers"][0]["balls"]]
                changed["gap"] = changed[path]
                moved[: len(fractions)] = [f * changed[path] for f in fractions]
            columns.append(self.end(moved, changed))
        slopes = np.imag(np.array(columns, dtype=complex).T) / tiny
        slopes[np.isnan(self.state())] = np.nan
        return slopes


def ball(radius: float = 8e-3, start: float = 0.0, velocity: float = 0.0) -> Run:
    """Return a ball of steel."""
    return {"radius": radius, "material": STEEL, "start": start, "velocity": velocity}


def mass_of(each: Run, density: Any = None) -> Any:
    """Return the mass of a ball."""
    return 4 / 3 * math.pi * each["radius"] ** 3 * (each["material"]["density"] if density is None else density)


def fixed(balls: list[Run], contact: Run, *, hard: bool, end: float, gap: float = 5e-3, gravity: float = 0.0) -> Run:
    """Return a run of balls in a cavity at rest."""
    damper = {"place": -1, "gap": gap, "gravity": gravity, "balls": balls, "wall": "rigid"}
    damper |= {"contact": contact, "ball_contact": contact}
    return {
        "structure": {"kind": "fixed"},
        "tuned": [],
        "loads": [],
        "dampers": [damper],
        "hard": hard,
        "target": 1,
        "fraction": 0.5,
        "end": end,
    }


def constant(e: float) -> Run:
    """Return Tsuji's contact with a constant restitution."""
    return {"kind": "tsuji", "restitution": {"kind": "constant", "e": e}, "ending": "zero_force"}


def exchange(e: float, sizes: tuple[float, float]) -> ClosedForm:
    """Return two balls that hit each other once, hard."""
    balls = [ball(sizes[0], -0.6, 0.35), ball(sizes[1], 0.3, -0.12)]
    end = 0.02
    path = "dampers[0].ball_contact.restitution"

    def state(start: list[Any], values: Numbers) -> list[Any]:
        x, y, u, v = start
        m, n = mass_of(balls[0]), mass_of(balls[1])
        touch = (y - x) / (u - v)
        impulse = (1 + values.get(path, e)) * (u - v) * m * n / (m + n)
        after = u - impulse / m, v + impulse / n
        at = x + u * touch, y + v * touch
        return [at[0] + after[0] * (end - touch), at[1] + after[1] * (end - touch), *after]

    return ClosedForm(fixed(balls, constant(e), hard=True, end=end), [path] if e < 1 else [], state)


def bouncing() -> ClosedForm:
    """Return a ball that hits a floor twice, hard."""
    end, e = 0.105, 0.8
    paths = ["dampers[0].gap", "dampers[0].contact.restitution"]

    def state(start: list[Any], values: Numbers) -> list[Any]:
        x, v = start
        g, r = 9.81, values[paths[1]]
        height = x + values["gap"]
        speed = (v * v + 2 * g * height) ** 0.5
        first = (v + speed) / g
        second = first + 2 * r * speed / g
        w = r * r * speed
        s = end - second
        return [-values["gap"] + w * s - g * s * s / 2, w - g * s]

    run = fixed([ball(start=-0.1, velocity=0.05)], constant(e), hard=True, end=end, gravity=-9.81)
    return ClosedForm(run, paths, state)


def dashpot(ending: str) -> ClosedForm:
    """Return a ball that hits a wall with a linear spring and dashpot."""
    contact = {"kind": "linear_damping", "stiffness": 4e5, "damping": 25.0, "ending": ending}
    run = fixed([ball(start=0.2, velocity=0.3)], contact, hard=False, end=0.025)
    paths = ["dampers[0].gap", "dampers[0].contact.stiffness", "dampers[0].contact.damping"]
    paths.append("dampers[0].balls[0].material.density")

    def state(start: list[Any], values: Numbers) -> list[Any]:
        x, v = start
        k, c, m = values[paths[1]], values[paths[2]], mass_of(run["dampers"][0]["balls"][0], values[paths[3]])
        w = (k / m) ** 0.5
        z = c / (2 * (k * m) ** 0.5)
        s = (1 - z * z) ** 0.5
        # At zero force the cosine of the angle w s t is 2 z^2 - 1.
        angle = math.pi if ending == "zero_overlap" else 2 * cmath.acos(z)
        t = angle / (w * s)
        decay = cmath.exp(-z * w * t)
        depth = v / (w * s) * decay * cmath.sin(angle)
        rate = v * decay * (cmath.cos(angle) - z / s * cmath.sin(angle))
        left = 0.025 - (values["gap"] - x) / v - t
        return [values["gap"] + depth + rate * left, rate]

    return ClosedForm(run, paths, state)


def hertz() -> ClosedForm:
    """Return an elastic Hertz contact with a rigid wall, whose duration is known."""
    run = fixed([ball(start=0.1, velocity=0.4)], constant(1.0), hard=False, end=0.02)
    paths = ["dampers[0].gap", "dampers[0].balls[0].material.young", "dampers[0].balls[0].radius"]
    duration = 2 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)

    def state(start: list[Any], values: Numbers) -> list[Any]:
        x, v = start
        r = values[paths[2]]
        a = 4 / 3 * values[paths[1]] / (1 - STEEL["poisson"] ** 2) * r**0.5
        m = 4 / 3 * math.pi * r**3 * STEEL["density"]
        t = duration * (5 / 4 * m / a) ** 0.4 * v**-0.2
        return [values["gap"] - v * (0.02 - (values["gap"] - x) / v - t), -v]

    return ClosedForm(run, paths, state)


def tsuji(ending: str) -> ClosedForm:
    """Return a damped Hertz contact, whose restitution is known, but not its duration."""
    contact = constant(0.55) | {"ending": ending}
    run = fixed([ball(start=0.1, velocity=0.4)], contact, hard=False, end=0.02)
    paths = ["dampers[0].gap", "dampers[0].contact.restitution", "dampers[0].balls[0].material.young"]
    return ClosedForm(run, paths, lambda start, values: [math.nan, -values[paths[1]] * start[1]])


def thornton() -> ClosedForm:
    """Return a contact that yields, whose restitution is known, but not its duration."""
    contact = {"kind": "thornton", "yield_pressure": 8e8}
    run = fixed([ball(start=0.1, velocity=0.4)], contact, hard=False, end=0.02)
    paths = ["dampers[0].gap", "dampers[0].contact.yield_pressure", "dampers[0].balls[0].radius"]

    def state(start: list[Any], values: Numbers) -> list[Any]:
        v, p, r = start[1], values[paths[1]], values[paths[2]]
        modulus = STEEL["young"] / (1 - STEEL["poisson"] ** 2)
        m = 4 / 3 * math.pi * r**3 * STEEL["density"]
        yields = (math.pi / (2 * modulus)) ** 2 * (8 * math.pi * r**3 / (15 * m)) ** 0.5 * p**2.5
        q = yields / v
        e = (6 * 3**0.5 / 5) ** 0.5 * (1 - q * q / 6) ** 0.5 * (q / (q + 2 * (1.2 - q * q / 5) ** 0.5)) ** 0.25
        return [math.nan, -e * v]

    return ClosedForm(run, paths, state)


def oscillator() -> ClosedForm:
    """Return an oscillator under a harmonic force, with a ball that touches nothing."""
    structure = {"kind": "sdof", "mass": 0.7, "frequency": 8.0, "damping_ratio": 0.03}
    structure |= {"displacement": 1e-3, "velocity": -0.1}
    load = {
        "place": 0,
        "shape": "harmonic",
        "amplitude": 3.0,
        "frequency": 11.0,
        "phase": 0.4,
        "start": 0.0,
        "stop": None,
    }
    run = fixed([ball(start=0.05, velocity=0.02)], constant(0.5), hard=True, end=0.1, gap=0.05)
    run |= {"structure": structure, "loads": [load]}
    run["dampers"][0]["place"] = 0
    paths = ["structure.mass", "structure.frequency", "structure.damping_ratio"]
    paths += ["loads[0].amplitude", "loads[0].frequency", "loads[0].phase"]

    def state(start: list[Any], values: Numbers) -> list[Any]:
        x, s, v, u = start
        m, f, z, a, g, phase = (values[path] for path in paths)
        w, p, t = 2 * math.pi * f, 2 * math.pi * g, run["end"]
        size = a / m / ((w * w - p * p) ** 2 + (2 * z * w * p) ** 2)

        def steady(time: float) -> tuple[Any, Any]:
            sine, cosine = cmath.sin(p * time + phase), cmath.cos(p * time + phase)
            stiff, loss = w * w - p * p, 2 * z * w * p
            return size * (stiff * sine - loss * cosine), size * p * (stiff * cosine + loss * sine)

        x0, v0 = x - steady(0.0)[0], v - steady(0.0)[1]
        d, decay = w * (1 - z * z) ** 0.5, cmath.exp(-z * w * t)
        cosine, sine = cmath.cos(d * t), cmath.sin(d * t)
        b = (v0 + z * w * x0) / d
        position = decay * (x0 * cosine + b * sine) + steady(t)[0]
        velocity = decay * ((b * d - z * w * x0) * cosine - (x0 * d + z * w * b) * sine) + steady(t)[1]
        return [position, s + u * t, velocity, u]

    return ClosedForm(run, paths, state)


CLOSED_FORMS = {
    "two equal elastic balls": exchange(1.0, (8e-3, 8e-3)),
    "two balls": exchange(0.7, (8e-3, 6e-3)),
    "bouncing ball": bouncing(),
    "dashpot to zero force": dashpot("zero_force"),
    "dashpot to zero overlap": dashpot("zero_overlap"),
    "elastic Hertz contact": hertz(),
    "damped Hertz contact to zero force": tsuji("zero_force"),
    "damped Hertz contact to zero overlap": tsuji("zero_overlap"),
    "contact that yields": thornton(),
    "oscillator under a load": oscillator(),
}
