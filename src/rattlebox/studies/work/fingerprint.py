"""Fingerprints of functions, so that a study resumes only with the functions with which it was started."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import partial
from hashlib import sha256
from inspect import getclosurevars, getsource
from types import CodeType, FunctionType, MethodType
from typing import Any

import numpy as np

from rattlebox.model.base import full_text


def fingerprint(function: Callable[..., Any]) -> str:
    """Return a digest of the source of a function and of the values that it refers to."""
    return _Digest(function).hexdigest()


_PLAIN = (str, bytes, bool, int, float, complex, type(None))


class _Digest:
    """Digest of a function, to which the values that it refers to are added recursively."""

    def __init__(self, function: Any) -> None:
        self._hash = sha256()
        self._added: list[Any] = []  # functions and types
        self._parents: list[Any] = []  # other objects, parts of which are being added
        innermost = function
        while isinstance(innermost, partial):
            innermost = innermost.func
        self._package = _package(innermost)
        self._add(function)

    def hexdigest(self) -> str:
        return self._hash.hexdigest()[:12]

    def _update(self, *values: object) -> None:
        """Add the text of values, without addresses in memory."""
        for value in values:
            text = value if isinstance(value, bytes) else re.sub(r" at 0x[0-9a-fA-F]+", "", str(value)).encode()
            self._hash.update(b"%d " % len(text) + text)

    def _add(self, value: Any) -> None:
        if isinstance(value, _PLAIN):
            return self._update(repr(value))
        known = [number for number, each in enumerate([*self._added, *self._parents]) if each is value]
        if known:  # a function that calls itself, a list that holds itself
            return self._update("as", known[0])
        if isinstance(value, (FunctionType, type)):
            self._added.append(value)
            return self._add_content(value)
        self._parents.append(value)
        self._add_content(value)
        self._parents.pop()
        return None

    def _add_content(self, value: Any) -> None:
        if isinstance(value, (FunctionType, type)) and _package(value) != self._package:
            self._update(value.__module__, value.__qualname__)
        elif isinstance(value, FunctionType):
            self._add_source(value, value.__code__)
            outer = getclosurevars(value)
            for part in (value.__defaults__, value.__kwdefaults__, outer.nonlocals, outer.globals):
                self._add(part)
        elif isinstance(value, type):
            self._add_source(value, value.__qualname__)
        elif isinstance(value, CodeType):
            self._update(value.co_code, value.co_names)
            self._add(value.co_consts)
        elif isinstance(value, partial):
            self._add((value.func, value.args, value.keywords))
        elif isinstance(value, MethodType):
            self._add((value.__func__, value.__self__))
        elif isinstance(value, np.ndarray) and value.dtype != object:
            self._update(value.dtype, value.shape, value.tobytes())
        elif isinstance(value, Mapping):
            self._add([*value, *value.values()])
        elif isinstance(value, (list, tuple)):
            self._update(type(value).__name__, len(value))
            for item in value:
                self._add(item)
        elif isinstance(value, (set, frozenset)):
            self._update(*sorted(map(repr, value)))
        else:
            self._update(full_text(value))
            if _package(type(value)) == self._package:
                self._add((type(value), getattr(value, "__dict__", None)))

    def _add_source(self, value: Any, otherwise: Any) -> None:
        """Add the source of a function or type, or something else if it is not available."""
        try:
            self._update(getsource(value))
        except (OSError, TypeError):
            self._add(otherwise)


def _package(value: Any) -> str:
    module = getattr(value, "__module__", None) or type(value).__module__
    return str(module).partition(".")[0]
