"""Optuna studies in the store of a design search."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import StoreError
from rattlebox._util.owned_folder import read_marker
from rattlebox.studies.design.space import DesignVariable
from rattlebox.studies.run.store import JOURNAL, exclusive_writer

if TYPE_CHECKING:
    import xarray as xr

_NAME = "rattlebox"
"""Name of the study in its journal."""
LAYOUT = "layout"
"""Attribute with the variables and objectives of a design, in the study of its trials."""


@contextmanager
def quiet(optuna: Any) -> Iterator[None]:
    """Suppress messages of Optuna below errors."""
    before = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    try:
        yield
    finally:
        optuna.logging.set_verbosity(before)


class _NoLock:
    """No lock: the store has one already, and a lock of Optuna remains after its process is killed."""

    def acquire(self) -> bool:
        """Return True."""
        return True

    def release(self) -> None:
        """Do nothing."""


@contextmanager
def trial_storage(optuna: Any, store: str | os.PathLike[str] | None) -> Iterator[Any]:
    """Open the journal of a store, to which each trial appends lines."""
    if store is None:
        yield None
        return
    with exclusive_writer(Path(store)) as progress:
        if (marker := read_marker(Path(store))) and marker.complete:
            raise StoreError(f"{store} holds another study", "another folder, or remove this one")
        path = progress / JOURNAL
        if path.exists():
            with path.open("r+b") as file:  # remove an incomplete last line
                file.truncate(file.read().rfind(b"\n") + 1)
        journal = optuna.storages.journal
        yield optuna.storages.JournalStorage(journal.JournalFileBackend(str(path), lock_obj=_NoLock()))


def count_trials(path: str | os.PathLike[str]) -> int | None:
    """Return the number of finished trials in the store of a design; None if it holds no design."""
    journal = Path(path) / "progress" / JOURNAL
    if not journal.exists():
        return None
    return len(re.findall(r'^{"op_code":6,.*"state":[12],', journal.read_text(), re.MULTILINE))  # complete or pruned


def open_trials(path: str | os.PathLike[str]) -> xr.Dataset | None:
    """Return the finished trials of a design that is not finished; None without Optuna."""
    import xarray as xr

    try:
        optuna: Any = import_module("optuna")
    except ImportError:
        return None
    journal = Path(path) / "progress" / JOURNAL
    with quiet(optuna):
        backend = optuna.storages.journal.JournalFileBackend(str(journal), lock_obj=_NoLock())
        study = optuna.load_study(study_name=_NAME, storage=optuna.storages.JournalStorage(backend))
    trials = finished_trials(optuna, study)
    layout = study.user_attrs.get(LAYOUT)
    if layout is None or not trials:
        return None
    found = xr.Dataset(coords={"trial": np.arange(len(trials))})
    for about in layout["variables"]:
        variable = DesignVariable.from_json(about)
        own = variable.coordinates([trial.params[variable.name] for trial in trials])
        found = found.assign_coords({name: ("trial", *column) for name, column in own.items()})
    for number, (name, attrs) in enumerate(layout["objectives"].items()):
        found[name] = ("trial", [math.nan if trial.values is None else trial.values[number] for trial in trials], attrs)
    reasons = np.array([trial.user_attrs["reason"] for trial in trials], dtype=object)
    return found.assign(reason=("trial", reasons))


def load_study(optuna: Any, storage: Any, directions: Sequence[str], description: Mapping[str, Any], store: Any) -> Any:
    """Return an Optuna study with the earlier trials of its storage."""
    about = json.loads(json.dumps(description))
    study = optuna.create_study(
        storage=storage,
        study_name=_NAME,
        load_if_exists=True,
        directions=list(directions),
    )
    stored = study.user_attrs.get("about")
    if stored is None:
        study.set_user_attr("about", about)
    elif stored != about:
        names = ", ".join(name for name in {**stored, **about} if stored.get(name) != about.get(name))
        raise StoreError(f"{store} holds the trials of another study, which differs in {names}", "another folder")
    # A trial that a stopped process was running is lost.
    for trial in study.get_trials(deepcopy=False, states=(optuna.trial.TrialState.RUNNING,)):
        study.tell(trial.number, state=optuna.trial.TrialState.FAIL)
    return study


def finished_trials(optuna: Any, study: Any) -> list[Any]:
    """Return the trials that are complete or pruned."""
    states = optuna.trial.TrialState
    trials: list[Any] = study.get_trials(deepcopy=False, states=(states.COMPLETE, states.PRUNED))
    return trials


def trial_seed(seed: int, number: int) -> int:
    """Return the random seed of a trial; it does not depend on where the search was stopped."""
    return int(np.random.SeedSequence([seed, number]).generate_state(1)[0])
