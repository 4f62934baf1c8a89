"""Cases of a figure: recorded while they run, and written as case files and study files."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import tomli_w

import rattlebox as rb

if TYPE_CHECKING:
    from rattlebox import Case, Run

Place = tuple[str | int, ...]  # Names of fields and numbers in lists: ("dampers", 0, "gap")

Columns = dict[str, list[float]]  # Values by path into a case, one a run

_MEASURES = ("impacts", "impact_share", "viscous_share")
"""What a study file asks for; the reader may want something else."""

_recorded_cases: ContextVar[list[Case] | None] = ContextVar("recorded_cases", default=None)


def simulate(case: Case) -> Run:
    """Simulate a case with `rattlebox.simulate`, and record it."""
    return simulate_many([case])[0]


def simulate_many(cases: Sequence[Case]) -> list[Run]:
    """Simulate cases with `rattlebox.simulate_many`, and record them."""
    noted = _recorded_cases.get()
    if noted is not None:
        noted.extend(cases)
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
    """Group runs by the named case from which they differ in the fewest numbers."""
    bases = {name: _Leaves(case) for name, case in named.items()}
    found: dict[str, list[dict[Place, float]]] = {name: [] for name in named}
    for run in {leaves.key: leaves for leaves in map(_Leaves, runs)}.values():
        changes = {name: change for name, base in bases.items() if (change := run.change_from(base)) is not None}
        if not changes:
            raise ValueError(
                f"a run of {run.numbers['duration',]:g} s differs from each named case in more than numbers"
            )
        name = min(changes, key=lambda name: (len(changes[name]), bases[name].distance(changes[name])))
        if changes[name]:
            found[name].append(changes[name])
    return {name: _columns(bases[name], changes) for name, changes in found.items() if changes}


class _Leaves:
    """Case split into its numbers by path and its other fields."""

    def __init__(self, case: Case) -> None:
        whole = case.model_dump(exclude={"name"})
        output = whole.pop("output")
        leaves = dict(_leaves(whole))
        self.numbers = {place: value for place, value in leaves.items() if isinstance(value, float)}
        self.rest = {place: value for place, value in leaves.items() if not isinstance(value, float | None)}
        self.key = (tuple(leaves.items()), str(output))

    def change_from(self, base: _Leaves) -> dict[Place, float] | None:
        """Return the numbers that turn the base into this case, None if other fields differ."""
        if self.key[1] != base.key[1] or self.rest != base.rest or base.numbers.keys() - self.numbers.keys():
            return None
        return {place: value for place, value in self.numbers.items() if base.numbers.get(place) != value}

    def distance(self, change: Mapping[Place, float]) -> float:
        """Return the size of a change."""
        return sum(abs(value - self.numbers.get(place, 0.0)) for place, value in change.items())


def _leaves(node: Any, place: Place = ()) -> Iterator[tuple[Place, Any]]:
    if isinstance(node, dict):
        for name, value in node.items():
            yield from _leaves(value, (*place, name))
    elif isinstance(node, tuple):
        for number, value in enumerate(node):
            yield from _leaves(value, (*place, number))
    else:
        yield place, node


_ONE_OF = {"dampers": "damper", "balls": "ball", "loads": "load"}


def _path(place: Place) -> str:
    """Return a path in the form of study files, for cases with at most one damper, ball and load."""
    path = ""
    for above, step in zip(("", *place), place, strict=False):
        if isinstance(step, str):
            path += ("." if path else "") + _ONE_OF.get(step, step)
        elif above not in _ONE_OF:
            path += f"[{step}]"
    return path


def _columns(base: _Leaves, changes: Sequence[Mapping[Place, float]]) -> Columns:
    places = list(dict.fromkeys(place for change in changes for place in change))
    return {
        _path(place): [change.get(place, base.numbers.get(place, float("nan"))) for change in changes]
        for place in places
    }


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
            (folder / f"{path}_study.toml").write_text(
                f"# {count} runs that differ from the case by what is listed under axes.run, one value a run.\n"
                + tomli_w.dumps(study),
                encoding="utf-8",
            )
        written[name] = Files(f"{path}.toml", f"{path}_study.toml" if columns else "", count, tuple(columns))
    return written
