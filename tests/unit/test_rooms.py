"""Rooms of the core use what stands below them, and the architecture page shows all rooms; import-linter checks Python."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE, CORE = ROOT / "src/rattlebox", ROOT / "core"
ARROWS = {
    "core/bindings": {"core/stepper", "core/impact", "core/dem"},
    "core/stepper": {"core/impact", "core/dem"},
    "core/dem": {"core/contact", "core/structure", "core/parallel"},
    "core/impact": {"core/contact", "core/structure"},
    "core/contact": {"core/util"},
    "core/structure": {"core/util"},
    "core/parallel": set(),
    "core/util": {"core/math"},
    "core/math": set(),
}


def _below(room: str) -> set[str]:
    return {room}.union(*map(_below, ARROWS[room]))


@pytest.mark.parametrize("file", sorted(CORE.rglob("*.?pp")), ids=lambda file: str(file.relative_to(CORE)))
def test_headers_include_what_stands_below(file: Path) -> None:
    """No header includes from a room that its own does not lead to."""
    room = f"core/{file.relative_to(CORE).parts[0]}"
    included = re.findall(r'#include "(\w+)/', file.read_text(encoding="utf-8"))
    assert {f"core/{target}" for target in included} <= _below(room)


def test_rooms_are_drawn_and_described() -> None:
    """The picture and the table of the architecture page hold all rooms that there are."""
    result = {file.parent.name for file in PACKAGE.glob("*/*.py")} | {
        f"core/{d.name}" for d in CORE.iterdir() if d.is_dir()
    }
    drawn = re.findall(r"<text[^>]*>([^<]*)</text>", (ROOT / "docs/_static/rooms.svg").read_text(encoding="utf-8"))
    described = re.findall(
        r"^\| `(.*?)` \|", (ROOT / "docs/developing/architecture.md").read_text(encoding="utf-8"), re.M
    )
    assert result <= set(drawn)
    assert result == set(described)


def test_frozen_objects_are_completed_in_one_place() -> None:
    """Frozen objects change in `_util/frozen.py` alone, and no import for types is hidden from the search for cycles."""
    files = [path for path in PACKAGE.rglob("*.py") if path.name != "frozen.py"]
    assert not [str(path) for path in files if re.search(r"\w\.__setattr__\b", path.read_text(encoding="utf-8"))]
    assert "exclude_type_checking_imports" not in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def test_nothing_outside_the_model_asks_for_the_kind_of_a_thing() -> None:
    """Behaviour of kinds is on their classes: no `isinstance` over kinds outside of it, which a new kind would miss."""
    size = runpy.run_path(str(ROOT / "tools" / "size.py"))
    sources = [size["read"](path) for path in sorted(PACKAGE.rglob("*.py"))]
    assert len(size["kinds"](sources)) > 30
    assert list(size["ladders"](sources)) == []
