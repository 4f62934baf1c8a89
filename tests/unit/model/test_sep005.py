"""Time histories of SEP005, which other packages of structural dynamics exchange, and which were copied by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rattlebox as rb

TIP: dict[str, Any] = {"name": "tip", "data": [0.0, 2.5, -1.5, 0.5], "fs": 200.0, "unit_str": "g", "quantity": "a"}
PUSH: dict[str, Any] = {"name": "push", "data": np.array([1.0, 2.0]), "time": [0.0, 0.25], "unit_str": "kN"}


def test_channels() -> None:
    """Name, values, unit and times are those of the dictionary; a list is searched by name."""
    tip = rb.Record.from_sep005(TIP, direction="x")
    assert (tip.name, tip.unit) == ("tip", "m/s^2")
    np.testing.assert_allclose(tip.values, 9.80665 * np.array(TIP["data"]), rtol=1e-15)
    np.testing.assert_allclose(tip.times, [0, 0.005, 0.01, 0.015])
    push = rb.Record.from_sep005([TIP, PUSH], "push", scale=2)
    assert push.unit == "N" and push.times.tolist() == [0, 0.25]
    np.testing.assert_allclose(push.polyline()[1], [2e3, 4e3])
    start = {**PUSH, "time": [3.0, 3.25]}
    assert rb.Record.from_sep005(start, time_zero="first").polyline()[0].tolist() == [0, 0.25]
    counts = {**TIP, "unit_str": "V", "quantity": ""}
    assert rb.Record.from_sep005(counts, unit="N", scale=100).peak == 250


def test_as_a_set() -> None:
    """Channels make a set of records, and a record is the base of a case."""
    records = rb.RecordSet({each["name"]: rb.Record.from_sep005(each) for each in (TIP, {**TIP, "name": "top"})})
    structure = rb.SDOF(mass="2 kg", frequency="9 Hz", damping_ratio=0.02)
    case = rb.Case(structure=structure, base=records["tip"], duration="15 ms")
    assert rb.sweep(case, {"base": records}, ["peak"], progress=False)["base"].values.tolist() == ["tip", "top"]


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        ({"data": None}, {}, "data has the shape"),
        ({"data": [1.0, None, 2.0]}, {}, "data has nan at index 1"),
        ({"data": [1.0, "x"]}, {}, "data has items that are no numbers"),
        ({"data": np.array([1.0, 2j])}, {}, "data has items that are no numbers"),
        ({"data": ["1.0", "2.0"]}, {}, "data has items that are no numbers"),
        ({"data": [1.0, 10**400]}, {}, "data has items that are no numbers"),
        ({"unit_str": np.arange(3)}, {}, "unit_str of a channel is array"),
        ({"data": [[1.0, 2.0], [3.0, 4.0]]}, {}, r"data has the shape \(2, 2\)"),
        ({"fs": None}, {}, "has neither time nor fs"),
        ({"fs": 0}, {}, "has fs = 0 Hz"),
        ({"fs": "fast"}, {}, "has fs = 'fast'"),
        ({"time": [0.0, 1.0]}, {}, "has 2 times, but 4 values"),
        ({"time": [0.0, 1.0, 2.0, 3.0]}, {}, "has fs = 200 Hz, but times at steps of 1 s"),
        ({"fs": None, "time": [0.0, 2.0, 1.0, 3.0]}, {}, "times must increase"),
        ({"unit_str": ""}, {}, r"has no unit_str\n.*unit = "),
        ({"unit_str": "degC"}, {}, "has unit_str = 'degC'"),
        ({"unit_str": "N"}, {}, "has unit_str = 'N', but quantity 'a', an acceleration"),
        ({"quantity": "v", "unit_str": "mm/s"}, {}, "is a velocity"),
        ({}, {"unit": "N"}, "has unit_str = 'g', not 'N'"),
        ({}, {"channel": "top"}, "no channel is called 'top'; there are tip"),
    ],
)
def test_bad_channels(changes: dict, options: dict, message: str) -> None:
    """What a dictionary lacks or contradicts is named."""
    with pytest.raises(rb.CaseError, match=message) as error:
        rb.Record.from_sep005({**TIP, **changes}, **options)
    assert "try: " in str(error.value) or "did you mean" in str(error.value) or "known: " in str(error.value)


@pytest.mark.parametrize("given", [3, "tip", [], [TIP, 3], None, [TIP, PUSH], [TIP, TIP], {"Data": [1, 2]}])
def test_no_dictionaries(given: Any) -> None:
    """Other values, lists without a choice and keys in capitals are refused."""
    with pytest.raises(rb.CaseError, match="try: "):
        rb.Record.from_sep005(given, *(["tip"] if given == [TIP, TIP] else []))


def test_damaged_dictionaries() -> None:
    """Fields of any type and size are read to finite numbers or refused, never with another error."""
    junk = [None, "", "x" * 10**5, float("nan"), -1, 10**400, [], [[]], {}, [None], b"a", True, np.arange(4), "kN", {1}]
    junk += [np.arange(4) * 1j, np.zeros((2, 2)), np.array(["a"] * 4), range(4), object(), [1e308] * 4, "a\x00b"]
    random = np.random.default_rng(11)
    for number in range(300):
        given: Any = {**TIP, "time": [0.0, 0.005, 0.01, 0.015]}
        for _ in range(random.integers(1, 4)):
            key = str(random.choice(list(TIP)))
            given[key.upper() if random.random() < 0.2 else key] = junk[random.integers(len(junk))]
            if random.random() < 0.2:
                given.pop(key, None)
        message = ""
        try:
            record = rb.Record.from_sep005([given, PUSH] if random.random() < 0.3 else given, "tip")
            assert np.isfinite(record.values).all()
        except rb.RattleboxError as error:
            message = str(error)
        assert len(message) < 5000, f"mutant {number}"
