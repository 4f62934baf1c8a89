"""Result of the study of stability lobes in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.phrases import joined
from rattlebox._util.quantities import amount, with_interval

if TYPE_CHECKING:
    import xarray


_FALL = 0.98
"""Limit at a larger amplitude over the largest one, below which the limit counts as falling."""


def answer(result: xarray.Dataset) -> Iterator[str]:
    """Yield sentences about the result of the study."""
    frequency = amount(float(result.bare_limit_frequency), "Hz")
    if np.isfinite(result.bare_limit):
        yield (
            "The structure alone is stable at all spindle speeds up to a depth of cut of "
            f"{amount(float(result.bare_limit), 'm')}; deeper cuts chatter at {frequency}."
        )
    else:
        yield "The structure alone does not chatter: its real part is not negative anywhere."
    linear = bool((result.amplitude == 0).all())
    limit = result.limit.values
    if linear:
        if system := str(result.attrs.get("system", "")):
            ratio = float(limit[0] / result.bare_limit)
            yield (
                f"With {system} it is stable up to {amount(float(limit[0]), 'm')}, {ratio:.3g} times as deep, and chatters "
                f"at {amount(float(result.limit_frequency[0]), 'Hz')}."
            )
        best = 0
    else:
        if not np.isfinite(limit).any():
            yield "With the dampers the limit is unknown: the map does not cover the chatter of this tool."
            return
        best = int(np.nanargmax(limit))
        yield from _contained(result, best)
    if "depth" in result and np.isfinite(depth := result.depth.values[best]).any():
        k = int(np.nanargmax(np.where(np.isfinite(depth), depth, -np.inf)))
        where = "" if linear else f", with vibrations of {amount(float(result.amplitude[best]), 'm', 3)}"
        speed = amount(float(result.speed[k]), "rpm")
        if result.speed.size > 1 and k in (0, result.speed.size - 1):
            speed += f", the {'highest' if k else 'lowest'} of them"
        yield f"The deepest stable cut at the given speeds is {amount(float(depth[k]), 'm')}, at {speed}{where}."


def depth_with_interval(one: xarray.Dataset) -> str:
    """Return the stable depth at an amplitude, with its 95 % interval where that is above a thousandth of it."""
    depth, half = float(one.limit), float(one.limit_interval)
    return with_interval(depth, half, "m") if half > 1e-3 * depth else amount(depth, "m", 3)


def _contained(result: xarray.Dataset, best: int) -> Iterator[str]:
    """Yield sentences about the amplitudes at which chatter is contained."""
    limit, sizes = result.limit.values, result.amplitude.values
    known = np.flatnonzero(np.isfinite(limit))

    def at(k: int) -> str:
        return f"at {amount(float(sizes[k]), 'm', 3)} up to {depth_with_interval(result.isel(amplitude=k))}"

    others = [int(k) for k in (known[0], known[-1]) if k != best]
    more = f"; {joined([at(k) for k in others])}" if others else ""
    yield f"With the dampers chatter is contained {at(best)} depth of cut at all spindle speeds{more}."
    last = int(known[-1])
    if limit[last] < _FALL * limit[best]:
        yield (
            f"The limit falls above {amount(float(sizes[best]), 'm', 3)}: between {amount(float(limit[last]), 'm', 3)} and "
            f"{amount(float(limit[best]), 'm', 3)} a disturbance beyond the amplitude with that limit grows."
        )
