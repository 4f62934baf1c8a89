"""Common style of all figures: widths of a journal, colours that work in greyscale and for colour-blind readers."""

from __future__ import annotations

import io
import math
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from textwrap import wrap
from typing import IO, Any, Literal, NamedTuple, cast

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter
from numpy.typing import ArrayLike

from rattlebox._util.atomic_io import atomic_write
from rattlebox._util.exceptions import CaseError
from rattlebox._util.narrow import present
from rattlebox._util.own_files import seal
from rattlebox._util.quantities import in_unit

from .types import Size, Style, Vector

WIDTHS: dict[Size, float] = {"column": 85.0, "page": 178.0, "slide": 254.0}
"""Width of a figure [mm]: one column and the full page of a journal, and a slide."""

_DPI: dict[Size, float] = {"column": 300.0, "page": 300.0, "slide": 150.0}
_FONT: dict[Size, float] = {"column": 8.0, "page": 8.0, "slide": 15.0}

INK = "#1a1a1a"
FAINT = "#b3b3b3"

CHANNEL_COLOURS: dict[str, str] = {
    "viscous": "#0b3d6b",
    "normal": "#d1742c",
    "sliding": "#8fb8c9",
    "rolling": "#a33b5c",
    "plastic": "#b4cf7a",
    "motion": "#e3ecf3",
    "structure": "#0b3d6b",
    "particles": "#d1742c",
    "contact": "#7d9a4b",
    "gravity": "#9a86b8",
    "work": INK,
}
"""Fill colour of each energy channel; neighbours in the ledger differ clearly in lightness."""

SERIES_COLOURS: tuple[str, ...] = ("#0b3d6b", "#d1742c", "#5f9ea0", "#a33b5c", "#8c8c2e", "#7a6fb0")
SERIES_STYLES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5)), (0, (3, 1)), (0, (8, 2)))
SERIES_MARKERS: tuple[str, ...] = ("o", "^", "s", "D", "v", "P")
ABOVE: Style = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0)}
"""Place of a legend above its axes."""


def series_colour(number: int) -> str:
    """Return the colour of a series; the colours repeat."""
    return SERIES_COLOURS[number % len(SERIES_COLOURS)]


def _settings(size: Size) -> Style:
    font = _FONT[size]
    line = font / 8.0
    return {
        "font.family": "sans-serif",
        "font.sans-serif": ["DejaVu Sans"],
        "mathtext.fontset": "dejavusans",
        "font.size": font,
        "axes.labelsize": font,
        "axes.titlesize": font,
        "axes.titleweight": "normal",
        "axes.titlelocation": "left",
        "xtick.labelsize": 0.9 * font,
        "ytick.labelsize": 0.9 * font,
        "legend.fontsize": 0.9 * font,
        "legend.title_fontsize": 0.9 * font,
        "axes.linewidth": 0.6 * line,
        "xtick.major.width": 0.6 * line,
        "ytick.major.width": 0.6 * line,
        "xtick.major.size": 2.5 * line,
        "ytick.major.size": 2.5 * line,
        "xtick.minor.size": 1.5 * line,
        "ytick.minor.size": 1.5 * line,
        "lines.linewidth": 0.9 * line,
        "lines.markersize": 3.0 * line,
        "axes.edgecolor": INK,
        "axes.labelcolor": INK,
        "xtick.color": INK,
        "ytick.color": INK,
        "text.color": INK,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.xmargin": 0.0,
        "axes.prop_cycle": cycler(color=SERIES_COLOURS),
        "legend.frameon": False,
        "legend.handlelength": 1.8,
        "legend.borderaxespad": 0.2,
        "legend.columnspacing": 1.2,
        "legend.labelspacing": 0.25,
        "figure.facecolor": "white",
        "axes.facecolor": "white",
        "agg.path.chunksize": 20000,
        "pdf.fonttype": 42,
        "svg.fonttype": "none",
    }


@contextmanager
def figure_style(size: Size = "column") -> Iterator[None]:
    """Apply the style of all figures of Rattlebox inside a `with` block, or to a function as a decorator.

    Parameters
    ----------
    size
        "column" (85 mm), "page" (178 mm) or "slide" (254 mm, larger letters).

    Raises
    ------
    ValueError
        If there is no such size.

    Examples
    --------
    >>> import matplotlib.pyplot as plt
    >>> from rattlebox.plots import figure_style
    >>> with figure_style("page"):
    ...     figure, axes = plt.subplots(figsize=(7, 3))
    ...     lines = axes.plot([0, 1], [0, 1])
    >>> plt.close(figure)
    """
    if size not in WIDTHS:
        raise CaseError(f"size = {size!r}: unknown size", ", ".join(map(repr, WIDTHS)))
    with mpl.rc_context(cast("Any", _settings(size))):
        yield


