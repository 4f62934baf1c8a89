"""Contents of a case file as a tree of tables and lists: names of files, shortened lists, empty values."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

_LONG = 12  # items of a list
_LONG_TEXT = 300  # characters


def without_empty(value: object) -> Any:
    """Remove empty values, since TOML has no null."""
    if isinstance(value, dict):
        return {
            key: without_empty(item) for key, item in value.items() if item is not None and item not in ("", [], {})
        }
    if isinstance(value, list):
        return [without_empty(item) for item in value]
    return value


def shortened(value: object) -> Any:
    """Return tables and lists with a note in place of all but the first items of long lists and of long texts."""
    if isinstance(value, dict):
        return {key: shortened(item) for key, item in value.items()}
    if isinstance(value, list):
        items = value if len(value) <= _LONG else [*value[:3], f"... {len(value)} in all"]
        return [shortened(item) for item in items]
    return f"{value[:_LONG_TEXT]}..." if isinstance(value, str) and len(value) > _LONG_TEXT else value


def with_files(node: object, name_of: Callable[[str], str]) -> Any:
    """Return a copy of a tree with `name_of` applied to the names of files, also to those of axes such as "base.file"."""
    if isinstance(node, dict):
        return {
            key: _renamed(item, name_of) if str(key).rpartition(".")[2] == "file" else with_files(item, name_of)
            for key, item in node.items()
        }
    return [with_files(item, name_of) for item in node] if isinstance(node, list) else node


def _renamed(file: object, name_of: Callable[[str], str]) -> Any:
    """Return `name_of` of the name of a file, or of each name in a table or a list."""
    if isinstance(file, dict):
        return {key: _renamed(item, name_of) for key, item in file.items()}
    if isinstance(file, list):
        return [_renamed(item, name_of) for item in file]
    return name_of(file) if isinstance(file, str) else file


def relative(file: str, folder: Path) -> str:
    """Return the path of a file relative to a folder; the full path of one on another drive."""
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:
        return file
