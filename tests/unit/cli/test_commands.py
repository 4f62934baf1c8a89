"""The commands, run as a user runs them."""

import json
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import pytest

import rattlebox as rb
from rattlebox.cli import commands

from .conftest import Answer

EXAMPLES = Path(__file__).parents[3] / "examples"


def rattlebox(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Run the command in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "rattlebox.cli", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def test_run_writes_what_it_says(tmp_path: Path) -> None:
    """A case file gives a summary, a netCDF file that loads equal in size, CSV, MAT and figures."""
    done = rattlebox("run", EXAMPLES / "steel_ball.toml", "-o", tmp_path, "--csv", "--mat")
    assert done.returncode == 0, done.stderr
    assert "impacts" in done.stdout
    run = rb.load(tmp_path / "run.nc")
    assert run.ok
    assert run.energy_residual < 1e-10
    for name in ("run.mat", "motion.csv", "energy.csv", "impacts.csv", "motion.png", "energy.png", "impacts.png"):
        assert (tmp_path / name).stat().st_size > 0


def test_run_states_the_unit_that_a_record_lacks(tmp_path: Path, answer: Answer) -> None:
    """The unit assumed for a record without one is printed with its peak in g, and so is the loss of a coarse record."""
    rows = "".join(f"{k / 100},{(-1) ** (k // 3)}\n" for k in range(101))
    (tmp_path / "quake.csv").write_text("t,a\n" + rows)
    (tmp_path / "quake.toml").write_text(
        "duration = 1\n[structure]\nkind = 'sdof'\nmass = 1\nstiffness = '11 kN/m'\ndamping_ratio = 0.02\n"
        "[base]\nkind = 'record'\nfile = 'quake.csv'\n"
    )
    code, printed, error = answer("run", tmp_path / "quake.toml", "-o", tmp_path / "out")
    assert code == 0, error
    printed = " ".join(printed.split())
    assert "m/s^2 is assumed, with a peak of 1 m/s^2 = 0.102 g" in printed
    assert "straight lines" in printed


def test_demo_sets_both_models_side_by_side(tmp_path: Path, answer: Answer) -> None:
    """The demo prints one column a model and leaves a figure and netCDF and case files that reproduce its runs."""
    code, printed, error = answer("demo", "-o", tmp_path)
    assert code == 0, error
    assert "constant alpha" in printed
    assert "Jackson-Green" in printed
    assert (tmp_path / "demo.png").stat().st_size > 10_000
    again = rb.simulate(rb.Case.from_file(tmp_path / "jackson_green.toml"))
    assert again.arrays.impacts == rb.load(tmp_path / "jackson_green.nc").arrays.impacts


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("duration = 1\n[structure]\nkind = 'sdof'\nmass = '-1 kg'\nstiffness = 1\n", "greater than zero"),
        ("duration = 1\n[structure]\nkind = 'sdof'\nmas = '1 kg'\nstiffness = 1\n", "did you mean 'mass'"),
        ("duration = \n", "not TOML"),
    ],
)
def test_bad_case_is_told_on_one_screen(tmp_path: Path, text: str, said: str, answer: Answer) -> None:
    """Bad input names the file and what is wrong, with exit code 2 and no traceback."""
    path = tmp_path / "bad.toml"
    path.write_text(text)
    code, _, error = answer("run", path)
    assert code == 2
    assert "bad.toml" in error
    assert said in error
    assert "Traceback" not in error
    assert len(error.splitlines()) < 24


def test_missing_file_and_unknown_option_are_told(answer: Answer) -> None:
    """A file that is not there and an option that does not exist end with exit code 2 and no traceback."""
    for arguments in (("run", "nowhere.toml"), ("run", "--sideways"), ("fly",)):
        code, _, error = answer(*arguments)
        assert code == 2
        assert "Traceback" not in error


def test_help_tells_what_particles_draw(answer: Answer) -> None:
    """The help of run names impacts as figures of impact dampers only."""
    told = " ".join(answer("run", "--help")[1].replace("│", " ").split())
    assert "Draw motion and energy, and the impacts of impact dampers." in told


@pytest.mark.parametrize("command", ["run", "sweep", "plot"])
def test_a_second_argument_suggests_the_option_for_output(command: str, answer: Answer) -> None:
    """A second argument is refused with exit code 2 and the command line that names it as the output."""
    code, printed, error = answer(command, "one.toml", "two")
    assert (code, printed) == (2, "")
    assert f"rattlebox {command} one.toml -o two" in error


