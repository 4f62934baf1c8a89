"""Base class of the kinds of studies, and the types of their fields.

A kind of study is one dataclass in `rattlebox.studies.kinds`. Its fields are the arguments of the function of its name, the
keys of its study file, and the parameters in its docstring.
"""

from __future__ import annotations

import copy
import dataclasses
import inspect
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, ParamSpec, Protocol, cast, runtime_checkable

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    InstanceOf,
    Tag,
    ValidationError,
    WrapValidator,
)
from pydantic.dataclasses import dataclass

from rattlebox._util.exceptions import CaseError
from rattlebox._util.interrupts import remember_ctrl_c
from rattlebox._util.plugins import Registry, owner_of
from rattlebox.analysis import equivalent_damping
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, nearest, translate
from rattlebox.model.record_sets import RecordSet
from rattlebox.model.units import NotNegativeTime, Number, PositiveMass, PositiveTime, Whole
from rattlebox.studies.grid.sampling import RandomDesign, Replicas, Spaced
from rattlebox.studies.run.estimate import Estimate, estimate_works
from rattlebox.studies.run.runner import run_work
from rattlebox.studies.work.measures import MEASURES, check_names, measure_function, named_functions
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox.results.run import Run

CONFIG = ConfigDict(extra="forbid", allow_inf_nan=False, arbitrary_types_allowed=True, defer_build=True)
"""Configuration of the dataclasses of all kinds. Their validators contain that of a case, which plug-ins add kinds to when
it is built: after all modules of this package that the plug-ins import."""

Parameters = ParamSpec("Parameters")


@runtime_checkable
class StartsCase(Protocol):
    """A motion from which the case of a study starts."""

    def as_case(self) -> Case:
        """Return the case that starts on the motion."""


def _case_of(value: object) -> object:
    return value.as_case() if isinstance(value, StartsCase) else value


StudiedCase = Annotated[InstanceOf[Case], BeforeValidator(_case_of)]


