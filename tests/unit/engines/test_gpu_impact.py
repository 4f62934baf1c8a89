"""Kernels of impact dampers do what the processor does, to the last bit, with the memory that they are given."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from rattlebox.engines.core import built


def _beside(name: str) -> Any:
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


CASES, kernels = _beside("gpu_cases").CASES, _beside("kernels")


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], dict[str, Any]]:
    """All cases, run by the kernels and by the core that has no instructions that round once where others round twice."""
    library = kernels.built(tmp_path_factory.mktemp("kernels"))
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
    assert not any(line["status"]) and all(line["impacts"])
    assert 0 < line["near"] <= kernels.NEAR and line["far"] <= line["reckoned"]
    bound = 0.0 if "v1" in built() else 1e-9
    assert {measure: off for measure, off in line["off"].items() if off is None or off > bound} == {}
