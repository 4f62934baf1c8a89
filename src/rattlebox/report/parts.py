"""Parts of a report, and the declaration of the content for one kind of result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rattlebox.model.case import Case


class Picture(NamedTuple):
    """A figure of a report.

    Attributes
    ----------
    caption
        Content of the figure, in one or two sentences.
    draw
        Function that draws the figure.
    """

    caption: str
    draw: Callable[[], Figure]


class Table(NamedTuple):
    """A table of a report.

    Attributes
    ----------
    title
        Title above the table; "" for none.
    header
        Titles of the columns; empty for none.
    rows
        Texts of each row. All columns but the first are aligned to the right if `numbers`.
    note
        Sentence below the table; "" for none.
    numbers
        Whether the columns after the first hold numbers.
    """

    title: str
    header: tuple[str, ...]
    rows: Sequence[Sequence[str]]
    note: str = ""
    numbers: bool = False


class Limit(NamedTuple):
    """A limit of the method, with its value in this result.

    Attributes
    ----------
    name
        Approximation.
    here
        Value in this result, with its unit.
    allowed
        Largest allowed value; "" where no limit exists.
    meaning
        Meaning of the limit for the reader, and how to check it.
    """

    name: str
    here: str
    allowed: str
    meaning: str


class Call(NamedTuple):
    """Call that computes a result again.

    Attributes
    ----------
    function
        Name of the function in `rattlebox`.
    arguments
        Its arguments after the case, by name, in types that TOML can write.
    kind
        Kind of the study file with these arguments; "" if no study file can start it.
    remarks
        Arguments that the call lacks, such as functions of the user.
    first
        Source of the first argument in place of the case, which follows as `case`, if there is one.
    """

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
    """Content of the report about one kind of result; each function takes the result.

    Attributes
    ----------
    name
        Name of the kind, as a title.
    cases
        Cases that are drawn and listed, by name; "" if there is only one.
    question
        The question that the result answers, one sentence.
    answer
        Sentences with the main numbers and their 95 % intervals.
    call
        How to compute the result again; None if there is no such call.
    pictures
        Figures with captions.
    tables
        Tables of the main numbers.
    warnings
        Warnings of the runs in full.
    limits
        Limits of the method.
    """

    name: str
    cases: Callable[[Any], Mapping[str, Case]]
    question: Callable[[Any], str]
    answer: Callable[[Any], Iterable[str]]
    call: Callable[[Any], Call | None]
    pictures: Callable[[Any], Iterable[Picture]] = nothing
    tables: Callable[[Any], Iterable[Table]] = nothing
    warnings: Callable[[Any], Iterable[str]] = nothing
    limits: Callable[[Any], Iterable[Limit]] = nothing
    about: Callable[[Any], Iterable[str]] = field(default=nothing)
