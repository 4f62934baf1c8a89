"""Random short runs, and the rules by which some are left out."""

from __future__ import annotations

from typing import Any

import numpy as np

from .runs import FIELDS, NEVER, NUMBERS, Answer, Run, deck_of, paths_of_loads, size

HARD = ("constant", "jackson_green", "thornton", "johnson", "table", "alpha", "contact")
SOFT = (
    "tsuji",
    "tsuji to zero overlap",
    "alpha",
    "jackson_green",
    "thornton restitution",
    "johnson",
    "table",
    "linear",
    "linear to zero overlap",
    "linear damping",
    "linear time",
    "power",
    "power to zero overlap",
    "thornton",
    "tabulated",
    "tabulated elastic",
)
FAMILIES = tuple(f"hard {name}" for name in HARD) + SOFT
"""Kinds of runs, drawn by turns."""
STOPS = tuple(f"{name} stops" for name in FAMILIES)
"""The same with stops, with or without a damper; soft ones may end within a contact."""

SLOW = 0.01
"""Smallest approach speed, as a part of the largest one of the run; below it a contact is close to grazing."""
MISS = 1e-5
"""Smallest distance of a miss, as a part of the smallest gap."""
TOGETHER = 1e-7
"""Smallest time between two hard impacts of a run [s]; derivatives do not exist for impacts at one instant."""
TIE = 0.1
"""Smallest difference of the logarithms of the hardness of two bodies in contact."""
GROWTH = 1e6
"""Largest growth of a small change, in units of the largest values of the motion."""
GROWTH_WITH_STOPS = 1e3
"""The same of runs with stops, half of which end within a contact, where derivatives change in microseconds."""


def uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a random number of five digits."""
    return float(f"{rng.uniform(low, high):.5g}")


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a random number of five digits whose logarithm is evenly spread."""
    return float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.5g}")


def restitution(rng: np.random.Generator, kind: str) -> Run:
    """Return a restitution law."""
    if kind == "constant":
        return {"kind": "constant", "e": uniform(rng, 0.2, 0.97)}
    if kind == "table":
        speeds = np.cumsum([uniform(rng, 0.02, 0.2) for _ in range(4)])
        values = sorted((uniform(rng, 0.3, 0.95) for _ in range(4)), reverse=True)
        return {"kind": "table", "speeds": [float(f"{v:.5g}") for v in speeds], "values": values}
    law: Run = {"kind": kind}
    if kind == "johnson" and rng.random() < 0.7:
        law["speed_scale"] = log_uniform(rng, 1e-4, 1e-2)
    if kind == "thornton" and rng.random() < 0.5:
        law["yield_pressure"] = log_uniform(rng, 2e8, 1.5e9)
    if rng.random() < 0.2:
        law["maximum"] = uniform(rng, 0.6, 0.95)
    return law


