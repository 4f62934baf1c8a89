"""`rattlebox report`: a page about runs and studies on disk."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox.cli.folder import CHECKPOINT, RUN, SNAPSHOTS, is_run
from rattlebox.cli.terminal import terminal
from rattlebox.engines.checkpoint import read_unfinished
from rattlebox.report.kinds.unfinished import UnfinishedRun
from rattlebox.report.write import write_report
from rattlebox.results import Run, load
from rattlebox.results.snapshots import Snapshots
from rattlebox.studies.design.trials import count_trials
from rattlebox.studies.run.stored import has_map, open_study, started_with

if TYPE_CHECKING:
    import xarray as xr


def write(results: Sequence[Path], out: Path | None, title: str | None, question: str | None) -> None:
    """Write a report about results on disk, and print its name."""
    path = out or Path(f"{results[0].resolve().with_suffix('').name}.html")
    replaces = path.exists()
    by_name: dict[str, object] = {}
    for folder in results:
        name = str(folder)
        if name in by_name:
            raise CaseError(f"{name} is given twice", "each folder once")
        by_name[name] = read_result(folder)
    result = by_name if len(by_name) > 1 else next(iter(by_name.values()))
    write_report(result, path, title=title, question=question)
    note = " (replaced an earlier report; choose another name with -o)" if replaces and out is None else ""
    terminal().print(f"written: {path}{note}", soft_wrap=True)


def read_result(path: Path) -> Run | UnfinishedRun | xr.Dataset:
    """Return a run, an unfinished run, or the dataset of a study."""
    if not is_run(path):
        trials = count_trials(path)
        if trials is not None and not has_map(path):
            raise DataError(
                f"{path} is a design that is not finished: {trials} trials, whose result is written at the end",
                f"repeat the command that started it{started_with(path)}, which resumes it; then the report",
            )
        return open_study(path).load()
    if path.is_file():
        if path.suffix != ".nc":
            raise DataError(f"{path} is not a run", f"{RUN}, or its folder")
        return load(path)
    if (path / RUN).is_file():
        return load(path / RUN)
    if (path / CHECKPOINT).is_file():
        snapshots = Snapshots(path / SNAPSHOTS) if (path / SNAPSHOTS).is_file() else None
        return UnfinishedRun(*read_unfinished(path / CHECKPOINT)[:3], snapshots)
    raise DataError(f"{path} has no {RUN}", "the folder that 'rattlebox run -o' wrote")
