"""Report: every figure of the paper computed, drawn and judged, on one page."""

from __future__ import annotations

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

from .figure import WORDS, Reproduction
from .matrix import documentation
from .page import GENERATOR, Column, FigureFiles, Table, render
from .runs import record_cases, write_runs
from .tables import write_tables

if TYPE_CHECKING:
    import xarray as xr

FIGURES = tuple(key for key in WORDS if key != "columns")  # modules of the figures, in the order of the page

_FIGURE_FOLDER, _CASE_FOLDER = "figures", "cases"
TABLE = f"{_FIGURE_FOLDER}/figure_claims.md"  # Matrix of the claims for the documentation

Progress = Callable[[int, int, str], None]
"""Function of the number of finished figures, their total and the name of the last one."""


def write_report(
    folder: str | os.PathLike[str], only: Sequence[str] = (), *, workers: int = 1, progress: Progress | None = None
) -> Path:
    """Write the report with each figure as SVG, PNG and CSV and its runs as case and study files; return its page.

    The folder is new, empty, or that of an earlier report. `only` has numbers of figures, such as "4", "7c" or "A1"; "7"
    means all its parts, and "paper" all but the extensions A1 to A5, which take two thirds of the time. More than one
    worker needs `if __name__ == "__main__":` in a script.
    """
    began = time.perf_counter()
    modules = choose(only)
    folder = _prepare_folder(Path(folder))
    made: dict[str, FigureFiles] = {}
    for module, figure in _compute_all(modules, folder, workers):
        made[module] = figure
        if progress is not None:
            progress(len(made), len(modules), f"figure {figure.number}")
    figures = [made[module] for module in modules]
    page = folder / "index.html"
    claims = [claim for figure in figures for claim in figure.claims]
    _write(folder / TABLE, documentation(claims))
    missing = [load_figure(module).number for module in FIGURES if module not in modules]
    text = render(
        figures, table=TABLE, missing=missing, cores=cores(), workers=workers, seconds=time.perf_counter() - began
    )
    _write(page, text)
    return page


