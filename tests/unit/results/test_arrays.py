"""The arrays are what they say: shapes, types, labels, equality."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from rattlebox.results import ImpactArrays, Run, RunArrays


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
    """A pickled run comes back equal."""
    assert pickle.loads(pickle.dumps(two_dampers)) == two_dampers


def test_contacts_have_names(two_dampers: Run) -> None:
    """Contacts are named along the row, walls at both ends."""
    assert two_dampers.arrays.contact_names(0) == ("trailing wall", "leading wall")
    assert two_dampers.arrays.contact_names(1) == (
        "trailing wall",
        "ball 1 - ball 2",
        "ball 2 - ball 3",
        "leading wall",
    )
