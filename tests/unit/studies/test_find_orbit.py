"""Periodic motions: which cases are refused with which advice, and what a motion reports."""

import numpy as np
import pytest

import rattlebox as rb

BALL = rb.Sphere(radius="14 mm", material="steel")


def case(**changes):
    """Return an impact damper with two impacts a cycle."""
    parts = {
        "structure": rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        "damper": rb.ImpactDamper(ball=BALL, gap="1 mm", contact=rb.Tsuji(restitution=0.6)),
        "load": rb.Harmonic(amplitude="5 N", frequency="33 Hz"),
        "method": rb.Newton(),
        "duration": "2 s",
    }
    return rb.Case(**{name: value for name, value in (parts | changes).items() if value is not None})


NOISE = rb.Random(psd=[["20 Hz", "0.01 g^2/Hz"], ["200 Hz", "0.01 g^2/Hz"]], duration="3 s")
REFUSED = {
    "no load": ({"load": None}, "no load"),
    "a load of amplitude zero": ({"load": rb.Harmonic(amplitude="0 N", frequency="33 Hz")}, "no load"),
    "two frequencies": (
        {"load": None, "loads": [rb.Harmonic(amplitude="5 N", frequency=f) for f in ("33 Hz", "46.669 Hz")]},
        "no common period",
    ),
    "a random load": (
        {"load": None, "base": NOISE},
        "random",
    ),
    "a pulse": ({"load": rb.HalfSine(amplitude="5 N", duration="10 ms")}, "transient"),
    "a load that stops": ({"load": rb.Harmonic(amplitude="5 N", frequency="33 Hz", stop="1 s")}, "does not last"),
    "fixed steps": ({"method": rb.TwoStep(), "duration": "0.01 s"}, "fixed steps"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name):
    """A case without a periodic motion is refused with what is wrong, what is allowed and what to try."""
    changes, words = REFUSED[name]
    with pytest.raises(rb.CaseError, match=words) as raised:
        rb.find_orbit(case(**changes))
    assert raised.value.suggestion
    assert ";" in raised.value.complaint or "so that" in raised.value.complaint


def test_a_file_is_not_a_case():
    """The name of a case file in place of a case is refused with the function that reads it."""
    with pytest.raises(rb.CaseError, match="a Case is needed") as raised:
        rb.find_orbit("case.toml")
    assert "from_file" in raised.value.suggestion


def test_particles_are_refused():
    """Particles in 3-D are refused with a study that suits them."""
    particles = rb.reference_case().replaced({"duration": "0.1 s"})
    bed = rb.Case(
        structure=particles.structure,
        damper=rb.ParticleDamper(
            particles=rb.Particles(count=5, diameter="6 mm", material="steel"),
            cavity=rb.Box(size=(0.03,) * 3),
            contact=rb.Tsuji(restitution=0.6),
        ),
        load=rb.Harmonic(amplitude="5 N", frequency="33 Hz"),
        method=rb.Dem(),
        duration="1 s",
    )
    with pytest.raises(rb.CaseError, match="not for particle dampers") as raised:
        rb.find_orbit(bed)
    assert "frequency_response" in raised.value.suggestion


@pytest.mark.parametrize("near", ["a run", [1.0, 2.0], [[1.0]], [np.nan] * 4])
def test_wrong_start(near):
    """A start that is no state of the case is refused with the components that are needed."""
    with pytest.raises(rb.CaseError) as raised:
        rb.find_orbit(case(), near=near)
    assert "simulate" in raised.value.suggestion


def test_wrong_period():
    """A period that is not a positive whole number is refused."""
    with pytest.raises(rb.CaseError, match="period"):
        rb.find_orbit(case(), period=0)


def test_chaotic_motion():
    """A run that does not repeat is refused, and the advice to give a period finds an unstable motion near it."""
    chaotic = case(load=rb.Harmonic(amplitude="10 N", frequency="32 Hz"))
    run = rb.simulate(chaotic, progress=False)
    with pytest.raises(rb.CaseError, match="does not repeat") as raised:
        rb.find_orbit(chaotic, near=run)
    assert "period=1" in raised.value.suggestion
    assert not rb.find_orbit(chaotic, near=run, period=1).is_stable


def named(name, **changes):
    """Return the damper with a name."""
    return rb.ImpactDamper(name=name, ball=BALL, gap="1 mm", contact=rb.Tsuji(restitution=0.6), **changes)


def test_soft_ball_that_lies_on_the_floor():
    """A soft contact that stays closed is refused with its reason, and the advice finds the motion.

    The search began at the last sample in flight, in the transient.
    """
    lying = case(
        damper=named("floor", gravity="9.81 m/s^2"),
        load=rb.Harmonic(amplitude="0.8 N", frequency="20 Hz"),
        structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.03),
        method=rb.EventDriven(),
        duration="3 s",
    )
    with pytest.raises(rb.CaseError, match="rests on a wall") as raised:
        rb.find_orbit(lying)
    assert "rb.Newton()" in raised.value.suggestion
    orbit = rb.find_orbit(lying.model_copy(update={"method": rb.Newton()}))
    assert orbit.sticks
    assert not orbit.impacts


