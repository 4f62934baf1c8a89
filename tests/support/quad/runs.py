"""Short runs as plain numbers: drawn at random, as input of the program `motion.cpp`, and as cases of the package."""

from __future__ import annotations

import hashlib
import re
import subprocess
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import rattlebox as rb

SOURCE = Path(__file__).with_name("motion.cpp")
NEVER = 1e300
RESTITUTIONS = ("constant", "jackson_green", "thornton", "johnson", "table")
LAWS = ("tsuji", "tsuji_alpha", "linear", "linear_damping", "linear_time", "power", "thornton", "tabulated")
SHAPES = ("harmonic", "half_sine", "sawtooth", "trapezoid")
Run = dict[str, Any]


# ---- input of the program


@dataclass
class Deck:
    """Numbers of a run in the order in which the program reads them, and where the parameters of the case are."""

    numbers: list[float] = field(default_factory=list)
    index: dict[str, int] = field(default_factory=dict)

    def add(self, value: float, path: str | None = None) -> None:
        """Append a number, perhaps that of a parameter."""
        if path is not None:
            self.index[path] = len(self.numbers)
        self.numbers.append(float(value))

    def extend(self, values: Iterable[float]) -> None:
        """Append numbers."""
        for value in values:
            self.add(value)


def places(run: Run) -> int:
    """Return the number of degrees of freedom of structure and tuned masses."""
    structure = run["structure"]
    own = {"sdof": 1, "fixed": 0}.get(structure["kind"])
    return (len(structure["M"]) if own is None else own) + len(run["tuned"])


def deck_of(run: Run) -> tuple[Deck, int]:
    """Return the numbers of a run, and the index of its first offset of the state."""
    deck = Deck()
    structure = run["structure"]
    own = places(run) - len(run["tuned"])
    deck.add(own)
    deck.add(structure["kind"] != "sdof")
    if structure["kind"] == "sdof":
        for name in ("mass", "frequency", "damping_ratio", "displacement", "velocity"):
            deck.add(structure[name], f"structure.{name}")
    elif own:
        for name in ("M", "C", "K"):
            deck.extend(np.ravel(structure[name]))
        deck.extend(structure["displacement"])
        deck.extend(structure["velocity"])
    deck.add(len(run["tuned"]))
    for i, tuned in enumerate(run["tuned"]):
        deck.add(tuned["place"])
        for name in ("mass", "frequency", "damping_ratio", "displacement", "velocity"):
            deck.add(tuned[name], f"tuned_masses[{i}].{name}")
    deck.add(len(run["loads"]))
    for where, load in zip(paths_of_loads(run), run["loads"], strict=True):
        deck.add(load["place"])
        deck.add(SHAPES.index(load["shape"]))
        for name in FIELDS[load["shape"]]:
            value = load[name]
            if name == "peak":
                value = value == "initial"
            deck.add(NEVER if value is None else value, f"{where}.{name}")
    deck.add(len(run["dampers"]))
    for i, damper in enumerate(run["dampers"]):
        _add_damper(deck, damper, f"dampers[{i}]")
    stops = run.get("stops", [])
    deck.add(len(stops))
    for i, stop in enumerate(stops):
        _add_stop(deck, stop, f"stops[{i}]")
    deck.add(run["hard"])
    offsets = len(deck.numbers)
    deck.extend([0.0] * (2 * size(run)))
    deck.extend([run["target"], run["fraction"], run.get("end", 0.0)])
    return deck, offsets


FIELDS = {
    "harmonic": ("amplitude", "frequency", "phase", "start", "stop"),
    "half_sine": ("amplitude", "duration", "start"),
    "sawtooth": ("amplitude", "duration", "start", "peak"),
    "trapezoid": ("amplitude", "duration", "start", "rise", "fall"),
}


def paths_of_loads(run: Run) -> list[str]:
    """Return the path of each load in the case: forces first, then motions of the base."""
    forces = [load for load in run["loads"] if load["place"] >= 0]
    paths, counts = [], {"loads": 0, "base": 0}
    several = len(run["loads"]) - len(forces) > 1
    for load in run["loads"]:
        name = "loads" if load["place"] >= 0 else "base"
        paths.append(f"{name}[{counts[name]}]" if name == "loads" or several else name)
        counts[name] += 1
    return paths


def size(run: Run) -> int:
    """Return the number of positions: degrees of freedom and balls."""
    return places(run) + sum(len(damper["balls"]) for damper in run["dampers"])


def _add_damper(deck: Deck, damper: Run, path: str) -> None:
    deck.add(damper["place"])
    deck.add(damper["gap"], f"{path}.gap")
    deck.add(damper["gravity"], f"{path}.gravity")
    deck.add(len(damper["balls"]))
    single = len(damper["balls"]) == 1
    for k, ball in enumerate(damper["balls"]):
        deck.add(ball["radius"], f"{path}.balls[{k}].radius")
        _add_material(deck, ball["material"], f"{path}.balls[{k}].material")
        deck.add(ball["start"], f"{path}.start" if single else None)
        deck.add(ball["velocity"], f"{path}.velocity" if single else None)
    wall = damper["wall"]
    deck.add({"ball": 0, "rigid": 2}.get(wall, 1) if isinstance(wall, str) else 1)
    if isinstance(wall, dict):
        deck.extend([wall["young"], wall["poisson"], wall["yield_stress"]])
    _add_law(deck, damper["contact"], f"{path}.contact")
    _add_law(deck, damper["ball_contact"], f"{path}.ball_contact")


