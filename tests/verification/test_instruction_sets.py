"""The builds of the core for each instruction set: the choice at import, and the verified numbers of each."""

import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox.core import choose as core

HERE = Path(__file__).parent


@pytest.mark.parametrize("level", ["v1", "v3", "v4", "native"])
def test_every_build_gives_the_verified_numbers(level: str) -> None:
    """Reference solution and lines of the verification table hold with each build that this processor can run."""
    if level not in core.supported():
        pytest.skip(f"{level} is not built, or this processor cannot run it")
    if level == core.choice()[0]:
        pytest.skip(f"{level} is what all other tests run with")
    environment = {**os.environ, "RATTLEBOX_SIMD": level}
    program = "from rattlebox.core.choose import core; print(core().__name__)"
    name = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert name.stdout.strip() == f"rattlebox.core._core_{level}"
    files = ["test_reference_w1.py", "test_known_solutions.py::test_run_has_the_exact_value"]
    lines = "reference or tsuji or jackson_green or thornton or slow_manifold or chatter or oscillator_with_stop"
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-k", lines]
    done = subprocess.run(
        [*command, *(str(HERE / file) for file in files)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-3000:]


@pytest.mark.parametrize(
    ("offered", "level", "why"),
    [
        (4, "v4", "the best that was built"),
        (3, "v3", "lacks instructions of v4"),
        (1, "v1", "lacks instructions of v4"),
    ],
)
def test_best_build_is_picked(offered: int, level: str, why: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The best build whose instructions the processor has is chosen, with the reason."""
    monkeypatch.delenv("RATTLEBOX_SIMD", raising=False)
    monkeypatch.setattr(core, "_x86_64_level", lambda: offered)
    monkeypatch.setattr(core, "built", lambda: ("v4", "v3", "v1"))
    chosen, reason = core.choice.__wrapped__()
    assert chosen == level
    assert why in reason


def test_build_that_cannot_run_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The message about a build that the processor cannot run lists the possible ones."""
    monkeypatch.setenv("RATTLEBOX_SIMD", "v4")
    monkeypatch.setattr(core, "_x86_64_level", lambda: 3)
    monkeypatch.setattr(core, "built", lambda: ("v4", "v3", "v1"))
    with pytest.raises(rb.ResourceError, match="offer v3, v1"):
        core.choice.__wrapped__()


def test_level_agrees_with_the_features_that_linux_lists() -> None:
    """The compiled function finds the level whose features the kernel lists, and no higher one."""
    listing = Path("/proc/cpuinfo")
    if platform.machine() != "x86_64" or not listing.exists():
        pytest.skip("not Linux on x86-64")
    line = next(line for line in listing.read_text(encoding="utf-8").splitlines() if line.startswith("flags"))
    flags = set(line.partition(":")[2].split())
    v3 = {"avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"} <= flags
    v4 = v3 and {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"} <= flags
    assert core._x86_64_level() == (4 if v4 else 3 if v3 else 1)


def test_no_core_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    """An installation without a compiled core raises an error with the command that installs one."""
    monkeypatch.setitem(sys.modules, "rattlebox.core._core_processor", None)
    with pytest.raises(rb.MissingDependency, match="no compiled core was found"):
        core.choice.__wrapped__()
