"""The data of a run, as its files store them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rattlebox._util.frozen import complete

from .arrays import RunArrays, same
from .ledger import Ledger
from .provenance import Provenance
from .run_end import RunEnd
from .schema import groups

if TYPE_CHECKING:
    from rattlebox.model.case import Case

_INCIDENTAL = {"memory_bytes"}
"""Counts that can differ when the same case is run again."""


@dataclass(frozen=True, eq=False, repr=False)
class Record:
    """The data of a run: arrays, case, status, counts, notes and provenance.

    Attributes
    ----------
    arrays : RunArrays
        The plain arrays, SI units, read-only.
    source : Case or str
        The case, or the text of its case file; see `case` and `case_toml`.
    provenance : Provenance
        Version, method, seed, date and platform; default those of this process.
    status : str
        "finished", or the reason why the run ended early.
    message : str
        Explanation of the status with advice.
    notes : tuple of str
        Warnings, and in 3-D runs what limits the time step.
    counts : mapping of str to int
        Numbers of events and steps, by name (`schema.COUNTS`).
    diagnostics : mapping of str to float
        Time step, largest overlap and so on, by name (`schema.DIAGNOSTICS`); empty for 1-D runs.
    wall_time : float
        Computing time [s].
    end : RunEnd or None
        State from which another run can continue; see `rattlebox.simulate`.

    Raises
    ------
    ValueError
        If the name of a count is not an identifier.
    """

    arrays: RunArrays
    source: Case | str = ""
    provenance: Provenance = field(default_factory=Provenance.now)
    status: str = "finished"
    message: str = ""
    notes: tuple[str, ...] = ()
    counts: Mapping[str, int] = field(default_factory=dict)
    diagnostics: Mapping[str, float] = field(default_factory=dict)
    wall_time: float = 0.0
    end: RunEnd | None = None

    def __post_init__(self) -> None:
        for name in self.counts:
            if not name.isidentifier():
                raise ValueError(f"count {name!r} is not an identifier")
        complete(
            self,
            notes=tuple(self.notes),
            counts=MappingProxyType({name: int(number) for name, number in self.counts.items()}),
            diagnostics=MappingProxyType({name: float(value) for name, value in self.diagnostics.items()}),
            wall_time=float(self.wall_time),
        )

    @cached_property
    def case(self) -> Case:
        """The case that was run.

        Raises
        ------
        CaseError
            If the run was read from a file, and a file that its case names can no longer be read.
        """
        if isinstance(self.source, str):
            from rattlebox.model.case import Case

            return Case.from_toml(self.source)
        return self.source

    @cached_property
    def case_toml(self) -> str:
        """The case that was run, as the text of a case file."""
        return self.source if isinstance(self.source, str) else self.source.to_toml()

    @property
    def ok(self) -> bool:
        """True if the run reached its end and its energies add up."""
        return self.status == "finished"

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the datasets of the run, `motion`, `energy`, and `impacts` (1-D) or `particles` (3-D)."""
        return tuple(groups(self.arrays.engine))

    @cached_property
    def ledger(self) -> Ledger:
        """Sums over all energies, in J, each (T,)."""
        return Ledger(self.arrays)

    @property
    def energy_residual(self) -> float:
        """Largest imbalance of the energy ledger over the energy that was put in.

        max|E(t) - E(0) - W_load - W_base + losses| / (max|W_load| + max|W_base| + E(0)); a gravity
        potential V enters the denominator as max|V(t) - V(0)|, since its zero is arbitrary.
        """
        return self.ledger.energy_residual

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Record):
            return NotImplemented
        return same(self._results, other._results) and self.case_toml == other.case_toml

    __hash__ = None  # type: ignore[assignment]

    @property
    def _results(self) -> dict[str, Any]:
        """Fields that are equal whenever the same case is run on the same kind of machine."""
        counts = {name: number for name, number in self.counts.items() if name not in _INCIDENTAL}
        names = ("arrays", "status", "message", "notes", "diagnostics")
        return {name: getattr(self, name) for name in names} | {"counts": counts}

    def __reduce__(self) -> tuple[Any, ...]:
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        return _rebuild, (type(self), {**values, "counts": dict(self.counts), "diagnostics": dict(self.diagnostics)})

    def __repr__(self) -> str:
        arrays = self.arrays
        contents = [f"{arrays.time[0]:g} to {arrays.time[-1]:g} s", _count(len(arrays.points), "point")]
        if "impacts" in arrays:
            contents += [_count(len(arrays.balls), "ball"), _count(len(arrays.impacts), "impact")]
        else:
            contents.append(f"{_count(len(arrays.particles), 'particle')} in {_count(len(arrays.dampers), 'damper')}")
        contents += [_count(len(self.notes), "note")] if self.notes else []
        return f"<Run {self.status}: {', '.join(contents)}>"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _rebuild(cls: type[Record], values: dict[str, Any]) -> Record:
    return cls(**values)
