"""The report: every figure of the paper computed, drawn and judged, on one page."""

from __future__ import annotations

import base64
import errno
import os
import re
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING

from .figure import Reproduction
from .page import GENERATOR, Column, Made, Table, render
from .runs import record_cases, write_runs
from .tables import write_tables

if TYPE_CHECKING:
    import xarray as xr

FIGURES = (
    "figure_02",
    "figure_04",
    "figure_05",
    "figure_06",
    "figure_07a",
    "figure_07b",
    "figure_07c",
    "figure_07de",
    "figure_09a",
    "figure_09b",
    "figure_10",
    "figure_11",
    "interpretations",
    "hundred_times",
    "contacts_per_cycle",
    "bifurcation",
    "chattering",
    "lyapunov",
)
"""Modules of the figures, in the order of the page."""

_FIGURE_FOLDER, _CASE_FOLDER = "figures", "cases"

Progress = Callable[[int, int, str], None]
"""Told how many figures are done, of how many, and what was done last."""


def write_report(
    folder: str | os.PathLike[str],
    only: Sequence[str] = (),
    *,
    workers: int = 1,
    progress: Progress | None = None,
) -> Path:
    """Compute the paper and write it as a page, with each figure as SVG, PNG and CSV and its runs as case and study files.

    Parameters
    ----------
    folder
        Where to write: a new or empty folder, or that of an earlier report, which is replaced.
    only
        Numbers of the figures wanted, such as "4", "7c" or "A1"; "7" are all its parts, and "paper" is everything but the
        extensions A1 to A5, which take two thirds of the time. Default all.
    workers
        Processes that compute figures. In a script more than one needs the usual `if __name__ == "__main__":`.
    progress
        Called after each figure.

    Returns
    -------
    Path
        The page, index.html.

    Raises
    ------
    ValueError
        When there is no such figure.
    OSError
        When the folder holds other files, or cannot be written.
    """
    began = time.perf_counter()
    modules = choose(only)
    folder = _prepared(Path(folder))
    made: dict[str, Made] = {}
    for module, figure in _all_made(modules, folder, workers):
        made[module] = figure
        if progress is not None:
            progress(len(made), len(modules), f"figure {figure.number}")
    figures = [made[module] for module in modules]
    page = folder / "index.html"
    missing = [load_figure(module).number for module in FIGURES if module not in modules]
    text = render(figures, missing=missing, cores=cores(), workers=workers, seconds=time.perf_counter() - began)
    _write(page, text)
    return page


