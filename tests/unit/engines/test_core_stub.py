"""The types of the compiled core that mypy reads are those of the core."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

import rattlebox
from rattlebox.core import _core

STUB = Path(rattlebox.__file__).parent / "core" / "_core.pyi"


@pytest.mark.skipif(importlib.util.find_spec("nanobind") is None, reason="nanobind is not installed")
def test_the_stub_is_current(tmp_path: Path) -> None:
    """The stub in the repository equals a newly generated one."""
    made = tmp_path / "_core.pyi"
    program = [sys.executable, "-m", "nanobind.stubgen", "-q", "-m", _core.__name__, "-o", str(made)]
    subprocess.run(program, check=True, cwd=STUB.parents[2])
    assert made.read_text(encoding="utf-8") == STUB.read_text(encoding="utf-8")


def test_fields_that_are_unknown_or_missing_are_refused() -> None:
    """A misspelt coefficient, a missing one, and one of a wrong type raise; so does an unknown law."""
    right = {"stiffness": 1e9, "mass": 0.1, "zero_overlap": 0.0}
    assert _core.HertzTsujiForce(**right).mass == 0.1
    wrong: list[dict[str, object]] = [
        {**right, "stifness": 1.0},
        {"stiffness": 1e9, "mass": 0.1},
        {**right, "mass": "0.1"},
        {**right, "mass": None},
    ]
    for values in wrong:
        with pytest.raises(TypeError, match="stiffness"):
            _core.normal_law("hertz_tsuji", values)
    with pytest.raises(ValueError, match="no law named 'hertz'"):
        _core.normal_law("hertz", dict(right))


def test_fields_cannot_be_set() -> None:
    """Fields of a problem are read-only; `replace` returns a changed copy."""
    force = _core.LinearForce(stiffness=1.0, mass=2.0, zero_overlap=0.0, fixed_contact_time=0.0)
    with pytest.raises(AttributeError):
        force.mass = 3.0  # type: ignore[misc]
    assert force.replace(mass=3.0).mass == 3.0 and force.mass == 2.0
    with pytest.raises(TypeError):
        force.replace(weight=3.0)
