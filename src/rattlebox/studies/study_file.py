"""Study files: a case, axes and options of a study in TOML."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox.model.base import examples
from rattlebox.model.case import Case, case_and_materials
from rattlebox.model.errors import Hint, nearest, translate
from rattlebox.model.files import existing, read_text, read_toml
from rattlebox.model.materials import Material
from rattlebox.model.record_sets import record_set
from rattlebox.model.units import Whole
from rattlebox.studies.grid import sampling
from rattlebox.studies.grid.starts import PATH as STARTS
from rattlebox.studies.kinds import study_kind, study_kinds
from rattlebox.studies.run.study import Axes, SpacedTable, Study, Table, make_study, table_shape

_EXAMPLE = '[axes]\n       "damper.gap" = { from = "0.1 mm", to = "2 mm", count = 20 }'
_REQUIRED = {
    "case": '{ file = "case.toml" }',
    "axes": '{ "damper.gap" = ["0.2 mm", "0.4 mm"] }',
    "parameters": '{ "damper.gap" = ["0.2 mm", "0.4 mm"] }',
    "path": '"load.frequency"',
    "values": '["30 Hz", "31 Hz"]',
    "amplitudes": '["0.5 mm", "1 mm"]',
    "frequencies": '["30 Hz", "60 Hz"]',
}
"""Examples of fields that studies need, for messages about missing ones."""
_ROOTS = {*Case.model_fields, *Case.aliases}


def read_study(path: str | os.PathLike[str]) -> Study:
    """Read a study file.

    Parameters
    ----------
    path
        TOML file with the following tables; paths in it are relative to its folder:

        case
            `file = "case.toml"`, or the content of a case file.
        axes, or starts of basins
            One dimension per line, `"damper.gap" = values`: a list, or `{ from = "0.1 mm", to = "2 mm", count = 20 }`, with
            `spacing = "log"` for geometric spacing. A table of such lines, `[axes.level]`, is one dimension along which
            they vary together. Quotes around the paths preserve the order of the lines. Records:
            `base = { records = "quakes/*.at2" }`, a folder, a pattern or a list, with other arguments of `rb.record_set`.
        design
            `count` random points in the ranges of the table `ranges` (pairs by path); `method`, `seed` and `log` as for
            `rb.random_design`.
        replicas
            `count` replicas of each variant with the largest offsets in the table `reach`, by path; `seed`.

        Before them, the kind of study (default `kind = "sweep"`) and its other fields, with the names of the arguments of
        its function. Values of a field (`values`, `frequencies`, `amplitudes`, `levels`) are lists or
        tables as above; `parameters` of a design and `bounds` of a sensitivity are tables of
        `"damper.gap" = { from = "0.1 mm", to = "2 mm" }`, with `spacing = "log"` for a search in the logarithm, or of lists
        to choose from.
    """
    file = Path(path)
    return study_from_toml(_text(file), source=str(file), folder=file.parent)


def study_from_toml(content: str, *, source: str = "study", folder: Path | None = None) -> Study:
    """Read a study from the text of a study file."""
    given = _read(content, source)
    try:
        if "structure" in given and "case" not in given:
            raise Hint(
                "the file is a case file, not a study file",
                f'rattlebox run {source}, or case.file = "{source}" in a study',
            )
        given = _with_records(given, folder or Path())
        kind = given.pop("kind", "sweep")
        if not isinstance(kind, str) or kind not in study_kinds():
            raise Hint(f"kind = {kind!r} is not a kind of study", nearest(str(kind), study_kinds()))
        cls = study_kind(kind)
        given = {name: _NESTED[name](value) if name in _NESTED else value for name, value in given.items()}
        if "case" in given:
            given["case"], own = _case(given["case"], source, folder or Path())
            given = {name: _with_materials(value, own) if name in _NESTED else value for name, value in given.items()}
        if isinstance(given.get("axes"), dict):
            given["axes"] = _with_starts(given["axes"], folder or Path())
        given = _with_samples(cls, given, source)
        for name in cls.files:
            if isinstance(given.get(name), str):
                given[name] = str((folder or Path()) / given[name])
        study = make_study(
            cls, given, source, {"": {"": examples(cls) | _REQUIRED}, "spaced": {"": examples(SpacedTable)}}
        )
        study.validate()
    except Hint as hint:
        raise hint.restated(CaseError, source) from None
    except CaseError as error:
        raise error if str(error).startswith(source) else error.restated(source=source) from None
    return study


def _read(content: str, source: str) -> dict[str, Any]:
    try:
        return read_toml(content, source)
    except CaseError as error:
        path = re.search(r"\n  ([\w.]+\[\d+\][^\s=]*)", str(error))
        advice = f'quotes around a path with a number: "{path[1]}" = ...' if path else error.suggestion
        raise error.restated(suggestion=advice) from None


# ---- paths without quotes, which TOML reads as tables in tables


def _walk(table: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in table.items():
        if table_shape(value) == "linked":
            yield from _walk(value, f"{above}{name}.")
        else:
            yield above + name, value


def _flat(pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for path, value in pairs:
        if path in table:
            raise Hint(f"{path} is given twice", "one of them")
        table[path] = value
    return table


def _flat_axes(table: Any) -> Any:
    def lines() -> Iterator[tuple[str, Any]]:
        for name, value in table.items():
            if name not in _ROOTS and table_shape(value) == "linked":
                yield name, _flat(_walk(value))
            else:
                yield from _walk({name: value})

    return _flat(lines()) if table_shape(table) == "linked" else table


def _flat_table(table: object) -> Any:
    return _flat(_walk(table)) if isinstance(table, dict) else table


def _flat_inside(field: str) -> Any:
    def flatten(table: Any) -> Any:
        inside = table.get(field) if isinstance(table, dict) else None
        return {**table, field: _flat(_walk(inside))} if isinstance(inside, dict) else table

    return flatten


_NESTED = {
    "axes": _flat_axes,
    "levels": _flat_axes,
    "starts": _flat_axes,
    "parameters": _flat_axes,
    "bounds": _flat_table,
    "design": _flat_inside("ranges"),
    "replicas": _flat_inside("reach"),
}


# ---- content


def _case(given: object, source: str, folder: Path) -> tuple[Case, dict[str, Material]]:
    """Return the case and the materials that its file defines."""
    content: dict[str, Any] = given if isinstance(given, dict) else {"file": given}
    if "file" in content:
        name = content["file"]
        if len(content) > 1 or not isinstance(name, str):
            raise CaseError(
                "the table must have either the name of a file or a case, not both",
                'file = "case.toml"',
                head=f"{source}: case",
            )
        try:
            file = existing(folder / name)
        except DataError as error:
            raise error.restated(CaseError, head=f"{source}: case.file = {name!r}") from None
        content = read_toml(_text(file), str(file))
        return case_and_materials(content, source=str(file), folder=file.parent)
    return case_and_materials(content, source=f"{source}: case", folder=folder)


def _text(file: Path) -> str:
    try:
        return read_text(file)
    except DataError as error:
        raise error.restated(CaseError) from None


def _with_materials(table: object, own: Mapping[str, Material]) -> Any:
    """Return a table of values by path, with the names of materials of the case replaced by the materials."""
    if not isinstance(table, dict):
        return table

    def read(path: str, values: object) -> Any:
        if isinstance(values, list) and path.rpartition(".")[2] in ("material", "wall"):
            return [own.get(value, value) if isinstance(value, str) else value for value in values]
        return _with_materials(values, own)

    return {path: read(path, values) for path, values in table.items()}


def _with_starts(axes: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return axes in which the files of runs that variants continue are relative to the folder of the study."""

    def moved(start: object) -> Any:
        if isinstance(start, list) and start:
            return (moved(start[0]), *start[1:])
        return os.path.join(folder, start) if isinstance(start, str) else start

    def read(path: str, values: object) -> Any:
        if path == STARTS and isinstance(values, list):
            return [moved(start) for start in values]
        return {name: read(name, inner) for name, inner in values.items()} if isinstance(values, dict) else values

    return {path: read(path, values) for path, values in axes.items()}


