"""What other packages add: the modules of docs/developing/extending.md as an installed package, used in every way."""

from __future__ import annotations

import json
import os
import re
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

PAGE = Path(__file__).parents[2] / "docs" / "developing" / "extending.md"
CASE = """
duration = "50 ms"
structure = { kind = "sdof", mass = "1 kg", frequency = "20 Hz", velocity = "0.5 m/s" }
[damper]
kind = "particle"
particles = { material = "steel", diameter = "5 mm", count = 30 }
cavity = { kind = "prism", side = "50 mm", length = "35 mm" }
contact = { kind = "tsuji", restitution = 0.7 }
softening = 100
"""
SWINGING = """
duration = "1.5 s"
structure = { kind = "pendulum", mass = "2 kg", length = "300 mm", displacement = "1 mm" }
damper = { kind = "impact", ball = { diameter = "20 mm", material = "porcelain" }, wall = "porcelain", gap = "2 mm", \
contact = { kind = "tsuji", restitution = 0.6 } }
load = { kind = "harmonic", amplitude = "3 N", frequency = "1.1 Hz" }
"""
SHAKEN = """
duration = "40 ms"
structure = { kind = "sdof", mass = "1 kg", frequency = "20 Hz" }
base = { kind = "record", file = "scope.osc" }
damper = { kind = "impact", ball = { diameter = "20 mm", material = "porcelain" }, wall = "steel", gap = "2 mm", \
contact = { kind = "tsuji", restitution = 0.6 } }
"""
STUDY = """
kind = "load_levels"
case.file = "swinging.toml"
amplitudes = ["2 N", "3 N", "5 N"]
measure = ["rms", "time_of_peak"]
"""


def modules() -> dict[str, str]:
    """Return the modules of the page by their path."""
    blocks = re.findall(r"^\*\*`(my_package/\w+\.py)`\*\*\n\n```python\n(.*?)```", PAGE.read_text("utf-8"), re.M | re.S)
    return dict(blocks)


def install(folder: Path, package: str, files: dict[str, str], points: str) -> None:
    """Install a package: its modules, and the metadata with its entry points."""
    for name, content in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(content, encoding="utf-8")
    (folder / package / "__init__.py").touch()
    info = folder / f"{package}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[rattlebox.plugins]\n{points}")


