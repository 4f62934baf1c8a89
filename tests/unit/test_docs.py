"""Documentation pages: examples, public names, fields, search terms."""

import contextlib
import inspect
import io
import pydoc
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.cli.demo import BARE, DAMPED, demo_cases
from rattlebox.model.base import Part
from rattlebox.model.contacts import Contact
from rattlebox.model.friction import Friction
from rattlebox.model.methods import Method
from rattlebox.model.restitutions import Restitution

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
LAWS = [
    law
    for laws in (
        *(base.kinds.values() for base in (Contact, Restitution, Friction, Method)),
        [rb.Rolling],
    )
    for law in laws
    if law is not rb.Tabulated  # a table of the user has no source
]
ROOMS = ("src", "core", "tests", "docs", "tools", "reproduction", "benchmarks", "examples")
# Files that a page tells the reader to write.
OF_THE_READER = re.compile(r"^(my_package|quarry)/|(viscoelastic|hunt_crossley|hertz_ratio)\.hpp$")
# Tests of the studies and of the engines hold for fewer cycles what these pages compute for 3 s and more.
SLOW_PAGES = (
    "how-to/design",
    "how-to/frequency_response",
    "how-to/loss_map",
    "how-to/lyapunov",
    "how-to/particle_output",
)
PAGES = (
    "how-to/analysis",
    "how-to/backbone",
    "how-to/basins",
    "how-to/bifurcation",
    "how-to/calibration",
    "how-to/chatter",
    "how-to/continue",
    "how-to/fills",
    "how-to/fmu",
    "how-to/gradients",
    "how-to/loads",
    "how-to/record_sets",
    "how-to/map_on_structure",
    "how-to/matlab",
    "how-to/notebooks",
    "how-to/paraview",
    "how-to/real_time",
    "how-to/particle_tuned_mass",
    "how-to/periodic_motions",
    "how-to/report",
    "how-to/results",
    "how-to/sensitivity",
    "how-to/softening",
    "how-to/stepper",
    "how-to/structures",
    "how-to/sweep",
    "reference/other_words",
    "tutorials/boring_bar",
    "tutorials/building",
    "tutorials/panel",
    "tutorials/particle_dampers",
    *(pytest.param(page, marks=pytest.mark.slow) for page in SLOW_PAGES),
)
FRONT = ("README.md", "docs/tutorials/start.md")
REFERENCE = DOCS / "reference"
FIELDS = [REFERENCE / "case_file.md", *sorted((REFERENCE / "case").glob("*.md"))]


OTHER_WORDS = (
    "TMD, PTMD, vibro-impact, NES, bean bag, NOPD, SRS, PSD, mobility, accelerance, receptance, loss "
    "factor, event detection, describing function, chatter, g²/Hz, Nastran, Abaqus, nonlinear energy "
    "sink, tuned mass damper, non-spherical, cohesion, centrifugal, honeycomb, wear, noise, conda, "
    "Docker, Windows, graphics cards, citation, licence, changes, command line, symbols, equations of "
    "motion, bibliography, messages and warnings"
)
SEARCHES = (
    "co-simulation",
    "90 % full",
    "coefficient of restitution from a drop test",
    "contact law",
    "energy balance",
    "install",
    "Jupyter",
    "MATLAB",
    "netCDF",
    "ParaView",
    "report",
    "restitution of steel",
    "resume",
    "softening",
    "time step",
    "units",
    *OTHER_WORDS.split(", "),
)


def read(page):
    """Return the text of a page."""
    return page.read_text(encoding="utf-8")


