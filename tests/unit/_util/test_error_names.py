"""Errors have the names of the documented classes wherever a user sees them."""

from __future__ import annotations

import importlib
import pickle
import pkgutil
import subprocess
import sys

import pytest

import rattlebox as rb
from rattlebox.model.errors import Hint

PUBLIC = {
    name for name in rb.__all__ if isinstance(getattr(rb, name), type) and issubclass(getattr(rb, name), Exception)
}


def all_errors() -> list[type[rb.RattleboxError]]:
    """Return all classes of errors of the package."""
    for module in pkgutil.walk_packages(rb.__path__, "rattlebox."):
        if not module.name.startswith("rattlebox.core.") and not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    stack, found = [rb.RattleboxError], []
    while stack:
        found.append(stack.pop())
        stack += [cls for cls in found[-1].__subclasses__() if cls.__module__.startswith("rattlebox")]
    return found


def test_names_are_documented() -> None:
    """Tracebacks name a documented class, which the error is one of; tests had compared with `isinstance` only."""
    errors = all_errors()
    assert len(errors) > len(PUBLIC)
    for cls in errors:
        assert f"{cls.__module__}.{cls.__qualname__}" == f"rattlebox.{cls.__name__}"
        assert cls.__name__ in PUBLIC
        assert issubclass(cls, getattr(rb, cls.__name__))


def test_errors_of_other_processes() -> None:
    """An error that comes from another process has its class, text, advice and place."""
    for cls in all_errors():
        error = pickle.loads(pickle.dumps(cls("a gap is needed", "1 mm", ("dampers", 0, "gap"))))
        assert type(error) is cls
        assert str(error) == "dampers[0].gap\n  a gap is needed\n  try: 1 mm"
        assert (error.complaint, error.suggestion, error.place) == ("a gap is needed", "1 mm", ("dampers", 0, "gap"))


def test_what_a_user_sees() -> None:
    """The traceback of a wrong argument ends with the documented name."""
    code = 'import rattlebox as rb; rb.damping_curve(rb.reference_case(), ["0.3 mm"])'
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "\nrattlebox.CaseError: amplitudes must be" in done.stderr
    assert "Hint" not in done.stderr.rpartition("\nrattlebox.")[2]


def test_classes_of_others_keep_their_names() -> None:
    """An error class of another package is shown under its own name."""

    class ForeignError(rb.CaseError):
        """Error of a test."""

    assert ForeignError.__name__ == "ForeignError"
    with pytest.raises(rb.CaseError):
        raise Hint("a gap is needed")
