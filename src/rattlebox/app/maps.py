"""The tab with maps: a measure over one or two numbers of the case."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from nicegui import run as threads
from nicegui import ui
from nicegui.events import EChartPointClickEventArguments, ValueChangeEventArguments
from numpy.typing import NDArray

import rattlebox as rb

from .draft import Draft, dotted, numeric_paths, quantity, rounded
from .jobs import TaskFailed, Worker
from .results import MAP_FORMATS, download_map, maps, new_name, stored_map
from .runs import offer
from .views import prefixed

Array = NDArray[Any]
Options = dict[str, Any]
"""Options of ECharts."""

NONE = "(none)"
VIRIDIS = ["#440154", "#414487", "#2a788e", "#22a884", "#7ad151", "#fde725"]
POLL = 0.7
"""Time between readings of the blocks of a running map [s]."""
MOST_VALUES = 400


class _Parameter(NamedTuple):
    """Inputs of a parameter of a map."""

    name: ui.select
    low: ui.input
    high: ui.input
    values: ui.number
    is_log: ui.switch


class MapTab:
    """Choice of parameters and measure, and the map, which fills while it is computed.

    `show` is called with the text of the case of a point that was clicked.
    """

    def __init__(self, draft: Draft, folder: Path, show: Callable[[str], object]) -> None:
        self._draft, self._folder, self._show = draft, folder, show
        self._worker: Worker | None = None
        self._name = ""
        self._typed: dict[str, tuple[object, ...]] = {}
        self._grid: tuple[list[str], list[Array], list[str]] | None = None
        self._proposed: dict[int, tuple[str, str]] = {}
        self._rows = [self._row(number) for number in range(2)]
        self.follow_case()
        with ui.row().classes("w-full items-center gap-2"):
            measures = {name: measure.long_name for name, measure in rb.MEASURES.items()}
            self._measure = ui.select(measures, value="rms", label="measure", with_input=True).props(
                "dense options-dense"
            )
            self._measure.classes("w-64")
            self._compare = ui.switch("ratio to the case without damper")
            self._start = ui.button("Compute map", icon="grid_on", on_click=self.compute).props("dense")
            self._stop = ui.button("Stop", icon="stop", on_click=self.stop).props("dense outline color=negative")
            self._open = ui.select([], label="open a map").props("dense options-dense").classes("w-36")
            self._open.on("focus", self._list_maps)
            self._open.on_value_change(self._open_map)
        self._stop.set_visibility(False)
        self._status = ui.label("A map shows a measure over one or two numbers; a click on a point shows its run.")
        self._status.classes("text-sm text-gray-700")
        self._failure = ui.label("").classes("text-red-700 text-sm whitespace-pre-wrap")
        self._remarks = ui.label("").classes("text-amber-800 text-sm whitespace-pre-wrap")
        self._chart = ui.echart({}, on_point_click=self._watch_point).classes("w-full").style("height:460px")
        with ui.row() as self._downloads:
            for suffix, title in MAP_FORMATS.items():
                ui.button(title, icon="download", on_click=partial(self._download, suffix)).props("flat dense")
        self._chart.set_visibility(False), self._downloads.set_visibility(False)

    def _row(self, number: int) -> _Parameter:
        """Build the inputs of a parameter: its name, the ends of its range, number of values and spacing."""
        with ui.row().classes("w-full items-center gap-2"):
            name = ui.select([NONE], value=NONE, label="second parameter" if number else "parameter")
            name.props("dense options-dense").classes("w-56")
            low, high = (ui.input(text).props("dense").classes("w-24") for text in ("from", "to"))
            count = ui.number("values", value=12, min=2, max=MOST_VALUES, precision=0).props("dense").classes("w-20")
            spacing = ui.switch("log")
        name.on_value_change(lambda _: self._suggest(number))
        return _Parameter(name, low, high, count, spacing)

    def follow_case(self) -> None:
        """Offer the numbers of the case, and ranges around its values in place of those that were proposed before."""
        names = [dotted(path) for path in numeric_paths(self._draft.given)]
        for number, ((name, low, high, *_), usual) in enumerate(zip(self._rows, ("damper.gap", NONE), strict=True)):
            options = [NONE, *names] if number or not names else names
            kept = name.value if name.value in options and (number or name.value != NONE) else None
            chosen = kept or (usual if usual in options else options[0])
            if name.options != options or name.value != chosen:
                name.set_options(options, value=chosen)
            if kept is None or (low.value, high.value) == self._proposed.get(number):
                self._suggest(number)

    def _suggest(self, number: int) -> None:
        """Fill in a range around the value of the case."""
        name, low, high, _, spacing = self._rows[number]
        paths = {dotted(path): path for path in numeric_paths(self._draft.given)}
        number_and_unit = quantity(self._draft.value(paths[name.value])) if name.value in paths else None
        if number_and_unit is None:
            ends = "", ""
        else:
            value, unit = number_and_unit
            start, stop = (0.0, 1.0) if not unit and 0 <= value <= 1 else (value / 3, value * 3)
            if name.value.endswith("start"):
                start, stop = -1.0, 1.0
            ends = f"{rounded(start):g} {unit}".strip(), f"{rounded(stop):g} {unit}".strip()
            if start * stop <= 0:  # that of another parameter, which logarithmic spacing suited
                spacing.set_value(False)
        self._proposed[number] = ends
        low.set_value(ends[0]), high.set_value(ends[1])

    # ---- computing

    async def compute(self) -> None:
        """Compute the map in the background; it fills as blocks of the study are finished."""
        folder, draft = self._folder, self._draft
        if draft.case is None or self._worker is not None:
            self._failure.set_text("" if draft.case else "The case is not valid; see the form.")
            return
        axes: dict[str, tuple[object, ...]] = {}
        for name, low, high, count, spacing in self._rows:
            if name.value != NONE:
                values = [int(v) if v.isdecimal() else v for v in (str(low.value).strip(), str(high.value).strip())]
                axes[name.value] = (*[_number(v) for v in values], int(count.value or 0), bool(spacing.value))
        try:
            self._name = new_name(folder, "map")
        except OSError as error:
            self._failure.set_text(f"the folder {folder} cannot be used: {error.strerror}")
            return
        self._typed = axes
        self._worker = worker = Worker()
        self._start.set_visibility(False), self._stop.set_visibility(True)
        self._failure.set_text("")
        self._status.set_text("starting")
        # The worker writes blocks to the disk; the page reads them from there while it waits.
        watch = asyncio.get_running_loop().create_task(self._poll(worker))
        try:
            what = axes, self._measure.value, bool(self._compare.value)
            await worker.do("sweep", draft.text, str(folder), self._name, *what, progress=self._report)
            await self._draw()
            self._status.set_text(f"saved as {self._name} in {folder.name}; click a point to watch it")
        except TaskFailed as error:
            if self._worker is worker:
                self._failure.set_text(str(error))
        finally:
            watch.cancel()
            worker.stop()
            with suppress(OSError):  # a map without blocks gives its name back
                (folder / f"{self._name}.zarr").rmdir()
            if self._worker is worker:
                self._worker = None
                self._start.set_visibility(True), self._stop.set_visibility(False)

    def _report(self, what: str, done: int, total: int) -> None:
        if self._worker is not None:  # else a report that a stopped process had sent
            self._status.set_text(f"{done} of {total} {what}")

    async def _poll(self, worker: Worker) -> None:
        while self._worker is worker:
            await asyncio.sleep(POLL)
            await self._draw()

    def stop(self) -> None:
        """Stop the computation; finished blocks remain."""
        self.close()
        self._start.set_visibility(True), self._stop.set_visibility(False)
        self._status.set_text(f"stopped; the finished part is {self._name} in {self._folder.name}")

    def close(self) -> None:
        """End the process of the map."""
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.stop()

    async def _open_map(self, event: ValueChangeEventArguments[str | None]) -> None:
        """Show a map of the folder."""
        if event.value:
            self._name, self._typed = event.value, {}
            await self._draw()

    def _list_maps(self) -> None:
        try:
            self._open.set_options(maps(self._folder))
        except OSError as error:
            self._failure.set_text(f"the folder {self._folder} cannot be read: {error.strerror}")

    # ---- drawing

    async def _draw(self) -> None:
        name = self._name
        if not name or not (self._folder / f"{name}.zarr").exists():
            return
        try:
            study, drawn = await threads.io_bound(stored_map, self._folder, name) or (None, "")
        except rb.RattleboxError as error:
            if self._worker is None:
                self._failure.set_text(str(error))
            return
        if study is None or name != self._name:  # the server ends, or another map was opened
            return
        values = study[drawn]
        unit, scale = prefixed(values.attrs.get("units", ""), [values])
        label = values.attrs.get("long_name", drawn) + (f" ({unit})" if unit not in ("", "1") else "")
        axes = [str(dim) for dim in values.dims]
        points = [study[axis].values for axis in axes]
        units = [str(study[axis].attrs.get("units", "")) for axis in axes]
        shown = [self._as_typed(*axis) for axis in zip(axes, points, units, strict=True)]
        points, units = [list(each) for each in zip(*shown, strict=True)]
        self._grid = axes, points, units
        titles = [f"{axis} ({unit})" if unit not in ("", "1") else axis for axis, unit in zip(axes, units, strict=True)]
        draw = _lines if len(axes) == 1 else _heat
        remarks = rb.study_remarks(study)
        texts = remarks.transpose(*axes).values if set(axes) == set(remarks.dims) else np.full(values.shape, "", object)
        self._remarks.set_text(_counted(texts))
        self._chart.set_visibility(True), self._downloads.set_visibility(True)
        self._chart.options.clear()
        self._chart.options.update(draw(scale * values.values, points, titles, label, texts))
        self._chart.update()

    def _as_typed(self, axis: str, values: Array, unit: str) -> tuple[Array, str]:
        """Return the values of an axis in the unit in which the user typed its range, and this unit."""
        typed = [quantity(text) for text in self._typed.get(axis, ())[:2]]
        for stored, end in zip((values[0], values[-1]), typed, strict=False):
            if end is not None and end[1] and end[0] and stored:
                return values * (end[0] / stored), end[1]
        return values, unit

    def _watch_point(self, event: EChartPointClickEventArguments) -> None:
        """Put the values of a point of the map into the case."""
        if self._grid is None:
            return
        axes, points, units = self._grid
        data: Any = event.data
        if isinstance(data, dict):  # one of the triangles
            indices = list(np.unravel_index(data["value"][2], [values.size for values in points]))
        else:
            indices = [event.data_index] if len(axes) == 1 else [int(number) for number in data[:2]]
        draft = self._draft
        paths = {dotted(path): path for path in numeric_paths(draft.given)}
        for axis, values, unit, index in zip(axes, points, units, indices, strict=True):
            if axis in paths:
                value = float(values[index])
                draft.set_value(paths[axis], f"{value:.6g} {unit}" if unit not in ("", "1") else value)
        self._show(draft.text)

    async def _download(self, suffix: str) -> None:
        if not self._name:
            self._failure.set_text("There is no map yet; press Compute map.")
            return
        await offer(self._failure, download_map, self._folder, self._name, suffix)


def _number(text: str | int) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


def _axis(kind: str, title: str, gap: int, **more: object) -> Options:
    return {"type": kind, "name": title, "nameLocation": "middle", "nameGap": gap, "scale": True, **more}


def _counted(texts: Array) -> str:
    """Return the remarks on the points of a map in lines, with the number of points that have each."""
    parts = [part for text in texts.ravel() if text for part in text.split("; ")]
    lines = [f"warning: {parts.count(part)} of {texts.size} points: {part}" for part in dict.fromkeys(parts)]
    return "\n".join([*lines, "The triangles mark these points."] if lines else [])


def _marks(texts: Array, data: list[list[Any]]) -> Options:
    """Return triangles at the points with remarks: place in the picture, number of the point, and text."""
    marked = [
        {"value": [*place[:2], number], "name": text}
        for number, (place, text) in enumerate(zip(data, texts.ravel().tolist(), strict=True))
        if text
    ]
    form = {"symbol": "triangle", "symbolSize": 12, "itemStyle": {"color": "#b45309"}}
    return {"type": "scatter", "data": marked, "animation": False, "tooltip": {"formatter": "{b}"}, **form}


def _lines(values: Array, points: list[Array], titles: list[str], label: str, texts: Array) -> Options:
    data = [[float(x), _finite(y)] for x, y in zip(points[0], values, strict=True)]
    line = {"type": "line", "data": data, "symbolSize": 8, "color": rb.plots.SERIES_COLOURS[0], "animation": False}
    steps = points[0][1:] / points[0][:-1] if (points[0] > 0).all() else np.zeros(1)
    kind = "log" if steps.size > 1 and np.allclose(steps, steps[0]) else "value"
    axes = {"xAxis": _axis(kind, titles[0], 30), "yAxis": _axis("value", label, 60)}
    return {
        "grid": {"left": 80, "right": 20, "top": 20, "bottom": 50},
        "tooltip": {},
        **axes,
        "series": [line, _marks(texts, data)],
    }


def _heat(values: Array, points: list[Array], titles: list[str], label: str, texts: Array) -> Options:
    cells = [[i, j, _finite(values[i, j])] for i in range(values.shape[0]) for j in range(values.shape[1])]
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    first, second = ([f"{x:.4g}" for x in each] for each in points)
    colours = {"min": low, "max": high if high > low else low + 1.0, "inRange": {"color": VIRIDIS}, "right": 4}
    return {
        "title": {"text": label, "right": 10, "top": 0, "textStyle": {"fontSize": 13}},
        "grid": {"left": 80, "right": 110, "top": 34, "bottom": 50},
        "tooltip": {"position": "top"},
        "xAxis": _axis("category", titles[0], 30, data=first),
        "yAxis": _axis("category", titles[1], 60, data=second),
        "visualMap": {**colours, "seriesIndex": 0, "top": "center", "text": [f"{high:.4g}", f"{low:.4g}"]},
        "series": [{"type": "heatmap", "data": cells, "animation": False}, _marks(texts, cells)],
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
