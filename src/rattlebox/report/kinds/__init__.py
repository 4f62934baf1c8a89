"""Kinds of reports: which result has which content."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rattlebox._util.exceptions import CaseError
from rattlebox._util.plugins import named_object
from rattlebox.report.kinds.unfinished import UnfinishedRun
from rattlebox.report.parts import Kind
from rattlebox.results.run import Run
from rattlebox.results.summary import Comparison
from rattlebox.studies.kinds import study_kind, study_kinds

_OTHERS = {
    "run": "run:KIND",
    "unfinished": "unfinished:KIND",
    "comparison": "comparison:KIND",
    "damping_curve": "damping_curve:KIND",
    "response_from_map": "map_response:KIND",
    "calibrate": "calibration:KIND",
}
"""Module in this folder, and its `Kind`, of results that are not those of a kind of study; of datasets by `study`."""


def kind_of(result: object) -> Kind[Any]:
    """Return the kind of a result; datasets of unknown studies are reported as sweeps."""
    name = _name(result)
    reference = f"{__name__}.{_OTHERS[name]}" if name in _OTHERS else study_kind(name).report
    kind: Kind[Any] = named_object(reference, f"the report about {name!r}")
    return kind


def _name(result: object) -> str:
    if isinstance(result, Run):
        return "run"
    if isinstance(result, Comparison):
        return "comparison"
    if isinstance(result, UnfinishedRun):
        return "unfinished"
    import xarray as xr

    if isinstance(result, xr.Dataset):
        name = str(result.attrs.get("study", "sweep"))
        return name if name in _OTHERS or name in study_kinds() else "sweep"
    if isinstance(result, Mapping) and result and all(_name(each) == "damping_curve" for each in result.values()):
        return "damping_curve"
    raise CaseError(
        f"there is no report about {result!r:.60}",
        "a run, rb.compare(...), the dataset of a study, or a mapping of these by name",
    )
