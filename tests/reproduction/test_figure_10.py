"""Figure 10: spectra of ball and structure."""

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from reproduction import figure_10
from reproduction.judge import verdict
from reproduction.models import CONSTANT_E, STEEL
from reproduction.system import DAMPING, MASS, PULSE, STIFFNESS

BIN = 2 * np.pi / 10.0


@pytest.fixture
def data(computed) -> xr.Dataset:
    """Spectra of all models."""
    return computed("figure_10").data


def test_ball_rides_along_at_resonance(data: xr.Dataset) -> None:
    """With the ball the peak is at sqrt(K/(M+m)), without it at sqrt(K/M), to the resolution of the record."""
    assert float(data.riding) == pytest.approx(61.4295, abs=1e-4)
    assert float(data.bare) == pytest.approx(63.2456, abs=1e-4)
    np.testing.assert_allclose(data.peak.median("member"), 61.4295, atol=BIN)
    alone = float(data.fine[int(data.near_without.argmax("fine"))])
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
    shared = data.frequency.values[(data.frequency > data.fine[0] - 1e-9) & (data.frequency < data.fine[-1] + 1e-9)]
    fine = data.near_without.sel(fine=shared, method="nearest")
    np.testing.assert_allclose(fine, data.without.sel(frequency=shared), rtol=1e-9)


def test_band_of_the_steel_wall_is_the_rattle(data: xr.Dataset) -> None:
    """The second band lies where the ball's round trips between the walls are."""
    rise, low, high = figure_10._hump(data, STEEL)
    slow, usual, fast = data.trips.sel(model=STEEL).values
    assert rise > 10
    assert low < slow < usual < fast < high
    assert high - low < 1.5 * (fast - slow)


def test_band_holds_the_median(data: xr.Dataset) -> None:
    """The 90 % quantile is nowhere below the median, and the 10 % quantile nowhere above it."""
    for name in ("ball", "structure", "near"):
        low, median, high = data[name].transpose("quantile", ...)
        assert bool((low <= median).all() and (median <= high).all())


def test_verdicts_follow_the_data(data: xr.Dataset) -> None:
    """The peak and its approximate frequency are confirmed by the data, and not by changed data."""
    assert [verdict(claim) for claim in figure_10.FIGURE.claims(data)] == [
        "reproduced",
        "reproduced",
        "under one interpretation only",
        "reproduced",
        "qualitatively",
    ]
    lower = xr.where(data.model == CONSTANT_E, 1.0, 1e-4)
    assert (
        verdict(figure_10.FIGURE.claims(data.assign(ball=data.ball * lower, structure=data.structure * lower))[4])
        == "reproduced"
    )
    elsewhere = figure_10.FIGURE.claims(data.assign(peak=data.peak + 9.0))
    assert [verdict(claim) for claim in elsewhere[:2]] == ["not reproducible", "not reproducible"]


def test_draws_what_the_data_hold(data: xr.Dataset) -> None:
    """Each panel holds the median of its model, and the window is named."""
    axes = np.reshape(figure_10.FIGURE.draw(data).axes, (3, 3))
    for row, name in enumerate(("ball", "structure", "near")):
        for column in range(3):
            np.testing.assert_array_equal(axes[row, column].lines[0].get_ydata(), data[name].sel(quantile=0.5)[column])
    assert "boxcar window" in figure_10.FIGURE.caption(data)
