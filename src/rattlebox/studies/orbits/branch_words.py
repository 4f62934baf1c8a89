"""Stretches and special points of a branch of periodic motions in words."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import amount, span

if TYPE_CHECKING:
    import xarray

_ON_CIRCLE = 1e-4
"""Difference of a multiplier from the unit circle below which it is critical."""
_MOST_STRETCHES = 6
"""Most stretches that a sentence describes."""
_MOST_POINTS = 8
"""Most special points that a sentence names."""
_UNBOUNDED = ("grazing", "impact lost")
"""Special points at which multipliers grow without bound."""
_NOUNS = {"torus": "Neimark-Sacker bifurcation", "impact lost": "loss of an impact"}
"""Words for special points in sentences, where they are not the kind itself."""


class Stretch(NamedTuple):
    """Neighbouring points of a branch with the same stability, symmetry and number of impacts.

    `low` and `high` are the ends in the parameter, `rows` the points, `limits` the kinds of the special points at both ends.
    """

    low: float
    high: float
    rows: NDArray[np.intp]
    stable: bool
    impacts: int  # in a period of the motion
    symmetric: bool
    sticks: bool
    limits: tuple[str, str]


def special_kinds(data: xarray.Dataset) -> NDArray[np.str_]:
    """Return the kind of each point of a branch, "" where it is not special."""
    return np.array([str(kind) for kind in data.special.values])  # files have other types of text


def size_of_motion(data: xarray.Dataset, place: str | None = None) -> xarray.DataArray:
    """Return the amplitude of a point of the structure, by default the first one.

    A structure whose motion is prescribed does not respond; the approach speed of the slowest impact stands for it.
    """
    responds = data.sizes["place"] and (data.amplitude.values > 0).any()
    if responds:
        data = data.isel(place=0) if place is None else data.sel(place=place)
    return data["amplitude" if responds else "slowest_impact"]


def stretches(data: xarray.Dataset) -> list[Stretch]:
    """Return the stretches of a branch in its order, from special point to special point where they change there."""
    special = special_kinds(data)
    value, located = data.value.values.astype(float), data.located.values.astype(float)
    labels = np.stack([data[name].values.astype(int) for name in ("stable", "impacts", "symmetric", "sticks")], axis=1)
    # At a special point a multiplier is on the unit circle, or an impact begins: its neighbours are what counts.
    ordinary = np.flatnonzero(special == "")
    if not ordinary.size:
        return []
    changes = np.flatnonzero((np.diff(labels[ordinary], axis=0) != 0).any(axis=1))
    starts, ends = np.concatenate([[0], changes + 1]), np.concatenate([changes, [ordinary.size - 1]])
    found = []
    for start, end in zip(ordinary[starts], ordinary[ends], strict=True):
        borders = [_border(special, value, located, int(start), -1), _border(special, value, located, int(end), 1)]
        inside = value[start : end + 1]
        edges = [*inside.tolist(), *(place for place, _ in borders)]
        stable, impacts, symmetric, sticks = (int(each) for each in labels[start])
        found.append(
            Stretch(
                min(edges),
                max(edges),
                np.arange(start, end + 1),
                bool(stable),
                impacts,
                bool(symmetric),
                bool(sticks),
                (borders[0][1], borders[1][1]),
            )
        )
    # A closed curve may begin anywhere: its first stretch continues the last one if nothing changes there.
    if data.attrs.get("closed") and len(found) > 1 and (labels[ordinary[0]] == labels[ordinary[-1]]).all():
        first, last = found[0], found.pop()
        found[0] = first._replace(
            low=min(first.low, last.low),
            high=max(first.high, last.high),
            rows=np.concatenate([last.rows, first.rows]),
            limits=(last.limits[0], first.limits[1]),
        )
    return found


def _border(
    special: NDArray[np.str_], value: NDArray[np.float64], located: NDArray[np.float64], row: int, side: int
) -> tuple[float, str]:
    """Return the value of the parameter at the end of a stretch, and the kind of the special point there, or ""."""
    beyond = row + side
    if not 0 <= beyond < value.size:
        return float(value[row]), ""
    if special[beyond]:
        return float(located[beyond]), str(special[beyond])
    return 0.5 * float(value[row] + value[beyond]), ""


def sentences(data: xarray.Dataset) -> Iterator[str]:
    """Yield the result of a continuation in sentences: where motions are stable, and where the branch ends."""
    rows, unit, cycles = stretches(data), str(data.attrs["unit"]), int(data.attrs["cycles"])
    value = data.value.values
    closed = ", a closed curve" if data.attrs.get("closed") else ""
    yield (
        f"Periodic motions of {counted(cycles, 'cycle')} over {data.attrs['parameter']} from "
        f"{range_words(float(value.min()), float(value.max()), unit)}: {counted(value.size, 'point')}{closed}."
    )
    for stable in (True, False):
        alike = sorted((each for each in rows if each.stable == stable), key=lambda each: each.low)
        if not alike:
            yield f"No motion of the branch is {'stable' if stable else 'unstable'}."
            continue
        by_impacts: dict[str, list[str]] = {}
        for each in alike[:_MOST_STRETCHES]:
            where = f"from {range_words(each.low, each.high, unit)}"
            by_impacts.setdefault(impacts_words(each.impacts, cycles), []).append(where)
        texts = [f"{joined(list(dict.fromkeys(spans)))} with {words}" for words, spans in by_impacts.items()]
        if len(alike) > _MOST_STRETCHES:
            texts.append(f"in {counted(len(alike) - _MOST_STRETCHES, 'further range')}")
        yield f"{'Stable' if stable else 'Unstable'} {'; '.join(texts)}."
    points = np.flatnonzero(special_kinds(data) != "")
    if points.size:
        kinds = [str(data.special[k].item()) for k in points]
        places = [amount(float(data.located[k]), unit) for k in points]
        ways = [f" ({passage})" if (passage := str(data.passage[k].item())) else "" for k in points]
        named = [f"{noun(kind)} at {place}{way}" for kind, place, way in zip(kinds, places, ways, strict=True)]
        named = named[:_MOST_POINTS]
        rest = [counted(points.size - _MOST_POINTS, "further one")] if points.size > _MOST_POINTS else []
        yield f"Special points: {joined(named + rest)}."
    if ended := str(data.attrs.get("ended", "")):
        yield f"The branch ends before the limits: {ended}."


def stopped_words(count: int, most: int) -> str:
    """Return the reason why a branch or curve with some number of points ends at no limit of a parameter."""
    return f"the limit of points = {most} is reached" if count >= most else "the continuation was stopped"


def noun(kind: str) -> str:
    """Return the noun for a kind of special point."""
    return _NOUNS.get(kind, kind)


def range_words(low: float, high: float, unit: str) -> str:
    """Return a range in one unit, with as many digits as show that its ends differ."""
    texts = [span(low, high, unit, digits) for digits in (4, 6, 9)]
    return next((text for text in texts if not _is_flat(text)), texts[0])


def _is_flat(text: str) -> bool:
    """Return whether both ends of a range are written alike."""
    low, _, high = text.partition(" to ")
    return low == high.partition(" ")[0]


def impacts_words(impacts: int, cycles: int) -> str:
    """Return the number of impacts of a motion in words: "2 impacts a cycle", "5 impacts in 2 cycles"."""
    return (
        f"{counted(impacts, 'impact')} {'a cycle' if cycles == 1 else f'in {cycles} cycles'}"
        if impacts
        else "no impact"
    )


def critical_multiplier(data: xarray.Dataset, row: int) -> str:
    """Return the multiplier that makes a point special: "+1", "-1", "pair at 63.2 deg", or its size if it is unbounded."""
    values = data.multiplier_real.values[row] + 1j * data.multiplier_imaginary.values[row]
    kind = str(data.special[row].item())
    if kind in _UNBOUNDED:
        return "unbounded"
    if kind == "sticking":
        return f"{amount(float(np.abs(values).max()), '', 3)}, the largest"
    nearest = values[np.argmin(np.abs(np.abs(values) - 1))]
    if abs(nearest.imag) > _ON_CIRCLE:
        return f"pair at {amount(math.degrees(abs(float(np.angle(nearest)))), '', 4)} deg"
    return f"{float(nearest.real):+.4g}"