def cores() -> int:
    """Return the number of processor cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1


def choose(only: Sequence[str]) -> tuple[str, ...]:
    """Return the modules of the figures with these numbers, in the order of the page; all when none is given.

    Raises
    ------
    ValueError
        When there is no such figure.
    """
    numbers = {module: load_figure(module).number for module in FIGURES}
    wanted: set[str] = set()
    for text in only:
        found = {module for module, number in numbers.items() if _covers(number, text.strip())}
        if not found:
            raise ValueError(f"there is no figure {text!r}; there are {', '.join(numbers.values())}, and 'paper'")
        wanted |= found
    return tuple(module for module in FIGURES if module in wanted or not only)


def load_figure(module: str) -> Reproduction:
    """Return the figure that a module of this package holds."""
    figure = import_module(f"{__package__}.{module}").FIGURE
    assert isinstance(figure, Reproduction)
    return figure


def _covers(number: str, wanted: str) -> bool:
    """Return whether a figure, such as "7d, e" or "10", shows what is wanted, such as "7", "7e", "10a" or "paper"."""
    if wanted == "paper":
        return not number.startswith("A")
    whole, parts = _parts(number)
    wanted_whole, wanted_parts = _parts(wanted)
    return whole == wanted_whole and (not parts or wanted_parts <= parts)


def _parts(number: str) -> tuple[str, set[str]]:
    whole = re.match(r"[A-Za-z]?\d+", number)
    if whole is None:
        return number, set()
    return whole[0].upper(), set(re.findall(r"[a-z]", number[whole.end() :].lower()))


def _prepared(folder: Path) -> Path:
    """Make the folder, empty it of an earlier report, and mark it as ours until the page is written."""
    page = folder / "index.html"
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "is a file; a report needs a folder", str(folder))
    if folder.is_dir() and any(folder.iterdir()):
        earlier = page.read_text(encoding="utf-8", errors="replace") if page.is_file() else ""
        if GENERATOR not in earlier:
            raise FileExistsError(
                errno.EEXIST, "holds other files; choose a new folder, or that of an earlier report", str(folder)
            )
        # Only files that the earlier page links to are removed; others belong to the user.
        for name in re.findall(rf'href="((?:{_FIGURE_FOLDER}|{_CASE_FOLDER})/figure_[\w.]+)"', earlier):
            (folder / name).unlink(missing_ok=True)
    for name in (_FIGURE_FOLDER, _CASE_FOLDER):
        (folder / name).mkdir(parents=True, exist_ok=True)
    _write(page, f"<!doctype html>{GENERATOR}<title>Report</title><p>This report is not finished.")
    return folder


def _write(page: Path, text: str) -> None:
    """Write a page that is complete or as it was before."""
    temporary = page.with_name(f".{page.name}.partial")
    try:
        temporary.write_text(text, encoding="utf-8")
        temporary.replace(page)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _all_made(modules: Sequence[str], folder: Path, workers: int) -> Iterator[tuple[str, Made]]:
    """Make the figures, in the order in which they are done."""
    if workers <= 1 or len(modules) <= 1:
        yield from ((module, _made(module, folder)) for module in modules)
        return
    # Processes, since matplotlib draws one figure at a time; spawned, since forking a process with threads is unsafe.
    # Ctrl-C ends them at once and without a word.
    on_ctrl_c = (signal.SIGINT, signal.SIG_DFL)
    with ProcessPoolExecutor(min(workers, len(modules)), get_context("spawn"), signal.signal, on_ctrl_c) as pool:
        running = {pool.submit(_made, module, folder): module for module in reversed(modules)}  # the last take longest
        try:
            for done in as_completed(running):
                yield running[done], done.result()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _made(module: str, folder: Path) -> Made:
    """Compute, draw and write one figure."""
    figure = load_figure(module)
    try:
        began = time.perf_counter()
        with record_cases() as runs:
            data = figure.data()
        computed = time.perf_counter()
        png, svg = _drawn(figure, data, folder / _FIGURE_FOLDER)
        drawn = time.perf_counter()
        tables = write_tables(data, folder / _FIGURE_FOLDER, figure.name)
        return Made(
            number=figure.number,
            title=figure.title,
            name=figure.name,
            caption=figure.caption(data),
            claims=tuple(figure.claims(data)),
            picture="data:image/svg+xml;base64," + base64.b64encode(svg.read_bytes()).decode(),
            svg=svg.relative_to(folder).as_posix(),
            png=png.relative_to(folder).as_posix(),
            tables=tuple(_described(path.relative_to(folder), table) for path, table in tables.items()),
            cases=write_runs(figure.cases(), runs, folder, _CASE_FOLDER, figure.name),
            computing=computed - began,
            drawing=drawn - computed,
        )
    except Exception as error:
        error.add_note(f"in figure {figure.number} of the report")
        raise


def _drawn(figure: Reproduction, data: xr.Dataset, folder: Path) -> tuple[Path, Path]:
    """Draw a figure as PNG and SVG."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from rattlebox.plots import figure_style

    drawing = figure.draw(data)
    png, svg = folder / f"{figure.name}.png", folder / f"{figure.name}.svg"
    drawing.savefig(png)
    # Outlined letters look the same on every machine; ids are the same in every run.
    with figure_style("page"), mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": figure.name}):
        Figure.savefig(drawing, svg, metadata={"Date": None})
    return png, svg


def _described(path: Path, table: xr.Dataset) -> Table:
    """Say what stands in a CSV file."""
    return Table(
        path=path.as_posix(),
        rows=max(variable.size for variable in table.variables.values()),
        columns=tuple(
            Column(str(name), table[name].attrs.get("units", ""), table[name].attrs.get("long_name", ""))
            for name in (*table.dims, *table.data_vars)
        ),
    )
