"""Loss maps: what they hold, how they are drawn, what they refuse."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

EXAMPLE = Path(__file__).parents[3] / "examples" / "loss_map.py"
AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"


def shaken(**changes: Any) -> rb.Case:
    """Return a ball in a shaken cavity."""
    parts: dict[str, Any] = {
        "structure": rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap="1 mm",
            velocity=0.1,
            contact=rb.Tsuji(restitution=0.6),
        ),
        "duration": "1 s",
        "method": rb.Newton(),
    }
    return rb.Case(**(parts | changes))


@pytest.fixture(scope="module")
def result() -> Any:
    """Return a small map."""
    return rb.loss_map(shaken(), ["0.5 mm", "1 mm", "2 mm"], ["10 Hz", "20 Hz"], cycles=(40, 20), progress=False)


def test_loss_and_masses_agree(result: Any) -> None:
    """The loss from the impacts is that from the force on the cavity, and both are those of the loss factor."""
    assert (result.status == 0).all()
    mass = 7850 * 4 / 3 * np.pi * 0.01**3
    assert float(result.particle_mass) == pytest.approx(mass)
    by_force = np.pi * result.damping_mass / mass
    assert result.reduced_loss[:2].values == pytest.approx(by_force[:2].values, rel=1e-3)
    # A motion that does not repeat ends with another energy than it began with.
    assert result.reduced_loss.values == pytest.approx(by_force.values, rel=1 / 20)
    assert result.loss_factor.values == pytest.approx(np.abs(result.damping_mass / result.effective_mass).values)
    speed = 2 * np.pi * result[FREQUENCY] * result[AMPLITUDE]
    assert (result.reduced_loss * mass * speed**2).values == pytest.approx(result.loss_per_cycle.values)


def test_map_is_a_sweep(result: Any) -> None:
    """Each number is that of a sweep at that amplitude and frequency, in the unit of the case's motion."""
    assert result.loss_factor.dims == (AMPLITUDE, FREQUENCY)
    assert result[AMPLITUDE].attrs["units"] == "m"
    one = rb.sweep(
        shaken(), {AMPLITUDE: ["2 mm"], FREQUENCY: ["20 Hz"]}, "effective_mass", cycles=(40, 20), progress=False
    )
    assert float(one.effective_mass.item()) == float(result.effective_mass[2, 1])
    faster = shaken(structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 m/s^2", frequency="10 Hz")))
    by_acceleration = rb.loss_map(faster, ["10 m/s^2"], ["10 Hz"], cycles=(2, 2), progress=False)
    assert by_acceleration[AMPLITUDE].attrs["units"] == "m/s^2"


@pytest.mark.parametrize("size", ["column", "page", "slide"])
def test_plot(result: Any, size: Any, tmp_path: Path) -> None:
    """Three panels are drawn in every size, without a warning; the mass is over that of the particles."""
    figure = rb.plot_loss_map(result, size=size)
    figure.savefig(tmp_path / "map.png")
    bars = [axes.get_ylabel() for axes in figure.axes[3:]]
    assert [bar.split("$")[0].strip() for bar in bars] == ["Loss factor", "Effective mass", "Loss per cycle"]
    assert (tmp_path / "map.png").stat().st_size > 5000


@pytest.mark.parametrize(
    ("changes", "amplitudes", "message"),
    [
        ({"structure": rb.Fixed()}, ["1 mm"], "a shaker with one harmonic motion"),
        ({"damper": []}, ["1 mm"], "a case with a damper"),
        ({}, ["1 m/s^2"], "a length"),
        ({}, ["1 mm", "-1 mm"], r"amplitudes: structure.motion.amplitude\[1\] = -0.001\n  must be greater than zero"),
        ({}, ["0 mm", "1 mm"], r"amplitudes: structure.motion.amplitude\[0\] = 0\n  must be greater than zero"),
        ({}, ["-1 mm", "0 mm", 1e400], r"amplitudes: structure.motion.amplitude\[2\] = inf\n.*finite"),
    ],
)
def test_clear_refusals(changes: dict[str, Any], amplitudes: Any, message: str) -> None:
    """A case without a shaker or a damper, or amplitudes in another unit or of nothing, are refused with what to try."""
    with pytest.raises(rb.CaseError, match=message):
        rb.loss_map(shaken(**changes), amplitudes, ["10 Hz"])


@pytest.mark.parametrize("frequencies", [6, pytest.param(21, marks=pytest.mark.slow)])
def test_example(frequencies: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the example, a ball rides along at low frequency; on the ridge it loses what one impact at each end must lose.

    The flight of half a cycle between floor and lid gives the phase; 2 gap is 2 mm, e = 0.6 makes (1 + e) / (1 - e) = 4,
    and gravity is up to a tenth of the shaker's acceleration.
    """
    monkeypatch.chdir(tmp_path)
    spaced = rb.geomspace
    monkeypatch.setattr(rb, "geomspace", lambda *ends: spaced(*ends[:2], frequencies if ends[2] == 21 else ends[2]))
    result = runpy.run_path(str(EXAMPLE))["result"]
    assert result.sizes[FREQUENCY] == frequencies
    slow = result.isel({FREQUENCY: 0, AMPLITUDE: -1})
    assert float(slow.effective_mass / slow.particle_mass) == pytest.approx(1, abs=0.02)
    ridge = result.isel(result.reduced_loss.argmax([AMPLITUDE])).sel({FREQUENCY: slice(80, 200)})
    travel = ridge[AMPLITUDE] / (2 * np.pi * ridge[FREQUENCY]) ** 2
    phase = np.arctan2(2, 4 * np.pi) - np.arccos(2e-3 / (travel * np.hypot(4 * np.pi, 2)))
    np.testing.assert_allclose(ridge.reduced_loss, 16 * np.cos(phase) ** 2, rtol=0.01)
    assert np.all((travel > 0.157e-3) & (travel < 0.26e-3))
    assert (tmp_path / "loss_map.png").stat().st_size > 5000


@pytest.mark.parametrize("size", ["column", "page"])
@pytest.mark.parametrize(
    ("amplitudes", "frequencies", "along"),
    [(["0.5 mm", "1 mm", "2 mm"], ["10 Hz"], "mm"), (["1 mm"], ["10 Hz", "20 Hz"], "Hz"), (["1 mm"], ["10 Hz"], "mm")],
)
def test_one_frequency_or_amplitude_is_drawn_as_lines(
    amplitudes: list[str], frequencies: list[str], along: str, size: Any
) -> None:
    """Lines over the axis that has several values hold the numbers of the map; the single value is named above them."""
    result = rb.loss_map(shaken(), amplitudes, frequencies, cycles=(40, 20), progress=False)
    figure = rb.plot_loss_map(result, size=size)
    figure.draw_without_rendering()
    assert along in figure.axes[-1].get_xlabel()
    mass_ratio = result.effective_mass / result.particle_mass
    for panel, values in zip(figure.axes, (result.loss_factor, mass_ratio, result.reduced_loss), strict=True):
        assert panel.lines[0].get_ydata() == pytest.approx(values.values.ravel())
    title = figure.get_suptitle()
    assert ("10 Hz" if along == "mm" else "1 mm") in title


def test_lines_show_points_that_are_not_steady_hollow() -> None:
    """Points whose motion is not steady have hollow marks and a legend; before, only `warnings` of the dataset had them.

    Damping curves had such marks, and figures of loss maps were looked at for their numbers only.
    """
    result = rb.loss_map(shaken(), ["0.5 mm", "1 mm", "2 mm"], ["10 Hz", "20 Hz"], cycles=(40, 20), progress=False)
    flags = {"flag_masks": [1, 2], "flag_meanings": "overlap unsteady"}
    result["warnings"] = result.status.dims, np.array([[1, 0], [2, 0], [3, 2]], np.int8), flags
    one = result.isel({FREQUENCY: [0]})
    panels = rb.plot_loss_map(one).axes[:3]
    for panel, values in zip(panels[1:], (one.effective_mass / one.particle_mass, one.reduced_loss), strict=False):
        line, hollow = panel.lines[:2]
        assert list(hollow.get_xdata()) == list(line.get_xdata()[1:]) and hollow.get_markerfacecolor() == "white"
        assert hollow.get_ydata() == pytest.approx(values.values[1:, 0])
    for figure, count in ((rb.plot_loss_map(one), 1), (rb.plot_map(result, "reduced_loss", kind="lines"), 1)):
        texts = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
        assert texts.count("not steady") == count
    two = rb.plot_map(result, "reduced_loss", kind="lines").axes[0]
    hollow_points = sum(line.get_xdata().size for line in two.lines if line.get_markerfacecolor() == "white")
    assert hollow_points == 3
    many = result.isel({FREQUENCY: [0]}).interp({AMPLITUDE: np.linspace(0.5e-3, 2e-3, 40)}, method="nearest")
    many["warnings"] = many.warnings.astype("int8").assign_attrs(flags)
    many["status"] = many.status.astype("int8")
    many["reduced_loss"][[3, 5]] = np.nan  # the point between two gaps has a dot of its own
    assert rb.plot_map(many.squeeze(), "reduced_loss").axes[0].lines[-1].get_xdata().size > 1
    result["warnings"][:] = 1
    assert not rb.plot_loss_map(result.isel({FREQUENCY: [0]})).legends
