"""The form of a case, generated from the JSON Schema of case files and the tables that are there."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import cache
from typing import Any

from nicegui import ui
from nicegui.elements.mixins.validation_element import ValidationElement

import rattlebox as rb

from .draft import Draft, Path_, dotted

Schema = dict[str, Any]

HIDDEN = {"kind", "file", "materials"}
"""Fields without an input of their own: the kind has a menu, and the others are for the text of the case."""


@cache
def schema() -> Schema:
    """Return the schema of case files."""
    return rb.Case.json_schema()


def variants(node: Schema) -> list[Schema]:
    """Return the alternatives of a field without references and null: tables, lists, numbers, texts."""
    if "$ref" in node:
        return variants(schema()["$defs"][node["$ref"].rpartition("/")[2]])
    for key in ("anyOf", "oneOf"):
        if key in node:
            inherited: Schema = {name: node[name] for name in ("description", "examples") if name in node}
            return [{**inherited, **found} for each in node[key] for found in variants(each)]
    return [] if node.get("type") == "null" else [node]


def tables(node: Schema) -> tuple[list[Schema], bool]:
    """Return the tables that a field accepts, and whether it accepts several in a list."""
    choices, several = [], False
    for variant in variants(node):
        if "properties" in variant:
            choices.append(variant)
        elif variant.get("type") == "array":
            inside = [part for part in variants(variant.get("items", {})) if "properties" in part]
            several = several or bool(inside)
    return choices, several


def kind_of(table: Schema) -> str:
    """Return the kind of a table; "" if it has none."""
    kind = table["properties"].get("kind", {})
    return str(kind.get("const") or kind.get("default") or "")


def helps(table: Schema) -> dict[str, str]:
    """Return the descriptions of the fields in the docstring of a table."""
    found: dict[str, str] = {}
    section = re.search(r"Parameters\n-+\n(.*?)(?:\n\n[A-Z]\w+\n-+\n|\Z)", table.get("description", ""), re.DOTALL)
    for names, text in re.findall(
        r"^(\w[\w, ]*)\n((?: {4}.*\n?|\n)+)", section[1] + "\n" if section else "", re.MULTILINE
    ):
        plain = " ".join(text.split())
        found |= {name.strip(): plain for name in names.split(",")}
    return found


def fields(table: Schema, given: object) -> list[tuple[str, Schema, bool]]:
    """Return name, schema and whether it is shown at once, of the fields of a table; of synonyms only one."""
    # Synonyms, such as damper and dampers, share their title; the one that is set is shown.
    by_title: dict[str, list[str]] = {}
    for name, node in table["properties"].items():
        if name not in HIDDEN:
            by_title.setdefault(node.get("title", name), []).append(name)
    needed = set(table.get("required", ()))
    result = []
    for names in by_title.values():
        present = [name for name in names if isinstance(given, dict) and name in given]
        name = (present or names)[-1]
        result.append((name, table["properties"][name], bool(present) or name in needed))
    return sorted(result, key=lambda entry: not entry[2])


def parse(text: str) -> object:
    """Return the value that a user typed: a number, a list, true or false, else text; None for nothing."""
    text = text.strip()
    if not text:
        return None
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        return text
    return value if isinstance(value, (int, float, list, bool)) else text


def written(value: object) -> str:
    """Return a value as a user types it."""
    return value if isinstance(value, str) else "" if value is None else json.dumps(value)


class Form:
    """Inputs for all fields of a case, each with its error; `changed` is called after each change."""

    def __init__(self, draft: Draft, changed: Callable[[], object]) -> None:
        self._draft, self._changed = draft, changed
        self._inputs: dict[str, ValidationElement[Any]] = {}
        self._labels: dict[str, ui.label] = {}
        self.box = ui.column().classes("w-full gap-1")
        self.follow_case()

    def follow_case(self) -> None:
        """Build all inputs again, after the text of the case was changed."""
        self._inputs.clear()
        self._labels.clear()
        self.box.clear()
        with self.box:
            self._error_label("")
            self._table(schema(), (), self._draft.given)

    def show_value(self, path: Path_) -> None:
        """Show the value of the case in the input of a path."""
        element = self._inputs.get(dotted(path))
        if element is not None:
            self._silent = True
            element.set_value(written(self._draft.value(path)))
            self._silent = False

    _silent = False

    def show_errors(self) -> None:
        """Show each error at the nearest input, and remove those that are gone."""
        errors = dict(self._draft.errors)
        for name, element in self._inputs.items():
            element.error = errors.pop(name, "").replace("\n", "; ") or None
        for label in self._labels.values():
            label.set_text("")
        for name, message in errors.items():
            # An error inside of a table that has no input of its own is shown at the table.
            holder = name
            while holder and holder not in self._labels:
                holder = holder.rpartition("." if holder.rfind(".") > holder.rfind("[") else "[")[0]
            where = name.removeprefix(holder).lstrip(".")
            text = f"{where}: {message}" if where else message
            label = self._labels[holder if holder in self._labels else ""]
            label.set_text("\n".join(filter(None, [label.text, text])))

    def _set(self, path: Path_, value: object, *, rebuild: bool = False) -> None:
        if self._silent:
            return
        self._draft.set_value(path, value)
        if rebuild:
            self.follow_case()
        self._changed()

    def _error_label(self, name: str) -> None:
        self._labels[name] = ui.label("").classes("text-red-700 text-sm whitespace-pre-wrap")

    def _table(self, table: Schema, path: Path_, given: object) -> None:
        texts, rest = helps(table), []
        for name, node, shown in fields(table, given):
            if shown:
                self._field(name, node, (*path, name), texts.get(name, ""))
            else:
                rest.append((name, node))
        if rest:
            with ui.expansion("more").classes("w-full text-sm").props("dense") as more:
                box = ui.column().classes("w-full gap-1")

            def fill() -> None:
                if more.value and not box.default_slot.children:
                    with box:
                        for name, node in rest:
                            self._field(name, node, (*path, name), texts.get(name, ""))

            more.on_value_change(fill)

    def _field(self, name: str, node: Schema, path: Path_, text: str) -> None:
        choices, several = tables(node)
        value = self._draft.value(path)
        if not choices or (value is not None and not isinstance(value, (dict, list))):
            self._input(name, node, path, text)
            return
        with ui.card().classes("w-full p-2 gap-1").props("flat bordered"):
            with ui.row().classes("w-full items-center no-wrap"):
                ui.label(name.replace("_", " ")).classes("font-semibold")
                if text:
                    ui.icon("help_outline").classes("text-gray-500").props["title"] = text
                ui.space()
                if several or value is None:
                    self._add_button(choices, path, value, several)
            self._error_label(dotted(path))
            items = list(enumerate(value)) if isinstance(value, list) else [] if value is None else [(None, value)]
            for number, item in items:
                where = path if number is None else (*path, number)
                self._item(choices, where, item)

    def _add_button(self, choices: list[Schema], path: Path_, value: object, several: bool) -> None:
        def add(kind: str) -> None:
            item = {"kind": kind} if kind else {}
            if value is None:
                self._set(path, item, rebuild=True)
            else:
                self._set(path, [*(value if isinstance(value, list) else [value]), item], rebuild=True)

        kinds = [kind_of(choice) for choice in choices]
        if len(kinds) == 1:
            ui.button(icon="add", on_click=lambda: add(kinds[0])).props('flat dense size=sm aria-label="add"')
            return
        with ui.button(icon="add").props('flat dense size=sm aria-label="add"'), ui.menu():
            for kind in kinds:
                ui.menu_item(kind.replace("_", " "), on_click=lambda kind=kind: add(kind))

    def _item(self, choices: list[Schema], path: Path_, item: object) -> None:
        if not isinstance(item, dict):
            return
        kinds = {kind_of(choice): choice for choice in choices}
        kind = item.get("kind") or self._likely_kind(kinds, item)
        with ui.row().classes("w-full items-center no-wrap"):
            if len(kinds) > 1:
                change = ui.select(list(kinds), value=kind if kind in kinds else None, label="kind").classes("grow")
                change.props("dense options-dense")
                change.on_value_change(lambda event: self._set_kind(path, item, kinds[event.value], event.value))
                self._inputs[dotted((*path, "kind"))] = change.without_auto_validation()
            if len(path) > 1 or path[0] != "structure":
                remove = ui.button(icon="delete", on_click=lambda: self._set(path, None, rebuild=True))
                remove.props('flat dense size=sm aria-label="remove"')
        if isinstance(path[-1], int):
            self._error_label(dotted(path))
        if kind in kinds:
            self._table(kinds[kind], path, item)

    def _likely_kind(self, kinds: dict[str, Schema], item: dict[str, Any]) -> str:
        """Return the kind that has most of the fields of a table without a kind."""
        return max(kinds, key=lambda kind: len(item.keys() & kinds[kind]["properties"].keys()))

    def _set_kind(self, path: Path_, item: dict[str, Any], table: Schema, kind: str) -> None:
        """Change the kind of a table; fields that the new kind lacks are removed."""
        kept = {name: value for name, value in item.items() if name in table["properties"]}
        self._set(path, {**kept, "kind": kind}, rebuild=True)

    def _input(self, name: str, node: Schema, path: Path_, text: str) -> None:
        value, label, allowed = self._draft.value(path), name.replace("_", " "), variants(node)
        choices = [each.get("const", option) for each in allowed for option in each.get("enum", [None])]
        choices = [choice for choice in choices if choice is not None]
        element: Any
        if any(each.get("type") == "boolean" for each in allowed):
            default = node.get("default", False)
            element = ui.switch(label, value=bool(default if value is None else value))
            element.on_value_change(lambda event: self._set(path, bool(event.value)))
        elif choices and len(choices) >= len(allowed) and (value is None or value in choices):
            element = ui.select(choices, value=value, label=label, clearable=True).props("dense options-dense")
            element.on_value_change(lambda event: self._set(path, event.value))
            self._inputs[dotted(path)] = element.without_auto_validation()
        else:
            about = next((each["description"] for each in (node, *allowed) if "description" in each), "")
            about = "" if about.startswith(tuple("ABCDEFGHIJKLMNOPQRSTUVWXYZ")) else about
            example = next((each["examples"][0] for each in (node, *allowed) if each.get("examples")), None)
            names = list(rb.materials()) if name == "material" else choices
            default = node.get("default")
            hint = f"for example {written(example)}" if example else ""
            hint = hint if default in (None, [], "") else written(default)
            element = ui.input(
                label, value=written(value), placeholder=hint, autocomplete=[str(each) for each in names]
            )
            element.props("dense debounce=150 stack-label hide-bottom-space")
            element.on_value_change(lambda event: self._set(path, parse(event.value or "")))
            self._inputs[dotted(path)] = element.without_auto_validation()
            text = text or about
        element.classes("w-full")
        if text:
            element.props["title"] = text
