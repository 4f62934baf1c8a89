"""Tests of `rattlebox plot`: figures of studies on disk."""

from functools import partial
from pathlib import Path

import pytest

import rattlebox as rb

from .conftest import RunCli

EXAMPLE = Path(__file__).parents[3] / "examples" / "steel_ball.toml"
SIGNATURES = {b"\x89PNG": "map.png", b"<?xml": "map.svg", b"%PDF": "map.pdf"}


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a study over three axes."""
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
def plot(run_cli: RunCli) -> RunCli:
    """Return a function that runs `rattlebox plot` in an empty folder."""
    return partial(run_cli, "plot")


def test_writes_every_format(study: Path, plot: RunCli) -> None:
    """Maps and lines are written as PNG, SVG or PDF, and the name of the file is printed."""
    for signature, name in SIGNATURES.items():
        at = ["--at", "damper.start=0", "--of", "impacts", "--kind", "map", "--size", "page"]
        assert plot(study, "-o", name, *at) == (0, f"written: {name}\n", "")
        assert Path(name).read_bytes().startswith(signature)
    some = ["--at", "damper.start=-1", "--at", "load.amplitude=5 kN"]
    assert plot(study, *some) == (0, "written: study.png\n", "")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "two axes can be drawn\n  try: at damper.start = -1"),
        (["--at", "damper.start"], 'try: --at "load.amplitude=5 kN"'),
        (["--at", "damper.strat=0"], "did you mean 'damper.start'"),
        (["--at", "damper.start=0", "--kind", "maps"], "did you mean 'map'"),
        (["--at", "damper.start=0", "--of", "impact"], "did you mean 'impacts'"),
        (["--size", "poster"], "column, page, slide"),
        (["--number", "2"], "which has no snapshots"),
        (["-o", "map.jpg"], ".png, .svg, .pdf"),
        (["-o", "nowhere/map.png"], "the folder nowhere does not exist"),
    ],
)
def test_options_that_do_not_apply(study: Path, plot: RunCli, options: list[str], message: str) -> None:
    """A figure that cannot be drawn ends with exit code 2 and a suggestion, and no file is written."""
    code, out, err = plot(study, *options)
    assert (code, out) == (2, "")
    assert message in err
    assert list(Path().iterdir()) == []


def test_the_nearest_value_is_printed(study: Path, plot: RunCli) -> None:
    """For a value of --at that is not in the study, the nearest one is drawn and printed."""
    near = ["--at", "damper.start=-0.9", "--at", "load.amplitude=4.5 kN"]
    code, printed, errors = plot(study, *near, "-o", "a.png")
    start, amplitude, written = printed.splitlines()
    assert (code, written, errors) == (0, "written: a.png", "")
    assert start.startswith("damper.start = -1,") and amplitude.startswith("load.amplitude = 5 kN,")
    exact = ["--at", "damper.start=-1.0", "--at", "load.amplitude=5000"]
    assert plot(study, *exact, "-o", "b.png") == (0, "written: b.png\n", "")
    assert Path("a.png").read_bytes() == Path("b.png").read_bytes()


def test_default_file(study: Path, plot: RunCli) -> None:
    """Without -o the file is study.png or run.png in the current folder; replacing an existing file is printed."""
    rb.simulate(rb.Case.from_file(EXAMPLE).model_copy(update={"duration": 0.05})).save("first.nc")
    at = ["--at", "damper.start=0", "--kind", "lines"]
    for name, arguments in (("study.png", [study, *at]), ("run.png", ["first.nc"])):
        assert plot(*arguments) == (0, f"written: {name}\n", "")
        code, printed, errors = plot(*arguments)
        assert (code, errors) == (0, "") and printed.startswith(f"written: {name} (replaced")
        Path(name).write_text("somebody's")
        assert plot(*arguments, "-o", name) == (0, f"written: {name}\n", "")
        assert Path(name).read_bytes().startswith(b"\x89PNG")


def test_figure_that_cannot_be_written(study: Path, plot: RunCli) -> None:
    """The message contains the file, the reason and a suggestion."""
    Path("a.png").mkdir()
    message = "error: a.png cannot be written: Is a directory\n  try: another folder\n"
    assert plot(study, "--at", "damper.start=0", "-o", "a.png") == (2, "", message)


def test_no_study(plot: RunCli) -> None:
    """A folder that does not exist ends with exit code 2."""
    assert plot("nothing.zarr")[0] == 2