@pytest.fixture(scope="module")
def plugin(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder in which the modules of the page are installed with their entry points."""
    folder = tmp_path_factory.mktemp("plugin")
    (entry,) = re.findall(
        r"```toml\n\[project\.entry-points\.\"rattlebox\.plugins\"\]\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL
    )
    install(folder, "my_package", modules(), entry.replace('"', ""))
    for name, text in (("case", CASE), ("swinging", SWINGING), ("shaken", SHAKEN), ("study", STUDY)):
        (folder / f"{name}.toml").write_text(text)
    values = (300 * np.sin(np.arange(60) * 0.2)).astype("<f4")
    content = b"OSC1" + struct.pack("<d", 1e-3) + b"gal     " + values.tobytes()
    (folder / "scope.osc").write_bytes(content)
    (folder / "scope.dat").write_bytes(content)
    return folder


def program(folder: Path, code: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Run a program in which the plug-ins of a folder are installed."""
    return _run(folder, sys.executable, *(options or ("-W", "error")), "-c", code)


def rattlebox(folder: Path, *commands: str) -> list[tuple[int, str, str]]:
    """Run commands one after the other in one process with the plug-ins of a folder; return exit codes and outputs."""
    done = _run(folder, sys.executable, "-c", _COMMANDS, *commands)
    assert done.returncode == 0, done.stderr
    return [(code, out, error) for code, out, error in json.loads(done.stdout)]


_COMMANDS = """
import contextlib, io, json, sys
from rattlebox.cli.commands import run_command
results = []
for command in sys.argv[1:]:
    sys.argv = ["rattlebox", *command.split()]
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        try: run_command()
        except SystemExit as end: code = end.code or 0
    results.append((code, out.getvalue(), error.getvalue()))
print(json.dumps(results))
"""


def _run(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": str(folder), "COLUMNS": "120"}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_each_thing_takes_as_many_files_as_the_page_says() -> None:
    """The page's table of files counts the modules that the page shows; a cavity once took nine files, not four."""
    table = dict(re.findall(r"^\| (an? [^|]+?) \| (\d) \|", PAGE.read_text("utf-8"), re.M))
    stems = {
        "a cavity between planes": ["prism"],
        "a structure": ["pendulum"],
        "a reader of records or modes": ["oscilloscope"],
        "a material": ["porcelain"],
        "a measure": ["measures"],
        "a kind of study with its figure": ["load_levels", "load_levels_figure"],
        "a figure of runs": ["speed"],
        "a command": ["frequencies"],
    }
    assert {name: int(count) for name, count in table.items() if name in stems} == {
        name: len(files) for name, files in stems.items()
    }
    assert sorted(modules()) == sorted(f"my_package/{stem}.py" for files in stems.values() for stem in files)
    assert table["a normal contact law in C++"] == "2"  # test_new_law.py


def test_a_cavity_of_another_package_runs_and_is_shown(plugin: Path) -> None:
    """Run, drawing, picture, report, snapshots and browser show a prism, by its own words and edges, and none a sphere.

    An unknown cavity was once drawn and exported as a sphere; no test had added a kind.
    """
    result = program(
        plugin,
        """
import numpy as np, rattlebox as rb
from rattlebox.app import views
case = rb.Case.from_file("case.toml")
run = rb.simulate(case, progress=False)
assert run.status == "finished", run.status
cavity = case.particle_dampers[0].cavity
assert (cavity.depth(run.particles.position.values) > 0).all()
assert abs(cavity.volume - np.sqrt(3) / 4 * 0.05**2 * 0.035) < 1e-12 * 0.05**3, cavity.volume
figure = rb.plot_case(case)
words = " ".join(text.get_text() for axes in figure.axes for text in axes.texts)
assert "triangular prism, 50 mm wide, 35 mm long" in words and "sphere" not in words, words
assert "43.3 mm" in words, words  # its height
run.plot.particles().savefig("picture.png")
rb.write_report(run, "report.html")
report = open("report.html").read()
assert "triangular prism" in report
edges = views._cavities(case)[0]
assert len(edges["sharp"]) == 9 * 6 and not edges["smooth"]
assert rb.Case.from_toml(case.to_toml()) == case
assert case.replaced({"damper.cavity.side": "52 mm"}).particle_dampers[0].cavity.side == 0.052
""",
    )
    assert result.returncode == 0, result.stderr


def test_structure_reader_material_and_figure_work_in_python(plugin: Path) -> None:
    """A run with parts of another package has their modes, numbers, units and words; none had been used outside tests."""
    result = program(
        plugin,
        """
import numpy as np, rattlebox as rb
case = rb.Case.from_file("swinging.toml")
assert abs(case.structure.natural_frequencies[0] - np.sqrt(9.80665 / 0.3) / (2 * np.pi)) < 1e-12
assert case.impact_dampers[0].balls[0].material is rb.materials()["porcelain"]
run = rb.simulate(case, progress=False)
assert run.ok and abs(run.motion.displacement.values[0, 0] - 1e-3) < 1e-15
assert "speed" in dir(run.plot)
run.plot.speed().savefig("speed.png")
rb.write_report(run, "swinging.html")
assert "pendulum of 0.3 m" in open("swinging.html").read()
rb.plot_case(case).savefig("case.png")
assert rb.Case.from_toml(case.to_toml()) == case
for file in ("scope.osc", "scope.dat"):  # by its ending, by its first bytes
    record = rb.Record(file=file, columns=["channel 1"])
    assert record.unit == "m/s^2" and len(record.times) == 60 and record.times[1] == 1e-3
    assert abs(record.peak - 3.0 * np.abs(np.sin(np.arange(60) * 0.2)).max()) < 1e-6, record.peak
shaken = rb.simulate(rb.Case.from_file("shaken.toml"), progress=False)
assert shaken.ok and abs(shaken.motion.base_acceleration).max() > 2.9
try: rb.Record(file="scope.osc", columns=[2])
except rb.DataError as error: assert "no time history 2, but channel 1" in str(error)
else: raise AssertionError
from my_package.load_levels import load_levels
study = load_levels(case, ["2 N", "4 N"], ["rms", "time_of_peak"], progress=False)
assert study.attrs["study"] == "load_levels" and study.time_of_peak.attrs["units"] == "s"
assert study.time_of_peak.attrs["long_name"] == "time of the largest displacement"
swept = rb.sweep(case, {"damper.gap": ["1 mm", "2 mm"]}, "time_of_peak", progress=False)
assert np.isfinite(swept.time_of_peak).all()
""",
    )
    assert result.returncode == 0, result.stderr


def test_study_figure_measure_and_command_work_in_the_command_line(plugin: Path) -> None:
    """A study file of a kind of another package runs, resumes, is shown, drawn and reported, and its command is in the help.

    Kinds of figures were found by the spelling of their names, so that a kind without such a name ended in a traceback.
    """
    results = rattlebox(
        plugin,
        "sweep study.toml -o levels.zarr",
        "sweep study.toml -o levels.zarr",
        "show levels.zarr",
        "plot levels.zarr -o levels.png",
        "plot levels.zarr -o levels2.png --kind levels",
        "report levels.zarr -o levels.html",
        "run swinging.toml -o swinging --no-figures",
        "plot swinging --kind speed -o speed2.png",
        "plot swinging --kind speeed -o speed3.png",
        "--help",
        "frequencies swinging.toml",
        "materials",
        "doctor",
    )
    assert [code for code, _, _ in results] == [0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 0], results
    _, again, shown, _, other, _, _, _, refused, listed, frequencies, materials, doctor = results
    assert "3 variants: 3 finished" in again[1]
    assert "load levels, 3 variants" in shown[1] and "time of the largest displacement" in shown[1]
    assert (plugin / "levels.png").stat().st_size > 10_000 and "load_levels" in other[2]
    text = (plugin / "levels.html").read_text("utf-8")
    assert "pendulum" in text and "time of the largest displacement" in text
    assert (plugin / "speed2.png").stat().st_size > 10_000 and "did you mean 'speed'?" in refused[2]
    assert "Print the natural frequencies of the structure" in listed[1]
    assert frequencies[1] == "mode 1: 0.909955 Hz\n"
    assert "porcelain" in materials[1] and "plug-in load_levels" in doctor[1]


def test_messages_list_what_other_packages_add(plugin: Path) -> None:
    """An unknown kind, material, measure or kind of study is refused with those of plug-ins among the allowed ones."""
    (plugin / "scope.xyz").write_text("1")
    result = program(
        plugin,
        """
import rattlebox as rb
from pathlib import Path
from rattlebox.studies.study_file import study_from_toml
def refuse(read, text, name, wrong):
    assert name in text
    try: read(text.replace(name, wrong))
    except rb.RattleboxError as error: return str(error)
    raise AssertionError(wrong)
case, swinging, study = (Path(f"{name}.toml").read_text() for name in ("case", "swinging", "study"))
assert "did you mean 'prism'?" in refuse(rb.Case.from_toml, case, '"prism"', '"prizm"')
assert "pendulum" in refuse(rb.Case.from_toml, swinging, '"pendulum"', '"swing"')
assert "did you mean 'porcelain'?" in refuse(rb.Case.from_toml, swinging, '"porcelain"', '"porcelan"')
assert "did you mean 'load_levels'?" in refuse(study_from_toml, study, '"load_levels"', '"load_level"')
assert "did you mean 'time_of_peak'" in refuse(study_from_toml, study, '"time_of_peak"', '"time_of_peek"')
assert "the ending '.xyz'" in refuse(lambda text: rb.Modal(file=text, damping_ratio=0.0), "scope.xyz", "xyz", "xyz")
""",
    )
    assert result.returncode == 0, result.stderr


def test_messages_do_not_depend_on_the_order_of_imports(tmp_path: Path) -> None:
    """The kinds in a message and in the schema have one order, whichever module was imported first.

    Kinds were listed in the order in which their modules were imported; every test imported the package as a whole.
    """
    code = """
import importlib, sys
for name in sys.argv[1:]: importlib.import_module(f"rattlebox.model.{name}")
import rattlebox as rb, json, hashlib
for table in ("structure = { mass = 1 }", "structure = {}", "load = { amplitude = 2.0 }"):
    try: rb.Case.from_toml(table + '\\nduration = "1 s"\\n[damper]\\nkind = "impact"\\ngap = 1')
    except rb.CaseError as error: print(error)
print(hashlib.sha256(json.dumps(rb.Case.json_schema()).encode()).hexdigest())
"""
    texts = {
        subprocess.run(
            [sys.executable, "-c", code, *names], cwd=tmp_path, capture_output=True, text=True, check=True
        ).stdout
        for names in ((), ("shear_buildings", "random_vibration"), ("plates", "shocks", "matrices"))
    }
    assert len(texts) == 1 and "'kind' is needed: " in texts.pop()


def test_a_class_that_lacks_a_method_is_refused_at_import() -> None:
    """A new kind that lacks a method is refused when it is defined, with the names of the missing methods."""
    from rattlebox.model.cavities import PlaneCavity, Walls

    with pytest.raises(TypeError, match=r"Cone must define words, as each Cavity does"):

        class Cone(PlaneCavity):
            kind: str = "cone"

            def walls(self) -> Walls:
                """Return no walls."""
                raise AssertionError


def test_a_packing_or_method_that_lacks_a_part_is_refused_at_import() -> None:
    """A packing without positions and a method without settings are refused when they are defined.

    A packing of an unknown kind started at undefined positions, and an unknown method ran as the event-driven one.
    """
    from rattlebox.model.methods import ImpactMethod
    from rattlebox.model.packing import Bed, Packing

    with pytest.raises(TypeError, match=r"Stack must define place, as each Packing does"):

        class Stack(Packing):
            kind: str = "stack"

    with pytest.raises(TypeError, match=r"Vibrated must define is_dense, as each Packing does"):

        class Vibrated(Bed):
            kind: str = "vibrated"

    with pytest.raises(TypeError, match=r"Implicit must define has_stepper, settings, as each Method does"):

        class Implicit(ImpactMethod):
            kind: str = "implicit"


STACK = """
import numpy as np, rattlebox as rb
from typing import Literal
from rattlebox.model.packing import Bed, Packing
class Stack(Packing):
    kind: Literal["stack"] = "stack"
    def place(self, cavity, radii, *, settles=True):
        heights = 2 * np.cumsum(radii) - radii - cavity.lengths[2] / 2
        return np.stack([0 * radii, 0 * radii, heights + 1e-4], axis=1)
class Vibrated(Bed):
    kind: Literal["vibrated"] = "vibrated"
    @property
    def is_dense(self): return True
"""


def test_packings_of_another_package_start_where_they_say(tmp_path: Path) -> None:
    """A run, a drawing and the measures of the bed start from the positions of a new packing, given or computed.

    Kinds of packings were asked for by name in seven files, so that a new one had no positions.
    """
    (tmp_path / "case.toml").write_text(
        CASE.replace('"prism", side = "50 mm", length = "35 mm"', '"box", size = ["40 mm", "40 mm", "60 mm"]')
        .replace("count = 30", "count = 8")
        .replace("softening = 100", 'softening = 100\nfriction = 0.3\npacking = { kind = "stack" }')
    )
    result = program(
        tmp_path,
        STACK
        + """
from rattlebox.prepare.particles import prepare
stacked = rb.Case.from_file("case.toml")
for case in (stacked, stacked.replaced({"damper.packing": {"kind": "vibrated", "seed": 3}})):
    run = rb.simulate(case, progress=False)
    damper = case.particle_dampers[0]
    (start,) = prepare(case).positions
    bed = rb.measure_bed(damper)
    assert run.status == "finished" and np.isfinite(start).all() and bed.count == 8, (run.status, bed)
    rb.plot_case(case)
    assert rb.Case.from_toml(case.to_toml()) == case
    if case is stacked: assert np.array_equal(start, damper.packing.place(damper.cavity, damper.contents.radius))
    else: assert bed.height < 0.02, bed
try: stacked.replaced({"damper.packing": {"kind": "stak"}})
except rb.CaseError as error: assert "did you mean 'stack'?" in str(error), error
else: raise AssertionError
""",
    )
    assert result.returncode == 0, result.stderr


def test_a_method_of_another_package_runs_and_is_listed(tmp_path: Path) -> None:
    """A new method runs with its settings in runs, sweeps and steppers, and messages list it; the list was closed."""
    (tmp_path / "case.toml").write_text(
        CASE.partition("[damper]")[0]
        + """
damper = { kind = "impact", ball = { diameter = "20 mm", material = "steel" }, gap = "0.4 mm", \
contact = { kind = "tsuji", restitution = 0.7 } }
method = { kind = "coarse" }
"""
    )
    result = program(
        tmp_path,
        """
import numpy as np, rattlebox as rb
from pathlib import Path
from typing import Literal
from rattlebox.model.methods import ImpactMethod
class Coarse(ImpactMethod):
    kind: Literal["coarse"] = "coarse"
    def settings(self): return "event_driven", {"tolerance": 1e-6, "max_events": 1000, "collocation": False}
    @property
    def has_stepper(self): return True
case = rb.Case.from_file("case.toml")
assert rb.Case.from_toml(case.to_toml()) == case
alike = {"kind": "event_driven", "tolerance": 1e-6, "max_events": 1000, "collocation": False}
methods = {"kind": "coarse"}, alike, {"kind": "event_driven"}
ends = [rb.simulate(case.replaced({"method": method}), progress=False) for method in methods]
own, same, usual = (run.motion.displacement.values[-1, 0] for run in ends)
assert own == same != usual and abs(own - usual) < 1e-3 * abs(usual), (own, same, usual)
swept = rb.sweep(case, {"damper.gap": ["0.4 mm", "0.5 mm"]}, "peak", progress=False)
assert np.isfinite(swept.peak).all()
rb.Stepper(case)
try: rb.Case.from_toml(Path("case.toml").read_text().replace("coarse", "course"))
except rb.CaseError as error: assert "did you mean 'coarse'?" in str(error), error
else: raise AssertionError
""",
    )
    assert result.returncode == 0, result.stderr


def test_a_kind_of_study_names_its_figure_and_its_report() -> None:
    """The figure and the report that each built-in kind names exist, and no study imports them.

    Figures, reports and kinds stood in three tables, which could differ; nothing compared them.
    """
    code = """
import sys
from rattlebox.studies.kinds import BUILT_IN, study_kind
kinds = {name: study_kind(name) for name in BUILT_IN}
assert not [name for name in sys.modules if name.startswith(("rattlebox.plots", "rattlebox.report", "matplotlib"))]
import rattlebox as rb
from rattlebox._util.plugins import named_object
from rattlebox.report.parts import Kind
for name, cls in kinds.items():
    assert cls.kind == name
    assert isinstance(named_object(cls.report, name), Kind)
    assert not cls.figure or named_object(cls.figure, name) is getattr(rb, cls.figure.partition(":")[2])
print(*sorted(name for name, cls in kinds.items() if not cls.figure))
"""
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout) == (0, "sweep\n"), result.stderr


def test_a_figure_or_report_that_does_not_exist_is_named(plugin: Path) -> None:
    """A kind of study that names no existing figure or report stops the command with the name, without a traceback."""
    code = plugin / "my_package" / "load_levels.py"
    text = code.read_text("utf-8")
    named = "my_package.load_levels_figure:plot_load_levels"
    assert text.count(f'"{named}"') == 1
    try:
        for wrong in ("my_package.load_levels_figure:plot_levels", "my_package.no_module:plot", "no reference"):
            changed = text.replace(f'"{named}"', f'"{wrong}"\n    report: ClassVar[str] = "{wrong}"')
            code.write_text(changed, encoding="utf-8")
            results = rattlebox(
                plugin,
                f"sweep study.toml -o {abs(hash(wrong))}.zarr",
                f"plot {abs(hash(wrong))}.zarr -o wrong.png",
                f"report {abs(hash(wrong))}.zarr -o wrong.html",
            )
            assert [code for code, _, _ in results] == [0, 2, 2], results
            for _, _, error in results[1:]:
                assert wrong in " ".join(error.split()) and "try: " in error, error
    finally:
        code.write_text(text, encoding="utf-8")


def test_a_kind_of_study_that_lacks_a_method_is_refused_at_import() -> None:
    """A kind of study without `compute` is refused when it is declared; it once failed when it ran."""
    from rattlebox.studies.run.study import Study, study_function

    class Half(Study):
        kind = "half"

        def validate(self) -> None:
            """Accept everything."""

    with pytest.raises(TypeError, match=r"Half must define compute, as each Study does"):
        study_function(Half)


def test_a_kind_has_one_class() -> None:
    """A second class of a kind is refused when it is defined."""
    from rattlebox.model.restitutions import Coefficients, Restitution

    with pytest.raises(TypeError, match=r"Other: the kind of Restitution 'constant' is that of rattlebox\.model\."):

        class Other(Restitution):
            kind: str = "constant"

            def coefficients(self, pair: object) -> Coefficients:
                """Return nothing."""
                raise AssertionError


TWICE = {
    "reader": (
        "from rattlebox.exchange.read.formats import record_reader\n@record_reader('.osc')\ndef other(path): return []",
        "ending of a file of records, '.osc'",
    ),
    "own_reader": (
        "from rattlebox.exchange.read.formats import record_reader\n@record_reader('.csv')\ndef other(path): return []",
        "ending of a file of records, '.csv'",
    ),
    "material": (
        "import rattlebox as rb\nfrom rattlebox.model.materials import add_material\n"
        "add_material(rb.materials()['steel'], __name__)",
        "material 'steel'",
    ),
    "measure": (
        "from rattlebox.studies.work.measures import measure_function\n"
        "@measure_function('m', 'peak')\ndef peak(run): return 0.0",
        "measure 'peak'",
    ),
    "figure": (
        "from rattlebox.results.figures import run_figure\n@run_figure('motion')\ndef draw(run): ...",
        "figure of runs 'motion'",
    ),
    "command": (
        "from rattlebox.cli.registry import command\n@command('run')\ndef mine(): ...",
        "command 'run'",
    ),
    "study": (
        "from rattlebox.studies.run.study import Study, study_function\n"
        "class Mine(Study):\n    kind = 'load_levels'\n    def validate(self): ...\n    def compute(self): ...\n"
        "study_function(Mine)",
        "kind of study 'load_levels'",
    ),
}


@pytest.mark.parametrize("concept", TWICE)
def test_two_packages_with_one_name_are_refused(plugin: Path, tmp_path: Path, concept: str) -> None:
    """A name that two packages give stops every command with both of them: the case would depend on their order."""
    code, what = TWICE[concept]
    install(tmp_path, "other_package", {"other_package/twice.py": code}, "twice = other_package.twice")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), str(plugin)]), "COLUMNS": "200"}
    command = [sys.executable, "-m", "rattlebox.cli", "sweep", "study.toml", "-o", str(tmp_path / "levels.zarr")]
    result = subprocess.run(command, cwd=plugin, env=environment, capture_output=True, text=True, check=False)
    assert result.returncode == 2, (result.stdout, result.stderr)
    assert what in result.stderr and "other_package" in result.stderr and "try: " in result.stderr, result.stderr
    assert "Traceback" not in result.stderr


