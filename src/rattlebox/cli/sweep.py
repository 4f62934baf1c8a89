"""`rattlebox sweep`: one study file."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer
from rich.text import Text

from rattlebox._util.exceptions import RattleboxError, ResourceError
from rattlebox._util.optional_imports import optional_import
from rattlebox._util.text import printable
from rattlebox.cli.show import statuses, warned
from rattlebox.cli.terminal import terminal
from rattlebox.model.plausibility import plausibility_notes
from rattlebox.studies.runner import Stopped
from rattlebox.studies.study_file import read_study


def run_sweep(path: Path, out: Path | None, workers: int | None, dask: str | None) -> None:
    """Run a study file into a store, or go on with one.

    Parameters
    ----------
    path
        Study file.
    out
        Folder of the store; default named after the study file.
    workers
        Threads of this process; default what the study file says, or one for each core.
    dask
        Address of a Dask scheduler, or the file that it wrote, to run there instead.
    """
    if dask and workers:
        raise typer.BadParameter("counts threads of this machine; with --dask, the cluster's workers run the study")
    study = read_study(path)
    out = out or path.with_suffix(".zarr")
    for told in plausibility_notes(study.case, signals=False):
        typer.echo(printable(f"{path}: {told}"), err=True)
    try:
        with _cluster(dask) as client, _naming(path, out):
            where = {"backend": client, "workers": None} if client else {"workers": workers} if workers else {}
            result = study.run(store=out, **where)
    except Stopped as stopped:
        typer.echo(str(stopped), err=True)
        sys.exit(130)
    console = terminal()
    counts = statuses(result)
    told = ", ".join(f"{count:,} {name}" for name, count in counts.items())
    told = f"{sum(counts.values()):,} variants: {told}\n" if counts else ""
    refused = f"refused, as with {result.attrs['refused']}\n" if "refused" in result.attrs else ""
    warnings = "".join(f"{line}\n" for line in warned(result))
    console.print(Text(f"{told}{refused}{warnings}written to {out}"), soft_wrap=True)


@contextmanager
def _naming(study: Path, out: Path) -> Iterator[None]:
    """Add to what is wrong with a study its file, unless it is about the folder of results."""
    try:
        yield
    except RattleboxError as error:
        if str(error).startswith((str(study), str(out))):
            raise
        raise type(error)(f"{study}: {error}") from None


@contextmanager
def _cluster(address: str | None) -> Iterator[Any]:
    if not address:
        yield None
        return
    distributed = optional_import("distributed", "cluster")
    where = {"scheduler_file": address} if Path(address).is_file() else {"address": address}
    try:
        client: Any = distributed.Client(**where, timeout=10)
    except (OSError, ValueError, TypeError) as error:
        raise ResourceError(
            f"no Dask scheduler answers at {address}: {error}\n  try: the address that 'dask scheduler' printed, "
            "as tcp://10.0.0.1:8786"
        ) from None
    with client:
        yield client