def _add_stop(deck: Deck, stop: Run, path: str) -> None:
    deck.extend([stop["place"], stop["other"], 1 if stop["side"] == "leading" else -1])
    deck.add(stop["gap"], f"{path}.gap")
    deck.add(stop["radius"], f"{path}.radius")
    deck.extend(stop["material"][name] for name in ("young", "poisson", "yield_stress"))
    deck.add(2 if stop["wall"] == "rigid" else 0)
    _add_law(deck, stop["contact"], f"{path}.contact")


def _add_material(deck: Deck, material: Run, path: str) -> None:
    for name in ("density", "young", "poisson", "yield_stress"):
        deck.add(material[name], f"{path}.{name}")


def _add_law(deck: Deck, law: Run, path: str) -> None:
    kind = law["kind"]
    deck.add(1 + LAWS.index(kind))
    for name in NUMBERS[kind]:
        deck.add(law[name] or 0.0, f"{path}.{name}" if law[name] else None)
    if "restitution" in law:
        e = law["restitution"]
        deck.add(RESTITUTIONS.index(e["kind"]))
        deck.add(e.get("maximum", 1.0))
        if e["kind"] == "table":
            deck.add(len(e["speeds"]))
            deck.extend(e["speeds"])
            deck.extend(e["values"])
        elif e["kind"] == "constant":
            deck.add(e["e"], f"{path}.restitution")
        else:
            name = {"johnson": "speed_scale", "thornton": "yield_pressure"}.get(e["kind"], "")
            deck.add(e.get(name) or 0.0, f"{path}.restitution.{name}" if e.get(name) else None)
    if kind == "tabulated":
        for curve in (law, law["unloading"]):
            deck.add(len(curve["overlap"]))
            deck.extend(curve["overlap"])
            deck.extend(curve["force"])
    elif kind != "thornton":
        deck.add(law["ending"] == "zero_overlap")


NUMBERS: dict[str, tuple[str, ...]] = {
    "tsuji": (),
    "tsuji_alpha": ("alpha",),
    "linear": ("stiffness",),
    "linear_damping": ("stiffness", "damping"),
    "linear_time": ("contact_time",),
    "power": ("stiffness", "exponent", "damping_exponent", "damping"),
    "thornton": ("yield_pressure",),
    "tabulated": (),
}


# ---- the same as a case


def case_of(run: Run) -> rb.Case:
    """Return the case of a run."""
    structure = dict(run["structure"])
    kind = structure.pop("kind")
    own = places(run) - len(run["tuned"])
    if kind == "matrices":
        structure["points"] = {point(i): i for i in range(own)}
    names = points(run)
    loads: dict[str, list[Any]] = {"loads": [], "base": []}
    for load in run["loads"]:
        values = {name: load[name] for name in FIELDS[load["shape"]] if load[name] is not None}
        if load["place"] >= 0:
            values |= {"point": names[load["place"]], "unit": "N"}
        else:
            values["unit"] = "m/s^2"
        make = {"harmonic": rb.Harmonic, "half_sine": rb.HalfSine, "sawtooth": rb.Sawtooth, "trapezoid": rb.Trapezoid}
        loads["loads" if load["place"] >= 0 else "base"].append(make[load["shape"]](**values))
    return rb.Case(
        structure={"sdof": rb.SDOF, "matrices": rb.Matrices, "fixed": rb.Fixed}[kind](**structure),
        tuned_masses=[
            rb.TunedMass(point=names[t["place"]], name=f"tuned {i}", **{k: v for k, v in t.items() if k != "place"})
            for i, t in enumerate(run["tuned"])
        ],
        dampers=[_damper(damper, names) for damper in run["dampers"]],
        stops=[_stop(stop, names) for stop in run.get("stops", [])],
        method=rb.Newton() if run["hard"] else rb.EventDriven(tolerance=2e-14),
        duration=1.0,
        **{name: several for name, several in loads.items() if several},
    )


def point(place: int) -> str:
    """Return the name of a degree of freedom of matrices."""
    return f"point {place}"


def points(run: Run) -> list[str]:
    """Return the names of the points of structure and tuned masses."""
    kind = run["structure"]["kind"]
    own = places(run) - len(run["tuned"])
    names = ["mass"] if kind == "sdof" else [point(i) for i in range(own)]
    return names + [f"tuned {i}" for i in range(len(run["tuned"]))]


