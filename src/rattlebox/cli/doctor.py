"""`rattlebox doctor`: versions, compiled core and packages."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version

from rich.table import Table
from rich.text import Text

from rattlebox import __version__
from rattlebox.cli.terminal import terminal
from rattlebox.core.choose import built, choice, core, supported

_PACKAGES = ("numpy", "scipy", "xarray", "h5netcdf", "h5py", "pydantic", "pint", "matplotlib")


def print_environment() -> None:
    """Print the versions, the processor cores, the compiled core in use and the installed packages."""
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
    for name in _PACKAGES:
        try:
            table.add_row(name, version(name))
        except PackageNotFoundError:
            table.add_row(name, Text.assemble(("missing", "bold"), f": python -m pip install {name}"))
    terminal().print(table)
