"""Remark about the best trials of a design whose parameters are at an end of the values tried."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.exceptions import CaseError
from rattlebox._util.phrases import joined
from rattlebox._util.quantities import amount
from rattlebox.model.paths import replaced

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox.model.case import Case
    from rattlebox.studies.design.search import DesignSearch

AT_END = "at_end"
"""Attribute with the parameters whose best value is at an end of the values tried."""

_NEAR = 0.05
"""Distance from an end of a range, over its width, at which a value counts as that end: a search seldom draws an end."""
_STEP = 1e-3
"""Relative size of the step beyond an end that must give a valid case."""
_ENDS = (("smallest", "smaller", min, -1), ("largest", "larger", max, 1))


def end_note(search: DesignSearch, found: xr.Dataset, best: Case) -> str:
    """Return which parameters of the front are at an end of the values tried; "" if none is that could go beyond it."""
    which = "best" if found.front.size == 1 else "Pareto-optimal"
    notes, advice = [], []
    for variable in search.variables:
        for path in variable.paths:
            tried = found[path].values
            if tried.dtype.kind not in "fi":  # names have no order
                continue
            low, high = ends = variable.bounds or (tried.min().item(), tried.max().item())
            if low == high:
                continue
            is_whole = tried.dtype.kind == "i"
            front, near = tried[found.front.values], 0.0 if is_whole or not variable.bounds else _NEAR
            places = np.log(front / low) / math.log(high / low) if variable.log else (front - low) / (high - low)
            for number, (extreme, more, pick, sign) in enumerate(_ENDS):
                end = ends[number]
                step = 1 if is_whole else _STEP * min(high - low, abs(end) or math.inf)
                if (np.abs(places - number) > near).any() or not _is_valid(search, best, path, end + sign * step):
                    continue
                value, name, unit = pick(front.tolist()), found[path].attrs["long_name"], found[path].attrs["units"]
                nearby = f"next to the {extreme} value of its range, {amount(end, unit)}"
                where = f"the {extreme} value tried" if value == end else nearby
                notes.append(f"the {which} {name}, {amount(value, unit)}, is {where}")
                advice.append(f"a {more} {name}")
    return f"{joined(notes)}; try: {joined(advice)}" if notes else ""


def _is_valid(search: DesignSearch, best: Case, path: str, value: float) -> bool:
    """Return whether a design may have a value, unlike a friction below 0, or one with which it exceeds its mass limit."""
    try:
        case = replaced(best, {path: value})
        search.grid_of(case)
    except CaseError:
        return False
    return not search.is_too_heavy(case)
