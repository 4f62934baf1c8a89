"""Stops in the time loop of another program, in FMUs and in Lyapunov exponents.

All of them refused stops before, so that no test could compare them with the run as a whole.
"""

from __future__ import annotations

import math
import zipfile
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from scipy.linalg import expm

import rattlebox as rb

OMEGA = 2 * math.pi * 6.0
TOWERS = rb.ShearBuilding(masses=["3 kg", "1.5 kg"], stiffnesses=["14 kN/m", "7 kN/m"], damping_ratio=0.02)
LAW = rb.Linear(stiffness="0.8 MN/m", restitution=0.55)


def cases() -> dict[str, rb.Case]:
    """Return cases with stops on both sides, between two points, beside a ball, and hard ones."""
    mass = rb.SDOF(mass="2.5 kg", frequency="5.5 Hz", damping_ratio=0.015)
    load = rb.Harmonic(amplitude="10 N", frequency="6 Hz")
    both = rb.Stop(gap="2.5 mm", side="both", contact=LAW)
    pounding = rb.Stop(point="storey 2", other="storey 1", gap="1.2 mm", contact=LAW, side="trailing")
    ball = rb.ImpactDamper(
        ball=rb.Sphere(diameter="25 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    )
    shared: dict[str, Any] = {"duration": "0.8 s", "output": rb.Output(rate="2 kHz")}
    return {
        "both": rb.Case(structure=mass, stop=both, load=load, **shared),
        "hard": rb.Case(structure=mass, stop=both, load=load, method=rb.Newton(), **shared),
        "ball": rb.Case(structure=mass, stop=both, damper=ball, load=load, **shared),
        "pounding": rb.Case(
            structure=TOWERS, stop=pounding, load=load.model_copy(update={"point": "storey 2"}), **shared
        ),
    }


def means(step: float, count: int) -> np.ndarray[Any, Any]:
    """Return the mean of the load in each step."""
    ends = np.cos(OMEGA * step * np.arange(count + 1))
    return 10 * (ends[:-1] - ends[1:]) / (OMEGA * step)


def advanced(case: rb.Case, step: float) -> tuple[rb.Stepper, np.ndarray[Any, Any], float]:
    """Advance a case to its end; return the stepper, the impulse of each damper and stop, and the loss."""
    stepper, impulse, loss = rb.Stepper(case), 0.0, 0.0
    for number, load in enumerate(means(step, round(case.duration / step)), start=1):
        result = stepper.advance(number * step, loads=[load])
        impulse = impulse + step * np.atleast_1d(result.force)
        loss += result.loss
    return stepper, np.asarray(impulse), loss


@pytest.mark.parametrize("name", list(cases()))
def test_a_stepper_approaches_the_run_with_second_order(name: str) -> None:
    """Motion, impulses of stops and loss approach those of the run as a whole by four with half of the step."""
    case = cases()[name]
    run = rb.simulate(case)
    assert run.arrays.impacts.time.size > 4
    point = case.modes.point(case.loads[0].point)
    exact = float(run.along().displacement.sel(point=point)[-1])
    size = float(abs(run.along().displacement).max())
    errors, impulses = [], []
    for step in (1e-3, 5e-4, 2.5e-4):
        stepper, impulse, loss = advanced(case, step)
        errors.append(abs(stepper.displacement(point) - exact) / size)
        impulses.append(impulse[-run.arrays.stop_impulse.shape[1] :])
        assert stepper.energy_residual < 1e-8
    total = np.abs(run.arrays.stop_impulse[-1])
    wrong = [np.abs(each - run.arrays.stop_impulse[-1]).max() / total.max() for each in impulses]
    assert wrong[-1] < 1e-3
    assert errors[-1] < 2e-3
    assert wrong[0] / wrong[-1] == pytest.approx(16, rel=0.5)
    ledger = run.energy.losses[-1].item()
    assert loss == pytest.approx(ledger, rel=2e-3)


@pytest.mark.parametrize("name", list(cases()))
def test_a_restored_stepper_has_the_same_bits(name: str) -> None:
    """A state with stops that was saved in the middle continues with the same bits."""
    case = cases()[name]
    loads = means(1e-3, 800)
    stepper = rb.Stepper(case)
    for number in range(1, 401):
        stepper.advance(number * 1e-3, loads=[loads[number - 1]])
    state, forces = stepper.save(), []
    for again in (stepper, rb.Stepper(case)):
        again.restore(state)
        forces.append([np.copy(again.advance(n * 1e-3, loads=[loads[n - 1]]).force) for n in range(401, 801)])
    assert np.array(forces[0]).tobytes() == np.array(forces[1]).tobytes()


def test_an_fmu_has_the_forces_of_stops(tmp_path: Path) -> None:
    """The description of an FMU lists the force of each stop behind those of the dampers."""
    case = cases()["ball"]
    file = rb.to_fmu(case, tmp_path / "held.fmu")
    with zipfile.ZipFile(file) as archive:
        text = archive.read("modelDescription.xml").decode()
    assert (
        text.index('name="force_damper"')
        < text.index('name="force_stop_leading"')
        < text.index('"force_stop_trailing"')
    )
    assert "with which the stop pushes" in text


def test_an_fmu_runs_with_stops(tmp_path: Path) -> None:
    """An FMU with stops has the forces and motions of a stepper with the same steps and a constant load."""
    case = cases()["ball"]
    file = rb.to_fmu(case, tmp_path / "held.fmu")
    names = ["force_stop_leading", "force_stop_trailing", "displacement_mass"]
    found = fmpy.simulate_fmu(file, stop_time=0.5, output_interval=1e-3, output=names, start_values={"load_1": 14.0})
    stepper, rows = rb.Stepper(case), []
    for number in range(1, 501):
        force = stepper.advance(number * 1e-3, loads=[14.0]).force
        rows.append([-force[1], force[2], stepper.displacement()])
    assert max(row[0] for row in rows) > 1.0
    for name, column in zip(names, np.array(rows).T, strict=True):
        np.testing.assert_allclose(found[name][1:], column, rtol=1e-9, atol=1e-12)


def test_a_damper_alone_has_no_stops() -> None:
    """A stepper of a damper alone refuses the stops of the case: they act on its structure."""
    with pytest.raises(rb.CaseError, match="a damper alone has no structure"):
        rb.Stepper(cases()["ball"], alone=True)


# ---- exponents

RATIO, FIRST = 0.7, 2 * math.pi * 3.0


def oscillator(gap: str, frequency: float, damping: float = 0.03) -> rb.Case:
    """Return a driven oscillator with a hard stop."""
    return rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness=FIRST**2, damping_ratio=damping),
        stop=rb.Stop(gap=gap, contact=rb.Linear(stiffness="1 MN/m", restitution=RATIO)),
        load=rb.Harmonic(amplitude="4 N", frequency=frequency),
        method=rb.Newton(),
        duration="60 s",
        output=rb.Output(rate="1 kHz"),
    )


