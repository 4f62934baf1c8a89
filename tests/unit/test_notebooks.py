"""Displays in notebooks and representations in the interpreter."""

import ast
import copy
import inspect
import pickle
import pydoc
import re
import typing
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.results import compare, figures
from rattlebox.results.arrays import RunArrays, Table
from rattlebox.results.schema import BOTH, groups, variables

TIME = np.linspace(0.0, 2.0, 20_001)


@pytest.fixture(scope="module")
def recorded():
    """Return a case with a record of 2 s and with HTML tags in its name and point."""
    return rb.Case(
        name="<b>bold</b>",
        structure=rb.Modal(frequencies=["10 Hz"], damping_ratio=0.01, shapes={"<i>tip</i>": [0.2]}),
        load=rb.Record(times=TIME, values=np.sin(9.0 * TIME), unit="N"),
        duration="2 s",
    )


@pytest.fixture(scope="module")
def run(recorded):
    """Return the run of the case."""
    return rb.simulate(recorded)


class _Balanced(HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.tags, self.text = [], set(), ""

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.tags.add(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def parsed(thing):
    """Parse the HTML of an object, which must be well formed, without colours and with a few tags only."""
    html = thing._repr_html_()
    reader = _Balanced()
    reader.feed(html)
    reader.close()
    assert reader.open == []
    assert reader.tags <= {"p", "b", "pre", "table", "thead", "tbody", "tr", "th", "td", "ul", "li"}
    assert not re.search(r"color|background|class=", html)
    return reader


def test_a_long_record_is_shortened(recorded):
    """The case has 800 kB of TOML; its display has at most 10 kB and the length of the record."""
    assert len(recorded.to_toml()) > 500_000
    assert len(recorded._repr_html_()) < 10_000
    assert "... 20001 in all" in parsed(recorded).text
    assert "1.9998" not in repr(recorded) and len(repr(recorded)) < 200
    assert len(repr(recorded.loads[0])) < 500


def test_a_case_of_very_many_points_is_cut():
    """A display that is too long without its records is cut, with the number of omitted characters."""
    shapes = {f"point {k} <{'x' * 250}>": [0.2] for k in range(60)}
    structure = rb.Modal(frequencies=[10], damping_ratio=0.01, shapes=shapes)
    many = rb.Case(structure=structure, duration=1)
    assert len(many.to_toml()) > len(many._repr_html_()) and len(many._repr_html_()) < 10_000
    assert re.search(r"\.\.\. \d+ more characters", parsed(many).text)


def test_names_are_shown_literally(recorded, run):
    """HTML tags in names are escaped in cases, runs, summaries and comparisons."""
    assert "<b>bold</b>" in parsed(recorded).text
    assert "<b>bold</b>" in parsed(run).text
    assert "<u>" in parsed(compare({"<u>": run, "b": run}, title="<s>")).text


def test_run_and_summary(run):
    """The display of a run has its status, case, method and the table of its summary with units and notes."""
    shown = parsed(run).text
    for words in ("finished", "Modal", "1 Record", "event_driven", "peak displacement", "µm"):
        assert words in shown
    assert "the run is too short for one" in parsed(run.summary()).text
    assert parsed(run.summary()).text in shown
    warned = parsed(type(run)(run.arrays, run.source, notes=("mind the <gap>",), status="interrupted", message="stop"))
    assert "mind the <gap>" in warned.text and "interrupted" in warned.text and "stop" in warned.text


def test_a_run_whose_case_cannot_be_read_is_shown(run, tmp_path):
    """The display of a run whose case refers to a missing file has the reason."""
    orphan = type(run)(run.arrays, '[structure]\nkind = "modal"\nfile = "gone.csv"\n')
    assert "gone.csv" in parsed(orphan).text


def test_materials_and_measures():
    """Materials and measures are displayed as tables with units and can be copied and pickled as dictionaries."""
    shown = parsed(rb.materials()).text
    assert "7850 kg/m^3" in shown and "200 GPa" in shown and "1030 MPa" in shown
    shown = parsed(rb.MEASURES).text
    assert all(name in shown and measure.long_name in shown for name, measure in rb.MEASURES.items())
    for table in (rb.materials(), rb.MEASURES):
        assert dict(table) == table == pickle.loads(pickle.dumps(table)) == copy.deepcopy(table)
        assert len(repr(table).splitlines()) <= 8 and all(name in repr(table) for name in table)


def test_representations_are_short(recorded, run):
    """The repr of cases and runs is one line; that of parts is a call with the fields that were set."""
    for thing in (recorded, run):
        assert len(repr(thing).splitlines()) == 1 and len(repr(thing)) < 200
    damper = rb.ImpactDamper(ball=rb.Sphere(radius=0.01, material="steel"), gap=0.1, contact=rb.Tsuji(alpha=0.1))
    assert "contact=Tsuji(alpha=0.1)" in repr(damper) and "gravity" not in repr(damper)
    assert repr(rb.SDOF(mass=2, stiffness=8)) == "SDOF(mass=2.0, stiffness=8.0)"


def test_variants_that_differ_late_in_a_list_are_different():
    """Two records with the same repr that differ in their last values are different variants."""
    case = rb.Case(structure=rb.SDOF(mass=1, stiffness=100), loads=[], duration=1, output=rb.Output(rate=100))
    damper = rb.ImpactDamper(ball=rb.Sphere(radius=0.01, material="steel"), gap=0.1, contact=rb.Tsuji(alpha=0.1))
    times = np.linspace(0.0, 1.0, 101)
    loads = [rb.Record(times=times, values=np.where(times > 0.5, size, 0.0), unit="N") for size in (1.0, 2.0)]
    assert repr(loads[0]) == repr(loads[1]) and loads[0] != loads[1]
    study = rb.sweep(case.replaced({"damper": damper, "load": loads[0]}), {"load": loads}, "peak", progress=False)
    assert study.peak.values[1] == pytest.approx(2 * study.peak.values[0], rel=1e-6)


def public_callables():
    """Return all public functions and classes, and the public methods of runs, cases and snapshots."""
    for module in (rb, rb.analysis, rb.plots):
        yield from ((f"{module.__name__}.{name}", getattr(module, name)) for name in module.__all__)
    for cls in (rb.Run, rb.Case, rb.Snapshots):
        yield from ((f"{cls.__name__}.{n}", m) for n, m in vars(cls).items() if inspect.isfunction(m) and n[0] != "_")


@pytest.mark.parametrize(("name", "thing"), [(n, t) for n, t in public_callables() if callable(t)])
def test_signatures_are_readable(name, thing):
    """Every parameter of a public callable has a short type without private names."""
    for parameter in inspect.signature(thing).parameters.values():
        if parameter.name == "self":
            continue
        text = inspect.formatannotation(parameter.annotation)
        assert parameter.annotation is not inspect.Parameter.empty, parameter.name
        assert len(text) < 200, text
        assert not re.search(r"\b_\w|Annotated|Validator| at 0x|PydanticUndefined|typing\.", text), text


def test_signatures_of_parts_have_the_names_of_calls():
    """The signature of a part has the accepted names, also the singular ones, and quantities accept text."""
    parameters = inspect.signature(rb.ImpactDamper).parameters
    assert str(parameters["gap"]) == "gap: number or text with unit | None = None"
    assert str(parameters["ball"]) == "ball: Sphere | Striker | None = None" and "kind" not in parameters
    length = "number or text with unit"
    assert str(inspect.signature(rb.Box)) == f"(*, size: tuple[{length}, {length}, {length}], periodic: str = '')"
    assert str(parameters["start"]) == "start: float | str | Sequence[float | str] = 0.0"
    assert str(inspect.signature(rb.Constant)).startswith("(e: float, *")
    inspect.signature(rb.Cylinder).bind(diameter="1 cm", length="2 cm")
    inspect.signature(rb.Random).bind("1 N^2/Hz", "1 s")


@pytest.mark.parametrize("part", [rb.Record, rb.SDOF, rb.ParticleDamper, rb.Case], ids=lambda part: part.__name__)
def test_help_shows_what_users_need(part):
    """The help of a part has no names of pydantic, of which it listed 400 lines; no test read it."""
    text = pydoc.render_doc(part, renderer=pydoc.plaintext)
    assert "number or text with unit" in text
    own = text.replace("pydantic.main.BaseModel", "", 1)
    assert not re.search(r"pydantic|model_|__\w+__|parse_obj|ClassVar|deprecated", own), own
    assert len(text.splitlines()) < 260


def test_names_that_complete(run):
    """Completion lists the fields and methods of a case and the figures of a run, with their signatures."""
    case = run.case
    assert {"structure", "duration", "replaced", "to_file"} <= set(dir(case))
    assert not [name for name in dir(case) if name.startswith(("model_", "__"))]
    assert "frequencies" in dir(case.structure)
    assert [str(name) for name in inspect.signature(run.plot.motion).parameters] == ["size", "between"]
    assert "between" in run.plot.motion.__doc__


def test_declared_attributes_exist():
    """The attributes that editors show are those of the schema, and the figures those that are registered."""
    declared = {RunArrays: set(), Table: set()}
    for engine in BOTH:
        for group in groups(engine).values():
            holder = RunArrays if group.along == "time" else Table
            declared[holder] |= {v.name for v in variables(engine, group.name) if not v.derived}
    others = {"engine", "time", "points", "balls", "dampers", "loads", "impacts", "particles", "stops", "group"}
    others |= {"walls", "line"}
    for holder, names in declared.items():
        assert set(holder.__annotations__) - others == names - others
    tree = ast.parse(Path(figures.__file__).read_text(encoding="utf-8"))
    plots = next(node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == "Plots")
    shown = next(node for node in plots.body if isinstance(node, ast.If)).body
    methods = {node.name: ast.unparse(node.args) for node in shown if isinstance(node, ast.FunctionDef)}
    assert set(methods) == set(figures._REGISTRY)
    for name, arguments in methods.items():
        parameters = list(inspect.signature(figures._REGISTRY[name].draw).parameters.values())[1:]
        scope = {**vars(figures), **vars(typing)}
        exec(f"def method({arguments}): pass", scope)
        stated = list(inspect.signature(scope["method"]).parameters.values())[1:]
        assert [(p.name, p.kind, p.default) for p in stated] == [(p.name, p.kind, p.default) for p in parameters]
