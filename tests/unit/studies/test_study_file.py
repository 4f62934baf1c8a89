"""Study files: contents and errors."""

from __future__ import annotations

from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.grid.sampling import RandomDesign, Replicas
from rattlebox.studies.study_file import read_study, study_from_toml

EXAMPLES = Path(__file__).parents[3] / "examples"
BALL = 'case = "steel_ball.toml"\n'
GAPS = '[axes]\n"damper.gap" = ["1 mm", "2 mm"]\n'
INLINE = """\
[case]
duration = "1 s"
structure = { kind = "sdof", mass = "20 kg", stiffness = "80 kN/m" }

[case.damper]
gap = "0.4 mm"
ball = { radius = "33.17 mm", material = "oak" }
contact = { kind = "tsuji", restitution = 0.5 }

[case.materials.oak]
density = 700
young = "10 GPa"
poisson = 0.3

[case.materials.cork]
density = 200
young = "30 MPa"
poisson = 0.0
"""


def refused(content: str) -> str:
    """Return the error message of a study file, which must be short."""
    with pytest.raises(rb.CaseError) as caught:
        study_from_toml(content, source="study.toml", folder=EXAMPLES)
    message = str(caught.value)
    assert message.startswith("study.toml: ")
    assert len(message.splitlines()) <= 24
    return message


def test_a_study_file_equals_a_call() -> None:
    """Case, axes in their order and options are those of the equivalent call of sweep."""
    study = study_from_toml(
        'measure = ["impacts", "impact_share"]\nskip = "100 ms"\nworkers = 2\n'
        + BALL
        + """
[axes]
"load.amplitude" = ["1 kN", "5 kN"]
"damper.gap" = { from = "0.1 mm", to = "2 mm", count = 20 }
"structure.mass" = { from = 1, to = "100 kg", count = 3, spacing = "log" }
"damper.ball.material" = ["steel", "brass"]
""",
        folder=EXAMPLES,
    )
    axes = {
        "load.amplitude": ["1 kN", "5 kN"],
        "damper.gap": rb.linspace("0.1 mm", "2 mm", 20),
        "structure.mass": rb.geomspace(1, "100 kg", 3),
        "damper.ball.material": ["steel", "brass"],
    }
    assert study.case == rb.Case.from_file(EXAMPLES / "steel_ball.toml")
    assert (study.measure, study.skip, study.workers) == (["impacts", "impact_share"], 0.1, 2)
    assert read_axes(study.case, study.axes).describe() == read_axes(study.case, axes).describe()


def test_one_measure_needs_no_list() -> None:
    """A single measure may be given by its name."""
    assert study_from_toml('measure = "impacts"\n' + BALL + GAPS, folder=EXAMPLES).measure == ["impacts"]


def test_paths_need_no_quotes() -> None:
    """Dotted keys without quotes are read as paths, also in linked axes, ranges and reaches."""
    bare = """
[axes]
damper.gap = { from = "0.1 mm", to = "2 mm", count = 3 }
damper.contact.restitution = [0.5, 0.9]
duration = [1, 2]
[axes.level]
load.amplitude = ["1 kN", "5 kN"]
structure.mass = [10, 20]
[design]
count = 4
ranges = { load.duration = ["1 ms", "2 ms"] }
[replicas]
count = 3
[replicas.reach]
damper.start = "1 um"
"""
    quoted = bare
    for path in ("damper.gap", "damper.contact.restitution", "load.amplitude", "structure.mass", "load.duration"):
        quoted = quoted.replace(f"{path} =", f'"{path}" =')
    one, other = (study_from_toml(BALL + text, folder=EXAMPLES) for text in (bare, quoted))
    design = read_axes(one.case, one.axes)
    assert design.describe() == read_axes(other.case, other.axes).describe()
    assert design.dims == ("damper.gap", "damper.contact.restitution", "duration", "level", "sample", "replica")


