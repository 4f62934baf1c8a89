"""Errors of the package: their classes, their messages, and how the command line ends with them."""

import ast
import pickle
import re
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

import rattlebox as rb
from rattlebox.cli.commands import run_command
from rattlebox.cli.main import main
from rattlebox.model.files import read_toml

CASE = """
duration = "1 s"
structure = {{ kind = "sdof", mass = "1 kg", frequency = "10 Hz" }}
load = {{ kind = "record", file = "{file}", unit = "N" }}
{more}
"""


def _far_too_many_samples() -> Any:
    structure = rb.SDOF(mass=1.0, stiffness=1e4)
    return rb.Case(structure=structure, duration=1.0, output=rb.Output(rate=1e15))


@pytest.mark.parametrize(
    ("cause", "kind", "builtin"),
    [
        (lambda: rb.Box(size=(-1.0, 1.0, 1.0)), rb.CaseError, ValueError),
        (lambda: rb.load("nothing.nc"), rb.DataError, OSError),
        (lambda: rb.Snapshots("nothing.vtkhdf"), rb.DataError, ValueError),
        (lambda: rb.Record(file="nothing.csv", unit="N"), rb.DataError, ValueError),
        (lambda: rb.Matrices.from_file("nothing.npz"), rb.DataError, OSError),
        (lambda: rb.open_study("nothing.zarr"), rb.StoreError, OSError),
        (_far_too_many_samples, rb.ResourceError, ValueError),
    ],
)
def test_each_error_is_of_its_class(cause: Callable[[], Any], kind: type[Exception], builtin: type[Exception]) -> None:
    """An error is of one class of the package, and of the built-in class that programs expect; it survives pickling."""
    with pytest.raises(rb.RattleboxError) as caught:
        cause()
    assert type(caught.value) is kind
    assert isinstance(caught.value, builtin)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (type(again), str(again)) == (kind, str(caught.value))


