"""What is allowed, but is likely a slip, is told below the numbers of a run."""

import pytest

import rattlebox as rb
from rattlebox.model.doubts import doubts

BALL = {"ball": rb.Sphere(diameter="20 mm", material="steel"), "gap": "1 mm", "contact": rb.Tsuji(restitution=0.9)}
TWO_POINTS = rb.Modal(
    frequencies=[5, 9], damping_ratios=[0.01, 0.01], shapes={"light": [3.0, 4.0], "heavy": [0.3, 0.4]}
)


def notes(structure=None, **changes):
    """Return what is noted of a short run with one ball."""
    case = rb.Case(
        structure=structure or rb.SDOF(mass=20, stiffness=8e4),
        damper=rb.ImpactDamper(**BALL | changes),
        duration="1 ms",
    )
    return tuple(note for note in rb.simulate(case).notes if "touched anything" not in note)


def test_nothing_is_noted_of_what_is_usual():
    """A small ball on a structure that is heavier than it needs no warning, nor does one on a shaker or a fixed table."""
    assert notes() == notes(rb.Fixed()) == notes(rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency=10))) == ()


def test_sizes_in_metres_are_noted():
    """A ball or a gap of more than a metre is told, with the likely reason."""
    (wide, heavy) = notes(ball=rb.Sphere(radius=3.317, material="steel"))
    assert wide == "warning: a ball of damper is 6.634 m wide; a number without a unit is in metres"
    assert heavy == "warning: the balls of damper weigh 1.2e+06 kg, 6e+04 times as much as the structure at their point"
    assert notes(gap=2.5) == ("warning: the gap of damper is 2.5 m; a number without a unit is in metres",)


@pytest.mark.parametrize(("point", "told"), [("light", 1), ("heavy", 0)])
def test_the_mass_is_compared_with_what_moves_at_the_point(point, told):
    """A ball of 0.1 kg outweighs a point where 0.04 kg move, and not one where 4 kg do."""
    ball = rb.Sphere(diameter="20 mm", material="steel", mass="0.1 kg")
    assert len(notes(TWO_POINTS, ball=ball, point=point)) == told


def test_particles_are_compared_as_well(tmp_path):
    """Particles in space that outweigh the structure are noted after what limits the step, and the note is kept in files."""
    grains = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=20),
        cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
        contact=rb.Tsuji(restitution=0.9),
        softening=1000,
    )
    case = rb.Case(structure=rb.SDOF(mass=0.01, stiffness=100), damper=grains, duration="1 ms")
    run = rb.simulate(case)
    assert run.notes[0].startswith("step ")
    said = "warning: the particles of damper weigh 0.01776 kg, 1.78 times as much"
    assert any(note.startswith(said) for note in run.notes[1:])
    assert rb.load(run.save(tmp_path / "run.nc")).notes == run.notes


@pytest.mark.parametrize(("friction", "told"), [(0.4, 0), ("40 %", 0), (40, 1)])
def test_friction_in_per_cent_is_noted(friction, told):
    """A coefficient of 40 is told; a bed settles with it as with any other."""
    grains = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=20),
        cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
        contact=rb.Tsuji(restitution=0.9),
        friction=friction,
        packing=rb.Settled(seed=1),
        softening=1000,
    )
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=grains, duration="1 ms"))
    assert [note for note in run.notes if "friction" in note] == told * [
        "warning: the friction in damper is 40; per cent need their sign: 40 % is 0.4"
    ]


def test_notes_of_impacts_are_kept_and_shown(tmp_path):
    """A warning is below the summary, and in the file of the run."""
    case = rb.Case(structure=rb.Fixed(), damper=rb.ImpactDamper(**BALL | {"gap": 2.0}), duration="1 ms")
    run = rb.simulate(case)
    assert "2 m" in run.notes[0]
    assert set(run.notes) <= set(str(run.summary()).splitlines())
    assert rb.load(run.save(tmp_path / "run.nc")) == run


@pytest.mark.parametrize(("ratio", "noted"), [(0.02, 0), ("2 %", 0), (0.49, 0), (0.5, 1), (1, 1), (2, 1)])
def test_overdamped_structures_are_noted(ratio, noted):
    """A damping ratio of 1, meant as 1 %, is noted; usual ones, and a free body with a dashpot, are not."""
    found = notes(rb.SDOF(mass=20, stiffness=8e4, damping_ratio=ratio))
    assert len(found) == noted
    assert all("2 % is 0.02" in note and f"{ratio:g}" in note for note in found)
    assert notes(rb.SDOF(mass=20, stiffness=0, damping=10)) == ()


