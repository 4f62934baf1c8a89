"""The tests of a card, on the processor: a stand-in for NVIDIA's driver beneath the packages that a card needs."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.stand_in import COMPILER, HERE, built

import rattlebox as rb
from rattlebox.engines.core import built as cores

from .gpu_cases import CASES, bed

pytestmark = pytest.mark.skipif(COMPILER is None or sys.platform != "linux", reason="no C++ compiler, or not Linux")
ROOT = Path(__file__).parents[3]
PROGRAM = Path(sys.executable).with_name("rattlebox")


@pytest.fixture(scope="module")
def around(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """An environment in which there is a card, it seems."""
    return {**os.environ, **built(tmp_path_factory.mktemp("stand_in"))}


def run(around: dict[str, str], *command: str | Path, **more: str) -> subprocess.CompletedProcess[str]:
    """Run a program there."""
    given = [sys.executable, *map(str, command)]
    return subprocess.run(given, env={**around, **more}, cwd=ROOT, capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize(
    ("files", "which", "more"),
    [
        ("test_impact.py", "agrees or members", {"STAND_IN_ALIKE": "1", "RATTLEBOX_SIMD": "v1"}),
        ("test_impact.py", "not launch", {"STAND_IN_ORDER": "3"}),
        ("test_dem.py", "", {"STAND_IN_ORDER": "backwards"}),
        ("test_studies_of_particles.py", "not ready_maps", {"STAND_IN_ORDER": "11"}),
    ],
)
def test_what_a_card_has_to_do(around: dict[str, str], files: str, which: str, more: dict[str, str]) -> None:
    """Tests of a card pass in any order of threads, and to the processor's bits where both round alike."""
    if "v1" not in cores():
        more = {name: value for name, value in more.items() if name not in ("STAND_IN_ALIKE", "RATTLEBOX_SIMD")}
    ended = run(around, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"tests/gpu/{files}", "-k", which, **more)
    print(ended.stdout, ended.stderr)
    assert ended.returncode == 0 and "skipped" not in ended.stdout


def written(folder: Path, case: rb.Case, axes: dict[str, list[str]]) -> Path:
    """Write the files of a study."""
    (folder / "case.toml").write_text(case.to_toml())
    named = "".join(f'"{name}" = {values}\n' for name, values in axes.items())
    study = folder / "study.toml"
    study.write_text(f'measure = ["peak"]\n[case]\nfile = "case.toml"\n[axes]\n{named}')
    return study


FAULTS = {
    "elsewhere": "ILLEGAL_ADDRESS",
    "beyond_memory": "beyond the end of 100 bytes",
    "beyond_shared": "wrote beyond its shared memory",
    "one_is_missing": "waits for ever: of 64 threads 63 are at a barrier",
    "not_on_the_card": "argument 0 is no place in the card's memory",
    "too_many_threads": "LAUNCH_OUT_OF_RESOURCES",
    "too_many_blocks": "exceeds the limit",
    "too_much_shared": "49152 are allowed",
    "given_back": "not in one block",
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_are_found(around: dict[str, str], fault: str) -> None:
    """What a card would not forgive, the stand-in does not either."""
    ended = run(around, HERE / "faults.py", fault)
    assert FAULTS[fault] in ended.stdout + ended.stderr


def test_a_missing_barrier_shows(around: dict[str, str]) -> None:
    """Orders of threads change what a kernel writes that waits for nobody, and nothing else."""

    def wrote(name: str) -> set[str]:
        return {run(around, HERE / "faults.py", name, STAND_IN_ORDER=order).stdout for order in ("forwards", "5")}

    assert wrote("mirrored") == {f"{list(range(63, -1, -1))}\n"}
    assert len(wrote("too_early")) == 2


def test_commands_find_the_card(around: dict[str, str], tmp_path: Path) -> None:
    """What is there is named, and studies of both kinds run."""
    told = run(around, PROGRAM, "doctor").stdout
    assert "stand-in of the tests" in told and "studies and runs of particles in space run there" in told
    shot = {"structure.velocity": ["0.2 m/s", "0.4 m/s"]}
    for case, axis in ((bed(), shot), (CASES["output"]["motion"].case, {"damper.gap": ["0.5 mm", "1 mm"]})):
        ended = run(
            around, PROGRAM, "sweep", written(tmp_path, case, axis), "--gpu", "-o", tmp_path / f"{id(case)}.zarr"
        )
        assert ended.returncode == 0 and "2 variants: 2 finished\n" in ended.stdout, ended.stderr
        assert "\nstand-in of the tests, no card" in ended.stdout


def test_the_table_of_measurements_is_whole(around: dict[str, str]) -> None:
    """All that is to be measured on a card is, and what is compared agrees: first impacts, statistics, bits."""
    table = run(around, "benchmarks/gpu.py", "--short").stdout
    print(table)
    rows = [line for line in table.splitlines() if not line.startswith(("Rattlebox", "  ", "compute-sanitizer"))]
    assert len(rows) == 10 and sum(row.endswith(" ok") for row in rows) == 5
    assert not [word for word in ("failed", "left out", "Error") if word in table]


def test_a_launch_is_stopped_by_ctrl_c(around: dict[str, str], tmp_path: Path) -> None:
    """A study whose variants would take days ends at once, with what to do to go on."""
    case = CASES["method"]["EventDriven"].case.model_copy(
        update={"duration": 1e6, "method": rb.EventDriven(max_events=10**9)}
    )
    study = written(tmp_path, case, {"damper.gap": ["0.5 mm", "1 mm"]})
    command = [sys.executable, PROGRAM, "sweep", study, "--gpu", "-o", tmp_path / "out.zarr"]
    how = {"env": {**around, "STAND_IN_TELLS": "1"}, "cwd": ROOT, "stderr": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(list(map(str, command)), text=True, **how) as program:
        assert program.stderr is not None
        assert any("impact begins" in line for line in program.stderr)
        time.sleep(0.5)
        program.send_signal(signal.SIGINT)
        pressed = time.perf_counter()
        _, told = program.communicate(timeout=100)
    assert program.returncode == 130 and time.perf_counter() - pressed < 20, told
