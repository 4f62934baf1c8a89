"""Exceptions of the package: every error about a case, a file or the machine is a `RattleboxError`.

Wrong arguments of a function (a wrong type, arrays of different lengths) raise TypeError, ValueError or IndexError, as in
NumPy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, ClassVar

_PUBLIC = "rattlebox"


class RattleboxError(Exception):
    """Base class of all errors of the package."""

    _source: ClassVar[tuple[str, str]] = (__name__, "RattleboxError")  # module and name of the class, for pickles

    def __init__(
        self,
        complaint: str,
        suggestion: str = "",
        place: Sequence[str | int] = (),
        *,
        head: str = "",
        allowed: Sequence[str] = (),
    ) -> None:
        self.complaint = complaint  # what is wrong, and what is allowed
        self.suggestion = suggestion
        self.place = tuple(place)
        self.head = head  # the place as a message names it, with file and value; default that of `place`
        self.allowed = tuple(allowed)  # names of fields or values, of which one is needed
        super().__init__(
            message(self.without_suggestion, suggestion)
        )  # the only place where the parts are put together

    @property
    def without_suggestion(self) -> str:
        """The text without the suggestion."""
        where = self.head or named(self.place)
        return message(where, self.complaint, "") if where else self.complaint

    def restated(self, kind: type[RattleboxError] | None = None, source: str = "", **changes: Any) -> RattleboxError:
        """Return the error with some parts changed, of another class, or with a file or option in front."""
        names = ("complaint", "suggestion", "place", "head", "allowed")
        parts: dict[str, Any] = {name: getattr(self, name) for name in names} | changes
        if source:
            name = "head" if parts["head"] or parts["place"] else "complaint"
            parts[name] = f"{source}: {parts[name] or named(parts['place'])}"
        return (kind or type(self))(**parts)

    def __init_subclass__(cls) -> None:
        """Name a class in tracebacks as users know it: a class of the package outside of this module by its public base."""
        super().__init_subclass__()
        cls._source = cls.__module__, cls.__qualname__
        if cls.__module__ == __name__:
            cls.__module__ = _PUBLIC
        elif cls.__module__.startswith(f"{_PUBLIC}."):
            public = next(base for base in cls.__mro__[1:] if base.__module__ == _PUBLIC)
            cls.__module__, cls.__name__, cls.__qualname__ = _PUBLIC, public.__name__, public.__qualname__

    def __str__(self) -> str:
        return str(self.args[0])  # OSError would add its number and file name

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]:
        return _rebuilt, (*self._source, self.args), self.__dict__


RattleboxError.__module__ = _PUBLIC


def _rebuilt(module: str, name: str, arguments: tuple[Any, ...]) -> RattleboxError:
    """Return an error of the class that a module defines under a name."""
    error: RattleboxError = getattr(import_module(module), name)(*arguments)
    return error


class CaseError(RattleboxError, ValueError):
    """A case or a study is not valid, or its result does not have the requested content."""


class DataError(RattleboxError, OSError, ValueError):
    """A file of the user (a record, a result, a checkpoint) is missing, damaged, foreign, or cannot be read or written."""


def unreadable(path: object, error: OSError) -> DataError:
    """Return the error about a file that the system does not read."""
    advice = "permission to read it, or a copy of the file in another folder"
    return DataError(f"{path} cannot be read: {error.strerror or error}", advice)


class StoreError(RattleboxError, OSError):
    """The folder of a study is damaged, is in use, or holds something else."""


class ResourceError(RattleboxError, OSError, ValueError):
    """A resource of the machine is missing: memory, disk space, threads, instructions, workers of a cluster."""


class StepError(RattleboxError, RuntimeError):
    """The engine of a stepper stopped, for instance because a particle left its cavity."""


class MissingDependency(RattleboxError, ImportError):
    """An optional library is not installed."""


def named(place: Sequence[str | int]) -> str:
    """Return names of fields and indices as a path, such as "pairs[0].friction"."""
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in place).removeprefix(".")


def message(head: str, *rest: str) -> str:
    """Return the head, further lines below it, and the last argument as a suggestion."""
    *complaint, suggestion = rest
    return "\n".join([head, *(f"  {line}" for line in complaint), *([f"  try: {suggestion}"] if suggestion else [])])
