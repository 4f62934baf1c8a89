"""Figures, tables and reports use the units that engineers write: Hz, t, g and mm, and a second axis in g.

Earlier tests checked the formatter with numbers of their own; no test read what a tower, a ship, a boring bar, a blade
and a shock print.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.text
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import rattlebox as rb
from rattlebox._util.quantities import acceleration, amount, quantity

G = 9.80665
NOBODY_WRITES = re.compile(
    r"(?<!\w)(?:mHz|µHz|kt|Mt|Gg|Mg|kkg|ks|Ms|Mm|km/s(?:\^2|²)?|[mµ]m/s(?:\^2|²)|kg(?:\^0\.5|\$\^\{0\.5\}\$)[^,;)<]*)(?!\w)"
)


def ball(diameter: str, gap: str, point: str | None = None) -> rb.ImpactDamper:
    """Return an impact damper with a steel ball."""
    steel = rb.Sphere(diameter=diameter, material="steel")
    return rb.ImpactDamper(ball=steel, gap=gap, contact=rb.Tsuji(restitution=0.5), point=point)


def cases() -> dict[str, rb.Case]:
    """Return cases from a blade of 3 g to a ship of 1500 t, with accelerations from 0.01 g to 100 g."""
    tower = rb.ShearBuilding(masses=["180 t"] * 4, stiffnesses=["250 MN/m"] * 4, damping_ratio=0.02)
    return {
        "tower": rb.Case(
            structure=tower,
            damper=ball("1.1 m", "70 mm", "storey 4"),
            base=rb.Harmonic(amplitude="0.2 g", frequency="1.9 Hz"),
            duration="8 s",
        ),
        "ship": rb.Case(
            structure=rb.SDOF(mass="1500 t", frequency="0.07 Hz", damping_ratio=0.01),
            load=rb.Harmonic(amplitude="30 kN", frequency="0.07 Hz"),
            duration="90 s",
        ),
        "bar": rb.Case(
            structure=rb.SDOF(mass="1.1 kg", frequency="210 Hz", damping_ratio=0.009),
            damper=ball("17 mm", "0.12 mm"),
            load=rb.Harmonic(amplitude="50 N", frequency="210 Hz"),
            duration="0.2 s",
        ),
        "blade": rb.Case(
            structure=rb.SDOF(mass="3 g", frequency="3.9 kHz", damping_ratio=0.002),
            load=rb.Harmonic(amplitude="4 N", frequency="3.9 kHz"),
            duration="20 ms",
        ),
        "shock": rb.Case(
            structure=rb.SDOF(mass="2 kg", frequency="110 Hz", damping_ratio=0.02),
            damper=ball("22 mm", "0.4 mm"),
            base=rb.HalfSine(amplitude="75 g", duration="6 ms"),
            duration="0.2 s",
        ),
    }


def texts(figure: Figure) -> list[str]:
    """Return all texts of a figure."""
    figure.draw_without_rendering()
    found: list[Any] = figure.findobj(matplotlib.text.Text)
    return [text.get_text() for text in found if text.get_visible()]


def lines_of(result: Any, folder: Path) -> list[str]:
    """Return the lines of a report, also of its figures."""
    text = rb.write_report(result, folder / "report.html").read_text()
    text = re.sub(r"<(script|style)[^>]*>.*?</\1>", "", text, flags=re.S)
    return html.unescape(re.sub(r"<[^>]+>", "\n", text)).splitlines()


def everything(case: rb.Case, folder: Path) -> Iterator[str]:
    """Yield the texts of the summary, the figures and the report of a run."""
    run = rb.simulate(case)
    yield from str(run.summary()).splitlines()
    yield from lines_of(run, folder)
    yield from texts(run.plot.responses())
    for of in ("displacement", "modal_displacement", "modal_velocity", "acceleration"):
        yield from texts(run.plot.responses(of=of))


@pytest.mark.parametrize("name", list(cases()))
def test_units_of_a_run(name: str, tmp_path: Path) -> None:
    """No summary, figure or report of a run has mHz, kt, km/s^2 or kg^0.5 m."""
    for line in everything(cases()[name], tmp_path):
        assert not NOBODY_WRITES.search(line), line


def test_units_of_studies(tmp_path: Path) -> None:
    """Neither have comparisons, sweeps and frequency responses."""
    tower, ship = cases()["tower"], cases()["ship"]
    bare = tower.replaced({"dampers": ()})
    compared = rb.compare({"bare": bare, "ball": tower})
    swept = rb.sweep(
        tower, {"base.amplitude": ["0.1 g", "0.3 g"], "damper.gap": ["50 mm", "90 mm"]}, ["peak_acceleration"]
    )
    response = rb.frequency_response(ship, rb.linspace("0.06 Hz", "0.08 Hz", 5), cycles=(5, 4))
    found = [*str(compared).splitlines(), *texts(rb.plot_comparison(compared.runs)), *texts(rb.plot_map(swept))]
    found += texts(rb.plot_frequency_response(response))
    for result in (compared, swept, response):
        found += lines_of(result, tmp_path)
    for line in found:
        assert not NOBODY_WRITES.search(line), line
    assert any("0.3 g" in line for line in found)


@pytest.mark.parametrize("g", [0.05, 0.3, 1.0, 2.5, 40.0, 1000.0])
def test_accelerations_are_written_as_given(g: float) -> None:
    """An acceleration that was given in g is written in g, one in m/s^2 in m/s^2; measures have both."""
    assert acceleration(g * G) == f"{g:g} g"
    assert amount(g * G, "m/s^2") == f"{g:g} g"
    assert amount(g, "m/s^2") == f"{g:g} m/s^2"
    assert quantity(g * G, "m/s^2").endswith(" g)")
    assert "g" not in quantity(4e-3 * G, "m/s^2")
    assert quantity(0.0, "m/s^2") == "0 m/s^2"


def second_axes(figure: Figure) -> list[tuple[Axes, Any]]:
    """Return pairs of axes and a second axis in g."""
    pairs = [(axes, child) for axes in figure.axes for child in axes.child_axes]
    return [(a, c) for a, c in pairs if re.search(r"(^g$|\(g\)$)", c.get_xlabel() + c.get_ylabel())]


@pytest.mark.parametrize(
    ("amplitudes", "unit", "order"), [(["0.5 g", "2 g"], "m/s^2", 0), (["0.1 mm", "0.3 mm"], "m", 2)]
)
def test_loss_maps_have_an_axis_in_g(amplitudes: list[str], unit: str, order: int) -> None:
    """A loss map over the amplitude of a shaker has a second axis in g, also if the amplitude is a displacement."""
    motion = rb.Harmonic(amplitude=amplitudes[0], frequency="40 Hz", unit=unit)
    case = rb.Case(structure=rb.Shaker(motion=motion), damper=ball("20 mm", "0.3 mm"), duration="1 s")
    study = rb.loss_map(case, amplitudes=amplitudes, frequencies=["40 Hz"], cycles=(5, 4))
    figure = rb.plot_loss_map(study)
    figure.draw_without_rendering()
    found = second_axes(figure)
    assert len(found) == 3
    axes, second = found[0]
    top = study["structure.motion.amplitude"].values[-1] * (2 * np.pi * 40) ** order / G
    assert second.get_xlim()[1] == pytest.approx(top, rel=1e-6)
    assert axes.get_xlabel().startswith("Amplitude")


def test_backbones_have_an_axis_in_g() -> None:
    """The second axis of a backbone has the acceleration at the frequency of each amplitude, not at that of the mode."""
    study = rb.backbone(cases()["bar"], ["5 g", "12 g", "30 g"])
    figure = rb.plot_backbone(study)
    figure.draw_without_rendering()
    ((_, second),) = second_axes(figure)
    ends = study.amplitude.values * (2 * np.pi * study.frequency.values) ** 2 / G
    assert second.get_xlim() == pytest.approx((ends[0], ends[-1]), rel=1e-6)
    two = rb.plot_backbone({"a": study, "b": study})
    two.draw_without_rendering()
    assert not second_axes(two)


def test_sweeps_have_an_axis_in_g() -> None:
    """A measure or an axis that is an acceleration has a second axis in g."""
    case = cases()["shock"]
    axes = {"base.amplitude": ["20 g", "40 g", "60 g"]}
    figure = rb.plot_map(rb.sweep(case, axes, ["peak_acceleration"]))
    figure.draw_without_rendering()
    assert sorted(bool(second.get_xlabel()) for _, second in second_axes(figure)) == [False, True]


def test_columns_of_a_comparison_are_in_g() -> None:
    """A comparison has accelerations in g alone, with the numbers and the relative errors of the summaries."""
    shaken = cases()["tower"]
    runs = {"a": rb.simulate(shaken), "b": rb.simulate(shaken.replaced({"damper.gap": "100 mm"}))}
    compared = rb.compare(runs)
    rows = [line for line in str(compared).splitlines() if "acceleration" in line]
    assert rows
    for line in rows:
        assert "m/s^2" not in line
        assert line.rstrip().endswith("g") or "+-" in line
    peak = next(line for line in rows if line.startswith("largest acceleration"))
    number = runs["a"].summary().values["largest_acceleration"] / G
    assert f"{number:.4g}" in peak
    width = max(map(len, rows))
    assert width < 110
