"""Beds of particles: fill by their volume, dense packings, full cavities, and how they are measured."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.model.overlaps import check_packing
from rattlebox.prepare import settle as settling
from rattlebox.prepare.settle import settle

FORMS = {
    "box": rb.Box(size=("44 mm", "44 mm", "60 mm")),
    "upright can": rb.Cylinder(diameter="46 mm", length="60 mm"),
    "lying can": rb.Cylinder(diameter="52 mm", length="46 mm", axis="x"),
    "sphere": rb.SphericalCavity(diameter="60 mm"),
}
SMALL = {
    "box": rb.Box(size=("24 mm", "28 mm", "30 mm")),
    "upright can": rb.Cylinder(diameter="28 mm", length="30 mm"),
    "lying can": rb.Cylinder(diameter="28 mm", length="30 mm", axis="y"),
    "sphere": rb.SphericalCavity(diameter="34 mm"),
}
LOOSE, DENSE = (0.56, 0.61), (0.605, 0.64)


def damper(cavity: Any = SMALL["box"], packing: Any = None, **options: Any) -> rb.ParticleDamper:
    """Return a damper with steel balls of 4 mm, by default compacted."""
    given: dict[str, Any] = {"diameter": "4 mm", "bed_fill": 0.9}
    given |= {name: options.pop(name) for name in list(options) if name in rb.Particles.model_fields}
    if given.get("count"):
        del given["bed_fill"]
    usual: dict[str, Any] = {
        "particles": rb.Particles(material="steel", **given),
        "cavity": cavity,
        "packing": packing or rb.Compacted(seed=1),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.3,
    }
    return rb.ParticleDamper(**{**usual, **options})


# ---- measures


def layers(count: int) -> rb.ParticleDamper:
    """Return a cubic lattice of balls of 4 mm that touch, of 12 x 12 balls in each layer."""
    grid = np.stack(np.meshgrid(*[np.arange(12)] * 2, np.arange(count), indexing="ij"), axis=-1).reshape(-1, 3)
    positions = 4e-3 * (grid - [5.5, 5.5, 5.5])
    balls = rb.Particles(material="steel", diameter="4 mm")
    return damper(rb.Box(size=("48 mm",) * 3), rb.Positions(positions=positions), particles=balls)


@pytest.mark.parametrize("count", [1, 5, 12])
def test_level_layers_reach_to_the_top_of_the_highest(count: int) -> None:
    """The height of a bed of level layers is that of their highest points, and its volume follows."""
    bed = rb.measure_bed(layers(count))
    assert bed.height == pytest.approx(count * 4e-3, rel=2e-3)
    assert bed.bed_fill == pytest.approx(count / 12, rel=2e-3)
    assert bed.density == pytest.approx(math.pi / 6, rel=2e-3)
    assert bed.fill_ratio == pytest.approx(math.pi / 6 * count / 12, rel=1e-12)


def test_the_bulk_of_a_lattice_has_its_density() -> None:
    """The density of a cubic lattice in the bulk is pi/6; one layer has no bulk."""
    assert rb.measure_bed(layers(12)).bulk_density == pytest.approx(math.pi / 6, rel=3e-3)
    assert math.isnan(rb.measure_bed(layers(1)).bulk_density)


@pytest.mark.parametrize("height", [15, 17, 19, 21, 23, 30])
def test_a_thin_bed_has_no_bulk(height: float) -> None:
    """A bulk that is a part of a layer had the density of a plane through its centres, 0.675 ± 0.018.

    All beds with a stated density in the bulk were ten diameters deep, or commensurate lattices.
    """
    cavity = rb.Box(size=("40 mm", "30 mm", f"{height} mm"))
    balls = rb.Particles(material="steel", diameter="4 mm", bed_fill=0.9)
    bed = rb.measure_bed(damper(cavity, rb.Settled(seed=1), friction=0.4, particles=balls))
    assert math.isnan(bed.bulk_density) == (bed.height < 6 * 4e-3)
    assert math.isnan(bed.bulk_error) == math.isnan(bed.bulk_density)
    assert not bed.bulk_density > LOOSE[1] + 0.02


def test_the_bulk_of_mixed_sizes_has_their_density() -> None:
    """Balls of a third of the diameter in a lattice of large ones add their volume."""
    large = np.array(layers(12).packing.positions)
    holes = large[(large < 0.0201).all(axis=1)] + 2e-3
    radii = np.repeat([2e-3, 0.7e-3], [len(large), len(holes)])
    packing = rb.Positions(positions=np.vstack([large, holes]), radii=radii)
    mixed = damper(rb.Box(size=("48 mm",) * 3), packing, particles=rb.Particles(material="steel"))
    expected = math.pi / 6 * (1 + 0.35**3)
    assert rb.measure_bed(mixed).bulk_density == pytest.approx(expected, rel=3e-3)


# ---- densities


@pytest.mark.parametrize(("packing", "limits"), [(rb.Settled(seed=3), LOOSE), (rb.Compacted(seed=3), DENSE)])
def test_settled_beds_are_loose_and_compacted_ones_dense(packing: Any, limits: tuple[float, float]) -> None:
    """Far from walls a settled bed with friction fills 0.56 to 0.61 of the volume, a compacted one 0.605 to 0.64."""
    bed = rb.measure_bed(damper(rb.Box(size=("40 mm", "40 mm", "44 mm")), packing, friction=0.5))
    assert limits[0] < bed.bulk_density < limits[1]
    assert 0 < bed.bulk_error < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("friction", [0.3, 1.0])
@pytest.mark.parametrize("size", ["equal", "normal", "two"])
@pytest.mark.parametrize(("packing", "limits"), [(rb.Settled(seed=4), LOOSE), (rb.Compacted(seed=4), DENSE)])
def test_densities_do_not_depend_on_form_and_sizes(
    packing: Any, limits: tuple[float, float], size: str, friction: float, form: str
) -> None:
    """The densities in the bulk hold in all cavities, with equal and mixed sizes."""
    spread = rb.NormalSizes(mean="4 mm", deviation="0.5 mm", smallest="3 mm", largest="5 mm")
    made = damper(FORMS[form], packing, friction=friction)
    if size == "normal":
        made = damper(FORMS[form], packing, friction=friction, distribution=spread, diameter=None)
    if size == "two":
        kinds = [
            rb.Particles(name=name, material="steel", diameter=name, fill_ratio=share)
            for name, share in (("4 mm", 0.25), ("3 mm", 0.2))
        ]
        made = damper(FORMS[form], packing, friction=friction, particles=kinds)
    bed = rb.measure_bed(made)
    assert limits[0] < bed.bulk_density < limits[1]
    if size != "two":
        assert bed.bed_fill == pytest.approx(0.9, abs=0.03)


PACKINGS = {"settled": rb.Settled(seed=2), "compacted": rb.Compacted(seed=2)}
QUICK = [
    ("box", "settled", 0.5),
    ("sphere", "settled", 0.9),
    ("lying can", "compacted", 0.5),
    ("upright can", "compacted", 0.9),
]
"""Beds of the fast tests: each cavity, packing and fill at least once."""


@pytest.mark.parametrize(
    ("form", "packing", "fill"),
    [
        pytest.param(*bed, marks=[] if bed in QUICK else [pytest.mark.slow])
        for bed in itertools.product(SMALL, PACKINGS, [0.5, 0.9])
    ],
)
def test_a_bed_has_the_stated_volume(form: str, packing: str, fill: float) -> None:
    """The bed of a few hundred particles has the stated volume within 5 % of it; `fill_ratio` is that of the balls."""
    made = damper(SMALL[form], PACKINGS[packing], bed_fill=fill)
    bed = rb.measure_bed(made)
    assert bed.bed_fill == pytest.approx(fill, rel=0.05)
    assert bed.fill_ratio == pytest.approx(bed.count * math.pi / 6 * 4e-3**3 / made.cavity.volume)
    assert bed.fill_ratio < 0.62 * bed.bed_fill


def test_more_friction_needs_fewer_particles_for_the_same_bed() -> None:
    """More friction gives a looser settled bed; a compacted bed has at least as many particles."""
    counts = [damper(packing=rb.Settled(), friction=friction).contents.radius.size for friction in (0.1, 0.3, 1)]
    assert counts[0] > counts[1] > counts[2]
    assert damper(friction=1).contents.radius.size > counts[2]


# ---- full cavities


@pytest.mark.parametrize(
    ("form", "gravity"),
    [
        *(pytest.param(form, (0, 0, -9.81), id=f"{form}-gravity") for form in SMALL),
        pytest.param("lying can", (0, 0, 0), id="lying can-no gravity"),
        *(
            pytest.param(form, (0, 0, 0), id=f"{form}-no gravity", marks=pytest.mark.slow)
            for form in ("box", "upright can", "sphere")
        ),
    ],
)
def test_a_full_cavity_has_no_room_for_another_particle(form: str, gravity: Any) -> None:
    """A full cavity is filled throughout: another particle fits in 0.01 % of the places at most, and none overlap."""
    full = damper(SMALL[form], bed_fill=1, gravity=gravity)
    positions = settle(full)
    check_packing(full.cavity, positions, full.contents.radius)
    centres = full.cavity.spread(200_000)
    centres = centres[full.cavity.depth(centres) > 2e-3]
    from scipy.spatial import cKDTree

    nearest, _ = cKDTree(positions).query(centres)
    assert np.mean(nearest > 4e-3) < 1e-4
    assert rb.measure_bed(full).full_count == len(positions)


def test_particles_fill_the_whole_cavity_without_gravity() -> None:
    """Without gravity there is no surface: half as many particles are spread over the whole cavity."""
    half = damper(bed_fill=0.5, gravity=(0, 0, 0))
    positions = settle(half)
    assert np.abs(positions).max(axis=0) == pytest.approx(half.cavity.lengths / 2 - 2e-3, abs=1e-3)
    assert np.abs(positions.mean(axis=0)).max() < 1.5e-3
    bed = rb.measure_bed(half)
    assert math.isnan(bed.bed_fill) and math.isnan(bed.height)
    assert bed.count == pytest.approx(0.5 * bed.full_count, abs=1)


@pytest.mark.parametrize(
    "cavity",
    [
        rb.Cylinder(diameter="7.3 mm", length="28 mm"),
        rb.Cylinder(diameter="4.2 mm", length="41 mm", axis="x"),
        rb.Box(size=("6 mm", "26 mm", "24 mm")),
        rb.Box(size=("31 mm", "34 mm", "5.4 mm")),
        rb.SphericalCavity(diameter="12 mm"),
    ],
    ids=["tube", "row", "upright layer", "flat layer", "small sphere"],
)
@pytest.mark.parametrize("fill", [0.5, 1.0])
def test_narrow_cavities_are_filled(cavity: Any, fill: float) -> None:
    """A bed of a stated volume is found in cavities of one or two diameters."""
    made = damper(cavity, bed_fill=fill)
    check_packing(cavity, settle(made), made.contents.radius)


def test_a_cavity_for_one_ball_is_full_with_it() -> None:
    """The smallest full cavity holds one particle."""
    assert damper(rb.SphericalCavity(diameter="5 mm"), bed_fill=1).contents.radius.size == 1


# ---- the start of a run


@pytest.mark.parametrize("packing", [rb.Settled(seed=2), rb.Compacted(seed=2)], ids=lambda packing: packing.kind)
@pytest.mark.parametrize("fill", [0.6, 1.0])
def test_a_bed_starts_at_rest(packing: Any, fill: float) -> None:
    """No overlap releases energy: the kinetic energy of a bed at rest stays below 0.1 % of a fall by a diameter."""
    bed = damper(packing=packing, bed_fill=fill)
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=bed, duration="3 ms"))
    fall = float(run.arrays.particle_mass[0]) * 9.81 * 4e-3
    assert run.arrays.contact_energy[0].sum() == 0
    assert run.arrays.kinetic_energy.max() < 1e-3 * fall
    height = run.arrays.centre_of_mass[:, 0, 2]
    assert np.ptp(height) < 1e-3 * 4e-3


def test_a_full_cavity_without_gravity_starts_without_energy() -> None:
    """Without gravity and motion nothing moves, and no energy appears."""
    full = damper(bed_fill=1, gravity=(0, 0, 0))
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=full, duration="1 ms"))
    assert run.arrays.kinetic_energy.max() == 0
    assert run.arrays.contact_energy.max() == 0


# ---- repetition


def test_a_seed_fixes_a_compacted_bed() -> None:
    """The same seed gives the same bits, also when computed anew; another seed gives another bed of the same number."""
    beds = []
    for seed in (1, 1, 2):
        settling._beds.clear()
        beds.append(settle(damper(packing=rb.Compacted(seed=seed))))
    assert np.array_equal(beds[0], beds[1])
    assert beds[0].shape == beds[2].shape and not np.allclose(beds[0], beds[2])


def test_compacted_beds_are_cached(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bed is computed once for cases that differ in their contacts only."""
    first = settle(damper())
    monkeypatch.setattr(settling, "compact", None)
    assert np.array_equal(settle(damper(contact=rb.Tsuji(restitution=0.5), softening=10)), first)


