"""Waiting times of the workers of a thread pool: core/parallel/contention.hpp alone, without threads."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

CORE = Path(__file__).parents[2] / "core"
COMPILER = shutil.which(os.environ.get("CXX", "c++")) or shutil.which("g++") or shutil.which("clang++")

PROGRAM = """
#include <cstdio>
#include "parallel/contention.hpp"

using rattlebox::WaitTimes;

int main() {
    const auto at = [](int ms) { return WaitTimes::Time(std::chrono::milliseconds(1000 + ms)); };
    int worker, start, end, now;
    WaitTimes waits(2, at(0));
    while (std::scanf("%d %d %d %d", &worker, &start, &end, &now) == 4) {
        waits.add(worker, at(start), at(end));
        std::printf("%d", waits.dominate(at(now)));
    }
}
"""


def dominates(folder: Path, *waits: tuple[int, int, int, int]) -> str:
    """Return digits: whether waits dominate after each of `waits`, (worker, start, end, time of the question) [ms]."""
    assert COMPILER, "a C++ compiler is needed, as for building Rattlebox"
    source, program = folder / "waits.cpp", folder / "waits"
    source.write_text(PROGRAM, encoding="utf-8")
    subprocess.run([COMPILER, "-std=c++20", f"-I{CORE}", "-o", program, source], check=True)
    lines = "\n".join(" ".join(map(str, wait)) for wait in waits)
    return subprocess.run([program], input=lines, capture_output=True, text=True, check=True).stdout


def test_alternating_waits_dominate(tmp_path: Path) -> None:
    """Waits dominate if one of two workers always waits for the other, so that one alone is as fast."""
    assert dominates(tmp_path, (0, 0, 11, 11), (1, 11, 22, 22), (0, 22, 32, 32), (1, 33, 43, 43)) == "0100"


def test_rare_waits_do_not_dominate(tmp_path: Path) -> None:
    """Short waits of both workers every 100 ms, each reported twice, do not dominate."""
    waits = [(worker, 100 * k + 7, 100 * k + 15, 100 * k + 15) for k in range(5) for worker in (0, 1)]
    assert dominates(tmp_path, *waits) == "0" * 10
