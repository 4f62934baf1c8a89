"""The tab with the runs in the folder: resume, compare, open, download."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Collection
from datetime import datetime
from functools import partial
from pathlib import Path

from nicegui import run as threads
from nicegui import ui

import rattlebox as rb

from .draft import FAILURES, leaves, said, short
from .elements import Charts
from .results import FORMATS, download, inside, name_of_case, paused_runs, runs
from .views import comparison

MOST_RUNS = 50
MOST_DIFFERENCES = 12


class RunsTab:
    """List of the runs in the folder.

    `busy` has the names of runs in progress, which are not listed as paused. The other arguments are called with the name of
    a run that the user resumes, with name and run of one that is opened, and with a body to serve, whose URL they return.
    """

    def __init__(
        self,
        folder: Path,
        tab: ui.tab,
        busy: Collection[str],
        *,
        resume: Callable[[str], Awaitable[object]],
        show: Callable[[str, rb.Run], Awaitable[object]],
        publish: Callable[[str, Callable[..., bytes]], str],
    ) -> None:
        self._folder, self._tab, self._busy = folder, tab, busy
        self._resume_run, self._show, self._publish = resume, show, publish
        self._chosen: set[str] = set()
        with ui.row().classes("items-center"):
            ui.button("Refresh", icon="refresh", on_click=self.refresh).props("flat dense")
            ui.button("Compare the ticked runs", icon="stacked_line_chart", on_click=self._compare).props("dense")
        self._failure = ui.label("").classes("text-red-700 text-sm whitespace-pre-wrap")
        self._download = partial(offer, self._failure, download, folder)
        self._box = ui.column().classes("w-full gap-0")
        self._charts = Charts().classes("w-full")
        self._charts._props["columns"] = 1
        self._table = ui.label("").classes("font-mono text-xs whitespace-pre overflow-x-auto w-full")
        self.show_paused()

    def show_paused(self) -> list[str]:
        """Show the number of paused runs in the label of the tab, and return their names."""
        try:
            paused = [name for name in paused_runs(self._folder) if name not in self._busy]
        except OSError:  # reported when the tab is opened
            paused = []
        self._tab.props["label"] = f"Saved runs ({len(paused)} paused)" if paused else "Saved runs"
        return paused

    def refresh(self) -> None:
        """Read the folder again."""
        self._box.clear()
        self._failure.set_text("")
        with self._box:
            self._list()

    def _list(self) -> None:
        folder = self._folder
        try:
            times = {name: (folder / f"{name}.nc").stat().st_mtime for name in runs(folder)[:MOST_RUNS]}
        except OSError as error:
            self._failure.set_text(f"the folder {folder} cannot be read: {error.strerror}")
            return
        paused = self.show_paused()
        if not times and not paused:
            ui.label("No runs in the folder yet; Run and save stores one.").classes("text-sm text-gray-600")
        for name in paused:
            with ui.row().classes("w-full items-center gap-2 no-wrap"):
                ui.icon("pause").classes("text-xl px-2")
                ui.label(f"{name}, paused").classes("whitespace-nowrap")
                ui.button("Resume", icon="play_arrow", on_click=partial(self._resume, name)).props("dense no-caps")
        for name, changed in times.items():
            with ui.row().classes("w-full items-center gap-2 no-wrap"):
                box = ui.checkbox(name, value=name in self._chosen)
                box.on_value_change(lambda event, name=name: self._choose(name, event.value))
                ui.label(name_of_case(folder / f"{name}.nc", changed)).classes("text-sm truncate")
                ui.label(f"{datetime.fromtimestamp(changed):%Y-%m-%d %H:%M}").classes("text-xs whitespace-nowrap")
                ui.space()
                ui.button("Open its case", on_click=partial(self._open, name)).props("flat dense no-caps")
                with ui.button("Download", icon="download").props("flat dense no-caps"), ui.menu():
                    for suffix, text in FORMATS.items():
                        if suffix != "vtkhdf" or (folder / f"{name}.vtkhdf").exists():
                            ui.menu_item(text, on_click=partial(self._download, name, suffix))

    def _choose(self, name: str, chosen: bool) -> None:
        (self._chosen.add if chosen else self._chosen.discard)(name)

    async def _resume(self, name: str) -> None:
        try:
            await self._resume_run(name)
        except FAILURES as error:
            self._failure.set_text(said(error))

    async def _open(self, name: str) -> None:
        run = (await self._load([name])).get(name)
        if run is not None:
            await self._show(name, run)

    async def _load(self, names: list[str]) -> dict[str, rb.Run]:
        """Return runs of the folder by name; none, with a message in the page, if one cannot be read."""
        folder = self._folder

        def load() -> dict[str, rb.Run]:
            loaded = {name: rb.load(inside(folder, name, ".nc")) for name in names}
            return {name: run for name, run in loaded.items() if run.case}  # raises if the text of a case is damaged

        try:
            loaded = await threads.io_bound(load) or {}
        except FAILURES as error:
            self._failure.set_text(said(error))
            return {}
        self._failure.set_text("")
        return loaded

    async def _compare(self) -> None:
        """Draw the motion of the chosen runs in one chart, and list their results and the differences of their cases."""
        if len(self._chosen) < 2:
            self._failure.set_text("Tick two or more runs.")
            return
        loaded = await self._load(sorted(self._chosen))
        if loaded:
            body = comparison(loaded)
            self._charts.show(self._publish("comparison", lambda _: body))
            self._table.set_text(f"{differences(loaded)}\n\n{rb.compare(loaded)}")


async def offer(failure: ui.label, content_of: Callable[..., bytes], folder: Path, name: str, suffix: str) -> None:
    """Offer a result as a download, or show an error."""
    try:
        content = await threads.io_bound(content_of, folder, name, suffix) or b""
    except FAILURES as error:
        failure.set_text(said(error))
    else:
        failure.set_text("")
        ui.download.content(content, f"{name}.{'zip' if content[:2] == b'PK' else suffix}")


def differences(loaded: dict[str, rb.Run]) -> str:
    """Return a table of the values in which the cases of runs differ."""
    cases = {name: leaves(run.case_toml) for name, run in loaded.items()}
    paths = list(dict.fromkeys(path for case in cases.values() for path in case))
    first, *others = cases.values()
    differing = [path for path in paths if any(case.get(path) != first.get(path) for case in others)]
    if not differing:
        return "The case files are equal."
    shown = differing[:MOST_DIFFERENCES]
    columns = [["", *shown], *([name, *(short(case.get(path, "-")) for path in shown)] for name, case in cases.items())]
    padded = [[text.rjust(max(map(len, column))) for text in column] for column in columns]
    more = [f"and {len(differing) - len(shown)} more"] if len(differing) > len(shown) else []
    return "\n".join(["Differences of the cases", *map("  ".join, zip(*padded, strict=True)), *more])
