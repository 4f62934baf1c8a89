"""Responses from a loss map: exact for constant masses, all coexisting motions, simulations, limits, refused arguments."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import rattlebox as rb
from rattlebox.analysis.describing_function import MassTable, solve

AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"
OSCILLATOR = rb.SDOF(mass="3 kg", frequency="32 Hz", damping_ratio=0.005)


def made_map(mass: Any, amplitudes: Any = None, frequencies: Any = (5.0, 200.0), unit: str = "m") -> xarray.Dataset:
    """Return a map with the masses of a function of amplitude and frequency."""
    amplitudes = np.geomspace(1e-7, 1.0, 21) if amplitudes is None else np.asarray(amplitudes)
    values = np.array([[complex(mass(a, f)) for f in frequencies] for a in amplitudes])
    axes = (AMPLITUDE, FREQUENCY)
    return xarray.Dataset(
        {"effective_mass": (axes, values.real), "damping_mass": (axes, -values.imag)},
        {
            AMPLITUDE: (AMPLITUDE, amplitudes, {"units": unit}),
            FREQUENCY: (FREQUENCY, list(frequencies), {"units": "Hz"}),
        },
    )


def chain() -> rb.Matrices:
    """Return three masses with damping that couples their modes."""
    k = 60e3
    stiffness = [[2 * k, -k, 0], [-k, 2 * k, -k], [0, -k, k]]
    damping = [[6.3, -3, 0], [-3, 6, -3], [0, -3, 4.2]]
    return rb.Matrices(
        M=np.diag([2.0, 1.5, 1.0]).tolist(), C=damping, K=stiffness, points={"foot": 0, "middle": 1, "top": 2}
    )


def test_constant_mass_is_a_linear_structure() -> None:
    """A damper of constant apparent mass gives the response of the matrices with that mass and damping."""
    mass = 0.05 - 0.02j
    structure, hertz = chain(), np.linspace(10, 70, 61)
    for at in ("top", ("middle", "top")):
        found = rb.response_from_map(
            structure,
            made_map(lambda *_: mass),
            level="3 N",
            number=2,
            at=at,
            load_point="foot",
            frequencies=hertz.tolist(),
        )
        assert found.amplitude.sizes == {"at": 1, "number": 1, "level": 1, "frequency": 61, "solution": 1}
        assert found.damping_ratio.sizes == {"at": 1, "number": 1, "mode": 3, "map_amplitude": 21}
        matrices = structure.matrices()
        for k, omega in enumerate(2 * np.pi * hertz):
            inertia = matrices[0].astype(complex)
            for name in (at,) if isinstance(at, str) else at:
                inertia[structure.points[name], structure.points[name]] += 2 * mass
            dynamic = matrices[2] + 1j * omega * matrices[1] - omega**2 * inertia
            observed = structure.points[at if isinstance(at, str) else at[0]]
            exact = np.linalg.solve(dynamic, [3, 0, 0])[observed]
            one = found.isel(at=0, number=0, level=0, frequency=k, solution=0)
            assert one.amplitude * np.exp(1j * one.phase) == pytest.approx(exact, rel=1e-6)
        assert (found.solutions == 1).all()
        assert float(found.interpolation_error.max()) < 1e-9


@pytest.mark.parametrize("axis", [AMPLITUDE, FREQUENCY])
def test_the_interpolation_error_is_the_change_without_every_second_value(axis: str) -> None:
    """A map that is too coarse along one axis has an error, that of the response from the map without its middle value."""
    amplitudes, frequencies = (
        ([1e-7, 1e-4, 1.0], [5.0, 200.0]) if axis == AMPLITUDE else ([1e-7, 1.0], [5.0, 32.0, 200.0])
    )
    whole = made_map(lambda a, f: (0.05 - 0.02j) * (2 if a == 1e-4 or f == 32 else 1), amplitudes, frequencies)
    options: dict[str, Any] = {"level": "1 N", "frequencies": np.linspace(25, 40, 31).tolist()}
    found, thin = (rb.response_from_map(OSCILLATOR, table, **options) for table in (whole, whole.isel({axis: [0, 2]})))
    change = np.abs(thin.amplitude.max("solution") / found.amplitude.max("solution") - 1)
    assert float(change.max()) > 0.1
    np.testing.assert_allclose(found.interpolation_error, change, rtol=1e-6)
    np.testing.assert_allclose(found.peak_interpolation_error, np.abs(thin.peak / found.peak - 1), rtol=1e-6)


def test_base_motion_of_a_point_in_3d() -> None:
    """The dampers move along one direction of a structure in 3-D; base and observed point have theirs."""
    shape = [[0.5, 0.0, 0.2], [0.0, 0.4, 0.1]]
    structure = rb.Modal(
        frequencies=[20.0, 31.0],
        damping_ratio=0.01,
        shapes={"tip": shape},
        participation=[[1.0, 0.0, 0.3], [0.0, 0.8, 0.2]],
    )
    mass = 0.3 - 0.1j
    found = rb.response_from_map(
        structure,
        made_map(lambda *_: mass),
        level="2 m/s^2",
        load_direction="x",
        direction="z",
        point="tip z",
        frequencies=[22.0],
    )
    omega, stiffness = 44 * np.pi, (2 * np.pi * np.array([20.0, 31.0])) ** 2
    s = np.array(shape)[:, 2]
    dynamic = np.diag(stiffness - omega**2 + 0.02j * np.sqrt(stiffness) * omega) - omega**2 * mass * np.outer(s, s)
    exact = 2 * s @ np.linalg.solve(dynamic, [-1.0, 0.0])
    one = found.isel(at=0, number=0, level=0, frequency=0, solution=0)
    assert one.amplitude * np.exp(1j * one.phase) == pytest.approx(exact, rel=1e-6)


def test_base_motion_along_a_line() -> None:
    """The apparent mass acts on the absolute acceleration: of base and structure."""
    mass = 0.3 - 0.1j
    found = rb.response_from_map(OSCILLATOR, made_map(lambda *_: mass), level="2 m/s^2", frequencies=[30.0])
    omega = 60 * np.pi
    dynamic = 3 * ((64 * np.pi) ** 2 + 0.01j * 64 * np.pi * omega) - omega**2 * (3 + mass)
    one = found.isel(at=0, number=0, level=0, frequency=0, solution=0)
    assert one.amplitude * np.exp(1j * one.phase) == pytest.approx(-2 * (3 + mass) / dynamic, rel=1e-6)


def hardening(amplitude: float, _: float) -> complex:
    """Return an apparent mass that falls with the amplitude, so that the resonance frequency rises."""
    return 0.5 / (1 + (amplitude / 1e-3) ** 2) - 0.001j


def test_all_coexisting_motions_are_found() -> None:
    """Where the resonance bends, three motions solve the equation, the middle one is unstable, and the point is flagged."""
    loss_map = made_map(hardening, np.geomspace(1e-5, 0.1, 161))
    found = rb.response_from_map(OSCILLATOR, loss_map, level="2 N", frequencies=np.linspace(29, 33, 81).tolist())
    one = found.isel(at=0, number=0, level=0)
    three = one.isel(frequency=np.flatnonzero(one.solutions == 3))
    assert three.sizes["frequency"] > 5
    assert (three.flags & 1 == 1).all()
    assert (three.is_unstable == [False, True, False]).all()
    assert (np.diff(three.amplitude, axis=-1) < 0).all()
    for frequency in three.frequency.values:
        omega = 2 * np.pi * frequency
        amplitudes = np.geomspace(2e-5, 0.09, 400_001)
        mass = 0.5 / (1 + (amplitudes / 1e-3) ** 2) - 0.001j
        force = amplitudes * np.abs(3 * ((64 * np.pi) ** 2 + 0.01j * 64 * np.pi * omega) - omega**2 * (3 + mass))
        roots = amplitudes[np.flatnonzero((force[1:] > 2) != (force[:-1] > 2))]
        assert three.amplitude.sel(frequency=frequency).values == pytest.approx(roots[::-1], rel=2e-3)


def test_several_dampers_follow_the_branch_around_its_folds() -> None:
    """Two dampers at two points with the same motion have the motions of two dampers at one point, with all folds."""
    twins = rb.Modal(frequencies=["32 Hz"], damping_ratio=0.005, shapes={"left": [3**-0.5], "right": [3**-0.5]})
    options: dict[str, Any] = {"level": ["1 N", "2 N"], "load_point": "left", "point": "left"}
    options["frequencies"] = np.linspace(28, 33, 21).tolist()
    loss_map = made_map(hardening, np.geomspace(1e-5, 0.1, 161))
    two = rb.response_from_map(twins, loss_map, at=[("left", "right")], **options)
    one = rb.response_from_map(twins, loss_map, at="left", number=2, **options)
    assert int(one.solutions.max()) == 3
    assert two.amplitude.values == pytest.approx(one.amplitude.values, rel=1e-6, nan_ok=True)
    assert (two.is_unstable.values == one.is_unstable.values).all()
    assert (two.flags.values == one.flags.values).all()
    assert two.damping_ratio.values == pytest.approx(one.damping_ratio.values, rel=1e-6, nan_ok=True)


def test_damping_ratio_of_the_mode() -> None:
    """An oscillator has the frequency of both masses, and the damping of the dashpot and of m''."""
    found = rb.response_from_map(OSCILLATOR, made_map(hardening), level="2 N", number=[1, 3], frequencies=[30.0])
    for number in (1, 3):
        one = found.sel(number=number).isel(at=0, mode=0)
        mass = number * np.array([hardening(a, 0) for a in one.map_amplitude.values])
        omega = np.sqrt(3 * (64 * np.pi) ** 2 / (3 + mass.real))
        assert one.mode_frequency.values == pytest.approx(omega / (2 * np.pi), rel=1e-6)
        dashpot = 2 * 0.005 * 64 * np.pi * 3
        ratio = (dashpot - omega * mass.imag) / (2 * omega * (3 + mass.real))
        assert one.damping_ratio.values == pytest.approx(ratio, rel=1e-6)


def test_amplitudes_as_accelerations() -> None:
    """A map over accelerations gives the response of the map over displacements."""
    hertz = [29.5, 30.0, 31.0]
    frequencies = np.geomspace(25, 40, 41)
    by_displacement = made_map(hardening, np.geomspace(1e-6, 1e-1, 161), frequencies)
    by_acceleration = made_map(
        lambda a, f: hardening(a / (2 * np.pi * f) ** 2, f), np.geomspace(0.04, 2000, 161), frequencies, "m/s^2"
    )
    one, other = (
        rb.response_from_map(OSCILLATOR, each, level="1 N", frequencies=hertz)
        for each in (by_displacement, by_acceleration)
    )
    assert other.amplitude.values == pytest.approx(one.amplitude.values, rel=1e-3)
    assert other.cavity_amplitude.attrs["units"] == "m/s^2"
    squared = (2 * np.pi * one.frequency) ** 2
    assert other.cavity_amplitude.values == pytest.approx(
        (one.cavity_amplitude * squared).transpose(*one.cavity_amplitude.dims).values, rel=1e-3
    )


@pytest.fixture(scope="module")
def ball_map() -> Any:
    """Return the map of a ball in a gap of 1 mm to each side, whose first motion reaches the walls."""
    return map_of_ball(rb.geomspace("0.6 mm", "14 mm", 25))


def map_of_ball(amplitudes: Any) -> xarray.Dataset:
    """Return the map of a moving ball at two frequencies."""
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="30 Hz")),
        damper=ball(velocity="0.1 m/s"),
        duration="1 s",
        method=rb.Newton(),
    )
    return rb.loss_map(case, amplitudes, ["30 Hz", "34 Hz"], cycles=(100, 60), progress=False)


def ball(**changes: Any) -> rb.ImpactDamper:
    """Return a steel ball of 33 g."""
    contact = rb.Tsuji(restitution=0.5)
    return rb.ImpactDamper(ball=rb.Sphere(diameter="20 mm", material="steel"), gap="1 mm", contact=contact, **changes)


def test_peak_of_a_ball_is_that_of_the_simulation(ball_map: Any, tmp_path: Path) -> None:
    """The peak from a map, also from its file, is that of the stepped sine within the interpolation error and 2 %."""
    levels = ["8 N", "12 N"]
    case = rb.Case(
        structure=OSCILLATOR,
        damper=ball(),
        load=rb.Harmonic(amplitude="10 N", frequency="32 Hz"),
        duration="1 s",
        method=rb.Newton(),
    )
    hertz = np.linspace(31.2, 32.2, 11).tolist()
    full = rb.frequency_response(case, hertz, levels=levels, direction="up", cycles=(300, 60), progress=False)
    file = tmp_path / "ball.nc"
    ball_map.to_netcdf(file)
    found = rb.response_from_map(OSCILLATOR, file, level=levels, frequencies=hertz)
    peak = full.amplitude.max("frequency").values[0]
    assert (found.peak_interpolation_error < 0.02).all()
    assert found.peak.values[0, 0] == pytest.approx(peak, rel=0.02)
    assert (found.peak < 0.95 * found.bare_amplitude.max("frequency")).all()
    share = 0.5 * full.amplitude**2 / full.rms**2
    assert (share > 0.95).all()


def test_peak_of_balls_on_three_modes_is_that_of_the_simulation() -> None:
    """One ball, and two of them by `number`, at the top of a chain: its second mode has the peak of the stepped sine."""
    structure, level = chain(), "8 N"
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="30 Hz")),
        damper=ball(velocity="0.1 m/s"),
        duration="1 s",
        method=rb.Newton(),
    )
    own = np.sqrt(structure.modes().stiffness[1]) / (2 * np.pi)
    hertz = (own * np.linspace(0.985, 1.015, 9)).tolist()
    loss_map = rb.loss_map(
        case, rb.geomspace("0.2 mm", "8 mm", 31), [0.95 * own, 1.05 * own], cycles=(100, 60), progress=False
    )
    found = rb.response_from_map(
        structure, loss_map, level=level, number=[1, 2], at="top", load_point="top", frequencies=hertz
    )
    for number in (1, 2):
        full = rb.frequency_response(
            rb.Case(
                structure=structure,
                damper=ball(velocity="0.1 m/s", number=number, point="top"),
                load=rb.Harmonic(amplitude=level, frequency=own, point="top"),
                duration="1 s",
                method=rb.Newton(),
            ),
            hertz,
            direction="up",
            cycles=(150, 60),
            progress=False,
        )
        one = found.sel(number=number).isel(at=0, level=0)
        assert one.peak.item() == pytest.approx(full.amplitude.max().item(), rel=0.05)
        assert not one.flags.sel(frequency=one.peak_frequency.item()).any()
        assert one.peak.item() < 0.9 * one.bare_amplitude.max().item()


def test_outside_of_the_map_is_flagged_and_not_a_number(ball_map: Any, tmp_path: Path) -> None:
    """Smaller and larger motions and other frequencies are NaN with a flag, counted, and a peak among them is unknown."""
    without_case = ball_map.drop_attrs(deep=False)
    found = rb.response_from_map(OSCILLATOR, without_case, level=["8 N", "40 N"], frequencies=[25.0, 31.8, 33.9])
    one = found.isel(at=0, number=0, solution=0)
    names = found.flags.attrs["flag_meanings"].split()
    bits = {name: 1 << bit for bit, name in enumerate(names)}
    assert (one.flags.sel(frequency=25.0) == bits["outside_frequencies"]).all()
    assert one.flags.sel(frequency=33.9, level=8.0) == bits["below_map"]
    assert one.flags.sel(frequency=31.8, level=40.0) == bits["above_map"]
    assert np.isnan(one.amplitude.where(one.flags > 0)).all()
    assert np.isfinite(one.amplitude.where(one.flags == 0, 1.0)).all()
    assert np.isnan(found.peak.values[0, 0]).tolist() == [False, True]
    assert "1 of 6 points: a motion of a damper is above" in found.attrs["warnings"]
    found.to_netcdf(tmp_path / "response.nc")
    xarray.testing.assert_equal(xarray.load_dataset(tmp_path / "response.nc"), found)


def test_balls_at_rest_are_another_motion() -> None:
    """Without gravity a ball stays at rest where the amplitude without it is less than the gap, and the point is flagged."""
    hertz = np.linspace(31.2, 32.8, 17).tolist()
    ball_map = map_of_ball(rb.geomspace("0.16 mm", "1 mm", 12))
    found = rb.response_from_map(OSCILLATOR, ball_map, level="1.15 N", frequencies=hertz).isel(at=0, number=0, level=0)
    case = rb.Case(
        structure=OSCILLATOR,
        damper=ball(),
        load=rb.Harmonic(amplitude="1.15 N", frequency="32 Hz"),
        duration="1 s",
        method=rb.Newton(),
    )
    at_rest = rb.frequency_response(case, hertz, direction="fresh", cycles=(400, 10), progress=False)
    assert (at_rest.impacts_per_cycle == 0).all()
    assert float(found.peak) == pytest.approx(float(at_rest.amplitude.max()), rel=1e-3)
    moving = found.isel(frequency=np.flatnonzero(found.solutions == 2))
    assert moving.sizes["frequency"] > 2
    assert (abs(moving.amplitude / moving.bare_amplitude - 1) < 1e-9).any("solution").all()
    assert (moving.flags & 1 == 1).all()


def test_share_of_the_first_harmonic(ball_map: Any) -> None:
    """Force harmonics of a periodic motion are those of its impulses; the share of the motion is that of the simulation."""
    one = ball_map.sel({FREQUENCY: 30.0})
    regular = one.isel({AMPLITUDE: slice(0, 2)})
    assert regular.impacts_per_cycle.values == pytest.approx(2)
    assert float(regular.force_variation.max()) < 1e-3
    apparent = np.hypot(regular.effective_mass, regular.damping_mass)
    first = (apparent * regular[AMPLITUDE] * (60 * np.pi) ** 2).values
    odd, even = regular.force_harmonics.sel(harmonic=[3, 5, 7]), regular.force_harmonics.sel(harmonic=[2, 4, 6, 8])
    # An impulse acts in the middle of its sampling step, a 64th of a cycle.
    lost = 1 - np.cos(np.pi * odd.harmonic.values / 64)
    assert (np.abs(odd.values / first[:, None] - 1) < lost).all()
    assert float(even.max()) < 0.01 * first.min()
    light = rb.SDOF(mass="0.2 kg", frequency="32 Hz", damping_ratio=0.05)
    case = rb.Case(
        structure=light,
        damper=ball(),
        load=rb.Harmonic(amplitude="3 N", frequency="32 Hz"),
        duration="1 s",
        method=rb.Newton(),
    )
    full = rb.frequency_response(
        case, [31.0], direction="up", cycles=(100, 100), measure="rms_velocity", progress=False
    ).isel(direction=0, level=0, frequency=0)
    found = rb.response_from_map(light, ball_map, level="3 N", frequencies=[31.0]).isel(at=0, number=0, level=0)
    share = float((2 * np.pi * 31 * full.amplitude) ** 2 / 2 / full.rms_velocity**2)
    assert 1 - float(found.first_harmonic_share[0, 0]) == pytest.approx(1 - share, rel=0.5)
    shaky = rb.response_from_map(
        rb.SDOF(mass="0.1 kg", frequency="32 Hz", damping_ratio=0.01), ball_map, level="2 N", frequencies=[31.0]
    )
    assert (shaky.flags.values & 1 << shaky.flags.attrs["flag_meanings"].split().index("higher_harmonics") > 0).all()


def test_runs_that_failed_or_exceeded_a_limit() -> None:
    """A failed run is a hole in the map; a run with a validity warning is flagged and leads to a warning."""
    loss_map = made_map(lambda *_: 0.1 - 0.01j, np.geomspace(1e-5, 1e-1, 17))
    status = xarray.zeros_like(loss_map.effective_mass, dtype=np.int8)
    status[8] = 1
    holed = loss_map.assign(status=status)
    levels = rb.geomspace("1 N", "7 kN", 41)
    found = rb.response_from_map(OSCILLATOR, holed, level=levels, frequencies=[20.0]).isel(at=0, number=0, solution=0)
    amplitudes = np.geomspace(1e-5, 1e-1, 17)
    unknown = np.isnan(found.amplitude.values[:, 0])
    whole = rb.response_from_map(OSCILLATOR, loss_map, level=levels, frequencies=[20.0]).isel(
        at=0, number=0, solution=0
    )
    size = whole.amplitude.values[:, 0]
    inside = (size >= amplitudes[7]) & (size <= amplitudes[9])
    assert (unknown == inside).all()
    assert inside.any()
    names = found.flags.attrs["flag_meanings"].split()
    assert ((found.flags.values[:, 0] & 1 << names.index("not_found") > 0) == inside).all()
    limits = xarray.zeros_like(status).assign_attrs(flag_meanings="few_steps deep_overlap soft_bed enduring_contacts")
    for value, name in ((4, "soft_bed"), (1, "few_steps")):
        limits[3] = value
        with pytest.warns(UserWarning, match=rf"a validity limit \({name}\)"):
            warned = rb.response_from_map(
                OSCILLATOR, loss_map.assign(warnings=limits), level=levels, frequencies=[20.0]
            )
        bit = 1 << warned.flags.attrs["flag_meanings"].split().index("map_warning")
        near = (size >= amplitudes[2]) & (size <= amplitudes[4])
        assert ((warned.flags.values[0, 0, :, 0] & bit > 0) == near).all()


def with_intervals(mass: complex, half: tuple[float, float]) -> xarray.Dataset:
    """Return a map of constant mass whose m' and m'' have intervals."""
    loss_map = made_map(lambda *_: mass)
    return loss_map.assign(
        {
            f"{name}_interval": xarray.full_like(loss_map.effective_mass, value)
            for name, value in zip(("effective_mass", "damping_mass"), half, strict=True)
        }
    )


