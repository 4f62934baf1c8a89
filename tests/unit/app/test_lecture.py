"""The numbers of the experiments for a lecture."""

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.app.draft import template


def test_best_gap_of_a_row():
    """RMS displacement has a valley near a gap of 6 mm and that of the bare structure from 14 mm on."""
    case = rb.Case.from_toml(template("row"))
    rms = 1e3 * rb.sweep(case, {"damper.gap": rb.geomspace("0.3 mm", "100 mm", 40)}, "rms", progress=False).rms
    gap = 1e3 * rms["damper.gap"].values
    assert rms.values.min() == pytest.approx(1.3, abs=0.05)
    assert 4 < gap[int(rms.values.argmin())] < 8
    assert np.allclose(rms.values[gap > 14], 3.0, atol=0.01)


def test_impacts_are_chaotic_and_averages_are_not():
    """Between neighbouring starts the number of impacts jumps, and the RMS displacement hardly changes."""
    case = rb.Case.from_toml(template("steel_ball"))
    study = rb.sweep(case, {"damper.start": rb.linspace(-0.1, 0.1, 21)}, ["impacts", "rms"], progress=False)
    assert np.ptp(study.impacts.values) > 20
    assert np.ptp(study.rms.values) < 0.01 * study.rms.values.mean()


@pytest.mark.slow
def test_loss_over_amplitude_of_a_box():
    """The loss over the square of the amplitude rises by more than three and falls again."""
    case = rb.Case.from_toml(template("box").replace('"1 s"', '"0.5 s"').replace(", snapshots = 200", ""))
    axis = {"structure.motion.amplitude": rb.geomspace("0.5 mm", "20 mm", 8)}
    loss = rb.sweep(case, axis, "impact_loss", progress=False).impact_loss
    reduced = loss.values / loss["structure.motion.amplitude"].values ** 2
    assert reduced.argmax() in (4, 5, 6)
    assert reduced.max() > 3 * reduced[0]
    assert reduced[-1] < 0.8 * reduced.max()


@pytest.mark.slow
def test_number_of_balls_of_the_same_mass():
    """Eight times as many balls lose less, and more in sliding and among themselves."""
    text = template("box").replace('"1 s"', '"0.5 s"').replace(", snapshots = 200", "")
    few, many = (
        rb.simulate(
            rb.Case.from_toml(text.replace('"6 mm", count = 200', f'"{size} mm", mass = "60 g"')), progress=False
        ).summary()
        for size in (12, 6)
    )
    assert few.values["supplied_energy"] > 1.1 * many.values["supplied_energy"]
    for share in ("share_sliding", "share_at_particle"):
        assert many.values[share] > few.values[share]