def test_compaction_stops_on_request() -> None:
    """A stop during the insertion ends the computation without a bed."""
    settling._beds.clear()
    assert settle(damper(packing=rb.Compacted(seed=9)), lambda: False) is None
    assert settle(damper(packing=rb.Settled(seed=9)), lambda: False) is None


# ---- results and studies


def test_the_summary_lists_both_fills(tmp_path: Any) -> None:
    """Fill ratio and bed volume are in the summary, in the diagnostics and in files; a lattice has no bed."""
    case = rb.Case(structure=rb.Fixed(), damper=damper(), duration="0.1 ms")
    run = rb.simulate(case)
    bed = rb.measure_bed(case.particle_dampers[0])
    assert run.diagnostics["fill_ratio"] == pytest.approx(bed.fill_ratio)
    assert run.diagnostics["bed_fill"] == pytest.approx(bed.bed_fill)
    assert "volume of the bed over the cavity" in str(run.summary())
    loaded = rb.load(run.save(tmp_path / "run.nc"))
    assert loaded.diagnostics["bed_fill"] == run.diagnostics["bed_fill"]
    flying = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper(packing=rb.Lattice()), duration="0.1 ms"))
    assert "bed_fill" not in flying.diagnostics and flying.diagnostics["fill_ratio"] > 0.4