def test_intervals_of_the_map_are_carried_into_the_response() -> None:
    """Peak and damping ratio have the intervals of an oscillator whose added mass and damping have those of the map."""
    mass, half, levels = 0.1 - 0.05j, (0.02, 0.01), np.array([5.0, 50.0, 5000.0])
    hertz = np.linspace(29, 33, 81)
    options: dict[str, Any] = {"level": [f"{each} N" for each in levels], "frequencies": hertz.tolist()}
    twins = rb.Modal(frequencies=["32 Hz"], damping_ratio=0.005, shapes={"left": [3**-0.5], "right": [3**-0.5]})
    omega = 2 * np.pi * hertz

    def amplitude(mass: complex) -> Any:
        dynamic = 3 * ((64 * np.pi) ** 2 + 0.01j * 64 * np.pi * omega) - omega**2 * (3 + 2 * mass)
        return levels[:, None] * np.abs(1 / dynamic)

    def peak(mass: complex) -> Any:
        return amplitude(mass).max(axis=1)

    def ratio(mass: complex) -> float:
        own = 64 * np.pi * np.sqrt(3 / (3 + 2 * mass.real))
        return float((0.01 * 64 * np.pi * 3 - 2 * own * mass.imag) / (2 * own * (3 + 2 * mass.real)))

    others = mass + half[0], mass - 1j * half[1]
    for structure, at, number in ((OSCILLATOR, None, 2), (twins, [("left", "right")], 1)):
        more = {} if at is None else {"load_point": "left", "point": "left"}
        found = rb.response_from_map(
            structure, with_intervals(mass, half), at=at, number=number, **options, **more
        ).isel(at=0, number=0)
        exact = np.hypot(*(peak(other) - peak(mass) for other in others))
        exact[2] = np.nan  # the damper moves more than the map covers
        each = np.hypot(*(amplitude(other) - amplitude(mass) for other in others))[:2]
        assert found.amplitude_interval.values[:2] == pytest.approx(each, rel=1e-5, abs=1e-12)
        assert found.peak_interval.values == pytest.approx(exact, rel=1e-5, nan_ok=True)
        exact = np.hypot(*(ratio(other) - ratio(mass) for other in others))
        assert found.damping_ratio_interval.values == pytest.approx(exact, rel=1e-6)
    without = rb.response_from_map(OSCILLATOR, made_map(lambda *_: mass), **options)
    assert np.isnan(without.peak_interval).all() and np.isnan(without.damping_ratio_interval).all()


