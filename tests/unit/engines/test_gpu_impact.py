"""Kernels of impact dampers do what the processor does, to the last bit, with the memory that they are given."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import typing
from ctypes import CDLL
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.engines import gpu_impact
from rattlebox.engines.batch import Look, kept, run_block
from rattlebox.engines.core import built
from rattlebox.engines.gpu_impact import Members
from rattlebox.engines.pack import pack_batch
from rattlebox.engines.status import STATUSES
from rattlebox.model import contacts, methods, restitutions, signals, structures
from rattlebox.studies.axes import Design
from rattlebox.studies.task import SweepTask


def _beside(name: str) -> Any:
    """A module in this folder, which is no package."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


cases, kernels = _beside("gpu_cases"), _beside("kernels")
CASES = cases.CASES


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The kernels, compiled for the processor."""
    return kernels.built(tmp_path_factory.mktemp("kernels"))


@pytest.fixture(scope="module")
def compared(library: Path) -> dict[tuple[str, str], dict[str, Any]]:
    """All cases, run by the kernels and by the core that has no instructions that round once where others round twice."""
    command = [sys.executable, kernels.__file__, str(library)]
    environment = os.environ | ({"RATTLEBOX_SIMD": "v1"} if "v1" in built() else {})
    told = subprocess.run(command, check=True, stdout=subprocess.PIPE, env=environment).stdout
    return {tuple(line["case"]): line for line in json.loads(told)}


@pytest.mark.parametrize(("group", "name"), [(group, name) for group, named in CASES.items() for name in named])
def test_kernels_agree_with_the_processor(
    group: str, name: str, compared: dict[tuple[str, str], dict[str, Any]]
) -> None:
    """Every part of a case gives the same status and the same bits of every measure, in the memory that was reckoned."""
    line = compared[group, name]
    names = {STATUSES[status][0] for status in line["status"]}
    assert names == {"finished"} if group != "ending" else name in names
    assert 0 < line["near"] <= kernels.NEAR and line["far"] <= line["reckoned"]
    bound = 0.0 if "v1" in built() else 1e-9
    assert {measure: off for measure, off in line["off"].items() if off is None or off > bound} == {}


@pytest.fixture
def card(library: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A card whose kernels are the processor's."""
    card = kernels.Card(CDLL(str(library)))
    monkeypatch.setattr(gpu_impact, "this_card", lambda: card)
    return card


def test_members_go_to_a_card_at_once(card: Any) -> None:
    """As many threads as fit the card take members one after the other; all memory is given back."""
    case, axes = cases.CASES["output"]["motion"].case, {"damper.gap": list(np.linspace(5e-4, 2e-3, 700))}
    task = SweepTask(case, Design.of(case, axes), measures=["impacts", "peak"], cycles=(1, 1), samples=11, motion=True)
    told: list[int] = []
    found = run_block(task.packed, (700,), 10, 700, task.look, gpu=True, progress=told.append)
    wanted, _, _ = kernels.emulated(card.library, Members(task.packed, (700,), 10, 700, **kept(task.look, (700,))))
    assert found is not None and found.keys() == wanted.keys() and np.all(found["impacts"] > 0)
    for name, values in wanted.items():
        np.testing.assert_array_equal(found[name], values)
    assert card.launched == [(690, 256)] and told[-1] == 690 and card.held == 0
    assert run_block(task.packed, (700,), 0, 700, task.look, gpu=True, progress=lambda done: False) is None


@pytest.mark.parametrize("method", [rb.EventDriven(max_events=10**9), rb.Newton(max_events=10**9), rb.TwoStep()])
def test_a_launch_is_stopped_in_its_middle(card: Any, method: Any) -> None:
    """Threads hear a stop at their next event, where a member takes minutes and all of them days; so when Ctrl-C comes."""
    case = cases.CASES["method"]["EventDriven"].case.model_copy(update={"method": method, "duration": 1e6})
    packed = pack_batch(case, {"damper.gap": np.linspace(5e-4, 2e-3, 500)}, (500,))
    told: list[int] = []

    def pressed(done: int) -> bool:
        told.append(done)
        if len(told) > 3:
            raise KeyboardInterrupt
        return True

    assert run_block(packed, (500,), 0, 500, Look(), gpu=True, progress=lambda done: False) is None
    with pytest.raises(KeyboardInterrupt):
        run_block(packed, (500,), 0, 500, Look(), gpu=True, progress=pressed)
    assert told == [0, 0, 0, 0] and not card.works() and card.held == 0


def test_pairs_are_parted_by_kernels(card: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs that begin in the middle of a load and end wherever pairs part are the processor's."""
    monkeypatch.setattr(gpu_impact, "ready", lambda: ("none", "a card of the processor's"))
    case = cases.CASES["structure"]["Shaker"].case
    axes = {"structure.motion.amplitude": ["3 mm"]}  # where motion repeats, so that rounding does not grow
    options: dict[str, Any] = {"cycles": (20, 10), "pairs": 2, "progress": False}
    here, there = (rb.lyapunov(case, axes, on=on, **options) for on in (None, "gpu"))
    assert np.array_equal(there.status, here.status) and len(card.launched) > 10
    np.testing.assert_allclose(there.exponent, here.exponent, rtol=1e-4)


UNIONS = {
    "contact": contacts.AnyContact,
    "restitution": restitutions.AnyRestitution,
    "structure": structures.AnyStructure,
    "load": signals.AnySignal,
    "method": methods.AnyMethod,
}


@pytest.mark.parametrize("group", UNIONS)
def test_every_part_of_a_case_is_compared(group: str) -> None:
    """What the model offers is among the cases, or is listed as missing."""
    offered = {part.__name__ for part in _classes(UNIONS[group])}
    assert offered and offered <= {*cases.CASES[group], *cases.BELOW.get(group, ())}


def _classes(union: Any) -> list[type]:
    if isinstance(union, type):
        return [union]
    inner = typing.get_args(union)
    return [part for one in inner for part in _classes(one)] if inner else []


def test_the_page_tells_what_a_card_can_do() -> None:
    """The parity table of the page is the one that the cases make."""
    page = (Path(__file__).parents[3] / "docs" / "gpu.md").read_text(encoding="utf-8")
    wanted = "\n".join(cases.table())
    assert wanted in page, wanted
