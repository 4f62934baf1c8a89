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
from .files import record_cases, write_runs, write_tables
from .judge import documentation
from .page import GENERATOR, FigureFiles, Table, render

if TYPE_CHECKING:
    import xarray as xr

FIGURES = tuple(key for key in WORDS if key != "columns")  # modules of the figures, in the order of the page
TABLE = "figures/figure_claims.md"  # Matrix of the claims for the documentation

Progress = Callable[[int, int, str], None]
"""Function of the number of finished figures, their total and the name of the last one."""


def write_report(
    folder: str | os.PathLike[str], only: Sequence[str] = (), *, workers: int = 1, progress: Progress | None = None
) -> Path:
    """Write the report with each figure as SVG, PNG and CSV and its runs as case and study files; return its page.

    The folder is new, empty, or that of an earlier report. `only` has numbers of figures, such as "4", "7c" or "A1"; "7"
    means all its parts, and "paper" all but the extensions A1 to A6, which take two thirds of the time. More than one
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
    _write(folder / TABLE, documentation([claim for figure in figures for claim in figure.claims]))
    missing = [load_figure(module).number for module in FIGURES if module not in modules]
    took = time.perf_counter() - began
    page = folder / "index.html"
    _write(page, render(figures, table=TABLE, missing=missing, cores=cores(), workers=workers, seconds=took))
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
        chosen = {module for module, number in numbers.items() if _includes(number, text.strip().lower())}
        if not chosen:
            names = ", ".join(numbers.values())
            raise ValueError(f"--only {text}: unknown figure; the figures are {names}, and 'paper'")
        wanted |= chosen
    return tuple(module for module in FIGURES if module in wanted or not only)


def load_figure(module: str) -> Reproduction:
    """Return the figure of a module of this package."""
    figure = import_module(f"{__package__}.{module}").FIGURE
    assert isinstance(figure, Reproduction)
    return figure


def _includes(number: str, wanted: str) -> bool:
    """Return whether a figure, such as "7d, 7e" or "10", includes a requested one, such as "7", "7e", "10a" or "paper"."""
    if wanted == "paper":
        return not number.startswith("A")
    parts = number.lower().split(", ")
    return wanted in parts or wanted in [re.sub(r"[a-z]+$", "", part) for part in parts] or wanted[:-1] in parts


def _prepare_folder(folder: Path) -> Path:
    """Create the folder, remove the files of an earlier report, and write a preliminary page with the mark."""
    page = folder / "index.html"
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "is a file; a report needs a folder", str(folder))
    if folder.is_dir() and any(folder.iterdir()):
        earlier = page.read_text(encoding="utf-8", errors="replace") if page.is_file() else ""
        if GENERATOR not in earlier:
            complaint = "contains other files; choose a new folder, or that of an earlier report"
            raise FileExistsError(errno.EEXIST, complaint, str(folder))
        # Only files that the earlier page links to are removed; others belong to the user.
        for name in re.findall(r'href="((?:figures|cases)/figure_[\w.]+)"', earlier):
            (folder / name).unlink(missing_ok=True)
    for name in ("figures", "cases"):
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
        # The last ones take longest.
        running = {pool.submit(_compute, module, folder): module for module in reversed(modules)}
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
        picture = _draw(figure, data, folder / "figures")
        drawn = time.perf_counter()
        return FigureFiles(
            number=figure.number,
            title=figure.title,
            name=figure.name,
            caption=figure.caption(data),
            claims=tuple(figure.claims(data)),
            lessons=tuple(figure.lessons(data)),
            film=figure.film(data),
            picture=picture,
            tables=tuple(
                Table(f"figures/{path.name}", max(v.size for v in table.variables.values()), _columns(table))
                for path, table in write_tables(data, folder / "figures", figure.name).items()
            ),
            cases=write_runs(figure.cases(), runs, folder, "cases", figure.name),
            computing=computed - began,
            drawing=drawn - computed,
        )
    except Exception as error:
        error.add_note(f"in figure {figure.number} of the report")
        raise


def _columns(table: xr.Dataset) -> tuple[tuple[str, str, str], ...]:
    """Return name, unit and meaning of the columns of a table."""
    names = [str(name) for name in (*table.dims, *table.data_vars)]
    return tuple((name, *(table[name].attrs.get(key, "") for key in ("units", "long_name"))) for name in names)


def _draw(figure: Reproduction, data: xr.Dataset, folder: Path) -> str:
    """Draw a figure and write it as PNG and SVG; return it as the value of an HTML attribute in double quotes."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from rattlebox.plots import figure_style

    drawing = figure.draw(data)
    drawing.savefig(folder / f"{figure.name}.png", dpi=200)
    svg = folder / f"{figure.name}.svg"
    # Outlined letters look the same on every machine; ids are the same in every run.
    with figure_style("page"), mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": figure.name}):
        Figure.savefig(drawing, svg, metadata={"Date": None}, dpi=140)
    # Hundredths of a point are invisible, and further digits would make the page half as large again.
    text = svg.read_text(encoding="utf-8")
    text = re.sub(r'(?<= d=")[^"]+', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path[0]), text)
    svg.write_text(text, encoding="utf-8")
    # Escaped text is a quarter shorter than base64.
    text = " ".join(text.replace('"', "'").split())
    return "data:image/svg+xml," + text.replace("%", "%25").replace("#", "%23").replace("&", "&amp;")
