"""Figures of runs over frequency."""

from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox import analysis
from rattlebox.model.units import STANDARD_GRAVITY

from .conftest import is_within_page

FLAT = rb.Random([("5 Hz", "0.02 g^2/Hz"), ("150 Hz", "0.02 g^2/Hz")], "8 s", seed=4, unit="g")


def shaken(**options: object) -> rb.Run:
    """Return a run on a base in random vibration."""
    usual = {
        "structure": rb.SDOF(mass="2 kg", frequency="30 Hz", damping_ratio=0.05),
        "base": FLAT,
        "duration": "8 s",
        "output": rb.Output(rate="1 kHz"),
    }
    return rb.simulate(rb.Case(**{**usual, **options}), progress=False)


def test_density_of_a_shaken_base_is_the_given_one() -> None:
    """The line of the base is flat at its density in both units, and its RMS in the legend that of the area."""
    figure = shaken().plot.psd(resolution=1.0)
    assert is_within_page(figure)
    (axes,) = figure.axes
    mass, base = axes.lines
    frequency, density = base.get_data()
    inside = (frequency > 10) & (frequency < 140)
    assert density[inside].mean() == pytest.approx(0.02 * STANDARD_GRAVITY**2, rel=0.05)
    rms = np.sqrt(0.02 * 145)
    assert float(str(base.get_label()).split()[2]) == pytest.approx(rms, rel=0.03)
    low, high = axes.get_ylim()
    second = axes.child_axes[0]
    figure.draw_without_rendering()
    assert second.get_ylim() == pytest.approx((low / STANDARD_GRAVITY**2, high / STANDARD_GRAVITY**2))
    assert second.get_ylabel() == "g²/Hz" and str(mass.get_label()).startswith("mass RMS")


def test_means_over_a_step_do_not_reduce_the_density() -> None:
    """A sine at an eighth of the rate keeps its RMS, of which a mean over the step has 97 %."""
    run = shaken(base=rb.Harmonic(amplitude="1 g", frequency="125 Hz"))
    (_, base) = run.plot.psd().axes[0].lines
    assert float(str(base.get_label()).split()[2]) == pytest.approx(1 / np.sqrt(2), rel=2e-3)


def test_third_octaves_are_those_of_the_density() -> None:
    """The bands of a displacement are those of analysis.band_levels."""
    run = shaken()
    figure = run.plot.third_octaves(of="displacement", resolution=1.0, size="page")
    assert is_within_page(figure)
    motion = run.motion.displacement.sel(point="mass")
    levels = analysis.band_levels(analysis.power_spectral_density(run.motion.time, motion, resolution=1.0).density)
    (drawn,) = figure.axes[0].patches
    np.testing.assert_allclose(drawn.get_data().values, 1e3 * levels.values, rtol=1e-9)
    assert figure.axes[0].get_ylabel().endswith("(mm)")


def test_shock_spectrum_of_a_stiff_point_is_that_of_the_base() -> None:
    """A structure far above the pulse follows the base, whose spectrum is that of the closed form of a half-sine."""
    stiff = rb.SDOF(mass="1 kg", frequency="900 Hz", damping_ratio=0.3)
    pulse = rb.HalfSine(amplitude="20 g", duration="11 ms")
    run = shaken(structure=stiff, base=pulse, duration="0.4 s", output=rb.Output(rate="5 kHz"))
    figure = run.plot.shock_spectrum(damping_ratio=0.0)
    assert is_within_page(figure)
    mass, base = (line.get_ydata().max() / STANDARD_GRAVITY for line in figure.axes[0].lines)
    assert base == pytest.approx(1.77 * 20, rel=5e-3)
    assert mass == pytest.approx(base, rel=0.02)


def test_of_many_points_the_largest_and_the_base_are_drawn() -> None:
    """Of nine floors five are drawn, which the legend states, and always the base."""
    tower = rb.ShearBuilding(masses=["80 t"] * 9, stiffnesses=["90 MN/m"] * 9, damping_ratio="3 %")
    run = shaken(structure=tower, output=rb.Output(rate="500 Hz"))
    for name in ("psd", "third_octaves", "shock_spectrum"):
        for size in ("column", "page", "slide"):
            figure = getattr(run.plot, name)(size=size)
            assert is_within_page(figure)
            legend = figure.axes[0].get_legend()
            assert legend.get_title().get_text() == "the largest 5 of 9"
            assert len(legend.get_texts()) == 6 and legend.get_texts()[-1].get_text().startswith("base")
    assert len(run.plot.psd(point="storey 2").axes[0].lines) == 2
    assert len(run.plot.psd(of="storey 2 - storey 1").axes[0].lines) == 1


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda run: run.plot.psd(resolution=1e-3), "resolution"),
        (lambda run: run.plot.psd(point="roof"), "roof"),
        (lambda run: run.plot.third_octaves(resolution=200.0), "no band"),
        (lambda run: run.plot.shock_spectrum(damping_ratio=2.0), "damping_ratio"),
        (lambda run: run.plot.psd(of="peak"), "not a response"),
    ],
)
def test_wrong_options_are_refused(draw, message: str) -> None:
    """Options that do not fit the run are errors of the case, with the allowed values."""
    with pytest.raises(rb.CaseError, match=message):
        draw(shaken())


def test_uneven_times_are_refused() -> None:
    """The output times of a run without a rate are those of its events; the advice is to set a rate."""
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="12 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.5)
    )
    with pytest.raises(rb.CaseError, match="rate"):
        shaken(damper=ball, output=rb.Output(), duration="0.5 s").plot.psd()


def test_spectra_are_in_reports_of_random_vibration_and_shocks(tmp_path: Path) -> None:
    """The report of a run has the figures that suit its load."""
    text = shaken().report(tmp_path / "random.html").read_text(encoding="utf-8")
    assert "Power spectral density of" in text and "third-octave bands" in text and "Shock response" not in text
    pulse = shaken(base=rb.HalfSine(amplitude="5 g", duration="10 ms"), duration="1 s")
    text = pulse.report(tmp_path / "shock.html").read_text(encoding="utf-8")
    assert "Shock response spectrum" in text and "Power spectral density of" not in text


def test_rms_of_a_short_run_is_that_of_its_samples() -> None:
    """The RMS of the legend is that of the summary; the area of the density, which weighs the ends of a run less, was not.

    Runs of the other tests were long and steady, so that both agreed.
    """
    struck = rb.SDOF(mass="2 kg", frequency="30 Hz", damping_ratio=0.01, velocity="0.3 m/s")
    run = shaken(structure=struck, base=(), duration="2 s")
    (mass,) = run.plot.psd().axes[0].lines
    rms = run.summary().values["rms_acceleration[mass]"] / STANDARD_GRAVITY
    assert float(str(mass.get_label()).split()[2]) == pytest.approx(rms, rel=0.01)


def test_third_octaves_of_a_short_run_state_what_they_lack() -> None:
    """A pulse has nearly all of its motion in bands that a run of 30 ms does not resolve; runs of tests were long."""
    pulse = shaken(
        base=rb.HalfSine(amplitude="30 g", duration="6 ms"), duration="30 ms", output=rb.Output(rate="20 kHz")
    )
    figure = pulse.plot.third_octaves()
    assert is_within_page(figure)
    names = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert len(names) == 2 and all(name.endswith("(100 % below)") for name in names)
    whole = [text.get_text() for text in shaken().plot.third_octaves().axes[0].get_legend().get_texts()]
    assert not any("below" in name for name in whole)
