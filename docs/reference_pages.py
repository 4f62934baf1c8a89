"""Pages of the reference: the directive `api`, links from code to what it names, and types in words.

A code literal that names something public is a link to it. Single backticks of docstrings are code, too, so that the
same holds for them, and quotes inside them stay straight.
"""

import inspect
import re

import gallery_of_examples
from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList
from sphinx.util import logging

import rattlebox as rb
from rattlebox.model.base import Part

log = logging.getLogger(__name__)

NAME = re.compile(r"(?P<package>(?:rb|rattlebox)\.)?(?P<name>[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*)(?:\(.*\))?", re.DOTALL)
PLACES = ("rattlebox.", "rattlebox.analysis.", "rattlebox.plots.")
PUBLIC = [getattr(rb, name) for name in rb.__all__]
FIELDS = {name for part in PUBLIC if isinstance(part, type) and issubclass(part, Part) for name in part.model_fields}
"""Fields of cases, some of which have the name of a function."""
MANY = 6
"""Largest number of scripts that an entry names."""
MEMBERS = {"none": "", "all": "   :members:\n", "inherited": "   :members:\n   :inherited-members:\n"}


class Api(Directive):
    """A summary table of public names, and the entry of each.

    A line holds a name and, for a class, after a colon the members to show: their names, `all` or `inherited`.
    """

    has_content = True

    def run(self):
        """Return the table and the entries."""
        entries = [line.partition(":")[::2] for line in self.content if line.strip()]
        lines = ["```{eval-rst}", ".. autosummary::", "   :nosignatures:", ""]
        lines += [f"   ~{name.strip()}" for name, _ in entries] + [""]
        for name, members in entries:
            kind = "autoclass" if isinstance(public(name.strip()), type) else "autofunction"
            lines.append(f".. {kind}:: {name.strip()}")
            if members.strip():
                lines += MEMBERS.get(members.strip(), f"   :members: {members.strip()}\n").splitlines()
            lines += ["", examples_of(name.strip()), ""]
        container = nodes.container()
        self.state.nested_parse(StringList([*lines, "```"]), self.content_offset, container)
        return container.children


def examples_of(name):
    """Return a line with links to the scripts of the gallery that use a name; empty if there are none or too many."""
    used = re.compile(rf"\b(?:rb|analysis|plots)\.{name.rpartition('.')[2]}\b")
    scripts = gallery_of_examples.scripts()
    found = [script for script in scripts.values() if used.search(script.read_text(encoding="utf-8"))]
    if not 0 < len(found) <= MANY:
        return ""
    links = [
        f":doc:`{gallery_of_examples.words(script)[0]} "
        f"</gallery/{script.relative_to(gallery_of_examples.SCRIPTS).with_suffix('').as_posix()}>`"
        for script in found
    ]
    return f"Used in the examples: {', '.join(links)}."


def public(name):
    """Return the object with a dotted name."""
    found = rb
    for part in name.split(".")[1:]:
        if inspect.ismodule(found) and not hasattr(found, part):
            found = __import__(f"{found.__name__}.{part}", fromlist=["_"])
        else:
            found = getattr(found, part)
    return found


def code(role, raw, text, line, inliner, options=None, content=None):
    """Return a text in single backticks of a docstring as code; the role of reStructuredText would set it in italics."""
    return [nodes.literal(text, text, classes=["code"])], []


def named(objects, text):
    """Return the full name of the public object that a piece of code names, or None.

    Without `rb.` only classes, their members, and names with an underscore are looked up: other words, such as `load` and
    `damping_ratio`, are fields of a case more often than functions.
    """
    found = NAME.fullmatch(text)
    if not found:
        return None
    name, package = found["name"], found["package"]
    function = "_" in name.strip("_") and name not in FIELDS
    if not (package or name[0].isupper() or function or name.startswith(("analysis.", "plots."))):
        return None
    return next((place + name for place in PLACES if place + name in objects), None)


