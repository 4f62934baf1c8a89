"""Tests of the report: figures, files and page."""

import csv
import html.parser
import os
import re
from itertools import pairwise
from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray as xr

from reproduction import write_report
from reproduction.files import write_tables
from reproduction.judge import SYSTEM, Claim, exact, place
from reproduction.page import GENERATOR, FigureFiles, render, system, typeset
from reproduction.report import FIGURES, choose, load_figure

FIGURE = "2"


class Page(html.parser.HTMLParser):
    """Parser that collects ids, addresses and headings, and checks that tags are closed."""

    VOID = frozenset({"meta", "img", "br", "link"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.addresses: list[str] = []
        self.headings: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.tags: list[str] = []
        self.handle_starttag, self.handle_endtag = self._open, self._shut
        self.feed(text)
        self.close()
        assert self.tags == []

    def _open(self, tag, attrs):
        attributes = dict(attrs)
        if tag not in self.VOID:
            self.tags.append(tag)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        self.addresses += [attributes[key] for key in ("href", "src") if key in attributes]
        if re.fullmatch(r"h\d", tag):
            self.headings.append(tag)
        if tag == "img":
            self.pictures.append(attributes)

    def _shut(self, tag):
        assert self.tags.pop() == tag


def read_back(data, tables):
    """Return the dataset with all values from its CSV files."""
    result = {}
    for path in tables:
        with path.open(newline="", encoding="utf-8") as file:
            headers, *rows = csv.reader(file)
        names = [re.sub(r" \[.*\]$", "", header) for header in headers]
        dims = [name for name in names if name in data.dims]
        for name, column in zip(names, zip(*rows, strict=True), strict=True):
            if name not in data.variables or name in result:
                continue
            kind = data[name].dtype
            values = np.array(column) == "True" if kind.kind == "b" else np.array(column).astype(kind)
            values = values.reshape([data.sizes[dim] for dim in dims])
            if name in data.dims:
                values = np.moveaxis(values, dims.index(name), 0).reshape(data.sizes[name], -1)[:, 0]
            result[name] = (data[name].dims, values, data[name].attrs)
    return xr.Dataset(
        {name: result[name] for name in data.data_vars}, {name: result[name] for name in data.coords}, data.attrs
    )


def test_data_of_a_figure_reads_back_from_csv(every, tmp_path):
    """All variables of a figure have unit and description, and their CSV files contain all digits."""
    for name, variable in every.data.variables.items():
        assert {"units", "long_name"} <= variable.attrs.keys(), name
    tables = write_tables(every.data, tmp_path, every.module)
    xr.testing.assert_identical(read_back(every.data, tables), every.data)


def test_captions_and_claims_are_complete(every):
    """Captions fill at most three lines, and no text contains "nan"; claims have a location and a test."""
    claims = every.figure.claims(every.data)
    caption = every.figure.caption(every.data)
    assert 0 < len(caption) <= 300
    texts = [text for c in claims for text in (c.statement, c.where, c.quantity, c.printed, c.note)]
    for text in (caption, *texts, *every.figure.lessons(every.data)):
        assert not re.search(r"\b(nan|inf|None|True|False)\b|[{}\[\]]", text), text
    for claim in claims:
        assert len(claim.statement) < 115 and len(claim.quantity) < 115 and len(claim.note) < 240, claim
        assert claim.kind == "unchecked" or claim.cells


def test_numbers_and_file_names_are_unique():
    """No two figures have the same number or file name."""
    figures = [load_figure(module) for module in FIGURES]
    assert len({figure.number for figure in figures}) == len(figures)
    assert len({figure.name for figure in figures}) == len(figures)
    assert all(re.fullmatch(r"figure_\w+", figure.name) for figure in figures)


@pytest.fixture(scope="module", params=["one", pytest.param("all", marks=pytest.mark.slow)])
def report(request, tmp_path_factory):
    """Return the page of a report on one figure or on all, the progress calls, and the processor time."""
    calls = []
    before = sum(os.times()[:4])
    folder = tmp_path_factory.mktemp("reports") / "report"
    page = write_report(
        folder,
        only=[FIGURE] if request.param == "one" else [],
        workers=1 if request.param == "one" else 2,
        progress=lambda *news: calls.append(news),
    )
    return page, calls, sum(os.times()[:4]) - before


def test_processor_time_of_the_report(report):
    """All figures together take at most two minutes on two cores."""
    *_, seconds = report
    assert 0 < seconds < 2 * 120


def test_page_is_valid(report):
    """The page is valid HTML without repeated ids, skipped heading levels or broken links."""
    page, *_ = report
    read = Page(page.read_text(encoding="utf-8"))
    assert len(set(read.ids)) == len(read.ids)
    levels = [int(heading[1]) for heading in read.headings]
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))
    for address in read.addresses:
        if address.startswith("#"):
            assert address[1:] in read.ids
        elif not address.startswith("data:"):
            assert (page.parent / unquote(address)).stat().st_size > 0


