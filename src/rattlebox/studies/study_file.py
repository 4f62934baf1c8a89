"""Study files: a case, its axes and what to measure, in TOML."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import ValidationError

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox.model.base import examples
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, nearest, translate
from rattlebox.model.files import existing, read_toml
from rattlebox.model.materials import Material

from . import sampling
from .axes import read_axes
from .studytables import INSIDE, KINDS, Range, Spaced, shape_of
from .studytables import Study as Content

if TYPE_CHECKING:
    import xarray

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
        Other arguments of the function, those that the file gives.
    kind
        Name of the function: "sweep", "bifurcation", "frequency_response", "basins", "lyapunov", "loss_map", "design" or
        "sensitivity".
    """

    case: Case
    axes: list[Any]
    options: dict[str, Any]
    kind: str = "sweep"

    def run(self, **where: Any) -> xarray.Dataset:
        """Run the study.

        Parameters
        ----------
        **where
            Arguments of the function that the file does not give: store, workers, backend, progress.

        Raises
        ------
        CaseError
            When something does not fit the case.
        """
        given: tuple[Any, ...] = (self.axes,) if self.axes else ()
        if self.kind == "bifurcation":
            ((name, values),) = self.axes[0].items()
            given = (tuple(values), tuple(values.values())) if isinstance(values, Mapping) else (name, values)
        study = getattr(import_module(f"rattlebox.studies.kinds.{self.kind}"), self.kind)
        found: xarray.Dataset = study(self.case, *given, **{**self.options, **where})
        return found


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

        With `kind = "bifurcation"` or the name of another ready map, the file holds the arguments of that function instead:
        `axes` is the one parameter of a bifurcation, the starts of basins, the axes of lyapunov; `frequencies`, `levels` and
        `amplitudes` are values; `parameters` of a design and `bounds` of a sensitivity are tables of
        `"damper.gap" = { from = "0.1 mm", to = "2 mm" }`, with `spacing = "log"` for a search in the logarithm, or of lists
        to choose from; their `levels` is a table like `axes`.

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
        given = _read(content, source)
        if "structure" in given and "case" not in given:
            raise Hint(
                "this is a case, not a study of one", f'rattlebox run {source}, or a study with case.file = "{source}"'
            )
        kind = given.get("kind", "sweep")
        if not isinstance(kind, str) or kind not in KINDS:
            raise Hint(f"kind = {kind!r}: there is no such kind of study", nearest(str(kind), KINDS))
        given = {name: _NESTED.get(name, _as_it_is)(value) for name, value in given.items()}
        study = KINDS[kind].model_validate(given)
        case, own = _case(study.case, source, folder or Path())
        axes = _axes(study, own)
        options = _options(study, own)
    except ValidationError as error:
        raise translate(error, source, {"": {"": examples(KINDS[kind])}, **INSIDE}, given) from None
    except Hint as hint:
        raise CaseError(f"{source}: {hint}") from None
    if study.axes_needed and not axes:
        raise CaseError(f"{source}: nothing varies\n  try: {_EXAMPLE}")
    if kind == "bifurcation" and len(axes[0]) > 1:
        raise CaseError(
            f"{source}: axes\n  a bifurcation diagram has one\n  try: a table [axes.together] that links them"
        )
    if axes:
        read_axes(case, axes, source=source)
    return Study(case, axes, options, kind)


def _read(content: str, source: str) -> dict[str, Any]:
    try:
        return read_toml(content, source)
    except CaseError as error:
        path = re.search(r"\n  ([\w.]+\[\d+\][^\s=]*)", str(error))
        hint = f'\n  try: quotes around a path with a number: "{path[1]}" = ...' if path else ""
        raise CaseError(f"{error}{hint}") from None


# ---- paths without quotes, which TOML reads as tables in tables


def _walk(table: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in table.items():
        if shape_of(value) == "linked":
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
            if name not in _ROOTS and shape_of(value) == "linked":
                yield name, _flat(_walk(value))
            else:
                yield from _walk({name: value})

    return _flat(lines()) if shape_of(table) == "linked" else table


def _flat_table(table: Any) -> Any:
    return _flat(_walk(table)) if isinstance(table, dict) else table


def _flat_inside(field: str) -> Any:
    def flatten(table: Any) -> Any:
        inside = table.get(field) if isinstance(table, dict) else None
        return {**table, field: _flat(_walk(inside))} if isinstance(inside, dict) else table

    return flatten


def _as_it_is(value: Any) -> Any:
    return value


_NESTED = {
    "axes": _flat_axes,
    "levels": _flat_axes,
    "parameters": _flat_table,
    "bounds": _flat_table,
    "design": _flat_inside("ranges"),
    "replicas": _flat_inside("reach"),
}


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
        except DataError as error:
            raise CaseError(f"{source}: case.file = {name!r}\n  {error}") from None
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
    except DataError as error:
        raise CaseError(str(error)) from None
    except OSError as error:
        raise CaseError(f"{file}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise CaseError(f"{file}: not text in UTF-8\n  try: a TOML file, saved as UTF-8") from None


def _read_values(path: str, values: Any, own: Mapping[str, Material]) -> Any:
    """Values of a parameter as the functions take them."""
    if isinstance(values, Spaced):
        return sampling.Spaced(values.start, values.to, values.count, values.spacing == "log", ("from", "to"))
    if isinstance(values, Range):
        return values.start, values.to
    if isinstance(values, list) and path.rpartition(".")[2] in ("material", "wall"):
        return [own.get(value, value) if isinstance(value, str) else value for value in values]
    return values


def _read_axes(axes: Mapping[str, Any], own: Mapping[str, Material]) -> dict[str, Any]:
    return {
        name: {path: _read_values(path, inner, own) for path, inner in values.items()}
        if isinstance(values, dict)
        else _read_values(name, values, own)
        for name, values in axes.items()
    }


def _axes(study: Content, own: Mapping[str, Material]) -> list[Any]:
    given = {name: getattr(study, name, None) for name in ("axes", "design", "replicas")}
    axes: list[Any] = [_read_axes(given["axes"], own)] if given["axes"] else []
    if random := given["design"]:
        ranges = {path: _read_values(path, values, own) for path, values in random.ranges.items()}
        axes.append(
            sampling.random_design(ranges, random.count, method=random.method, seed=random.seed, log=random.log)
        )
    if copies := given["replicas"]:
        axes.append(sampling.replicas(copies.reach, copies.count, seed=copies.seed))
    return axes


def _options(study: Content, own: Mapping[str, Material]) -> dict[str, Any]:
    """What else the file gives."""
    options = {}
    for name in sorted(study.model_fields_set - {"axes", "design", "replicas", "case", "kind"}):
        value = getattr(study, name)
        several = isinstance(value, dict) and name in _NESTED
        options[name] = _read_axes(value, own) if several else _read_values(name, value, own)
        log = [path for path, one in value.items() if getattr(one, "spacing", "") == "log"] if several else []
        if log and name != "levels":
            options["log"] = log
    return options
