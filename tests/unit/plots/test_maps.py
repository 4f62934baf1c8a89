"""Maps and lines of studies: what is drawn is what is in the study, and what is missing is named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.figure import Figure

import rattlebox as rb

GAPS = np.linspace(1e-4, 2e-3, 12)
FORCES = np.geomspace(100.0, 5000.0, 9)


def study(members: int = 0) -> xr.Dataset:
    """Return a study over gap and amplitude, perhaps with replicas."""
    shape = (GAPS.size, FORCES.size, *([members] if members else []))
    share = np.random.default_rng(3).random(shape)
    status = np.zeros(shape, "int8")
    status[-1, -2:] = 2
    status[0, 0] = -128
    share[status != 0] = np.nan
    share[4, 4] = np.nan
    dims = ("damper.gap", "load.amplitude", *(["replica"] if members else []))
    return xr.Dataset(
        {
            "status": (dims, status, {"flag_meanings": "finished law_domain too_many_events"}),
            "share": (dims, share, {"units": "1", "long_name": "share lost in the damper"}),
            "peak": (dims, 1e-3 * share, {"units": "m", "long_name": "peak displacement"}),
        },
        coords={
            "damper.gap": ("damper.gap", GAPS, {"units": "m", "long_name": "damper gap"}),
            "load.amplitude": ("load.amplitude", FORCES, {"units": "N", "long_name": "load amplitude"}),
        },
    )


def inside(figure: Figure) -> bool:
    """Whether all that is drawn lies on the paper."""
    figure.draw_without_rendering()
    box = figure.get_tightbbox()
    width, height = figure.get_size_inches()
    return bool(box.x0 > -0.01 and box.y0 > -0.01 and box.x1 < width + 0.01 and box.y1 < height + 0.01)


def told(figure: Figure) -> list[str]:
    """Return the texts of the legend below the figure."""
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def test_map_shows_the_values() -> None:
    """Each cell of a map has the value of its variant, in the unit of the colour bar."""
    figure = rb.plot_map(study(), "peak")
    mesh = next(item for item in figure.axes[0].collections if isinstance(item, QuadMesh))
    assert np.ma.filled(mesh.get_array(), np.nan) == pytest.approx(1e3 * study().peak.values.T, nan_ok=True)
    assert figure.axes[1].get_ylabel() == "Peak displacement (mm)"
    assert figure.axes[0].get_xlabel() == "Damper gap (mm)"
    assert figure.axes[0].get_ylabel() == "Load amplitude\n(kN)"
    assert inside(figure)


def test_axis_that_grows_by_a_factor_is_logarithmic() -> None:
    """Values that grow by a factor are evenly spaced, and their cells meet halfway between."""
    figure = rb.plot_map(study(), kind="map")
    axes = figure.axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("linear", "log")
    ratio = (FORCES[1] / FORCES[0]) ** 0.5
    assert axes.get_ylim() == pytest.approx((FORCES[0] / ratio / 1e3, FORCES[-1] * ratio / 1e3))


def test_what_is_missing_is_named() -> None:
    """Runs that did not finish are hatched, those without a value grey, and all are counted."""
    figure = rb.plot_map(study())
    patches = [item for item in figure.axes[0].collections if isinstance(item, PolyCollection)]
    assert [len(item.get_paths()) for item in patches] == [1, 2, 1]
    assert [bool(item.get_hatch()) for item in patches] == [False, True, False]
    assert told(figure) == ["not computed yet (1)", "too many events (2)", "no value (1)"]


@pytest.mark.parametrize("size", ["column", "page", "slide"])
@pytest.mark.parametrize("kind", ["map", "lines"])
def test_everything_is_on_the_paper(kind: Any, size: Any, tmp_path: Path) -> None:
    """Maps and lines of every size are saved without a warning, with all on the paper."""
    figure = rb.plot_map(study(), kind=kind, size=size)
    figure.savefig(tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 5000
    assert inside(figure)


def test_lines_show_the_values() -> None:
    """One line for each value of the shorter axis, named by it, with marks where there is no value."""
    few = study().isel({"load.amplitude": [0, 4, 8]})
    figure = rb.plot_map(few, "share")
    lines = figure.axes[0].get_lines()[:3]
    for line, values in zip(lines, few.share.values.T, strict=True):
        assert np.asarray(line.get_xdata()) == pytest.approx(1e3 * GAPS)
        assert np.asarray(line.get_ydata()) == pytest.approx(values, nan_ok=True)
    assert [line.get_label() for line in lines] == [
        "load amplitude 100 N",
        "load amplitude 707.1 N",
        "load amplitude 5 kN",
    ]
    assert "too many events (1)" in told(figure)


@pytest.mark.parametrize("leap", [0.0, 50.0])
def test_leaps_of_a_loss_factor_press_nothing_flat(leap: float) -> None:
    """Where a loss factor leaps beyond the rest, lines and colours end below, with a mark; other measures are whole."""
    found = study().rename(share="loss_factor").isel({"load.amplitude": slice(1, 4)})
    found.loss_factor[5, 1] += leap
    lines = rb.plot_map(found, of="loss_factor", kind="lines")
    assert (lines.axes[0].get_ylim()[1] < 1.5) and inside(lines)
    marks = [x.get_xdata() for x in lines.axes[0].lines if (x.get_marker(), x.get_linestyle()) == ("^", "None")]
    assert [float(x) for places in marks for x in places] == ([pytest.approx(1e3 * GAPS[5])] if leap else [])
    mesh = next(
        x for x in rb.plot_map(found, of="loss_factor", kind="map").axes[0].collections if isinstance(x, QuadMesh)
    )
    assert mesh.norm.vmax < 1.0
    kept = rb.plot_map(found.rename(loss_factor="share"), of="share", kind="lines")
    assert kept.axes[0].get_ylim()[1] > leap


def test_seeds_are_replicas() -> None:
    """An axis of seeds is drawn as replicas are, but for where nothing else varies, or replicas are there as well."""
    many = study(5).isel({"load.amplitude": 0}, drop=True)
    seeds = many.rename(replica="damper.packing.seed").assign_coords({"damper.packing.seed": np.arange(5)})
    drawn, asked = (rb.plot_map(data, "share").axes[0].get_lines()[0] for data in (seeds, many))
    assert np.array_equal(np.asarray(drawn.get_ydata()), np.asarray(asked.get_ydata()), equal_nan=True)
    alone = study(5).isel({"load.amplitude": 0, "damper.gap": 3}, drop=True).rename(replica="damper.packing.seed")
    line = rb.plot_map(alone.assign_coords({"damper.packing.seed": np.arange(5)}), "share").axes[0].get_lines()[0]
    assert np.asarray(line.get_xdata()) == pytest.approx(np.arange(5))


def test_replicas_give_median_and_band() -> None:
    """Of replicas, lines show the median within 10 to 90 %, and maps the median."""
    many = study(21)
    line = rb.plot_map(many, at={"load.amplitude": "100 N"}).axes[0].get_lines()[0]
    middle = many.share.isel({"load.amplitude": 0}).median("replica")
    assert np.asarray(line.get_ydata()) == pytest.approx(middle.values, nan_ok=True)
    figure = rb.plot_map(many, kind="map")
    mesh = next(item for item in figure.axes[0].collections if isinstance(item, QuadMesh))
    assert np.ma.filled(mesh.get_array(), np.nan) == pytest.approx(many.share.median("replica").values.T, nan_ok=True)
    assert figure.axes[1].get_ylabel().endswith("median")


def test_names_stand_beside_their_values() -> None:
    """An axis of names has them at its ticks."""
    whole = study().isel({"load.amplitude": [0, 1]})
    named = whole.assign_coords({"load.amplitude": ["steel", "brass"]}).rename(
        {"load.amplitude": "damper.ball.material"}
    )
    figure = rb.plot_map(named, kind="map")
    assert [text.get_text() for text in figure.axes[0].get_yticklabels()] == ["steel", "brass"]
    assert rb.plot_map(named, at={"damper.ball.material": "brass"}).axes[0].get_lines()


def test_at_takes_the_nearest_value() -> None:
    """A further axis is fixed at the value nearest to the one asked for, which the title tells."""
    figure = rb.plot_map(study(), at={"load.amplitude": "1.1 kN"})
    nearest = int(np.abs(FORCES - 1100).argmin())
    line = figure.axes[0].get_lines()[0]
    assert np.asarray(line.get_ydata()) == pytest.approx(study().share.values[:, nearest], nan_ok=True)
    assert figure.get_suptitle() == f"Load amplitude {FORCES[nearest] / 1e3:.3f} kN"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"of": "sharre"}, "did you mean 'share'"),
        ({"kind": "mapp"}, "did you mean 'map'"),
        ({"at": {"load.amplitud": 1}}, "did you mean 'load.amplitude'"),
        ({"at": {"load.amplitude": "9 kN"}}, "try: 100 N to 5 kN"),
        ({"at": {"load.amplitude": "9 mm"}}, "a force (N) is needed, not a length"),
        ({"at": {"load.amplitude": "1 kN"}, "kind": "map"}, "try: kind lines"),
        ({"at": {"load.amplitude": "1 kN", "damper.gap": "1 mm"}}, "nothing varies"),
    ],
)
def test_clear_refusals(options: dict[str, Any], said: str) -> None:
    """What cannot be drawn is refused with what to try."""
    with pytest.raises(rb.CaseError) as caught:
        rb.plot_map(study(), **options)
    assert said in str(caught.value)


def test_a_value_between_gaps_is_drawn() -> None:
    """A value whose neighbours are missing is a dot, since a line of one point cannot be seen."""
    gaps = np.linspace(1e-4, 2e-3, 31)
    gappy = study().isel({"load.amplitude": 2}).reindex({"damper.gap": gaps}, method="nearest")
    gappy.share.values[:7] = [0.1, np.nan, 0.2, 0.3, np.nan, 0.4, np.nan]
    line, dots = rb.plot_map(gappy).axes[0].get_lines()[:2]
    assert line.get_marker() == "None"
    assert np.asarray(dots.get_xdata()) == pytest.approx(1e3 * gaps[[0, 5]])
    assert np.asarray(dots.get_ydata()) == pytest.approx([0.1, 0.4])
    assert (dots.get_linestyle(), dots.get_marker()) == ("None", "o")


def test_few_points_of_lines_are_marked() -> None:
    """Lines of thirty points and fewer have a mark at each, another one for each line that is named."""
    for size, marked in ((30, True), (31, False)):
        gaps = np.linspace(1e-4, 2e-3, size)
        for amplitudes in ([0], [0, 4, 8], list(range(9))):
            few = study().isel({"load.amplitude": amplitudes}).reindex({"damper.gap": gaps}, method="nearest")
            lines = rb.plot_map(few, "share", kind="lines").axes[0].get_lines()[: len(amplitudes)]
            marks = ["o"] * len(lines) if len(lines) != 3 else ["o", "^", "s"]
            assert [line.get_marker() for line in lines] == (marks if marked else ["None"] * len(lines))
            assert all(line.get_clip_on() is not marked for line in lines)


@pytest.mark.parametrize(
    ("values", "unit", "shown"),
    [
        ([1, 2, 3], "1", ["1", "2", "3"]),
        ([1.0, 2.0, 3.0], "", ["1", "2", "3"]),
        ([20000.0, 123456789.0, -7.0], "", ["20000", "123456789", "-7"]),
        ([0.5, 1.0, 1e-9], "", ["0.5", "1", "1e-09"]),
        ([0.0025, 1.23e-7, 4.0e20], "", ["0.0025", "1.23e-07", "4e+20"]),
        ([2e3, 3.4e3, 100.0], "N", ["2 kN", "3.4 kN", "100 N"]),
        ([0.02, 1.0, 0.0], "kg", ["20 g", "1 kg", "0 g"]),
        ([5000.0, 999.9, 250.0], "kg", ["5 t", "999.9 kg", "250 kg"]),
    ],
)
def test_numbers_in_legends(values: list[float], unit: str, shown: list[str]) -> None:
    """Numbers in legends have no zeros behind their last decimal; whole ones without a unit have all their digits."""
    coord = ("load.amplitude", values, {"units": unit, "long_name": "it"})
    few = study().isel({"load.amplitude": [0, 1, 2]}).assign_coords({"load.amplitude": coord})
    legend = rb.plot_map(few).axes[0].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == [f"it {text}" for text in shown]


def test_repeated_values_are_drawn_once() -> None:
    """Of an axis with the same value several times one is drawn; an axis with nothing else is none."""
    again = study().isel({"load.amplitude": [0, 1, 1, 2]})
    (drawn,) = (part for part in rb.plot_map(again, kind="map").axes[0].collections if isinstance(part, QuadMesh))
    (plain,) = (
        part
        for part in rb.plot_map(study().isel({"load.amplitude": [0, 1, 2]}), kind="map").axes[0].collections
        if isinstance(part, QuadMesh)
    )
    assert drawn.get_coordinates().shape == plain.get_coordinates().shape
    with pytest.raises(rb.CaseError, match="nothing varies"):
        rb.plot_map(study().isel({"load.amplitude": [1, 1], "damper.gap": [3]}))
    linked = study().isel({"load.amplitude": [0, 0, 1, 1], "damper.gap": 3})
    linked = linked.assign_coords({"load.duration": ("load.amplitude", [1e-3, 2e-3, 1e-3, 2e-3])})
    assert len(np.asarray(rb.plot_map(linked).axes[0].get_lines()[0].get_xdata())) == 4


def test_more_axes_than_two_are_refused() -> None:
    """A study over three axes asks for a value of one of them, and takes it."""
    three = xr.concat([study(), study()], xr.DataArray([1.0, 2.0], dims="structure.mass", name="structure.mass"))
    with pytest.raises(rb.CaseError, match=r"varies along .*\n  try: at load.amplitude = 100"):
        rb.plot_map(three)
    assert rb.plot_map(three, at={"structure.mass": 2.0})


def test_samples_of_the_motion_are_refused() -> None:
    """What is no one number of a run is no measure."""
    with_motion = study().assign(displacement=study().share.expand_dims(sample=5))
    with pytest.raises(rb.CaseError, match="runs along sample"):
        rb.plot_map(with_motion, "displacement")