def test_parts_of_a_map_without_intervals_give_none() -> None:
    """Where a run of the map was too short for an interval, peaks and damping ratios have none."""
    loss_map = with_intervals(0.1 - 0.05j, (0.02, 0.01))
    loss_map.damping_mass_interval[10:] = np.nan  # amplitudes from 0.3 mm
    levels = rb.geomspace("0.01 N", "10 N", 13)
    found = rb.response_from_map(OSCILLATOR, loss_map, level=levels, frequencies=np.linspace(29, 33, 81).tolist())
    known = np.isfinite(found.peak_interval)
    assert known.any() and (known == (found.peak < found.map_amplitude[9])).all()
    assert f"{int((~known).sum())} of 13 peaks have no 95 % interval" in found.attrs["warnings"]
    has_ratio = np.isfinite(found.damping_ratio_interval.values[0, 0, 0])
    assert has_ratio.tolist() == [True] * 10 + [False] * 11


def test_a_dozen_arrangements_take_less_than_a_second() -> None:
    """Three places with one to four dampers, at 400 frequencies, take less than a second of processor time."""
    loss_map = made_map(hardening, np.geomspace(1e-5, 0.1, 41), np.geomspace(5, 60, 6))
    options: dict[str, Any] = {"at": ["foot", "middle", "top"], "number": [1, 2, 3, 4], "load_point": "foot"}
    took = []
    for _ in range(3):
        before = time.process_time()
        rb.response_from_map(chain(), loss_map, level="10 N", frequencies=np.linspace(10, 55, 400).tolist(), **options)
        took.append(time.process_time() - before)
    assert min(took) < 1  # 0.2 s on an idle machine


