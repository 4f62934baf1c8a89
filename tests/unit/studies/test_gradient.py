"""Derivatives of measures: differences of runs, exact cases, and refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.support.smooth_differences import difference

import rattlebox as rb

PATHS = ["damper.gap", "structure.mass", "structure.frequency", "damper.contact.restitution", "structure.velocity"]


def case(**changes: Any) -> rb.Case:
    """Return a structure that is struck and its impact damper."""
    return rb.Case(
        structure=rb.SDOF(mass="0.8 kg", frequency="18 Hz", damping_ratio=0.01, velocity="0.4 m/s"),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="13 mm", material="steel"), gap="1.7 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        method=rb.Newton(),
        duration="90 ms",
    ).replaced(changes)


def shaken(**changes: Any) -> rb.Case:
    """Return the same under a harmonic load, in two impacts a cycle."""
    return rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="38 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude="5 N", frequency="32 Hz"),
        method=rb.Newton(),
        duration="3 s",
    ).replaced(changes)


@pytest.mark.parametrize("measure", ["displacement", "velocity", "energy", "peak", "rms"])
@pytest.mark.parametrize("method", [rb.Newton(), rb.EventDriven(tolerance=1e-13)], ids=["hard", "soft"])
def test_transients(measure: str, method: Any) -> None:
    """Derivatives of each measure of a transient equal differences of the measure of runs."""
    one = case(method=method, duration="78 ms")
    result = rb.gradient(one, measure, PATHS)
    for path in PATHS:
        value = {"damper.gap": 1.7e-3, "structure.mass": 0.8, "structure.frequency": 18, "structure.velocity": 0.4}.get(
            path, 0.6
        )

        def measured(h: float, path: str = path, value: float = value) -> Any:
            moved = one.replaced({path: value * (1 + h)})
            return np.array([float(rb.gradient(moved, measure, "structure.mass").value)])

        differences, rough = difference(measured, step=4e-4, trials=1)
        exact = float(result.derivative.sel(parameter=path)) * value
        # Quadrature of soft contacts, whose forces begin with a root of the overlap.
        tolerance = 1e-6 if measure == "rms" and method.kind != "newton" else 1e-8
        assert exact == pytest.approx(differences[0], rel=tolerance, abs=1e-9 * abs(float(result.value)) + 10 * rough)


def test_measures_are_those_of_runs() -> None:
    """Values are those of the run: displacement, velocity and energy at the end, peak and RMS of fine samples."""
    one = case(output=rb.Output(rate="200 kHz"))
    run = rb.simulate(one)
    z = run.motion.displacement.squeeze()
    assert float(rb.gradient(one, "displacement", "damper.gap").value) == pytest.approx(float(z[-1]), rel=1e-9)
    assert float(rb.gradient(one, "peak", "damper.gap").value) == pytest.approx(float(abs(z).max()), rel=1e-6)
    time = z.time.values
    rms = np.sqrt(np.trapezoid(z.values**2, time) / time[-1])
    assert float(rb.gradient(one, "rms", "damper.gap").value) == pytest.approx(rms, rel=1e-6)


def test_peak_at_an_impact() -> None:
    """A heavy slug stops the structure at the wall: the peak is the gap, and its derivative in the gap is 1."""
    one = case(damper=rb.ImpactDamper(ball=rb.Striker(mass="3 kg"), gap="1.5 mm", contact=rb.Tsuji(restitution=0.6)))
    result = rb.gradient(one.replaced({"duration": "15 ms"}), "peak", ["damper.gap", "structure.mass"])
    assert float(result.value) == pytest.approx(1.5e-3, rel=1e-9)
    np.testing.assert_allclose(result.derivative.values, [1, 0], atol=1e-8)


def test_peak_at_the_start() -> None:
    """The peak of a structure that is released is its first displacement."""
    one = case().replaced({"structure.velocity": 0.0, "structure.displacement": "3 mm"})
    result = rb.gradient(one, "peak", ["structure.displacement", "damper.gap"])
    np.testing.assert_allclose(result.derivative.values, [1, 0], atol=1e-12)


def test_equal_elastic_balls() -> None:
    """Two equal elastic balls exchange their speeds: derivatives are (0, 1) and (1, 0)."""
    one = rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(
            balls=[rb.Sphere(radius="9 mm", material="steel")] * 2,
            gap="20 mm",
            contact=rb.Tsuji(restitution=1.0),
            start=["-18 mm", "10 mm"],
            velocity=[0.8, 0.1],
            name="row",
        ),
        duration="44 ms",
        method=rb.Newton(),
    )
    speeds = ["damper.velocity[0]", "damper.velocity[1]"]
    for ball, expected in (("row/1", [0, 1]), ("row/2", [1, 0])):
        result = rb.gradient(one, "velocity", speeds, point=ball)
        np.testing.assert_allclose(result.derivative.values, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("measure", ["peak", "rms", "energy"])
def test_periodic_motions(measure: str) -> None:
    """Derivatives of a periodic motion equal differences between the periodic motions of changed cases."""
    orbit = rb.find_orbit(shaken())
    values = {"damper.gap": 1e-3, "load.amplitude": 5.0, "load.frequency": 32.0, "structure.mass": 1.0}
    result = rb.gradient(orbit, measure, list(values))
    for path, value in values.items():

        def measured(h: float, path: str = path, value: float = value) -> Any:
            other = rb.find_orbit(shaken().replaced({path: value * (1 + h)}), near=orbit, period=orbit.cycles)
            return np.array([float(rb.gradient(other, measure, "structure.mass").value)])

        differences, rough = difference(measured, step=3e-4, trials=1)
        exact = float(result.derivative.sel(parameter=path)) * value
        assert exact == pytest.approx(differences[0], rel=1e-7, abs=10 * rough)


def test_units() -> None:
    """Value and derivatives state their units."""
    result = rb.gradient(case(), "peak", ["damper.gap", "structure.mass"])
    assert result.value.units == "m"
    assert result.unit.values.tolist() == ["m/(m)", "m/(kg)"]


def chaotic() -> rb.Case:
    """Return a motion in which small changes grow."""
    return shaken(load=rb.Harmonic(amplitude="5 N", frequency="31 Hz")).replaced({"duration": "1.5 s"})


def twins() -> rb.Case:
    """Return a struck structure with two equal dampers, whose balls hit at one instant."""
    dampers = [rb.ImpactDamper(**BALL, contact=rb.Tsuji(restitution=0.5), start=0) for _ in range(2)]
    return rb.Case(structure=case().structure, dampers=dampers, method=rb.Newton(), duration="90 ms")


BALL = {"ball": rb.Sphere(radius="13 mm", material="steel"), "gap": "1.7 mm"}
REFUSED = {
    "chaos": (chaotic, {}, "practically chaotic"),
    "chatter": (
        lambda: case(
            damper=rb.ImpactDamper(**BALL, contact=rb.Tsuji(restitution=0.5), gravity=9.81, start=0.9), duration="0.4 s"
        ),
        {},
        "close to grazing",
    ),
    "two equal dampers": (
        twins,
        {"parameters": "structure.mass"},
        "at one instant",
    ),
    "restitution of 1": (
        lambda: case(**{"damper.contact": rb.Tsuji(restitution=1.0), "method": rb.EventDriven()}),
        {"parameters": "damper.contact.restitution"},
        "has a kink",
    ),
    "unknown measure": (case, {"measure": "peak_contact_force"}, "no derivative of the measure"),
    "time outside": (case, {"time": 2.0}, "is not within the motion"),
    "time of a peak": (case, {"time": 0.01, "measure": "peak"}, "has no time"),
    "no path": (case, {"parameters": []}, "at least one path"),
    "a text": (case, {"parameters": "damper.ball.material"}, "needs a number"),
    "a file": (lambda: "case.toml", {}, "a case or a periodic motion is needed"),
    "a number of dampers": (case, {"parameters": "damper.number"}, "whole numbers"),
    "unknown point": (case, {"point": "roof"}, "no point"),
    "fixed steps": (lambda: case(method=rb.TwoStep()), {}, "has no derivatives"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refusals(name: str) -> None:
    """Motions and arguments without a derivative are refused with the reason and advice."""
    make, options, words = REFUSED[name]
    arguments = {"measure": "displacement", "parameters": "damper.gap", **options}
    with pytest.raises(rb.CaseError, match=words) as error:
        rb.gradient(make(), **arguments)
    assert "try:" in str(error.value) or name in ("a text", "unknown point")
