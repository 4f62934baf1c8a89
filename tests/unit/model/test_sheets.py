"""Spreadsheets, which were no text."""

from __future__ import annotations

import time
import zipfile
from pathlib import Path

import numpy as np
import pytest
from support.mutants import mutant

import rattlebox as rb
from rattlebox._util import optional_imports

ROWS = [["time (ms)", "acc (g)", "load (N)"], [0, 0.5, 1], [2, -0.25, 2], [4, 0.125, 3]]


def cell(value: object) -> str:
    """Return the XML of a cell."""
    return f'<c t="inlineStr"><is><t>{value}</t></is></c>' if isinstance(value, str) else f"<c><v>{value}</v></c>"


def book(path: Path, *sheets: list[list[object]]) -> Path:
    """Write a spreadsheet of the fewest parts."""
    main, office = "http://schemas.openxmlformats.org/spreadsheetml/2006/main", "http://schemas.openxmlformats.org/"
    relations, kind = f"{office}package/2006/relationships", f"{office}officeDocument/2006/relationships"
    names = range(1, len(sheets) + 1)
    cells = [
        "".join(
            "<row>" + "".join(cell(c) for c in row) + "</row>"
            for row in rows
        )
        for rows in sheets
    ]  # fmt: skip
    with zipfile.ZipFile(path, "w") as file:
        file.writestr(
            "_rels/.rels",
            f'<Relationships xmlns="{relations}"><Relationship Id="r" Type="{kind}/officeDocument" '
            'Target="xl/workbook.xml"/></Relationships>',
        )
        file.writestr(
            "xl/workbook.xml",
            f'<workbook xmlns="{main}" xmlns:r="{kind}"><sheets>'
            + "".join(f'<sheet name="S{k}" sheetId="{k}" r:id="r{k}"/>' for k in names)
            + "</sheets></workbook>",
        )
        file.writestr(
            "xl/_rels/workbook.xml.rels",
            f'<Relationships xmlns="{relations}">'
            + "".join(f'<Relationship Id="r{k}" Type="{kind}/worksheet" Target="worksheets/s{k}.xml"/>' for k in names)
            + "</Relationships>",
        )
        for k in names:
            file.writestr(
                f"xl/worksheets/s{k}.xml",
                f'<worksheet xmlns="{main}"><sheetData>{cells[k - 1]}</sheetData></worksheet>',
            )
    return path


def test_a_sheet_is_a_table(tmp_path: Path) -> None:
    """Names, units and columns of a sheet are those of a text table; two sheets with numbers are refused."""
    pytest.importorskip("python_calamine")
    record = rb.Record.from_file(book(tmp_path / "a.xlsx", ROWS), columns=("time (ms)", "acc (g)"))
    np.testing.assert_allclose(record.values, 9.80665 * np.array([0.5, -0.25, 0.125]))
    np.testing.assert_allclose(record.times, [0, 0.002, 0.004])
    with pytest.raises(rb.RattleboxError, match="numbers in 2 sheets"):
        rb.Record.from_file(book(tmp_path / "b.xlsx", ROWS, ROWS))
    with pytest.raises(rb.RattleboxError, match=r"line 3: 'x' is not a number"):
        rb.Record.from_file(book(tmp_path / "c.xlsx", [*ROWS[:2], [2, "x", 1], ROWS[3]]), columns=(1, 2))


def test_damaged_sheets(tmp_path: Path) -> None:
    """A damaged file is read or refused, in two seconds at most, never with another error."""
    pytest.importorskip("python_calamine")
    content = book(tmp_path / "a.xlsx", ROWS).read_bytes()
    for number in range(300):
        (tmp_path / "a.xlsx").write_bytes(mutant(content, number))
        start = time.process_time()
        try:
            message = "try: " if rb.Record.from_file(tmp_path / "a.xlsx", columns=(1, 2)) else ""
        except rb.RattleboxError as error:
            message = str(error)
        assert "try: " in message and len(message) < 5000, f"mutant {number}"
        assert time.process_time() - start < 2, f"mutant {number}"


def test_a_missing_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message has the line that installs the library."""

    def absent(name: str) -> None:
        raise ModuleNotFoundError(name=name)

    monkeypatch.setattr(optional_imports, "import_module", absent)
    with pytest.raises(rb.RattleboxError, match=r"pip install 'rattlebox\[xlsx\]'"):
        rb.Record.from_file(book(tmp_path / "a.xlsx", ROWS))
