"""A run warns of valid values that are likely slips."""

import re

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.model.plausibility import plausibility_notes

BALL = {"ball": rb.Sphere(diameter="20 mm", material="steel"), "gap": "1 mm", "contact": rb.Tsuji(restitution=0.9)}
TWO_POINTS = rb.Modal(
    frequencies=[5, 9], damping_ratios=[0.01, 0.01], shapes={"light": [3.0, 4.0], "heavy": [0.3, 0.4]}
)


def notes(structure=None, **changes):
    """Return the notes of a short run with one ball."""
    case = rb.Case(
        structure=structure or rb.SDOF(mass=20, stiffness=8e4),
        damper=rb.ImpactDamper(**BALL | changes),
        duration="1 ms",
    )
    return tuple(note for note in rb.simulate(case).notes if "touched anything" not in note)


def test_usual_cases_have_no_notes():
    """A small ball on a structure that is heavier than it needs no warning, nor does one on a shaker or a fixed table."""
    assert notes() == notes(rb.Fixed()) == notes(rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency=10))) == ()


@pytest.mark.parametrize(
    ("amplitude", "frequency", "noted"),
    [
        (15.0, "50 Hz", "a harmonic displacement of 15 m at 50 Hz, 4712 m/s and 1.51e+05 g"),
        (1.5, "50 Hz", "1.51e+04 g"),
        (0.4, "8 Hz", "20.11 m/s and 103 g"),
        (2e5, "50 Hz", "2.01e+09 g"),
        ("15 g", "50 Hz", ""),
        ("15 mm", "50 Hz", ""),
        ("2 m", "0.2 Hz", ""),
        ("2000 g", "2 kHz", ""),
    ],
)
def test_amplitudes_of_shakers_in_metres_are_noted(amplitude, frequency, noted):
    """A run warns of a displacement that no shaker reaches: 15 for 15 g or 15 mm is 15 m.

    Only records were tested for their peaks, so that a number without a unit for a motion had no warning.
    """
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude=amplitude, frequency=frequency))
    result = plausibility_notes(rb.Case(structure=shaker, damper=rb.ImpactDamper(**BALL), duration="1 ms"))
    assert len(result) == bool(noted)
    assert all(
        note.startswith("warning: motion is a harmonic displacement") and noted in note and '"15 mm" or "15 g"' in note
        for note in result
    )


@pytest.mark.parametrize("kind", [rb.Harmonic, rb.HalfSine, rb.Sawtooth, rb.SineSweep])
def test_accelerations_of_the_base_that_are_too_large_are_noted(kind):
    """Motions of the base and of a shaker above 100 km/s^2 have a warning with the unit of a bare number."""
    fields = {
        rb.Harmonic: {"frequency": 50},
        rb.SineSweep: {"first_frequency": 5, "last_frequency": 50, "sweep_rate": "9 oct/s"},
    }
    motion = kind(amplitude=3e5, **fields.get(kind, {"duration": "11 ms"}))
    beam = rb.SDOF(mass=20, stiffness=8e4)
    (note,) = [each for each in plausibility_notes(rb.Case(structure=beam, base=motion, duration=9)) if "usual" in each]
    assert note.startswith("warning: base is a") and "up to 100000 m/s^2" in note
    assert "a number without a unit is in m/s^2 here; try: check the amplitude" in note and note.endswith(
        'such as "15 g"'
    )
    for amplitude in (3e3, -1e5 * (1 + 1e-12)):  # the limit itself is allowed, whatever the rounding
        usual = rb.Case(structure=beam, base=motion.model_copy(update={"amplitude": amplitude}), duration=9)
        assert not any("usual" in each for each in plausibility_notes(usual))


