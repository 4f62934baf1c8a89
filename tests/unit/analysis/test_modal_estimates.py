"""Forms of frequency response functions, measures of damping, and estimates from a resonance."""

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from rattlebox import analysis

FORMS = {
    "receptance": "m/N",
    "mobility": "m/s/N",
    "accelerance": "m/s^2/N",
    "dynamic_stiffness": "N/m",
    "impedance": "N s/m",
    "apparent_mass": "kg",
}


def oscillator(zeta: float, natural: float = 37.0, width: float = 8.0, samples: int = 161) -> xr.DataArray:
    """Return the receptance of an oscillator of 1 N/m around its resonance."""
    half = min(width * zeta, 0.6)
    r = np.linspace(1 - half, 1 + half, samples) + 0.17 * zeta / samples
    return xr.DataArray(
        1 / (1 - r**2 + 2j * zeta * r), {"frequency": natural * r}, ["frequency"], attrs={"units": "m/N"}
    )


@pytest.mark.parametrize("form", FORMS)
def test_forms_are_powers_of_i_omega(form: str) -> None:
    """Each form of an oscillator is that of its mass, dashpot and spring, has its unit, and leads back."""
    m, c, k = 3.0, 40.0, 5e4
    f = np.linspace(1, 60, 60)
    s = 2j * math.pi * f
    h = 1 / (m * s**2 + c * s + k)
    exact = {"receptance": h, "mobility": s * h, "accelerance": s**2 * h}
    exact |= {"dynamic_stiffness": 1 / h, "impedance": 1 / (s * h), "apparent_mass": 1 / (s**2 * h)}
    known = xr.DataArray(s**2 * h, {"frequency": f}, ["frequency"], attrs={"units": "(m/s^2)/(N)"})
    found = analysis.frequency_response_as(known, form)
    np.testing.assert_allclose(found.values, exact[form], rtol=1e-12)
    assert (found.name, found.units) == (form, FORMS[form])
    np.testing.assert_allclose(analysis.frequency_response_as(found, "accelerance").values, s**2 * h, rtol=1e-12)


def test_forms_of_computed_and_estimated_functions() -> None:
    """Results of rb.frequency_response and transfer_function give the same dynamic stiffness as the closed form."""
    load = rb.Harmonic(amplitude="4 N", frequency="20 Hz")
    case = rb.Case(structure=rb.SDOF(mass="2 kg", frequency="25 Hz", damping_ratio=0.02), load=load, duration="1 s")
    response = rb.frequency_response(case, [15.0, 24.0, 33.0], levels=["4 N", "8 N"], progress=False)
    found = analysis.frequency_response_as(response.sel(direction="up"), "dynamic_stiffness")
    w, n = 2 * math.pi * response.frequency.values, 50 * math.pi
    exact = 2 * (n**2 - w**2 + 0.04j * n * w)
    assert found.sizes == {"level": 2, "frequency": 3}
    np.testing.assert_allclose(found.values, [exact, exact], rtol=1e-3)
    time = np.arange(4000) / 500
    force = np.random.default_rng(2).normal(size=time.size)
    signal = xr.DataArray(force, dims="time", attrs={"units": "N"})
    motion = xr.DataArray(3 * force, dims="time", attrs={"units": "m/s^2"})
    mass = analysis.frequency_response_as(analysis.transfer_function(time, signal, motion), "apparent_mass")
    np.testing.assert_allclose(mass.sel(frequency=100, method="nearest").item(), 1 / 3, rtol=1e-6)


@pytest.mark.parametrize("zeta", [0.0005, 0.001, 0.01, 0.05, 0.2])
@pytest.mark.parametrize("unit", ["receptance", "accelerance", "dynamic_stiffness"])
def test_estimates_are_exact_for_a_linear_oscillator(zeta: float, unit: str) -> None:
    """Both estimates give frequency and damping of an oscillator, from any form and for samples off the resonance."""
    response = analysis.frequency_response_as(oscillator(zeta), unit)
    circle, width = analysis.circle_fit(response), analysis.half_power(response)
    for found in (circle, width):
        assert found.frequency == pytest.approx(37.0, rel=1e-6 * zeta + 1e-9)
    assert width.damping_ratio == pytest.approx(zeta, rel=1e-6)
    assert circle.damping_ratio == pytest.approx(zeta, rel=1e-6)
    assert circle.misfit < 1e-6


def test_estimates_of_few_samples_and_a_second_mode() -> None:
    """Ten samples over the resonance suffice; another mode at twice the frequency changes the circle fit by 0.1 %."""
    coarse = oscillator(0.02, width=4.0, samples=13)
    assert analysis.half_power(coarse).damping_ratio == pytest.approx(0.02, rel=1e-6)
    assert analysis.circle_fit(coarse).damping_ratio == pytest.approx(0.02, rel=1e-6)
    one = oscillator(0.01)
    other = 1 / (4 - (one.frequency / 37.0) ** 2 + 0.04j * one.frequency / 37.0)
    both = analysis.circle_fit((one + other).assign_attrs(units="m/N"))
    assert both.damping_ratio == pytest.approx(0.01, rel=1e-3)


