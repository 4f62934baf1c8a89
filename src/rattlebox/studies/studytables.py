"""What a study file may hold: the tables and lines of each kind of study."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag, ValidationError

from rattlebox._util.exceptions import CaseError
from rattlebox.model.base import examples
from rattlebox.model.errors import Hint, nearest, translate
from rattlebox.model.units import NotNegativeTime, Number, PositiveMass, Whole

from .measures import MEASURES, check_names
from .sampling import Method


class Table(BaseModel):
    """A table of a study file."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, validate_assignment=True)


class Range(Table):
    """Bounds of a parameter."""

    start: Any = Field(alias="from")
    to: Any
    spacing: Literal["linear", "log"] = "linear"


class Spaced(Range):
    """Values from one to another."""

    count: Annotated[Whole, Field(ge=1, examples=[20])]


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

    ranges: dict[str, list[Any]] = Field(examples=[{"damper.gap": ["0.1 mm", "2 mm"]}])
    count: Annotated[Whole, Field(ge=1, examples=[1000])]
    method: Method = "sobol"
    seed: Annotated[Whole, Field(ge=0)] = 0
    log: list[str] = []


class Replicas(Table):
    """Replicas of each variant."""

    reach: dict[str, Any] = Field(examples=[{"load.amplitude": "50 N"}])
    count: Annotated[Whole, Field(ge=1, examples=[50])]
    seed: Annotated[Whole, Field(ge=0)] = 0


def _known(measures: list[str]) -> list[str]:
    for index, name in enumerate(measures):
        if name not in MEASURES:
            raise Hint("there is no such measure", nearest(name, MEASURES), [index])
    check_names(measures)
    return measures


def _whole(cycles: Any, least: int) -> tuple[int, int]:
    try:
        skip, look = (int(number) for number in cycles)
        whole = (skip, look) == tuple(cycles)
    except (TypeError, ValueError, OverflowError):
        whole = False
    if not whole or skip < 0 or look < least:
        raise Hint(f"whole numbers of cycles are needed: some to skip, at least {least} to look at", "[200, 50]")
    return skip, look


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


Measures = Annotated[list[str], BeforeValidator(_as_list), AfterValidator(_known)]
Cycles = Annotated[tuple[int, int], BeforeValidator(partial(_whole, least=1))]
CyclesToCompare = Annotated[tuple[int, int], BeforeValidator(partial(_whole, least=2))]
Part = Annotated[Number, Field(gt=0, lt=1)]
Count = Annotated[Whole, Field(ge=1)]
Seed = Annotated[Whole, Field(ge=0)]


class Study(Table):
    """What all study files hold."""

    axes_needed: ClassVar[bool] = False
    kind: str = "sweep"
    case: Any = Field(examples=["case.toml"])
    workers: Count | None = None


class _OverAxes(Study):
    axes_needed: ClassVar[bool] = True
    axes: dict[str, Axis] = {}
    design: Random | None = None
    replicas: Replicas | None = None


class _Sweep(_OverAxes):
    measure: Measures = []
    skip: NotNegativeTime = 0.0
    cycles: Cycles | None = None
    samples: Annotated[Whole, Field(ge=2)] | None = None
    point: str | None = None
    motion: bool = False
    last: Annotated[Whole, Field(ge=0)] = 0


class _Bifurcation(Study):
    axes_needed: ClassVar[bool] = True
    axes: dict[str, Axis] = {}
    cycles: CyclesToCompare = (400, 48)
    show: Literal["strobe", "impacts"] = "strobe"
    direction: Literal["up", "down", "both", "fresh"] = "both"
    measure: Measures = []
    tolerance: Part = 1e-4
    point: str | None = None


_FREQUENCIES: Any = Field(examples=[{"from": "9 Hz", "to": "11 Hz", "count": 50}])


class _FrequencyResponse(Study):
    frequencies: Values = _FREQUENCIES
    levels: Values | None = None
    direction: Literal["up", "down", "both", "fresh"] = "both"
    cycles: Cycles = (200, 32)
    measure: Measures = []
    point: str | None = None
    samples: Annotated[Whole, Field(ge=8)] = 64
    tolerance: Part = 1e-3


class _Basins(_OverAxes):
    cycles: CyclesToCompare = (400, 48)
    measure: Measures = []
    tolerance: Part = 1e-4
    apart: Part = 1e-2
    point: str | None = None


class _Lyapunov(_OverAxes):
    axes_needed: ClassVar[bool] = False
    cycles: Cycles | None = None
    skip: NotNegativeTime = 0.0
    steps: Annotated[Whole, Field(ge=2)] | None = None
    pairs: Count = 8
    distance: Annotated[Number, Field(ge=1e-12, le=1e-4)] = 1e-7
    reach: Annotated[Number, Field(ge=0, le=1)] = 1e-3
    seed: Seed = 0


class _LossMap(Study):
    amplitudes: Values = Field(examples=[["1 mm", "2 mm"]])
    frequencies: Values = _FREQUENCIES
    cycles: Cycles = (50, 50)
    samples: Annotated[Whole, Field(ge=2)] | None = None


class _Judged(Study):
    """Runs at several levels and starts that count together."""

    levels: dict[str, Axis] = {}
    starts: int | list[Any] | None = None
    seed: Seed = 0
    skip: NotNegativeTime = 0.0
    cycles: Cycles | None = None
    samples: Annotated[Whole, Field(ge=2)] | None = None
    point: str | None = None


_BOUNDS: Any = Field(examples=[{"damper.gap": {"from": "0.1 mm", "to": "2 mm"}}])


class _Design(_Judged):
    parameters: dict[str, Bounds] = _BOUNDS
    objective: str | list[str] | dict[str, Literal["min", "max"]] = "settling_time"
    robust: Literal["worst", "mean", "median"] = "worst"
    max_added_mass: PositiveMass | None = None
    trials: Count = 100


class _Sensitivity(_Judged):
    bounds: dict[str, Bounds] = _BOUNDS
    measure: Measures = ["impact_share"]
    n: Annotated[Whole, Field(ge=8)] = 256
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


def checked(kind: str, **given: Any) -> dict[str, Any]:
    """Return arguments of a study's function as they are read from a study file.

    Parameters
    ----------
    kind
        Name of the function.
    **given
        Some of its arguments.

    Raises
    ------
    CaseError
        When a file could not hold one of them, naming it, its value and what is allowed.
    """
    empty: type[Table] = KINDS[kind]
    table = empty.model_construct()
    for name, value in given.items():
        try:
            setattr(table, name, value)
        except ValidationError as error:
            raise CaseError(str(translate(error, "", {}, given)).removeprefix(": ")) from None
    if given.get("cycles") is not None and getattr(table, "skip", None):
        raise Hint(f"skip = {given['skip']!r}: with cycles, the first number of them is what is skipped", "one of both")
    return {name: getattr(table, name) for name in given}


INSIDE = {
    "spaced": {"": examples(Spaced)},
    "design": {"": examples(Random)},
    "replicas": {"": examples(Replicas)},
}
"""Names of the fields of tables with examples, for messages."""
