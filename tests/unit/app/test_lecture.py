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
    """Between neighbouring starts the number of impacts jumps, while the RMS displacement changes little."""
    case = rb.Case.from_toml(template("steel_ball"))
    study = rb.sweep(case, {"damper.start": rb.linspace(-0.1, 0.1, 21)}, ["impacts", "rms"], progress=False)
    assert np.ptp(study.impacts.values) > 20
    assert np.ptp(study.rms.values) < 0.01 * study.rms.values.mean()