@dataclass(frozen=True, config=CONFIG)
class Study(ABC):
    """A study of a case: the fields that all kinds share.

    Parameters
    ----------
    case
        Base case, or a periodic motion of `rb.find_orbit`, from which the variants start.
    workers
        Number of threads or processes; default one per core. Results are bitwise independent of it.
    backend
        "threads" of this process; "processes", for measures in Python, which do not run in parallel in threads; or the
        client of a Dask cluster (`dask.distributed.Client`).
    store
        Folder of a Zarr store for the results. It holds the finished work at all times, and the same call resumes after a
        stop.
    progress
        True for a progress bar after 2 s, False for none, or a function of the number of finished variants and of all; the
        study stops if it returns False.
    """

    kind: ClassVar[str]
    kinds: ClassVar[Registry[type[Study]]] = Registry("kind of study")
    """Classes by kind; `study_function` adds them."""
    files: ClassVar[tuple[str, ...]] = ()
    """Fields that may name a file, which study files state relative to their own folder."""
    figure: ClassVar[str] = ""
    """Function that draws the dataset, as "module:function"; without one it is drawn as a map or as lines."""
    report: ClassVar[str] = "rattlebox.report.kinds.sweep:KIND"
    """Content of the report about the dataset, a `rattlebox.report.parts.Kind`, as "module:name".

    Figure and report are named, not imported: a study runs without them.
    """

    case: StudiedCase
    _: KW_ONLY
    workers: Annotated[Whole, Field(ge=1)] | None = None
    backend: Any = "threads"
    store: Any = None
    progress: bool | Callable[[int, int], object] = True

    def run(self, **where: Any) -> xr.Dataset:
        """Run the study.

        Parameters
        ----------
        **where
            Values for `workers`, `backend`, `store` and `progress` in place of those of the study.

        Returns
        -------
        xarray.Dataset
            See the kind.

        Raises
        ------
        CaseError
            If a field is not valid for the case (raised before anything runs).
        """
        checked = dataclasses.replace(self, **where)
        study = copy.copy(self)  # retains the grid and the work that are already computed
        for name in where:
            study.__dict__[name] = getattr(checked, name)
        study.validate()
        with remember_ctrl_c():  # a run that it ends may be one of many
            return study.compute()

    @abstractmethod
    def validate(self) -> None:
        """Raise if the fields are not valid for the case or exclude each other.

        Raises
        ------
        CaseError
            If they are not valid.
        """

    @abstractmethod
    def compute(self) -> xr.Dataset:
        """Run the variants and evaluate their results."""

    @property
    def where(self) -> dict[str, Any]:
        """Fields of execution and storage, as arguments of `run`."""
        return {"workers": self.workers, "backend": self.backend, "store": self.store, "progress": self.progress}

    def estimate(self) -> Estimate:
        """Predict the processor time of all runs from a few short ones.

        Returns
        -------
        Estimate
            Processor time, wall time and the factor within which the processor time is expected; as text, one sentence.

        Raises
        ------
        CaseError
            If a field is not valid for the case.

        Notes
        -----
        Impact dampers: eight blocks of variants are timed. Particle dampers: the variants with the fewest and with the most
        particles are timed for up to a second after their beds have settled, and the steps of the others are counted. If the
        first and the last variant take less than 5 s together, they run as a whole. Otherwise runs that may continue until
        their motion is steady are taken to last for the geometric mean of their shortest and longest length. Results that a
        store has already are not subtracted. A design is predicted from runs of up to 16 of its trials.
        """
        self.validate()
        return self.predict()

    def predict(self) -> Estimate:
        """Return the estimate of a valid study, see `estimate`."""
        return estimate_works(self.works, backend=self.backend, workers=self.workers)

    @property
    def works(self) -> Sequence[Work]:
        """Works that the study runs."""
        return (self.work,)

    @property
    def work(self) -> Work:
        """Only work of the study."""
        raise NotImplementedError

    def run_work(self, work: Work) -> xr.Dataset:
        """Run work with the backend and store of the study."""
        return run_work(work, **self.where)


def study_function(kind: Callable[Parameters, Study]) -> Callable[Parameters, xr.Dataset]:
    """Return the function that runs a study of a kind; its arguments are the fields of the kind."""
    cls = cast("type[Study]", kind)
    if missing := sorted(cls.__abstractmethods__):
        raise TypeError(f"{owner_of(cls)} must define {', '.join(missing)}, as each Study does")
    Study.kinds.add(cls.kind, cls, owner_of(cls))
    shared = [field.name for field in dataclasses.fields(Study) if field.kw_only]
    # pydantic sets the signature of the class when its validator is built, which is later.
    arguments = [
        inspect.Parameter(
            field.name,
            inspect.Parameter.KEYWORD_ONLY if field.kw_only else inspect.Parameter.POSITIONAL_OR_KEYWORD,
            default=inspect.Parameter.empty if field.default is dataclasses.MISSING else field.default,
            annotation=_readable(str(field.type)),
        )
        for field in dataclasses.fields(cls)
    ]
    arguments.sort(key=lambda argument: (argument.kind, argument.name in shared))
    signature = inspect.Signature(arguments, return_annotation="xarray.Dataset")

    def function(*args: Parameters.args, **kwargs: Parameters.kwargs) -> xr.Dataset:
        return make_study(cls, signature.bind(*args, **kwargs).arguments).run()

    function.__name__ = function.__qualname__ = cls.kind
    function.__module__, function.__doc__ = cls.__module__, cls.__doc__
    function.__signature__ = signature  # type: ignore[attr-defined]
    return function


def _readable(annotation: str) -> str:
    """Return the annotation of a field without the checks of its value, in types that need no look-up."""
    plain = re.sub(r"InstanceOf\[(\w+)\]|Annotated\[(\w+),.*?\)\]", r"\1\2", annotation.replace("typing.", ""))
    return re.sub(r"\w+", lambda word: _SIMPLE.get(word[0], word[0]), plain)


