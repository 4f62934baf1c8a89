"""The three ways to a damping curve agree, with each other and with what is known."""

import math
import warnings
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

LEVELS = [2e-4, 4e-4, 8e-4]


@pytest.mark.parametrize("way", ["decay", "energy", "shaking"])
@pytest.mark.parametrize(
    "structure",
    [
        rb.SDOF(mass=3, frequency=50, damping_ratio=0.02),
        rb.Beam(length="0.4 m", width="30 mm", height="20 mm", material="steel", damping_ratio=0.02),
    ],
    ids=["sdof", "beam"],
)
def test_a_linear_damper(way: Any, structure: Any) -> None:
    """A tuned mass far below the mode adds its closed-form damping, by each of the three ways to 1 %."""
    point = "mass" if structure.kind == "sdof" else "tip"
    modes = structure.modes()
    frequency = math.sqrt(modes.stiffness[0]) / (2 * math.pi)
    tuned = rb.TunedMass(
        mass=0.01 / modes.shape(point)[0] ** 2, frequency=0.3 * frequency, damping_ratio=0.8, point=point
    )
    case = rb.Case(structure=structure, tuned_mass=tuned, duration=40 / frequency)
    result = rb.damping_curve(case, LEVELS, way=way, packings=1, point=point)
    impedance = 0.09 + 0.48j  # stiffness of the tuned mass over m w^2
    added = -0.01 / 2 * (impedance / (impedance - 1)).imag
    np.testing.assert_allclose(result.damping_ratio, 0.02 + added, rtol=0.01)
    np.testing.assert_allclose(result.bare, 0.02)


def ball_case(**options: Any) -> rb.Case:
    """Return a ball on a lightly damped structure."""
    return rb.Case(
        structure=rb.SDOF(mass="3 kg", frequency="50 Hz", damping_ratio=0.005),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="11 mm", material="steel"), gap="0.5 mm", contact=rb.Tsuji(restitution=0.5)
        ),
        duration="2 s",
        **options,
    )


@pytest.mark.parametrize(("mass", "agreement"), [(30.0, 0.005), (10.0, 0.012), (3.0, 0.035)], ids=["700", "230", "70"])
def test_one_ball_by_three_ways(mass: float, agreement: float) -> None:
    """Decay and energy agree, and shaking to the interval and the change within half a cycle, which grows with the ball."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="11 mm", material="steel"), gap="0.5 mm", contact=rb.Tsuji(restitution=0.5)
    )
    case = rb.Case(structure=rb.SDOF(mass=mass, frequency=50, damping_ratio=0.001), damper=damper, duration="4 s")
    levels = [2.4e-4, 2.7e-4, 3e-4, 3.4e-4]
    result = {way: rb.damping_curve(case, levels, way=way, packings=4) for way in ("decay", "energy", "shaking")}
    decay = result["decay"]
    assert np.all(decay.damping_ratio > 0.0016)
    for way, share in (("energy", 0.5), ("shaking", 1.0)):
        other = result[way]
        difference = abs(other.damping_ratio - decay.damping_ratio)
        interval = (decay.upper - decay.lower + other.upper - other.lower) / 2
        np.testing.assert_array_less(difference, interval + share * decay.quasi_steady_error)
        np.testing.assert_array_less(difference, share * agreement * decay.damping_ratio)


def test_coexisting_motions_are_covered_by_the_interval() -> None:
    """Where a ball has two steady motions, the interval of the shaken one covers the one that a decay follows."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="11 mm", material="steel"), gap="0.5 mm", contact=rb.Tsuji(restitution=0.8)
    )
    case = rb.Case(structure=rb.SDOF(mass=30, frequency=50, damping_ratio=0.001), damper=damper, duration="6 s")
    decay, shaking = (rb.damping_curve(case, [2.5e-4, 3.2e-4, 4e-4], way=way) for way in ("decay", "shaking"))
    allowed = (decay.upper - decay.lower + shaking.upper - shaking.lower) / 2 + 0.005 * decay.damping_ratio
    np.testing.assert_array_less(abs(decay.damping_ratio - shaking.damping_ratio), allowed)


