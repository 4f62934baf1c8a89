"""Tests that the reproduction uses public names only."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

import rattlebox as rb

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/reference/api.md").read_text(encoding="utf-8")
PUBLIC = {"rattlebox"} | set(re.findall(r"`(rattlebox\.\w+)`", PAGE.partition("```")[0]))
"""Modules whose names are public: the package, and the subpackages that the introduction of the API page names."""
SOURCES = sorted((ROOT / "reproduction").rglob("*.py"))


def uses(source: str) -> Iterator[tuple[str, str]]:
    """Yield module and name of everything that a file takes from Rattlebox; the name is empty for whole modules."""
    tree = ast.parse(source)
    aliases = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.partition(".")[0] == "rattlebox":
                    aliases[alias.asname or "rattlebox"] = alias.name if alias.asname else "rattlebox"
                    yield alias.name, ""
        elif (
            isinstance(node, ast.ImportFrom) and not node.level and (node.module or "").partition(".")[0] == "rattlebox"
        ):
            for alias in node.names:
                yield str(node.module), alias.name
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in aliases:
            yield aliases[node.value.id], node.attr


def is_public(module: str, name: str) -> bool:
    """Return whether a name is public."""
    return module in PUBLIC and (name in ("", "__version__") or name in import_module(module).__all__)


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: file.name)
def test_only_public_names_are_used(file: Path) -> None:
    """Everything that a file takes from the package is public."""
    assert [use for use in uses(file.read_text(encoding="utf-8")) if not is_public(*use)] == []


def test_scan_detects_private_names() -> None:
    """Private modules and names are found however they are imported."""
    source = """
import rattlebox as rb
import rattlebox.core.choose
from rattlebox.plots.style import pen
from rattlebox.plots import paper, pen
def late():
    from rattlebox.model.case import Case
    return rb.engines, rb.Case
"""
    assert {use for use in uses(source) if not is_public(*use)} == {
        ("rattlebox.core.choose", ""),
        ("rattlebox.plots.style", "pen"),
        ("rattlebox.plots", "paper"),
        ("rattlebox.model.case", "Case"),
        ("rattlebox", "engines"),
    }


def test_there_are_public_subpackages() -> None:
    """The API page names the subpackages that are names of the package."""
    assert {"rattlebox.analysis", "rattlebox.plots"} <= PUBLIC
    assert all(module.partition(".")[2] in ("", *rb.__all__) for module in PUBLIC)


def test_package_does_not_import_the_reproduction() -> None:
    """No file of the package imports the reproduction or names its modules."""
    for file in (ROOT / "src").rglob("*.py"):
        assert not re.search(r"\breproduction[./]|(?:import|from) reproduction\b", file.read_text(encoding="utf-8")), (
            file
        )
