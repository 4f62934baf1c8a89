"""Content of a report, and its page in HTML."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from markupsafe import Markup, escape

from rattlebox._util.exceptions import RattleboxError
from rattlebox._util.templates import render as fill
from rattlebox._util.text import printable
from rattlebox.model.case import Case
from rattlebox.plots.case import plot_case
from rattlebox.studies.orbits.branch import Branch

from .inputs import input_tables
from .kinds import kind_of
from .parts import Limit, Picture, Table
from .reproduce import Recipe, recipe, short_names

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GENERATOR = "Rattlebox report"
"""Name in the page by which reports of this program are recognised."""

_MAX_SVG_BYTES = 300_000
"""Largest drawing that is embedded as SVG; larger ones become PNG."""
_DPI = 170.0
_MAX_CASES = 6
"""Most cases that are drawn with their inputs."""


class Image(NamedTuple):
    """A figure as a data URL, "" if it cannot be drawn, with its caption and its width [mm]."""

    url: str
    caption: str
    width: float = 0.0


class Described(NamedTuple):
    """A case with its drawing and its inputs; those that differ from another case, if its name is given."""

    name: str
    drawing: Image | None
    tables: tuple[Table, ...]
    other: str | None = None
    problem: str = ""


@dataclass(frozen=True)
class Section:
    """Content of the page about one result."""

    title: str
    kind: str
    question: str
    answer: tuple[str, ...]
    cases: tuple[Described, ...]
    images: tuple[Image, ...]
    tables: tuple[Table, ...]
    warnings: tuple[str, ...]
    limits: tuple[Limit, ...]
    about: tuple[str, ...]
    recipe: Recipe


def section(result: Any, title: str, case: Case | None, question: str | None) -> Section:
    """Return the section of the page about a result."""
    if isinstance(result, Branch):
        result = result.data
    kind = kind_of(result)
    result = _with_short_names(result)
    if case is not None and hasattr(result, "assign_attrs") and not isinstance(result.attrs.get("case"), str):
        result = result.assign_attrs(case=case.to_toml())
    # A dataset may lack its case, or name a file that is gone: the page then states that, and has all the rest.
    problem, cases = "", {}
    try:
        cases = dict(kind.cases(result))
    except RattleboxError as error:  # the dataset has no case, or a file that the case names is gone
        problem = error.complaint
    described: list[Described] = []
    for name, named_case in list(cases.items())[:_MAX_CASES]:
        described.append(describe(name, named_case, described[0] if described else None))
    if problem:
        described = [Described("", None, (), problem=problem)]
    return Section(
        title=title,
        kind=kind.name,
        question=question or kind.question(result),
        answer=tuple(kind.answer(result)),
        cases=tuple(described),
        images=tuple(image(picture) for picture in kind.pictures(result)),
        tables=tuple(table for table in kind.tables(result) if table.rows),
        warnings=tuple(kind.warnings(result)),
        limits=tuple(kind.limits(result)),
        about=tuple(kind.about(result)),
        recipe=recipe(cases, kind.call(result)),
    )


def _with_short_names(result: Any) -> Any:
    """Return a study whose axes over files have the names of these, without folders that hold them all."""
    for name in [name for name in getattr(result, "coords", ()) if str(name).rpartition(".")[2] == "file"]:
        coord = result[name]
        short = short_names([str(file) for file in coord.values])
        result = result.assign_coords({name: (coord.dims, [short[str(file)] for file in coord.values], coord.attrs)})
    return result


def describe(name: str, case: Case, first: Described | None = None) -> Described:
    """Return the drawing and the inputs of a case; of a further one the inputs that differ from those of the first."""
    drawing = image(Picture(_drawing_caption(case), partial(plot_case, case))) if first is None else None
    tables = input_tables(case)
    if first is not None:
        known = {(table.title, tuple(row)) for table in first.tables for row in table.rows}
        tables = [
            table._replace(rows=[row for row in table.rows if (table.title, tuple(row)) not in known])
            for table in tables
        ]
    other = None if first is None else first.name or "the first case"
    return Described(name, drawing, tuple(table for table in tables if table.rows), other)


def _drawing_caption(case: Case) -> str:
    scale = "Dampers, beams and plates are to scale, other structures are symbols."
    beds = [damper.packing.kind for damper in case.particle_dampers]
    start = " Particles are at their positions at the start." if beds else ""
    return f"The case. {scale}{start}"


def image(picture: Picture) -> Image:
    """Return a drawn figure with its caption: SVG, or PNG if that is smaller."""
    try:
        figure = picture.draw()
        return Image(data_url(figure), picture.caption, 25.4 * figure.get_figwidth())
    except RattleboxError as error:  # such as basins over one axis, which have no map
        complaint = getattr(error, "complaint", str(error))
        return Image("", f"{picture.caption} Not drawn: {complaint}.")


def data_url(figure: Figure) -> str:
    """Return a figure as a data URL: a small drawing as SVG, a large one or a picture as PNG."""
    import matplotlib as mpl

    # A picture in an SVG would be a PNG in base64; and many lines make an SVG larger than their PNG.
    if not any(axes.images for axes in figure.axes):
        buffer = io.BytesIO()
        # Text as outlines looks the same in every browser; equal reports have equal bytes.
        with mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": "rattlebox"}):
            mpl.figure.Figure.savefig(figure, buffer, format="svg", metadata={"Date": None})
        if buffer.tell() <= _MAX_SVG_BYTES:
            return f"data:image/svg+xml;base64,{base64.b64encode(buffer.getvalue()).decode()}"
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=_DPI)
    return f"data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode()}"


def render(sections: list[Section], title: str) -> str:
    """Return the page as self-contained HTML."""
    from rattlebox import __version__

    return fill(
        "rattlebox.report",
        "report.html",
        {"typeset": typeset, "download": _download},
        generator=GENERATOR,
        title=title,
        sections=sections,
        version=__version__,
        created=datetime.now(UTC).isoformat(" ", timespec="minutes")[:16],
    )


_TYPESET = (
    (re.compile(r"(\d+(?:\.\d+)?)e([+-]?)0*(\d+)\b"), r"\1 × 10<sup>\2\3</sup>"),
    (re.compile(r"\^(-?[\d.]*\d)"), r"<sup>\1</sup>"),
    (re.compile(r"\+-"), "±"),
    (re.compile(r"(?<![\w)\]./:&#-])-(?=\d)"), "−"),
)


def typeset(text: str) -> Markup:
    """Return a text as HTML, with powers of ten, exponents and minus signs."""
    html = str(escape(printable(text)))
    for pattern, printed in _TYPESET:
        html = pattern.sub(printed, html)
    return Markup(html)


def _download(text: str) -> str:
    """Return a text file as a data URL."""
    return f"data:text/plain;charset=utf-8;base64,{base64.b64encode(text.encode()).decode()}"


def sections_of(result: object, case: Case | None = None, question: str | None = None) -> Iterator[Section]:
    """Yield a section for each result of a mapping, or for the only one."""
    results: Mapping[str, Any] = {"": result}
    if isinstance(result, Mapping) and result and not hasattr(result, "data_vars"):
        try:
            kind_of(result)  # a mapping of damping curves is one result
        except RattleboxError:
            results = result
    for name, one in results.items():
        yield section(one, str(name), case, question)
