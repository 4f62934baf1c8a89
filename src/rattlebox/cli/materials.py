"""`rattlebox materials`: the library of materials."""

from __future__ import annotations

from rich.table import Column, Table

from rattlebox.cli.terminal import terminal
from rattlebox.model.materials import materials


def show_materials() -> None:
    """Print the library as a table, and below it the sources of the values."""
    numbers = (Column(head, justify="right") for head in ("density\nkg/m³", "E\nGPa", "ν", "yield\nMPa"))
    table = Table(Column("name", no_wrap=True), "material", *numbers)
    sources = Table(Column("name", no_wrap=True), "source", box=None)
    for name, m in materials().items():
        strength = "" if m.yield_stress is None else f"{m.yield_stress / 1e6:g}"
        table.add_row(name, m.title, f"{m.density:g}", f"{m.young / 1e9:g}", f"{m.poisson:g}", strength)
        sources.add_row(name, m.source)
    terminal().print(table, sources)
