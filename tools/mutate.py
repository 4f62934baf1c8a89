"""Changes single operators and numbers of the package and prints the changes that no test notices: `make mutate`.

Needs the data of `make coverage`, which holds the lines that each test runs. Changes are drawn at random until the time is
over. A change is tested by the tests that run its line, quickest first, in a forked process that imports the changed module
instead of the file; no file is written. A survivor is a missing test or a change without an effect.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import os
import random
import signal
import time
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

# The libraries that the package needs are loaded once for all changes.
import pytest
import scipy.signal  # noqa: F401
import xarray  # noqa: F401
from coverage import CoverageData

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "rattlebox"
LONGEST = 15.0  # time of the tests of one change [s]
PAIRS = (
    *((ast.Lt, ast.LtE), (ast.Gt, ast.GtE), (ast.Eq, ast.NotEq), (ast.Is, ast.IsNot), (ast.In, ast.NotIn)),
    *((ast.And, ast.Or), (ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.Pow, ast.Mult), (ast.Mod, ast.FloorDiv)),
)
SWAPS: dict[type, type] = {new: old for old, new in PAIRS} | dict(PAIRS)


def changes(node: ast.AST) -> Iterator[tuple[int, Callable[[], None]]]:
    """Yield the line of each possible change and the function that makes it in place."""
    if isinstance(node, ast.Raise | ast.JoinedStr | ast.arg) or getattr(node, "arg", None) == "strict":
        return  # messages, types, and checks of zip
    for name in ("op", "ops"):
        value = getattr(node, name, None)
        first, *rest = value if isinstance(value, list) else [value]
        if type(first) in SWAPS and not any(isinstance(getattr(each, "value", None), str) for each in ast.walk(node)):
            new = SWAPS[type(first)]()
            yield node.lineno, partial(setattr, node, name, [new, *rest] if isinstance(value, list) else new)
    if isinstance(node, ast.Constant) and isinstance(node.value, bool | int | float):
        new = not node.value if isinstance(node.value, bool) else node.value + 1
        yield node.lineno, partial(setattr, node, "value", new)
    if isinstance(node, ast.If | ast.While | ast.IfExp) and "TYPE_CHECKING" not in ast.unparse(node.test):
        yield node.test.lineno, partial(setattr, node, "test", ast.UnaryOp(ast.Not(), node.test))
    for field, child in ast.iter_fields(node):
        if field not in ("returns", "annotation", "decorator_list"):
            for each in child if isinstance(child, list) else [child]:
                if isinstance(each, ast.AST):
                    yield from changes(each)


def outcome(path: Path, tree: ast.Module, tests: list[str]) -> str:
    """Run tests on a changed tree in a forked process; return "killed", "survived" or "too slow"."""
    child = os.fork()
    if child == 0:
        os.setsid()
        null = os.open(os.devnull, os.O_RDWR)
        for number in (0, 1, 2):
            os.dup2(null, number)
        code_of_file, changed = SourceFileLoader.get_code, compile(ast.fix_missing_locations(tree), path, "exec")
        SourceFileLoader.get_code = lambda self, name: changed if self.path == str(path) else code_of_file(self, name)
        code = 1
        with contextlib.suppress(BaseException):
            code = int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *tests]))
        os._exit(code)
    end = time.monotonic() + 8 * LONGEST
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return "survived" if status == 0 else "killed"
        time.sleep(0.02)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return "too slow"


def tests_of(data: CoverageData, seconds: dict[tuple[Any, ...], float], path: Path, line: int) -> list[str]:
    """Return the tests that run a line, quickest first, of LONGEST seconds together."""
    timed, total = [], 0.0
    # Examples in docstrings are left out: pytest itself loads the files that they are in.
    names = {name.rpartition("|")[0] for name in data.contexts_by_lineno(str(path)).get(line, ())}
    for name in (name for name in names if name.startswith("tests/")):
        file, _, test = name.partition("::")
        timed.append((seconds.get((file.removesuffix(".py").replace("/", "."), test), LONGEST), name))
    chosen = []
    for time_of_one, name in sorted(timed):
        total += time_of_one
        if total < LONGEST or not chosen:
            chosen.append(name)
    return chosen


def excerpt(line: str, other: str, reach: int = 80) -> str:
    """Return the part of a line around its first difference from another one; a table may be one line of a tree."""
    place = next((k for k, pair in enumerate(zip(line, other, strict=False)) if len({*pair}) > 1), 0)
    return line if len(line) <= 2 * reach else line[max(0, place - reach) : place + reach]


def main() -> None:
    """Test random changes for the given time; print the survivors and the number of each outcome."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("packages", nargs="*", default=["analysis", "results", "studies", "prepare"])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    os.chdir(ROOT)
    data = CoverageData("build/coverage")
    data.read()
    if not any(path.startswith(str(PACKAGE)) for path in data.measured_files()):
        raise SystemExit("build/coverage has no data of this package\n  try: make coverage")
    cases = ElementTree.parse("build/tests.xml").iter("testcase")
    seconds = {(case.get("classname"), case.get("name")): float(case.get("time", 0)) for case in cases}
    texts = {
        path: path.read_text("utf-8") for name in options.packages for path in sorted((PACKAGE / name).rglob("*.py"))
    }
    drawn = [(path, number) for path, text in texts.items() for number, _ in enumerate(changes(ast.parse(text)))]
    random.Random(options.seed).shuffle(drawn)
    counts: Counter[str] = Counter()
    sound: set[Path] = set()
    end = time.monotonic() + 60 * options.minutes
    for path, number in drawn:
        if time.monotonic() > end:
            break
        tree = ast.parse(texts[path])
        line, change = list(changes(tree))[number]
        before = ast.unparse(tree).splitlines()
        chosen = tests_of(data, seconds, path, line)
        if chosen and path not in sound:
            broken = ast.parse(f"{texts[path]}\nraise RuntimeError")
            if (outcome(path, tree, chosen), outcome(path, broken, chosen)) != ("survived", "killed"):
                print(
                    f"{path.relative_to(ROOT)}:{line}: its tests fail on the file as it is, or do not load it",
                    flush=True,
                )
                counts["whose tests fail without it"] += 1
                continue
            sound.add(path)
        change()
        result = outcome(path, tree, chosen) if chosen else "not run by a test"
        counts[result] += 1
        if result in ("survived", "not run by a test"):
            differ = [pair for pair in zip(before, ast.unparse(tree).splitlines(), strict=True) if len({*pair}) > 1]
            print(
                f"{path.relative_to(ROOT)}:{line} {result}",
                *(f"\n  - {excerpt(old, new)}\n  + {excerpt(new, old)}" for old, new in differ),
                flush=True,
            )
    total = ", ".join(f"{number} {result}" for result, number in counts.items())
    print(f"{sum(counts.values())} of {len(drawn)} changes: {total}")


if __name__ == "__main__":
    main()