@pytest.mark.parametrize(
    ("psd", "options", "noted"),
    [
        ([(20, 0.05), (1500, 0.05)], {}, True),
        ([("30 Hz", 0.002), (400, 0.9)], {}, True),
        ([(20, "0.05 g^2/Hz"), (1500, "0.05 g^2/Hz")], {}, False),
        ([(20, "0.05 (m/s^2)^2/Hz"), (1500, "0.05 (m/s^2)^2/Hz")], {}, False),
        ([(20, 0.05), (1500, 0.05)], {"unit": "m/s^2"}, False),
        ([(20, 0.05), (1500, 0.05)], {"unit": "g"}, False),
        ([(20, 4.8), (1500, 4.8)], {}, False),  # too much in g^2/Hz
        ([(0.1, 1e-4), (20, 1e-4)], {}, False),  # as of a floor: too little in g^2/Hz
        ("minimum_integrity", {}, False),
    ],
)
def test_densities_without_a_unit_are_noted(psd, options, noted):
    """A density without a unit whose numbers are usual in g^2/Hz has a warning, whose advice ends it.

    Bare amplitudes had a warning, but densities have another field, which no check read.
    """
    beam, motion = rb.SDOF(mass=20, stiffness=8e4), rb.Random(psd, "0.4 s", **options)
    case = rb.Case(structure=beam, base=motion, duration="0.3 s")
    for again in (case, case.replaced({"duration": "0.2 s"}), case.model_copy()):
        found = [each for each in plausibility_notes(again) if "RMS" in each]
        assert len(found) == noted
    for note in found:
        assert note.startswith("warning: base is random acceleration of ") and "it would be " in note
        for advised in re.findall(r'"([^"]+)"', note):
            stated = rb.Random([(20, advised), (1500, advised)], "0.4 s")
            assert not plausibility_notes(rb.Case(structure=beam, base=stated, duration="0.3 s"))
    assert not plausibility_notes(
        rb.Case(structure=beam, load=rb.Random([(20, 0.05), (90, 0.05)], "1 s"), duration=0.1)
    )


def test_sizes_in_metres_are_noted():
    """A run warns of a ball or a gap of more than a metre, with the likely reason."""
    (wide, heavy) = notes(ball=rb.Sphere(radius=3.317, material="steel"))
    assert wide.startswith("warning: a ball of damper is 6.634 m wide") and "check the value and its unit" in wide
    assert heavy.startswith("warning: the balls of damper") and "1.2e+06 kg" in heavy and "6e+04 times" in heavy
    (gap,) = notes(gap=2.5)
    assert gap.startswith("warning: the gap of damper is 2.5 m") and "check the value and its unit" in gap


@pytest.mark.parametrize(("point", "count"), [("light", 1), ("heavy", 0)])
def test_the_mass_is_compared_with_the_effective_mass_at_the_point(point, count):
    """A ball of 0.1 kg outweighs a point where 0.04 kg move, and not one where 4 kg do."""
    ball = rb.Sphere(diameter="20 mm", material="steel", mass="0.1 kg")
    assert len(notes(TWO_POINTS, ball=ball, point=point)) == count


def test_particles_are_compared_as_well(tmp_path):
    """Particles that outweigh the structure are noted after the limits of the step, and files keep the note."""
    grains = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=20),
        cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
        contact=rb.Tsuji(restitution=0.9),
        softening=1000,
    )
    case = rb.Case(structure=rb.SDOF(mass=0.01, stiffness=100), damper=grains, duration="1 ms")
    run = rb.simulate(case)
    assert run.notes[0].startswith("step ")
    (note,) = [note for note in run.notes[1:] if note.startswith("warning: the particles of damper")]
    assert "0.01776 kg, 1.78 times" in note
    assert rb.load(run.save(tmp_path / "run.nc")).notes == run.notes


@pytest.mark.parametrize(("friction", "count"), [(0.4, 0), ("40 %", 0), (40, 1)])
def test_friction_in_per_cent_is_noted(friction, count):
    """A run warns of a coefficient of 40; a bed settles with it as with any other."""
    grains = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=20),
        cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
        contact=rb.Tsuji(restitution=0.9),
        friction=friction,
        packing=rb.Settled(seed=1),
        softening=1000,
    )
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=grains, duration="1 ms"))
    result = [note for note in run.notes if "friction" in note]
    assert len(result) == count
    assert all(note.startswith("warning:") and "damper is 40;" in note and "40 % is 0.4" in note for note in result)


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
    result = notes(rb.SDOF(mass=20, stiffness=8e4, damping_ratio=ratio))
    assert len(result) == noted
    assert all("2 % is 0.02" in note and f"{ratio:g}" in note for note in result)
    assert notes(rb.SDOF(mass=20, stiffness=0, damping=10)) == ()


