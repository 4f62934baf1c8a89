"""How to compute a result again: command, case file, study file and Python script."""

from __future__ import annotations

import pprint
import re
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rattlebox.model.case import Case

    from .parts import Call

_WIDTH = 96
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
    names = {name: _file_name(number, len(cases)) for number, name in enumerate(cases)}
    files = [File(names[name], case.to_toml(), case.short_toml()) for name, case in cases.items()]
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
