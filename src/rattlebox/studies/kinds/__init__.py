"""Kinds of studies, one module each: a class with its fields, its measures, its figure and its report."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING

from rattlebox._util.plugins import load_plugins

if TYPE_CHECKING:
    from rattlebox.studies.run.study import Study

BUILT_IN = tuple(module.name for module in iter_modules(__path__))
"""Names of the built-in kinds: of their module, which is imported when it is needed, and the key `kind` of a study file."""


def study_kinds() -> tuple[str, ...]:
    """Return the names of all kinds, also of those of other packages."""
    from rattlebox.studies.run.study import Study

    load_plugins()
    return tuple(dict.fromkeys([*BUILT_IN, *Study.kinds]))


def study_kind(name: str) -> type[Study]:
    """Return the class of a kind that `study_kinds` lists."""
    from rattlebox.studies.run.study import Study

    if name in BUILT_IN:
        import_module(f"{__name__}.{name}")
    return Study.kinds[name]
