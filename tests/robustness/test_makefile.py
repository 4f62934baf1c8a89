"""What make installs, depending on earlier installations in the folder."""

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")


def commands(target: str, *stamps: str, folder: Path) -> str:
    """Return the commands that make would run for a target after earlier set-ups, given by their stamps."""
    shutil.copy(ROOT / "Makefile", folder)
    for name in ("CMakeLists.txt", "pyproject.toml", "constraints.txt"):
        (folder / name).touch()
    (folder / "core").mkdir()
    (folder / "tests/portable").mkdir(parents=True)
    (folder / "tests/portable/cases.cpp").touch()
    for name in ("bin/python", *stamps):
        (folder / ".venv" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / ".venv" / name).touch()
    done = subprocess.run(["make", "-n", target], cwd=folder, capture_output=True, text=True, check=True)
    return done.stdout


@pytest.mark.parametrize("target", ["demo", "reproduction"])
def test_demo_installs_only_the_package(target: str, tmp_path: Path) -> None:
    """The demonstration builds one core for this machine and installs no tool of developers."""
    todo = commands(target, folder=tmp_path)
    assert "RATTLEBOX_LEVELS=best" in todo
    assert "RATTLEBOX_LEVELS=all" not in todo and "[dev" not in todo


@pytest.mark.parametrize("target", ["test", "lint", "docs"])
def test_tests_install_everything_after_a_demo(target: str, tmp_path: Path) -> None:
    """After a demonstration in the same folder, developers still get all instruction sets and all tools."""
    todo = commands(target, ".package", folder=tmp_path)
    assert "RATTLEBOX_LEVELS=all" in todo and "'.[dev,docs]'" in todo


def test_demo_keeps_a_complete_setup(tmp_path: Path) -> None:
    """After a complete set-up, the demonstration installs nothing and so removes no instruction set."""
    todo = commands("demo", ".installed", folder=tmp_path)
    assert "pip" not in todo and "rattlebox demo" in todo
