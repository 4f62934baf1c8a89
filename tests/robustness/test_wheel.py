"""The wheel: built, installed without a compiler and without an index, and run."""

import platform
import runpy
import subprocess
import sys
import sysconfig
import zipfile
from importlib.util import find_spec
from pathlib import Path

import pytest

WHEEL = runpy.run_path(str(Path(__file__).parents[2] / "tools" / "wheel.py"))

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        platform.system() != "Linux" or platform.machine() != "x86_64" or not find_spec("ziglang"),
        reason="wheels are built by zig on Linux x86-64",
    ),
]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel for this Python."""
    built: Path = WHEEL["build"](sys.executable, tmp_path_factory.mktemp("wheel"), systems=["aarch64-linux"])
    return built


def test_wheel_has_a_label_and_all_files(wheel: Path) -> None:
    """The label is manylinux_2_28; each instruction set, the library and the headers are in it, and no file of the tests."""
    assert "manylinux_2_28_x86_64" in wheel.name
    with zipfile.ZipFile(wheel) as content:
        names = content.namelist()
        sizes = sum(entry.file_size for entry in content.infolist())
    for part in ("_core_v1.", "_core_v3.", "_core_v4.", "_core_processor.", "rattlebox_component.so"):
        assert sum(name.startswith(f"rattlebox/core/{part}") and name.endswith(".so") for name in names) == 1
    assert {"rattlebox/include/rattlebox.h", "rattlebox/include/dem/simulation.hpp", "rattlebox/py.typed"} <= set(names)
    assert "rattlebox/core/rattlebox_component.aarch64-linux.so" in names
    assert {name.split("/")[0].split("-")[0] for name in names} == {"rattlebox"}
    assert wheel.stat().st_size < 6e6
    assert sizes < 20e6


def test_wheel_runs_in_a_fresh_environment(wheel: Path, tmp_path: Path) -> None:
    """Installed without a compiler, the package runs a case with each instruction set and writes an FMU."""
    python = WHEEL["environment"](tmp_path / "user", sys.executable)
    pip = [python, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", wheel]
    subprocess.run(pip, check=True, env={"PATH": "/nowhere", **WHEEL["NO_COMPILER"]})
    # The libraries of this environment stand for those that an index would provide.
    (path,) = (tmp_path / "user" / "lib").glob("python*/site-packages")
    (path / "libraries.pth").write_text(sysconfig.get_path("purelib") + "\n")
    shown = WHEEL["check"](python, tmp_path)
    assert "instruction sets" in shown
