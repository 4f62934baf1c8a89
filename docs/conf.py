from docutils import nodes
from latex2mathml.converter import convert

project = "Rattlebox"
author = "Rattlebox developers"
release = "0.1.0"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["dollarmath"]
exclude_patterns = ["_build", "verification_table.md"]
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["formulas.css"]
html_title = "Rattlebox"
html_show_copyright = False
html_math_renderer = "mathml"
autodoc_member_order = "bysource"
autodoc_typehints = "none"


def setup(app):
    """Write formulas as MathML, which browsers draw by themselves: MathJax would need the network."""

    def write(display):
        def visit(self, node):
            self.body.append(convert(node.astext(), display=display))
            raise nodes.SkipNode

        return visit

    app.add_html_math_renderer("mathml", (write("inline"), None), (write("block"), None))
