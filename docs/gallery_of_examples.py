"""Gallery of the scripts in examples/, built by sphinx-gallery.

`make docs` does not run the scripts: it shows the figures in docs/_static. `make gallery` runs them, but for those in LONG,
stops at the first assertion that fails, and writes their figures into docs/_static. The page of the gallery has one card a
script, from docs/cards.toml.
"""

import ast
import builtins
import re
import shutil
import tomllib
from pathlib import Path

from PIL import Image

DOCS = Path(__file__).parent
FIGURES, SCRIPTS, PAGES = DOCS / "_static", DOCS / "_build" / "examples", DOCS / "gallery"
"""Folders of the figures, of copies of the examples, which write files into their folder, and of their pages."""
LONG = {
    "boring_bar_checks": "2 minutes",
    "boring_bar_design": "6 minutes",
    "calibration": "1 minute",
    "cavity_shapes": "2 minutes",
    "map_against_simulation": "3 minutes",
    "panel_variants": "1 minute",
    "stiffer_and_finer": "3 minutes",
    "two_case_files": "30 seconds",
}
"""Scripts that `make gallery` does not run, and processor time that they take."""
CARDS = tomllib.loads((DOCS / "cards.toml").read_text(encoding="utf-8"))
FIRST, SIZE = 6, (640, 440)
"""Number of cards to start with, and size of the pictures [pixels]."""
TRADES = ("machine tool", "space", "building", "lecture")


def tags(script: Path) -> list[str]:
    """Return the tags of a script, from its comment `sphinx_gallery_tags`: trades and methods."""
    found = re.search(r"^# sphinx_gallery_tags = (\[.*\])$", script.read_text(encoding="utf-8"), re.MULTILINE)
    return ast.literal_eval(found[1]) if found else []


def words(script: Path) -> tuple[str, str]:
    """Return the title of a script, and the content of its figure: the first sentence after "For whom:"."""
    lines = (ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or "").split("\n\n")
    content = " ".join(lines[1].split()).partition(": ")[2]
    return lines[0].splitlines()[0], content[:1].upper() + content[1:]


def scripts() -> dict[str, Path]:
    """Return the copies of all scripts of the gallery by name."""
    return {path.stem: path for path in sorted(SCRIPTS.rglob("*.py")) if path.name != "write_data.py"}


