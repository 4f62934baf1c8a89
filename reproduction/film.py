"""Animation of structures with a ball in a cavity, as one SVG element that needs no other file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .page import templates

SLOWER = 10  # Times that the animation is slower than the motion
_SCALE, _RADIUS = (
    18e3,
    22.0,
)  # Pixels per metre of motion, and of the ball [px]: the motion is magnified against the ball
_HEIGHT, _CENTRE, _HALF, _SUPPORT = 96, 300, 90, 20  # Of a row, of the structure, its half width, and the support [px]


class Row(NamedTuple):
    """One run of the animation."""

    name: str
    structure: NDArray[np.float64]  # Displacement at evenly spaced times [m]
    ball: NDArray[np.float64]  # Position of the ball in its cavity [m]
    energy: NDArray[np.float64]  # Share of the work that is left
    gap: float  # Clearance on each side of the centred ball [m]; 0 for no ball


def film(rows: Sequence[Row], span: float) -> str:
    """Return the animation."""
    sizes = {
        "height": _HEIGHT,
        "centre": _CENTRE,
        "support": _SUPPORT,
        "radius": _RADIUS,
        "seconds": f"{SLOWER * span:g}",
    }
    return templates().get_template("film.svg").render(rows=[_shape(row) for row in rows], **sizes).strip()


def _shape(row: Row) -> dict[str, Any]:
    """Return sizes and positions of a row in pixels, positions over time as text."""
    inner = _RADIUS + _SCALE * row.gap
    outer = max(_HALF, inner + 16)
    length = _CENTRE - outer - _SUPPORT
    return {
        "name": row.name,
        "inner": inner,
        "outer": outer,
        "turn": f"{length / 12:.2f}",
        "structure": ";".join(f"{x:.1f}" for x in _SCALE * row.structure),
        "stretch": ";".join(f"{x:.3f} 1" for x in 1 + _SCALE * row.structure / length),
        "ball": ";".join(f"{x:.1f}" for x in _SCALE * row.ball) if row.gap else "",
        "energy": ";".join(f"{180 * x:.1f}" for x in np.clip(row.energy / row.energy.max(), 0, 1)),
    }
