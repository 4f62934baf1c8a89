"""Random changes of case files: the result is a case or an error of the package."""

from __future__ import annotations

import copy
import tomllib
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rattlebox as rb

EXAMPLES = Path(__file__).parents[2] / "examples"
TEXTS = [path.read_text(encoding="utf-8") for path in sorted(EXAMPLES.glob("*.toml"))]

UNITS = [
    "",
    "mm",
    "m",
    "kN",
    "kg",
    "s",
    "Hz",
    "rad/s",
    "deg",
    "g_0",
    "m/s^2",
    "N s/m",
    "GPa",
    "furlong",
    "m^-1",
    "%",
    "°C",
]
WORDS = [
    "sdof",
    "modal",
    "matrices",
    "fixed",
    "shaker",
    "tsuji",
    "linear",
    "thornton",
    "johnson",
    "jackson_green",
]
WORDS += ["constant", "table", "half_sine", "harmonic", "record", "newton", "two_step", "event_driven"]
WORDS += ["rigid", "steel", "tip", "zero_force", "rk4"]
KEYS = [
    "kind",
    "mass",
    "gap",
    "cavity_length",
    "ball",
    "balls",
    "load",
    "loads",
    "damper",
    "dampers",
    "base",
    "start",
]
KEYS += [
    "velocity",
    "restitution",
    "alpha",
    "wall",
    "material",
    "materials",
    "method",
    "output",
    "rate",
    "times",
]
KEYS += [
    "values",
    "file",
    "shapes",
    "points",
    "M",
    "C",
    "K",
    "motion",
    "contact",
    "ball_contact",
    "gravity",
    "e",
]

numbers = st.one_of(
    st.floats(),
    st.integers(-(10**6), 10**6),
    st.sampled_from([0, -1, 1, 1e-300, 1e300, 10**400]),
)
quantities = st.builds(lambda x, unit: f"{x} {unit}", st.floats(), st.sampled_from(UNITS))
leaves = st.one_of(numbers, quantities, st.booleans(), st.dates(), st.sampled_from(WORDS), st.text(max_size=8))
anything = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(st.sampled_from(KEYS) | st.text(max_size=4), inner, max_size=3),
    ),
    max_leaves=5,
)
many_examples = settings(
    derandomize=True, max_examples=250, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)


def places(node: Any) -> list[tuple[Any, Any]]:
    """Return each container of a case file with each of its keys."""
    if isinstance(node, dict):
        result = [(node, key) for key in node]
    elif isinstance(node, list):
        result = [(node, index) for index in range(len(node))]
    else:
        return []
    return result + [place for container, key in result for place in places(container[key])]


@st.composite
def mutated(draw: st.DrawFn) -> str:
    """Draw an example file with up to three values replaced, removed or added."""
    data = copy.deepcopy(tomllib.loads(draw(st.sampled_from(TEXTS))))
    for _ in range(draw(st.integers(1, 3))):
        container, key = draw(st.sampled_from(places(data)))
        change = draw(st.sampled_from(["replace", "replace", "remove", "add"]))
        if change == "replace":
            container[key] = draw(anything)
        elif change == "remove":
            del container[key]
        elif isinstance(container, dict):
            container[draw(st.sampled_from(KEYS))] = draw(anything)
        if not places(data):
            break
    return tomli_w.dumps(data)


def case_or_case_error(text: str) -> rb.Case | None:
    """Read a case file; errors must be of the package and fit on a screen."""
    try:
        return rb.Case.from_toml(text, source="case.toml")
    except (rb.CaseError, rb.DataError, rb.ResourceError) as error:
        message = str(error)
        assert "case.toml" in message
        assert len(message.splitlines()) <= 24
        return None


@many_examples
@given(mutated())
def test_a_mutated_case_file_is_a_case_or_a_case_error(text: str) -> None:
    """No value of any type in any place raises another error."""
    case_or_case_error(text)


@many_examples
@given(st.sampled_from(TEXTS), st.data())
def test_a_case_file_with_damaged_text_is_a_case_or_a_case_error(text: str, data: st.DataObject) -> None:
    """No truncated, inserted or overwritten text raises another error."""
    start = data.draw(st.integers(0, len(text)))
    stop = data.draw(st.integers(start, min(len(text), start + 40)))
    case_or_case_error(text[:start] + data.draw(st.text(max_size=12)) + text[stop:])


@settings(derandomize=True, max_examples=200, deadline=None)
@given(st.text(max_size=60))
def test_any_text_is_refused(text: str) -> None:
    """A random text raises a CaseError."""
    assert case_or_case_error(text) is None


SDOF = 'duration = "1 s"\nstructure = {{ kind = "sdof", mass = 1, stiffness = 1 }}\n'
FRAMES = {
    "duration": "duration = {value}\n",
    "mass": 'duration = "1 s"\n[structure]\nkind = "sdof"\nstiffness = 1\nmass = {value}\n',
    "shapes": 'duration = "1 s"\n[structure]\nkind = "modal"\nfrequencies = [1]\ndamping_ratios = [0]\n'
    "shapes = {{ tip = {value} }}\n",
    "start": SDOF + "[damper]\nstart = {value}\n",
    "values": SDOF + '[load]\nkind = "record"\nvalues = {value}\n',
}


@pytest.mark.parametrize(
    "value",
    [
        "1" + "0" * 400,
        "1" + "0" * 5000,
        "[" * 3000 + "]" * 3000,
        '"1e99999 mm"',
        '"1 m**99999"',
        "1979-05-27T07:32:00Z",
        "{}",
    ],
    ids=["large integer", "huge integer", "deep", "overflow", "power", "time", "table"],
)
@pytest.mark.parametrize("field", FRAMES)
def test_extreme_values(field: str, value: str) -> None:
    """Integers, nestings, powers and types beyond any field raise a CaseError."""
    assert case_or_case_error(FRAMES[field].format(value=value)) is None
