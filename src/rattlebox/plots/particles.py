"""Pictures and films of the particles in their cavities."""

from __future__ import annotations

import io
import logging
import operator
import os
import tomllib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.animation import AbstractMovieWriter
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from numpy.typing import NDArray
from pydantic import TypeAdapter

from rattlebox._util.atomic_io import atomic_write
from rattlebox._util.exceptions import DataError
from rattlebox._util.optional_imports import optional_import
from rattlebox._util.progress import progress_bar

from ..model.any_cavity import AnyCavity
from ..model.bodies import AnyBody, Body
from ..model.cavities import Cavity
from ..model.interior import Interior
from ..results import Run
from ..results.figures import run_figure
from ..results.snapshots import Frame, Snapshots
from .spheres import Renderer, draw_spheres
from .style import (
    INK,
    WIDTHS,
    StyledFigure,
    colour_bar,
    figure_style,
    map_colours,
    pen,
    scaled,
    series_colour,
)
from .types import Size

Array = NDArray[np.float64]

FILMS = (".gif", ".mp4")
_LOST = "make room and give the same command again"

Colour = Literal["speed", "spin", "radius", "species", "none"]
COLOURS: tuple[Colour, ...] = ("speed", "spin", "radius", "species", "none")
_WALL = "#eef2f5"

VIEWS: dict[str, tuple[float, float]] = {
    "oblique": (-60.0, 18.0),
    "front": (-90.0, 0.0),
    "side": (0.0, 0.0),
    "top": (-90.0, 90.0),
    "corner": (-45.0, 35.264),
}
"""Azimuth and elevation of the viewer [degrees] by name: "front" looks along y, "side" against x, "top" down along z."""


