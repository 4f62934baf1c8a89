"""The arrays are what they say: shapes, types, labels, equality."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.results import GranularArrays, ImpactArrays, Run, RunArrays


def test_missing_fields_are_zero() -> None:
    """Fields that an engine leaves out hold zeros of the right shape."""
    arrays = RunArrays(time=np.arange(4.0), points=("tip",), dampers=("a", "b"), mode_frequency=np.ones(3))
    assert arrays.displacement.shape == (4, 1)
    assert arrays.mode_energy.shape == (4, 3)
    assert arrays.plastic_loss.shape == (4, 2)
    assert not arrays.plastic_loss.any()
    assert len(arrays.impacts) == 0


def test_wrong_shape_is_named() -> None:
    """An array of the wrong shape is refused with its name and both shapes."""
    with pytest.raises(ValueError, match=r"displacement has shape \(3, 1\), but \(time, point\) is \(4, 1\)"):
        RunArrays(time=np.arange(4.0), points=("tip",), displacement=np.zeros((3, 1)))


@pytest.mark.parametrize("time", [[], [0.0, 0.0], [1.0, 0.5], [0.0, np.nan], [[0.0, 1.0]]])
def test_times_must_increase(time: list[float]) -> None:
    """Times that are absent, repeated, falling, undefined or two-dimensional are refused."""
    with pytest.raises(ValueError, match="time"):
        RunArrays(time=np.array(time))


def test_wrong_kind_of_number_is_refused() -> None:
    """Fractions cannot stand for the index of a damper."""
    with pytest.raises(TypeError, match="ball_damper"):
        RunArrays(time=np.zeros(1), dampers=("d",), balls=("d/1",), ball_damper=np.array([0.5]))


@pytest.mark.parametrize("points", [("tip", "tip"), ("",), ("a\0",)])
def test_labels_must_tell_apart(points: tuple[str, ...]) -> None:
    """Names that repeat, are empty, or hold a zero byte are refused."""
    with pytest.raises(ValueError, match="points"):
        RunArrays(time=np.zeros(1), points=points)


def test_references_are_checked(run: Run) -> None:
    """Impacts of a damper or a contact that does not exist are refused."""
    log, count = run.arrays.impacts, len(run.arrays.impacts)
    with pytest.raises(ValueError, match="damper outside"):
        replace(run.arrays, impacts=replace(log, damper=np.ones(count, int)))
    with pytest.raises(ValueError, match="outside its row"):
        replace(run.arrays, impacts=replace(log, contact=np.full(count, 2)))
    with pytest.raises(ValueError, match="identifier"):
        replace(run.arrays, counts={"not a name": 1})


def test_impacts_need_every_column() -> None:
    """An impact log with times alone is refused."""
    with pytest.raises(ValueError, match="damper of the impacts is missing"):
        ImpactArrays(time=np.array([0.1]))


def test_arrays_are_read_only(run: Run) -> None:
    """Results cannot be overwritten by accident."""
    with pytest.raises(ValueError, match="read-only"):
        run.arrays.displacement[0] = 1.0


def test_equality_sees_one_bit(run: Run) -> None:
    """Equality holds for copies with NaN and fails for one changed bit."""
    nan = np.full(len(run.arrays.impacts), np.nan)
    log = run.arrays.impacts
    one, two = (replace(run.arrays, impacts=replace(log, restitution=nan.copy())) for _ in "12")
    assert one == two
    changed = run.arrays.velocity.copy()
    changed[5, 0] = np.nextafter(changed[5, 0], np.inf)
    assert replace(run.arrays, velocity=changed) != run.arrays
    assert replace(run.arrays, status="interrupted") != run.arrays


def test_runs_travel_between_processes(two_dampers: Run) -> None:
    """A pickled run comes back equal, with its computing time and provenance."""
    again = pickle.loads(pickle.dumps(two_dampers))
    assert again == two_dampers
    assert again.arrays.wall_time == two_dampers.arrays.wall_time
    assert again.provenance == two_dampers.provenance


def test_how_a_run_was_computed_does_not_count(run: Run) -> None:
    """Runs differ by their case, counts and results, not by when, where, how fast and in how much memory they came to be."""
    counts = {**run.arrays.counts, "memory_bytes": 1000}
    arrays = replace(run.arrays, counts=counts, wall_time=5.0)
    elsewhere = replace(run.provenance, version="9.9", created="2031-01-01", platform="elsewhere")
    assert Run(arrays, run.case_toml, elsewhere) == run
    assert Run(arrays, run.case_toml + "seed = 2\n") != run
    for changes in ({"counts": {**counts, "flights": 0}}, {"counts": {"memory_bytes": 1000}}, {"notes": ("beware",)}):
        assert Run(replace(arrays, **changes), run.case_toml) != run
    assert run.__eq__(run.arrays) is NotImplemented
    assert run.arrays.__eq__(run) is NotImplemented
    assert run != "run" and run != run.arrays


def test_the_same_case_again_is_the_same_run() -> None:
    """A case that is simulated twice gives equal runs, another gap another run."""
    first, again = (rb.simulate(rb.reference_case(duration=0.05)) for _ in "12")
    assert first == again
    case = rb.reference_case(duration=0.05)
    wider = case.dampers[0].model_copy(update={"gap": 1.1 * case.dampers[0].gap})
    other = rb.simulate(case.model_copy(update={"dampers": (wider,)}))
    assert other != first
    assert other.arrays != first.arrays


def test_particles_again_are_the_same_run() -> None:
    """Particles that are simulated twice, on one thread and on two, give equal results; another seed does not."""

    def beads(seed: int = 1, threads: int = 1) -> rb.Case:
        damper = rb.ParticleDamper(
            particles=rb.Particles(material="glass", diameter="3 mm", count=30),
            cavity=rb.SphericalCavity(diameter="20 mm"),
            contact=rb.Tsuji(restitution=0.8),
            packing=rb.Lattice(noise=0.2, seed=seed),
            softening=100,
        )
        structure = rb.SDOF(mass="0.1 kg", stiffness="10 kN/m", velocity="0.5 m/s")
        return rb.Case(structure=structure, damper=damper, duration="5 ms", method=rb.Dem(threads=threads))

    first, again = (rb.simulate(beads()) for _ in "12")
    assert first == again
    assert rb.simulate(beads(threads=2)).arrays == first.arrays
    assert rb.simulate(beads(seed=2)) != first


def test_what_is_not_a_number_is_equal_in_figures_too() -> None:
    """Figures that are not numbers in both of two runs do not make them differ."""
    first, again = (GranularArrays(time=np.zeros(1), figures={"largest_overlap": float("nan")}) for _ in "12")
    assert first == again
    assert first != GranularArrays(time=np.zeros(1), figures={"largest_overlap": 0.0})
    assert first != GranularArrays(time=np.zeros(1))


def test_contacts_have_names(two_dampers: Run) -> None:
    """Contacts are named along the row, walls at both ends."""
    assert two_dampers.arrays.contact_names(0) == ("trailing wall", "leading wall")
    assert two_dampers.arrays.contact_names(1) == (
        "trailing wall",
        "ball 1 - ball 2",
        "ball 2 - ball 3",
        "leading wall",
    )
