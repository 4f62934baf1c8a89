"""Tests of reports: content for each kind of result, pages that need nothing else, escaping, files that exist."""

from __future__ import annotations

import base64
import os
import re
import shutil
import tomllib
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from rattlebox._util.quantities import amount
from rattlebox.report.page import typeset
from rattlebox.studies.maps.lobe_words import answer

HOSTILE = '<script>alert("1")</script> & <b>'
"""A name that would run or change the page if it were not escaped."""


class Page(HTMLParser):
    """Elements, links and text of a page; raises if an element is not closed."""

    EMPTY = ("meta", "img", "br", "link")

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.source = path.read_text(encoding="utf-8")
        self.tags: list[str] = []
        self.links: list[str] = []
        self.downloads: dict[str, str] = {}
        self.text = ""
        self._open: list[str] = []
        self.feed(self.source)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect an element and its links."""
        self.tags.append(tag)
        values = {name: value or "" for name, value in attrs}
        self.links += [values[name] for name in ("src", "href") if name in values]
        if "download" in values:
            self.downloads[values["download"]] = base64.b64decode(values["href"].partition(",")[2]).decode()
        if tag not in self.EMPTY:
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """Check that elements are nested."""
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        """Collect text."""
        self.text += data


def case(**changes: Any) -> rb.Case:
    """Return a case with one ball."""
    parts: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        "load": rb.Harmonic(amplitude="10 N", frequency="30 Hz"),
        "duration": "0.5 s",
    }
    return rb.Case(**{**parts, **changes})


def on_shaker() -> rb.Case:
    """Return a case of a ball on a shaker with hard impacts."""
    return case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")), load=(), method=rb.Newton()
    )


def in_step() -> rb.Case:
    """Return a case whose steady motion repeats each cycle, with hard impacts."""
    return case(load=rb.Harmonic(amplitude="5 N", frequency="33 Hz"), method=rb.Newton(), duration="3 s")


def in_a_tuned_mass() -> rb.Case:
    """Return a case with a ball in a box on a spring."""
    box = rb.TunedMass(mass="20 g", frequency="30 Hz", damping_ratio=0.02)
    ball = case().dampers[0].model_copy(update={"point": "tuned mass"})
    return case(damper=ball, tuned_mass=box)


def free() -> rb.Case:
    """Return a case in free vibration."""
    structure = rb.SDOF(mass="3 kg", frequency="50 Hz", damping_ratio=0.01, velocity="0.2 m/s")
    return case(structure=structure, load=(), duration="2 s")


def particles() -> rb.Case:
    """Return a case of eight particles in a cylinder."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="glass", diameter="4 mm", count=8),
        cavity=rb.Cylinder(diameter="12 mm", length="12 mm"),
        contact=rb.Tsuji(restitution=0.8),
        friction=0.2,
        softening=1e4,
    )
    return case(damper=damper, duration="0.05 s", output=rb.Output(rate="1 kHz"))