@pytest.mark.parametrize("way", ["decay", "energy"])
@pytest.mark.parametrize("ratio", [0.03, 0.15])
def test_strong_damping(way: Any, ratio: float) -> None:
    """The initial amplitude is raised until the highest level is passed after the first cycles."""
    case = rb.Case(structure=rb.SDOF(mass=3, frequency=50, damping_ratio=ratio), duration="1 s")
    result = rb.damping_curve(case, LEVELS, way=way, packings=1)
    error = {"decay": 1e-4, "energy": 0.3 * ratio}[way]  # two steps a cycle
    np.testing.assert_allclose(result.damping_ratio, ratio, rtol=error)
    assert not result.attrs["warnings"]


def test_a_fast_decay_is_warned_of() -> None:
    """A ratio that changes within half a cycle is flagged, since steady vibration differs there."""
    case = ball_case().model_copy(update={"structure": rb.SDOF(mass=1, frequency=50, damping_ratio=0.001)})
    result = rb.damping_curve(case, [2.4e-4, 3e-4])
    assert any("half a cycle" in warning for warning in result.attrs["warnings"])


def test_too_small_a_motion_is_only_the_structures() -> None:
    """Where the ball does not reach its walls, the damping is that of the structure."""
    result = rb.damping_curve(ball_case(), [1e-5, 2e-5, 4e-5], packings=3)
    np.testing.assert_allclose(result.damping_ratio[:1], 0.005, rtol=0.05)


def test_particles() -> None:
    """A bed under gravity adds damping; the interval covers the scatter of its packings."""
    case = rb.Case(
        structure=rb.SDOF(mass="0.5 kg", frequency="40 Hz", damping_ratio=0.005),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=30),
            cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
            contact=rb.Tsuji(restitution=0.6),
            friction=0.2,
            packing=rb.Settled(seed=1),
            softening=1000,
        ),
        duration="1 s",
    )
    levels = [4e-4, 6e-4, 8e-4]
    result = rb.damping_curve(case, levels, packings=2)
    assert np.all(result.damping_ratio > 1.5 * result.bare)
    assert result.damping_ratios.sizes == {"packing": 2, "amplitude": 3}
    assert np.all(result.lower <= result.damping_ratio)
    soft = rb.damping_curve(case.model_copy(update={"duration": 0.3}), [4e-5, 6e-5], packings=1).attrs["warnings"]
    assert any("softening" in warning or "resonance" in warning for warning in soft), soft
    assert result.damping_ratio.attrs["units"] == "1" and result.amplitude.attrs["units"] == "m"


def test_the_weight_of_a_settling_bed_is_no_damping() -> None:
    """A thrown bed dissipates the work of its weight as it settles, which "energy" does not count as a loss of the mode."""
    case = rb.Case(
        structure=rb.SDOF(mass="0.1 kg", frequency="80 Hz", damping_ratio=0.005),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=30),
            cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
            contact=rb.Tsuji(restitution=0.6),
            friction=0.2,
            direction="z",
            packing=rb.Settled(seed=1),
            softening=1000,
        ),
        duration="0.3 s",
    )
    decay, energy = (rb.damping_curve(case, [4.5e-5, 7e-5, 1e-4], way=way, packings=2) for way in ("decay", "energy"))
    np.testing.assert_allclose(energy.damping_ratios, decay.damping_ratios, rtol=0.1)


