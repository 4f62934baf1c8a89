"""HTML of objects that notebooks display. It sets no colours, so that it is readable in light and dark themes."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from html import escape as _escape
from typing import Any, ClassVar, TypeVar

from .text import printable

Entry = TypeVar("Entry")

_CELL = 'style="text-align:{align}; vertical-align:top; padding:2px 10px"'


def escape(text: str) -> str:
    """Return a text as content of an HTML element that shows it literally; not for attributes."""
    return _escape(printable(text), quote=False)


def paragraph(title: str, text: str = "") -> str:
    """Return a paragraph that begins with a title in bold, if there is one."""
    return f"<p><b>{escape(title)}</b> {escape(text)}</p>" if title else f"<p>{escape(text)}</p>"


def code_block(text: str) -> str:
    """Return a text with its line breaks, in a fixed-width font."""
    return f'<pre style="line-height:1.3">{escape(text)}</pre>'


def bullets(lines: Iterable[str]) -> str:
    """Return a list of sentences, empty if there are none."""
    items = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return f"<ul>{items}</ul>" if items else ""


def table(header: Sequence[str], rows: Iterable[Sequence[str]], numbers: bool = False) -> str:
    """Return a table."""

    def line(texts: Sequence[str], tag: str) -> str:
        aligns = ["left", *["right" if numbers else "left"] * (len(texts) - 1)]
        cells = (
            f"<{tag} {_CELL.format(align=align)}>{escape(text)}</{tag}>"
            for align, text in zip(aligns, texts, strict=True)
        )
        return f"<tr>{''.join(cells)}</tr>"

    head = f"<thead>{line(header, 'th')}</thead>" if any(header) else ""
    return f"<table>{head}<tbody>{''.join(line(row, 'td') for row in rows)}</tbody></table>"


class Catalogue(dict[str, Entry]):
    """A dictionary that notebooks display as a table; a subclass names the columns."""

    plural: ClassVar[str]
    columns: ClassVar[tuple[str, ...]]

    def row(self, name: str, entry: Entry) -> Sequence[str]:
        """Return the texts of one row."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return textwrap.fill(f"<{len(self)} {self.plural}: {', '.join(self)}>", 100)

    def _repr_html_(self) -> str:
        return table(self.columns, [self.row(name, entry) for name, entry in self.items()])

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self),)