def softened(change: float, softening: float = 20.0) -> xarray.Dataset:
    """Return a map of 200 g of particles of constant apparent mass, with softening that may change their loss."""
    loss_map = made_map(lambda *_: 0.1 - 0.05j)
    parts = {"softening": softening, "softening_change": change}
    values = {name: xarray.full_like(loss_map.effective_mass, value) for name, value in parts.items()}
    return loss_map.assign(values | {"particle_mass": 0.2})


def test_the_effect_of_softening_is_carried_into_the_response() -> None:
    """The peak changes by the estimated loss of softening; a large or unknown effect is among the warnings."""
    options: dict[str, Any] = {"level": "5 N", "frequencies": np.linspace(29, 33, 81).tolist()}
    peak = [
        rb.response_from_map(OSCILLATOR, made_map(lambda *_, m=m: 0.1 - 1j * m), **options).peak for m in (0.05, 0.04)
    ]
    found = rb.response_from_map(OSCILLATOR, softened(0.01 * np.pi / 0.2), **options)
    assert found.peak_softening_error.item() == pytest.approx((peak[1] / peak[0]).item() - 1, rel=1e-9)
    assert found.attrs["softening"] == "20"
    assert found.attrs["warnings"].endswith(
        "softening 20 in the map may change a peak by 14 %, see peak_softening_error"
    )
    small = rb.response_from_map(OSCILLATOR, softened(0.001), **options)
    assert "softening" not in small.attrs["warnings"]
    unknown = rb.response_from_map(OSCILLATOR, softened(np.nan), **options)
    assert np.isnan(unknown.peak_softening_error).all()
    assert "the effect of softening 20 in the map is unknown" in unknown.attrs["warnings"]
    none = rb.response_from_map(OSCILLATOR, softened(0.0, 1.0), **options)
    assert none.attrs["softening"] == "1" and "softening" not in none.attrs["warnings"]