def test_a_bed_of_another_volume_is_noted() -> None:
    """A full bed without friction sinks, and the run has a note."""
    smooth = damper(bed_fill=1, friction=None)
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=smooth, duration="0.1 ms"))
    assert any("not 100 %" in note and "more of them" in note for note in run.notes)
    slippery = damper(bed_fill=1, friction=0.1)
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=slippery, duration="0.1 ms"))
    assert any(
        note.startswith("warning: the bed of damper fills 9") and "a gap at the top" in note for note in run.notes
    )
    for changes in ({"friction": 0.2}, {"friction": 0.1, "gravity": (0, 0, 0)}):
        held = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper(bed_fill=1, **changes), duration="0.1 ms"))
        assert not any("gap at the top" in note for note in held.notes)
    usual = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper(), duration="0.1 ms"))
    assert not any("fills" in note for note in usual.notes)


def test_studies_vary_the_bed_fill() -> None:
    """An axis over `bed_fill` replaces a count, in sweeps and in study files."""
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="20 m/s^2", frequency="100 Hz")),
        damper=damper(count=100, softening=1000),
        duration="20 ms",
    )
    found = rb.sweep(case, {"damper.particles.bed_fill": [0.4, 0.8]}, "impact_loss", progress=False)
    assert found["damper.particles.bed_fill"].attrs["units"] == "1"
    assert np.all(found.impact_loss > 0)
    full = case.replaced({"damper.particles.bed_fill": 0.8}).particle_dampers[0].particles[0]
    assert full.count is None and full.bed_fill == 0.8


