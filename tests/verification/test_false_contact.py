"""The check of the 1-D engine that a contact begins where its gap is closed and its sides approach."""

import shutil
import subprocess
from pathlib import Path

import pytest

from rattlebox.core._core import Status

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Program that begins a contact at any gap."""
    compiler = shutil.which("g++")
    if compiler is None:
        pytest.skip("there is no g++")
    path = tmp_path_factory.mktemp("false_contact") / "program"
    command = [compiler, "-std=c++20", "-O1", "-fopenmp-simd", "-Wno-psabi", "-I", HERE.parents[1] / "core"]
    subprocess.run([*command, HERE / "false_contact.cpp", "-o", path, "-pthread"], check=True, timeout=600)
    return path


@pytest.mark.slow
@pytest.mark.parametrize(
    ("gap", "approach", "status", "logged"),
    [
        (0.0, 0.2, Status.finished, 1),
        (4e-19, 0.2, Status.finished, 1),
        (-4e-19, 1e-9, Status.finished, 1),
        (1e-15, 0.2, Status.false_contact, 0),
        (2.6e-4, 0.2, Status.false_contact, 0),
        (-1e-12, 0.2, Status.false_contact, 0),
        (0.0, -0.2, Status.finished, 0),
        (0.0, 0.0, Status.finished, 0),
    ],
)
def test_contact_at_an_open_gap_ends_the_run(
    program: Path, gap: float, approach: float, status: Status, logged: int
) -> None:
    """A contact begins at a gap of rounding only, and is logged only if its sides approach.

    No run was checked for it: the energy balance, which was, holds for a contact at any gap.
    """
    done = subprocess.run([program, repr(gap), repr(approach)], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.splitlines() == [f"{status.value} {logged}"] * 2
