"""Lyapunov exponents of motions whose exponents are known."""

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import lyapunov_exponent

TIME = np.linspace(0, 10, 201)


def test_exact_growth_until_it_saturates():
    """Growth at a known rate is found exactly up to saturation; what follows does not bend the line."""
    separation = np.minimum(1e-9 * np.exp(2.5 * TIME), 1.0)
    result = lyapunov_exponent(TIME, separation, saturation=1e-2)
    assert float(result.exponent) == pytest.approx(2.5, rel=1e-12)
    assert float(result.standard_error) < 1e-12
    end = np.log(1e7) / 2.5
    np.testing.assert_allclose(result.fit.dropna("time"), 2.5 * TIME[end > TIME], atol=1e-9)
    np.testing.assert_allclose(result.growth.sel(time=slice(None, end)), 2.5 * TIME[end > TIME], atol=1e-9)
    assert float(result.growth[-1]) == pytest.approx(np.log(1e9))


def test_mean_over_pairs_and_its_error():
    """Pairs with rates 1, 2 and 3 have the mean 2 with the standard error of their spread."""
    separations = 1e-6 * np.exp(np.outer([1.0, 2.0, 3.0], TIME - 5.0))
    result = lyapunov_exponent(TIME - 5.0, separations, saturation=1e30)
    assert float(result.exponent) == pytest.approx(2.0)
    assert float(result.standard_error) == pytest.approx(1 / np.sqrt(3))


def test_error_of_a_single_pair():
    """The error of one pair is that of a straight line through independent scatter: its spread over many draws."""
    rng = np.random.default_rng(3)
    draws = [
        lyapunov_exponent(TIME, np.exp(0.5 * TIME + 0.2 * rng.standard_normal(TIME.size)), saturation=1e9)
        for _ in range(200)
    ]
    spread = np.std([float(result.exponent) for result in draws])
    assert np.mean([float(result.standard_error) for result in draws]) == pytest.approx(spread, rel=0.15)


def test_cat_map():
    """Neighbours under Arnold's map of the torus part at the logarithm of the square of the golden ratio."""
    rng = np.random.default_rng(5)
    points = rng.random((2, 100))
    shadows = points + 1e-10 * rng.standard_normal(points.shape)
    separations = []
    for _ in range(60):
        apart = np.abs(points - shadows)
        separations.append(np.hypot(*np.minimum(apart, 1 - apart)))
        points, shadows = (np.array([2 * x + y, x + y]) % 1.0 for x, y in (points, shadows))
    exact = np.log((3 + np.sqrt(5)) / 2)
    result = lyapunov_exponent(np.arange(60.0), np.transpose(separations), saturation=1e-2)
    assert float(result.exponent) == pytest.approx(exact, rel=0.02)
    assert result.fit.count() < 25
    assert result.exponent.attrs == {"units": "1/s", "long_name": "finite-time Lyapunov exponent"}
    # Without the first few cycles, in which neighbours turn into the growing direction, it is exact.
    turned = lyapunov_exponent(np.arange(55.0), np.transpose(separations)[:, 5:], saturation=1e-2)
    assert float(turned.exponent) == pytest.approx(exact, rel=1e-3)


def test_logistic_map_scatters_about_the_exact_exponent():
    """The fully chaotic logistic map, whose growth differs from step to step, gives ln 2 within its standard error."""
    rng = np.random.default_rng(7)
    points = np.sin(0.5 * np.pi * rng.random(400)) ** 2
    shadows = np.clip(points + 1e-8 * rng.standard_normal(400), 0.0, 1.0)
    separations = []
    for _ in range(14):
        separations.append(np.abs(points - shadows))
        points, shadows = 4 * points * (1 - points), 4 * shadows * (1 - shadows)
    result = lyapunov_exponent(np.arange(14.0), np.transpose(separations), saturation=1e-3)
    assert float(result.standard_error) < 0.02
    assert abs(float(result.exponent) - np.log(2)) < 3 * float(result.standard_error)


def test_unstable_orbit_of_a_bouncing_ball():
    """Beyond period doubling, the growth rate of simulated neighbours is the logarithm of the orbit's exact multiplier.

    A ball bounces on a table gamma sin t with g = 1, once a cycle. The map from bounce to bounce has determinant e^2 and
    trace 1 + e^2 - (1 + e)^2 gamma sin(phase of the impact).
    """
    e, gamma = 0.5, 2.0
    phase = np.arccos(np.pi * (1 - e) / (1 + e) / gamma)
    trace = 1 + e**2 - (1 + e) ** 2 * gamma * np.sin(phase)
    multiplier = trace / 2 - np.sqrt(trace**2 / 4 - e**2)
    cycles = 2 * np.pi * np.arange(20)

    def heights(shift):
        """Return positions and velocities at the top of each flight; the table's phase is half a cycle on."""
        top = gamma * np.sin(phase) + 0.5 * np.pi**2 + gamma * np.sin(phase)
        case = rb.Case(
            structure=rb.Shaker(
                motion=rb.Harmonic(amplitude=f"{gamma} m", frequency="1 rad/s", phase=float(phase + np.pi))
            ),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius=0.01, material="steel", mass=1.0),
                gap=1e3,
                start=(top + shift) / 1e3 - 1,
                velocity=float(gamma * np.cos(phase)),
                contact=rb.Tsuji(restitution=e),
                gravity=-1.0,
            ),
            duration=float(cycles[-1]),
            method=rb.Newton(restitution=e),
            output=rb.Output(times=cycles.tolist()),
        )
        arrays = rb.simulate(case).arrays
        return arrays.relative_position[:, 0], arrays.relative_velocity[:, 0]

    (x, v), (x_near, v_near) = heights(0.0), heights(1e-7)
    # Three cycles turn the neighbour into the growing direction.
    result = lyapunov_exponent(cycles[3:], np.hypot(x - x_near, v - v_near)[3:], saturation=1e-3)
    assert 5 <= result.fit.count() <= 10
    assert float(result.exponent) == pytest.approx(np.log(abs(multiplier)) / (2 * np.pi), rel=1e-3)


@pytest.mark.parametrize(
    ("separations", "saturation", "message"),
    [
        (np.zeros(201), 1.0, "separations .* 0, but must be above zero"),
        (np.ones(201), 0.5, r"only 0 samples .* 0\.5"),
        (np.ones(201), 0.0, r"saturation is 0\.0"),
        (np.ones((3, 200)), 1.0, r"separations\[0\] has 200 samples, but time has 201"),
        (np.ones((2, 3, 201)), 1.0, r"shape \(2, 3, 201\)"),
        (np.full((2, 201), np.nan), 1.0, r"separations\[0\]\[0\] is nan"),
    ],
)
def test_bad_separations_are_refused(separations, saturation, message):
    """Separations that have no logarithm, no room to grow or no matching times are refused."""
    with pytest.raises(ValueError, match=message):
        lyapunov_exponent(TIME, separations, saturation=saturation)