def test_a_start_that_is_not_random_has_no_scatter() -> None:
    """Amplitudes that the decay does not pass are NaN; one packing has no interval."""
    case = rb.Case(structure=rb.SDOF(mass=3, frequency=50, damping_ratio=0.02), duration="0.3 s")
    result = rb.damping_curve(case, [1e-5, 5e-4, 1e-3], packings=1)
    assert np.isnan(result.damping_ratio[0]) and np.isfinite(result.damping_ratio[2])
    assert ["10.00 µm" in warning for warning in result.attrs["warnings"]] == [True]
    assert np.isnan(result.lower).all()


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"amplitudes": [1e-4]}, "amplitudes"),
        ({"amplitudes": "1 mm"}, "amplitudes"),
        ({"amplitudes": [2e-4, 1e-4]}, "amplitudes"),
        ({"way": "guess"}, "way"),
        ({"mode": 2}, "mode"),
        ({"point": "tip"}, "tip"),
        ({"packings": 0}, "packings"),
    ],
)
def test_bad_arguments(change: dict[str, Any], word: str) -> None:
    """The message names the argument."""
    with pytest.raises(rb.CaseError, match=word):
        rb.damping_curve(ball_case(), **{"amplitudes": LEVELS, **change})


def test_modal_takes_any_structure() -> None:
    """Modal.of gives the same motion as the structure whose modes it takes, coupled damping included."""
    own = rb.Matrices(
        M=[[2, 0], [0, 1]], C=[[0, 0], [0, 9]], K=[[3e4, -1e4], [-1e4, 1e4]], points={"tip": 1}, velocity=[0, 1]
    )
    runs = [
        rb.simulate(rb.Case(structure=s, duration=0.5, output=rb.Output(rate=100)))
        for s in (own, rb.Modal.of(own.modes()))
    ]
    np.testing.assert_allclose(runs[0].motion.displacement, runs[1].motion.displacement, atol=1e-15)


def test_a_mode_that_is_not_there_names_those_that_are() -> None:
    """Modes are counted from 1, also in messages."""
    structure = rb.Modal(frequencies=[20.0, 90.0], damping_ratio=0.01, shapes={"tip": [1.0, 0.1]})
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="8 mm", material="steel"), gap="50 um", contact=rb.Tsuji(restitution=0.5)
    )
    case = rb.Case(structure=structure, damper=damper, duration="1 s")
    with pytest.raises(rb.CaseError, match=r"one of these: 1, 2$"):
        rb.damping_curve(case, [2e-4, 3e-4], mode=3)


def test_a_mode_is_told_from_others_that_impacts_excite() -> None:
    """The decay of the second mode is that of its own coordinate, even where the first mode moves the point more."""
    structure = rb.Modal(
        frequencies=[20.0, 90.0], damping_ratios=[0.002, 0.02], shapes={"tip": [1.0, 0.1]}, participation=[1.0, 0.1]
    )
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="8 mm", material="steel"), gap="50 um", contact=rb.Tsuji(restitution=0.5)
    )
    case = rb.Case(structure=structure, damper=damper, duration="1 s")
    result = rb.damping_curve(case, [2e-4, 3e-4, 4e-4], mode=2, packings=1)
    np.testing.assert_allclose(result.damping_ratio, 0.02, rtol=0.25)
    assert not result.attrs["warnings"]


def test_a_heavy_damper_that_changes_the_motion_is_warned_of() -> None:
    """A tuned mass as heavy as the structure shifts the frequency, and the curve has a note."""
    structure = rb.SDOF(mass=3, frequency=50, damping_ratio=0.005)
    tuned = rb.TunedMass(mass=3, frequency=50, damping_ratio=0.02)
    result = rb.damping_curve(rb.Case(structure=structure, tuned_mass=tuned, duration="2 s"), LEVELS, packings=1)
    assert any("Hz" in warning for warning in result.attrs["warnings"])


@pytest.mark.parametrize("way", ["decay", "shaking"])
def test_backends(way: Any) -> None:
    """Processes and one or several threads give the same bits."""
    first = rb.damping_curve(ball_case(), LEVELS, way=way, packings=3, cycles=(5, 10), workers=1)
    for options in ({"workers": 3}, {"workers": 2, "backend": "processes"}):
        again = rb.damping_curve(ball_case(), LEVELS, way=way, packings=3, cycles=(5, 10), **options)
        assert again.identical(first)
    with pytest.raises(rb.CaseError, match="backend"):
        rb.damping_curve(ball_case(), LEVELS, backend="cluster")