def test_loads_that_come_too_late_are_noted():
    """A warning names pulses and shakers that begin after the end by field, and by number where there are several."""
    pulses = [rb.HalfSine(amplitude="1 N", duration="1 ms", start=start) for start in ("0.5 ms", "20 ms")]
    late = rb.Case(structure=rb.SDOF(mass=1, stiffness=1e4), loads=pulses, duration="1 ms")
    (load,) = plausibility_notes(late)
    assert load.startswith("warning: load 2 begins at 0.02 s") and "0.001 s" in load
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency=10, start="1 s"))
    (motion,) = notes(shaker)
    assert motion.startswith("warning: motion begins at 1 s") and "0.001 s" in motion


@pytest.mark.parametrize(("rate", "count"), [(None, 0), (200, 0), (199, 1)])
def test_few_samples_in_a_period_are_noted(rate, count):
    """A run warns of a chosen rate of less than four samples in a period of the fastest load or the lowest mode."""
    load = rb.Harmonic(amplitude="1 N", frequency="50 Hz")
    case = rb.Case(structure=rb.SDOF(mass=20, stiffness=8e4), load=load, duration=1, output=rb.Output(rate=rate))
    result = plausibility_notes(case)
    assert len(result) == count
    assert all("output.rate is 199 Hz, 3.98 samples in a period of load, at 50 Hz," in note for note in result)
    slow = rb.Case(structure=rb.SDOF(mass=20, stiffness=8e4), duration=1, output=rb.Output(rate=40))
    (note,) = plausibility_notes(slow)
    assert "the structure's lowest mode, at 10.07 Hz," in note


@pytest.mark.parametrize(
    ("young", "density", "words"),
    [
        ("210 GPa", 7850, []),
        (70, 2700, ["modulus", "70 Pa"]),
        ("70 GPa", 2.7, ["density", "2.7 kg/m^3"]),
    ],
)
def test_absurd_materials_are_noted(young, density, words):
    """A run warns once of moduli in gigapascals and densities in grams without units, for balls and for particles."""
    stuff = rb.Material(young=young, density=density, poisson=0.3)
    damper = rb.ImpactDamper(**BALL | {"ball": rb.Sphere(diameter="20 mm", material=stuff)})
    grains = rb.ParticleDamper(
        particles=rb.Particles(material=stuff, diameter="3 mm", count=2),
        cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
        contact=rb.Tsuji(restitution=0.9),
    )
    for each in (damper, grains):
        case = rb.Case(structure=rb.Fixed(), damper=each, duration=1)
        result = plausibility_notes(case)
        assert len(result) == bool(words)
        assert all(word in note for note in result for word in ("warning: ", "damper", *words))


def grains(**changes):
    """Return a damper with a few balls."""
    usual = {
        "particles": rb.Particles(material="steel", diameter="5 mm", count=12),
        "cavity": rb.Box(size=("20 mm", "20 mm", "20 mm")),
        "contact": rb.Tsuji(restitution=0.7),
    }
    return rb.ParticleDamper(**usual | changes)


def of(damper, **changes):
    """Return the notes of a case."""
    usual = {"structure": rb.SDOF(mass=1, stiffness=1e4), "damper": damper, "duration": 0.1}
    return plausibility_notes(rb.Case(**usual | changes))


def test_a_base_across_the_structure_is_noted():
    """A base that moves at right angles to the only direction of the structure is noted; one along it, or askew, is not."""
    result = {
        direction: of(grains(), base=rb.Harmonic(amplitude=1, frequency=16, direction=direction))
        for direction in ("x", (1, 0, 1), "z")
    }
    assert result["x"] == result[(1, 0, 1)] == of(grains(), base=rb.Harmonic(amplitude=1, frequency=16)) == ()
    (note,) = result["z"]
    assert note.startswith("warning: base moves along z") and "along x, the direction of damper" in note
    assert of(grains(direction="z"), base=rb.Harmonic(amplitude=1, frequency=16, direction="z")) == ()