def test_estimates_are_biased_by_a_damper() -> None:
    """Where damping falls with the amplitude, both estimates are below the damping at the peak, as the how-to states."""
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="12 mm", material="steel"), gap="0.5 mm", contact=rb.Tsuji(restitution=0.5)
    )
    case = rb.Case(
        structure=rb.SDOF(mass="3 kg", frequency="50 Hz", damping_ratio=0.01),
        damper=ball,
        load=rb.Harmonic(amplitude="20 N", frequency="50 Hz"),
        duration="2 s",
    )
    frequencies = rb.linspace("45 Hz", "55 Hz", 81)
    response = rb.frequency_response(case, frequencies, levels=["10 N", "80 N"], direction="up", progress=False)
    stated = {10.0: (0.0121, 0.0122, 0.0130), 80.0: (0.0100, 0.0100, 0.0103)}
    for level, expected in stated.items():
        one = response.sel(level=level)
        peak = float(one.amplitude.max())
        curve = rb.damping_curve(case, [0.7 * peak, peak], way="shaking", packings=2, progress=False)
        found = [each(one).damping_ratio for each in (analysis.half_power, analysis.circle_fit)]
        assert [*found, float(curve.damping_ratio[1])] == pytest.approx(expected, abs=6e-5)


@pytest.mark.parametrize(
    "name", ["quality_factor", "loss_factor", "logarithmic_decrement", "specific_damping_capacity"]
)
def test_measures_of_damping_lead_back(name: Any) -> None:
    """Each measure of a damping ratio has the value of its equation and gives the ratio again."""
    zeta = np.array([0.001, 0.02, 0.4])
    exact = {
        "quality_factor": 1 / (2 * zeta),
        "loss_factor": 2 * zeta,
        "logarithmic_decrement": 2 * np.pi * zeta / np.sqrt(1 - zeta**2),
        "specific_damping_capacity": 4 * np.pi * zeta,
    }[name]
    found = analysis.damping_as(zeta, name)
    np.testing.assert_allclose(found, exact, rtol=1e-14)
    np.testing.assert_allclose(analysis.damping_as(found, "damping_ratio", given=name), zeta, rtol=1e-14)
    labelled = analysis.damping_as(xr.DataArray(zeta, dims="amplitude"), name)
    assert labelled.name == name and labelled.dims == ("amplitude",)
    assert isinstance(analysis.damping_as(0.02, name), float)
    assert analysis.damping_as(analysis.damping_as(0.02, name), "loss_factor", given=name) == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.frequency_response_as(oscillator(0.01), "stiffness"), "dynamic_stiffness"),
        (lambda: analysis.frequency_response_as(oscillator(0.01).assign_attrs(units="1"), "mobility"), "m/s"),
        (lambda: analysis.half_power(oscillator(0.01).sel(frequency=slice(37, None))), "edge|both sides"),
        (lambda: analysis.half_power(oscillator(0.01, width=0.5)), "both sides"),
        (lambda: analysis.circle_fit(oscillator(0.01, samples=7)), "at least 5"),
        (lambda: analysis.damping_as(0.01, "Q"), "quality_factor"),
        (lambda: analysis.damping_as(-0.01, "loss_factor"), "negative"),
        (lambda: analysis.damping_as([0.9, 1.2], "logarithmic_decrement"), "does not oscillate"),
    ],
)
def test_wrong_arguments_are_refused(call: Any, message: str) -> None:
    """Unknown names, units of other quantities and too few samples are errors with what is allowed."""
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("drop", [0.1, 0.25, 0.5])
@pytest.mark.parametrize("gone", [2, 5])
def test_a_jump_beside_the_peak_has_no_estimate(side: int, drop: float, gone: int) -> None:
    """A response that jumps next to its largest value is refused; all functions had resonances with both flanks before."""
    frequency = 60 + 0.1 * np.arange(-40, 41)
    r = frequency / 60
    values = 1e-4 / (1 - r**2 + 0.02j * r)
    beyond = side * np.arange(-40, 41) > -gone  # the peak itself is not reached: the motion changes before it
    values[beyond] = drop * values[40 - side * gone]
    response = xr.DataArray(values, {"frequency": frequency}, attrs={"units": "m/N"})
    with pytest.raises(ValueError, match="jumps from one motion"):
        analysis.half_power(response)
    if drop < 0.5:
        with pytest.raises(ValueError, match=r"one flank|samples have half"):
            analysis.circle_fit(response)
