"""Advice of errors of studies is followed: what a message says to try leads to a result.

Tests matched the first words of messages, and advice that cannot be followed has the right first words, too.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import notch

BAR = rb.SDOF(mass="3 kg", frequency="20 Hz", damping_ratio=0.02)
LEVELS = ["0.1 mm", "0.2 mm"]
TURNED = {"frequencies": [20, 30], "damping_ratios": [0.01, 0.01], "shapes": {"tip": [[1, 0, 0], [0, 0.5, 0]]}}


def lone_ball() -> rb.ParticleDamper:
    """Return a sphere at a given place, whose start has no random part."""
    return rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=1),
        cavity=rb.Box(size=("40 mm", "40 mm", "25 mm")),
        contact=rb.Tsuji(restitution=0.6),
        softening=1000,
        packing=rb.Positions(positions=[[0, 0, 0]]),
    )


def advice(call: Any, words: str) -> str:
    """Return the advice of the error that a call raises."""
    with pytest.raises(rb.CaseError, match=re.escape(words)) as caught:
        call()
    return caught.value.suggestion


def test_the_argument_of_repeated_runs_is_named() -> None:
    """A case without a random start is run once by the argument of the function: backbones were told of packings."""
    load = rb.Harmonic(amplitude="1 N", frequency="20 Hz")
    case = rb.Case(structure=BAR, damper=lone_ball(), load=load, duration="1 s")
    said = advice(lambda: rb.backbone(case, LEVELS, progress=False), "no random seed")
    assert said.endswith("or starts = 1")
    assert rb.backbone(case, LEVELS, starts=1, cycles=(8, 8), progress=False).sizes["start"] == 1
    free = case.replaced({"loads": ()})
    said = advice(lambda: rb.damping_curve(free, LEVELS, progress=False), "no random seed")
    assert said.endswith("or packings = 1")
    assert rb.damping_curve(free, LEVELS, packings=1, progress=False).sizes["packing"] == 1


def test_a_decay_that_is_too_short_is_made_longer() -> None:
    """The duration that a message gives is long enough, and a plain run, which it named before, shows nothing."""
    case = rb.Case(structure=BAR, duration="0.2 s")
    said = advice(lambda: rb.damping_curve(case, LEVELS, progress=False), "values cover")
    (text,) = re.findall(r'^duration = "(.*)" or more', said)
    longer = rb.damping_curve(case.replaced({"duration": text}), LEVELS, progress=False)
    assert longer.damping_ratio.values == pytest.approx(0.02, rel=1e-2)


def test_cutting_coefficients_have_a_unit() -> None:
    """A bare number in N/mm^2 is answered by itself with its unit; the message advised a list of one number."""
    said = advice(lambda: rb.stability_lobes(BAR, cutting_coefficient=2000), "is 2000 N/m^2")
    assert said == '"2000 N/mm^2"'
    limits = [rb.stability_lobes(BAR, cutting_coefficient=each).limit.values for each in ("2000 N/mm^2", 2e9)]
    np.testing.assert_array_equal(*limits)
    said = advice(lambda: rb.stability_lobes(BAR, None, "2 GPa", teeth_in_cut=2.5), "more than the number of teeth")
    assert said == "teeth = 3, or teeth_in_cut = 1"
    assert rb.stability_lobes(BAR, None, "2 GPa", teeth=3, teeth_in_cut=2.5).limit.notnull().all()


def test_directions_are_those_in_which_something_moves() -> None:
    """The direction of a message is the main one of the structure, not the vertical in which it may not move."""
    tool = rb.Modal(**TURNED)
    assert advice(lambda: rb.stability_lobes(tool, cutting_coefficient="2 GPa"), "moves in 3-D") == 'direction = "x"'
    assert rb.stability_lobes(tool, cutting_coefficient="2 GPa", direction="x").limit.notnull().all()
    box = rb.Case(structure=rb.Modal(**TURNED, participation=[[1, 0, 0], [0, 2, 0]]), duration="1 s")
    level = {"psd": [("5 Hz", "0.01 g^2/Hz"), ("60 Hz", "0.01 g^2/Hz")], "duration": "1 s"}
    said = advice(lambda: notch(rb.Random(**level), box, force_rms="3 N"), "its base needs a direction")
    assert said == 'direction = "y"'
    assert notch(rb.Random(**level, direction="y"), box, force_rms="3 N").depth > 0


def test_the_unit_of_a_density_is_of_the_right_quantity() -> None:
    """Advice on the density of a force begins with one of a force."""
    case = rb.Case(structure=BAR, duration="1 s")
    level = rb.Random("gevs_acceptance", "1 s")
    said = advice(lambda: notch(level, case, force_density="200 N"), "is not the unit of a power spectral density")
    assert said.startswith('"1 N^2/Hz"')
    assert notch(level, case, force_density="1 N^2/Hz").depth > 0
