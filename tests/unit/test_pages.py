"""The built pages: no warning, no request to another host, texts for all pictures, code that can be pasted, links."""

import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

pytest.importorskip("sphinx")

ROOT = Path(__file__).parents[2]
LOADED = {
    "img": ("src", "srcset"),
    "script": ("src",),
    "link": ("href",),
    "iframe": ("src",),
    "source": ("src", "srcset"),
    "video": ("src", "poster"),
    "object": ("data",),
    "use": ("href", "xlink:href"),
}
"""Attributes by which a page loads a file; the address of a link that a reader clicks is none of them."""
FOREIGN = re.compile(r"\s*(?:https?:)?//", re.IGNORECASE)

pytestmark = pytest.mark.slow


class Page(HTMLParser):
    """What a page loads, shows and quotes."""

    def __init__(self, text: str) -> None:
        """Read a page."""
        super().__init__()
        self.loaded: list[str] = []
        self.pictures: list[str] = []
        self.code: list[str] = []
        self.cites = self.depth = 0
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what an element loads."""
        given = {key: value or "" for key, value in attrs}
        if tag != "link" or given.get("rel") not in ("canonical", "search", "index", "next", "prev"):
            self.loaded += [given[name] for name in LOADED.get(tag, ()) if name in given]
        if tag == "img":
            self.pictures.append(given.get("alt", ""))
        self.cites += tag == "cite"
        self.depth += tag in ("code", "pre")

    def handle_endtag(self, tag: str) -> None:
        """Leave code."""
        self.depth -= tag in ("code", "pre")

    def handle_data(self, data: str) -> None:
        """Note code."""
        if self.depth:
            self.code.append(data)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the pages, built from a copy of their sources without anything from an earlier build."""
    folder = tmp_path_factory.mktemp("site")
    for name in ("docs", "examples"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("_build", "gallery", "__pycache__"))
    for name in ("CHANGELOG.md", "pyproject.toml"):
        shutil.copy(ROOT / name, folder)
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "docs", "html"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "html"


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[str, Page]:
    """Return the pages by name."""
    return {path.relative_to(site).as_posix(): Page(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}


def test_no_request_leaves_the_site(site: Path, pages: dict[str, Page]) -> None:
    """Pages and styles load files of the site only; a developer's machine would load a font of another host unnoticed."""
    assert len(pages) > 100
    assert [(name, file) for name, page in pages.items() for file in page.loaded if FOREIGN.match(file)] == []
    styles = {path.name: path.read_text(encoding="utf-8") for path in site.rglob("*.css")}
    assert "fonts/rattlebox-math.woff2" in styles["pages.css"]
    assert (site / "_static/fonts/rattlebox-math.woff2").stat().st_size < 300_000
    for name, style in styles.items():
        files = re.findall(r"url\(\s*[\"']?([^\"')]+)|@import\s+[\"']([^\"']+)", style)
        assert [file for pair in files for file in pair if FOREIGN.match(file)] == [], name


def test_every_picture_has_a_text(pages: dict[str, Page]) -> None:
    """No picture is silent for a reader who cannot see it; 131 thumbnails once were."""
    assert [name for name, page in pages.items() if not all(text.strip() for text in page.pictures)] == []
    assert sum(len(page.pictures) for page in pages.values()) > 80


def test_code_can_be_pasted(pages: dict[str, Page]) -> None:
    """Code has straight quotes, and a name in single backticks is code; typographic quotes are a SyntaxError when pasted."""
    wrong = {
        name: text
        for name, page in pages.items()
        for text in page.code
        if re.search("[\u201c\u201d\u2018\u2019]", text)
    }
    assert wrong == {}
    assert [name for name, page in pages.items() if page.cites] == []


def test_signs_and_functions_have_their_space(site: Path) -> None:
    """A sign after "=" or a bracket has no space behind it, a function has; browsers do the reverse of TeX unless told."""
    text = "".join(path.read_text(encoding="utf-8") for path in site.rglob("*.html"))
    assert text.count("<math") > 300
    assert not re.search(r">(?:[=(,]|&#x000(?:3D|28|2C);)</mo><mo>&#x02212;</mo>", text)
    assert not re.search(r"<mi>(?:sin|cos|exp|ln)</mi><m[inf]", text)


def test_names_in_code_are_links(site: Path) -> None:
    """A name of the package in a guide leads to its entry; names looked like links, and were none."""
    for name, link in (
        ("tutorials/particle_dampers.html", "reference/case/contacts.html#rattlebox.Tsuji"),
        ("how-to/sweep.html", "reference/api/studies.html#rattlebox.sweep"),
        ("reference/api/runs.html", "#rattlebox.Run.save"),
    ):
        assert link in (site / name).read_text(encoding="utf-8"), name
    literal = re.compile(r'<code class="[^"]*"><span class="pre">rb\.\w+</span></code>(?:</span>)?(</a>)?')
    ends = [end for path in site.rglob("*.html") for end in literal.findall(path.read_text(encoding="utf-8"))]
    assert len(ends) > 250 and all(ends)


def test_the_gallery_has_one_card_a_script(site: Path) -> None:
    """Each script has one card, with its picture and message, and all have links; thumbnails were repeated by tag."""
    page = (site / "gallery/index.html").read_text(encoding="utf-8").partition("<article")[2].partition("</article>")[0]
    scripts = [path for path in (ROOT / "examples").rglob("*.py") if path.name != "write_data.py"]
    cards = re.findall(r'<a class="reference external image-reference" href="([\w/]+)\.html">', page)
    assert sorted(Path(card).name for card in cards) == sorted(path.stem for path in scripts)
    assert all((site / "gallery" / f"{card}.html").exists() for card in cards)
    assert page.index("Six to start with") < page.index("More")


def test_tutorials_show_no_assertion(site: Path) -> None:
    """Tutorials show cells of their scripts with text between, without tags and assertions."""
    for name in ("boring_bar", "panel", "building"):
        page = re.sub(r"<[^>]+>", "", (site / f"tutorials/{name}.html").read_text(encoding="utf-8"))
        assert "assert " not in page and "sphinx_gallery" not in page and "# %%" not in page
        assert "import rattlebox as rb" in page


@pytest.mark.browser
def test_pages_fit_a_phone_and_paper(site: Path, pages: dict[str, Page]) -> None:
    """No page scrolls sideways at 390 px, and print cuts no line of code; only eyes had looked before."""
    playwright = pytest.importorskip("playwright.sync_api")
    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if chromium is None:
        pytest.skip("no Chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        phone = browser.new_page(viewport={"width": 390, "height": 800})
        wide, cut = [], {}
        for name in sorted(pages):
            phone.goto((site / name).as_uri())
            if phone.evaluate("document.documentElement.scrollWidth") > 390:
                wide.append(name)
            if name.startswith(("theory/", "tutorials/")):
                phone.emulate_media(media="print")
                cut[name] = phone.evaluate(
                    "[...document.querySelectorAll('pre')].filter(e => e.scrollWidth > e.clientWidth + 1).length"
                )
                phone.emulate_media(media="screen")
        browser.close()
    assert wide == []
    assert len(cut) > 15 and not any(cut.values())