def contact(rng: np.random.Generator, family: str) -> Run:
    """Return a contact law of a family of runs."""
    ending = "zero_overlap" if family.endswith("zero overlap") else "zero_force"
    if family.startswith("hard "):
        kind = family.removeprefix("hard ")
        if kind == "alpha":
            return {"kind": "tsuji_alpha", "alpha": uniform(rng, 0.02, 1.5), "ending": ending}
        if kind == "contact":
            return {"kind": "thornton", "yield_pressure": log_uniform(rng, 2e8, 1.5e9)}
        return {"kind": "tsuji", "restitution": restitution(rng, kind), "ending": ending}
    if family == "alpha":
        return {"kind": "tsuji_alpha", "alpha": uniform(rng, 0.02, 1.5), "ending": ending}
    if family == "linear damping":
        k = log_uniform(rng, 3e4, 3e6)
        return {
            "kind": "linear_damping",
            "stiffness": k,
            "damping": uniform(rng, 0.02, 0.3) * k**0.5 * 0.1,
            "ending": ending,
        }
    if family == "linear time":
        law = {"kind": "linear_time", "contact_time": log_uniform(rng, 1e-4, 2e-3), "ending": ending}
        return law | {"restitution": restitution(rng, str(rng.choice(["constant", "jackson_green", "table"])))}
    if family.startswith("linear"):
        law = {"kind": "linear", "stiffness": log_uniform(rng, 3e4, 3e6), "ending": ending}
        return law | {"restitution": restitution(rng, str(rng.choice(["constant", "constant", "johnson", "table"])))}
    if family == "power":
        n = uniform(rng, 1.1, 1.9)
        p = uniform(rng, 0.25, n - 0.6) if n > 0.9 else 0.25
        # The force of a mass of 20 g at 0.3 m/s with an overlap of 20 um, and a dashpot that takes some of its speed.
        k = log_uniform(rng, 0.3, 3.0) * 0.02 * 0.3**2 / 2e-5 ** (n + 1)
        c = uniform(rng, 0.1, 0.7) * 0.02 * 0.3 / 2e-5 ** (p + 1)
        law = {"kind": "power", "stiffness": float(f"{k:.5g}"), "exponent": n, "damping_exponent": p}
        return law | {"damping": float(f"{c:.5g}"), "ending": ending}
    if family == "power to zero overlap":
        n, p = float(rng.choice([1.0, 1.25, 1.5, 1.75, 2.0])), float(rng.choice([0.25, 0.5, 1.0, 1.5]))
        k = log_uniform(rng, 0.3, 3.0) * 0.02 * 0.3**2 / 2e-5 ** (n + 1)
        c = uniform(rng, 0.1, 0.7) * 0.02 * 0.3 / 2e-5 ** (p + 1)
        law = {"kind": "power", "stiffness": float(f"{k:.5g}"), "exponent": n, "damping_exponent": p}
        ends = "zero_overlap" if rng.random() < 0.6 or p >= n else "zero_force"
        return law | {"damping": float(f"{c:.5g}"), "ending": ends}
    if family == "thornton":
        given = log_uniform(rng, 2e8, 1.5e9) if rng.random() < 0.6 else None
        return {"kind": "thornton", "yield_pressure": given}
    if family.startswith("tabulated"):
        last = log_uniform(rng, 1e-4, 4e-4)
        overlap = np.linspace(0, last, 6) ** 1.2 * last**-0.2
        force = uniform(rng, 300, 3000) * (overlap / last) ** uniform(rng, 1.1, 1.8) * (1 + 0.1 * rng.random(6))
        part = np.linspace(uniform(rng, 0.2, 0.6), 1, 4)
        back = force[-1] * ((part - part[0]) / (1 - part[0])) ** uniform(rng, 1.3, 2.0)
        tidy = [[float(f"{x:.5g}") for x in values] for values in (overlap, np.sort(force), part * last, back)]
        tidy[2][-1], tidy[3][-1] = tidy[0][-1], tidy[1][-1]
        unloading = {"overlap": tidy[2], "force": tidy[3]} if family == "tabulated" else {"overlap": [], "force": []}
        return {"kind": "tabulated", "overlap": tidy[0], "force": tidy[1], "unloading": unloading}
    kind = {"tsuji": "constant", "tsuji to zero overlap": "constant", "thornton restitution": "thornton"}.get(
        family, family
    )
    return {"kind": "tsuji", "restitution": restitution(rng, kind), "ending": ending}


def structure(rng: np.random.Generator) -> Run:
    """Return a structure: one degree of freedom, two or three with any damping, or none."""
    kind = rng.choice(["sdof", "matrices", "fixed"], p=[0.55, 0.37, 0.08])
    if kind == "fixed":
        return {"kind": "fixed"}
    if kind == "sdof":
        return {
            "kind": "sdof",
            "mass": uniform(rng, 0.2, 2),
            "frequency": uniform(rng, 4, 15),
            "damping_ratio": uniform(rng, 0, 0.05) if rng.random() < 0.9 else uniform(rng, 0.5, 1.5),
            "displacement": uniform(rng, -3e-3, 3e-3),
            "velocity": uniform(rng, -0.3, 0.3),
        }
    n = int(rng.integers(2, 4))
    mass = np.diag([uniform(rng, 0.2, 1.5) for _ in range(n)])
    if rng.random() < 0.3:
        mass[0, 1] = mass[1, 0] = uniform(rng, 0.01, 0.1)

    def chain(low: float, high: float) -> Any:
        springs = [log_uniform(rng, low, high) for _ in range(n)]
        matrix = np.diag(springs) + np.diag([*springs[1:], 0.0])
        for i in range(1, n):
            matrix[i, i - 1] = matrix[i - 1, i] = -springs[i]
        return matrix

    stiffness = chain(400, 8000)
    damping = chain(0.1, 5) if rng.random() < 0.6 else stiffness * uniform(rng, 1e-4, 1e-3)
    return {
        "kind": "matrices",
        "M": mass.tolist(),
        "C": np.vectorize(lambda x: float(f"{x:.5g}"))(damping).tolist(),
        "K": np.vectorize(lambda x: float(f"{x:.7g}"))(stiffness).tolist(),
        "displacement": [uniform(rng, -3e-3, 3e-3) for _ in range(n)],
        "velocity": [uniform(rng, -0.3, 0.3) for _ in range(n)],
    }


