"""Kinds of reports: which result has which content."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from rattlebox._util.exceptions import CaseError
from rattlebox._util.plugins import Registry, load_plugins
from rattlebox.report.kinds.unfinished import UnfinishedRun
from rattlebox.report.parts import Kind
from rattlebox.results.run import Run
from rattlebox.results.summary import Comparison

KINDS: Mapping[str, tuple[str, str]] = {
    "run": ("run", "KIND"),
    "unfinished": ("unfinished", "KIND"),
    "comparison": ("comparison", "KIND"),
    "sweep": ("sweep", "KIND"),
    "bifurcation": ("steady_motions", "BIFURCATION"),
    "basins": ("steady_motions", "BASINS"),
    "lyapunov": ("steady_motions", "LYAPUNOV"),
    "frequency_response": ("frequency_response", "KIND"),
    "loss_map": ("loss_map", "KIND"),
    "damping_curve": ("damping_curve", "KIND"),
    "design": ("design", "KIND"),
    "sensitivity": ("sensitivity", "KIND"),
    "response_from_map": ("map_response", "KIND"),
    "stability_lobes": ("stability_lobes", "KIND"),
    "calibrate": ("calibration", "KIND"),
}
"""Module in this folder, and its `Kind`, by the attribute `study` of a dataset; or "run" and "comparison"."""

_REGISTERED: Registry[Kind[Any]] = Registry("report about the study")


def add_report(study: str, kind: Kind[Any], owner: str) -> None:
    """Add the content of the report about a kind of study of another package; `owner` is its module, `__name__`."""
    _REGISTERED.add(study, kind, owner)


def kind_of(result: object) -> Kind[Any]:
    """Return the kind of a result; datasets without one of their own are reported as sweeps."""
    load_plugins()
    found = _name(result)
    if found in _REGISTERED:
        return _REGISTERED[found]
    module, name = KINDS[found]
    kind: Kind[Any] = getattr(import_module(f"{__name__}.{module}"), name)
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
        return name if name in KINDS or name in _REGISTERED else "sweep"
    if isinstance(result, Mapping) and result and all(_name(each) == "damping_curve" for each in result.values()):
        return "damping_curve"
    raise CaseError(
        f"there is no report about {result!r:.60}",
        "a run, rb.compare(...), the dataset of a study, or a mapping of these by name",
    )