class StyledFigure(Figure):
    """Figure without a window, displayed by notebooks, that is saved in the style in which it was drawn.

    Parameters
    ----------
    size
        "column", "page" or "slide".
    height
        Ratio of height to width.
    """

    def __init__(self, size: Size, height: float) -> None:
        width = WIDTHS[size] / 25.4
        super().__init__(figsize=(width, height * width), layout="constrained", dpi=_DPI[size])
        self._size_name: Size = size

    def savefig(self, fname: str | os.PathLike[str] | IO[bytes], **options: Any) -> None:
        """Save the figure as `matplotlib.figure.Figure.savefig` does, with editable text in PDF and SVG.

        Parameters
        ----------
        fname
            File to write; its suffix determines the format.
        **options
            Options of `matplotlib.figure.Figure.savefig`.
        """
        with figure_style(self._size_name):
            if isinstance(fname, (str, os.PathLike)):
                self._save(Path(fname), options)
            else:
                super().savefig(fname, **options)

    def _save(self, path: Path, options: Style) -> None:
        """Write a file atomically; a name without a suffix gets that of the format, as in matplotlib."""
        form = options.pop("format", None) or path.suffix[1:] or str(mpl.rcParams["savefig.format"])
        path = path if path.suffix else path.with_name(f"{path.name}.{form}")
        if form == "png":
            # Level 4 takes two thirds of the time of the default level 6 and writes slightly larger files.
            options = {"pil_kwargs": {"compress_level": 4}} | options
        # To memory: matplotlib's writers of PDF files hide the error of a full disk.
        content = io.BytesIO()
        super().savefig(content, format=form, **options)
        with atomic_write(path, "make room and save the figure again") as name:
            name.write_bytes(seal(content.getvalue(), ".png") if form == "png" else content.getbuffer())

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png")
        return buffer.getvalue()


def map_colours() -> Colormap:
    """Return the colour map of maps, whose lightness rises evenly, so that it works in greyscale."""
    from cmcrameri import cm  # type: ignore[import-untyped]

    colours: Colormap = cm.batlow
    return colours


def colour_bar(
    figure: Figure, mappable: ScalarMappable, axes: Axes | list[Axes], text: str, **options: Any
) -> Colorbar:
    """Add a colour bar with a label and without a frame to the right of axes."""
    bar = figure.colorbar(mappable, ax=axes, pad=0.02, **options)
    bar.outline.set_visible(False)
    bar.set_label(text)
    return bar


class Scale(NamedTuple):
    """Divisor of the values on an axis, and their unit with an SI prefix."""

    divisor: float
    unit: str


def scaled(values: ArrayLike, unit: str) -> Scale:
    """Return the divisor and the unit with the SI prefix that suits the largest value.

    Parameters
    ----------
    values
        Values in SI units, any shape; may be empty.
    unit
        SI unit.

    Returns
    -------
    Scale
        Divisor, and unit with its prefix.
    """
    array = np.abs(np.asarray(values, dtype=float))
    array = array[np.isfinite(array)]
    return Scale(*in_unit(float(array.max()) if array.size else 0.0, unit))


def label(axes: Axes, which: Literal["x", "y"], text: str, unit: str) -> None:
    """Label an axis with a text and a unit; on a vertical axis the unit is on a second line.

    Parameters
    ----------
    axes
        Axes to label.
    which
        "x" or "y".
    text
        Name of the quantity.
    unit
        Unit with its prefix; "" for a pure number.
    """
    unit = unit.replace("^2", "²").replace("^0.5", "$^{0.5}$")
    if which == "x":
        axes.set_xlabel(f"{text} ({unit})" if unit else text)
        return
    # Lines that are shorter than the panel is high, so that labels do not run into each other.
    lines = wrap(text, letters(axes, "y")) if unit or len(text) > letters(axes, "y") else text.rsplit(" ", 1)
    axes.set_ylabel("\n".join([*lines, f"({unit})"] if unit else lines))