@cache
def result_of(name: str) -> Any:
    """Return a small result of a kind."""
    quiet = {"progress": False}
    return {
        "run": lambda: rb.simulate(case()),
        "free run": lambda: rb.simulate(free()),
        "particles": lambda: rb.simulate(particles()),
        "comparison": lambda: rb.compare({"bare": case(damper=()), "ball": case()}, **quiet),
        "runs": lambda: {"a": rb.simulate(case(damper=())), "b": rb.simulate(case())},
        "in a tuned mass": lambda: rb.compare({"bare": case(damper=()), "box and ball": in_a_tuned_mass()}, **quiet),
        "sweep": lambda: rb.sweep(
            case(), {"damper.gap": ["0.5 mm", "1 mm"], "load.amplitude": [5, 10, 20]}, ["rms", "impacts"], **quiet
        ),
        "frequency_response": lambda: rb.frequency_response(case(), [28, 30, 32], cycles=(20, 10), **quiet),
        "bifurcation": lambda: rb.bifurcation(case(), "load.amplitude", [5, 10], cycles=(20, 8), **quiet),
        "basins": lambda: rb.basins(on_shaker(), {"damper.start": rb.linspace(-1, 1, 3)}, cycles=(20, 8), **quiet),
        "lyapunov": lambda: rb.lyapunov(case(), {"load.amplitude": [5, 10]}, cycles=(20, 20), **quiet),
        "bifurcation of impacts": lambda: rb.bifurcation(
            case(), "load.amplitude", [5, 10], cycles=(20, 8), show="impacts", measure="peak", tolerance=1e-3, **quiet
        ),
        "response with a measure": lambda: rb.frequency_response(
            case(), [28, 30], cycles=(20, 10), measure="loss_per_cycle", tolerance=1e-2, samples=32, **quiet
        ),
        "basins apart": lambda: rb.basins(
            on_shaker(), {"damper.start": rb.linspace(-1, 1, 3)}, cycles=(20, 8), apart=0.9, **quiet
        ),
        "lyapunov of pairs": lambda: rb.lyapunov(
            case(), {"load.amplitude": [5, 10]}, cycles=(20, 20), pairs=3, seed=1, **quiet
        ),
        "loss_map": lambda: rb.loss_map(on_shaker(), [1e-3, 2e-3], [10.0, 20.0], **quiet),
        "stability_lobes": lambda: rb.stability_lobes(
            rb.Case(structure=free().structure, method=rb.Newton(), duration="1 s"),
            on_shaker().dampers[0].model_copy(update={"point": None}),
            "2000 N/mm^2",
            0.7,
            ["700 rpm", "900 rpm"],
            amplitudes=["0.6 mm", "2 mm"],
            **quiet,
        ),
        "branch": lambda: rb.continue_orbit(
            rb.find_orbit(in_step()), "load.frequency", ("31.5 Hz", "34 Hz"), step=0.05, **quiet
        ),
        "damping_curve": lambda: rb.damping_curve(free(), ["0.2 mm", "0.4 mm"], packings=4, **quiet),
        "damping curves": lambda: dict.fromkeys(("a", "b"), result_of("damping_curve")),
        "design": lambda: rb.design(case(), {"damper.gap": ("0.5 mm", "2 mm")}, "rms", trials=3, **quiet),
        "design of a seed": lambda: rb.design(
            case(),
            {"damper.gap": ("0.5 mm", "2 mm")},
            "rms",
            trials=3,
            seed=5,
            log=["damper.gap"],
            cycles=(5, 5),
            **quiet,
        ),
        "design of damping": lambda: rb.design(
            free(),
            {("damper.ball.material", "damper.contact.restitution"): (["steel", "brass"], [0.5, 0.7])},
            "damping_ratio",
            amplitudes=["0.5 mm", "1 mm"],
            **quiet,
        ),
        "sensitivity": lambda: rb.sensitivity(
            case(duration="0.1 s"), {"damper.gap": ("0.5 mm", "2 mm"), "load.amplitude": (5.0, 10.0)}, "rms", 8, **quiet
        ),
        "sensitivity with options": lambda: rb.sensitivity(
            case(duration="0.1 s"),
            {"damper.gap": ("0.5 mm", "2 mm"), "damper.ball.material": ["steel", "brass"]},
            ["rms", "impacts"],
            8,
            log="damper.gap",
            confidence=0.9,
            seed=3,
            skip="10 ms",
            **quiet,
        ),
        "drops": lambda: rb.calibrate(
            [
                rb.Drops(height="300 mm", rebound=["192 mm", "189 mm", "194 mm"], error="1 mm"),
                rb.BounceTimes([0.1, 0.5, 0.82, 1.07]),
            ]
        ),
        "calibration": lambda: rb.calibrate(
            [
                rb.ShakerLoss(["0.5 mm", "0.8 mm", "1.5 mm"], "40 Hz", reduced_loss=[2.5, 1.5, 0.86], error="3 %"),
                rb.RingDown(["0.7 mm", "1.1 mm"], ["1.4 %", "1.1 %"], error="3 %"),
            ],
            free(),
            {"damper.contact.restitution": (0.4, 0.9), "structure.damping_ratio": (0.0, 0.02)},
            known={"structure.damping_ratio": (0.01, 0.001)},
            runs=26,
            checks=2,
            **quiet,
        ),
        "several": lambda: {"the run": result_of("run"), "the curve": result_of("damping_curve")},
    }[name]()


@cache
def page_of(name: str) -> Page:
    """Return the report about a result; drawing is most of the work of these tests."""
    with TemporaryDirectory() as folder:
        return Page(rb.write_report(result_of(name), Path(folder) / "report.html"))


def result_of_script(page: Page) -> Any:
    """Write the files of a report into the current folder, and return the result of its script."""
    for file, content in page.downloads.items():
        Path(file).write_text(content, encoding="utf-8")
    names: dict[str, Any] = {}
    exec(page.downloads["script.py"], names)
    return names["result"]


