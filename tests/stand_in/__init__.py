"""A stand-in for NVIDIA's driver and a card, for tests: the real cuda-core on top, the processor beneath.

It shows that host and kernels work together. It is no card, and nothing about a card is measured with it.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

HERE = Path(__file__).parent
COMPILER = shutil.which(os.environ.get("CXX", "c++")) or shutil.which("g++") or shutil.which("clang++")


def built(folder: Path) -> dict[str, str]:
    """Compile driver and card into a folder; return the environment in which they are found."""
    for given in (
        ["-shared", "-fPIC", "-Wl,-soname,libcuda.so.1", HERE / "driver.cpp", "-o", folder / "libcuda.so.1"],
        ["-rdynamic", HERE / "card.cpp", "-o", folder / "card"],
    ):
        subprocess.run(
            [str(COMPILER), "-std=c++20", "-O2", "-Wall", "-Wextra", "-Werror", *map(str, given)], check=True
        )
    where = {"LD_LIBRARY_PATH": str(folder), "PYTHONPATH": str(HERE)}
    return {"STAND_IN": str(folder), "STAND_IN_COMPILER": str(COMPILER), **where}
