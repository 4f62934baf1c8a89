"""How to compute a result again: command, case file, study file and Python script."""

from __future__ import annotations

import os
import pprint
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from rattlebox._util.phrases import joined
from rattlebox.model.case_tree import with_files

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from rattlebox.model.case import Case

    from .parts import Call

_WIDTH = 96
_MOST_NAMES = 6
"""Most files that are named in a sentence."""
_LIST = re.compile(r"\[\n((?: +[^\[\]{}\n]+,\n)+)\]")


class File(NamedTuple):
    """A text file that the page contains for download."""

    name: str
    content: str
    shown: str


class Recipe(NamedTuple):
    """How to compute a result again."""

    commands: tuple[str, ...]
    files: tuple[File, ...]
    remarks: tuple[str, ...] = ()


def recipe(cases: Mapping[str, Case], call: Call | None) -> Recipe:
    """Return commands and files that compute a result again."""
    arguments = {} if call is None else _without_none(dict(call.arguments))
    # The names of files, not their full paths: these belong to the computer of the author.
    read: dict[str, str] = {}
    for case in cases.values():
        case.to_toml(lambda file: read.setdefault(file, file))
    with_files(arguments, lambda file: read.setdefault(file, file))
    name_of = short_names(read).__getitem__
    names = {name: _file_name(number, len(cases)) for number, name in enumerate(cases)}
    files = [File(names[name], case.to_toml(name_of), case.short_toml(name_of=name_of)) for name, case in cases.items()]
    found = _steps(names, files, call and call._replace(arguments=with_files(arguments, name_of)))
    return found._replace(remarks=(*found.remarks, *_about_files([name_of(file) for file in read])))


def short_names(files: Collection[str]) -> dict[str, str]:
    """Return the paths of files relative to the folder that holds all of them; relative paths stay as they are."""
    full = [file for file in files if os.path.isabs(file)]
    try:
        folder = os.path.commonpath([os.path.dirname(file) for file in full]) if full else ""
    except ValueError:  # several drives
        return {file: Path(file).name for file in files}
    return {file: Path(os.path.relpath(file, folder)).as_posix() if file in full else file for file in files}


def _about_files(names: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the files that the case and the study read."""
    if names:
        listed = joined(names) if len(names) <= _MOST_NAMES else f"the {len(names)} files that they name"
        yield f"The page does not contain the numbers of files: put {listed} into the same folder."


def _without_none(node: Any) -> Any:
    """Return a copy of a tree without fields that have no value, which TOML cannot write."""
    if isinstance(node, dict):
        return {key: _without_none(item) for key, item in node.items() if item is not None}
    return [_without_none(item) for item in node] if isinstance(node, list) else node


def _steps(names: Mapping[str, str], files: list[File], call: Call | None) -> Recipe:
    """Return commands and files of a call."""
    if call is None:
        return Recipe((), tuple(files), ("The call of the study is not part of its result.",) if files else ())
    # A comparison is no single call: its cases run one by one, and a script compares them.
    if call.function == "compare":
        script = _comparison_script(names, call.arguments)
        commands = tuple(f"rattlebox run {file} -o {file.removesuffix('.toml')}" for file in names.values())
        return Recipe((*commands, "python script.py"), (*files, File("script.py", script, script)))
    # Several cases of one call are the best designs, each of which can begin the search.
    first = next(iter(names.values()), "")
    script = _script(call, first)
    files.append(File("script.py", script, script))
    if call.function == "simulate":
        start = f" --start {call.arguments['start']}" if "start" in call.arguments else ""
        return Recipe((f"rattlebox run {first}{start} -o out", "python script.py"), tuple(files), call.remarks)
    more: list[str] = []
    if call.kind and not call.remarks:
        study = _study_file(call, first)
        files.append(File("study.toml", study, study))
        more.append("rattlebox sweep study.toml -o study")
    return Recipe((*more, "python script.py"), tuple(files), call.remarks)


def _file_name(number: int, count: int) -> str:
    return "case.toml" if count == 1 else f"case_{number + 1}.toml"


def _script(call: Call, case: str) -> str:
    lines = ["import rattlebox as rb", ""]
    positional = [call.first] if call.first else []
    if case:
        lines.append(f'case = rb.Case.from_file("{case}")')
        positional.append(call.case)
    named = "".join(f"\n    {name}={_literal(value)}," for name, value in call.arguments.items())
    arguments = ", ".join(positional)
    if named or call.first:
        arguments = "".join(f"\n    {each}," for each in positional) + named + "\n"
    lines += [*(f"# {remark}" for remark in call.remarks), f"result = rb.{call.function}({arguments})"]
    return "\n".join([*lines, 'rb.write_report(result, "report.html")', ""])


def _literal(value: object) -> str:
    return pprint.pformat(value, width=_WIDTH, compact=True, sort_dicts=False).replace("\n", "\n    ")


def _comparison_script(names: Mapping[str, str], options: Mapping[str, Any]) -> str:
    given = "".join(f"    {name}={value!r},\n" for name, value in options.items())
    cases = "".join(f"\n        {name!r}: rb.Case.from_file({file!r})," for name, file in names.items())
    return (
        f"import rattlebox as rb\n\nresult = rb.compare(\n    {{{cases}\n    }}{',' * bool(given)}\n{given})\n"
        'rb.write_report(result, "report.html")\n'
    )


def _study_file(call: Call, case: str) -> str:
    import tomli_w

    text = tomli_w.dumps({"kind": call.kind, **call.arguments, **call.study, "case": {"file": case}})
    # Lists of plain values on one line each.
    return _LIST.sub(lambda match: "[" + ", ".join(part.strip() for part in match[1].split(",\n") if part) + "]", text)
