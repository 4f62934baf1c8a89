"""Count lines of code by folder, and list long files: python tools/code_size.py [--check].

Docstrings, comments and blank lines do not count. With --check, fail if a file of more than 500 lines is not listed with a
reason in docs/developing/code_size.md, or a listed file is shorter.
"""

from __future__ import annotations

import ast
import io
import re
import subprocess
import sys
import tokenize
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "developing" / "code_size.md"
LONG = 500
GENERATED = {"_core.pyi"}
_NO_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}


def python_lines(text: str) -> int:
    """Return the number of lines of Python code in a text."""
    docstrings: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            docstrings |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    code: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in _NO_CODE:
            code |= set(range(token.start[0], token.end[0] + 1))
    return len(code - docstrings)


def cpp_lines(text: str) -> int:
    """Return the number of lines of C++ code in a text."""
    text = re.sub(r"/\*.*?\*/", lambda match: "\n" * match[0].count("\n"), text, flags=re.DOTALL)
    return sum(bool(line.split("//")[0].strip()) for line in text.splitlines())


def sources() -> list[Path]:
    """Return the sources of the package and of the core that are part of the repository."""
    listed = subprocess.run(
        ["git", "ls-files", "src/rattlebox", "core"], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.split()
    paths = [Path(name) for name in listed]
    return [path for path in paths if path.suffix in (".py", ".hpp", ".h", ".cpp") and path.name not in GENERATED]


def main() -> int:
    """Print the counts; return 1 if the list of long files is not current."""
    by_folder: Counter[str] = Counter()
    long_files: dict[str, tuple[int, int]] = {}
    for path in sources():
        text = (ROOT / path).read_text(encoding="utf-8")
        lines = python_lines(text) if path.suffix == ".py" else cpp_lines(text)
        folder = path.parts[:3] if path.parts[0] == "src" else path.parts[:2]
        name = "/".join(folder if len(folder) < len(path.parts) else path.parts[: len(folder) - 1])
        by_folder[name] += lines
        total = len(text.splitlines())
        if total > LONG:
            long_files[str(path)] = total, lines
    if "--check" in sys.argv:
        shown = set(re.findall(r"^\| `((?:src|core)/\S+)` \| \d+ \(", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
        for name in sorted(long_files.keys() - shown):
            print(f"{name} has {long_files[name][0]} lines, but {PAGE.name} states no reason for it")
        for name in sorted(shown - long_files.keys()):
            print(f"{name} has at most {LONG} lines, but {PAGE.name} lists it")
        return int(long_files.keys() != shown)
    for name, count in sorted(by_folder.items()):
        print(f"{count:6d} {name}")
    for head in ("core", "src"):
        print(f"{sum(count for name, count in by_folder.items() if name.startswith(head)):6d} {head}")
    for name, (total, lines) in sorted(long_files.items(), key=lambda item: -item[1][0]):
        print(f"{total:6d} ({lines}) {name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
