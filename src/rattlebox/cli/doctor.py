"""`rattlebox doctor`: versions, compiled core and libraries."""

from __future__ import annotations

import os
import platform
import re
from collections import Counter
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version

from rich.table import Table
from rich.text import Text

from rattlebox import __version__
from rattlebox._util.plugins import plugins
from rattlebox.cli.terminal import terminal
from rattlebox.core.choose import built, choice, core, supported

_FOR_DEVELOPERS = ("dev", "docs")
"""Extras whose libraries are not listed."""


def print_environment() -> None:
    """Print the versions, the processor cores, the compiled core in use, and the required and optional libraries."""
    level, reason = choice()
    table = Table(show_header=False, box=None)
    table.add_row("rattlebox", __version__)
    table.add_row("python", f"{platform.python_version()} on {platform.system()} {platform.machine()}")
    table.add_row("cores", str(os.cpu_count()))
    table.add_row("core", f"{level}: {reason}")
    table.add_row(
        "", f"built: {', '.join(built())}; runnable here: {', '.join(supported())}; RATTLEBOX_SIMD selects another"
    )
    table.add_row("", f"loaded from {core().__name__}")
    for name, extra in _libraries():
        try:
            table.add_row(name, f"{version(name)}{f' (optional, {extra})' * bool(extra)}")
        except PackageNotFoundError:
            state, package = ("not installed", f"'rattlebox[{extra}]'") if extra else ("missing", name)
            table.add_row(name, Text.assemble((state, "" if extra else "bold"), f": python -m pip install {package}"))
    for plugin in plugins():
        state = f"cannot be imported: {plugin.problem}" if plugin.problem else f"plug-in {plugin.name}"
        table.add_row(plugin.package, f"{plugin.version} ({state})")
    terminal().print(table)


def _libraries() -> Iterator[tuple[str, str]]:
    """Yield the name of each required and optional library, and the extra that installs it, "" if it is required.

    If several extras install a library, that with the fewest libraries is named.
    """
    extras: dict[str, list[str]] = {}
    for line in requires("rattlebox") or ():
        name, extra = re.match(r"[\w.-]+", line), re.search(r"extra == [\"'](.+?)[\"']", line)
        if name and not (extra and extra[1] in _FOR_DEVELOPERS):
            extras.setdefault(name[0], []).append(extra[1] if extra else "")
    sizes = Counter(extra for names in extras.values() for extra in names)
    for library, names in extras.items():
        yield library, "" if "" in names else min(names, key=lambda extra: sizes[extra])
