"""Units of records: those above columns and in arguments, those that are unknown, and those that nobody states."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.set_58 import set58

import rattlebox as rb
from rattlebox.model.plausibility import plausibility_notes

G = 9.80665


def written(folder: Path, above: str) -> Path:
    """Write a record with a line above its numbers."""
    path = folder / "quake.csv"
    path.write_text((f"{above}\n" if above else "") + "0,0.1\n0.02,-0.2\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("unit", "factor", "si"),
    [
        ("g", G, "m/s^2"), ("G", G, "m/s^2"), ("gn", G, "m/s^2"), ("mg", G / 1e3, "m/s^2"), ("gal", 0.01, "m/s^2"),
        ("Gal", 0.01, "m/s^2"), ("GAL", 0.01, "m/s^2"), ("cm/s^2", 0.01, "m/s^2"), ("cm/s2", 0.01, "m/s^2"),
        ("cm/sec^2", 0.01, "m/s^2"), ("cm/sec/sec", 0.01, "m/s^2"), ("m s^-2", 1, "m/s^2"), ("ft/s^2", 0.3048, "m/s^2"),
        ("in/s^2", 0.0254, "m/s^2"), ("N", 1, "N"), ("kN", 1e3, "N"), ("lbf", 4.4482216152605, "N"), ("kgf", G, "N"),
        ("mm", 1e-3, "m"), ("in", 0.0254, "m"), ("ft", 0.3048, "m"),
    ],
)  # fmt: skip
def test_usual_units_above_a_column(tmp_path: Path, unit: str, factor: float, si: str) -> None:
    """Values are converted from the unit above their column, which means what it means for such a quantity."""
    for above in (f"time (s),x ({unit})", f"time [s],x [{unit}]", f"time,x\ns,{unit}"):
        record = rb.Record(file=written(tmp_path, above))
        assert record.unit == si
        np.testing.assert_allclose(record.evaluate(record.times), np.array([0.1, -0.2]) * factor, rtol=1e-14)


@pytest.mark.parametrize("unit", ["furlong", "rod", "a", "V", "counts", "s", "banana/s^2"])
def test_other_units_above_a_column_are_refused(tmp_path: Path, unit: str) -> None:
    """A unit that is unknown or of another dimension is refused; the arguments that are advised take its place."""
    path = written(tmp_path, f"time (s),x ({unit})")
    with pytest.raises(rb.DataError, match=r"file = .*\n  .* is not a unit of .*known: .*\n  try: unit = \"m/s\^2\""):
        rb.Record(file=path)
    advised = rb.Record(file=path, unit="m/s^2", scale=2.0)
    assert (advised.unit, advised.scale) == ("m/s^2", 2.0)
    assert rb.Record(file=path, unit="m/s^2").scale == 1


@pytest.mark.parametrize(("unit", "factor"), [("ms", 1e-3), ("min", 60.0), ("s", 1.0)])
def test_units_of_time(tmp_path: Path, unit: str, factor: float) -> None:
    """Times are converted from the unit above their column."""
    assert rb.Record(file=written(tmp_path, f"t ({unit}),x (N)")).times[1] == pytest.approx(0.02 * factor)


def test_unknown_units_of_time_are_refused(tmp_path: Path) -> None:
    """Times in an unknown unit are refused with advice."""
    with pytest.raises(rb.DataError, match=r'fortnight.* is not a unit of time.*\n  try: .*"time \(s\)"'):
        rb.Record(file=written(tmp_path, "t (fortnight),x (N)"))


@pytest.mark.parametrize("above", ["t,a(t)", "t,a (X)", "t,force (1)", "t,accelerometer", ""])
def test_a_unit_that_nobody_states_is_noted(tmp_path: Path, above: str) -> None:
    """A run notes the unit that it assumes and the peak in g, also after the case was written and read."""
    case = rb.Case(
        structure=rb.SDOF(mass=1, stiffness=100), base=rb.Record(file=written(tmp_path, above)), duration=0.02
    )
    for each in (case, rb.Case.from_toml(case.to_toml())):
        assert each == case
        (note,) = rb.simulate(each).notes
        assert "quake.csv" in note and "m/s^2 is assumed" in note and "0.2 m/s^2 = 0.02039 g" in note
    assert "m/s^2 is assumed" in str(rb.simulate(case).summary())
    assert plausibility_notes(case, signals=False) == (note,)  # of studies, too


def test_a_unit_that_is_stated_is_not_noted(tmp_path: Path) -> None:
    """Nothing is noted where the file or the user states the unit."""
    for above, options in (("t,a (g)", {}), ("t,a", {"unit": "m/s^2"})):
        base = rb.Record(file=written(tmp_path, above), **options)
        case = rb.Case(structure=rb.SDOF(mass=1, stiffness=100), base=base, duration=0.02)
        assert rb.simulate(case).notes == ()


def test_units_mean_what_their_quantity_is() -> None:
    """In accelerations g is gravity, mg a thousandth of it and gal cm/s^2; in masses g is gram."""
    for text, value in (("-5 g", -5 * G), ("3 mg", 3e-3 * G), ("3 gal", 0.03), ("1 gn", G), ("1 ft/s²", 0.3048)):
        assert rb.Harmonic(amplitude=text, frequency=1).amplitude == pytest.approx(value, rel=1e-14)
    assert rb.SDOF(mass="5 g", stiffness=1).mass == 0.005
    with pytest.raises(rb.CaseError, match="try: did you mean 'kg'"):
        rb.SDOF(mass="5 Kg", stiffness=1)


PSD_UNITS: list[tuple[dict[str, Any], float, str | None]] = [
    ({"unit": "g_0", "density": 0.04}, G, "m/s^2"),
    ({"unit": "gal", "density": 0.04}, 0.01, "m/s^2"),
    ({"unit": "kN", "density": 0.04}, 1e3, "N"),
    ({"density": "0.04 g_0^2/Hz"}, G, "m/s^2"),
    ({"density": "0.04 g²/Hz"}, G, "m/s^2"),
    ({"density": "0.04 (m/s^2)^2/Hz"}, 1, "m/s^2"),
    ({"density": "0.04 m^2/s^3"}, 1, "m/s^2"),
    ({"density": "0.04 kN^2/Hz"}, 1e3, "N"),
    ({"density": "0.04 mm^2/Hz"}, 1e-3, "m"),
    ({"density": "0.04 g^2/Hz", "unit": "m/s^2"}, G, "m/s^2"),
    ({"density": 0.04}, 1, None),
]


@pytest.mark.parametrize(("given", "factor", "unit"), PSD_UNITS)
def test_units_of_densities(given: dict[str, Any], factor: float, unit: str | None) -> None:
    """A random record takes densities in squares of units per Hz, and is in SI."""
    plain = rb.Random([(10, 0.04), (20, 0.04)], 1.0)
    density = given.pop("density")
    record = rb.Random([("10 Hz", density), ("0.02 kHz", density)], "1 s", direction="x", **given)
    assert (record.unit, record.direction) == (unit, "x")
    np.testing.assert_allclose(record.values, factor * np.array(plain.values), rtol=1e-12)


@pytest.mark.parametrize(
    ("psd", "options", "message"),
    [
        ([(10, 1), (20, 1)], {"unit": "furlong"}, r"unit = 'furlong'\n  'furlong' is not a unit"),
        (
            [(10, "1 g/Hz"), (20, 1)],
            {},
            r"psd\[0\]\[1\] = '1 g/Hz'\n  'g/Hz' is not the unit of a power spectral density",
        ),
        (
            [(10, "1 g^2/Hz"), (20, "1 N^2/Hz")],
            {},
            r"psd\[1\]\[1\] = '1 N\^2/Hz'\n  the density of a force, but others",
        ),
        (
            [(10, "1 g^2/Hz"), (20, "1 g^2/Hz")],
            {"unit": "N"},
            r"psd\[0\]\[1\] = '1 g\^2/Hz'\n  the density of an acceleration",
        ),
        ([(10, "1 furlong^2/Hz"), (20, 1)], {}, "not the unit of a power spectral density"),
        ("psd.csv", {}, "there is no density of this name"),
    ],
)
def test_wrong_units_of_densities(psd: Any, options: dict[str, Any], message: str) -> None:
    """Units of other dimensions than a density, and units that contradict each other, are refused with advice."""
    with pytest.raises(rb.CaseError, match=message):
        rb.Random(psd, 1.0, **options)


def test_a_rate_that_is_too_low_is_raised() -> None:
    """A random record has sixteen points in the shortest period at least, and more where they are asked for."""
    psd = [(10, 1.0), (50, 1.0)]
    assert len(rb.Random(psd, 1.0, 100).times) == len(rb.Random(psd, 1.0).times) == 801
    assert len(rb.Random(psd, 1.0, 2000).times) == 2001


def test_a_note_without_a_unit(tmp_path: Path) -> None:
    """The note on a record that no one gave a unit has its peak, not "None": only records in cases had been looked at."""
    notes = " ".join(rb.Record.from_file(written(tmp_path, "")).notes())
    assert "SI is assumed, with a peak of 0.2; set unit" in notes


def test_logarithmic_units_are_unknown() -> None:
    """A unit with octaves ended in an AttributeError of the library of units, which computes dimensions late."""
    with pytest.raises(rb.CaseError, match=r"unknown unit 'g\^2/oct'"):
        rb.HalfSine(amplitude="5 g^2/oct", duration="1 ms")


@pytest.mark.parametrize("options", [{}, {"unit": "m/s^2", "scale": 1.0}])
@pytest.mark.parametrize("above", ["t (s),v (cm/s)", "t (s),v [m/s]"])
def test_velocities_are_refused_with_any_unit(tmp_path: Path, above: str, options: dict[str, Any]) -> None:
    """The advice for an unknown unit, a factor, made accelerations of velocities; no test followed it for them."""
    with pytest.raises(rb.RattleboxError, match=r"'[cm]?m/s', written above the column(.|\n)*its derivative"):
        rb.Record.from_file(written(tmp_path, above), **options)


@pytest.mark.parametrize("above", ["time,velocity", "Zeit,Geschwindigkeit x", "时间,速度"])
def test_columns_with_the_name_of_a_velocity(tmp_path: Path, above: str) -> None:
    """A column with the name of a velocity and no unit was taken for an acceleration, with a note; a unit decides."""
    path = written(tmp_path, above)
    with pytest.raises(rb.DataError, match="is a velocity"):
        rb.Record.from_file(path)
    assert rb.Record.from_file(path, unit="g").unit == "m/s^2"
    assert rb.Record.from_file(written(tmp_path, "时间,加速度")).unit is None


SET_164 = """    -1
   164
        10             Model               2
   1.0000000000000000D+03   1.0000000000000000D+00   1.0000000000000000D+00
   0.0000000000000000D+00
    -1