def test_a_plugin_that_fails_is_named(tmp_path: Path) -> None:
    """A plug-in that cannot be imported gives a warning with its name and that of its package; all else works.

    It stopped every command; the test asked for the name only.
    """
    install(tmp_path, "broken", {"broken/part.py": "import no_such_module"}, "part = broken.part")
    (tmp_path / "case.toml").write_text(
        CASE.replace('"prism", side = "50 mm", length = "35 mm"', '"sphere", radius = 0.03')
    )
    named = "the plug-in part of the package broken cannot be imported: ModuleNotFoundError: No module named 'no_such_"
    result = program(
        tmp_path, "import rattlebox as rb; print(rb.Case.from_file('case.toml').duration)", "-W", "default"
    )
    assert result.stdout == "0.05\n" and named in result.stderr
    (code, _, error), (_, doctor, _) = rattlebox(tmp_path, "materials", "doctor")
    assert code == 0 and f"warning: {named}" in error and "pip uninstall broken" in error
    assert "cannot be imported" in doctor


def test_a_kind_may_be_defined_after_the_first_case(tmp_path: Path) -> None:
    """A class that a notebook defines after it has run a case is accepted by the next case."""
    (tmp_path / "case.toml").write_text(CASE)
    first = "import rattlebox as rb\nrb.reference_case()\n"
    last = "\nassert rb.Case.from_file('case.toml').dampers[0].cavity.words() == Prism(side=0.05, length=0.035).words()"
    result = program(tmp_path, first + modules()["my_package/prism.py"] + last)
    assert result.returncode == 0, result.stderr