def load(rng: np.random.Generator, place: int) -> Run:
    """Return a load at a degree of freedom, or a motion of the base (-1)."""
    shape = str(rng.choice(list(FIELDS), p=[0.6, 0.2, 0.1, 0.1]))
    sign = float(rng.choice([-1, 1]))
    if shape == "harmonic":
        limited = rng.random() < 0.3
        start = uniform(rng, 0, 0.02) if limited else 0.0
        return {
            "place": place,
            "shape": shape,
            "amplitude": uniform(rng, 1, 8),
            "frequency": uniform(rng, 4, 25),
            "phase": uniform(rng, 0.1, 3),
            "start": start,
            "stop": start + uniform(rng, 0.01, 0.05) if limited else None,
        }
    duration = uniform(rng, 2e-3, 2e-2)
    pulse = {"place": place, "shape": shape, "amplitude": sign * uniform(rng, 5, 40), "duration": duration}
    pulse["start"] = uniform(rng, 0, 0.02)
    if shape == "sawtooth":
        pulse["peak"] = str(rng.choice(["terminal", "initial"]))
    if shape == "trapezoid":
        pulse |= {"rise": float(f"{0.2 * duration:.4g}"), "fall": float(f"{0.3 * duration:.4g}")}
    return pulse


def material(rng: np.random.Generator, others: list[Run]) -> Run:
    """Return a material like steel, brass, or aluminium, which is clearly harder or softer than others.

    Laws that take the softer one of two bodies have no derivative where both are equal.
    """
    while True:
        result = {
            "density": uniform(rng, 2700, 8000),
            "young": uniform(rng, 7e10, 2.1e11),
            "poisson": uniform(rng, 0.25, 0.35),
            "yield_stress": log_uniform(rng, 2e8, 1.2e9),
        }
        if all(abs(np.log(_hardness(result) / _hardness(other))) > TIE for other in others):
            return result


def _hardness(material: Run) -> float:
    return float(material["yield_stress"] * np.exp(0.736 * material["poisson"]))


def damper(rng: np.random.Generator, family: str, place: int, most: int) -> Run:
    """Return a damper with a row of balls."""
    count = int(rng.choice([1, 2, 3][:most], p=np.array([0.6, 0.25, 0.15][:most]) / sum([0.6, 0.25, 0.15][:most])))
    matter: list[Run] = []
    for _ in range(count):
        matter.append(material(rng, matter))
    edges = np.linspace(-0.9, 0.9, count + 1)
    law = contact(rng, family)
    between = contact(rng, family) if rng.random() < 0.4 else law
    wall: Any = "ball"
    if rng.random() < 0.4:
        own = material(rng, matter)
        del own["density"]
        wall = own if rng.random() < 0.6 else "rigid"
    return {
        "place": place,
        "gap": uniform(rng, 5e-4, 3e-3),
        "gravity": float(rng.choice([0.0, 9.81, -9.81], p=[0.6, 0.2, 0.2])),
        "balls": [
            {
                "radius": uniform(rng, 5e-3, 1e-2),
                "material": matter[k],
                "start": uniform(rng, edges[k] + 0.03, edges[k + 1] - 0.03),
                "velocity": uniform(rng, -0.3, 0.3),
            }
            for k in range(count)
        ],
        "wall": wall,
        "contact": law,
        "ball_contact": between,
    }


def stop(rng: np.random.Generator, family: str, places: int) -> Run:
    """Return a stop between a degree of freedom and the ground or another one."""
    place = int(rng.integers(places))
    others = [-1, *(other for other in range(places) if other != place)]
    return {
        "place": place,
        "other": int(rng.choice(others)),
        "side": str(rng.choice(["leading", "trailing"])),
        "gap": uniform(rng, 5e-4, 3e-3),
        "radius": uniform(rng, 5e-3, 3e-2),
        "material": material(rng, []),
        "wall": str(rng.choice(["own", "rigid"])),
        "contact": contact(rng, family),
    }


def draw(rng: np.random.Generator, family: str) -> Run:
    """Return a random run of a family."""
    has_stops, family = family in STOPS, family.removesuffix(" stops")
    base = structure(rng)
    while has_stops and base["kind"] == "fixed":
        base = structure(rng)
    own = {"sdof": 1, "fixed": 0}.get(base["kind"]) if base["kind"] != "matrices" else len(base["M"])
    assert own is not None
    tuned = [
        {
            "place": int(rng.integers(own)),
            "mass": uniform(rng, 0.02, 0.15),
            "frequency": uniform(rng, 4, 15),
            "damping_ratio": uniform(rng, 0, 0.2),
            "displacement": uniform(rng, -2e-3, 2e-3),
            "velocity": uniform(rng, -0.1, 0.1),
        }
        for _ in range(int(rng.choice([0, 1, 2], p=[0.5, 0.35, 0.15])) if own else 0)
    ]
    all_places = own + len(tuned)
    loads = [load(rng, int(rng.integers(own)))] if own and rng.random() < 0.7 else []
    if rng.random() < 0.3 or not own:
        loads.append(load(rng, -1))
    count = int(rng.integers(2)) if has_stops else int(rng.choice([1, 2, 3], p=[0.45, 0.35, 0.2]))
    dampers = []
    for i in range(count):
        # Balls of a tenth of the mass that carries them: heavy ones belong to the structure, not to a tuned mass.
        place = int(rng.integers(all_places if rng.random() < 0.2 else own)) if own else -1
        dampers.append(damper(rng, family, place, 3 if i == 0 else 1))
    run = {
        "structure": base,
        "tuned": tuned,
        "loads": loads,
        "dampers": dampers,
        "hard": family.startswith("hard "),
        "target": int(rng.integers(2, 9)),
        "fraction": uniform(rng, 0.2, 0.8),
    }
    if has_stops:
        run["stops"] = [stop(rng, family, all_places) for _ in range(int(rng.integers(1, 3)))]
        if family in SOFT and rng.random() < 0.5:
            run["fraction"] *= -1  # ends within a contact
    return run