@pytest.mark.parametrize("command", [(), ("run",), ("sweep",), ("plot",)])
def test_help_shows_no_type_for_flags(command: tuple[str, ...], answer: Answer) -> None:
    """Options that take no value have no type in the help; other options have theirs."""
    _, printed, _ = answer(*command, "--help")
    assert "--help" in printed
    assert "bool" not in printed
    assert not command or "<path>" in printed


def test_figures_of_a_run_load_no_xarray() -> None:
    """Figures of a run do without xarray, which takes longer to load than they take to draw."""
    script = (
        "import sys, rattlebox as rb; run = rb.simulate(rb.Case.from_file(sys.argv[1]));"
        "run.plot.motion(); run.plot.energy(); run.plot.impacts(); print('xarray' in sys.modules)"
    )
    command = [sys.executable, "-c", script, str(EXAMPLES / "steel_ball.toml")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "False\n", done.stderr


def test_schema_is_a_schema(tmp_path: Path, answer: Answer) -> None:
    """The exported schema is JSON and knows the structures."""
    assert answer("schema", "-o", tmp_path / "schema.json")[0] == 0
    schema = json.loads((tmp_path / "schema.json").read_text())
    assert {"SDOF", "Modal", "Matrices"} <= set(schema["$defs"])


def test_schema_that_cannot_be_written_is_told(tmp_path: Path, answer: Answer) -> None:
    """The message names the file, the reason and what to try."""
    code, _, error = answer("schema", "-o", tmp_path)
    assert code == 2
    assert error == f"error: {tmp_path} cannot be written: Is a directory\n  try: another folder\n"


def test_doctor_and_materials_say_what_they_have(monkeypatch: pytest.MonkeyPatch, answer: Answer) -> None:
    """Doctor names the core and why; materials lists the library, in a narrow terminal on some two screens."""
    assert "core" in answer("doctor")[1]
    monkeypatch.setenv("COLUMNS", "80")
    shown = answer("materials")[1]
    assert "tungsten_carbide" in shown
    assert len(shown.splitlines()) < 80


def test_speed_beyond_a_law_ends_with_a_status() -> None:
    """An impact above the last speed of Jackson-Green keeps what was computed and says what to try."""
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
    freely = rb.JacksonGreen(extrapolate=True)
    damper = case.dampers[0].model_copy(update={"contact": rb.Tsuji(restitution=freely)})
    assert rb.simulate(case.model_copy(update={"dampers": (damper,), "duration": 1.2e-5})).counts["extrapolated"] == 1


def test_budget_of_events_ends_with_a_status() -> None:
    """A run that spends its events keeps what it has and says so."""
    case = rb.Case.from_file(EXAMPLES / "steel_ball.toml").model_copy(update={"method": rb.EventDriven(max_events=20)})
    run = rb.simulate(case)
    assert run.status == "too_many_events"
    assert 0 < len(run.arrays.impacts) < 20


PRESSED = """
import os, signal, sys

class Press:
    def find_spec(self, name, path=None, target=None):
        if name == module:
            sys.meta_path.remove(self)
            os.kill(os.getpid(), signal.SIGINT)

module, sys.argv = sys.argv[1], ["rattlebox", *sys.argv[2:]]
sys.meta_path.insert(0, Press())
from rattlebox.cli.main import main
main()
"""


@pytest.mark.parametrize("module", ["typer", "numpy", "rattlebox.model.case", "rattlebox.engines.simulate"])
def test_ctrl_c_while_modules_load_is_quiet(module: str, tmp_path: Path) -> None:
    """Ctrl-C before anything is computed, be it while modules load, ends with exit code 130 and one word."""
    case = EXAMPLES / "steel_ball.toml"
    command = [sys.executable, "-c", PRESSED, module, "run", str(case), "-o", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "stopped\n")


def test_the_package_loads_what_is_used() -> None:
    """The package itself loads nothing, so that commands begin at once; every public name is there when it is used."""
    script = (
        "import sys, rattlebox; light = not {'numpy', 'pydantic'} & sys.modules.keys();"
        "print(light, all(getattr(rattlebox, name) is not None for name in rattlebox.__all__))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "True True\n", done.stderr


def test_errors_without_a_file_are_told_plainly(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What the system refuses is told with its file if there is one, and without a gap if there is none."""
    for error, said in ((OSError("no such thing"), "no such thing"), (OSError(5, "odd", "a.nc"), "a.nc: odd")):
        monkeypatch.setattr(commands, "app", Mock(side_effect=error))
        with pytest.raises(SystemExit, match="2"):
            commands.carry_out()
        assert capsys.readouterr().err == f"error: {said}\n"