KINDS = {
    "run": "How does an oscillator of 1 kg at 31.83 Hz with a steel ball of 90.23 g",
    "free run": "vibrate freely within 2 s?",
    "particles": "8 glass balls of 4 mm",
    "comparison": "How do the variants “bare” and “ball” of an oscillator of 1 kg",
    "in a tuned mass": "How do the variants “bare” and “box and ball”",
    "runs": "How do the variants “a” and “b”",
    "sweep": "How do the RMS displacement and impacts of an oscillator",
    "frequency_response": "Which steady motion does an oscillator",
    "bifurcation": "Which steady motions does an oscillator",
    "basins": "To which steady motion of a shaker",
    "lyapunov": "Is the motion of an oscillator",
    "loss_map": "How much energy does a steel ball",
    "stability_lobes": "Up to which depth of cut does an oscillator of 3 kg",
    "branch": "Which periodic motions does an oscillator of 1 kg at 31.83 Hz with a steel ball",
    "damping_curve": "Which damping ratio does mode 1 (50 Hz)",
    "damping curves": "of an oscillator of 3 kg at 50 Hz with a and b have at amplitudes",
    "design of damping": "Which damper ball material and damper contact restitution give the largest damping ratio",
    "design": "Which damper gap gives the smallest RMS displacement",
    "sensitivity": "Which of damper.gap and load.amplitude cause the variation of rms",
    "drops": "Which restitution do 5 measured impacts show?",
    "calibration": "Which contact restitution and structure damping ratio of a steel ball",
    "several": "Which damping ratio does mode 1 (50 Hz)",
}


@pytest.mark.parametrize("name", KINDS)
def test_report_of_each_kind_is_complete_and_needs_nothing_else(name: str) -> None:
    """A report has all parts, figures with captions, and neither scripts nor links to other files."""
    page = page_of(name)
    assert KINDS[name] in page.text
    headings = ("Case", "Inputs", "Results", "Warnings and notes", "Limits of the method", "How to reproduce")
    for heading in headings[2 * (name == "drops") :]:  # a drop test has no case
        assert heading in page.text
    assert not {"script", "link", "iframe", "object"} & set(page.tags)
    assert all(link.startswith("data:") for link in page.links)
    assert "url(" not in page.source
    assert (
        page.tags.count("figcaption") == page.tags.count("img") >= 1 or "Not drawn: the starts vary along" in page.text
    )
    assert "nan" not in re.sub(r"[A-Za-z]+nan|nan[A-Za-z]+", "", page.text)
    assert len(page.source) < 2_000_000


