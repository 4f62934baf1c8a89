"""Bad case files given to the command: each message has file, field, value, what is allowed and what to try."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support.struck import CASE_FILE

import rattlebox as rb
from rattlebox.cli.main import main

GOOD = 'duration = "0.2 s"\n' + CASE_FILE
LOAD = 'kind = "half_sine"\namplitude = "5 kN"\nduration = "1 ms"\n'
LAW = "restitution = 0.9"
MODES = 'duration = 1\n[structure]\nkind = "modal"\nfrequencies = [1, 2]\n'


Run = Callable[..., tuple[int | str | None, str]]


def changed(*changes: str) -> str:
    """Return the valid case with changes: old, new, old, new, ..."""
    text = GOOD
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert text.count(old) == 1
        text = text.replace(old, new)
    return text


@pytest.fixture
def answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Return a function that runs the command in an empty folder and returns its exit code and standard error."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> tuple[int | str | None, str]:
        monkeypatch.setattr(sys, "argv", ["rattlebox", *arguments])
        with pytest.raises(SystemExit) as stop:
            main()
        return stop.value.code, capsys.readouterr().err

    return run


MESSAGES = {
    "misspelt field": (
        changed("stiffness", "stifness"),
        "structure.stifness = '80 kN/m'\n  there is no such field here\n  try: did you mean 'stiffness'?",
    ),
    "misspelt field of which one of two is needed": (
        changed("gap", "gaap"),
        "damper.gaap = '0.4 mm'\n  there is no such field here\n  try: did you mean 'gap'?",
    ),
    "misspelt field of a ball": (
        changed("radius", "raduis"),
        "damper.ball.raduis = '33.17 mm'\n  there is no such field here\n  try: did you mean 'radius'?",
    ),
    "misspelt table": (
        changed("[damper]", "[dampr]"),
        "dampr\n  there is no such field here\n  try: did you mean 'damper' or 'dampers'?",
    ),
    "misspelt field of a law": (
        changed(LAW, 'restitution = { kind = "jackson_green", extrapolat = true }'),
        "damper.contact.restitution.extrapolat = True\n  there is no such field here\n  try: did you mean 'extrapolate'?",
    ),
    "unknown unit": (
        changed("5 kN", "5 kX"),
        "load.amplitude = '5 kX'\n  unknown unit 'kX'\n  try: known: MN, N,",
    ),
    "wrong dimension": (
        changed("5 kN", "5 kg"),
        "load.amplitude = '5 kg'\n  a force (N) is needed, not a mass\n  try: \"5 kN\"",
    ),
    "displacement as a load": (
        changed("5 kN", "5 mm"),
        "load.amplitude = '5 mm'\n  a force (N) is needed, not a length\n  try: \"5 kN\"",
    ),
    "negative mass": (
        changed("20 kg", "-20 kg"),
        "structure.mass = '-20 kg'\n  must be greater than zero\n  try: \"20 kg\"",
    ),
    "negative diameter": (
        changed('radius = "33.17 mm"', 'diameter = "-1 mm"'),
        "damper.ball.diameter = '-1 mm'\n  must be greater than zero\n  try: \"1 mm\"",
    ),
    "negative gap": (
        changed('gap = "0.4 mm"', "gap = -0.0004"),
        "damper.gap = -0.0004\n  must not be negative\n  try: 0.0004",
    ),
    "one wrong letter in a short unit": (
        changed('gap = "0.4 mm"', 'gap = "0.4 mn"'),
        "damper.gap = '0.4 mn'\n  unknown unit 'mn'\n  try: known: cm, ft, in, m, mil, mm,",
    ),
    "unit in capitals": (
        changed('gap = "0.4 mm"', 'gap = "0.4 MM"'),
        "damper.gap = '0.4 MM'\n  a length (m) is needed, not a quantity in MM\n  try: \"0.4 mm\"",
    ),
    "stiffness with the unit of a modulus": (
        changed("80 kN/m", "80 kN/mm2"),
        "structure.stiffness = '80 kN/mm2'\n  a stiffness (N/m) is needed, not a pressure or modulus\n  try: \"80 kN/m\"",
    ),
    "structure without a kind": (
        changed('kind = "sdof"\n', ""),
        "structure\n  'kind' is needed: sdof, beam,",
    ),
    "contact without a kind": (
        changed('kind = "tsuji", ', ""),
        "damper.contact\n  'kind' is needed: tsuji, linear, thornton,",
    ),
    "unknown kind": (
        changed("tsuji", "tsui"),
        "damper.contact.kind = 'tsui'\n  there is no such kind here\n  try: did you mean 'tsuji'? known: linear,",
    ),
    "kind under a name of other programs": (
        changed('"half_sine"', '"pulse"'),
        "load.kind = 'pulse'\n  there is no such kind here\n  try: did you mean 'half_sine'? known: half_sine, ",
    ),
    "field under a name of other programs": (
        changed("stiffness", "k"),
        "structure.k = '80 kN/m'\n  there is no such field here\n  try: did you mean 'stiffness'?",
    ),
    "kind instead of a table": (
        'method = "newton"\n' + GOOD,
        "method = 'newton'\n  a table is needed\n  try: method = { kind = \"newton\", ... }",
    ),
    "list instead of a table": (
        changed("[structure]", "[[structure]]"),
        "  one table is needed, not a list\n  try: [structure] in single brackets",
    ),
    "unknown material": (
        changed('"steel"', '"stel"'),
        "damper.ball.material = 'stel'\n  there is no material of this name\n  try: did you mean 'steel'?",
    ),
    "unknown material of the case": (
        changed('"steel"', '"rubbr"') + "[materials.rubber]\ndensity = 1100\nyoung = 1e7\npoisson = 0.49\n",
        "damper.ball.material = 'rubbr'\n  there is no material of this name\n  try: did you mean 'rubber'?",
    ),
    "invalid material of the case": (
        GOOD + '[materials.rubber]\ndensity = "1 g"\nyoung = 1e7\npoisson = 0.6\n',
        "materials.rubber.density = '1 g'\n  a density (kg/m^3) is needed, not a mass\n  try: \"7850 kg/m^3\"\n"
        "case.toml: materials.rubber.poisson = 0.6\n",
    ),
    "material with a name of the library": (
        GOOD + "[materials.steel]\ndensity = 1\nyoung = 1\npoisson = 0\n",
        "materials.steel\n  the library already has a material of this name\n  try: another name",
    ),
    "restitution above one": (
        changed("0.9", "1.2"),
        "damper.contact.restitution = 1.2\n  restitution is between 0 (no rebound) and 1 (no loss)",
    ),
    "restitution in a law above one": (
        changed("0.9", '{ kind = "constant", e = 1.2 }'),
        "damper.contact.restitution.e = 1.2\n  restitution is between 0 (no rebound) and 1 (no loss)",
    ),
    "restitution in a table above one": (
        changed("0.9", '{ kind = "table", speeds = [1, 2], values = [0.9, 1.8] }'),
        "damper.contact.restitution.values[1] = 1.8\n  restitution is between 0",
    ),
    "speeds in a table": (
        changed("0.9", '{ kind = "table", speeds = ["1 m/s", "2 m"], values = [0.9, 0.8] }'),
        "damper.contact.restitution.speeds[1] = '2 m'\n  a velocity (m/s) is needed, not a length\n  try: \"0.1 m/s\"",
    ),
    "law of a material that does not yield": (
        changed("0.9", '{ kind = "jackson_green" }', "steel", "glass"),
        "damper.contact.restitution\n  the Jackson-Green law needs a material with a yield stress",
    ),
    "restitution as text": (
        changed("0.9", '"high"'),
        "damper.contact.restitution = 'high'\n  a number from 0 to 1 is needed, or a table\n  try: 0.9",
    ),
    "alpha with a unit": (
        changed(LAW, 'alpha = "0.1 kg"'),
        "damper.contact.alpha = '0.1 kg'\n  a number is needed",
    ),
    "ending": (
        changed(LAW, LAW + ', ending = "zero force"'),
        "damper.contact.ending = 'zero force'\n  must be 'zero_force' or 'zero_overlap'\n  try: \"zero_force\"",
    ),
    "one load in a list": (
        changed("[load]", "[[load]]", "5 kN", "5 kg"),
        "load[0].amplitude = '5 kg'\n",
    ),
    "second of several loads": (
        changed("[load]", "[[loads]]") + '[[loads]]\nkind = "harmonic"\namplitude = "1 m"\nfrequency = 2\n',
        "loads[1].amplitude = '1 m'\n",
    ),
    "second of several dampers": (
        changed("[damper]", '[[dampers]]\nname = "damper2"')
        + GOOD[GOOD.index("[damper]") :].replace("[d", "[[d").replace("r]", "rs]]"),
        "dampers[1]\n  two dampers are called 'damper2'",
    ),
    "second of several balls": (
        changed(
            "ball = {", 'balls = [{ radius = "1 mm", material = "steel" }, {', "}\ncon", "}]\ncon", "33.17 mm", "3 s"
        ),
        "damper.balls[1].radius = '3 s'\n  a length (m) is needed, not a time",
    ),
    "load twice": (
        GOOD + '[[loads]]\nkind = "harmonic"\namplitude = "1 N"\nfrequency = 2\n',
        "give load or loads, not both",
    ),
    "point of a load": (
        changed('"5 kN"', '"5 kN"\npoint = "tip"'),
        "load.point = 'tip'\n  the structure has no point 'tip'\n  try: known: mass",
    ),
    "point of a damper": (
        changed('"0.4 mm"', '"0.4 mm"\npoint = "tip"'),
        "damper.point = 'tip'\n  the structure has no point 'tip'\n  try: known: mass",
    ),
    "no point where there are several": (
        MODES + "damping_ratios = [0, 0]\nshapes = { a = [1, 1], b = [1, 0] }\n[load]\n" + LOAD,
        'load.point\n  a point must be named\n  try: point = "a" or point = "b"',
    ),
    "start in a wall": (
        changed('"0.4 mm"', '"0.4 mm"\nstart = 1.5'),
        "damper.start = 1.5\n  ball 1 would start 0.2 mm inside a wall of the cavity\n"
        "  try: start between -1 and 1, or a length up to 0.4 mm "
        "from the centre of the cavity",
    ),
    "start outside a displaced cavity": (
        changed('mass = "20 kg"', 'mass = "20 kg"\ndisplacement = "1 mm"').replace(
            '"0.4 mm"', '"0.4 mm"\nstart = "1 mm"'
        ),
        "damper.start = '1 mm'\n  ball 1 would start 0.6 mm inside a wall of the cavity\n"
        "  try: start between -1 and 1, or a length up to 0.4 mm from the centre of the cavity",
    ),
    "one of several velocities": (
        changed('"0.4 mm"', '"0.4 mm"\nvelocity = ["1 m/s", "2 mm"]'),
        "damper.velocity[1] = '2 mm'\n  a velocity (m/s) is needed, not a length",
    ),
    "cavity shorter than the ball": (
        changed('gap = "0.4 mm"', 'cavity_length = "66 mm"'),
        "damper.cavity_length = '66 mm'\n  is shorter than the row of balls, which is 66.34 mm long\n"
        '  try: cavity_length = "67 mm"',
    ),
    "tolerance": (
        GOOD + '[method]\nkind = "event_driven"\ntolerance = 1\n',
        "method.tolerance = 1\n  must be at most 0.001",
    ),
    "output that exceeds the memory": (
        GOOD + '[output]\nrate = "1 THz"\n',
        "output.rate = '1 THz'\n  2e+11 samples would take",
    ),
    "one of the output times": (
        GOOD + '[output]\ntimes = ["0.1 s", "x"]\n',
        "output.times[1] = 'x'\n  a time (s) is needed\n  try: \"1 ms\"",
    ),
    "missing record": (
        changed(LOAD, 'kind = "record"\nfile = "push.csv"\n'),
        "load.file = 'push.csv'\n  there is no file ",
    ),
    "record that is a folder": (
        changed(LOAD, 'kind = "record"\nfile = "."\n'),
        " is a folder, not a file",
    ),
    "record that is too short": (
        changed(LOAD, 'kind = "record"\ntimes = [0, 0.1]\nvalues = [0, 1]\n'),
        'load.times = [0, 0.1]\n  the record covers 0 s to 0.1 s, the run 0 to 0.2 s\n  try: duration = "0.1 s"',
    ),
    "record with text": (
        changed(LOAD, 'kind = "record"\ntimes = [0, 1]\nvalues = [0, "x"]\n'),
        "load.values[1] = 'x'\n  a finite number is needed",
    ),
    "missing file of matrices": (
        'duration = 1\n[structure]\nkind = "matrices"\nfile = "beam.npz"\n',
        "structure.file = 'beam.npz'\n  there is no file ",
    ),
    "too few damping ratios": (
        MODES + "damping_ratios = [0]\nshapes = { tip = [1, 1] }\n",
        "structure.damping_ratios = [0]\n  1 number, but there are 2 frequencies\n  try: one number for each mode",
    ),
    "one damping ratio for all": (
        MODES + "damping_ratios = 0.003\nshapes = { tip = [1, 1] }\n",
        "structure.damping_ratios = 0.003\n  a list is needed, with one number for each mode\n"
        "  try: [0.003] for one mode, [0.003, 0.003] for two",
    ),
    "unit with a prefix": (
        changed('amplitude = "5 kN"', 'amplitude = 5\nunit = "kN"'),
        "load.unit = 'kN'\n  must be 'N', 'm/s^2' or 'm'\n  try: amplitude = \"5 kN\"",
    ),
    "record in a unit with a prefix": (
        'duration = 1\nstructure = { kind = "sdof", mass = 1, stiffness = 1 }\n'
        'load = { kind = "record", times = [0, 1], values = [0, 1], unit = "kg" }\n',
        "load.unit = 'kg'\n  must be 'N', 'm/s^2' or 'm'",
    ),
    "record with units": (
        'duration = 1\nstructure = { kind = "sdof", mass = 1, stiffness = 1 }\n'
        'load = { kind = "record", times = ["0 s", "1 s"], values = [0, 1] }\n',
        "load.times[0] = '0 s'\n  a finite number is needed\n  try: numbers without units: times in s",
    ),
    "truncated file": (
        GOOD[: GOOD.index("steel") + 3],
        "not TOML: Unterminated string (at end of document)\n"
        '  ball = { radius = "33.17 mm", material = "ste\n'
        "  try: the whole file, which seems cut off at line 16",
    ),
    "shape with text": (
        MODES + 'damping_ratios = [0, 0]\nshapes = { tip = [1, "x"] }\n',
        "structure.shapes.tip[1] = 'x'\n  a finite number is needed",
    ),
    "force on a shaker": (
        'duration = 1\n[structure]\nkind = "shaker"\nmotion = { kind = "harmonic", amplitude = "1 N", frequency = 2 }\n',
        "structure.motion.amplitude = '1 N'\n  a length (m) or an acceleration (m/s^2) is needed, not a force",
    ),
    "number with a bare unit": (
        changed('"20 kg"', "20 kg"),
        'at line 5, column 11)\n  mass = 20 kg\n  try: quotes around a number with a unit: mass = "20 kg"',
    ),
    "open bracket": (changed("[load]", "[load"), "at line 9, column 6)\n  [load"),
    "the same field twice": (changed('"20 kg"', '"20 kg"\nmass = 3'), "not TOML: Cannot overwrite a value (at line 6"),
    "JSON": ('{"duration": 1}', "not TOML: Invalid statement (at line 1, column 1)"),
    "empty file": ("", "the file is empty\n  try: rattlebox demo"),
    "only a comment": ("# todo\n", "the file is empty\n  try: rattlebox demo"),
    "no structure": (LOAD, "structure\n  this field is needed"),
}


@pytest.mark.parametrize("mistake", MESSAGES)
def test_message_of_a_mistake(mistake: str, answer: Run) -> None:
    """A message has file, field and value as written, what is allowed, and what to try."""
    text, pattern = MESSAGES[mistake]
    Path("case.toml").write_text(text, encoding="utf-8")
    code, message = answer("run", "case.toml")
    assert code == 2
    assert message.startswith("error: case.toml:")
    assert pattern in message
    assert "Traceback" not in message
    assert len(message.splitlines()) < 24
    assert not Path("out").exists()


def test_several_mistakes_fit_one_screen(answer: Run) -> None:
    """The first of many mistakes are listed, and the others are counted."""
    spoilt = changed(
        "20 kg", "-1 kg", "80 kN/m", "8 kg", "0.4 mm", "-1 mm", "33.17 mm", "0 mm", "steel", "x", "0.9", "9"
    )
    Path("case.toml").write_text(spoilt, encoding="utf-8")
    code, message = answer("run", "case.toml")
    assert code == 2
    assert message.count("case.toml: ") == 4
    assert message.endswith("and 2 more\n")


@pytest.mark.parametrize(
    ("content", "pattern"),
    [
        (bytes(range(256)), "not text in UTF-8\n  try: a TOML file, saved as UTF-8"),
        (GOOD.encode("utf-16"), "not text in UTF-8"),
        (b"\x89PNG\r\n\x1a\n", "not text in UTF-8"),
        (b"\x00\x01\x02\x03", "not TOML"),
    ],
    ids=["bytes", "utf-16", "picture", "control characters"],
)
def test_a_case_file_that_is_not_text(content: bytes, pattern: str, answer: Run) -> None:
    """A file that is not text is refused with its name, without printing its bytes."""
    Path("case.toml").write_bytes(content)
    code, message = answer("run", "case.toml")
    assert code == 2
    assert f"error: case.toml: {pattern}" in message
    assert message.replace("\n", "").isprintable()


def test_byte_order_mark(tmp_path: Path) -> None:
    """A case file that begins with a byte order mark is read."""
    (tmp_path / "case.toml").write_text(GOOD, encoding="utf-8-sig")
    assert rb.Case.from_file(tmp_path / "case.toml") == rb.Case.from_toml(GOOD)


def test_missing_case_file(answer: Run) -> None:
    """For a missing case file, files with similar names are suggested; a folder is reported as a folder."""
    Path("steel_ball.toml").write_text(GOOD, encoding="utf-8")
    Path("cases").mkdir()
    assert answer("run", "steel_bal.toml") == (2, "error: there is no file steel_bal.toml\n  try: steel_ball.toml\n")
    advice = "a file; the folder contains none"
    assert answer("run", "cases") == (2, f"error: cases is a folder, not a file\n  try: {advice}\n")
    advice = f"a path from {Path.cwd()}, or a full one"
    complaint = "error: there is no file none/x.toml: there is no folder none"
    assert answer("run", "none/x.toml") == (2, f"{complaint}\n  try: {advice}\n")


def test_file_in_place_of_the_results_folder(answer: Run) -> None:
    """A file in place of the folder for results is refused before anything is computed."""
    Path("case.toml").write_text(GOOD, encoding="utf-8")
    Path("taken").write_text("mine", encoding="utf-8")
    for arguments in (("run", "case.toml"), ("demo",)):
        code, message = answer(*arguments, "-o", "taken")
        assert (code, message) == (2, "error: taken is a file; results need a folder\n  try: --out results\n")
    assert Path("taken").read_text(encoding="utf-8") == "mine"
