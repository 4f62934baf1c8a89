"""The case that a page edits: its text, its tables and its errors."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import tomli_w

import rattlebox as rb

MOST_CHARACTERS = 400_000
DEEPEST = 20
TEMPLATES = {
    "struck": "Struck structure with a ball",
    "steel_ball": "Ball of the reference paper",
    "row": "Row of three balls",
    "box": "Shaken box of balls",
    "boring_bar": "Boring bar",
    "panel": "Panel in random vibration",
    "building": "Building on moving ground",
}
"""Titles of the templates, by the name of their file."""
FIRST = "struck"
"""Template of a new page."""

Path_ = tuple[str | int, ...]

FAILURES = (rb.RattleboxError, OSError, ValueError, ArithmeticError, MemoryError, RecursionError)
"""Errors of cases and files of others."""


def said(error: BaseException) -> str:
    """Return the text of one of `FAILURES`."""
    if isinstance(error, MemoryError):
        return str(rb.ResourceError("the memory is exhausted", "a shorter or smaller case"))
    return "nested too deep" if isinstance(error, RecursionError) else str(error)


class Draft:
    """Case that a page edits, also while it is not valid."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.case: rb.Case | None = None
        self.errors: dict[str, str] = {}
        self.given: dict[str, Any] = {}
        self.set_text(template(FIRST))

    def set_text(self, text: str) -> None:
        """Replace the whole case by the text of a case file."""
        self.text, self.is_toml = text, False
        try:
            if len(text) > MOST_CHARACTERS:
                raise rb.CaseError(
                    f"the text has {len(text)} characters, more than {MOST_CHARACTERS}",
                    "records and tables in files of their own",
                )
            if _has_long_key(text):  # for which tomllib needs a time that grows with the square of its length
                raise rb.CaseError(f"the tables are nested deeper than {DEEPEST}", "fewer tables within each other")
            given = tomllib.loads(text)
            if _depth(given) > DEEPEST:
                raise rb.CaseError(f"the tables are nested deeper than {DEEPEST}", "fewer tables within each other")
        except rb.CaseError as error:
            self._invalid({"": str(error)})
        except ValueError as error:  # also numbers of thousands of digits
            self._invalid({"": f"the text is not TOML: {error}"})
        except RecursionError:
            self._invalid({"": f"the tables are nested deeper than {DEEPEST}"})
        else:
            self.given, self.is_toml = given, True
            self._check()

    def value(self, path: Path_) -> Any:
        """Return the value at a path; None if there is none."""
        node: Any = self.given
        for part in path:
            try:
                node = node[part]
            except (KeyError, IndexError, TypeError):
                return None
        return node

    def set_value(self, path: Path_, value: object) -> None:
        """Set the value at a path; None removes it. The text is written anew, without its comments."""
        if not self.is_toml:  # a change of older tables would replace the text that the user is writing
            return
        node: Any = self.given
        for part in path[:-1]:
            node = node.setdefault(part, {}) if isinstance(node, dict) else node[part]
        if value is None:
            if not isinstance(node, dict) or path[-1] in node:
                del node[path[-1]]
        elif isinstance(node, list) and path[-1] == len(node):
            node.append(value)
        else:
            node[path[-1]] = value
        self.text = tomli_w.dumps(self.given)
        self._check()

    def _check(self) -> None:
        try:
            outside(self.given, self.folder)
            self.case, self.errors = rb.Case.from_dict(self.given, folder=self.folder), {}
        except rb.RattleboxError as error:
            self._invalid(by_field(str(error)))
        except FAILURES as error:
            self._invalid({"": f"the case cannot be read: {said(error)}"})

    def _invalid(self, errors: dict[str, str]) -> None:
        self.case, self.errors = None, errors


def template(name: str) -> str:
    """Return the case file of a template."""
    return (files("rattlebox.app") / "templates" / f"{name}.toml").read_text(encoding="utf-8")


def by_field(message: str) -> dict[str, str]:
    """Return the parts of a message about a case by their fields; "" has those without one."""
    errors: dict[str, str] = {}
    field = ""
    for line in message.splitlines():
        if not line.startswith("  "):
            head = re.match(r"case: ([\w.\[\]]+)(?: = .*)?$", line)
            field = head[1] if head else ""
            text = "" if head else line.removeprefix("case: ").removeprefix("case:")
        else:
            text = line.strip()
        if text:
            errors[field] = f"{errors[field]}\n{text}" if field in errors else text
    return errors


