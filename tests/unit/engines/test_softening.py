"""Softening: warnings where it changes the loss, the value of "auto", and the estimates behind both."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.prepare.particles import pack_particles, prepare
from rattlebox.prepare.softening import (
    AUTO_CHANGE,
    MAX_CHANGE,
    CavityMotion,
    bed_resonance,
    cavity_motion,
    loss_change,
)
from rattlebox.prepare.time_step import WARNINGS


def shaken(amplitude: float, frequency: float, softening: Any, cycles: float = 10, **changes: Any) -> rb.Case:
    """A cylinder of tungsten carbide balls on a shaker."""
    damper: dict[str, Any] = {
        "particles": rb.Particles(material="tungsten_carbide", diameter="6 mm", fill_ratio=0.45),
        "cavity": rb.Cylinder(diameter="40 mm", length="60 mm", axis="x"),
        "contact": rb.Tsuji(restitution=0.6),
        "friction": 0.2,
        "direction": "z",
        "wall": "steel",
        "packing": rb.Settled(seed=1),
        "softening": softening,
    }
    motion = rb.Harmonic(amplitude=(amplitude, "m/s^2"), frequency=frequency, direction="z")
    return rb.Case(
        structure=rb.Shaker(motion=motion),
        damper=rb.ParticleDamper(**damper | changes),
        duration=cycles / frequency,
        output=rb.Output(rate=20 * frequency),
    )


def small(amplitude: float, frequency: float, softening: Any, **changes: Any) -> rb.Case:
    """A few steel balls."""
    few: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="5 mm", count=30),
        "cavity": rb.Box(size=("20 mm", "20 mm", "25 mm")),
        "wall": None,
    }
    return shaken(amplitude, frequency, softening, **few | changes)


def warnings(run: rb.Run) -> list[str]:
    """Return the warnings of a run."""
    return [note for note in run.notes if note.startswith("warning")]


@pytest.mark.parametrize("softening", [100, 20])
def test_a_resting_softened_bed_has_both_warnings(softening: float) -> None:
    """At half of gravity the loss is 1.1 and 0.18 m V^2 at softening 100 and 20, and 0.01 without."""
    run = rb.simulate(shaken(5, 180, softening))
    assert run.diagnostics["softening_change"] > MAX_CHANGE
    assert run.diagnostics["enduring_share"] > 0.4
    result = warnings(run)
    assert len(result) == 2 and "resonance" in result[0] and "quarter of a period" in result[1]


@pytest.mark.parametrize(("amplitude", "softening"), [(49, 5), (49, 1), (5, 1)])
def test_beds_that_softening_changes_little_have_none(amplitude: float, softening: float) -> None:
    """Thrown beds with little softening, and beds without softening, have no warning."""
    assert warnings(rb.simulate(shaken(amplitude, 180, softening))) == []


def test_motions_given_as_displacement_are_judged_alike() -> None:
    """A motion that is given as a displacement has the estimate of its acceleration."""
    motion = rb.Harmonic(amplitude=(12 / (2 * math.pi * 160) ** 2, "m"), frequency=160, direction="z")
    made = small(12, 160, 300)
    moved = rb.simulate(made.model_copy(update={"structure": rb.Shaker(motion=motion)}))
    assert moved.diagnostics["softening_change"] == rb.simulate(made).diagnostics["softening_change"] > 0.2


def test_each_damper_has_its_own_warnings() -> None:
    """With several dampers, warnings name the damper."""
    case = small(5, 160, 1)
    hard = case.particle_dampers[0].model_copy(update={"name": "hard"})
    soft = hard.model_copy(update={"name": "soft", "softening": 300})
    result = warnings(rb.simulate(case.model_copy(update={"dampers": (hard, soft)})))
    assert len(result) == 2
    assert all("in soft" in note and "in hard" not in note for note in result)


def test_the_loss_of_contacts_of_any_age_is_all_loss() -> None:
    """If contacts of any age last, their sampled loss is that of the ledger; no contact is older than the run."""
    prepared = prepare(small(12, 80, 100))
    packed, step = pack_particles(prepared), prepared.step
    shares = []
    for age in (0.0, 1 / 320, 1.0):
        dem = _core.Dem(packed.replace(enduring=age))
        dem.run(step.count, None)
        records = dem.records()
        lost = sum(getattr(records, f"{name}_loss")[-1].sum() for name in ("normal", "plastic", "sliding", "rolling"))
        shares.append(float(dem.counts().enduring_loss[0] / lost))
    assert shares[0] == pytest.approx(1, abs=0.02)
    assert 0 < shares[1] < 0.9 and shares[2] == 0


@pytest.mark.filterwarnings("ignore:the motion is not steady")  # its loss is far below that of a bed that sinks
@pytest.mark.parametrize("softening", [100, 20])
def test_the_resonance_is_that_of_a_bed_shaken_gently(softening: float) -> None:
    """Well below its resonance f0 the effective mass of a column is m tan(x) / x with x = pi f / (2 f0)."""
    wide = {
        "particles": rb.Particles(material="steel", diameter="5 mm", count=100),
        "cavity": rb.Box(size=("30 mm", "30 mm", "25 mm")),
    }
    case = small(0.05, 1, softening, **wide)
    estimate = bed_resonance(case.particle_dampers[0])
    frequency = estimate / 5
    run = rb.simulate(small(0.05, frequency, softening, cycles=0.08 * frequency + 15, **wide))
    result = rb.analysis.shaken_cavity(run, frequency=frequency, after=0.08).sel(way="complex power")
    ratio = float(result.effective_mass) / run.arrays.particle_mass[0]
    measured = math.pi * frequency / 2 / math.sqrt(3 * (ratio - 1))
    assert estimate == pytest.approx(measured, rel=0.3)


def test_the_resonance_depends_on_the_force_and_not_on_the_law() -> None:
    """A power law with the numbers of another law has its resonance; a measured curve counts as a spring."""

    def resonances(contact: Any) -> list[float]:
        damper = small(5, 160, 1, contact=contact, friction=None).particle_dampers[0]
        return [bed_resonance(damper, softening) for softening in (1, 8)]

    hertz, linear = resonances(rb.Tsuji(restitution=0.6)), resonances(rb.Linear(stiffness=1e6, restitution=0.6))
    assert resonances(rb.PowerLaw(damping_exponent=0.25, restitution=0.6)) == pytest.approx(hertz)
    assert resonances(rb.PowerLaw(stiffness=1e6, exponent=1, damping_exponent=0, restitution=0.6)) == pytest.approx(
        linear
    )
    curve = rb.TabulatedNormal(overlap=(0, 1e-6, 2e-6), force=(0, 1, 2))
    assert resonances(curve) == pytest.approx(linear)


def test_the_resonance_falls_with_softening() -> None:
    """The resonance falls with the cube root of softening for Hertz contacts, with its square root for linear ones."""
    hertz = small(5, 100, 1).particle_dampers[0]
    linear = small(5, 100, 1, contact=rb.Linear(stiffness="1 MN/m", restitution=0.6), friction=0).particle_dampers[0]
    assert bed_resonance(hertz, 1.0) / bed_resonance(hertz, 64.0) == pytest.approx(4)
    assert bed_resonance(linear, 1.0) / bed_resonance(linear, 64.0) == pytest.approx(8)
    still = small(5, 100, 1, gravity=(0, 0, 0), packing=rb.Lattice()).particle_dampers[0]
    assert bed_resonance(still) == 0


@pytest.mark.parametrize(
    ("amplitude", "frequency", "limit"), [(49, 400, "the loss"), (15, 160, "the loss"), (30, 20, "overlaps")]
)
def test_auto_takes_the_largest_within_its_bounds(amplitude: float, frequency: float, limit: str) -> None:
    """A run with the automatic softening equals one with its value, notes the value, and has no warning."""
    run = rb.simulate(small(amplitude, frequency, "auto"))
    chosen = run.diagnostics["softening"]
    assert chosen > 1
    change = run.diagnostics["softening_change"]
    assert 0.9 * AUTO_CHANGE < change <= AUTO_CHANGE if limit == "the loss" else change < AUTO_CHANGE
    assert any(note.startswith(f"softening {chosen:g}, limited by {limit}") for note in run.notes)
    assert warnings(run) == []
    same = rb.simulate(small(amplitude, frequency, chosen))
    assert np.array_equal(run.arrays.cavity_force, same.arrays.cavity_force)


@pytest.mark.parametrize(
    "changes",
    [
        {"amplitude": 5.0},
        {"gravity": (0, 0, 0), "packing": rb.Lattice()},
    ],
)
def test_auto_is_one_where_nothing_can_be_promised(changes: dict[str, Any]) -> None:
    """The automatic softening is 1, with a note, for beds that stay on the floor and without gravity."""
    run = rb.simulate(small(**{"amplitude": 30.0, "frequency": 100, "softening": "auto", "cycles": 2, **changes}))
    assert run.diagnostics["softening"] == 1
    assert any(note.startswith("softening 1: ") for note in run.notes)


def test_auto_on_a_structure_looks_at_its_modes() -> None:
    """The automatic softening is lower if the modes of the structure have higher frequencies."""

    def softening(stiffness: float) -> float:
        structure = rb.SDOF(mass="1 kg", stiffness=stiffness, velocity="0.3 m/s")
        case = small(10, 100, "auto").model_copy(update={"structure": structure, "duration": 1e-3})
        return rb.simulate(rb.Case.model_validate(case.model_dump())).diagnostics["softening"]

    assert 1 < softening(2.5e6) < softening(1e6)


def test_auto_is_read_from_case_files_and_written() -> None:
    """Case files state the automatic softening as the text "auto"."""
    case = small(10, 100, "auto")
    assert 'softening = "auto"' in case.to_toml()
    assert rb.Case.from_toml(case.to_toml()) == case


def test_studies_and_loss_maps_mark_softened_variants() -> None:
    """Flags of studies and loss maps contain the effects of softening."""
    case = small(5, 160, 300, cycles=6)
    result = rb.loss_map(case, [5.0, 49.0], [20.0, 160.0], cycles=(2, 4), progress=False)
    names = list(WARNINGS)
    soft, enduring = (result.warnings.values & 2 ** names.index(name) > 0 for name in ("soft_bed", "enduring_contacts"))
    assert soft.tolist() == [[False, True], [False, True]]
    assert enduring[0].all() and not enduring[1, 0]


def test_the_estimate_covers_computed_changes() -> None:
    """The estimate is at least the change of the loss in a cycle over m V^2 in long runs (docs/theory/softening.md)."""
    carbide, steel = (
        shaken(5, 180, 1).particle_dampers[0],
        shaken(
            5,
            160,
            1,
            particles=rb.Particles(material="steel", diameter="5 mm", count=100),
            cavity=rb.Box(size=("30 mm", "30 mm", "25 mm")),
            contact=rb.Tsuji(restitution=0.8),
            wall=None,
        ).particle_dampers[0],
    )
    computed = [
        (carbide, 180, 1.53, 5, 1.454 - 1.107),
        (carbide, 180, 1.53, 20, 2.538 - 1.107),
        (carbide, 180, 1.02, 20, 0.870 - 0.062),
        (carbide, 180, 4.99, 5, 0.999 - 0.880),
        (steel, 160, 1.53, 30, 1.576 - 0.963),
        (steel, 160, 1.02, 100, 0.745 - 0.006),
        (steel, 60, 1.53, 300, 1.200 - 0.929),
    ]
    for damper, frequency, level, softening, change in computed:
        motion = CavityMotion(frequency, frequency, 9.81 * level, is_prescribed=True)
        assert change < 1.05 * loss_change(damper, motion, level, softening)


@pytest.mark.parametrize("level", [1e-3, 0.5, 30.0])
def test_motion_of_a_shaken_cavity_at_any_level(level: float) -> None:
    """The estimate for a cavity on a shaker uses its frequency and acceleration, also far below 1 m/s^2."""
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude=f"{level} m/s^2", frequency=70.0, direction="z"))
    motion = cavity_motion(rb.Case(structure=shaker, duration="1 s"), np.zeros((0, 3)), np.zeros((2, 0, 2)))
    assert motion == CavityMotion(70.0, 70.0, pytest.approx(level), is_prescribed=True)


def rolling_balls(softening: float, **changes: Any) -> rb.Run:
    """Return a run of balls that roll on the floor of a long box, with rolling resistance."""
    radius = 2e-3
    places = [[x, 0, radius - 6e-3] for x in (-9e-3, 0, 9e-3)]
    damper = rb.ParticleDamper(
        **{
            "particles": rb.Particles(material="steel", diameter=2 * radius),
            "cavity": rb.Box(size=("60 mm", "20 mm", "12 mm")),
            "contact": rb.Tsuji(restitution=0.7),
            "friction": 0.5,
            "rolling": 0.03,
            "packing": rb.Positions(positions=places),
            "direction": "x",
            "softening": softening,
        }
        | changes
    )
    motion = rb.Harmonic(amplitude="4 m/s^2", frequency="30 Hz", direction="x")
    return rb.simulate(rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration="0.3 s"), progress=False)


def test_a_rolling_ball_does_not_lose_more_with_softening() -> None:
    """The contact of a resting ball lasts; its loss agrees within 1 % at softening 1 and 200, and there is no warning.

    No test saw the warning of a rolling ball: the tests of enduring contacts had beds at rest only.
    """
    hard, soft = rolling_balls(1), rolling_balls(200)
    losses = [float(run.ledger.contact_loss[-1]) for run in (hard, soft)]
    assert losses[0] == pytest.approx(losses[1], rel=0.01)
    assert soft.diagnostics["softened_enduring_share"] < 0.05
    assert not any("last longer than a quarter" in note for note in soft.notes)


def test_a_resting_bed_with_rolling_resistance_still_has_the_warning() -> None:
    """The rolling loss of a bed that rests is not taken off: it grows with softening as the other losses do."""
    bed = {
        "particles": rb.Particles(material="steel", diameter="4 mm", count=40),
        "cavity": rb.Box(size=("17 mm", "17 mm", "20 mm")),
        "packing": rb.Settled(seed=1),
    }
    soft = rolling_balls(300, **bed)
    assert soft.diagnostics["softened_enduring_share"] > 0.1
    assert any("last longer than a quarter" in note for note in soft.notes)