def parameters(rng: np.random.Generator, run: Run, most: int = 5) -> list[str]:
    """Return some of the parameters of a run: always a gap, and the numbers of loads, structure, laws and balls."""
    deck, _ = deck_of(run)
    loads = paths_of_loads(run)
    laws = {
        f"dampers[{i}].{name}.{number}"
        for i, each in enumerate(run["dampers"])
        for name in ("contact", "ball_contact")
        for number in NUMBERS[each[name]["kind"]]
    }
    used = {path for path, at in deck.index.items() if deck.numbers[at] not in (0, NEVER)}
    # Pulses of straight lines are tables for the core, in whose entries there are no derivatives.
    for where, each in zip(loads, run["loads"], strict=True):
        if each["shape"] in ("sawtooth", "trapezoid"):
            used = {path for path in used if not path.startswith(where)}
    # The walls of a row without contacts between balls have no second law; a law that both share is one number twice.
    for i, each in enumerate(run["dampers"]):
        if len(each["balls"]) == 1:
            used = {path for path in used if not path.startswith(f"dampers[{i}].ball_contact")}
        if run["hard"] and each["contact"]["kind"] == "tsuji":
            used -= {path for path in laws if path.startswith(f"dampers[{i}].")}
    stops = run.get("stops", [])
    gaps = [f"dampers[{i}].gap" for i in range(len(run["dampers"]))] + [f"stops[{i}].gap" for i in range(len(stops))]
    first = [str(rng.choice(gaps))]
    groups = [
        [path for path in sorted(used) if path.startswith(("loads", "base"))],
        [path for path in sorted(used) if ".contact" in path or ".ball_contact" in path],
        [path for path in sorted(used) if path.startswith(("structure", "tuned"))],
        [path for path in sorted(used) if path.startswith("dampers") and ".balls" in path],
        [path for path in sorted(used) if path.startswith("stops") and not path.endswith(".gap")],
        [path for path in sorted(used) if path.endswith((".start", ".velocity")) and path.startswith("dampers")],
    ]
    chosen = first + [str(rng.choice(group)) for group in groups if group]
    rest = [path for path in sorted(used) if path not in chosen]
    chosen += [str(path) for path in rng.permutation(rest)]
    return list(dict.fromkeys(chosen))[:most]


def gaps_of(run: Run) -> list[float]:
    """Return the gaps of dampers and stops."""
    return [each["gap"] for each in [*run["dampers"], *run.get("stops", [])]]


def scales(run: Run, touches: Any, paths: list[str]) -> tuple[Any, Any]:
    """Return the sizes of the state and of all directions, in which derivatives are compared.

    Positions have the largest gap, velocities the largest approach speed, and parameters their own size.
    """
    deck, _ = deck_of(run)
    length = max(gaps_of(run))
    speed = max(touch[3] for touch in touches)
    state = np.array([length] * size(run) + [speed] * size(run))
    values = [abs(deck.numbers[deck.index[path]]) or 1.0 for path in paths]
    return state, np.concatenate([state, values])


def left_out(run: Run, answer: Answer, paths: list[str]) -> str:
    """Return why a run is left out, by rules for the motion alone; empty if it is not."""
    speeds = [touch[3] for touch in answer.touches]
    times = [touch[2] for touch in answer.touches]
    if min(speeds) < SLOW * max(speeds):
        return "slow"
    if answer.miss < MISS * min(gaps_of(run)):
        return "miss"
    if run["hard"] and len(times) > 1 and min(np.diff(times)) < TOGETHER:
        return "together"
    if not answer.derivatives.size:  # the motion alone
        return ""
    rows, columns = scales(run, answer.touches, paths)
    growth = np.abs(answer.derivatives * columns / rows[:, None]).max()
    return "growth" if not growth < (GROWTH_WITH_STOPS if run.get("stops") else GROWTH) else ""
