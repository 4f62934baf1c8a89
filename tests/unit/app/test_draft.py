"""The case that the browser application edits."""

import pytest

import rattlebox as rb
from rattlebox.app.draft import TEMPLATES, Draft, dotted, numeric_paths, python_script, quantity, template


@pytest.fixture
def draft(tmp_path):
    """Return a draft with the first template."""
    return Draft(tmp_path)


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_are_valid_cases(draft, name):
    """Each template is a case, and its script gives the same case."""
    draft.set_text(template(name))
    assert draft.errors == {}
    names = {}
    exec(python_script(draft.text, "pass"), names)
    assert names["case"] == draft.case


def test_value_is_changed_in_case_and_text(draft):
    """A changed value is in the case and in its text; a removed one takes its default."""
    draft.set_value(("damper", "gap"), "0.7 mm")
    assert draft.case.dampers[0].gap == pytest.approx(0.7e-3)
    assert rb.Case.from_toml(draft.text) == draft.case
    draft.set_value(("damper", "start"), None)
    assert "start" not in draft.text


def test_errors_are_found_by_their_field(draft):
    """Errors have the path of their field; after the correction the draft has a case again."""
    draft.set_value(("damper", "gap"), "-0.4 mm")
    draft.set_value(("structure", "stiffness"), "80 kN/s")
    assert draft.case is None
    assert set(draft.errors) == {"damper.gap", "structure.stiffness"}
    assert "80 kN/m" in draft.errors["structure.stiffness"]
    draft.set_value(("damper", "gap"), "0.4 mm")
    draft.set_value(("structure", "stiffness"), "80 kN/m")
    assert draft.case is not None


def test_unknown_field_is_reported(draft):
    """A field that does not exist is reported with the one that is meant."""
    draft.set_text(draft.text.replace('gap = "2 mm"', 'gapp = "2 mm"'))
    assert any("gap" in text for text in draft.errors.values())


@pytest.mark.parametrize(
    "text",
    [
        "a = [" * 3000 + "]" * 3000,
        "a = " + "[" * 30 + "]" * 30,
        "x" * 500_000,
        "duration = 1e400",
        "duration = " + "9" * 5000,
        "= 3",
        "",
        "name = '\x00'",
    ],
    ids=["recursion", "nested", "long", "infinite", "digits", "syntax", "empty", "null"],
)
def test_bad_text_is_refused(draft, text):
    """Text that is no case, or that would exhaust a parser, gives an error; the draft can be used afterwards."""
    draft.set_text(text)
    assert draft.case is None
    assert draft.errors
    draft.set_text(template("row"))
    assert draft.case is not None


@pytest.mark.parametrize("file", ["/etc/passwd", "../secret.csv", "sub/../../x.csv", "link/x.csv"])
def test_files_outside_of_the_folder_are_refused(draft, tmp_path_factory, file):
    """A case cannot read a file outside of the folder, not even through a link."""
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (elsewhere / "x.csv").write_text("0,0\n1,1\n")
    (draft.folder / "link").symlink_to(elsewhere)
    draft.set_value(("load",), {"kind": "record", "file": file})
    assert "outside" in " ".join(draft.errors.values())


def test_file_in_the_folder_is_read(draft):
    """A record in the folder is read."""
    (draft.folder / "load.csv").write_text("t,F\n0,0\n1,1\n5,0\n")
    draft.set_value(("load",), {"kind": "record", "file": "load.csv"})
    assert draft.errors == {}


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("0.4 mm", (0.4, "mm")),
        ("1e-3", (1e-3, "")),
        (3, (3.0, "")),
        ("steel", None),
        (True, None),
        ("5 m/s^2", (5.0, "m/s^2")),
    ],
)
def test_quantity(value, expected):
    """Numbers with and without units are split."""
    assert quantity(value) == expected


def test_numeric_paths(draft):
    """All single numbers of a case are listed by their path."""
    names = [dotted(path) for path in numeric_paths(draft.given)]
    assert "damper.gap" in names
    assert "damper.ball.radius" in names
    assert "structure.kind" not in names
