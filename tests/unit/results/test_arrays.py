"""Arrays of results: shapes, types, labels, equality."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.results import Run, RunArrays, Table

BOX = Path(__file__).parents[3] / "examples/steel_balls_in_a_box.toml"


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
    """Fractions are refused as indices of dampers."""
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
        run.arrays.replaced(impacts=log.replaced(damper=np.ones(count, int)))
    with pytest.raises(ValueError, match="outside its row"):
        run.arrays.replaced(impacts=log.replaced(contact=np.full(count, 2)))
    with pytest.raises(ValueError, match="identifier"):
        replace(run, counts={"not a name": 1})


def test_impacts_need_every_column() -> None:
    """An impact log with times alone is refused."""
    with pytest.raises(ValueError, match="damper of the impacts is missing"):
        Table("impacts", "impact", time=np.array([0.1]))


def test_arrays_are_read_only(run: Run) -> None:
    """Results cannot be overwritten by accident."""
    with pytest.raises(ValueError, match="read-only"):
        run.arrays.displacement[0] = 1.0


def test_equality_sees_one_bit(run: Run) -> None:
    """Equality holds for copies with NaN and fails for one changed bit."""
    nan = np.full(len(run.arrays.impacts), np.nan)
    log = run.arrays.impacts
    one, two = (run.arrays.replaced(impacts=log.replaced(restitution=nan.copy())) for _ in "12")
    assert one == two
    changed = run.arrays.velocity.copy()
    changed[5, 0] = np.nextafter(changed[5, 0], np.inf)
    assert run.arrays.replaced(velocity=changed) != run.arrays
    assert replace(run, status="interrupted") != run


def test_runs_travel_between_processes(two_dampers: Run) -> None:
    """A pickled run comes back equal, with its computing time and provenance."""
    again = pickle.loads(pickle.dumps(two_dampers))
    assert again == two_dampers
    assert again.wall_time == two_dampers.wall_time
    assert again.provenance == two_dampers.provenance


def test_how_a_run_was_computed_does_not_count(run: Run) -> None:
    """Runs differ by their case, counts and results, not by date, machine, computing time and memory."""
    counts = {**run.counts, "memory_bytes": 1000}
    elsewhere = replace(run.provenance, version="9.9", created="2031-01-01", platform="elsewhere")
    assert replace(run, counts=counts, wall_time=5.0, provenance=elsewhere) == run
    assert replace(run, source=run.case_toml + "seed = 2\n") != run
    for changes in ({"counts": {**counts, "flights": 0}}, {"counts": {"memory_bytes": 1000}}, {"notes": ("beware",)}):
        assert replace(run, **changes) != run
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


def test_undefined_diagnostics_are_equal() -> None:
    """Diagnostics that are NaN in both of two runs do not make them differ."""
    arrays = RunArrays(time=np.zeros(1))
    first, again = (Run(arrays, diagnostics={"largest_overlap": float("nan")}) for _ in "12")
    assert first == again
    assert first != Run(arrays, diagnostics={"largest_overlap": 0.0})
    assert first != Run(arrays)


@pytest.mark.parametrize(
    ("engine", "name", "reason"),
    [
        ("dem", "impacts", "does not log them one by one; it has motion, energy, particles"),
        ("impact", "particles", "1-D run .* has balls, .*; it has motion, energy, impacts"),
        ("impact", "sliding_loss", "only the dem engine writes"),
        ("dem", "ball_position", "only the impact engine writes"),
        ("dem", "no_such_array", "this 3-D run .* has no 'no_such_array'"),
    ],
)
def test_absent_groups_and_variables_say_why(engine: str, name: str, reason: str) -> None:
    """A group or a variable that a run lacks raises AttributeError with the reason and what the run has."""
    run = Run(RunArrays(time=np.zeros(1), engine=engine))
    assert name not in run.arrays
    for holder in (run.arrays, run) if name in ("impacts", "particles") else (run.arrays,):
        with pytest.raises(AttributeError, match=reason):
            getattr(holder, name)
    with pytest.raises(TypeError, match=reason):
        run.arrays.replaced(**{name: np.zeros(1)})


def test_a_run_holds_its_case(tmp_path: Path) -> None:
    """A run of either engine returns the case that was run, and an equal one after it was read from a file."""
    for case in (rb.reference_case(duration=0.01), rb.Case.from_file(BOX).model_copy(update={"duration": 1e-3})):
        run = rb.simulate(case)
        assert type(run) is rb.Run
        assert run.case is case
        assert rb.load(run.save(tmp_path / "run.nc")).case == case


def test_contacts_have_names(two_dampers: Run) -> None:
    """Contacts are named along the row, walls at both ends."""
    assert two_dampers.arrays.contact_names(0) == ("trailing wall", "leading wall")
    assert two_dampers.arrays.contact_names(1) == (
        "trailing wall",
        "ball 1 - ball 2",
        "ball 2 - ball 3",
        "leading wall",
    )


def test_impacts_stay_read_only_when_copied() -> None:
    """The log of impacts is read-only, also after pickling."""
    run = pickle.loads(pickle.dumps(rb.simulate(rb.reference_case(duration=0.1))))
    assert run.arrays.impacts.time.size > 0
    with pytest.raises(ValueError, match="read-only"):
        run.arrays.impacts.time[0] = 9.0
