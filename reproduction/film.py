"""Animation of structures with a ball in a cavity, as one SVG element that needs no other file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

SLOWER = 10  # Times that the animation is slower than the motion
_SCALE, _BALL = 18.0, 22.0
"""Pixels per millimetre of motion, and radius of the ball [px]: the motion is magnified against the ball."""
_ROW, _CENTRE, _HALF, _SUPPORT = 96, 300, 90, 20
"""Height of a row, centre of the structure, half of its width, and place of the support [px]."""


class Row(NamedTuple):
    """One run of the animation."""

    name: str
    structure: NDArray[np.float64]  # Displacement at evenly spaced times [m]
    ball: NDArray[np.float64]  # Position of the ball in its cavity [m]
    energy: NDArray[np.float64]  # Share of the work that is left
    gap: float  # Clearance on each side of the centred ball [m]; 0 for no ball


def film(rows: Sequence[Row], span: float) -> str:
    """Return the animation."""
    names = escape("; ".join(row.name for row in rows))
    parts = "".join(_row(row, k * _ROW, SLOWER * span) for k, row in enumerate(rows))
    size = f"0 0 760 {_ROW * len(rows) + 10}"
    return f'<svg id="film" viewBox="{size}" role="img" aria-label="Animation: {names}">{parts}</svg>'


def _row(row: Row, top: float, seconds: float) -> str:
    """Draw support, spring, structure with its cavity, ball, and the bar of the energy that is left."""
    middle = top + 58
    inner = _BALL + 1e3 * _SCALE * row.gap
    outer = max(_HALF, inner + 16)
    place = 1e3 * _SCALE * row.structure
    parts = _box(_CENTRE - outer, middle - 32, 2 * outer, 64, "structure")
    if row.gap:
        ball = f'<circle cx="{_CENTRE}" cy="{middle}" r="{_BALL}" class="ball"/>'
        parts += _box(_CENTRE - inner, middle - _BALL - 3, 2 * inner, 2 * _BALL + 6, "cavity")
        parts += f"<g>{ball}{_moving('translate', 1e3 * _SCALE * row.ball, seconds)}</g>"
    # The spring is drawn at its length at rest and stretched from the support.
    length = _CENTRE - outer - _SUPPORT
    turns = "".join(f"l{length / 12:.2f} {14 if k % 2 else -14}" for k in range(10))
    spring = f"M0 0h{length / 12:.2f}v7{turns}v-7h{length / 12:.2f}"
    stretch = _moving("scale", 1 + place / length, seconds, digits=3, then=" 1")
    bar = f'<rect x="560" y="{middle - 6}" width="180" height="14" class="energy">'
    width = (f"{180 * value:.1f}" for value in np.clip(row.energy / row.energy.max(), 0, 1))
    return (
        f'<text x="{_SUPPORT}" y="{top + 18}">{escape(row.name)}</text>'
        f'<path d="M{_SUPPORT} {middle - 34}v68M{_CENTRE} {middle - 40}v80" class="mark"/>'
        f'<g transform="translate({_SUPPORT} {middle})"><g>'
        f'<path d="{spring}" class="mark" vector-effect="non-scaling-stroke"/>'
        f"{stretch}</g></g><g>{parts}{_moving('translate', place, seconds)}</g>"
        f'<text x="560" y="{middle - 14}">energy left</text>{_box(560, middle - 6, 180, 14, "empty")}'
        f"{bar}{_animate('animate', 'width', width, seconds)}</rect>"
    )


def _box(x: float, y: float, width: float, height: float, kind: str) -> str:
    return f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" class="{kind}"/>'


def _moving(kind: str, values: NDArray[np.float64], seconds: float, digits: int = 1, then: str = "") -> str:
    texts = (f"{value:.{digits}f}{then}" for value in values)
    return _animate(f'animateTransform type="{kind}"', "transform", texts, seconds)


def _animate(tag: str, attribute: str, values: Iterable[str], seconds: float) -> str:
    return (
        f'<{tag} attributeName="{attribute}" dur="{seconds:g}s" repeatCount="indefinite" values="{";".join(values)}"/>'
    )