def test_random_designs_and_replicas_are_read() -> None:
    """The tables have the arguments of random_design and replicas."""
    study = study_from_toml(
        BALL
        + """
[design]
count = 16
method = "lhs"
seed = 5
log = ["damper.gap"]
ranges = { "damper.gap" = ["0.1 mm", "2 mm"], "duration" = [1, 2] }

[replicas]
count = 8
seed = 7
reach = { "damper.start" = "1 um" }
""",
        folder=EXAMPLES,
    )
    assert study.axes == [
        RandomDesign({"damper.gap": ["0.1 mm", "2 mm"], "duration": [1, 2]}, 16, "lhs", 5, ("damper.gap",)),
        Replicas({"damper.start": "1 um"}, 8, 7),
    ]


def test_a_case_in_the_study_file_with_its_materials() -> None:
    """A case may be a table of the study file, and its materials may be values of axes."""
    axes = '[axes]\n"damper.ball.material" = ["steel", "oak", "cork"]\n"damper.wall" = ["rigid", "cork"]\n'
    study = study_from_toml(INLINE + axes, folder=EXAMPLES)
    last = read_axes(study.case, study.axes).case_at(study.case, 5).dampers[0]
    assert last.balls[0].material.density == 200
    assert last.wall == last.balls[0].material


