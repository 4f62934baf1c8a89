"""Gallery of the scripts in examples/, built by sphinx-gallery.

`make docs` does not run the scripts: it shows the figures in docs/_static. `make gallery` runs them, but for those in LONG,
stops at the first assertion that fails, and writes their figures into docs/_static.
"""

import ast
import builtins
import re
import shutil
from pathlib import Path

DOCS = Path(__file__).parent
FIGURES, SCRIPTS, PAGES = DOCS / "_static", DOCS / "_build" / "examples", DOCS / "gallery"
"""Folders of the figures, of copies of the examples, which write files into their folder, and of their pages."""
LONG = {
    "boring_bar_checks": "2 minutes",
    "boring_bar_design": "2 minutes",
    "calibration": "1 minute",
    "map_against_simulation": "3 minutes",
    "panel_variants": "1 minute",
    "stiffer_and_finer": "3 minutes",
    "two_case_files": "30 seconds",
}
"""Scripts that `make gallery` does not run, and processor time that they take."""
TRADES = ("machine tool", "space", "building", "lecture")


def tags(script: Path) -> list[str]:
    """Return the tags of a script, from its comment `sphinx_gallery_tags`: trades and methods."""
    found = re.search(r"^# sphinx_gallery_tags = (\[.*\])$", script.read_text(encoding="utf-8"), re.MULTILINE)
    return ast.literal_eval(found[1]) if found else []


def scripts() -> list[Path]:
    """Return the copies of all scripts of the gallery."""
    return sorted(path for path in SCRIPTS.rglob("*.py") if path.name != "write_data.py")


def prepare() -> None:
    """Copy the examples and the present figures to where sphinx-gallery looks for them, and write the index by tags."""
    shutil.copytree(DOCS.parent / "examples", SCRIPTS, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
    of = {script: tags(script) for script in scripts()}
    methods = sorted({tag for each in of.values() for tag in each} - set(TRADES))
    lines = [(SCRIPTS / "GALLERY_HEADER.rst").read_text(encoding="utf-8")]
    for heading, names in (("By trade", TRADES), ("By method", methods)):
        lines += [heading, "-" * len(heading), ""]
        for name in names:
            tagged = [f"   _build/examples/{path.relative_to(SCRIPTS)}" for path in of if name in of[path]]
            title = name[0].upper() + name[1:]
            lines += [title, "~" * len(title), "", ".. minigallery::", "", *tagged, ""]
    lines += ["All scripts", "-----------", ""]
    (SCRIPTS / "GALLERY_HEADER.rst").write_text("\n".join(lines), encoding="utf-8")
    for script in of:
        figure, image = FIGURES / f"{script.stem}.png", image_of(script)
        if figure.exists():
            image.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(figure, image)


def image_of(script: Path) -> Path:
    """Return the path at which sphinx-gallery expects the first figure of a script."""
    return PAGES / script.relative_to(SCRIPTS).parent / "images" / f"sphx_glr_{script.stem}_001.png"


def before(gallery_conf, name) -> None:
    """Define `__file__` for a script: sphinx-gallery does not, and scripts find their data by it. See `reset_modules`."""
    (script,) = SCRIPTS.rglob(name)
    builtins.__file__ = str(script)


def take_figure(block, block_vars, gallery_conf) -> str:
    """Move the figure that a script has written to the figures of the pages. See `image_scrapers`."""
    script = Path(block_vars["src_file"])
    written = script.with_suffix(".png")
    if written.exists():
        shutil.copyfile(written, next(block_vars["image_path_iterator"]))
        shutil.move(written, FIGURES / written.name)
    return ""


def show_figure(app, name, source) -> None:
    """Insert the figure of a script into its page, above the code, and the duration of a long script. See `source-read`."""
    script = SCRIPTS / Path(name).relative_to("gallery").with_suffix(".py") if name.startswith("gallery/") else None
    if script is None or not script.exists():
        return
    text, code, rest = source[0].partition(".. code-block:: Python")
    if script.stem in LONG:
        text += f"The script takes {LONG[script.stem]} of processor time; ``make gallery`` does not run it.\n\n"
    if (FIGURES / f"{script.stem}.png").exists():
        text += f".. image:: /_static/{script.stem}.png\n   :alt: figure of {script.name}\n\n"
    source[0] = text + code + rest
