"""The 3-D engine against exact solutions: lines of the verification table, and orders of convergence."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from support import known_particles
from support.exact import printed
from support.known_impacts import Comparison

import rattlebox as rb


@pytest.mark.parametrize(
    "lines",
    [
        pytest.param(f, id=f.__name__, marks=pytest.mark.slow if f is known_particles.hydrostatic else ())
        for f in known_particles.ALL
    ],
)
def test_run_has_the_exact_value(lines: Callable[[], Iterator[Comparison]]) -> None:
    """Every line of the verification table is within its tolerance."""
    result = list(lines())
    assert result
    failed = [f"{line.case}: {line.ours!r}, exact {line.exact!r}" for line in result if not line.within_tolerance]
    assert not failed, "\n".join(failed)


@pytest.mark.parametrize("name", known_particles.IMPACTS)
def test_elastic_impacts_have_the_printed_values(name: str) -> None:
    """Tests 1 and 2 of Chung and Ooi: force, overlap and time agree with all six digits that are printed."""
    for ours, shown in zip(
        known_particles.elastic_impact(*known_particles.IMPACTS[name]), printed.ELASTIC[name], strict=True
    ):
        assert ours == pytest.approx(shown, rel=1e-5)


@pytest.mark.parametrize("e", printed.FALLING)
def test_falling_ball_has_the_printed_values(e: float) -> None:
    """The exact solution for MFiX's falling ball has the printed speeds and time to six digits."""
    for exact, shown in zip(known_particles.bounce(e), printed.FALLING[e], strict=True):
        assert shown is None or exact == pytest.approx(shown, rel=5e-6)


@pytest.mark.parametrize("law", known_particles.LAWS)
def test_one_ball_in_one_direction_agrees_with_the_impact_engine(law: str) -> None:
    """Structure and ball converge to the 1-D engine over eight impacts or more, with the square of the step."""
    *exact, impacts = known_particles.one_ball_exactly(law)
    assert impacts >= 8

    def error(dt: float) -> Any:
        return [np.sqrt(np.mean((a - b) ** 2)) for a, b in zip(known_particles.one_ball(law, dt), exact, strict=True)]

    coarse, fine = np.array(error(4e-7)), np.array(error(2.5e-8))
    # The time of each touch within its step is random, so only the mean order is checked.
    assert np.log2(coarse / fine) / 4 == pytest.approx(2, abs=0.4)
    assert fine[1] < 1e-4 * known_particles.PLAY


@pytest.mark.parametrize("part", [0.3, 0.8, 0.97])
def test_ball_stands_on_a_gentle_slope(part: float) -> None:
    """A ball rests on a slope below the coefficient of rolling resistance, after a small displacement."""
    path, speed = known_particles.along(
        known_particles.on_floor(0.0, 0.0, 0.5, rolling=rb.Rolling(0.05, damping=0.3), slope=part * 0.05)
    )
    assert np.abs(speed[-1]) < 1e-9
    assert 0 < path[-1] < 5e-6
    assert path[-1] == pytest.approx(path[500], abs=1e-9)


def test_ball_without_resistance_rolls_on() -> None:
    """Without rolling resistance a rolling ball has constant speed and no friction loss."""
    result = known_particles.on_floor(0.3, 0.3 / 0.02, 0.5)
    _, speed = known_particles.along(result)
    assert speed[-1] == pytest.approx(0.3, rel=1e-4)
    energy = 0.7 * result.arrays.particles.mass[0] * 0.3**2
    assert result.arrays.sliding_loss[-1].sum() < 1e-4 * energy
    assert result.arrays.rolling_loss[-1].sum() == 0


@pytest.mark.parametrize(
    "name", ["box", *(pytest.param(n, marks=pytest.mark.slow) for n in ("lying cylinder", "sphere"))]
)
def test_settled_fill_loads_its_cavity_with_its_weight(name: str) -> None:
    """The cavity of a settled fill carries its weight, and the lateral forces cancel."""
    force, weight = known_particles.settled(name)
    assert force == pytest.approx((0, 0, -weight), abs=1e-6 * weight)