_SIMPLE = {
    "Axes": "Mapping[Any, Sequence[Any]] | RandomDesign | Replicas",
    "Bounds": "Mapping[Any, Sequence[Any]]",
    "CaseOrStructure": "Case | StructurePart",
    "Count": "int",
    "Cycles": "tuple[int, int]",
    "CyclesToCompare": "tuple[int, int]",
    "Fraction": "float",
    "Kilograms": "float | str",
    "Measures": "str | Callable | Sequence[str | Callable]",
    "Number": "float",
    "Path": "str | tuple[str, ...]",
    "Robust": "Literal['worst', 'mean', 'median']",
    "Samples": "int",
    "Seconds": "float | str",
    "StudiedCase": "Case",
    "Seed": "int",
    "TimeLimit": "float | str",
    "Values": "Sequence[float | str]",
    "Way": "Literal['decay', 'energy', 'shaking']",
    "Whole": "int",
}


def make_study(cls: type[Study], values: Mapping[str, Any], source: str = "", vocabulary: Any = None) -> Study:
    """Return a study with the given fields."""
    names = [field.name for field in dataclasses.fields(cls)]
    for name in values:
        if name not in names:
            raise CaseError(f"{source}: {name} = {values[name]!r:.60}\n  there is no such field", nearest(name, names))
    try:
        study = cls(**values)
    except ValidationError as error:
        raise CaseError(re.sub("(?m)^: ", "", str(translate(error, source, vocabulary or {}, dict(values))))) from None
    skip = getattr(study, "skip", 0.0)
    if skip and getattr(study, "cycles", None) is not None:
        raise Hint(f"skip = {skip:g} s and cycles exclude each other; the first of cycles is skipped", "one of them")
    return study


# ---- tables of study files


