"""Sliders for numbers of the case."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from nicegui import ui
from nicegui.events import GenericEventArguments

from .draft import FIRST, Draft, Path_, dotted, numeric_paths, quantity, rounded
from .form import written

MOST_SLIDERS = 4
PINNED = {
    "struck": ("damper.gap", "damper.contact.restitution", "load.amplitude", "damper.start"),
    "steel_ball": ("damper.gap", "load.amplitude", "damper.start", "damper.ball.radius"),
    "row": ("damper.gap", "load.amplitude", "damper.contact.restitution"),
    "building": ("damper.gap", "damper.contact.restitution", "damper.ball.mass"),
}
"""Numbers with a slider at the start, by template."""
USUAL = ("damper.gap", "damper.friction", "load.amplitude", "base.amplitude", "damper.contact.restitution")
"""Numbers with a slider where the case has none of those that had one."""


class Sliders:
    """Sliders that show the numbers of the case, and change them.

    `moved` is called with the path after each change of the case, `chosen` after another choice of sliders.
    """

    def __init__(self, draft: Draft, moved: Callable[[Path_], object], chosen: Callable[[], object]) -> None:
        self._draft, self._moved, self._chosen = draft, moved, chosen
        self.pinned: Sequence[str] = PINNED[FIRST]
        self._shown: tuple[list[str], dict[str, Any]] = [], {}
        self.row = ui.row().classes("w-full items-center gap-4")
        self.follow_case()

    def follow_case(self) -> None:
        """Show the numbers of the case; a slider whose number is what it shows already stays as it is."""
        numbers = {dotted(path): path for path in numeric_paths(self._draft.given)}
        names = [name for name in self.pinned if name in numbers] or [name for name in USUAL if name in numbers]
        values = {name: self._draft.value(numbers[name]) for name in names[:MOST_SLIDERS]}
        if self._shown == ([*numbers], values):
            return
        self._shown = [*numbers], values
        self.row.clear()
        with self.row:
            for name in values:
                self._slider(name, numbers[name])
            choice = ui.select([*numbers], label="slider for", multiple=True, value=[*values])
            choice.props(f"dense options-dense max-values={MOST_SLIDERS}").classes("w-44")
            choice.on_value_change(lambda event: self._pin(event.value))

    def _pin(self, names: list[str]) -> None:
        self.pinned = names[:MOST_SLIDERS]
        self.follow_case()
        self._chosen()

    def _slider(self, name: str, path: Path_) -> None:
        """Show a slider from a quarter to four times the value; from 0 or -1 to 1 for numbers that are shares."""
        number, unit = quantity(self._draft.value(path)) or (0.0, "")
        share = not unit and abs(number) <= 1
        low = (-1.0 if name.endswith("start") else 0.0) if share else -1.0

        def text(position: float) -> str | float:
            value = rounded(position if share else number * 4**position)
            return f"{value:g} {unit}" if unit else value

        with ui.column().classes("gap-0").style("width:150px"):
            label = ui.label(f"{name.removeprefix('damper.')}: {written(self._draft.value(path))}").classes("text-xs")

            def move(event: GenericEventArguments) -> None:
                value = text(float(event.args))
                label.set_text(f"{name.removeprefix('damper.')}: {written(value)}")
                self._shown[1][name] = value
                self._draft.set_value(path, value)
                self._moved(path)

            slider = ui.slider(min=low, max=1.0, step=0.01, value=number if share else 0.0)
            slider.props(f'dense aria-label="{name}"')
            slider.on("update:model-value", move, throttle=0.03, leading_events=True)