def test_page_is_self_contained(report):
    """Neither the page nor its pictures load anything from a network."""
    page, *_ = report
    text = page.read_text(encoding="utf-8")
    assert not re.search(r"""(?:src|href|url\()\s*=?\s*["']?(?:https?:)?//""", text)
    for picture in Page(text).pictures:
        svg = unquote(picture["src"].partition(",")[2])
        drawn = ElementTree.fromstring(svg)
        links = [value for node in drawn.iter() for key, value in node.items() if key.endswith("href")]
        assert all(link.startswith(("#", "data:")) for link in links)
        assert re.match(r"Figures? \w+", picture["alt"])
        stem = f"figures/{picture['aria-describedby'].removesuffix('_caption')}"
        assert f'swipe it sideways, or <a href="{stem}.svg">' in text
        assert picture["aria-describedby"] in text


def test_every_file_is_written_and_linked(report):
    """SVG, PNG, CSV and case files are in the folder of the page, and the page links to each of them."""
    page, *_ = report
    folder = page.parent
    written = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()} - {"index.html"}
    linked = {address for address in Page(page.read_text(encoding="utf-8")).addresses if address[0].isalpha()}
    assert written == {address for address in linked if not address.startswith("data:")}
    assert {Path(name).suffix for name in written} == {".svg", ".png", ".csv", ".toml", ".md"}


def test_page_is_small(report):
    """The page stays below 4 MB with all figures in it."""
    page, *_ = report
    assert page.stat().st_size < 4e6


def test_progress(report):
    """The progress function is called after each figure with the number of finished figures and the total."""
    page, calls, _ = report
    count = len(list(page.parent.glob("figures/*.svg")))
    assert [(done, total) for done, total, _ in calls] == [(k + 1, count) for k in range(count)]
    assert f"figure {FIGURE}" in {last for _, _, last in calls}


def test_figures_are_the_same_in_every_run(report, tmp_path):
    """A second report has bit-identical drawings, data and cases, also with worker processes."""
    page, *_ = report
    again = write_report(tmp_path, only=[FIGURE, "5"], workers=2)
    for path in page.parent.glob("*/figure_02*"):
        if path.suffix != ".png":
            assert path.read_bytes() == (again.parent / path.relative_to(page.parent)).read_bytes(), path.name


def test_earlier_report_is_replaced(tmp_path):
    """A report removes the files to which the earlier page links, and no others."""
    page = write_report(tmp_path, only=[FIGURE])
    stale, *own = (page.parent / name for name in ("figures/figure_99.svg", "figures/figure_mine.svg", "notes.txt"))
    page.write_text(page.read_text() + '<a href="figures/figure_99.svg" download>SVG</a>')
    for file in (stale, *own):
        file.touch()
    write_report(tmp_path, only=[FIGURE])
    assert all(file.exists() for file in own) and not stale.exists()


def test_other_folders_are_not_overwritten(tmp_path):
    """A folder with other files, or a file instead of a folder, raises an error."""
    other = tmp_path / "index.html"
    other.write_text("mine")
    with pytest.raises(FileExistsError, match="other files"):
        write_report(tmp_path)
    assert [*tmp_path.iterdir()] == [other]
    with pytest.raises(NotADirectoryError, match="is a file"):
        write_report(other)


def test_selection_of_figures():
    """A number selects its figure, a number without letter all its parts; an unknown one raises an error with the list."""
    assert choose([]) == FIGURES
    assert choose(["2"]) == ("figure_02",)
    assert choose(["paper"]) == tuple(m for m in FIGURES if not load_figure(m).number.startswith("A"))
    assert choose(["paper", "A5"]) == (*choose(["paper"]), "lyapunov")
    with pytest.raises(ValueError, match=r"99.*7a, 7b"):
        choose(["99"])
    with pytest.raises(ValueError, match="unknown figure"):
        choose([""])


