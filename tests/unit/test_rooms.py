"""Rooms use what stands below them, as the architecture page draws it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE, CORE = ROOT / "src/rattlebox", ROOT / "core"
ARROWS = {
    "cli": {"plots", "studies"},
    "plots": {"analysis", "model"},
    "studies": {"engines", "analysis"},
    "analysis": {"results"},
    "engines": {"results", "model"},
    "results": {"_util"},
    "model": {"exchange", "_util"},
    "exchange": {"_util"},
    "_util": set(),
    "core/python": {"core/impact", "core/dem"},
    "core/dem": {"core/contact", "core/structure"},
    "core/impact": {"core/contact", "core/structure"},
    "core/contact": {"core/base"},
    "core/structure": {"core/base"},
    "core/base": set(),
}
UPWARDS = {("results", "run.py", "plots"), ("results", "granular.py", "plots")}  # run.plot


def _below(room: str) -> set[str]:
    return {room}.union(*map(_below, ARROWS[room]))


def _imported(file: Path) -> Iterator[str]:
    """Rooms that a module imports, wherever it does."""
    package = ["rattlebox", *file.relative_to(PACKAGE).parts[:-1]]
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else []
            names = [[*base, *(node.module or "").split(".")]]
            if names[0] in (["rattlebox"], ["rattlebox", ""]):
                names = [["rattlebox", alias.name] for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name.split(".") for alias in node.names]
        else:
            continue
        yield from (name[1] for name in names if name[0] == "rattlebox" and len(name) > 1 and name[1] in ARROWS)


@pytest.mark.parametrize("file", sorted(PACKAGE.glob("*/**/*.py")), ids=lambda file: str(file.relative_to(PACKAGE)))
def test_modules_import_what_stands_below(file: Path) -> None:
    """No module imports from a room that its own does not lead to."""
    room = file.relative_to(PACKAGE).parts[0]
    upwards = {target for target in _imported(file) if target not in _below(room)}
    assert {(room, file.name, target) for target in upwards} <= UPWARDS


@pytest.mark.parametrize("file", sorted(CORE.rglob("*.?pp")), ids=lambda file: str(file.relative_to(CORE)))
def test_headers_include_what_stands_below(file: Path) -> None:
    """No header includes from a room that its own does not lead to."""
    room = f"core/{file.relative_to(CORE).parts[0]}"
    included = re.findall(r'#include "(\w+)/', file.read_text(encoding="utf-8"))
    assert {f"core/{target}" for target in included} <= _below(room)


def test_rooms_are_drawn_and_described() -> None:
    """The picture and the table of the architecture page hold all rooms that there are."""
    found = {file.parent.name for file in PACKAGE.glob("*/*.py")} | {
        f"core/{d.name}" for d in CORE.iterdir() if d.is_dir()
    }
    assert found == set(ARROWS)
    drawn = re.findall(r"<text[^>]*>([^<]*)</text>", (ROOT / "docs/_static/rooms.svg").read_text(encoding="utf-8"))
    described = re.findall(r"^\| `(.*?)` \|", (ROOT / "docs/architecture.md").read_text(encoding="utf-8"), re.M)
    assert found <= set(drawn)
    assert found == set(described)