@pytest.mark.parametrize(
    "name",
    [
        "run",
        "comparison",
        "sweep",
        "response with a measure",
        "bifurcation of impacts",
        "basins apart",
        "lyapunov of pairs",
        "design of a seed",
        "design of damping",
        "loss_map",
        "damping_curve",
        "drops",
        "sensitivity with options",
        pytest.param("calibration", marks=pytest.mark.slow),
    ],
)
def test_files_of_a_report_compute_the_result_again(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The case file and the script of a report, in an empty folder, compute an equal result."""
    result, page = result_of(name), page_of(name)
    if name not in ("run", "sweep"):
        monkeypatch.setattr(rb, "write_report", lambda result, path: Path(path).touch())
    monkeypatch.chdir(tmp_path)
    again = result_of_script(page)
    if name == "run":
        assert again == result
    elif name == "comparison":
        assert again.runs == result.runs
    else:
        assert again.equals(result)
    assert Path("report.html").is_file()
    if "study.toml" in page.downloads:
        from rattlebox.studies.study_file import read_study

        assert read_study("study.toml").run(progress=False).equals(result)


def test_the_files_of_a_branch_follow_it_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Script and study file begin at the state of the first motion, and find the same special points and ends."""
    from rattlebox.studies.study_file import read_study

    branch, page = result_of("branch"), page_of("branch")
    monkeypatch.setattr(rb, "write_report", lambda result, path: None)
    monkeypatch.chdir(tmp_path)
    result = result_of_script(page)
    for again in (result, rb.Branch(read_study("study.toml").run(progress=False))):
        assert [point.kind for point in again.specials] == [point.kind for point in branch.specials] == ["pitchfork"]
        assert again.specials[0].value == pytest.approx(branch.specials[0].value, rel=1e-9)
        for end in (np.min, np.max):
            assert end(again.data.value.values) == pytest.approx(end(branch.data.value.values), rel=1e-12)
    assert "Stable from 32.08 to 34 Hz with 2 impacts a cycle." in page.text


def test_multipliers_of_a_branch_are_doubtful_only_where_they_are_small(tmp_path: Path) -> None:
    """An error of the determinant is reported, but not that of rounding beside a multiplier that grows towards grazing.

    A branch with a grazing was said to be doubtful at a fifth of its points; the branches of the tests had none.
    """
    data = result_of("branch").data
    errors, sizes = data.determinant_error.copy(deep=True), data.multiplier_real.copy(deep=True)
    errors[3] = 0.02
    wrong = Page(rb.write_report(data.assign(determinant_error=errors), tmp_path / "a.html")).text
    assert re.search(r"at 1 of \d+ points the product of the multipliers differs", wrong)
    sizes[3, 0] = 1e6
    grazing = data.assign(determinant_error=errors, multiplier_real=sizes)
    assert "product of the multipliers differs" not in Page(rb.write_report(grazing, tmp_path / "b.html")).text


def test_a_branch_that_begins_at_another_one_claims_no_script(tmp_path: Path) -> None:
    """The motions without symmetry begin at a pitchfork, from which no case starts: the page states that it has no call."""
    branch = result_of("branch")
    crooked = branch.switch(branch.specials[0], points=12, progress=False)
    page = Page(rb.write_report(crooked, tmp_path / "report.html"))
    assert "The call of the study is not part of its result." in page.text and "script.py" not in page.downloads
    assert "not symmetric" in page.text


@pytest.mark.parametrize("name", ["frequency_response", "lyapunov of pairs", "loss_map", "sensitivity with options"])
def test_a_study_from_a_netcdf_file_has_the_same_script(name: str, tmp_path: Path) -> None:
    """Attributes that a file returns as NumPy numbers are written as plain numbers."""
    result_of(name).to_netcdf(tmp_path / "study.nc")
    with xr.open_dataset(tmp_path / "study.nc") as stored:
        again = Page(rb.write_report(stored.load(), tmp_path / "report.html"))
    assert again.downloads == page_of(name).downloads


def test_numbers_of_the_answer_are_those_of_the_result() -> None:
    """The answer of a damping curve has the largest ratio with its interval, that of a run the peak."""
    curve = result_of("damping_curve")
    text = page_of("damping_curve").text
    best = int(np.argmax(curve.damping_ratio.values))
    lower, ratio, upper = (f"{100 * float(curve[name][best]):.3g}" for name in ("lower", "damping_ratio", "upper"))
    assert f"{ratio} % (95 % interval {lower} to {upper} %)" in text
    found = result_of("calibration")
    lower, value, upper = (f"{float(found[name][0]):.3g}" for name in ("lower", "value", "upper"))
    text = page_of("calibration").text
    assert f"The contact restitution is {value} (95 % interval {lower} to {upper})" in text
    run = result_of("run")
    peak = float(np.abs(run.motion.displacement).max())
    assert f"The peak displacement of mass is {1e3 * peak:.3f} mm" in page_of("run").text


def test_recorded_walls_have_a_table(tmp_path: Path) -> None:
    """Forces, pressures and losses of walls that were recorded were on no page, because tables were those of every run."""
    run = rb.simulate(particles().model_copy(update={"output": rb.Output(rate="1 kHz", walls=True)}))
    text = Page(run.report(tmp_path / "walls.html")).text
    assert "power of friction" in text and "power of friction" not in page_of("particles").text
    table = re.sub(r"\s+", " ", text[text.index("power of friction") :])
    pressures, wear = rb.analysis.wall_pressures(run), rb.analysis.wall_wear(run)
    losses = sum(run.energy[f"wall_{channel}_loss"][-1] for channel in ("normal", "plastic", "sliding", "rolling"))
    forces = np.linalg.norm(run.motion.wall_force, axis=2).max(axis=0)
    assert list(pressures) == ["side", "first end", "last end"]
    for k, wall in enumerate(pressures):
        numbers = ((forces[k], "N"), (pressures[wall], "Pa"), (losses[k], "J"), (wear[wall], "W/m"))
        words = [amount(float(value), unit, 3) for value, unit in numbers]
        assert re.sub(r"\s+", " ", "".join([wall, *words])) in table


@pytest.mark.parametrize(
    ("options", "words", "keys"),
    [
        ({}, "the peak displacement of c is", ("peak_displacement[c]", "rms_displacement[c]")),
        ({"point": "a"}, "the peak displacement of a is", ("peak_displacement[a]", "rms_displacement[a]")),
        ({"of": "acceleration", "point": "b"}, "the peak acceleration of b is", ("peak_acceleration[b]",)),
        ({"of": "force"}, "the peak force on the base is", ("peak_interface_force", "rms_interface_force")),
    ],
)
def test_all_sentences_of_a_comparison_are_about_one_point(
    options: dict[str, Any], words: str, keys: tuple[str, ...], tmp_path: Path
) -> None:
    """In the second run another point moves most; with one point, as in the other comparisons, no sentence can mix them."""
    shapes = {"a": [1.0, 0.4], "b": [0.6, -0.8], "c": [1.2, 0.5]}
    structure = rb.Modal(frequencies=[20, 27], damping_ratio=0.01, shapes=shapes, participation=[1.0, 0.6])
    shaken = case(structure=structure, load=(), base=rb.Harmonic(amplitude="1 g", frequency="20 Hz"), damper=())
    faster = shaken.replaced({"base.frequency": "27 Hz"})
    result = rb.compare({"bare": shaken, "faster": faster}, progress=False, **options)
    page = Page(rb.write_report(result, tmp_path / "report.html"))
    peaks = [{point: result.values[name][f"peak_displacement[{point}]"] for point in shapes} for name in result.runs]
    assert len({max(some, key=some.__getitem__) for some in peaks}) == 2
    for name in ("bare", "faster"):
        assert f"{name}: {words}" in page.text
    others = {"a", "b", "c"} - {str(result.point)}
    sentences = re.findall(r"(?:bare|faster): the .*", page.text.partition("Case:")[0])
    assert len(sentences) == 2
    assert not any(re.search(rf"\bof {other}\b", sentence) for sentence in sentences for other in others)
    bare, changed = (result.values[name][keys[0]] for name in ("bare", "faster"))
    assert (
        f"{amount(abs(1 - changed / bare), '%', 3)} {'less' if changed < bare else 'more'} than with bare" in page.text
    )
    assert repr(options.get("of", "")) in page.downloads["script.py"] or "of" not in options


def test_mass_of_a_ball_in_a_tuned_mass_is_compared_with_its_box() -> None:
    """The page states the mass over that of the box: the report ended in an error.

    No report of a test had a damper in a tuned mass.
    """
    assert re.search(r"mass over that of its box\s*451 %", page_of("in a tuned mass").text)


@pytest.mark.parametrize("name", ["stability_lobes", "damping curves"])
def test_a_result_without_a_call_has_no_script(name: str) -> None:
    """A page that does not hold the call claims nothing: a script that compared the cases was said to compute the lobes.

    Only the files of results with a call were run.
    """
    page = page_of(name)
    assert "The call of the study is not part of its result." in page.text
    assert not any(file.endswith(".py") for file in page.downloads) and "computes the result again" not in page.text


def test_a_stable_depth_has_its_interval_in_the_same_unit() -> None:
    """Intervals of zero are not shown, and others have the unit of the depth: there were 1.08e-07 pm.

    No test had read the table.
    """
    table = (
        page_of("stability_lobes").text.partition("stable depth at all speeds")[2].partition("Warnings and notes")[0]
    )
    assert " pm" not in table and "0 m" not in table.replace("0 mm", "")


def test_inputs_of_a_cut_are_in_its_report(tmp_path: Path) -> None:
    """Factor, teeth and tuned mass stand in the report, and an empty figure does not; only lobes with a map were tested."""
    bar = rb.SDOF(mass="4 kg", frequency="150 Hz", damping_ratio=0.02)
    cut = rb.stability_lobes(
        bar,
        rb.TunedMass.den_hartog(bar, mass="0.3 kg"),
        "1500 N/mm^2",
        0.45,
        teeth=4,
        teeth_in_cut=1.5,
        progress=False,
    )
    page = Page(rb.write_report(cut, tmp_path / "cut.html"))
    assert "1500 N/mm² and a directional factor of 0.45, with 1.5 of 4 teeth in cut" in page.text
    assert re.search(r"Tuned mass: tuned mass\s*mass\s*300 g", page.text)
    assert "Not drawn: the limit of a linear tool" in page.text
    assert "differ from those" not in page.text and "differ from the first case" in page_of("stability_lobes").text


def test_intervals_of_depths_have_one_unit() -> None:
    """A depth and its interval have one unit in the answer; only the table was read, and there was 0.126 mm ± 3 µm."""
    cut = result_of("stability_lobes")
    cut = cut.assign(limit_interval=0.012 * cut.limit)
    text = "\n".join(answer(cut))
    assert text.count("±") == 2
    assert not re.search(r"[µmn]m ± ", text)


def test_a_curve_names_accelerations_and_motions_that_are_not_steady() -> None:
    """Amplitudes stand in g, too, and a point without an interval states why: a dash left the reader to guess."""
    curve = result_of("damping_curve")
    doubt = curve.assign(
        steady=(("packing", "amplitude"), np.array([[True, False]] * curve.sizes["packing"])),
        lower=curve.lower.where([True, False]),
        upper=curve.upper.where([True, False]),
    )
    with TemporaryDirectory() as folder:
        text = Page(rb.write_report(doubt, Path(folder) / "report.html")).text
    assert re.search(r"0.4 mm\s*4.03 g", text) and text.count("not steady") == 1
    axes = rb.plot_damping_curve(doubt).axes[0]
    (hollow,) = [line for line in axes.lines if line.get_label() == "not steady"]
    assert hollow.get_xdata() == pytest.approx([0.4])


def test_files_of_a_front_are_those_that_its_script_reads(tmp_path: Path) -> None:
    """The report of a design with several best cases names one of its case files in the script and in the study file."""
    parameters = {"damper.gap": ["0.5 mm", "1 mm"], "damper.ball.radius": ["8 mm", "14 mm"]}
    result = rb.design(case(), parameters, {"rms": "min", "added_mass": "max"}, progress=False)
    assert result.front.size > 1
    downloads = Page(rb.write_report(result, tmp_path / "a.html")).downloads
    for file in ("script.py", "study.toml"):
        (name,) = re.findall(r'"(case.*\.toml)"', downloads[file])
        assert name in downloads


def test_sweeps_are_compared_only_where_both_are_computed(tmp_path: Path) -> None:
    """A report of an unfinished frequency response does not state that a sweep agrees with one that is not computed."""
    response = result_of("frequency_response")
    assert "downward sweep" in page_of("frequency_response").text
    only_up = response.assign(amplitude=response.amplitude.where(response.direction == "up"))
    answer = Page(rb.write_report(only_up, tmp_path / "b.html")).text
    assert "agree within" not in answer and "differ by more" not in answer
    first = response.assign(
        amplitude=response.amplitude.where((response.direction == "up") | (response.frequency == 28))
    )
    answer = Page(rb.write_report(first, tmp_path / "c.html")).text
    assert "where both are computed (1 of 3 points)" in answer


def test_the_only_known_exponent_is_reported(tmp_path: Path) -> None:
    """The exponent is that of the run that has one, wherever it is."""
    study = result_of("lyapunov")
    known = {name: study[name].where(study["load.amplitude"] == 10) for name in ("exponent", "standard_error")}
    text = Page(rb.write_report(study.assign(known), tmp_path / "a.html")).text
    assert f"The largest Lyapunov exponent is {amount(float(study.exponent[1]), '1/s')}" in text


def test_the_mean_of_a_measure_has_its_unit() -> None:
    """The report of a sensitivity states the unit of the mean."""
    study = result_of("sensitivity")
    text = page_of("sensitivity").text
    assert f"its mean is {amount(study['mean'].item(), 'm')}." in text


def test_warnings_are_complete() -> None:
    """Each note of a run is in its report, and limits have the values of the run."""
    run = result_of("particles")
    assert any("warning" in note for note in run.notes)
    page = page_of("particles")
    for note in run.notes:
        assert str(typeset(note)) in page.source
    assert f"{100 * run.diagnostics['largest_overlap']:.3g} % of the radius" in page.text


def test_overlaps_are_compared_with_the_radius_of_their_own_ball(tmp_path: Path) -> None:
    """The limit of overlaps is that of the contact nearest to it; all other cases here have balls of one size."""
    small, large = (
        rb.ImpactDamper(
            ball=rb.Sphere(radius=radius, material="steel"),
            gap="0.2 mm",
            contact=rb.Tsuji(restitution=0.6),
            start=start,
        )
        for radius, start in (("2 mm", 0.0), ("25 mm", 0.9))
    )
    structure = rb.SDOF(mass="5 kg", frequency="40 Hz", damping_ratio=0.01, velocity="0.5 m/s")
    run = rb.simulate(case(structure=structure, damper=(small, large), load=()))
    log, radii = run.arrays.impacts, np.array([2e-3, 25e-3])
    assert np.nanargmax(log.peak_overlap) != np.nanargmax(log.peak_overlap / radii[log.damper])
    worst = amount(float(np.nanmax(log.peak_overlap / radii[log.damper])), "%", 3)
    assert f"{worst} of the radius" in Page(run.report(tmp_path / "report.html")).text


def test_every_limit_has_a_meaning_and_every_meaning_a_limit() -> None:
    """The table of limits lists what the reports state; few results exceed enough limits to show all of them."""
    folder = Path(rb.__file__).parent / "report"
    table = tomllib.loads((folder / "limits.toml").read_text(encoding="utf-8"))
    source = ""
    for file in folder.rglob("*.py"):
        text = file.read_text(encoding="utf-8")
        named = re.search(r'^_NAME = "(\w+)"', text, re.MULTILINE)
        source += text.replace("limit(_NAME,", f'limit("{named[1]}",') if named else text
    source = source.replace(
        'limit("choices" if only_choices else "design", "search"', 'limit("choices", "search") limit("design", "search"'
    )
    stated = set(re.findall(r'limit\(\s*"(\w+)",\s*"([^"]+)"', source))
    assert stated == {(kind, name) for kind, meanings in table.items() for name in meanings}


def test_user_texts_are_escaped(tmp_path: Path) -> None:
    """Names with markup appear as text, in the page and in its drawings."""
    named = case(
        name=HOSTILE,
        structure=rb.Modal(frequencies=[30], damping_ratio=0.01, shapes={HOSTILE: [1.0]}),
        damper=case().dampers[0].model_copy(update={"name": f"{HOSTILE} $x$ $"}),
    )
    run = rb.simulate(named)
    path = rb.write_report({HOSTILE: run, "'": run}, tmp_path / "report.html", title=HOSTILE, question=HOSTILE)
    page = Page(path)
    assert "script" not in page.tags and "b" not in page.tags
    assert page.text.count('<script>alert("1")</script>') >= 4
    for link in page.links:
        if link.startswith("data:image/svg"):
            assert b"<script>" not in base64.b64decode(link.partition(",")[2])
    assert (
        f"name = '{HOSTILE}'" in page.downloads["case_1.toml"]
        or HOSTILE.replace('"', '\\"') in page.downloads["case_1.toml"]
    )


def test_control_characters_do_not_reach_the_page(tmp_path: Path) -> None:
    """Control characters of a question are replaced."""
    page = Page(rb.write_report(result_of("run"), tmp_path / "report.html", question="a\x00\x1b[31mb"))
    assert "\x1b" not in page.source and "a??[31mb" in page.text


def test_only_unchanged_reports_are_replaced(tmp_path: Path) -> None:
    """A report replaces an earlier one; files of others and edited reports stay as they are."""
    path, run = tmp_path / "report.html", result_of("run")
    run.report(path)
    run.report(path, title="again")
    assert "again" in Page(path).text
    edited = path.read_bytes().replace(b"again", b"mine ")
    for content in (b"<html>", edited, b""):
        path.write_bytes(content)
        with pytest.raises(rb.DataError, match="was not written by Rattlebox, or has changed"):
            run.report(path)
        assert path.read_bytes() == content
    folder = tmp_path / "folder.html"
    folder.mkdir()
    with pytest.raises(rb.DataError, match="was not written by Rattlebox"):
        run.report(folder)
    target = tmp_path / "elsewhere.txt"
    target.write_text("mine")
    (tmp_path / "link.html").symlink_to(target)
    with pytest.raises(rb.DataError, match="was not written by Rattlebox"):
        run.report(tmp_path / "link.html")
    assert target.read_text() == "mine"
    assert sorted(os.listdir(tmp_path)) == ["elsewhere.txt", "folder.html", "link.html", "report.html"]


@pytest.mark.parametrize(
    ("name", "words"),
    [("report.pdf", "HTML"), ("run.nc", "run.save"), ("missing/report.html", "no folder")],
)
def test_bad_names_are_refused(name: str, words: str, tmp_path: Path) -> None:
    """A file name with another suffix, or in a missing folder, is refused before anything is drawn."""
    with pytest.raises(rb.DataError, match=words):
        result_of("run").report(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("result", [3, "out", {}, {"a": 3}, [1]])
def test_other_objects_have_no_report(result: Any, tmp_path: Path) -> None:
    """An object that is not a result is refused with the list of results."""
    with pytest.raises(rb.CaseError, match=r"rb\.compare"):
        rb.write_report(result, tmp_path / "report.html")


def test_dataset_without_its_case(tmp_path: Path) -> None:
    """A dataset that does not hold its case is reported without drawing; the case can be given."""
    curve = result_of("damping_curve").copy()
    del curve.attrs["case"]
    assert "No drawing and no table of inputs" in Page(rb.write_report(curve, tmp_path / "a.html")).text
    assert "natural frequencies" in Page(rb.write_report(curve, tmp_path / "b.html", case=free())).text


def test_run_whose_case_names_a_missing_file(tmp_path: Path) -> None:
    """The report of a run whose case can no longer be read states this."""
    record = tmp_path / "pulse.csv"
    record.write_text("t (s),F (N)\n0,0\n0.01,5\n0.02,0\n1,0\n")
    rb.simulate(case(load=rb.Record(file=str(record)))).save(tmp_path / "run.nc")
    record.unlink()
    page = Page(rb.load(tmp_path / "run.nc").report(tmp_path / "report.html"))
    assert "No drawing and no table of inputs" in page.text and "pulse.csv" in page.text
    assert "The peak displacement of mass is" in page.text


def test_unknown_studies_are_reported_as_sweeps(tmp_path: Path) -> None:
    """A dataset of a kind without a report of its own has one with its measures."""
    study = result_of("sweep").assign_attrs(study="new_kind")
    assert "RMS displacement: at most" in Page(rb.write_report(study, tmp_path / "report.html")).text


@pytest.mark.parametrize("name", ["run", "comparison", "records", "one record", "files", "two folders"])
def test_files_are_named_without_the_folders_of_the_author(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A report names the files that it needs and no folder of the computer; with them its script computes the same.

    No tested report read a file: full paths went into the page, and a study over records from files was no report at all.
    """
    author, reader = tmp_path / "author of it", tmp_path / "reader"
    (author / "quakes").mkdir(parents=True)
    for file, peak in (("quakes/north", 0.1), ("quakes/south", 0.3), ("north", 0.2)):
        (author / f"{file}.csv").write_text(f"time (s), acceleration (g)\n0, 0\n0.2, {peak}\n0.5, {-peak}\n2, 0\n")
    monkeypatch.chdir(author)
    quakes = rb.record_set("quakes")
    bare = rb.Case(structure=rb.SDOF(mass="3 kg", frequency="5 Hz"), base=quakes["north"], duration="1 s")
    other = rb.Record.from_file("north.csv" if name == "two folders" else "quakes/south.csv")
    results = {
        "run": lambda: rb.simulate(bare),
        "comparison": lambda: rb.compare({"a": bare, "b": bare.replaced({"base": other})}),
        "records": lambda: rb.sweep(bare, {"base": quakes, "base.scale": [1, 2]}, ["peak"]),
        "one record": lambda: rb.sweep(bare, {"base": rb.record_set(["quakes/south.csv"])}, ["peak"]),
        "files": lambda: rb.sweep(bare, {"base.file": [str(author / f"quakes/{k}.csv") for k in quakes]}, ["peak"]),
        "two folders": lambda: rb.sweep(bare, {"base": rb.RecordSet({"a": quakes["north"], "b": other})}, ["peak"]),
    }
    result = results[name]()
    page = Page(rb.write_report(result, "report.html"))
    texts = [page.source, *page.downloads.values()]
    assert not [text for text in texts if "author of it" in text or tmp_path.name in text]
    kept = author if name == "two folders" else author / "quakes"  # the folder that holds all files
    shutil.copytree(kept, reader, dirs_exist_ok=True)
    monkeypatch.chdir(reader)
    again = result_of_script(page)
    if name == "run":
        assert np.array_equal(again.arrays.displacement, result.arrays.displacement)
    elif name == "comparison":
        for one, other in zip(again.runs.values(), result.runs.values(), strict=True):
            assert np.array_equal(one.arrays.displacement, other.arrays.displacement)
    else:
        assert np.array_equal(again.peak, result.peak)
        from rattlebox.studies.study_file import read_study

        assert np.array_equal(read_study("study.toml").run(progress=False).peak, result.peak)
    assert "into the same folder" in page.text


@pytest.mark.parametrize("times", [{"dt": "10 ms"}, {"times": np.arange(250) * 0.01}])
def test_records_of_numbers_are_summarised(times: Any, tmp_path: Path) -> None:
    """Records that are given by numbers have a report of runs and studies; those of all other cases were read from files."""
    record = rb.Record(values=np.cos(np.arange(250) * 0.2), unit="m/s^2", **times)
    case = rb.Case(structure=rb.SDOF(mass="2 kg", frequency="3 Hz", damping_ratio=0.03), base=record, duration="2 s")
    page = Page(rb.simulate(case, progress=False).report(tmp_path / "run.html"))
    # The first and the last number stood there like a range.
    assert re.search(r"250 numbers from .(1|0\.99\d*) m/s. ?2? to 1 m/s", page.text), page.text[:3000]
    study = rb.sweep(case, {"base.scale": [1, 3]}, ["peak"], progress=False)
    assert "250 numbers" in Page(rb.write_report(study, tmp_path / "study.html")).text
