"""The tab with the results in the folder: compare, open, download."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import run as threads
from nicegui import ui

import rattlebox as rb

from .binary import encode
from .results import FORMATS, download, inside, runs

if TYPE_CHECKING:
    from .page import Page

from .elements import Charts


class KeptTab:
    """List of the runs in the folder."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self._chosen: set[str] = set()
        with ui.row().classes("items-center"):
            ui.button("Refresh", icon="refresh", on_click=self.refresh).props("flat dense")
            ui.button("Compare the chosen runs", icon="stacked_line_chart", on_click=self._compare).props("dense")
        self._failure = ui.label("").classes("text-red-700 text-sm whitespace-pre-wrap")
        self._download = partial(offer, self._failure, download, page.folder)
        self._box = ui.column().classes("w-full gap-0")
        self.refresh()
        self._charts = Charts().classes("w-full")
        self._charts._props["columns"] = 1
        self._table = ui.label("").classes("font-mono text-xs whitespace-pre")

    def refresh(self) -> None:
        """Read the folder again."""
        self._box.clear()
        with self._box:
            self._list()

    def _list(self) -> None:
        try:
            names = runs(self._page.folder)
        except OSError as error:
            self._failure.set_text(f"the folder {self._page.folder} cannot be read: {error.strerror}")
            return
        if not names:
            ui.label("No runs in the folder yet; Run and keep stores one.").classes("text-sm text-gray-600")
        for name in names[:50]:
            with ui.row().classes("w-full items-center gap-1 no-wrap"):
                box = ui.checkbox(name, value=name in self._chosen)
                box.on_value_change(lambda event, name=name: self._choose(name, event.value))
                ui.space()
                ui.button("Open its case", on_click=lambda name=name: self._open(name)).props("flat dense no-caps")
                with ui.button("Download", icon="download").props("flat dense no-caps"), ui.menu():
                    for suffix, title in FORMATS.items():
                        if suffix != "vtkhdf" or (self._page.folder / f"{name}.vtkhdf").exists():
                            ui.menu_item(title, on_click=partial(self._download, name, suffix))

    def _choose(self, name: str, chosen: bool) -> None:
        (self._chosen.add if chosen else self._chosen.discard)(name)

    async def _open(self, name: str) -> None:
        try:
            run = await threads.io_bound(rb.load, inside(self._page.folder, name, ".nc"))
        except rb.RattleboxError as error:
            self._failure.set_text(str(error))
            return
        if run is not None:
            await self._page.show_kept(name, run)

    def _compare(self) -> None:
        """Draw the motion of the chosen runs in one chart, and list their main numbers."""
        try:
            chosen = {name: rb.load(inside(self._page.folder, name, ".nc")) for name in sorted(self._chosen)}
        except rb.RattleboxError as error:
            self._failure.set_text(str(error))
            return
        moving = {name: run for name, run in chosen.items() if "displacement" in run.motion}
        if len(moving) < 2:
            self._failure.set_text("Choose two or more runs with a structure that moves.")
            return
        self._failure.set_text("")
        body = comparison(moving)
        self._charts.show(self._page.publish("comparison", lambda _: body))
        self._table.set_text("\n\n".join(f"{name}\n{run.summary()}" for name, run in moving.items()))


async def offer(failure: ui.label, content_of: Callable[..., bytes], folder: Path, name: str, suffix: str) -> None:
    """Let the browser download a result, or show why there is none."""
    try:
        content = await threads.io_bound(content_of, folder, name, suffix) or b""
    except (rb.RattleboxError, OSError, MemoryError) as error:
        failure.set_text(str(error) or "the memory is exhausted")
    else:
        failure.set_text("")
        ui.download.content(content, f"{name}.{'zip' if content[:2] == b'PK' else suffix}")


def comparison(chosen: dict[str, Any]) -> bytes:
    """Return the motion of the first point of several runs as a body with one chart."""
    arrays: dict[str, Any] = {}
    series = []
    for number, (name, run) in enumerate(chosen.items()):
        step = max(1, -(-run.motion.time.size // 6000))
        x = run.motion.displacement.values[::step, 0]
        arrays[f"time {name}"] = run.motion.time.values[::step]
        arrays[name] = 1e3 * (x if x.ndim == 1 else x[:, abs(x).max(axis=0).argmax()])
        colour = rb.plots.SERIES_COLOURS[number % 6]
        series.append({"name": name, "x": f"time {name}", "y": name, "colour": colour, "dash": number > 5})
    chart = {"title": "Motion of the first point", "x": "Time (s)", "y": "Displacement (mm)", "series": series}
    return encode(arrays, charts=[chart])