def exponent_of(case: rb.Case, frequency: float, skip: float, length: float) -> float:
    """Return the exponent of a run from the exact derivatives of flights and impacts, independent of pairs of motions."""
    run = rb.simulate(case.replaced({"duration": skip + length}))
    assert run.ok
    damping = case.structure.damping_ratio
    flight = np.array([[0, 1], [-(FIRST**2), -2 * damping * FIRST]])
    log = run.arrays.impacts
    inside = log.time > skip
    assert (log.duration[inside] == 0).all()  # no time at the stop
    vector, growth, before, begin = np.array([1.0, 0.3]), 0.0, skip, skip
    gap = case.stops[0].gap
    for number, (time, speed) in enumerate(zip(log.time[inside], log.approach_speed[inside], strict=True)):
        vector = expm(flight * (time - before)) @ vector
        force = 4 * math.sin(2 * math.pi * frequency * time)

        def acceleration(velocity: float, force: float = force) -> float:
            return force - 2 * damping * FIRST * velocity - FIRST**2 * gap

        turn = (RATIO * acceleration(speed) + acceleration(-RATIO * speed)) / speed
        vector = np.array([[-RATIO, 0], [turn, -RATIO]]) @ vector
        size = float(np.linalg.norm(vector * [FIRST, 1]))
        growth, vector, before = growth + math.log(size), vector / size, time
        if number == 9:  # the vector has turned into the direction of the largest growth
            growth, begin = 0.0, time
    return growth / (before - begin)


def test_without_contact_the_exponent_is_the_decay() -> None:
    """Motions that never reach their stop approach each other as a linear oscillator decays."""
    found = rb.lyapunov(oscillator("0.5 m", 2.0), cycles=(20, 60), pairs=4)
    assert float(found.exponent) == pytest.approx(-0.03 * FIRST, rel=0.02)


@pytest.mark.parametrize(("gap", "frequency"), [("4 mm", 4.4), ("0 mm", 5.5), ("2 mm", 8.5), ("2 mm", 8.0)])
def test_exponents_agree_with_the_derivatives_of_impacts(gap: str, frequency: float) -> None:
    """Exponents of pairs agree with those of the derivatives along one motion, periodic or chaotic, also without a gap."""
    case = oscillator(gap, frequency)
    found = rb.lyapunov(case, cycles=(100, 400), pairs=6)
    exact = exponent_of(case, frequency, 100 / frequency, 400 / frequency)
    assert (exact > 0) == (frequency == 8.0)
    # The angle of the vector at both ends changes its length by a factor of a few.
    slack = 2.5 * frequency / 400
    assert float(found.exponent) == pytest.approx(exact, abs=slack + (0.15 * exact if exact > 0 else 0))