def test_a_cavity_in_metres_is_noted():
    """A run warns of a fill ratio of almost zero, with the likely reason."""
    (note,) = of(grains(cavity=rb.Box(size=(20, 20, 20))))
    assert note.startswith("warning: the fill ratio of damper is 9.8e-11") and "their units" in note


def test_cavities_in_metres_from_their_axis_or_point_are_noted():
    """An arm or an offset of 45 m is noted, one of 0.4 m is not; the motion of a cell at rest showed nothing unusual."""
    cells = [[0, 0, 0], [45, 0, 0]]
    slow = {"speed": 0.1, "axis": "y"}
    (note,) = of(grains(rotation=rb.Rotation(arm=(45, 0, 0), **slow)))
    assert note.startswith("warning: a cavity is 45 m from its axis") and "arm and offsets" in note
    (note,) = of(grains(offsets=cells))
    assert note.startswith("warning: a cavity is 45 m from its point") and "offsets" in note
    (note,) = of(grains(offsets=cells, rotation=rb.Rotation(arm=(0.4, 0, 0), **slow)))
    assert note.startswith("warning: a cavity is 45.4 m from its axis")
    assert not of(grains(offsets=[[0, 0, 0], [0.4, 0, 0]], rotation=rb.Rotation(arm=(0.4, 0, 0), **slow)))


def test_a_record_in_milliseconds_is_noted():
    """A record that is more than a hundred times as long as the run is noted, a shorter one is not."""
    for length, count in ((0.2, 0), (10.0, 0), (600.0, 1)):
        result = of(grains(), load=rb.Record(times=[0, length], values=[0, 1], unit="N"))
        assert len(result) == count
    assert (
        result[0].startswith("warning: load is a record of 600 s") and "0.1 s" in result[0] and "seconds" in result[0]
    )


def test_dampers_with_one_packing_are_noted():
    """Two dampers with one random seed at one point have a warning, whose two pieces of advice remove it.

    Only the cells of one damper were tested for different packings; two listed dampers moved as one, without a note.
    """
    cup = grains(packing=rb.Settled(seed=4), softening=200)
    structure = rb.SDOF(mass=2, frequency=25, damping_ratio=0.01, velocity="0.3 m/s")

    def pair(*dampers, structure=structure):
        return rb.Case(structure=structure, dampers=dampers, duration="2 ms")

    run = rb.simulate(pair(cup, cup), progress=False)
    assert np.array_equal(run.arrays.centre_of_mass[:, 0], run.arrays.centre_of_mass[:, 1])
    (note,) = (note for note in run.notes if "packing" in note)
    assert note.startswith("warning: the particles of damper2 have the same random packing as those of damper, ")
    other = cup.model_copy(update={"packing": rb.Settled(seed=5)})
    twice = cup.model_copy(update={"number": 2})
    spots = [cup.model_copy(update={"point": point}) for point in ("light", "heavy")]
    grid = [[x, y, z] for x in (-6e-3, 0, 6e-3) for y in (-4e-3, 4e-3) for z in (-4e-3, 4e-3)]
    even = grains(packing=rb.Positions(positions=grid))
    turned = rb.Rotation(speed="90 rpm", axis="y", arm=("50 mm", 0, 0))
    angles = [cup.model_copy(update={"rotation": turned.model_copy(update={"angle": angle})}) for angle in (0.0, 2.0)]
    for dampers, options in (
        ((cup, other), {}),
        ((twice,), {}),
        (spots, {"structure": TWO_POINTS}),
        ((even, even), {}),
        (angles, {}),
    ):
        assert not any("random packing" in note for note in plausibility_notes(pair(*dampers, **options)))
    assert any("those of damper," in note for note in plausibility_notes(pair(twice, cup)))