def view_axes(view: str | tuple[float, float]) -> Array:
    """Return the directions to the right, up and towards the viewer, (3, 3), one per row.

    `view`: name of a view, or azimuth from x towards y and elevation over the x-y plane [degrees].
    """
    try:
        azimuth, elevation = np.radians(np.asarray(VIEWS[view] if isinstance(view, str) else view, dtype=float))
    except (KeyError, TypeError, ValueError):
        names = ", ".join(map(repr, VIEWS))
        raise ValueError(f"view {view!r} is not one of {names}, or a pair of azimuth and elevation") from None
    if not (np.isfinite(azimuth) and abs(elevation) <= np.pi / 2):
        raise ValueError(f"view {view!r}: the elevation must be from -90 to 90 degrees, the azimuth finite")
    towards = [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.array([right, np.cross(towards, right), towards])


VIEW: Array = view_axes("oblique")
"""Directions of the usual view: x points to the right, z upwards."""


@run_figure("particles", needs="particles")
def plot_particles(
    of: Run | Snapshots,
    *,
    number: int = -1,
    colour: Colour = "speed",
    view: str | tuple[float, float] = "oblique",
    size: Size = "page",
    renderer: Renderer | None = None,
) -> Figure:
    """Draw the particles in their cavities at one time, as seen from the base, or from a cavity that turns.

    Parameters
    ----------
    of
        A run, of which the final state is drawn, or its snapshots.
    number
        Index of the snapshot; negative ones count from the end.
    colour
        "speed", "spin", "radius", "species" or "none".
    view
        "oblique", "front" (along y), "side" (against x), "top", "corner"; or azimuth and elevation of the viewer [degrees].
    size
        Width of the figure: "column", "page" or "slide".
    renderer
        "pyvista" or "plain"; default PyVista where it is installed.

    Returns
    -------
    Figure
        With one panel for each cavity; cells with offsets are in one panel.

    Raises
    ------
    TypeError
        If something else is given.
    AttributeError
        If the run has no particles.
    ValueError
        When the size is unknown.
    DataError
        When there is no snapshot.
    """
    if not isinstance(of, (Run, Snapshots)):
        raise TypeError(f"a run with particles or its snapshots are needed, not {of!r:.60}")
    if isinstance(of, Snapshots) and not len(of):
        raise DataError(f"{of.path} holds no snapshot yet", "again when the run has taken one")
    frame = of[number] if isinstance(of, Snapshots) else _end(of)
    with figure_style(size):
        return _Scene([frame], of.case_toml, size, renderer, colour=colour, view=view).figure


def film_particles(
    snapshots: Snapshots,
    out: str | os.PathLike[str],
    *,
    rate: int = 20,
    colour: Colour = "speed",
    view: str | tuple[float, float] = "oblique",
    pixels: tuple[int, int] = (1280, 720),
    renderer: Renderer | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> Path:
    """Write a film of the particles in their cavities, with a picture for each snapshot, seen as in `particles`.

    Parameters
    ----------
    snapshots
        Snapshots of a run.
    out
        File to write, .gif or .mp4.
    rate
        Pictures a second.
    colour, view
        Colours and direction of view, as of `plot_particles`.
    pixels
        Width and height of the pictures, even numbers of 160 or more.
    renderer
        "pyvista" or "plain"; default PyVista where it is installed.
    progress
        True for a progress bar after 2 s, False for none, or a function of the numbers of pictures done and of all; the
        film stops if it returns False.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    TypeError
        When something else than snapshots is given, as a run, which knows its particles at the end only.
    ValueError
        When the ending is another one, or there is no such colour, view or size.
    DataError
        When there is no snapshot, or the file cannot be written; an earlier one is then as it was.
    MissingDependency
        When .mp4 is asked for and imageio-ffmpeg is not installed.
    """
    if not isinstance(snapshots, Snapshots):
        raise TypeError(f'snapshots are needed, as rb.Snapshots("run.vtkhdf"), not {snapshots!r:.60}')
    path = Path(out)
    if path.suffix not in FILMS:
        raise ValueError(f"{path}: a film is {' or '.join(FILMS)}")
    if not len(snapshots):
        raise DataError(f"{snapshots.path} holds no snapshot yet", "again when the run has taken one")
    from matplotlib.animation import FFMpegWriter, PillowWriter

    width, height = _checked_pixels(pixels)
    with figure_style("slide"):
        import matplotlib as mpl

        if path.suffix == ".mp4":
            ffmpeg = optional_import("imageio_ffmpeg", "3d", "a name that ends in .gif")
            mpl.rcParams["animation.ffmpeg_path"] = ffmpeg.get_ffmpeg_exe()
        dpi = width / (WIDTHS["slide"] / 25.4)
        shape = height / width
        scene = _Scene(snapshots, snapshots.case_toml, "slide", renderer, dpi, colour=colour, view=view, shape=shape)
        # The first picture decides the layout. Were each laid out anew, titles of other widths would shake the film.
        scene.figure.savefig(io.BytesIO(), dpi=dpi)
        scene.figure.set_layout_engine("none")  # all pictures are laid out as the first
        writer: AbstractMovieWriter = (PillowWriter if path.suffix == ".gif" else FFMpegWriter)(fps=rate)
        with atomic_write(path, _LOST) as name, progress_bar(progress, "pictures") as report:
            writer.setup(scene.figure, os.fspath(name), dpi=dpi)
            try:
                for number in range(len(snapshots)):
                    scene.show(number)
                    writer.grab_frame()
                    report.advance(number + 1, len(snapshots))
            except BaseException:
                _close_quietly(writer)
                raise
            writer.finish()
    return path


def _checked_pixels(pixels: tuple[int, int]) -> tuple[int, int]:
    """Return width and height; raise if films cannot have them."""
    try:
        width, height = (operator.index(number) for number in pixels)
    except (TypeError, ValueError):
        width = height = 0
    if not all(160 <= number <= 7680 and number % 2 == 0 for number in (width, height)):
        raise ValueError(f"pixels {pixels!r}: width and height must be even numbers from 160 to 7680, as (1280, 720)")
    return width, height


def _close_quietly(writer: AbstractMovieWriter) -> None:
    """Close FFmpeg without its message that it was stopped or has no picture yet."""
    log = logging.getLogger("matplotlib.animation")
    before, log.disabled = log.disabled, True
    try:
        with suppress(Exception):
            writer.finish()
    finally:
        log.disabled = before


def _end(run: Run) -> Frame:
    """Return the particles at the end of a run."""
    particles = run.arrays.particles
    displacement = run.arrays.cavity_displacement[-1]
    return Frame(
        time=float(run.arrays.time[-1]),
        position=particles.position + displacement[particles.damper],
        velocity=particles.velocity,
        spin=particles.spin,
        contact_force=np.zeros_like(particles.radius),
        radius=particles.radius,
        mass=particles.mass,
        cavity=particles.damper,
        species=particles.species,
        displacement=displacement,
    )


@dataclass(frozen=True)
class _Group:
    """Equal cavities that one panel shows."""

    name: str
    cavity: Cavity
    first: int  # Number of the first of these cavities in the case
    places: Array  # Of each of them [m], (k, 3)

    @property
    def cells(self) -> range:
        """Numbers of the cavities in the case."""
        return range(self.first, self.first + len(self.places))


def _groups(dampers: Sequence[Mapping[str, Any]]) -> list[_Group]:
    """Return the cavities of a case, whose other files may be missing: cells with offsets together, others one by one."""
    form: TypeAdapter[Cavity] = TypeAdapter(AnyCavity)
    inside: TypeAdapter[tuple[Body, ...]] = TypeAdapter(tuple[AnyBody, ...])
    groups: list[_Group] = []
    first = 0
    for damper in dampers:
        cavity = Interior.of(form.validate_python(damper["cavity"]), inside.validate_python(damper.get("bodies", ())))
        points, given = max(1, len(damper.get("points", ()))), damper.get("name", "")
        offsets = np.array(damper.get("offsets", ()), float)
        before = first
        for places in [offsets] * points if len(offsets) else [np.zeros((1, 3))] * (points * damper.get("number", 1)):
            name = f"{given}{first - before + 1}" if first > before else given
            last = first + len(places)
            usual = f"damper {last}" if last == first + 1 else f"dampers {first + 1} to {last}"
            groups.append(_Group(name if given else usual, cavity, first, places))
            first = last
    return groups


@dataclass
class _Panel:
    axes: Axes
    image: AxesImage
    lines: list[tuple[Line2D, Array, int]]  # With the number of the cell in the group
    walls: list[Polygon]
    extent: tuple[float, float, float, float]


class _Scene:
    """Figure that shows one frame of several."""

    def __init__(
        self,
        frames: Sequence[Frame] | Snapshots,
        case_toml: str,
        size: Size,
        renderer: Renderer | None,
        dpi: float = 300.0,
        *,
        colour: Colour = "speed",
        view: str | tuple[float, float] = "oblique",
        shape: float | None = None,
    ) -> None:
        if colour not in COLOURS:
            raise ValueError(f"colour {colour!r} is not one of {', '.join(map(repr, COLOURS))}")
        self._dpi, self._colour, self._view = dpi, colour, view_axes(view)
        case = tomllib.loads(case_toml)
        self._groups = _groups(case["dampers"])
        self._frames, self._renderer = frames, renderer
        # One pass over all frames, each of which is read from the file: their colours, motions and the last time.
        columns = [(_values(frame, colour), frame.displacement, frame.time) for frame in frames]
        values = np.concatenate([column for column, _, _ in columns])
        self._moves, self._last = np.array([moves for _, moves, _ in columns]), columns[-1][2]
        self._scale = scaled(values, _UNITS[colour])
        self._map, self._norm = self._colours(values, len(frames) > 1)
        extents = [self._extent(group) for group in self._groups]
        sides = [(right - left, top - bottom) for left, right, bottom, top in extents]
        ratio = max(h for _, h in sides) / sum(w for w, _ in sides)
        self.figure = StyledFigure(size, min(0.86 * ratio + 0.1, 1.1) if shape is None else shape)
        widths = [w for w, _ in sides]
        panels = list(self.figure.subplots(1, len(widths), squeeze=False, width_ratios=widths)[0])
        parts = zip(self._groups, panels, extents, strict=True)
        self._panels = [self._panel(group, axes, extent) for group, axes, extent in parts]
        if colour != "none":
            shaken = "base" in case or case["structure"]["kind"] == "shaker"
            self._draw_key(panels, "Speed relative\nto the base" if shaken and colour == "speed" else _TITLES[colour])
        self.show(0)

    def _colours(self, values: Array, several: bool) -> tuple[Colormap, Normalize]:
        """Return the colour map, and the values at its ends; a few outliers in a film do not set them."""
        if self._colour in ("species", "none"):
            count = int(values.max(initial=0)) + 1
            colours = [series_colour(k) for k in range(count)]
            return ListedColormap(colours), Normalize(-0.5, count - 0.5)
        low = float(values.min()) if self._colour == "radius" else 0.0
        top = float(np.quantile(values, 0.99)) if several and self._colour != "radius" else float(values.max())
        if self._colour == "radius" and top - low < 1e-9 * top:
            low, top = 0.5 * top, 1.5 * top
        return map_colours(), Normalize(low / self._scale.divisor, max(top, 1e-12) / self._scale.divisor)

    def _draw_key(self, panels: list[Axes], title: str) -> None:
        """Draw the colour bar, with whole numbers for species."""
        unit = f" ({self._scale.unit})" if self._scale.unit else ""  # two lines at most: pictures of flat boxes are low
        values = ScalarMappable(self._norm, self._map)
        bar = colour_bar(self.figure, values, panels, f"{title}{unit}", aspect=28)
        if self._colour == "species":
            bar.set_ticks(list(range(self._map.N)), labels=[str(number) for number in range(self._map.N)])

    def _extent(self, group: _Group) -> tuple[float, float, float, float]:
        """Return the edges of a panel that contains its cavities at all times."""
        corners = np.concatenate(group.cavity.outline(self._view)) @ self._view.T
        moves = (self._moves[:, group.cells] + group.places).reshape(-1, 3) @ self._view.T
        low, high = corners.min(axis=0) + moves.min(axis=0), corners.max(axis=0) + moves.max(axis=0)
        margin = 0.03 * float((high - low)[:2].max())
        return low[0] - margin, high[0] + margin, low[1] - 3 * margin, high[1] + margin

    def _panel(self, group: _Group, axes: Axes, extent: tuple[float, float, float, float]) -> _Panel:
        axes.set_axis_off()
        image = axes.imshow(np.zeros((1, 1, 4), np.uint8), extent=extent, zorder=2, interpolation="antialiased")
        lines, walls = [], []
        outline = group.cavity.outline(self._view)
        for cell in range(len(group.places)):
            walls += axes.fill([0.0], [0.0], facecolor=_WALL, edgecolor="none", zorder=0)
            for line in outline:
                behind = line.mean(axis=0) @ self._view[2] < 0
                (drawn,) = axes.plot([], [], color=INK, linewidth=pen(0.7), alpha=0.6 if behind else 1.0)
                drawn.set_zorder(1 if behind else 3)
                lines.append((drawn, line, cell))
        _draw_scale_bar(axes, extent)
        axes.set_xlim(extent[0], extent[1])
        axes.set_ylim(extent[2], extent[3])
        axes.set_aspect("equal")
        return _Panel(axes, image, lines, walls, extent)

    def show(self, number: int) -> None:
        """Show a frame."""
        from scipy.spatial import ConvexHull  # takes a fifth of a second to load

        frame = self._frames[number]
        colours = self._map(self._norm(_values(frame, self._colour) / self._scale.divisor))[:, :3]
        time = scaled([self._last], "s")
        for group, panel in zip(self._groups, self._panels, strict=True):
            here = (frame.cavity >= group.cells.start) & (frame.cavity < group.cells.stop)
            width = round(self.figure.get_figwidth() * self._dpi * 0.85 / len(self._panels))
            panel.image.set_data(
                draw_spheres(
                    (frame.position[here] + group.places[frame.cavity[here] - group.first]) @ self._view.T,
                    frame.radius[here],
                    colours[here],
                    panel.extent,
                    width,
                    self._renderer,
                )
            )
            centres = frame.displacement[group.cells] + group.places
            for drawn, line, cell in panel.lines:
                placed = (line + centres[cell]) @ self._view.T
                drawn.set_data(placed[:, 0], placed[:, 1])
            # The cavity as it is seen is the convex hull of its projected corners.
            corners = group.cavity.surface().points @ self._view[:2].T
            hull = corners[ConvexHull(corners).vertices]
            for wall, centre in zip(panel.walls, centres @ self._view[:2].T, strict=True):
                wall.set_xy(hull + centre)
            name = f"{group.name}, " if len(self._panels) > 1 else ""
            panel.axes.set_title(f"{name}{frame.time / time.divisor:.4g} {time.unit}")


def _draw_scale_bar(axes: Axes, extent: tuple[float, float, float, float]) -> None:
    """Draw a scale bar at the lower left."""
    left, right, bottom, top = extent
    about = 0.25 * (right - left)
    length = max(step for step in np.outer(10.0 ** np.arange(-7, 3), [1, 2, 5]).ravel() if step <= about)
    height = bottom + 0.025 * (top - bottom)
    axes.plot([left, left + length], [height, height], color=INK, linewidth=pen(1.6), solid_capstyle="butt")
    unit = scaled([length], "m")
    axes.text(left + 1.15 * length, height, f"{length / unit.divisor:g} {unit.unit}", va="center")


_UNITS: dict[Colour, str] = {"speed": "m/s", "spin": "rad/s", "radius": "m", "species": "", "none": ""}
_TITLES: dict[Colour, str] = {"speed": "Speed", "spin": "Spin", "radius": "Radius", "species": "Species"}


def _values(frame: Frame, colour: Colour) -> Array:
    """Return the numbers by which particles are coloured, (N,)."""
    if colour in ("speed", "spin"):
        return np.asarray(np.linalg.norm(frame.velocity if colour == "speed" else frame.spin, axis=1))
    values = {"radius": frame.radius, "species": frame.species, "none": np.zeros_like(frame.radius)}[colour]
    return np.asarray(values, dtype=float)
