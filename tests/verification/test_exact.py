"""The exact solutions, compared with printed values and with the conditions that they must satisfy."""

import math

import numpy as np
import pytest
from support.exact import dashpot, impact_oscillator, masri_caughey, printed, restitution_laws, shaken

ENDINGS = ("zero_overlap", "zero_force")


def digits(value: float, shown: float, places: int) -> None:
    """Assert equality up to rounding in the last place shown."""
    assert value == pytest.approx(shown, abs=0.5000001 * 10**-places, rel=0)


@pytest.mark.parametrize("zeta", printed.TSUJI_RESTITUTION)
def test_restitution_of_a_dashpot_has_the_printed_values(zeta: float) -> None:
    """Restitution of the damped contact agrees with the printed seven places for both endings."""
    for ending, shown in zip(ENDINGS, printed.TSUJI_RESTITUTION[zeta], strict=True):
        digits(dashpot.restitution(zeta, ending), shown, 7)


@pytest.mark.parametrize("zeta", printed.TSUJI_CONTACT_TIME)
def test_contact_time_of_tsuji_has_the_printed_values(zeta: float) -> None:
    """Contact time of Tsuji's law agrees with the printed places for both endings."""
    for ending, shown in zip(ENDINGS, printed.TSUJI_CONTACT_TIME[zeta], strict=True):
        digits(dashpot.tsuji_contact_time(zeta, ending), shown, 7 if zeta == 0 else 5)


def test_hertz_contact_time_follows_from_the_gamma_function() -> None:
    """Without damping the contact time is that of Hertz, known in closed form."""
    closed = math.sqrt(math.pi) * math.gamma(0.4) / math.gamma(0.9) * 0.8
    digits(closed, dashpot.HERTZ_TIME, 7)
    assert dashpot.tsuji_contact_time(0, "zero_overlap") == pytest.approx(closed * 1.25**0.4, rel=1e-12)
    assert dashpot.tsuji_peak_overlap(0) == pytest.approx(1.25**0.4, rel=1e-14)


@pytest.mark.parametrize("ratio", printed.JACKSON_GREEN)
def test_jackson_green_has_the_printed_values(ratio: float) -> None:
    """The law of Jackson and Green agrees with the printed seven places."""
    digits(restitution_laws.jackson_green(ratio, 0.00515), printed.JACKSON_GREEN[ratio], 7)


@pytest.mark.parametrize("hits", printed.JACKSON_GREEN_HITS)
def test_hits_in_a_still_cavity_have_the_printed_values(hits: int) -> None:
    """Speeds after n hits agree with the printed six places."""
    digits(restitution_laws.jackson_green_after(10, hits, 0.00515), printed.JACKSON_GREEN_HITS[hits], 6)


def test_jackson_green_speed_of_the_steel_ball() -> None:
    """Critical speeds of the steel ball on steel and on a rigid wall have the printed values."""
    mass = 7850 * 4 / 3 * math.pi * 0.03317**3
    together = 20 * mass / (20 + mass)
    steel, rigid = 100e9 / 0.91, 200e9 / 0.91
    for m, modulus, shown in (
        (mass, steel, 0.1645947),
        (together, steel, 0.1694607),
        (mass, rigid, 0.0411487),
        (together, rigid, 0.0423652),
    ):
        digits(restitution_laws.jackson_green_speed(0.03317, m, modulus, 1030e6, 0.3), shown, 7)


@pytest.mark.parametrize("ratio", printed.THORNTON)
def test_thornton_has_the_printed_values(ratio: float) -> None:
    """The restitution of Thornton agrees with the printed seven places."""
    digits(restitution_laws.thornton(ratio), printed.THORNTON[ratio], 7)


def test_thornton_tail_is_a_quarter_power() -> None:
    """At high speed restitution falls with the fourth root of the speed."""
    ratio = 1e12
    assert restitution_laws.thornton(ratio) * ratio**0.25 == pytest.approx(1.18499, abs=5e-6)


@pytest.mark.parametrize("key", printed.MASRI_CAUGHEY)
def test_masri_caughey_has_the_printed_values(key: tuple[float, float, float]) -> None:
    """Amplitude, ball speed and multiplier of the periodic impact damper agree with the printed digits."""
    largest, speed, multiplier = printed.MASRI_CAUGHEY[key]
    fits = []
    for orbit in masri_caughey.orbits(*key):
        fit = abs(max(abs(orbit.multipliers())) - multiplier) < 5.1e-4
        if speed is not None and largest is not None:
            fit &= abs(orbit.speed - speed) < 5.1e-6 and abs(orbit.largest() / 50 - largest) < 5.1e-6
        fits.append(fit)
    assert fits.count(True) == 1


