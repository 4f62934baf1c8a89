"""Packages outside of Rattlebox that add kinds of parts, readers, materials, measures, studies, figures and commands.

A package names its modules as entry points of the group `rattlebox.plugins`. They are imported before the first case or
study is read, and what they define is added to the registry of its concept. Each registry is asked by files, command line,
reports and messages, and refuses a second thing of a name.
"""

from __future__ import annotations

import warnings
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pkgutil import resolve_name
from typing import Any, NamedTuple, TypeVar

from .exceptions import ResourceError, message

GROUP = "rattlebox.plugins"
"""Group of entry points; each names a module that registers its classes and functions when it is imported."""

OWN = "rattlebox"
"""Owner of what this package defines."""

Thing = TypeVar("Thing")


class NameTaken(ResourceError, TypeError):
    """Two packages give the same name to two things of one concept."""


class PluginWarning(UserWarning):
    """A plug-in cannot be imported; what it would add is missing."""


class Plugin(NamedTuple):
    """An entry point of an installed package, and why it could not be imported, if so."""

    name: str
    package: str
    version: str
    problem: str


class Registry(dict[str, Thing]):
    """Things of one concept by name, such as the figures of runs."""

    def __init__(self, concept: str) -> None:
        super().__init__()
        self.concept = concept
        self._owners: dict[str, str] = {}

    def add(self, name: str, thing: Thing, owner: str) -> None:
        """Add a thing that a module defines; raise if another one has the name already.

        A thing with the same owner, "module.name", replaces the former one: a notebook defines its classes again and again.
        """
        self.reserve(name, owner)
        self[name] = thing

    def reserve(self, name: str, owner: str) -> None:
        """Reserve a name for a thing that is not in this registry, such as a measure of the core."""
        known = self._owners.setdefault(name, owner)
        if known != owner:
            raise taken(self.concept, name, *((owner, known) if owner == OWN else (known, owner)))


def owner_of(thing: type | object) -> str:
    """Return the module and the name of a class or function."""
    return f"{getattr(thing, '__module__', '')}.{getattr(thing, '__qualname__', type(thing).__qualname__)}"


def taken(concept: str, name: str, known: str, new: str) -> NameTaken:
    """Return the error about a second thing of a name."""
    return NameTaken(
        f"{new}: the {concept} {name!r} is that of {known}",
        f"another name; or, if these are packages of others, pip uninstall {new.partition('.')[0]}",
    )


def named_object(reference: str, needed_by: str) -> Any:
    """Return what "module:name" stands for, imported when it is needed, such as the figure of a kind of study."""
    try:
        return resolve_name(reference)
    except (ImportError, AttributeError, ValueError) as error:
        raise ResourceError(
            f"{needed_by} names {reference!r}, which cannot be imported: {error}", 'a text "package.module:name"'
        ) from error


def load_plugins() -> None:
    """Import the modules that installed packages name as plug-ins, once.

    A module that cannot be imported gives a warning, because the rest of Rattlebox does not depend on it. A name that is
    given twice is an error, because a case would otherwise depend on the order of installation.
    """
    plugins()


@cache
def plugins() -> tuple[Plugin, ...]:
    """Import the plug-ins and return them, in the order of their names."""
    return tuple(_loaded(point) for point in sorted(entry_points(group=GROUP)))


def _loaded(point: EntryPoint) -> Plugin:
    """Import a plug-in."""
    package, version = (point.dist.name, point.dist.version) if point.dist else ("unknown", "")
    problem = ""
    try:
        point.load()
    except NameTaken:
        raise
    except Exception as error:  # whatever code of others raises
        problem = f"{type(error).__name__}: {error}"
        text = message(
            f"the plug-in {point.name} of the package {package} cannot be imported: {problem}",
            f"pip uninstall {package}, or a version of it for this version of Rattlebox",
        )
        warnings.warn(text, PluginWarning, stacklevel=2)
    return Plugin(point.name, package, version, problem)