def test_the_interval_covers_random_starts() -> None:
    """Intervals of four starts hold the mean of forty at nearly all amplitudes."""
    levels = np.geomspace(1e-4, 4e-4, 4)
    many = rb.damping_curve(ball_case(), levels, packings=40)
    inside = []
    for seed in range(8):
        few = rb.damping_curve(ball_case(seed=seed), levels, packings=4)
        inside += [*((few.lower < many.damping_ratio) & (many.damping_ratio < few.upper)).values]
    assert np.mean(inside) > 0.75


def test_shaking_is_the_damping_of_a_forced_vibration() -> None:
    """A structure under a steady harmonic force loses what the ratio of "shaking" at its amplitude gives."""
    frequency, mass = 49.6, 3.0
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="11 mm", material="steel"), gap="0.5 mm", start=0.9, contact=rb.Tsuji(restitution=0.5)
    )
    structure = rb.SDOF(mass=mass, frequency=50, damping_ratio=0.03)
    omega = 2 * math.pi * frequency
    load = rb.Harmonic(amplitude=2 * 0.038 * mass * omega**2 * 3e-4, frequency=frequency)
    run = rb.simulate(
        rb.Case(structure=structure, damper=damper, load=load, duration="3 s", output=rb.Output(rate=4000))
    )
    late = run.motion.time >= 2.0
    motion = run.motion.displacement.sel(point="mass").values[late]
    amplitude = abs(2 * np.mean((motion * np.exp(-1j * omega * run.motion.time.values[late]))[:-1]))
    lost = float(np.ptp(run.energy.losses.values[late])) / frequency
    curve = rb.damping_curve(
        rb.Case(structure=structure, damper=damper, duration="1 s"), np.array([0.97, 1.03]) * amplitude, way="shaking"
    )
    assert amplitude > 2.6e-4
    viscous = 2 * math.pi * mass * (2 * math.pi * 50) * omega * amplitude**2  # loss in a cycle of a dashpot of ratio 1
    assert lost / viscous == pytest.approx(float(curve.damping_ratio.mean()), rel=0.006)


@pytest.mark.parametrize(
    ("number", "mass", "share"), [(1, "0.25 kg", ""), (3, "0.15 kg", "15 %"), (1, "0.6 kg", "20 %")]
)
def test_heavy_dampers_have_a_warning(number: int, mass: str, share: str) -> None:
    """Shaking neglects that dampers lower the frequency, which the docstring alone said, however heavy they were."""
    ball = rb.Striker(mass=mass, radius="12 mm")
    damper = rb.ImpactDamper(ball=ball, number=number, gap="0.8 mm", contact=rb.Tsuji(restitution=0.5))
    structure = rb.Modal(
        frequencies=["40 Hz"], shapes={"tip": [3**-0.5]}, damping_ratios=[0.01]
    )  # 3 kg move with the tip
    case = rb.Case(structure=structure, damper=damper, duration="1 s")
    curve = rb.damping_curve(case, ["0.2 mm", "0.5 mm"], way="shaking", packings=1, cycles=(5, 10), progress=False)
    found = [text for text in curve.attrs["warnings"] if "mass that moves in the mode" in text]
    assert len(found) == bool(share)
    assert share in "".join(found)


def test_a_design_counts_the_cycles_that_are_given() -> None:
    """The damping ratio of a design is the smallest of its curve with the same cycles at each amplitude."""
    case, levels = ball_case(), ["0.3 mm", "0.4 mm"]
    options: dict[str, Any] = {"way": "shaking", "cycles": (5, 10), "packings": 1}
    found = rb.design(case, {"damper.gap": ["0.5 mm"]}, "damping_ratio", amplitudes=levels, trials=1, **options)
    assert found["damping_ratio"].item() == rb.damping_curve(case, levels, **options).damping_ratio.min().item()


