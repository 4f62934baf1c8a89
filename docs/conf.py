import re
import sys
import tomllib
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList
from latex2mathml.converter import convert
from sphinx.util.math import get_node_equation_number

sys.path.insert(0, str(Path(__file__).parent))  # for the modules of the gallery and of the reference

import gallery_of_examples
import typer
from sphinx.ext.autodoc.mock import _MockModule

import rattlebox

try:
    import rattlebox.core._core
except rattlebox.MissingDependency:  # `make docs-light`: the pages show signatures and docstrings, and run nothing
    sys.modules["rattlebox.core._core"] = _MockModule("rattlebox.core._core")

from rattlebox.cli import commands
from rattlebox.engines.status import ADVICE, MESSAGES
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.results.schema import COUNTS, DIAGNOSTICS, VARIABLES

ROOT = Path(__file__).parents[1]
REPOSITORY = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["urls"]["Repository"]
PACKAGE = "."
"""What pip installs: the folder of the source; "rattlebox" once there is a release on PyPI."""

project = "Rattlebox"
author = "Rattlebox developers"
release = rattlebox.__version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
    "sphinxcontrib.bibtex",
    "reference_pages",
]
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
exclude_patterns = ["_build", "validation/verification_table.md", "validation/paper_table.md"]
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["pages.css"]
html_favicon = "_static/favicon.svg"
html_title = f"Rattlebox {release}"
html_show_copyright = False
html_math_renderer = "mathml"
bibtex_bibfiles = ["theory/sources.bib"]
bibtex_reference_style = "author_year"
math_eqref_format = "({number})"
autosummary_generate = False
default_role = "code-or-link"
napoleon_use_rtype = False
napoleon_use_param = False  # parameters that share a description stay on one line
autodoc_member_order = "bysource"
autodoc_typehints = "none"
plot_gallery = "False"  # `make gallery` runs the scripts
sphinx_gallery_conf = {
    "examples_dirs": "_build/examples",
    "gallery_dirs": "gallery",
    "backreferences_dir": "gallery/uses",
    "filename_pattern": rf"(?<!{')(?<!'.join(gallery_of_examples.LONG)})\.py$",
    "ignore_pattern": r"write_data\.py",
    "image_scrapers": ("gallery_of_examples.take_figure",),
    "reset_modules": ("matplotlib", "gallery_of_examples.before"),
    "capture_repr": (),
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,
    "within_subsection_order": "FileNameSortKey",
    "parallel": 2,
    "nested_sections": False,
}


class SchemaTable(Directive):
    """A table of the declared variables of a group, or of `counts` or `diagnostics`."""

    required_arguments = 1

    def run(self):
        """Return the table."""
        name = self.arguments[0]
        if name == "counts":
            lines = [
                "| name | number of |",
                "|---|---|",
                *(f"| `{key}` | {meaning} |" for key, meaning in COUNTS.items()),
            ]
        elif name == "diagnostics":
            rows = (f"| `{key}` | {units} | {meaning} |" for key, (units, meaning) in DIAGNOSTICS.items())
            lines = ["| name | unit | meaning |", "|---|---|---|", *rows]
        else:
            rows = (
                f"| `{v.name}` | {', '.join(v.dims)} | {v.units} | {v.long_name} | {' and '.join(v.engines)} |"
                for v in VARIABLES
                if v.group == name
            )
            lines = ["| name | dimensions | unit | meaning | engines |", "|---|---|---|---|---|", *rows]
        container = nodes.container()
        self.state.nested_parse(StringList(lines), self.content_offset, container)
        return container.children


class Lines(Directive):
    """Base class of directives whose content is computed."""

    def lines(self):
        """Return the content in Markdown."""
        raise NotImplementedError

    def run(self):
        """Return the content."""
        container = nodes.container()
        self.state.nested_parse(StringList(self.lines()), self.content_offset, container)
        return container.children


class Statuses(Lines):
    """A table of the statuses of runs, with their messages and advice."""

    def lines(self):
        """Return the rows."""
        rows = []
        for status, message in MESSAGES.items():
            words = re.sub(r"\{(\w+)[^}]*\}", "...", message)
            name = str(status).rpartition(".")[2]
            rows.append(f"| `{name}` | {words} | {ADVICE.get(status, {}).get('', '')} |")
        return ["| status | message | what to try |", "|---|---|---|", *rows]