def examples(page):
    """Return pairs of code and the output on the page."""
    pattern = r"^```python\n(.*?)^```$(?:\n\n```text\n(.*?)^```$)?"
    return re.findall(pattern, page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("name", PAGES)
def test_examples_print_the_output_on_the_page(name, tmp_path, monkeypatch):
    """Every example of a page, run in order, prints the text that follows it."""
    monkeypatch.chdir(tmp_path)
    result = examples(DOCS / f"{name}.md")
    names = {}
    for code, message in result:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(code, names)
        assert printed.getvalue() == message
    assert any(message for _, message in result)


@pytest.mark.parametrize(
    "page", ["docs/tutorials/start.md", "docs/reference/api/errors.md", "docs/theory/laws.md", "README.md"]
)
def test_examples_of_other_pages_run(page, tmp_path, monkeypatch):
    """The examples run, and print the text that follows them; "..." stands for lines such as the computing time."""
    monkeypatch.chdir(tmp_path)
    result, names = examples(ROOT / page), {}
    for code, message in result:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(code, names)
        assert not message or matches(printed.getvalue(), message)
    assert result and (any(message for _, message in result) or page not in FRONT)


def matches(printed, message):
    """Return whether a printed text is that of a page, in which a line "..." stands for any lines."""
    lines = (r"(?:.*\n)*" if line == "..." else re.escape(f"{line}\n") for line in message.splitlines())
    return re.fullmatch("".join(lines), printed) is not None


def test_every_public_name_has_a_page():
    """Each public name of the package and of its two subpackages has an entry on one page of the reference."""
    pages = [page for folder in ("api", "case") for page in (REFERENCE / folder).glob("*.md")]
    entries = re.findall(r"^(?:\.\. py:data:: |  +)?(rattlebox\.[\w.]+)", "\n".join(map(read, pages)), re.MULTILINE)
    errors = [
        name for name in rb.__all__ if isinstance(getattr(rb, name), type) and issubclass(getattr(rb, name), Exception)
    ]
    known = {*entries, *(f"rattlebox.{name}" for name in errors), "rattlebox.analysis", "rattlebox.plots"}
    assert len(entries) == len(set(entries))
    names = [f"rattlebox.{name}" for name in rb.__all__]
    for place in ("analysis", "plots"):  # a name of both is documented once
        names += [f"rattlebox.{place}.{name}" for name in getattr(rb, place).__all__ if name not in rb.__all__]
    assert [name for name in names if name not in known] == []


def section(docstring: str, title: str) -> str:
    """Return the text of a section of a docstring; empty if there is none."""
    found = re.search(
        rf"^{title}\n-+\n(.*?)(?=^\w[\w ]*\n---|\Z)", inspect.cleandoc(docstring), re.DOTALL | re.MULTILINE
    )
    return found[1] if found else ""


def test_docstrings_of_public_functions_are_complete():
    """Each public function describes all its parameters, its result and, if it raises in its own lines, its errors."""
    modules = {"": rb, "analysis.": rb.analysis, "plots.": rb.plots}
    functions = {
        f"{prefix}{name}": getattr(module, name) for prefix, module in modules.items() for name in module.__all__
    }
    lacks = []
    for name, function in functions.items():
        if not inspect.isfunction(function):
            continue
        text, signature = function.__doc__ or "", inspect.signature(function)
        described = re.findall(r"\w+", " ".join(re.findall(r"^(\S[^:\n]*)", section(text, "Parameters"), re.MULTILINE)))
        lacks += [f"{name}: {parameter}" for parameter in signature.parameters if parameter not in described]
        returns = signature.return_annotation not in (None, "None", inspect.Signature.empty)
        if returns and not inspect.isgeneratorfunction(inspect.unwrap(function)) and not section(text, "Returns"):
            lacks.append(f"{name}: Returns")
        if re.search(r"^ +raise \w", inspect.getsource(function), re.MULTILINE) and not section(text, "Raises"):
            lacks.append(f"{name}: Raises")
    assert len(functions) > 100 and not lacks


def test_the_most_used_classes_have_an_example():
    """The sixteen classes that pages and scripts use most have examples in their docstrings, which tests run."""
    pages = [page for page in DOCS.rglob("*.md") if not {"_build", "gallery"} & set(page.parts)]
    text = "".join(map(read, [*pages, *(ROOT / "examples").rglob("*.py")]))
    classes = [name for name in rb.__all__ if isinstance(getattr(rb, name), type)]
    used = sorted(classes, key=lambda name: -len(re.findall(rf"\brb\.{name}\(", text)))
    assert [name for name in used[:16] if ">>>" not in getattr(rb, name).__doc__] == []


def test_formulas_of_docstrings_are_rendered():
    """No displayed formula of the notes of a public name is in plain letters, which the pages would show as they are."""
    plain = re.compile(r"^ {4,}[^\s>.:-][^:`]* = [^`]*(?:\^|\bsqrt\(|\bpi\b|\babs\()", re.MULTILINE)
    wrong = []
    for module in (rb, rb.analysis):
        for name in module.__all__:
            if not callable(getattr(module, name)):
                continue
            notes = section(getattr(module, name).__doc__ or "", "Notes")
            shown = re.sub(r"\.\. math::.*?(?=\n\S|\Z)", "", notes, flags=re.DOTALL)
            wrong += [f"{name}: {line.strip()}" for line in plain.findall(shown)]
    assert wrong == []


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)
def test_laws_and_methods_state_equation_and_source(law):
    """Each law and method that a case can name has an equation in its notes, and names the DOI or ISBN of its source."""
    assert re.search(r"\S [=+<] \S", section(law.__doc__, "Notes"))
    assert re.search(r"doi:10\.\d{4,}/\S|ISBN \d", section(law.__doc__, "References"))


