"""The only place where a frozen object changes: while it is made."""

from __future__ import annotations

from typing import Any


def complete(made: object, **values: Any) -> None:
    """Set fields of a frozen object that its own validator or `__post_init__` computes, before anybody else has it."""
    private = getattr(made, "__pydantic_private__", None) or {}
    for name, value in values.items():
        if name in private:
            private[name] = value
        else:
            object.__setattr__(made, name, value)