_FEW_DECADES = 1000.0
"""Ratio of the ends of a logarithmic axis up to which 2 and 5 are written beside the powers of ten."""


def axis_in_g(
    axes: Axes,
    which: Literal["x", "y"],
    per_g: float | tuple[Callable[[Any], Any], Callable[[Any], Any]],
    text: str = "",
    unit: str = "g",
) -> None:
    """Add a second axis in g above or to the right of axes.

    Parameters
    ----------
    axes
        Axes, on whose scale the second one depends.
    which
        "x" or "y".
    per_g
        Value on the axis that is an acceleration of 1 g; or the functions from the values to the accelerations in g, and
        back, if they are not in proportion.
    text
        Name of the quantity.
    unit
        Unit of the second axis, "g" or one that contains it.
    """
    both = per_g if isinstance(per_g, tuple) else (lambda value: value / per_g, lambda value: value * per_g)
    second = axes.secondary_xaxis("top", both) if which == "x" else axes.secondary_yaxis("right", both)
    axis = second.xaxis if which == "x" else second.yaxis
    log = (axes.get_xscale() if which == "x" else axes.get_yscale()) == "log"
    axis.set_minor_formatter(NullFormatter())
    low, high = axes.get_xlim() if which == "x" else axes.get_ylim()
    few = which == "x" or (low > 0 and high < _FEW_DECADES * low)
    if few or not log:
        axis.set_major_formatter("{x:g}")
    if few and log:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    unit = unit.replace("^2", "²")
    axis.set_label_text(f"{text} ({unit})" if text else unit)


def pen(width: float = 0.6) -> float:
    """Return a line width in proportion to the font size.

    Parameters
    ----------
    width
        Line width [pt] at a font size of 8 pt.

    Returns
    -------
    float
        Line width [pt] at the font size of the current style.
    """
    return width * float(mpl.rcParams["font.size"]) / 8.0


def time_axis(axes: Axes, time: Vector, scale: Scale, ticks: int = 6) -> None:
    """Label the time axis of the lowest panel and limit it to the drawn times, (n,) [s]."""
    label(axes, "x", "Time", scale.unit)
    axes.xaxis.set_major_locator(MaxNLocator(ticks, steps=[1, 2, 5, 10]))
    if len(time) > 1:
        axes.set_xlim(time[0] / scale.divisor, time[-1] / scale.divisor)


def legend_above(axes: Axes, **options: Any) -> None:
    """Place the legend above the axes, in as many columns as fit.

    Parameters
    ----------
    axes
        Axes with labelled artists; without any, nothing happens.
    **options
        Options of `Axes.legend`.
    """
    handles, names = axes.get_legend_handles_labels()
    if handles:
        room = letters(axes)
        # As few rows as possible, and then no more columns than these rows need.
        rows = math.ceil(len(names) / _fitting_columns(names, room))
        columns = math.ceil(len(names) / rows)  # fill the last row as well as possible
        texts = [shorten(name, room - _HANDLE_LETTERS) for name in names]
        axes.legend(handles, texts, ncols=columns, **(ABOVE | options))


def shorten(text: str, room: int) -> str:
    """Replace the middle of a text that is too long by an ellipsis."""
    if len(text) <= room:
        return text
    tail = (room - 1) // 2
    return f"{text[: room - 1 - tail]}…{text[len(text) - tail :]}"


def letters(axes: Axes, along: Literal["x", "y"] = "x") -> int:
    """Estimate the number of letters that fit in a legend above an axes, or in a line of the label to its left."""
    figure, grid = present(axes.get_figure(root=True)), axes.get_gridspec()
    if along == "y":
        length, share = figure.get_figheight() / (grid.nrows if grid is not None else 1), 0.75
    else:
        length, share = figure.get_figwidth() / (grid.ncols if grid is not None else 1), 0.8
    return max(int(share * 72.0 * length / (0.58 * 0.9 * float(mpl.rcParams["font.size"]))), 1)


_HANDLE_LETTERS = 6  # width of a legend handle in letters


def _fitting_columns(names: list[str], room: int) -> int:
    """Return the largest number of legend columns that are not wider than `room` letters."""
    for columns in range(len(names), 1, -1):
        if sum(max(len(name) for name in names[k::columns]) + _HANDLE_LETTERS for k in range(columns)) <= room:
            return columns
    return 1
