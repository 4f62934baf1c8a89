"""Commands that other packages add to `rattlebox`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from rattlebox._util.plugins import Registry, load_plugins, owner_of

Command = TypeVar("Command", bound="Callable[..., Any]")

_COMMANDS: Registry[Callable[..., Any]] = Registry("command")


def command(name: str) -> Callable[[Command], Command]:
    """Register a function as a command; its arguments are those of typer, its docstring is the help."""

    def register(function: Command) -> Command:
        _COMMANDS.add(name, function, owner_of(function))
        return function

    return register


def commands_of_plugins(own: list[str]) -> dict[str, Callable[..., Any]]:
    """Return the commands of plug-ins by name; raise if one has the name of an own command."""
    load_plugins()
    for name in own:
        _COMMANDS.reserve(name, "rattlebox")
    return dict(_COMMANDS)
