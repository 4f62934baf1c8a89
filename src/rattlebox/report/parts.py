"""Parts of a report, and the declaration of the content for one kind of result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rattlebox.model.case import Case


class Picture(NamedTuple):
    """A figure of a report."""

    caption: str
    draw: Callable[[], Figure]


class Table(NamedTuple):
    """A table of a report."""

    title: str
    header: tuple[str, ...]
    rows: Sequence[Sequence[str]]
    note: str = ""
    numbers: bool = False


class Limit(NamedTuple):
    """A limit of the method, with its value in this result."""

    name: str
    here: str
    allowed: str
    meaning: str


class Call(NamedTuple):
    """Call that computes a result again."""

    function: str
    arguments: Mapping[str, Any] = {}
    kind: str = ""
    remarks: tuple[str, ...] = ()
    first: str = ""


def nothing(result: Any) -> Iterable[Any]:
    """Return no parts."""
    return ()


@dataclass(frozen=True)
class Kind:
    """Content of the report about one kind of result; each function takes the result."""

    name: str
    cases: Callable[[Any], Mapping[str, Case]]
    question: Callable[[Any], str]
    answer: Callable[[Any], Iterable[str]]
    call: Callable[[Any], Call | None]
    pictures: Callable[[Any], Iterable[Picture]] = nothing
    tables: Callable[[Any], Iterable[Table]] = nothing
    warnings: Callable[[Any], Iterable[str]] = nothing
    limits: Callable[[Any], Iterable[Limit]] = nothing
    about: Callable[[Any], Iterable[str]] = nothing