def test_loads_that_come_too_late_are_noted():
    """Pulses and shakers that begin when the run is over are told by field, and by number where there are several."""
    pulses = [rb.HalfSine(amplitude="1 N", duration="1 ms", start=start) for start in ("0.5 ms", "20 ms")]
    late = rb.Case(structure=rb.SDOF(mass=1, stiffness=1e4), loads=pulses, duration="1 ms")
    assert doubts(late) == ("warning: load 2 begins at 0.02 s, when the run of 0.001 s is over",)
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency=10, start="1 s"))
    assert notes(shaker) == ("warning: motion begins at 1 s, when the run of 0.001 s is over",)


@pytest.mark.parametrize(("rate", "told"), [(None, 0), (200, 0), (199, 1)])
def test_few_samples_in_a_period_are_noted(rate, told):
    """Less than four samples in a period of the fastest load or the lowest mode are told, where they were asked for."""
    load = rb.Harmonic(amplitude="1 N", frequency="50 Hz")
    case = rb.Case(structure=rb.SDOF(mass=20, stiffness=8e4), load=load, duration=1, output=rb.Output(rate=rate))
    assert doubts(case) == told * (
        "warning: output.rate is 199 Hz, 3.98 samples in a period of load, at 50 Hz,"
        " so that figures and spectra of the motion are not true; the run itself is",
    )
    slow = rb.Case(structure=rb.SDOF(mass=20, stiffness=8e4), duration=1, output=rb.Output(rate=40))
    assert len(doubts(slow)) == 1 and "the structure's lowest mode, at 10.07 Hz," in doubts(slow)[0]


@pytest.mark.parametrize(
    ("young", "density", "told"),
    [
        ("210 GPa", 7850, []),
        (70, 2700, ["the modulus of a material in damper is 70 Pa; a number without a unit is in pascals"]),
        ("70 GPa", 2.7, ["the density of a material in damper is 2.7 kg/m^3, which hardly a solid has"]),
    ],
)
def test_absurd_materials_are_noted(young, density, told):
    """Moduli in gigapascals and densities in grams that lost their units are told, once, of balls and of particles."""
    stuff = rb.Material(young=young, density=density, poisson=0.3)
    damper = rb.ImpactDamper(**BALL | {"ball": rb.Sphere(diameter="20 mm", material=stuff)})
    grains = rb.ParticleDamper(
        particles=rb.Particles(material=stuff, diameter="3 mm", count=2),
        cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
        contact=rb.Tsuji(restitution=0.9),
    )
    for each in (damper, grains):
        case = rb.Case(structure=rb.Fixed(), damper=each, duration=1)
        assert doubts(case) == tuple(f"warning: {said}" for said in told)


def grains(**changes):
    """Return a damper with a few balls."""
    usual = {
        "particles": rb.Particles(material="steel", diameter="5 mm", count=12),
        "cavity": rb.Box(size=("20 mm", "20 mm", "20 mm")),
        "contact": rb.Tsuji(restitution=0.7),
    }
    return rb.ParticleDamper(**usual | changes)


def of(damper, **changes):
    """Return what is noted of a case."""
    return doubts(rb.Case(**{"structure": rb.SDOF(mass=1, stiffness=1e4), "damper": damper, "duration": 0.1} | changes))


def test_a_base_across_the_structure_is_noted():
    """A base that moves at right angles to the only direction of the structure is told; one along it, or askew, is not."""
    told = {
        direction: of(grains(), base=rb.Harmonic(amplitude=1, frequency=16, direction=direction))
        for direction in ("x", (1, 0, 1), "z")
    }
    assert told["x"] == told[(1, 0, 1)] == of(grains(), base=rb.Harmonic(amplitude=1, frequency=16)) == ()
    said = "warning: base moves along z, across the structure, which moves along x, the direction of damper"
    assert told["z"] == (said,)
    assert of(grains(direction="z"), base=rb.Harmonic(amplitude=1, frequency=16, direction="z")) == ()


def test_a_cavity_in_metres_is_noted():
    """Balls that fill next to nothing of their cavity are told with the likely reason."""
    (told,) = of(grains(cavity=rb.Box(size=(20, 20, 20))))
    assert told.startswith("warning: the particles of damper fill 9.8e-11 of the cavity; a number without a unit")


def test_a_record_in_milliseconds_is_noted():
    """A record that is more than a hundred times as long as the run is told, one that is as long as need be is not."""
    for length, notes in ((0.2, 0), (10.0, 0), (600.0, 1)):
        told = of(grains(), load=rb.Record(times=[0, length], values=[0, 1], unit="N"))
        assert len(told) == notes
    assert told == ("warning: load is a record of 600 s, of which the run takes 0.1 s; its times are in seconds",)
