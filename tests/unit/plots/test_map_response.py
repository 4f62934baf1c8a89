"""The figure of a response from a map: lines of all motions, marks of limits, damping of the modes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import rattlebox as rb

AXES = ("structure.motion.amplitude", "structure.motion.frequency")


@pytest.fixture(scope="module")
def response() -> Any:
    """Return the response of an oscillator whose resonance bends, with one and two dampers."""
    amplitude = np.geomspace(1e-5, 0.1, 81)
    mass = np.repeat(0.5 / (1 + (amplitude / 1e-3) ** 2)[:, None], 2, axis=1)
    harmonics = np.zeros((81, 2, 7))
    harmonics[40:, :, 1] = 1e6 * amplitude[40:, None]
    loss_map = xarray.Dataset(
        {
            "effective_mass": (AXES, mass),
            "damping_mass": (AXES, np.full(mass.shape, 1e-3)),
            "force_harmonics": ((*AXES, "harmonic"), harmonics),
            "force_variation": (AXES, np.zeros(mass.shape)),
        },
        {AXES[0]: (AXES[0], amplitude, {"units": "m"}), AXES[1]: [5.0, 200.0]},
    )
    structure = rb.SDOF(mass="3 kg", frequency="32 Hz", damping_ratio=0.005)
    return rb.response_from_map(
        structure, loss_map, level=["0.5 N", "2 N"], number=[1, 2], frequencies=np.linspace(28, 34, 121).tolist()
    )


@pytest.mark.parametrize("size", ["column", "page", "slide"])
def test_motions_and_damping(response: Any, size: Any, tmp_path: Path) -> None:
    """Every size has both panels; unstable motions are dotted, and the damping curve has the numbers of the mode."""
    figure = rb.plot_response_from_map(response, number=2, size=size)
    figure.savefig(tmp_path / "response.png")
    left, right = figure.axes
    drawn = np.concatenate([line.get_ydata() for line in left.lines if line.get_linestyle() == ":"])
    one = response.sel(number=2).isel(at=0)
    unstable = one.amplitude.values[one.is_unstable.values]
    assert np.sort(drawn[np.isfinite(drawn)]) == pytest.approx(np.sort(1e3 * unstable))
    assert right.lines[0].get_ydata() == pytest.approx(100 * one.damping_ratio.values[0])
    texts = [text.get_text() for legend in (left.get_legend(), *figure.legends) for text in legend.get_texts()]
    assert texts[:2] == ["0.5 N", "2 N"]
    assert {"no damper", "unstable", "other harmonics above 5 %"} <= set(texts)


def test_selection(response: Any) -> None:
    """An arrangement that is not in the dataset is refused; amplitudes can be drawn per level."""
    with pytest.raises(rb.CaseError, match="tip"):
        rb.plot_response_from_map(response, at="tip")
    axes = rb.plot_response_from_map(response, per_level=True).axes[0]
    assert "over level" in axes.get_ylabel()
