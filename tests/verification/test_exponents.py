"""All Lyapunov exponents, and studies that start on a periodic motion, against independent results."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.basin_stability import _interval
from rattlebox.studies.orbits.find import _end_of
from rattlebox.studies.orbits.forcing import Forcing
from rattlebox.studies.orbits.orbit import Orbit

BALL = rb.Sphere(radius="14 mm", material="steel")


def on_spring(restitution: float = 0.6, **others: Any) -> rb.Case:
    """Return an oscillator with a ball under a harmonic load."""
    settings: dict[str, Any] = {"method": rb.Newton(), "duration": "3 s"} | others
    return rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(ball=BALL, gap="1 mm", contact=rb.Tsuji(restitution=restitution)),
        load=rb.Harmonic(amplitude="5 N", frequency="33 Hz"),
        **settings,
    )


def on_shaker(restitution: float = 0.9, amplitude: str = "2 mm", **others: Any) -> rb.Case:
    """Return a ball in a shaken cavity."""
    settings: dict[str, Any] = {"method": rb.Newton(), "duration": "1 s"} | others
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=amplitude, frequency="10 Hz")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=restitution)
        ),
        **settings,
    )


def test_exponents_of_a_periodic_motion_are_those_of_its_multipliers() -> None:
    """Pairs share the logarithm of the absolute value of their multipliers, for hard and soft impacts."""
    for method in (rb.Newton(), rb.EventDriven()):
        orbit = rb.find_orbit(on_spring(method=method))
        found = rb.lyapunov_spectrum(orbit, cycles=(0, 100)).exponent.values
        exact = np.log(np.abs(orbit.multipliers)) / orbit.period
        # A frame turns at changing speed within a pair, of which the mean is exact.
        assert found.reshape(2, 2).mean(axis=1) == pytest.approx(exact[::2], rel=1e-6)
        assert found == pytest.approx(exact, rel=1e-2)


def test_sum_of_exponents_is_the_loss_of_volume_at_hard_impacts() -> None:
    """The mean of ln det M over the evaluated cycles is that of damping and impacts, also in chaos."""
    case = on_shaker()
    cycles = 400
    found = rb.lyapunov_spectrum(case, cycles=(100, cycles))
    run = rb.simulate(case.replaced({"duration": f"{(120 + cycles) / 10} s"}), progress=False)
    times = run.impacts.time.values
    hits = np.sum((times >= 12.0) & (times < 12.0 + cycles / 10))
    rule = 2 * hits * math.log(0.9) / (cycles / 10)
    assert found["sum"].item() == pytest.approx(rule, rel=0.05)
    assert found.attrs["left_out"] == 0
    assert ("too_short" in found.attrs) == bool(np.isnan(found.exponent_interval).any())
    assert 1 < found.dimension.item() < 2


def test_largest_exponent_agrees_with_pairs_of_neighbours() -> None:
    """Chaotic motion of hard and soft balls: both methods agree within their errors."""
    for method in (rb.Newton(), rb.EventDriven()):
        case = on_shaker(method=method)
        spectrum = rb.lyapunov_spectrum(case, cycles=(100, 600))
        pairs = rb.lyapunov(case, cycles=(100, 600), pairs=8, progress=False)
        largest, half = spectrum.exponent.values[0], spectrum.exponent_interval.values[0]
        assert largest > 5
        assert abs(largest - float(pairs.exponent)) < half + 3 * float(pairs.standard_error)


def test_studies_take_a_periodic_motion_as_their_start() -> None:
    """The motion stays on the orbit from the first cycle, where the case itself has a transient."""
    case = on_spring()
    orbit = rb.find_orbit(case)
    amplitude = orbit.amplitudes["mass"]
    options: dict[str, Any] = {"cycles": (0, 4), "direction": "up", "progress": False}
    on = rb.frequency_response(orbit, ["33 Hz"], **options)
    off = rb.frequency_response(case, ["33 Hz"], **options)
    assert on.peak.item() == pytest.approx(amplitude, rel=3e-3)  # of 64 samples a cycle
    assert abs(off.peak.item() / amplitude - 1) > 0.1
    largest = rb.lyapunov(orbit, cycles=(20, 40), pairs=2, progress=False).exponent.item()
    assert largest == pytest.approx(math.log(abs(orbit.multipliers[0])) / orbit.period, rel=2e-3)
    starts = rb.basins(orbit, {"damper.velocity": [orbit.as_case().impact_dampers[0].velocity[0]]}, cycles=(0, 8))
    assert starts.motion.item() == 1


def test_studies_start_on_one_of_two_motions() -> None:
    """Where a motion with impacts and one without them are both stable, each study stays on the one that is given.

    The studies had started on the only motion, to which a run from rest leads as well.
    """
    resting = rb.Case(
        structure=rb.SDOF(mass="1.5 kg", frequency="25 Hz", damping_ratio=0.01),
        damper=rb.ImpactDamper(ball=BALL, gap="1 mm", contact=rb.Tsuji(restitution=0.6)),
        load=rb.Harmonic(amplitude="3 N", frequency="25.5 Hz"),
        method=rb.Newton(),
        duration="4 s",
    )
    branch = rb.continue_orbit(rb.find_orbit(resting), "load.frequency", ("25.4 Hz", "28 Hz"), progress=False)
    rows = branch.data.where((branch.data.value > 27) & branch.data.stable.astype(bool), drop=True)
    hertz = [float(value) for value in rows.value.values[:3]]
    orbit = branch.orbit(int(np.flatnonzero(branch.data.value.values == hertz[0])[0]))
    at = resting.replaced({"load.frequency": hertz[0]})
    options: dict[str, Any] = {"cycles": (150, 8), "direction": "up", "progress": False}
    on = rb.frequency_response(orbit, hertz, **options).isel(direction=0, level=0)
    off = rb.frequency_response(at, hertz, **options).isel(direction=0, level=0)
    assert on.impacts_per_cycle.values == pytest.approx([2] * 3) and off.impacts_per_cycle.values == pytest.approx(
        [0] * 3
    )
    assert on.peak.values == pytest.approx(rows.amplitude.values[:3, 0], rel=3e-3)
    assert (off.peak.values > 1.5 * on.peak.values).all()
    largest = [rb.lyapunov(each, cycles=(60, 60), pairs=2, progress=False).exponent.item() for each in (orbit, at)]
    assert largest[0] == pytest.approx(math.log(abs(orbit.multipliers[0])) / orbit.period, rel=2e-2)
    assert abs(largest[1] / largest[0] - 1) > 0.1
    speed = orbit.as_case().impact_dampers[0].velocity[0]
    for case, start, impacts in ((orbit, speed, 2), (at, 0.0, 0)):
        found = rb.basins(case, {"damper.velocity": [start]}, cycles=(150, 8), progress=False)
        assert found.impacts_per_cycle.values == pytest.approx([impacts]) and found.period.values.tolist() == [1]


@pytest.mark.parametrize(
    "structure",
    [
        rb.ShearBuilding(masses=["1 kg", "1 kg"], stiffnesses=["40 kN/m", "40 kN/m"], damping_ratio=0.02),
        rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.02),
    ],
)
@pytest.mark.parametrize("tuned", [False, True])
def test_case_that_starts_on_a_motion_repeats_it(structure: Any, tuned: bool) -> None:
    """Structures of modes, tuned masses, rows and several dampers start where the motion is."""
    point = "mass" if isinstance(structure, rb.SDOF) else "storey 2"
    balls = [rb.Sphere(radius="10 mm", material="steel"), rb.Sphere(radius="14 mm", material="steel")]
    dampers = [
        rb.ImpactDamper(balls=balls, gap="0.6 mm", contact=rb.Tsuji(restitution=0.5), point=point),
        rb.ImpactDamper(ball=BALL, gap="1 mm", contact=rb.Tsuji(restitution=0.6), point=point, number=2),
    ]
    case = rb.Case(
        structure=structure,
        dampers=dampers,
        load=rb.Harmonic(amplitude="8 N", frequency="19 Hz", point=point),
        method=rb.Newton(),
        duration="1 s",
        **(
            {"tuned_mass": rb.TunedMass(mass="50 g", frequency="25 Hz", damping_ratio=0.1, point=point)}
            if tuned
            else {}
        ),
    )
    run = rb.simulate(case, progress=False)
    time, state = _end_of(run, math.inf)
    forcing = Forcing.of(case)
    phase = time / forcing.period % 1.0
    nan = np.zeros(0)
    orbit = Orbit(case, 1, forcing.period, state, phase, 0.0, nan, (), None, False, {}, math.nan, False)
    again = rb.simulate(orbit.as_case().replaced({"duration": f"{forcing.period!r} s"}), progress=False)
    expected = orbit.run(1)
    for name in ("ball_position", "ball_velocity"):
        one, other = getattr(again.arrays, name), getattr(expected.arrays, name)
        assert one == pytest.approx(other, rel=0, abs=1e-9 * np.abs(other).max())
    assert again.impacts.sizes == expected.impacts.sizes


def test_basin_stability_counts_the_starts_that_return() -> None:
    """The interval of random starts holds the share of a fine grid of starts."""
    orbit = rb.find_orbit(on_shaker(0.5, "0.8 mm", duration="20 s"))
    region = {"damper.start": (-1, 1), "damper.velocity": ("-0.2 m/s", "0.2 m/s")}
    grid = {"damper.start": rb.linspace(-1, 1, 41), "damper.velocity": rb.linspace("-0.2 m/s", "0.2 m/s", 41)}
    found = rb.basin_stability(orbit, region, 300, cycles=(300, 16), progress=False)
    fine = rb.basins(orbit, grid, cycles=(300, 16), progress=False)
    assert 0 <= found.lower <= found.share <= found.upper <= 1
    assert found.count == 300
    share = float(fine.share.max())
    assert found.lower - 0.02 <= share <= found.upper + 0.02


def test_binomial_interval_holds_in_95_percent() -> None:
    """The interval of Clopper and Pearson contains the planted probability in at least 95 % of all outcomes."""
    from scipy.stats import binom

    for count, p in ((20, 0.3), (200, 0.02), (200, 0.5), (500, 0.97)):
        holds = [lower <= p <= upper for lower, upper in (_interval(k, count) for k in range(count + 1))]
        assert binom.pmf(np.arange(count + 1), count, p)[holds].sum() >= 0.95


def test_unstable_motion_has_no_basin() -> None:
    """The refusal names the kind of stability."""
    stable = rb.find_orbit(on_spring())
    unstable = dataclasses.replace(stable, multipliers=np.array([-1.4 + 0j, 0.2, 0.1, 0.1]))
    with pytest.raises(rb.CaseError, match="only stable motions have a basin"):
        rb.basin_stability(unstable, {"damper.start": (-1, 1)}, 10)


def test_exponents_refuse_what_has_no_period() -> None:
    """Loads without a common period and particle dampers are refused with what to do instead."""
    with pytest.raises(rb.CaseError, match="harmonic"):
        rb.lyapunov_spectrum(rb.reference_case(duration="0.1 s"))