def outside(node: object, folder: Path) -> None:
    """Raise if a case names a file that is not in the folder."""
    for file in _named_files(node):
        if not (folder / file).resolve().is_relative_to(folder.resolve()):
            raise rb.CaseError(f"case: the file {file!r} is outside of the folder of this page", f"a copy in {folder}")


def _named_files(node: object, is_file: bool = False) -> list[str]:
    if isinstance(node, str):
        return [node] if is_file else []
    if isinstance(node, dict):
        return [file for key, item in node.items() for file in _named_files(item, is_file or key == "file")]
    return [file for item in node for file in _named_files(item, is_file)] if isinstance(node, list) else []


def _has_long_key(text: str) -> bool:
    """Return whether a key has more than `DEEPEST` parts; not exact for dots in texts over several lines."""
    for line in text.split("\n"):
        bare = re.sub(r"""\"[^"]*"|'[^']*'""", "q", line).partition("#")[0] if line.count(".") > DEEPEST else ""
        if any(part.count(".") > DEEPEST for part in re.split(r"[,=\[\]{}]", bare)):
            return True
    return False


def _depth(node: Any) -> int:
    """Return the depth of nested tables and lists, without recursion."""
    # Level by level: a recursion would itself be too deep for what is to be refused.
    level, deepest = [node], 0
    while level:
        deepest += 1
        level = [
            item
            for parent in level
            for item in (parent.values() if isinstance(parent, dict) else parent)
            if isinstance(item, (dict, list))
        ]
    return deepest


_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s].*)?$")


def quantity(value: object) -> tuple[float, str] | None:
    """Return number and unit of a value such as "0.4 mm" or 0.5; None if it is something else."""
    if isinstance(value, bool):
        return None
    if isinstance(value, (int, float)):
        return float(value), ""
    match = _QUANTITY.match(value) if isinstance(value, str) else None
    return (float(match[1]), (match[2] or "").strip()) if match else None


def rounded(value: float) -> float:
    """Return a value with four significant digits."""
    return float(f"{value:.4g}")


def numeric_paths(node: object, above: Path_ = ()) -> list[Path_]:
    """Return the paths of all single numbers with or without a unit in the tables of a case."""
    if isinstance(node, (dict, list)):
        items: Sequence[tuple[str | int, object]] = list(node.items() if isinstance(node, dict) else enumerate(node))
        if isinstance(node, list) and not all(isinstance(item, dict) for item in node):
            return []
        return [path for key, item in items for path in numeric_paths(item, (*above, key))]
    return [above] if above and quantity(node) is not None else []


def leaves(toml: str) -> dict[str, object]:
    """Return all single values and lists of a case file by path, but for the descriptions of materials."""
    values: dict[str, object] = {}

    def walk(node: object, path: Path_) -> None:
        if isinstance(node, dict):
            for key, item in node.items():
                walk(item, (*path, key))
        elif isinstance(node, list) and any(isinstance(item, dict) for item in node):
            for number, item in enumerate(node):
                walk(item, (*path, number))
        elif path[-1] not in ("title", "source"):
            values[dotted(path)] = node

    walk(tomllib.loads(toml), ())
    return values


def short(value: object) -> str:
    """Return a value of a case file as text of at most 30 characters."""
    if isinstance(value, list):
        return ", ".join(map(short, value)) if len(value) < 4 else f"{len(value)} values"
    number = quantity(value)
    text = f"{number[0]:.6g} {number[1]}".strip() if number else str(value)
    return text if len(text) <= 30 else f"{text[:27]}..."


def dotted(path: Path_) -> str:
    """Return a path in the notation of case files: "dampers[0].gap"."""
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path).removeprefix(".")


def python_script(toml: str, task: str = "") -> str:
    """Return a Python script that computes a case, or a task with it, again."""
    quoted = toml.replace("\\", "\\\\").replace('"""', '\\"\\"\\"').removesuffix("\n") + "\n"
    quoted = re.sub(r"[\x00-\x08\x0b-\x1f\x7f\ud800-\udfff]", lambda match: f"\\u{ord(match[0]):04x}", quoted)
    body = task or 'run = rb.simulate(case)\nprint(run.summary())\nrun.plot.motion().savefig("motion.png")\n'
    return f'import rattlebox as rb\n\ncase = rb.Case.from_toml("""\n{quoted}""")\n{body}'
