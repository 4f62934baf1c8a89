"""95 % intervals of the measures of steady motion."""

from __future__ import annotations

import numpy as np
import pytest

import rattlebox as rb

STEADY = [
    "rms",
    "rms_velocity",
    "rms_acceleration",
    "impacts_per_cycle",
    "loss_per_cycle",
    "loss_factor",
    "impact_loss",
]


def ball(**changes):
    """Return a case with one ball that is chaotic at 28 Hz."""
    parts = {
        "structure": rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        "load": rb.Harmonic(amplitude="10 N", frequency="28 Hz"),
        "duration": "2 s",
    }
    return rb.Case(**{**parts, **changes})


def test_the_intervals_of_chaotic_motion_cover_the_mean():
    """About 95 % of the intervals of 60 runs with different starts contain the mean of all runs."""
    result = rb.sweep(ball(), {"damper.start": rb.linspace(-0.9, 0.9, 60)}, STEADY, cycles=(100, 384), progress=False)
    for name in STEADY:
        half = result[f"{name}_interval"]
        assert np.isfinite(half).mean() > 0.85, name
        value = result[name].where(np.isfinite(half), drop=True)
        inside = abs(value - result[name].mean()) < half
        assert 0.85 < float(inside.mean()) <= 1.0, name
        assert half.attrs["units"] == result[name].attrs["units"]
        # Not narrower than the scatter of the runs, but wider if neighbouring cycles are anticorrelated.
        assert 0.7 < float(half.median()) / (1.96 * float(result[name].std())) < 5, name


def test_periodic_motion_has_a_narrow_interval():
    """The interval of a periodic motion is nearly zero; a window too short for an interval gives a note."""
    at_resonance = rb.sweep(ball(), {"load.frequency": ["34.4 Hz"]}, STEADY, cycles=(300, 40), progress=False)
    for name in STEADY:
        assert float(at_resonance[f"{name}_interval"][0]) < 1e-3 * float(at_resonance[name][0])
    assert "too_short" not in at_resonance.attrs
    short = rb.sweep(ball(), {"load.frequency": ["34.4 Hz"]}, STEADY, cycles=(300, 9), progress=False)
    assert np.isnan(short.rms_interval).all() and np.isfinite(short.rms).all()
    assert "rms (1 of 1 variants)" in short.attrs["too_short"]
    assert "a window of 31.4 s" in short.attrs["too_short"]  # 10 cycles of the mode over its damping ratio


