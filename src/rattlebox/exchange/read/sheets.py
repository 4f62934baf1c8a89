"""Tables of spreadsheets (.xlsx, .xlsm, .xlsb, .xls, .ods) as lines of text."""

from __future__ import annotations

from pathlib import Path

from rattlebox._util.exceptions import DataError
from rattlebox._util.optional_imports import optional_import

from .formats import no_signals, record_reader
from .guarded import errors_of

SHEETS = (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods")
"""Endings of spreadsheets."""

record_reader(*SHEETS)(no_signals)


def sheet_lines(path: Path) -> list[str]:
    """Return the rows of the only sheet with numbers, with tabs between the cells."""
    with errors_of(path, "a spreadsheet"):
        path.open("rb").close()  # the library would hide the reason if this fails
        calamine = optional_import("python_calamine", "xlsx", "save the sheet as CSV")
        try:
            book = calamine.CalamineWorkbook.from_path(str(path))
            tables = {name: book.get_sheet_by_name(name).to_python(skip_empty_area=False) for name in book.sheet_names}
        except Exception as error:
            raise DataError(f"{path} cannot be read as a spreadsheet: {str(error)[:200]}", "the sheet as CSV") from None
        except BaseException as error:
            if type(error).__name__ != "PanicException":  # of the library, which is no Exception
                raise
            raise DataError(f"{path} cannot be read as a spreadsheet; it is damaged", "the sheet as CSV") from None
        used = {name: table for name, table in tables.items() if any(_is_number(cell) for row in table for cell in row)}
        if len(used) != 1:
            names = ", ".join(map(repr, used))[:200] or "none"
            raise DataError(
                f"{path} has numbers in {len(used)} sheets ({names}); one is needed", "a copy with one sheet, or CSV"
            )
        (table,) = used.values()
        return ["\t".join(" ".join(str(cell).split()) for cell in row) for row in table]


def _is_number(cell: object) -> bool:
    return isinstance(cell, (int, float)) and not isinstance(cell, bool)
