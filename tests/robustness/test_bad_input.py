"""Bad input in case files and in Python: one short message with the place, what is wrong and what to try."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.struck import CASE_FILE

import rattlebox as rb
from rattlebox.model.base import vocabulary
from rattlebox.model.synonyms import MEANT

GOOD = 'duration = "5 s"\n' + CASE_FILE

SCREEN = 24
"""Lines of a small terminal."""


def error_of(text: str) -> str:
    """Return the error message of a case file, which must be short."""
    with pytest.raises(rb.CaseError) as caught:
        rb.Case.from_toml(text, source="case.toml")
    message = str(caught.value)
    assert message.startswith("case.toml: ")
    assert len(message.splitlines()) <= SCREEN
    return message


def changed(old: str, new: str) -> str:
    """Return the valid case with one change."""
    assert GOOD.count(old) == 1
    return GOOD.replace(old, new)


def test_valid_case_is_accepted() -> None:
    """The case that the other tests change is valid."""
    assert rb.Case.from_toml(GOOD).structure.mass == 20.0


@pytest.mark.parametrize(
    ("old", "new", "pattern"),
    [
        ('mass = "20 kg"', 'mass = "-20 kg"', ["structure.mass", "greater than zero"]),
        ('mass = "20 kg"', "mass = 0", ["structure.mass", "greater than zero"]),
        ('mass = "20 kg"', "", ["structure.mass", "needed"]),
        ('stiffness = "80 kN/m"', 'stiffness = "-1 N/m"', ["structure.stiffness", "negative"]),
        ('amplitude = "5 kN"', 'amplitude = "5 kg"', ["amplitude", "'5 kg'", "force", "not a mass", "5 kN"]),
        (
            'amplitude = "5 kN"',
            'amplitude = "5 mm"',
            ["load.amplitude = '5 mm'", "a force (N) is needed", "not a length"],
        ),
        ('amplitude = "5 kN"', 'amplitude = "5 kX"', ["amplitude", "unknown unit 'kX'"]),
        ('gap = "0.4 mm"', 'gap = "0.4 mmm"', ["gap", "unknown unit 'mmm'", "did you mean 'mm'?"]),
        ('gap = "0.4 mm"', 'gap = "-0.4 mm"', ["gap", "negative"]),
        ('gap = "0.4 mm"', 'gap = "five mm"', ["gap", "length"]),
        ('gap = "0.4 mm"', "gap = nan", ["gap", "finite"]),
        ('duration = "5 s"', "duration = inf", ["duration", "finite"]),
        ('duration = "5 s"', "duration = true", ["duration", "time"]),
        ('duration = "5 s"', "duration = 1979-05-27", ["duration", "time"]),
        ('duration = "5 s"', 'duration = "0 s"', ["duration", "greater than zero"]),
        (
            'stiffness = "80 kN/m"',
            'stifness = "80 kN/m"',
            ["structure.stifness", "did you mean 'stiffness'?"],
        ),
        ('kind = "sdof"', 'kind = "sdov"', ["structure", "did you mean 'sdof'?"]),
        ('material = "steel"', 'material = "stel"', ["material", "did you mean 'steel'?"]),
        ("restitution = 0.9", "restitution = 1.2", ["restitution", "1.2", "between 0", "and 1"]),
        ("restitution = 0.9", "restitution = -0.1", ["restitution", "between 0"]),
        ("restitution = 0.9", "restitution = 0.0", ["restitution", "Newton"]),
        ("restitution = 0.9", "alpha = nan", ["alpha", "finite"]),
        ("restitution = 0.9", "restitution = 0.9, alpha = 0.1", ["restitution", "alpha", "not both"]),
        (
            'gap = "0.4 mm"',
            'cavity_length = "66 mm"',
            ["damper.cavity_length = '66 mm'", "shorter than the row of balls, which is 66.34 mm"],
        ),
        ('gap = "0.4 mm"', 'gap = "70 mm"\ncavity_length = "67 mm"', ["gap", "cavity_length"]),
        ('gap = "0.4 mm"', 'gap = "0.4 mm"\nstart = 1.5', ["inside a wall", "start"]),
        ('gap = "0.4 mm"', 'gap = "0.4 mm"\nstart = "0.5 mm"', ["inside a wall", "start"]),
        ('gap = "0.4 mm"', 'gap = "0.4 mm"\nvelocity = nan', ["velocity", "finite"]),
        ('amplitude = "5 kN"', 'amplitude = "5 kN"\npoint = "tip"', ["no point 'tip'", "mass"]),
        ('duration = "5 s"', 'duration = "5 s"\nseed = 1.5', ["seed", "integer"]),
        ('duration = "5 s"', 'duration = "5 s', ["not TOML", "line 1"]),
        ('duration = "5 s"', "duration = 5,5", ["not TOML", "try: a point before decimals: duration = 5.5"]),
        ('gap = "0.4 mm"', 'gap = "0,4 mm"', ["gap", "decimal point", 'try: "0.4 mm"']),
        ('amplitude = "5 kN"', 'amplitude = "5,000 N"', ["amplitude", 'try: "5.000 N" or "5000 N"']),
        ('amplitude = "5 kN"', 'amplitude = "1,234,567 N"', ["amplitude = '1,234,567 N'", "thousands"]),
        ("restitution = 0.9", 'restitution = "0,9"', ["restitution", 'try: "0.9"']),
        ('gap = "0.4 mm"\n', "", ["damper", "gap or cavity_length is needed", 'try: gap = "0.4 mm"']),
        ("restitution = 0.9", 'ending = "zero_force"', ["damper.contact", "restitution or alpha is needed"]),
        ('contact = { kind = "tsuji", restitution = 0.9 }', "", ["contact", 'try: contact = { kind = "tsuji", ... }']),
    ],
)
def test_one_mistake(old: str, new: str, pattern: list[str]) -> None:
    """The message of one mistake has its place and what is allowed."""
    message = error_of(changed(old, new))
    for words in pattern:
        assert words in message


@pytest.mark.parametrize(
    ("old", "new", "meant"),
    [
        ("mass =", "m =", "mass"),
        ("stiffness =", "k =", "stiffness"),
        ("damping =", "c =", "damping"),
        ("radius =", "r =", "radius"),
        ("gap =", "clearance =", "gap cavity_length"),
        ('amplitude = "5 kN"', 'force = "5 kN"', "amplitude"),
        ("restitution = 0.9", "COR = 0.9", "restitution"),
        ('duration = "5 s"', 't_end = "5 s"', "duration"),
    ],
)
def test_names_of_other_programs(old: str, new: str, meant: str) -> None:
    """A field under its name in other programs is reported once, with our name and without a message on missing fields."""
    message = error_of(changed(old, new))
    expected = " or ".join(repr(name) for name in meant.split())
    assert message.endswith(f"there is no such field here\n  try: did you mean {expected}?")
    assert message.count("try:") == 1


def test_suggested_names_exist() -> None:
    """Each suggestion for a name of other programs is a field, a kind or a face of a box."""
    places = [names for kinds in vocabulary().values() for names in (set(kinds), *kinds.values())]
    places.append(set(rb.Box(size=("1 m", "1 m", "1 m")).walls().names))
    for name, ours in MEANT.items():
        assert all(any(part in names for names in places) for word in ours for part in word.split(".")), name


def test_overlapping_balls() -> None:
    """Balls that overlap at the start are refused with their numbers and the size of the overlap."""
    with pytest.raises(rb.CaseError, match=r"balls 2 and 3 overlap by 0\.2 mm"):
        rb.ImpactDamper(
            balls=[rb.Sphere(radius="5 mm", material="steel")] * 3,
            gap="1 mm",
            start=[-0.5, 0.5, 0.3],
            contact=rb.Tsuji(restitution=0.9),
        )


def test_number_of_positions() -> None:
    """Two positions for three balls are refused."""
    with pytest.raises(rb.CaseError, match="2 positions, but there are 3 balls"):
        rb.ImpactDamper(
            balls=[rb.Sphere(radius="5 mm", material="steel")] * 3,
            gap="1 mm",
            start=[0.0, 0.3],
            contact=rb.Tsuji(restitution=0.9),
        )


@pytest.mark.parametrize("poisson", [0.6, -1.0, math.nan])
def test_poisson_ratio(poisson: float) -> None:
    """A Poisson ratio outside (-1, 0.5] is refused."""
    with pytest.raises(rb.CaseError, match="poisson"):
        rb.Material(name="odd", density=1000.0, young=1e9, poisson=poisson)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_record_with_nan_or_infinity(value: float) -> None:
    """NaN or an infinity in a record is refused with its index."""
    with pytest.raises(rb.CaseError, match="number 2 of 3"):
        rb.Record(times=[0.0, 1.0, 2.0], values=[0.0, value, 0.0])


@pytest.mark.parametrize("times", [[0.0, 1.0, 1.0], [0.0, 2.0, 1.0]])
def test_record_with_times_that_do_not_increase(times: list[float]) -> None:
    """A record whose times do not increase is refused with the point."""
    with pytest.raises(rb.CaseError, match="point 3"):
        rb.Record(times=times, values=[0.0, 1.0, 2.0])


def test_record_that_ends_before_the_run() -> None:
    """A record shorter than the run is refused with both times."""
    with pytest.raises(rb.CaseError, match=r"0 s to 1 s, the run 0 to 2 s"):
        rb.Case(
            structure=rb.SDOF(mass=1.0, stiffness=1.0),
            load=rb.Record(times=[0.0, 1.0], values=[0.0, 1.0], unit="N"),
            duration=2.0,
        )


@pytest.mark.parametrize(
    ("rows", "line"),
    [
        ("time,force\n0,0\n1,soft\n2,0\n", 3),
        ("0,0\n1,nan\n", 2),
        ("0,0\n\n1,2,3\n", 3),
        ("# recorded\n0;0\n1;1\n2;-\n", 4),
    ],
)
def test_csv_without_numbers(tmp_path: Path, rows: str, line: int) -> None:
    """Text, NaN or a third column in a CSV file is refused with file and line."""
    file = tmp_path / "push.csv"
    file.write_text(rows, encoding="utf-8")
    with pytest.raises(rb.DataError, match=rf"push\.csv, line {line}:"):
        rb.Record.from_file(file, unit="N")


def test_csv_named_in_a_case_file(tmp_path: Path) -> None:
    """The message on a bad CSV file of a case file has both names."""
    (tmp_path / "push.csv").write_text("0,0\n6,high\n", encoding="utf-8")
    load = 'kind = "record"\nunit = "N"\nfile = "push.csv"\n'
    case = tmp_path / "case.toml"
    case.write_text(changed('kind = "half_sine"\namplitude = "5 kN"\nduration = "1 ms"\n', load), encoding="utf-8")
    with pytest.raises(rb.DataError, match=r"(?s)case\.toml: .*push\.csv, line 2:"):
        rb.Case.from_file(case)


@pytest.mark.parametrize("name", ["none.csv", "none.npy", "none.mat"])
def test_missing_record_file(tmp_path: Path, name: str) -> None:
    """A missing record file is refused with its name."""
    with pytest.raises(rb.DataError, match=name):
        rb.Record.from_file(tmp_path / name, unit="N")


@pytest.mark.parametrize("name", ["noise.npy", "noise.mat"])
def test_invalid_record_file(tmp_path: Path, name: str) -> None:
    """Bytes that are no NPY or MAT file are refused with the name of the file."""
    (tmp_path / name).write_bytes(bytes(range(256)))
    with pytest.raises(rb.DataError, match=name):
        rb.Record.from_file(tmp_path / name, unit="N")


def test_unreadable_case_file(tmp_path: Path) -> None:
    """A case file that is missing or not text is refused with its name."""
    with pytest.raises(rb.CaseError, match=r"none\.toml"):
        rb.Case.from_file(tmp_path / "none.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(rb.CaseError, match=r"bytes\.toml"):
        rb.Case.from_file(tmp_path / "bytes.toml")


@pytest.mark.parametrize("law", [rb.JacksonGreen(), rb.ThorntonRestitution(), rb.Johnson()])
def test_law_that_needs_a_yield_stress(law: Any) -> None:
    """A law that needs a yield stress is refused for glass against glass."""
    with pytest.raises(rb.CaseError, match="yield stress"):
        rb.Case(
            structure=rb.Fixed(),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius="5 mm", material="glass"), gap="1 mm", contact=rb.Tsuji(restitution=law)
            ),
            duration=1.0,
        )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"M": [[1.0, 0.0], [0.0, 0.0]]}, "M is not positive definite"),
        ({"K": [[1.0, 0.0], [0.0, -1.0]]}, "K is not positive semidefinite"),
        ({"K": [[1.0, 1.0], [0.0, 1.0]]}, "K is not symmetric"),
        ({"C": [[-0.2, 0.1], [0.1, -0.2]]}, "C is not positive semidefinite: .* would gain energy"),
        ({"points": {"end": 2}}, "no such degree of freedom"),
        ({"C": [[0.0]]}, "C has shape"),
    ],
)
def test_invalid_matrices(change: dict[str, Any], message: str) -> None:
    """Matrices of no stable structure are refused with the name of the matrix."""
    zero = [[0.0, 0.0], [0.0, 0.0]]
    good = {"M": np.eye(2), "C": zero, "K": [[2.0, -1.0], [-1.0, 2.0]], "points": {"end": 1}}
    with pytest.raises(rb.CaseError, match=message):
        rb.Matrices(**(good | change))


def test_pulse_as_displacement() -> None:
    """A pulse as the displacement of a shaker is refused."""
    with pytest.raises(rb.CaseError, match="acceleration"):
        rb.Shaker(motion=rb.HalfSine(amplitude="1 mm", duration="1 ms"))


def test_load_on_a_fixed_structure() -> None:
    """A force on a fixed cavity is refused."""
    with pytest.raises(rb.CaseError, match="cannot move a fixed structure"):
        rb.Case(structure=rb.Fixed(), load=rb.HalfSine(amplitude="1 N", duration="1 ms"), duration=1.0)


def without_play(gap: str, method: object) -> rb.Case:
    """Return a ball in a cavity with a small or zero gap on a structure that vibrates."""
    return rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=4e3, velocity=0.1),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius=0.01, material="steel"), gap=gap, contact=rb.Tsuji(restitution=0.5)
        ),
        duration=0.1,
        method=method,
    )


def test_ball_without_play() -> None:
    """Hard impacts with a gap of zero are refused; soft contacts hold such a ball, and the ledger closes."""
    with pytest.raises(rb.CaseError, match=r"damper\.gap = 0\.0"):
        without_play("0 mm", rb.Newton())
    assert rb.simulate(without_play("1 nm", rb.Newton())).energy_residual <= 1e-11
    run = rb.simulate(without_play("0 mm", rb.EventDriven()))
    assert run.ok and run.energy_residual <= 1e-11


def test_function_as_load() -> None:
    """A function as a load is refused with how to make a record of it."""
    with pytest.raises(rb.CaseError, match=r"load = <function .*\n  a function .*\n  try: rb\.Record\("):
        rb.Case(structure=rb.SDOF(mass=1, stiffness=1), load=lambda t: t, duration=1)


def test_numbers_that_overflow() -> None:
    """Numbers whose powers overflow are refused with their place, also if laws combine them."""
    with pytest.raises(rb.CaseError, match=r"radius = 1e\+150\n  no more than 1e\+30"):
        rb.Sphere(radius=1e150, material="steel")
    with pytest.raises(rb.CaseError, match=r"radius = 1e-150\n  no less than 1e-30"):
        rb.Sphere(radius=1e-150, material="steel")
    with pytest.raises(rb.CaseError, match=r"shapes.tip .*\n  number 1 of 1 is more than 1e\+30"):
        rb.Modal(frequencies=[1.0], damping_ratios=[0.0], shapes={"tip": [1e200]})
    soft = rb.Material(density=1e-30, young=1e-30, poisson=0.3)
    plastic = rb.Tsuji(restitution=rb.JacksonGreen(yield_stress=1e30))
    damper = rb.ImpactDamper(ball=rb.Sphere(radius=1e30, material=soft), gap=1e-3, contact=plastic)
    with pytest.raises(rb.CaseError, match="sizes, masses and moduli"):
        rb.Case(structure=rb.SDOF(mass=1.0, stiffness=1.0), damper=damper, duration=1.0)


def sine_sweep(**changed: Any) -> rb.SineSweep:
    """Return a sine_sweep from 5 Hz to 100 Hz with other arguments."""
    return rb.SineSweep(**{"amplitude": "1 m/s^2", "first_frequency": 5.0, "last_frequency": 100.0} | changed)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rb.SDOF(20.0, 80e3), "SDOF takes its fields by name: .*mass, stiffness"),
        (lambda: rb.Constant(0.5, e=0.4), "Constant takes its fields by name"),
        (lambda: rb.Tsuji(restitution=rb.Thornton()), "Thornton does not belong here"),
        (lambda: rb.Case(structure=rb.Thornton(), duration=1.0), "there is no such kind here"),
        (lambda: rb.Case(structure=rb.SDOF(mass=1e-320, stiffness=1.0), duration=1.0), "no less than 1e-30"),
        (lambda: rb.Modal(frequencies=[], damping_ratios=[], shapes={"tip": []}), "at least one mode"),
        (lambda: rb.Random([(1.0, 2.0), (300.0, 1.0)], 1.0, -10.0), "rate = -10.0\n  must be greater than zero"),
        (lambda: rb.Random([(0.1, 1.0), (0.2, 1.0)], 1.0, 10.0), "a longer duration"),
        (lambda: rb.Random([(1.0, 2.0), (3.0, -1.0)], 1.0, 10.0), "positive .* pairs"),
        (lambda: rb.Random([(1.0, "high")], 1.0, 10.0), r"psd\[0\]\[1\] = 'high'\n  a finite number is needed"),
        (lambda: rb.Random(np.zeros((0, 2)), 1.0, 10.0), "positive .* pairs"),
        (lambda: rb.Random([(1.0, 2.0), (3.0, 1.0)], "2 m", 10.0), "duration = '2 m'\n  a time .* is needed"),
        (lambda: rb.Random([(1.0, 2.0), (3.0, 1.0)], 2.0, "fast"), "rate = 'fast'\n  a frequency .* is needed"),
        (lambda: rb.Random([(1.0, 2.0), (3.0, 1.0)], 2.0, 10.0, seed=-1), "seed = -1\n  must be at least 0"),
        (lambda: rb.Random([(1.0, 2.0), (3.0, 1.0)], 2.0, 10.0, seed="a"), "seed = 'a'\n  an integer is needed"),
        (lambda: rb.Random("gevs", 2.0), "there is no density of this name\n  try: known: gevs_acceptance"),
        (lambda: rb.Random("gevs_acceptance", 2.0, unit="N"), "is an acceleration"),
        (lambda: sine_sweep(first_frequency=-1.0, sweep_rate="2 oct/min"), "must be greater than zero"),
        (lambda: sine_sweep(first_frequency="1 m", sweep_rate="2 oct/min"), "a frequency .* is needed"),
        (lambda: sine_sweep(last_frequency=5.0, sweep_rate="2 oct/min"), "two different frequencies"),
        (lambda: sine_sweep(sweep_rate="2 octaves"), "oct/min, oct/s, dec/min, Hz/s or Hz/min"),
        (lambda: sine_sweep(sweep_rate="2..3 oct/min"), "oct/min, oct/s, dec/min, Hz/s or Hz/min"),
        (lambda: sine_sweep(sweep_rate="-2 oct/min"), "must be greater than zero"),
        (lambda: sine_sweep(sweep_rate="1e-9 Hz/s"), "cycles; at most"),
        (lambda: sine_sweep(sweep_rate="1 Hz/s", duration=1.0), "a rate or a duration"),
        (lambda: sine_sweep(), "a rate or a duration"),
        (lambda: rb.Trapezoid(amplitude="1 N", duration=1.0, rise=0.6), "rise and fall last 1.2 s"),
        (lambda: rb.Sawtooth(amplitude="1 N", duration=0.0), "must be greater than zero"),
        (lambda: rb.Sawtooth(amplitude="1 N", duration=1.0, peak="late"), "'terminal' or 'initial'"),
        (lambda: rb.simulate("case.toml"), "a Case is needed, not 'case.toml'\n  try: rb.Case.from_file"),
        (lambda: rb.simulate_many(rb.Case(structure=rb.Fixed(), duration=1.0)), "a list of cases is needed"),
        (lambda: rb.simulate_many([], threads="2"), "threads = '2': a whole number of at least 1"),  # type: ignore[arg-type]
        (lambda: rb.simulate_many([], threads=0), "threads = 0: a whole number of at least 1"),
    ],
)
def test_mistakes_in_python(make: Callable[[], object], message: str) -> None:
    """Bad arguments in Python are refused like those of a case file, also by functions that make records."""
    with pytest.raises(rb.CaseError, match=message):
        make()


def test_base_motion_of_modes_without_participation() -> None:
    """Base motion of a modal structure without participation is refused."""
    with pytest.raises(rb.CaseError, match="participation"):
        rb.Case(
            structure=rb.Modal(frequencies=[1.0], damping_ratios=[0.0], shapes={"tip": [1.0]}),
            base=rb.Harmonic(amplitude="1 m/s^2", frequency="1 Hz"),
            duration=1.0,
        )