def test_every_field_of_a_case_is_described():
    """The docstring of each part, which a page of fields includes, lists all its fields."""
    shown = re.findall(r"^rattlebox\.(\w+)(?::.*)?$", "\n".join(map(read, FIELDS)), re.MULTILINE)
    parts = [getattr(rb, name) for name in shown]
    public = [getattr(rb, name) for name in rb.__all__]
    assert {part for part in public if isinstance(part, type) and issubclass(part, Part)} <= set(parts)
    for part in parts:
        text = "".join(each.__doc__ or "" for each in part.__mro__ if issubclass(each, Part))
        lists = set(re.findall(r"\w+", " ".join(re.findall(r"^    (\w+(?:, \w+)*)$", text, re.MULTILINE))))
        assert set(part.model_fields) - {"kind"} <= lists, part.__name__


def test_cases_on_the_page_of_fields_run(tmp_path):
    """The case files on the pages of fields are complete and run."""
    files = re.findall(r"^```toml\n(.*?)^```$", "\n".join(map(read, FIELDS)), re.MULTILINE | re.DOTALL)
    assert len(files) == 3
    for number, content in enumerate(files):
        case = rb.Case.from_toml(content)
        run = rb.simulate(case, snapshots=tmp_path / f"{number}.vtkhdf" if case.output.snapshots else None)
        assert run.status == "finished"


def cells(row: str) -> int:
    """Return the number of cells of a row of a table; a pipe in a formula or a text ends a cell unless it is escaped."""
    return len(re.findall(r"(?<!\\)\|", row.strip())) - 1


def test_rows_of_tables_have_the_cells_of_their_header():
    """No pipe inside a cell moves the cells after it into other columns."""
    wrong, count = [], 0
    for page in DOCS.rglob("*.md"):
        if {"_build", "gallery"} & set(page.parts):
            continue
        text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        for table in re.findall(r"(?:^[ ]*\|.*\n)+", text, re.MULTILINE):
            header, _, *rows = table.splitlines()
            count += len(rows)
            wrong += [f"{page.name}: {row}" for row in rows if cells(row) != cells(header)]
    assert count > 500 and not wrong


def test_pages_name_files_and_words_of_the_code_that_exist():
    """Files on all pages, and words of the code on those for developers and on theory, exist; the tour alone was checked."""
    files = [f"/{path.relative_to(ROOT).as_posix()}" for room in ROOMS for path in (ROOT / room).rglob("*.*")]
    source = [ROOT / file[1:] for file in files if file.endswith((".py", ".pyi", ".hpp", ".cpp", ".toml", ".txt"))]
    settings = [ROOT / name for name in ("pyproject.toml", "CMakeLists.txt", "Makefile")]
    words = {word for path in (*source, *settings) for word in re.findall(r"\w+", path.read_text(encoding="utf-8"))}
    words |= {Path(file).stem for file in files}
    wrong, count = [], 0
    for page in DOCS.rglob("*.md"):
        if "_build" in page.parts:
            continue
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        for span in re.findall(r"`([^`\n]+)`", text):
            if re.fullmatch(r"[\w./-]+\.(py|pyi|hpp|cpp|js|svg)", span) and not OF_THE_READER.search(span):
                count += 1
                wrong += [] if any(file.endswith(f"/{span}") for file in files) else [f"{page.name}: {span}"]
            elif page.parent.name in ("developing", "theory"):
                named = re.findall(r"\b(?:[A-Z][a-z]+){2,}\b|\b[a-z]\w*_\w+\b", span)
                wrong += [f"{page.name}: {word}" for word in named if word not in words]
    assert count > 150 and not wrong


def test_docstrings_name_modules_that_exist():
    """Dotted names of the package, such as `rattlebox.model.space.Direction`, lead to an object after a move, too."""
    names = {
        name
        for path in [*(ROOT / "src").rglob("*.py"), *DOCS.rglob("*.md")]
        for name in re.findall(r"`~?(rattlebox(?:\.\w+)+)`", path.read_text(encoding="utf-8"))
    }
    names -= {"rattlebox.h", "rattlebox.json", "rattlebox.plugins"}  # files, and the entry point
    assert len(names) > 50
    assert [name for name in sorted(names) if pydoc.locate(name) is None] == []


