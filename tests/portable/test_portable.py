"""The core, built without Python by other compilers and for other systems, computes the same digits."""

import platform
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from rattlebox.core._core_processor import x86_64_level

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
# Multiplications and additions must stay apart: compilers differ in which ones they fuse.
FLAGS = [
    "-std=c++20",
    "-O2",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-fopenmp-simd",
    "-Wno-psabi",
    "-ffp-contract=off",
]
ZIG = [sys.executable, "-m", "ziglang", "c++"]
# Starts a WebAssembly program with Node.js.
START = """
const { WASI } = require('node:wasi');
const wasi = new WASI({ version: 'preview1' });
WebAssembly.compile(require('node:fs').readFileSync(process.argv[1]))
  .then(module => WebAssembly.instantiate(module, wasi.getImportObject()))
  .then(instance => process.exit(wasi.start(instance)));
"""

pytestmark = pytest.mark.slow


def build(program: Path, *command: str | Path) -> Path:
    """Compile the cases and return the program."""
    files = (["-I", ROOT / "core", HERE / "cases.cpp"], ["-o", program])
    subprocess.run([*command, *FLAGS, *files[0], *files[1]], check=True, timeout=600)
    return program


def numbers(*command: str | Path) -> list[str]:
    """Return the lines that a program prints."""
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    return done.stdout.splitlines()


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Digits of the build by GCC with threads."""
    compiler = shutil.which("g++")
    if compiler is None:
        pytest.skip("the cases did not run: there is no g++")
    lines = numbers(build(tmp_path_factory.mktemp("gcc") / "cases", compiler, "-pthread"))
    assert lines[0].startswith("impact: status 0, 94 impacts")
    assert any(line.startswith("particles: status 0, step 5001") for line in lines)
    return lines


def test_core_without_threads_gives_the_same_digits(usual: list[str], tmp_path: Path) -> None:
    """A build with RATTLEBOX_THREADS=0 needs no thread library and computes the same."""
    assert numbers(build(tmp_path / "cases", "g++", "-DRATTLEBOX_THREADS=0")) == usual


@pytest.mark.skipif(find_spec("ziglang") is None, reason="the cases did not run: ziglang is not installed")
@pytest.mark.skipif(sys.platform != "linux", reason="the cases did not run: not Linux")
def test_clang_on_old_linux_gives_the_same_digits(usual: list[str], tmp_path: Path) -> None:
    """A build by Clang for Linux with glibc 2.28 computes the same."""
    assert numbers(build(tmp_path / "cases", *ZIG, "-target", "x86_64-linux-gnu.2.28")) == usual


@pytest.mark.skipif(find_spec("ziglang") is None, reason="the cases did not run: ziglang is not installed")
@pytest.mark.skipif(shutil.which("node") is None, reason="the WebAssembly cases did not run: node is not installed")
def test_web_assembly_gives_the_same_numbers(usual: list[str], tmp_path: Path) -> None:
    """A build for WebAssembly computes the same digits of particles.

    The impact case calls sin and cos of another mathematical library, whose last bits differ and grow from impact to impact.
    """
    command = [*ZIG, "-target", "wasm32-wasi", "-msimd128", HERE / "wasi.cpp"]
    program = build(tmp_path / "cases.wasm", *command)
    lines = numbers("node", "--no-warnings", "-e", START, program)
    middle = next(k for k, line in enumerate(usual) if line.startswith("particles"))
    assert lines[middle:] == usual[middle:]
    assert lines[0] == usual[0]
    impact, expected = (np.array(" ".join(result[1:middle]).split(), float) for result in (lines, usual))
    np.testing.assert_allclose(impact, expected, rtol=1e-9, atol=1e-12)


@pytest.mark.skipif(find_spec("ziglang") is None, reason="ziglang is not installed")
@pytest.mark.skipif(sys.platform != "linux" or platform.machine() != "x86_64", reason="not Linux on x86-64")
def test_clang_finds_the_same_instructions(tmp_path: Path) -> None:
    """The level of the processor does not depend on the run-time library of the compiler."""
    source, program = tmp_path / "level.cpp", tmp_path / "level"
    source.write_text('#include "util/processor.hpp"\nint main() { return rattlebox::x86_64_level(); }\n')
    command = [sys.executable, "-m", "ziglang", "cc", "-std=c++20", "-O1", "-I", ROOT / "core", source, "-o", program]
    subprocess.run(command, check=True, timeout=120)
    assert subprocess.run([program], check=False).returncode == x86_64_level()
