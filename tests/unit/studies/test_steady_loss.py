"""The loss of a bed is the work of its walls over whole cycles, with a test of steadiness.

No test saw that settling was counted as damping: every bed of the tests was either thrown, where settling is a small part
of the loss, or shaken for so many cycles that it had settled before the evaluated ones.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray
from scipy.special import stdtrit

import rattlebox as rb
from rattlebox.analysis import cycle_loss as module
from rattlebox.analysis.cycle_loss import cycle_loss

HERTZ, BARE, G = 100.0, 0.006, 9.80665


def bed(**options: Any) -> rb.ParticleDamper:
    """Return a few balls that fall on the floor of a box at the start."""
    usual: dict[str, Any] = {"packing": rb.Lattice(seed=4), "friction": 0.4, "softening": 50, "direction": "z"}
    return rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=18),
        cavity=rb.Box(size=("13 mm", "13 mm", "25 mm")),
        contact=rb.Tsuji(restitution=0.6),
        **usual | options,
    )


def structure_with(damper: rb.ParticleDamper, share: float = 0.1) -> rb.Case:
    """Return a structure with a bed of a share of its mass."""
    mass = float(damper.contents.mass.sum()) / share
    return rb.Case(
        structure=rb.SDOF(mass=mass, frequency=HERTZ, damping_ratio=BARE), damper=damper, duration="0.1 s", seed=1
    )


def levels(*accelerations: float) -> list[float]:
    """Return the displacement amplitudes of accelerations in g [m]."""
    return [G * each / (2 * math.pi * HERTZ) ** 2 for each in accelerations]


@cache
def curve(cycles: tuple[int, int] | None) -> xarray.Dataset:
    """Return the damping curve of the falling bed at two levels at which it is locked."""
    case = structure_with(bed())
    return rb.damping_curve(case, levels(0.1, 0.2), way="shaking", packings=2, cycles=cycles, progress=False)


def test_a_bed_that_settles_adds_no_damping() -> None:
    """The energy of the fall does not count in any window; early windows have a flag and a warning."""
    early = curve((3, 10))
    assert not early.steady.any() and early.lower.isnull().all() and "unsteady" in early.attrs["exceeded"]
    assert any("the motion is not steady" in text and "cycles to skip" in text for text in early.attrs["warnings"])
    late = curve(None)
    assert late.steady.all() and "unsteady" not in late.attrs["exceeded"]
    np.testing.assert_allclose(late.damping_ratios, BARE, rtol=0.05)


def test_the_advice_to_skip_more_cycles_helps() -> None:
    """A window after the fall has no warning, and the same damping as the default one."""
    advised = curve((60, 40))
    assert advised.steady.all()
    np.testing.assert_allclose(advised.damping_ratios, curve(None).damping_ratios, rtol=0.02)


def shaken(damper: rb.ParticleDamper, acceleration: float, cycles: int) -> rb.Run:
    """Return the run of a bed on a shaker."""
    motion = rb.Harmonic(amplitude=G * acceleration, unit="m/s^2", frequency=HERTZ, direction="z")
    case = rb.Case(
        structure=rb.Shaker(motion=motion),
        damper=damper,
        duration=cycles / HERTZ,
        output=rb.Output(rate=40 * HERTZ),
    )
    return rb.simulate(case, progress=False)


def test_work_is_dissipation_and_storage_and_agrees_with_the_force() -> None:
    """The energy balance and force times velocity give the same work for a bed that falls and one that flies."""
    for acceleration, cycles, after in ((0.3, 8, 3), (6.0, 20, 10)):
        run = shaken(bed(), acceleration, cycles)
        found = module.cycle_loss(run, HERTZ, cycles - after)
        assert found.work == pytest.approx(found.dissipated + found.stored, rel=1e-9)
        harmonic = rb.analysis.shaken.harmonic_loss(run, frequency=HERTZ, after=after / HERTZ)  # type: ignore[attr-defined]
        forced, balanced = harmonic.loss_per_cycle.values
        assert balanced == pytest.approx(found.work, rel=1e-9)
        assert forced == pytest.approx(balanced, abs=0.02 * found.dissipated + 0.02 * found.scale)


def test_samples_beside_the_ends_of_cycles_change_little() -> None:
    """The work over whole cycles does not depend on whether cycles begin at samples."""
    run = shaken(bed(packing=rb.Settled(seed=2)), 0.3, 12)
    whole = cycle_loss(run, HERTZ, 5)
    other = cycle_loss(run, HERTZ * 1.0001, 5)
    assert other.work == pytest.approx(whole.work, abs=1e-3 * whole.scale)


def test_a_shaken_cavity_warns_of_a_bed_that_falls() -> None:
    """`shaken_cavity` gives the work in both ways, with a warning and the flag of unsteady motion."""
    run = shaken(bed(), 0.2, 12)
    with pytest.warns(UserWarning, match="not steady"):
        found = rb.analysis.shaken_cavity(run, frequency=HERTZ, after=2 / HERTZ)
    assert not found.steady and found.attrs["warnings"]
    assert float(found.raised_power) < 0 < float(found.dissipated_power)
    assert float(found.dissipated_power) > 20 * float(np.abs(found.active_power).max())


@pytest.mark.filterwarnings("ignore:at .*, which decides")
def test_maps_and_designs_flag_motions_that_are_not_steady() -> None:
    """Loss maps and designs have the flag "unsteady" where a bed still falls, and a note."""
    motion = rb.Harmonic(amplitude="2 m/s^2", frequency=HERTZ, direction="z")
    case = rb.Case(structure=rb.Shaker(motion=motion), damper=bed(), duration="1 s")
    early, late = (rb.loss_map(case, ["2 m/s^2"], [HERTZ], cycles=cycles, progress=False) for cycles in ((3, 10), None))
    names = early.warnings.attrs["flag_meanings"].split()
    bit = 2 ** names.index("unsteady")
    assert early.warnings.item() & bit and not late.warnings.item() & bit
    assert late.skipped_cycles.item() in (50, 100, 150, 200, 250) and "skipped_cycles" not in early
    assert abs(late.reduced_loss.item()) < 0.02

    design = rb.design(
        structure_with(bed()),
        {"damper.friction": [0.2, 0.4]},
        {"damping_ratio": "max"},
        amplitudes=levels(0.1, 0.2),
        way="shaking",
        cycles=(3, 10),
        packings=2,
        progress=False,
    )
    assert "not steady" in design.attrs["flagged"]
    assert (design.warnings.values & bit > 0).all()


@pytest.mark.parametrize(
    ("drift", "noise", "steady"), [(0, 1, True), (0.5, 0, False), (0.5, 1, False), (0.04, 0, True)]
)
def test_the_test_of_steadiness_of_series(drift: float, noise: float, steady: bool) -> None:
    """Trends above the limit are found in noise, at most 2 % of series without one are, and small trends do not matter."""
    rng = np.random.default_rng(3)
    found = []
    for _ in range(300):
        series = drift * np.arange(40) + noise * rng.standard_normal(40)
        found.append(module._matters((series[-1] - series[0]) / 39, 0.05, series))
    assert np.mean(found) == pytest.approx(0 if steady else 1, abs=0.02)


def test_one_slip_in_the_middle_is_found() -> None:
    """A bed that slips once within the evaluated cycles is not steady."""
    series = np.where(np.arange(41) < 17, 0.0, -8.0)
    assert module._matters(-8 / 40, 0.05, series)
    assert not module._matters(-8 / 40, 0.3, series)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("direction", "acceleration", "packings"), [("z", 2.5, 40), ("z", 7.0, 40), ("x", 0.4, 120), ("x", 2.0, 40)]
)
def test_intervals_of_a_few_packings_hold_the_mean_of_many(direction: str, acceleration: float, packings: int) -> None:
    """Intervals from two or three packings hold the mean of many in 86 % of cases or more, as documented.

    In a bed that is nearly locked (x, 0.4 m/s^2) a tenth of the packings lose twice as much as the others. Forty packings
    then determine the share only to 6 %: three groups of forty gave 85, 90 and 92 %, all of them together 88 %.
    """
    case = structure_with(bed(packing=rb.Settled(seed=1), direction=direction))
    found = rb.damping_curve(
        case, levels(acceleration, 1.01 * acceleration), way="shaking", packings=packings, progress=False
    )
    values = found.damping_ratios.values[:, 0]
    rng = np.random.default_rng(5)
    for count in (2, 3):
        draws = np.array([rng.choice(values, count, replace=False) for _ in range(2000)])
        half = stdtrit(count - 1, 0.975) * draws.std(axis=1, ddof=1) / math.sqrt(count)
        assert np.mean(np.abs(draws.mean(axis=1) - values.mean()) <= half) > 0.86
