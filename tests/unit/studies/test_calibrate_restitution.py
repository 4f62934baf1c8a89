"""Restitution from drops and bounces: exact values, coverage of intervals, and errors of measurements."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.calibration.restitution import impacts_of

BALL = rb.Sphere(diameter="3 mm", material="glass")


def bounces(e: Any, first: float = 0.4, count: int = 7, start: float = 0.1) -> np.ndarray:
    """Return times of contacts with a restitution, or one for each contact."""
    flights = first * np.concatenate([[1.0], np.cumprod(np.broadcast_to(e, (count - 2,)))])
    return start + np.concatenate([[0.0], np.cumsum(flights)])


def test_restitution_of_a_drop_is_the_root_of_the_heights() -> None:
    """Heights without scatter give the exact value; the interval has no width, with a warning."""
    result = rb.calibrate(rb.Drops(height=["1 m", "1 m"], rebound=["64 cm", "640 mm"]))
    assert result.value.item() == pytest.approx(0.8, rel=1e-12)
    assert result.upper.item() - result.lower.item() < 1e-12
    assert "no width" in " ".join(result.warnings)
    assert result.approach_speed.values == pytest.approx(np.sqrt(2 * 9.80665))


def test_restitution_of_bounces_is_the_ratio_of_flights() -> None:
    """Times of contacts of a constant restitution give it, from any first time."""
    for start in (-3.0, 0.0, 12.0):
        result = rb.calibrate(rb.BounceTimes(bounces(0.73, start=start)))
        assert result.value.item() == pytest.approx(0.73, rel=1e-9)
    drops = [(1e3 * bounces(0.73, count=count), "ms") for count in (5, 7)]
    assert rb.calibrate(rb.BounceTimes(drops)).value.item() == pytest.approx(0.73, rel=1e-9)
    assert result.approach_speed[0].item() == pytest.approx(0.4 * 9.80665 / 2)


@pytest.mark.parametrize("error", [None, "1 mm"])
def test_intervals_of_drops_hold_the_planted_value(error: str | None) -> None:
    """Of 400 data sets of five drops, 95 % of the intervals hold the restitution; with reading errors as many or more."""
    rng = np.random.default_rng(5)
    hits = 0
    for _ in range(400):
        e = 0.82 * np.exp(0.015 * rng.standard_normal(5))
        rebound = 0.3 * e**2 + (0.001 * rng.standard_normal(5) if error else 0.0)
        found = rb.calibrate(rb.Drops(height=0.3, rebound=rebound, error=error))
        hits += bool(found.lower.item() <= 0.82 <= found.upper.item())
    assert 0.92 <= hits / 400 <= (0.99 if error else 0.98)


@pytest.mark.parametrize(("scatter", "timing", "least"), [(0.02, 0.0, 0.92), (0.0, 3e-4, 0.94), (0.01, 1e-4, 0.92)])
def test_intervals_of_bounces_hold_the_planted_value(scatter: float, timing: float, least: float) -> None:
    """Scatter of the restitution gives 95 %; errors of the times, which cancel along a sequence, give wider intervals."""
    rng = np.random.default_rng(7)
    hits = 0
    for _ in range(400):
        times = bounces(0.8 * np.exp(scatter * rng.standard_normal(6)), count=8)
        found = rb.calibrate(rb.BounceTimes(times + timing * rng.standard_normal(8)))
        hits += bool(found.lower.item() <= 0.8 <= found.upper.item())
    assert hits / 400 >= least
    if not timing:
        assert hits / 400 <= 0.98


def test_reading_errors_give_an_interval_of_three_contacts() -> None:
    """The error of ln(T_2/T_1) is that of three independent times."""
    times = np.array([0.1, 0.5, 0.82])
    result = rb.calibrate(rb.BounceTimes(times, error="1 ms"))
    rng = np.random.default_rng(1)
    noisy = times + 1e-3 * rng.standard_normal((100_000, 3))
    flights = np.diff(noisy)
    expected = 1.96 * np.log(flights[:, 1] / flights[:, 0]).std()
    assert np.log(result.upper / result.value).item() == pytest.approx(expected, rel=0.01)


def test_a_speed_dependence_without_noise_is_found() -> None:
    """Restitutions as v^(-1/4) give this exponent exactly and a warning; a constant one gives none."""
    heights = np.array([0.05, 0.1, 0.2, 0.4, 0.8])
    speeds = np.sqrt(2 * 9.80665 * heights)
    result = rb.calibrate(rb.Drops(heights, heights * (0.7 * speeds**-0.25) ** 2))
    assert result.exponent.item() == pytest.approx(-0.25, abs=1e-9)
    assert "depends on the approach speed" in " ".join(result.warnings)
    constant = rb.calibrate(rb.Drops(heights, 0.49 * heights))
    assert "depends" not in " ".join(constant.warnings)
    steady = rb.calibrate(rb.Drops(heights, heights * (0.7 * speeds**-0.001) ** 2))
    assert steady.exponent.item() == pytest.approx(-0.001, abs=1e-9)
    assert "depends" not in " ".join(steady.warnings)
    rng = np.random.default_rng(2)
    rough = rb.calibrate(rb.Drops(heights, heights * (0.7 * rng.uniform(0.7, 1.3, 5)) ** 2))
    assert abs(rough.exponent.item()) > 0.02 and "depends" not in " ".join(rough.warnings)


def test_drag_of_air_is_that_of_an_integrated_fall() -> None:
    """A planted restitution is recovered from a fall and rise through air, which the heights alone miss by over 1 %."""
    from scipy.integrate import solve_ivp

    area, mass, e = np.pi * BALL.half**2, BALL.weight, 0.9

    def motion(_: float, state: np.ndarray) -> list[float]:
        speed = abs(state[1])
        reynolds = max(speed * 2 * BALL.half * 1.204 / 1.825e-5, 1e-12)
        drag = 24 / reynolds * (1 + 0.15 * reynolds**0.687) if reynolds < 1000 else 0.44
        return [state[1], -9.80665 - np.sign(state[1]) * drag * 1.204 * area * speed**2 / (2 * mass)]

    def event(_: float, state: np.ndarray) -> float:
        return float(state[0])

    event.terminal = True  # type: ignore[attr-defined]
    options = {"rtol": 1e-10, "atol": 1e-12, "max_step": 1e-3}
    fall = solve_ivp(motion, (0, 2), [0.5, 0.0], events=event, **options)
    impact = -fall.y[1, -1]
    rise = solve_ivp(motion, (0, 2), [1e-12, e * impact], events=event, **options)
    rebound = rise.y[0].max()
    heights = {"height": [0.5, 0.5], "rebound": [rebound, rebound]}
    assert rb.calibrate(rb.Drops(**heights, ball=BALL)).value.item() == pytest.approx(e, rel=1e-4)
    assert rb.calibrate(rb.Drops(**heights)).value.item() < 0.99 * e


def test_heights_to_the_top_of_the_ball_are_reduced() -> None:
    """Heights to the centre or top, less the radius or diameter, give the restitution of the fall."""
    steel = rb.Sphere(diameter="20 mm", material="steel")
    for point, extra in (("bottom", 0), ("centre", 10), ("top", 20)):
        data = rb.Drops(([200 + extra] * 2, "mm"), ([128 + extra] * 2, "mm"), measured_to=point, ball=steel)
        assert rb.calibrate(data).value.item() == pytest.approx(0.8, rel=2e-3)  # drag of a heavy ball


def test_several_measurements_are_pooled_or_found_to_differ() -> None:
    """Data sets of one restitution give one mean; data sets of two give a warning."""
    rng = np.random.default_rng(2)

    def drops(e: float) -> rb.Drops:
        return rb.Drops(0.3, 0.3 * (e * np.exp(0.01 * rng.standard_normal(6))) ** 2)

    same = rb.calibrate([drops(0.8), drops(0.8), rb.BounceTimes([bounces(0.8), bounces(0.8)])])
    assert same.sizes["impact"] == 22
    assert same.lower.item() < 0.8 < same.upper.item()
    assert "differ by more" not in " ".join(same.warnings)
    assert "differ by more" in " ".join(rb.calibrate([drops(0.8), drops(0.7)]).warnings)


def test_a_missed_contact_is_found() -> None:
    """A sequence without one of its contacts is refused, or the odd restitution is named."""
    with pytest.raises(rb.CaseError, match="longer than the one before"):
        rb.BounceTimes(np.delete(bounces(0.8), 3))
    result = rb.calibrate(rb.BounceTimes(np.delete(bounces(0.55, count=9), 4)))
    assert "missed contact" in " ".join(result.warnings)


def test_values_without_units_are_noted() -> None:
    """Numbers without units are read as SI, with a note; a drop from 300 m gives a warning."""
    result = rb.calibrate(rb.Drops(height=300, rebound=[192, 189, 194]))
    text = " ".join(result.warnings)
    assert "height has no unit, m is assumed: the largest is 300 m" in text and "check the unit" in text
    assert not rb.calibrate(rb.Drops(height="300 mm", rebound=["192 mm", "189 mm", "194 mm"])).warnings


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rb.calibrate(rb.Drops("300 mm", "192 mm")), "one drop has no scatter"),
        (lambda: rb.calibrate(rb.BounceTimes([0.1, 0.5, 0.82])), "three contacts have one ratio"),
        (lambda: rb.BounceTimes([0.1, 0.5]), "2 contacts cannot"),
        (lambda: rb.BounceTimes([0.1]), "1 contact cannot"),
        (lambda: rb.BounceTimes("0.1 s"), "1 contact cannot"),
        (lambda: rb.BounceTimes([0.1, 0.9, 0.5, 1.1]), "is not after"),
        (lambda: rb.BounceTimes([[0.1, 0.5, 0.8], 0.9]), r"times\[0\]"),
        (lambda: rb.BounceTimes([[0.1, 0.5, 0.8], [0.1, float("nan"), 0.8]]), r"times\[1\]\[1\]"),
        (lambda: rb.Drops("300 mm", ["310 mm", "190 mm"]), r"rebound\[0\]\n.*above the height of the drop"),
        (lambda: rb.Drops(["300 mm", "-200 mm"], ["190 mm"] * 2), r"height\[1\]\n.*greater than zero"),
        (lambda: rb.Drops(0.3, [0.19, float("nan")]), r"rebound\[1\]\n.*finite"),
        (lambda: rb.Drops(["0.3 m"] * 3, ["0.2 m"] * 2), "3 heights, but 2 rebounds"),
        (lambda: rb.Drops("0.3 s", "0.2 m"), "a length"),
        (lambda: rb.Drops("0.3 m", []), r"rebound\n.*no value"),
        (lambda: rb.Drops("0.3 m", ["0.2 m"], measured_to="centre"), "need its radius"),
        (lambda: rb.Drops("0.3 m", ["0.2 m"], measured_to="middle"), "not a point of the ball"),
        (
            lambda: rb.Drops("5 mm", ["4 mm"], measured_to="top", ball=rb.Sphere(radius="5 mm", material="steel")),
            "below",
        ),
        (lambda: rb.Drops(0.3, ["0.2 m", 0.19]), "one unit for all"),
        (lambda: rb.calibrate([]), "data\n.*empty"),
        (lambda: rb.calibrate(["0.3 m"]), "not a measurement"),
        (lambda: rb.calibrate(rb.Drops(0.3, [0.2, 0.21]), rb.reference_case()), "without simulations"),
    ],
)
def test_errors_name_the_value(make: Any, words: str) -> None:
    """Each wrong measurement raises an error with the place and what is wrong."""
    with pytest.raises(rb.CaseError, match=words):
        make()


def test_reading_errors_of_heights_propagate() -> None:
    """The standard deviation of the sum of ln e = ln(h_1 / h_0) / 2 is that of random reading errors of all heights."""
    drops, rebounds = np.array([0.3, 0.6, 1.0]), np.array([0.18, 0.4, 0.5])
    rng = np.random.default_rng(1)
    read = [heights + 1e-3 * rng.standard_normal((40_000, 3)) for heights in (drops, rebounds)]
    scatter = (np.log(read[1] / read[0]) / 2).sum(axis=1).std()
    assert impacts_of(rb.Drops(height=drops, rebound=rebounds, error="1 mm")).error == pytest.approx(scatter, rel=0.02)