def prepare() -> None:
    """Copy the examples to where sphinx-gallery looks for them, and draw the pictures of the cards."""
    shutil.copytree(DOCS.parent / "examples", SCRIPTS, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
    (PAGES / "cards").mkdir(parents=True, exist_ok=True)
    for name, card in CARDS.items():
        source = FIGURES / f"{name}.png" if "crop" in card else FIGURES / "beds" / f"{name}.jpg"
        target = PAGES / "cards" / source.name
        if not target.exists() or target.stat().st_mtime < max(
            each.stat().st_mtime for each in (source, DOCS / "cards.toml")
        ):
            picture(source, card.get("crop", (0, 0, 1, 1))).save(target, optimize=True, quality=88)


def picture(source: Path, crop: tuple[float, float, float, float]) -> Image.Image:
    """Return a part of a figure on a white card."""
    with Image.open(source) as figure:
        whole = figure.convert("RGB")
    left, top, right, bottom = (round(each * whole.size[k % 2]) for k, each in enumerate(crop))
    part = whole.crop((left, top, right, bottom))
    scale = min(SIZE[0] / part.width, SIZE[1] / part.height)
    part = part.resize((round(scale * part.width), round(scale * part.height)), Image.Resampling.LANCZOS)
    card = Image.new("RGB", SIZE, "white")
    card.paste(part, ((SIZE[0] - part.width) // 2, (SIZE[1] - part.height) // 2))
    return card


def index() -> str:
    """Return the page of the gallery: the header, a filter, and one card a script."""
    paths = scripts()
    if set(paths) != set(CARDS):
        raise ValueError(f"docs/cards.toml and examples/ differ: {sorted(set(paths) ^ set(CARDS))}")
    of = {name: tags(paths[name]) for name in CARDS}
    methods = sorted({tag for each in of.values() for tag in each} - set(TRADES))
    header, mark, files = (SCRIPTS / "GALLERY_HEADER.rst").read_text(encoding="utf-8").partition(".. list-table::")
    lines = [header, ".. raw:: html", ""]
    lines += [f"   {line}" for line in chooser([*TRADES, *methods])]
    for number, (name, card) in enumerate(CARDS.items()):
        if number in (0, FIRST):
            heading = "More" if number else "Six to start with"
            lines += ["", heading, "-" * len(heading), "", ".. container:: cards gallery"]
        page = paths[name].relative_to(SCRIPTS).with_suffix("").as_posix()
        title, content = words(paths[name])
        lines += [
            "",
            f"   .. container:: card {' '.join(map(slug, of[name]))}",
            "",
            f"      .. image:: cards/{name}.{'png' if 'crop' in card else 'jpg'}",
            f"         :alt: {content}",
            f"         :target: {page}.html",
            "         :loading: lazy",
            "",
            f"      **{card['message']}.** :doc:`{title} <{page}>`",
        ]
    lines += ["", mark + files, "", ".. toctree::", "   :hidden:", ""]
    return "\n".join(
        [*lines, *(f"   {path.relative_to(SCRIPTS).with_suffix('').as_posix()}" for path in paths.values())]
    )


def slug(tag: str) -> str:
    """Return a tag as the name of a class of HTML."""
    return "tag-" + tag.replace(" ", "-")


def chooser(names: list[str]) -> list[str]:
    """Return radio buttons that show the cards of one tag, without a script."""
    buttons = ['<label><input type="radio" name="tag" id="tag-all" checked> all</label>']
    buttons += [f'<label><input type="radio" name="tag" id="{slug(name)}"> {name}</label>' for name in names]
    rules = [
        f"article:has(#{slug(name)}:checked) .gallery .card:not(.{slug(name)}) {{ display: none }}" for name in names
    ]
    return ["<style>", *rules, "</style>", '<div class="gallery-filter">Show: ', *buttons, "</div>"]


def cells(name: str) -> list[str]:
    """Return a script for a tutorial, in Markdown: text and code in turns, without its docstring, tags and assertions."""
    code = (SCRIPTS / f"{name}.py").read_text(encoding="utf-8")
    first, *others = re.split(
        r"^# %%\n", code.partition("# sphinx_gallery_tags")[2].partition("\n")[2], flags=re.MULTILINE
    )
    lines = ["```python", *first.strip().splitlines(), "```", ""]
    for cell in others:
        text, code = re.match(r"((?:#[^\n]*\n)*)(.*)", cell, re.DOTALL).groups()
        if not re.search(r"^ *assert ", code, re.MULTILINE):
            lines += [line.removeprefix("# ") for line in text.splitlines()]
            lines += ["", "```python", *code.strip().splitlines(), "```", ""]
    return lines


def before(gallery_conf, name) -> None:
    """Define `__file__` for a script: sphinx-gallery does not, and scripts find their data by it. See `reset_modules`."""
    (script,) = SCRIPTS.rglob(name)
    builtins.__file__ = str(script)


def take_figure(block, block_vars, gallery_conf) -> str:
    """Move the figure that a script has written to the figures of the pages. See `image_scrapers`."""
    script = Path(block_vars["src_file"])
    written = script.with_suffix(".png")
    if written.exists():
        shutil.move(written, FIGURES / written.name)
    return ""


def show(app, name, source) -> None:
    """Write the page of the gallery, and the figure of a script into its page, above the code. See `source-read`."""
    if name == "gallery/index":
        source[0] = index()
    if not name.startswith("gallery/") or Path(name).name not in CARDS:
        return
    script = scripts()[Path(name).name]
    text, code, rest = source[0].partition(".. code-block:: Python")
    if script.stem in LONG:
        text += f"The script takes {LONG[script.stem]} of processor time; ``make gallery`` does not run it.\n\n"
    if (FIGURES / f"{script.stem}.png").exists():
        text += f".. image:: /_static/{script.stem}.png\n   :alt: {words(script)[1]}\n\n"
    source[0] = text + code + rest