def test_a_library_that_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The message names the library and the command that installs it."""
    from rattlebox._util.optional_imports import optional_import

    monkeypatch.setitem(sys.modules, "optuna", None)
    with pytest.raises(
        rb.MissingDependency, match=r"optuna.*\n  try: python -m pip install 'rattlebox\[design\]'"
    ) as caught:
        optional_import("optuna", "design")
    assert isinstance(caught.value, ImportError)


def test_a_message_has_its_parts() -> None:
    """An error is printed with its place first, then the complaint, then the advice."""
    error = rb.DataError("the file is empty", "another file", ["loads", 1, "file"])
    assert str(error) == "loads[1].file\n  the file is empty\n  try: another file"
    assert (error.complaint, error.suggestion, error.place) == (
        "the file is empty",
        "another file",
        ("loads", 1, "file"),
    )


@pytest.mark.parametrize(
    "arguments",
    [["run", "case.toml"], ["run", "nothing.toml"], ["show", "nothing"], ["show", "text.nc"], ["plot", "study.zarr"]],
)
def test_the_command_line_prints_errors_without_a_traceback(
    tmp_path: Path, arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Errors of every class end the program with exit code 2, a message, and nothing else."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["rattlebox", *arguments])
    (tmp_path / "case.toml").write_text(CASE.format(file="nothing.csv", more=""))
    (tmp_path / "text.nc").write_text("text")
    (tmp_path / "study.zarr").mkdir()
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    printed, error = capsys.readouterr()
    assert error.startswith("error: ")
    assert "Traceback" not in error
    assert printed == ""


@pytest.mark.parametrize("kind", [rb.CaseError, rb.DataError, rb.StoreError, rb.ResourceError, rb.MissingDependency])
def test_every_class_ends_the_command_alike(
    kind: type[rb.RattleboxError], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """For an error of any class, the command prints the message and ends with exit code 2."""

    def fails() -> None:
        raise kind("it is wrong", "something else")

    monkeypatch.setattr("rattlebox.cli.materials.show_materials", fails)
    monkeypatch.setattr(sys, "argv", ["rattlebox", "materials"])
    with pytest.raises(SystemExit) as end:
        run_command()
    assert end.value.code == 2
    assert capsys.readouterr().err == "error: it is wrong\n  try: something else\n"


def test_errors_carry_their_parts() -> None:
    """Place, complaint, allowed names and suggestion are data, also behind a file and after a pickle.

    Messages were put together by hand at 38 places and taken apart again: tests compared the text alone.
    """
    with pytest.raises(rb.CaseError) as caught:
        rb.Case.from_toml(
            'duration = "1 s"\n[structure]\nkind = "sdof"\nmas = "3 kg"\nfrequency = "2 Hz"', source="a.toml"
        )
    error = caught.value
    assert (error.place, error.suggestion) == (("structure", "mas"), "did you mean 'mass'?")
    assert error.complaint == "there is no such field here"
    assert {"mass", "stiffness"} <= set(error.allowed)
    assert str(error) == "a.toml: structure.mas = '3 kg'\n  there is no such field here\n  try: did you mean 'mass'?"
    behind = pickle.loads(pickle.dumps(error)).restated(rb.DataError, "b.toml")
    assert isinstance(behind, rb.DataError)
    assert str(behind) == f"b.toml: {error}"
    assert behind.without_suggestion == str(behind).partition("\n  try: ")[0]
    assert str(rb.CaseError("wrong", "right").restated(source="--rate")) == "--rate: wrong\n  try: right"


def test_suggestions_are_formatted_in_one_place() -> None:
    """No module of the package writes the line of a suggestion by hand, or takes a message apart at it."""
    folder = Path(rb.__file__).parent
    files = [path for path in folder.rglob("*.py") if path.name != "exceptions.py"]
    assert not [str(path) for path in files if re.search(r'\\n {2}try|["\']  try: ', path.read_text(encoding="utf-8"))]


ERRORS = {
    *("CaseError", "DataError", "StoreError", "ResourceError", "StepError", "MissingDependency", "RattleboxError"),
    "Hint",
}
PASSED_ON = {
    "cli/plot_run.py": 1,  # of a function of a figure, as it is
    "engines/stepper.py": 1,  # of a status, with its advice
    "prepare/variants.py": 1,  # of a variant
    "studies/basin_stability.py": 1,
    "studies/design/search.py": 1,  # of a design
    "studies/grid/axes.py": 3,
    "studies/grid/grid.py": 2,
    "studies/run/store.py": 2,
    "studies/run/study.py": 1,
}
"""Errors without a suggestion by file: they contain the text of another error with its own suggestion."""


def _raised(path: Path) -> list[ast.Call]:
    """Return the calls in a file that make an error."""
    calls = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Call)]
    return [call for call in calls if getattr(call.func, "id", getattr(call.func, "attr", "")) in ERRORS]


def test_every_error_has_a_suggestion() -> None:
    """Each error that the package raises says what to try, except where it passes on another one.

    Tests of messages looked at messages that they knew: 70 of 1200 errors, such as NaN in a field, had two parts only.
    """
    package = Path(rb.__file__).parent
    lacking: dict[str, int] = {}
    for path in package.rglob("*.py"):
        for call in _raised(path):
            third = (
                call.args[1]
                if len(call.args) > 1
                else next((keyword.value for keyword in call.keywords if keyword.arg == "suggestion"), None)
            )
            is_passed = any(isinstance(argument, ast.Starred) for argument in call.args)
            if not is_passed and (third is None or (isinstance(third, ast.Constant) and not third.value)):
                name = path.relative_to(package).as_posix()
                lacking[name] = lacking.get(name, 0) + 1
    assert lacking == PASSED_ON


@pytest.mark.parametrize(
    "text",
    [
        "x",
        "a = 1\na = 2",
        "[a]\n[a]",
        "a = [1, 2\nb = 3",
        'a = "b',
        "a = " + "[" * 5000,
        "a = {b = 1, b = 2}",
        "= 3",
        "a = b",
    ],
)
def test_every_error_of_toml_has_a_suggestion(text: str) -> None:
    """An error of TOML syntax says what to try, also without one of the usual slips, for which only there was advice."""
    with pytest.raises(rb.CaseError) as raised:
        read_toml(text, "case.toml")
    assert raised.value.suggestion


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1, 0, 1e400, "nan", True, "x", None, [], [[1], 2], {}])
def test_every_wrong_value_of_a_field_gets_a_suggestion(value: Any) -> None:
    """Any wrong value of fields of several kinds gets advice, as all messages must; those of limits of pydantic had none."""
    cases: list[Callable[[], object]] = [
        lambda: rb.Sphere(diameter=value, material="steel"),
        lambda: rb.Harmonic(amplitude=value, frequency=value),
        lambda: rb.Modal(masses=[1, 1], frequencies=value, damping_ratios=value, shapes={"tip": [1, 1]}),
        lambda: rb.Dem(fraction=value),
        lambda: rb.Box(size=(value, "1 mm", "1 mm")),
        lambda: rb.Record(times=[0, 1], values=value, unit="N"),
        lambda: rb.SDOF(mass=1, frequency="10 Hz", damping_ratio=value),
        lambda: rb.Case(structure=rb.SDOF(mass=1, frequency="10 Hz"), duration=value),
    ]
    for make in cases:
        with suppress(rb.RattleboxError):
            make()
            continue
        with pytest.raises(rb.RattleboxError) as raised:
            make()
        assert all("try: " in part for part in re.split(r"\n(?!  )", str(raised.value))), str(raised.value)