def test_a_case_file_keeps_packing_and_fill() -> None:
    """A compacted bed survives a round trip through TOML."""
    case = rb.Case(structure=rb.Fixed(), damper=damper(), duration="1 ms")
    again = rb.Case.from_toml(case.to_toml())
    assert again == case
    assert 'kind = "compacted"' in case.to_toml()


# ---- bad input


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"bed_fill": 1.2}, r"bed_fill = 1.2\n  a bed fill must be greater than 0 and at most 1"),
        ({"bed_fill": 0}, "a bed fill must be greater than 0"),
        ({"bed_fill": "90 mm"}, "bed_fill"),
        ({"bed_fill": 0.5, "fill_ratio": 0.3}, "fill_ratio and bed_fill exclude each other"),
        ({"bed_fill": 1e-4}, "less than one particle"),
    ],
)
def test_a_bed_fill_that_makes_no_sense_is_refused(options: dict[str, Any], message: str) -> None:
    """Values outside of 0 to 1, units, two amounts and less than one particle are refused."""
    with pytest.raises(rb.CaseError, match=message):
        rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="4 mm", **options),
            cavity=SMALL["box"],
            contact=rb.Tsuji(restitution=0.7),
        )


def test_a_bed_of_several_species_needs_other_amounts() -> None:
    """The volume of a mixed bed is not known in advance."""
    kinds = [
        rb.Particles(name=name, material="steel", diameter=name, **amount)
        for name, amount in (("4 mm", {"bed_fill": 0.5}), ("3 mm", {"count": 20}))
    ]
    with pytest.raises(
        rb.CaseError, match=r"particles\[0\].bed_fill = 0.5\n  bed_fill needs the density of the bed, which is unknown"
    ):
        damper(particles=kinds)