def test_no_root_between_the_amplitudes_of_the_table_is_missed() -> None:
    """Random smooth tables have the solutions that a scan of a thousand times as many amplitudes has."""
    rng = np.random.default_rng(3)
    amplitude, frequency = np.geomspace(1e-4, 1e-1, 13), np.array([30.0])
    for _ in range(20):
        mass = rng.normal(0, 0.05, (13, 1)) - 0.05j * rng.random((13, 1))
        table = MassTable(frequency, amplitude, mass, False)
        omega = 2 * np.pi * frequency
        gain = (-(omega**2) / (3 * ((64 * np.pi) ** 2 - omega**2 + 0.64j * np.pi * omega))).reshape(1, 1, 1)
        drive = gain[:, 0]
        levels = np.geomspace(1, 100, 7)
        found = solve(table, frequency, gain, drive, levels)
        logs = np.linspace(*table.limits, 100_001)
        own, _ = table.curves(frequency).evaluate(np.arange(1), logs[None])
        scan = np.exp(logs) * omega**2 * np.abs(1 + gain[0, 0] * own[0]) / np.abs(drive[0])
        for k, level in enumerate(levels):
            roots = np.exp(logs[np.flatnonzero((scan[1:] > level) != (scan[:-1] > level))])[::-1] * omega**2
            motions = np.abs(found.acceleration[k, 0, :, 0])
            assert motions[np.isfinite(motions)] == pytest.approx(roots, rel=1e-3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"level": "5"}, "no unit"),
        ({"level": ["5 N", "1 m/s^2"]}, "different dimensions"),
        ({"level": "-5 N"}, "greater than zero"),
        ({"level": []}, "greater than zero"),
        ({"level": "5 mm"}, "force"),
        ({"level": "1e9 N"}, "larger than the amplitudes of the map"),
        ({"level": "1e-9 N"}, "smaller than the amplitudes of the map"),
        ({"number": 0}, "number = 0: a whole number of at least 1"),
        ({"number": 1.5}, "number = 1.5"),
        ({"at": "tip"}, "the structure has no point 'tip'"),
        ({"at": ("mass", "mass")}, "names a point twice"),
        ({"point": "tip"}, "there is no point 'tip'"),
        ({"load_point": "tip"}, "the structure has no point 'tip'"),
        ({"frequencies": ["300 Hz"]}, "outside of the map, which covers 5 to 200 Hz"),
        ({"frequencies": [31.0, 30.0]}, "strictly rising"),
        ({"structure": rb.Fixed()}, "has no modes"),
        ({"structure": 5}, "is not a structure"),
        ({"loss_map": 5}, "is not a loss map"),
        ({"loss_map": xarray.Dataset()}, "is not a loss map"),
        ({"loss_map": "missing.nc"}, "does not exist"),
        ({"loss_map": made_map(lambda *_: 0.1, [1e-3])}, "one amplitude"),
    ],
)
def test_bad_input_is_refused(options: dict[str, Any], message: str) -> None:
    """Bad arguments are refused with advice."""
    given: dict[str, Any] = {"structure": OSCILLATOR, "loss_map": made_map(lambda *_: 0.1), "level": "5 N", **options}
    with pytest.raises(rb.RattleboxError) as error:
        rb.response_from_map(given.pop("structure"), given.pop("loss_map"), **given)
    assert message in str(error.value)


