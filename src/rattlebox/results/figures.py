"""Registry of the figures of runs, in which the modules of `rattlebox.plots` register their functions."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar

from rattlebox._util.plugins import Registry, load_plugins, owner_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .record import Record

Size = Literal["column", "page", "slide"]
"""Width of a figure."""

Draw = TypeVar("Draw", bound="Callable[..., Figure]")


class _Entry(NamedTuple):
    draw: Callable[..., Figure]
    needs: str


_REGISTRY: Registry[_Entry] = Registry("figure of runs")


def run_figure(name: str, needs: str = "motion") -> Callable[[Draw], Draw]:
    """Register a function of a run as one of its figures."""

    def register(draw: Draw) -> Draw:
        _REGISTRY.add(name, _Entry(draw, needs), owner_of(draw))
        return draw

    return register


class Plots:
    """Figures of one run, as methods; `dir` lists those that the run has, also of plug-ins."""

    if TYPE_CHECKING:  # what an editor shows; the functions in rattlebox.plots have the documentation and draw

        def case(self, *, size: Size = "page") -> Figure:
            """Draw the case; see `rattlebox.plots.plot_case`."""

        def energy(self, *, size: Size = "column", log: bool = False) -> Figure:
            """Draw the energy ledger; see `rattlebox.plots.plot_energy`."""

        def impacts(self, *, size: Size = "column", log: bool = False) -> Figure:
            """Draw the impact log of a 1-D run; see `rattlebox.plots.plot_impacts`."""

        def motion(self, *, size: Size = "column", between: tuple[float, float] | None = None) -> Figure:
            """Draw displacements and balls over time; see `rattlebox.plots.plot_motion`."""

        def particles(
            self,
            *,
            number: int = -1,
            colour: Literal["speed", "spin", "radius", "species", "none"] = "speed",
            view: str | tuple[float, float] = "oblique",
            size: Size = "page",
            renderer: Literal["pyvista", "plain"] | None = None,
        ) -> Figure:
            """Draw the particles of a 3-D run; see `rattlebox.plots.plot_particles`."""

        def phase_portrait(self, of: str | None = None, *, size: Size = "column") -> Figure:
            """Draw velocity over displacement; see `rattlebox.plots.plot_phase_portrait`."""

        def psd(
            self,
            *,
            of: str = "absolute_acceleration",
            point: str | None = None,
            resolution: float | None = None,
            size: Size = "column",
            between: tuple[float, float] | None = None,
        ) -> Figure:
            """Draw the power spectral density of a response; see `rattlebox.plots.plot_psd`."""

        def responses(
            self,
            *,
            of: str | Iterable[str] | None = None,
            size: Size = "column",
            between: tuple[float, float] | None = None,
        ) -> Figure:
            """Draw responses over time, one panel for each; see `rattlebox.plots.plot_responses`."""

        def shock_spectrum(
            self,
            *,
            point: str | None = None,
            damping_ratio: float = 0.05,
            size: Size = "column",
            between: tuple[float, float] | None = None,
        ) -> Figure:
            """Draw the shock response spectrum of points and of the base; see `rattlebox.plots.plot_shock_spectrum`."""

        def third_octaves(
            self,
            *,
            of: str = "absolute_acceleration",
            point: str | None = None,
            resolution: float | None = None,
            size: Size = "column",
            between: tuple[float, float] | None = None,
        ) -> Figure:
            """Draw the RMS of a response in third octaves; see `rattlebox.plots.plot_third_octaves`."""

    def __init__(self, run: Record) -> None:
        load_plugins()
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

        known = inspect.signature(draw)
        drawn.__signature__ = known.replace(parameters=list(known.parameters.values())[1:])  # type: ignore[attr-defined]
        drawn.__name__ = drawn.__qualname__ = name
        drawn.__doc__ = draw.__doc__
        return drawn
