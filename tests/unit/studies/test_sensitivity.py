"""Sensitivity studies: indices, seeds, missing values, refused arguments, figures."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from support.struck import struck

import rattlebox as rb
from rattlebox.studies.kinds.sensitivity import _indices

EXAMPLE = Path(__file__).parents[3] / "examples" / "sensitivity.py"
BOUNDS: dict[str, Any] = {"damper.gap": ("0.2 mm", "1 mm"), "load.amplitude": ("4 kN", "6 kN")}


def test_mean_and_variance_are_those_of_the_runs() -> None:
    """Mean and variance are those of the runs, and the index of a parameter without influence is zero."""
    bounds = BOUNDS | {"structure.velocity": (0.0, 1e-12)}
    result = rb.sensitivity(struck(), bounds, "impact_share", 64, progress=False)
    assert result.total.sel(measure="impact_share", parameter="structure.velocity") < 1e-3
    assert 0 < float(result["mean"][0]) < 1
    assert (result.total.sel(parameter=list(BOUNDS)) > 0.05).all()


def test_driven_cases_have_no_indices_of_intervals() -> None:
    """Of a driven case, only the measure has indices, not its 95 % interval, which short runs lack."""
    driven = struck(load=rb.Harmonic(amplitude="10 N", frequency="10 Hz"), duration="0.1 s")
    result = rb.sensitivity(driven, {"load.amplitude": (5.0, 10.0)}, "rms", 8, progress=False)
    assert result.measure.values.tolist() == ["rms"]


def test_same_seed_same_indices() -> None:
    """A seed fixes points and intervals for any number of threads and any state of NumPy's global generator."""
    first = rb.sensitivity(struck(), BOUNDS, n=16, seed=0, workers=2, progress=False)
    np.random.seed(7)  # noqa: NPY002
    again = rb.sensitivity(struck(), BOUNDS, n=16, seed=0, workers=1, progress=False)
    assert first.identical(again)
    other = rb.sensitivity(struck(), BOUNDS, n=16, seed=1, progress=False)
    assert not first.total.equals(other.total)


def test_several_measures_names_and_logarithms() -> None:
    """Each measure has a row; parameters may be choices and logarithmic ranges."""
    bounds = BOUNDS | {"damper.ball.material": ["steel", "brass", "glass"]}
    result = rb.sensitivity(struck(), bounds, ["peak_contact_force", "impacts"], 16, log=["damper.gap"], progress=False)
    assert result.total.dims == ("measure", "parameter")
    assert result.measure.values.tolist() == ["peak_contact_force", "impacts"]
    assert result.parameter.values.tolist() == list(bounds)
    assert (result.left_out == 0).all()


def test_means_over_starts() -> None:
    """With several starts, the value of each point is the mean over the starts."""
    result = rb.sensitivity(struck(), BOUNDS, "impacts", 8, starts=[-1, 1], progress=False)
    single = [rb.sensitivity(struck(), BOUNDS, "impacts", 8, starts=[s, s], progress=False)["mean"] for s in (-1, 1)]
    assert float(result["mean"][0]) == pytest.approx(np.mean(single))


def test_resumes_from_a_store(tmp_path: Path) -> None:
    """With a store the runs are on disk, and the same call reads them."""
    store = tmp_path / "study.zarr"
    first = rb.sensitivity(struck(), BOUNDS, n=8, store=store, progress=False)
    counts: list[int] = []
    again = rb.sensitivity(struck(), BOUNDS, n=8, store=store, progress=lambda done, total: counts.append(done))
    assert first.equals(again)
    assert counts == [32]
    with pytest.raises(rb.StoreError, match="another study"):
        rb.sensitivity(struck(), BOUNDS, n=8, seed=1, store=store)


