"""How members of a team count what they wait for each other: core/parallel/contention.hpp alone, without threads."""

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
    int member, begun, ended, asked;
    WaitTimes waits(2, at(0));
    while (std::scanf("%d %d %d %d", &member, &begun, &ended, &asked) == 4) {
        waits.add(member, at(begun), at(ended));
        std::printf("%d", waits.dominate(at(asked)));
    }
}
"""


def asked(folder: Path, *waits: tuple[int, int, int, int]) -> str:
    """Return whether waits were a habit after each (member, begun, ended, when that was asked [ms]), as digits."""
    assert COMPILER, "a C++ compiler is needed: what builds Rattlebox needs one, too"
    source, program = folder / "waits.cpp", folder / "waits"
    source.write_text(PROGRAM, encoding="utf-8")
    subprocess.run([COMPILER, "-std=c++20", f"-I{CORE}", "-o", program, source], check=True)
    lines = "\n".join(" ".join(map(str, wait)) for wait in waits)
    return subprocess.run([program], input=lines, capture_output=True, text=True, check=True).stdout


def test_members_that_wait_for_each_other_in_turns_are_held_up(tmp_path: Path) -> None:
    """Where now one and now the other waits, all the time, one alone is as fast; where they wait half of it, not."""
    assert asked(tmp_path, (0, 0, 11, 11), (1, 11, 22, 22), (0, 22, 32, 32), (1, 33, 43, 43)) == "0100"


def test_a_core_that_is_taken_away_now_and_then_does_not_hold_a_team_up(tmp_path: Path) -> None:
    """One halt in which both wait is told twice, but the second time it was before the count began anew."""
    halts = [(member, 100 * k + 7, 100 * k + 15, 100 * k + 15) for k in range(5) for member in (0, 1)]
    assert asked(tmp_path, *halts) == "0" * 10
