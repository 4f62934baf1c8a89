"""Drawing of a case: its structure, and each damper to scale."""

from __future__ import annotations

from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rattlebox._util.phrases import joined

from ..model.case import Case
from ..model.damper_base import Damper
from ..results import Run
from ..results.case_words import each_damper
from ..results.figures import run_figure
from .case_dampers import Cells, draw_damper
from .case_stops import draw_stops
from .case_structures import draw_structure
from .style import StyledFigure, figure_style, shorten
from .types import Size

_MAX_DAMPERS = 3
"""Most dampers in a drawing; further ones are named below it."""
_MAX_LETTERS, _MAX_LOADS = 60, 3


class _Group(NamedTuple):
    """Dampers that are drawn once, since they differ in name, point, start and random seed only."""

    damper: Damper
    numbers: list[int]
    cells: Cells


def plot_case(case: Case, *, size: Size = "page") -> Figure:
    """Draw a case: the structure with its loads and the points of its dampers, each damper to scale, and its stops.

    Beams and plates are drawn to scale, with the shape of the first mode of a beam in grey; oscillators, buildings and modal
    models have no geometry and are drawn as symbols. Cells are drawn at their offsets. Beds of more than 2000 particles are
    drawn as a level.

    Parameters
    ----------
    case
        Case to draw.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with a panel for the structure, one for each of up to three different dampers, and one for stops.

    Raises
    ------
    TypeError
        If something else is given.
    ValueError
        If the size is unknown.

    Examples
    --------
    >>> import rattlebox as rb
    >>> figure = rb.plot_case(rb.reference_case())
    >>> len(figure.axes)
    2
    """
    if not isinstance(case, Case):
        raise TypeError(f"a case is needed, not {case!r:.60}")
    groups = _groups(case)
    shown = groups[:_MAX_DAMPERS]
    stops = [stop.model_copy(update={"name": stop.label(index)}) for index, stop in enumerate(case.stops)]
    count = 1 + len(shown) + bool(stops)
    with figure_style(size):
        narrow = size == "column"
        shape = (count, 1) if narrow else (-(-count // 2), 2) if count > 2 else (1, count)
        figure = StyledFigure(size, (0.72 if narrow else 0.4) * shape[0])
        panels: list[Axes] = list(figure.subplots(*shape, squeeze=False).ravel())
        marks = {number: str(k + 1) for k, group in enumerate(groups) for number in group.numbers}
        draw_structure(panels[0], case, marks if len(groups) > 1 else dict.fromkeys(marks, ""))
        panels[0].set_title(_loads(case), parse_math=False)
        for k, (panel, group) in enumerate(zip(panels[1:], shown, strict=False)):
            draw_damper(group.damper, panel, group.cells)
            panel.set_title(_heading(case, group, k + 1 if len(groups) > 1 else 0), parse_math=False)
        if stops:
            draw_stops(panels[1 + len(shown)], stops, [case.modes.point(stop.point) for stop in stops])
            panels[1 + len(shown)].set_title("stops" if len(stops) > 1 else "stop")
        for panel in panels[count:]:
            panel.set_axis_off()
        if len(groups) > len(shown):
            panels[0].set_xlabel(f"{len(groups) - len(shown)} further dampers are not drawn")
        figure.draw_without_rendering()  # Equal scales change the room for titles, which only a second layout takes in.
    return figure


@run_figure("case")
def plot_run_case(run: Run, *, size: Size = "page") -> Figure:
    """Draw the case of a run; see `plot_case`."""
    return plot_case(run.case, size=size)


def _groups(case: Case) -> list[_Group]:
    """Return the dampers, equal ones in one group."""
    together: list[Cells] = [[] for _ in case.impact_dampers]
    for _, places in case.cell_groups:
        first = len(together) - len(case.impact_dampers)
        cells: Cells = list(zip(case.particle_dampers[first : first + len(places)], places, strict=True))
        together += [cells] * len(places)
    groups: dict[str, _Group] = {}
    for number, (damper, drawn) in enumerate(zip(each_damper(case), together, strict=True)):
        # Dampers that differ in name, point, start, random seed and place on the rotor only have equal drawings.
        rotation = getattr(damper, "rotation", None)
        key = damper.alike().model_copy(update={"name": "", "point": None}).model_dump_json()
        key += rotation.words() if rotation else ""
        groups.setdefault(key, _Group(damper, [], drawn)).numbers.append(number)
    return list(groups.values())


def _heading(case: Case, group: _Group, number: int) -> str:
    dampers = each_damper(case)
    names = [dampers[k].label(k) for k in group.numbers]
    text = joined(names) if len(names) < 4 else f"{len(names)} dampers, {names[0]} to {names[-1]}"
    return f"({number}) {shorten(text, _MAX_LETTERS // 2)}" if number else shorten(text, _MAX_LETTERS // 2)


def _loads(case: Case) -> str:
    """Return a title with the loads, one on each line."""
    words = [shorten(each.words(), _MAX_LETTERS) for each in (*case.loads, *case.base, *case.shaker_motion)]
    more = [f"and {len(words) - _MAX_LOADS} more"] if len(words) > _MAX_LOADS else []
    return "\n".join([*words[:_MAX_LOADS], *more]).replace("^2", "²")