def runs(values: Any, status: Any = 0) -> xr.Dataset:
    """Return a dataset as from a sweep."""
    array = np.asarray(values, dtype=float)
    ended = np.broadcast_to(np.asarray(status, dtype="int8"), array.shape)
    return xr.Dataset({"status": ("sample", ended), "f": ("sample", array)}, attrs={"case": ""})


def test_points_without_a_value_are_omitted() -> None:
    """A run without a value removes all runs of its base point; too many missing values are an error."""
    rng = np.random.default_rng(1)
    values = rng.random(32 * 4)
    status = np.zeros(128)
    status[5] = 2
    values[77] = np.nan
    result = _indices(runs(values, status), ["a", "b"], 32, 0.95, 0)
    assert int(result.left_out[0]) == 2
    assert np.isfinite(result.total).all()
    with pytest.raises(rb.CaseError, match="32 of 32 base points have a run without a value"):
        _indices(runs(values, 1), ["a", "b"], 32, 0.95, 0)


@pytest.mark.parametrize(
    ("bounds", "options", "message"),
    [
        ({"damper.gapp": (1e-4, 1e-3)}, {}, "did you mean 'gap'"),
        ({"damper.gap": ("1 mm", "0.1 mm")}, {}, "the first value must be the smaller one"),
        (BOUNDS, {"n": 100}, "a power of two"),
        (BOUNDS, {"n": 4}, "at least 8"),
        (BOUNDS, {"measure": "shares"}, "measure = 'shares'"),
        (BOUNDS, {"confidence": 95}, "must be less than 1"),
        (BOUNDS, {"log": ["gap"]}, "is not one of the ranges"),
        (BOUNDS, {"measure": "settling_time"}, "have a run without a value"),
        ({"damper.gap": ("50 mm", "60 mm")}, {}, "has no variance"),
        ({}, {}, "paths to bounds or choices"),
    ],
)
def test_clear_refusals(bounds: Any, options: dict[str, Any], message: str) -> None:
    """Bad arguments and measures without indices are refused with advice."""
    with pytest.raises(rb.CaseError) as caught:
        rb.sensitivity(struck(), bounds, **({"n": 8, "progress": False} | options))
    assert message in str(caught.value)


def test_without_salib(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without SALib the error has the command that installs it."""
    for name in [name for name in sys.modules if name.startswith("SALib")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "SALib", None)
    with pytest.raises(
        rb.MissingDependency, match=r"SALib is required and not installed.*\n.*pip install 'rattlebox\[design\]'"
    ):
        rb.sensitivity(struck(), BOUNDS, n=8)


@pytest.mark.parametrize("size", ["column", "page", "slide"])
def test_plot(size: Any, tmp_path: Path) -> None:
    """Bars have the lengths of the indices, with the most important parameter on top."""
    result = rb.sensitivity(struck(), BOUNDS, ["impacts", "rms"], 16, progress=False)
    figure = rb.plot_sensitivity(result, size=size)
    figure.savefig(tmp_path / "bars.png")
    axes = figure.axes[0]
    lengths = [patch.get_width() for patch in axes.patches]
    order = np.argsort(result.total.mean("measure").values)
    expected = [*result.first.values[0, order], *result.total.values[0, order]]
    assert lengths == pytest.approx(expected)
    assert [text.get_text() for text in axes.get_yticklabels()] == list(result.parameter.values[order])


def test_example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the example the start has no influence on the impact share, but on the largest force."""
    monkeypatch.chdir(tmp_path)
    result = runpy.run_path(str(EXAMPLE))["result"]
    start = result.total.sel(parameter="damper.start")
    assert float(start.sel(measure="impact_share")) < 0.01
    assert float(start.sel(measure="peak_contact_force")) == pytest.approx(0.085, abs=0.05)
    shares = result.first.sel(measure="impact_share")
    assert float(shares.sum()) == pytest.approx(1, abs=0.1)
    assert str(shares.idxmax().item()) == "damper.contact.restitution"
    assert (tmp_path / "sensitivity.png").stat().st_size > 5000
