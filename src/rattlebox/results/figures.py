"""Registries of the figures of runs and of studies, in which the modules of `rattlebox.plots` register their functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .record import Record

Draw = TypeVar("Draw", bound="Callable[..., Figure]")


class _Entry(NamedTuple):
    draw: Callable[..., Figure]
    needs: str


_REGISTRY: dict[str, _Entry] = {}


def run_figure(name: str, needs: str = "motion") -> Callable[[Draw], Draw]:
    """Register a function of a run as one of its figures."""

    def register(draw: Draw) -> Draw:
        _REGISTRY[name] = _Entry(draw, needs)
        return draw

    return register


_STUDIES: dict[str, Callable[..., Figure]] = {}


def study_figure(kind: str) -> Callable[[Draw], Draw]:
    """Register a function of a dataset as the figure of a kind of study."""

    def register(draw: Draw) -> Draw:
        _STUDIES[kind] = draw
        return draw

    return register


def figures_of_studies() -> dict[str, Callable[..., Figure]]:
    """Return the figure of each kind of study that has one of its own."""
    return dict(_STUDIES)


class Plots:
    """Figures of one run, as methods; `dir` lists those that the run has."""

    def __init__(self, run: Record) -> None:
        self._run = run

    def __dir__(self) -> list[str]:
        return sorted(name for name, entry in _REGISTRY.items() if entry.needs in self._run.groups)

    def __getattr__(self, name: str) -> Callable[..., Figure]:
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in dir(self):
            raise AttributeError(f"this run has no figure {name!r}; it has {', '.join(dir(self))}")
        draw, run = _REGISTRY[name].draw, self._run

        def drawn(*arguments: Any, **options: Any) -> Figure:
            return draw(run, *arguments, **options)

        drawn.__doc__ = draw.__doc__
        return drawn