def _with_records(table: object, folder: Path) -> Any:
    """Return a table with sets of records in place of tables such as { records = "quakes/*.at2", unit = "g" }."""
    if not isinstance(table, dict):
        return table
    if "records" not in table:
        return {name: value if name == "case" else _with_records(value, folder) for name, value in table.items()}
    fields = dict(table)
    files = fields.pop("records")
    if isinstance(files, str):
        files = os.path.join(folder, files)
    elif isinstance(files, list) and all(isinstance(each, str) for each in files):
        files = [os.path.join(folder, each) for each in files]
    elif isinstance(files, dict) and all(isinstance(each, str) for each in files.values()):
        files = {name: os.path.join(folder, each) for name, each in files.items()}
    else:
        raise Hint(f"records = {files!r:.60} are no files", 'records = "quakes/*.at2"')
    try:
        return record_set(files, **fields)
    except DataError as error:
        raise error.restated(Hint) from None


def _with_samples(cls: type[Study], given: dict[str, Any], source: str) -> dict[str, Any]:
    """Return the fields with the tables `design` and `replicas` added to the axes of the study."""
    names = [field.name for field in dataclasses.fields(cls)]
    name = next((name for name in ("axes", "starts") if name in names), None)
    if cls.kind in ("design", "sensitivity") or name is None:
        return given
    tables = {table: given.pop(table) for table in ("design", "replicas") if table in given}
    try:
        samples = _Samples.model_validate(tables)
    except ValidationError as error:
        vocabulary = {"": {"": examples(_Samples)}, "design": {"": examples(RandomTable)}}
        raise translate(error, source, {**vocabulary, "replicas": {"": examples(ReplicasTable)}}, tables) from None
    more: list[Any] = []
    if points := samples.design:
        more.append(
            sampling.random_design(points.ranges, points.count, method=points.method, seed=points.seed, log=points.log)
        )
    if copies := samples.replicas:
        more.append(sampling.replicas(copies.reach, copies.count, seed=copies.seed))
    if name not in given and not more and "case" in given and cls.kind != "lyapunov":
        raise Hint("nothing varies", _EXAMPLE)
    if more:
        axes = given.get(name)
        checked = TypeAdapter(Axes).validate_python(axes) if axes else None
        given[name] = [*([checked] if checked else []), *more]
    return given


class RandomTable(Table):
    """A random design."""

    ranges: dict[str, list[Any]] = Field(examples=[{"damper.gap": ["0.1 mm", "2 mm"]}])
    count: Annotated[Whole, Field(ge=1, examples=[1000])]
    method: sampling.Method = "sobol"
    seed: Annotated[Whole, Field(ge=0)] = 0
    log: list[str] = Field(default=[])


class ReplicasTable(Table):
    """Replicas of each variant."""

    reach: dict[str, Any] = Field(examples=[{"load.amplitude": "50 N"}])
    count: Annotated[Whole, Field(ge=1, examples=[50])]
    seed: Annotated[Whole, Field(ge=0)] = 0


class _Samples(Table):
    design: RandomTable | None = None
    replicas: ReplicasTable | None = None
