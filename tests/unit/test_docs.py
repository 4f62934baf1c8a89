"""The examples of the how-to pages print what the pages say."""

import contextlib
import io
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = (
    "analysis",
    "basins",
    "bifurcation",
    "design",
    "frequency_response",
    "loss_map",
    "lyapunov",
    "particle_output",
    "particle_dampers",
    "results",
    "sensitivity",
    "sweep",
)


def examples(page):
    """Return pairs of code and what the page says that it prints."""
    pattern = r"^```python\n(.*?)^```$(?:\n\n```text\n(.*?)^```$)?"
    return re.findall(pattern, page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("name", PAGES)
def test_examples_print_what_the_page_says(name, tmp_path, monkeypatch):
    """Run from top to bottom, every example prints the text that follows it."""
    monkeypatch.chdir(tmp_path)
    found = examples(DOCS / f"{name}.md")
    names = {}
    for code, said in found:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(code, names)
        assert printed.getvalue() == said
    assert any(said for _, said in found)
