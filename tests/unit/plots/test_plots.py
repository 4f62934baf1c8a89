"""Tests of the figures of runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import rattlebox as rb
from rattlebox.plots import figure_style, plot_comparison
from rattlebox.plots.style import CHANNEL_COLOURS, WIDTHS, Scale, scaled
from rattlebox.results import Run

from .conftest import is_within_page

FIGURES = ("motion", "energy", "impacts", "phase_portrait")


@pytest.mark.parametrize("kind", FIGURES)
def test_every_run_is_drawn(any_run: Run, kind: str, tmp_path: Path) -> None:
    """Every figure of every kind of run is saved without a warning and fits on the page."""
    figure = getattr(any_run.plot, kind)()
    path = tmp_path / "figure.png"
    figure.savefig(path)
    assert path.stat().st_size > 5000
    assert is_within_page(figure)


@pytest.mark.parametrize("size", WIDTHS)
@pytest.mark.parametrize("kind", FIGURES)
def test_sizes(two_dampers: Run, kind: str, size: str) -> None:
    """Figures have the width of their size and fit on the page."""
    figure = getattr(two_dampers.plot, kind)(size=size)
    assert figure.get_figwidth() * 25.4 == pytest.approx(WIDTHS[size])
    assert is_within_page(figure)


def test_unknown_size(run: Run) -> None:
    """An unknown size raises an error that lists the known ones."""
    with pytest.raises(ValueError, match="'column', 'page', 'slide'"):
        run.plot.motion(size="poster")


def test_style_is_temporary() -> None:
    """The style does not change the settings outside its context."""
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    with figure_style("slide"):
        assert mpl.rcParams["font.size"] != before["font.size"]
    assert dict(mpl.rcParams) == before


def test_axes_have_units(run: Run) -> None:
    """Labels of axes contain units with SI prefixes."""
    motion = run.plot.motion().axes
    assert [a.get_ylabel() for a in motion] == ["Displacement\n(mm)", "Position in cavity\n(mm)"]
    assert motion[-1].get_xlabel() == "Time (s)"
    assert [a.get_ylabel() for a in run.plot.energy().axes] == ["Energy\n(mJ)", "Energy ledger\n(mJ)"]
    labels = [a.get_ylabel() for a in run.plot.impacts().axes]
    assert labels == ["Approach speed\n(mm/s)", "Peak force\n(kN)", "Coefficient of\nrestitution"]


def test_prefixes() -> None:
    """Lengths and times keep the larger prefix from 0.1 on; an empty array keeps the unit."""
    assert scaled([4e-4], "m") == Scale(1e-3, "mm")
    assert scaled([0.02, np.nan], "s") == Scale(1e-3, "ms")
    assert scaled([0.25], "J") == Scale(1e-3, "mJ")
    assert scaled([], "N") == Scale(1.0, "N")


def test_areas_of_the_ledger_reach_the_energy_supplied(run: Run) -> None:
    """The upper edge of the stacked areas is the line of the energy supplied, at every output time."""
    lower = run.plot.energy().axes[1]
    edge = lower.collections[-1].get_paths()[0].vertices
    (line,) = lower.lines
    time, supplied = line.get_data()
    assert np.max(supplied) == pytest.approx(252.1, rel=1e-3)
    for t, level in zip(time[::100], supplied[::100], strict=True):
        assert edge[edge[:, 0] == t, 1].max() == pytest.approx(level, rel=1e-12, abs=1e-9)


def test_missing_energy_is_visible(run: Run) -> None:
    """If energy is missing, the areas end below the line of the energy supplied."""
    leaking = Run(run.arrays.replaced(viscous_loss=0.5 * run.arrays.viscous_loss))
    lower = leaking.plot.energy().axes[1]
    edge = lower.collections[-1].get_paths()[0].vertices
    last = edge[edge[:, 0] == edge[:, 0].max(), 1].max()
    assert last < 0.8 * lower.lines[0].get_ydata()[-1]


def test_channels_differ_in_grey(run: Run) -> None:
    """Neighbouring areas of the ledger differ by at least a tenth in lightness when printed in grey."""

    def grey(name: str) -> float:
        return float(np.dot(to_rgb(CHANNEL_COLOURS[name]), (0.299, 0.587, 0.114)))

    order = [grey(name) for name in ("viscous", "normal", "plastic", "motion")]
    assert np.min(np.diff(order)) > 0.1
    flowing = Run(run.arrays.replaced(plastic_loss=run.arrays.normal_loss / 2))
    assert len(flowing.plot.energy().axes[1].collections) == 4


def test_logarithmic_energies(run: Run) -> None:
    """Logarithmic energies cover six decades; zeros result in gaps without warnings."""
    upper = run.plot.energy(log=True).axes[0]
    assert upper.get_yscale() == "log"
    low, high = upper.get_ylim()
    assert 1e5 < high / low < 1e7


def test_gravity_energy(run: Run) -> None:
    """The potential energy of gravity is drawn relative to its lowest value."""
    heavy = Run(run.arrays.replaced(gravity_energy=-10.0 - run.arrays.ball_position))
    upper = heavy.plot.energy().axes[0]
    names = [text.get_text() for text in upper.get_legend().get_texts()]
    assert names == ["structure", "balls", "gravity"]
    assert min(line.get_ydata().min() for line in upper.lines) >= 0.0


def test_impacts_show_every_impact(two_dampers: Run) -> None:
    """Each impact has one marker at its time and speed, in the group of its damper and side."""
    axes = two_dampers.plot.impacts().axes
    log = two_dampers.arrays.impacts
    marks = np.concatenate([c.get_offsets() for c in axes[0].collections])
    assert len(marks) == len(log)
    np.testing.assert_allclose(np.sort(marks[:, 0]), np.sort(log.time), rtol=1e-12)
    between = (log.damper == 1) & (log.contact > 0) & (log.contact < 3)
    counts = [len(c.get_offsets()) for c in axes[0].collections]
    assert np.count_nonzero(between) in counts


def test_impacts_without_force_or_restitution(run: Run) -> None:
    """Quantities without values have no panel."""
    log = run.arrays.impacts
    nan = np.full(len(log), np.nan)
    bare = Run(run.arrays.replaced(impacts=log.replaced(peak_force=nan, restitution=nan)))
    assert len(bare.plot.impacts().axes) == 1
    assert len(bare.plot.impacts(log=True).axes) == 1


def test_distant_wall_is_not_drawn() -> None:
    """The panel of a ball that bounces on the floor of a high cavity does not include the lid."""
    case = rb.Case.from_file(Path(__file__).parents[3] / "examples" / "shaker.toml")
    (axes,) = rb.simulate(case).plot.motion().axes
    assert [line.get_ydata()[0] for line in axes.lines[:-1]] == [pytest.approx(-50)]
    assert np.diff(axes.get_ylim()) < 2


def test_walls_of_a_phase_portrait(two_dampers: Run) -> None:
    """The walls are at half the clearance and limit the positions of a ball in a row."""
    axes = two_dampers.plot.phase_portrait("damper2/3").axes[0]
    walls = sorted(line.get_xdata()[0] for line in axes.lines)
    np.testing.assert_allclose(walls, [-0.4, 0.4])
    points = np.concatenate(axes.collections[0].get_segments())
    assert abs(points[:, 0]).max() == pytest.approx(0.4, rel=0.1)


def test_portrait_of_a_point(run: Run) -> None:
    """The portrait of a point of the structure has its own labels and no walls."""
    axes = run.plot.phase_portrait("mass").axes[0]
    assert axes.get_xlabel() == "Displacement (mm)"
    assert not axes.lines


def test_motion_in_a_time_interval(run: Run) -> None:
    """An interval limits the time axis; an interval without output times raises an error."""
    axes = run.plot.motion(between=(0.1, 0.2)).axes
    assert axes[-1].get_xlim() == pytest.approx((0.1, 0.2))
    with pytest.raises(ValueError, match="no output time"):
        run.plot.motion(between=(3.0, 4.0))


def test_comparison_has_common_axes(run: Run, make_run, tmp_path: Path) -> None:
    """All columns of a comparison have the same scales."""
    weak = make_run(pulse=100.0)
    figure = plot_comparison({"strong": run, "weak": weak})
    figure.savefig(tmp_path / "comparison.png")
    panels = np.array(figure.axes).reshape(3, 2)
    assert [panel.get_title(loc="left") for panel in panels[0]] == ["strong", "weak"]
    for row in panels:
        assert row[0].get_ylim() == row[1].get_ylim()
    strong, faint = (panel.lines[-1].get_ydata().max() for panel in panels[0])
    assert strong / faint == pytest.approx(run.arrays.displacement.max() / weak.arrays.displacement.max())
    assert is_within_page(figure)


def test_comparison_shows_all_of_a_run_with_more_energy(run: Run, make_run) -> None:
    """The scale of the energies holds the last column, too: the tests had the strongest run in the first column."""
    figure = plot_comparison({"weak": make_run(pulse=100.0), "strong": run})
    figure.draw_without_rendering()
    for panel in np.array(figure.axes).reshape(3, 2).flat:
        low, high = panel.get_ylim()
        assert all(low <= np.min(line.get_ydata()) and np.max(line.get_ydata()) <= high for line in panel.lines)
    assert figure.axes[-1].get_ylim()[0] == 0


def test_comparison_of_a_building_draws_one_point() -> None:
    """All columns have the top floor only, and the balls a label; other comparisons here have one point and two runs."""
    tower = rb.ShearBuilding(masses=["60 t"] * 8, stiffnesses=["70 MN/m"] * 8, damping_ratio="2 %")
    common = {
        "structure": tower,
        "base": rb.HalfSine(amplitude="0.2 g", duration="0.4 s"),
        "duration": "2 s",
        "output": rb.Output(rate="100 Hz"),
    }
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="40 cm", material="steel"),
        gap="40 mm",
        contact=rb.Tsuji(restitution=0.5),
        point="storey 8",
    )
    damped = rb.simulate(rb.Case(**common, damper=(ball, ball)))
    runs = {"bare": rb.simulate(rb.Case(**common)), "with a long name": damped, "again": damped, "more": damped}
    figure = plot_comparison(runs)
    assert is_within_page(figure)
    panels = np.array(figure.axes).reshape(3, 4)
    assert all(len(panel.lines) == 2 for panel in panels[0])
    labels = [panel.get_ylabel().replace("\n", " ") for panel in panels[:, 0]]
    assert labels == ["Displacement of storey 8 (mm)", "Position in cavity (mm)", "Energy ledger (kJ)"]
    drift = plot_comparison(runs, of="storey 3 - storey 2").axes
    np.testing.assert_allclose(
        drift[0].lines[1].get_ydata(),
        1e3 * rb.analysis.drift(runs["bare"], "storey 3", "storey 2"),
        rtol=1e-12,
        atol=1e-12,
    )
    with pytest.raises(rb.CaseError, match=r"storey 9.*is not a point of all runs"):
        plot_comparison(runs, point="storey 9")


def test_comparison_of_rb_compare_is_drawn_with_its_choice(run: Run, make_run) -> None:
    """The result of rb.compare shows its point and quantity; it ended in an error, since only mappings were drawn."""
    compared = rb.results.compare({"strong": run, "weak": make_run(pulse=100.0)})
    figure = plot_comparison(compared)
    drawn, same = (
        np.concatenate([line.get_ydata() for line in each.axes[0].lines])
        for each in (figure, plot_comparison(compared.runs))
    )
    assert np.array_equal(drawn, same)
    push = rb.Case(
        structure=rb.SDOF(mass="1 kg", frequency="5 Hz"),
        load=rb.Harmonic(amplitude="1 N", frequency="4 Hz"),
        duration="1 s",
    )
    moved = rb.compare({"a": push, "b": push.replaced({"load.amplitude": 2.0})}, of="acceleration", progress=False)
    assert plot_comparison(moved).axes[0].get_ylabel().startswith("Absolute")


def test_comparison_of_different_structures(run: Run, make_run) -> None:
    """Runs without a ball or without a moving structure can be compared; an empty comparison raises an error."""
    figure = plot_comparison({"a": run, "b": make_run(rows=()), "c": make_run(fixed=True, ball_speed=0.1)})
    assert is_within_page(figure)
    assert len(plot_comparison({"c": make_run(fixed=True, ball_speed=0.1)}).axes) == 2
    with pytest.raises(ValueError, match="at least one run"):
        plot_comparison({})


def test_long_names(two_dampers: Run) -> None:
    """Long names are shortened, so that the panels keep their width."""
    arrays = two_dampers.arrays
    points = ("left end of the upper flange " * 4, "right end")
    double = arrays.replaced(
        points=points,
        displacement=np.repeat(arrays.displacement, 2, axis=1),
        velocity=np.repeat(arrays.velocity, 2, axis=1),
        acceleration=np.repeat(arrays.acceleration, 2, axis=1),
        absolute_acceleration=np.repeat(arrays.absolute_acceleration, 2, axis=1),
        dampers=("a damper with a rather long name, first", "a damper with a rather long name, second"),
    )
    for kind in ("motion", "impacts"):
        figure = getattr(Run(double).plot, kind)()
        assert is_within_page(figure), kind
        assert figure.axes[0].get_position().width > 0.5, kind


def test_fonts_in_pdf(run: Run, tmp_path: Path) -> None:
    """A PDF file contains TrueType fonts and no Type 3 fonts, as journals require."""
    path = tmp_path / "figure.pdf"
    run.plot.energy().savefig(path)
    content = path.read_bytes()
    assert b"/Type3" not in content
    assert b"/CIDFontType2" in content


def test_figures_in_notebooks(run: Run) -> None:
    """A figure has a PNG representation."""
    assert run.plot.energy()._repr_png_().startswith(b"\x89PNG")
