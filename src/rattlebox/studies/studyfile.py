"""Study files: a case, its axes and what to measure, in TOML."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError

from rattlebox.model.case import Case
from rattlebox.model.errors import CaseError, Hint, nearest, translate
from rattlebox.model.files import existing, read_toml
from rattlebox.model.materials import Material
from rattlebox.model.units import NotNegativeTime

from .axes import Design
from .designs import Method, geomspace, linspace, random_design, replicas
from .measures import MEASURES

_EXAMPLE = '[axes]\n       "damper.gap" = { from = "0.1 mm", to = "2 mm", count = 20 }'
_ROOTS = {*Case.model_fields, *Case.spellings}


class Study(NamedTuple):
    """What a study file says.

    Attributes
    ----------
    case
        The case that varies.
    axes
        Axes as `rb.sweep` takes them.
    options
        Other arguments of `rb.sweep`, those that the file gives.
    """

    case: Case
    axes: list[Any]
    options: dict[str, Any]


def read_study(path: str | os.PathLike[str]) -> Study:
    """Read a study file.

    Parameters
    ----------
    path
        A TOML file with these tables; files named in it are relative to its folder:

        case
            `file = "case.toml"`, or all that a case file holds.
        axes
            One dimension a line, `"damper.gap" = values`: a list, or `{ from = "0.1 mm", to = "2 mm", count = 20 }`, with
            `spacing = "log"` if they grow by a factor. A table of such lines, `[axes.level]`, is one dimension along
            which they vary together. The quotes around a path keep the lines in their order.
        design
            `count` random points in the ranges of the table `ranges` (pairs by path); `method`, `seed` and `log` as for
            `rb.random_design`.
        replicas
            `count` replicas of each variant, moved by at most what the table `reach` says by path; `seed`.

        Above them the other arguments of `rb.sweep`: measure, skip, cycles, samples, point, motion, last, threads.

    Raises
    ------
    CaseError
        When the file cannot be read or something in it does not fit, naming the field, its value and what is allowed.
    """
    file = Path(path)
    return study_from_toml(_text(file), source=str(file), folder=file.parent)


def study_from_toml(content: str, *, source: str = "study", folder: Path | None = None) -> Study:
    """Read a study from the text of a study file.

    Parameters
    ----------
    content
        TOML, as read_study takes it.
    source
        What messages call it.
    folder
        Where files named in it are looked for; default the current folder.

    Raises
    ------
    CaseError
        When something in it does not fit.
    """
    try:
        given = {name: _NESTED.get(name, _as_it_is)(value) for name, value in _read(content, source).items()}
        study = _Study.model_validate(given)
        case, own = _case(study.case, source, folder or Path())
        axes = _axes(study, own)
    except ValidationError as error:
        raise translate(error, source, _VOCABULARY, given) from None
    except Hint as hint:
        raise CaseError(f"{source}: {hint}") from None
    if not axes:
        raise CaseError(f"{source}: nothing varies\n  try: {_EXAMPLE}")
    Design.of(case, axes, source=source)
    return Study(
        case, axes, {name: getattr(study, name) for name in sorted(study.model_fields_set - {*_NESTED, "case"})}
    )


def _read(content: str, source: str) -> dict[str, Any]:
    try:
        return read_toml(content, source)
    except CaseError as error:
        path = re.search(r"\n  ([\w.]+\[\d+\][^\s=]*)", str(error))
        hint = f'\n  try: quotes around a path with a number: "{path[1]}" = ...' if path else ""
        raise CaseError(f"{error}{hint}") from None


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class _Spaced(_Table):
    start: Any = Field(alias="from")
    to: Any
    count: Annotated[int, Field(ge=1)]
    spacing: Literal["linear", "log"] = "linear"


def _kind(value: Any) -> str:
    if not isinstance(value, dict):
        return "values"
    return "linked" if value and not value.keys() & {"from", "to", "count", "spacing"} else "spaced"


_Values = Annotated[
    Annotated[list[Any], Tag("values")] | Annotated[_Spaced, Tag("spaced")],
    Discriminator(lambda value: "spaced" if _kind(value) == "spaced" else "values"),
]
_Axis = Annotated[
    Annotated[list[Any], Tag("values")]
    | Annotated[_Spaced, Tag("spaced")]
    | Annotated[dict[str, _Values], Tag("linked")],
    Discriminator(_kind),
]


class _Random(_Table):
    ranges: dict[str, list[Any]]
    count: Annotated[int, Field(ge=1)]
    method: Method = "sobol"
    seed: Annotated[int, Field(ge=0)] = 0
    log: list[str] = []


class _Replicas(_Table):
    reach: dict[str, Any]
    count: Annotated[int, Field(ge=1)]
    seed: Annotated[int, Field(ge=0)] = 0


def _known(measures: list[str]) -> list[str]:
    for index, name in enumerate(measures):
        if name not in MEASURES:
            raise Hint("there is no such measure", nearest(name, MEASURES), [index])
    return measures


class _Study(_Table):
    case: Any
    axes: dict[str, _Axis] = {}
    design: _Random | None = None
    replicas: _Replicas | None = None
    measure: Annotated[list[str], AfterValidator(_known)] = []
    skip: NotNegativeTime = 0.0
    cycles: tuple[float, float] | None = None
    samples: Annotated[int, Field(ge=2)] | None = None
    point: str | None = None
    motion: bool = False
    last: Annotated[int, Field(ge=0)] = 0
    threads: Annotated[int, Field(ge=1)] | None = None


_VOCABULARY = {
    "": {"": {*_Study.model_fields}},
    "spaced": {"": {"from", "to", "count", "spacing"}},
    "design": {"": {*_Random.model_fields}},
    "replicas": {"": {*_Replicas.model_fields}},
}


# ---- paths without quotes, which TOML reads as tables in tables


def _walk(table: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in table.items():
        if _kind(value) == "linked":
            yield from _walk(value, f"{above}{name}.")
        else:
            yield above + name, value


def _flat(pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for path, value in pairs:
        if path in table:
            raise Hint(f"{path} is given twice")
        table[path] = value
    return table


def _flat_axes(table: Any) -> Any:
    def lines() -> Iterator[tuple[str, Any]]:
        for name, value in table.items():
            if name not in _ROOTS and _kind(value) == "linked":
                yield name, _flat(_walk(value))
            else:
                yield from _walk({name: value})

    return _flat(lines()) if isinstance(table, dict) else table


def _flat_inside(field: str) -> Any:
    def flatten(table: Any) -> Any:
        inside = table.get(field) if isinstance(table, dict) else None
        return {**table, field: _flat(_walk(inside))} if isinstance(inside, dict) else table

    return flatten


def _as_it_is(value: Any) -> Any:
    return value


_NESTED = {"axes": _flat_axes, "design": _flat_inside("ranges"), "replicas": _flat_inside("reach")}


# ---- what is in it


def _case(given: Any, source: str, folder: Path) -> tuple[Case, dict[str, Material]]:
    """The case, and the materials that it brings along."""
    content: dict[str, Any] = given if isinstance(given, dict) else {"file": given}
    if "file" in content:
        name = content["file"]
        if len(content) > 1 or not isinstance(name, str):
            hint = Hint("the name of a file is needed, or the case itself, not both", 'file = "case.toml"')
            raise CaseError(f"{source}: case\n  {hint}")
        try:
            file = existing(folder / name)
        except Hint as hint:
            raise CaseError(f"{source}: case.file = {name!r}\n  {hint}") from None
        case = Case.from_file(file)
        content = read_toml(_text(file), str(file))
    else:
        import tomli_w

        case = Case.from_toml(tomli_w.dumps(content), source=f"{source}: case", folder=folder)
    own = content.get("materials", {})
    return case, {name: Material(**{"name": name, **values}) for name, values in own.items()}


def _text(file: Path) -> str:
    try:
        return existing(file).read_text(encoding="utf-8-sig")
    except Hint as hint:
        raise CaseError(str(hint)) from None
    except OSError as error:
        raise CaseError(f"{file}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise CaseError(f"{file}: not text in UTF-8\n  try: a TOML file, saved as UTF-8") from None


def _axes(study: _Study, own: Mapping[str, Material]) -> list[Any]:
    def named(path: str, values: Any) -> Any:
        if isinstance(values, _Spaced):
            return (geomspace if values.spacing == "log" else linspace)(values.start, values.to, values.count)
        if path.rpartition(".")[2] in ("material", "wall"):
            return [own.get(value, value) if isinstance(value, str) else value for value in values]
        return values

    axes: list[Any] = []
    if study.axes:
        axes.append(
            {
                name: {path: named(path, inner) for path, inner in values.items()}
                if isinstance(values, dict)
                else named(name, values)
                for name, values in study.axes.items()
            }
        )
    if study.design is not None:
        ranges = {path: named(path, values) for path, values in study.design.ranges.items()}
        random = study.design
        axes.append(random_design(ranges, random.count, method=random.method, seed=random.seed, log=random.log))
    if study.replicas is not None:
        axes.append(replicas(study.replicas.reach, study.replicas.count, seed=study.replicas.seed))
    return axes