class Table(BaseModel):
    """A table inside a study file."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Range(Table):
    """Bounds of a parameter."""

    start: Any = Field(alias="from")
    to: Any
    spacing: Literal["linear", "log"] = "linear"


class SpacedTable(Range):
    """Spaced values of a parameter."""

    count: Annotated[Whole, Field(ge=1, examples=[20])]

    @property
    def values(self) -> Spaced:
        """The values as `linspace` and `geomspace` return them."""
        return Spaced(self.start, self.to, self.count, self.spacing == "log", ("from", "to"))


def table_shape(value: object) -> str:
    """Return "spaced" for a table of spaced values, "linked" for other tables, "value" for text and numbers, or "other"."""
    if isinstance(value, Mapping) and not isinstance(value, RecordSet):
        return "linked" if value and not value.keys() & {"from", "to", "count", "spacing"} else "spaced"
    return "value" if isinstance(value, (str, int, float)) or value is None else "other"


def _spaced_or_other(value: object) -> str:
    shape = table_shape(value)
    return "spaced" if shape == "linked" else shape


def _if_table(value: object, handler: Callable[[Any], Any]) -> Any:
    """Validate a table; return other forms, which only Python calls have, unchanged."""
    if isinstance(value, Mapping) and all(isinstance(name, str) for name in value):
        return handler(value)
    if value is None or (isinstance(value, (Sequence, RandomDesign, Replicas)) and not isinstance(value, str)):
        return value
    return handler(value) if not isinstance(value, Mapping) else value


measure_function("1", "equivalent damping ratio")(equivalent_damping)


def _as_measures(value: object) -> Any:
    if isinstance(value, str) or callable(value):
        value = [value]
    if not isinstance(value, Iterable):
        raise Hint(f"{value!r} is not the name of a measure or a function of a Run", '"impact_share"')
    functions = named_functions()
    return [functions.get(each, each) if isinstance(each, str) else each for each in value]


def known_measures(measures: Any) -> list[Any]:
    """Return measures as a list; raise if one is unknown or two have the same name."""
    for index, name in enumerate(measures):
        if isinstance(name, str) and name not in MEASURES:
            raise Hint("it is not the name of a measure", nearest(name, [*MEASURES, *named_functions()]), [index])
        if not isinstance(name, str) and not callable(name):
            raise Hint(f"{name!r} is not the name of a measure or a function of a Run", '"impact_share"', [index])
    check_names(measures)
    return list(measures)


def whole_cycles(cycles: Any, least: int = 1) -> tuple[int, int]:
    """Return the numbers of cycles to skip and to evaluate; raise if they are not whole or too few are evaluated."""
    try:
        skip, count = (int(number) for number in cycles)
        whole = (skip, count) == tuple(cycles)
    except (TypeError, ValueError, OverflowError):
        whole = False
    if not whole or skip < 0 or count < least:
        raise Hint(f"cycles must be two whole numbers: to skip, >= 0, and to evaluate, >= {least}", "[200, 50]")
    return skip, count


def _check_bounds(bounds: object) -> Any:
    if not isinstance(bounds, Mapping) or not bounds:
        raise Hint("a mapping of paths to bounds or choices is required", '{"damper.gap": ("0.1 mm", "2 mm")}')
    return bounds


def split_bounds(bounds: Mapping[str, Any], log: Any) -> tuple[dict[str, Any], list[str]]:
    """Return pairs and choices by path, and the paths with a logarithmic distribution."""
    logarithmic = [path for path, given in bounds.items() if isinstance(given, Range) and given.spacing == "log"]
    pairs = {path: (given.start, given.to) if isinstance(given, Range) else given for path, given in bounds.items()}
    return pairs, [*logarithmic, *([log] if isinstance(log, str) else log)]


if TYPE_CHECKING:  # types of arguments; the validated values are plain
    Measure = str | Callable[[Run], float]
    Measures = Measure | Sequence[Measure]
    Seconds = float | str
    TimeLimit = float | str
    Kilograms = float | str
    Axes = Any
    Values = Any
    Bounds = Mapping[str, Any]
else:
    _SpacedValues = Annotated[SpacedTable, AfterValidator(lambda table: table.values)]
    _List = Annotated[list[Any], Tag("value")]
    _Other = Annotated[Any, Tag("other")]
    Values = Annotated[_List | Annotated[_SpacedValues, Tag("spaced")] | _Other, Discriminator(_spaced_or_other)]
    _Axis = Annotated[
        _List | Annotated[_SpacedValues, Tag("spaced")] | Annotated[dict[Any, Values], Tag("linked")] | _Other,
        Discriminator(table_shape),
    ]
    Axes = Annotated[dict[str, _Axis], WrapValidator(_if_table)]
    _Bound = Annotated[
        _List | Annotated[Range, Tag("spaced")] | Annotated[dict[str, _List], Tag("linked")] | _Other,
        Discriminator(table_shape),
    ]
    Bounds = Annotated[
        dict[str, _Bound],
        WrapValidator(_if_table),
        BeforeValidator(_check_bounds),
        Field(examples=[{"damper.gap": {"from": "0.1 mm", "to": "2 mm"}}]),
    ]
    Measures = Annotated[Any, BeforeValidator(_as_measures), AfterValidator(known_measures)]
    Seconds = NotNegativeTime
    TimeLimit = Annotated[PositiveTime, Field(examples=["10 min"])]
    Kilograms = PositiveMass

Cycles = Annotated[tuple[int, int], BeforeValidator(partial(whole_cycles, least=1))]
CyclesToCompare = Annotated[tuple[int, int], BeforeValidator(partial(whole_cycles, least=2))]
Fraction = Annotated[Number, Field(gt=0, lt=1)]
Count = Annotated[Whole, Field(ge=1)]
Seed = Annotated[Whole, Field(ge=0)]
Samples = Annotated[Whole, Field(ge=2)]