def link_code(app, doctree, page):
    """Turn each code literal that names something public into a link; see the event `doctree-resolved`."""
    objects = app.env.domains["py"].objects
    for literal in list(doctree.findall(nodes.literal)):
        text = literal.astext()
        inside = (literal.parent, *(ancestor for ancestor in ancestors(literal)))
        if any(isinstance(each, (nodes.reference, nodes.title)) for each in inside):
            continue
        name = named(objects, text)
        if name is None:
            if text.startswith("rb.") and NAME.fullmatch(text):
                log.warning("%r is not in the reference", text, location=literal)
            continue
        entry = objects[name]
        address = app.builder.get_relative_uri(page, entry.docname) + "#" + entry.node_id
        link = nodes.reference("", "", internal=True, refuri=address)
        literal.replace_self(link)
        link += literal


def ancestors(node):
    """Yield the nodes around a node."""
    while node.parent is not None:
        node = node.parent
        yield node


WORDS = (
    (r"Callable\[\[.*?\], .*?\]", "function"),
    (r"float \| str", "number or text with unit"),
    (r"(?:str \| )?os\.PathLike\[str\]|str \| Path|Path \| str", "path"),
    (r"NDArray\[[\w.]*\]|FloatArray|Array\b|ArrayLike|Vector\b", "array"),
    (r"\bxr\.", ""),
    (r"Literal\[([^\[\]]*)\]", r"\1"),
    (r"\bAny\b", "any"),
    (r"\bbool\b", "True or False"),
    (r"\bstr\b", "text"),
    (r"\bint\b", "whole number"),
    (r"\bfloat\b", "number"),
    (r" \| ", " or "),
)
CONTAINERS = (
    (r"(?:Sequence|Iterable|list)\[number or text with unit\]", "numbers or texts with unit"),
    (r"(?:Sequence|Iterable|list)\[(number|whole number|text|path)\]", r"\1s"),
    (r"(?:Sequence|Iterable|list)\[(numbers[^\[\]]*)\]", r"rows of \1"),
    (r"(?:Sequence|Iterable|list)\[([^\[\]]*)\]", r"sequence of \1"),
    (r"(?:dict|Mapping)\[([^\[\],]*), ([^\[\]]*)\]", r"dict of \2 by \1"),
    (r"tuple\[([^\[\]]*)\]", r"(\1)"),
)


def in_words(annotation):
    """Return a type in words: `float | str | None` is "number or text with unit, optional"."""
    text = re.sub(r" \| None\b", "", annotation)
    optional = text != annotation
    for pattern, words in WORDS:
        text = re.sub(pattern, words, text)
    before = ""
    while before != text:  # from the inside out
        before = text
        for pattern, words in CONTAINERS:
            text = re.sub(pattern, words, text)
    return f"{text}, optional" if optional else text


def types_of(subject):
    """Return the types of the parameters of a function, or of the fields of a class, in words by name."""
    if not callable(subject):
        return {}
    try:
        signature = inspect.signature(subject)
    except (TypeError, ValueError):
        return {}
    return {
        name: in_words(parameter.annotation if isinstance(parameter.annotation, str) else str(parameter.annotation))
        for name, parameter in signature.parameters.items()
        if parameter.annotation is not inspect.Parameter.empty
    }


def add_types(app, what, name, subject, options, lines):
    """Write the types of parameters into a docstring, before it is formatted; see the event `autodoc-process-docstring`."""
    types = types_of(subject)
    if not types or "Parameters" not in lines:
        return
    start = lines.index("Parameters") + 2
    end = next((k for k in range(start, len(lines) - 1) if re.fullmatch("-{3,}", lines[k + 1])), len(lines))
    for k in range(start, end):
        names = [each.strip().lstrip("*") for each in lines[k].split(",")]
        known = dict.fromkeys(types[each] for each in names if each in types)
        if lines[k] and not lines[k].startswith(" ") and known:
            optional = all(each.endswith(", optional") for each in known)
            kinds = {each.removesuffix(", optional"): None for each in known}
            shown = " or ".join(kind for kind in kinds if not any(f"{kind} " in other for other in kinds))
            lines[k] = f"{lines[k]} : {shown}{', optional' if optional else ''}"


def setup(app):
    """Add the directive, the role and the events."""
    app.add_directive("api", Api)
    app.add_role("code-or-link", code)
    app.connect("autodoc-process-docstring", add_types, priority=100)
    app.connect("doctree-resolved", link_code)
    return {"parallel_read_safe": True}
