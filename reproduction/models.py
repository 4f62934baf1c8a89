"""Contact models of the paper, the second in three interpretations, with their colours in figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox import Case, JacksonGreen, Pair, Run, Tsuji, contact_pairs
from rattlebox.plots import SERIES_COLOURS, SERIES_STYLES

from .system import CONSTANT, PLASTIC, PLASTIC_RIGID, START, ensemble, near, paper_case

CONSTANT_E, STEEL, RIGID = "constant restitution", "elasto-plastic, steel wall", "elasto-plastic, rigid wall"
STIFF = "elasto-plastic, rigid wall, also in stiffness"


class Model(NamedTuple):
    """Contact law and wall of a model."""

    contact: Tsuji
    wall: Literal["rigid"] | None = None


ALL_MODELS: Mapping[str, Model] = {
    CONSTANT_E: Model(CONSTANT),
    STEEL: Model(PLASTIC),
    RIGID: Model(PLASTIC_RIGID),
    STIFF: Model(PLASTIC_RIGID, "rigid"),
}
"""Every model by its name. `RIGID` is the one that the paper states: a rigid wall in its section on yield, equation "
"(6) for A."""

MODELS: Mapping[str, Tsuji] = {name: ALL_MODELS[name].contact for name in (CONSTANT_E, STEEL, RIGID)}
"""Contact law by model, for the figures, where the last model would repeat the third."""

SHORT: Mapping[str, str] = dict(
    zip(ALL_MODELS, ("constant e", "steel wall", "rigid wall", "rigid in A too"), strict=True)
)
COLOURS: Mapping[str, str] = dict(zip(ALL_MODELS, SERIES_COLOURS, strict=False))
STYLES: Mapping[str, Any] = dict(zip(ALL_MODELS, SERIES_STYLES, strict=False))


def model_case(model: str, *, start: float = 0.0, **options: Any) -> Case:
    """Return the paper's case with a model, and other options of `paper_case`."""
    contact, wall = ALL_MODELS[model]
    return paper_case(contact, start=start, wall=wall, **options)


def model_runs(model: str, case: int, members: int, **options: Any) -> list[Run]:
    """Simulate an ensemble of starts within a micrometre of a case of the paper."""
    return ensemble(lambda offset: model_case(model, start=near(START[case], offset), **options), members)


def by_model(of: Callable[[str], str]) -> str:
    """Return a text with the results of the models of the figures."""
    return ", ".join(f"{of(model)} ({SHORT[model]})" for model in MODELS)


def two(value: Any) -> str:
    """Return a number with two significant digits, trailing zeros included."""
    return f"{float(value):#.2g}".rstrip(".")


def critical_speed(model: str) -> float:
    """Return the speed at which yield begins in a model [m/s], infinite with constant restitution."""
    law = ALL_MODELS[model].contact.restitution
    return law.critical_speed(contact_pairs(model_case(model), 0)[0]) if isinstance(law, JacksonGreen) else inf


def lasting(log: Any, pair: Pair) -> NDArray[np.bool_]:
    """Return which contacts take more than five times as long as an elastic collision at their speed."""
    speed = np.maximum(log.approach_speed, 1e-12)
    collision = 2.9432752 * (1.25 * pair.mass * speed**2 / pair.hertz_stiffness) ** 0.4 / speed
    return np.asarray(log.duration > 5 * collision)
