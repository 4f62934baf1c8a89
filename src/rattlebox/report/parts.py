"""Parts of a report, and the declaration of the content for one kind of result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rattlebox.model.case import Case

Result = TypeVar("Result")


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
    """Call that computes a result again.

    `case` is the argument of the function that is made from the case, `study` what stands for it in a study file.
    """

    function: str
    arguments: Mapping[str, Any] = {}
    kind: str = ""
    remarks: tuple[str, ...] = ()
    first: str = ""
    case: str = "case"
    study: Mapping[str, Any] = {}


def nothing(result: object) -> tuple[()]:
    """Return no parts."""
    return ()


@dataclass(frozen=True)
class Kind(Generic[Result]):
    """Content of the report about one kind of result; each function takes the result."""

    name: str
    cases: Callable[[Result], Mapping[str, Case]]
    question: Callable[[Result], str]
    answer: Callable[[Result], Iterable[str]]
    call: Callable[[Result], Call | None]
    pictures: Callable[[Result], Iterable[Picture]] = nothing
    tables: Callable[[Result], Iterable[Table]] = nothing
    warnings: Callable[[Result], Iterable[str]] = nothing
    limits: Callable[[Result], Iterable[Limit]] = nothing
    about: Callable[[Result], Iterable[str]] = nothing