def test_a_free_decay_has_no_interval():
    """Measures of a motion without periodic load have no intervals, nor have peaks."""
    free = ball(load=None, structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", velocity="1 m/s"))
    result = rb.sweep(free, {"damper.gap": ["1 mm"]}, ["rms", "peak"], progress=False)
    assert set(result.data_vars) == {"status", "rms", "peak"}
    driven = rb.sweep(ball(), {"damper.gap": ["1 mm"]}, ["rms", "peak"], cycles=(20, 20), progress=False)
    assert set(driven.data_vars) == {"status", "rms", "peak", "rms_interval"}


def test_intervals_do_not_change_what_is_measured():
    """Intervals do not change the measures, and a store returns them."""
    axes = {"load.frequency": rb.linspace("27 Hz", "36 Hz", 5)}
    coarse = rb.sweep(ball(), axes, ["loss_per_cycle"], cycles=(50, 64), samples=2, progress=False)
    result = rb.sweep(ball(), axes, ["loss_per_cycle"], cycles=(50, 64), progress=False)
    assert coarse.loss_per_cycle.identical(result.loss_per_cycle)
    assert np.isnan(coarse.loss_per_cycle_interval).all()


def test_intervals_in_stores_and_responses(tmp_path):
    """A store returns intervals and the note; a frequency response has intervals where the motion is periodic."""
    result = rb.sweep(
        ball(), {"damper.gap": ["1 mm", "2 mm"]}, ["rms"], cycles=(5, 12), store=tmp_path / "s.zarr", progress=False
    )
    again = rb.open_study(tmp_path / "s.zarr")
    assert again.rms_interval.load().identical(result.rms_interval.load())
    assert again.attrs.get("too_short") == result.attrs.get("too_short")
    again.load().to_netcdf(tmp_path / "s.nc")
    response = rb.frequency_response(ball(), ["28 Hz", "34.4 Hz"], cycles=(300, 32), direction="up", progress=False)
    assert response.rms_interval.dims == response.rms.dims
    assert np.isfinite(response.rms_interval).values.ravel().tolist() == [False, True]
    assert response.period.values.ravel().tolist() == [0, 1]


def test_random_vibration():
    """Without cycles the window is divided into equal parts; four times the length halves the interval."""
    psd = [("10 Hz", "0.01 g_0^2/Hz"), ("200 Hz", "0.01 g_0^2/Hz")]
    medians = []
    for length in ("19 s", "70 s"):
        case = rb.Case(
            structure=rb.SDOF(mass="1 kg", frequency="40 Hz", damping_ratio=0.05),
            base=rb.Random(psd=psd, duration=length, unit="m/s^2"),
            duration=length,
        )
        axes = {"base.seed": list(range(1, 13))}
        result = rb.sweep(case, axes, ["rms"], skip="2 s", samples=20_001, progress=False)
        medians.append(float(result.rms_interval.median() / result.rms.mean()))
    assert medians[1] / medians[0] == pytest.approx(0.5, abs=0.15)
    assert 0.01 < medians[1] < 0.1


def shaken(amplitude):
    """Return twelve balls on a shaker."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=amplitude, frequency="50 Hz", direction="z")),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=12),
            cavity=rb.Box(size=("15 mm", "15 mm", "20 mm")),
            contact=rb.Tsuji(restitution=0.7),
            friction=0.2,
            packing=rb.Settled(seed=1),
            softening=1000,
        ),
        duration="1 s",
    )


def test_particles_on_a_shaker():
    """Measures of particle dampers have intervals; a window of six cycles is too short."""
    case = shaken("60 m/s^2")
    axes = {"damper.packing.seed": [1, 2, 3, 4, 5, 6]}
    names = ["loss_per_cycle", "reduced_loss", "impact_loss", "effective_mass", "loss_factor"]
    result = rb.sweep(case, axes, names, cycles=(5, 120), progress=False)
    for name in names[:-1]:
        half = result[f"{name}_interval"]
        assert np.isfinite(half).mean() > 0.6, name
        assert 0.3 < float(half.median()) / (1.96 * float(result[name].std())) < 4, name
    # The effective mass may be zero within its interval: the loss factor has no limits.
    assert (result.effective_mass_interval > 0.5 * result.effective_mass).sum() >= 4
    assert np.isnan(
        result.loss_factor_interval.where(result.effective_mass_interval > 0.5 * result.effective_mass)
    ).all()
    short = rb.sweep(case, {"damper.packing.seed": [1]}, names, cycles=(5, 6), progress=False)
    assert np.isnan(short.loss_per_cycle_interval).all() and "loss_per_cycle" in short.attrs["too_short"]


def test_the_interval_of_a_ratio():
    """The interval of the loss factor agrees with the scatter between packings where the effective mass is not near zero.

    It was that of the mean of the ratios of the parts of the window, which a part with hardly any effective mass decides.
    """
    axes = {"damper.packing.seed": [1, 2, 3, 4, 5, 6]}
    result = rb.sweep(shaken("20 m/s^2"), axes, ["loss_factor", "effective_mass"], cycles=(20, 120), progress=False)
    half = result.loss_factor_interval
    assert np.isfinite(half).mean() > 0.6
    assert 0.3 < float(half.median()) / (1.96 * float(result.loss_factor.std())) < 4


def test_a_linear_motion_has_an_interval_only_in_long_windows():
    """A window of less than five cycles over the damping ratio never gives an interval for a linear motion.

    The motions of the other tests were observed for long, and a short series may look uncorrelated by chance. A ball that
    never touches a wall changes nothing; a run and a sweep have the same limit.
    """
    psd = [("10 Hz", "0.01 g_0^2/Hz"), ("200 Hz", "0.01 g_0^2/Hz")]
    parts = {"structure": rb.SDOF(mass="1 kg", frequency="40 Hz", damping_ratio=0.05)}
    parts |= {"base": rb.Random(psd=psd, duration="24 s", unit="m/s^2")}
    axes = {"base.seed": list(range(1, 41))}
    still = rb.ImpactDamper(
        ball=rb.Sphere(radius="4 mm", material="steel"), gap="4 m", contact=rb.Tsuji(restitution=0.5)
    )
    for damper in (None, still):
        for length, given in (("3.4 s", False), ("12 s", True)):
            case = rb.Case(**parts, damper=damper, duration=length)
            result = rb.sweep(case, axes, ["rms"], skip="1 s", samples=8001, progress=False)
            assert np.isfinite(result.rms_interval).any() == given
            assert "a window of 5 s" in result.attrs.get("too_short", "a window of 5 s")
    for length, given in (("4.8 s", False), ("24 s", True)):
        case = rb.Case(**parts, duration=length, output=rb.Output(rate="1 kHz"))
        values = rb.simulate(case).summary().values
        assert np.isfinite(values["steady_rms_displacement_error[mass]"]) == given


def test_a_harmonic_linear_motion_has_an_interval_in_short_windows():
    """The RMS of a steady linear vibration is exact within its interval after 13 cycles, though modes decay slowly."""
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", frequency="40 Hz", damping_ratio=0.01),
        load=rb.Harmonic(amplitude="3 N", frequency="26 Hz"),
        duration="6.5 s",
        output=rb.Output(rate="900 Hz"),
    )
    omega, own = 2 * np.pi * 26, 2 * np.pi * 40
    exact = 3 / np.abs(own**2 - omega**2 + 0.02j * own * omega) / np.sqrt(2)
    result = rb.sweep(case, {"load.amplitude": [3.0]}, ["rms"], cycles=(156, 13), progress=False)
    assert abs(float(result.rms[0]) - exact) <= float(result.rms_interval[0]) + 1e-4 * exact < 0.05 * exact
    assert "too_short" not in result.attrs
    values = rb.simulate(case).summary().values
    error = values["steady_rms_displacement_error[mass]"]
    # The second half begins before the transient is over by a thousandth.
    assert abs(values["steady_rms_displacement[mass]"] - exact) <= error + 2e-3 * exact < 0.05 * exact


def test_a_cavity_without_modes_has_intervals():
    """A ball in a cavity with a given motion has intervals: there is no mode whose damping limits them."""
    case = ball(structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="20 Hz")), load=None)
    result = rb.sweep(case, {"damper.start": [-0.5, 0.0, 0.5]}, ["impact_loss"], cycles=(50, 200), progress=False)
    assert np.isfinite(result.impact_loss_interval).any()


def test_a_line_lies_in_its_interval():
    """The figure of a measure over one axis has a band with the width of the interval."""
    result = rb.sweep(
        ball(), {"load.frequency": ["28 Hz", "28.1 Hz", "28.2 Hz"]}, ["rms"], cycles=(100, 384), progress=False
    )
    (band,) = rb.plot_map(result).axes[0].collections
    heights = [
        np.ptp(part[part[:, 0] == x, 1]) for part in [band.get_paths()[0].vertices] for x in np.unique(part[:, 0])
    ]
    shown = 2 * result.rms_interval.values
    assert np.array(heights) / np.array(heights).max() == pytest.approx(shown / shown.max(), abs=1e-6)
