"""What the source of the browser application may use."""

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox import app

FOLDER = Path(app.__file__).parent
SOURCES = sorted(FOLDER.glob("*.py"))


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: file.name)
def test_only_public_names_are_used(file):
    """The application imports `rattlebox` as a user does, and uses only names that it lists."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            assert [name.name for name in node.names if name.name.startswith("rattlebox.")] == []
        elif isinstance(node, ast.ImportFrom):
            assert node.level <= 1
            assert node.level == 1 or not str(node.module).startswith("rattlebox")
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "rb":
            assert node.attr in rb.__all__


def test_colours_of_curves_are_those_of_figures():
    """The curves in the browser have the colours of the figures."""
    listed = re.search(r"const COLOURS = (\[.*?\]);", (FOLDER / "browser" / "charts.js").read_text(encoding="utf-8"))
    assert listed
    assert tuple(json.loads(listed[1])) == rb.plots.SERIES_COLOURS


def test_live_views_do_not_load_matplotlib():
    """A process that computes while a slider moves starts without Matplotlib, which takes half a second."""
    code = (
        "import sys, rattlebox.app.worker as w; w.live(print, w.template('steel_ball'), '.', False); "
        "sys.exit('matplotlib' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
