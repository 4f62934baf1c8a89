"""Tests of maps and lines of studies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.figure import Figure

import rattlebox as rb

from .conftest import is_within_page

GAPS = np.linspace(1e-4, 2e-3, 12)
FORCES = np.geomspace(100.0, 5000.0, 9)


def study(replicas: int = 0) -> xr.Dataset:
    """Return a study over gap and amplitude, optionally with replicas."""
    shape = (GAPS.size, FORCES.size, *([replicas] if replicas else []))
    share = np.random.default_rng(3).random(shape)
    status = np.zeros(shape, "int8")
    status[-1, -2:] = 2
    status[0, 0] = -128
    share[status != 0] = np.nan
    share[4, 4] = np.nan
    dims = ("damper.gap", "load.amplitude", *(["replica"] if replicas else []))
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


def legend_texts(figure: Figure) -> list[str]:
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
    assert is_within_page(figure)


def test_geometric_axis_is_logarithmic() -> None:
    """Values with a constant ratio are on a logarithmic axis, with cell edges at their geometric means."""
    figure = rb.plot_map(study(), kind="map")
    axes = figure.axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("linear", "log")
    ratio = (FORCES[1] / FORCES[0]) ** 0.5
    assert axes.get_ylim() == pytest.approx((FORCES[0] / ratio / 1e3, FORCES[-1] * ratio / 1e3))


def test_missing_values() -> None:
    """Unfinished runs are hatched, runs without a value are grey, and the legend counts both."""
    figure = rb.plot_map(study())
    patches = [item for item in figure.axes[0].collections if isinstance(item, PolyCollection)]
    assert [len(item.get_paths()) for item in patches] == [1, 2, 1]
    assert [bool(item.get_hatch()) for item in patches] == [False, True, False]
    assert legend_texts(figure) == ["not computed yet (1)", "too many events (2)", "no value (1)"]


@pytest.mark.parametrize("size", ["column", "page", "slide"])
@pytest.mark.parametrize("kind", ["map", "lines"])
def test_layout(kind: Any, size: Any, tmp_path: Path) -> None:
    """Maps and lines of every size are saved without a warning and fit on the page."""
    figure = rb.plot_map(study(), kind=kind, size=size)
    figure.savefig(tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 5000
    assert is_within_page(figure)


def test_lines_show_the_values() -> None:
    """There is one labelled line for each value of the shorter axis, with marks for missing values."""
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
    assert "too many events (1)" in legend_texts(figure)


@pytest.mark.parametrize("peak", [0.0, 50.0])
def test_peaks_of_a_loss_factor_are_clipped(peak: float) -> None:
    """The scale of a loss factor ends below an extreme peak, which is marked; other measures are not clipped."""
    data = study().rename(share="loss_factor").isel({"load.amplitude": slice(1, 4)})
    data.loss_factor[5, 1] += peak
    lines = rb.plot_map(data, of="loss_factor", kind="lines")
    assert (lines.axes[0].get_ylim()[1] < 1.5) and is_within_page(lines)
    marks = [x.get_xdata() for x in lines.axes[0].lines if (x.get_marker(), x.get_linestyle()) == ("^", "None")]
    assert [float(x) for places in marks for x in places] == ([pytest.approx(1e3 * GAPS[5])] if peak else [])
    mesh = next(
        x for x in rb.plot_map(data, of="loss_factor", kind="map").axes[0].collections if isinstance(x, QuadMesh)
    )
    assert mesh.norm.vmax < 1.0
    unclipped = rb.plot_map(data.rename(loss_factor="share"), of="share", kind="lines")
    assert unclipped.axes[0].get_ylim()[1] > peak


def test_seeds_are_replicas() -> None:
    """An axis of seeds is drawn like replicas if another axis varies, and as an axis otherwise."""
    many = study(5).isel({"load.amplitude": 0}, drop=True)
    seeds = many.rename(replica="damper.packing.seed").assign_coords({"damper.packing.seed": np.arange(5)})
    drawn, asked = (rb.plot_map(data, "share").axes[0].get_lines()[0] for data in (seeds, many))
    assert np.array_equal(np.asarray(drawn.get_ydata()), np.asarray(asked.get_ydata()), equal_nan=True)
    alone = study(5).isel({"load.amplitude": 0, "damper.gap": 3}, drop=True).rename(replica="damper.packing.seed")
    line = rb.plot_map(alone.assign_coords({"damper.packing.seed": np.arange(5)}), "share").axes[0].get_lines()[0]
    assert np.asarray(line.get_xdata()) == pytest.approx(np.arange(5))


def test_median_of_replicas() -> None:
    """Lines and maps show the median of replicas."""
    many = study(21)
    line = rb.plot_map(many, at={"load.amplitude": "100 N"}).axes[0].get_lines()[0]
    middle = many.share.isel({"load.amplitude": 0}).median("replica")
    assert np.asarray(line.get_ydata()) == pytest.approx(middle.values, nan_ok=True)
    figure = rb.plot_map(many, kind="map")
    mesh = next(item for item in figure.axes[0].collections if isinstance(item, QuadMesh))
    assert np.ma.filled(mesh.get_array(), np.nan) == pytest.approx(many.share.median("replica").values.T, nan_ok=True)
    assert figure.axes[1].get_ylabel().endswith("median")


def test_axis_of_names() -> None:
    """The ticks of an axis of names have these names."""
    whole = study().isel({"load.amplitude": [0, 1]})
    named = whole.assign_coords({"load.amplitude": ["steel", "brass"]}).rename(
        {"load.amplitude": "damper.ball.material"}
    )
    figure = rb.plot_map(named, kind="map")
    assert [text.get_text() for text in figure.axes[0].get_yticklabels()] == ["steel", "brass"]
    assert rb.plot_map(named, at={"damper.ball.material": "brass"}).axes[0].get_lines()


def test_nearest_value_of_a_further_axis() -> None:
    """A further axis is fixed at the nearest value in the study, which is in the title."""
    figure = rb.plot_map(study(), at={"load.amplitude": "1.1 kN"})
    nearest = int(np.abs(FORCES - 1100).argmin())
    line = figure.axes[0].get_lines()[0]
    assert np.asarray(line.get_ydata()) == pytest.approx(study().share.values[:, nearest], nan_ok=True)
    assert figure.get_suptitle() == f"Load amplitude {FORCES[nearest] / 1e3:.3f} kN"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"of": "sharre"}, "did you mean 'share'"),
        ({"kind": "mapp"}, "did you mean 'map'"),
        ({"at": {"load.amplitud": 1}}, "did you mean 'load.amplitude'"),
        ({"at": {"load.amplitude": "9 kN"}}, "try: 100 N to 5 kN"),
        ({"at": {"load.amplitude": "9 mm"}}, "a force (N) is needed, not a length"),
        ({"at": {"load.amplitude": "1 kN"}, "kind": "map"}, "try: kind lines"),
        ({"at": {"load.amplitude": "1 kN", "damper.gap": "1 mm"}}, "no axis of the study is left"),
    ],
)
def test_invalid_options(options: dict[str, Any], message: str) -> None:
    """Options that do not apply to the study raise CaseError with a suggestion."""
    with pytest.raises(rb.CaseError) as caught:
        rb.plot_map(study(), **options)
    assert message in str(caught.value)


def test_isolated_values_are_dots() -> None:
    """A value between two missing values is drawn as a dot."""
    gaps = np.linspace(1e-4, 2e-3, 31)
    gappy = study().isel({"load.amplitude": 2}).reindex({"damper.gap": gaps}, method="nearest")
    gappy.share.values[:7] = [0.1, np.nan, 0.2, 0.3, np.nan, 0.4, np.nan]
    line, dots = rb.plot_map(gappy).axes[0].get_lines()[:2]
    assert line.get_marker() == "None"
    assert np.asarray(dots.get_xdata()) == pytest.approx(1e3 * gaps[[0, 5]])
    assert np.asarray(dots.get_ydata()) == pytest.approx([0.1, 0.4])
    assert (dots.get_linestyle(), dots.get_marker()) == ("None", "o")


def test_short_lines_have_markers() -> None:
    """Lines of up to thirty points have markers, which differ between lines in a legend."""
    for size, has_markers in ((30, True), (31, False)):
        gaps = np.linspace(1e-4, 2e-3, size)
        for amplitudes in ([0], [0, 4, 8], list(range(9))):
            few = study().isel({"load.amplitude": amplitudes}).reindex({"damper.gap": gaps}, method="nearest")
            lines = rb.plot_map(few, "share", kind="lines").axes[0].get_lines()[: len(amplitudes)]
            marks = ["o"] * len(lines) if len(lines) != 3 else ["o", "^", "s"]
            assert [line.get_marker() for line in lines] == (marks if has_markers else ["None"] * len(lines))
            assert all(line.get_clip_on() is not has_markers for line in lines)


@pytest.mark.parametrize(
    ("values", "unit", "texts"),
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
def test_numbers_in_legends(values: list[float], unit: str, texts: list[str]) -> None:
    """Numbers in legends have no trailing zeros; whole numbers without a unit have all their digits."""
    coord = ("load.amplitude", values, {"units": unit, "long_name": "it"})
    few = study().isel({"load.amplitude": [0, 1, 2]}).assign_coords({"load.amplitude": coord})
    legend = rb.plot_map(few).axes[0].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == [f"it {text}" for text in texts]


def test_repeated_values_are_drawn_once() -> None:
    """Repeated values of an axis are drawn once, unless a linked parameter distinguishes them."""
    again = study().isel({"load.amplitude": [0, 1, 1, 2]})
    (drawn,) = (part for part in rb.plot_map(again, kind="map").axes[0].collections if isinstance(part, QuadMesh))
    (plain,) = (
        part
        for part in rb.plot_map(study().isel({"load.amplitude": [0, 1, 2]}), kind="map").axes[0].collections
        if isinstance(part, QuadMesh)
    )
    assert drawn.get_coordinates().shape == plain.get_coordinates().shape
    with pytest.raises(rb.CaseError, match="no axis of the study is left"):
        rb.plot_map(study().isel({"load.amplitude": [1, 1], "damper.gap": [3]}))
    linked = study().isel({"load.amplitude": [0, 0, 1, 1], "damper.gap": 3})
    linked = linked.assign_coords({"load.duration": ("load.amplitude", [1e-3, 2e-3, 1e-3, 2e-3])})
    assert len(np.asarray(rb.plot_map(linked).axes[0].get_lines()[0].get_xdata())) == 4


def test_three_axes() -> None:
    """A study over three axes needs a value of one of them."""
    three = xr.concat([study(), study()], xr.DataArray([1.0, 2.0], dims="structure.mass", name="structure.mass"))
    with pytest.raises(rb.CaseError, match=r"varies along .*\n  try: at load.amplitude = 100"):
        rb.plot_map(three)
    assert rb.plot_map(three, at={"structure.mass": 2.0})


def test_time_series_are_no_measure() -> None:
    """A variable with several values per run cannot be drawn."""
    with_motion = study().assign(displacement=study().share.expand_dims(sample=5))
    with pytest.raises(rb.CaseError, match="several values per run, along sample"):
        rb.plot_map(with_motion, "displacement")
