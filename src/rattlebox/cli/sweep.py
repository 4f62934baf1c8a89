"""`rattlebox sweep`: run one study file."""

from __future__ import annotations

import dataclasses
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer
from rich.text import Text

from rattlebox._util.exceptions import RattleboxError, ResourceError
from rattlebox._util.optional_imports import optional_import
from rattlebox._util.text import printable
from rattlebox.cli.exit_codes import STOPPED
from rattlebox.cli.terminal import terminal
from rattlebox.model.plausibility import plausibility_notes
from rattlebox.studies.run.runner import Stopped
from rattlebox.studies.run.stored import status_lines
from rattlebox.studies.study_file import read_study


def run_sweep(path: Path, out: Path | None, workers: int | None, dask: str | None, *, estimate: bool = False) -> None:
    """Run a study file and store its results, or resume a stored study; or print its predicted time."""
    if dask and workers:
        raise typer.BadParameter("--workers counts threads of this machine; --dask runs on the workers of the cluster")
    study = read_study(path)
    out = out or path.with_suffix(".zarr")
    for note in plausibility_notes(study.case, signals=False):
        typer.echo(printable(f"{path}: {note}"), err=True)
    try:
        with _cluster(dask) as client, _error_context(path, out), warnings.catch_warnings():
            warnings.filterwarnings("ignore", "no trial is feasible|at .*, which decides")  # lines of the output below
            backend = {"backend": client, "workers": None} if client else {"workers": workers} if workers else {}
            if estimate:
                typer.echo(printable(f"{path}: {dataclasses.replace(study, **backend).estimate()}"))
                return
            result = study.run(store=out, **backend)
    except Stopped as stopped:
        typer.echo(str(stopped), err=True)
        sys.exit(STOPPED)
    terminal().print(Text("\n".join([*status_lines(result), f"written to {out}"])), soft_wrap=True)


@contextmanager
def _error_context(study: Path, out: Path) -> Iterator[None]:
    """Prefix errors with the study file, except those that name it or the results folder already."""
    try:
        yield
    except RattleboxError as error:
        if str(error).startswith((str(study), str(out))):
            raise
        raise error.restated(source=str(study)) from None


@contextmanager
def _cluster(address: str | None) -> Iterator[Any]:
    if not address:
        yield None
        return
    distributed = optional_import("distributed", "cluster")
    target = {"scheduler_file": address} if Path(address).is_file() else {"address": address}
    try:
        client: Any = distributed.Client(**target, timeout=10)
    except (OSError, ValueError, TypeError) as error:
        raise ResourceError(
            f"no Dask scheduler responds at {address}: {error}",
            "the address that 'dask scheduler' printed, such as tcp://10.0.0.1:8786",
        ) from None
    with client:
        yield client