def test_words():
    """The text of a motion names its kind, multipliers, impacts and checks."""
    orbit = rb.find_orbit(case())
    text = str(orbit)
    for words in ("1 cycle", "symmetric", "stable", "pair at", "trailing wall", "residual", "determinant"):
        assert words in text
    assert orbit.slowest_impact in orbit.impacts


def test_run_repeats():
    """A run of a motion repeats it, also if a contact is near the phase zero of the load."""
    for phase in ("0 deg", "95 deg", "180 deg", "265 deg"):
        load = rb.Harmonic(amplitude="5 N", frequency="33 Hz", phase=phase)
        orbit = rb.find_orbit(case(load=load))
        arrays = orbit.run(2).arrays
        assert arrays.displacement[-1, 0] == pytest.approx(arrays.displacement[0, 0], rel=1e-9)
        assert arrays.ball_velocity[-1, 0] == pytest.approx(arrays.ball_velocity[0, 0], rel=1e-9)


def test_period_is_the_own_one_of_the_motion():
    """A motion that is sought over three cycles and repeats after one has the period of one cycle."""
    orbit = rb.find_orbit(case(), period=3)
    assert orbit.cycles == 1
    assert orbit.is_symmetric


def test_gravity_breaks_the_symmetry():
    """With gravity along the cavity the motion is not symmetric."""
    tilted = rb.ImpactDamper(ball=BALL, gap="1 mm", contact=rb.Tsuji(restitution=0.6), gravity="-0.5 m/s^2")
    orbit = rb.find_orbit(case(damper=tilted))
    assert not orbit.is_symmetric
    assert orbit.determinant_error < 1e-8


def test_loads_with_a_common_period():
    """Two loads of 2:3 have the period of both."""
    loads = [
        rb.Harmonic(amplitude="5 N", frequency="33 Hz"),
        rb.Harmonic(amplitude="0.5 N", frequency="49.5 Hz"),
    ]
    orbit = rb.find_orbit(case(load=None, loads=loads))
    assert orbit.period == pytest.approx(1 / 16.5)


def test_figure():
    """The figure of a motion has its period and its multipliers."""
    figure = rb.find_orbit(case()).plot(size="column")
    assert len(figure.axes) == 2


def test_a_ball_that_floats_is_named() -> None:
    """A motion that touches no ball is refused with this reason, and the advice finds one; it was "not converged"."""
    case = rb.Case(
        structure=rb.SDOF(mass="60 t", frequency="1.7 Hz", damping_ratio=0.02),
        damper=rb.ImpactDamper(
            ball=rb.Striker(mass="1.5 t"), gap="30 mm", contact=rb.Linear(restitution=0.5, stiffness=3e7)
        ),
        load=rb.Harmonic(amplitude="4 kN", frequency="1.7 Hz"),
        method=rb.Newton(restitution=0.5),
        duration="90 s",
    )
    with pytest.raises(
        rb.CaseError, match=r"no ball touches anything in 1 cycle.*\n  try: a larger load or a smaller gap"
    ):
        rb.find_orbit(case)
    assert len(rb.find_orbit(case.replaced({"load.amplitude": "40 kN"})).impacts) >= 2
    assert rb.find_orbit(case.replaced({"dampers": ()})).stability == "stable"