@pytest.mark.parametrize("way", ["decay", "energy"])
def test_any_frequency_and_duration(way: Any) -> None:
    """The ratio of a linear structure is exact for any frequency and duration; earlier tests had 50 Hz and whole seconds."""
    rng = np.random.default_rng(7)
    for frequency in [51.3, 10.0658, 33.33, *10 ** rng.uniform(-0.5, 3.0, 12)]:
        structure = rb.SDOF(mass=4.7, frequency=frequency, damping_ratio=0.012)
        case = rb.Case(structure=structure, duration=rng.uniform(40, 60) / frequency)
        result = rb.damping_curve(case, LEVELS, way=way, packings=1, progress=False)
        np.testing.assert_allclose(result.damping_ratio, 0.012, rtol=1e-4 if way == "decay" else 6e-3)


def test_a_ball_at_any_frequency() -> None:
    """The ratio of a ball damper depends on frequency, gap and mass only through the amplitude over the gap."""
    rng = np.random.default_rng(8)
    found = []
    for frequency in [40.0, *rng.uniform(7, 300, 6)]:
        damper = rb.ImpactDamper(
            ball=rb.Sphere(radius="9 mm", material="steel"), gap="0.37 mm", contact=rb.Tsuji(restitution=0.5)
        )
        structure = rb.SDOF(mass=2.1, frequency=frequency, damping_ratio=0.004)
        case = rb.Case(structure=structure, damper=damper, duration=70.3 / frequency, method=rb.Newton())
        found.append(rb.damping_curve(case, ["0.1 mm", "0.2 mm"], packings=2, progress=False).damping_ratio.values)
    np.testing.assert_allclose(found, np.broadcast_to(found[0], np.shape(found)), rtol=2e-4)


def test_amplitudes_may_be_accelerations() -> None:
    """Accelerations are those at the frequency of the mode, as in a ring-down; "1 g" was refused as a mass."""
    levels = ["3 g", "3.3 g", "36 m/s^2"]
    place = [each * 9.80665 / (100 * math.pi) ** 2 for each in (3, 3.3, 36 / 9.80665)]
    options: dict[str, Any] = {"packings": 2, "progress": False}
    found, same = (rb.damping_curve(ball_case(), each, **options) for each in (levels, place))
    np.testing.assert_allclose(found.amplitude, place, rtol=1e-12)
    np.testing.assert_allclose(found.damping_ratios, same.damping_ratios, rtol=1e-6)
    spaced = rb.damping_curve(ball_case(), rb.geomspace("3 g", "36 m/s^2", 3), **options)
    np.testing.assert_allclose(spaced.amplitude[[0, 2]], [place[0], place[2]], rtol=1e-12)
    with pytest.raises(rb.CaseError, match=r"a length \(m\) or an acceleration .* is needed, not a mass"):
        rb.damping_curve(ball_case(), ["1 kg", "2 kg"])
    with pytest.raises(rb.CaseError, match="'2 g' is an acceleration") as caught:
        rb.design(ball_case(), {"structure.mass": ["2 kg", "3 kg"]}, "damping_ratio", amplitudes=["2 g", "3 g"])
    assert "'0.199 mm' at 50 Hz" in caught.value.suggestion
    assert (100 * math.pi) ** 2 * 199e-6 == pytest.approx(2 * 9.80665, rel=5e-3)
    options |= {"amplitudes": ["3 g", "3.3 g"]}
    designs = [
        rb.design(ball_case(), {"damper.gap": ["0.4 mm", "0.5 mm"]}, "damping_ratio", **options | more)
        for more in ({}, {"amplitudes": place[:2]})
    ]
    np.testing.assert_allclose(designs[0].damping_ratio, designs[1].damping_ratio, rtol=1e-6)


