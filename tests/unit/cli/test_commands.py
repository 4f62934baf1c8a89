"""Tests of the commands."""

import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.cli import commands
from rattlebox.cli import run as rattlebox_run
from rattlebox.cli.demo import BARE, DAMPED, demo_cases
from rattlebox.cli.main import main

from .conftest import RunCli

EXAMPLES = Path(__file__).parents[3] / "examples"


def rattlebox(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Run the command in a subprocess."""
    return subprocess.run(
        [sys.executable, "-m", "rattlebox.cli", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def test_run_writes_its_files(tmp_path: Path) -> None:
    """A case file results in a summary, a netCDF file that can be loaded, CSV, MAT and figures."""
    done = rattlebox("run", EXAMPLES / "steel_ball.toml", "-o", tmp_path, "--csv", "--mat")
    assert done.returncode == 0, done.stderr
    assert "impacts" in done.stdout
    run = rb.load(tmp_path / "run.nc")
    assert run.ok
    assert run.energy_residual < 1e-10
    for name in ("run.mat", "motion.csv", "energy.csv", "impacts.csv", "motion.png", "energy.png", "impacts.png"):
        assert (tmp_path / name).stat().st_size > 0


def test_run_prints_the_unit_assumed_for_a_record(tmp_path: Path, run_cli: RunCli) -> None:
    """The unit assumed for a record is printed with its peak in g, and so is the error of a coarse record."""
    rows = "".join(f"{k / 100},{(-1) ** (k // 3)}\n" for k in range(101))
    (tmp_path / "quake.csv").write_text("t,a\n" + rows)
    (tmp_path / "quake.toml").write_text(
        "duration = 1\n[structure]\nkind = 'sdof'\nmass = 1\nstiffness = '11 kN/m'\ndamping_ratio = 0.02\n"
        "[base]\nkind = 'record'\nfile = 'quake.csv'\n"
    )
    code, printed, error = run_cli("run", tmp_path / "quake.toml", "-o", tmp_path / "out")
    assert code == 0, error
    printed = " ".join(printed.split())
    assert "m/s^2 is assumed, with a peak of 1 m/s^2 = 0.102 g" in printed
    assert "straight lines" in printed


def test_demo_states_the_gain_in_one_sentence(tmp_path: Path, run_cli: RunCli) -> None:
    """The demo prints the gain with numbers, and writes a figure, netCDF files and case files that reproduce its runs."""
    code, printed, error = run_cli("demo", "-o", tmp_path)
    assert code == 0, error
    bare, damped = (rb.load(tmp_path / f"{name}.nc") for name in ("without_damper", "with_the_ball"))
    motion = [run.motion.displacement.sel(point="mass") for run in (bare, damped)]
    peak = float(abs(motion[0]).max())
    before, after = (rb.analysis.settling_time(each.time, each, reference=peak) for each in motion)
    lost = 100 * damped.summary().values["share_normal"]
    line = f"stops the structure in {after:.2g} s instead of {before:.2g} s; {lost:.0f} % of the energy is lost"
    assert f"A loose steel ball of 6 % of the mass {line} in impacts.\n" in printed
    assert after < before / 5
    assert (tmp_path / "demo.png").stat().st_size > 10_000
    again = rb.simulate(rb.Case.from_file(tmp_path / "with_the_ball.toml"))
    assert again.arrays.impacts == damped.arrays.impacts


def test_the_gain_of_the_demo_does_not_depend_on_the_start_of_the_ball() -> None:
    """From each start position the ball of the demo stops the structure at least three times as soon."""
    case = demo_cases()[DAMPED]
    runs = rb.simulate_many([case.replaced({"damper.start": start}) for start in np.linspace(-0.95, 0.95, 8)])
    compared = rb.compare({BARE: demo_cases()[BARE], **{str(number): run for number, run in enumerate(runs)}})
    bare, *damped = (values["settling_time[mass]"] for values in compared.values.values())
    assert max(damped) < bare / 3


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("duration = 1\n[structure]\nkind = 'sdof'\nmass = '-1 kg'\nstiffness = 1\n", "greater than zero"),
        ("duration = 1\n[structure]\nkind = 'sdof'\nmas = '1 kg'\nstiffness = 1\n", "did you mean 'mass'"),
        ("duration = \n", "not TOML"),
    ],
)
def test_error_of_a_case_file_fits_one_screen(tmp_path: Path, text: str, message: str, run_cli: RunCli) -> None:
    """Bad input ends with exit code 2 and a message with the file and the problem, without a traceback."""
    path = tmp_path / "bad.toml"
    path.write_text(text)
    code, _, error = run_cli("run", path)
    assert code == 2
    assert "bad.toml" in error
    assert message in error
    assert "Traceback" not in error
    assert len(error.splitlines()) < 24


def test_missing_file_and_unknown_option(run_cli: RunCli) -> None:
    """A missing file, an unknown option and an unknown command end with exit code 2 and no traceback."""
    for arguments in (("run", "nowhere.toml"), ("run", "--sideways"), ("fly",)):
        code, _, error = run_cli(*arguments)
        assert code == 2
        assert "Traceback" not in error


@pytest.mark.parametrize("command", ["run", "sweep", "plot"])
def test_second_argument_suggests_the_output_option(command: str, run_cli: RunCli) -> None:
    """A second argument ends with exit code 2 and suggests the command line with -o."""
    code, printed, error = run_cli(command, "one.toml", "two")
    assert (code, printed) == (2, "")
    assert f"rattlebox {command} one.toml -o two" in error


@pytest.mark.parametrize("command", [(), ("run",), ("sweep",), ("plot",)])
def test_help_shows_no_type_for_flags(command: tuple[str, ...], run_cli: RunCli) -> None:
    """The help shows a type for options with a value only."""
    _, printed, _ = run_cli(*command, "--help")
    assert "--help" in printed
    assert "bool" not in printed
    assert not command or "<path>" in printed


def test_figures_of_a_run_load_no_slow_libraries() -> None:
    """Neither a run, its summary nor its figures import a library that takes longer to import than they take.

    SciPy's special functions, of which a summary needed one number, took a quarter of the time of a short run: the test
    looked at the run alone.
    """
    script = (
        "import sys, rattlebox as rb, rattlebox.cli.run; run = rb.simulate(rb.Case.from_file(sys.argv[1]));"
        "run.summary(); print({'scipy', 'matplotlib', 'pint', 'xarray'} & sys.modules.keys());"
        "run.plot.motion(); run.plot.energy(); run.plot.impacts();"
        "slow = {'xarray', 'scipy.spatial', 'matplotlib.pyplot', 'scipy.special', 'jinja2', 'rattlebox.report'};"
        "print(slow & sys.modules.keys())"
    )
    command = [sys.executable, "-c", script, str(EXAMPLES / "steel_ball.toml")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "set()\nset()\n", done.stderr


def test_schema_lists_the_structures(tmp_path: Path, run_cli: RunCli) -> None:
    """The exported schema is JSON and defines the kinds of structure."""
    assert run_cli("schema", "-o", tmp_path / "schema.json")[0] == 0
    schema = json.loads((tmp_path / "schema.json").read_text())
    assert {"SDOF", "Modal", "Matrices"} <= set(schema["$defs"])


def test_schema_that_cannot_be_written(tmp_path: Path, run_cli: RunCli) -> None:
    """The message contains the file, the reason and a suggestion."""
    code, _, error = run_cli("schema", "-o", tmp_path)
    assert code == 2
    assert error == f"error: {tmp_path} cannot be written: Is a directory\n  try: another folder\n"


def test_pack_does_not_overwrite_its_case(tmp_path: Path, run_cli: RunCli) -> None:
    """The case file is not changed, and the message names the missing folder."""
    case = tmp_path / "case.toml"
    rb.reference_case(duration=0.1).to_file(case)
    before = case.read_bytes()
    code, _, error = run_cli("pack", case, "-o", case)
    assert code == 2 and "is the case file" in error
    assert case.read_bytes() == before
    code, _, error = run_cli("pack", case, "-o", tmp_path / "none" / "case.bin")
    assert code == 2 and "there is no folder" in error


def test_doctor_and_materials(monkeypatch: pytest.MonkeyPatch, run_cli: RunCli) -> None:
    """Doctor prints the core in use and optional libraries; materials prints the library in fewer than 80 lines."""
    shown = run_cli("doctor")[1]
    assert "core" in shown and "numpy" in shown and "pytest" not in shown
    assert all(name in shown for name in ("distributed", "optuna", "pyvista", "nicegui"))
    # A library of two extras had two lines, since no test counted them.
    names = [line.split()[0] for line in shown.splitlines() if "optional, " in line or "not installed" in line]
    assert len(set(names)) == len(names) > 5 and "trimesh" in names
    monkeypatch.setenv("COLUMNS", "80")
    shown = run_cli("materials")[1]
    assert "tungsten_carbide" in shown
    assert len(shown.splitlines()) < 80


def test_speed_above_the_range_of_a_law_ends_with_a_status() -> None:
    """An impact above the speed range of Jackson-Green ends the run with its results so far and a suggestion."""
    case = rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius=0.01, material="lead"),
            gap=1e-3,
            velocity=100.0,
            contact=rb.Tsuji(restitution=rb.JacksonGreen()),
        ),
        duration=0.1,
    )
    run = rb.simulate(case)
    assert run.status == "law_domain"
    assert "extrapol" in run.message
    extrapolating = rb.JacksonGreen(extrapolate=True)
    damper = case.dampers[0].model_copy(update={"contact": rb.Tsuji(restitution=extrapolating)})
    assert rb.simulate(case.model_copy(update={"dampers": (damper,), "duration": 1.2e-5})).counts["extrapolated"] == 1


def test_event_limit_ends_with_a_status() -> None:
    """A run that reaches its event limit ends with its results so far and a status."""
    case = rb.Case.from_file(EXAMPLES / "steel_ball.toml").model_copy(update={"method": rb.EventDriven(max_events=20)})
    run = rb.simulate(case)
    assert run.status == "too_many_events"
    assert 0 < len(run.arrays.impacts) < 20


INTERRUPTED_IMPORT = """
import os, signal, sys

class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == module:
            sys.meta_path.remove(self)
            os.kill(os.getpid(), signal.SIGINT)

module, sys.argv = sys.argv[1], ["rattlebox", *sys.argv[2:]]
sys.meta_path.insert(0, Interrupt())
from rattlebox.cli.main import main
main()
"""


@pytest.mark.parametrize("module", ["typer", "numpy", "rattlebox.model.case", "rattlebox.engines.simulate"])
def test_ctrl_c_while_modules_load_is_quiet(module: str, tmp_path: Path) -> None:
    """Ctrl-C while modules are imported ends with exit code 130 and one word."""
    case = EXAMPLES / "steel_ball.toml"
    command = [sys.executable, "-c", INTERRUPTED_IMPORT, module, "run", str(case), "-o", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "stopped\n")


def test_the_package_imports_lazily() -> None:
    """Importing the package imports no libraries, so that commands start at once; every public name is available."""
    script = (
        "import sys, rattlebox; light = not {'numpy', 'pydantic'} & sys.modules.keys();"
        "print(light, all(getattr(rattlebox, name) is not None for name in rattlebox.__all__))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "True True\n", done.stderr


def test_errors_of_the_operating_system(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Errors of the operating system are printed with their file, if they have one."""
    for error, message in ((OSError("no such thing"), "no such thing"), (OSError(5, "odd", "a.nc"), "a.nc: odd")):
        monkeypatch.setattr(commands, "app", Mock(side_effect=error))
        with pytest.raises(SystemExit, match="2"):
            commands.run_command()
        assert capsys.readouterr().err == f"error: {message}\n"


@pytest.mark.parametrize(
    ("module", "function", "arguments", "advice"),
    [
        ("run", "run_case", ["run", "a.toml"], "fewer particles"),
        ("sweep", "run_sweep", ["sweep", "a.toml"], "fewer workers"),
        ("materials", "show_materials", ["materials"], "other programs"),
    ],
)
def test_advice_on_a_lack_of_memory_fits_the_command(
    module: str, function: str, arguments: list[str], advice: str, monkeypatch: pytest.MonkeyPatch, run_cli: RunCli
) -> None:
    """A command that runs out of memory ends with advice on what that command can do.

    No test saw that a study was told to use fewer particles: no test had a command without memory.
    """
    monkeypatch.setattr(f"rattlebox.cli.{module}.{function}", Mock(side_effect=MemoryError))
    code, _, errors = run_cli(*arguments)
    assert code == 2
    assert f"not enough memory for 'rattlebox {arguments[0]}'" in errors and advice in errors


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stopped_run_of_a_ball_has_the_exit_code_of_the_signal(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run of a ball that is stopped ends with 130 or 143 and writes its results; it ended with 1, as a failed one.

    Only runs of particles were stopped on the command line.
    """
    monkeypatch.chdir(tmp_path)
    case = rb.Case.from_file(EXAMPLES / "steel_ball.toml")
    shaken = rb.Harmonic(amplitude="300 N", frequency="9 Hz")
    case.model_copy(update={"loads": (shaken,), "duration": 1e6}).to_file("long.toml")
    monkeypatch.setattr(sys, "argv", ["rattlebox", "run", "long.toml", "-o", "out", "--no-figures"])
    simulate = rattlebox_run._simulate

    def stopped(*arguments: Any) -> rb.Run:
        """Simulate, and send the signal a second later."""
        threading.Timer(1.0, os.kill, (os.getpid(), number)).start()
        return simulate(*arguments)

    monkeypatch.setattr(rattlebox_run, "_simulate", stopped)
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 128 + number
    assert rb.load("out/run.nc").status == "interrupted"


def test_a_folder_that_cannot_be_created_has_another_place_as_advice(tmp_path: Path) -> None:
    """The advice for a folder that cannot be created is no other name in the same folder, which is refused, too."""
    (tmp_path / "taken").write_text("a file")
    done = rattlebox("run", EXAMPLES / "steel_ball.toml", "-o", tmp_path / "taken" / "out")
    assert done.returncode == 2 and "in which you may write" in done.stderr
