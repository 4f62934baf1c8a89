"""The command plot: figures of studies on disk."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox.cli.main import main

EXAMPLE = Path(__file__).parents[3] / "examples" / "steel_ball.toml"
STARTS = {b"\x89PNG": "map.png", b"<?xml": "map.svg", b"%PDF": "map.pdf"}

Answer = Callable[..., tuple[int | str | None, str, str]]


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study over three axes."""
    store = tmp_path_factory.mktemp("study") / "study.zarr"
    case = rb.Case.from_file(EXAMPLE).model_copy(update={"duration": 0.2})
    axes = {
        "damper.gap": rb.linspace("0.1 mm", "1 mm", 8),
        "load.amplitude": rb.geomspace("1 kN", "5 kN", 7),
        "damper.start": [-1.0, 0.0],
    }
    rb.sweep(case, axes, ["impact_share", "impacts"], store=store, progress=False)
    return store


@pytest.fixture
def answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Answer:
    """Run the command in an empty folder; return its exit code, what it prints, and what it says."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> tuple[int | str | None, str, str]:
        monkeypatch.setattr(sys, "argv", ["rattlebox", "plot", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main()
        return stop.value.code or 0, *capsys.readouterr()

    return run


def test_writes_every_format(study: Path, answer: Answer) -> None:
    """A map or lines are written as PNG, SVG or PDF, and the file is told."""
    for begin, name in STARTS.items():
        at = ["--at", "damper.start=0", "--of", "impacts", "--kind", "map", "--size", "page"]
        assert answer(study, "-o", name, *at) == (0, f"written: {name}\n", "")
        assert Path(name).read_bytes().startswith(begin)
    some = ["--at", "damper.start=-1", "--at", "load.amplitude=5 kN"]
    assert answer(study, *some) == (0, "written: study.png\n", "")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "two axes can be drawn\n  try: at damper.start = -1"),
        (["--at", "damper.start"], 'try: --at "load.amplitude=5 kN"'),
        (["--at", "damper.strat=0"], "did you mean 'damper.start'"),
        (["--at", "damper.start=0", "--kind", "maps"], "did you mean 'map'"),
        (["--at", "damper.start=0", "--of", "impact"], "did you mean 'impacts'"),
        (["--size", "poster"], "column, page, slide"),
        (["--number", "2"], "--number 2: this applies to snapshots of a run, run.vtkhdf"),
        (["-o", "map.jpg"], ".png, .svg, .pdf"),
        (["-o", "nowhere/map.png"], "there is no folder nowhere"),
    ],
)
def test_clear_refusals(study: Path, answer: Answer, options: list[str], said: str) -> None:
    """What cannot be drawn ends with exit code 2 and what to try, and no file."""
    code, out, err = answer(study, *options)
    assert (code, out) == (2, "")
    assert said in err
    assert list(Path().iterdir()) == []


def test_the_value_that_is_taken_is_told(study: Path, answer: Answer) -> None:
    """Where the study lacks the value of --at, the nearest is drawn and told; one that it holds is not told."""
    near = ["--at", "damper.start=-0.9", "--at", "load.amplitude=4.5 kN"]
    told = (
        "damper.start = -1, the nearest to -0.9 in the study\n"
        "load.amplitude = 5 kN, the nearest to 4.5 kN in the study\n"
    )
    assert answer(study, *near, "-o", "a.png") == (0, f"{told}written: a.png\n", "")
    exact = ["--at", "damper.start=-1.0", "--at", "load.amplitude=5000"]
    assert answer(study, *exact, "-o", "b.png") == (0, "written: b.png\n", "")
    assert Path("a.png").read_bytes() == Path("b.png").read_bytes()


def test_the_usual_file_is_told(study: Path, answer: Answer) -> None:
    """Without -o a figure is study.png or run.png in the current folder; where that takes the place of a file it is told."""
    rb.simulate(rb.Case.from_file(EXAMPLE).model_copy(update={"duration": 0.05})).save("first.nc")
    at = ["--at", "damper.start=0", "--kind", "lines"]
    for name, arguments in (("study.png", [study, *at]), ("run.png", ["first.nc"])):
        assert answer(*arguments) == (0, f"written: {name}\n", "")
        Path(name).write_text("somebody's")
        told = f"written: {name}, in the place of an earlier one; -o names another file\n"
        assert answer(*arguments) == (0, told, "")
        assert Path(name).read_bytes().startswith(b"\x89PNG")
        assert answer(*arguments, "-o", name) == (0, f"written: {name}\n", "")


def test_figure_that_cannot_be_written(study: Path, answer: Answer) -> None:
    """The message names the file, the reason and what to try."""
    Path("a.png").mkdir()
    said = "error: a.png cannot be written: Is a directory\n  try: another folder\n"
    assert answer(study, "--at", "damper.start=0", "-o", "a.png") == (2, "", said)


def test_no_study(answer: Answer) -> None:
    """A folder that is not there is told."""
    assert answer("nothing.zarr")[0] == 2