def test_amplitudes_in_metres_are_noted() -> None:
    """Bare numbers for g or mm are metres, and metres at a natural frequency have a warning; with a unit it is gone.

    Earlier tests wrote all amplitudes with a unit or in small numbers.
    """
    from rattlebox.studies.damping_curve import read_amplitudes

    for levels in ([0.5, 1, 2], rb.geomspace(0.5, 2, 3)):
        with pytest.warns(UserWarning, match=r"amplitudes reach 2.* at 50.00 Hz, .* and 2.01e\+04 g; .* is in m here"):
            read_amplitudes(levels, 100 * math.pi)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_amplitudes(["0.5 g", "2 g"], 100 * math.pi)
        read_amplitudes(["0.5 mm", "2 mm"], 100 * math.pi)


def test_the_drift_is_the_change_between_the_halves_of_the_cycles() -> None:
    """The drift of shaken motions is the change between curves over the first and the second half of the cycles."""
    options: dict[str, Any] = {"way": "shaking", "packings": 3, "progress": False}
    whole, first, second = (
        rb.damping_curve(ball_case(), LEVELS, cycles=n, **options) for n in ((1, 8), (1, 4), (5, 4))
    )
    change = second.damping_ratios - first.damping_ratios
    assert float(abs(change).max()) > 1e-3
    np.testing.assert_allclose(whole.drift, change, atol=1e-6)
    assert "drift" not in rb.damping_curve(ball_case(), LEVELS, packings=1, progress=False)


@pytest.mark.parametrize("study", ["backbone", "decay", "energy"])
def test_equal_starts_are_run_once(study: Any) -> None:
    """Without dampers all starts are equal: one of them is run, and its values are those of all.

    Results were right, so that no test noticed that the same runs were made four times.
    """
    structure = rb.SDOF(mass=3, frequency=50, damping_ratio=0.01)
    counts: list[int] = []
    seen: dict[str, Any] = {"progress": lambda done, total: counts.append(total) or True}
    levels = ["0.4 mm", "0.7 mm"]
    if study == "backbone":
        stop = rb.Stop(gap="0.5 mm", contact=rb.Linear(stiffness="0.3 MN/m", restitution=0.6))
        load = rb.Harmonic(amplitude="1 N", frequency="50 Hz")
        case = rb.Case(structure=structure, stop=stop, load=load, duration="1 s")
        found, one = (rb.backbone(case, levels, starts=number, **seen) for number in (4, 1))
        assert found.frequencies.shape == (4, 2) and bool(found.found.all())
        assert np.array_equal(found.frequencies, np.repeat(one.frequencies, 4, axis=0))
    else:
        case = rb.Case(structure=structure, duration="1 s")
        found, one = (rb.damping_curve(case, levels, way=study, packings=number, **seen) for number in (4, 1))
        assert np.array_equal(found.damping_ratios, np.repeat(one.damping_ratios, 4, axis=0))
    assert max(counts) == (2 if study == "backbone" else 1)


@pytest.mark.parametrize("way", ["decay", "shaking"])
def test_amplitudes_are_those_of_the_damper(way: Any) -> None:
    """Without a point the amplitudes are those of the damper's one; on structures with several it had to be named.

    All tests of them named it.
    """
    case = rb.Case(
        structure=rb.Beam(length="0.3 m", diameter="20 mm", material="steel", damping_ratio=0.01, mode_count=1),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(diameter="12 mm", material="steel"),
            gap="0.3 mm",
            contact=rb.Tsuji(restitution=0.6),
            point="middle",
        ),
        duration="0.5 s",
    )
    options = {"way": way, "packings": 2, "progress": False}
    given = rb.damping_curve(case, ["0.1 mm", "0.2 mm"], point="middle", **options)
    assert rb.damping_curve(case, ["0.1 mm", "0.2 mm"], **options).equals(given)
    with pytest.raises(rb.CaseError, match="a point must be named"):
        rb.damping_curve(case.replaced({"dampers": ()}), ["0.1 mm", "0.2 mm"], **options)