@pytest.mark.parametrize("words", SEARCHES)
def test_a_search_finds_a_heading_or_a_first_paragraph(words):
    """Common search terms are in a heading or the first paragraph of a page, or among the words of other trades."""
    found = [(DOCS / "reference" / "other_words.md").read_text(encoding="utf-8")]
    for path in DOCS.rglob("*.md"):
        page = path.read_text(encoding="utf-8")
        found += [" ".join(" ".join(page.split("\n\n")[:2]).split()), *re.findall(r"^#+ (.*)$", page, re.MULTILINE)]
    assert any(re.search(rf"\b{re.escape(words)}", each, re.IGNORECASE) for each in found)


def test_the_front_has_the_numbers_of_the_demonstration():
    """The first pages and pictures show the gain that the demonstration has; they once showed a ball that damps nothing."""
    case = demo_cases()[DAMPED]
    starts = [case.replaced({"damper.start": float(start)}) for start in np.linspace(-1, 1, 201)]
    runs = rb.simulate_many(starts, progress=False)
    compared = rb.compare({**demo_cases(), **{str(k): run for k, run in enumerate(runs)}}).values
    before, after, *others = (values["settling_time[mass]"] for values in compared.values())
    share = f"{100 * compared[DAMPED]['share_normal']:.0f} % of the energy is lost in impacts"
    gain = f"in {after:.2g} s instead of {before:.2g} s"
    ends = f"({min(others):.1f} to {max(others):.1f} s from other start positions)"
    readme, home = ((ROOT / page).read_text(encoding="utf-8") for page in ("README.md", "docs/index.md"))
    assert f"{gain} {ends}; {share}" in readme
    assert f"stops the structure {gain}, and {share}" in " ".join(home.split())
    drawn = (DOCS / "_static" / "three_structures.svg").read_text(encoding="utf-8")
    narrow = rb.compare({"": demo_cases()[BARE], "narrow": case.replaced({"damper.gap": "0.2 mm"})}).values["narrow"]
    for name, time in (("no ball", before), ("gap 0.2 mm", narrow["settling_time[mass]"]), ("gap 2 mm", after)):
        assert f"{name}: at rest after {time:.2g} s" in drawn
        assert f"after {time:.2g} s" in home


def test_the_first_page_is_short():
    """The README has at most one and a half screens of text, and the picture with its message comes first."""
    lines = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 100
    assert next(k for k, line in enumerate(lines) if line.startswith("![")) < 6


@pytest.mark.parametrize(
    "page",
    [ROOT / "README.md", *sorted(DOCS.rglob("*.md")), *sorted((ROOT / "examples").rglob("*.py"))],
    ids=lambda page: page.stem,
)
def test_no_page_names_an_installation_that_fails(page):
    """No page installs a release that does not exist: pip finds the folder of the source, or a wheel by its path."""
    if "_build" in page.parts or "gallery" in page.parts:
        return
    text = page.read_text(encoding="utf-8")
    assert not re.search(
        r"""(?:pip|uv|conda) (?:install|add|download)[^`\n]* ['"]?rattlebox(?:\[|['"`\s]|$)""", text, re.MULTILINE
    )
    assert not re.search(r"git clone (?!@REPOSITORY@$)", text, re.MULTILINE) and "github.com/OWNER" not in text


def test_one_line_names_the_repository():
    """The address of the repository is in pyproject.toml alone, from which the pages take it."""
    urls = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["urls"]
    assert urls["Repository"].startswith("https://github.com/")
    assert "@REPOSITORY@" in (DOCS / "index.md").read_text(encoding="utf-8")


def test_the_table_of_files_lists_every_ending():
    """The page of files has the endings that readers register, and no others: nothing compared them."""
    from rattlebox.exchange.read.formats import density_reader, modes_reader, record_reader
    from rattlebox.exchange.read.sheets import SHEETS
    from rattlebox.model.modal_files import export_instead

    table = "".join(line for line in (DOCS / "how-to/files.md").read_text().splitlines() if line.startswith("|"))
    page = {ending.lower() for ending in re.findall(r"`(\.[A-Za-z0-9]+)`", table)}
    read = {*record_reader.endings, *modes_reader.endings, *density_reader.endings, *SHEETS}
    by_content = {".mtx", ".dat"}  # of rb.Matrices, and known by its first lines
    refused = {ending for ending in page if export_instead(Path(f"a{ending}"))}
    assert page - refused == read | by_content
    assert refused == {".med", ".rmed", ".op2", ".xdb", ".odb", ".fil", ".sim"}