def test_the_largest_number_of_a_cavity_is_stated() -> None:
    """More particles than a cavity holds at random are refused with the number that it holds, which then fits."""
    with pytest.raises(rb.CaseError, match="at random this cavity holds at most 3") as caught:
        damper(count=430)
    most = int(str(caught.value).split("holds at most ")[1].split()[0])
    full = damper(count=most)
    check_packing(full.cavity, settle(full), full.contents.radius)
    assert most == rb.measure_bed(full).full_count


@pytest.mark.parametrize("iterations", [500, pytest.param(settling.MAX_ITERATIONS, marks=pytest.mark.slow)])
def test_particles_that_cannot_be_compacted_are_refused_with_the_largest_number(
    iterations: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the number is below random close packing but the walls forbid it, the insertion ends with the same message."""
    monkeypatch.setattr(settling, "MAX_ITERATIONS", iterations)
    with pytest.raises(rb.CaseError, match=r"cannot be inserted at random; at random this cavity holds at most \d+"):
        settle(damper(rb.Box(size=("9 mm", "9 mm", "9 mm")), count=13))


def shaken_can(level: float, **options: Any) -> rb.Run:
    """Return a short run of a can that is shaken up and down at a level in g, with a full bed or another packing."""
    usual: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="5 mm", bed_fill=1),
        "packing": rb.Compacted(seed=2),
        "gravity": (0, 0, -9.80665),
    }
    damper = rb.ParticleDamper(
        cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
        contact=rb.Tsuji(restitution=0.8),
        friction=0.3,
        direction="z",
        softening=300,
        **usual | options,
    )
    motion = rb.Harmonic(amplitude=(9.80665 * level, "m/s^2"), frequency="60 Hz", direction="z")
    case = rb.Case(
        structure=rb.Shaker(motion=motion), damper=damper, duration="0.4 s", output=rb.Output(rate="2.4 kHz")
    )
    return rb.simulate(case, progress=False)


def test_a_full_bed_is_loose_and_a_block_is_locked() -> None:
    """Above 1 g a full random bed loses energy like a dense fluid, with a warning; a block that touches all walls does not.

    No test saw that a full bed is not locked: none shook one above its weight.
    """
    places = np.stack(np.meshgrid(*[(np.arange(4) - 1.5) * 5e-3] * 3), -1).reshape(-1, 3)
    block = {"particles": rb.Particles(material="steel", diameter="5 mm"), "packing": rb.Positions(positions=places)}
    runs = {name: shaken_can(2.0, **options) for name, options in (("bed", {}), ("block", block))}
    harmonic = {name: rb.analysis.shaken.harmonic_loss(run, frequency=60, after=0.2) for name, run in runs.items()}  # type: ignore[attr-defined]
    assert harmonic["bed"].reduced_loss.min() > 0.5
    assert abs(harmonic["block"].reduced_loss).max() < 0.005
    mass = harmonic["block"].effective_mass / runs["block"].arrays.particle_mass[0]
    assert mass.min() > 1 and mass.max() < 1.05
    warned = {name: any("is loose" in note for note in run.notes) for name, run in runs.items()}
    assert warned == {"bed": True, "block": False}


def test_a_full_bed_below_its_weight_has_no_warning() -> None:
    """Below 1 g a bed of any fill rests; without gravity it is loose at any level."""
    assert not any("is loose" in note for note in shaken_can(0.5).notes)
    space = shaken_can(0.5, gravity=(0, 0, 0))
    assert any("is loose" in note and "without gravity" in note for note in space.notes)
    part = rb.Particles(material="steel", diameter="5 mm", bed_fill=0.8)
    assert not any("is loose" in note for note in shaken_can(2.0, particles=part).notes)