@pytest.mark.parametrize("key", printed.MASRI_CAUGHEY)
def test_masri_caughey_repeats_mirrored(key: tuple[float, float, float]) -> None:
    """After half a cycle displacement and velocity of the structure are mirrored."""
    for orbit in masri_caughey.orbits(*key):
        end = orbit.structure(orbit.half_period)
        assert end == pytest.approx((-orbit.position, -orbit.before), rel=1e-11, abs=1e-11)
        assert orbit.ball(orbit.half_period)[0] == pytest.approx(-orbit.position - orbit.clearance / 2, rel=1e-11)


@pytest.mark.parametrize("e", printed.SLOW_MANIFOLD_THRESHOLD)
def test_slow_manifold_has_the_printed_threshold(e: float) -> None:
    """The least amplitude with two impacts a cycle agrees with the printed seven places."""
    digits(shaken.threshold(e), printed.SLOW_MANIFOLD_THRESHOLD[e], 7)
    orbit = shaken.two_impacts(e, 1.5 * shaken.threshold(e))
    wall = orbit.amplitude * math.sin(orbit.phase), orbit.amplitude * math.cos(orbit.phase)
    assert 1 + wall[0] == pytest.approx(orbit.reach, rel=1e-14)
    assert -orbit.speed - wall[1] == pytest.approx(-e * (orbit.speed - wall[1]), rel=1e-13)


@pytest.mark.parametrize("ratio", printed.COLLECT_AND_COLLIDE)
def test_collect_and_collide_has_the_printed_values(ratio: float) -> None:
    """Energy lost in a cycle with a sticky ball agrees with the printed six places."""
    digits(shaken.collect_and_collide(ratio), printed.COLLECT_AND_COLLIDE[ratio], 6)
    assert shaken.collect_and_collide(1 / math.pi) == pytest.approx(4, rel=1e-12)


@pytest.mark.parametrize("key", printed.VIBRATING_TABLE)
def test_vibrating_table_has_the_printed_bounds(key: tuple[float, int]) -> None:
    """Birth and doubling of the bouncing motion agree with the printed seven places."""
    for value, shown in zip(shaken.table_bounds(*key), printed.VIBRATING_TABLE[key], strict=True):
        digits(value, shown, 7)


def test_chatter_has_the_printed_values() -> None:
    """Time and path of a ball that chatters to rest agree with the printed six places."""
    digits(shaken.chatter_time(0.5, 0.8, 9.81), printed.CHATTER[0], 6)
    digits(shaken.chatter_path(0.5, 0.8), printed.CHATTER[1], 6)
    assert shaken.chatter_time(0.5, 0.8, 9.81, 400) == pytest.approx(printed.CHATTER[0], abs=1e-6)


@pytest.mark.parametrize("gamma", printed.APPARENT_MASS)
def test_apparent_mass_has_the_printed_values(gamma: float) -> None:
    """The apparent mass agrees with the printed six places, and the loss with the impact's energy."""
    ball = shaken.inelastic_ball(gamma)
    for value, shown in zip(ball.apparent_mass(), printed.APPARENT_MASS[gamma], strict=True):
        digits(value, shown, 6)
    lost = 0.5 * ball.approach**2
    assert math.pi * ball.apparent_mass()[1] * gamma**2 == pytest.approx(lost, rel=1e-10)


@pytest.mark.parametrize("key", printed.IMPACT_OSCILLATOR)
def test_impact_oscillator_has_the_printed_speed(key: tuple[float, float, float, float]) -> None:
    """The speed before impact agrees with the printed seven places, and the motion repeats."""
    result = impact_oscillator.orbits(*key)
    fits = [o for o in result if abs(o.speed - printed.IMPACT_OSCILLATOR[key]) < 5.1e-8]
    assert len(fits) == 1
    end = fits[0].state(2 * np.pi / fits[0].omega)
    assert end == pytest.approx((fits[0].stop, fits[0].speed), rel=1e-11, abs=1e-11)
