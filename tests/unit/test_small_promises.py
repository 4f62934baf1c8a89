"""Promises of single functions that users lean on without a thought."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import complex_power


def test_cases_may_come_from_a_generator() -> None:
    """Cases are run whatever holds them."""
    runs = rb.simulate_many(rb.reference_case(duration=0.01 * k) for k in (1, 2))
    assert [run.arrays.time[-1] for run in runs] == [0.01, 0.02]


def test_impacts_stay_read_only_when_copied() -> None:
    """The log of impacts cannot be written to, after pickling either."""
    run = pickle.loads(pickle.dumps(rb.simulate(rb.reference_case(duration=0.1))))
    assert run.arrays.impacts.time.size > 0
    with pytest.raises(ValueError, match="read-only"):
        run.arrays.impacts.time[0] = 9.0


def test_the_library_of_materials_is_not_changed_by_its_readers() -> None:
    """Who changes what rb.materials() gives changes nobody's steel."""
    rb.materials().pop("steel")
    assert rb.Sphere(radius="1 mm", material="steel").material.density == 7850


def test_snapshots_take_any_whole_number() -> None:
    """A whole number of NumPy's is a number of snapshots, and no time."""
    assert rb.Output(snapshots=np.int64(20)).snapshots == 20


def test_a_velocity_without_the_frequency_is_told() -> None:
    """Power at a frequency at which nothing moves is no number of rounding."""
    time = np.linspace(0.0, 1.0, 2001)
    with pytest.raises(ValueError, match=r"velocity .* 10 Hz"):
        complex_power(time, np.cos(40 * np.pi * time), np.sin(40 * np.pi * time), frequency=10.0)


def test_saving_through_a_link_writes_its_target(tmp_path: Path) -> None:
    """A run that is saved by the name of a symbolic link is in the file that it points to."""
    (tmp_path / "kept.nc").touch()
    (tmp_path / "latest.nc").symlink_to(tmp_path / "kept.nc")
    run = rb.simulate(rb.reference_case(duration=0.01))
    run.save(tmp_path / "latest.nc")
    assert (tmp_path / "latest.nc").is_symlink()
    assert rb.load(tmp_path / "kept.nc").arrays == run.arrays
