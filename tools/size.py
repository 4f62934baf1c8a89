"""Print the size and shape of the package: lines by room, long functions, `Any`, ladders over kinds, import cycles.

The numbers are for readers of a pull request. None of them fails a build: a line that explains is not too many.
"""

from __future__ import annotations

import ast
import io
import sys
import tokenize
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[1] / "src" / "rattlebox"
LONG = 60  # lines of a function without its docstring

Function = ast.FunctionDef | ast.AsyncFunctionDef
Documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


@dataclass
class Source:
    """A file of the package."""

    path: Path
    tree: ast.Module
    code: int
    docstrings: int
    comments: int

    @property
    def room(self) -> str:
        """Name of the package below rattlebox; "." for its top."""
        parts = self.path.relative_to(ROOT).parts
        return parts[0] if len(parts) > 1 else "."

    @property
    def module(self) -> str:
        """Dotted name."""
        parts = self.path.relative_to(ROOT.parent).with_suffix("").parts
        return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@dataclass
class Imports:
    """Imports of modules of the package: at run time, also inside functions, and of types only."""

    runtime: dict[str, set[str]] = field(default_factory=lambda: defaultdict(set))
    typing: dict[str, set[str]] = field(default_factory=lambda: defaultdict(set))


def docstring(node: Documented) -> ast.Expr | None:
    """Return the docstring of a node."""
    first = node.body[0] if node.body else None
    is_text = (
        isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str)
    )
    return first if is_text and isinstance(first, ast.Expr) else None


def lines_of(node: ast.Expr | None) -> range:
    """Return the numbers of the lines of a docstring."""
    return range(0) if node is None else range(node.lineno, (node.end_lineno or node.lineno) + 1)


def read(path: Path) -> Source:
    """Read a file and count its lines; a line with code and a comment counts as both."""
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    documented = {line for node in ast.walk(tree) if isinstance(node, Documented) for line in lines_of(docstring(node))}
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    comments = {token.start[0] for token in tokens if token.type == tokenize.COMMENT}
    code = sum(
        bool(line.strip()) and not line.lstrip().startswith("#") and number not in documented
        for number, line in enumerate(text.splitlines(), start=1)
    )
    return Source(path, tree, code, len(documented), len(comments))


def long_functions(sources: list[Source]) -> Iterator[tuple[int, str]]:
    """Yield the length and the name of each long function."""
    for source in sources:
        for node in ast.walk(source.tree):
            if isinstance(node, Function):
                length = (node.end_lineno or node.lineno) - node.lineno + 1 - len(lines_of(docstring(node)))
                if length > LONG:
                    yield length, f"{source.module}.{node.name}"


def uses_of_any(source: Source) -> int:
    """Return how often the annotation Any is written."""
    return sum(isinstance(node, ast.Name) and node.id == "Any" for node in ast.walk(source.tree))


def kinds(sources: list[Source]) -> set[str]:
    """Return the names of the classes of the model that are kinds: with a fixed field `kind`, or below a registry."""
    fixed: set[str] = set()
    registries: set[str] = set()
    above: dict[str, set[str]] = {}
    for source in sources:
        if source.room != "model":
            continue
        for node in ast.walk(source.tree):
            if isinstance(node, ast.ClassDef):
                above[node.name] = {getattr(base, "id", getattr(base, "attr", "")) for base in node.bases}
                for each in node.body:
                    if isinstance(each, ast.AnnAssign) and each.value is not None:
                        name = getattr(each.target, "id", "")
                        fixed |= {node.name} if name == "kind" else set()
                        registries |= {node.name} if name == "kinds" else set()
    found = fixed | registries
    while more := {name for name, names in above.items() if names & found} - found:
        found |= more
    return found - registries


