"""The damping ratio of a free decay, in summaries and as a measure."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import equivalent_damping
from rattlebox.results.free_decay import free_decay


def decay(**changes: Any) -> rb.Run:
    """Return the run of a structure of 2 % damping that is set off."""
    usual: dict[str, Any] = {
        "structure": rb.SDOF(mass="3 kg", frequency="50 Hz", damping_ratio=0.02, velocity="0.3 m/s"),
        "duration": "1 s",
    }
    return rb.simulate(rb.Case(**{**usual, **changes}))


def test_a_linear_decay() -> None:
    """The ratio of a linear structure is its own at each amplitude that it passes, and NaN beyond."""
    run = decay()
    for amplitude in (0.1e-3, 0.3e-3, 0.6e-3, None):
        assert equivalent_damping(run, amplitude) == pytest.approx(0.02, rel=0.01)
    assert math.isnan(equivalent_damping(run, 1e-3)) and math.isnan(equivalent_damping(run, 1e-9))
    for wrong in ({"amplitude": 0.0}, {"point": "tip"}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            equivalent_damping(run, **wrong)


def test_a_decay_about_a_displaced_equilibrium() -> None:
    """A constant displacement, such as that by a weight, does not change the ratio."""
    arrays = decay().arrays
    offset = 0.5 * np.abs(arrays.modal_displacement).max()
    shape = np.abs(arrays.displacement).max() / np.abs(arrays.modal_displacement).max()
    lowered = arrays.replaced(
        modal_displacement=arrays.modal_displacement - offset, displacement=arrays.displacement - shape * offset
    )
    result = free_decay(lowered)
    assert result is not None and result.damping_ratio == pytest.approx(0.02, rel=0.01)


def test_after_a_load() -> None:
    """The decay begins when the load has ended; a steady motion has no decay."""
    structure = rb.Beam(length="0.4 m", width="30 mm", height="20 mm", material="steel", damping_ratio=0.01)
    pulse = rb.HalfSine(amplitude="100 N", duration="2 ms", point="tip")
    struck = decay(structure=structure, load=pulse)
    assert equivalent_damping(struck) == pytest.approx(0.01, rel=0.02)
    assert "equivalent damping ratio" in str(struck.summary())
    shaken = decay(load=rb.Harmonic(amplitude="1 N", frequency="45 Hz"))
    assert math.isnan(equivalent_damping(shaken))
    assert "equivalent damping" not in str(shaken.summary())


def test_the_summary_states_the_amplitude() -> None:
    """The line holds the ratio and the amplitude; half the peak is 0.48 mm."""
    values = decay().summary().values
    assert values["equivalent_damping_ratio"] == pytest.approx(0.02, rel=0.01)
    assert values["damping_amplitude"] == pytest.approx(0.5 * 0.3 / (100 * math.pi), rel=0.01)
    short = decay(duration="0.15 s").summary().values  # falls to 0.39 of the peak only
    assert short["equivalent_damping_ratio"] == pytest.approx(0.02, rel=0.05)


def test_as_a_measure_it_agrees_with_the_curve() -> None:
    """In a study over the start of a ball, the mean is that of the damping curve within the intervals."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="11 mm", material="steel"), gap="0.5 mm", contact=rb.Tsuji(restitution=0.5)
    )
    structure = rb.SDOF(mass="3 kg", frequency="50 Hz", damping_ratio=0.005, velocity="0.3 m/s")
    case = rb.Case(structure=structure, damper=damper, duration="2 s", output=rb.Output(rate=2000))
    measure = partial(equivalent_damping, amplitude=0.4e-3)
    study = rb.sweep(case, {"damper.start": rb.linspace(-0.9, 0.9, 12)}, [measure], progress=False)
    curve = rb.damping_curve(case, [0.2e-3, 0.4e-3, 0.8e-3], packings=12).sel(amplitude=0.4e-3)
    error = 2 * float(study.equivalent_damping.std()) / math.sqrt(12) + float(curve.upper - curve.damping_ratio)
    assert float(study.equivalent_damping.mean()) == pytest.approx(float(curve.damping_ratio), abs=error + 1e-3)
    assert np.isfinite(study.equivalent_damping).all() and float(study.equivalent_damping.mean()) > 0.01
