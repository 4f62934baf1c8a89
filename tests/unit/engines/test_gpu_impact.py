"""Kernels of impact dampers do what the processor does, to the last bit, with the memory that they are given."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from ctypes import CDLL
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rattlebox.engines import batch, gpu_impact
from rattlebox.engines.core import built
from rattlebox.engines.gpu_impact import Members
from rattlebox.studies.axes import Design
from rattlebox.studies.measures import MEASURES
from rattlebox.studies.task import SweepTask

ROOT = Path(__file__).parents[3]


def _beside(name: str) -> Any:
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


CASES, kernels = _beside("gpu_cases").CASES, _beside("kernels")
EVERY = [(group, name) for group, named in CASES.items() for name in named]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> CDLL:
    """The kernels on the processor."""
    return kernels.built(tmp_path_factory.mktemp("kernels"))


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """The core without instructions that round once where others round twice."""
    if "v1" in built():
        core = import_module("rattlebox.engines._core_v1")
        for module in (batch, gpu_impact):
            monkeypatch.setattr(module, "core", lambda: core)


def _task(group: str, name: str) -> SweepTask:
    case, axes, look = CASES[group][name]
    named = [measure for measure, about in MEASURES.items() if "cycles" in look or not about.cyclic]
    return SweepTask(case, Design.of(case, axes), measures=named, samples=101, **look)


def _parts(task: SweepTask) -> Iterator[tuple[Any, tuple[int, ...], int, Any]]:
    for part, look, _ in task._prepared:
        yield part.packed, part.shape, int(np.prod(part.shape)), look


@pytest.mark.parametrize(("group", "name"), EVERY)
def test_kernels_agree_with_the_processor(
    group: str, name: str, library: CDLL, plain: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every part of a case gives the same status and the same bits of every measure, in the memory that was reckoned."""
    given: list[Members] = []

    def taken(packed: Any, shape: Any, start: int, stop: int, progress: Any, **look: Any) -> Any:
        given.append(Members(packed, shape, start, stop, **look))
        return kernels.emulated(library, given[-1])

    monkeypatch.setattr(gpu_impact, "run_members", taken)
    for packed, shape, size, look in _parts(_task(group, name)):
        found, near, far = batch.run_block(packed, shape, 0, size, look, gpu=True)  # type: ignore[misc]
        wanted = batch.run_block(packed, shape, 0, size, look)
        assert wanted is not None and set(wanted) == set(found)
        assert np.all(wanted["status"] == 0) and np.all(wanted["impacts"] > 0)
        assert 0 < near <= kernels.NEAR and far <= given[-1].memory
        for measure, values in wanted.items():
            if "v1" in built():
                np.testing.assert_array_equal(found[measure], values, err_msg=measure)
            else:
                np.testing.assert_allclose(found[measure], values, rtol=1e-9, err_msg=measure)
