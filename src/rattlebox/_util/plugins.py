"""Packages outside of Rattlebox that add kinds of parts, readers, studies, figures and commands."""

from __future__ import annotations

from functools import cache
from importlib.metadata import entry_points

from .exceptions import ResourceError

GROUP = "rattlebox.plugins"
"""Group of entry points; each names a module that registers its classes and functions when it is imported."""


@cache
def load_plugins() -> None:
    """Import the modules that installed packages name as plug-ins, once."""
    for point in entry_points(group=GROUP):
        try:
            point.load()
        except Exception as error:  # whatever code of others raises
            package = point.dist.name if point.dist else "unknown"
            raise ResourceError(
                f"the plug-in {point.name} of the package {package} cannot be imported: {type(error).__name__}: {error}",
                f"pip uninstall {package}, or a version of it for this version of Rattlebox",
            ) from error