def test_paths_are_relative_to_the_folder_of_the_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The path of a case is relative to the study file, and axes may use the materials of the case."""
    (tmp_path / "cases").mkdir()
    (tmp_path / "cases" / "oak.toml").write_text(INLINE.replace("[case]\n", "").replace("[case.", "["))
    (tmp_path / "study.toml").write_text(
        '[case]\nfile = "cases/oak.toml"\n[axes]\n"damper.ball.material" = ["oak", "cork"]\n'
    )
    monkeypatch.chdir(EXAMPLES)
    study = read_study(tmp_path / "study.toml")
    assert study.case.dampers[0].balls[0].material.name == "oak"
    assert read_axes(study.case, study.axes).case_at(study.case, 1).dampers[0].balls[0].material.name == "cork"


@pytest.mark.parametrize(
    ("content", "pattern"),
    [
        ("", ["case", "this field is needed"]),
        ("x", ["not TOML"]),
        (BALL, ["nothing varies", "[axes]"]),
        (GAPS, ["case", "this field is needed"]),
        ('case = "steel_bal.toml"\n' + GAPS, ["case.file = 'steel_bal.toml'", "there is no file", "steel_ball.toml"]),
        ("case = 3\n" + GAPS, ["case", "the name of a file or a case"]),
        ('[case]\nfile = "steel_ball.toml"\nduration = 3\n' + GAPS, ["case", "not both"]),
        (INLINE.replace('"20 kg"', '"-20 kg"') + GAPS, ["case: structure.mass = '-20 kg'", "greater than zero"]),
        (INLINE.replace("mass", "mas") + GAPS, ["case: structure.mas", "did you mean 'mass'?"]),
        ('mesure = ["impacts"]\n' + BALL + GAPS, ["mesure = ['impacts']", "did you mean 'measure'?"]),
        ('measure = ["impacts", "impactz"]\n' + BALL + GAPS, ["measure[1] = 'impactz'", "did you mean 'impacts'"]),
        ('measure = "impactz"\n' + BALL + GAPS, ["measure = 'impactz'", "did you mean 'impacts'"]),
        ("measure = 3\n" + BALL + GAPS, ["measure = 3", "is not the name of a measure"]),
        (BALL + '[axes]\n"damper.gap" = "1 mm"', ["axes.damper.gap = '1 mm'", 'a list is needed\n  try: ["1 mm"]']),
        (
            'measure = ["peak", "peak"]\n' + BALL + GAPS,
            ["measure = ['peak', 'peak']", "two measures have the name peak"],
        ),
        ("workers = 0\n" + BALL + GAPS, ["workers = 0", "at least 1"]),
        ('skip = "1 kg"\n' + BALL + GAPS, ["skip = '1 kg'", "a time (s) is needed, not a mass"]),
        ("cycles = 3\n" + BALL + GAPS, ["cycles = 3", "two whole numbers"]),
        (BALL + "axes = 3", ["axes = 3", "a table is needed"]),
        (BALL + '[axes]\n"damper.gap" = "1 mm"', ["axes.damper.gap = '1 mm'", "a list is needed"]),
        (BALL + '[axes]\n"damper.gapp" = ["1 mm"]', ["damper.gapp", "did you mean 'gap'?"]),
        (BALL + '[axes]\n"damper.gap" = ["1 mm", "2 kg"]', ["damper.gap[1] = '2 kg'", "not a mass"]),
        (BALL + '[axes]\n"damper.gap" = []', ["damper.gap", "there are no values"]),
        (BALL + '[axes]\n"damper.gap" = {}', ["axes.damper.gap.from", "this field is needed"]),
        (
            BALL + '[axes]\n"damper.gap" = { from = "1 mm", too = "2 mm", count = 3 }',
            ["axes.damper.gap.too", "did you mean 'to'?"],
        ),
        (
            BALL + '[axes]\n"damper.gap" = { from = "1 mm", to = "2 mm", count = 0 }',
            ["axes.damper.gap.count = 0", "at least 1"],
        ),
        (
            BALL + '[axes]\n"damper.gap" = { from = "1 mm", to = "2 mm", count = 3, spacing = "lin" }',
            ["axes.damper.gap.spacing = 'lin'", '"linear"'],
        ),
        (
            BALL + '[axes]\n"damper.gap" = { from = "1 mm", to = "2 kg", count = 3 }',
            ["damper.gap, to = '2 kg'", "not a mass"],
        ),
        (BALL + '[axes]\n"damper.start" = [0, 2]', ["variant 1 is not valid", "inside a wall"]),
        (BALL + '[axes]\n"damper.gap" = ["1 mm"]\ndamper.gap = ["1 mm"]', ["damper.gap is given twice"]),
        (BALL + "[axes]\nloads[0].amplitude = [1]", ["not TOML", "quotes around a path", '"loads[0].amplitude"']),
        (BALL + '[axes.level]\n"damper.gap" = [1e-3]\nduration = [1, 2]', ["same number of values"]),
        (BALL + '[axes.level]\n"damper.gap" = "1 mm"', ["axes.level.damper.gap = '1 mm'", "a list is needed"]),
        (BALL + '[design]\nranges = { "damper.gap" = [0, 1] }', ["design.count", "this field is needed"]),
        (BALL + '[design]\ncount = 4\nrange = { "damper.gap" = [0, 1] }', ["design.range", "did you mean 'ranges'?"]),
        (
            BALL + '[design]\ncount = 4\nmethod = "sob"\nranges = { "damper.gap" = [0, 1] }',
            ["design.method = 'sob'", '"sobol"'],
        ),
        (BALL + '[design]\ncount = 4\nlog = ["x"]\nranges = { duration = [1, 2] }', ["log = 'x'", "duration"]),
        (
            BALL + '[replicas]\ncount = 4\nreach = { "damper.start" = "-1 um" }',
            ["reach = '-1 um'", "greater than zero"],
        ),
        (BALL + '[replicas]\ncount = 4\nreach = "1 um"', ["replicas.reach = '1 um'", "a table is needed"]),
    ],
)
def test_bad_study_files_are_refused_with_the_place_and_a_reason(content: str, pattern: list[str]) -> None:
    """Each wrong study file is refused with the file, the field, the value and the allowed values."""
    message = refused(content)
    for word in pattern:
        assert word in message, message


def test_unreadable_study_files_are_refused(tmp_path: Path) -> None:
    """Missing files, folders and files that are not text are refused."""
    with pytest.raises(rb.CaseError, match="there is no file"):
        read_study(tmp_path / "study.toml")
    with pytest.raises(rb.CaseError, match="is a folder"):
        read_study(tmp_path)
    (tmp_path / "study.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(rb.CaseError, match="UTF-8"):
        read_study(tmp_path / "study.toml")
