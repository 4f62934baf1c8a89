"""Figure 10: spectra of ball and structure."""

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from reproduction import figure_10
from reproduction.models import STEEL
from reproduction.reference import DAMPING, MASS, PULSE, STIFFNESS

BIN = 2 * np.pi / 10.0


@pytest.fixture
def data(computed) -> xr.Dataset:
    """Spectra of all models."""
    return computed("figure_10").data


def test_ball_rides_along_at_resonance(data: xr.Dataset) -> None:
    """With the ball the peak is at sqrt(K/(M+m)), without it at sqrt(K/M), to the resolution of the record."""
    assert float(data.riding) == pytest.approx(61.4295, abs=1e-4)
    assert float(data.bare) == pytest.approx(63.2456, abs=1e-4)
    np.testing.assert_allclose(data.peak.sel(quantile=0.5), 61.4295, atol=BIN)
    alone = float(data.near[int(data.near_without.argmax("near"))])
    assert alone == pytest.approx(63.2456, abs=BIN / 4)


def test_spectrum_without_damper_is_the_transfer_function(data: xr.Dataset) -> None:
    """A pulse P(w) leaves the amplitude 2/T |P - (transform of the motion after T)| / |K - M w² + i C w|."""
    w, duration = data.frequency.values, 10.0
    pulse = 2 * 5000.0 * PULSE / np.pi * np.cos(w * PULSE / 2) / (1 - (w * PULSE / np.pi) ** 2)
    end = rb.simulate(figure_10.cases()["without damper"]).arrays
    later = MASS * end.velocity[-1, 0] + (DAMPING + 1j * w * MASS) * end.displacement[-1, 0]
    force = pulse * np.exp(-0.5j * w * PULSE) - later  # a bin turns whole turns in T
    exact = 2 / duration * np.abs(force / (STIFFNESS - MASS * w**2 + 1j * DAMPING * w))
    slow = w < 2 * np.pi * 100  # beyond, half a sample at the cut end shows
    np.testing.assert_allclose(data.without[slow], exact[slow], rtol=3e-3)


def test_near_spectrum_passes_through_the_bins(data: xr.Dataset) -> None:
    """The finer spectrum about the resonance agrees with the coarse one where both are known."""
    shared = data.frequency.values[(data.frequency > data.near[0] - 1e-9) & (data.frequency < data.near[-1] + 1e-9)]
    fine = data.near_without.sel(near=shared, method="nearest")
    np.testing.assert_allclose(fine, data.without.sel(frequency=shared), rtol=1e-9)


def test_band_of_the_steel_wall_is_the_rattle(data: xr.Dataset) -> None:
    """The second band lies where the ball's round trips between the walls are."""
    rise, low, high = figure_10._hump(data, STEEL)
    slow, usual, fast = data.trips.sel(model=STEEL).values
    assert rise > 10
    assert low < slow < usual < fast < high
    assert high - low < 1.5 * (fast - slow)


def test_band_holds_the_median(data: xr.Dataset) -> None:
    """Nine tenths are nowhere below the median, nor one tenth above it."""
    for name in ("ball", "structure", "near"):
        assert bool((data[f"{name}_low"] <= data[f"{name}_median"]).all())
        assert bool((data[f"{name}_median"] <= data[f"{name}_high"]).all())


def test_verdicts_follow_the_data(data: xr.Dataset) -> None:
    """The resonance is confirmed, its name and the reduction everywhere are not, until the data say so."""
    assert [claim.verdict for claim in figure_10.claims(data)] == [
        "reproduced",
        "not reproducible",
        "reproduced qualitatively",
        "reproduced",
        "not reproducible",
    ]
    names = [f"{part}_{key}" for part in ("ball", "structure") for key in ("low", "median", "high")]
    lowered = data.assign({name: data[name] * [[1.0], [1e-4], [1e-4]] for name in names})
    assert figure_10.claims(lowered)[4].verdict == "reproduced"
    elsewhere = data.assign(peak=data.peak + 2.0)
    assert figure_10.claims(elsewhere)[0].verdict == "not reproducible"
    assert figure_10.claims(elsewhere)[1].verdict == "reproduced"


def test_draws_what_the_data_hold(data: xr.Dataset) -> None:
    """Each panel holds the median of its model, the window is named, and every number has a unit."""
    figure = figure_10.draw(data)
    axes = np.reshape(figure.axes, (3, 3))
    for row, name in enumerate(("ball", "structure", "near")):
        for column in range(3):
            (line,) = [line for line in axes[row, column].lines if line.get_label() == "median"]
            np.testing.assert_array_equal(line.get_ydata(), data[f"{name}_median"][column])
    assert "boxcar window" in figure_10.caption(data)
    assert all({"units", "long_name"} <= set(variable.attrs) for variable in data.variables.values())
    assert len(figure_10.cases()) == 4
