"""What tells a function from others of its name, so that a study goes on with the one that it was begun with."""

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
    """Return what tells a function from others of its name: its text, and the values that it takes from elsewhere.

    Parameters
    ----------
    function
        Any function, method, partial or object that can be called. Of what it takes from other packages only names count.
    """
    return _Digest(function).hexdigest()


_PLAIN = (str, bytes, bool, int, float, complex, type(None))


class _Digest:
    def __init__(self, function: Any) -> None:
        self._sum = sha256()
        self._told: list[Any] = []  # functions and types
        self._within: list[Any] = []  # other things, of which a part is being told
        of = function
        while isinstance(of, partial):
            of = of.func
        self._package = _package(of)
        self._tell(function)

    def hexdigest(self) -> str:
        return self._sum.hexdigest()[:12]

    def _say(self, *words: object) -> None:
        for word in words:
            text = word if isinstance(word, bytes) else re.sub(r" at 0x[0-9a-fA-F]+", "", str(word)).encode()
            self._sum.update(b"%d " % len(text) + text)

    def _tell(self, value: Any) -> None:
        if isinstance(value, _PLAIN):
            return self._say(repr(value))
        known = [number for number, told in enumerate([*self._told, *self._within]) if told is value]
        if known:  # a function that calls itself, a list that holds itself
            return self._say("as", known[0])
        if isinstance(value, (FunctionType, type)):
            self._told.append(value)
            return self._tell_inside(value)
        self._within.append(value)
        self._tell_inside(value)
        self._within.pop()
        return None

    def _tell_inside(self, value: Any) -> None:
        if isinstance(value, (FunctionType, type)) and _package(value) != self._package:
            self._say(value.__module__, value.__qualname__)
        elif isinstance(value, FunctionType):
            self._tell_text(value, value.__code__)
            taken = getclosurevars(value)
            for given in (value.__defaults__, value.__kwdefaults__, taken.nonlocals, taken.globals):
                self._tell(given)
        elif isinstance(value, type):
            self._tell_text(value, value.__qualname__)
        elif isinstance(value, CodeType):
            self._say(value.co_code, value.co_names)
            self._tell(value.co_consts)
        elif isinstance(value, partial):
            self._tell((value.func, value.args, value.keywords))
        elif isinstance(value, MethodType):
            self._tell((value.__func__, value.__self__))
        elif isinstance(value, np.ndarray) and value.dtype != object:
            self._say(value.dtype, value.shape, value.tobytes())
        elif isinstance(value, Mapping):
            self._tell([*value, *value.values()])
        elif isinstance(value, (list, tuple)):
            self._say(type(value).__name__, len(value))
            for item in value:
                self._tell(item)
        elif isinstance(value, (set, frozenset)):
            self._say(*sorted(map(repr, value)))
        else:
            self._say(full_text(value))
            if _package(type(value)) == self._package:
                self._tell((type(value), getattr(value, "__dict__", None)))

    def _tell_text(self, value: Any, instead: Any) -> None:
        try:
            self._say(getsource(value))
        except (OSError, TypeError):
            self._tell(instead)


def _package(value: Any) -> str:
    module = getattr(value, "__module__", None) or type(value).__module__
    return str(module).partition(".")[0]
