"""Drawing of the stops of a case: a symbol for each, with its gap and contact law."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.patches import Wedge

from rattlebox._util.quantities import amount

from ..model.stops import Stop
from .style import FAINT, INK, pen, shorten
from .technical import SOLID, body, dimension, ground, text

_MAX_STOPS = 4
"""Most stops in a drawing; further ones are counted below it."""


def draw_stops(axes: Axes, stops: Sequence[Stop], points: Sequence[str]) -> None:
    """Draw stops below each other; `points` are the names of their points."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    shown = stops[:_MAX_STOPS]
    for row, (stop, point) in enumerate(zip(shown, points, strict=False)):
        _draw_stop(axes, stop, point, -1.9 * row)
    more = f"and {len(stops) - len(shown)} more; " if len(stops) > len(shown) else ""
    text(axes, (0.0, -1.9 * len(shown) + 0.7), f"{more}symbols, not to scale", color=FAINT, fontsize="small")
    axes.set_xlim(-2.6, 2.6)
    axes.set_ylim(-1.9 * len(shown) + 0.4, 1.1)


def _draw_stop(axes: Axes, stop: Stop, point: str, y: float) -> None:
    """Draw a point as a block, and the noses of its stops on the ground or on the other point."""
    body(axes, (-0.5, y - 0.3), 1.0, 0.6)
    text(axes, (0.0, y), shorten(point, 10), fontsize="small")
    for sign in (1, -1) if stop.side == "both" else (int(stop.sign),):
        nose, back = sign * 0.95, sign * 1.25
        angles = (90, 270) if sign > 0 else (-90, 90)
        axes.add_patch(Wedge((back, y), 0.3, *angles, facecolor=SOLID, edgecolor=INK, lw=pen(0.8), zorder=2))
        if stop.other is None:
            ends = ((back, y + 0.45), (back, y - 0.45)) if sign > 0 else ((back, y - 0.45), (back, y + 0.45))
            ground(axes, *ends, 0.18)
        else:
            body(axes, (back if sign > 0 else back - 1.0, y - 0.3), 1.0, 0.6)
            text(axes, (back + sign * 0.5, y), shorten(stop.other, 10), fontsize="small")
        dimension(axes, (min(sign * 0.5, nose), y + 0.3), (max(sign * 0.5, nose), y + 0.3), amount(stop.gap, "m"), 0.25)
    words = f"{shorten(stop.name, 20)}: {stop.contact.kind.replace('_', ' ')} contact"
    text(axes, (0.0, y - 0.62), words, fontsize="small")
