"""What a study file may hold: the tables and lines of each kind of study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Tag

from rattlebox.model.errors import Hint, nearest
from rattlebox.model.units import NotNegativeTime, PositiveMass

from .designs import Method
from .measures import MEASURES


class Table(BaseModel):
    """A table of a study file."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Range(Table):
    """Bounds of a parameter."""

    start: Any = Field(alias="from")
    to: Any
    spacing: Literal["linear", "log"] = "linear"


class Spaced(Range):
    """Values from one to another."""

    count: Annotated[int, Field(ge=1)]


def shape_of(value: Any) -> str:
    """Tell lists, spaced values and tables of several from each other: "values", "spaced" or "linked"."""
    if not isinstance(value, dict):
        return "values"
    return "linked" if value and not value.keys() & {"from", "to", "count", "spacing"} else "spaced"


def _plain_shape(value: Any) -> str:
    return "spaced" if shape_of(value) == "spaced" else "values"


List = Annotated[list[Any], Tag("values")]
Values = Annotated[List | Annotated[Spaced, Tag("spaced")], Discriminator(_plain_shape)]
Bounds = Annotated[List | Annotated[Range, Tag("spaced")], Discriminator(_plain_shape)]
Axis = Annotated[
    List | Annotated[Spaced, Tag("spaced")] | Annotated[dict[str, Values], Tag("linked")],
    Discriminator(shape_of),
]


class Random(Table):
    """A random design."""

    ranges: dict[str, list[Any]]
    count: Annotated[int, Field(ge=1)]
    method: Method = "sobol"
    seed: Annotated[int, Field(ge=0)] = 0
    log: list[str] = []


class Replicas(Table):
    """Replicas of each variant."""

    reach: dict[str, Any]
    count: Annotated[int, Field(ge=1)]
    seed: Annotated[int, Field(ge=0)] = 0


def _known(measures: list[str]) -> list[str]:
    for index, name in enumerate(measures):
        if name not in MEASURES:
            raise Hint("there is no such measure", nearest(name, MEASURES), [index])
    return measures


Measures = Annotated[list[str], AfterValidator(_known)]
Whole = tuple[int, int]
Part = Annotated[float, Field(gt=0, lt=1)]
Count = Annotated[int, Field(ge=1)]
Seed = Annotated[int, Field(ge=0)]


class Study(Table):
    """What all study files hold."""

    axes_needed: ClassVar[bool] = False
    kind: str = "sweep"
    case: Any
    threads: Count | None = None


class _OverAxes(Study):
    axes_needed: ClassVar[bool] = True
    axes: dict[str, Axis] = {}
    design: Random | None = None
    replicas: Replicas | None = None


class _Sweep(_OverAxes):
    measure: Measures = []
    skip: NotNegativeTime = 0.0
    cycles: tuple[float, float] | None = None
    samples: Annotated[int, Field(ge=2)] | None = None
    point: str | None = None
    motion: bool = False
    last: Annotated[int, Field(ge=0)] = 0


class _Bifurcation(Study):
    axes_needed: ClassVar[bool] = True
    axes: dict[str, Axis] = {}
    cycles: Whole = (400, 48)
    show: Literal["strobe", "impacts"] = "strobe"
    direction: Literal["up", "down", "both", "fresh"] = "both"
    measure: Measures = []
    tolerance: Part = 1e-4
    point: str | None = None


class _FrequencyResponse(Study):
    frequencies: Values
    levels: Values | None = None
    direction: Literal["up", "down", "both", "fresh"] = "both"
    cycles: Whole = (200, 32)
    measure: Measures = []
    point: str | None = None
    samples: Annotated[int, Field(ge=8)] = 64
    tolerance: Part = 1e-3


class _Basins(_OverAxes):
    cycles: Whole = (400, 48)
    measure: Measures = []
    tolerance: Part = 1e-4
    apart: Part = 1e-2
    point: str | None = None


class _Lyapunov(_OverAxes):
    axes_needed: ClassVar[bool] = False
    cycles: tuple[float, float] | None = None
    skip: NotNegativeTime = 0.0
    steps: Annotated[int, Field(ge=2)] | None = None
    pairs: Count = 8
    distance: float = 1e-7
    reach: float = 1e-3
    seed: Seed = 0


class _LossMap(Study):
    amplitudes: Values
    frequencies: Values
    cycles: tuple[float, float] = (50, 50)
    samples: Annotated[int, Field(ge=2)] | None = None


class _Judged(Study):
    """Runs at several levels and starts that count together."""

    levels: dict[str, Axis] = {}
    starts: int | list[Any] | None = None
    seed: Seed = 0
    skip: NotNegativeTime = 0.0
    cycles: tuple[float, float] | None = None
    samples: Annotated[int, Field(ge=2)] | None = None
    point: str | None = None


class _Design(_Judged):
    parameters: dict[str, Bounds]
    objective: str | list[str] | dict[str, Literal["min", "max"]] = "settling_time"
    robust: Literal["worst", "mean", "median"] = "worst"
    max_added_mass: PositiveMass | None = None
    trials: Count = 100


class _Sensitivity(_Judged):
    bounds: dict[str, Bounds]
    measure: Measures = ["impact_share"]
    n: Annotated[int, Field(ge=8)] = 256
    confidence: Part = 0.95


KINDS: Mapping[str, type[Study]] = {
    "sweep": _Sweep,
    "bifurcation": _Bifurcation,
    "frequency_response": _FrequencyResponse,
    "basins": _Basins,
    "lyapunov": _Lyapunov,
    "loss_map": _LossMap,
    "design": _Design,
    "sensitivity": _Sensitivity,
}
"""Kinds of studies, each of which is a function of rattlebox, by name."""

INSIDE = {
    "spaced": {"": {"from", "to", "count", "spacing"}},
    "design": {"": {*Random.model_fields}},
    "replicas": {"": {*Replicas.model_fields}},
}
"""Names of the fields of tables, for messages."""