"""


def test_universal_files_without_labels(tmp_path: Path) -> None:
    """Without labels the type of data and the units of the file count, which all labelled functions of tests left open.

    Velocities were taken for accelerations, and mm/s^2 for m/s^2.
    """
    pytest.importorskip("pyuff")
    text = set58(1, np.array([0.0, 4.0, -2.5, 0.5]), "NONE", over=17)
    path = tmp_path / "a.uff"
    path.write_text(SET_164 + with_quantity(text, 12))
    record = rb.Record.from_file(path)
    np.testing.assert_allclose(record.values, [0.0, 0.004, -0.0025, 0.0005], rtol=1e-12)
    assert "set 164" in "".join(record.notes())
    assert rb.Record.from_file(path, unit="g").peak == 4 * G
    path.write_text(with_quantity(text, 11))
    with pytest.raises(rb.DataError, match="its derivative"):
        rb.Record.from_file(path)


def with_quantity(text: str, kind: int) -> str:
    """Return a set 58 with another type of data of its values."""
    lines = text.splitlines(keepends=True)
    return "".join([*lines[:10], f"{kind:10d}{lines[10][10:]}", *lines[11:]])


@pytest.mark.parametrize(
    "line",
    [
        "Unité : mg",
        "UNITÉ: MG",
        "Unite: mg",
        "units of acceleration: mg",
        "Einheit der Beschleunigung: mg",
        "units: s, mg",
    ],
)
def test_units_in_lines_of_other_languages(tmp_path: Path, line: str) -> None:
    """Words between "unit" and the unit were overlooked, and so was "unité": its test had a unit that stands for itself."""
    (tmp_path / "a.txt").write_text(f"# {line}\n0 0.5\n0.02 -20\n0.04 1\n", encoding="utf-8")
    assert rb.Record.from_file(tmp_path / "a.txt").peak == pytest.approx(0.02 * G, rel=1e-12)