def _damper(damper: Run, names: list[str]) -> rb.ImpactDamper:
    balls = [rb.Sphere(radius=ball["radius"], material=_material(ball["material"])) for ball in damper["balls"]]
    wall = damper["wall"]
    starts = [ball["start"] for ball in damper["balls"]]
    speeds = [ball["velocity"] for ball in damper["balls"]]
    return rb.ImpactDamper(
        balls=balls,
        gap=damper["gap"],
        gravity=damper["gravity"],
        start=starts[0] if len(starts) == 1 else starts,
        velocity=speeds[0] if len(speeds) == 1 else speeds,
        wall=None if wall == "ball" else "rigid" if wall == "rigid" else _material(wall),
        contact=_law(damper["contact"]),
        ball_contact=_law(damper["ball_contact"]),
        **({} if damper["place"] < 0 else {"point": names[damper["place"]]}),
    )


def _stop(stop: Run, names: list[str]) -> rb.Stop:
    return rb.Stop(
        point=names[stop["place"]],
        other=None if stop["other"] < 0 else names[stop["other"]],
        side=stop["side"],
        gap=stop["gap"],
        radius=stop["radius"],
        material=_material(stop["material"]),
        wall="rigid" if stop["wall"] == "rigid" else None,
        contact=_law(stop["contact"]),
    )


def _material(material: Run) -> rb.Material:
    return rb.Material(**{"density": 1000.0, **material})


def _law(law: Run) -> Any:
    kind = law["kind"]
    values = {name: law[name] for name in NUMBERS[kind] if law[name]}
    if "restitution" in law:
        e = dict(law["restitution"])
        make = {"constant": rb.Constant, "jackson_green": rb.JacksonGreen, "thornton": rb.ThorntonRestitution}
        make |= {"johnson": rb.Johnson, "table": rb.Tabulated}
        name = e.pop("kind")
        values["restitution"] = e["e"] if name == "constant" else make[name](**{k: v for k, v in e.items() if v})
    if kind == "tabulated":
        unloading = law["unloading"]
        curve = rb.Curve(**unloading) if unloading["overlap"] else None
        return rb.TabulatedNormal(overlap=law["overlap"], force=law["force"], unloading=curve)
    if kind == "thornton":
        return rb.Thornton(**values)
    make = {"tsuji": rb.Tsuji, "power": rb.PowerLaw, "linear": rb.Linear}
    return make[kind.partition("_")[0]](ending=law["ending"], **values)


# ---- the program


class Answer(NamedTuple):
    """What the program computed: state at the end and its derivatives, contacts, and the check with a second step."""

    end: float
    state: NDArray[np.float64]
    derivatives: NDArray[np.float64]
    second: NDArray[np.float64]
    touches: list[tuple[int, int, float, float, float]]
    miss: float
    steps: int


def digest() -> str:
    """Return a digest of the program without comments and white space: runs by another program must be computed again."""
    code = re.sub(r"//[^\n]*|\s+", "", SOURCE.read_text(encoding="utf-8"))
    return hashlib.sha256(code.encode()).hexdigest()[:16]


def compile_program(compiler: str, target: Path) -> bool:
    """Compile the program; False if the compiler has no 113-bit arithmetic."""
    command = [compiler, "-std=gnu++20", "-O2", str(SOURCE), "-o", str(target), "-lquadmath"]
    return subprocess.run(command, capture_output=True, timeout=600, check=False).returncode == 0


def question(run: Run, paths: Iterable[str] | None, check: bool = False) -> str:
    """Return the input of the program for a run and its derivatives in the state at the start and in parameters.

    Without paths, not even empty ones, there are no derivatives.
    """
    deck, offset = deck_of(run)
    count = 0 if paths is None else size(run)
    indices = [offset + i for i in range(2 * count)]
    sizes = [1e-3] * count + [0.1] * count
    for path in paths or ():
        indices.append(deck.index[path])
        sizes.append(abs(deck.numbers[deck.index[path]]) or 1.0)
    words = [len(deck.numbers), *map(repr, deck.numbers), len(indices), *indices, *map(repr, sizes), int(check)]
    return " ".join(map(str, words)) + "\n"


def answers(program: Path, questions: Iterable[str], options: tuple[str, ...] = ()) -> Iterator[Answer | str]:
    """Return what the program answers, in turn: numbers, or the reason why a run is left out."""
    done = subprocess.run(
        [str(program), *options], input="".join(questions), capture_output=True, text=True, check=True, timeout=36000
    )
    lines: list[list[str]] = []
    for line in done.stdout.splitlines():
        if line != "done":
            lines.append(line.split())
            continue
        yield " ".join(lines[0][1:]) if lines[0][0] == "refused" else _read(lines)
        lines = []


def _read(lines: list[list[str]]) -> Answer:
    rows: dict[str, list[list[str]]] = {}
    for name, *rest in lines:
        rows.setdefault(name, []).append(rest)

    def matrix(name: str) -> NDArray[np.float64]:
        return np.array([[float(x) for x in row] for row in rows.get(name, [])]).T

    touches = [(int(a), int(b), float(t), float(v), float(e)) for a, b, t, v, e in rows.get("touch", [])]
    return Answer(
        float(rows["end"][0][0]),
        np.array([float(x) for x in rows["state"][0]]),
        matrix("column"),
        matrix("second"),
        touches,
        float(rows["miss"][0][0]),
        int(rows["steps"][0][0]),
    )
