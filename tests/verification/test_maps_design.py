"""Loss maps, designs and sensitivities against exact values."""

from typing import Any

import numpy as np
import pytest
from support import impact_cases
from support.exact import printed, shaken

import rattlebox as rb

AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"


def test_trials_have_the_exact_loss() -> None:
    """Every trial below the best clearance has the loss of collect-and-collide."""
    result = rb.design(
        impact_cases.sticky_load(1.0, 1.0),
        {"damper.gap": ("0.2 m", "1.5 m")},
        {"reduced_loss": "max"},
        cycles=(10, 20),
        trials=12,
        progress=False,
    )
    exact = [shaken.collect_and_collide(1 / (2 * gap)) for gap in result["damper.gap"].values]
    assert result.reduced_loss.values == pytest.approx(exact, rel=1e-9)


def test_loss_map_of_an_inelastic_ball() -> None:
    """Effective mass and loss of an inelastic ball on a shaker are the published ones at any frequency."""
    case = impact_cases.inelastic_ball(1.2, 1.0)
    gammas = np.array(list(printed.APPARENT_MASS))
    # g = 1: at twice the frequency a quarter of the amplitude is the same motion.
    for ratio in (1.0, 2.0):
        result = rb.loss_map(
            case, gammas / ratio**2, [ratio / (2 * np.pi)], cycles=(10, 20), samples=20 * 4096 + 1, progress=False
        )
        exact = np.array([shaken.inelastic_ball(gamma).apparent_mass() for gamma in gammas])
        assert result.effective_mass[:, 0].values == pytest.approx(exact[:, 0], abs=1e-6)
        assert result.damping_mass[:, 0].values == pytest.approx(exact[:, 1], abs=1e-6)
        assert result.effective_mass[:, 0].values == pytest.approx(
            [m for m, _ in printed.APPARENT_MASS.values()], abs=2e-6
        )
        assert result.reduced_loss[:, 0].values == pytest.approx(np.pi * exact[:, 1], rel=1e-8)


def test_loss_map_of_two_impacts_a_cycle() -> None:
    """Above its threshold a ball that hits both walls once a cycle has the loss of the exact orbit, at any frequency."""
    e = 0.6
    ratios = np.array([1.2, 1.5, 2.0]) * shaken.threshold(e)
    for ratio in ratios.tolist():
        orbit = shaken.two_impacts(e, ratio)
        result = rb.loss_map(
            impact_cases.shaken_cavity(orbit, 1.0),
            [float(orbit.amplitude)],
            ["1 rad/s"],
            cycles=(0, 20),
            progress=False,
        )
        exact = (1 - e**2) * orbit.approach**2 / orbit.amplitude**2
        assert float(result.reduced_loss.item()) == pytest.approx(exact, rel=1e-8)
        assert float(result.impacts_per_cycle.item()) == 2


def struck() -> rb.Case:
    """Return a structure without damping or damper under a short pulse."""
    return rb.Case(
        structure=rb.SDOF(mass=2.0, stiffness=200.0, damping=0.0),
        load=rb.HalfSine(amplitude=3.0, duration=1e-4),
        duration="1 s",
    )


def pulse_indices(low: float, high: float, first: float, last: float) -> tuple[np.ndarray, np.ndarray]:
    """Return first-order and total indices of F^2 / M for uniform F in low to high and M in first to last."""

    def moment(power: int, a: float, b: float) -> float:
        return np.log(b / a) / (b - a) if power == -1 else (b ** (power + 1) - a ** (power + 1)) / (power + 1) / (b - a)

    force = moment(2, low, high), moment(4, low, high)
    mass = moment(-1, first, last), moment(-2, first, last)
    of_force, of_mass = force[1] / force[0] ** 2 - 1, mass[1] / mass[0] ** 2 - 1
    total = (1 + of_force) * (1 + of_mass) - 1
    return np.array([of_force, of_mass]) / total, np.array([of_force * (1 + of_mass), of_mass * (1 + of_force)]) / total


def test_sensitivity_of_the_energy_of_a_pulse() -> None:
    """The work of a short pulse is F^2 / M: the indices of force and mass are exact, that of stiffness is zero."""
    bounds = {"load.amplitude": (2.0, 4.0), "structure.mass": (1.0, 5.0), "structure.stiffness": (100.0, 300.0)}
    result = rb.sensitivity(struck(), bounds, "work", n=1024, progress=False).isel(measure=0)
    first, total = pulse_indices(2.0, 4.0, 1.0, 5.0)
    assert first.sum() < 1 < total.sum()
    assert result.first.values == pytest.approx([*first, 0], abs=0.03)
    assert result.total.values == pytest.approx([*total, 0], abs=0.03)
    assert np.all(np.abs(result.first.values[:2] - first) < 2 * result.first_confidence.values[:2])
    assert np.all(np.abs(result.total.values[:2] - total) < 2 * result.total_confidence.values[:2])
    impulse = 3.0 * 1e-4 * 2 / np.pi  # mean of F^2 is 28/3, of 1/M ln 5 / 4
    assert float(result["mean"]) == pytest.approx(impulse**2 / 9 * 28 / 3 * np.log(5) / 4 / 2, rel=0.01)


def test_indices_converge() -> None:
    """With sixteen times the points, the errors of the indices are at least three times smaller."""
    bounds = {"load.amplitude": (2.0, 4.0), "structure.mass": (1.0, 5.0)}
    exact = np.concatenate(pulse_indices(2.0, 4.0, 1.0, 5.0))

    def off(n: int) -> float:
        errors = []
        for seed in range(4):
            result = rb.sensitivity(struck(), bounds, "work", n=n, seed=seed, progress=False).isel(measure=0)
            errors.append(np.concatenate((result.first, result.total)) - exact)
        return float(np.sqrt(np.mean(np.square(errors))))

    assert off(512) < off(32) / 3


@pytest.mark.slow
def test_sensitivity_of_a_published_function() -> None:
    """The indices of sin x + 7 sin^2 y + 0.1 z^4 sin x over -pi to pi are found, z having a total index only."""

    def ishigami(run: Any) -> float:
        x, y, z = run.arrays.velocity[0, 0], run.arrays.displacement[0, 0], run.arrays.ball_velocity[0, 0]
        return float(np.sin(x) + 7 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x))

    case = rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1.0),
        damper=rb.ImpactDamper(ball=impact_cases.ball(1.0), gap=10.0, contact=rb.Tsuji(restitution=0.5)),
        duration=1e-3,
        method=rb.Newton(),
        output=rb.Output(times=[0.0]),
    )
    bounds = dict.fromkeys(("structure.velocity", "structure.displacement", "damper.velocity"), (-np.pi, np.pi))
    result = rb.sensitivity(case, bounds, ishigami, n=2048, progress=False).isel(measure=0)
    assert result.first.values == pytest.approx([0.3139, 0.4424, 0.0], abs=0.01)
    assert result.total.values == pytest.approx([0.5576, 0.4424, 0.2437], abs=0.01)