def cores() -> int:
    """Return the number of processor cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not available on every system
        return os.cpu_count() or 1


def choose(only: Sequence[str]) -> tuple[str, ...]:
    """Return the modules of the figures with the given numbers, in the order of the page; default all."""
    numbers = {module: load_figure(module).number for module in FIGURES}
    wanted: set[str] = set()
    for text in only:
        found = {module for module, number in numbers.items() if _covers(number, text.strip())}
        if not found:
            raise ValueError(
                f"--only {text}: unknown figure; the figures are {', '.join(numbers.values())}, and 'paper'"
            )
        wanted |= found
    return tuple(module for module in FIGURES if module in wanted or not only)


def load_figure(module: str) -> Reproduction:
    """Return the figure of a module of this package."""
    figure = import_module(f"{__package__}.{module}").FIGURE
    assert isinstance(figure, Reproduction)
    return figure


def _covers(number: str, wanted: str) -> bool:
    """Return whether a figure, such as "7d, e" or "10", includes a requested one, such as "7", "7e", "10a" or "paper"."""
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


def _prepare_folder(folder: Path) -> Path:
    """Create the folder, remove the files of an earlier report, and write a preliminary page with the mark."""
    page = folder / "index.html"
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "is a file; a report needs a folder", str(folder))
    if folder.is_dir() and any(folder.iterdir()):
        earlier = page.read_text(encoding="utf-8", errors="replace") if page.is_file() else ""
        if GENERATOR not in earlier:
            raise FileExistsError(
                errno.EEXIST, "contains other files; choose a new folder, or that of an earlier report", str(folder)
            )
        # Only files that the earlier page links to are removed; others belong to the user.
        for name in re.findall(rf'href="((?:{_FIGURE_FOLDER}|{_CASE_FOLDER})/figure_[\w.]+)"', earlier):
            (folder / name).unlink(missing_ok=True)
    for name in (_FIGURE_FOLDER, _CASE_FOLDER):
        (folder / name).mkdir(parents=True, exist_ok=True)
    _write(page, f"<!doctype html>{GENERATOR}<title>Report</title><p>This report is not finished.")
    return folder


def _write(page: Path, text: str) -> None:
    """Write a page atomically."""
    temporary = page.with_name(f".{page.name}.partial")
    try:
        temporary.write_text(text, encoding="utf-8")
        temporary.replace(page)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _compute_all(modules: Sequence[str], folder: Path, workers: int) -> Iterator[tuple[str, FigureFiles]]:
    """Compute the figures; yield each when it is done."""
    if workers <= 1 or len(modules) <= 1:
        yield from ((module, _compute(module, folder)) for module in modules)
        return
    # Processes, since matplotlib draws one figure at a time; spawned, since forking a process with threads is unsafe.
    # Ctrl-C ends them at once and without messages.
    on_ctrl_c = (signal.SIGINT, signal.SIG_DFL)
    with ProcessPoolExecutor(min(workers, len(modules)), get_context("spawn"), signal.signal, on_ctrl_c) as pool:
        running = {
            pool.submit(_compute, module, folder): module for module in reversed(modules)
        }  # the last take longest
        try:
            for done in as_completed(running):
                yield running[done], done.result()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _compute(module: str, folder: Path) -> FigureFiles:
    """Compute, draw and write one figure."""
    figure = load_figure(module)
    try:
        began = time.perf_counter()
        with record_cases() as runs:
            data = figure.data()
        computed = time.perf_counter()
        png, svg = _draw(figure, data, folder / _FIGURE_FOLDER)
        drawn = time.perf_counter()
        tables = write_tables(data, folder / _FIGURE_FOLDER, figure.name)
        return FigureFiles(
            number=figure.number,
            title=figure.title,
            name=figure.name,
            caption=figure.caption(data),
            claims=tuple(figure.claims(data)),
            lessons=tuple(figure.lessons(data)),
            film=figure.film(data),
            picture=_data_url(svg.read_text(encoding="utf-8")),
            svg=svg.relative_to(folder).as_posix(),
            png=png.relative_to(folder).as_posix(),
            tables=tuple(_table(path.relative_to(folder), table) for path, table in tables.items()),
            cases=write_runs(figure.cases(), runs, folder, _CASE_FOLDER, figure.name),
            computing=computed - began,
            drawing=drawn - computed,
        )
    except Exception as error:
        error.add_note(f"in figure {figure.number} of the report")
        raise


def _draw(figure: Reproduction, data: xr.Dataset, folder: Path) -> tuple[Path, Path]:
    """Draw a figure and write it as PNG and SVG."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from rattlebox.plots import figure_style

    drawing = figure.draw(data)
    png, svg = folder / f"{figure.name}.png", folder / f"{figure.name}.svg"
    drawing.savefig(png, dpi=200)
    # Outlined letters look the same on every machine; ids are the same in every run.
    with figure_style("page"), mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": figure.name}):
        Figure.savefig(drawing, svg, metadata={"Date": None}, dpi=140)
    # Hundredths of a point are invisible, and further digits would make the page half as large again.
    text = re.sub(
        r'(?<= d=")[^"]+', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path[0]), svg.read_text(encoding="utf-8")
    )
    svg.write_text(text, encoding="utf-8")
    return png, svg


def _data_url(svg: str) -> str:
    """Return a drawing as the value of an HTML attribute in double quotes, a quarter shorter than in base64."""
    text = " ".join(svg.replace('"', "'").split())
    return "data:image/svg+xml," + text.replace("%", "%25").replace("#", "%23").replace("&", "&amp;")


def _table(path: Path, table: xr.Dataset) -> Table:
    """Return the description of a CSV file."""
    return Table(
        path=path.as_posix(),
        rows=max(variable.size for variable in table.variables.values()),
        columns=tuple(
            Column(str(name), table[name].attrs.get("units", ""), table[name].attrs.get("long_name", ""))
            for name in (*table.dims, *table.data_vars)
        ),
    )
