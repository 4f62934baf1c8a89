"""The page: the case on the left; its motion, maps of it and the saved runs on the right."""

from __future__ import annotations

import asyncio
import io
import secrets
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from nicegui import app, ui
from nicegui import run as threads
from nicegui.events import UploadEventArguments, ValueChangeEventArguments

import rattlebox as rb

from .binary import decode
from .draft import FIRST, TEMPLATES, Draft, Path_, python_script, template
from .elements import Balls, Charts, Particles
from .form import Form
from .jobs import Live, TaskFailed, Worker
from .maps import MapTab
from .results import (
    DATA_FILES,
    case_files,
    inside,
    new_name,
    paused_case,
    paused_runs,
    release_name,
    store_file,
    typed_text,
)
from .runs import RunsTab
from .sliders import PINNED, USUAL, Sliders
from .views import view_of_run, view_of_snapshots

Bodies = dict[str, Callable[..., bytes]]

IMPACT_COLUMNS = {
    "number": "number",
    "time": "time (s)",
    "speed": "approach speed (m/s)",
    "force": "peak force (N)",
    "loss": "energy lost",
}
STYLE = """
.nicegui-content { padding: 0 }
.rb-left { flex: 0 0 clamp(320px, 33%, 460px); height: calc(100vh - 50px); position: sticky; top: 50px }
.q-btn--dense.q-btn--rectangle { padding: 2px 10px }
.q-uploader__list, .q-uploader__subtitle { display: none }
.rb-left .q-field__label { text-transform: none }
.rb-left textarea { height: 26vh; resize: none; white-space: pre }
.rb-drawing svg { width: 100%; height: auto }
"""
MOST_FILE = 1_000_000
"""Largest case file that is uploaded [B]."""
RESUMES = "Run and save resumes from the last checkpoint"
OUTDATED = "the pictures show an earlier case"