class ValidityLimits(Lines):
    """A table of the validity limits of particle runs."""

    def lines(self):
        """Return the rows."""
        return ["| name | meaning |", "|---|---|", *(f"| `{name}` | {text} |" for name, text in WARNINGS.items())]


class Commands(Lines):
    """The help of each command."""

    def lines(self):
        """Return a heading and a list of options for each command."""
        lines = []
        for name, command in typer.main.get_command(commands.app).commands.items():
            context = typer.Context(command, info_name=f"rattlebox {name}")
            usage = " ".join([f"rattlebox {name}", *command.collect_usage_pieces(context)])
            lines += ["", f"**{usage}**", "", *(command.help or "").split("\n"), ""]
            for parameter in command.get_params(context):
                shown = parameter.get_help_record(context)
                if shown is not None:
                    lines.append(f"- `{' '.join(shown[0].split())}`: {shown[1]}")
        return lines


class Script(Lines):
    """The cells of a script of the gallery, given by its name."""

    required_arguments = 1

    def lines(self):
        """Return text and code in turns."""
        self.state.document.settings.env.note_dependency(f"../examples/{self.arguments[0]}.py")
        return gallery_of_examples.cells(self.arguments[0])


def formula(latex, display):
    """Return a formula as MathML, with what browsers lay out otherwise than TeX.

    Browsers ignore bold letters that are not characters of their own, and set space around a slash and a sign.
    """
    text = convert(latex, display=display)
    text = re.sub(
        r'<mi mathvariant="bold">([A-Za-z])</mi>',
        lambda match: f"<mi>{chr(0x1D400 + ord(match[1]) - (65 if match[1] < 'a' else 71))}</mi>",
        text,
    )
    text = text.replace("<mo>&#x0002F;</mo>", '<mo lspace="0" rspace="0">/</mo>')
    for entity, character in (("&#x00028;", "("), ("&#x0002C;", ","), ("&#x0003D;", "=")):
        text = text.replace(entity, character)
    text = re.sub(r"<mover>(<mi>\w</mi><mo>&#x0(?:02D9|00A8);)", r'<mover accent="true">\1', text)
    function = "sin|cos|tan|cot|sinh|cosh|tanh|coth|exp|ln|log|max|min"
    text = re.sub(rf"(<m[io]>(?:{function})</m[io]>)(?=<m[infrs])", r'\1<mspace width="0.17em"/>', text)
    sign = r'\1<mo form="prefix" lspace="0" rspace="0">&#x02212;</mo>'
    return re.sub(r"(<mrow>|<math[^>]*>|<mo[^>]*>[=(,]</mo>)<mo>&#x02212;</mo>", sign, text)


def fill_in(app, name, content):
    """Fill in the version, the address of the repository and what pip installs."""
    text = content[0].replace("@VERSION@", release).replace("@REPOSITORY@", REPOSITORY)
    content[0] = re.sub(r"(pip install (?:-\S+ )*'?)\.(?=['\[\s])", rf"\g<1>{PACKAGE}", text)


def setup(app):
    """Prepare the gallery, add tables of output variables, and write formulas as MathML.

    Browsers draw MathML; MathJax would need the network.
    """
    gallery_of_examples.prepare()
    app.connect("source-read", gallery_of_examples.show)
    app.connect("source-read", fill_in)
    app.add_directive("schema", SchemaTable)
    app.add_directive("statuses", Statuses)
    app.add_directive("validity-limits", ValidityLimits)
    app.add_directive("commands", Commands)
    app.add_directive("script", Script)

    def inline(self, node):
        self.body.append(formula(node.astext(), "inline"))
        raise nodes.SkipNode

    def block(self, node):
        self.body.append(self.starttag(node, "div", CLASS="math"))
        latex = node.astext()
        if r"\\" in latex and r"\begin" not in latex:  # as LaTeX does with several lines in a docstring
            latex = rf"\begin{{align*}}{latex}\end{{align*}}"
        self.body.append(formula(latex, "block"))
        if node["number"]:
            self.body.append(f'<span class="eqno">({get_node_equation_number(self, node)})</span>')
        self.body.append("</div>")
        raise nodes.SkipNode

    app.add_html_math_renderer("mathml", (inline, None), (block, None))
