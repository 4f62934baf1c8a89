"""Files of a figure: its runs, recorded while they are simulated, as case and study files, and its data as CSV tables."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from math import nan
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import tomli_w

import rattlebox as rb

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox import Case, Run

Columns = dict[str, list[float]]  # Values by path into a case, one a run

_MEASURES = ("impacts", "impact_share", "viscous_share")  # of a study file; the reader may want others
_ONE_OF = {"dampers": "damper", "balls": "ball", "loads": "load"}  # lists of at most one item in the paper's cases

_recorded_cases: ContextVar[list[Case] | None] = ContextVar("recorded_cases", default=None)


def simulate(case: Case) -> Run:
    """Simulate a case with `rattlebox.simulate`, and record it."""
    return simulate_many([case])[0]


def simulate_many(cases: Sequence[Case]) -> list[Run]:
    """Simulate cases with `rattlebox.simulate_many`, and record them."""
    recorded = _recorded_cases.get()
    if recorded is not None:
        recorded.extend(cases)
    return rb.simulate_many(cases)


@contextmanager
def record_cases() -> Iterator[list[Case]]:
    """Record every case that is simulated inside a `with` block."""
    cases: list[Case] = []
    token = _recorded_cases.set(cases)
    try:
        yield cases
    finally:
        _recorded_cases.reset(token)


def grouped(named: Mapping[str, Case], runs: Sequence[Case]) -> dict[str, Columns]:
    """Group runs by the named case from which they differ in the fewest numbers, then by the least."""
    bases = {name: _fields(case) for name, case in named.items()}
    groups: dict[str, list[dict[str, float]]] = {name: [] for name in named}
    different = {(*numbers.items(), *others.items()): (numbers, others) for numbers, others in map(_fields, runs)}
    for numbers, others in different.values():
        changes = {
            name: {path: value for path, value in numbers.items() if base.get(path) != value}
            for name, (base, fixed) in bases.items()
            if fixed == others and base.keys() <= numbers.keys()
        }
        if not changes:
            raise ValueError(f"a run of {numbers['duration']:g} s differs from each named case in more than numbers")
        sizes = {
            name: (len(change), sum(abs(value - bases[name][0].get(path, 0.0)) for path, value in change.items()))
            for name, change in changes.items()
        }
        nearest = min(sizes, key=sizes.__getitem__)
        if changes[nearest]:
            groups[nearest].append(changes[nearest])
    return {name: _columns(bases[name][0], group) for name, group in groups.items() if group}


def _columns(base: Mapping[str, float], changes: Sequence[Mapping[str, float]]) -> Columns:
    paths = dict.fromkeys(path for change in changes for path in change)
    return {path: [change.get(path, base.get(path, nan)) for change in changes] for path in paths}


def _fields(case: Case) -> tuple[dict[str, float], dict[str, Any]]:
    """Return the numbers of a case by path, and its other fields."""
    whole = case.model_dump(exclude={"name"})
    others: dict[str, Any] = {"output": str(whole.pop("output"))}
    leaves = list(_leaves(whole))
    others |= {path: value for path, value in leaves if not isinstance(value, float | None)}
    return {path: value for path, value in leaves if isinstance(value, float)}, others


def _leaves(node: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the fields below a part of a case, with their paths as in study files."""
    if isinstance(node, dict):
        for name, value in node.items():
            for below in value if name in _ONE_OF else (value,):
                yield from _leaves(below, f"{path}.{_ONE_OF.get(name, name)}".lstrip("."))
    elif isinstance(node, tuple):
        for number, value in enumerate(node):
            yield from _leaves(value, f"{path}[{number}]")
    else:
        yield path, node


class Files(NamedTuple):
    """Files of a case and of the study of the runs that differ from it; paths are relative to the report."""

    case: str
    study: str
    runs: int
    varied: tuple[str, ...]  # What takes other values in them, as paths into the case


def write_runs(
    named: Mapping[str, Case], runs: Sequence[Case], folder: Path, subfolder: str, stem: str
) -> dict[str, Files]:
    """Write a case file for each named case, and a study file for the runs that differ from it."""
    studies = grouped(named, runs)
    written = {}
    for name, case in named.items():
        slug = re.sub(r"[^a-z0-9.]+", "_", name.lower()).strip("_.")
        path, columns = f"{subfolder}/{stem}_{slug}", studies.get(name, {})
        case.to_file(folder / f"{path}.toml")
        count = len(next(iter(columns.values()), ()))
        if columns:
            study = {"measure": list(_MEASURES), "case": {"file": f"{stem}_{slug}.toml"}, "axes": {"run": columns}}
            text = f"# {count} runs that differ from the case by what is listed under axes.run, one value a run.\n"
            (folder / f"{path}_study.toml").write_text(text + tomli_w.dumps(study), encoding="utf-8")
        written[name] = Files(f"{path}.toml", f"{path}_study.toml" if columns else "", count, tuple(columns))
    return written


def write_tables(data: xr.Dataset, folder: Path, stem: str) -> dict[Path, xr.Dataset]:
    """Write a dataset as CSV tables, one per group of dimensions; an unused coordinate is a table of its own."""
    data, tables = data.reset_coords(), {}
    dims = [tuple(map(str, variable.dims)) for variable in data.data_vars.values()]
    used = {name for group in dims for name in group}
    for group in dict.fromkeys(dims + [(str(name),) for name in data.coords if name not in used]):
        names = [name for name, variable in data.data_vars.items() if variable.dims == group]
        table = data[names or list(group)]
        path = folder / f"{'_'.join([stem, *(group or ('numbers',))])}.csv"
        frame = table.to_dataframe(dim_order=list(group)) if group else table.expand_dims("row").to_pandas()
        frame = frame.reset_index()[[*group, *table.data_vars]]
        units = {name: data[name].attrs.get("units", "") for name in frame}
        header = [f"{name} [{unit}]" if unit else name for name, unit in units.items()]
        frame.to_csv(path, index=False, header=header, na_rep="nan")
        tables[path] = table
    return tables