def test_direction_of_the_map() -> None:
    """A map of a damper that moves along z is refused for motion along x, and needs no direction for z."""
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="30 Hz")),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=2),
            cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
            contact=rb.Tsuji(restitution=0.8),
            direction="z",
        ),
        duration="1 s",
    )
    loss_map = made_map(lambda *_: 0.1 - 0.01j).assign_attrs(case=case.to_toml())
    structure = rb.Modal(frequencies=[30.0], damping_ratio=0.01, shapes={"tip": [[0.1, 0.2, 0.5]]})
    options: dict[str, Any] = {"level": "5 N", "load_direction": "z", "frequencies": [30.0]}
    with pytest.raises(rb.CaseError, match="move along 'x', but the map was computed for motion along z"):
        rb.response_from_map(structure, loss_map, direction="x", **options)
    along_z = rb.response_from_map(structure, loss_map, **options)
    again = rb.response_from_map(structure, loss_map, direction="-z", point="tip z", **options)
    assert along_z.amplitude.values == pytest.approx(again.amplitude.values)
    with pytest.raises(rb.CaseError, match="moves in 3-D and needs a direction"):
        rb.response_from_map(structure, loss_map.drop_attrs(deep=False), **options)


def test_measures_of_the_response_to_a_force() -> None:
    """A constant mass has the smallest real part and the dynamic stiffness of its equation; unknown motions have none."""
    mass, hertz = 0.05 - 0.3j, np.linspace(20, 60, 4001).tolist()
    found = rb.response_from_map(OSCILLATOR, made_map(lambda *_: mass), level=["2 N", "4 N"], frequencies=hertz)
    omega = 2 * np.pi * np.linspace(25, 40, 1_000_001)
    response = 1 / (3 * ((64 * np.pi) ** 2 + 0.01j * 64 * np.pi * omega) - omega**2 * (3 + mass))
    np.testing.assert_allclose(found.minimum_real_part.squeeze(), response.real.min(), rtol=1e-6)
    np.testing.assert_allclose(found.dynamic_stiffness.squeeze(), 1 / np.abs(response).max(), rtol=1e-6)
    part = made_map(lambda *_: mass, np.geomspace(1e-7, 1e-4, 5))
    found = rb.response_from_map(OSCILLATOR, part, level="2 N", frequencies=hertz)
    assert np.isnan(found.minimum_real_part).all() and np.isnan(found.dynamic_stiffness).all()


def test_transmissibility_of_a_base_motion() -> None:
    """The absolute acceleration over that of the base is that of the equation, at a point on a line and in 3-D."""
    mass, omega = 0.3 - 0.1j, 2 * np.pi * np.array([30.0, 33.0])
    found = rb.response_from_map(OSCILLATOR, made_map(lambda *_: mass), level="2 m/s^2", frequencies=[30.0, 33.0])
    spring = 3 * ((64 * np.pi) ** 2 + 0.01j * 64 * np.pi * omega)
    exact = np.abs(spring / (spring - omega**2 * (3 + mass)))
    np.testing.assert_allclose(found.transmissibility.squeeze(), exact, rtol=1e-6)
    shape = [[3**-0.5, 0.0, 0.0]]
    space = rb.Modal(
        frequencies=[32.0], damping_ratio=0.005, shapes={"mass": shape}, participation=[[3**0.5, 0.0, 0.0]]
    )
    options: dict[str, Any] = {"level": "2 m/s^2", "direction": "x", "frequencies": [30.0, 33.0]}
    for point in (None, "mass x"):
        found = rb.response_from_map(space, made_map(lambda *_: mass), point=point, **options)
        np.testing.assert_allclose(found.transmissibility.squeeze(), exact, rtol=1e-6)
