"""Kinds of studies, one module each."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from rattlebox._util.plugins import load_plugins

if TYPE_CHECKING:
    from rattlebox.studies.run.study import Study

KINDS = (
    "sweep",
    "bifurcation",
    "frequency_response",
    "basins",
    "lyapunov",
    "loss_map",
    "stability_lobes",
    "design",
    "sensitivity",
)
"""Names of the built-in kinds: of their module, which is imported when it is needed, and the key `kind` of a study file."""


def study_kinds() -> tuple[str, ...]:
    """Return the names of all kinds, also of those of other packages."""
    from rattlebox.studies.run.study import Study

    load_plugins()
    return tuple(dict.fromkeys([*KINDS, *Study.kinds]))


def study_kind(name: str) -> type[Study]:
    """Return the class of a kind that `study_kinds` lists."""
    from rattlebox.studies.run.study import Study

    if name in KINDS:
        import_module(f"{__name__}.{name}")
    return Study.kinds[name]