class Page:
    """One open page."""

    runs_in_progress: ClassVar[set[str]] = set()
    """Names of the runs that the pages of this server compute; their checkpoints are not those of paused runs."""

    def __init__(self, folder: Path, bodies: Bodies) -> None:
        self.folder, self._bodies = folder, bodies
        self.draft = Draft(folder)
        self._keys: dict[str, str] = {}
        self._version = 0
        self._impact_rows: list[dict[str, Any]] = []
        self._client = ui.context.client
        self._live = Live(self._show_view, self._show_failure)
        self._worker: Worker | None = None
        self._build()
        self._client.on_connect(self._restore)

    # ---- bodies

    def publish(self, slot: str, body: Callable[..., bytes]) -> str:
        """Serve a body at a new URL; earlier URLs of the slot, which the browser may still read, return it, too."""
        key = self._keys.setdefault(slot, secrets.token_urlsafe(12))
        self._bodies[key] = body
        self._version += 1
        return f"/data/{key}/{self._version}"

    def close(self) -> None:
        """Stop all computations of the page, and remove its data."""
        self._live.stop()
        self.stop_run()
        self.map_tab.close()
        for key in self._keys.values():
            self._bodies.pop(key, None)

    # ---- layout

    def _build(self) -> None:
        ui.add_head_html(f"<style>{STYLE}</style>")
        with ui.header().classes("items-center bg-slate-800 text-white py-1 gap-3"):
            ui.label("Rattlebox").classes("text-lg font-bold")
            self._templates = ui.select(TEMPLATES, value=FIRST, label="template").classes("w-64")
            self._templates.props("dark dense options-dense").on_value_change(self._use_template)
            offer, draft = ui.download.content, self.draft
            for title, icon, action in (
                ("Open", "upload", self._open_dialog),
                ("Download case", "download", lambda: offer(draft.text, "case.toml")),
                ("Python script", "code", lambda: offer(python_script(draft.text), "case.py")),
            ):
                ui.button(title, icon=icon, on_click=action).props("flat dense color=white")
            ui.space()
            ui.label(f"files in {self.folder.name}").classes("text-xs opacity-80").props["title"] = str(self.folder)
        with ui.row().classes("w-full no-wrap items-start gap-0"):
            with ui.column().classes("rb-left gap-1 p-2 border-r no-wrap"):
                self._build_case()
            with ui.column().classes("grow gap-1 p-2").style("min-width:0"):
                self._build_results()

    def _build_case(self) -> None:
        with ui.column().classes("w-full grow overflow-auto"):
            self.form = Form(self.draft, lambda: self._follow(self.form))
        with ui.row().classes("w-full items-center gap-2 no-wrap"):
            ui.label("TOML").classes("font-semibold text-sm")
            ui.button("Copy", icon="content_copy", on_click=self._copy).props("dense flat size=sm")
            ui.label("edits apply as you type").classes("text-xs text-gray-600")
        self._text_error = ui.label("").classes("text-red-700 text-xs whitespace-pre-wrap")
        self._text = ui.textarea(value=self.draft.text).classes("w-full text-xs")
        self._text.props("outlined dense debounce=300 input-class=font-mono")
        self._text.on_value_change(self._text_edited)

    def _build_results(self) -> None:
        with ui.tabs().props("dense align=left") as tabs:
            watch, maps, saved = ui.tab("watch", "Watch"), ui.tab("map", "Map"), ui.tab("runs", "Saved runs")
            drawing = ui.tab("drawing", "Drawing")
        self._right = tabs
        with ui.tab_panels(tabs, value="watch", animated=False).classes("w-full").props("keep-alive"):
            with ui.tab_panel(watch).classes("p-0 gap-1"):
                self._build_watch()
            with ui.tab_panel(maps).classes("p-0"):
                self.map_tab = MapTab(self.draft, self.folder, self._watch_text)
            with ui.tab_panel(saved).classes("p-0"):
                self.runs_tab = RunsTab(
                    self.folder,
                    saved,
                    self.runs_in_progress,
                    resume=self.resume,
                    show=self.show_saved,
                    publish=self.publish,
                )
            with ui.tab_panel(drawing).classes("p-0"):
                self._drawing = ui.html("The case is being drawn.", sanitize=False).classes("w-full rb-drawing")
        tabs.on_value_change(lambda event: self.runs_tab.refresh() if event.value == "runs" else None)
        tabs.on_value_change(lambda event: self._draw_case() if event.value == "drawing" else None)

    def _build_watch(self) -> None:
        with ui.row().classes("w-full items-center gap-2"):
            self._run_button = ui.button("Run and save", icon="play_arrow", on_click=self.run).props("dense")
            self._pause_button = ui.button("Pause", icon="pause", on_click=self._pause).props("dense outline")
            self._cancel_button = ui.button("Cancel", icon="stop", on_click=self._cancel)
            self._cancel_button.props("dense outline color=negative")
            self._save_button = ui.button("Save again", icon="save", on_click=self._save_again).props("dense")
            self._save_button.set_visibility(False)
            self._progress = ui.linear_progress(value=0, show_value=False).classes("w-48")
            self._compare = ui.switch("compare without damper", on_change=self._changed)
            self._status = ui.label("").classes("text-sm text-gray-700")
            self._about = ui.label("").classes("text-sm text-gray-700")
        self._show_running(False)
        self.sliders = Sliders(self.draft, partial(self._follow, None), self._keep)
        self._not_saved = ui.label("").classes("text-red-700 text-sm whitespace-pre-wrap")
        self._failure = ui.label("").classes("text-red-700 text-sm whitespace-pre-wrap")
        self._warnings = ui.label("").classes("text-amber-800 text-sm whitespace-pre-wrap")
        self._notes = ui.label("").classes("text-gray-600 text-xs whitespace-pre-wrap")
        self._balls = Balls().classes("w-full")
        self._particles = Particles().classes("w-full")
        self._particles.set_visibility(False)
        self._charts = Charts().classes("w-full")
        with ui.expansion("Impacts", on_value_change=self._list_impacts).classes("w-full") as self._impacts:
            listed = [{"name": name, "field": name, "label": label} for name, label in IMPACT_COLUMNS.items()]
            self._impact_list = ui.table(columns=listed, rows=[], row_key="number", pagination=10).props("dense")
        with ui.expansion("Summary", value=False).classes("w-full"):
            self._summary = ui.label("").classes("font-mono text-xs whitespace-pre")
        ui.timer(0.05, self._changed, once=True)

    # ---- changes of the case

    def _follow(self, source: object = None, path: Path_ | None = None) -> None:
        """Let all views show the case, after a change at a path or of the whole case; the source shows it already."""
        # An input that the user is writing in must not be replaced while its cursor is in it.
        if source is not self._text:
            self._text.set_value(self.draft.text)
        if path is not None:
            self.form.show_value(path)
        elif source is not self.form:
            self.form.follow_case()
        self.sliders.follow_case()
        self.map_tab.follow_case()
        for box in (self.form.box, self.sliders.row):  # they show older tables while the text is being written
            box.classes(**{"remove" if self.draft.is_toml else "add": "opacity-50 pointer-events-none"})
        self._changed()

    def _text_edited(self, event: ValueChangeEventArguments[str | None]) -> None:
        if event.value != self.draft.text:
            self.draft.set_text(event.value or "")
            self._follow(self._text)

    def _restore(self) -> None:
        """Show the case that this tab of the browser had before the page was loaded again."""
        with self._client:
            kept = dict(app.storage.tab)
            if kept and (kept["text"], kept["pinned"]) != (self.draft.text, [*self.sliders.pinned]):
                self.use_text(kept["text"], kept["pinned"])

    def _keep(self) -> None:
        """Keep the case for `_restore`, in the memory of the server."""
        if self._client.tab_id is not None:
            with self._client:
                app.storage.tab.update(text=self.draft.text, pinned=[*self.sliders.pinned])

    def use_text(self, text: str, pinned: Sequence[str] = ()) -> None:
        """Replace the case by the text of a case file."""
        if self._worker is not None and not self._unsaved:
            self._stop_for_another_case()
        self.sliders.pinned = pinned or self.sliders.pinned
        self.draft.set_text(text)
        self._clear_view()
        self._follow()

    def _stop_for_another_case(self) -> None:
        self.stop_run()
        if self._paused in self.runs_tab.show_paused():
            ui.notify(f"{self._paused} is paused; resume it in the tab Saved runs")

    def _clear_view(self) -> None:
        """Remove the pictures of an earlier case."""
        self._particles.show("", growing=False)
        for element in (self._balls, self._charts, self._impacts):
            element.set_visibility(False)
        for label in (self._summary, self._warnings, self._notes, self._about):
            label.set_text("")

    def _use_template(self, event: ValueChangeEventArguments[str | None]) -> None:
        if event.value is not None:
            self.use_text(template(event.value), PINNED.get(event.value, USUAL))

    def _changed(self) -> None:
        """Show errors, or compute a case of balls on a line again."""
        self.form.show_errors()
        self._keep()
        draft = self.draft
        if self._templates.value and draft.text != template(self._templates.value):
            self._templates.set_value(None)  # so that the same template can be chosen again
        self._text_error.set_text("\n".join(f"{name}: {text}" if name else text for name, text in draft.errors.items()))
        if self._right.value == "drawing":
            asyncio.get_running_loop().create_task(self._draw_case())
        if self._about.text and draft.text != self._running_text:
            self._about.set_text(OUTDATED)
        if draft.case is None:
            place = "in the form" if draft.is_toml else "above the text"
            self._failure.set_text(f"The case is not valid; see the red lines {place}.")
            return
        self._failure.set_text("")
        particles = bool(draft.case.particle_dampers)
        self._balls.set_visibility(not particles)
        self._particles.set_visibility(particles)
        self._compare.set_visibility(not particles)
        self._pause_button.set_visibility(particles and self._worker is not None)
        if self._worker is None:
            self._status.set_text("press Run and save: particles are computed in the background" if particles else "")
        if particles:
            return
        request = ("live", draft.text, str(self.folder), bool(self._compare.value))
        asyncio.get_running_loop().create_task(self._live.request(*request))

    async def _draw_case(self) -> None:
        """Draw structure and cavities to scale, in a thread."""
        if self.draft.case is not None:
            self._drawing.set_content(await threads.io_bound(_svg, self.draft.case) or "")

    # ---- runs

    def _show_view(self, body: bytes) -> None:
        """Draw a run."""
        _, about = decode(body)
        url = self.publish("view", lambda _: body)
        self._charts.show(url)
        self._charts.set_visibility(True)
        self._impacts.set_visibility("impacts" in about)
        if "impacts" in about:
            self._balls.show(url)
            listed = len(about["impacts"])
            more = f", of which the first {listed} are listed" if listed < about["impact_count"] else ""
            self._impacts.set_text(f"Impacts: {about['impact_count']}{more}")
            self._impact_rows = about["impacts"]
            self._impact_list.columns[-1]["label"] = f"energy lost ({about['energy_unit']})"
            self._list_impacts()
        self._summary.set_text(about["summary"])
        self._warnings.set_text("\n".join(about["warnings"]))
        self._notes.set_text("\n".join(about["notes"]))
        self._failure.set_text("" if about["status"] in ("finished", "interrupted") else about["status"])
        shown = f"; drawn from {about['shown']}" if about["shown"] else ""
        status = "computed up to" if about["status"] == "interrupted" else f"{about['status']} at"
        self._about.set_text(f"{status} t = {about['end']:.4g} s{shown}")

    def _show_failure(self, text: str) -> None:
        self._failure.set_text(text)
        self._about.set_text(OUTDATED if self._about.text else "")

    def _list_impacts(self) -> None:
        """Send the list of impacts if it is open: it is the largest part of a view."""
        if self._impacts.value:
            self._impact_list.rows = self._impact_rows
            self._impact_list.update()

    async def show_saved(self, name: str, run: rb.Run) -> None:
        """Show the case of a run in the folder; of particles, also the stored result."""
        self._watch_text(typed_text(self.folder, name, run.case.to_toml()))
        if run.case.particle_dampers and self.draft.case is not None:
            self._running, self._running_text = name, self.draft.text
            self._show_view(await threads.io_bound(view_of_run, run) or b"")
            snapshots = partial(view_of_snapshots, self.folder / f"{name}.vtkhdf")
            self._particles.show(self.publish("particles", snapshots), growing=False)
            self._status.set_text(f"stored as {name}")

    def _watch_text(self, text: str) -> None:
        """Replace the case by the text of a case file, and show the tab with the run."""
        self.use_text(text)
        self._right.set_value("watch")

    def _show_running(self, running: bool) -> None:
        self._run_button.set_visibility(not running)
        self._cancel_button.set_visibility(running)
        self._progress.set_visibility(running)
        case = self.draft.case
        self._pause_button.set_visibility(running and case is not None and bool(case.particle_dampers))

    async def run(self) -> None:
        """Run the case in the background and save the result in the folder."""
        draft = self.draft
        if draft.case is None or self._worker is not None:
            return
        try:
            resumed = self._paused_text == draft.text and self._paused in paused_runs(self.folder)
            name = self._paused if resumed else new_name(self.folder, "run", draft.text)
        except OSError as error:
            self._failure.set_text(f"the folder {self.folder} cannot be used: {error.strerror}")
            return
        # The text may change while the run takes hours: what runs is remembered.
        self._running, self._running_text = name, draft.text
        self.runs_in_progress.add(name)
        self.runs_tab.show_paused()
        self._worker = worker = Worker()
        self._show_running(True)
        self._progress.set_value(0)
        self._status.set_text("starting")
        self._failure.set_text("")
        particles = bool(draft.case.particle_dampers)
        if particles:
            snapshots = partial(view_of_snapshots, self.folder / f"{name}.vtkhdf")
            self._particles.show(self.publish("particles", snapshots), growing=True)
        task = "run", draft.text, str(self.folder), name, bool(self._compare.value)
        try:
            body, problem, saved = await worker.do(*task, progress=partial(self._report, worker))
            self._show_view(body)
            self._ended(worker, saved, problem)
        except TaskFailed as error:
            if self._worker is worker:
                self._failure.set_text(str(error))
                self._paused, self._paused_text = name, self._running_text
                if (self.folder / f"{name}.checkpoint").exists():
                    self._status.set_text(f"stopped; {RESUMES}")
            self._end(worker)
        finally:
            self.runs_in_progress.discard(name)
            if not self._unsaved:
                release_name(self.folder, name, self._running_text)
            self.runs_tab.show_paused()
        if particles:
            self._particles.show(self._particles._props.get("url", ""), growing=False)

    async def resume(self, name: str) -> None:
        """Resume a paused run of the folder from its checkpoint."""
        if self._worker is not None:
            raise rb.DataError("a run of this page is in progress", "Pause or Cancel in the tab Watch first")
        self._watch_text(paused_case(self.folder, name))
        self._paused, self._paused_text = name, self.draft.text
        await self.run()

    _paused = _paused_text = _running = _running_text = _unsaved = ""

    def _ended(self, worker: Worker, name: str, problem: str) -> None:
        """Report that a run was saved; if it could not be written, its process holds it until Save again or Cancel."""
        self._unsaved = name if problem else ""
        self._save_button.set_visibility(bool(problem))
        self._progress.set_visibility(False), self._pause_button.set_visibility(False)
        if problem:
            self._status.set_text("computed, but not saved")
            self._not_saved.set_text(f"{problem}\nThe result is not lost: press Save again when it can be written.")
        else:
            self._not_saved.set_text("")
            self._status.set_text(f"saved as {name} in {self.folder.name}")
            self._end(worker)

    def _end(self, worker: Worker) -> None:
        worker.stop()
        if self._worker is worker:
            self._worker = None
        self._show_running(self._worker is not None)

    async def _save_again(self) -> None:
        worker, name, problem = self._worker, self._unsaved, ""
        if worker is None or not name:
            return
        try:
            name = await worker.do("save")
        except TaskFailed as error:
            problem = str(error)
        self._ended(worker, name, problem)

    def _report(self, worker: Worker, what: str, *content: Any) -> None:
        if self._worker is not worker:  # a report that a stopped process had sent
            return
        if what == "steps":
            done, total = content
            self._progress.set_value(done / max(1, total))
            self._status.set_text(f"{100 * done / max(1, total):.0f} % of {total} steps")
        elif what == "view":
            self._show_view(content[0])

    def stop_run(self) -> None:
        """Stop the run in progress, if any."""
        worker, self._worker, self._unsaved = self._worker, None, ""
        self._save_button.set_visibility(False), self._not_saved.set_text("")
        if worker is not None:
            worker.stop()
            self.runs_in_progress.discard(self._running)
            release_name(self.folder, self._running, self._running_text)
            self._paused, self._paused_text = self._running, self._running_text

    def _pause(self) -> None:
        """Stop a particle run; its last checkpoint remains, from which Run and save resumes."""
        self.stop_run()
        self._show_running(False)
        self._status.set_text(f"paused; {RESUMES}" if self._paused in self.runs_tab.show_paused() else "stopped")

    def _cancel(self) -> None:
        """Stop a run and remove its unfinished files."""
        self.stop_run()
        self._show_running(False)
        if not (self.folder / f"{self._running}.nc").exists():
            for suffix in (".checkpoint", ".vtkhdf"):
                (self.folder / f"{self._running}{suffix}").unlink(missing_ok=True)
            release_name(self.folder, self._running, self._running_text)
        self._paused = ""
        self.runs_tab.show_paused()
        self._particles.show("")
        self._status.set_text("cancelled")

    # ---- files of the case

    def _copy(self) -> None:
        ui.clipboard.write(self.draft.text)
        ui.notify("copied")

    def _open_dialog(self) -> None:
        try:
            names = case_files(self.folder)
        except OSError as error:
            self._failure.set_text(f"the folder {self.folder} cannot be read: {error.strerror}")
            return
        with ui.dialog() as dialog, ui.card():
            dialog.on("hide", dialog.delete)
            ui.label("Open a case file, or add a file of data that a case names").classes("font-semibold")
            ui.label(
                f"in the folder {self.folder.name}:"
                if names
                else f"The folder {self.folder.name} has no case files yet."
            )
            for name in names[:30]:
                button = ui.button(name, on_click=lambda name=name: self._open(name)).on_click(dialog.close)
                button.props("flat dense no-caps")

            async def read(event: UploadEventArguments) -> None:
                dialog.close()
                self._use_file(event.file.name, await event.file.read())

            refused = ui.label("").classes("text-red-700 text-sm")
            upload = ui.upload(label="Choose a file", on_upload=read, auto_upload=True, max_file_size=MOST_FILE)
            upload.props(f"accept={','.join(['.toml', *DATA_FILES])}")
            upload.on_rejected(
                lambda: refused.set_text(f"A file has at most 1 MB and ends in .toml, {', '.join(DATA_FILES)}.")
            )
        dialog.open()

    def _open(self, name: str) -> None:
        try:
            self._use_file(name, inside(self.folder, name.removesuffix(".toml"), ".toml").read_bytes())
        except OSError as error:
            self._failure.set_text(f"{name} cannot be read: {error.strerror or error}")

    def _use_file(self, name: str, content: bytes) -> None:
        """Open a case file; write another file, such as a record that a case names, to the folder."""
        try:
            if name.lower().endswith(".toml"):
                self.use_text(content.decode("utf-8-sig"))
                return
            store_file(self.folder, name, content)
        except UnicodeDecodeError:
            self._failure.set_text(f"{name} is not a text in UTF-8; save it as UTF-8 and open it again")
        except (rb.RattleboxError, OSError) as error:
            self._failure.set_text(str(error))
        else:
            self.use_text(self.draft.text)
            ui.notify(f"{name} is in the folder {self.folder.name}")


def _svg(case: rb.Case) -> str:
    picture = io.StringIO()
    rb.plot_case(case).savefig(picture, format="svg")
    return "<svg" + picture.getvalue().partition("<svg")[2]