@pytest.mark.parametrize(
    ("earlier", "later"),
    [
        ("abstract", "section 3.1, figure 2"),
        ("table 1", "section 5, figure 6"),
        ("figure 4", "Fig. 5"),
        ("Section 5.1, Figs 7a to 7c", "section 5.1, figures 7b and 7c"),
        ("section 2, figure 5", "equation (5)"),
        ("equation (5)", "equations (14) and (15)"),
        ("equation (14)", "figure 4"),
        ("Sections 5.1 and 6.1, figure 7e", "section 5.1, figure 9"),
        ("section 6.1", "elsewhere"),
        ("section 5.1, figure 7c", "section 5.1, figure 7e"),
        ("section 5.1, figure 9a", "section 5.1, figure 10"),
        ("figure 11", "conclusion 1"),
        ("section 6, conclusion 2", "section 6.1"),
    ],
)
def test_order_of_claims(earlier, later):
    """Claims are sorted by section and then by figure."""
    assert place(earlier) < place(later)


def test_page_escapes_and_counts():
    """Text from figures is escaped, and the summary counts each verdict that occurs."""
    values = (1.0, 1.0, 0.0)
    claims = tuple(
        Claim(f"x < {k} & y", "section 1", "<b>", {SYSTEM: exact(value)}, accept=(0.5, 2), scope="system", note="z > 1")
        for k, value in enumerate(values)
    )
    made = FigureFiles("A9", "<i>", "figure_A9", "a < b", claims, ("**c** < d",), "", "data:,", (), {}, 1.0, 2.0)
    text = render([made], table="t.md", cores=3, workers=2, seconds=4.25)
    Page(text)
    assert GENERATOR in text
    assert (
        "x &lt; 2 &amp; y" in text and "<i>" not in text and "&lt;b&gt;" in text and "<strong>c</strong> &lt; d" in text
    )
    counts = re.findall(r"<b>(\d+)</b><span aria-hidden=\"true\">.</span> ([a-z ]+)<", text)
    assert counts == [("2", "reproduced"), ("1", "not reproducible")]
    assert "For 2 of the 2 reproduced claims the paper prints no number" in text
    assert "4.2 s" in text and "3 cores, 2 processes" in text
    assert "Not computed" not in text
    missing = render([made], table="t.md", missing=["7d, 7e", "A1"], cores=1, workers=1, seconds=1)
    assert "Not computed for this page: 7d, 7e; A1." in missing


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("4.8e-09 m/s", "4.8 × 10<sup>−9</sup> m/s"),
        ("4.5e+02 to 2e+12", "450 to 2 × 10<sup>12</sup>"),
        ("V_c < E_k/2", "V<sub>c</sub> &lt; E<sub>k</sub>/2"),
        ("N/m^1.5, s^-1, sqrt(K/M)", "N/m<sup>1.5</sup>, s<sup>−1</sup>, √(K/M)"),
        ("degree 9 in log10 e", "degree 9 in log<sub>10</sub> e"),
        ("-3 to 5, (-ζω), x-1, figure_02, e = 0.99", "−3 to 5, (−ζω), x-1, figure_02, e = 0.99"),
        ("7.6 % after 5 kN in 3 motions", "7.6\N{NO-BREAK SPACE}% after 5\N{NO-BREAK SPACE}kN in 3 motions"),
    ],
)
def test_numbers_and_symbols_are_typeset(text, html):
    """Powers of ten, subscripts, exponents and minus signs are typeset; other text is unchanged."""
    assert typeset(text) == html


def test_parameters_of_the_system():
    """The table of parameters contains the mass, the frequencies and the speeds of first yield."""
    values = {(name, symbol): float(value) for name, symbol, value, _ in system()}
    assert values["Mass of the ball", "m"] == pytest.approx(1.200037, abs=1e-6)
    assert values["Natural frequency, ball riding along", "√(K/(M+m))"] == pytest.approx(61.4295, abs=1e-4)
    assert values["Speed of first yield, steel wall", "V_c"] == pytest.approx(0.1694607, abs=1e-5)
    assert values["Speed of first yield, rigid wall", "V_c"] == pytest.approx(0.0423652, abs=1e-5)
    assert values["Hertz stiffness, ball on steel wall", "A"] == pytest.approx(26.68518, abs=1e-5)
    assert values["Its restitution", "e"] == pytest.approx(0.991170, abs=1e-6)
