"""The examples of the how-to page print what the page says."""

import contextlib
import io
import re
from pathlib import Path

PAGE = Path(__file__).parents[3] / "docs" / "analysis.md"


def examples():
    """Return pairs of code and what the page says that it prints."""
    text = PAGE.read_text(encoding="utf-8")
    pattern = r"^```python\n(.*?)^```$(?:\n\n```text\n(.*?)^```$)?"
    return re.findall(pattern, text, re.MULTILINE | re.DOTALL)


def test_examples_print_what_the_page_says():
    """Run from top to bottom, every example prints the text that follows it."""
    names = {}
    for code, said in examples():
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(code, names)
        assert printed.getvalue() == said
    assert sum(bool(said) for _, said in examples()) >= 9