def ladders(sources: list[Source]) -> Iterator[tuple[str, str]]:
    """Yield the place and the class of each test of a kind outside of the model."""
    known = kinds(sources)  # a class of results may have the name of one of them
    for source in sources:
        if source.room == "model":
            continue
        imported = {
            alias.asname or alias.name
            for node in ast.walk(source.tree)
            if isinstance(node, ast.ImportFrom) and "model" in (node.module or "").split(".")
            for alias in node.names
        }
        for node in ast.walk(source.tree):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "isinstance" and len(node.args) == 2:
                names = {getattr(each, "id", getattr(each, "attr", "")) for each in ast.walk(node.args[1])}
                for name in sorted(names & known & imported):
                    yield f"{source.path.relative_to(ROOT)}:{node.lineno}", name


def imports(sources: list[Source]) -> Imports:
    """Return the imports of the modules of the package."""
    modules = {source.module for source in sources}
    found = Imports()
    for source in sources:
        package = source.module if source.path.name == "__init__.py" else source.module.rpartition(".")[0]
        only_types = {
            id(child)
            for node in ast.walk(source.tree)
            if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)
            for statement in node.body
            for child in ast.walk(statement)
        }
        for node in ast.walk(source.tree):
            edges = found.typing if id(node) in only_types else found.runtime
            for name in _imported(node, package):
                target = name if name in modules else name.rpartition(".")[0]
                if target in modules and target != source.module:
                    edges[source.module].add(target)
    return found


def _imported(node: ast.AST, package: str) -> Iterator[str]:
    """Yield the names that a statement imports, as if each were a module."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    if isinstance(node, ast.ImportFrom):
        above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
        base = ".".join([*above, *([node.module] if node.module else [])])
        yield from (f"{base}.{alias.name}" for alias in node.names)


def cycles(edges: dict[str, set[str]]) -> list[list[str]]:
    """Return the groups of modules that import each other, by Tarjan's algorithm."""
    number: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    groups: list[list[str]] = []

    def visit(node: str) -> None:
        number[node] = lowest[node] = len(number)
        stack.append(node)
        for other in edges.get(node, ()):
            if other not in number:
                visit(other)
            if other in stack:
                lowest[node] = min(lowest[node], lowest[other])
        if lowest[node] == number[node]:
            place = stack.index(node)
            group = stack[place:]
            del stack[place:]
            if len(group) > 1:
                groups.append(sorted(group))

    for node in list(edges):
        if node not in number:
            visit(node)
    return groups


def main() -> None:
    """Print all numbers."""
    sys.setrecursionlimit(10_000)
    sources = [read(path) for path in sorted(ROOT.rglob("*.py"))]
    total: Counter[str] = Counter()
    rooms: dict[str, Counter[str]] = defaultdict(Counter)
    for source in sources:
        row = {
            "files": 1,
            "code": source.code,
            "docstrings": source.docstrings,
            "comments": source.comments,
            "Any": uses_of_any(source),
        }
        rooms[source.room].update(row)
        total.update(row)
    print(f"{'room':12}{'files':>7}{'code':>8}{'docstrings':>12}{'comments':>10}{'Any per 1000':>14}")
    for name, row in [*sorted(rooms.items()), ("all", total)]:
        share = 1000 * row["Any"] / row["code"]
        print(f"{name:12}{row['files']:7}{row['code']:8}{row['docstrings']:12}{row['comments']:10}{share:14.1f}")
    long = sorted(long_functions(sources), reverse=True)
    print(f"\nfunctions over {LONG} lines without docstring: {len(long)}")
    for length, name in long:
        print(f"  {length:4} {name}")
    tests = list(ladders(sources))
    print(f"isinstance over kinds of the model outside of it: {len(tests)}")
    for place, name in tests:
        print(f"  {place} {name}")
    edges = imports(sources)
    both = {name: edges.runtime[name] | edges.typing[name] for name in {*edges.runtime, *edges.typing}}
    for label, graph in (("", edges.runtime), (", with imports of types only", both)):
        groups = cycles(graph)
        print(f"import cycles{label}: {len(groups)}")
        for group in groups:
            print(f"  {' '.join(name.removeprefix('rattlebox.') for name in group)}")
    print(f"files in studies/: {rooms['studies']['files']}")


if __name__ == "__main__":
    main()
